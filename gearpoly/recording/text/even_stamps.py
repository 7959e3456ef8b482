"""Time stamps that are written alike, made seconds in one go: a logger writes millions of them.

Days and hours may have one digit or two, and an hour may be one of twelve. What is written in another way, or no stamp,
is left to a look at each cell, which says what is wrong with it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearpoly.recording.text.stamps import DAY_S, STAMP, day_of, zone_seconds
from gearpoly.units import BoolArray, FloatArray, IntArray

Codes = npt.NDArray[np.uint8]
"""Characters of ASCII as a matrix (n, length), one row for each cell, short ones filled up with zeros."""

LAYOUTS_MOST = 24
"""Ways in which the digits of one column of stamps may be spread: one or two for month, day and hour, and the rest."""

_ZERO, _SMALL = np.uint8(ord("0")), np.uint8(ord("a") - ord("A"))


@dataclass(frozen=True, kw_only=True, eq=False)
class EvenStamps:
    """Stamps of one kind: the number (n,) that each of their ``parts`` is, by letter (a, b, c of a date, h, m, s of a
    time of day on 24 hours), what their zone is ``ahead`` of Greenwich in s, and the cells ``dated`` anew: (row, text)
    of each that has another date than the one before."""

    parts: dict[str, FloatArray]
    ahead: float
    dated: tuple[tuple[int, str], ...]

    @property
    def timed(self) -> bool:
        """Whether they hold a time of day."""
        return "h" in self.parts


@dataclass(frozen=True, kw_only=True)
class _Kind:
    """What all stamps of a column have in common: the letters of their parts, the mark of dates, the zone, and whether
    hours are of twelve."""

    letters: tuple[str, ...]
    mark: str
    zone: str
    halved: bool


def even_stamps(codes: Codes) -> EvenStamps | None:
    """The stamps in ``codes``; ``None`` where they are not all of one kind, or of one that is not known here."""
    lengths = np.count_nonzero(codes, axis=1) if not codes[:, -1].all() else None
    parts: dict[str, FloatArray] = {}
    kinds: set[_Kind] = set()
    layouts = 0
    for length in [codes.shape[1]] if lengths is None else np.unique(lengths).tolist():
        left: IntArray | None = None if lengths is None else np.flatnonzero(lengths == length)
        while left is None or left.size:
            held = codes if left is None else codes[left, :length]
            digits = held - _ZERO  # what is below zero comes out large
            figures: BoolArray = digits < 10
            like = (figures == figures[0]).all(axis=1)
            layouts += 1
            kind = _take(held, digits, like, left, codes.shape[0], parts)
            if kind is None or layouts > LAYOUTS_MOST:
                return None
            kinds.add(kind)
            left = np.flatnonzero(~like) if left is None else left[~like]
    if len(kinds) != 1:
        return None
    kind = kinds.pop()
    texts: tuple[tuple[int, str], ...] = ()
    if "a" in parts:
        turned = np.zeros(codes.shape[0] - 1, dtype=np.bool_)
        for letter in "abc":
            turned |= np.diff(parts[letter]) != 0.0
        rows = [0, *(np.flatnonzero(turned) + 1).tolist()]
        texts = tuple((row, codes[row].tobytes().rstrip(b"\0").decode("latin-1")) for row in rows)
    return EvenStamps(parts=parts, ahead=zone_seconds(kind.zone), dated=texts)


def _take(
    held: Codes, digits: Codes, like: BoolArray, rows: IntArray | None, size: int, parts: dict[str, FloatArray]
) -> _Kind | None:
    """Put the numbers of those cells in ``held`` that are spread ``like`` the first into ``parts`` (size,), at their
    ``rows``; ``None`` where they are no stamps, or differ in more than digits."""
    found = STAMP.fullmatch(held[0].tobytes().decode("latin-1"))
    if found is None or found["minutes"]:
        return None
    dated = found["a"] is not None
    prefix = "" if dated else "t"
    groups = {**({one: one for one in "abc"} if dated else {}), **{one: prefix + one for one in "hms"}}
    halved = found[f"{prefix}half"] is not None
    if not like.all():
        held, digits = held[like], digits[like]
    at = np.flatnonzero(like) if rows is None else rows[like]
    fixed = ~(digits[0] < 10)
    late: BoolArray | None = None
    if halved:
        half = found.start(f"{prefix}half")
        fixed[half] = False
        first = held[:, half] | _SMALL
        late = first == ord("p")
        if not (late | (first == ord("a"))).all():
            return None
    zone = found["zone"] or "" if dated else ""
    if zone:
        fixed[slice(*found.span("zone"))] = True
    if not (held[:, fixed] == held[0, fixed]).all():
        return None
    there = {letter: found.span(group) for letter, group in groups.items() if found[group] is not None}
    for letter, (begin, end) in there.items():
        number = _number(digits[:, begin:end], decimals=letter == "s")
        if letter == "h" and late is not None:
            if number.min() < 1.0 or number.max() > 12.0:
                return None
            number = np.mod(number, 12.0) + 12.0 * late
        parts.setdefault(letter, np.zeros(size))[at] = number
    return _Kind(letters=tuple(there), mark=found["mark"] or "", zone=zone, halved=halved)


def _number(digits: Codes, *, decimals: bool) -> FloatArray:
    """The number (n,) that ``digits`` (n, length) write; with ``decimals`` those behind two digits and a mark."""
    out = np.zeros(digits.shape[0])
    for k in range(digits.shape[1]):
        if not decimals or k != 2:
            out = 10.0 * out + digits[:, k]
    return out / 10.0 ** max(0, digits.shape[1] - 3) if decimals else out


def even_seconds(stamps: EvenStamps, *, order: str, dates: EvenStamps | None = None) -> FloatArray | None:
    """Seconds (n,) after the first stamp, times of day alone running on over midnight; ``dates`` are a column of dates
    beside. ``None`` where a date or a time of day is none."""
    nothing = np.zeros(next(iter(stamps.parts.values())).size)
    hour, minute, second = (stamps.parts.get(letter, nothing) for letter in "hms")
    if hour.max() > 24.0 or minute.max() > 59.0 or second.max() >= 61.0:
        return None
    out: FloatArray = 3600.0 * hour + 60.0 * minute + second
    if stamps.ahead:
        out -= stamps.ahead
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
