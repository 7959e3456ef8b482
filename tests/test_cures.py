"""Every refusal of a file names a cure that works: each was tried here, and a new refusal without a tried cure is red.

A case makes the bad file, sees the message with the words of its cure, does what they say, and tries again. Where the
bad attempt was refused is taken from the traceback, so that the statements that raise can be counted.
"""

from __future__ import annotations

import ast
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from gearpoly.errors import GearpolyError
from gearpoly.recording.reader import Reader, check_finite
from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.table import Table
from tests.cures import (
    commands,
    compared,
    designs,
    formats,
    guide_logs,
    maps,
    owners,
    pairs,
    pulse_times,
    rest,
    sheets,
    tables,
    texts,
    universal,
)
from tests.cures.cure import PACKAGE, site

CURES = {
    f"{module.__name__.rpartition('.')[2]}: {case.name} {k}": case
    for module in (
        texts,
        maps,
        formats,
        universal,
        guide_logs,
        owners,
        sheets,
        tables,
        designs,
        pairs,
        pulse_times,
        commands,
        compared,
        rest,
    )
    for k, case in enumerate(module.CURES)
}

LOOKED_AT = (
    *sorted((PACKAGE / "recording").rglob("*.py")),
    *sorted((PACKAGE / "files").rglob("*.py")),
    PACKAGE / "commands" / "read.py",
    PACKAGE / "commands" / "pair.py",
    PACKAGE / "inspected.py",
    PACKAGE / "compare" / "scale.py",
    PACKAGE / "compare" / "stated.py",
    PACKAGE / "compare" / "zeros.py",
)

INTERNAL = {
    "BrokenError": "mat5_reader.read_table tells it as a damaged file, whose cure is tried",
    "BadCellError": "the line's own error is made of it",
    "ValueError": "of a cell, a word or a caller in Python; what a file brings is caught where the file is known",
    "OverLimitError": "files.toml.parse tells it with the limit, which is tried",
    "EOFError": "the process apart ended; it is asked again, or told as a crash",
    "TimeoutError": "told as a file that did not end",
    "_CrashedError": "told as a crash",
    "RuntimeError": "a bug of a reader, which no file may bring",
}
"""Errors that no user sees, by their class."""

ALLOWED = {
    ("*", "*", "unreadable("): "the system's own refusals: a circle of links and a long name are tried; who runs tests "
    "as a super-user can read everything else",
    (
        "recording/apart.py",
        "read_apart",
        "_damaged(",
    ): "tests/test_read_apart.py brings a crash and a file without end; "
    "the cure is the whole file, as for every damaged file",
    ("recording/apart.py", "read_apart", "MissingExtraError(answer"): "what the process apart says: tried in this one",
    (
        "recording/apart.py",
        "read_apart",
        "InputFileError(file, **answer",
    ): "what the process apart says: tried in this one",
    ("recording/reader.py", "numbers", "InputFileError(file, where=f'column {name}', found=f'values of type"): "every "
    "reader refuses such columns by its format's own types before; a reader to come may not",
    ("recording/tdms_reader.py", "_check_sizes", "InputFileError("): "npTDMS refuses such files first as far as seen; "
    "guards the memory",
    ("recording/csv_reader.py", "_check_names", "InputFileError("): "read_tables tells the fault of the contract's own "
    "form in its place",
    ("recording/matlab_tables.py", "read_table", "InputFileError("): "take_tables tells it with the line for MATLAB, "
    "which is tried",
    ("files/output.py", "check_target", "InputFileError(target, found='the folder is read-only'"): "no folder is "
    "read-only to a super-user",
    ("files/output.py", "check_folder", "InputFileError(target, found='the folder is read-only'"): "the same",
    (
        "files/output.py",
        "written_aside",
        "InputFileError(target, found=error.strerror or str(error), wish='want a folder",
    ): "the same, where the system finds it later",
    ("files/samples.py", "samples", "InputFileError(PACKAGE"): "an installation without its data",
    ("files/samples.py", "copy_samples", "InputFileError(target, found=error.strerror"): "a full disk",
    ("files/streams.py", "*", "_unwritable("): "tests/test_output_targets.py closes standard output",
    ("recording/brought.py", "*", "plugin.fault("): "a fault of an installed package, not of a file: "
    "tests/test_plugins.py brings them",
    ("files/traces.py", "read_text", "too_large("): "a file that grows while it is read",
}
"""Statements that no file in a test can bring: file, function and how what they raise begins, with the reason."""


def direct(reader: Reader, file: Path, *arguments: Any) -> Table:
    """``read_apart`` in this process, where a traceback shows the place."""
    table = reader.read(file, *arguments)
    for name, values in table.columns.items():
        if name in COLUMNS:
            check_finite(file, name, values)
    return table


@pytest.fixture
def _in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("read", "mat5_reader"):
        monkeypatch.setattr(f"gearpoly.recording.{module}.read_apart", direct)


SITES: dict[str, tuple[str, int]] = {}
"""Where the cases that ran in this process were refused, so that none need run twice to be counted."""


def refused(name: str, folder: Path) -> GearpolyError:
    with pytest.raises(GearpolyError) as caught:
        CURES[name].bad(folder)
    SITES[name] = site(caught.value)
    return caught.value


@pytest.mark.long
@pytest.mark.usefixtures("_in_this_process")
@pytest.mark.parametrize("name", CURES)
def test_the_cure_that_a_refusal_names_works(tmp_path: Path, name: str) -> None:
    case = CURES[name]
    message = str(refused(name, tmp_path))
    assert case.says in message
    case.good(tmp_path, message)


def raises(tree: ast.AST, function: str = "") -> Iterator[tuple[ast.Raise, str]]:
    """Every raise below ``tree`` with the function that it stands in."""
    for child in ast.iter_child_nodes(tree):
        if isinstance(child, ast.Raise):
            yield child, function
        yield from raises(child, child.name if isinstance(child, ast.FunctionDef) else function)


def reason(file: str, function: str, raised: ast.expr | None) -> str:
    """Why a statement needs no case, or nothing."""
    if raised is None or isinstance(raised, ast.Name):
        return INTERNAL.get(raised.id, "it was raised before") if raised is not None else "it was raised before"
    text = ast.unparse(raised)
    if (said := INTERNAL.get(text.partition("(")[0])) is not None:
        return said
    places = ((f, n, begin) for f, n, begin in ALLOWED if f in ("*", file) and n in ("*", function))
    return next((ALLOWED[one] for one in places if text.startswith(one[2])), "")


@pytest.mark.usefixtures("_in_this_process")
@pytest.mark.long
def test_every_refusal_has_a_cure_that_was_tried() -> None:
    for name in CURES.keys() - SITES.keys():
        with tempfile.TemporaryDirectory() as folder:
            refused(name, Path(folder))
    tried, lacking = set(SITES.values()), []
    for file in LOOKED_AT:
        name = file.relative_to(PACKAGE).as_posix()
        for one, function in raises(ast.parse(file.read_text(encoding="utf-8"))):
            held = any(at == name and one.lineno <= line <= (one.end_lineno or 0) for at, line in tried)
            if not held and not reason(name, function, one.exc):
                lacking.append(f"{name}:{one.lineno} {function}: {ast.unparse(one)[:100]}")
    assert not lacking, "refusals of which no cure was tried:\n" + "\n".join(lacking)


def test_what_needs_no_case_is_there() -> None:
    """A reason outlives the statement that it was for."""
    seen = set()
    for file in LOOKED_AT:
        name = file.relative_to(PACKAGE).as_posix()
        for one, function in raises(ast.parse(file.read_text(encoding="utf-8"))):
            text = "" if one.exc is None else ast.unparse(one.exc)
            seen |= {
                key
                for key in ALLOWED
                if key[0] in ("*", name) and key[1] in ("*", function) and text.startswith(key[2])
            }
            seen |= {key for key in INTERNAL if text.partition("(")[0] == key}
    assert seen == {*ALLOWED, *INTERNAL}
