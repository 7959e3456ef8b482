"""What callers from Python give: one value or a list, recordings of one set-up, and the bounds of an export."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from gearpoly import arguments
from gearpoly.errors import OutOfRangeError, shown, shown_value
from gearpoly.export.magnify import LARGEST_MAGNIFICATION
from gearpoly.export.outline import LEAST_POINTS_PER_FLANK, MOST_POINTS_PER_FLANK
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray

Recorded = Path | str | Recording | Sequence[Path | str | Recording]
"""One recording or several of one set-up: files, or what ``read`` gave."""

POINTS_PER_FLANK = arguments.Count(least=LEAST_POINTS_PER_FLANK, most=MOST_POINTS_PER_FLANK)
"""Points per flank of what is exported."""

MAGNIFICATION = arguments.Number(least=0.0, most=LARGEST_MAGNIFICATION)
"""How many times as far along the normal deviations are drawn."""


def row(name: str, values: FloatArray | float, what: str, *, least: float = -math.inf) -> FloatArray:
    """One value or a list of them (N,); raises ``OutOfRangeError`` where ``name`` holds anything else than ``what``."""
    try:
        out = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        out = np.empty((0, 0))
    if out.ndim != 1 or out.size == 0 or not np.all(np.isfinite(out)) or out.min() < least:
        raise OutOfRangeError(f"{name} {shown_value(values)}: want one {what} or a list of them")
    return out


def each_of(recordings: Recorded) -> list[Path | str | Recording]:
    """One recording or several as a list; raises ``OutOfRangeError`` for none and for what is no recording."""
    wish = "want the path of a recording, what gearpoly.read gives, or a list of these"
    if isinstance(recordings, str | Path | Recording):
        recordings = [recordings]
    given = list(recordings) if isinstance(recordings, Iterable) else [recordings]
    if not given:
        raise OutOfRangeError(f"recordings {shown_value(recordings)}: {wish}")
    for one in given:
        if not isinstance(one, str | Path | Recording):
            raise OutOfRangeError(f"recordings {shown_value(one)}: {wish}")
        if isinstance(one, Recording):
            arguments.check_choice(f"{shown(str(one.source))}: flank", one.flank, arguments.FLANKS)
    return given
