"""Between an inspection file and a gear: tooth numbers in the order of meshing, left and right as drive and coast.

Both gears are seen on their datum face, the drawing's own side. There the drive flank is the left one of a tooth that
points up, on both gears; teeth mesh in clockwise order on the driving gear and counter-clockwise on the driven.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from gearpoly.errors import InputFileError
from gearpoly.files.gde import GearInspection, Side, Turn
from gearpoly.files.gde_read import read_gde
from gearpoly.files.models import GearSection, Inspection
from gearpoly.files.traces import Flank, Trace
from gearpoly.units import UM, read_only

Which = Literal["driving", "driven"]

FLANK_OF_SIDE: dict[Side, Flank] = {"left": "drive", "right": "coast"}
MESHING_TURN: dict[Which, Turn] = {"driving": "clockwise", "driven": "counterclockwise"}

GDE_SAME_GEAR_TOLERANCE = 1e-6
"""Relative. Module and pressure angle of file and pair agree to more digits than anybody writes, or it is another
gear."""


def meshing_order(gear: GearInspection, which: Which) -> list[int]:
    """For each tooth in the order of meshing its index in the file: file tooth 1 is tooth 0, others may count the other
    way round."""
    sense = 1 if gear.count == MESHING_TURN[which] else -1
    return [(sense * k) % gear.z for k in range(gear.z)]


def inspection(
    path: Path | str, section: GearSection, sheet: Inspection, which: Which
) -> tuple[Inspection, tuple[Trace, ...]]:
    """What the file that ``sheet.gde`` names says of the ``which`` gear, as an inspection section and traces.

    ``path`` is the pair file. Raises ``InputFileError`` where the inspection file is of another gear than ``section``.
    """
    file = Path(path).parent / (sheet.gde or "")
    gear = read_gde(file)
    for key, found, wanted in (
        ("number_of_teeth", float(gear.z), float(section.teeth)),
        ("normal_module", gear.geometry["normal_module"], section.module_mm),
        ("normal_pressure_angle", gear.geometry["normal_pressure_angle"], section.pressure_angle_deg),
    ):
        if abs(found - wanted) > GDE_SAME_GEAR_TOLERANCE * wanted:
            wish = f"want {wanted:g}, as {Path(path).name} has it for the {which} gear"
            raise InputFileError(file, where=f"geometry.{key}", found=f"{found:g}", wish=wish)
    order = meshing_order(gear, which)
    place = {index: k for k, index in enumerate(order)}

    def sorted_row(values: tuple[float, ...] | None) -> tuple[float, ...] | None:
        return None if values is None else tuple(values[index] for index in order)

    read = {
        "pitch_um": sorted_row(gear.pitch.get("left")),
        "pitch_coast_um": sorted_row(gear.pitch.get("right")),
        "tooth_thickness_um": sorted_row(gear.thickness),
    }
    measured = sheet.model_copy(update={key: row for key, row in read.items() if getattr(sheet, key) is None})
    traces = tuple(
        Trace(
            tooth=place[profile.tooth - 1],
            flank=FLANK_OF_SIDE[profile.flank],
            roll_length=read_only(profile.roll_length),
            deviation=read_only([value * UM for value in profile.deviation]),
        )
        for profile in gear.profiles
    )
    return measured, traces
