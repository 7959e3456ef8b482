"""Curves of periodic error as EQMOD and PECPrep write them: one turn of a telescope's worm, second by second.

The lines begin with ``!WormPeriod=`` and ``!StepsPerWorm=``; rows are time in s, steps of the motor, error in arcsec.
EQMOD takes the rise of the error from its tracking rate, so an error that rises is that of an axis running ahead.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import check_file, shorten, unreadable
from gearpoly.recording.reader import Reader, check_few
from gearpoly.recording.table import AXIS_ERROR, WORM_ANGLE, Table
from gearpoly.recording.text.broken_off import broken_off
from gearpoly.recording.text.encoding import ENCODING_SAMPLE_BYTES, shown
from gearpoly.units import FloatArray

PEC_FILE_MARK = "!WormPeriod"

LIMIT_BYTES = 2**24
"""Largest file: a night of second-by-second rows has a MB."""

LEAST_WORM_CURVE_ROWS = 16
"""Rows below which no wave of a gear before the worm shows."""

STEPS_OFF_TIME_TURNS = 0.02
"""Turns by which the motor's steps may stray from time and still be the worm's angle: they count from any zero."""


def read_table(file: Path) -> Table:
    """Worm angle in deg, time in s and error of the axis in arcsec, positive where it is ahead. Raises
    ``InputFileError`` with the line at fault."""
    check_file(file, limit_bytes=LIMIT_BYTES)
    try:
        data = file.read_bytes()
    except OSError as error:
        raise unreadable(file, error) from None
    text = data.decode(shown(data[:ENCODING_SAMPLE_BYTES]) or "utf-8", errors="replace").rstrip("\0\x1a")
    lines = text.splitlines()
    broken = "" if text.endswith(("\n", "\r")) or not lines else broken_off(lines)
    lines = lines[:-1] if broken else lines
    stated: dict[str, float] = {}
    rows: list[tuple[float, float, float]] = []
    for number, line in enumerate(lines, start=1):
        text = line.lstrip("\ufeff").strip()
        if text.startswith("!"):
            key, _, value = text[1:].partition("=")
            check_few(file, f"line {number}", len(stated), "lines with !")
            stated[key.strip().lower()] = _number(file, number, value, f"a number of {shorten(key)}")
        elif text and not text.startswith("#") and (number > 1 or text[0].isdigit()):
            rows.append(_row(file, number, text))
    period = stated.get("wormperiod", math.nan)
    if not period > 0.0:
        raise InputFileError(
            file, where=PEC_FILE_MARK, found=f"{period:g}", wish="want the worm's period in s, above 0"
        )
    if len(rows) < LEAST_WORM_CURVE_ROWS:
        wish = f"want at least {LEAST_WORM_CURVE_ROWS} rows of time, steps and error"
        raise InputFileError(file, found=f"{len(rows)} rows", wish=wish)
    time, steps, error_arcsec = (np.array(column) for column in zip(*rows, strict=True))
    if not bool(np.all(np.diff(time) > 0.0)):
        row = int(np.argmin(np.diff(time) > 0.0)) + 1
        raise InputFileError(file, where=f"row {row + 1}", found="time that falls", wish="want rows in their order")
    turned = time / period
    by_steps = _by_steps(steps, stated.get("stepsperworm", 0.0), turned)
    remarks = [f"{time.size} rows over {_turns(time, period)} of a worm that turns once in {period:g} s"]
    remarks += [f"the last line breaks off, {broken}, and is left out"] if broken else []
    if by_steps is None:
        angle, sense = 360.0 * turned, 1.0
        remarks.append("the worm's angle is time, since the motor's steps do not follow it")
    else:
        angle, sense = by_steps
        remarks.append("the worm's angle is that of the motor's steps")
    if sense < 0.0:
        remarks.append("the steps fall, as south of the equator, where a positive error is behind: its sign is changed")
    remarks.append(
        "a curve is the mean of turns and smoothed: what does not repeat with the worm's turn, and short waves, may be "
        "missing from it; a guide log holds them"
    )
    columns = {"time_s": time, WORM_ANGLE: angle, AXIS_ERROR: sense * error_arcsec}
    return Table(columns=columns, keys={}, remarks=remarks, worm_period_s=period)


def _turns(time: FloatArray, period: float) -> str:
    turns = (time[-1] - time[0]) / period + 1.0 / max(1, time.size)
    return f"{turns:.2g} turns" if turns > 1.2 else "one turn"


def _by_steps(steps: FloatArray, per_turn: float, turned: FloatArray) -> tuple[FloatArray, float] | None:
    """The worm's angle in deg by the motor's steps, and their sense; ``None`` where they do not follow the turns."""
    if not per_turn > 1.0:
        return None
    counted = np.unwrap(steps, period=per_turn) / per_turn
    travel = float(counted[-1] - counted[0])
    sense = 1.0 if travel >= 0.0 else -1.0
    apart = sense * (counted - counted[0]) - (turned - turned[0])
    if float(np.max(np.abs(apart - np.mean(apart)))) > STEPS_OFF_TIME_TURNS * max(1.0, float(np.ptp(turned))):
        return None
    return 360.0 * sense * counted, sense


def _row(file: Path, number: int, text: str) -> tuple[float, float, float]:
    cells = re.split(r"[\s;]+", text)
    if len(cells) < 3:
        wish = 'want three numbers, time in s, steps of the motor and error in arcsec; "#" before a remark'
        raise InputFileError(file, where=f"line {number}", found=f"`{shorten(text)}`", wish=wish)
    time, steps, error = (_number(file, number, cell, "a number") for cell in cells[:3])
    return time, steps, error


def _number(file: Path, number: int, text: str, wanted: str) -> float:
    """A number, with a point or a decimal comma as the country of the computer has it."""
    try:
        value = float(text.strip().replace(",", "."))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputFileError(file, where=f"line {number}", found=f'"{shorten(text)}"', wish=f"want {wanted}")
    return value


def recognises(head: bytes) -> bool:
    """Whether a file's first bytes hold the mark of a curve of periodic error."""
    return f"\n{PEC_FILE_MARK}" in "\n" + head.decode(shown(head) or "latin-1", errors="replace").replace("\r", "\n")


READER = Reader(name="EQMOD periodic error", endings=(".txt", ".log", ".pec"), recognises=recognises, read=read_table)
