"""Cases on disk: where their files are, and what has been sealed."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from gearpoly.errors import InputFileError, shown
from gearpoly.files.paths import is_file, is_folder

RECORDING_ENDINGS = (".csv", ".parquet", ".h5", ".hdf5", ".mat", ".tdms", ".uff", ".unv")
"""Recordings that `gearpoly diagnose` reads."""


@dataclass(frozen=True, kw_only=True)
class CaseFiles:
    """The files of a case; only the scorer opens ``truth``."""

    name: str
    pair: Path
    recordings: tuple[Path, ...]
    truth: Path


def case_files(folder: Path, name: str, *, truths: Path) -> CaseFiles:
    """The files of the case ``name`` of ``folder``, its truth among ``truths``. Raises ``InputFileError`` where
    something is missing."""
    place = folder / name
    pair, truth = place / "pair.toml", truths / f"{name}.truth.json"
    found = [path for path in place.glob("rec_*") if path.suffix.lower() in RECORDING_ENDINGS]
    for path in (pair, truth):
        if not is_file(path):
            raise InputFileError(path, found="there is no such file", wish=f"want pair.toml and truth of case {name}")
    if not found:
        raise InputFileError(place, found="no recording", wish="want rec_0.csv, rec_1.csv, ...")
    return CaseFiles(name=name, pair=pair, recordings=tuple(sorted(found, key=_number)), truth=truth)


def _number(path: Path) -> tuple[int, str]:
    digits = "".join(c for c in path.stem if c.isdigit())
    return int(digits or 0), path.name


def folder_cases(folder: Path) -> list[CaseFiles]:
    """Every case of a folder laid out as NAME/pair.toml, NAME/rec_K.csv, NAME.truth.json, by name."""
    if not is_folder(folder):
        raise InputFileError(folder, found="there is no such folder", wish="want a folder of cases")
    names = sorted(path.parent.name for path in folder.glob("*/pair.toml"))
    for name in names:
        if shown(name, width=len(name)) != name:
            raise InputFileError(folder / name, found="a name that does not print", wish="rename the case")
    if not names:
        raise InputFileError(folder, found="no case", wish="want NAME/pair.toml, NAME/rec_0.csv and NAME.truth.json")
    return [case_files(folder, name, truths=folder) for name in names]


def digest(paths: Iterable[Path]) -> str:
    """sha256 of names and bytes of some files."""
    out = hashlib.sha256()
    for path in paths:
        body = path.read_bytes()
        out.update(f"{path.name} {len(body)}\n".encode())
        out.update(body)
    return out.hexdigest()


def truth_hash(truth: Path) -> str:
    """sha256 of a truth file's bytes, which seals it; nothing is read of what is in it."""
    return hashlib.sha256(truth.read_bytes()).hexdigest()


def truth_hashes(cases: Iterable[CaseFiles]) -> dict[str, str]:
    """``truth_hash`` of every case, by name."""
    return {case.name: truth_hash(case.truth) for case in cases}


def code_of(*packages: Path, but: tuple[str, ...] = ()) -> str:
    """sha256 of the Python sources of some packages, folders named in ``but`` left out."""
    out = hashlib.sha256()
    for package in packages:
        for path in sorted(package.rglob("*.py")):
            place = path.relative_to(package)
            if place.parts[0] not in but:
                out.update(f"{place.as_posix()}\n".encode())
                out.update(path.read_bytes())
    return out.hexdigest()
