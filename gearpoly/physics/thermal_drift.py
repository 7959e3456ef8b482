"""A rig that warms up: the transmission error wanders slowly over a recording."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations
from typing import Annotated

import numpy as np
from pydantic import Strict

from gearpoly.keys.edit import changed, table
from gearpoly.keys.kinds import ONE_FAULT, Section, Um, field
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import READ, Physics, Quantity, Scope
from gearpoly.physics.bounds import recorded
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported
from gearpoly.units import UM, FloatArray

RECORDINGS_ANY_MAY_DRIFT = 4
"""Recordings up to which any number of them may drift alike."""

DRIFT_TERMS = 3
"""Legendre polynomials over a recording: a ramp, a bow, an S. What is faster is no warming."""


class MeasurementKeys(Section):
    """What a measurement says of it."""

    thermal_drift_um: tuple[Annotated[tuple[Um, ...], Strict(False), ONE_FAULT], ...] = field(
        "slow drift in um of each recording in the order given: factors of Legendre's polynomials 1, 2, ... over time",
        (),
        strict=False,
    )


def _places(scope: Scope) -> Iterable[Place]:
    steady = tuple(k for k in range(scope.conditions) if not (scope.wanders and scope.wanders[k]))
    for count in range(1, len(steady) + 1):
        # Those that began cold drift alike; of many recordings all or one.
        if count in (1, len(steady)) or len(steady) <= RECORDINGS_ANY_MAY_DRIFT:
            yield from (Place(recordings=some) for some in combinations(steady, count))


def _curve(values: Values, along: FloatArray) -> FloatArray:
    return np.asarray(np.polynomial.legendre.legval(along, (0.0, *values)) * UM)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    if scene.samples.number not in place.recordings:
        return np.zeros(scene.samples.size)
    return _curve(values, scene.samples.along)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    measured = table(file, "measurement")
    held = list(measured.thermal_drift_um)
    held += [()] * (max(place.recordings) + 1 - len(held))
    for k in place.recordings:
        stated = np.array([*held[k], *(0.0,) * DRIFT_TERMS])[: max(DRIFT_TERMS, len(held[k]))]
        stated[:DRIFT_TERMS] += values
        held[k] = tuple(round(v, 6) for v in stated.tolist())
    copy: PairFile = changed(file, measurement=changed(measured, thermal_drift_um=tuple(held)))
    return copy


def _named(recordings: tuple[int, ...]) -> str:
    if len(recordings) == 1:
        return f"recording {recordings[0]}"
    return f"recordings {', '.join(map(str, recordings[:-1]))} and {recordings[-1]}, alike,"


def _sensible(scope: Scope, place: Place, values: Values) -> bool:
    """All terms together drift no farther than the recordings range."""
    return float(np.ptp(_curve(values, np.linspace(-1, 1, 201)))) / UM <= recorded(scope, place)


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    along = np.linspace(-1.0, 1.0, 201)
    columns = np.polynomial.legendre.legvander(along, DRIFT_TERMS)[:, 1:]
    curve = columns @ values
    # The change from the mildest to the strongest point; its error is that of the difference of both.
    top, bottom = int(np.argmax(curve)), int(np.argmin(curve))
    row = columns[top] - columns[bottom]
    size = float(curve[top] - curve[bottom])
    std = float(np.sqrt(max(float(row @ covariance @ row), 0.0)))
    return {"amplitude_um": (size, std)}


PHYSICS = Physics(
    name="thermal_drift",
    rank=READ + 4,
    source="no law: the slowest curves over time, Legendre polynomials",
    stands="measurement.thermal_drift_um",
    parameters=("amplitude_um",),
    case=(Place(recordings=(0,)), (2.0, -1.0, 0.4)),
    keys={"measurement": MeasurementKeys},
    coordinates=tuple(
        Quantity(name=f"legendre_{k}_um", unit="um", most=recorded, why="no drift is larger than all that was recorded")
        for k in range(1, DRIFT_TERMS + 1)
    ),
    amplitudes=DRIFT_TERMS,
    ordinary=(2.0, 0.0, 0.0),
    places=_places,
    effect=_effect,
    sensible=_sensible,
    slow=True,
    write=_write,
    report=_report,
    says=lambda place, v: (
        f"The transmission error of {_named(place.recordings)} drifts slowly, by "
        f"{float(np.ptp(_curve(v, np.linspace(-1, 1, 201)))) / UM:.1f} um."
    ),
    equation="x gains a slow curve over time (Legendre polynomials 1 to 3)",
)
