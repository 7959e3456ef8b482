"""Keys in comment lines: ``# torque_nm = 25.0``, as a text file states the condition of a recording."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.toml import load
from gearpoly.files.traces import shorten
from gearpoly.recording.reader import check_short, is_key
from gearpoly.recording.recording import check_key
from gearpoly.recording.words import RADIAL, quantity_of


def said_radial(lines: Iterable[str]) -> list[str]:
    """A remark where ``lines`` above the rows say that it was a double-flank test."""
    for line in lines:
        if quantity_of(line) == RADIAL:
            said = f'"{shorten(line.strip().lstrip("#").strip())}" above the rows'
            return [f"{said}: a double-flank test has radial composite deviations, which are no transmission error"]
    return []


def read_comment(file: Path, where: str, text: str, keys: dict[str, object], places: dict[str, str]) -> None:
    """Take ``key = value`` from the text of a comment line into ``keys``, and ``where`` it stands into ``places``;
    leave remarks alone."""
    key, equals, value = (part.strip() for part in text.partition("="))
    if not equals:
        return
    if not is_key(file, where, key):
        return
    if key in keys:
        found = f"{key} a second time, after {places[key]}"
        raise InputFileError(file, where=where, found=found, wish="want each key once")
    check_short(file, where, key, value)
    try:
        found = load(text)[key]
    except (ValueError, KeyError):  # TOMLDecodeError, an integer with too many digits, or a dotted key
        wish = 'want a TOML value: a number with a decimal point, or text in quotes ("drive")'
        raise InputFileError(file, where=where, found=f"{key} = {shorten(value)}", wish=wish) from None
    check_key(file, where, key, found)
    keys[key], places[key] = found, where
