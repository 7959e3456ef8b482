"""What is asked of an owner's file is right as it stands: times of controllers, runs, per cent, counts, other tests."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.by_readings import counter_modulus
from gearpoly.recording.map_lines import each_once
from gearpoly.recording.map_text import map_text
from gearpoly.recording.read import read_recording
from gearpoly.recording.survey import survey
from gearpoly.recording.words import RADIAL, TE, quantity_of, run_of
from tests.made_texts import DEGREE, chart, run, same, table, written

RUN = run(1200)
TIME_S, DRIVING, DRIVEN, TORQUE = RUN.values()
LINE = re.compile(
    r"(?:columns|keys|text)\.\w+ = (?:\{[^}]*\}|\"[^\"]*\"|[\d.]+)|leave_out = \[(?:\"[^\"]*\"(?:, )?)+\]"
)
ANGLES = ("Input angle [deg]", "Output angle [deg]")


def made(tmp_path: Path, names: tuple[str, ...], *columns: np.ndarray, digits: int | tuple[int, ...] = 5) -> Path:
    return written(tmp_path, table(columns, names, separator=",", decimal=".", digits=digits))


def cure(file: Path, tmp_path: Path, *filled: tuple[str, str]) -> list[str]:
    """The lines that a refusal names, which have to be taken as they stand, or with what is ``filled`` in: without it
    they are refused."""
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    lines = LINE.findall(caught.value.wish)
    text = "\n".join(lines)
    for blank, number in filled:
        assert blank in text
        with pytest.raises(InputFileError):
            chart(tmp_path, text)
        text = text.replace(blank, number)
    read_recording(file, chart=chart(tmp_path, text))
    return lines


@pytest.mark.parametrize(
    ("name", "scale"),
    [("millis", 1e3), ("micros", 1e6), ("t_ms", 1e3), ("ms", 1e3), ("us", 1e6), ("millis()", 1e3),
     ("micros_start", 1e6), ("time_us", 1e6), ("sec", 1.0)],
)  # fmt: skip
def test_a_counter_of_a_controller_is_the_time(tmp_path: Path, name: str, scale: float) -> None:
    """Its steps vary by a few of the last place, as those of a loop do."""
    jitter = np.random.default_rng(5).integers(0, 3, TIME_S.size) if scale > 1.0 else 0.0
    time = np.rint(TIME_S * scale + jitter) if scale > 1.0 else TIME_S
    file = made(tmp_path, (name, *ANGLES), time, DRIVING, DRIVEN, digits=(0 if scale > 1.0 else 3, 5, 5))
    found = read_recording(file)
    same(found.time_s, TIME_S, half=3.0 / scale + 1e-9)


@pytest.mark.parametrize("name", ["millis", "micros", "x0"])
def test_a_time_is_never_offered_as_an_angle(tmp_path: Path, name: str) -> None:
    scale = 1e6 if name == "micros" else 1e3
    file = made(tmp_path, (name, "enc1", "enc2"), np.rint(TIME_S * scale), DRIVING, DRIVEN, digits=(0, 5, 5))
    lines = cure(file, tmp_path)
    assert not any(name in line for line in lines if "angle" in line)
    read = read_recording(file, chart=chart(tmp_path, "\n".join(lines)))
    same(read.time_s, TIME_S, half=1e-9)
    same(read.driven_angle_rad, DRIVEN * DEGREE, half=0.5e-5 * DEGREE)


@pytest.mark.parametrize(("scale", "unit"), [(1.0, "s"), (1e3, "ms"), (1e6, "us")])
def test_a_time_without_a_unit_is_asked_for_with_what_it_would_last(tmp_path: Path, scale: float, unit: str) -> None:
    digits = (3 if scale == 1.0 else 0, 5, 5)
    file = made(tmp_path, ("time", *ANGLES), TIME_S * scale, DRIVING, DRIVEN, digits=digits)
    assert cure(file, tmp_path) == [f'columns.time_s = {{ from = "time", unit = "{unit}" }}']
    if scale > 1.0:
        assert "11.99 s in " + unit in survey(file)[0].doubts[0].says


def test_offers_follow_the_shafts_that_names_say_whatever_their_order(tmp_path: Path) -> None:
    lines = cure(made(tmp_path, ("t [s]", "driven", "driving"), TIME_S, DRIVEN, DRIVING), tmp_path)
    assert lines == [
        f'columns.{shaft}_angle_deg = {{ from = "{shaft}", unit = "deg" }}' for shaft in ("driving", "driven")
    ]


def test_offers_have_the_unit_in_which_readings_begin_again(tmp_path: Path) -> None:
    """Offered as degrees, the map was refused that the refusal had named."""
    lines = cure(made(tmp_path, ("t [s]", "a", "b"), TIME_S, DRIVING * DEGREE, DRIVEN * DEGREE, digits=7), tmp_path)
    assert all('unit = "rad"' in line for line in lines)


def test_what_goes_on_is_offered_before_what_swings(tmp_path: Path) -> None:
    """The joints of a robot: one only swings, however slowly, and is no shaft of a pair that turns on."""
    swinging = 0.3 + 0.1 * np.sin(TIME_S)
    names = ("t [s]", "shoulder/position", "motor/position", "joint/position")
    lines = cure(made(tmp_path, names, TIME_S, swinging, DRIVING, DRIVEN), tmp_path)
    assert [line.partition('from = "')[2].partition('"')[0] for line in lines] == ["motor/position", "joint/position"]


def test_what_has_another_unit_is_offered_for_no_angle(tmp_path: Path) -> None:
    names = ("t [s]", "Input angle [deg]", "Oil temperature [°C]", "gap [mm]")
    with pytest.raises(InputFileError) as caught:
        read_recording(made(tmp_path, names, TIME_S, DRIVING, TORQUE, TORQUE))
    assert "angle_deg = {" not in caught.value.wish


@pytest.mark.parametrize(
    ("name", "number"),
    [("Lauf 1", "1"), ("run 2 in", "2"), ("Messung_3", "3"), ("trial12 [deg]", "12"), ("Versuch Nr. 4", "4"),
     ("angle 1", ""), ("Winkel 2", ""), ("enc1", ""), ("Serie 1", ""), ("running 1", "")],
)  # fmt: skip
def test_the_run_that_a_name_says(name: str, number: str) -> None:
    assert run_of(name) == number


@pytest.mark.parametrize(
    "names", [("Lauf 1", "Lauf 2"), ("trial 1 [deg]", "trial 2 [deg]"), ("Messung 1", "Messung 3")]
)
def test_two_runs_are_not_offered_as_two_shafts(tmp_path: Path, names: tuple[str, str]) -> None:
    file = made(tmp_path, ("Zeit [s]", *names), TIME_S, DRIVING, DRIVING)
    with pytest.raises(InputFileError, match="runs side by side") as caught:
        read_recording(file)
    assert not LINE.findall(caught.value.wish)
    assert all("no shaft" in one.says for one in survey(file)[0].doubts)


def test_of_runs_side_by_side_one_is_offered_whole(tmp_path: Path) -> None:
    names = ("time [s]", "run 1 out", "run 1 in", "run 2 in", "run 2 out")
    file = made(tmp_path, names, TIME_S, DRIVEN, DRIVING, DRIVING, DRIVEN)
    assert cure(file, tmp_path) == [
        'columns.driving_angle_deg = { from = "run 1 in", unit = "deg" }',
        'columns.driven_angle_deg = { from = "run 1 out", unit = "deg" }',
    ]


@pytest.mark.long
@pytest.mark.parametrize("unit", ["[%]", "[% Mn]", "/ %", "_pct", "[V]", "[digits]"])
@pytest.mark.parametrize("name", ["Output torque", "Drehmoment"])
def test_a_torque_of_no_known_scale_is_left_out_or_scaled(tmp_path: Path, name: str, unit: str) -> None:
    """One per cent was offered as 1 N.m."""
    file = made(tmp_path, ("t [s]", *ANGLES, f"{name} {unit}" if unit[0] in "[/" else name + unit),
                TIME_S, DRIVING, DRIVEN, 2.0 * TORQUE)  # fmt: skip
    (left,) = cure(file, tmp_path)
    assert left.startswith("leave_out")
    (doubt,) = survey(file)[0].doubts
    (scaled,) = LINE.findall(doubt.says)
    read = read_recording(file, chart=chart(tmp_path, scaled))
    same(read.torque_samples_nm, TORQUE, half=0.5e-5)
    settled = map_text(survey(file)[0]).replace("# leave_out", "leave_out")
    assert read_recording(file, chart=chart(tmp_path, settled)).torque_samples_nm is None


def test_several_columns_are_left_out_by_one_line(tmp_path: Path) -> None:
    names = ("t [s]", *ANGLES, "Input torque [%]", "Output torque [%]")
    file = made(tmp_path, names, TIME_S, DRIVING, DRIVEN, 0.72 * TORQUE, TORQUE)
    assert cure(file, tmp_path) == ['leave_out = ["Input torque [%]", "Output torque [%]"]']
    settled = map_text(survey(file)[0]).replace("# leave_out", "leave_out")
    assert read_recording(file, chart=chart(tmp_path, settled)).torque_samples_nm is None
    assert each_once(['leave_out = ["a"]', "x = 1", 'leave_out = ["b"]', "x = 2"]) == [
        'leave_out = ["a", "b"]',
        "x = 1",
    ]


@pytest.mark.parametrize("per", [4096, 2000, 10_000])
@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_counts_that_are_called_an_angle(tmp_path: Path, per: int, unit: str) -> None:
    counts = [np.floor(one / 360.0 * per) for one in (DRIVING, DRIVEN)]
    names = ("t [s]", f"Input angle [{unit}]", f"Output angle [{unit}]")
    file = made(tmp_path, names, TIME_S, *counts, digits=(3, 0, 0))
    lines = cure(file, tmp_path)
    assert all(f"wraps = {per} " in line for line in lines)
    read = read_recording(file, chart=chart(tmp_path, "\n".join(lines)))
    assert read.driven_angle_rad is not None
    apart = np.angle(np.exp(1j * (read.driven_angle_rad - DRIVEN * DEGREE)))
    assert np.max(np.abs(apart)) <= 2.001 * np.pi / per


OWN = ("driving_angle_deg", "driven_angle_deg")


@pytest.mark.long
@pytest.mark.parametrize("names", [("c_in", "c_out"), ("Encoder in [counts]", "Encoder out [counts]"), ANGLES, OWN])
@pytest.mark.parametrize(("width", "low"), [(2**16, 0), (2**16, -(2**15)), (2**8, 0), (2**24, 0)])
def test_the_width_of_a_counter_is_no_turn(tmp_path: Path, names: tuple[str, str], width: int, low: int) -> None:
    """36 000 counts a turn were offered as 65 536, since a counter of 16 bits begins again there, and so at other
    widths. The lines of the encoder are asked for; with them the turns come out to a count."""
    time = np.arange(6000) / 100.0
    per = 36_000 * width // 2**16 // 4 * 4
    turned = (0.5 * time, 0.36 * time)
    held = [np.mod(np.floor(one * per) - low, width) + low for one in turned]
    file = made(tmp_path, ("t [s]", *names), time, *held, digits=(3, 0, 0))
    lines = cure(file, tmp_path, ('"those on its label"', str(per // 4)))
    assert "scale" not in "".join(lines)
    text = "\n".join(lines).replace('"those on its label"', str(per // 4))
    read = read_recording(file, chart=chart(tmp_path, text))
    for angle, turns in zip((read.driving_angle_rad, read.driven_angle_rad), turned, strict=True):
        assert angle is not None
        assert np.max(np.abs(angle / (2.0 * np.pi) - turns)) <= 1.01 / per


def test_degrees_in_whole_numbers_are_no_counts() -> None:
    assert counter_modulus(np.floor(DRIVING)) is None
    assert counter_modulus(np.floor(DRIVING * 10.0)) is None


@pytest.mark.parametrize(
    ("name", "quantity"),
    [("Fi'' [um]", RADIAL), ("F_i'' [um]", RADIAL), ('fi" ', RADIAL), ("fi″", RADIAL),
     ("Zweiflankenwälzabweichung", RADIAL),
     ("centre distance", RADIAL), ("Achsabstand", RADIAL), ("radial composite deviation", RADIAL), ("Entraxe", RADIAL),
     ("double-flank", RADIAL), ("Fi' [um]", TE), ("F_i\u2032", TE), ("Einflankenwälzabweichung", TE),
     ("tangential composite deviation", TE), ("single flank error", TE), ("fi1", ""), ("phi'", "")],
)  # fmt: skip
def test_radial_and_tangential_composite_deviations_are_told_apart(name: str, quantity: str) -> None:
    assert quantity_of(name) in ((quantity,) if quantity else ("", "angle"))


@pytest.mark.parametrize(
    "name", ["Fi'' [um]", "centre distance [mm]", "Zweiflankenwälzabweichung [um]", "a double flank [um]"]
)
@pytest.mark.parametrize("angle", ["driving_angle_deg", "Winkel [deg]", "Input angle [deg]"])
def test_a_double_flank_test_is_no_transmission_error(tmp_path: Path, name: str, angle: str) -> None:
    with pytest.raises(InputFileError, match="radial composite deviation, no transmission error"):
        read_recording(made(tmp_path, (angle, name), DRIVING, TORQUE))


def test_a_radial_deviation_beside_both_angles_is_left_out(tmp_path: Path) -> None:
    file = made(tmp_path, ("t [s]", *ANGLES, "Achsabstand [mm]"), TIME_S, DRIVING, DRIVEN, TORQUE)
    assert read_recording(file).te_mm is None


def test_a_tangential_composite_deviation_is_a_transmission_error(tmp_path: Path) -> None:
    te = 20.0 * np.sin(DRIVING * DEGREE)
    lines = cure(made(tmp_path, ("Input angle [deg]", "Fi' [um]"), DRIVING, te), tmp_path)
    assert lines == ['columns.te_um = { from = "Fi\' [um]", unit = "um", sign = 1 }']


@pytest.mark.parametrize("own", [True, False])
def test_a_comment_that_says_a_double_flank_test_is_told(tmp_path: Path, own: bool) -> None:
    names = ("driving_angle_deg", "te_um") if own else ("Input angle [deg]", "Output angle [deg]")
    text = table([DRIVING, TORQUE if own else DRIVEN], names, separator=",", decimal=".")
    file = written(tmp_path, f"# Zweiflankenwälzprüfung, Nr. 4\n{text}")
    assert any("radial composite" in one for one in read_recording(file).remarks)
    other = written(tmp_path, f"# Einflankenwälzprüfung, Nr. 4\n{text}", name="other.csv")
    assert not any("radial" in one for one in read_recording(other).remarks)


def test_counts_of_a_controller_are_offered_as_counts(tmp_path: Path) -> None:
    turned = np.arange(1200) * 1.8
    counts = [np.floor(one / 360.0 * 2400.0) for one in (turned, 0.72 * turned)]
    file = made(tmp_path, ("ms", "E1", "E2"), TIME_S * 1e3, *counts, digits=0)
    lines = cure(file, tmp_path, ('"those on its label"', "600"))
    assert lines[:2] == ['columns.driving_count = { from = "E1" }', 'keys.driving_lines = "those on its label"']


def test_levels_of_an_oscilloscope_are_offered_as_pulses(tmp_path: Path) -> None:
    t = np.arange(6000) / 2000.0
    levels = [2.5 + 2.4 * np.sign(np.sin(2.0 * np.pi * hz * t + 0.3)) for hz in (100.0, 72.0)]
    file = made(tmp_path, ("Time [s]", "CH1 [V]", "CH2 [V]"), t, *levels)
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    lines = LINE.findall(caught.value.wish)
    assert lines[0] == 'columns.driving_a = { from = "CH1 [V]" }'
    read = read_recording(file, chart=chart(tmp_path, "\n".join(lines).replace('"those on its label"', "60")))
    assert read.driving_angle_rad is not None
    assert abs(np.ptp(read.driving_angle_rad) / (2.0 * np.pi) - 5.0) < 0.1


@pytest.mark.parametrize("names", [("sin1 [V]", "cos1 [V]", "sin2 [V]", "cos2 [V]"), ("qw", "qx", "qy", "qz")])
def test_what_swings_is_offered_for_no_angle(tmp_path: Path, names: tuple[str, ...]) -> None:
    t = np.arange(3000) / 100.0
    waves = [wave(2.0 * np.pi * hz * t) for hz in (1.0, 0.72) for wave in (np.sin, np.cos)]
    with pytest.raises(InputFileError, match="readings of both shafts") as caught:
        read_recording(made(tmp_path, ("t [s]", *names), t, *waves))
    assert ("atan2" in caught.value.wish) == names[0].startswith("sin")


def test_an_angle_alone_is_not_asked_for_its_shaft(tmp_path: Path) -> None:
    """After that answer it was refused for the other shaft's."""
    with pytest.raises(InputFileError, match="the angle of one shaft alone"):
        read_recording(made(tmp_path, ("t [s]", "angle [deg]"), TIME_S, DRIVING))


def test_of_two_torques_the_second_is_offered_as_the_driven_one(tmp_path: Path) -> None:
    names = ("t [s]", "Angle 1 [deg]", "Angle 2 [deg]", "Torque 1 [Nm]", "Torque 2 [Nm]")
    lines = cure(made(tmp_path, names, TIME_S, DRIVING, DRIVEN, 0.72 * TORQUE, TORQUE), tmp_path)
    assert lines[-1] == 'columns.torque_nm = { from = "Torque 2 [Nm]", unit = "N.m" }'


def test_an_index_in_brackets_is_no_unit(tmp_path: Path) -> None:
    lines = cure(made(tmp_path, ("time[0]", "Y[0]", "Y[1]"), TIME_S, DRIVING, DRIVEN), tmp_path)
    assert 'columns.time_s = { from = "time[0]", unit = "s" }' in lines


def test_stamps_in_whole_seconds_have_the_rate_of_the_samples(tmp_path: Path) -> None:
    columns = np.floor(TIME_S), DRIVING, DRIVEN
    (found,) = survey(made(tmp_path, ("t [s]", *ANGLES), *columns))
    assert found.clock is not None and found.clock.alike == 100
    assert abs(found.clock.rate_hz / 100.0 - 1.0) < 0.1  # as fine as the first and the last second


def test_dates_of_spreadsheets_have_their_rate(tmp_path: Path) -> None:
    file = made(tmp_path, ("Datum", *ANGLES), 46_000.0 + TIME_S / 86_400.0, DRIVING, DRIVEN, digits=(9, 5, 5))
    clock = survey(file)[0].clock
    assert clock is not None and abs(clock.seconds - TIME_S[-1]) < 1e-3


@pytest.mark.parametrize("names", [("Counter {}",), ("Encoder {} [counts]",), ("Zähler {}",)])
def test_a_blank_of_a_line_is_no_number_that_might_be_right(tmp_path: Path, names: tuple[str, ...]) -> None:
    """Counters of 16 bits on encoders of 14 400 counts: any number of lines, the same for both, would fit the pair. The
    line holds words, a map with it is refused, and the 3600 of the label give the turns."""
    turned = (TIME_S * 0.5, TIME_S * 0.36)
    counts = [np.mod(np.floor(one * 14_400.0), 65_536.0) for one in turned]
    columns = [names[0].format(one) for one in ("input", "output")]
    file = made(tmp_path, ("Time [s]", *columns), TIME_S, *counts, digits=(4, 0, 0))
    lines = cure(file, tmp_path, ('"those on its label"', "3600"))
    text = "\n".join(lines)
    with pytest.raises(InputFileError, match="as on its label or data sheet"):
        chart(tmp_path, text)
    read = read_recording(file, chart=chart(tmp_path, text.replace('"those on its label"', "3600")))
    for angle, turn in zip((read.driving_angle_rad, read.driven_angle_rad), turned, strict=True):
        assert angle is not None
        assert np.max(np.abs(angle / (2.0 * np.pi) - turn)) <= 1.01 / 14_400


def test_counts_that_the_index_sets_back_are_turns_of_what_they_begin_again_at(tmp_path: Path) -> None:
    """1000 lines were named for counts that begin again after 14 400, and refused in their turn."""
    turned = (TIME_S * 0.5, TIME_S * 0.36)
    counts = [np.mod(np.floor(one * 14_400.0), 14_400.0) for one in turned]
    names = ("Time [s]", "Encoder input [counts]", "Encoder output [counts]")
    file = made(tmp_path, names, TIME_S, *counts, digits=(4, 0, 0))
    lines = cure(file, tmp_path)
    assert all("wraps = 14400 }" in line for line in lines) and len(lines) == 2
    read = read_recording(file, chart=chart(tmp_path, "\n".join(lines)))
    assert read.driven_angle_rad is not None
    assert np.max(np.abs(read.driven_angle_rad / (2.0 * np.pi) - turned[1])) <= 1.01 / 14_400


def test_a_torque_of_the_driving_shaft_is_scaled_by_the_teeth(tmp_path: Path) -> None:
    """10 N.m on 18 teeth are 13.889 on 25; a line without the scale read them as 10."""
    names = ("Zeit [s]", "Winkel Antrieb [deg]", "Winkel Abtrieb [deg]", "Drehmoment Antrieb [Nm]")
    file = made(tmp_path, names, TIME_S, DRIVING, DRIVEN, np.full(TIME_S.size, 10.0))
    (line,) = cure(file, tmp_path, ('"z_2/z_1"', "1.388889"))
    with pytest.raises(InputFileError, match=r"torque_nm.scale: .*the driven teeth by the driving ones"):
        chart(tmp_path, line)
    read = read_recording(file, chart=chart(tmp_path, line.replace('"z_2/z_1"', "1.388889")))
    assert read.torque_samples_nm is not None
    np.testing.assert_allclose(read.torque_samples_nm, 13.88889, rtol=1e-6)


@pytest.mark.parametrize("unit", ["U", "Umdr.", "tr"])
def test_letters_that_may_be_turns_are_offered_as_turns(tmp_path: Path, unit: str) -> None:
    names = ("Zeit [s]", f"Winkel Antrieb [{unit}]", f"Winkel Abtrieb [{unit}]")
    file = made(tmp_path, names, TIME_S, TIME_S * 0.5, TIME_S * 0.36, digits=7)
    lines = cure(file, tmp_path)
    assert [line.partition("unit = ")[2] for line in lines] == ['"rev" }', '"rev" }']
    read = read_recording(file, chart=chart(tmp_path, "\n".join(lines)))
    assert read.driven_angle_rad is not None
    np.testing.assert_allclose(read.driven_angle_rad, 2.0 * np.pi * 0.36 * TIME_S, atol=1e-6)


@pytest.mark.parametrize("name", ["torque_nm", "Drehmoment Abtrieb [mN.m]"])
def test_a_torque_that_points_back_is_turned_round_by_the_line_that_is_named(tmp_path: Path, name: str) -> None:
    own = name == "torque_nm"
    names = ("time_s", "driving_angle_deg", "driven_angle_deg") if own else ("Zeit [s]", *ANGLES)
    file = made(tmp_path, (*names, name), TIME_S, DRIVING, DRIVEN, -TORQUE)
    (line,) = cure(file, tmp_path)
    assert line == f'columns.torque_nm = {{ from = "{name}", unit = "{"N.m" if own else "mN.m"}", sign = -1 }}'
    read = read_recording(file, chart=chart(tmp_path, line))
    assert read.torque_samples_nm is not None
    np.testing.assert_allclose(read.torque_samples_nm, TORQUE * (1.0 if own else 1e-3), atol=1e-5)
    forward = made(tmp_path, (*names, name), TIME_S, DRIVING, DRIVEN, TORQUE)
    with pytest.raises(InputFileError, match=r"if it counts backwards: columns\.torque_nm = \{[^}]*\}$") as caught:
        read_recording(forward, chart=chart(tmp_path, line))
    assert "sign" not in caught.value.wish
