"""Raw encoder channels become angles: the names of channels and keys, the common times, and the report.

The channels of a shaft are ``driving_a`` alone (pulses) or with ``driving_b`` (quadrature), or ``driving_count``
(a counter), with ``driving_index`` where there is one; docs/reference/recordings.md has the whole convention. Each
shaft then has readings at times of its own: edges, or the samples; ``sources`` brings them to common times. Where a
shaft's angle is stated in more than one way (an angle column beside channels, a counter beside pulses), the ways have
to agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.agreement import check_agreement, rounding
from gearpoly.recording.counters import Counter, counted
from gearpoly.recording.deeds import in_full, so_many
from gearpoly.recording.pulses import (
    HYSTERESIS,
    Counts,
    Edges,
    check_index,
    find_edges,
    pulses,
    quadrature,
)
from gearpoly.recording.recording import ANGLE_COLUMNS, RAW_COLUMNS, SHAFTS, raw_channels
from gearpoly.recording.sources import TimedColumn, brought_together, is_wrapped, unwrapped
from gearpoly.recording.table import Table
from gearpoly.units import FloatArray, IntArray

FAULT_PLACES_NAMED = 3
"""How many places of a fault are named; the rest is counted."""


def angles_from_raw(file: Path, table: Table) -> Table:
    """The table with angle columns in the place of raw channels, all at common times.

    Raises ``InputFileError`` where a key is missing, a channel does not move or has drop-outs, or the stated line
    count contradicts the index.
    """
    remarks = list(table.remarks)
    time, has_time = _times(file, table, remarks)
    sources = []
    for shaft, angle in zip(SHAFTS, ANGLE_COLUMNS, strict=True):
        ways = _ways(file, table, shaft, angle, time, remarks, has_time=has_time)
        if angle in table.columns:
            ways.insert(0, _Way(angle, TimedColumn(column=angle, time=time, values=table.columns[angle]), 0.0))
            if unused := [f"{shaft}_{c}" for c in raw_channels(table.columns, shaft)]:
                remarks.append(f"{' and '.join(unused)} not used, since {angle} gives the angle")
        for other in ways[1:]:
            _check_same(file, ways[0], other, time)
        sources += [one.source for one in ways[:1]]
    given = {one.column for one in sources} | {"time_s", *RAW_COLUMNS}
    sources += [
        TimedColumn(column=name, time=time, values=values)
        for name, values in table.columns.items()
        if name not in given
    ]
    common, columns = brought_together(file, sources, remarks)
    if has_time:
        columns = {"time_s": common, **columns}
    return Table(columns=columns, keys=table.keys, remarks=remarks)


TRAVEL_SHARE = 0.99
"""Share of the steps from reading to reading that a shaft's usual way between two of them is not below; a speed that
varies reaches it, a fault of a few samples does not.
"""


@dataclass(frozen=True)
class _Way:
    """One way to the angle of a shaft: the column it comes from, its readings in deg, and what one count of it is."""

    column: str
    source: TimedColumn
    step: float


def _ways(
    file: Path, table: Table, shaft: str, angle: str, time: FloatArray, remarks: list[str], *, has_time: bool
) -> list[_Way]:
    """What the raw channels of a shaft say of its angle: pulses first, then the counter."""
    channels = raw_channels(table.columns, shaft)
    kinds = {
        "a": tuple(c for c in channels if c != "count"),
        "count": tuple(c for c in channels if c in ("count", "index")),
    }
    return [
        _Way(f"{shaft}_{kind}", *_shaft(file, table, shaft, angle, held, time, remarks, has_time=has_time))
        for kind, held in kinds.items()
        if kind in channels
    ]


def _check_same(file: Path, first: _Way, second: _Way, time: FloatArray) -> None:
    """Raise where two ways to one angle disagree by more than a count and the way of one sample."""
    one, other = (unwrapped(s.values) if is_wrapped(s) else s.values for s in (first.source, second.source))
    there = np.interp(first.source.time, second.source.time, other, left=np.nan, right=np.nan)
    if np.nansum(np.diff(there)) * np.nansum(np.diff(one)) < 0.0 and second.column.endswith("_a"):
        there = -there  # single pulses do not see the direction
    sampled = [v for v, way in ((one, first), (other, second)) if way.source.time is time]
    # Nearly the longest step: the longest may be the very fault.
    travel = max((float(np.nanquantile(np.abs(np.diff(v)), TRAVEL_SHARE)) for v in sampled), default=0.0)
    tolerance = np.full(one.size, max(first.step, second.step) + travel) + rounding(one)
    row = np.searchsorted(time, first.source.time)
    check_agreement(
        file, (first.column, second.column), one, there, tolerance, row=row, unit="deg", any_zero=True
    )  # fmt: skip


def _times(file: Path, table: Table, remarks: list[str]) -> tuple[FloatArray, bool]:
    """The times of the samples, and whether they are seconds or only numbers of samples."""
    size = next(iter(table.columns.values())).size
    if "time_s" in table.columns:
        time = table.columns["time_s"]
        bad = ~np.isfinite(time)
        bad[1:] |= ~(np.diff(time) > 0.0)
        if bad.any():
            row = int(np.argmax(bad)) + 1
            wish = "want a time that rises from sample to sample, since edges are placed by it"
            raise InputFileError(file, where=f"column time_s, row {row}", found=in_full(time[row - 1]), wish=wish)
        return time, True
    rate = table.keys.get("sample_rate_hz")
    if isinstance(rate, int | float):
        return np.arange(size) / float(rate), True
    remarks.append("neither time_s nor sample_rate_hz: samples taken as evenly spaced, times unknown")
    return np.arange(size, dtype=np.float64), False


def _shaft(
    file: Path,
    table: Table,
    shaft: str,
    angle: str,
    channels: tuple[str, ...],
    time: FloatArray,
    remarks: list[str],
    *,
    has_time: bool,
) -> tuple[TimedColumn, float]:
    """The readings of one shaft's raw channels in deg, and what one count is."""
    lines = _key(file, table, f"{shaft}_lines", f"{shaft}_lines = 1024, the lines of the encoder on that shaft")
    if "count" in channels:
        per_line = _key(file, table, f"{shaft}_counts_per_line", f"{shaft}_counts_per_line = 4 (1 or 2 where so set)")
        per_turn = lines * per_line
        counts = _counter(file, table, shaft, per_turn, time, remarks)
        kind = "counter"
    else:
        a = _edges(file, table, f"{shaft}_a", time, remarks)
        if "b" in channels:
            per_turn, kind = 4.0 * lines, "quadrature"
            counts = quadrature(a, _edges(file, table, f"{shaft}_b", time, remarks))
        else:
            per_turn, kind = lines, "pulses, direction unseen"
            counts = pulses(a)
        _report(shaft, counts, time, remarks, quadrature="b" in channels)
    count = counts.count
    if "index" in channels:
        count = _indexed(file, table, shaft, counts, per_turn, time, remarks)
    else:
        count = _from_first(count)
        remarks.append(f"{shaft}: no index, so its reading is 0 where the recording begins")
    step = 360.0 / per_turn
    seen = "s" if has_time else "samples"
    span = f"{counts.time[0]:g} to {counts.time[-1]:g} {seen}"
    remarks.append(f"{shaft}: {kind}, {counts.time.size} readings from {span}, one count is {step:.6g} deg")
    return TimedColumn(column=angle, time=counts.time, values=count * step), step


def _key(file: Path, table: Table, key: str, example: str) -> float:
    """A key that raw channels need."""
    if key not in table.keys:
        raise InputFileError(file, found=f"raw channels without the key {key}", wish=f"want {example}")
    return _number(table, key)


def _number(table: Table, key: str) -> float:
    value = table.keys[key]
    assert isinstance(value, int | float)  # check_key has seen to it
    return float(value)


def _channel(file: Path, table: Table, name: str) -> FloatArray:
    """A pulse channel, which must not have drop-outs: counts would go missing unseen."""
    values = table.columns[name]
    bad = np.isnan(values)
    if bad.any():
        row = int(np.argmax(bad)) + 1
        wish = "want pulses without gaps (lines would go uncounted); cut the recording there"
        raise InputFileError(file, where=f"column {name}, row {row}", found=f"{int(bad.sum())} drop-outs", wish=wish)
    return values


def _edges(file: Path, table: Table, name: str, time: FloatArray, remarks: list[str]) -> Edges:
    edges = find_edges(_channel(file, table, name), time)
    if edges.sample.size < 2:
        found = f"{edges.sample.size} edges between the levels {edges.low:.4g} and {edges.high:.4g}"
        raise InputFileError(file, where=f"column {name}", found=found, wish="want a channel that switches as it turns")
    sharp = f", {edges.sharp:.0%} of them within one sample, so placed to half a sample" if edges.sharp > 0.1 else ""
    remarks.append(
        f"{name}: levels {edges.low:.4g} and {edges.high:.4g} found, threshold {0.5 * (edges.low + edges.high):.4g} "
        f"+- {HYSTERESIS * (edges.high - edges.low):.3g}, {edges.sample.size} edges{sharp}"
    )
    return edges


def _report(shaft: str, counts: Counts, time: FloatArray, remarks: list[str], *, quadrature: bool) -> None:
    if counts.illegal.size:
        places = _places(counts.illegal, time)
        remarks.append(
            f"{shaft}: {counts.illegal.size} illegal transitions, both channels at once, {places}; "
            "counted as two steps onward"
        )
    if counts.against.size and quadrature:
        places = _places(counts.against, time)
        remarks.append(f"{shaft}: {counts.against.size} steps against the run (jitter, or lost pulses), {places}")
    elif counts.against.size:
        places = _places(counts.against, time)
        remarks.append(f"{shaft}: {so_many(counts.against.size, 'pulses')} too early, {places}; counted")
    if counts.lost:
        number = sum(lost for _, lost in counts.lost)
        places = _places(np.array([sample for sample, _ in counts.lost]), time)
        remarks.append(f"{shaft}: {so_many(number, 'pulses')} lost by their time, {places}; counted on")


def _places(samples: IntArray, time: FloatArray) -> str:
    """Rows (from 1) and times of the first faults."""
    named = ", ".join(f"row {int(i) + 1} ({time[i]:.6g})" for i in samples[:FAULT_PLACES_NAMED])
    return f"at {named}" + (" ..." if samples.size > FAULT_PLACES_NAMED else "")


def _counter(file: Path, table: Table, shaft: str, per_turn: float, time: FloatArray, remarks: list[str]) -> Counts:
    """The readings of a counter, one at every sample."""
    name = f"{shaft}_count"
    bits, modulus = (table.keys.get(f"{name}_{key}") for key in ("bits", "modulus"))
    if bits is not None and modulus is not None:
        found = f"{name}_bits = {bits}, and {name}_modulus = {modulus} too"
        raise InputFileError(file, found=found, wish="want one of the two, which say where the counter goes round")
    stated = 2.0 ** float(bits) if isinstance(bits, int | float) else modulus
    counter = Counter(
        file=file, name=name, per_turn=per_turn, modulus=float(stated) if isinstance(stated, int | float) else None
    )
    count = counted(counter, table.columns[name], remarks)
    none = np.empty(0, dtype=np.int64)
    return Counts(time=time, count=count, sample=np.arange(count.size), illegal=none, against=none)


def _indexed(
    file: Path,
    table: Table,
    shaft: str,
    counts: Counts,
    per_turn: float,
    time: FloatArray,
    remarks: list[str],
) -> FloatArray:
    """Counts from the first index on, checked turn by turn."""
    name = f"{shaft}_index"
    index = find_edges(_channel(file, table, name), time)
    good = np.isfinite(counts.count)
    forward = bool(counts.count[good][-1] >= counts.count[good][0])
    # The edge that is met first when counting up, so that the place is the same both ways.
    passed = index.time[index.rising == forward]
    if not passed.size:
        remarks.append(f"{name}: no pulse, so the counts are unchecked and the reading is 0 where the recording begins")
        return _from_first(counts.count)
    check = check_index(counts.time, counts.count, passed, per_turn)
    if check.always:
        seen, stated = in_full(per_turn + check.always), in_full(per_turn)
        found = f"{seen} counts from index to index in most turns, {stated} by {shaft}_lines"
        lines = _number(table, f"{shaft}_lines") * (1.0 + check.always / per_turn)
        wish = f"want the line count of that encoder in {shaft}_lines (perhaps {in_full(lines)})"
        raise InputFileError(file, where=f"column {name}", found=found, wish=wish)
    if check.turns:
        remarks.append(
            f"{name}: {so_many(check.turns, 'turns')} checked, {len(check.lost)} with lost counts; "
            "reading 0 at the index"
        )
    else:
        remarks.append(f"{name}: {passed.size} pulse, so no turn could be checked; reading 0 at the index")
    for begin, end, number in check.lost[:FAULT_PLACES_NAMED]:
        what = so_many(abs(number), "counts lost" if number > 0 else "counts too many")
        remarks.append(f"{shaft}: {what} between {begin:.6g} and {end:.6g}; that turn left out, put right after it")
    if len(check.lost) > FAULT_PLACES_NAMED:
        number = sum(abs(one[2]) for one in check.lost)
        remarks.append(f"{shaft}: {number} counts lost or too many in {len(check.lost)} turns in all")
    if check.ignored:
        places = ", ".join(f"{t:.6g}" for t in check.ignored[:FAULT_PLACES_NAMED])
        more = " ..." if len(check.ignored) > FAULT_PLACES_NAMED else ""
        remarks.append(f"{name}: {len(check.ignored)} pulses that fit no turn, at {places}{more}; not used")
    return check.count


def _from_first(count: FloatArray) -> FloatArray:
    """Counts from the first one that is no drop-out."""
    first = float(count[np.argmax(np.isfinite(count))])
    return count - first
