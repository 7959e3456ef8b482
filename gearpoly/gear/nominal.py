"""The deviation-free gears that a pair file states."""

from __future__ import annotations

from gearpoly.gear.gear import Gear
from gearpoly.gear.rack import Rack, usual_round
from gearpoly.keys.sections import GearSection, PairFile
from gearpoly.units import DEG


def nominal_gears(file: PairFile) -> tuple[Gear, Gear]:
    """Both deviation-free gears of a pair file. Raises ``GeometryError`` where one cannot be cut."""
    return nominal_gear(file.driving, file.driven), nominal_gear(file.driven, file.driving)


def nominal_gear(section: GearSection, mate: GearSection | None = None) -> Gear:
    """The deviation-free gear of one gear section, with a root that leaves the tip of its ``mate`` free where none is
    stated. Raises ``GeometryError`` where it cannot be cut."""
    alpha, round_ = section.pressure_angle_deg * DEG, section.root_radius
    # The default means the same where a file writes it out.
    if round_ is None or round_ == Rack.rho_fP:
        h_aP = None if mate is None else mate.addendum
        round_ = usual_round(alpha=alpha, h_fP=section.dedendum, h_aP=h_aP)
    rack = Rack(alpha=alpha, h_aP=section.addendum, h_fP=section.dedendum, rho_fP=round_)
    return Gear(
        z=section.teeth,
        m=section.module_mm,
        x=section.profile_shift,
        rack=rack,
        b=section.face_width_mm,
        d_bore=section.bore_mm,
    )
