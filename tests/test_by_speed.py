"""A stated speed that the unit of a time, an angle or itself contradicts."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from tests.made_texts import DEGREE, RATIO, chart, table, written

TIME = np.arange(3000) / 125.0
DRIVING = 180.0 * TIME + 2.0 * np.sin(2.0 * TIME)
"""deg, at 30 rpm."""
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}
ANGLES = {"deg": 1.0, "rad": 1.0 / DEGREE, "rev": 360.0}
SPEEDS = {"rpm": 1.0, "rev/s": 60.0, "rad/s": 30.0 / np.pi}


def log(
    folder: Path, *, time: tuple[str, str] = ("s", "s"), angle: tuple[str, str] = ("deg", "deg"),
    speed: tuple[str, str] = ("rpm", "rpm"), wrapped: bool = True, factor: float = 1.0,
) -> Path:  # fmt: skip
    """A run whose units are each (stated, true)."""
    turned = [DRIVING, RATIO * DRIVING + 1e-3 * np.sin(DRIVING * DEGREE)]
    angles = [(np.mod(one, 360.0) if wrapped else one) / ANGLES[angle[1]] for one in turned]
    columns = [TIME / TIMES[time[1]], *angles, np.full(TIME.size, factor * 30.0 / SPEEDS[speed[1]])]
    names = (f"t [{time[0]}]", f"Input angle [{angle[0]}]", f"Output angle [{angle[0]}]", f"Input speed [{speed[0]}]")
    return written(folder, table(columns, names, separator=";", decimal=".", digits=9))


@pytest.mark.parametrize("wrapped", [True, False])
@pytest.mark.parametrize(("stated", "true"), [("ms", "s"), ("s", "ms"), ("us", "s"), ("us", "ms")])
def test_a_time_in_another_unit_is_told_by_the_speed(tmp_path: Path, stated: str, true: str, wrapped: bool) -> None:
    """Of seconds under the name of milliseconds nothing was said. The line that is named gives the seconds; one with
    the unit that the file states is believed."""
    file = log(tmp_path, time=(stated, true), wrapped=wrapped)
    with pytest.raises(InputFileError, match=f"30 rpm is stated.*as if {stated} were {true}") as caught:
        read_recording(file)
    (line,) = re.findall(r"columns\.\S+ = \{[^}]*\}", caught.value.wish)
    read = read_recording(file, chart=chart(tmp_path, line))
    assert read.time_s is not None
    np.testing.assert_allclose(read.time_s, TIME, atol=1e-8)
    kept = read_recording(file, chart=chart(tmp_path, line.replace(f'unit = "{true}"', f'unit = "{stated}"')))
    assert kept.time_s is not None
    np.testing.assert_allclose(kept.time_s, TIME * TIMES[stated] / TIMES[true], atol=1e-8)


@pytest.mark.parametrize(("stated", "true"), [("rpm", "rad/s"), ("rad/s", "rpm")])
def test_a_speed_in_another_unit_is_told_by_the_angle(tmp_path: Path, stated: str, true: str) -> None:
    file = log(tmp_path, speed=(stated, true))
    with pytest.raises(InputFileError, match=f"as if {stated} were {true}") as caught:
        read_recording(file)
    (line,) = re.findall(r"columns\.\S+ = \{[^}]*\}", caught.value.wish)
    read = read_recording(file, chart=chart(tmp_path, line))
    assert read.speed_samples_rpm is not None
    np.testing.assert_allclose(read.speed_samples_rpm, 30.0, rtol=1e-6)


def test_a_factor_of_sixty_may_be_two_things(tmp_path: Path) -> None:
    """Minutes, or turns per second: said, and not decided."""
    said = [one for one in read_recording(log(tmp_path, speed=("rpm", "rev/s"))).remarks if "is stated" in one]
    assert len(said) == 1 and "s were min or rpm were rev/s" in said[0]


@pytest.mark.parametrize("factor", [1.0, 0.72, 25.0 / 18.0, 2.0, 4.0, 100.0])
def test_a_speed_that_is_only_wrong_is_no_unit(tmp_path: Path, factor: float) -> None:
    assert not any("is stated" in one for one in read_recording(log(tmp_path, factor=factor)).remarks)


def test_a_speed_in_a_key_counts_too(tmp_path: Path) -> None:
    columns = [TIME * 1e3, DRIVING, RATIO * DRIVING]
    names = ("time_s", "driving_angle_deg", "driven_angle_deg")
    text = "# speed_rpm = 30.0\n" + table(columns, names, separator=",", decimal=".")
    with pytest.raises(InputFileError, match="as if s were ms") as caught:
        read_recording(written(tmp_path, text))
    assert 'columns.time_s = { from = "time_s", unit = "ms" }' in caught.value.wish
