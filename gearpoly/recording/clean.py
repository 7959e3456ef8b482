"""A recording made ready for comparison: only what is meant is put right, and all of it is counted.

Wraps, directions and stated zeros are undone; drop-outs, single spikes and the start and stop ramps are left out, never
filled in. A ratio that is off by a constant is measured and told. Nothing is filtered, resampled or smoothed: every
value that comes out was recorded.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearpoly.errors import InputFileError, told_at_most, told_beside
from gearpoly.recording.by_travel import check_units_by_travel
from gearpoly.recording.deeds import Deed, note, so_many
from gearpoly.recording.looks_like import COMES_BACK
from gearpoly.recording.recording import Recording
from gearpoly.recording.repeats import new_readings
from gearpoly.recording.reversals import backward_limit
from gearpoly.recording.rows import check_time, first_row, row_of
from gearpoly.recording.spikes import single_spikes
from gearpoly.recording.stated_twice import check_error, check_errors
from gearpoly.recording.steady import RAMP_SHARE, steady
from gearpoly.recording.travel import nearest_teeth, slope
from gearpoly.recording.unwrapping import Continuous, continuous, settle_gaps
from gearpoly.units import DEG, TURN, BoolArray, FloatArray, IntArray, read_only

RATIO_LIMIT = 0.03
"""Relative error of the ratio from which it is another pair's recording, not a wrong encoder count or slip. One tooth
more or less in 30 is as much.
"""
OFFSET_SIGMAS = 5.0
"""Standard errors from which a ratio is told to be off; with a dozen stretches behind the error chance is 4 in 10^4."""
TEETH_TOLERANCE = 1e-4
"""Relative uncertainty of a measured ratio at least, when teeth are named: encoder errors over a few turns."""
STOPS_NAMED = 3
"""Stops whose rows are told; the rest is counted."""
LEAST_DRIVING_TURNS = 1.0
"""Driving turns that must be left: of less not even every driving tooth was in mesh. Nothing repeats before the second
turn, so hardly anything is named, but lines are located: half a hunting cycle of 20/30 or 24/36 teeth is one and a half
turns. Of 40 recordings of the bench, cut to 1.2 turns, none was given a false name."""

AGAIN = 2.0
"""Driving turns from which all that the driving shaft does has come twice."""


class TooShortError(InputFileError):
    """Too little of a recording is left to be compared."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cleaned:
    """The samples of a recording that can be compared with a simulation, in the order of their angles.

    That is the recording's own order; one of a pair that ran backwards comes last first, and its time counts back.

    ``theta_1``, ``theta_2`` (N,): rotations in rad, continuous and forward positive; the stated zero is subtracted,
    and where none is stated they are the encoder's readings. Both are known only up to whole turns. ``te`` (N,) in rad
    is ``theta_2 - ratio * theta_1``, or the recorded transmission error. ``time_s`` (N,) in s, ``torque_nm`` (N,) in
    N.m and ``speed_rpm`` (N,) in rpm per sample, where recorded; torque and speed may hold ``nan``. ``keep`` (N,) are
    the samples' numbers in the recording, from 0.

    ``ratio`` is z_1/z_2. ``ratio_offset`` is the slope of the transmission error, (measured ratio) - ``ratio``, with
    its standard error ``ratio_offset_std``; ``ratio_is_off`` says that it is significant. ``done`` lists what was done.
    ``doubt`` is the rms in rad of ``te`` to which readings are known that lie between an encoder's own.
    """

    recording: Recording
    theta_1: FloatArray
    theta_2: FloatArray
    te: FloatArray
    time_s: FloatArray | None
    torque_nm: FloatArray | None
    speed_rpm: FloatArray | None
    keep: npt.NDArray[np.int64]
    ratio: float
    ratio_offset: float
    ratio_offset_std: float
    done: tuple[Deed, ...]
    doubt: float = 0.0

    def __post_init__(self) -> None:
        for name in ("theta_1", "theta_2", "te", "time_s", "torque_nm", "speed_rpm"):
            value = getattr(self, name)
            object.__setattr__(self, name, None if value is None else read_only(value))
        keep = np.array(self.keep, dtype=np.int64)
        keep.setflags(write=False)
        object.__setattr__(self, "keep", keep)

    @property
    def size(self) -> int:
        """Number of samples left."""
        return self.te.size

    @property
    def backward(self) -> bool:
        """Whether the pair ran backwards."""
        return self.recording.backward

    @property
    def ratio_is_off(self) -> bool:
        """Whether the travels contradict the tooth ratio: encoder count, slip, or a slow drift."""
        return abs(self.ratio_offset) > OFFSET_SIGMAS * self.ratio_offset_std


def clean(recording: Recording, *, ratio: float | None, r_b2: float | None = None) -> Cleaned:
    """Make a recording ready for comparison.

    ``ratio`` is z_1/z_2; None takes that of the travels, where no pair is known. ``r_b2``, the driven base radius in
    mm, is needed where the transmission error was recorded along the line of action. Raises ``InputFileError``, with
    the row (from 1), where a shaft runs backwards, the ratio is another pair's, or less than one driving turn is left;
    ``ValueError`` where ``r_b2`` is missing.
    """
    done: list[Deed] = []
    te = recording.te_in_rad(r_b2)
    if r_b2 is not None:
        check_errors(recording, r_b2)
    readings = {"driving": recording.driving_angle_rad, "driven": recording.driven_angle_rad}
    good = np.ones(recording.size, dtype=np.bool_)
    for values in (*readings.values(), te, recording.time_s):
        if values is not None:
            good &= np.isfinite(values)
    if not good.all():
        gaps = int(np.sum(good[:-1] & ~good[1:])) + int(not good[0])
        note(done, "drop-outs", int(np.sum(~good)), f"samples without a reading, in {so_many(gaps, 'gaps')}, left out")
    keep, time_s = np.flatnonzero(good), recording.time_s
    position = keep.astype(np.float64) if time_s is None else time_s[keep]
    if time_s is not None:
        check_time(recording, keep, position)
    new = new_readings(keep, readings, position, done)
    keep, number, position, read = new.keep, new.number, new.position, new.readings
    if keep.size < 8:
        raise _too_short(recording, f"{keep.size} samples without drop-outs or repeats")
    if time_s is not None and 2 * np.count_nonzero(np.diff(time_s[keep]) == 0.0) > keep.size:
        note(done, "clock", keep.size, "samples on a clock that is coarser than the samples; times not used")
        time_s, position = None, keep.astype(np.float64)
    back = recording.backward
    if back:
        keep, number, position = keep[::-1], number[::-1], -position[::-1]
        read = {shaft: values[::-1] for shaft, values in read.items()}
        note(done, "reversed", keep.size, "samples of a pair that ran backwards, taken from the last to the first")
    shafts = {shaft: _continuous(recording, shaft, values, position, number, done) for shaft, values in read.items()}
    _check_direction(recording, shafts)
    ratio = _travelled(shafts) if ratio is None else ratio
    theta_1, theta_2, te = _rotations(recording, shafts, None if te is None else te[keep], keep, ratio, r_b2, done)

    spikes = single_spikes(te, theta_1, theta_2)
    if len(shafts) == 1:  # then a wild reading does not show in the recorded transmission error
        spikes |= single_spikes(next(iter(shafts.values())).angle, moving=True)
    note(done, "spikes", int(spikes.sum()), "single samples far off their neighbours that never return, left out")
    left = np.flatnonzero(~spikes)
    keep, position = keep[left], position[left]
    theta_1, theta_2, te = theta_1[left], theta_2[left], te[left]

    begin, end, stops = steady(theta_1, position)
    ramps = ("stop ramp", "start ramp") if back else ("start ramp", "stop ramp")
    for what, count in zip(ramps, (begin, keep.size - end), strict=True):
        note(done, what, count, f"samples below {RAMP_SHARE:.0%} of the usual speed, left out")
    _note_stops(recording, keep, stops, done)
    left = begin + np.flatnonzero(~stops[begin:end])
    keep, position, theta_1, theta_2, te = keep[left], position[left], theta_1[left], theta_2[left], te[left]
    turns = (theta_1[-1] - theta_1[0]) / TURN if keep.size else 0.0
    if turns < LEAST_DRIVING_TURNS:
        raise _too_short(recording, f"{told_beside(turns, LEAST_DRIVING_TURNS, 2)} driving turns")
    if turns < AGAIN:
        says = f"{told_beside(turns, AGAIN, 2)} driving turns{_in_rad(recording)}: nothing of the driving shaft has "
        done.append(Deed("short", 0, f"{says}come a second time"))
    for shaft, angle in (("driving", theta_1), ("driven", theta_2)):
        if shaft in shafts:
            _check_forward(recording, shaft, angle, keep, done)

    value, error = slope(theta_1, theta_2, te)
    _judge_ratio(recording, ratio, value, error, done)

    def kept(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else values[keep]

    return Cleaned(
        recording=recording,
        theta_1=theta_1,
        theta_2=theta_2,
        te=te,
        time_s=None if time_s is None else position,
        torque_nm=kept(recording.torque_samples_nm),
        speed_rpm=kept(recording.speed_samples_rpm),
        keep=keep,
        ratio=ratio,
        ratio_offset=value,
        ratio_offset_std=error,
        done=tuple(done),
        doubt=max(new.doubt.get("driven", 0.0), ratio * new.doubt.get("driving", 0.0)),
    )


def _note_stops(recording: Recording, keep: IntArray, stops: BoolArray, done: list[Deed]) -> None:
    """Say which samples lie in stops between turns in one direction."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], stops, [False])))).reshape(-1, 2)
    if not edges.size:
        return
    ends = keep[edges - [0, 1]] + first_row(recording)
    places = [f"rows {min(a, b)} to {max(a, b)}" for a, b in ends[:STOPS_NAMED].tolist()]
    more = f" and {len(edges) - STOPS_NAMED} more" if len(edges) > STOPS_NAMED else ""
    what = "a stop" if len(edges) == 1 else f"{len(edges)} stops"
    says = f"samples of {what} in the middle left out, with the ramps: {', '.join(places)}{more}"
    note(done, "stops", int(np.count_nonzero(stops)), says)


def _too_short(recording: Recording, found: str) -> TooShortError:
    wish = (
        f"want at least {LEAST_DRIVING_TURNS:g} driving turn at speed, angles in deg{_in_rad(recording)}; record longer"
    )
    return TooShortError(recording.source, found=found, wish=wish)


def _in_rad(recording: Recording) -> str:
    """A word about angles that were written in rad and read as deg, where those would be turns enough, or the one that
    was said of their unit."""
    if said := next((one for one in recording.remarks if COMES_BACK in one), ""):
        return f" ({said})"
    angle = recording.driving_angle_rad if recording.driving_angle_rad is not None else recording.driven_angle_rad
    read = np.empty(0) if angle is None else angle[np.isfinite(angle)]
    turns = float(np.ptp(read)) / DEG / TURN if read.size else 0.0
    return f" (were they written in rad, it would be {turns:.3g} turns)" if turns >= AGAIN else ""


def _continuous(
    recording: Recording, shaft: str, reading: FloatArray, position: FloatArray, number: IntArray, done: list[Deed]
) -> Continuous:
    """One shaft's angle, forward positive and without wraps; its stated zero becomes 0."""
    direction = recording.driving_direction if shaft == "driving" else recording.driven_direction
    zero = recording.driving_zero_rad if shaft == "driving" else recording.driven_zero_rad
    one = continuous(direction * (reading - (zero or 0.0)), position, number)
    if direction < 0:
        note(done, f"{shaft} direction", reading.size, f"readings of the {shaft} shaft, which count down, reversed")
    note(done, f"{shaft} wraps", int(np.count_nonzero(one.wraps)), f"wraps of the {shaft} angle undone")
    return one


def _check_direction(recording: Recording, shafts: dict[str, Continuous]) -> None:
    """Raise where a shaft turns back over the recording: its encoder counts down, or the pair ran the other way."""
    travel = {name: float(np.sum(np.diff(one.angle)[one.ordinary])) for name, one in shafts.items()}
    wrong = [name for name, way in travel.items() if way < 0.0]
    if not wrong:
        return
    ways = {"driving": recording.driving_direction, "driven": recording.driven_direction}
    keys = " and ".join(f"{name}_direction = {-ways[name]}" for name in wrong)
    goes, runs = ("rise", "backwards") if recording.backward else ("fall", "forward")
    first = wrong[0]
    found, counts = (
        f"an angle that {goes}s by {-travel[first] / TURN:.2f} turns as the recording runs",
        "this encoder counts",
    )
    if len(wrong) == 2:
        turns = " and ".join(f"{-travel[name] / TURN:.2f}" for name in wrong)
        found, counts = f"angles that both {goes}, by {turns} turns, as the recording runs", "both encoders count"
    wanted = "fall" if recording.backward else "rise"
    wish = f"want angles that {wanted} as the pair runs {runs}; state {keys} (in a map as keys.NAME) if {counts} "
    wish += "the other way"
    if len(wrong) == len(shafts):
        way, ran = ("false", "forward") if recording.backward else ("true", "backwards")
        wish += f", or reversed = {way} if the pair ran {ran}"
    raise InputFileError(recording.source, where=f"column {first}_angle_deg", found=found, wish=wish)


def _rotations(
    recording: Recording,
    shafts: dict[str, Continuous],
    te: FloatArray | None,
    keep: IntArray,
    ratio: float,
    r_b2: float | None,
    done: list[Deed],
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Both rotations and the transmission error (m,) in rad; what was not recorded follows from the other two."""
    if len(shafts) == 2:
        first, second = shafts["driving"], shafts["driven"]
        _check_pair(recording, ratio, _travelled(shafts, otherwise=ratio))
        theta_1, theta_2, moved = settle_gaps(first, second, ratio)
        note(done, "gaps settled", moved, "gaps whose number of turns was found from both shafts together")
        if te is None:
            return theta_1, theta_2, theta_2 - ratio * theta_1
        check_error(recording, te, (theta_1, theta_2), keep, ratio=ratio, r_b2=r_b2)
        return theta_1, theta_2, te
    assert te is not None  # a Recording has two of the three
    if "driving" in shafts:
        theta_1 = shafts["driving"].angle
        return theta_1, te + ratio * theta_1, te
    theta_2 = shafts["driven"].angle
    return (theta_2 - te) / ratio, theta_2, te


def _travelled(shafts: dict[str, Continuous], *, otherwise: float = 1.0) -> float:
    """Driven over driving travel without gaps, which are settled with the ratio, and where a wrong one must show; else
    what is taken ``otherwise``."""
    if len(shafts) < 2:
        return otherwise
    first, second = shafts["driving"], shafts["driven"]
    both = first.ordinary & second.ordinary
    driving, driven = (float(np.sum(np.diff(one.angle)[both])) for one in (first, second))
    return driven / driving if driving > 0.0 and driven > 0.0 else otherwise


def _check_forward(recording: Recording, shaft: str, angle: FloatArray, keep: IntArray, done: list[Deed]) -> None:
    """Raise where a shaft really turns back; count where only its reading trembles."""
    back, limit = np.maximum.accumulate(angle) - angle, backward_limit(angle)
    real = np.flatnonzero(back > limit)
    if real.size:
        # The turn-round itself is the highest reading before.
        turned = int(np.argmax(angle[: real[0] + 1]))
        found = (
            f"the {shaft} angle runs back, by {told_beside(back[real[0]] / DEG, limit / DEG, 2)} deg up to "
            f"{row_of(recording, int(keep[real[0]]))}"
        )
        wish = f"want one direction (up to {told_at_most(limit / DEG, 2)} deg back is taken for jitter); cut the "
        wish += "recording there"
        raise InputFileError(recording.source, where=row_of(recording, int(keep[turned])), found=found, wish=wish)
    steps = int(np.count_nonzero(np.diff(angle) < 0.0))
    says = f"steps of the {shaft} angle backwards, by at most {back.max() / DEG:.2g} deg, taken for jitter and kept"
    note(done, f"{shaft} jitter", steps, says)


def _check_pair(recording: Recording, ratio: float, measured: float) -> None:
    if abs(measured / ratio - 1.0) <= RATIO_LIMIT:
        return
    check_units_by_travel(recording, ratio)
    teeth = nearest_teeth(measured, 10.0 * TEETH_TOLERANCE)
    found = (
        f"a ratio of {measured:.6g} (driven to driving travel), {measured / ratio - 1.0:+.1%} off "
        f"the pair's {ratio:.6g}; the nearest tooth ratio is {teeth.numerator}/{teeth.denominator}"
    )
    wish = "want a recording of this pair, with the right counts per turn of both encoders"
    raise InputFileError(recording.source, found=found, wish=wish)


def _judge_ratio(recording: Recording, ratio: float, value: float, error: float, done: list[Deed]) -> None:
    """Tell a ratio that is off by a constant; a pair's recording is not refused for it."""
    _check_pair(recording, ratio, ratio + value)
    if abs(value) <= OFFSET_SIGMAS * error:
        return
    tolerance = max(3.0 * error / ratio, TEETH_TOLERANCE)
    teeth = nearest_teeth(ratio + value, tolerance)
    other = f"; {teeth.numerator}/{teeth.denominator} teeth would fit" if abs(value) > 2.0 * tolerance * ratio else ""
    says = (
        f"the driven shaft travels {ratio + value:.8g} of the driving one, not {ratio:.8g}: "
        f"off by {value / ratio:+.3g} +- {error / ratio:.1g} of it (encoder count or slip{other}), or by a drift; "
        "left as recorded"
    )
    done.append(Deed("ratio", 0, says))
