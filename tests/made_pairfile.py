"""The smallest pair file, the contract's example, and what a refusal looks like, for the tests of pair files."""

from __future__ import annotations

from pathlib import Path

import pytest

from gearpoly.errors import InputFileError
from gearpoly.files.pairfile import read_pair

ROOT = Path(__file__).parents[1]

SMALLEST = """\
[driving]
teeth = 18
module_mm = 2.0
[driven]
teeth = 25
module_mm = 2.0
"""

PITCH = [0.4, -1.2, *[0.1 * n for n in range(16)]]
COAST = [0.1, 0.3, *[-0.1 * n for n in range(16)]]

# The whole example of the contract; its lists are cut short there and have z values here.
CONTRACT = f"""\
name = "18/25 bench pair"

[pair]
centre_distance_mm = 43.0        # default: the tight-mesh distance
torque_nm = 25.0
speed_rpm = 30.0

[model]
tooth_deflection = true          # false: rigid teeth

[material]                       # default: steel
youngs_modulus_gpa = 206.0
poisson_ratio = 0.3

[driving]                        # [driven] has the same keys
teeth = 18
module_mm = 2.0
pressure_angle_deg = 20.0
addendum = 1.0
dedendum = 1.25
root_radius = 0.38
profile_shift = 0.0
face_width_mm = 20.0
bore_mm = 20.0
grade = 5
grade_edition = 2013

[driving.limits]
f_pt_um = 7.6
F_p_um = 30.0
F_alpha_um = 5.1
E_sns_um = -40.0
E_sni_um = -70.0

[driving.inspection]
uncertainty_um = 0.5
pitch_um = {PITCH}
pitch_coast_um = {COAST}
profile_slope_um = 1.2
profile_crowning_um = 0.0
tooth_thickness_um = -50.0
profile_csv = "driving_flanks.csv"

[driving.tip_relief]
amount_um = 8.0
length_mm = 0.7
shape = "linear"

[driving.eccentricity]
amplitude_um = 12.0
angle_deg = 40.0

[driven]
teeth = 25
module_mm = 2.0
face_width_mm = 20.0
"""


def write(folder: Path, text: str, name: str = "pair.toml") -> Path:
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


def refusal(folder: Path, text: str) -> InputFileError:
    file = write(folder, text)
    with pytest.raises(InputFileError) as caught:
        read_pair(file)
    error = caught.value
    assert error.file == str(file)
    assert str(error).startswith(str(file))
    assert "\n" not in str(error)
    return error
