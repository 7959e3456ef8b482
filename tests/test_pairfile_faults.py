"""What is wrong with a pair file is said once, with section, key, value and cure."""

from __future__ import annotations

from pathlib import Path

import pytest

from gearpoly.errors import InputFileError
from gearpoly.files.pairfile import read_pair
from gearpoly.files.traces import FILE_LIMIT_BYTES
from tests.made_pairfile import SMALLEST, refusal, write

# In [driven], at the end of SMALLEST: (line, key, what was found, what would do).
DRIVEN_FAULTS = [
    ("bore_mm = 0", "bore_mm", "0 is too small", "more than 0"),
    ("bore_mm = -20.0", "bore_mm", "-20.0 is too small", "more than 0"),
    ('bore_mm = "20"', "bore_mm", '"20"', "a number"),
    ("bore_mm = true", "bore_mm", "true", "a number"),
    ("bore_mm = nan", "bore_mm", "nan", "a finite number"),
    ("bore_mm = inf", "bore_mm", "inf", "a finite number"),
    ("bore_mm = 1979-05-27", "bore_mm", "1979-05-27", "a number"),
    ("bore_mm = [20.0]", "bore_mm", "a list of 1 values", "a number"),
    ("bore_mm = {d = 20.0}", "bore_mm", "a table", "a number"),
    ("face_width_mm = 0.0", "face_width_mm", "too small", "more than 0"),
    ("pressure_angle_deg = 9.0", "pressure_angle_deg", "9.0 is too small", "10 or more"),
    ("pressure_angle_deg = 0.349", "pressure_angle_deg", "too small", "in deg, 10 to 35"),
    ("pressure_angle_deg = 36", "pressure_angle_deg", "too large", "35 or less"),
    ("addendum = 0.0", "addendum", "too small", "more than 0"),
    ("addendum = 4.0", "addendum", "too large", "3 or less"),
    ("dedendum = 5.0", "dedendum", "too large", "4 or less"),
    ("dedendum = 0", "dedendum", "too small", "more than 0"),
    ("root_radius = -0.1", "root_radius", "too small", "0 or more"),
    ("root_radius = 1.1", "root_radius", "too large", "1 or less"),
    ("profile_shift = 6.0", "profile_shift", "too large", "5 or less"),
    ("grade = 0", "grade", "0, outside the 2013 edition", "want 1 to 11"),
    ("grade = 12", "grade", "12, outside the 2013 edition", "grade_edition = 1995"),
    ("grade = 13", "grade", "13 is too large", "12 or less"),
    ("grade = 5.0", "grade", "5.0", "a whole number"),
    ("grade_edition = 2020", "grade_edition", "2020", "1995 or 2013"),
    ("points_per_flank = 7", "points_per_flank", "7 is too small", "8 or more"),
    ("points_per_flank = 200001", "points_per_flank", "too large", "200000 or less"),
    ("chord_error_um = 0.0", "chord_error_um", "too small", "1e-06 or more"),
    (
        "points_per_flank = 90\nchord_error_um = 0.1",
        "points_per_flank",
        "90, and chord_error_um = 0.1 too",
        "want one of the two",
    ),
    ('profile_errors = "rough"', "profile_errors", '"rough"', "'smooth' or 'scatter'"),
    ('thickness_errors = "x"', "thickness_errors", '"x"', "'graded' or 'independent'"),
    ("limits = 3", "limits", "3", "a table"),
    ("[driven.limits]\nf_pt_um = -1.0", "limits.f_pt_um", "too small", "0 or more"),
    (
        "[driven.limits]\nE_sns_um = -70\nE_sni_um = -40",
        "limits.E_sns_um",
        "-70.0, below E_sni_um = -40.0",
        "at or above the lower E_sni_um",
    ),
    (
        "[driven.limits]\nW_kns_um = -70\nW_kni_um = -40",
        "limits.W_kns_um",
        "-70.0, below W_kni_um = -40.0",
        "at or above the lower W_kni_um",
    ),
    (
        "[driven.inspection]\npitch_um = [1, 2, 3]",
        "inspection.pitch_um",
        "a list of 3 values",
        "want 25, one per tooth",
    ),
    (
        '[driven.inspection]\npitch_um = [1, 2, 3, "4"]',
        "inspection.pitch_um[3]",
        '"4"',
        "a number: index deviation",
    ),
    ("[driven.inspection]\npitch_um = [nan]", "inspection.pitch_um[0]", "nan", "a finite number"),
    ('[driven.inspection]\npitch_um = "4"', "inspection.pitch_um", '"4"', "a number"),
    (
        "[driven.inspection]\nprofile_slope_um = 1e5",
        "inspection.profile_slope_um",
        "large",
        "10000",
    ),
    (
        "[driven.inspection]\nuncertainty_um = -0.1",
        "inspection.uncertainty_um",
        "small",
        "0 or more",
    ),
    ('[driven.inspection]\nprofile_csv = ""', "inspection.profile_csv", '""', "not empty"),
    (
        '[driven.inspection]\nprofile_csv = "no.csv"',
        "inspection.profile_csv",
        "no such",
        "relative",
    ),
    ("[driven.tip_relief]\namount_um = 8.0", "tip_relief.length_mm", "missing", "radial length"),
    (
        "[driven.tip_relief]\namount_um = -8.0\nlength_mm = 0.7",
        "tip_relief.amount_um",
        "-8.0 is too small",
        "0 or more",
    ),
    (
        "[driven.tip_relief]\namount_um = 8.0\nlength_mm = 0.0",
        "tip_relief.length_mm",
        "0.0 is too small",
        "more than 0",
    ),
    (
        '[driven.tip_relief]\namount_um = 8.0\nlength_mm = 1.0\nshape = "round"',
        "tip_relief.shape",
        '"round"',
        "'linear' or 'parabolic'",
    ),
    (
        '[driven.tip_relief]\namount_um = 8.0\nlength_mm = 1.0\nflank = "left"',
        "tip_relief.flank",
        '"left"',
        "'both', 'drive' or 'coast'",
    ),
    ("[driven.eccentricity]\namplitude_um = -1", "eccentricity.amplitude_um", "-1", "0 or more"),
    ("[driven.eccentricity]\nangle_deg = 3.0", "eccentricity.amplitude_um", "missing", "distance"),
]


@pytest.mark.parametrize(("line", "key", "found", "wish"), DRIVEN_FAULTS)
def test_bad_value_of_a_gear(tmp_path: Path, line: str, key: str, found: str, wish: str) -> None:
    error = refusal(tmp_path, f"{SMALLEST}{line}\n")
    assert error.where == f"driven.{key}"
    assert found in error.found
    assert wish in error.wish


@pytest.mark.parametrize(
    ("value", "found", "wish"),
    [
        ('"18"', '"18"', "a whole number: number of teeth, 5 or more"),
        ("18.5", "18.5", "a whole number"),
        ("18.0", "18.0", "a whole number"),
        ("true", "true", "a whole number"),
        ("4", "4 is too small", "5 or more"),
        ("-18", "-18 is too small", "5 or more"),
        ("100000", "too large", "10000 or less"),
        ("0x" + "f" * 9000, "a huge value is too large", "10000 or less"),
    ],
)
def test_bad_number_of_teeth(tmp_path: Path, value: str, found: str, wish: str) -> None:
    error = refusal(tmp_path, SMALLEST.replace("18", value))
    assert error.where == "driving.teeth"
    assert found in error.found
    assert wish in error.wish


@pytest.mark.parametrize(
    ("section", "where", "found", "wish"),
    [
        ("[pair]\ntorque_nm = -1.0", "pair.torque_nm", "-1.0 is too small", "0 or more"),
        ("[pair]\nspeed_rpm = 0.0", "pair.speed_rpm", "0.0 is too small", "more than 0"),
        ("[pair]\ncentre_distance_mm = 0", "pair.centre_distance_mm", "0 is", "more than 0"),
        ("[model]\ntooth_deflection = 1", "model.tooth_deflection", "1", "true or false"),
        (
            "[material]\nyoungs_modulus_gpa = 0",
            "material.youngs_modulus_gpa",
            "0 is",
            "more than 0",
        ),
        ("[material]\npoisson_ratio = 0.5", "material.poisson_ratio", "0.5 is", "less than 0.5"),
        ("[material]\npoisson_ratio = -1", "material.poisson_ratio", "-1 is", "more than -1"),
        ("[[pair]]\ntorque_nm = 1.0", "pair", "a list of 1 values", "a table"),
        ("[extra]\nname = 3", "extra", "unknown key", "at the top of the file"),
    ],
)
def test_bad_value_elsewhere(tmp_path: Path, section: str, where: str, found: str, wish: str) -> None:
    error = refusal(tmp_path, f"{SMALLEST}{section}\n")
    assert (error.where, found in error.found, wish in error.wish) == (where, True, True)


@pytest.mark.parametrize(("module", "good"), [(0.05, True), (100.0, True), (0.04, False)])
def test_module_range_includes_its_ends(tmp_path: Path, module: float, good: bool) -> None:
    text = SMALLEST.replace("2.0", str(module))
    if good:
        assert read_pair(write(tmp_path, text)).driven.module_mm == module
    else:
        assert refusal(tmp_path, text).where == "driving.module_mm"


@pytest.mark.parametrize("grade", [0, 1, 11, 12])
def test_1995_edition_has_grades_0_to_12(tmp_path: Path, grade: int) -> None:
    text = f"{SMALLEST}grade = {grade}\ngrade_edition = 1995\n"
    assert read_pair(write(tmp_path, text)).driven.grade == grade


@pytest.mark.parametrize(
    ("before", "after", "where"),
    [
        ("teeth = 18\n", "", "driving.teeth"),
        ("module_mm = 2.0\n[driven]", "[driven]", "driving.module_mm"),
        ("[driven]\nteeth = 25\nmodule_mm = 2.0\n", "", "driven"),
    ],
)
def test_missing_key(tmp_path: Path, before: str, after: str, where: str) -> None:
    error = refusal(tmp_path, SMALLEST.replace(before, after))
    assert (error.where, error.found) == (where, "missing")


def test_empty_file_asks_for_the_driving_gear(tmp_path: Path) -> None:
    error = refusal(tmp_path, "")
    assert (error.where, error.found) == ("driving", "missing")
    assert "the driving gear" in error.wish


@pytest.mark.parametrize(
    ("text", "where", "wish"),
    [
        (
            SMALLEST + "module = 2.0\n",
            "driven.module",
            'nearest known key in [driven] is "module_mm"',
        ),
        (SMALLEST + "Grade = 5\n", "driven.Grade", 'nearest known key in [driven] is "grade"'),
        (SMALLEST + "torque_nm = 5.0\n", "driven.torque_nm", "belongs in [pair]"),
        (SMALLEST + "pitch_um = 5.0\n", "driven.pitch_um", "belongs in [driven.inspection]"),
        (SMALLEST + "name = 'x'\n", "driven.name", "belongs at the top of the file"),
        (
            SMALLEST + "[driven.limits]\ngrade = 5\n",
            "driven.limits.grade",
            "there is none in [driven.limits], it belongs in [driven]",
        ),
        ("teeth = 18\n" + SMALLEST, "teeth", "belongs in [driving] and [driven]"),
        (SMALLEST.replace("[driving]", "[drivng]"), "drivng", 'is "driving"'),
        (SMALLEST + "[pair]\ncenter_distance_mm = 43.0\n", "pair.center_distance_mm", "centre_"),
        (SMALLEST + "[pair]\nteeth = 18\n", "pair.teeth", "belongs in [driving] and [driven]"),
        (SMALLEST + "torque = 5.0\n", "driven.torque", '"torque_nm" in [pair]'),
        (SMALLEST + '"@list" = 5.0\n', "driven.@list", "nearest known key in [driven]"),
    ],
)
def test_unknown_key_names_the_nearest_and_its_section(tmp_path: Path, text: str, where: str, wish: str) -> None:
    error = refusal(tmp_path, text)
    assert (error.where, error.found) == (where, "unknown key")
    assert wish in error.wish


def test_the_most_basic_fault_comes_first(tmp_path: Path) -> None:
    # A misspelt key also makes its section lack the right one; the misspelling is the cause.
    assert refusal(tmp_path, SMALLEST.replace("teeth = 25", "tooth = 25")).where == "driven.tooth"
    both_bad = SMALLEST.replace("18", "1").replace("25", "2")
    assert refusal(tmp_path, both_bad).where == "driving.teeth"
    driving, driven = both_bad[: both_bad.index("[driven]")], both_bad[both_bad.index("[driven]") :]
    assert refusal(tmp_path, driven + driving).where == "driven.teeth"


def test_gears_of_different_module_or_pressure_angle(tmp_path: Path) -> None:
    error = refusal(tmp_path, SMALLEST[: SMALLEST.rindex("2.0")] + "2.5\n")
    assert error.where == "driven.module_mm"
    assert "2.5" in error.found
    assert "driving.module_mm = 2.0" in error.found
    assert "same module" in error.wish
    error = refusal(tmp_path, SMALLEST + "pressure_angle_deg = 25.0\n")
    assert error.where == "driven.pressure_angle_deg"
    assert "25.0" in error.found
    assert "driving.pressure_angle_deg = 20.0 by default" in error.found


def test_face_width_is_required_only_where_teeth_deflect(tmp_path: Path) -> None:
    loaded = SMALLEST + "[pair]\ntorque_nm = 25.0\n"
    error = refusal(tmp_path, loaded)
    assert (error.where, error.found) == ("driving.face_width_mm", "missing")
    assert "pair.torque_nm = 25.0" in error.wish
    assert "tooth_deflection = false" in error.wish
    one = loaded.replace("teeth = 18", "teeth = 18\nface_width_mm = 20")
    assert refusal(tmp_path, one).where == "driven.face_width_mm"
    both = one.replace("teeth = 25", "teeth = 25\nface_width_mm = 20")
    assert read_pair(write(tmp_path, both)).driven.face_width_mm == 20.0
    assert read_pair(write(tmp_path, loaded + "[model]\ntooth_deflection = false\n"))
    assert read_pair(write(tmp_path, loaded.replace("25.0", "0.0")))


@pytest.mark.parametrize(
    ("text", "where", "standing"),
    [
        ("[driving]\nteeth : 18\n", "line 2, column 7", "`teeth : 18`"),
        ("[driving]\nmodule_mm = 2,0\n", "line 2, column 14", "`module_mm = 2,0`"),
        ("[driving]\nteeth = 18\nteeth = 19\n", "line 3, column 11", "`teeth = 19`"),
        ("[driving]\nteeth =", "line 2, column 8", "`teeth =`"),
        ("[driving", "line 1, column 9", "`[driving`"),
    ],
)
def test_syntax_error_names_line_and_column(tmp_path: Path, text: str, where: str, standing: str) -> None:
    error = refusal(tmp_path, text)
    assert error.where == where
    assert standing in error.found
    assert "`key = value`" in error.wish


@pytest.mark.parametrize("text", ["a = " + "[" * 5000, "a = " + "9" * 5000])
def test_monstrous_values_are_refused_not_crashed_on(tmp_path: Path, text: str) -> None:
    assert "TOML" in refusal(tmp_path, text).wish


def test_file_that_cannot_be_read(tmp_path: Path) -> None:
    def reason(path: Path) -> str:
        with pytest.raises(InputFileError) as caught:
            read_pair(path)
        assert caught.value.file == str(path).replace("\0", "\\x00")
        return caught.value.found

    assert reason(tmp_path / "absent.toml") == "no such file"
    assert reason(tmp_path) == "a folder"
    assert "cannot be read" in reason(tmp_path / "null\0byte.toml")
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b'[pair]\nname = "Zahnr\xe4der"\n')
    with pytest.raises(InputFileError, match=r"line 2: byte 0xe4.*UTF-8"):
        read_pair(latin)
    huge = tmp_path / "huge.toml"
    with huge.open("wb") as stream:
        stream.truncate(FILE_LIMIT_BYTES + 1)  # sparse: takes no room
    assert reason(huge) == "larger than 64 MB"
