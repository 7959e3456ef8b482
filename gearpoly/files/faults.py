"""Faults of a pair file in words: the one message for the most basic fault, with file, key, value and what would do."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from gearpoly.errors import InputFileError, shown, shown_value
from gearpoly.files.models import PairFile, Section
from gearpoly.files.traces import nearest
from gearpoly.keys.kinds import LIST_TAG, NUMBER_TAG


def _sections(
    model: type[Section] = PairFile, path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], type[Section]]]:
    """Every section that a pair file can have, with its path."""
    yield path, model
    for key, info in model.model_fields.items():
        for kind in (info.annotation, *get_args(info.annotation)):
            if isinstance(kind, type) and issubclass(kind, Section):
                yield from _sections(kind, (*path, key))


_SECTIONS = dict(_sections())
_LISTS = {path for path in _SECTIONS if path and "tuple" in str(_SECTIONS[path[:-1]].model_fields[path[-1]].annotation)}
_WANT = {
    "int_type": "a whole number",
    "float_type": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "string_type": "text in quotes",
    "string_too_short": "text that is not empty",
    "tuple_type": "a list",
}
_BOUND = {
    "greater_than_equal": ("ge", "too small", "{} or more"),
    "greater_than": ("gt", "too small", "more than {}"),
    "less_than_equal": ("le", "too large", "{} or less"),
    "less_than": ("lt", "too large", "less than {}"),
}


def explain(file: Path, raw: dict[str, Any], error: ValidationError) -> InputFileError:
    """The one message for the most basic fault, and of equals the first in the file."""
    faults = error.errors(include_url=False)
    basic = min(map(_rank, faults))
    places: dict[int, dict[str, int]] = {}  # of the keys in each table, since a file may hold many
    fault = min((one for one in faults if _rank(one) == basic), key=lambda one: _position(raw, _loc(one), places))
    loc, kind, context = _loc(fault), fault["type"], fault.get("ctx", {})
    if kind == "rule":
        where = ".".join((*(str(key) for key in loc), context["key"]))
        return InputFileError(file, where=where, found=context["found"], wish=context["wish"])
    where = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in loc).lstrip(".")
    if kind == "extra_forbidden":
        return InputFileError(file, where=shown(where), found="unknown key", wish=_place_for(loc))
    path = tuple(key for key in loc if isinstance(key, str))
    info = _SECTIONS[path[:-1]].model_fields[path[-1]]
    found = _shown(fault["input"])
    want = ""
    if kind == "missing":
        found = "missing"
    elif kind in _BOUND:
        bound, verdict, want = _BOUND[kind]
        found, want = f"{found} is {verdict}", want.format(f"{context[bound]:g}") + ": "
    elif kind != "model_type":
        want = f"{_WANT.get(kind) or context.get('expected', 'another value')}: "
    return InputFileError(file, where=where, found=found, wish=f"want {want}{info.description}")


def _rank(fault: ErrorDetails) -> int:
    return {"extra_forbidden": 0, "missing": 2, "rule": 3}.get(fault["type"], 1)


def _loc(fault: ErrorDetails) -> tuple[int | str, ...]:
    if fault["type"] == "extra_forbidden":  # the writer's own key, whatever it is called
        return fault["loc"]
    return tuple(key for key in fault["loc"] if key not in (NUMBER_TAG, LIST_TAG))


def _position(raw: dict[str, Any], loc: tuple[int | str, ...], places: dict[int, dict[str, int]]) -> tuple[float, ...]:
    """Where the key stands in the file; a missing key comes after what its section holds. ``places`` keeps, by the
    identity of a table, the place of each of its keys."""
    position: list[float] = []
    here: Any = raw
    for key in loc:
        if isinstance(key, int):
            position.append(key)
        else:
            known = isinstance(here, dict) and key in here
            if known and id(here) not in places:
                places[id(here)] = {name: k for k, name in enumerate(here)}
            position.append(places[id(here)][key] if known else math.inf)
            here = here[key] if known else None
    return tuple(position)


def _place_for(loc: tuple[int | str, ...]) -> str:
    """What the writer of an unknown key most likely meant."""
    path, name = tuple(str(key) for key in loc[:-1] if not isinstance(key, int)), str(loc[-1])
    here = f"in [{'.'.join(path)}]" if path else "at the top of the file"
    # The other gear's sections hold the same keys: look in this gear's, from the outermost in.
    in_gear = path[:1] in (("driving",), ("driven",))
    gear = path[0] if in_gear else "driving"
    mate = {"driving": "driven", "driven": "driving"}[gear]
    others = [other for other in _SECTIONS if other != path and other[:1] != (mate,)]

    def called(other: tuple[str, ...]) -> str:
        if not other:
            return "at the top of the file, before any [section]"
        text = f"in [{'.'.join(other)}]"
        if not in_gear and other[0] == gear:
            text += f" and [{'.'.join((mate, *other[1:]))}]"
        return text

    own = _SECTIONS[path].model_fields
    for other in others:
        # A table of a list (a spall, a crack) is asked for only where nothing nearer is meant.
        listed = other in _LISTS and nearest(name, own, cutoff=0.6)
        if name in _SECTIONS[other].model_fields and not listed:
            return f"there is none {here}, it belongs {called(other)}"
    if close := nearest(name, own, cutoff=0.6):  # difflib's own idea of a close match
        return f'the nearest known key {here} is "{close}"'
    for other in others:  # farther away, so it must look closer
        if close := nearest(name, _SECTIONS[other].model_fields, cutoff=0.75):
            return f'none {here} is like it, the nearest known key is "{close}" {called(other)}'
    return f'the nearest known key {here} is "{nearest(name, own)}" (known: {", ".join(own)})'


def _shown(value: object) -> str:
    """A value as the file has it, short."""
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)} values"
    return shown_value(value)
