"""Sentences that are said of many recordings alike, as one."""

from __future__ import annotations

import re
from collections.abc import Iterable

TOLD_SINGLY = 2
"""Recordings of which a sentence is still told one by one."""

_OF = re.compile(r"recording (\d+): (.*)", re.DOTALL)
_NUMBER = re.compile(r"\d+(?:[.,]\d+)?(?:e[+-]?\d+)?")


def together(sentences: Iterable[str]) -> list[str]:
    """The ``sentences`` with those that differ in the number of their recording as one, and of those that differ in
    other numbers too the first; all at the place of the first."""
    groups: dict[object, list[tuple[str, str | None]]] = {}
    for at, said in enumerate(sentences):
        found = _OF.fullmatch(said)
        if found is None:
            groups[at] = [(said, None)]
        else:
            groups.setdefault(_NUMBER.sub("#", found[2]), []).append((found[2], found[1]))
    return [line for group in groups.values() for line in _told(group)]


def _told(group: list[tuple[str, str | None]]) -> list[str]:
    numbers = [int(k) for _, k in group if k is not None]
    if len(group) <= TOLD_SINGLY:
        return [said if k is None else f"recording {k}: {said}" for said, k in group]
    first = group[0][0]
    # Of one recording the same may be said of several stretches.
    same = sorted({k for (said, _), k in zip(group, numbers, strict=True) if said == first})
    others = sorted({k for k in numbers if k not in same})
    out = f"recording{'s' * (len(same) > 1)} {ranges(same)}: {first}"
    return [
        out + (f" (and so recording{'s' * (len(others) > 1)} {ranges(others)}, with other numbers)" if others else "")
    ]


def ranges(numbers: list[int]) -> str:
    """Rising whole numbers in words, those that follow one another as a range."""
    parts: list[list[int]] = []
    for k in numbers:
        if parts and k == parts[-1][-1] + 1:
            parts[-1].append(k)
        else:
            parts.append([k])
    words = [str(p[0]) if len(p) == 1 else f"{p[0]} {'to' if len(p) > 2 else 'and'} {p[-1]}" for p in parts]
    return ", ".join(words)
