"""A clock that was set while it was read: its time jumps, and the shafts turn on as if nothing had been.

Derived here. Local time goes back or forward by an hour (on Lord Howe Island by half of one), and a computer sets its
clock by another's at any moment. If so the shafts turn from the sample before the jump to the one behind it by as much
as from any other to the next. In a real pause they would have turned by many steps, or slowed down before it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.recording.finite import all_finite, steps_between
from gearpoly.recording.from_time import is_from_time
from gearpoly.recording.map_lines import entry, with_more
from gearpoly.recording.recording import ANGLE_COLUMNS, SHAFTS
from gearpoly.recording.table import Doubt, Table
from gearpoly.recording.unwrapping import GAP_STEPS, WRAPPED_SPAN, thinned
from gearpoly.units import BoolArray, FloatArray, IntArray

HALF_HOUR_S = 1800.0

CLOCK_JUMP_STEPS = 20.0
"""Usual steps that a jump is larger than: computers stamp single samples late by some, and catch up with the next."""

JUMP_LEAST_S = 1.0
"""Least jump forward in s: computers are busy for less, and their own clocks set themselves by a few ms at a time."""

USUAL_MOST_S = 60.0
"""Usual step above which a jump by an hour is no more than a few samples that are missing."""

STEPS_BESIDE_JUMP = 16
"""Steps on either side by which the course of a shaft is told."""

FEWEST_STEPS_BESIDE_JUMP = 4
"""The same at least: a recording may end soon behind a jump."""

SPEED_CHANGE_AT_JUMP = 0.25
"""Part by which a shaft may be faster on one side of a jump than on the other: one that stops in a pause slows down
to nothing before it, and takes longer than a sample for that."""

LATE_S = 60.0
"""Time that may be missing beside a whole half hour, and still be samples that were lost while the clock was set."""

OFF_COURSE_PART = 0.1
"""Part of the way over lost samples by which a shaft may be off its steady course."""

CHANCE_WRAPPED_GOES_ON = 0.01
"""Chance that wrapped readings go on so after a real pause, up to which a jump is told at all: both shafts at 3 deg a
sample meet by chance in 10^-3, one of them alone in a fortieth."""

JUMPS_MOST = 100
"""Jumps above which a clock is none that was set now and then."""

JUMPS_TAKEN_OUT, JUMPS_KEPT = "taken out", "kept"
"""What a map may say of jumps of the time."""

JUMPS_OUT = f'jumps = "{JUMPS_TAKEN_OUT}"'
"""The same in the line that cures a jump."""

CAUGHT_UP = 0.5
"""Part of the usual time that the samples behind a jump take at least, unless they only catch up with it."""


@dataclass(frozen=True, kw_only=True)
class ClockJump:
    """A jump of the clock before the ``row`` (from 1), ``by`` s; ``step`` s is what went by from the row above.
    ``certain``: nothing but a clock that was set does so."""

    row: int
    by: float
    step: float
    certain: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class _Course:
    """Readings (m,) of a shaft, and the ``turn`` at which they begin again (infinite: never)."""

    readings: FloatArray
    turn: float

    def across(self, k: int, samples: float) -> float | None:
        """The chance that readings go on so by accident over the step behind sample ``k``, in which the shaft would
        turn as in so many usual ``samples`` (``nan``: in one to three of them); ``None`` where they do not go on."""
        low, high = max(0, k - STEPS_BESIDE_JUMP), min(self.readings.size, k + 2 + STEPS_BESIDE_JUMP)
        before, after = (self._steps(self.readings[a:b]) for a, b in ((low, k + 1), (k + 1, high)))
        if min(before.size, after.size) < FEWEST_STEPS_BESIDE_JUMP:
            return None
        speeds = float(np.mean(before)), float(np.mean(after))
        usual = 0.5 * sum(speeds)
        if usual == 0.0 or abs(speeds[0] - speeds[1]) > SPEED_CHANGE_AT_JUMP * abs(usual):
            return None
        scatter = float(np.max(np.abs(np.concatenate([before, after]) - usual)))
        room = max(0.5 * abs(usual), scatter)
        nearest, farthest = (usual, GAP_STEPS * usual) if math.isnan(samples) else (usual * samples,) * 2
        room += OFF_COURSE_PART * abs(farthest) if not math.isnan(samples) else 0.0
        middle, reach = 0.5 * (nearest + farthest), 0.5 * abs(farthest - nearest) + room
        step = float(self.readings[k + 1] - self.readings[k])
        off = step - middle if math.isinf(self.turn) else math.remainder(step - middle, self.turn)
        if abs(off) > reach:
            return None
        return 0.0 if math.isinf(self.turn) else min(1.0, 2.0 * reach / self.turn)

    def _steps(self, readings: FloatArray) -> FloatArray:
        steps = np.diff(readings)
        return steps if math.isinf(self.turn) else steps - self.turn * np.rint(steps / self.turn)


USUAL_OF = 10_000
"""Steps that the usual one is told from, all along the recording: the nearest thing that it is held against is three
times as long."""


@np.errstate(over="ignore", invalid="ignore")  # a damaged file may hold anything
def clock_jumps(time: FloatArray, shafts: Sequence[FloatArray]) -> list[ClockJump]:
    """The jumps of a clock with ``time`` (n,) in s, by the readings (n,) of ``shafts`` in deg or counts, which turn on
    without a gap there."""
    held = time
    rows: IntArray | None = None
    if not all_finite(time):
        rows = np.flatnonzero(np.isfinite(time))
        held = time[rows]
    if held.size < 2 * FEWEST_STEPS_BESIDE_JUMP + 2 or not shafts:
        return []
    every = max(1, held.size // USUAL_OF)
    rising = held[1::every] - held[:-1:every]
    rising = rising[rising > 0.0]
    if 2 * rising.size < FEWEST_STEPS_BESIDE_JUMP:
        return []
    usual = float(np.median(rising))
    least = max(CLOCK_JUMP_STEPS * usual, JUMP_LEAST_S)
    if usual > USUAL_MOST_S:
        return []
    back, on = steps_between(held)
    if on <= least and back >= -GAP_STEPS * usual:
        return []  # the commonest case
    steps = np.diff(held)
    at = np.flatnonzero((steps > least) | (steps < -GAP_STEPS * usual))
    if at.size > JUMPS_MOST or at.size > held.size // STEPS_BESIDE_JUMP:
        return []
    read: BoolArray = np.logical_and.reduce([np.isfinite(one) for one in shafts]) & np.isfinite(time)
    number = np.flatnonzero(read)
    if not number.size:
        return []
    courses = [_course(one[number]) for one in shafts]
    mean = _per_sample(steps, at)
    if not mean > 0.0:
        return []
    out = []
    for k in at.tolist():
        beside = np.concatenate([steps[max(0, k - STEPS_BESIDE_JUMP) : k], steps[k + 1 : k + 1 + STEPS_BESIDE_JUMP]])
        samples = float(np.median(beside)) or mean  # of a shaft that runs up pulses come later and later
        if abs(steps[k]) <= CLOCK_JUMP_STEPS * samples and steps[k] > 0.0:
            continue
        row = k if rows is None else int(rows[k])
        place = int(np.searchsorted(number, row))
        if place + 1 >= number.size or number[place] != row:
            continue
        many = min(held.size - 2 - k, max(STEPS_BESIDE_JUMP, math.ceil(2.0 * usual / samples)))
        if many and held[k + 1 + many] - held[k + 1] < CAUGHT_UP * many * samples:
            continue
        behind = k + 1 if rows is None else int(rows[k + 1])
        if number[place + 1] == behind:
            found = _jump(float(steps[k]), courses, place, usual, samples)
            if found is not None:
                out.append(ClockJump(row=behind + 1, by=found[0], step=found[1], certain=found[2]))
    return out


def _per_sample(steps: FloatArray, at: IntArray) -> float:
    """Time from sample to sample away from jumps; the mean one where stamps are rounded so that most repeat."""
    plain = np.delete(steps, at)
    usual = float(np.median(thinned(plain)))
    return usual if usual > 0.0 else float(np.mean(plain))


def _jump(
    step: float, courses: Sequence[_Course], place: int, usual: float, sample: float
) -> tuple[float, float, bool] | None:
    """By how many s a clock jumped in a ``step`` in s, what it is without that, and whether that is certain; ``None``
    where it was none."""
    hours = HALF_HOUR_S * round(step / HALF_HOUR_S)
    rest = step - hours
    if hours and -usual <= rest <= LATE_S + GAP_STEPS * usual:
        lost = rest / sample
        # Stamps in whole seconds leave it open which of the samples in a second these are.
        lost = lost if rest > GAP_STEPS * usual else math.nan
        across = [one.across(place, lost) for one in courses]
        chances = [one for one in across if one is not None]
        if len(chances) == len(courses):
            left = rest if rest > 0.0 else sample
            # That it is a half hour to a minute is a chance of a thirtieth of its own.
            return step - left, left, math.prod(chances) <= CHANCE_WRAPPED_GOES_ON * HALF_HOUR_S / LATE_S
    across = [one.across(place, math.nan) for one in courses]
    chances = [one for one in across if one is not None]
    if len(chances) < len(courses) or (step > 0.0 and math.prod(chances) > CHANCE_WRAPPED_GOES_ON):
        return None
    return step - sample, sample, step < 0.0 and math.prod(chances) <= CHANCE_WRAPPED_GOES_ON


def _course(readings: FloatArray) -> _Course:
    low, high = np.quantile(thinned(readings), [0.005, 0.995])
    return _Course(readings=readings, turn=360.0 if high - low <= WRAPPED_SPAN * 360.0 else math.inf)


def on_one_clock(table: Table) -> list[Doubt]:
    """Take jumps of the clock out of a ``table``'s time, with a remark; the doubts about those that may be none. One
    that goes back and may be none stays."""
    time = table.columns.get("time_s")
    if time is None or table.jumps == JUMPS_KEPT:
        return []
    shafts = [column for shaft, angle in zip(SHAFTS, ANGLE_COLUMNS, strict=True)
              if (column := table.columns.get(angle, table.columns.get(f"{shaft}_count"))) is not None]  # fmt: skip
    if any(one.size != time.size for one in shafts) or not time.size:
        return []
    found = clock_jumps(time, shafts)
    if found and len(shafts) == 1 and is_from_time(time, shafts[0]):
        return []  # such an angle is as wrong as the time
    sure = [one for one in found if one.certain or table.jumps == JUMPS_TAKEN_OUT]
    # Readings that turn on across a leap do so whatever the clock did: as a gap it would be given turns of its own.
    leaps = [one for one in found if one not in sure and one.by > 0.0]
    back = [one for one in found if one not in sure and one.by < 0.0]
    table.columns["time_s"] = time_without(time, [*sure, *leaps]) if sure or leaps else time
    if sure:
        why = "as the map says" if table.jumps else 'which jumps = "kept" for time_s in a map undoes'
        summer = " (summer time?)" if all(one.by % HALF_HOUR_S == 0.0 for one in sure) else ""
        table.remarks.append(f"{_says(sure)}: the clock was set{summer}, and that is taken out, {why}")
    out = with_more(table.entries.get("time_s") or entry("time_s", "time_s", None), JUMPS_OUT)
    asked = (out, f"or {out.replace(JUMPS_OUT, JUMPS_OUT.replace(JUMPS_TAKEN_OUT, JUMPS_KEPT))}")
    doubts = []
    if leaps:
        says = f"{_says(leaps)}: the clock was set, or the logger and its counters paused; taken out for the time being"
        doubts.append(Doubt(says=says, ask=asked))
    if back:
        says = f"{_says(back)}: the clock was set, unless wrapped readings meet by chance"
        doubts.append(Doubt(says=says, ask=asked[:1]))
    return doubts


def time_without(time: FloatArray, jumps: Iterable[ClockJump]) -> FloatArray:
    """The time (n,) in s without ``jumps``."""
    out = time.copy()
    for one in jumps:
        out[one.row - 1 :] -= one.by
    return out


SAID = 3
"""Jumps that are said one by one."""


def _says(jumps: Sequence[ClockJump]) -> str:
    each = " and ".join(f"by {_size(one.by)} before row {one.row}" for one in jumps[:SAID])
    more = f" and {len(jumps) - SAID} times more" if len(jumps) > SAID else ""
    return f"the time jumps {each}{more}, while the shafts turn on without a gap"


def _size(by: float) -> str:
    hours = by / (2.0 * HALF_HOUR_S)
    return f"{hours:+g} h" if (2.0 * hours).is_integer() else f"{by:+.6g} s"
