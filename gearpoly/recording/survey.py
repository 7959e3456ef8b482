"""What a recording's file holds, before anything is computed: columns, rate, turns, and whatever is odd in them.

Nothing is put right here and nothing refused: what a comparison would refuse is told, with the rows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearpoly.errors import GearpolyError
from gearpoly.recording.asked import angles_known
from gearpoly.recording.clean import clean
from gearpoly.recording.clock_set import on_one_clock
from gearpoly.recording.in_name import in_name
from gearpoly.recording.looks_like import unit_doubts
from gearpoly.recording.lost_motion import LostMotion
from gearpoly.recording.map_file import RecordingMap
from gearpoly.recording.map_lines import turns_in
from gearpoly.recording.mapped import stated_unit
from gearpoly.recording.meant import Meaning
from gearpoly.recording.pulse_times import asked_of_pulses
from gearpoly.recording.quantities import ANGLE, Unit, column_unit
from gearpoly.recording.read import find_reader, read_tables
from gearpoly.recording.reader import recording_from_table
from gearpoly.recording.recording import ANGLE_COLUMNS, COLUMNS, Recording
from gearpoly.recording.run import Run
from gearpoly.recording.runs import is_long, lost_motions, runs_of, says, usable
from gearpoly.recording.table import Channel, Doubt, Table
from gearpoly.recording.taken import assigned, taken
from gearpoly.recording.turning import FEWEST_SAMPLES_FOR_TURNS, Turning, turning_of
from gearpoly.recording.unwrapping import GAP_STEPS, STEPS_FOR_USUAL_STEP, gaps
from gearpoly.threads import each
from gearpoly.units import FloatArray

ASTRAY = 1.0
"""Even steps by which times may stray in all, rounded to a step as they may be; loops whose steps vary by a twentieth
of themselves and add up stray farther within 1000 samples (0.05 sqrt(1000) = 1.6)."""


@dataclass(frozen=True, kw_only=True)
class SampleTimes:
    """Times of the samples: ``rate_hz`` of the usual step, or of all between gaps where they are even and rounded, the
    ``spread`` of the steps (5 to 95 %, relative), ``seconds`` from first to last, ``gaps`` of more than three steps as
    (row, s) and ``backs``, rows before which the time runs back; ``alike`` samples share a time where most do."""

    rate_hz: float
    spread: float
    seconds: float
    gaps: tuple[tuple[int, float], ...]
    backs: tuple[int, ...]
    alike: int = 1


@dataclass(frozen=True, kw_only=True, eq=False)
class Seen:
    """One channel: its ``name`` and ``unit`` in the file, its ``values`` (n,), the contract's ``column`` that it was
    taken for or may be (empty: none), whether that is ``sure``, ``why``, how it turns where it is an angle, and the
    unit that its numbers are ``known`` to have."""

    name: str
    unit: str
    values: FloatArray
    column: str
    sure: bool
    why: str
    turning: Turning | None
    known: Unit | None

    @property
    def missing(self) -> int:
        """Samples without a reading."""
        return int(np.count_nonzero(~np.isfinite(self.values)))

    @property
    def span(self) -> tuple[float, float] | None:
        """Least and largest reading."""
        low, high = float(self.values.min(initial=np.inf)), float(self.values.max(initial=-np.inf))
        if np.isfinite(low) and np.isfinite(high):
            return low, high
        held = self.values[np.isfinite(self.values)]
        return (float(held.min()), float(held.max())) if held.size else None


@dataclass(frozen=True, kw_only=True)
class RunSeen:
    """One of the runs forth and back: what it ``says``, which ``run`` it is, whether it turns ``back``, its ``flank``,
    and whether it is too ``short`` to be compared."""

    says: str
    run: Run
    back: bool
    flank: str
    short: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class Survey:
    """One recording of a file: its ``number`` among those in the ``file`` (from 1) and ``of`` how many, the ``format``,
    the ``channels``, ``clock``, ``keys``, ``layout`` of the text, what is in doubt, remarks, and the ``refusal`` that a
    comparison would give, empty where it takes the recording; where the shafts turn forth and back the ``runs``, and
    the lost motion between two of them, by their numbers."""

    file: Path
    number: int
    of: int
    format: str
    channels: tuple[Seen, ...]
    time: FloatArray | None
    clock: SampleTimes | None
    keys: Mapping[str, object]
    layout: Mapping[str, str]
    doubts: tuple[Doubt, ...]
    remarks: tuple[str, ...]
    refusal: str
    runs: tuple[RunSeen, ...] = ()
    lost: tuple[tuple[int, int, LostMotion], ...] = ()

    @property
    def rows(self) -> int:
        """Samples of the longest channel."""
        return max((one.values.size for one in self.channels), default=0)


def survey(file: Path, chart: RecordingMap | None = None) -> list[Survey]:
    """What every recording in a file holds, read as the map ``chart`` has it.

    Raises ``InputFileError`` only where the file cannot be read at all.
    """
    tables = read_tables(file, chart)
    name = find_reader(file).name
    return [
        _survey(file, table, chart, number=number, of=len(tables), format_name=name)
        for number, table in enumerate(tables, start=1)
    ]


def _survey(file: Path, table: Table, chart: RecordingMap | None, *, number: int, of: int, format_name: str) -> Survey:
    refusal = ""
    _seal(table)
    runs: tuple[Recording, ...] = ()
    try:
        runs = runs_of(recording_from_table(file, taken(file, _copied(table), chart)))
        usable(runs)
        if len(runs) == 1:
            _check_clean(runs[0])
    except GearpolyError as error:
        refusal = str(error)
    out, found = assigned(file, table, chart)
    said = len(out.remarks)
    doubts = [
        *table.doubts,
        *(Doubt(says=_doubt(one, table), ask=one.ask) for one in found if one.doubt),
        *on_one_clock(out),
    ]
    pulses = asked_of_pulses(found, table.others) if not angles_known(out.columns) else None
    if pulses is not None:  # in place of the same columns as times of samples
        doubts = [*table.doubts, Doubt(says=pulses[0], ask=pulses[1])]
    doubts += unit_doubts(out)
    doubts += in_name(file, out.keys, [*out.columns, *(one.column for one in found)])
    time = next((v for v in (out.columns.get("time_s"), _likely_time(table, found)) if v is not None), None)
    channels = _channels(table, out, found, time)
    return Survey(
        file=file,
        number=number,
        of=of,
        format=format_name,
        channels=tuple(channels),
        time=time,
        clock=None if time is None or time.size < FEWEST_SAMPLES_FOR_TURNS else _clock(time),
        keys=out.keys,
        layout=table.layout,
        doubts=tuple(doubts),
        remarks=(*table.remarks, *out.remarks[said:]),
        refusal=refusal,
        runs=tuple(
            RunSeen(says=says(one), run=one.run, back=one.backward, flank=one.flank, short=not is_long(one, runs))
            for one in runs
            if one.run is not None
        ),
        lost=tuple((forth + 1, back + 1, one) for forth, back, one in lost_motions(runs)),
    )


CLEANED_MOST = 300_000
"""Samples up to which a recording is cleaned to see whether a comparison would refuse it; that takes 0.1 s, and a file
of 100 MB shall be told within two."""


def _check_clean(run: Recording) -> None:
    """Raise what a comparison would, whatever the pair: a time or a shaft that runs back, too few turns."""
    if run.size > CLEANED_MOST or run.te_mm is not None:
        return
    clean(run, ratio=None)


def _seal(table: Table) -> None:
    """Let nobody write to the numbers of a table, so that a recording takes none of them over."""
    for values in (*table.columns.values(), *(one.values for one in table.others.values())):
        values.setflags(write=False)


def _copied(table: Table) -> Table:
    """The table with lists and keys of its own, beside the same numbers."""
    return replace(table, columns=dict(table.columns), keys=dict(table.keys), remarks=list(table.remarks))


def _doubt(one: Meaning, table: Table) -> str:
    bare = one.dimension == ANGLE and one.unit is None and not stated_unit(one.channel, table.others[one.channel])
    return f'"{one.channel}": {one.doubt}{turns_in(table.others[one.channel].values) if bare else ""}'


def _likely_time(table: Table, found: list[Meaning]) -> FloatArray | None:
    """The times in s by a column that is not surely time; samples of a format may have times of their own."""
    for one in found:
        if one.column == "time_s":
            return table.others[one.channel].values * (one.unit.size if one.unit is not None else 1.0)
    return next((one.time for one in table.others.values() if one.time is not None), None)


def _channels(table: Table, out: Table, found: list[Meaning], time: FloatArray | None) -> list[Seen]:
    """Every channel in the order of the file."""
    meant = {one.channel: one for one in found}
    given = {channel: column for column, channel in out.taken_from.items()}
    held = {**{name: Channel(values=values) for name, values in table.columns.items()}, **table.others}

    def seen(name: str) -> Seen:
        return _seen(name, held[name], meant.get(name), given.get(name, ""), table, out, time)

    # How each of two shafts turned takes as long as half of the reading of a large file.
    large = any(one.values.size > CLEANED_MOST for one in held.values())
    return each(seen, held) if large else [seen(name) for name in held]


def _seen(
    name: str, one: Channel, meaning: Meaning | None, given: str, table: Table, out: Table, time: FloatArray | None
) -> Seen:
    """One channel, ``given`` to that column for sure."""
    column = given or (meaning.column if meaning is not None else "")
    if meaning is not None:
        why = meaning.doubt or meaning.why
    elif given == name:
        why = "the name of a column" if name in COLUMNS else "a telescope's axis, watched through the pair's worm"
    else:
        why = "the map says so" if given else ""
    unit = stated_unit(name, one) or (column_unit(name).name if name in table.columns else "")
    turning = None
    known = meaning.unit if meaning is not None else None
    if column in ANGLE_COLUMNS and (given or known is not None):
        degrees = out.columns[column] if given else one.values * (known.size if known is not None else 1.0)
        timed = time if time is not None and time.size == degrees.size else None
        turning = turning_of(degrees, one.values, timed)
    return Seen(
        name=name, unit=unit, values=one.values, column=column, sure=bool(given), why=why, turning=turning, known=known
    )


def _rate(steps: FloatArray, usual: float) -> float:
    """Samples per s by the ``steps`` (n,) of a time and the ``usual`` one, s. Times that are rounded have no step that
    is the true one: their samples still come a whole number of even steps apart, but for ``ASTRAY`` of one."""
    ordinary = steps[(steps > 0.0) & (steps <= GAP_STEPS * usual)]
    if not ordinary.size:
        return 1.0 / usual
    number = np.rint(ordinary / np.mean(ordinary))
    rate = float(np.sum(number) / np.sum(ordinary))
    astray = np.cumsum(ordinary * rate - number)
    return rate if float(np.ptp(astray)) <= ASTRAY else 1.0 / usual


def _clock(time: FloatArray) -> SampleTimes:
    rows = np.flatnonzero(np.isfinite(time))
    steps = np.diff(time[rows] if rows.size < time.size else time)
    some = steps[:: max(1, steps.size // STEPS_FOR_USUAL_STEP)]
    sense = 1.0 if 2 * np.count_nonzero(some < 0.0) < some.size else -1.0
    rising = sense * some[sense * some > 0.0]
    low, usual, high = np.quantile(rising, [0.05, 0.5, 0.95]).tolist() if rising.size else (float("nan"),) * 3
    seconds = abs(float(time[rows[-1]] - time[rows[0]])) if rows.size else 0.0
    if seconds and 2 * np.count_nonzero(some == 0.0) > some.size:
        # Times are coarser than the samples: how many there are in all is their rate.
        changes = np.count_nonzero(steps)
        backs = tuple(int(rows[k + 1]) + 1 for k in np.flatnonzero(steps < 0.0))
        late = tuple((int(rows[k]) + 1, float(steps[k])) for k in np.flatnonzero(sense * steps > GAP_STEPS * usual))
        return SampleTimes(
            rate_hz=steps.size / seconds, spread=0.0, seconds=seconds, gaps=late, backs=backs,
            alike=round(rows.size / (changes + 1)),
        )  # fmt: skip
    wide = np.flatnonzero(gaps(sense * steps, usual))
    return SampleTimes(
        rate_hz=_rate(sense * steps, usual),
        spread=(high - low) / usual,
        seconds=seconds,
        gaps=tuple((int(rows[k]) + 1, float(steps[k])) for k in wide),
        backs=tuple(int(rows[k + 1]) + 1 for k in np.flatnonzero(steps < 0.0)),
    )
