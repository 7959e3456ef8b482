"""A run of a pair as loggers of different countries write it down."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from gearpoly.recording.map_file import RecordingMap, read_map

FloatArray = npt.NDArray[np.float64]

RATIO = 18.0 / 25.0
GERMAN = ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Drehmoment Abtrieb [Nm]")
OWN = ("time_s", "driving_angle_deg", "driven_angle_deg", "torque_nm")


def run(size: int = 1500, *, rpm: float = 30.0, rate: float = 100.0) -> dict[str, FloatArray]:
    """Time in s, both angles in deg wrapped at 360, torque in N.m, of a steady run with a wave of 40 urad."""
    t = np.arange(size) / rate
    theta = 6.0 * rpm * t
    te = np.degrees(40e-6 * np.sin(np.radians(theta)))
    return {
        "time_s": t,
        "driving_angle_deg": np.mod(theta, 360.0),
        "driven_angle_deg": np.mod(RATIO * theta + te, 360.0),
        "torque_nm": 25.0 + 0.2 * np.cos(np.radians(theta)),
    }


def table(
    columns: Sequence[FloatArray],
    names: Sequence[str],
    *,
    separator: str = ";",
    decimal: str = ",",
    digits: int | Sequence[int] = 5,
    units: Sequence[str] = (),
    head: str = "",
    quoted: bool = False,
) -> str:
    """The text of a table, numbers to so many ``digits`` after the ``decimal`` mark."""
    places = [digits] * len(columns) if isinstance(digits, int) else digits
    cells = [[f"{v:.{n}f}".replace(".", decimal) for v in column] for column, n in zip(columns, places, strict=True)]
    if quoted:
        cells = [[f'"{cell}"' for cell in column] for column in cells]
    lines = [separator.join(names), *([separator.join(units)] if units else [])]
    return head + "\n".join([*lines, *(separator.join(row) for row in zip(*cells, strict=True))]) + "\n"


def written(folder: Path, text: str, *, name: str = "Messung.csv", encoding: str = "utf-8") -> Path:
    file = folder / name
    file.write_bytes(text.encode(encoding))
    return file


def chart(folder: Path, text: str) -> RecordingMap:
    """A map with that ``text``."""
    file = folder / "map.toml"
    file.write_text(text, encoding="utf-8")
    return read_map(file)


def own(columns: Mapping[str, FloatArray], *, digits: int = 5) -> str:
    """The contract's own CSV of the same numbers."""
    return table(list(columns.values()), list(columns), separator=",", decimal=".", digits=digits)


def same(actual: FloatArray | None, wanted: FloatArray | None, *, half: float) -> None:
    """Both are there and agree to ``half`` of the last place that was written, and a few roundings."""
    assert actual is not None and wanted is not None
    np.testing.assert_allclose(actual, wanted, rtol=1e-14, atol=1.01 * half)


DEGREE = math.pi / 180.0
