"""The table on disk: a folder of small Parquet files, each written aside and renamed, so a row is there whole or not.

``study.json`` says what the rows are of. ``rows/<start>-<stop>.parquet`` hold them, sorted; each carries the study, its
versions and its seed in its metadata. Files are written by one process, which holds a lock on the folder.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import IO, Any, cast

import numpy as np

from gearpoly.errors import InputFileError, MissingExtraError, shown
from gearpoly.files.output import write_text, written_aside
from gearpoly.files.paths import is_file, is_folder, unreadable
from gearpoly.files.traces import parse_number, read_text
from gearpoly.study.keys import is_whole
from gearpoly.study.pipeline import MadeRow
from gearpoly.study.plan import StudyPlan, differences
from gearpoly.units import FloatArray

MANIFEST_FILE, ROWS_FOLDER, LOCK_FILE = "study.json", "rows", ".lock"
FORMULA = tuple("=+-@\t\r")
"""With what a cell begins that a spreadsheet computes."""

_MANIFEST = {"gearpoly": str, "seed": int, "rows": int, "finished": bool, "why": str, "plan": str}
_PART = re.compile(r"^(\d{9})-(\d{9})\.parquet$")


def pyarrow() -> Any:
    """The pyarrow package with its Parquet part. Raises ``MissingExtraError`` with the cure where it is missing."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise MissingExtraError("a study's table is Parquet; pip install gearpoly[parquet]") from None
    return pyarrow


@dataclass(frozen=True)
class Store:
    """The rows of one ``plan`` in one ``folder``."""

    folder: Path
    plan: StudyPlan

    @property
    def _rows(self) -> Path:
        return self.folder / ROWS_FOLDER

    def parts(self) -> list[tuple[int, int, Path]]:
        """Start, stop and file of every part, in order."""
        try:
            found = [(_PART.match(path.name), path) for path in self._rows.iterdir()]
        except OSError as error:
            raise unreadable(self._rows, error) from None
        return sorted((int(match[1]), int(match[2]), path) for match, path in found if match)

    def done(self) -> list[tuple[int, int]]:
        """Rows that are there, as ranges."""
        return [(start, stop) for start, stop, _ in self.parts()]

    @cached_property
    def schema(self) -> Any:
        """Columns: number, combination, draw, seed, status, reason, swept keys by their dotted names, outputs."""
        pa = pyarrow()
        file, design = self.plan.file, self.plan.design
        sample = design.values(0)
        kinds = {bool: pa.bool_(), int: pa.int64(), float: pa.float64(), str: pa.string()}

        def kind(key: str) -> Any:
            values = [design.values(k)[key] for k in range(min(design.combinations, 64))]
            if any(isinstance(value, float) for value in values) and not is_whole(key):
                return pa.float64()
            return kinds.get(type(sample[key]), pa.string())

        fields = [
            ("index", pa.int64()), ("combination", pa.int64()), ("draw", pa.int64()), ("seed", pa.int64()),
            ("status", pa.string()), ("reason", pa.string()), *((key, kind(key)) for key in design.keys),
            *((name, pa.float64()) for name in file.outputs),
        ]  # fmt: skip
        metadata = {
            "gearpoly.study": json.dumps(self.plan.what, sort_keys=True),
            "gearpoly.versions": json.dumps(self.plan.versions | {"pyarrow": pa.__version__}, sort_keys=True),
            "gearpoly.seed": str(file.seed),
        }
        return pa.schema(fields, metadata=metadata)

    def write(self, rows: Sequence[MadeRow]) -> None:
        """One part of rows that follow one another. Raises ``InputFileError`` where the disk takes no more."""
        pa = pyarrow()
        columns: list[list[Any]] = [[r.index, r.combination, r.draw, r.seed, r.status, r.reason] for r in rows]
        for column, row in zip(columns, rows, strict=True):
            column += [row.values[key] for key in self.plan.design.keys]
            column += [None if np.isnan(value) else value for value in row.outputs]
        arrays = [
            pa.array([_fitting(row[k], field.type) for row in columns], type=field.type)
            for k, field in enumerate(self.schema)
        ]
        table = pa.Table.from_arrays(arrays, schema=self.schema)
        self._write_table(table, rows[0].index, rows[-1].index + 1)

    def _write_table(self, table: Any, start: int, stop: int) -> None:
        with written_aside(self._rows / f"{start:09d}-{stop:09d}.parquet") as aside:
            pyarrow().parquet.write_table(table, aside, compression="zstd")

    def trim(self, rows: int) -> None:
        """Drop what lies beyond the first ``rows`` rows: computed before it was known that they are enough."""
        for start, stop, path in self.parts():
            if stop <= rows:
                continue
            if start < rows:
                self._write_table(read_part(path).slice(0, rows - start), start, rows)
            path.unlink()

    def clear(self) -> None:
        """Drop every row and the manifest; the folder is as fresh as before the first run."""
        for _, _, path in self.parts():
            path.unlink()
        (self.folder / MANIFEST_FILE).unlink(missing_ok=True)

    def column(self, name: str, *, rows: int | None = None) -> Any:
        """One column over all parts (or those within the first ``rows``) as a numpy array, missing numbers as nan."""
        return self.columns([name], rows=rows)[name]

    def columns(self, names: Sequence[str], *, rows: int | None = None) -> dict[str, Any]:
        """Several columns as numpy arrays, in the order of the row numbers."""
        paths = [path for _, stop, path in self.parts() if rows is None or stop <= rows]
        found: dict[str, list[Any]] = {name: [] for name in names}
        for path in paths:
            table = read_part(path, columns=names)
            for name in names:
                found[name].append(table[name].to_numpy())
        return {name: np.concatenate(parts) if parts else np.empty(0) for name, parts in found.items()}

    def to_csv(self, target: Path) -> None:
        """The whole table as CSV, part by part; numbers read back equal, and no text is a formula to a spreadsheet."""
        with written_aside(target) as aside, aside.open("w", newline="", encoding="utf-8") as out:
            writer = csv.writer(out, lineterminator="\n")
            writer.writerow(self.schema.names)
            for _, _, path in self.parts():
                for row in read_part(path).to_pylist():
                    writer.writerow([_cell(value) for value in row.values()])


def read_part(path: Path, *, columns: Sequence[str] | None = None) -> Any:
    """The table in one part, or some ``columns`` of it. Raises ``InputFileError`` where it is cut off or damaged."""
    with _damage_told(path):
        table = pyarrow().parquet.read_table(path, columns=None if columns is None else list(columns))
        missing = [name for name in columns or () if name not in table.column_names]
        if missing:
            raise ValueError(f"no column {missing[0]}")
    _check_count(path, table.num_rows)
    return table


def _what_in(path: Path) -> dict[str, Any]:
    """What the rows of one part are of, from its own metadata. Raises ``InputFileError`` as ``read_part`` does."""
    with _damage_told(path):
        found = pyarrow().parquet.read_metadata(path)
        what: dict[str, Any] = dict(json.loads(found.metadata[b"gearpoly.study"]))
    _check_count(path, found.num_rows)
    return what


def _check_count(path: Path, rows: int) -> None:
    match = _PART.match(path.name)
    if match and rows != int(match[2]) - int(match[1]):
        raise _damaged(path, f"{rows} rows, which is not what its name says")


@contextmanager
def _damage_told(path: Path) -> Iterator[None]:
    """The library promises no exception types for damage, so all are taken."""
    try:
        yield
    except Exception as error:
        raise _damaged(path, shown(str(error), width=120)) from None


def _damaged(path: Path, reason: str) -> InputFileError:
    wish = "delete it and run the study again, which makes its rows and no others"
    return InputFileError(path, found=f"a cut-off or damaged part ({reason})", wish=wish)


def _cell(value: Any) -> Any:
    """A value as a cell of a CSV: a text that a spreadsheet would take for a formula gets its mark for text, an
    apostrophe in front (OWASP, CSV injection)."""
    if isinstance(value, str) and value[:1] in FORMULA and parse_number(value) is None:
        return f"'{value}"
    return "" if value is None else value


def _fitting(value: Any, kind: Any) -> Any:
    return (
        float(value) if str(kind) == "double" and value is not None else str(value) if str(kind) == "string" else value
    )


def read_store(folder: Path) -> tuple[Store, dict[str, Any]]:
    """An existing table and its manifest, to be read. Raises ``InputFileError`` where there is none."""
    manifest = folder / MANIFEST_FILE
    if not is_file(manifest):
        raise InputFileError(
            folder, found=f"no {MANIFEST_FILE}", wish="want the folder that gearpoly study --out has filled"
        )
    try:
        document = json.loads(read_text(manifest))
        for key, kind in _MANIFEST.items():
            if not isinstance(document[key], kind):
                raise TypeError(f"{key} = {shown(repr(document[key]))}")
        plan = StudyPlan(document["plan"])
        # Asked for what they raise: a plan that is none fails here.
        plan.what, plan.versions, plan.design.combinations, plan.design.values(0)
    except (ValueError, KeyError, TypeError, AttributeError, IndexError, RecursionError) as error:
        reason = f"no {error}" if isinstance(error, KeyError) else shown(str(error), width=120)
        wish = "delete it and run the study again, which keeps the finished rows"
        raise InputFileError(manifest, found=f"a damaged manifest ({reason})", wish=wish) from None
    if not is_folder(folder / ROWS_FOLDER):
        raise InputFileError(folder, found=f"no folder {ROWS_FOLDER}", wish="run the study again")
    return Store(folder, plan), document


def write_manifest(store: Store, *, rows: int, finished: bool, why: str) -> None:
    """Note what the folder holds and how far it is meant to go."""
    document = {
        "gearpoly": store.plan.versions["gearpoly"],
        "name": store.plan.file.name,
        "seed": store.plan.file.seed,
        "rows": rows,
        "finished": finished,
        "why": why,
        "what": store.plan.what,
        "plan": store.plan.text,
    }
    write_text(store.folder / MANIFEST_FILE, json.dumps(document, indent=1, sort_keys=True))


@contextmanager
def opened(folder: Path, plan: StudyPlan) -> Iterator[Store]:
    """The table of ``plan`` in ``folder``, begun or taken up again, for this process alone.

    Raises ``InputFileError`` where the folder holds other rows than ``plan`` would make (says what changed), something
    that is no study, or another run that is still going.
    """
    store = Store(folder, plan)
    pyarrow()
    before = None
    if is_file(folder / MANIFEST_FILE):
        before = read_store(folder)[0].plan.what
    elif is_folder(folder) and not _ours(folder):
        raise InputFileError(folder, found="a folder with other things in it", wish="want a new or empty folder")
    if is_folder(folder / ROWS_FOLDER):
        for _, _, path in store.parts():  # each says itself what it is of, should the manifest be lost
            inside = _what_in(path)
            before = inside if before is None else before
    if before is not None:
        changed = differences(before, json.loads(json.dumps(plan.what)))
        if changed:
            more = f" and {len(changed) - 5} more" if len(changed) > 5 else ""
            raise InputFileError(
                folder,
                found="rows of another study: " + "; ".join(changed[:5]) + more,
                wish="these do not mix; want another --out, or the study as it was",
            )
    try:
        (folder / ROWS_FOLDER).mkdir(parents=True, exist_ok=True)
        lock = (folder / LOCK_FILE).open("a")
    except OSError as error:
        raise InputFileError(
            folder, found=error.strerror or str(error), wish="want a folder that can be written to"
        ) from None
    with lock:
        _hold(lock, folder)
        # What a killed run was writing has no name yet and holds nothing.
        for aside in (folder / ROWS_FOLDER).glob(".gearpoly-*"):
            aside.unlink(missing_ok=True)
        yield store


def _ours(folder: Path) -> bool:
    """Whether ``folder`` is one of a study whose manifest is not written yet, or lost: it has rows, or nothing else."""
    try:
        names = {path.name for path in folder.iterdir() if not path.name.startswith(".gearpoly-")}
        rows = {path.name for path in (folder / ROWS_FOLDER).iterdir()} if ROWS_FOLDER in names else set()
    except OSError as error:
        raise unreadable(folder, error) from None
    parts = {name for name in rows if _PART.match(name)}
    return bool(parts) or (names <= {LOCK_FILE, ROWS_FOLDER} and all(name.startswith(".gearpoly-") for name in rows))


def _hold(lock: IO[str], folder: Path) -> None:
    """Take the folder for this process; the system lets go of it when the process ends, however it ends."""
    try:
        import fcntl
    except ImportError:  # a system without it has no such lock, and one run at a time is up to the user
        return
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise InputFileError(
            folder, found="another run is writing here", wish="wait for it, or want another --out"
        ) from None


def as_numbers(values: Any) -> FloatArray:
    """A numeric column as float64."""
    return cast("FloatArray", np.asarray(values, dtype=np.float64))
