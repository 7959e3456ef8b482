"""A pair file to fill in, with what each key means beside it."""

from __future__ import annotations

import json

from gearpoly.files.sheet_csv import SIDES_HELP

TEMPLATE = """# A pair file of gearpoly. It runs as it stands; keys behind a # may be stated.
# All keys: docs/reference/pair_file.md. Lengths in mm, deviations in um, angles in deg.

name = "my pair"

[pair]
# centre_distance_mm = 43.05      # default: tight mesh of the deviation-free gears
torque_nm = 0.0                   # on the driven (output) shaft
# torque_driving_nm = 10.0        # or on the driving (input) shaft, instead of torque_nm
# speed_rpm = 30.0                # of the driving shaft

{driving}
{driven}"""

GEAR = """[{gear}]
teeth = {teeth}
module_mm = 2.0                   # or diametral_pitch = 12.7, teeth per inch
# pressure_angle_deg = 20.0
# addendum = 1.0                  # times the module, as dedendum and root_radius
# dedendum = 1.25
# profile_shift = 0.0
face_width_mm = 20.0
# bore_mm = 20.0                  # diameter
# grade = 6                       # ISO 1328-1:2013, where nobody inspected the gear

# [{gear}.inspection]
# uncertainty_um = 0.5            # standard uncertainty of what follows
# single_pitch_um = [0.4, -0.4]   # f_p of the drive flank, one per tooth, positive = pitch too large, as on the sheet;
#                                 # not the same as pitch_um, the index deviation (the F_p curve), positive = material
# profile_slope_um = 1.2          # rise of material from active root to tip
# span_mm = 15.2                  # measured base tangent length W_k ...
# span_teeth = 3                  # ... over so many teeth
# over_pins_mm = 40.9             # or the size over two pins (balls) ...
# pin_diameter_mm = 3.5           # ... of this diameter; or tooth_thickness_um, E_s itself
"""

SHEET_SECTION_TEXT = """
[{gear}.inspection]              # filled from the sheet; an empty one counts as not inspected
sheet_csv = {sheet}
"""

TEMPLATE_TEETH = {"driving": 18, "driven": 25}
"""Those of the pair that the documentation shows."""


def pair_template(*, sheet: str | None) -> str:
    """The text of a commented pair file; ``sheet`` is the path of its inspection sheet as seen from it, if any."""

    def gear(name: str) -> str:
        text = GEAR.format(gear=name, teeth=TEMPLATE_TEETH[name])
        if sheet is None:
            return text
        # A table stands once in a file: the sheet's takes the place of the commented one.
        shown = SHEET_SECTION_TEXT.format(gear=name, sheet=json.dumps(sheet, ensure_ascii=False))
        return text.replace(f"\n# [{name}.inspection]\n", shown)

    head, name, rest = TEMPLATE.partition("\nname = ")
    return f"{head}{SIDES_HELP}\n{name}{rest}".format(driving=gear("driving"), driven=gear("driven"))
