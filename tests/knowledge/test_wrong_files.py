"""Where a file is wrong nothing is missing: no physics is named, and the verdict says what does not fit."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from gearpoly.files.models import PairFile
from gearpoly.keys.edit import on_gear
from gearpoly.recording.recording import Recording
from gearpoly.units import UM
from tests.knowledge.rigs import COAST, UNLOADED, bending, graded, hidden, record
from tests.knowledge.verdicts import Verdict, verdict
from tests.physics_cases import Condition

pytestmark = pytest.mark.slow

LOADED = Condition(torque_nm=40.0)


def remark(found: Verdict, words: str) -> bool:
    return any(words in one for one in found.json["remarks"])


def noise_alone(one: Recording, um: float) -> Recording:
    """The recording of a rig that computed the transmission error, and recorded noise for it."""
    assert one.driven_angle_rad is not None
    te = np.random.default_rng(4).normal(0.0, um * UM, one.driven_angle_rad.size)
    return replace(one, driving_angle_rad=None, driving_zero_rad=None, te_mm=te)


def test_a_mesh_that_is_not_in_the_recording_is_cancelled_by_no_relief() -> None:
    """Teeth that bend by some micrometres at every mesh, and a recording of 0.3 um of noise: two reliefs would cancel
    the mesh to a tenth, and so does another column."""
    known = bending()
    found = verdict(known, [noise_alone(one, 0.3) for one in record(known, LOADED)])
    assert not found.missing, found.told
    assert found.located(("mesh_phase", "mesh_order")), found.told


def test_a_mounting_between_two_recordings_is_told() -> None:
    """The driving gear runs 12 um off its axis in one, 15 um and the other way in the next: both on the drive flank,
    where an eccentricity is the same under any load."""
    known = bending()
    first = record(hidden(known, "eccentricity", (12.0, 0.0), gear=0), Condition(torque_nm=10.0))
    second = record(hidden(known, "eccentricity", (-15.0, 4.0), gear=0), LOADED, seed=2)
    found = verdict(known, [*first, *second])
    assert not found.missing, found.told
    assert remark(found, "no one mounting does that")


def test_an_eccentric_gear_under_two_torques_is_mounted_once() -> None:
    """60 um off its axis, which bends teeth otherwise where it carries more: it keeps its name."""
    known = bending()
    true = hidden(known, "eccentricity", (60.0, 0.0), gear=0)
    found = verdict(known, record(true, Condition(torque_nm=10.0), LOADED))
    assert [(one["physics"], one["gear"]) for one in found.missing] == [("eccentricity", "driving")], found.told
    assert not remark(found, "mounted anew")


def at(file: PairFile, deg: float) -> PairFile:
    """The pair with another pressure angle, on the same axes."""
    for gear in (0, 1):
        file = on_gear(file, gear, pressure_angle_deg=deg)
    return file


def test_a_wrong_pressure_angle_is_no_centre_distance() -> None:
    """22.5 deg for 20: backlash and hand-over are those of axes that stand a fifth of a millimetre nearer."""
    _, known = graded((12, 16), bends=True)
    wrong = at(known, 22.5)
    found = verdict(wrong, record(known, LOADED, replace(COAST, torque_nm=40.0)), within=120.0)
    assert not found.missing, found.told


def shifted(file: PairFile, by: float) -> PairFile:
    """The pair with so much more profile shift of the driving gear, and less of the driven one, on the same axes."""
    for gear, more in ((0, by), (1, -by)):
        file = on_gear(file, gear, profile_shift=more)
    return file


def test_a_wrong_profile_shift_is_told_and_no_relief_named() -> None:
    """Teeth shifted by 0.3 of the module of which the file knows nothing: tips end elsewhere, roots are thicker."""
    true, known = graded((15, 28), bends=True)
    found = verdict(known, record(shifted(true, 0.3), Condition(torque_nm=10.0), LOADED), within=120.0)
    assert not found.missing, found.told
    assert remark(found, "check profile_shift in the drawing"), found.json["remarks"]
    told = next(one for one in found.json["remarks"] if "check profile_shift" in one)
    shifts = [float(one) for one in re.findall(r"(-?\d\.\d+) \((?:driving|driven)\)", told)][:2]
    assert shifts == pytest.approx([0.3, -0.3], abs=0.02)  # tried in steps of 0.0125


def test_the_right_profile_shift_stays() -> None:
    """A relief as deep as what another shift makes at every mesh: the keys are not it."""
    true, known = graded((15, 28), bends=True)
    true = hidden(true, "tip_relief", (15.0, 0.9), gear=0, form="linear")
    found = verdict(known, record(true, Condition(torque_nm=10.0), LOADED), within=120.0)
    assert not remark(found, "in the drawing"), found.json["remarks"]


def test_an_unloaded_pair_of_another_sheet_is_not_explained_tooth_by_tooth() -> None:
    """Noise of 3 um beside a sheet of as much: a tooth of the sheet that is not there is no tooth that deviates."""
    true, _ = graded((12, 17))
    recordings = [noise_alone(one, 3.0) for one in record(true, UNLOADED)]
    found = verdict(true, recordings)
    assert not found.missing, found.told


def test_gears_of_twice_the_teeth_get_no_name() -> None:
    """18/24 teeth of module 1 on the same axes have the ratio of 9/12 of module 2, and their mesh is an even one of
    its. What every second tooth has looks like teeth of the declared pair, and most of the rest stays."""
    true, _ = graded((18, 24), pitch_um=4.0, slope_um=3.0)
    _, known = graded((9, 12))
    for gear in (0, 1):
        true = on_gear(true, gear, module_mm=1.0)
    found = verdict(known, record(true, UNLOADED, cycles=4.0), within=60.0)
    assert not found.missing, found.told
    assert found.json["unexplained"]
