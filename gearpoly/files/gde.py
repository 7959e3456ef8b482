"""Gear inspections as XML, arranged after VDI/VDE 2610 (gear data exchange format): geometry, tolerances, measured
pitch and profiles of one gear.

A documented subset (docs/reference/export.md) with a unit on every length and deviation. Values stay as the file has
them (mm, deg, um), teeth count from 1, flanks are left and right seen on the datum face: ``gde_inspection`` translates.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal
from xml.sax.saxutils import escape, quoteattr

Side = Literal["left", "right"]
Turn = Literal["clockwise", "counterclockwise"]

ROOT, SUBSET = "gear_data_exchange", "gearpoly-1"

GDE_UNITS = {
    "mm": {"mm": 1.0},
    "um": {"um": 1.0, "µm": 1.0, "μm": 1.0, "mm": 1e3},
    "deg": {"deg": 1.0, "rad": 180.0 / math.pi},
    "": {},
}
"""Known units of lengths, deviations, angles and numbers, and their size in the first."""

GEOMETRY = {
    "number_of_teeth": "",
    "normal_module": "mm",
    "normal_pressure_angle": "deg",
    "helix_angle": "deg",
    "profile_shift_coefficient": "",
    "face_width": "mm",
    "tip_diameter": "mm",
    "root_diameter": "mm",
    "base_diameter": "mm",
    "bore_diameter": "mm",
}
REQUIRED = ("number_of_teeth", "normal_module", "normal_pressure_angle")

TOLERANCES = {
    "quality_grade": "",
    "single_pitch": "um",
    "cumulative_pitch": "um",
    "profile_total": "um",
    "profile_slope": "um",
    "profile_form": "um",
    "tooth_thickness_upper": "um",
    "tooth_thickness_lower": "um",
}


@dataclass(frozen=True, kw_only=True)
class Profile:
    """One measured profile: ``tooth`` from 1, ``flank``, roll lengths in mm (rising) and deviations in um from the
    design profile, positive = more material."""

    tooth: int
    flank: Side
    roll_length: tuple[float, ...]
    deviation: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class GearInspection:
    """What a file says of one gear, in its units: ``geometry`` (mm, deg), ``tolerances`` (um), index deviations
    ``pitch`` by flank (z values, um, normal), ``thickness`` (one per tooth, um along the reference circle), profiles.

    Teeth count ``count`` seen on the datum face.
    """

    name: str
    geometry: dict[str, float]
    tolerances: dict[str, float] = field(default_factory=dict)
    count: Turn = "clockwise"
    pitch: dict[Side, tuple[float, ...]] = field(default_factory=dict)
    thickness: tuple[float, ...] | None = None
    profiles: tuple[Profile, ...] = ()

    @property
    def z(self) -> int:
        """Number of teeth."""
        return int(self.geometry["number_of_teeth"])


def gde_text(gear: GearInspection) -> str:
    """The inspection as XML that :func:`~.gde_read.read_gde` reads back equal: every number in full."""

    def one(name: str, unit: str, value: float) -> str:
        shown = str(int(value)) if name == "number_of_teeth" else repr(float(value))
        return f"<{name}{_unit(unit)}>{shown}</{name}>"

    def row(name: str, unit: str, values: tuple[float, ...], more: str = "") -> str:
        return f"<{name}{more}{_unit(unit)}>{' '.join(repr(float(value)) for value in values)}</{name}>"

    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<{ROOT} subset="{SUBSET}">',
        f"<identification><name>{escape(gear.name)}</name></identification>",
        "<geometry>",
        *(one(name, GEOMETRY[name], value) for name, value in gear.geometry.items()),
        "</geometry>",
    ]
    if gear.tolerances:
        lines.append("<tolerances>")
        lines += [one(name, TOLERANCES[name], value) for name, value in gear.tolerances.items()]
        lines.append("</tolerances>")
    lines.append(f"<inspection tooth_count={quoteattr(gear.count)}>")
    lines += [row("pitch", "um", values, f' flank="{side}" direction="normal"') for side, values in gear.pitch.items()]
    if gear.thickness is not None:
        lines.append(row("tooth_thickness", "um", gear.thickness))
    for profile in gear.profiles:
        lines += [
            f'<profile tooth="{profile.tooth}" flank="{profile.flank}">',
            row("roll_length", "mm", profile.roll_length),
            row("deviation", "um", profile.deviation),
            "</profile>",
        ]
    return "\n".join([*lines, "</inspection>", f"</{ROOT}>"]) + "\n"


def _unit(unit: str) -> str:
    return f' unit="{unit}"' if unit else ""
