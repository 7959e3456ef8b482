"""A gear's teeth as they run: what was estimated of them as built, and what was claimed of them beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.diagnose.fit import Fit
from gearpoly.keys.edit import gear_section
from gearpoly.mesh.pair import Flank
from gearpoly.physics.base import Claim
from gearpoly.physics.sheet import column
from gearpoly.units import FloatArray

INSPECTED_PHYSICS = ("cumulative_pitch", "profile_slope", "tooth_pitch", "tooth_thickness")
"""Physics that change what an inspector would measure of pitch, slope and thickness."""

PITCH_BY_FORM, SLOPE_BY_FORM = 0.2, 0.95
"""Standard errors of a tooth's pitch and slope over that of a graded gear's form (``GearPrior.crowning``): flanks of a
grade are no straight lines, and the fit sees the part of each that works. Measured on twelve drawn pairs of grade 6
(0.18 and 0.93), of which noise alone would leave 0.03 and 0.25; two standard errors then hold 96 % of the pitches and
96 % of the slopes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Running:
    """Index deviations ``pitch`` (z,) and profile ``slope`` (z,) in um of one gear's flank, normal to it, with their
    covariances (z, z); ``noise`` (z,) by which its pitch rests on each parameter, for thicknesses of both flanks."""

    flank: Flank
    pitch: FloatArray
    pitch_covariance: FloatArray
    slope: FloatArray
    slope_covariance: FloatArray
    noise: FloatArray


def running(search: Fit, gear: int, flank: Flank, *, claimed: bool) -> Running:
    """One gear's flank as the recordings show it; ``claimed``: with what was claimed of it in ``INSPECTED_PHYSICS``
    kinds.

    Two gears that lean alike look as if they did not lean, and what a fit makes of that comes from the forms of their
    teeth (10 um on drawn pairs whose teeth lean by 1 um in the mean). So of two graded gears each is taken to lean half
    as much as both lean apart, and what it may lean beside that is doubt.
    """
    model, system, layout = search.model, search.linear.system, search.linear.layout
    prior, tail = model.as_built.gears[gear], "_coast_um" if flank == "coast" else "_um"
    section = gear_section(model.declared, gear)
    place = np.arange(system.size)
    pitch = column(section, f"pitch{tail}") + model.as_built.pitch(model.built, flank, gear)
    slope = column(section, f"profile_slope{tail}") + model.as_built.slope(model.built, flank, gear)
    z = prior.z
    by_pitch, by_slope = np.zeros((z, system.size)), np.zeros((z, system.size))
    start = layout.built.start + model.as_built.start(flank, gear)
    by_pitch[np.arange(z), place[start : start + z]] = 1.0
    by_slope[np.arange(z), place[start + z : start + 2 * z]] = 1.0
    doubt = np.zeros((z, z))
    if prior.graded:
        doubt += (SLOPE_BY_FORM * prior.crowning) ** 2 * np.eye(z)
    if all(one.graded for one in model.as_built.gears):
        slope = slope - common_lean(search, flank)
        # A limit must not be called broken, nor said to hold, by what does not show.
        doubt += 0.5 * prior.mean_slope**2
    if claimed:
        for claim, at in zip(model.claims, layout.claims, strict=True):
            if claim.physics.name not in INSPECTED_PHYSICS or claim.place.gear != gear:
                continue
            more_pitch, more_slope = (written(search, claim, f"{key}{tail}") for key in ("pitch", "profile_slope"))
            by_pitch[:, at], by_slope[:, at] = more_pitch, more_slope
            pitch, slope = pitch + more_pitch @ claim.values, slope + more_slope @ claim.values
            doubted = more_slope @ (claim.physics.law_doubt * np.array(claim.values))
            doubt += np.outer(doubted, doubted)
    form = PITCH_BY_FORM * prior.crowning if prior.graded else 0.0
    return Running(
        flank=flank,
        pitch=pitch,
        pitch_covariance=by_pitch @ system.covariance @ by_pitch.T + form**2 * np.eye(z),
        slope=slope,
        slope_covariance=by_slope @ system.covariance @ by_slope.T + doubt,
        noise=by_pitch,
    )


def common_lean(search: Fit, flank: Flank) -> float:
    """Slope in um that the median teeth of both gears have in common on one flank, as they were built."""
    as_built, built = search.model.as_built, search.model.built
    return 0.5 * sum(float(np.median(as_built.slope(built, flank, gear))) for gear in (0, 1))


def written(search: Fit, claim: Claim, key: str) -> FloatArray:
    """Change (z, q) in um of ``key`` of the claim's gear by one unit of each of its values."""
    file, q = search.model.declared, len(claim.values)
    before = column(gear_section(file, claim.place.gear), key)
    units: Sequence[Sequence[float]] = np.eye(q).tolist()
    return np.column_stack(
        [
            column(gear_section(claim.physics.write(file, claim.place, tuple(unit)), claim.place.gear), key) - before
            for unit in units
        ]
    )


def thicknesses(search: Fit, flanks: Sequence[Running], gear: int) -> tuple[FloatArray, FloatArray] | None:
    """Tooth thickness deviations E_s (z,) in um along the reference circle and their covariance (z, z); None where not
    both flanks were recorded."""
    if {one.flank for one in flanks} != {"drive", "coast"}:
        return None
    cosine = math.cos(search.model.scope.gears[gear].alpha)
    drive, coast = flanks
    by = (drive.noise + coast.noise) / cosine
    form = 2.0 * (PITCH_BY_FORM * search.model.as_built.gears[gear].crowning / cosine) ** 2
    if not search.model.as_built.gears[gear].graded:
        form = 0.0
    covariance = by @ search.linear.system.covariance @ by.T + form * np.eye(drive.pitch.size)
    return (drive.pitch + coast.pitch) / cosine, covariance


def about_mean(values: FloatArray, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values (z,) about their mean, and their standard errors (z,)."""
    centred = np.eye(values.size) - 1.0 / values.size
    return centred @ values, np.sqrt(np.maximum(np.diag(centred @ covariance @ centred.T), 0.0))
