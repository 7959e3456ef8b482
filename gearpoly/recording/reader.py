"""What the readers of recordings share: the table they fill, and the checks that keep a bad file from doing harm.

A reader is one module of this package whose name ends in ``_reader`` and which holds a ``READER``. It finds columns and
keys in its format; it takes no memory before ``check_numbers`` has seen the sizes that the file states, and it runs and
unpickles nothing.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from gearpoly.errors import GearpolyError, InputFileError, MissingExtraError, told_at_most, told_beside
from gearpoly.files.toml import load
from gearpoly.files.traces import nearest, shorten
from gearpoly.recording.agreement import check_agreement, rounding
from gearpoly.recording.by_readings import are_whole_turns, contradicting, counter_modulus
from gearpoly.recording.by_speed import check_speed
from gearpoly.recording.by_turns import bring_together
from gearpoly.recording.clock_set import on_one_clock
from gearpoly.recording.finite import has_infinite
from gearpoly.recording.in_name import in_name
from gearpoly.recording.looks_like import check_units
from gearpoly.recording.map_lines import counter_entries, entry
from gearpoly.recording.pulse_times import angles_from_pulse_times
from gearpoly.recording.quantities import column_unit
from gearpoly.recording.raw import angles_from_raw
from gearpoly.recording.recording import (
    ANGLE_COLUMNS,
    COLUMNS,
    KEYS,
    PASSED_OVER,
    RAW_COLUMNS,
    SHAFTS,
    TE_COLUMNS,
    Recording,
    check_complete,
    check_key,
    recording_from_columns,
)
from gearpoly.recording.table import AXIS_ERROR, PULSE_TIMES, Table
from gearpoly.recording.worm import at_the_worm
from gearpoly.units import ARCSEC, URAD, FloatArray

if TYPE_CHECKING:  # models of pair files take long to import, and few recordings are guide logs
    from gearpoly.keys.sections import WormSection

RECORDING_LIMIT_BYTES = 4 * 2**30
"""Largest recording that is read: as a file, and as the memory that reading takes."""

DEEPEST_NESTING = 4
"""Groups or structs within one another that are looked through: data of a run of a test of a rig."""

KEY_TEXT_LIMIT = 1000
"""Longest text that a key may have, in characters; ``flank`` needs five."""

NUMBER_BYTES = 32
"""Memory that reading takes for each number at its peak: the 8 bytes that are kept, those that the file stores, and the
parser's own. Measured with 4 10^6 numbers (benchmarks.reading): 8 (HDF5) to 29 bytes (MAT 5 with a struct).
"""

SMALL_LIMIT_BYTES = 3 * 2**27
"""The same where the file is small: 1.7 kB of HDF5 can state any size and hold nothing of it. 384 MB are 1.2 10^7
numbers; cleaning and comparing hold ten times their 8 bytes, so that the whole process stays below 1.5 GB.
"""

UNPACKED_MOST = 36
"""Times its size that a file may take where that is more (from 11 MB on): nine times its size in numbers. Angles with
noise pack to a half; what packs to less than a ninth repeats itself.
"""

NAME_CUTOFF = 0.7
"""Likeness (difflib, 0..1) from which a foreign name counts as one of ours misspelt, not as a remark or another
channel.
"""

NAMES_LIMIT = 2000
"""Most channels or variables that are looked through for ours; a recording has a handful."""

VALUE_LIMIT = 1000
"""Longest value of a key in characters; ``flank`` needs seven, a number twenty."""


@dataclass(frozen=True, kw_only=True)
class Reader:
    """One format: its name, its file endings, how its first bytes look and how it is read.

    ``recognises`` gets the first 4096 bytes. ``module`` is the optional package that ``read`` imports and ``extra``
    the extra that brings it; both are empty where the core suffices. A ``fallback`` is asked last. ``apart``: a damaged
    file can bring the library to crash or to go round for ever, so it reads in a process of its own. ``parts``: a file
    may hold several recordings, of which ``read`` takes the number, from 1, as a second argument. ``several`` reads a
    format whose files may hold more than one recording and be written in more than one way (a ``Writing``), ``mapped``
    where a map speaks of columns.
    """

    name: str
    endings: tuple[str, ...]
    recognises: Callable[[bytes], bool]
    read: Callable[..., Table]
    module: str = ""
    extra: str = ""
    fallback: bool = False
    apart: bool = False
    parts: bool = False
    several: Callable[..., list[Table]] | None = None


def optional(file: Path, module: str, *, extra: str) -> Any:
    """An optional package, or ``MissingExtraError`` that names the extra."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.split(".")[0]
        raise MissingExtraError(
            f"{file}: this format needs {package}, which is not here ({error}); pip install gearpoly[{extra}]"
        ) from None


@contextmanager
def damage_reported(file: Path, format_name: str) -> Iterator[None]:
    """Turn whatever a format's library raises on a damaged file into an ``InputFileError``.

    The libraries promise no exception types for damage, so all are taken; the user's files are at fault far more
    often than the library, and the original error stays in the chain.
    """
    try:
        yield
    except GearpolyError:
        raise
    except Exception as error:
        reason = shorten(" ".join(str(error).split()) or type(error).__name__, width=120)
        cut = "truncat" in reason.lower() or "end of file" in reason.lower() or "buffer of" in reason.lower()
        found = f"a {'cut-off' if cut else 'damaged'} {format_name} file ({reason})"
        raise InputFileError(file, found=found, wish="want the whole file; copy or export it again") from error


def recording_from_table(file: Path, table: Table, *, worm: WormSection | None = None) -> Recording:
    """The recording in a table, after the checks that every format needs; a telescope's axis is watched through its
    ``worm``."""
    if AXIS_ERROR in table.columns:
        table = at_the_worm(file, table, worm)
    if any(name in PULSE_TIMES for name in table.columns):
        table = angles_from_pulse_times(file, table)
    entries = table.entries
    check_complete(file, "", table.columns)
    lengths = {name: values.size for name, values in table.columns.items()}
    if len(set(lengths.values())) > 1:
        found = "columns of unequal length, " + ", ".join(f"{name}: {size}" for name, size in lengths.items())
        raise InputFileError(file, found=found, wish="want one value in each column for every sample")
    if not next(iter(lengths.values())):
        raise InputFileError(file, found="columns without rows", wish="want rows of numbers")
    check_units(file, table)
    for doubt in in_name(file, table.keys, table.columns):
        table.remarks.append(f"{doubt.says}, in a map: {' '.join(doubt.ask)}")
    for doubt in on_one_clock(table):
        table.remarks.append(f"{doubt.says}; in a map, if the clock was set: {' '.join(doubt.ask)}")
    bring_together(file, table)
    check_speed(file, table)
    for name in ANGLE_COLUMNS:
        other = contradicting(table.columns[name], column_unit(name)) if name in table.columns else None
        if other is not None:
            wish = f"want degrees, or a map with {entry(name, name, other)}"
            found = f"readings that begin again after one turn as in {other.name}"
            raise InputFileError(file, where=f"column {name}", found=found, wish=wish)
    around = {one: counter_modulus(table.columns[one]) for one in ANGLE_COLUMNS if one in table.columns}
    counts = {one: modulus for one, modulus in around.items() if modulus is not None and not are_whole_turns(modulus)}
    for name, modulus in counts.items():  # all of them are in the lines, so that one map cures them
        lines = [line for one, at in counts.items() for line in counter_entries(one, one, at, stated=True)]
        found = f"readings that are counts, and begin again after {modulus}"
        wish = f"want degrees, or a map with {' '.join(lines)}"
        raise InputFileError(file, where=f"column {name}", found=found, wish=wish)
    if "te_urad" in table.columns and "te_arcsec" in table.columns:
        _take_one_error(file, table)
    places = _last_places(table)
    if any(name in RAW_COLUMNS for name in table.columns):
        table = angles_from_raw(file, table)
    elif "time_s" not in table.columns and (rate := table.keys.get("sample_rate_hz")):
        table.columns["time_s"] = np.arange(next(iter(table.columns.values())).size) / float(str(rate))
    return recording_from_columns(file, table.columns, table.keys, table.remarks, places=places, entries=entries)


def _last_places(table: Table) -> dict[str, float]:
    """Half of the last place to which columns were written, where one follows from the others; nothing elsewhere."""
    tied = [name for name in table.columns if name in ANGLE_COLUMNS or name in TE_COLUMNS]
    if len(tied) < 3 and sum(name in TE_COLUMNS for name in tied) < 2:
        return {}
    return {
        name: table.places.get(name) or float(np.nanmax(rounding(table.columns[name]), initial=0.0)) for name in tied
    }


def _take_one_error(file: Path, table: Table) -> None:
    """Keep one of two columns that give the transmission error as an angle, where both say the same."""
    held, other = table.columns["te_urad"], table.columns.pop("te_arcsec")
    unit = ARCSEC / URAD
    tolerance = rounding(held) + unit * rounding(other)
    names = ("te_urad", "te_arcsec")
    check_agreement(file, names, held, unit * other, tolerance, unit="urad", any_zero=False)
    table.remarks.append("te_arcsec says the same as te_urad")


def check_few(file: Path, where: str, count: int, what: str) -> None:
    """Raise ``InputFileError`` where there are more names than anyone gives a recording; each is looked through."""
    if count > NAMES_LIMIT:
        wish = f"want a file with the columns of one recording, and at most {NAMES_LIMIT} {what}"
        raise InputFileError(file, where=where, found=f"more than {NAMES_LIMIT} {what}", wish=wish)


def check_short(file: Path, where: str, name: str, value: str) -> None:
    """Raise ``InputFileError`` where a key's value is too long to be a number or a word; parsing it takes memory."""
    if len(value) > VALUE_LIMIT:
        found = f"{name} = {shorten(value)} of {len(value)} characters"
        raise InputFileError(file, where=where, found=found, wish=f"want a value of at most {VALUE_LIMIT} characters")


def is_key(file: Path, where: str, name: str, *, own: bool = True) -> bool:
    """Whether ``name`` is a key; a name that is nearly one is refused beside the contract's ``own`` columns, any other
    is a remark of the rig's."""
    if name in KEYS:
        return True
    if own and (close := nearest(name, KEYS, cutoff=NAME_CUTOFF)):
        wish = f'the nearest known key is "{close}" (known: {", ".join(KEYS)})'
        raise InputFileError(file, where=where, found=f'unknown key "{shorten(name)}"', wish=wish)
    return False


def take_key(file: Path, where: str, name: str, value: object, keys: dict[str, object]) -> None:
    """Put a key's value into ``keys`` after its check; the same key may come twice only with the same value."""
    if isinstance(value, np.ndarray | np.generic) and value.size == 1:
        value = value.reshape(-1)[0].item() if isinstance(value, np.ndarray) else value.item()
    if isinstance(value, bytes):
        value = value.decode("utf-8", errors="replace")
    check_key(file, where, name, value)
    if name in keys and keys[name] != value:
        found = f"{name} = {value} and {name} = {keys[name]}"
        raise InputFileError(file, where=where, found=found, wish="want each key once")
    keys[name] = value


def text_value(text: str) -> object:
    """The value of a key in a format that holds only text: TOML as in a CSV, or a bare word (``coast``)."""
    try:
        return load(f"value = {text.strip()}")["value"]
    except (ValueError, KeyError):
        return text.strip()


def pass_over(table: Table) -> None:
    """Leave out the columns of a simulation's own table that no recording needs, with a remark."""
    for name in PASSED_OVER:
        if table.columns.pop(name, None) is not None:
            table.remarks.append(f"{name} passed over: it belongs to a simulation")


def memory_limit(file: Path) -> int:
    """Bytes of memory that reading ``file`` may take."""
    return min(RECORDING_LIMIT_BYTES, max(SMALL_LIMIT_BYTES, UNPACKED_MOST * file.stat().st_size))


def check_numbers(file: Path, count: int, *, beside: int = 0) -> None:
    """Raise ``InputFileError`` where ``count`` numbers, by the file's own account, would fill the memory; ``beside``
    are bytes that are needed along with them."""
    needed, limit = NUMBER_BYTES * count + beside, memory_limit(file)
    if needed > limit:
        size = file.stat().st_size
        takes = told_beside(needed / 2**20, limit / 2**20, 0)
        found = f"{count} numbers, which take {takes} MB to read, in a file of {size / 2**20:.3g} MB"
        wish = f"want at most {told_at_most(limit / 2**20, 0)} MB for a file of that size; split it"
        if limit < RECORDING_LIMIT_BYTES:
            wish += ", or store it without compression"
        raise InputFileError(file, found=found, wish=wish)


def since_first(stamps: npt.NDArray[Any]) -> FloatArray:
    """Time stamps (n,) as seconds since the first of them; ``nan`` where there is none."""
    held = stamps[~np.isnat(stamps)]
    if not held.size:
        return np.full(stamps.size, np.nan)
    # Differences of whole ticks first: seconds since 1970 would leave half a microsecond.
    return np.asarray(np.where(np.isnat(stamps), np.nan, (stamps - held[0]) / np.timedelta64(1, "s")))


def numbers(file: Path, name: str, values: npt.NDArray[Any]) -> FloatArray:
    """One column as float64 (n,); a row or a column of a matrix counts, text and complex numbers do not. Time stamps
    are seconds since the first of them."""
    if name == "time_s" and values.dtype.kind in "mM":
        values = since_first(values)
    if values.dtype.kind not in "iufb":
        wish = "want plain numbers"
        raise InputFileError(file, where=f"column {name}", found=f"values of type {values.dtype}", wish=wish)
    if values.ndim != 1:
        if values.size != max(values.shape, default=0):
            shape = " x ".join(str(n) for n in values.shape)
            raise InputFileError(file, where=f"column {name}", found=f"shape {shape}", wish="want one value a sample")
        values = values.reshape(-1)
    column = np.ascontiguousarray(values, dtype=np.float64)
    check_finite(file, name, column)
    return column


def check_finite(file: Path, name: str, column: FloatArray) -> None:
    """Raise ``InputFileError`` where a column (n,) holds an infinite number."""
    if has_infinite(column):
        row = int(np.argmax(np.isinf(column))) + 1
        wish = "want a finite number (nan for a drop-out)"
        raise InputFileError(file, where=f"column {name}, row {row}", found="inf", wish=wish)


def offered(
    file: Path, sizes: Mapping[str, int], own: Collection[str], remarks: list[str], *, beside: int = 0
) -> list[str]:
    """The names among ``sizes`` (numbers in each channel) that are read: all, or the contract's ``own`` alone where all
    would fill the memory. Raises ``InputFileError`` where those do; ``beside`` as in :func:`check_numbers`."""
    check_numbers(file, sum(sizes[name] for name in own or sizes), beside=beside)
    if NUMBER_BYTES * sum(sizes.values()) + beside <= memory_limit(file):
        return list(sizes)
    left = [name for name in sizes if name not in own]
    remarks.append(f"not read, since they would fill the memory: {shorten(', '.join(left), width=200)}")
    return [name for name in sizes if name in own]


WISHED_SERIES_APART = "each column of a matrix or of a table as a series of its own"
"""What makes a recording of numbers that are kept together."""


def check_held(file: Path, where: str, table: Table, left: Collection[str]) -> None:
    """Raise ``InputFileError`` where a ``table`` has no numbers; say what was ``left`` out where it has."""
    said = shorten(", ".join(left), width=200)
    if not table.columns and not table.others:
        held = f"no column of a recording, only {said}" if left else "no columns"
        apart = f"{WISHED_SERIES_APART}, or " if left else ""
        raise InputFileError(file, where=where, found=held, wish=f"want {apart}columns of {', '.join(COLUMNS)}")
    if left and len(table.columns) + len(table.others) < len(SHAFTS) and table.unread is None:
        table.unread = (f"{said}, which is no series of plain numbers", f"want {WISHED_SERIES_APART}")
    if left:
        table.remarks.append(f"not read, since no series of plain numbers: {said}")
