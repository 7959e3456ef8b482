"""TOML from anywhere: bounded before it is parsed, since the time of a parse is no bound of its own."""

from __future__ import annotations

import re
import tomllib
from typing import Any

SIZE_LIMIT = 4 * 2**20
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
        (len(text), SIZE_LIMIT, "characters"),
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
