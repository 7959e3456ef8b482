"""The catalogue as a table for the reader: ``python -m gearpoly.physics.page docs/reference/catalogue.md`` writes it
into the page anew; a test compares."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from gearpoly.physics import catalogue, in_order
from gearpoly.physics.base import Physics

PHYSICS_TABLE_HEAD = (
    "| physics | keys of the pair file | parameters | equation | source |",
    "| --- | --- | --- | --- | --- |",
)


def table(known: Iterable[Physics]) -> str:
    """A row per physics, in the order in which they come in the life of a pair."""
    rows = [
        f"| `{one.name}` | `{one.stands}` | {', '.join(f'`{name}`' for name in one.parameters)} | "
        f"{one.equation.replace('|', chr(92) + '|')} | {one.source} |"
        for one in in_order(known)
    ]
    return "\n".join((*PHYSICS_TABLE_HEAD, *rows))


def unsearched(known: Iterable[Physics]) -> str:
    """A line per physics that a pair file may state and no diagnosis looks for, with the reason."""
    return "\n".join(f"`{one.name}` is not looked for yet: {one.unsearched}." for one in known if one.unsearched)


def written(page: str, known: Iterable[Physics]) -> str:
    """The ``page`` with its table of the catalogue as it is now."""
    head = "\n".join(PHYSICS_TABLE_HEAD)
    before, found, after = page.partition(head)
    _, _, rest = after.partition("\n\n")
    if not found:
        raise ValueError(f"no table of the catalogue, which begins {PHYSICS_TABLE_HEAD[0]}")
    return f"{before}{table(known)}\n\n{rest}"


if __name__ == "__main__":
    target = Path(sys.argv[1])
    anew = written(target.read_text(encoding="utf-8"), catalogue().values())
    target.write_text(anew, encoding="utf-8", newline="\n")
