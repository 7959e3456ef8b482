"""The keys of a pair file by their dotted names, and how to set them before the file is checked."""

from __future__ import annotations

import types
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, Union, get_args, get_origin

from gearpoly.errors import OutOfRangeError
from gearpoly.files.models import PairFile, Section
from gearpoly.files.traces import nearest


def _walk(model: type[Section], prefix: str) -> Iterator[tuple[str, Any]]:
    for key, info in model.model_fields.items():
        kinds = [kind for kind in (info.annotation, *get_args(info.annotation)) if isinstance(kind, type)]
        inner = [kind for kind in kinds if issubclass(kind, Section)]
        if inner:
            yield from _walk(inner[0], f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", info.annotation


@cache
def known_keys() -> dict[str, Any]:
    """Every key that a pair file can hold, dotted (``driving.tip_relief.amount_um``), with its type."""
    return dict(_walk(PairFile, ""))


def check_key(key: str) -> None:
    """Raise ``OutOfRangeError`` with the nearest known key where a pair file has no such ``key``."""
    if key not in known_keys():
        close = nearest(key, known_keys())
        raise OutOfRangeError(f'a pair file has no key "{key}"; the nearest known key is "{close}"')


def is_whole(key: str) -> bool:
    """Whether the values of ``key`` are whole numbers (teeth, grade)."""
    kind = known_keys()[key]
    kinds = get_args(kind) if get_origin(kind) in (Union, types.UnionType) else (kind,)
    return int in kinds and float not in kinds


def with_values(raw: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """The tables ``raw`` of a pair file with some dotted keys set; neither argument is changed."""
    out = dict(raw)
    for key, value in values.items():
        *path, name = key.split(".")
        here = out
        for part in path:
            inner = here.get(part)
            here[part] = dict(inner) if isinstance(inner, dict) else {}
            here = here[part]
        here[name] = value
    return out
