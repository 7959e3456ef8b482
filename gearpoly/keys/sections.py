"""The keys that a pair file has of any pair: names, units, bounds, defaults and which contradict one another.

What a physics adds stands in its own file, and ``files.models`` puts both together. A section that is absent is
``None`` where its absence means something (no limits, not inspected).
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from gearpoly.keys.inspection import FOR_THE_GEAR
from gearpoly.keys.inspection import Inspection as Inspection
from gearpoly.keys.kinds import Length, Name, Um, UmSize, broken, field
from gearpoly.keys.kinds import Section as Section
from gearpoly.keys.sizes import LEAST_PITCH, MOST_PITCH, with_sizes


class Open(Section):
    """A table to which physics bring keys of their own, in their own files."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...


class PairSection(Open):
    """How the two gears are mounted and run."""

    centre_distance_mm: Length | None = field(
        "centre distance in mm, above 0; default: tight mesh of the deviation-free gears"
    )
    torque_nm: float = field(
        "torque on the driven shaft in N.m, 0 or more; its flank says which way it acts",
        0.0,
        ge=0.0,
        le=1e9,
    )
    torque_driving_nm: float | None = field(
        "torque on the driving (input) shaft in N.m, 0 or more, instead of torque_nm: times z_2/z_1", ge=0.0, le=1e9
    )
    speed_rpm: float | None = field("speed of the driving shaft in rpm, above 0; default: quasi-static", gt=0.0, le=1e6)

    @model_validator(mode="after")
    def _one_torque(self) -> Self:
        if self.torque_driving_nm is not None and "torque_nm" in self.model_fields_set:
            found = f"{self.torque_driving_nm}, and torque_nm = {self.torque_nm} too"
            broken("torque_driving_nm", found, "want one of the two, the torque on the input or on the driven shaft")
        return self


class ModelSection(Section):
    """What the simulation takes into account."""

    tooth_deflection: bool = field("true: teeth bend under load, false: rigid teeth", True)
    compliance: Literal["cantilever", "cantilever_published", "weber_banaschek", "potential_energy", "iso6336"] = field(
        "law by which a tooth bends, see docs/explanation/compliance.md", "cantilever"
    )
    contact: Literal["palmgren", "linear", "weber_banaschek"] = field("law by which two flanks flatten", "palmgren")
    compliance_scale: float = field(
        "factor on the compliance of every pair, contact included, 0.01 to 100", 1.0, ge=0.01, le=100.0
    )
    load_sharing: Literal["equilibrium", "paper"] = field(
        "equilibrium: only pressed pairs carry; paper: pairs join one by one and none leaves", "equilibrium"
    )


class MaterialSection(Section):
    """The material of both gears; default: steel."""

    youngs_modulus_gpa: float = field("Young's modulus in GPa, above 0 to 10000", 206.0, gt=0.0, le=1e4)
    poisson_ratio: float = field("Poisson's ratio, between -1 and 0.5", 0.3, gt=-1.0, lt=0.5)


class LimitsSection(Section):
    """Limits instead of, or over, those of the grade, in um."""

    f_pt_um: UmSize | None = field("single pitch limit in um, 0 or more")
    F_p_um: UmSize | None = field("total cumulative pitch limit in um, 0 or more")
    F_alpha_um: UmSize | None = field("total profile limit in um, 0 or more")
    f_Halpha_um: UmSize | None = field("profile slope limit in um, 0 or more")
    f_falpha_um: UmSize | None = field("profile form limit in um, 0 or more")
    E_sns_um: Um | None = field("upper tooth thickness deviation in um, along the reference circle; negative thins")
    E_sni_um: Um | None = field("lower tooth thickness deviation in um, along the reference circle; negative thins")
    W_kns_um: Um | None = field("upper base tangent length deviation in um; a drawn gear above it is drawn again")
    W_kni_um: Um | None = field("lower base tangent length deviation in um; a drawn gear below it is drawn again")

    @model_validator(mode="after")
    def _upper_above_lower(self) -> Self:
        for symbol in ("E_sn", "W_kn"):
            upper, lower = getattr(self, f"{symbol}s_um"), getattr(self, f"{symbol}i_um")
            if upper is not None and lower is not None and upper < lower:
                found = f"{upper}, below {symbol}i_um = {lower}"
                broken(
                    f"{symbol}s_um",
                    found,
                    f"want the upper deviation {symbol}s_um at or above the lower {symbol}i_um",
                )
        return self


class Encoder(Open):
    """What a shaft's encoder reads wrong: reading minus truth."""


RollLength = Annotated[float, Field(ge=0.0, le=1e5)]


class FormSection(Section):
    """What the flanks of a gear have beside all else that the file says of them: a curve over the roll length."""

    tooth: int | None = field("number of the tooth, from 0; default: all teeth", ge=0)
    flank: Literal["drive", "coast"] = field("drive or coast", "drive")
    roll_length_mm: tuple[RollLength, ...] = Field(
        strict=False, min_length=2, max_length=10_000, description="roll lengths in mm, rising"
    )
    deviation_um: tuple[Um, ...] = Field(
        strict=False, min_length=2, max_length=10_000,
        description="deviation in um there, positive = more material; straight between, level beyond the ends",
    )  # fmt: skip

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        count = len(self.roll_length_mm)
        if len(self.deviation_um) != count:
            wish = f"want {count}, one for each of roll_length_mm"
            broken("deviation_um", f"a list of {len(self.deviation_um)} values", wish)
        for k, (low, high) in enumerate(pairwise(self.roll_length_mm), start=1):
            if high <= low:
                broken("roll_length_mm", f"{high} at place {k} behind {low}", "want roll lengths that rise")
        return self


class GearSection(Open):
    """One gear: its rack, its blank, its quality, and what was measured of it."""

    teeth: int = Field(ge=5, le=10_000, description="number of teeth, 5 or more")
    module_mm: float = Field(ge=0.05, le=100.0, description="module in mm, 0.05 to 100; or diametral_pitch")
    diametral_pitch: float | None = field(
        "teeth per inch of reference diameter, 0.254 to 508, instead of module_mm: 25.4 over it",
        ge=LEAST_PITCH,
        le=MOST_PITCH,
    )
    pressure_angle_deg: float = field("pressure angle in deg, 10 to 35", 20.0, ge=10.0, le=35.0)
    addendum: float = field("addendum over the module, above 0 to 3", 1.0, gt=0.0, le=3.0)
    dedendum: float = field("dedendum over the module, above 0 to 4", 1.25, gt=0.0, le=4.0)
    tip_diameter_mm: Length | None = field(
        "tip diameter d_a in mm beside profile_shift, instead of addendum; or beside addendum, instead of profile_shift"
    )
    root_diameter_mm: Length | None = field("root diameter d_f in mm, instead of dedendum")
    root_radius: float | None = field(
        "tip radius of the rack over the module, 0 to 1; "
        "default: 0.38, or the largest that fits and leaves the mate's tip free",
        ge=0.0,
        le=1.0,
    )
    profile_shift: float = field("profile shift coefficient, -5 to 5", 0.0, ge=-5.0, le=5.0)
    face_width_mm: Length | None = field("face width in mm, above 0")
    bore_mm: Length | None = field("diameter of the bore in mm, above 0; default: half the root diameter")
    grade: int | None = field("ISO 1328-1 grade; default: ideal gear", ge=0, le=12)
    grade_edition: Literal[1995, 2013] = field("edition of ISO 1328-1, 1995 or 2013", 2013)
    points_per_flank: int | None = field(
        "points on each involute flank, 8 to 200000; default: from chord_error_um", ge=8, le=200_000
    )
    chord_error_um: float = field(
        "largest distance of a chord from its flank in um, 0.000001 to 10", 0.001, ge=1e-6, le=10.0
    )
    profile_errors: Literal["smooth", "scatter"] = field(
        "how drawn profile errors vary: in smooth waves, or (the paper's) each point on its own",
        "smooth",
    )
    thickness_errors: Literal["graded", "independent"] = field(
        "drawn thickness: the coast flank keeps the grade's pitch limits too, or (the paper's) "
        "each tooth's E_s on its own",
        "graded",
    )
    limits: LimitsSection | None = field("limits over the grade's, a table")
    inspection: Inspection | None = field("what was measured, a table")
    form: tuple[FormSection, ...] = field(
        "what the flanks have beside all else, tables", (), strict=False, fail_fast=True
    )

    @model_validator(mode="before")
    @classmethod
    def _sizes(cls, raw: Any) -> Any:
        return with_sizes(raw) if isinstance(raw, dict) else raw

    @model_validator(mode="after")
    def _keys_agree(self) -> Self:
        if self.grade is not None and self.grade_edition == 2013 and not 1 <= self.grade <= 11:
            wish = "want 1 to 11, which the 2013 edition defines, or grade_edition = 1995 for 0 to 12"
            broken("grade", f"{self.grade}, outside the 2013 edition", wish)
        if self.points_per_flank is not None and "chord_error_um" in self.model_fields_set:
            found = f"{self.points_per_flank}, and chord_error_um = {self.chord_error_um} too"
            broken(
                "points_per_flank",
                found,
                "want one of the two, since each sets the number of points",
            )
        for key, values in self.inspection or ():
            if isinstance(values, tuple) and key not in FOR_THE_GEAR and len(values) != self.teeth:
                wish = f"want {self.teeth}, one per tooth"
                wish += "" if key.startswith("profile_form") else ", or one number for all teeth"
                broken(f"inspection.{key}", f"a list of {len(values)} values", wish)
        for name, faults in self:
            for fault in faults if isinstance(faults, tuple) else ():
                tooth = getattr(fault, "tooth", None)
                if tooth is not None and tooth >= self.teeth:
                    wish = f"want a tooth from 0 to {self.teeth - 1}"
                    broken(f"{name}.tooth", f"{tooth}, of a gear with {self.teeth} teeth", wish)
        return self


class Measurement(Open):
    """What the rig itself did to recordings of this pair, apart from its encoders."""


class WormSection(Section):
    """The worm that the driven gear turns, and the wheel on a telescope's axis: what a guide log is read with."""

    wheel_teeth: int = Field(ge=10, le=10_000, description="teeth of the worm wheel, 10 or more")
    period_s: float | None = field(
        "seconds per turn of the worm, above 0; default: a sidereal day over wheel_teeth", gt=0.0, le=1e6
    )


class AlsoTurns(Section):
    """Another part of the drive that turns in a known ratio: a motor, a belt, a further stage, a bearing."""

    name: Name = Field(min_length=1, description="name of the part in quotes")
    turns_per_driving: float | None = field(
        "its turns for one of the driving gear, above 0; or turns_per_driven", gt=0.0, le=1e6
    )
    turns_per_driven: float | None = field(
        "its turns for one of the driven gear, above 0; or turns_per_driving", gt=0.0, le=1e6
    )
    teeth: int | None = field("its teeth, or balls of a bearing, if it meshes", ge=1, le=10_000)

    @model_validator(mode="after")
    def _one_ratio(self) -> Self:
        if (self.turns_per_driving is None) == (self.turns_per_driven is None):
            both = f"{self.turns_per_driven}, and turns_per_driving = {self.turns_per_driving} too"
            found = "missing, and turns_per_driving too" if self.turns_per_driven is None else both
            broken("turns_per_driven", found, f'want one of the two for "{self.name}": how fast it turns')
        return self


class PairFile(Section):
    """Everything that is known of a pair, in the file's units; made by :func:`read_pair`."""

    name: Name = field("name of the pair in quotes", "unnamed pair")
    pair: PairSection = field("how the gears are mounted and run, a table", PairSection())
    model: ModelSection = field("what is taken into account, a table", ModelSection())
    material: MaterialSection = field("material of both gears, a table", MaterialSection())
    driving: GearSection = Field(description="the driving gear, a table")
    driven: GearSection = Field(description="the driven gear, a table")
    measurement: Measurement | None = field("what the rig did to the recordings, a table")
    worm: WormSection | None = field("the worm that the driven gear turns, a table; for guide logs of telescopes")
    also_turns: tuple[AlsoTurns, ...] = field("other parts of the drive, tables", (), strict=False, fail_fast=True)

    @property
    def torque_nm(self) -> float:
        """Torque on the driven shaft in N.m, whichever shaft the file states it for."""
        driving = self.pair.torque_driving_nm
        return self.pair.torque_nm if driving is None else driving * self.driven.teeth / self.driving.teeth

    @model_validator(mode="after")
    def _gears_agree(self) -> Self:
        for key, called in (("module_mm", "module"), ("pressure_angle_deg", "pressure angle")):
            mine, mate = getattr(self.driven, key), getattr(self.driving, key)
            if mine != mate:
                default = "" if key in self.driven.model_fields_set else " by default"
                mate_default = "" if key in self.driving.model_fields_set else " by default"
                found = f"{mine}{default}, but driving.{key} = {mate}{mate_default}"
                broken(
                    f"driven.{key}",
                    found,
                    f"want the same {called} in both gears, or they do not mesh",
                )
        if self.model.tooth_deflection and self.torque_nm > 0.0:
            for gear in ("driving", "driven"):
                if getattr(self, gear).face_width_mm is None:
                    key = "torque_nm" if self.pair.torque_driving_nm is None else "torque_driving_nm"
                    torque = f"pair.{key} = {getattr(self.pair, key)} bends the teeth"
                    wish = f"want a face width in mm, since {torque} (or tooth_deflection = false)"
                    broken(f"{gear}.face_width_mm", "missing", wish)
        return self
