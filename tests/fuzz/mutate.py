"""Valid files made wrong: in their structure, where a parser still reads them, and then in their bytes."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterator
from typing import Any

from hypothesis import strategies as st

Draw = Any

NASTY = (
    "\x1b[31mred\x1b[0m", "a\nb", "\x00", "\x9b2J", "\u202egnp.exe", "\ufeff",
    "=1+1", "-@x", "../../x", "/dev/zero", "", " ",
    "nan", "1e999", "0x10", "x" * 5000, "[bold]b[/bold]", ":warning:", "%s%n", "{0}",
)  # fmt: skip
"""Texts that act on a terminal, a spreadsheet, a format or a path, or are numbers to some."""

CHANGES = ("value", "number", "number", "number", "drop", "add", "misspell", "copy", "wrap")
BYTES = (b"\x00", b"\xff\xfe", b"\x1b[2J", b"\r", b'"', b"'''", b"=", b"[[", b"<")
NUMBERS = (0, -1, 1, 2, 7, 11, 255, 10**9, 2**63, -(2**64), 10**400, 0.0, -0.0, 1e-320, 1e300, -1e300, 0.1, 1e400, 17.5)

texts = st.sampled_from(NASTY) | st.text(st.characters(exclude_categories=["Cs"]), max_size=12)
plain = st.booleans() | st.sampled_from(NUMBERS) | st.floats() | texts
values = st.recursive(
    plain, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(texts, inner, max_size=3), max_leaves=6
)


def places(tree: Any) -> Iterator[tuple[Any, Any]]:
    """Every place in nested tables and lists: what holds it, and its key."""
    for key in list(tree) if isinstance(tree, dict) else range(len(tree)) if isinstance(tree, list) else ():
        yield tree, key
        yield from places(tree[key])


@st.composite
def trees(draw: Draw, originals: list[dict[str, Any]]) -> dict[str, Any]:
    """One of the ``originals`` with up to four changes: a value replaced, a number moved, a key dropped, added,
    misspelt or copied elsewhere."""
    tree = copy.deepcopy(draw(st.sampled_from(originals)))
    for _ in range(draw(st.sampled_from((0, 1, 1, 1, 2, 4)))):
        every = list(places(tree))
        if not every:
            break
        holder, key = draw(st.sampled_from(every))
        change = draw(st.sampled_from(CHANGES))
        if change == "value":
            holder[key] = draw(values)
        elif change == "number" and isinstance(holder[key], int | float):
            by = draw(st.sampled_from((-1, 0, 0.5, 2, 10, 1000, 1e-6)))
            try:
                holder[key] *= by
            except OverflowError:  # a whole number too large for a fraction of it
                holder[key] *= int(math.copysign(math.ceil(abs(by)), by))
        elif change == "drop":
            del holder[key]
        elif change == "wrap":
            holder[key] = draw(st.sampled_from(([holder[key]], {"a": holder[key]}, [holder[key]] * 3)))
        elif isinstance(holder, dict):
            if change == "add":
                holder[draw(texts)] = draw(values)
            elif change == "misspell":
                holder[f"{key}{draw(texts)}"] = holder.pop(key)
            elif change == "copy":
                other, to = draw(st.sampled_from(every))
                if isinstance(other, dict) and isinstance(to, str):
                    other[to] = copy.deepcopy(holder[key])
    return tree


@st.composite
def damaged(draw: Draw, whole: bytes) -> bytes:
    """The bytes of a file, mostly whole, else cut off, with bytes changed, put in or doubled."""
    data = bytearray(whole)
    for _ in range(draw(st.sampled_from((0, 0, 0, 0, 1, 2)))):
        at = draw(st.integers(0, max(len(data) - 1, 0)))
        change = draw(st.sampled_from(("cut", "flip", "insert", "double", "drop")))
        if change == "cut":
            del data[at:]
        elif change == "flip" and data:
            data[at] = draw(st.integers(0, 255))
        elif change == "insert":
            data[at:at] = draw(st.sampled_from(BYTES))
        elif change == "double":
            data[at:at] = data[at : at + draw(st.integers(1, 400))]
        elif change == "drop":
            del data[at : at + draw(st.integers(1, 40))]
    return bytes(data)


def toml(tree: dict[str, Any]) -> str:
    """A tree as TOML, tables in tables inline."""
    return "".join(f"{_key(key)} = {_value(value)}\n" for key, value in tree.items())


def _key(key: str) -> str:
    return json.dumps(key, ensure_ascii=False)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)
