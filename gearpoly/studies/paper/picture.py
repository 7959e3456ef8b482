"""What a picture shows, without saying how it is drawn: so that no question needs a plotting library."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy.typing as npt

Style = Literal["line", "thin", "dots", "joined", "dashed"]


@dataclass(frozen=True, kw_only=True)
class Line:
    """One curve or cloud of points: ``x`` and ``y`` (n,) in the axes' units, ``colour`` a number (0 first)."""

    x: npt.ArrayLike
    y: npt.ArrayLike
    label: str = ""
    colour: int = 0
    style: Style = "line"


@dataclass(frozen=True, kw_only=True)
class Panel:
    """One pair of axes with their units in the labels; ``ticks`` names the places 0, 1, 2 ... where x is no number."""

    x: str
    y: str
    lines: tuple[Line, ...]
    title: str = ""
    ticks: tuple[str, ...] = ()
    log: bool = False


@dataclass(frozen=True, kw_only=True)
class PaperPicture:
    """A figure of one or more panels side by side or, if ``tall``, one below the other; ``name`` becomes its file's."""

    name: str
    caption: str
    panels: tuple[Panel, ...]
    tall: bool = False
