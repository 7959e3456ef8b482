"""Refusals of universal files (UFF 58)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tests import recording_files as files
from tests.cures.cure import RUN, one_of_two
from tests.cures.formats import changed, cut, written

T = RUN["time_s"]


def uff(*, binary: bool = True, **columns: Any) -> Callable[[Path], None]:
    return lambda file: files.write_uff(file, {**RUN, **columns}, {}, binary=binary)


def uneven(name: str, axis: Any, *, kind: int = 17, more: float = 0.0) -> bytes:
    """A data set of the usual run with values, so much ``more`` each, at places of its own."""
    head = files.uff_header(name, T.size, {}, binary=True, even=False).decode()
    lines = head.splitlines()
    lines[9] = f"{kind:10d}" + lines[9][10:]
    both = np.stack([axis, RUN[name] + more], axis=1).astype("<f8").tobytes()
    return "".join(f"{line}\n" for line in lines).encode() + both + b"    -1\n"


def sets(*parts: bytes) -> Callable[[Path], object]:
    return lambda file: file.write_bytes(b"".join(parts))


ANGLES = ("driving_angle_deg", "driven_angle_deg")
BACKWARD = T.copy()
BACKWARD[5] = 0.0
HOLE = T.copy()
HOLE[5] = np.nan

AGAIN = sets(*(uneven(one, T) for one in ANGLES), uneven(ANGLES[0], T, more=1.0))

CURES = [
    written(
        "other text",
        "want a data set, which begins with -1",
        sets(uneven(ANGLES[0], T), b"hello\n"),
        sets(*(uneven(one, T) for one in ANGLES)),
        "a.uff",
    ),
    one_of_two("uff", ANGLES[0], (1, 3), AGAIN, "a.uff"),
    written("long line", "want the whole file", sets(uneven(ANGLES[0], T), b"x" * 300), uff(), "a.uff"),
    written("no end", "want the whole file", sets(b"    -1\n   151\nno end\n"), uff(), "a.uff"),
    written("header", "want the whole file", changed(uff(), b"         4", b"       4.x"), uff(), "a.uff"),
    written(
        "complex",
        "want real numbers (2 or 4)",
        changed(uff(), b"         4       700", b"         6       700"),
        uff(),
        "a.uff",
    ),
    written(
        "count", "want the whole file", changed(uff(), b"         4       700", b"         4      -700"), uff(), "a.uff"
    ),
    written(
        "start",
        "want finite numbers in line 7 of its header",
        changed(uff(), b"  0.00000e+00", b"          nan"),
        uff(),
        "a.uff",
    ),
    written("cut binary", "want the whole file", cut(uff(), 0.9), uff(), "a.uff"),
    written(
        "precision",
        "export it again, in double precision",
        changed(uff(), b"         4       700", b"         2       700"),
        uff(),
        "a.uff",
    ),
    written(
        "text too short",
        "want the whole file",
        changed(uff(binary=False), b"         4       700", b"         4     99700"),
        uff(binary=False),
        "a.uff",
    ),
    written(
        "text of fewer",
        "want the whole file",
        changed(uff(binary=False), b"         4       700", b"         4       800"),
        uff(binary=False),
        "a.uff",
    ),
    written(
        "a word among numbers",
        "want numbers in the format's columns",
        changed(uff(binary=False), b"e+02", b"x+02"),
        uff(binary=False),
        "a.uff",
    ),
    written(
        "other places",
        "or a column time_s",
        sets(uneven(ANGLES[0], T), uneven(ANGLES[1], T + 0.005, kind=1)),
        sets(*(uneven(one, T) for one in ANGLES)),
        "a.uff",
    ),
    written(
        "times back",
        "want times that rise",
        sets(uneven(ANGLES[0], BACKWARD), uneven(ANGLES[1], T)),
        sets(*(uneven(one, T) for one in ANGLES)),
        "a.uff",
    ),
    written(
        "no abscissa",
        "want a finite number for each value",
        sets(uneven(ANGLES[0], HOLE), uneven(ANGLES[1], T)),
        sets(*(uneven(one, T) for one in ANGLES)),
        "a.uff",
    ),
]
