"""The condition that a file's name says (``run_20Nm_drive.csv``), offered for a map and never taken by itself."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from gearpoly.recording.quantities import SPEED, TORQUE, unit_written
from gearpoly.recording.table import Doubt

_NUMBER = r"(?<![\d.,])(?P<sign>(?:(?<![^\W_])|^)[-\u2212+])?(?P<size>\d{1,6}(?:[.,]\d{1,6})?)"

_TORQUE = re.compile(rf"{_NUMBER}[ _]?(?P<unit>[kmc]?N[ ._*\u00b7-]?[mc]?m)(?![^\W\d_])", re.IGNORECASE)

_SPEED = re.compile(rf"{_NUMBER}[ _]?(?P<unit>rpm|upm|U_?min|1_?min|min-1|tr_?min)(?![^\W\d_])", re.IGNORECASE)

_FLANK = {"coast": "coast", "schub": "coast", "drive": "drive", "zug": "drive"}
"""Words of names for the flank that carries."""


def in_name(file: Path, keys: Mapping[str, object], columns: Iterable[str]) -> list[Doubt]:
    """What the name of a ``file`` says of its condition where neither ``keys`` nor ``columns`` state it, with the lines
    of a map that confirm it; of two torques in a name nothing is known."""
    held = {*keys, *columns}
    out = []
    torques = _said(_TORQUE, file.name, TORQUE)
    if len(torques) == 1 and "torque_nm" not in held:
        ((size, minus, text),) = torques
        words = set(re.findall(r"[^\W\d_]+", file.name.lower()))
        flanks = {_FLANK[one] for one in words if one in _FLANK} or ({"coast"} if minus else set())
        ask = [f"keys.torque_nm = {size!r}"]
        ask += [f'keys.flank = "{flank}"' for flank in flanks if len(flanks) == 1 and "flank" not in held]
        what = "a torque of the driven shaft" + (", and its minus the coast flank" if minus else "")
        out.append(
            Doubt(says=f'the name of the file says "{text}", which is not taken: if it is {what}', ask=tuple(ask))
        )
    speeds = _said(_SPEED, file.name, SPEED)
    if len(speeds) == 1 and not {"speed_rpm", "time_s"} & held and speeds[0][0] > 0.0:
        says = f'the name of the file says "{speeds[0][2]}", which is not taken: if it is a speed of the driving shaft'
        out.append(Doubt(says=says, ask=(f"keys.speed_rpm = {speeds[0][0]!r}",)))
    return out


def _said(pattern: re.Pattern[str], name: str, dimension: str) -> list[tuple[float, bool, str]]:
    """The sizes in the contract's unit, whether they stand behind a minus, and their text; each size once."""
    held: dict[float, tuple[float, bool, str]] = {}
    for found in pattern.finditer(name):
        spelling = re.sub(r"[ _]", "/" if dimension == SPEED else ".", found["unit"])
        unit = unit_written(spelling, dimension) or unit_written(re.sub(r"[^A-Za-z]", "", spelling), dimension)
        if unit is not None:
            size = round(float(found["size"].replace(",", ".")) * unit.size, 9)
            held[size] = (size, (found["sign"] or "+") in "-\u2212", found[0].strip())
    return list(held.values())
