"""The gears as the recordings show them, and whether they still fit their grade or their inspection."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.assemble import nominal_gear
from gearpoly.diagnose.search import Search
from gearpoly.diagnose.verdict import BuiltGear
from gearpoly.errors import GearpolyError
from gearpoly.files.models import GearSection, PairFile
from gearpoly.gear.tolerances import tolerances
from gearpoly.mesh.pair import Flank
from gearpoly.physics.base import gear_section
from gearpoly.physics.sheet import column
from gearpoly.units import UM, FloatArray, read_only

GRADES = {1995: range(13), 2013: range(1, 12)}

FAR = 4.0
"""Standard deviations beyond which a tooth contradicts its inspection: one of 43 does by chance in 400 sets."""


def built_gears(search: Search, file: PairFile) -> tuple[BuiltGear, BuiltGear]:
    """Both gears, driving first."""
    return _built(search, file, 0), _built(search, file, 1)


def _built(search: Search, file: PairFile, gear: int) -> BuiltGear:
    model, layout = search.model, search.linear.layout
    as_built = model.as_built
    std = np.sqrt(np.maximum(np.diag(search.linear.system.covariance)[layout.built], 0.0))
    flank: Flank = as_built.flanks[0]
    tail = "_coast_um" if flank == "coast" else "_um"
    section = gear_section(model.declared, gear)
    pitch = column(section, f"pitch{tail}") + as_built.pitch(model.built, flank, gear)
    # Where both gears' teeth stand as a whole is the mean's matter, and cannot be told.
    pitch = pitch - float(np.mean(pitch)) if flank == "drive" else pitch
    slope = column(section, f"profile_slope{tail}") + as_built.slope(model.built, flank, gear)
    thickness = None
    if "coast" in as_built.flanks and "drive" in as_built.flanks:
        coast = column(section, "pitch_coast_um") + as_built.pitch(model.built, "coast", gear)
        drive = column(section, "pitch_um") + as_built.pitch(model.built, "drive", gear)
        thickness = float(np.mean(coast + drive)) / math.cos(math.radians(section.pressure_angle_deg))
    return BuiltGear(
        pitch=read_only(pitch),
        pitch_std=read_only(as_built.pitch(std, flank, gear)),
        slope=read_only(slope),
        slope_std=read_only(as_built.slope(std, flank, gear)),
        thickness=thickness,
        grade_needed=grade_needed(gear_section(file, gear), pitch, slope),
        grade_edition=section.grade_edition,
    )


def grade_needed(section: GearSection, pitch: FloatArray, slope: FloatArray) -> int | None:
    """The finest ISO 1328-1 grade whose limits of single pitch, cumulative pitch and profile slope hold ``pitch`` (z,)
    and ``slope`` (z,) in um; None where none does, or none is defined for such a gear."""
    ideal = nominal_gear(section)
    cos = math.cos(ideal.alpha)
    index = pitch / cos  # ISO 1328 measures along the reference circle
    single, total = np.max(np.abs(np.diff(index, append=index[0]))), np.ptp(index)
    for grade in GRADES[section.grade_edition]:
        try:
            limit = tolerances(d=2.0 * ideal.r, m=ideal.m, b=ideal.b, grade=grade, edition=section.grade_edition)
        except GearpolyError:
            return None
        f_halpha = limit.f_HalphaT
        if single <= limit.f_pT / UM and total <= limit.F_pT / UM and np.max(np.abs(slope)) <= f_halpha / UM:
            return grade
    return None


def compliance_scale(search: Search) -> tuple[float, float] | None:
    """The compliance over the declared and its standard error, where the recordings bend declared teeth."""
    place, model = search.nuisance.scale, search.model
    if place is None or any(claim.physics.name == "tooth_deflection" for claim in model.claims):
        return None
    at = search.linear.layout.nuisance.start + place
    scale = model.ratio * model.scale
    return scale, scale * math.sqrt(max(float(search.linear.system.covariance[at, at]), 0.0))


def contradicted(search: Search) -> list[str]:
    """Teeth that stand farther off their inspection than its uncertainty allows, in words."""
    model, out = search.model, []
    for flank in model.as_built.flanks:
        for gear, name in ((0, "driving"), (1, "driven")):
            prior = model.as_built.gears[gear]
            if prior.graded:
                continue
            for what, values, std in (
                ("pitch", model.as_built.pitch(model.built, flank, gear), math.sqrt(prior.pitch[0, 0])),
                ("slope", model.as_built.slope(model.built, flank, gear), prior.slope),
            ):
                far = np.flatnonzero(np.abs(values) > FAR * std)
                if far.size:
                    teeth = ", ".join(str(k) for k in far[:6].tolist())
                    out.append(
                        f"{what} of {name} tooth {teeth} ({flank} flank) differs from the inspection by up to "
                        f"{float(np.max(np.abs(values))):.1f} um, more than {FAR:.0f} times its uncertainty of {std:g} "
                        "um: inspect again"
                    )
    return out
