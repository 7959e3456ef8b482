"""What an argument may be: choices, numbers, counts, files and lists, the same from Python and on the command line.

Messages name an argument as the command line does (``--turns``) where that has it; ``gearpoly.api`` calls it by its
name in Python.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Literal

from gearpoly.errors import OutOfRangeError, shown_value

FLANKS = ("drive", "coast")
"""Flanks that may carry."""

GEARS: tuple[Literal["driving", "driven"], Literal["driving", "driven"]] = ("driving", "driven")
"""The gears of a pair."""


def check_choice(name: str, value: object, choices: tuple[str, ...]) -> None:
    """Refuse a ``value`` of the argument ``name`` that is none of ``choices``: raises ``OutOfRangeError``."""
    if not isinstance(value, str) or value not in choices:
        *others, last = (f'"{one}"' for one in choices)
        wish = f"{', '.join(others)} or {last}" if others else last
        raise OutOfRangeError(f"{name} {shown_value(value)}: want {wish}")


def check_file(name: str, value: object) -> None:
    """Refuse a ``value`` of the argument ``name`` that is no path: raises ``OutOfRangeError``."""
    if not isinstance(value, str | os.PathLike):
        raise OutOfRangeError(f'{name} {shown_value(value)}: want a path, such as "pair.toml" or a pathlib.Path')


def check_keys(name: str, value: object) -> None:
    """Refuse a ``value`` of the argument ``name`` that is no dictionary: raises ``OutOfRangeError``."""
    if not isinstance(value, Mapping):
        raise OutOfRangeError(f"{name} {shown_value(value)}: want a dictionary with the keys of a pair file")


@dataclass(frozen=True, kw_only=True)
class Number:
    """A number from ``least`` to ``most``, both allowed, that says in ``unit`` what it says; infinite only where not
    ``finite``."""

    least: float = -math.inf
    most: float = math.inf
    unit: str = ""
    finite: bool = True

    def check(self, name: str, value: object) -> None:
        """Refuse a ``value`` of the argument ``name`` that is no such number: raises ``OutOfRangeError``."""
        if isinstance(value, Real) and not isinstance(value, bool):
            number = float(value)
            if self.least <= number <= self.most and (math.isfinite(number) or not self.finite):
                return
        kind = "a finite number" if self.finite and math.inf in (-self.least, self.most) else "a number"
        unit = f" in {self.unit}" if self.unit else ""
        raise OutOfRangeError(f"{name} {shown_value(value)}: want {kind}{unit}{_span(self.least, self.most)}")


@dataclass(frozen=True, kw_only=True)
class Count:
    """A whole number from ``least`` to ``most``, both allowed (None: no end)."""

    least: int
    most: int | None = None

    def check(self, name: str, value: object) -> None:
        """Refuse a ``value`` of the argument ``name`` that is no such number: raises ``OutOfRangeError``."""
        most = math.inf if self.most is None else self.most
        if isinstance(value, Integral) and not isinstance(value, bool) and self.least <= int(value) <= most:
            return
        wish = f"{self.least}" if self.least == self.most else f"a whole number{_span(self.least, most)}"
        raise OutOfRangeError(f"{name} {shown_value(value)}: want {wish}")


def _span(least: float, most: float) -> str:
    if most == math.inf:
        return "" if least == -math.inf else f", {least:g} or more"
    return f" from {least:g} to {most:g}"


TURNS_OF_DRIVEN = Number(least=0.0)
"""Turns of the driven gear; the mesh that is begun is gone through, so 0 is one mesh."""

POINTS_PER_MESH = Count(least=1)
"""Positions per pitch."""

SEED = Count(least=0)
"""What decides what a grade leaves to chance: numpy's generators take no negative seed."""

SECONDS_OF_WORK = Number(least=1.0, unit="s", finite=False)
"""Work of a diagnosis: reading and laying recordings on their simulation alone takes most of a second."""

WORKERS = Count(least=1)
"""Processes of a study."""

STAGE = Count(least=0)
"""A stage of a design, by its id."""

SHARE_OF_PAIRS = Number(least=0.0, most=1.0)
"""Share of pairs that shall keep a limit."""

CONFIDENCE = Number(least=0.5, most=0.9999)
"""Confidence of intervals."""

ROTATION = Number(unit="rad")
"""A rotation."""

DISTANCE_BETWEEN_TEETH = Number(least=0.0, unit="mm", finite=False)
"""A distance between teeth."""

TORQUE_MAGNITUDE = Number(least=0.0, unit="N.m")
"""A torque is a magnitude; the flank says which way it acts."""
