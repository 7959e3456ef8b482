"""The pair as far as it is known: what nobody measured stands as free of deviations, never as drawn."""

from __future__ import annotations

from pathlib import Path

from gearpoly.assemble import Assembled, assemble, stated_limits
from gearpoly.errors import GearpolyError
from gearpoly.files.models import GearSection, Inspection, PairFile
from gearpoly.gear.gear import Gear
from gearpoly.gear.nominal import nominal_gears
from gearpoly.mesh.pair import tight_centre_distance
from gearpoly.units import UM


def known_pair(file: PairFile, *, path: Path | str) -> Assembled:
    """The pair of ``file`` (read from ``path``) with inspected deviations, and none where a grade only limits them.

    A graded gear keeps the middle of its thickness limits, since backlash is what they are stated for. Raises
    ``InputFileError`` as ``assemble`` does.
    """
    return assemble(known_file(file), path=path, seed=0)


def known_file(file: PairFile) -> PairFile:
    """The pair file with an inspection that found nothing in place of every grade."""
    try:
        gears = nominal_gears(file)
        a = tight_centre_distance(*gears)
        sections = {
            name: _plain(section, E_s=_middle(section, gear, a=a))
            for name, section, gear in (("driving", file.driving, gears[0]), ("driven", file.driven, gears[1]))
            if section.inspection is None and (section.grade is not None or section.limits is not None)
        }
    except GearpolyError:
        sections = {}  # assemble says what is wrong with the file, in the file's own terms
    return file.model_copy(update=sections)


def _middle(section: GearSection, gear: Gear, *, a: float) -> float:
    limits = stated_limits(section, gear, a=a)
    return 0.5 * (limits.E_sns + limits.E_sni)


def _plain(section: GearSection, *, E_s: float) -> GearSection:
    sheet = Inspection(tooth_thickness_um=E_s / UM, uncertainty_um=0.0)
    return section.model_copy(update={"grade": None, "limits": None, "inspection": sheet})
