"""Pulses of a shaft that runs up: the time between them changes smoothly, and none is missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError, told_at_most, told_beside
from gearpoly.gear.rack import Rack
from gearpoly.recording.clean import clean
from gearpoly.recording.read import read_recording
from gearpoly.recording.survey import survey
from gearpoly.recording.unwrapping import gaps
from tests.made_texts import RATIO, own, written

TURNS = 40


def ramp(*, down: bool, turn: float) -> dict[str, np.ndarray]:
    """Even pulses of a shaft that runs up from rest in 10 s, or down to it, with readings that begin again at a
    ``turn``."""
    angle = np.arange(0.0, 360.0 * TURNS, 2.0)
    time = 10.0 * np.sqrt(angle / angle[-1])
    if down:
        time = time[-1] - time[::-1]
    te = np.degrees(40e-6 * np.sin(np.radians(angle)))
    return {"time_s": time, "driving_angle_deg": angle % turn, "driven_angle_deg": (RATIO * angle + te) % turn}


@pytest.mark.parametrize("down", [False, True])
@pytest.mark.parametrize("turn", [360.0, 1e9])
def test_even_pulses_of_a_run_up_are_no_gaps(tmp_path: Path, *, down: bool, turn: float) -> None:
    file = written(tmp_path, own(ramp(down=down, turn=turn)))
    (found,) = survey(file)
    assert found.clock is not None and found.clock.gaps == ()
    for one in found.channels[1:]:
        assert one.turning is not None
        # Turns by their very making; half a step is rounded.
        wanted = (TURNS - 2.0 / 360.0) * (RATIO if one.column.startswith("driven") else 1.0)
        assert abs(one.turning.turns - wanted) < 1e-4
    made = clean(read_recording(file), ratio=RATIO)
    assert made.size > 0.9 * found.rows
    np.testing.assert_allclose(np.ptp(made.te), np.degrees(80e-6) * np.pi / 180.0, rtol=0.2)


def test_a_gap_in_a_run_up_is_one() -> None:
    time = ramp(down=False, turn=360.0)["time_s"]
    lost = np.delete(time, np.arange(1000, 1020))
    steps = np.diff(lost)
    assert np.flatnonzero(gaps(steps, float(np.median(steps)))).tolist() == [999]


def test_single_samples_in_a_hole_stand_between_gaps() -> None:
    """What is left in a hole is a leap from the even steps, not the end of a course."""
    steps = np.array([*[1.0] * 20, 5.0, 5.0, 5.0, *[1.0] * 20])
    assert np.flatnonzero(gaps(steps, 1.0)).tolist() == [20, 21, 22]


@pytest.mark.parametrize("turns", [0.9951, 0.99996, 0.999999])
def test_a_turn_that_is_not_whole_is_not_told_as_one(tmp_path: Path, turns: float) -> None:
    angle = np.linspace(0.0, 360.0 * turns, 4000)
    columns = {"time_s": np.arange(4000) / 1000.0, "driving_angle_deg": angle, "driven_angle_deg": RATIO * angle}
    file = written(tmp_path, own(columns, digits=7))
    with pytest.raises(InputFileError, match=r"want at least 1 driving turn") as caught:
        clean(read_recording(file), ratio=RATIO)
    assert float(caught.value.found.split()[0]) < 1.0


def test_less_than_two_turns_are_not_told_as_two(tmp_path: Path) -> None:
    angle = np.linspace(0.0, 360.0 * 1.9987, 4000)
    columns = {"time_s": np.arange(4000) / 1000.0, "driving_angle_deg": angle, "driven_angle_deg": RATIO * angle}
    made = clean(read_recording(written(tmp_path, own(columns, digits=7))), ratio=RATIO)
    (said,) = [one.says for one in made.done if one.what == "short"]
    assert float(said.split()[0]) < 2.0


@pytest.mark.parametrize(
    ("value", "limit", "decimals", "text"),
    [(0.998, 1.0, 2, "0.998"), (0.5, 1.0, 2, "0.50"), (1.004, 1.0, 2, "1.004"), (20.3, 20.0, 0, "20.3"),
     (1.0, 1.0, 2, "1.00")],
)  # fmt: skip
def test_a_value_is_told_on_its_side_of_a_limit(value: float, limit: float, decimals: int, text: str) -> None:
    assert told_beside(value, limit, decimals) == text


@pytest.mark.parametrize(
    ("limit", "decimals", "text"), [(0.47196, 4, "0.4719"), (0.3, 4, "0.3000"), (2.9996, 3, "2.999")]
)
def test_a_bound_is_told_so_that_it_can_be_kept(limit: float, decimals: int, text: str) -> None:
    assert told_at_most(limit, decimals) == text


@pytest.mark.parametrize("alpha", np.radians(np.linspace(14.0, 30.0, 9)))
def test_a_rack_takes_the_round_that_its_message_names(alpha: float) -> None:
    with pytest.raises(ValueError, match=r"at most 0\.\d{4}") as caught:
        Rack(alpha=float(alpha), rho_fP=0.9)
    Rack(alpha=float(alpha), rho_fP=float(str(caught.value).split("at most ")[1].split()[0]))
