"""The way in for every recording: the format is found from the file's ending and its first bytes."""

from __future__ import annotations

import functools
import importlib
import pkgutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from gearpoly import recording as package
from gearpoly.errors import InputFileError, OutOfRangeError
from gearpoly.files.paths import parted
from gearpoly.files.traces import check_file, unreadable
from gearpoly.recording.apart import read_apart
from gearpoly.recording.brought import brought
from gearpoly.recording.elsewhere import known_elsewhere
from gearpoly.recording.map_file import RecordingMap, read_map
from gearpoly.recording.parts import join_parts
from gearpoly.recording.reader import RECORDING_LIMIT_BYTES, Reader, recording_from_table
from gearpoly.recording.recording import Recording
from gearpoly.recording.runs import RUNS_NAMED, runs_of, usable
from gearpoly.recording.table import Table
from gearpoly.recording.taken import only, taken
from gearpoly.recording.text.writing import Writing

if TYPE_CHECKING:
    from gearpoly.keys.sections import WormSection

FORMAT_HEAD_BYTES = 4096
"""How much of a file is looked at to tell its format; HDF5 may begin as far in as 2048."""


@functools.cache
def readers() -> tuple[Reader, ...]:
    """Every reader of this package, found by its module's name, and those of installed packages; the fallback stands
    last."""
    names = [info.name for info in pkgutil.iter_modules(package.__path__) if info.name.endswith("_reader")]
    found = [importlib.import_module(f"{package.__name__}.{name}").READER for name in sorted(names)]
    return tuple(sorted([*found, *brought(found)], key=lambda reader: reader.fallback))


def read_recording(
    path: Path | str, *, worm: WormSection | None = None, chart: RecordingMap | None = None
) -> Recording:
    """Read the one recording of a file of any format; a guide log through the ``worm`` of the pair file, an owner's own
    file by the map ``chart``. ``FILE#2`` is the second recording of a file that holds several, or the second run of one
    that turned forth and back.

    Units and signs are those of :class:`Recording`. Raises ``InputFileError`` (file, place, cure) where the file is no
    recording or holds several, and ``MissingExtraError`` where its format needs a package that is not installed.
    """
    with sheets_named(Path(path), chart):
        file, tables, number = _opened(Path(path), chart)
        one = recording_from_table(file, taken(file, only(file, tables), chart), worm=worm)
    runs = _runs(one, number)
    if len(runs) > 1:
        each = [f"{run.source.name} ({'back' if run.backward else 'forward'}, {run.flank} flank)" for run in runs]
        named = ", ".join(each[:RUNS_NAMED]) + (" or a later one" if len(each) > RUNS_NAMED else "")
        raise InputFileError(file, found=f"{len(runs)} runs forth and back", wish=f"want one of them: {named}")
    return runs[0]


def read_recordings(
    path: Path | str, *, worm: WormSection | None = None, chart: RecordingMap | None = None
) -> list[Recording]:
    """Every recording of a file, as :func:`read_recording` reads one, and every run of those that turned forth and
    back; each of several is called by its number."""
    with sheets_named(Path(path), chart):
        file, tables, number = _opened(Path(path), chart)
        if len(tables) == 1:
            return _runs(recording_from_table(file, taken(file, tables[0], chart), worm=worm), number)
        out = []
        for k, table in enumerate(tables, start=1):
            table.remarks.insert(0, f"recording {k} of {len(tables)} in the file, each taken as one of the set")
            called = file.with_name(f"{file.name}, recording {k}")
            out += _runs(recording_from_table(called, taken(called, table, chart), worm=worm), None)
        return out


@contextmanager
def sheets_named(file: Path, chart: RecordingMap | None) -> Iterator[None]:
    """Say of a ``file`` that is refused as a recording that it is an inspection sheet, where it is one and no map says
    otherwise."""
    try:
        yield
    except InputFileError as error:
        from gearpoly.files.inspection.heads_of_sheets import is_sheet  # few files are refused

        if chart is None and "gearpoly pair --from" not in error.wish and is_sheet(file):
            wish = "want it given to gearpoly pair --from; gearpoly read shows what it holds"
            raise InputFileError(file, found="an inspection sheet, no recording", wish=wish) from error
        raise


def _opened(file: Path, chart: RecordingMap | None) -> tuple[Path, list[Table], int | None]:
    """A file as it is called from here on, its tables, and the number of the run that is asked for: the number behind a
    name is that of a run where there is one recording to be cut, and else of a recording."""
    name, number = parted(file)
    if number is not None and not find_reader(name).parts:
        tables = read_tables(name, chart)
        if len(tables) == 1:
            return name, tables, number
    return file, read_tables(file, chart), None


def _runs(recording: Recording, number: int | None) -> list[Recording]:
    """The runs of a recording that can be used, or the one of that ``number``.

    Raises ``InputFileError`` where there is no such run, or none long enough.
    """
    runs = runs_of(recording)
    if number is not None:
        file = recording.source
        if len(runs) == 1:
            wish = f"want {file.name} without #{number}: it holds one recording that turns one way"
            raise InputFileError(file, found=f"part {number} asked for", wish=wish)
        if not 1 <= number <= len(runs):
            wish = f"want {file.name}#1 to #{len(runs)}"
            raise InputFileError(file, found=f"run {number} of {len(runs)}", wish=wish)
        return [runs[number - 1]]
    return usable(runs)


def read_set(paths: Sequence[Path], maps: Sequence[Path] | None, *, worm: WormSection | None = None) -> list[Recording]:
    """The recordings of all files, by one map for all, or by one for each in their order; raises as they are read, and
    ``OutOfRangeError`` where the numbers of maps and files do not fit."""
    charts = [read_map(one) for one in maps or ()]
    if len(charts) not in (0, 1, len(paths)):
        raise OutOfRangeError(
            f"--map: {len(charts)} maps for {len(paths)} recordings; want one for all of them, or one for each in order"
        )
    each = charts if len(charts) == len(paths) else [charts[0] if charts else None] * len(paths)
    return [
        one for path, chart in zip(paths, each, strict=True) for one in read_recordings(path, worm=worm, chart=chart)
    ]


def read_tables(path: Path, chart: RecordingMap | None = None) -> list[Table]:
    """What the reader of a file's format finds in it: one table for every recording, or that of the number behind its
    name, or of the map's section."""
    tables = _tables(path, chart)
    for table in tables:
        join_parts(table)
    return tables


def _tables(path: Path, chart: RecordingMap | None) -> list[Table]:
    file, part = parted(path)
    reader = find_reader(file)
    if chart is not None and reader.several is None and chart.writing != Writing():
        wish = "want no [text] in a map for another format"
        raise InputFileError(chart.file, where="text", found=f"{file.name} is {reader.name}, no text", wish=wish)
    section = chart.section if chart is not None and part is None else None
    number = section if part is None else part
    if reader.parts:
        return [reader.read(file, number)]
    if reader.several is not None:
        mapped = chart is not None and bool(chart.columns or chart.leave_out)
        tables = reader.several(file, chart.writing if chart is not None else Writing(), mapped=mapped)
    elif part is not None:
        wish = f"want {file.name} without #{part}: a {reader.name} file holds one recording"
        raise InputFileError(path, found=f"part {part} asked for", wish=wish)
    else:
        tables = [read_apart(reader, file) if reader.apart else reader.read(file)]
    if number is None:
        return tables
    if number > len(tables):
        if chart is not None and part is None:
            found = f"{number}, and the file holds {len(tables)}"
            wish = f"want a number from 1 to {len(tables)}, or no section where there is one recording"
            raise InputFileError(chart.file, where="section", found=found, wish=wish)
        wish = f"want {file.name}#1 to #{len(tables)}" if len(tables) > 1 else f"want {file.name} without #{number}"
        raise InputFileError(path, found=f"part {number} of {len(tables)}", wish=wish)
    return [tables[number - 1]]


def find_reader(file: Path) -> Reader:
    """The reader whose ending and first bytes both fit; an ending that nobody claims leaves it to the bytes."""
    check_file(file, limit_bytes=RECORDING_LIMIT_BYTES)
    try:
        with file.open("rb") as stream:
            head = stream.read(FORMAT_HEAD_BYTES)
    except OSError as error:
        raise unreadable(file, error) from None
    known = ", ".join(reader.name for reader in readers())
    if not head:
        raise InputFileError(file, found="an empty file", wish=f"want a recording ({known})")
    ending = file.suffix.lower()
    other = known_elsewhere(head)
    if other is not None and not any(reader.recognises(head) for reader in readers() if not reader.fallback):
        raise InputFileError(file, found=other[0], wish=other[1])
    by_ending = [reader for reader in readers() if ending in reader.endings]
    by_content = [reader for reader in readers() if reader.recognises(head)]
    for reader in by_ending:
        if reader in by_content and (not reader.fallback or by_content[0] is reader):
            return reader
    if by_ending:
        wanted = " or ".join(reader.name for reader in by_ending)
        if not by_content:
            wish = f"want a {wanted} file; check the name, or export it again"
            raise InputFileError(file, found=f"no {wanted} file, for all its ending {ending}", wish=wish)
        inside = by_content[0]
        kind = "text" if inside.fallback else f"a {inside.name} file"
        wish = f"want a {wanted} file, or the ending {inside.endings[0]} if it is {inside.name}"
        raise InputFileError(file, found=f"{kind}, for all its ending {ending}", wish=wish)
    if by_content:
        return by_content[0]
    raise InputFileError(file, found="a format that is not known", wish=f"want a recording ({known})")
