"""What is known of the pair: ``pair.toml`` read, checked, defaulted and written back."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from pydantic import ValidationError

from gearpoly.errors import InputFileError
from gearpoly.files.faults import explain
from gearpoly.files.models import GearSection, PairFile, Section
from gearpoly.files.paths import is_file
from gearpoly.files.sheet_csv import with_sheets
from gearpoly.files.toml import parse
from gearpoly.files.toml_text import value_text
from gearpoly.files.traces import read_text


def read_pair(path: Path | str) -> PairFile:
    """Read and check a pair file.

    Raises ``InputFileError`` with the file, the dotted key (or line and column), what stands there
    and what would do: the most basic fault first (unknown keys, then bad values, then missing keys,
    then keys that contradict one another).
    """
    file = Path(path)
    raw = with_sheets(parse(file, read_text(file)), file)
    try:
        pair = PairFile.model_validate(raw)
    except ValidationError as error:
        raise explain(file, raw, error) from None
    for gear, section in (("driving", pair.driving), ("driven", pair.driven)):
        for key, source in (("profile_csv", profile_csv_path(file, section)), ("gde", gde_path(file, section))):
            if source is not None and not is_file(source):
                called = "a trace file" if key == "profile_csv" else "an inspection file"
                found = f"no such file, {source}"
                wish = f"want the path of {called}, relative to the pair file"
                raise InputFileError(file, where=f"{gear}.inspection.{key}", found=found, wish=wish)
    return pair


def profile_csv_path(file: Path | str, gear: GearSection) -> Path | None:
    """Where the measured traces of a gear of the pair file ``file`` lie, or ``None``; for
    :func:`~.traces.read_traces`.
    """
    if gear.inspection is None or gear.inspection.profile_csv is None:
        return None
    return Path(file).parent / gear.inspection.profile_csv


def gde_path(file: Path | str, gear: GearSection) -> Path | None:
    """Where the inspection file of a gear of the pair file ``file`` lies, or ``None``."""
    if gear.inspection is None or gear.inspection.gde is None:
        return None
    return Path(file).parent / gear.inspection.gde


def moved(pair: PairFile, *, source: Path | str, target: Path | str) -> PairFile:
    """The pair as a file ``target`` must hold it, so that trace files named in ``source`` are still
    found.
    """
    gears: dict[str, GearSection] = {}
    for name, gear in (("driving", pair.driving), ("driven", pair.driven)):
        if gear.inspection is None:
            continue
        new = {
            key: Path(os.path.relpath(path, Path(target).parent)).as_posix()
            for key, path in (("profile_csv", profile_csv_path(source, gear)), ("gde", gde_path(source, gear)))
            if path is not None and not Path(getattr(gear.inspection, key)).is_absolute()
        }
        if new:
            gears[name] = gear.model_copy(update={"inspection": gear.inspection.model_copy(update=new)})
    return pair.model_copy(update=gears)


_COMPUTED = {
    "centre_distance_mm": "tight mesh of the deviation-free gears",
    "speed_rpm": "quasi-static",
    "bore_mm": "half the root diameter",
    "root_radius": "0.38, or the largest that fits and leaves the mate's tip free",
}


def effective_defaults(pair: PairFile) -> list[tuple[str, object]]:
    """The keys that the file left to their defaults and that have an effect: dotted key and value.

    A default that the geometry computes is given in words. Absent sections below a gear have no
    defaults to show.
    """
    return list(_defaults(pair, ""))


def _defaults(section: Section, prefix: str) -> Iterator[tuple[str, object]]:
    idle: set[str] = set()
    if isinstance(section, GearSection):
        if section.points_per_flank is not None:
            idle.add("chord_error_um")
        if section.grade is None:
            idle.add("grade_edition")
            if section.limits is None:  # nothing is drawn at random
                idle |= {"profile_errors", "thickness_errors"}
    for key, value in section:
        if isinstance(value, Section):
            yield from _defaults(value, f"{prefix}{key}.")
        elif key not in section.model_fields_set and key not in idle:
            if value is not None:
                yield f"{prefix}{key}", value
            elif key in _COMPUTED:
                yield f"{prefix}{key}", _COMPUTED[key]
            elif key == "grade" and not section.model_fields_set & {"limits", "inspection"}:
                yield f"{prefix}{key}", "ideal gear"


def dump_pair(pair: PairFile) -> str:
    """The pair as TOML text that :func:`read_pair` reads back equal; keys left to their defaults
    stay left out.
    """
    return "\n".join(_dump(pair, "")) + "\n"


def _dump(section: Section, prefix: str) -> Iterator[str]:
    tables: list[tuple[str, Section]] = []
    arrays: list[tuple[str, tuple[Section, ...]]] = []
    for key, value in section:
        default = type(section).model_fields[key].default
        if value is None or (key not in section.model_fields_set and value == default):
            continue
        if isinstance(value, Section):
            tables.append((key, value))
        elif isinstance(value, tuple) and value and isinstance(value[0], Section):
            arrays.append((key, value))
        else:
            yield f"{key} = {value_text(value)}"
    for key, table in tables:
        yield f"\n[{prefix}{key}]"
        yield from _dump(table, f"{prefix}{key}.")
    for key, entries in arrays:
        for entry in entries:
            yield f"\n[[{prefix}{key}]]"
            yield from _dump(entry, f"{prefix}{key}.")
