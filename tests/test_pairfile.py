"""pair.toml and trace files: what is read, what is refused, and what the refusal says."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly.errors import InputFileError
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import (
    dump_pair,
    effective_defaults,
    moved,
    profile_csv_path,
    read_pair,
)
from gearpoly.files.traces import TEXT_LIMIT_BYTES, read_traces

ROOT = Path(__file__).parents[1]
BENCH = Path(__file__).parents[2] / "shared" / "recordings" / "bench"

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


def test_contract_example_is_read_whole(tmp_path: Path) -> None:
    write(tmp_path, "tooth,flank,roll_length_mm,deviation_um\n", "driving_flanks.csv")
    pair = read_pair(write(tmp_path, CONTRACT))
    assert pair.name == "18/25 bench pair"
    assert pair.pair.centre_distance_mm == 43.0
    assert (pair.pair.torque_nm, pair.pair.speed_rpm) == (25.0, 30.0)
    assert pair.model.tooth_deflection
    assert (pair.material.youngs_modulus_gpa, pair.material.poisson_ratio) == (206.0, 0.3)
    driving = pair.driving
    assert (driving.teeth, driving.module_mm, driving.grade) == (18, 2.0, 5)
    assert driving.limits is not None
    assert driving.inspection is not None
    assert (driving.limits.E_sns_um, driving.limits.E_sni_um) == (-40.0, -70.0)
    assert driving.inspection.pitch_um == tuple(PITCH)
    assert driving.inspection.profile_slope_um == 1.2
    assert driving.tip_relief is not None
    assert driving.eccentricity is not None
    assert driving.tip_relief.flank == "both"
    assert driving.eccentricity.angle_deg == 40.0
    assert profile_csv_path(tmp_path / "pair.toml", driving) == tmp_path / "driving_flanks.csv"
    assert pair.driven.limits is None
    assert pair.driven.inspection is None
    assert profile_csv_path(tmp_path / "pair.toml", pair.driven) is None


def test_defaults_are_iso_53_profile_a_and_steel(tmp_path: Path) -> None:
    pair = read_pair(write(tmp_path, SMALLEST))
    gear = pair.driving
    rack = (gear.pressure_angle_deg, gear.addendum, gear.dedendum, gear.root_radius)
    assert rack == (20.0, 1.0, 1.25, 0.38)
    assert (pair.material.youngs_modulus_gpa, pair.material.poisson_ratio) == (206.0, 0.3)
    assert pair.model.tooth_deflection
    assert pair.pair.torque_nm == 0.0
    assert pair.pair.centre_distance_mm is gear.bore_mm is gear.grade is None


def test_effective_defaults_name_what_was_left_out_and_nothing_else(tmp_path: Path) -> None:
    shown = dict(effective_defaults(read_pair(write(tmp_path, SMALLEST))))
    assert shown["driving.pressure_angle_deg"] == 20.0
    assert shown["model.tooth_deflection"] is True
    assert shown["driven.bore_mm"] == "half the root diameter"
    assert shown["pair.centre_distance_mm"] == "tight mesh of the deviation-free gears"
    assert shown["driving.grade"] == "ideal gear"
    assert "driving.teeth" not in shown
    assert "driving.grade_edition" not in shown  # without a grade it has no effect
    graded = SMALLEST.replace("teeth = 18", "teeth = 18\ngrade = 5\npoints_per_flank = 500")
    shown = dict(effective_defaults(read_pair(write(tmp_path, graded))))
    assert shown["driving.grade_edition"] == 2013
    assert shown["driving.thickness_errors"] == "graded"
    assert "driving.chord_error_um" not in shown  # points_per_flank stands in its place
    assert shown["driven.chord_error_um"] == 0.001


def test_integers_are_accepted_where_floats_are_wanted(tmp_path: Path) -> None:
    pair = read_pair(write(tmp_path, SMALLEST.replace("2.0", "2")))
    assert pair.driving.module_mm == 2.0
    assert isinstance(pair.driving.module_mm, float)


def test_byte_order_mark_and_crlf_are_fine(tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    file.write_bytes(b"\xef\xbb\xbf" + SMALLEST.replace("\n", "\r\n").encode())
    assert read_pair(file).driven.teeth == 25


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
        ("0x" + "f" * 9000, "a huge integer is too large", "10000 or less"),
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
        assert caught.value.file == str(path)
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
        stream.truncate(TEXT_LIMIT_BYTES + 1)  # sparse: takes no room
    assert reason(huge) == "larger than 64 MB"


def test_pair_is_frozen(tmp_path: Path) -> None:
    pair = read_pair(write(tmp_path, SMALLEST))
    with pytest.raises(ValueError, match="frozen"):
        pair.driving.teeth = 19


def test_every_key_is_described() -> None:
    sections = [PairFile]
    for section in sections:
        for key, info in section.model_fields.items():
            assert info.description, f"{section.__name__}.{key}"


# Writing back.

um = st.floats(-1e4, 1e4)
um_size = st.floats(0.0, 1e4)
length = st.floats(1e-3, 1e5)


@st.composite
def pairs(draw: st.DrawFn) -> PairFile:
    """Any pair that the rules allow, in the file's own structure."""

    def some(**keys: st.SearchStrategy[object]) -> dict[str, object]:
        return draw(st.fixed_dictionaries({}, optional=keys))

    module, angle = draw(st.floats(0.05, 100.0)), draw(st.none() | st.floats(10.0, 35.0))

    def gear() -> dict[str, object]:
        teeth = draw(st.integers(5, 40))
        per_tooth = um | st.lists(um, min_size=teeth, max_size=teeth)
        limits = some(f_pt_um=um_size, F_p_um=um_size, f_Halpha_um=um_size, f_falpha_um=um_size)
        for symbol in ("E_sn", "W_kn"):
            if draw(st.booleans()):
                lower, upper = sorted(draw(st.tuples(um, um)))
                limits |= {f"{symbol}i_um": lower, f"{symbol}s_um": upper}
        keys = ("pitch", "pitch_coast", "profile_slope", "profile_slope_coast", "tooth_thickness")
        tables: dict[str, object] = {
            "limits": limits,
            "inspection": some(uncertainty_um=um_size, **{f"{key}_um": per_tooth for key in keys}),
            "tip_relief": {
                "amount_um": draw(um_size),
                "length_mm": draw(length),
                **some(
                    shape=st.sampled_from(["linear", "parabolic"]),
                    flank=st.sampled_from(["both", "drive", "coast"]),
                ),
            },
            "eccentricity": {"amplitude_um": draw(um_size), **some(angle_deg=st.floats(-360, 360))},
        }
        kept = {name: table for name, table in tables.items() if draw(st.booleans())}
        points: list[dict[str, object]] = [
            {},
            {"points_per_flank": draw(st.integers(8, 200_000))},
            {"chord_error_um": draw(st.floats(1e-6, 10.0))},
        ]
        return {
            "teeth": teeth,
            "module_mm": module,
            "face_width_mm": draw(length),
            **({} if angle is None else {"pressure_angle_deg": angle}),
            **some(
                profile_shift=st.floats(-5.0, 5.0),
                bore_mm=length,
                grade=st.integers(1, 11),
                grade_edition=st.sampled_from([1995, 2013]),
                profile_errors=st.sampled_from(["smooth", "scatter"]),
            ),
            **draw(st.sampled_from(points)),
            **kept,
        }

    raw = some(
        name=st.text(max_size=20),
        pair=st.fixed_dictionaries({}, optional={"torque_nm": um_size, "speed_rpm": length}),
        model=st.fixed_dictionaries({}, optional={"tooth_deflection": st.booleans()}),
    )
    return PairFile.model_validate({**raw, "driving": gear(), "driven": gear()})


@settings(max_examples=60, deadline=None)
@given(pair=pairs())
def test_dumped_pair_reads_back_equal(pair: PairFile) -> None:
    with tempfile.TemporaryDirectory() as folder:
        again = read_pair(write(Path(folder), dump_pair(pair)))
    assert again == pair
    # What the file left out is still left out, so that `simulate` still shows it as a default.
    assert effective_defaults(again) == effective_defaults(pair)


def test_changed_copy_is_dumped_with_its_changes(tmp_path: Path) -> None:
    pair = read_pair(write(tmp_path, SMALLEST))
    driven = pair.driven.model_copy(update={"profile_shift": 0.1})
    fitted = pair.model_copy(update={"driven": driven})
    assert read_pair(write(tmp_path, dump_pair(fitted))) == fitted


def test_moved_pair_still_finds_its_traces(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    write(tmp_path, "tooth,flank,roll_length_mm,deviation_um\n", "driving_flanks.csv")
    source, target = write(tmp_path, CONTRACT), tmp_path / "out" / "fitted.toml"
    pair = moved(read_pair(source), source=source, target=target)
    write(target.parent, dump_pair(pair), target.name)
    traces = profile_csv_path(target, read_pair(target).driving)
    assert traces is not None
    assert traces.samefile(tmp_path / "driving_flanks.csv")


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused(data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(CONTRACT)))
    stop = data.draw(st.integers(start, min(len(CONTRACT), start + 30)))
    text = CONTRACT[:start] + data.draw(st.text(max_size=8)) + CONTRACT[stop:]
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder), "", "driving_flanks.csv")
        try:
            read_pair(write(Path(folder), text))
        except InputFileError as error:
            assert error.wish


@pytest.mark.parametrize("name", ["paper_18_25", "ideal_18_25", "ottewill_18_18"])
def test_shipped_pairs_are_read(name: str) -> None:
    pair = read_pair(ROOT / "data" / "pairs" / f"{name}.toml")
    assert (pair.driving.teeth, pair.driven.teeth) == tuple(int(z) for z in name.split("_")[1:])


@pytest.mark.skipif(not BENCH.is_dir(), reason="the shared bench recordings are not here")
def test_bench_pairs_are_read_and_written_back(tmp_path: Path) -> None:
    files = sorted(BENCH.glob("*/pair.toml"))
    assert files
    for file in files:
        pair = read_pair(file)
        assert read_pair(write(tmp_path, dump_pair(pair))) == pair


# Traces.

TRACES = """\
# gear measuring machine, run 12
deviation_um,tooth,roll_length_mm,flank
0.5,3,4.0,coast
1.5,3,3.0,coast
-2.0,3,6.0,drive
0.0,0,3.5,drive
1.0,0,2.5,drive
-1.0,3,5.0,drive
"""


def test_traces_are_sorted_and_converted(tmp_path: Path) -> None:
    traces = read_traces(write(tmp_path, TRACES, "flanks.csv"), 18)
    assert [(t.tooth, t.flank) for t in traces] == [(0, "drive"), (3, "drive"), (3, "coast")]
    assert traces[0].roll_length.tolist() == [2.5, 3.5]
    # One rounding of the product um * 1e-3 mm/um.
    np.testing.assert_allclose(traces[0].deviation, [1e-3, 0.0], rtol=1e-15, atol=0.0)
    assert not traces[0].deviation.flags.writeable
    assert not traces[0].roll_length.flags.writeable


@pytest.mark.parametrize(
    ("before", "after", "where", "found", "wish"),
    [
        ("6.0,drive", "6.0,left", "line 5, column flank", '"left"', "drive or coast"),
        ("-2.0,3", "-2.0,18", "line 5, column tooth", '"18"', "0 to 17"),
        ("-2.0,3", "-2.0,-1", "line 5, column tooth", '"-1"', "0 to 17"),
        ("-2.0,3", "-2.0,3.5", "line 5, column tooth", '"3.5"', "0 to 17"),
        ("-2.0", "nan", "line 5, column deviation_um", '"nan"', "finite number"),
        ("-2.0", "", "line 5, column deviation_um", "an empty cell", "finite number"),
        ("-2.0", "x", "line 5, column deviation_um", '"x"', "finite number"),
        ("-2.0", "-2e9", "line 5, column deviation_um", '"-2e9"', "-10000 to 10000"),
        ("6.0", "-6.0", "line 5, column roll_length_mm", '"-6.0"', "0 or more"),
        ("6.0,drive", "6.0", "line 5", "3 cells", "want 4"),
        ("-1.0,3,5.0", "-1.0,3,6.0", "line 8", "as in line 5", "each roll length once"),
        ("-1.0,3,5.0,drive", "-1.0,4,5.0,drive", "line 5", "one point on tooth 3", "at least 2"),
        (",flank", ",flunk", "line 2", '"flunk"', 'nearest known column is "flank"'),
        (",flank", "", "line 2", 'no column "flank"', "roll_length_mm"),
        (",flank", ",tooth", "line 2", 'column "tooth" twice', "once"),
        (TRACES.partition("flank\n")[2], "", "", "no rows", "want rows"),
        (TRACES, "", "", "an empty file", "want rows"),
    ],
)
def test_bad_trace_file(tmp_path: Path, before: str, after: str, where: str, found: str, wish: str) -> None:
    file = write(tmp_path, TRACES.replace(before, after, 1), "flanks.csv")
    with pytest.raises(InputFileError) as caught:
        read_traces(file, 18)
    error = caught.value
    assert (error.file, error.where) == (str(file), where)
    assert found in error.found
    assert wish in error.wish


def test_missing_trace_file(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="no such file"):
        read_traces(tmp_path / "none.csv", 18)
