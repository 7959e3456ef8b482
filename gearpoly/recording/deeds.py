"""What cleaning did to a recording or found in it, for the user to read."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Deed:
    """One thing that was done or found: a short name, how many samples (or steps) it touched, and a sentence."""

    what: str
    count: int
    says: str


def so_many(count: int, things: str) -> str:
    """A ``count`` and words that begin with what is counted, in the plural: "1 sample", "2 samples of a stop"."""
    first, space, rest = things.partition(" ")
    return f"{count} {first.removesuffix('s') if count == 1 else first}{space}{rest}"


def in_full(number: float) -> str:
    """A ``number`` that may be stated again as it is told: 16777216 and 0.25, with no digit rounded away."""
    return str(int(number)) if float(number).is_integer() and abs(number) < 1e15 else repr(float(number))


def note(done: list[Deed], what: str, count: int, says: str) -> None:
    """Add a deed whose sentence begins with its ``count``, where that is not 0."""
    if count:
        done.append(Deed(what, count, so_many(count, says)))
