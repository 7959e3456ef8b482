"""Time stamps that are all written alike, made seconds in one go: a logger writes millions of them.

What is not alike, or no stamp, is left to a look at each cell, which says what is wrong with it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearpoly.recording.text.stamps import DAY_S, STAMP, day_of
from gearpoly.units import FloatArray

Codes = npt.NDArray[np.uint8]
"""Characters of ASCII as a matrix (n, length), one row for each cell."""

_ZERO = np.uint8(ord("0"))


@dataclass(frozen=True, kw_only=True, eq=False)
class EvenStamps:
    """Stamps of one layout: the ``digits`` (n, length) of each cell, where the parts of a date and of a time of day
    stand in it (``places``, by letter), and the cells ``dated`` anew: (row, text) of each that has another date than
    the one before."""

    digits: Codes
    places: dict[str, tuple[int, int]]
    dated: tuple[tuple[int, str], ...]

    @property
    def timed(self) -> bool:
        """Whether they hold a time of day."""
        return "h" in self.places

    def number(self, part: str) -> FloatArray:
        """The number (n,) that a part of each stamp is, with decimals behind a mark where it has one."""
        begin, end = self.places.get(part, (0, 0))
        held = self.digits[:, begin:end]
        out = np.zeros(held.shape[0])
        decimals = max(0, end - begin - 3)  # two digits of the second, and the mark
        for k in range(end - begin):
            if part != "s" or k != 2:
                out = 10.0 * out + held[:, k]
        return out / 10.0**decimals if part == "s" else out


def even_stamps(codes: Codes) -> EvenStamps | None:
    """The stamps in ``codes``; ``None`` where they are not all written as the first is, or not in a way known here."""
    first = codes[0].tobytes().decode("latin-1")
    found = STAMP.fullmatch(first)
    if found is None or found["minutes"] or found["half"] or found["thalf"] or found["zone"] not in (None, "Z"):
        return None
    dated = found["a"] is not None
    letters = (
        {"a": "a", "b": "b", "c": "c", "h": "h", "m": "m", "s": "s"} if dated else {"h": "th", "m": "tm", "s": "ts"}
    )
    places = {letter: found.span(group) for letter, group in letters.items() if found[group] is not None}
    digits = codes - _ZERO  # what is below zero comes out large
    figures = np.array([one.isdigit() for one in first])
    if not ((digits[:, figures] < 10).all() and (codes[:, ~figures] == codes[0][~figures]).all()):
        return None
    rows = [0]
    if dated:
        begin, end = found.span("a")[0], found.span("c")[1]
        rows += (np.flatnonzero((codes[1:, begin:end] != codes[:-1, begin:end]).any(axis=1)) + 1).tolist()
    texts = tuple((row, codes[row].tobytes().decode("latin-1")) for row in rows) if dated else ()
    return EvenStamps(digits=digits, places=places, dated=texts)


def even_seconds(stamps: EvenStamps, *, order: str, dates: EvenStamps | None = None) -> FloatArray | None:
    """Seconds (n,) after the first stamp, times of day alone running on over midnight; ``dates`` are a column of dates
    beside. ``None`` where a date or a time of day is none."""
    hour, minute, second = (stamps.number(part) for part in "hms")
    if hour.max() > 24.0 or minute.max() > 59.0 or second.max() >= 61.0:
        return None
    out: FloatArray = 3600.0 * hour + 60.0 * minute + second
    held = stamps if stamps.dated else dates
    if held is None:
        out[1:] += DAY_S * np.cumsum(np.diff(out) < -0.5 * DAY_S)
        out -= out[0]
        return out
    first = None
    ends = [*(row for row, _ in held.dated[1:]), out.size]
    for (row, text), end in zip(held.dated, ends, strict=True):
        found = STAMP.fullmatch(text)
        day = day_of(found["a"], found["mark"], found["b"], found["c"], order=order) if found is not None else None
        if day is None:
            return None
        first = day if first is None else first
        out[row:end] += DAY_S * (day - first).days
    out -= out[0]
    return out
