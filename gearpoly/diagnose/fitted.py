"""The pair file with everything in it that the recordings showed."""

from __future__ import annotations

from gearpoly.diagnose.model import Model
from gearpoly.files.models import PairFile
from gearpoly.keys.edit import changed, gear_section, on_gear
from gearpoly.physics.sheet import SHEET_DECIMALS

UNCERTAINTY = 0.05
"""um. Least uncertainty that is written for teeth that were estimated from recordings."""


def fitted_file(model: Model) -> PairFile:
    """The declared pair with as-built teeth, compliance and all claims; ``simulate`` and ``compare`` accept it.

    A gear that only had a grade now has an inspection: that of the recordings.
    """
    file = model.file()
    for gear in (0, 1):
        section = gear_section(file, gear)
        sheet = section.inspection
        if sheet is None:
            continue
        uncertainty = max(sheet.uncertainty_um, UNCERTAINTY)
        file = on_gear(file, gear, inspection=changed(sheet, uncertainty_um=round(uncertainty, SHEET_DECIMALS)))
    name = file.name if file.name.endswith("(fitted)") else f"{file.name} (fitted)"
    copy: PairFile = changed(file, name=name)
    return copy
