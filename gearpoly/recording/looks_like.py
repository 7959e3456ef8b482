"""The unit that angles which never begin again look like: errors of gears and encoders come back once a turn.

Derived here. What the driven shaft is off its even way repeats with either shaft's turn. If it comes back after 6.283
of the numbers and not after 360 these are rad, whatever their header says.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.by_readings import COUNTERS, FEWEST_READINGS_FOR_KIND, ROUND_COUNTS_PER_TURN, are_counts
from gearpoly.recording.by_speed import ONE_WAY_SHARE
from gearpoly.recording.finite import all_finite
from gearpoly.recording.map_lines import counts_entries, entry
from gearpoly.recording.quantities import ANGLE, UNITS, Unit
from gearpoly.recording.recording import ANGLE_COLUMNS, TE_COLUMNS
from gearpoly.recording.table import Doubt, Table
from gearpoly.units import FloatArray, IntArray

SAMPLES_FOR_TURN_WAVES = 4000
"""Samples that are looked at; the waves of a shaft's turn have hundreds of them."""

LEAST_TURNS_FOR_UNIT = 4.0
"""Turns in the other unit from which it is told: fewer waves are like any slow course."""

TURNS_SURE = 20.0
"""The same from which rad under the name of deg are beyond doubt: 57 teeth mesh every 6.316 deg, and are ``OFF_PEAK``
off 6.283 in so many. Deg under the name of rad are as soon as they are told: no gear's wave takes 57 turns."""

RATIO_MOST = 10.0
"""Ratio of the travels of both shafts from which they are likelier in two units, 57.3 apart, than in another one."""

STEP_MOST = 0.25
"""Part of a turn from sample to sample up to which two waves of it are seen."""

EXPLAINED = 0.3
"""Part of the error's square that waves of either shaft's turn make at least in the unit that it looks like. Noise of
4000 samples makes 0.002."""

CONTRADICTED_SHARE = 0.1
"""The same in the stated unit, as a share of that, up to which it contradicts."""

OFF_PEAK = 0.1
"""How far the period may be off that of the waves, in periods over the whole recording: 57 teeth have a period of 6.316
deg, which is 0.3 off 6.283 in one turn."""

ONE_COUNT = 1.0
"""Standard deviation of the error in whole numbers up to which it may be their rounding, which repeats in step with the
samples."""

SAME_SHARE_PART = 0.9
"""Part of the best share from which another number of counts explains as much."""

EXCHANGED = ("deg", "rad", "rev")
"""Units of which one shaft may have one and the other another."""

NUMBERS_FOR_QUICK_LOOK = 20_000
"""Numbers that are looked at before all are."""

STATED_IN = ("deg", "rad", "rev", "gon")
"""Units that people exchange."""


@dataclass(frozen=True, kw_only=True)
class _Like:
    """What numbers look like: the ``turn`` of a shaft in them, and how it is called; ``sure`` where nothing else that
    gears make comes back so."""

    turn: float
    name: str
    counts: int = 0
    sure: bool = False


def unit_doubts(table: Table) -> list[Doubt]:
    """The doubt that a ``table``'s angles are in another unit than stated, by what repeats in them; none where they
    begin again."""
    return [doubt for doubt, _ in _doubts(table, teeth_tell=False)]


@np.errstate(over="ignore", invalid="ignore")  # a damaged file may hold anything
def _doubts(table: Table, *, teeth_tell: bool) -> list[tuple[Doubt, bool]]:
    """The same, and whether the numbers are sure of it. ``teeth_tell``: the pair is known, so that how far one shaft
    goes on for the other is held against its teeth."""
    held = [name for name in ANGLE_COLUMNS if name in table.columns]
    errors = [name for name in TE_COLUMNS if name in table.columns]
    if not held or (len(held) == 1 and not errors):
        return []
    units = [table.units.get(name, UNITS[ANGLE]["deg"]) for name in held]
    some = 50 * SAMPLES_FOR_TURN_WAVES
    numbers = [table.columns[name][:some] for name in held]
    numbers = [one if unit.size == 1.0 else one / unit.size for one, unit in zip(numbers, units, strict=True)]
    error = table.columns[errors[0]][:some] if len(held) == 1 else None
    if len({one.name for one in units}) > 1:
        return []
    like = _looks_like(numbers, error, units[0])
    called = {name: table.taken_from.get(name, name) for name in held}
    ratio = _driven_by_driving(numbers) if len(held) == 2 else None
    if ratio is not None:
        apart = not 1.0 / RATIO_MOST < ratio < RATIO_MOST
        two = _two_units(numbers, units[0], ratio) if apart or (like is not None and not like.counts) else None
        # What looks like another unit for both may be one shaft's wave, and the other shaft in a third unit.
        if apart or (like is not None and two is not None and two != (like.name, like.name)):
            if teeth_tell and two is None:
                return []
            return _of_two_units(two, units[0], tuple(called.values()), ratio)
    if like is None:
        if table.mapped & set(held) or not all(are_counts(one) for one in numbers):
            return []
        says = f"the angles are stated in {units[0].name}, and are whole numbers that never begin again, as counts are"
        ask = [line for name in held for line in counts_entries(name.partition("_")[0], called[name], stated=True)]
        return [(Doubt(says=says, ask=tuple(ask)), False)]
    says = f"the angles are stated in {units[0].name}, and their error {COMES_BACK} {like.turn:.6g} of the numbers, "
    says += f"as of {like.name}"
    more = [f"scale = {1.0 / like.counts!r}"] if like.counts else []
    unit = UNITS[ANGLE]["rev" if like.counts else like.name]
    return [(Doubt(says=says, ask=tuple(entry(name, called[name], unit, *more) for name in held)), like.sure)]


def _driven_by_driving(numbers: Sequence[FloatArray]) -> float | None:
    """How far the driven shaft's ``numbers`` (n,) go on for one of the driving one's; none where they begin again."""
    held = [one if all_finite(one) else one[np.isfinite(one)] for one in numbers]
    if any(one.size < FEWEST_READINGS_FOR_KIND for one in held):
        return None
    travel = [abs(float(one[-1] - one[0])) for one in held]
    spans = [float(np.ptp(one)) for one in held]
    if min(travel) <= 0.0 or any(way < ONE_WAY_SHARE * span for way, span in zip(travel, spans, strict=True)):
        return None
    if any(float(np.max(np.abs(np.diff(one)))) > 0.5 * span for one, span in zip(held, spans, strict=True)):
        return None  # wrapped, and ended by chance where it is highest
    return travel[1] / travel[0]


def _possible(ratio: float, stated: Unit) -> list[tuple[str, str]]:
    """The units that the driving and the driven numbers may be in, where these go on by ``ratio``: others than
    ``stated``, in which gears would do so."""
    turns = {name: 360.0 / UNITS[ANGLE][name].size for name in EXCHANGED}
    return [
        (one, two)
        for one, two in product(turns, repeat=2)
        if 1.0 / RATIO_MOST < ratio * turns[one] / turns[two] < RATIO_MOST and (one, two) != (stated.name, stated.name)
    ]


def _two_units(numbers: Sequence[FloatArray], stated: Unit, ratio: float) -> tuple[str, str] | None:
    """The units that the ``numbers`` (n,) of both shafts, ``stated`` in one, look like by what repeats in each."""
    read = np.flatnonzero(np.isfinite(numbers[0]) & np.isfinite(numbers[1]))
    first = [one[read] for one in numbers]
    size = {name: 360.0 / UNITS[ANGLE][name].size for name in EXCHANGED}
    shares = sorted(
        (_explained(first, None, (size[pair[0]], size[pair[1]])) or 0.0, pair) for pair in _possible(ratio, stated)
    )
    if not shares or shares[-1][0] < EXPLAINED or (len(shares) > 1 and shares[-2][0] > SAME_SHARE_PART * shares[-1][0]):
        return None
    return shares[-1][1]


def _of_two_units(
    told: tuple[str, str] | None, stated: Unit, called: Sequence[str], ratio: float
) -> list[tuple[Doubt, bool]]:
    """The doubt where the two shafts' numbers, which are ``called`` so and both ``stated`` in one unit, go on by a
    ``ratio``: by what is ``told`` of each by its waves, or with all that it may be."""
    says = f"both angles are stated in {stated.name}, and the driven one goes on by {ratio:.4g} of the driving one"
    if told is not None:
        after = [f"{360.0 / UNITS[ANGLE][name].size:.6g}" for name in told]
        says += f"; their error {COMES_BACK} {after[0]} of the driving numbers and {after[1]} of the driven ones, "
        return [(Doubt(says=f"{says}as of {told[0]} and {told[1]}", ask=_lines(told, stated, called)), False)]
    likely = _possible(ratio, stated)
    fewest = min((sum(name != stated.name for name in pair) for pair in likely), default=0)
    ways = [_lines(pair, stated, called) for pair in likely if sum(name != stated.name for name in pair) == fewest]
    if len(ways) == 1:
        return [(Doubt(says=f"{says}, as where one is in another unit", ask=ways[0]), False)]
    each = ", or ".join(" ".join(lines) for lines in ways)
    return [(Doubt(says=f"{says}: in a map, as it is, {each}", ask=()), False)] if ways else []


def _lines(pair: tuple[str, str], stated: Unit, called: Sequence[str]) -> tuple[str, ...]:
    """The lines of a map for the shafts of a ``pair`` of units whose unit is not the ``stated`` one."""
    return tuple(
        entry(column, channel, UNITS[ANGLE][name])
        for column, channel, name in zip(ANGLE_COLUMNS, called, pair, strict=True)
        if name != stated.name
    )


COMES_BACK = "comes back after"
"""How it is said that an error repeats."""

HALF_TURN_DEG = 180.0


def check_units(file: Path, table: Table) -> None:
    """Say in a remark that a ``table``'s angles look like those of another unit; raise ``InputFileError`` where that is
    sure, or they would turn by more than half a turn from sample to sample in the stated one."""
    for doubt, sure in _doubts(table, teeth_tell=True):
        asks = f"in a map, if so: {' '.join(doubt.ask)}"
        held = [table.columns[name] for name in ANGLE_COLUMNS if name in table.columns]
        quick = max(float(np.nanmedian(np.abs(np.diff(one)))) for one in held) > HALF_TURN_DEG
        if (sure or (quick and COMES_BACK in doubt.says)) and not table.mapped & set(ANGLE_COLUMNS):
            raise InputFileError(file, found=doubt.says, wish=f"want {asks}{_or_as_stated(table)}")
        table.remarks.append(f"{doubt.says}; {asks}")


def _looks_like(numbers: Sequence[FloatArray], error: FloatArray | None, stated: Unit) -> _Like | None:
    """What ``numbers`` (n,) of one or both shafts look like, if not as in the unit that is ``stated``."""
    every = [*numbers, *([error] if error is not None else [])]
    if any(one.size != every[0].size for one in every):
        return None
    read: slice | IntArray = slice(None)
    if not all(all_finite(one) for one in every):
        read = np.flatnonzero(np.logical_and.reduce([np.isfinite(one) for one in every]))
    first = [one[read] for one in numbers]
    if first[0].size < FEWEST_READINGS_FOR_KIND or not _goes_on(first[0][:NUMBERS_FOR_QUICK_LOOK]):
        return None
    steps = np.diff(first[0])
    sense = float(np.sign(first[0][-1] - first[0][0]))
    if (
        not sense
        or np.count_nonzero(sense * steps < 0.0) > 0.01 * steps.size
        or np.max(np.abs(steps)) > 0.5 * float(np.ptp(first[0]))
    ):
        return None  # wrapped, or forth and back
    off = error[read] if error is not None else None
    own = 360.0 / stated.size
    known = _explained(first, off, own)
    if known is not None and known > EXPLAINED:
        return None
    likes = [_Like(turn=360.0 / UNITS[ANGLE][name].size, name=name) for name in STATED_IN if name != stated.name]
    if all(np.array_equal(one, np.rint(one)) for one in first):
        if (
            off is None
            and float(np.std(first[-1] - np.polynomial.Polynomial.fit(first[0], first[-1], 1)(first[0]))) <= ONE_COUNT
        ):
            return None
        counts = sorted({*ROUND_COUNTS_PER_TURN, *(1 << bits for bits in COUNTERS if bits <= 24)})
        likes += [_Like(turn=float(one), name=f"counts, {one} a turn", counts=one) for one in counts]
    found = [
        (share, one)
        for one in likes
        if (share := _explained(first, off, one.turn, waves=1 if one.counts else 2)) is not None
    ]
    if not found:
        return None
    found.sort(key=lambda pair: pair[0], reverse=True)
    share, best = found[0]
    if best.counts and len(found) > 1 and found[1][0] > SAME_SHARE_PART * share:
        return None  # a wave of one shaft is one of the other with as many counts less as their ratio
    if (
        share < EXPLAINED
        or (known is not None and known > CONTRADICTED_SHARE * share)
        or not _at_peak(first, off, best.turn)
    ):
        return None
    other = {"deg": "rad", "rad": "deg"}.get(stated.name)
    travel = [abs(float(one[-1] - one[0])) for one in first]
    sure = best.name == other and (best.turn > own or travel[0] / best.turn >= TURNS_SURE)
    return replace(best, sure=sure and max(travel) < RATIO_MOST * min(travel))


def _goes_on(first: FloatArray) -> bool:
    """Whether the ``first`` numbers (m,) of a shaft may be of one that goes on one way, and was never wrapped."""
    steps = np.diff(first)
    against = min(np.count_nonzero(steps < 0.0), np.count_nonzero(steps > 0.0))
    return bool(against <= CONTRADICTED_SHARE * steps.size)


def _or_as_stated(table: Table) -> str:
    """What is said of the other way out: a map that states the unit once more is believed."""
    name = next(name for name in ANGLE_COLUMNS if name in table.columns)
    return f'; or the same with unit = "{table.units.get(name, UNITS[ANGLE]["deg"]).name}", if that is the unit'


def _explained(
    shafts: Sequence[FloatArray], error: FloatArray | None, turn: float | tuple[float, float], *, waves: int = 2
) -> float | None:
    """The part of the error's square that ``waves`` a ``turn`` of each shaft make, or of one and of the other; ``None``
    where such turns are too few or too quick."""
    x, every_turn = shafts[0], turn if isinstance(turn, tuple) else (turn, turn)
    turn = every_turn[0]
    span = abs(float(x[-1] - x[0]))
    if span < LEAST_TURNS_FOR_UNIT * turn:
        return None
    usual = float(np.median(np.abs(np.diff(x))))
    if usual > STEP_MOST * turn:
        return None
    every = max(1, min(x.size // SAMPLES_FOR_TURN_WAVES, int(STEP_MOST * turn / usual) if usual > 0.0 else 1))
    some = [one[::every][:SAMPLES_FOR_TURN_WAVES] for one in shafts]
    if abs(float(some[0][-1] - some[0][0])) < LEAST_TURNS_FOR_UNIT * turn:
        return None
    return _share(some, None if error is None else error[::every][:SAMPLES_FOR_TURN_WAVES], every_turn, waves)


def _share(shafts: Sequence[FloatArray], error: FloatArray | None, turns: tuple[float, float], count: int) -> float:
    x = shafts[0] - shafts[0][0]
    slow = np.vander(x / max(float(np.max(np.abs(x))), 1e-300), 3)
    off = shafts[-1] if error is None else error
    off = off - slow @ np.linalg.lstsq(slow, off, rcond=None)[0]
    total = float(off @ off)
    if not total > 0.0:
        return 0.0
    phases = [
        2.0 * np.pi / turn * k * one
        for one, turn in zip(shafts, turns[: len(shafts)], strict=True)
        for k in range(1, count + 1)
    ]
    waves = np.column_stack([slow, *(wave(one) for one in phases for wave in (np.cos, np.sin))])
    rest = off - waves @ np.linalg.lstsq(waves, off, rcond=None)[0]
    return 1.0 - float(rest @ rest) / total


def _at_peak(shafts: Sequence[FloatArray], error: FloatArray | None, turn: float) -> bool:
    """Whether waves explain most with just this ``turn``, and not with one beside it, as those of the mesh would."""
    turns = min(abs(float(shafts[0][-1] - shafts[0][0])) / turn, 0.5 * SAMPLES_FOR_TURN_WAVES)
    low, middle, high = (_explained(shafts, error, turn / (1.0 + k / (2.0 * turns))) or 0.0 for k in (-0.5, 0.0, 0.5))
    bend = 2.0 * middle - low - high
    return bend > 0.0 and abs(0.25 * 0.5 * (high - low) / bend) <= OFF_PEAK
