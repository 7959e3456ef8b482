"""A pair as a REXS design: what was ordered, without what was measured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from gearpoly.arguments import GEARS
from gearpoly.assemble import Assembled
from gearpoly.errors import OutOfRangeError
from gearpoly.export.drawing import Request
from gearpoly.files.models import GearSection, PairFile
from gearpoly.files.output import check_target, written_aside
from gearpoly.files.rexs.gear import PERMITTED_DEVIATIONS
from gearpoly.files.rexs.model import Attribute, Component, Relation, RexsModel, Value
from gearpoly.files.rexs.source import REXS_ENDINGS
from gearpoly.files.rexs.write import write_model
from gearpoly.gear.gear import Gear
from gearpoly.physics import catalogue
from gearpoly.units import DEG, UM

VERSION = "2.0"

MEASURED_SECTIONS = ("inspection", "form", "encoder")
"""Keys of a gear that say what was measured; nor is what a physics adds a design, but for its relief."""


def is_design_target(target: Path) -> bool:
    """Whether the ending of ``target`` asks for a design."""
    return target.suffix.lower() in REXS_ENDINGS


@dataclass(frozen=True, kw_only=True)
class ExportedDesign:
    """A design that was written to ``target``; ``remarks`` say what of the pair is no part of it."""

    target: Path
    remarks: tuple[str, ...]

    @property
    def says(self) -> str:
        """What is in the file, for whoever asked for it."""
        return f"the design of both gears (REXS {VERSION})"


def check_design(target: Path, curves: str | None) -> None:
    """Raise ``InputFileError`` where ``target`` cannot be written, ``OutOfRangeError`` where ``curves`` are asked for;
    before any long work."""
    check_target(target)
    if curves is not None:
        raise OutOfRangeError(f"--curves {curves}: {target.suffix} files hold no curves; leave it out")


def export_design(file: PairFile, assembled: Assembled, target: Path, request: Request) -> ExportedDesign:
    """Write the design of a pair to ``target``.

    Raises ``OutOfRangeError`` for what a ``request`` asks of a drawing, ``InputFileError`` where ``target`` cannot be
    written.
    """
    if request != Request():
        raise OutOfRangeError(
            f"{target.suffix} files hold the design of both gears; leave out --gear, --at, --flank, --apart, "
            "--magnify, --points and --chord-um"
        )
    model = design_model(file, assembled)
    with written_aside(target) as aside:
        write_model(model, aside, ending=target.suffix.lower())
    return ExportedDesign(target=target, remarks=tuple(left_out(file)))


def left_out(file: PairFile) -> list[str]:
    """What of a pair file is no part of a REXS design, in words."""
    brought = {key for one in catalogue().values() if "gear" in one.keys for key in one.keys["gear"].model_fields}
    keys = [key for key in GearSection.model_fields if key in brought - {"tip_relief"} or key in MEASURED_SECTIONS]
    found = [
        f"{name}.{key}"
        for name in GEARS
        for key in keys
        if key in getattr(file, name).model_fields_set and getattr(getattr(file, name), key)
    ]
    words = ", ".join(found)
    return [f"not part of a design and left out: {words}"] if found else []


@dataclass
class _Builder:
    """Components and relations, numbered as they come."""

    components: dict[int, Component] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)

    def add(self, type_: str, name: str, attributes: dict[str, tuple[Value | None, str]]) -> int:
        """A component; attributes that are None are left out."""
        number = len(self.components) + 1
        kept = {key: Attribute(value=v, unit=unit) for key, (v, unit) in attributes.items() if v is not None}
        self.components[number] = Component(id=number, type=type_, name=name, attributes=kept)
        return number

    def relate(self, type_: str, *refs: tuple[str, int], order: int | None = None) -> None:
        self.relations.append(Relation(id=len(self.relations) + 1, type=type_, refs=refs, order=order))


def design_model(file: PairFile, assembled: Assembled) -> RexsModel:
    """The stage with its gears, flanks, tools and reliefs as REXS 2.0 has them."""
    build, pair = _Builder(), assembled.pair
    unit = build.add("gear_unit", file.name, {})
    stage = build.add("cylindrical_stage", file.name, {"center_distance": (pair.a, "mm")})
    build.relate("assembly", ("assembly", unit), ("part", stage))
    gears = []
    for name, section, mounted in zip(GEARS, (file.driving, file.driven), (pair.driving, pair.driven), strict=True):
        gear = mounted.gear
        speed = file.pair.speed_rpm
        if speed is not None and name == "driven":
            speed *= file.driving.teeth / file.driven.teeth
        number = build.add(
            "cylindrical_gear", f"{name} gear", _blank(section, gear) | {"rotational_speed": (speed, "1 / min")}
        )
        torque = file.torque_nm * (1.0 if name == "driven" else file.driving.teeth / file.driven.teeth)
        # Seen on the datum face, as drawings and inspections are, the drive flank is the left one of both gears.
        data: dict[str, tuple[Value | None, str]] = {
            "is_driving_gear": (name == "driving", "none"),
            "loaded_tooth_flank": ("left", "none"),
            "torque": (torque or None, "N m"),
        }
        of_stage = build.add("cylindrical_stage_gear_data", f"{name} gear in its stage", data)
        build.relate("stage_gear_data", ("stage", stage), ("gear", number), ("stage_gear_data", of_stage))
        shaft = build.add("shaft", f"{name} shaft", {})
        build.relate("assembly", ("assembly", unit), ("part", shaft))
        build.relate("assembly", ("assembly", shaft), ("part", number))
        _flanks(build, section, gear, number, name)
        gears.append(number)
    build.relate("stage", ("stage", stage), ("gear_1", gears[0]), ("gear_2", gears[1]))
    return RexsModel(
        file=Path("design"), version=VERSION, components=build.components, relations=tuple(build.relations)
    )


def _blank(section: GearSection, gear: Gear) -> dict[str, tuple[Value | None, str]]:
    """Attributes of a gear."""
    out: dict[str, tuple[Value | None, str]] = {
        "number_of_teeth": (gear.z, "none"),
        "normal_module": (gear.m, "mm"),
        "helix_angle_reference_diameter": (0.0, "deg"),
        "face_width": (gear.b, "mm"),
        "tip_diameter": (_round(2.0 * gear.r_a), "mm"),
        "root_diameter": (_round(2.0 * gear.r_f), "mm"),
        "inner_diameter": (gear.d_bore, "mm"),
    }
    if section.grade is not None and section.grade_edition == 2013:
        out["global_tolerance_class_iso_1328_2013"] = (str(section.grade), "none")
    if section.limits is not None:
        out |= {name: (getattr(section.limits, key), "mum") for key, name in PERMITTED_DEVIATIONS.items()}
    return out


def _flanks(build: _Builder, section: GearSection, gear: Gear, number: int, name: str) -> None:
    """Both flanks of a gear with the tool that cuts them, and its tip relief."""
    sides: list[tuple[str, int]] = []
    alpha = _round(gear.alpha / DEG)
    tool = build.add("rack_shaped_tool", f"tool of the {name} gear", dict(_tool(gear, alpha)))
    settings = build.add("cylindrical_gear_manufacturing_settings", f"cutting of the {name} gear", {})
    for side in ("left", "right"):
        attributes: dict[str, tuple[Value | None, str]] = {
            "normal_pressure_angle": (alpha, "deg"),
            "addendum_modification_coefficient": (gear.x, "none"),
        }
        flank = build.add("cylindrical_gear_flank", f"{side} flank of the {name} gear", attributes)
        sides.append((side, flank))
        build.relate(
            "manufacturing_step", ("workpiece", flank), ("tool", tool), ("manufacturing_settings", settings), order=1
        )
        relief = section.tip_relief
        if relief is not None and relief.flank in ("both", "drive" if side == "left" else "coast"):
            shape: dict[str, tuple[Value | None, str]] = {
                "tip_relief_depth": (relief.amount_um * UM, "mm"),
                "tip_relief_datum_diameter": (_round(2.0 * (gear.r_a - relief.length_mm)), "mm"),
                "shape_of_relief": (relief.shape, "none"),
            }
            build.relate("reference", ("origin", flank), ("referenced", build.add("tip_relief", "tip relief", shape)))
    build.relate("flank", ("gear", number), *sides)


def _tool(gear: Gear, alpha: float) -> Iterator[tuple[str, tuple[Value | None, str]]]:
    """The rack that cuts the gear: its addendum is the gear's dedendum."""
    yield "normal_module", (gear.m, "mm")
    yield "normal_pressure_angle", (alpha, "deg")
    yield "addendum_coefficient_reference_profile", (gear.rack.h_fP, "none")
    yield "dedendum_coefficient_reference_profile", (gear.rack.h_aP, "none")
    yield "tip_corner_radius_factor_reference_profile", (gear.rack.rho_fP, "none")


def _round(value: float) -> float:
    """A computed length or angle without the digits that float64 adds."""
    return round(value, 12)
