"""A flank's own deviation where no physics earns a name: a curve over its roll length, estimated with its error band.

It is no physics of the catalogue, and names nothing. It stands among the claims of a fit so that what nobody can name
is in the simulation all the same, and in the fitted pair file.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.keys.sections import FormSection, PairFile
from gearpoly.physics.base import WORN, Claim, Physics, Quantity
from gearpoly.physics.bounds import half_tooth
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported
from gearpoly.scene import Scene
from gearpoly.units import UM, FloatArray, IntArray

FREE_FORM_KNOTS = 17
"""Places along the active flank between which the curve is straight: one for every sixteenth of a contact, as fine as
twenty samples a mesh tell."""

FREE_FORM_DECIMALS = 6
"""Decimals of um and mm that are written."""


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    if scene.samples.flank != place.flank:
        return np.zeros(scene.samples.size)
    mine, along, um = place.tooth, np.array(place.shape), np.array(values)

    def curve(tooth: IntArray, l: FloatArray) -> FloatArray:
        return np.asarray(UM * np.interp(l, along, um) * (True if mine is None else tooth == mine))

    return scene.deviated(place.gear or 0, curve)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    if not any(values):
        return file
    form = FormSection.model_construct(
        tooth=place.tooth,
        flank=place.flank or "drive",
        roll_length_mm=tuple(round(one, FREE_FORM_DECIMALS) for one in place.shape),
        deviation_um=tuple(round(one, FREE_FORM_DECIMALS) for one in values),
    )
    return on_gear(file, place.gear, form=(*gear_section(file, place.gear).form, form))


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return {f"knot_{k}_um": (float(v), float(s)) for k, (v, s) in enumerate(zip(values, std, strict=True))}


FREE_FORM = Physics(
    name="free_form",
    rank=WORN + 9,
    source="no law: a curve that is straight between places along the flank",
    stands="[[driving.form]]: tooth, flank, roll_length_mm, deviation_um",
    parameters=tuple(f"knot_{k}_um" for k in range(FREE_FORM_KNOTS)),
    case=(Place(gear=0, tooth=0, flank="drive"), (1.0,) * FREE_FORM_KNOTS),
    coordinates=tuple(
        Quantity(name=f"knot_{k}_um", unit="um", most=half_tooth, why="more than half a tooth is not there")
        for k in range(FREE_FORM_KNOTS)
    ),
    amplitudes=FREE_FORM_KNOTS,
    ordinary=(3.0,) * FREE_FORM_KNOTS,
    places=lambda scope: (),
    effect=_effect,
    write=_write,
    report=_report,
    says=lambda place, v: f"The flank deviates by up to {max(map(abs, v)):.1f} um as no physics does.",
    equation="d(l) straight between places along the flank",
)


FREE_FORM_REACH = 0.3
"""Part of the active flank over which the curve forgets itself."""


def curve_covariance() -> FloatArray:
    """Covariance (``FREE_FORM_KNOTS``, ``FREE_FORM_KNOTS``) in um^2 that an ordinary curve has between its places."""
    u = np.linspace(0.0, 1.0, FREE_FORM_KNOTS)
    size = FREE_FORM.ordinary[0]
    return np.asarray(size**2 * np.exp(-np.abs(u[:, None] - u) / FREE_FORM_REACH))


def free_forms(claim: Claim, scenes: Sequence[Scene]) -> list[Claim]:
    """A curve in the place of a ``claim`` about the flanks of one tooth, or of all teeth of a gear, on every flank that
    was recorded and that the claim is about; none where it is about something else."""
    place, physics = claim.place, claim.physics
    of_flanks = place.gear is not None and (place.tooth is not None or physics.mean_tooth)
    if not of_flanks or physics.measures or physics.whole_gear:
        return []
    span = scenes[0].spans[place.gear or 0]
    along = tuple(np.linspace(span.l_start, span.l_a, FREE_FORM_KNOTS).tolist())
    flanks = dict.fromkeys(scene.samples.flank for scene in scenes)
    return [
        Claim(
            physics=FREE_FORM,
            place=Place(gear=place.gear, tooth=place.tooth, flank=flank, shape=along),
            values=(0.0,) * FREE_FORM_KNOTS,
        )
        for flank in flanks
        if place.flank in (None, flank)
    ]
