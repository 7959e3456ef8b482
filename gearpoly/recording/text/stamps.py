"""Time stamps as loggers write them, made seconds: ISO 8601, dates of several countries, times of day.

``03/04/2026`` is a day in April or one in March. Where the date never changes both say the same; where it does, the
order is taken only if the other one breaks the run of the clock, and asked for otherwise.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Sequence
from datetime import date

import numpy as np

from gearpoly.recording.text.cells import BadCellError, is_missing
from gearpoly.units import FloatArray

DAY_S = 86400.0

DATE_ORDERS = {"year first": "ymd", "day first": "dmy", "month first": "mdy"}
"""Orders of a date as a map names them, by the letters of its parts."""

_DATE = r"(?P<a>\d{1,4})(?P<mark>[-./])(?P<b>\d{1,2})(?P=mark)(?P<c>\d{1,4})"
_TIME = r"(?P<h>\d{1,2}):(?P<m>\d{2})(?::(?P<s>\d{2}(?:[.,:]\d{1,9})?))?\s*(?P<half>[AaPp]\.?[Mm]\.?)?"
_ZONE = r"\s*(?P<zone>Z|[+-]\d{2}:?\d{2})?"
_MINUTES = r"(?P<minutes>\d{1,4}):(?P<rest>[0-5]\d[.,]\d{1,9})"
STAMP = re.compile(rf"(?:{_DATE}(?:[T ]\s*{_TIME}{_ZONE})?|{_MINUTES}|{_TIME.replace('?P<', '?P<t')})", re.ASCII)
"""A date with or without a time of day, a time of day alone (its groups begin with t), or minutes and seconds."""

HOUR_S = 3600.0

LONGEST_STAMP = 40


def is_stamp(cell: str) -> bool:
    """Whether a stripped cell is a date, a time of day, or both."""
    return len(cell) <= LONGEST_STAMP and STAMP.fullmatch(cell) is not None


def is_date_alone(cell: str) -> bool:
    """Whether a stripped cell is a date without a time of day."""
    found = STAMP.fullmatch(cell) if len(cell) <= LONGEST_STAMP else None
    return found is not None and found["a"] is not None and found["h"] is None


def date_order(cells: Sequence[str], *, stated: str = "") -> tuple[str, str]:
    """The order of the dates in ``cells`` (letters of its parts, "ymd") with the reason, or nothing for both where it
    cannot be told; ``stated`` is an order as a map names it."""
    dates = list(dict.fromkeys(m.group("a", "mark", "b", "c") for c in cells if (m := STAMP.fullmatch(c)) and m["a"]))
    if stated:
        return DATE_ORDERS[stated], "as the map says"
    if not dates:
        return "ymd", "times of day alone"
    if len(dates[0][0]) == 4:
        return "ymd", "the year stands first"
    if dates[0][1] == ".":
        return "dmy", "dates with points have the day first"
    short = all(len(year) <= 2 for _, _, _, year in dates)
    orders = ("dmy", "mdy", "ymd") if short else ("dmy", "mdy")
    able = [order for order in orders if all(day_of(*d, order=order) is not None for d in dates)]
    if len(able) == 1:
        return able[0], "the other order makes no dates"
    if able and len(dates) == 1:
        return "dmy", "one date, so its order does not matter"
    runs = [order for order in able if _next_days(dates, order)]
    if len(runs) == 1:
        return runs[0], "only so one day follows the other"
    return "", ""


def _next_days(dates: Sequence[tuple[str, ...]], order: str) -> bool:
    """Whether every date is the day after the one before."""
    days = [day_of(*one, order=order) for one in dates]
    return all(a is not None and b is not None and (b - a).days == 1 for a, b in itertools.pairwise(days))


def day_of(first: str, mark: str, second: str, third: str, *, order: str) -> date | None:
    """The day of a date in that ``order`` of its parts, or ``None`` where there is none."""
    parts = dict(zip(order, (first, second, third), strict=True))
    year = int(parts["y"])
    try:
        return date(year + 2000 if len(parts["y"]) <= 2 else year, int(parts["m"]), int(parts["d"]))
    except ValueError:
        return None


def seconds(cells: Sequence[str], *, order: str, dates: Sequence[str] | None = None) -> FloatArray:
    """Seconds (n,) after the first stamp, ``nan`` where there is none; times of day alone run on over midnight, minutes
    and seconds over the hour.

    ``dates`` (n,) are the cells of a column of dates beside. Raises ``BadCellError`` with the first cell that is no
    stamp.
    """
    out = np.full(len(cells), math.nan)
    days: dict[str, float] = {}
    first: date | None = None
    dated = dates is not None
    turn = DAY_S
    for k, cell in enumerate(cells):
        if is_missing(cell):
            continue
        found = STAMP.fullmatch(cell) if len(cell) <= LONGEST_STAMP else None
        if found is None:
            raise BadCellError(k)
        if found["minutes"] is not None:  # spreadsheets show no hour
            out[k], turn = 60.0 * int(found["minutes"]) + float(found["rest"].replace(",", ".")), HOUR_S
            continue
        begin = found["a"] is not None
        dated = dated or begin
        day = 0.0
        if (where := found if begin else (STAMP.fullmatch(dates[k]) if dates is not None else None)) is not None:
            key = where.group(0)[: where.end("c")]
            if key not in days:
                there = day_of(where["a"], where["mark"], where["b"], where["c"], order=order)
                if there is None:
                    raise BadCellError(k)
                first = there if first is None else first
                days[key] = DAY_S * (there - first).days  # small, so that no digit of the second is lost
            day = days[key]
        try:
            out[k] = day + _time_of_day(found, "" if begin else "t")
        except ValueError:
            raise BadCellError(k) from None
    held = np.flatnonzero(np.isfinite(out))
    if held.size:
        if not dated:  # the clock begins again at midnight, or at the hour
            out[held[1:]] += turn * np.cumsum(np.diff(out[held]) < -0.5 * turn)
        out -= out[held[0]]
    return out


def _time_of_day(found: re.Match[str], prefix: str) -> float:
    """Seconds since midnight, of a stamp with a zone since midnight at Greenwich."""
    if found[f"{prefix}h"] is None:
        return 0.0
    hour, minute = int(found[f"{prefix}h"]), int(found[f"{prefix}m"])
    second = float((found[f"{prefix}s"] or "0").replace(",", ".").replace(":", "."))
    if half := found[f"{prefix}half"]:
        if not 1 <= hour <= 12:
            raise ValueError("an hour that is none of twelve")
        hour = hour % 12 + (12 if half[0] in "pP" else 0)
    if hour > 24 or minute > 59 or second >= 61.0:
        raise ValueError("a time that no clock shows")
    zone = found["zone"] if not prefix else None
    ahead = zone_seconds(zone or "")
    # Small numbers, so that no digit of the second is lost.
    return 3600.0 * hour + 60.0 * minute + second - ahead if ahead else 3600.0 * hour + 60.0 * minute + second


def zone_seconds(zone: str) -> float:
    """What a zone such as +01:00 is ahead of Greenwich, in s."""
    if zone in ("", "Z"):
        return 0.0
    digits = zone[1:].replace(":", "")
    ahead = 3600.0 * int(digits[:2]) + 60.0 * int(digits[2:])
    return -ahead if zone[0] == "-" else ahead
