"""The unit of an angle or a time by its readings alone: where an angle begins again, from when a time counts."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np

from gearpoly.recording.agreement import rounding
from gearpoly.recording.finite import first_read
from gearpoly.recording.quantities import ANGLE, TIME, UNITS, Unit, unit_written
from gearpoly.units import FloatArray

SERIAL_DAYS = (20_000.0, 80_000.0)
"""Days by which spreadsheets count dates, from 1954 to 2119."""

READINGS_FOR_UNIT = 16_000
"""Readings of an angle that are looked at for its unit, the first or some of all; a turn has a few hundred."""

WRAP_TOLERANCE = 0.01
"""Relative. Jumps of an angle that begins again are its modulus less a step; a turn of 360 deg and one of 400 gon are
a tenth apart."""


TURNS_IN = tuple(
    unit
    for name in ("deg", "rad", "gon", "mrad", "rev", "arcmin", "arcsec", "mdeg", "urad", "mgon", "0.1 deg", "0.01 deg")
    if (unit := unit_written(name, ANGLE)) is not None
)
"""Units that readings which begin again after one turn are told by."""

SINCE_1970 = (1e9, 4.1e9)
"""Seconds since 1970 from 2001 to 2099."""


def since_1970(values: FloatArray) -> Unit | None:
    """The unit in which readings (n,) of a time count from 1970, as the clocks of computers do, or ``None``."""
    held = values[np.isfinite(values)]
    if not held.size:
        return None
    for unit in (UNITS[TIME][one] for one in ("s", "ms", "us", "ns")):
        if SINCE_1970[0] < held.min() * unit.size and held.max() * unit.size < SINCE_1970[1]:
            return unit
    for before in TICKS_BEFORE_S.values():
        if SINCE_1970[0] < held.min() * TICK.size - before and held.max() * TICK.size - before < SINCE_1970[1]:
            return TICK
    return None


TICK = Unit(name="100 ns", dimension=TIME, size=1e-7)
"""What clocks of Windows count."""

TICKS_BEFORE_S = {1601: 11_644_473_600.0, 1: 62_135_596_800.0}
"""Seconds from the years in which they begin to 1970: that of its files, and that of its programs."""


def told_since(unit: Unit) -> str:
    """How a time in that ``unit`` is said to count."""
    return "in ticks of 100 ns, as Windows counts" if unit is TICK else f"{unit.name} since 1970"


def are_days(values: FloatArray) -> bool:
    """Whether readings (n,) may be dates of a spreadsheet."""
    held = values[np.isfinite(values)]
    return bool(held.size and SERIAL_DAYS[0] < held.min() and held.max() < SERIAL_DAYS[1])


@np.errstate(over="ignore", invalid="ignore")  # a damaged file may hold anything
def contradicting(values: FloatArray, unit: Unit) -> Unit | None:
    """The unit in which readings (n,) of an angle begin again after one turn, where it is another than ``unit``."""
    shown_by, net = _begun_again(values)
    if shown_by is None or abs(shown_by.size / unit.size - 1.0) <= WRAP_TOLERANCE:
        return None
    # A spike goes there and back; of turns more begin again one way than the other.
    return shown_by if net else None


def wrapped_unit(values: FloatArray) -> Unit | None:
    """The unit in which readings (n,) begin again after one turn, or ``None`` where they do not."""
    return _begun_again(values)[0]


def _begun_again(values: FloatArray) -> tuple[Unit | None, int]:
    """The unit in which readings (n,) begin again after one turn, by the first of many or by some of all, and how many
    more of them do so downward than upward."""
    for some in (values[:READINGS_FOR_UNIT], values[:: max(1, values.size // READINGS_FOR_UNIT)]):
        found = _jumps(some)
        if found[0] is not None:
            return found
    return None, 0


def _jumps(values: FloatArray) -> tuple[Unit | None, int]:
    read = np.isfinite(values)
    held = values if read.all() else values[read]
    if held.size < 8:
        return None, 0
    with np.errstate(over="ignore"):  # a damaged file may hold anything
        steps = np.diff(held)
        span = float(np.ptp(held))
    sizes = np.abs(steps)
    jumps = steps[sizes > 0.5 * span]
    if not 1 <= jumps.size <= held.size // 4:
        return None, 0
    usual = float(np.median(sizes))
    modulus = float(np.median(np.abs(jumps))) + usual
    for unit in TURNS_IN:
        if abs(modulus * unit.size / 360.0 - 1.0) <= WRAP_TOLERANCE:
            return unit, -int(np.sum(np.sign(jumps)))
    return None, 0


def begins_again_at(values: FloatArray) -> float | None:
    """The number at which readings (n,) of any unit begin again, by jumps that agree, or ``None`` where they do not or
    leave it in doubt (``begins_again_about``): a power of two or a round number, the one within the doubt."""
    found = begins_again_about(values)
    if found is None:
        return None
    middle, doubt = found
    power = 2.0 ** round(math.log2(middle))
    near = (10.0**k * round(middle / 10.0**k) for k in range(math.floor(math.log10(middle)), -PLACES_MOST, -1))
    rounds = [one for one in (float(f"{one:.12g}") for one in near) if one > 0.0]
    told = [power] if middle >= 2.0 ** COUNTERS[0] and doubt <= ROUNDNESS * power else []
    told += [one for one in rounds if doubt <= ROUNDNESS * _roundness(one)]
    span = float(np.ptp(first_read(values, READINGS_FOR_UNIT)))
    return next((one for one in told if abs(one - middle) <= doubt and one > span - doubt), None)


PLACES_MOST = 6
"""Decimal places of a number at which readings begin again: those of a voltage to a millionth."""

ROUNDNESS = 0.05
"""Part of its last digit's size, up to which doubt leaves a round number certain: one number in ten of any kind has
such a one within its doubt, and counts of a turn are seldom of any kind."""


def _roundness(number: float) -> float:
    """The size of the last digit of a ``number`` that is not 0."""
    return 10.0 ** int(Decimal(f"{number:.12g}").normalize().as_tuple().exponent)


def begins_again_about(values: FloatArray) -> tuple[float, float] | None:
    """The number at which readings (n,) begin again and its doubt, by jumps that agree, or ``None`` without them.

    A jump with the steps beside it is that number but for what the shaft's speed changed meanwhile. Jumps come at one
    place of the shaft, where it changes alike each time, so no number of jumps makes the doubt less than that change.
    """
    held = first_read(values, READINGS_FOR_UNIT)
    steps = np.diff(held)
    span = float(np.ptp(held)) if held.size >= FEWEST_READINGS_FOR_KIND else 0.0
    large = np.abs(steps) > 0.5 * span
    jumps = np.abs(steps[large])
    if span == 0.0 or not 3 <= jumps.size <= held.size // 8 or np.ptp(jumps) > WRAP_TOLERANCE * 5.0 * span:
        return None
    size = np.abs(steps)
    beside = 0.5 * (size[:-2] + size[2:])
    alone = ~(large[:-2] | large[2:])
    told = (size[1:-1] + beside)[large[1:-1] & alone]
    change = np.abs(size[1:-1] - beside)[~large[1:-1] & alone]
    if not told.size or not change.size:
        return None
    whole = not np.any(held != np.rint(held))
    middle, doubt = float(np.median(told)), float(np.quantile(change, SPEED_CHANGES_SHARE)) + (0.5 if whole else 0.0)
    return (middle, doubt) if 0.95 * middle < span < 1.01 * middle else None


SPEED_CHANGES_SHARE = 0.99
"""Share of the changes of speed that the doubt of a jump holds; the rest are readings that are missing or wrong."""


COUNTERS = range(8, 33)
"""Bits of counters that go round."""

ROUND_COUNTS_PER_TURN = (
    1000,
    1200,
    2000,
    2400,
    2500,
    2880,
    4000,
    4800,
    5000,
    7200,
    8000,
    10_000,
    14_400,
    20_000,
    40_000,
    72_000,
)
"""Counts of a turn that encoders have beside powers of two; the others are units of an angle too."""


COUNTER_ROUND_FILLED, COUNTER_BINARY_FILLED = 0.99, 0.9
"""Parts of what a counter goes round at that its largest reading reaches: round numbers lie as near as 4 % to one
another and to powers of two, and these a factor of two apart."""


def counter_modulus(values: FloatArray) -> int | None:
    """The number at which whole readings (n,) begin again, a power of two that they nearly fill or a round one that
    they fill, from 0 on or to both sides of it, or ``None``."""
    held = first_read(values, READINGS_FOR_UNIT)
    if held.size < 8 or np.any(held[:8] != np.rint(held[:8])) or np.any(held != np.rint(held)):
        return None
    low, top, steps = float(held.min()), float(held.max()), np.abs(np.diff(held))
    usual = float(np.median(steps))
    least = max(top, -2.0 * low - 0.5, 2.0 * top if low < 0.0 else 0.0)
    power = next((1 << bits for bits in COUNTERS if least < 2**bits), None)
    tried: list[tuple[int, float]] = [(one, COUNTER_ROUND_FILLED) for one in ROUND_COUNTS_PER_TURN if least < one]
    for modulus, share in [*tried, *([(power, COUNTER_BINARY_FILLED)] if power is not None else [])]:
        jumps = steps > 0.5 * modulus
        filled = min(top, -low) >= (share - 0.5) * modulus if low < 0.0 else top >= share * modulus
        if not filled or not 1 <= np.sum(jumps) <= held.size // 4:
            continue
        # What a jump and the step that it took the place of make together; 30 000 counts nearly fill 32 768 too.
        if abs(float(np.median(steps[jumps])) + usual - modulus) <= max(1.0, float(np.max(steps[~jumps]))):
            return modulus
    return None


def are_row_numbers(values: FloatArray) -> bool:
    """Whether readings (n,) count the rows, from 0 or 1 on."""
    return bool(values.size > 1 and values[0] in (0.0, 1.0) and np.all(np.diff(values) == 1.0))


WHOLE_TURNS = 0.01
"""Part of a turn by which a counter's turn may miss a whole one; next to a power of two the nearest numbers of counts
that anybody sets are 2 % off (1000 and 1024)."""


def are_whole_turns(degrees: float) -> bool:
    """Whether an angle is one turn or a few, as what readings begin again at is."""
    return abs(degrees / 360.0 - max(1.0, round(degrees / 360.0))) <= WHOLE_TURNS


def rises(values: FloatArray) -> bool:
    """Whether readings (n,) rise all along and never fall, as those of a clock do."""
    held = values[np.isfinite(values)]
    return bool(held.size > 1 and held[-1] > held[0] and np.all(np.diff(held) >= 0.0))


CLOCK_TICKS = 1 << 32
"""Ticks after which the clock of a small computer begins again: it has 32 bits."""


def went_on(values: FloatArray, modulus: float) -> FloatArray:
    """Readings (n,) that go on where they begin again after the ``modulus``: wherever they fall by half of it."""
    fell = np.diff(values, prepend=values[:1]) < -0.5 * modulus
    return np.asarray(values + modulus * np.cumsum(fell))


COUNTS_LEAST = 800.0
"""Whole numbers, two turns in gons, beyond which readings that never begin again are counts."""

FEWEST_READINGS_FOR_KIND = 200
"""Readings from which that is told, and what a channel is that is no angle."""


def are_counts(values: FloatArray) -> bool:
    """Whether readings (n,) are whole numbers that only go on, for more than any unit's turn has of them."""
    held = first_read(values, 10 * READINGS_FOR_UNIT)
    if held.size < FEWEST_READINGS_FOR_KIND or any(
        np.any(np.abs(one - np.rint(one)) > 1e-6) for one in (held[:FEWEST_READINGS_FOR_KIND], held)
    ):
        return False
    steps = np.diff(held)
    return float(np.ptp(held)) > COUNTS_LEAST and bool(np.all(steps >= 0.0) or np.all(steps <= 0.0))


LEVEL = 0.1
"""Part of the range of a channel within which a reading is at one of its two levels."""


def are_levels(values: FloatArray) -> bool:
    """Whether readings (n,) switch between two levels, as a channel of an encoder does."""
    held = first_read(values, 10 * READINGS_FOR_UNIT)
    span = float(np.ptp(held)) if held.size >= FEWEST_READINGS_FOR_KIND else 0.0
    if span == 0.0:
        return False
    share = (held - held.min()) / span
    high = share > 0.5
    clear = np.count_nonzero((share < LEVEL) | (share > 1.0 - LEVEL))
    return bool(clear > 0.95 * held.size and np.count_nonzero(high[1:] != high[:-1]) >= 8)


def level_changes(values: FloatArray) -> int:
    """How often readings (n,) pass from one of two levels to the other."""
    held = values[np.isfinite(values)]
    high = held > 0.5 * (held.min() + held.max())
    return int(np.count_nonzero(high[1:] != high[:-1]))


SWINGS_LEAST_RANGES = 20.0
"""Times its range that a channel goes without ever beginning again, from which it swings and turns no shaft: forth and
back ten times."""


def swings(values: FloatArray) -> bool:
    """Whether readings (n,) stand still or swing to and fro without a wrap, as no angle of a shaft does."""
    held = first_read(values, READINGS_FOR_UNIT)
    if held.size < FEWEST_READINGS_FOR_KIND:
        return False
    steps = np.abs(np.diff(held))
    span = float(np.ptp(held))
    return span == 0.0 or bool(steps.max() < 0.5 * span and steps.sum() > SWINGS_LEAST_RANGES * span)


COMES_BACK_PART = 0.5
"""Part of its range within which a channel ends that comes back. A judgement; it orders what is offered."""


def comes_back(values: FloatArray) -> bool:
    """Whether readings (n,) end near where they began without a wrap, as those of a shaft do that only swings."""
    read = values[np.isfinite(values)]
    if read.size < FEWEST_READINGS_FOR_KIND:
        return False
    span = float(np.ptp(read))
    wraps = float(np.max(np.abs(np.diff(read)))) > 0.5 * span
    return not wraps and abs(float(read[-1] - read[0])) < COMES_BACK_PART * span


CLOCK_STEP_VARIATION = 1e-6
"""Part of a step by which steps of a clock may differ; a shaft with an encoder wobbles by a hundred times as much."""


def runs_evenly(values: FloatArray) -> bool:
    """Whether readings (n,) rise by one step, as the times of a logger or the numbers of its rows do."""
    if values.size < 8 or not np.isfinite(values).all():
        return False
    steps = np.diff(values)
    step = float(np.median(steps))
    coarse = 2.0 * float(rounding(values[-1:])[0])
    return step > 0.0 and bool(
        np.max(np.abs(steps - step)) <= CLOCK_STEP_VARIATION * step + 2.0 * coarse and np.min(steps) > 0.0
    )
