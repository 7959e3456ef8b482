"""A telescope's axis watched from behind its worm: what guide logs and curves of periodic error say of the pair that
turns the worm."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.mounts import SIDEREAL_DAY_S
from gearpoly.recording.table import AXIS_CORRECTION, AXIS_ERROR, WORM_ANGLE, Table
from gearpoly.units import FloatArray

if TYPE_CHECKING:
    from gearpoly.keys.sections import WormSection

ARCSEC_PER_DEG = 3600.0

CURVE_TURNS = 3
"""Times that a curve over one turn is taken. Of a made curve of 5 arcsec at order 1 and 0.4 at order 47 compare found
2.5 arcsec at order 3 from one turn, since a drift looks like half a wave, and both waves to 0.001 from three."""

FEWEST_CURVE_ROWS = 16
"""Rows of a curve."""

CURVE_ENDS_MOST_STEPS = 2.0
"""Largest steps of a curve by which its ends may be apart before a drift is taken off."""

OTHER_WORM = 0.01
"""Part by which the period that a file states may be off the pair's: periods of a solar day are off by 0.003, and two
worms by a tooth of the wheel, 1/435 at least, but mostly by far more. A curve says it in whole seconds."""


def worm_period(worm: WormSection) -> float:
    """Seconds per turn of the worm, and so of the driven gear."""
    return SIDEREAL_DAY_S / worm.wheel_teeth if worm.period_s is None else worm.period_s


def at_the_worm(file: Path, table: Table, worm: WormSection | None) -> Table:
    """A guide log's table as the contract has it: the driven angle in deg, that of the worm or from time at its period,
    the error in arcsec and the pulses in deg at the worm, the number of wheel teeth times those of the axis. Raises
    ``InputFileError`` where the pair file has no worm, or another one than the file."""
    if worm is None:
        wish = (
            "want a table [worm] in the pair file with the wheel_teeth of the worm wheel (EQ6: 180, HEQ5: 135); "
            "gearpoly pair --mount EQ6 PAIR writes it for a known mount"
        )
        raise InputFileError(file, found="a telescope's axis, watched behind a worm", wish=wish)
    period = worm_period(worm)
    if table.worm_period_s and abs(table.worm_period_s / period - 1.0) > OTHER_WORM:
        found = f"a worm that turns once in {table.worm_period_s:g} s, and the pair file's in {period:.6g} s"
        wish = "want the pair file of that mount (gearpoly pair --mount lists some), or period_s in its table [worm]"
        raise InputFileError(file, found=found, wish=wish)
    if "time_s" not in table.columns and WORM_ANGLE not in table.columns:
        wish = "want time_s, or worm_angle_deg, the angle of the worm, beside the error of the axis"
        raise InputFileError(file, found="an error of the axis without a time", wish=wish)
    held, said = table.columns, list(table.remarks)
    if (curve := _one_turn(held)) is not None:
        held = _repeated(curve, said)
    angle = held.get(WORM_ANGLE)
    columns = {"time_s": held["time_s"] if "time_s" in held else held[WORM_ANGLE] * (period / 360.0)}
    columns["driven_angle_deg"] = columns["time_s"] * (360.0 / period) if angle is None else angle
    columns["te_arcsec"] = held[AXIS_ERROR] * worm.wheel_teeth
    if AXIS_CORRECTION in table.columns:
        columns["driven_correction_deg"] = table.columns[AXIS_CORRECTION] * (worm.wheel_teeth / ARCSEC_PER_DEG)
    remarks = [
        *said,
        f"the worm turns once in {period:.6g} s; 1 arcsec of the axis is {worm.wheel_teeth} at the worm",
    ]
    return Table(columns=columns, keys=table.keys, remarks=remarks)


def _one_turn(columns: Mapping[str, FloatArray]) -> dict[str, FloatArray] | None:
    """Worm angle and error (n,) of a curve over one turn of the worm, each place once; ``None`` of anything else."""
    angle, error = columns.get(WORM_ANGLE), columns[AXIS_ERROR]
    if angle is None or angle.size < FEWEST_CURVE_ROWS or not (np.isfinite(angle).all() and np.isfinite(error).all()):
        return None
    steps = np.diff(angle)
    step = float(np.median(steps))
    if not np.all(steps > 0.0):
        return None
    left = (360.0 - float(angle[-1] - angle[0])) / step
    if not -0.25 <= left < 2.0:  # rows to the turn's end: none where the last row is the first once more
        return None
    rows = angle.size - (left < 0.25)
    return {WORM_ANGLE: angle[:rows], AXIS_ERROR: error[:rows]}


def _repeated(curve: Mapping[str, FloatArray], said: list[str]) -> dict[str, FloatArray]:
    """A curve ``CURVE_TURNS`` times over, closed at its ends, with what was done ``said``."""
    angle, error = curve[WORM_ANGLE], curve[AXIS_ERROR]
    gap = float(error[0] - error[-1]) - 0.5 * float(error[1] - error[0] + error[-1] - error[-2])
    if abs(gap) > CURVE_ENDS_MOST_STEPS * float(np.max(np.abs(np.diff(error)))):
        error = error + gap * (angle - angle[0]) / 360.0
        said.append(f"a drift of {-gap:.3g} arcsec a turn taken off, so that the curve closes")
    said.append(
        f"a curve over one turn of the worm: taken {CURVE_TURNS} times over, since it says that every turn is like it; "
        "how far the mount's turns are, nothing here tells"
    )
    turns = 360.0 * np.repeat(np.arange(CURVE_TURNS), angle.size)
    return {WORM_ANGLE: np.tile(angle, CURVE_TURNS) + turns, AXIS_ERROR: np.tile(error, CURVE_TURNS)}
