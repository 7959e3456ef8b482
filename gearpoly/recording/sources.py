"""Columns that were read at different times, brought to common times.

The common times are those of the source with the fewest readings among those that make the transmission error, so that
every sample holds one true reading, and what is read more often is interpolated linearly between the two readings about
it. Nothing is resampled onto a grid, so no reading of the coarser source is lost, moved or made up.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.recording import ANGLE_COLUMNS, RAW_COLUMNS, TE_COLUMNS
from gearpoly.recording.table import Table
from gearpoly.recording.unwrapping import WRAPPED_SPAN
from gearpoly.units import FloatArray

COMPANIONS = ("torque_nm", "speed_rpm")
"""Columns that change slowly, and choose no times."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TimedColumn:
    """Values (m,) in the column's unit at rising times (m,)."""

    column: str
    time: FloatArray
    values: FloatArray


def brought_together(
    file: Path, sources: Sequence[TimedColumn], remarks: list[str]
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """The common times (k,) and every source's values (k,) there; what was done is put into ``remarks``.

    Raises ``InputFileError`` where the sources share no time, or state one thing twice at different times, so that no
    rounding says how well they should agree.
    """
    rivals = [one for one in sources if one.column not in COMPANIONS]
    base = min(rivals, key=lambda one: one.time.size)
    moved = [one.column for one in rivals if one.time is not base.time]
    errors = [one.column for one in sources if one.column in TE_COLUMNS]
    if moved and len(errors) + sum(one.column in ANGLE_COLUMNS for one in sources) > 2:
        found = f"{' and '.join(one.column for one in rivals)}, of which two give the third, read at different times"
        raise InputFileError(file, found=found, wish="want two of them; leave one out")
    begin, end = max(one.time[0] for one in rivals), min(one.time[-1] for one in rivals)
    inside = (base.time >= begin) & (base.time <= end)
    common = base.time[inside]
    if common.size < 2:
        wish = "want both shafts recorded together"
        raise InputFileError(file, found="shafts that do not turn at the same time", wish=wish)
    columns = {
        one.column: one.values[inside] if one.time is base.time else interpolated(one, common) for one in sources
    }
    cut = base.time.size - common.size
    remarks.append(
        f"angles at the {common.size} times of {base.column}, which has the fewest readings; "
        f"what is read more often or between them is interpolated linearly onto them"
        + (f"; {cut} readings outside the common time left out" if cut else "")
    )
    return common, columns


def put_on_one_axis(file: Path, table: Table, times: Mapping[str, FloatArray]) -> None:
    """Bring the columns of ``table``, each read at its own rising ``times`` in s, to common times in ``time_s``."""
    if pulses := next((name for name in table.columns if name in RAW_COLUMNS), None):
        found = f"{pulses} read at other times than other channels"
        raise InputFileError(file, found=found, wish="want raw channels sampled together; start them together")
    for name, time in times.items():
        if not time.size:
            raise InputFileError(file, where=f"column {name}", found="no values", wish="want rows of numbers")
    sources = [TimedColumn(column=name, time=times[name], values=values) for name, values in table.columns.items()]
    begins = {one.column: one.time[0] for one in sources}
    first, last = min(begins, key=begins.__getitem__), max(begins, key=begins.__getitem__)
    late = begins[last] - begins[first]
    table.remarks.append(f"channels read at times of their own: {last} begins {late:.6g} s after {first}")
    common, columns = brought_together(file, sources, table.remarks)
    table.columns = {"time_s": common, **columns}


def interpolated(one: TimedColumn, time: FloatArray) -> FloatArray:
    """A source's values (k,) at ``time`` (k,); an angle across its wraps; ``nan`` beside a drop-out and where
    it was not read."""
    wrapped = is_wrapped(one)
    values = unwrapped(one.values) if wrapped else one.values
    found = np.asarray(np.interp(time, one.time, values, left=np.nan, right=np.nan))
    if not wrapped:
        return found
    low = np.nanmin(one.values)
    # Wrapped again, since how many turns a gap took is for both shafts together to say.
    return np.asarray(np.mod(found - low, 360.0) + low)


def is_wrapped(one: TimedColumn) -> bool:
    """Whether a source is an angle that begins again after each turn: its readings span no more than one."""
    held = one.values[np.isfinite(one.values)]
    return one.column in ANGLE_COLUMNS and held.size > 0 and bool(np.ptp(held) <= WRAPPED_SPAN * 360.0)


def unwrapped(angle: FloatArray) -> FloatArray:
    """An angle (m,) in deg without the wraps at 360 between neighbours; drop-outs stay."""
    held = np.isfinite(angle)
    out = angle.copy()
    out[held] = np.unwrap(angle[held], period=360.0)
    return out
