"""From what is known of a pair to the pair itself: nominal gears, their deviations, both on their axes.

Deviations come from the inspection where there is one, from a seeded draw within the grade or stated limits where
there is not, and are zero otherwise. Nothing is drawn for an inspected gear.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache, reduce
from pathlib import Path
from typing import Literal

import numpy as np

from gearpoly.arguments import GEARS
from gearpoly.errors import blamed
from gearpoly.files.models import GearSection, Inspection, PairFile
from gearpoly.files.pairfile import profile_csv_path
from gearpoly.files.traces import read_traces
from gearpoly.gear.deviations import (
    Crowning,
    Deviations,
    FormDeviation,
    Shape,
    Slope,
    Traces,
    pitch_and_thickness,
)
from gearpoly.gear.draw import draw_deviations, streams
from gearpoly.gear.flank import draw_flanks, points_for
from gearpoly.gear.gear import Gear
from gearpoly.gear.nominal import nominal_gear, nominal_gears
from gearpoly.gear.rack import Rack
from gearpoly.gear.root import form_point
from gearpoly.gear.tolerances import LIMIT_KEYS, Limits, default_thickness, limits_for, tolerances
from gearpoly.inspected import measured
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.deflection import Elasticity
from gearpoly.mesh.loaded import Sharing
from gearpoly.mesh.meshing import Meshing, compliance_under
from gearpoly.mesh.pair import GearPair, active_start, mount, tight_centre_distance
from gearpoly.mesh.shafts import Shafts
from gearpoly.physics import catalogue, in_order
from gearpoly.physics.parts import EncoderErrors, Parts
from gearpoly.units import GPA, UM, FloatArray, read_only


@dataclass(frozen=True, kw_only=True, eq=False)
class Assembled:
    """A pair made from a file: ``pair`` itself, how each gear came by its deviations ("ideal", "inspected" or
    "drawn"), and what bends: None where teeth stay rigid. ``shafts`` lie between mesh and encoders, ``encoders`` read
    the driving and the driven shaft, and ``support`` in mm per N.mm of driven torque lets the axes apart.
    """

    pair: GearPair
    origin: tuple[str, str]
    limits: tuple[Limits | None, Limits | None]
    elasticity: Elasticity | None
    sharing: Sharing
    deviations: tuple[Deviations, Deviations]
    shafts: Shafts = field(default_factory=Shafts)
    encoders: tuple[EncoderErrors, EncoderErrors] = (EncoderErrors(), EncoderErrors())

    support: float = 0.0

    def under(self, condition: Condition) -> Meshing:
        """The pair as it meshes under ``condition``: shafts and bearings let its axes apart in step with the torque.

        Raises ``GeometryError`` for teeth without a width that are to bend, or that no longer reach each other,
        ``OutOfRangeError`` for a material or law that is none.
        """
        apart = self.support * condition.torque
        pair = self.pair if apart == 0.0 else _apart(self.pair, apart)
        return Meshing(
            pair=pair,
            condition=condition,
            compliance=compliance_under(pair, self.elasticity, condition),
            sharing=self.sharing,
            shafts=self.shafts,
            support=self.support,
        )

    @property
    def feels_torque(self) -> bool:
        """Whether a torque changes anything."""
        return self.elasticity is not None or not self.shafts.rigid or self.support != 0.0


@lru_cache(maxsize=16)
def _apart(pair: GearPair, more: float) -> GearPair:
    """The pair with its axes ``more`` mm apart, kept: what was tabulated for a pair is kept by it."""
    return replace(pair, a=pair.a + more)


def with_tip(assembled: Assembled, gear: int, tooth: int) -> Assembled:
    """The same pair with the tip of one tooth in place, which is missing."""
    pair, made = assembled.pair, list(assembled.deviations)
    mounted = [pair.driving, pair.driven]
    flanks = mounted[gear].flanks
    rest = {k: one for k, one in flanks.chipped.items() if k != tooth}
    mounted[gear] = replace(mounted[gear], flanks=replace(flanks, chipped=rest))
    made[gear] = replace(made[gear], chips=tuple(one for one in made[gear].chips if one.tooth != tooth))
    whole = replace(pair, driving=mounted[0], driven=mounted[1])
    return replace(assembled, pair=whole, deviations=(made[0], made[1]))


def with_sheets_stated(file: PairFile, *, path: Path | str) -> PairFile:
    """The pair file at ``path`` with pitch and thickness of its inspections written out as deviations per tooth, so
    that what is found can be added to them; traces stay where they are. Raises ``InputFileError``."""
    sections: dict[str, GearSection] = {}
    for k, gear in enumerate(nominal_gears(file)):
        name = GEARS[k]
        section: GearSection = getattr(file, name)
        if section.inspection is not None:
            sheet, _ = measured(path, section, section.inspection, gear, name)
            sections[name] = section.model_copy(update={"inspection": sheet})
    return file.model_copy(update=sections)


def root_remarks(file: PairFile) -> list[str]:
    """Which roots are less round than usual because a usual one would not fit the cutting rack or would stand in the
    way of the mate's tip."""
    return [
        f"the {name} gear's root_radius is {gear.rack.rho_fP:.4f}, the largest that fits and leaves its mate's tip "
        f"free; the usual {Rack.rho_fP:g} does not"
        for name, gear, section in zip(GEARS, nominal_gears(file), (file.driving, file.driven), strict=True)
        if section.root_radius in (None, Rack.rho_fP) and gear.rack.rho_fP != Rack.rho_fP
    ]


def assemble(file: PairFile, *, path: Path | str, seed: int, chord_error: float = 0.0) -> Assembled:
    """Both gears of ``file`` (read from ``path``) drawn and mounted; ``seed`` decides what the file leaves to chance.
    Chords may stand ``chord_error`` mm off their flanks where the file states none and its default is finer.

    Raises ``InputFileError`` naming file and section for a gear that cannot be cut, limits that no gear keeps, or
    gears that cannot reach each other.
    """
    sections = (file.driving, file.driven)
    gears = _nominal(sections, path)
    with blamed(path, "driving, driven"):
        a_w = tight_centre_distance(gears[0], gears[1])
    flanks, origins, limits, made_of = [], [], [], []
    for k, name in enumerate(GEARS):
        section = sections[k]
        gear, mate = gears[k], gears[1 - k]
        with blamed(path, name):
            l_form = form_point(gear)[1]
            made = _Making(
                section=section,
                gear=gear,
                l_start=active_start(gear, mate, l_form=l_form),
                l_form=l_form,
                chord_error=chord_error,
            )
            if section.inspection is not None:
                shapes, origin, limit = (
                    _inspected(made, section.inspection, path, GEARS[k]),
                    "inspected",
                    None,
                )
            elif section.grade is not None or section.limits is not None:
                limit = stated_limits(section, gear, a=a_w)
                shapes, origin = _drawn(made, limit, streams(seed)[k], GEARS[k]), "drawn"
            else:
                shapes, origin, limit = Deviations(), "ideal", None
            shapes = shapes + brought_shapes(section, gear, k)
            flanks.append(draw_flanks(gear, shapes, l_start=made.l_start, points=made.points))
        made_of.append(shapes)
        origins.append(origin)
        limits.append(limit)
    parts = brought_parts(file)
    with blamed(path, "pair"):
        pair = mount(
            flanks[0],
            flanks[1],
            a=file.pair.centre_distance_mm,
            eccentricity_1=parts.eccentricity[0],
            eccentricity_2=parts.eccentricity[1],
        )
    return Assembled(
        pair=pair,
        deviations=(made_of[0], made_of[1]),
        origin=(origins[0], origins[1]),
        limits=(limits[0], limits[1]),
        elasticity=parts.elasticity if file.model.tooth_deflection else None,
        sharing=file.model.load_sharing,
        shafts=parts.shafts,
        encoders=parts.encoders,
        support=parts.support,
    )


def _nominal(sections: tuple[GearSection, GearSection], path: Path | str) -> list[Gear]:
    """Both deviation-free gears. Raises ``InputFileError`` naming the section of one that cannot be cut."""
    gears: list[Gear] = []
    for name, section, other in zip(GEARS, sections, sections[::-1], strict=True):
        with blamed(path, name):
            gears.append(nominal_gear(section, other))
    return gears


def brought_shapes(section: GearSection, gear: Gear, which: int) -> Deviations:
    """What every physics in the file makes of the flanks of a gear, the driving one (0) or the driven, and what they
    have beside all physics."""
    known = in_order(catalogue().values())
    return sum((one.shapes(section, gear, which) for one in known), start=_forms(section, gear.z))


def _forms(section: GearSection, z: int) -> Deviations:
    """The curves that the flanks of a gear of ``z`` teeth have beside all else."""
    sides: dict[str, list[Shape]] = {"drive": [], "coast": []}
    empty = np.empty(0)
    for one in section.form:
        l, d = np.array(one.roll_length_mm), np.array(one.deviation_um) * UM
        mine = [one.tooth in (None, tooth) for tooth in range(z)]
        sides[one.flank].append(
            Traces(tuple(l if here else empty for here in mine), tuple(d if here else empty for here in mine))
        )
    return Deviations(drive=tuple(sides["drive"]), coast=tuple(sides["coast"]))


def brought_parts(file: PairFile) -> Parts:
    """What every physics in the file makes of the pair beside its flanks."""
    bends = Elasticity(
        E=file.material.youngs_modulus_gpa * GPA,
        nu=file.material.poisson_ratio,
        law=file.model.compliance,
        contact=file.model.contact,
        scale=file.model.compliance_scale,
    )
    return reduce(lambda parts, one: one.build(file, parts), in_order(catalogue().values()), Parts(elasticity=bends))


@dataclass(frozen=True, kw_only=True)
class _Making:
    section: GearSection
    gear: Gear
    l_start: float
    l_form: float
    chord_error: float

    @property
    def points(self) -> int:
        if self.section.points_per_flank is not None:
            return self.section.points_per_flank
        chord_error = self.section.chord_error_um * UM
        if "chord_error_um" not in self.section.model_fields_set:
            chord_error = max(chord_error, self.chord_error)
        return points_for(self.gear, l_form=self.l_form, chord_error=chord_error)


def stated_limits(section: GearSection, gear: Gear, *, a: float, nearest: bool = False) -> Limits:
    """Limits in mm of a graded gear: its ``[limits]`` over its grade's; ``a`` centre distance in mm for the default
    backlash.

    Raises ``OutOfRangeError`` where the gear lies outside the standard's range; with ``nearest`` it has the limits of
    the nearest size there.
    """
    d, grade, edition = 2.0 * gear.r, section.grade, section.grade_edition
    graded = (
        tolerances(d=d, m=gear.m, b=gear.b, grade=grade, edition=edition, nearest=nearest)
        if grade is not None
        else None
    )
    stated = {
        key: None if value is None else value * UM
        for key in LIMIT_KEYS
        for value in [getattr(section.limits, f"{key}_um", None)]
    }
    thickness = default_thickness(a=a, m=gear.m, alpha=gear.alpha, F_pT=graded.F_pT) if graded is not None else None
    return limits_for(gear, grade=graded, stated=stated, thickness=thickness)


def _drawn(made: _Making, limits: Limits, rng: np.random.Generator, which: Literal["driving", "driven"]) -> Deviations:
    """Deviations drawn within ``limits``."""
    return draw_deviations(
        made.gear,
        limits,
        rng=rng,
        which=which,
        profile_errors=made.section.profile_errors,
        thickness_errors=made.section.thickness_errors,
        roll_lengths=np.linspace(made.l_start, made.gear.l_a, made.points),
    ).deviations


def _per_tooth(value: float | tuple[float, ...] | None, z: int) -> FloatArray:
    return read_only(np.broadcast_to(np.asarray(0.0 if value is None else value, dtype=float) * UM, (z,)))


def _inspected(made: _Making, sheet: Inspection, path: Path | str, which: Literal["driving", "driven"]) -> Deviations:
    """Deviations as measured: pitch, thickness, slope, crowning and form from the sheet, whole traces in place of the
    last three."""
    gear, z = made.gear, made.gear.z
    sheet, traces = measured(path, made.section, sheet, gear, which)
    coast = sheet.pitch_coast_um
    where = pitch_and_thickness(
        gear,
        index=_per_tooth(sheet.pitch_um, z),
        E_s=_per_tooth(sheet.tooth_thickness_um, z),
        index_coast=None if coast is None else _per_tooth(coast, z),
    )
    csv = profile_csv_path(path, made.section)
    traces = read_traces(csv, z) if csv is not None else traces
    sides: dict[str, tuple[Shape, ...]] = {}
    for flank, slope, crowning, form in (
        ("drive", sheet.profile_slope_um, sheet.profile_crowning_um, sheet.profile_form_um),
        (
            "coast",
            sheet.profile_slope_um if sheet.profile_slope_coast_um is None else sheet.profile_slope_coast_um,
            sheet.profile_crowning_um if sheet.profile_crowning_coast_um is None else sheet.profile_crowning_coast_um,
            sheet.profile_form_um if sheet.profile_form_coast_um is None else sheet.profile_form_coast_um,
        ),
    ):
        mine = {trace.tooth: trace for trace in traces if trace.flank == flank}
        # A whole trace holds slope and crowning already.
        plain = np.array([tooth not in mine for tooth in range(z)], dtype=float)
        empty = np.empty(0)
        sides[flank] = (
            Slope(_per_tooth(slope, z) * plain),
            Crowning(_per_tooth(crowning, z) * plain),
            *(() if form is None else (FormDeviation(read_only(np.array(form) * UM * plain[:, None])),)),
            Traces(
                tuple(mine[k].roll_length if k in mine else empty for k in range(z)),
                tuple(mine[k].deviation if k in mine else empty for k in range(z)),
            ),
        )
    return where + Deviations(drive=sides["drive"], coast=sides["coast"])
