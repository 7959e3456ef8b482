"""The catalogue as a table for the reader: ``python -m gearpoly.physics.page`` prints it; a test compares the page."""

from __future__ import annotations

from collections.abc import Iterable

from gearpoly.physics import catalogue, in_order
from gearpoly.physics.base import Physics

HEAD = ("| physics | keys of the pair file | parameters | equation | source |", "| --- | --- | --- | --- | --- |")


def table(known: Iterable[Physics]) -> str:
    """A row per physics, in the order in which they come in the life of a pair."""
    rows = [
        f"| `{one.name}` | `{one.stands}` | {', '.join(f'`{name}`' for name in one.parameters)} | "
        f"{one.equation.replace('|', chr(92) + '|')} | {one.source} |"
        for one in in_order(known)
    ]
    return "\n".join((*HEAD, *rows))


def unsearched(known: Iterable[Physics]) -> str:
    """A line per physics that a pair file may state and no diagnosis looks for, with the reason."""
    return "\n".join(f"`{one.name}` is not looked for yet: {one.unsearched}." for one in known if one.unsearched)


if __name__ == "__main__":
    print(table(catalogue().values()), unsearched(catalogue().values()), sep="\n\n")
