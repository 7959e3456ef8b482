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
from gearpoly.gear.deviations import Deviations, Form, Scatter, Shape, Slope, pitch_and_thickness
from gearpoly.gear.gear import Gear
from gearpoly.gear.tolerances import Limits
from gearpoly.units import UM, FloatArray, IntArray, read_only

Which = Literal["driving", "driven"]

MAX_GEARS = 400
"""Gears drawn before the limits count as contradicting one another. Smaller refuses limits that a
few gears in a hundred keep; larger makes the refusal wait (0.1 s a gear at 200 teeth)."""
MAX_FLANKS = 1000
"""Profiles drawn for one flank before its profile limits count as contradicting one another."""
MAX_CHAINS = 200_000
"""Proposals for one chain of index deviations. The worst accepted rate in use is about 1 in
1000."""
SLACK = 1e-12
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


# Metrology: what an inspector would find. These know nothing of how the numbers were drawn.


def single_pitch(index: FloatArray, *, alpha: float) -> FloatArray:
    """Single pitch deviations f_p (z,) in mm of one side, arcs on the reference circle, tooth n to
    n + 1 and the last to 0.

    ``index`` (z,) normal index deviations in mm; an arc is its normal part / cos(alpha)
    (ISO 1328-1:2013, clause 3).
    """
    f_p: FloatArray = (np.roll(index, -1) - index) / math.cos(alpha)
    return f_p


def cumulative_pitch(index: FloatArray, *, alpha: float) -> float:
    """Total cumulative pitch deviation F_p in mm, the range of all index deviations as arcs (ISO
    1328-1:2013, clause 3)."""
    return float(np.ptp(index)) / math.cos(alpha)


def spans(gear: Gear, which: Which) -> tuple[IntArray, IntArray]:
    """Drive flank and coast flank (tooth numbers, each (z,)) between which the base tangent over k
    teeth is measured.

    The drive side is the counter-clockwise one on both gears, but the driving gear's teeth are
    numbered clockwise.
    """
    first = np.arange(gear.z)
    last = (first + gear.k_span - 1) % gear.z
    return (first, last) if which == "driving" else (last, first)


def base_tangent_deviations(gear: Gear, *, index: FloatArray, index_coast: FloatArray, which: Which) -> FloatArray:
    """Deviations (z,) in mm of the base tangent length W_k at every place round the gear.

    Both flanks are met along their normals, so their normal deviations ``index`` and
    ``index_coast`` (z,) in mm add up (derived here).
    """
    drive, coast = spans(gear, which)
    return index[drive] + index_coast[coast]


def profile_deviations(u: FloatArray, d: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Slope, form and total profile deviation (...) in mm of traces ``d`` (..., n) at places ``u``
    (n,) of the profile.

    Least-squares mean line over the active profile: its rise from 0 to 1, the range about it, and
    the range of all (ISO 1328-1:2013, clause 4).
    """
    # Trapezoids: points at any spacing, and none of the ends' double weight.
    share = np.concatenate(([0.0], np.diff(u))) + np.concatenate((np.diff(u), [0.0]))
    centred = u - np.sum(share * u) / np.sum(share)
    slope = d @ (share * centred) / np.sum(share * centred**2)
    rest = d - slope[..., None] * centred
    return slope, np.ptp(rest, axis=-1), np.ptp(d, axis=-1)


# Pitch: closed chains of index deviations.


def closed_chain(z: int, *, f: float, F: float, rng: np.random.Generator) -> FloatArray:
    """Index deviations (z,) in mm of one side, the first 0: uniform among all that keep both pitch
    limits and close.

    Steps are at most ``f`` (mm), also from the last tooth to the first, and the range is at most
    ``F`` (mm): independent uniform steps, given that they close and keep F. Loose limits are met by
    drawing again. Tight ones, which chance meets once in millions, by forward filtering and
    backward sampling in cells, with the place within each cell drawn last; what then breaks a limit
    is drawn again, so the cells leave no trace in the distribution (derived here).
    """
    f = min(f, F)
    if f <= 0.0:
        return np.zeros(z)
    # A closed chain ranges over 1.25 of this root on average; below it fewer than 1 in 50 fit.
    if min(f * math.sqrt(z / 3.0), f * (z // 2)) <= F:
        return _chain_by_rejection(z, f, F, rng)
    return _chain_in_corridor(z, f, F, rng)


def _chain_by_rejection(z: int, f: float, F: float, rng: np.random.Generator) -> FloatArray:
    rows = max(1, 20_000 // z)
    for _ in range(1 + MAX_CHAINS // rows):
        chains = np.zeros((rows, z))
        np.cumsum(rng.uniform(-f, f, (rows, z - 1)), axis=1, out=chains[:, 1:])
        good = (np.abs(chains[:, -1]) <= f) & (np.ptp(chains, axis=1) <= F)
        if np.any(good):
            first: FloatArray = chains[int(np.argmax(good))].copy()
            return first
    raise NoGearPassesError(_chain_message(z, f, F))


def _chain_message(z: int, f: float, F: float) -> str:
    return (
        f"no chain of {z} index deviations within f_pT = {f / UM:.3g} um and F_pT = {F / UM:.3g} "
        f"um was found; "
        f"a larger F_pT (or a smaller f_pT) would do"
    )


def _chain_in_corridor(z: int, f: float, F: float, rng: np.random.Generator) -> FloatArray:
    """The same distribution as by rejection, for tight F: a corridor a little wider than F, of
    cells of width f/K."""
    # The number of chains grows as exp(range / gap) near F; one gap wider accepts most.
    gap = min(0.5 * F, 3.0 * F**3 / (z * math.pi**2 * f**2))
    # K cells a step lose exp(-z/2K) of all draws; 8e6 cells in all (64 MB) bound the memory.
    K = math.ceil(min(max(z, 64), 8e6 * f / (z * F)))
    h = f / K
    N = math.ceil((F + gap) / h)
    slack = N * h - F
    centre = _forward(z, N, K, N // 2)[1]
    for _ in range(MAX_CHAINS):
        start = int(rng.integers(N))
        # Chains that start at the centre are the most: the count is log-concave and even.
        messages, ways = _forward(z, N, K, start)
        if rng.random() > math.exp(min(0.0, ways - centre)):
            continue
        cells = _backward(messages, K, start, rng)
        chain = (cells + rng.random(z)) * h
        # A chain wider than F goes; the others fit the corridor in (N h - range) places.
        if np.max(np.abs(np.roll(chain, -1) - chain)) > f or np.ptp(chain) > F:
            continue
        if rng.random() * (N * h - float(np.ptp(chain))) <= slack:
            index: FloatArray = chain - chain[0]
            return index
    raise NoGearPassesError(_chain_message(z, f, F))


def _forward(z: int, N: int, K: int, start: int) -> tuple[FloatArray, float]:
    """Weights (z, N) of reaching each cell from ``start`` by steps of at most K cells, each row of
    sum 1; and the log of the number of closed chains."""
    messages = np.zeros((z, N))
    messages[0, start] = 1.0
    low = np.maximum(np.arange(N) - K, 0)
    high = np.minimum(np.arange(N) + K + 1, N)
    total = np.zeros(N + 1)
    ways = 0.0
    for t in range(1, z):
        np.cumsum(messages[t - 1], out=total[1:])
        row = total[high] - total[low]
        size = float(np.sum(row))
        messages[t] = row / size
        ways += math.log(size)
    return messages, ways + math.log(float(np.sum(messages[-1, low[start] : high[start]])))


def _backward(messages: FloatArray, K: int, start: int, rng: np.random.Generator) -> IntArray:
    """One closed chain of cells (z,) drawn from the last to the first by its ``messages``."""
    z, N = (int(size) for size in messages.shape)
    cells = np.empty(z, dtype=np.int64)
    cells[0] = at = start
    pick = rng.random(z)
    for t in range(z - 1, 0, -1):
        low = max(at - K, 0)
        weights = np.cumsum(messages[t, low : min(at + K + 1, N)])
        mark = pick[t] * weights[-1]
        at = low + int(np.searchsorted(weights, mark, side="right"))
        cells[t] = at
    return cells


# The finished gear.


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

    Raises ``NoGearPassesError`` where ``MAX_GEARS`` gears all break a limit, and
    ``OutOfRangeError`` for "scatter" without ``roll_lengths``.
    """
    if profile_errors == "scatter" and (roll_lengths is None or roll_lengths.size < 2):
        raise OutOfRangeError('profile_errors = "scatter" has no points; roll_lengths of two or more would do')
    pitch_rng, coast_rng, profile_rng = rng.spawn(3)
    drive, coast = spans(gear, which)
    cosine = math.cos(gear.alpha)
    _refuse_apart(limits, cosine)
    place = _graded if thickness_errors == "graded" else _independent
    tightest, gears = math.inf, 0
    while gears < MAX_GEARS:
        gears += 1
        x = closed_chain(gear.z, f=limits.f_pT, F=limits.F_pT, rng=pitch_rng)
        y, lack = place(gear, limits, x, drive, coast, coast_rng)
        tightest = min(tightest, lack)
        if y is None:
            continue
        index, index_coast = x * cosine, y * cosine
        if _passes(gear, limits, index, index_coast, which, coast_graded=place is _graded):
            break
    else:
        raise NoGearPassesError(_gear_message(gear, limits, tightest))
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


def _refuse_apart(limits: Limits, cosine: float) -> None:
    """The mean of W_k round a gear is cos(alpha) times the mean of E_s, whatever its pitch: limits
    apart pass no gear."""
    low = max(limits.E_sni, limits.W_kni / cosine)
    high = min(limits.E_sns, limits.W_kns / cosine)
    if low > high + SLACK:
        raise NoGearPassesError(
            f"no gear passes: E_s from {limits.E_sni / UM:.2f} to {limits.E_sns / UM:.2f} um means "
            f"W_k from "
            f"{limits.E_sni * cosine / UM:.2f} to {limits.E_sns * cosine / UM:.2f} um on average, "
            f"but its limits are "
            f"{limits.W_kni / UM:.2f} to {limits.W_kns / UM:.2f} um; ranges that overlap would do"
        )


def _gear_message(gear: Gear, limits: Limits, lack: float) -> str:
    return (
        f"none of {MAX_GEARS} gears drawn with z = {gear.z}, f_pT = {limits.f_pT / UM:.2f} um and "
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
    if low > high + SLACK:
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
    if lack > SLACK:
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
            np.max(np.abs(single_pitch(side, alpha=gear.alpha))) <= limits.f_pT + SLACK
            and cumulative_pitch(side, alpha=gear.alpha) <= limits.F_pT + SLACK
            for side in sides
        )
        and bool(np.all((E_s >= limits.E_sni - SLACK) & (E_s <= limits.E_sns + SLACK)))
        and bool(np.all((W_k >= limits.W_kni - SLACK) & (W_k <= limits.W_kns + SLACK)))
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
                if np.ptp(trace) <= limits.F_alphaT + SLACK:
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
    shapes = [(Slope(read_only(slope[side] - a[side] @ lean)), Form(read_only(a[side]))) for side in range(2)]
    return slope, form, shapes[0], shapes[1]


def _scatter(gear: Gear, limits: Limits, rng: np.random.Generator, l: FloatArray) -> _Profiles:
    half = 0.5 * limits.F_alphaT
    d = np.stack([tooth.uniform(-half, half, (2, l.size)) for tooth in rng.spawn(gear.z)], axis=1)
    slope, form, _total = profile_deviations((l - l[0]) / (l[-1] - l[0]), d)
    grid = (read_only(l),) * gear.z
    drive, coast = (Scatter(grid, tuple(read_only(row) for row in side)) for side in d)
    return slope, form, (drive,), (coast,)
