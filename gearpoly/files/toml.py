"""TOML from anywhere: bounded before it is parsed, since the time of a parse is no bound of its own."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gearpoly.errors import InputFileError, shown

TOML_SIZE_LIMIT = 4 * 2**20
"""Characters of a TOML text. A pair of two gears of 10 000 teeth, each with all its inspected lists, has 2 MB."""

KEYS_LIMIT = 50_000
"""Keys, tables and lists of a text; a spall on each of 10 000 teeth has 50 000. So many unknown keys are refused within
2 s and 200 MB."""

VALUES_LIMIT = 500_000
"""Values in the lists of a text: twelve lists for each of two gears of 10 000 teeth are 240 000."""

DEPTH_LIMIT = 32
"""Parts of a dotted key; ours have at most 4. The parser takes time and memory as the square of it."""

_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_DEEP = re.compile(rf"(?<![\w-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{DEPTH_LIMIT}}}")


class OverLimitError(ValueError):
    """A text larger or deeper than is read; the message names the limit."""


def load(text: str) -> dict[str, Any]:
    """The tables of a TOML text.

    Raises ``OverLimitError``, and tomllib's own ``ValueError`` where it is none.
    """
    for count, limit, what in (
        (len(text), TOML_SIZE_LIMIT, "characters"),
        (sum(text.count(mark) for mark in "=[{"), KEYS_LIMIT, "keys, tables and lists"),
        (text.count(","), VALUES_LIMIT, "values"),
    ):
        if count > limit:
            raise OverLimitError(f"{count} {what}, and the limit is {limit}")
    if deep := _DEEP.search(text):
        line = text.count("\n", 0, deep.start()) + 1
        raise OverLimitError(f"a dotted name in line {line}, and its limit is {DEPTH_LIMIT} parts")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("lists or tables nested too deep") from None


def parse(file: Path, text: str) -> dict[str, Any]:
    """The tables of a TOML text; raises ``InputFileError`` with line and column where it is none."""
    wish = "want TOML: `key = value`, text in quotes, decimal points, each key and section once"
    try:
        return load(text)
    except OverLimitError as error:
        wish = "want no more than that; check the file name, or whether a program wrote too much"
        raise InputFileError(file, found=str(error), wish=wish) from None
    except ValueError as error:  # TOMLDecodeError, a limit, or an integer with more digits than Python converts
        message = str(error)
    place = re.search(r" \(at (?:line (\d+), column (\d+)|end of document)\)$", message)
    if place is None:
        raise InputFileError(file, found=message, wish=wish)
    lines = text.splitlines() or [""]
    line, column = (int(place[1]), int(place[2])) if place[1] else (len(lines), len(lines[-1]) + 1)
    standing = lines[line - 1].strip() if line <= len(lines) else ""
    found = f"`{shown(standing)}` ({message[: place.start()]}{_first(lines[: line - 1], standing)})"
    raise InputFileError(file, where=f"line {line}, column {column}", found=found, wish=wish)


def _first(above: Sequence[str], standing: str) -> str:
    """Where in the lines ``above`` the key or section of the line ``standing`` was begun, in words; nothing where it
    was not."""
    key, equals, _ = (part.strip() for part in standing.partition("="))
    section = "" if equals else standing.strip("[] ")
    for number in range(len(above), 0, -1):
        line = above[number - 1].strip()
        if section and re.match(rf"\[+\s*{re.escape(section)}\s*[].]|{re.escape(section)}\s*[.=]", line):
            return f", as begun in line {number}"
        if equals and line.startswith("["):
            return ""
        if equals and line.partition("=")[0].strip() == key:
            return f", as given in line {number}"
    return ""
