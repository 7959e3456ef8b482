"""One gear of a REXS model as keys of a pair file."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from gearpoly.errors import InputFileError, shown
from gearpoly.files.gde import Side
from gearpoly.files.inspection.measured import SIDES
from gearpoly.files.rexs.model import Component, RexsModel, called

FLANK_COMPONENTS = ("cylindrical_gear_flank", "flank_geometry")
"""Flanks: the name of today, and that of versions 1.0 to 1.2."""

TOOL_RELATIONS = ("manufacturing_step", "reference", "ordered_reference")

PERMITTED_DEVIATIONS = {
    "f_pt_um": "single_pitch_deviation_iso_1328_2013",
    "F_p_um": "cumulative_pitch_deviation_iso_1328_2013",
    "F_alpha_um": "total_profile_deviation_iso_1328_2013",
    "f_Halpha_um": "profile_slope_deviation_iso_1328_2013",
    "f_falpha_um": "profile_form_deviation_iso_1328_2013",
}
"""Permitted deviations of ISO 1328-1:2013 by their key in a pair file, mum."""

FLANKS_AGREE_TOLERANCE = 1e-9
"""Coefficients and angles of both flanks agree to what a file prints, or the gear is not symmetric."""

RELIEF_SHAPES = {"linear": 1, "parabolic": 2}


@dataclass
class GearOfDesign:
    """One gear: ``keys`` of its section of a pair file, and what was taken for what, or left out."""

    model: RexsModel
    gear: Component
    loaded: Side | None
    keys: dict[str, object] = field(default_factory=dict)
    says: list[str] = field(default_factory=list)

    def read(self) -> None:
        """Fill in keys and words. Raises ``InputFileError`` where a spur gear cannot be read from the file."""
        number = self.model.number
        z, m = self.whole("number_of_teeth"), number(self.gear, "normal_module", "mm")
        if m is None or not m > 0.0:
            raise self.model.fault(self.gear, "normal_module", "missing" if m is None else f"{m:g}", "want it in mm")
        self.keys |= {"teeth": z, "module_mm": m}
        flanks = self.flanks()
        alpha = self.both(flanks, "normal_pressure_angle", "deg", 20.0)
        x = self.both(flanks, "addendum_modification_coefficient", "none", 0.0)
        self.keys |= {"pressure_angle_deg": alpha, "profile_shift": x}
        self.blank(flanks, m)
        for key, name in (("face_width_mm", "face_width"), ("bore_mm", "inner_diameter")):
            value = number(self.gear, name, "mm")
            if value is not None and value > 0.0:
                self.keys[key] = value
        self.quality()
        self.modifications(flanks)

    def whole(self, name: str) -> int:
        value = self.model.number(self.gear, name, "none")
        if value is None or value != int(value):
            raise self.model.fault(self.gear, name, "missing" if value is None else f"{value:g}", "want a whole number")
        return int(value)

    def flanks(self) -> dict[Side, Component]:
        """Left and right flank."""
        out: dict[Side, Component] = {}
        for relation in self.model.relations:
            if relation.type == "flank" and relation.role("gear") == self.gear.id:
                for side in SIDES:
                    one = relation.role(side)
                    if one is not None and self.model.components[one].type in FLANK_COMPONENTS:
                        out[side] = self.model.components[one]
        return out

    def both(self, flanks: dict[Side, Component], name: str, unit: str, usual: float) -> float:
        """An attribute that both flanks must share, or the usual value, which is said."""
        found = {side: self.model.number(one, name, unit) for side, one in flanks.items()}
        values = [value for value in found.values() if value is not None]
        if not values:
            self.says.append(f"{called(self.gear)} states no {name}: {usual:g} is taken")
            return usual
        if max(values) - min(values) > FLANKS_AGREE_TOLERANCE:
            text = " and ".join(f"{side} {value:g}" for side, value in found.items() if value is not None)
            raise self.model.fault(
                self.gear, name, text, "want the same on both flanks; gearpoly's gears are symmetric"
            )
        return values[0]

    def blank(self, flanks: dict[Side, Component], m: float) -> None:
        """Tip, root and fillet: from diameters, else from the tool that cuts the gear."""
        number = self.model.number
        tip, root = number(self.gear, "tip_diameter", "mm"), number(self.gear, "root_diameter", "mm")
        origins = (self.gear.id, *(one.id for one in flanks.values()))
        tools = {t.id: t for one in origins for t in self.model.related(one, TOOL_RELATIONS, "rack_shaped_tool")}
        if len(tools) > 1:
            self.says.append(
                f"{called(self.gear)} is cut by {len(tools)} tools: none is taken, state dedendum and root_radius"
            )
        tool = next(iter(tools.values())) if len(tools) == 1 else None
        basic = [number(one, "addendum_coefficient_basic_profile", "none") for one in flanks.values()]
        if tip is not None:
            self.keys["tip_diameter_mm"] = tip
        elif basic and basic[0] is not None:
            self.keys["addendum"] = basic[0]
        else:
            self.says.append(f"{called(self.gear)} states no tip_diameter: addendum = 1 is taken")
        # The tool's addendum cuts the gear's dedendum.
        h_fP = None if tool is None else number(tool, "addendum_coefficient_reference_profile", "none")
        if root is not None:
            self.keys["root_diameter_mm"] = root
        elif h_fP is not None:
            self.keys["dedendum"] = h_fP
        else:
            self.says.append(f"{called(self.gear)} states neither root_diameter nor a tool: dedendum = 1.25 is taken")
        if tool is not None:
            radius = number(tool, "tip_corner_radius_reference_profile", "mm")
            factors = (
                number(tool, name, "none")
                for name in ("tip_corner_radius_factor_reference_profile", "tip_radius_factor")
            )
            factor = radius / m if radius is not None else next((one for one in factors if one is not None), None)
            if factor is not None:
                self.keys["root_radius"] = round(factor, 12)

    def quality(self) -> None:
        """Tolerance class and permitted deviations."""
        grade = self.gear.attributes.get("global_tolerance_class_iso_1328_2013")
        if grade is not None:
            text = str(grade.value).removesuffix(".0")
            if not (text.isdigit() and len(text) < 3 and 1 <= int(text) <= 11):
                name = "global_tolerance_class_iso_1328_2013"
                raise self.model.fault(self.gear, name, f'"{shown(text)}"', "want a class from 1 to 11")
            self.keys["grade"] = int(text)
        limits = {key: self.model.number(self.gear, name, "mum") for key, name in PERMITTED_DEVIATIONS.items()}
        stated = {key: value for key, value in limits.items() if value is not None and value > 0.0}
        if stated:
            self.keys["limits"] = stated
        others = sorted(
            name for name in self.gear.attributes
            if "allowance" in name or name.startswith("tooth_thickness_deviation") or "_din_396" in name
        )  # fmt: skip
        if others:
            self.says.append(
                f"{called(self.gear)}: not taken: {', '.join(map(shown, others[:6]))}; state [driving.limits]"
            )

    def modifications(self, flanks: dict[Side, Component]) -> None:
        """Tip relief and crowning of the flanks that have them."""
        reliefs: dict[Side, dict[str, object]] = {}
        crowning: dict[Side, float] = {}
        left_out = set()
        for side, flank in flanks.items():
            origins = [r for r in self.model.relations if r.type == "reference" and r.role("origin") == flank.id]
            for relation in origins:
                other = relation.role("referenced")
                one = self.model.components[other] if other is not None else flank
                relief = self.relief(one) if one.type == "tip_relief" else None
                c = self.crowning(one) if one.type == "profile_crowning" else None
                if relief is not None and side not in reliefs:
                    reliefs[side] = relief
                elif c is not None and side not in crowning:
                    crowning[side] = c
                elif one.type.startswith(
                    ("profile_", "helix_", "tip_", "root_", "end_", "triangular_", "topographical")
                ):
                    left_out.add(called(one))
        if left_out:
            self.says.append(
                f"{called(self.gear)}: modifications that are not taken: {', '.join(sorted(left_out)[:6])}"
            )
        self.relieved(reliefs)
        if crowning:
            self.crowned(crowning)

    def relieved(self, reliefs: dict[Side, dict[str, object]]) -> None:
        if len(reliefs) == 2 and reliefs["left"] == reliefs["right"]:
            self.keys["tip_relief"] = reliefs["left"]
        elif len(reliefs) == 1 and self.loaded is not None:
            (side,) = reliefs
            self.keys["tip_relief"] = reliefs[side] | {"flank": "drive" if side == self.loaded else "coast"}
        elif reliefs:
            self.says.append(
                f"{called(self.gear)}: the tip relief is left out, since left and right differ"
                + (" and loaded_tooth_flank is not stated" if len(reliefs) == 1 else "")
                + "; state [driving.tip_relief]"
            )

    def relief(self, one: Component) -> dict[str, object] | None:
        """A tip relief as its table, amount at the tip in um and radial length in mm."""
        number = self.model.number
        depth, shape = number(one, "tip_relief_depth", "mm"), one.attributes.get("shape_of_relief")
        power = RELIEF_SHAPES.get(str(shape.value)) if shape is not None else 1
        z, m, alpha, x = (
            float(str(self.keys[key])) for key in ("teeth", "module_mm", "pressure_angle_deg", "profile_shift")
        )
        r_a = 0.5 * float(
            str(self.keys.get("tip_diameter_mm", m * (z + 2.0 * x + 2.0 * float(str(self.keys.get("addendum", 1.0))))))
        )
        r_b = 0.5 * m * z * math.cos(math.radians(alpha))
        l_a = math.sqrt(max(0.0, r_a * r_a - r_b * r_b))
        d_start, length = number(one, "tip_relief_datum_diameter", "mm"), number(one, "tip_relief_datum_length", "mm")
        if d_start is None and length is not None:
            # Counted from the tip down the line of action.
            d_start = 2.0 * math.hypot(r_b, l_a - length) if 0.0 < length < l_a else None
        if depth is None or depth < 0.0 or d_start is None or power is None or not 2.0 * r_b < d_start < 2.0 * r_a:
            return None
        l_start = math.sqrt(0.25 * d_start * d_start - r_b * r_b)
        d_at = number(one, "tip_relief_evaluation_reference", "mm")
        if d_at is not None and d_start < d_at < 2.0 * r_a:
            depth *= ((l_a - l_start) / (math.sqrt(0.25 * d_at * d_at - r_b * r_b) - l_start)) ** power
        return {
            "amount_um": round(1e3 * depth, 6),
            "length_mm": round(r_a - 0.5 * d_start, 9),
            "shape": "linear" if power == 1 else "parabolic",
        }

    def crowning(self, one: Component) -> float | None:
        """A parabolic crowning in um that takes as much at the root as at the tip, else None."""
        tip, root = (self.model.number(one, f"profile_crowning_at_{end}", "mm") for end in ("tip", "root"))
        shape = one.attributes.get("shape_of_profile_crowning")
        if (
            tip is None
            or (root is not None and abs(tip - root) > 1e-9)
            or (shape is not None and shape.value != "parabolic")
        ):
            return None
        return round(1e3 * tip, 6)

    def crowned(self, crowning: dict[Side, float]) -> None:
        """Crowning stands where measured deviations stand, which a grade would then no longer draw."""
        if "grade" in self.keys or "limits" in self.keys:
            self.says.append(
                f"{called(self.gear)}: the crowning is left out, since a pair file has it beside measured deviations "
                "and not beside a grade; state profile_crowning_um with the inspection"
            )
        elif len(crowning) == 2 and crowning["left"] == crowning["right"]:
            self.keys["inspection"] = {"profile_crowning_um": crowning["left"]}
        else:
            self.says.append(f"{called(self.gear)}: the crowning is left out, since left and right differ")


def why_not(model: RexsModel, gear: Component) -> str:
    """Why gearpoly has no such gear, or ""."""
    if gear.type != "cylindrical_gear":
        return f"a {gear.type.replace('_', ' ')}"
    try:
        helix = model.number(gear, "helix_angle_reference_diameter", "deg")
        teeth = model.number(gear, "number_of_teeth", "none")
    except InputFileError as error:
        return str(error)
    if helix is not None and abs(helix) > FLANKS_AGREE_TOLERANCE:
        return f"helical, {helix:g} deg"
    return "an internal gear" if teeth is not None and teeth < 0 else ""
