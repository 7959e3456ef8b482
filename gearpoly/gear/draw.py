"""Seeded error gears: every tooth and both flanks drawn within limits, then verified (the paper's
Eqs. 1-7).

Streams: ``draw_deviations`` spawns three generators from the one that it gets: drive pitch, place
of the coast flanks, profiles; the last spawns one per tooth. So another profile option leaves pitch
and thickness as they were, a tooth's profile does not depend on the number of teeth, and a mate has
no part in it. Order per gear: drive chain, then coast chain and level (graded) or one thickness per
tooth (independent), again for every gear drawn again. Per tooth: drive flank, then coast flank; per
flank: slope, form coefficients, form size, again where F_alpha is exceeded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from gearpoly.errors import NoGearPassesError, OutOfRangeError
from gearpoly.gear.chain import closed_chain
from gearpoly.gear.deviations import Deviations, FormDeviation, Scatter, Shape, Slope, pitch_and_thickness
from gearpoly.gear.gear import Gear
from gearpoly.gear.metrology import (
    Which,
    base_tangent_deviations,
    cumulative_pitch,
    profile_deviations,
    single_pitch,
    spans,
)
from gearpoly.gear.tolerances import Limits
from gearpoly.units import UM, FloatArray, IntArray, read_only

MAX_GEARS = 400
"""Gears drawn before the limits count as contradicting one another. Smaller refuses limits that a few gears in a
hundred keep."""

LEAST_GEARS, MOST_TEETH_DRAWN = 40, 20_000
"""Large gears take long to draw (0.1 s at 200 teeth), so they get as many tries as make ``MOST_TEETH_DRAWN`` teeth, but
LEAST_GEARS at least."""
MAX_FLANKS = 1000
"""Profiles drawn for one flank before its profile limits count as contradicting one another."""
SUM_ROUNDING = 1e-12
"""mm. Rounding in sums of a thousand deviations; no measurement resolves it. 0 refuses gears that
lie on their limit."""
FORM_WAVES = 4
"""Form deviations are cosines of 2, 3, 4 and 5 half waves over the active profile."""
_U = np.linspace(0.0, 1.0, 1001)
"""Where smooth profiles are evaluated: 1001 places find the range of 5 half waves to 3e-5 of
itself."""


def streams(seed: int) -> tuple[np.random.Generator, np.random.Generator]:
    """Independent generators for the driving and the driven gear of one ``seed``; neither depends
    on the other's use."""
    driving, driven = (np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(i,))) for i in range(2))
    return driving, driven


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """One error gear and the numbers it was made from, mm.

    ``index`` and ``index_coast`` (z,) normal deviations of both sides, ``E_s`` (z,) thickness as an
    arc; ``f_Halpha`` and ``f_falpha`` (2, z) profile slope and form of drive and coast flanks as an
    inspector finds them. ``gears`` were drawn until one passed, itself included.
    """

    deviations: Deviations
    index: FloatArray
    index_coast: FloatArray
    E_s: FloatArray
    f_Halpha: FloatArray
    f_falpha: FloatArray
    gears: int


def draw_deviations(
    gear: Gear,
    limits: Limits,
    *,
    rng: np.random.Generator,
    which: Which = "driving",
    profile_errors: Literal["smooth", "scatter"] = "smooth",
    thickness_errors: Literal["graded", "independent"] = "graded",
    roll_lengths: FloatArray | None = None,
) -> Drawn:
    """An error gear within ``limits``, drawn from ``rng`` and verified; ``which`` gear it is sets
    where W_k is measured.

    Drive flanks: a closed chain of pitch deviations uniform within f_pT and F_pT; tooth 0 stands at
    its place. "graded" coast flanks have a chain of their own, at a level uniform among those that
    keep E_s and W_k. "independent" thickness is the paper's: each tooth's E_s uniform within its
    limits, drawn again where it breaks W_k; coast pitch then obeys no grade. "smooth" profiles have
    a slope uniform in +-f_HalphaT and a form of range Rand(1) f_falphaT. "scatter" is the paper's:
    every point uniform in +-F_alphaT/2, our reading of a limit on the range of a trace, at
    ``roll_lengths`` (n,) in mm, from the active start to the tip.

    Raises ``NoGearPassesError`` where every gear drawn breaks a limit, and
    ``OutOfRangeError`` for "scatter" without ``roll_lengths``.
    """
    if profile_errors == "scatter" and (roll_lengths is None or roll_lengths.size < 2):
        raise OutOfRangeError('profile_errors = "scatter" has no points; roll_lengths of two or more would do')
    pitch_rng, coast_rng, profile_rng = rng.spawn(3)
    _refuse_apart(limits, math.cos(gear.alpha))
    x, y, gears = _placed(gear, limits, pitch_rng, coast_rng, which, graded=thickness_errors == "graded")
    index, index_coast = x * math.cos(gear.alpha), y * math.cos(gear.alpha)
    slope, form, drive_shapes, coast_shapes = (
        _smooth(gear, limits, profile_rng)
        if roll_lengths is None or profile_errors == "smooth"
        else _scatter(gear, limits, profile_rng, roll_lengths)
    )
    E_s = x + y
    return Drawn(
        deviations=pitch_and_thickness(gear, index=index, E_s=E_s, index_coast=index_coast)
        + Deviations(drive=drive_shapes, coast=coast_shapes),
        index=read_only(index),
        index_coast=read_only(index_coast),
        E_s=read_only(E_s),
        f_Halpha=read_only(slope),
        f_falpha=read_only(form),
        gears=gears,
    )


def _placed(
    gear: Gear, limits: Limits, pitch_rng: np.random.Generator, coast_rng: np.random.Generator, which: Which, *,
    graded: bool,
) -> tuple[FloatArray, FloatArray, int]:  # fmt: skip
    """Arcs (z,) in mm by which the drive and the coast flanks of a gear that passes stand off their places, and how
    many gears were drawn for it. Raises ``NoGearPassesError``."""
    drive, coast = spans(gear, which)
    cosine = math.cos(gear.alpha)
    place = _graded if graded else _independent
    tightest = math.inf
    tries = max(LEAST_GEARS, min(MAX_GEARS, MOST_TEETH_DRAWN // gear.z))
    for gears in range(1, tries + 1):
        x = closed_chain(gear.z, f=limits.f_pT, F=limits.F_pT, rng=pitch_rng)
        y, lack = place(gear, limits, x, drive, coast, coast_rng)
        tightest = min(tightest, lack)
        if y is not None and _passes(gear, limits, x * cosine, y * cosine, which, coast_graded=graded):
            return x, y, gears
    raise NoGearPassesError(_gear_message(gear, limits, tightest, tries))


def _refuse_apart(limits: Limits, cosine: float) -> None:
    """The mean of W_k round a gear is cos(alpha) times the mean of E_s, whatever its pitch: limits
    apart pass no gear."""
    low = max(limits.E_sni, limits.W_kni / cosine)
    high = min(limits.E_sns, limits.W_kns / cosine)
    if low > high + SUM_ROUNDING:
        raise NoGearPassesError(
            f"no gear passes: E_s from {limits.E_sni / UM:.2f} to {limits.E_sns / UM:.2f} um means "
            f"W_k from "
            f"{limits.E_sni * cosine / UM:.2f} to {limits.E_sns * cosine / UM:.2f} um on average, "
            f"but its limits are "
            f"{limits.W_kni / UM:.2f} to {limits.W_kns / UM:.2f} um; ranges that overlap would do"
        )


def _gear_message(gear: Gear, limits: Limits, lack: float, tries: int) -> str:
    return (
        f"none of {tries} gears drawn with z = {gear.z}, f_pT = {limits.f_pT / UM:.2f} um and "
        f"F_pT = "
        f"{limits.F_pT / UM:.2f} um keeps E_s from {limits.E_sni / UM:.2f} to "
        f"{limits.E_sns / UM:.2f} um and W_k (over "
        f"{gear.k_span} teeth) from {limits.W_kni / UM:.2f} to {limits.W_kns / UM:.2f} um; the "
        f"best lacked "
        f"{lack / UM:.2f} um of width. E_s limits 2 F_pT = {2 * limits.F_pT / UM:.2f} um apart, "
        f"with W_k limits cos(alpha) "
        "times as far apart, or a smaller F_p would do"
    )


def _graded(
    gear: Gear,
    limits: Limits,
    x: FloatArray,
    drive: IntArray,
    coast: IntArray,
    rng: np.random.Generator,
) -> tuple[FloatArray | None, float]:
    """Coast flanks (z,) as arcs in mm with their own pitch, or None and the width in mm that the
    thickness limits lack."""
    cosine = math.cos(gear.alpha)
    y = closed_chain(gear.z, f=limits.f_pT, F=limits.F_pT, rng=rng)
    E, W = x + y, x[drive] + y[coast]
    low = max(limits.E_sni - float(np.min(E)), limits.W_kni / cosine - float(np.min(W)))
    high = min(limits.E_sns - float(np.max(E)), limits.W_kns / cosine - float(np.max(W)))
    if low > high + SUM_ROUNDING:
        return None, low - high
    return y + low + max(0.0, high - low) * rng.random(), 0.0


def _independent(
    gear: Gear,
    limits: Limits,
    x: FloatArray,
    drive: IntArray,
    coast: IntArray,
    rng: np.random.Generator,
) -> tuple[FloatArray | None, float]:
    """As ``_graded``, each tooth's thickness on its own: every span has its own coast flank, so
    drawing a tooth again until its W_k passes is drawing it where both limits hold."""
    cosine = math.cos(gear.alpha)
    shift = np.empty(gear.z)
    shift[coast] = x[coast] - x[drive]
    low = np.maximum(limits.E_sni, limits.W_kni / cosine + shift)
    high = np.minimum(limits.E_sns, limits.W_kns / cosine + shift)
    lack = float(np.max(low - high))
    if lack > SUM_ROUNDING:
        return None, lack
    return low + np.maximum(0.0, high - low) * rng.random(gear.z) - x, 0.0


def _passes(
    gear: Gear,
    limits: Limits,
    index: FloatArray,
    index_coast: FloatArray,
    which: Which,
    *,
    coast_graded: bool,
) -> bool:
    """Whether an inspector would pass pitch, thickness and base tangent lengths of the finished
    gear."""
    E_s = (index + index_coast) / math.cos(gear.alpha)
    W_k = base_tangent_deviations(gear, index=index, index_coast=index_coast, which=which)
    sides = (index, index_coast) if coast_graded else (index,)
    return (
        all(
            np.max(np.abs(single_pitch(side, alpha=gear.alpha))) <= limits.f_pT + SUM_ROUNDING
            and cumulative_pitch(side, alpha=gear.alpha) <= limits.F_pT + SUM_ROUNDING
            for side in sides
        )
        and bool(np.all((E_s >= limits.E_sni - SUM_ROUNDING) & (E_s <= limits.E_sns + SUM_ROUNDING)))
        and bool(np.all((W_k >= limits.W_kni - SUM_ROUNDING) & (W_k <= limits.W_kns + SUM_ROUNDING)))
    )


_Profiles = tuple[FloatArray, FloatArray, tuple[Shape, ...], tuple[Shape, ...]]


def _smooth(gear: Gear, limits: Limits, rng: np.random.Generator) -> _Profiles:
    waves = np.cos(np.pi * np.outer(np.arange(2, 2 + FORM_WAVES), _U))
    # Odd half waves have a slope of their own; it goes to the slope's account.
    lean = profile_deviations(_U, waves)[0]
    straight = waves - lean[:, None] * (_U - 0.5)
    slope, form = np.zeros((2, gear.z)), np.zeros((2, gear.z))
    a = np.zeros((2, gear.z, FORM_WAVES))
    for n, tooth in enumerate(rng.spawn(gear.z)):
        for side in range(2):
            for _ in range(MAX_FLANKS):
                s = tooth.uniform(-limits.f_HalphaT, limits.f_HalphaT)
                c = tooth.standard_normal(FORM_WAVES)
                c *= tooth.random() * limits.f_falphaT / np.ptp(c @ straight)
                trace = s * (_U - 0.5) + c @ straight
                if np.ptp(trace) <= limits.F_alphaT + SUM_ROUNDING:
                    break
            else:
                raise NoGearPassesError(
                    f"none of {MAX_FLANKS} profiles with f_HalphaT = {limits.f_HalphaT / UM:.2f} "
                    f"um and f_falphaT = "
                    f"{limits.f_falphaT / UM:.2f} um keeps F_alphaT = {limits.F_alphaT / UM:.2f} "
                    f"um; F_alphaT of "
                    f"{(limits.f_HalphaT + limits.f_falphaT) / UM:.2f} um always would do"
                )
            a[side, n] = c
            slope[side, n], form[side, n], _total = profile_deviations(_U, trace)
    shapes = [(Slope(read_only(slope[side] - a[side] @ lean)), FormDeviation(read_only(a[side]))) for side in range(2)]
    return slope, form, shapes[0], shapes[1]


def _scatter(gear: Gear, limits: Limits, rng: np.random.Generator, l: FloatArray) -> _Profiles:
    half = 0.5 * limits.F_alphaT
    d = np.stack([tooth.uniform(-half, half, (2, l.size)) for tooth in rng.spawn(gear.z)], axis=1)
    slope, form, _total = profile_deviations((l - l[0]) / (l[-1] - l[0]), d)
    grid = (read_only(l),) * gear.z
    drive, coast = (Scatter(grid, tuple(read_only(row) for row in side)) for side in d)
    return slope, form, (drive,), (coast,)
