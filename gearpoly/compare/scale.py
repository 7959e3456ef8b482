"""Recordings whose travels do not fit the tooth ratio, put right where their lines tell which reading is wrong."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from gearpoly.compare.among import shared_counts
from gearpoly.compare.even import even_rate
from gearpoly.compare.ratio import Explained, Travelled, decided, explanations, other_teeth
from gearpoly.compare.runaway import MATTERS, without_course
from gearpoly.errors import InputFileError
from gearpoly.mesh.pair import GearPair
from gearpoly.physics.parts import EncoderErrors
from gearpoly.recording.chain import loses_zero, with_own_zeros
from gearpoly.recording.clean import RATIO_LIMIT, TEETH_TOLERANCE, Cleaned, clean
from gearpoly.recording.recording import SHAFTS, Recording
from gearpoly.recording.rounding import reading_step
from gearpoly.recording.travel import nearest_teeth, whole_angles
from gearpoly.units import TURN, UM, FloatArray, IntArray

SWAPPED = (
    "want each angle under its own name: the columns of the two shafts are swapped; exchange driving_angle_deg and "
    "driven_angle_deg in the recording, or the two gears in the pair file"
)
"""What to do where the ratio of the travels is the inverse of the pair's."""

LEAST_ENCODER_RMS = 0.02 * UM
"""mm rms. What the simulation itself misses; a recording of less was made without encoders."""

ROUNDING_IN_LINES = 0.1
"""Part of what a recording differs by, rms, from which the rounding of even readings may make the lines that show."""

SAME_SCALE_SIGMAS = 5.0
"""Standard errors within which several recordings have one scale."""

COUNTS_OF_SOLD_ENCODERS = (
    1000, 1024, 2000, 2048, 2500, 3600, 4096, 5000, 4000, 500, 512, 360, 720, 400, 1800, 250, 256, 200, 100, 128,
)  # fmt: skip
"""Lines or counts per turn that encoders are sold with, the commonest first."""

LOG_STRONGER_MESH = math.log(4.0)
"""By how much stronger the mesh of one of several pairs has to be for the pair to be named: two lines that noise and
pitch errors have in common differ by as much in one case of six."""

TOOTH_PAIRS_NAMED = 3
"""Pairs of teeth that a message names."""


@dataclass(frozen=True, kw_only=True)
class Scale:
    """A reading that is ``value`` times the truth, with its standard error ``std``, of the encoder on the ``shaft``;
    ``by_recording`` where recordings differ (a coupling that slips), and the recordings ``of`` which it is.
    ``log_odds`` over the next best explanation, ``says`` the finding in words."""

    shaft: str
    value: float
    std: float
    by_recording: tuple[float, ...]
    of: tuple[int, ...]
    log_odds: float
    says: str


def put_right(
    recordings: Sequence[Recording], pair: GearPair, encoders: tuple[EncoderErrors, EncoderErrors]
) -> tuple[list[Recording], Scale | None]:
    """The recordings with a wrong scale of one reading taken out, and what it was; as they are, and None, where travels
    fit the pair or nothing tells which reading is wrong. ``encoders``: what was declared and taken out before.

    Raises ``InputFileError`` where the lines are those of another pair of teeth, or the ratio is another pair's by more
    than ``RATIO_LIMIT`` and no lines tell.
    """
    recordings = [without_course(recording, pair) for recording in recordings]
    z_1, z_2 = pair.driving.gear.z, pair.driven.gear.z
    found = {k: one for k, r in enumerate(recordings) if (one := _travelled(r, pair)) is not None}
    if not found:
        shafts = [name for name, one in zip(("driving", "driven"), encoders, strict=True) if loses_zero(one.scale)]
        if shafts and not _one_count(recordings):
            return with_own_zeros(recordings, shafts[0], ratio=pair.ratio), None
        return list(recordings), None
    these = list(found.values())
    first = recordings[next(iter(found))]
    ratio = these[0].ratio
    if abs(ratio * pair.ratio - 1.0) <= TEETH_TOLERANCE < abs(ratio / pair.ratio - 1.0):
        raise InputFileError(first.source, found=_off(ratio, pair) + ", which is its inverse", wish=SWAPPED)
    told = explanations(these, z_1=z_1, z_2=z_2)
    best = decided(told)
    if best is None:
        if abs(ratio / pair.ratio - 1.0) > RATIO_LIMIT:
            nearest = nearest_teeth(ratio, 10.0 * TEETH_TOLERANCE)
            named = f"; the nearest tooth ratio is {nearest.numerator}/{nearest.denominator}"
            raise InputFileError(first.source, found=_off(ratio, pair) + named, wish=_open(told, ratio, z_1))
        return list(recordings), None
    if best.teeth is not None:
        raise InputFileError(first.source, found=_off(ratio, pair), wish=_another(told))
    scale = _scale(best, told, {k: _refined(recordings[k], best.shaft, one, pair) for k, one in found.items()}, pair)
    return _taken_out(recordings, scale, pair), scale


def _one_count(recordings: Sequence[Recording]) -> bool:
    """Whether all recordings go by one count of turns."""
    counts = set(shared_counts(recordings))
    return len(recordings) == 1 or (len(counts) == 1 and counts != {-1})


def _travelled(recording: Recording, pair: GearPair) -> Travelled | None:
    """The ratio of the travels of a recording of which both angles were read; None where it fits the pair."""
    both = whole_angles(recording)
    if both is None:
        return None
    rows, theta_1, theta_2, rough = both
    meshes = abs(float(theta_1[-1] - theta_1[0])) / TURN * pair.driving.gear.z
    if not rough > 0.0 or abs(rough / pair.ratio - 1.0) * meshes < MATTERS:
        return None
    factor = rough / pair.ratio
    whole = _spread(recording, rows, theta_1 * factor), _spread(recording, rows, theta_2)
    cleaned = clean(_with(recording, *whole), ratio=pair.ratio, r_b2=pair.r_b2)
    ratio, std = (pair.ratio + cleaned.ratio_offset) * factor, cleaned.ratio_offset_std * factor
    if abs(ratio / pair.ratio - 1.0) <= SAME_SCALE_SIGMAS * std / pair.ratio:
        return None
    if _is_rounding(cleaned, pair.r_b2):
        return None
    return Travelled(cleaned=cleaned, factor=factor, ratio=ratio, std=std)


def _is_rounding(cleaned: Cleaned, r_b2: float) -> bool:
    """Whether the lines of a recording may be those of its rounding, which in even samples stand at whole orders
    too: it is a good part of what is recorded, or that is less than any encoder reads (``LEAST_ENCODER_RMS``)."""
    angles = cleaned.theta_1, cleaned.theta_2
    steps = [reading_step(angle) or 0.0 for angle in angles]
    error = math.hypot(cleaned.ratio * steps[0], steps[1]) / math.sqrt(12.0)
    left = float(np.std(cleaned.te - cleaned.ratio_offset * cleaned.theta_1))
    if left * r_b2 < LEAST_ENCODER_RMS:
        return True
    if error < ROUNDING_IN_LINES * left:
        return False
    return any(
        even_rate(angle, rounding=step / math.sqrt(12.0)) is not None for angle, step in zip(angles, steps, strict=True)
    )


def _spread(recording: Recording, rows: IntArray, angle: FloatArray) -> FloatArray:
    """A forward angle (m,) at its ``rows`` among the samples (n,), nan elsewhere."""
    out = np.full(recording.size, np.nan)
    out[rows] = angle
    return out


def _with(recording: Recording, driving: FloatArray, driven: FloatArray) -> Recording:
    """The recording with continuous angles (n,) in rad, counted forward."""
    return replace(
        recording, driving_angle_rad=driving, driven_angle_rad=driven, driving_direction=1, driven_direction=1,
        driving_zero_rad=None, driven_zero_rad=None,
    )  # fmt: skip


def _refined(recording: Recording, shaft: str, one: Travelled, pair: GearPair) -> Travelled:
    """The travels once more, with the first orders of both shafts where they truly are."""
    wrong = pair.ratio / one.ratio if shaft == "driving" else one.ratio / pair.ratio
    again = clean(_divided(recording, shaft, wrong), ratio=pair.ratio, r_b2=pair.r_b2)
    more = 1.0 + again.ratio_offset / pair.ratio
    return replace(one, ratio=one.ratio * more, std=again.ratio_offset_std * one.ratio / pair.ratio)


def _scale(best: Explained, told: Sequence[Explained], found: dict[int, Travelled], pair: GearPair) -> Scale:
    """The scale that the recordings have in common, or those that they have."""
    driving = best.shaft == "driving"
    each = {k: pair.ratio / one.ratio if driving else one.ratio / pair.ratio for k, one in found.items()}
    errors = {k: each[k] * one.std / one.ratio for k, one in found.items()}
    value = float(np.average(list(each.values()), weights=[errors[k] ** -2 for k in each]))
    std = 1.0 / math.sqrt(sum(error**-2 for error in errors.values()))
    alike = all(abs(each[k] - value) <= SAME_SCALE_SIGMAS * errors[k] for k in each)
    if not alike:
        std = float(np.std(list(each.values())))
    ratio = next(iter(found.values())).ratio
    return Scale(
        shaft=best.shaft,
        value=value,
        std=std,
        by_recording=() if alike else tuple(each.values()),
        of=tuple(each),
        log_odds=best.log_odds - max((one.log_odds for one in told if one is not best), default=-math.inf),
        says=_says(best.shaft, value, std, ratio, pair, slips=not alike),
    )


def _taken_out(recordings: Sequence[Recording], scale: Scale, pair: GearPair) -> list[Recording]:
    """The recordings as a true encoder would have made them. Where each began its count by itself a wrong count has no
    common zero, so only the transmission error is left of it."""
    values = dict(zip(scale.of, scale.by_recording or (scale.value,) * len(scale.of), strict=True))
    out = [_divided(one, scale.shaft, values[k]) if k in values else one for k, one in enumerate(recordings)]
    if _one_count(recordings) and not scale.by_recording:
        return out
    return with_own_zeros(out, scale.shaft, ratio=pair.ratio)


def _divided(recording: Recording, shaft: str, scale: float) -> Recording:
    """The recording with continuous angles, that of the ``shaft`` by a true scale, and no zero of it that is none."""
    both = whole_angles(recording)
    if both is None:
        return recording
    rows, *angles, _ = both
    ways = recording.driving_direction, recording.driven_direction
    parts = {name: 1.0 / scale if name == shaft else 1.0 for name in SHAFTS}
    changes: dict[str, Any] = {
        f"{name}_angle_rad": _spread(recording, rows, way * parts[name] * angle)
        for name, way, angle in zip(SHAFTS, ways, angles, strict=True)
    }
    if loses_zero(scale):
        changes[f"{shaft}_zero_rad"] = None
    return replace(recording, **changes)


def counts_for(scale: float, std: float) -> tuple[int, int] | None:
    """Counts per turn, the true ones and those that were set, of common encoders that make a ``scale`` of reading over
    truth within its error; None where no two do."""
    within = max(SAME_SCALE_SIGMAS * std, 1e-5)
    pairs = [
        (a, b)
        for a in COUNTS_OF_SOLD_ENCODERS
        for b in COUNTS_OF_SOLD_ENCODERS
        if a != b and abs(b * scale / a - 1.0) <= within
    ]
    return min(
        pairs,
        key=lambda both: COUNTS_OF_SOLD_ENCODERS.index(both[0]) + COUNTS_OF_SOLD_ENCODERS.index(both[1]),
        default=None,
    )


def _off(ratio: float, pair: GearPair) -> str:
    return (
        f"a ratio of {ratio:.7g} (driven to driving travel), {ratio / pair.ratio - 1.0:+.3%} off "
        f"the pair's {pair.ratio:.7g}"
    )


def _says(shaft: str, value: float, std: float, ratio: float, pair: GearPair, *, slips: bool) -> str:
    """What was found, in words."""
    counts = counts_for(value, std)
    likely = "" if counts is None or slips else f" (as {counts[0]} counts per turn taken for {counts[1]} make)"
    what = (
        "a coupling there slips, by another part in each recording"
        if slips
        else f"counts per turn are set wrong there{likely}, or a coupling slips"
    )
    return (
        f"{_off(ratio, pair)}: the orders at which the teeth show say that the {shaft} shaft reads "
        f"{value:.7g} +- {std:.1g} times what it turns; {what}; taken out"
    )


def _open(told: Sequence[Explained], ratio: float, z_1: int) -> str:
    """What would explain a ratio where nothing in the recording tells which it is; of other teeth those are named that
    are nearest the ``z_1`` declared ones."""
    scales = " or ".join(f"the {one.shaft} shaft reads {one.scale:.6g} times its turns" for one in told if one.shaft)
    teeth = [f"{a}/{b}" for a, b in sorted(other_teeth(ratio, 1e-4), key=lambda z: abs(z[0] - z_1))[:TOOTH_PAIRS_NAMED]]
    pairs = f", or the teeth are {' or '.join(teeth)}" if teeth else ""
    return (
        f"want a recording of this pair, with the right counts per turn of both encoders: no order of the teeth shows "
        f"whether {scales}{pairs}; state which under [driving.encoder] or [driven.encoder], scale"
    )


def _another(told: Sequence[Explained]) -> str:
    """What pairs the lines are of."""
    others = [one for one in told if one.teeth is not None]
    first, *more = sorted(others, key=lambda one: -one.mesh)
    least = min(others, key=lambda one: one.teeth or (0, 0)).teeth or (0, 0)
    a, b = first.teeth or (0, 0)
    ratio = Fraction(*least)
    clearly = not more or first.mesh - more[0].mesh > LOG_STRONGER_MESH
    names = f"{a} on {b} teeth" if clearly else f"{ratio.numerator} on {ratio.denominator} teeth or a multiple"
    return (
        f"want a recording of this pair: the orders at which teeth show in this one are those of {names}, with both "
        "encoders right; correct teeth in the pair file if that is the pair"
    )
