"""Curves of a telescope's periodic error: EQMOD's own text, and tables of worm angle or time and arcsec."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.keys.sections import WormSection
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.recording.worm import CURVE_TURNS
from gearpoly.units import ARCSEC, DEG, FloatArray
from tests.made_command import Command
from tests.made_texts import chart, table, written

EQ6, HEQ5 = WormSection(wheel_teeth=180), WormSection(wheel_teeth=135)
PERIOD, ROWS, STEPS = 86164.0905 / 180, 479, 50133
TURN = 2.0 * np.pi * np.arange(ROWS) / ROWS
"""The worm's angle in rad at each row: 479 s are a turn of 478.69 s to the second, as EQMOD has it."""
ERROR = 5.0 * np.cos(TURN) + 0.4 * np.cos(47.0 * TURN + 1.0)


def eqmod(*, sense: float = 1.0, period: str = "479", steps: bool = True, begin: float = 1234.0) -> str:
    position = np.mod(begin + sense * STEPS * TURN / (2.0 * np.pi), STEPS) if steps else np.zeros(ROWS)
    rows = "\n".join(f"{k} {p:.0f} {e:.4f}" for k, (p, e) in enumerate(zip(position, ERROR, strict=True)))
    return f"# EQMOD\n!WormPeriod={period}\n!StepsPerWorm={STEPS}\n# time - motor - smoothed PE\n{rows}\n"


def waves(read: Recording, *orders: int) -> list[float]:
    """Amplitudes in arcsec of the axis at whole orders of the worm's turn, by the angle that was read."""
    assert read.driven_angle_rad is not None and read.te_rad is not None
    angle, error = read.driven_angle_rad, read.te_rad / ARCSEC / EQ6.wheel_teeth
    return [2.0 * abs(np.mean(error * np.exp(-1j * order * angle))) for order in orders]


def phase(read: Recording, order: int) -> complex:
    assert read.driven_angle_rad is not None and read.te_rad is not None
    found = complex(np.mean(read.te_rad * np.exp(-1j * order * read.driven_angle_rad)))
    return found / abs(found)


def test_a_curve_of_eqmod_is_turns_of_the_worm(tmp_path: Path) -> None:
    """Angles are those of the motor's steps, and both waves have their sizes."""
    read = read_recording(written(tmp_path, eqmod(), name="pec.txt"), worm=EQ6)
    assert read.size == CURVE_TURNS * ROWS
    assert read.driven_angle_rad is not None and read.time_s is not None
    np.testing.assert_allclose(np.diff(read.driven_angle_rad), 2.0 * np.pi / ROWS, atol=2.1 * np.pi / STEPS)
    assert read.driven_angle_rad[0] == pytest.approx(1234.0 / STEPS * 2.0 * np.pi, abs=np.pi / STEPS)
    np.testing.assert_allclose(waves(read, 1, 3, 47), [5.0, 0.0, 0.4], atol=2e-3)
    assert phase(read, 1) == pytest.approx(np.exp(-1j * 2.0 * np.pi * 1234.0 / STEPS), abs=1e-3)
    assert any("one turn of the worm" in one for one in read.remarks)
    assert np.ptp(read.time_s) == pytest.approx(CURVE_TURNS * PERIOD * (1.0 - 1.0 / ROWS / CURVE_TURNS), rel=1e-3)


def test_decimal_commas_and_another_encoding(tmp_path: Path) -> None:
    plain = read_recording(written(tmp_path, eqmod(), name="pec.txt"), worm=EQ6)
    commas = eqmod().replace(".", ",").replace(" ", "\t").replace("# EQMOD", "# Schneckenfehler für EQMOD")
    read = read_recording(written(tmp_path, commas, name="pec2.txt", encoding="cp1252"), worm=EQ6)
    np.testing.assert_array_equal(read.te_rad, plain.te_rad)


def test_south_of_the_equator_the_sign_is_the_other(tmp_path: Path) -> None:
    """There the motor's steps fall; the axis then is ahead where the error falls."""
    read = read_recording(written(tmp_path, eqmod(sense=-1.0), name="pec.txt"), worm=EQ6)
    assert read.te_rad is not None
    np.testing.assert_allclose(read.te_rad[:ROWS] / ARCSEC / EQ6.wheel_teeth, -ERROR, atol=1e-4)
    assert read.driven_angle_rad is not None and np.all(np.diff(read.driven_angle_rad) > 0.0)
    assert any("south" in one for one in read.remarks)


def test_steps_that_stand_leave_the_time(tmp_path: Path) -> None:
    read = read_recording(written(tmp_path, eqmod(steps=False), name="pec.txt"), worm=EQ6)
    np.testing.assert_allclose(waves(read, 1, 47), [5.0, 0.4], atol=2e-3)
    assert any("steps do not follow" in one for one in read.remarks)


@pytest.mark.parametrize(
    ("change", "where", "found"),
    [
        (("!WormPeriod=479", "!WormPeriod=0"), "!WormPeriod", "0"),
        (("!WormPeriod=479", "!WormPeriod=soon"), "line 2", '"soon"'),
        (("7 1967", "7 x"), "line 12", '"x"'),
        (("7 1967", "5 1967"), "row 8", "time that falls"),
    ],
)
def test_what_is_no_curve_is_one_message(tmp_path: Path, change: tuple[str, str], where: str, found: str) -> None:
    text = eqmod()
    assert change[0] in text
    with pytest.raises(InputFileError) as caught:
        read_recording(written(tmp_path, text.replace(*change), name="pec.txt"), worm=EQ6)
    assert (caught.value.where, caught.value.found) == (where, found)


def test_another_mount_s_pair_is_refused_and_its_own_period_is_the_cure(tmp_path: Path) -> None:
    file = written(tmp_path, eqmod(), name="pec.txt")
    with pytest.raises(InputFileError, match=r"turns once in 479 s, and the pair file's in 638\.253 s"):
        read_recording(file, worm=HEQ5)
    assert read_recording(file, worm=WormSection(wheel_teeth=135, period_s=479.0)).size == CURVE_TURNS * ROWS


def curve(angle: FloatArray, error: FloatArray, name: str = "Worm phase [deg]") -> str:
    return table([angle, error], (name, "PE [arcsec]"), separator=",", decimal=".", digits=4)


MAP = 'columns.axis_error_arcsec = { from = "PE [arcsec]", unit = "arcsec", sign = 1 }'


@pytest.mark.parametrize("closed", [False, True])
def test_a_table_over_the_worm_s_angle_asks_for_the_sign(tmp_path: Path, closed: bool) -> None:
    """The first row once more at the end is one row too many."""
    angle = np.append(TURN / DEG, 360.0) if closed else TURN / DEG
    error = np.append(ERROR, ERROR[0]) if closed else ERROR
    file = written(tmp_path, curve(angle, error))
    with pytest.raises(InputFileError, match="whose sign no name tells") as caught:
        read_recording(file, worm=EQ6)
    assert MAP in caught.value.wish
    read = read_recording(file, worm=EQ6, chart=chart(tmp_path, MAP))
    assert read.size == CURVE_TURNS * ROWS
    np.testing.assert_allclose(waves(read, 1, 3, 47), [5.0, 0.0, 0.4], atol=1e-4)
    turned = read_recording(file, worm=EQ6, chart=chart(tmp_path, MAP.replace("sign = 1", "sign = -1")))
    assert turned.te_rad is not None and read.te_rad is not None
    np.testing.assert_array_equal(turned.te_rad, -read.te_rad)


@pytest.mark.parametrize(("name", "per"), [("worm angle [rev]", 1.0 / 360.0), ("Schneckenwinkel [°]", 1.0)])
def test_units_and_languages_of_the_worm_s_angle(tmp_path: Path, name: str, per: float) -> None:
    text = table([TURN / DEG * per, ERROR], (name, "PE [arcsec]"), separator=";", decimal=",", digits=(7, 4))
    read = read_recording(written(tmp_path, text), worm=EQ6, chart=chart(tmp_path, MAP))
    np.testing.assert_allclose(waves(read, 1, 47), [5.0, 0.4], atol=1e-4)


def test_a_curve_that_does_not_close_has_a_drift(tmp_path: Path) -> None:
    file = written(tmp_path, curve(TURN / DEG, ERROR + 6.0 * TURN / (2.0 * np.pi)))
    read = read_recording(file, worm=EQ6, chart=chart(tmp_path, MAP))
    # The drift is what the ends' own slopes leave: known to a tenth of a step of the curve, 0.012 arcsec.
    np.testing.assert_allclose(waves(read, 1, 3, 47), [5.0, 0.0, 0.4], atol=4e-3)
    assert any("a drift of 6" in one for one in read.remarks)


def test_part_of_a_turn_stays_as_it_is(tmp_path: Path) -> None:
    half = slice(0, ROWS // 2)
    read = read_recording(written(tmp_path, curve(TURN[half] / DEG, ERROR[half])), worm=EQ6, chart=chart(tmp_path, MAP))
    assert read.size == ROWS // 2


def test_an_error_over_time_is_as_long_as_it_was_watched(tmp_path: Path) -> None:
    """Minutes of a star's error without guiding: the worm's angle is time over its period."""
    time = 5.0 * np.arange(600)
    error = 5.0 * np.cos(2.0 * np.pi * time / PERIOD)
    text = table([time, error], ("Time (s)", "RA error (arcsec)"))
    line = 'columns.axis_error_arcsec = { from = "RA error (arcsec)", unit = "arcsec", sign = 1 }'
    read = read_recording(written(tmp_path, text), worm=EQ6, chart=chart(tmp_path, line))
    assert read.size == 600 and read.driven_angle_rad is not None and read.te_rad is not None
    np.testing.assert_allclose(read.driven_angle_rad, 2.0 * np.pi * time / PERIOD, rtol=1e-12)
    np.testing.assert_allclose(read.te_rad, error * ARCSEC * 180, atol=1e-5 * ARCSEC * 180)


def test_numbers_without_names_are_told_what_to_write_above_them(tmp_path: Path) -> None:
    rows = "\n".join(f"{k} {e:.4f}" for k, e in enumerate(ERROR))
    with pytest.raises(InputFileError, match=r"Time \[s\] and PE \[arcsec\]"):
        read_recording(written(tmp_path, rows, name="curve.txt"), worm=EQ6)
    named = written(tmp_path, "Time [s]\tPE [arcsec]\n" + rows.replace(" ", "\t"), name="curve2.txt")
    assert read_recording(named, worm=EQ6, chart=chart(tmp_path, MAP)).size == ROWS


def test_a_worm_in_another_machine_is_no_telescope(tmp_path: Path) -> None:
    """Both angles are there; the worm's angle and a servo's error are others."""
    t = 0.01 * np.arange(1500)
    columns = [t, 180.0 * t, 129.6 * t, 3.6 * t, np.sin(t)]
    names = ("Time [s]", "angle in [deg]", "angle out [deg]", "worm angle [deg]", "tracking error [deg]")
    read = read_recording(written(tmp_path, table(columns, names, separator=";", decimal=".")))
    assert read.size == 1500 and read.te_rad is None
    np.testing.assert_allclose(read.driven_angle_rad, 129.6 * t * DEG, atol=1e-5 * DEG)


@pytest.mark.slow
def test_compare_finds_the_waves_of_a_curve(tmp_path: Path, gearpoly_command: Command) -> None:
    """From one turn alone a drift looks like half a wave, and order 3 was located at half the size of order 1."""
    pair = tmp_path / "eq6.toml"
    assert gearpoly_command("pair", "--mount", "EQ6", str(pair)).code == 0
    done = gearpoly_command("compare", str(pair), str(written(tmp_path, eqmod(), name="pec.txt")))
    assert done.code == 0
    said = " ".join(done.out.split())
    assert re.search(
        r"Order 1 of the driven shaft, [^:]*: every 479 s, as often as the worm's turn, 5 arcsec on the sky", said
    ), said
    assert re.search(r"Mesh order 1, [^:]*: every 10\.2 s, 0\.4 arcsec on the sky", said), said
    assert "Order 3 of the driven shaft" not in said
