"""A telescope's axis watched from behind its worm: what a guide log says of the pair that turns the worm."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gearpoly.errors import InputFileError
from gearpoly.files.mounts import SIDEREAL_DAY_S
from gearpoly.recording.table import AXIS_CORRECTION, AXIS_ERROR, Table

if TYPE_CHECKING:
    from gearpoly.keys.sections import WormSection

ARCSEC_PER_DEG = 3600.0


def worm_period(worm: WormSection) -> float:
    """Seconds per turn of the worm, and so of the driven gear."""
    return SIDEREAL_DAY_S / worm.wheel_teeth if worm.period_s is None else worm.period_s


def at_the_worm(file: Path, table: Table, worm: WormSection | None) -> Table:
    """A guide log's table as the contract has it: the driven angle in deg from time at the worm's period, the error in
    arcsec and the pulses in deg at the worm, the number of wheel teeth times those of the axis. Raises
    ``InputFileError`` where the pair file has no worm."""
    if worm is None:
        wish = (
            "want a table [worm] in the pair file with the wheel_teeth of the worm wheel (EQ6: 180, HEQ5: 135); "
            "gearpoly pair --mount EQ6 PAIR writes it for a known mount"
        )
        raise InputFileError(file, found="a guide log, which watches the telescope's axis behind a worm", wish=wish)
    period = worm_period(worm)
    time = table.columns["time_s"]
    columns = {
        "time_s": time,
        "driven_angle_deg": time * (360.0 / period),
        "te_arcsec": table.columns[AXIS_ERROR] * worm.wheel_teeth,
        "driven_correction_deg": table.columns[AXIS_CORRECTION] * (worm.wheel_teeth / ARCSEC_PER_DEG),
    }
    remarks = [
        *table.remarks,
        f"the worm turns once in {period:.6g} s; 1 arcsec of the axis is {worm.wheel_teeth} at the worm",
    ]
    return Table(columns=columns, keys=table.keys, remarks=remarks)
