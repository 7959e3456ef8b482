"""Clocks that were set while they were read: the time jumps, and the shafts turn on."""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.clean import clean
from gearpoly.recording.clock_set import clock_jumps
from gearpoly.recording.map_text import map_text
from gearpoly.recording.read import read_recording
from gearpoly.recording.survey import Survey, survey
from tests.made_texts import RATIO, chart, own, written
from tests.test_read_owners import LINE

ROWS, AT, RATE = 3000, 1500, 50.0
HOUR = 3600.0


def shafts(*, turn: float, wobble: float = 2.0) -> dict[str, np.ndarray]:
    """Both shafts at 30 rpm, whose speed swings as that of any drive."""
    t = np.arange(ROWS) / RATE
    theta = 180.0 * t + wobble * np.sin(t) + 11.0
    te = np.degrees(40e-6 * np.sin(np.radians(theta)))
    return {"time_s": t, "driving_angle_deg": theta % turn, "driven_angle_deg": (RATIO * theta + te) % turn}


def jumped(columns: dict[str, np.ndarray], by: float, *, at: int = AT) -> dict[str, np.ndarray]:
    return {**columns, "time_s": columns["time_s"] + by * (np.arange(ROWS) >= at)}


def stamped(columns: dict[str, np.ndarray]) -> str:
    """The same as a logger in Germany writes it, by its local time without a zone."""
    begin = datetime(2026, 10, 25, 2, 59, 30)
    stamps = [(begin + timedelta(seconds=float(t))).strftime("%d.%m.%Y %H:%M:%S.%f")[:-3] for t in columns["time_s"]]
    lines = [f"{s};{a:.5f};{b:.5f}" for s, a, b in zip(stamps, *list(columns.values())[1:], strict=True)]
    return "\n".join(["Zeit;Winkel Antrieb [°];Winkel Abtrieb [°]", *lines, ""])


def turns(found: Survey) -> list[float]:
    return [one.turning.turns for one in found.channels if one.turning is not None]


@pytest.mark.parametrize("by", [HOUR, -HOUR, HOUR / 2.0, -HOUR / 2.0, -17.28, -2.0 * HOUR])
@pytest.mark.parametrize("turn", [360.0, 1e9])
@pytest.mark.parametrize("stamps", [False, True])
def test_a_clock_that_was_set_is_put_right(tmp_path: Path, *, by: float, turn: float, stamps: bool) -> None:
    true = shafts(turn=turn)
    held = jumped(true, by)
    file = written(tmp_path, stamped(held) if stamps else own(held))
    (found,) = survey(file)
    assert not found.refusal and not found.doubts
    assert found.clock is not None and not found.clock.gaps and not found.clock.backs
    theta = 180.0 * ROWS / RATE / 360.0
    np.testing.assert_allclose(turns(found), [theta, RATIO * theta], rtol=1e-3)
    assert any("the clock was set" in one and f"before row {AT + 1}," in one for one in found.remarks)
    one = read_recording(file)
    assert one.time_s is not None
    # Of a jump by no whole half hour nobody knows the step: that of the samples beside is taken, and stamps have 1 ms.
    np.testing.assert_allclose(one.time_s, true["time_s"], atol=1.5e-3)
    assert any("the clock was set" in said for said in one.remarks)
    assert not any("gaps" in deed.says for deed in clean(one, ratio=RATIO).done)


def test_summer_time_with_samples_lost_beside_it(tmp_path: Path) -> None:
    """The machine is busy while it sets its clock: 20 samples are lost, and shafts turn on by as many."""
    held = {name: np.delete(one, np.arange(AT, AT + 20)) for name, one in jumped(shafts(turn=1e9), HOUR).items()}
    one = read_recording(written(tmp_path, own(held)))
    assert one.time_s is not None
    np.testing.assert_allclose(one.time_s, np.delete(shafts(turn=1e9)["time_s"], np.arange(AT, AT + 20)), atol=1e-9)


@pytest.mark.parametrize("turn", [360.0, 1e9])
@pytest.mark.parametrize("by", [HOUR, 171.3])
def test_a_real_pause_stays(tmp_path: Path, *, turn: float, by: float) -> None:
    """The shafts turned on meanwhile, and stand elsewhere; 3600 s would be whole turns at just 30 rpm."""
    t = np.arange(ROWS) / RATE + by * (np.arange(ROWS) >= AT)
    theta = 181.7 * t
    held = {"time_s": t, "driving_angle_deg": theta % turn, "driven_angle_deg": RATIO * theta % turn}
    (found,) = survey(written(tmp_path, own(held)))
    assert found.clock is not None and [row for row, _ in found.clock.gaps] == [AT]
    assert not found.doubts and not any("clock" in one for one in found.remarks)


def test_a_pause_in_which_the_shafts_stopped_stays(tmp_path: Path) -> None:
    """They slow down to it: nothing goes on at the jump."""
    t = np.arange(ROWS) / RATE
    speed = 180.0 * np.minimum(1.0, np.abs(np.arange(ROWS) - AT) / 100.0)
    theta = np.cumsum(speed) / RATE
    time = t + HOUR * (np.arange(ROWS) >= AT)
    assert clock_jumps(time, [theta, RATIO * theta]) == []


def test_shafts_without_a_reading_tell_of_no_jump() -> None:
    time = np.arange(ROWS) / RATE
    time[AT:] -= HOUR
    assert clock_jumps(time, [np.full(ROWS, np.nan), 180.0 * np.arange(ROWS)]) == []


def test_recordings_strung_together_stay_refused(tmp_path: Path) -> None:
    held = shafts(turn=360.0)
    both = {name: np.concatenate([one[:AT], one[:AT]]) for name, one in held.items()}
    with pytest.raises(InputFileError, match="before the row above"):
        clean(read_recording(written(tmp_path, own(both))), ratio=RATIO)


@pytest.mark.long
@pytest.mark.parametrize("turn", [360.0, 1e9])
@pytest.mark.parametrize("stamps", [False, True])
def test_a_leap_that_may_be_a_pause_is_a_doubt_whose_cure_works(tmp_path: Path, *, turn: float, stamps: bool) -> None:
    """Counters of a logger that was paused stand still too."""
    true, held = shafts(turn=turn), jumped(shafts(turn=turn), 171.3)
    file = written(tmp_path, stamped(held) if stamps else own(held))
    (found,) = survey(file)
    (doubt,) = found.doubts
    assert "jumps by +171.3 s" in doubt.says
    one = read_recording(file)
    assert one.time_s is not None and np.ptp(one.time_s) < 171.3
    (said,) = [remark for remark in one.remarks if "+171.3 s" in remark]
    first, second = LINE.findall(said)
    cured = read_recording(file, chart=chart(tmp_path, first))
    assert cured.time_s is not None
    np.testing.assert_allclose(cured.time_s, true["time_s"], atol=1.5e-3)
    assert not any("in a map" in remark for remark in cured.remarks if "taken out, as" not in remark)
    kept = read_recording(file, chart=chart(tmp_path, second))
    assert kept.time_s is not None and np.ptp(kept.time_s) > 171.3
    lines = map_text(found).replace(f"# {doubt.ask[0]}", doubt.ask[0]).split("\n")
    settled = [line for line in lines if not line.startswith("columns.time_s") or line == doubt.ask[0]]
    assert len(settled) == len(lines) - 1
    (again,) = survey(file, chart(tmp_path, "\n".join(settled)))
    assert not again.doubts and again.clock is not None and not again.clock.gaps


def test_one_wrapped_shaft_alone_may_go_on_by_chance(tmp_path: Path) -> None:
    """It stands within a few steps of where it was once in a dozen pauses."""
    held = jumped(shafts(turn=360.0), -17.28)
    held["te_um"] = 20.0 * np.sin(np.radians(held.pop("driven_angle_deg")))
    file = written(tmp_path, own(held))
    (found,) = survey(file)
    assert len(found.doubts) == 1
    with pytest.raises(InputFileError, match="before the row above") as caught:
        clean(read_recording(file), ratio=RATIO, r_b2=20.0)
    cured = read_recording(file, chart=chart(tmp_path, "\n".join(LINE.findall(caught.value.wish))))
    assert clean(cured, ratio=RATIO, r_b2=20.0).size > 0.9 * ROWS


def test_a_map_keeps_what_was_taken_out(tmp_path: Path) -> None:
    file = written(tmp_path, own(jumped(shafts(turn=1e9), HOUR)))
    kept = chart(tmp_path, 'columns.time_s = { from = "time_s", jumps = "kept" }')
    one = read_recording(file, chart=kept)
    assert one.time_s is not None and np.ptp(one.time_s) > HOUR


@pytest.mark.parametrize(
    "line", ['time_s = { from = "time_s", jumps = "no" }', 'driving_angle_deg = { from = "a", jumps = "kept" }']
)
def test_what_a_map_may_say_of_jumps(tmp_path: Path, line: str) -> None:
    with pytest.raises(InputFileError, match="jumps"):
        chart(tmp_path, f"columns.{line}")


def test_a_shaft_that_goes_on_at_another_speed_says_nothing() -> None:
    """Two recordings were strung together, and the counters went on."""
    t = np.arange(ROWS) / RATE
    speed = np.where(np.arange(ROWS) < AT, 180.0, 300.0)
    theta = np.cumsum(speed) / RATE
    time = t - t[AT] * (np.arange(ROWS) >= AT)
    assert clock_jumps(time, [theta, RATIO * theta]) == []
    assert clock_jumps(time, [180.0 * t, RATIO * 180.0 * t]) != []


def test_stamps_that_come_late_and_catch_up_are_no_jumps() -> None:
    """A busy computer stamps some samples late; the next ones follow at once."""
    t = np.arange(ROWS) / RATE
    late = t.copy()
    late[AT : AT + 80] = np.maximum(late[AT : AT + 80], t[AT] + 1.5)
    assert clock_jumps(late, [180.0 * t + 2.0 * np.sin(t)]) == []


def test_times_in_whole_seconds(tmp_path: Path) -> None:
    """Fifty samples share each stamp; the hour shows all the same."""
    held = jumped(shafts(turn=360.0), HOUR)
    found = clock_jumps(np.floor(held["time_s"]), [held["driving_angle_deg"], held["driven_angle_deg"]])
    (one,) = found
    assert one.certain and one.row == AT + 1
    assert abs(one.by - HOUR) <= 1.0  # as fine as the stamps
