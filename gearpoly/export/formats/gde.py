"""An inspection file of one drawn gear: geometry, tolerances, pitch, profiles as XML (after VDI/VDE 2610)."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from gearpoly.export.drawing import Drawing, Placed
from gearpoly.export.measured import TRACE_POINTS, measure, only_gear
from gearpoly.files.gde import GearInspection, Profile, Side, gde_text
from gearpoly.files.gde_inspection import FLANK_OF_SIDE, MESHING_TURN
from gearpoly.units import DEG, UM

ENDINGS = (".gde",)
CURVES = ("lines",)


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """The one gear of ``drawing`` as an inspection file that a pair file can name as ``inspection.gde``."""
    gear = only_gear(drawing, target)
    title = f"{drawing.title}, {gear.name} gear" + (f", seed {drawing.seed}" if "drawn" in drawing.origin else "")
    target.write_text(
        gde_text(as_inspection(gear, title=title, points=drawing.request.detail.points or TRACE_POINTS)),
        encoding="utf-8",
    )
    return drawing.chord_error


def as_inspection(gear: Placed, *, title: str, points: int = TRACE_POINTS) -> GearInspection:
    """What an inspector would report of ``gear``, in the units of the file; tooth 1 is tooth 0 of gearpoly."""
    nominal, limits, found = gear.mounted.gear, gear.limits, measure(gear, points=points)
    which: Literal["driving", "driven"] = "driving" if gear.name == "driving" else "driven"
    geometry = {
        "number_of_teeth": float(nominal.z),
        "normal_module": nominal.m,
        "normal_pressure_angle": round(nominal.alpha / DEG, 12),
        "helix_angle": 0.0,
        "profile_shift_coefficient": nominal.x,
        "tip_diameter": 2.0 * nominal.r_a,
        "root_diameter": 2.0 * nominal.r_f,
        "base_diameter": 2.0 * nominal.r_b,
        "bore_diameter": 2.0 * gear.outline.r_bore,
    } | ({} if nominal.b is None else {"face_width": nominal.b})
    tolerances = {}
    if limits is not None:
        values = {
            "single_pitch": limits.f_pT,
            "cumulative_pitch": limits.F_pT,
            "profile_total": limits.F_alphaT,
            "profile_slope": limits.f_HalphaT,
            "profile_form": limits.f_falphaT,
            "tooth_thickness_upper": limits.E_sns,
            "tooth_thickness_lower": limits.E_sni,
        }
        tolerances = {name: value / UM for name, value in values.items()}
    index = {"drive": found.index_drive, "coast": found.index_coast}
    pitch: dict[Side, tuple[float, ...]] = {
        side: tuple((index[flank] / UM).tolist()) for side, flank in FLANK_OF_SIDE.items()
    }
    profiles = []
    for k in range(nominal.z):
        for side, flank in FLANK_OF_SIDE.items():
            roll, deviation = found.trace(flank, k)
            if roll:
                microns = tuple(d / UM for d in deviation)
                profiles.append(Profile(tooth=k + 1, flank=side, roll_length=tuple(roll), deviation=microns))
    return GearInspection(
        name="; ".join([title, *found.remarks(first=1)]),
        geometry=geometry,
        tolerances=tolerances,
        count=MESHING_TURN[which],
        pitch=pitch,
        profiles=tuple(profiles),
    )
