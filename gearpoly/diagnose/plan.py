"""Before anything is measured: which look-alikes this pair has, and which recordings would tell them apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from gearpoly.assemble import with_sheets_stated
from gearpoly.compare.stand_in import known_file
from gearpoly.diagnose.alike import Alike, FaultsShown, alike
from gearpoly.diagnose.as_built import make_as_built
from gearpoly.diagnose.imagine import LIGHT_TORQUE_N_MM, NextRecording, imagined
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.ordinary import label, not_asked, ordinary_claims, scope_of
from gearpoly.diagnose.prepare import gear_priors
from gearpoly.errors import GearpolyError
from gearpoly.files.models import PairFile
from gearpoly.physics.base import Scope
from gearpoly.units import NM, RPM, FloatArray

TOLD_APART_SINE = 0.5
"""Sine from which two physics count as told apart: an effect of ten standard deviations still stands out by five."""

FURTHER_RECORDING_SINES = 0.05
"""Sines, summed over all pairs and none counted beyond ``TOLD_APART_SINE``, that a further recording has to add."""


@dataclass(frozen=True, kw_only=True)
class LookAlike:
    """Two physics that the recordings cannot tell apart where both first show: sine of their angle in the ``first``
    recording alone, and ``after`` each further one; None as long as either does not show."""

    one: str
    other: str
    first: float | None
    after: tuple[float | None, ...]

    @property
    def last(self) -> float | None:
        """The sine that all recordings together leave."""
        return (self.first, *self.after)[-1]


@dataclass(frozen=True, kw_only=True)
class Hidden:
    """A physics of which the ``first`` recording shows less than ``SHOWS``, and what it shows of it (in
    standard deviations of an ordinary fault) with each further one."""

    physics: str
    first: float
    after: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Plan:
    """``first`` the recording that anybody would make, ``further`` those worth making after it, most telling first, the
    look-alikes with what each step leaves of them, what is ``hidden`` from the first, and what could show in none."""

    name: str
    first: NextRecording
    further: tuple[NextRecording, ...]
    look_alikes: tuple[LookAlike, ...]
    hidden: tuple[Hidden, ...]
    not_asked: tuple[str, ...]


def plan(file: PairFile, *, path: Path | str, step: Callable[[str], None] = lambda _: None) -> Plan:
    """Which recordings would tell the look-alikes of a pair apart.

    Raises ``GeometryError`` or ``OutOfRangeError`` where the pair cannot run at all.
    """
    step("thinking of recordings")
    file = with_sheets_stated(file, path=path)
    model = _model(file, Path(path))
    first, *others = _recordings(file)
    kept, scenes = [first], [imagined(model, first, number=0)]
    for made in others:
        try:
            scenes.append(imagined(model, made, number=len(kept)))
        except GearpolyError:
            continue  # the pair cannot run like that
        kept.append(made)
    model = replace(model, scope=scope_of(model, scenes))
    claims = ordinary_claims(model.scope)
    step("laying look-alikes side by side")
    laid = alike(model, scenes, claims)
    order, steps = _campaign(laid, len(kept))
    names = [label(claim) for claim in claims]
    return Plan(
        name=file.name,
        first=first,
        further=tuple(kept[k] for k in order),
        look_alikes=tuple(_look_alikes(names, steps)),
        hidden=tuple(
            Hidden(physics=name, first=float(steps[0].shown[i]), after=tuple(float(one.shown[i]) for one in steps[1:]))
            for i, name in enumerate(names)
            if not steps[0].visible[i]
        ),
        not_asked=tuple(not_asked(claims)),
    )


def _campaign(laid: Alike, recordings: int) -> tuple[list[int], list[FaultsShown]]:
    """The recordings worth making after the first, and what the first and all up to each of them show."""
    campaign, steps = [0], [laid.weighed([0])]
    while len(campaign) < recordings:
        tried = {k: laid.weighed([*campaign, k]) for k in range(recordings) if k not in campaign}
        best = max(tried, key=lambda k: round(_worth(tried[k]), 2))
        if _worth(tried[best]) < _worth(steps[-1]) + FURTHER_RECORDING_SINES:
            break
        campaign.append(best)
        steps.append(tried[best])
    return campaign[1:], steps


def _worth(weighed: FaultsShown) -> float:
    """What is told apart: sines over all pairs, none counted for more than it takes; of what does not show nothing
    is."""
    return float(np.sum(np.minimum(np.triu(weighed.sines, 1), TOLD_APART_SINE)))


def _look_alikes(names: list[str], steps: list[FaultsShown]) -> list[LookAlike]:
    out = []
    for i, j in combinations(range(len(names)), 2):
        sines = [float(one.sines[i, j]) if one.visible[i] and one.visible[j] else None for one in steps]
        if next((sine for sine in sines if sine is not None), TOLD_APART_SINE) < TOLD_APART_SINE:
            out.append(LookAlike(one=names[i], other=names[j], first=sines[0], after=tuple(sines[1:])))
    return out


def _full(file: PairFile) -> float:
    return max(file.torque_nm * NM, 10.0 * LIGHT_TORQUE_N_MM)


def _recordings(file: PairFile) -> list[NextRecording]:
    full = _full(file)
    out = [
        NextRecording(flank=flank, torque=torque)
        for flank in ("drive", "coast")
        for torque in (full, LIGHT_TORQUE_N_MM)
    ]
    if file.pair.speed_rpm is not None:
        # The first at a stated speed, or nothing could be said of another.
        out = [NextRecording(flank=one.flank, torque=one.torque, speed=file.pair.speed_rpm * RPM) for one in out]
        out.append(NextRecording(flank="drive", torque=full, speed=2.0 * file.pair.speed_rpm * RPM))
    speed = out[0].speed
    out += [NextRecording(flank="drive", torque=full, speed=speed, refitted=shaft) for shaft in (0, 1)]
    out.append(NextRecording(flank="drive", torque=full, speed=speed, reversed=True))
    return out


def _model(file: PairFile, path: Path) -> Model:
    declared = known_file(file)
    gears, priors = gear_priors(file)
    as_built = make_as_built(priors, ["drive", "coast"])
    nothing = Scope(
        file=declared,
        gears=gears,
        flanks=(),
        torques=(),
        speeds=(),
        encoders=(True, True),
        timed=False,
        counted=True,
        span=0.0,
        inspected=(not priors[0].graded, not priors[1].graded),
        reach=((0.0, 1.0), (0.0, 1.0)),
    )
    built: FloatArray = np.zeros(as_built.size)
    return Model(
        declared=declared, path=path, scope=nothing, as_built=as_built, observed=(), shift_std=1e-4, built=built
    )
