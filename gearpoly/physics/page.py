"""The catalogue as a table for the reader: ``python -m gearpoly.physics.page`` prints it; a test compares the page."""

from __future__ import annotations

from collections.abc import Iterable

from gearpoly.physics import catalogue
from gearpoly.physics.base import Physics

HEAD = ("| physics | keys of the pair file | parameters | equation | source |", "| --- | --- | --- | --- | --- |")


def table(known: Iterable[Physics]) -> str:
    """A row per physics, in the order in which they come in the life of a pair."""
    rows = [
        f"| `{one.name}` | `{one.stands}` | {', '.join(f'`{name}`' for name in one.parameters)} | "
        f"{one.equation.replace('|', chr(92) + '|')} | {one.source} |"
        for one in sorted(known, key=lambda one: (one.rank, one.name))
    ]
    return "\n".join((*HEAD, *rows))


if __name__ == "__main__":
    print(table(catalogue().values()))
