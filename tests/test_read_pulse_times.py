"""Files of pulse times: a column for each encoder, a row for each pulse with its channel, or the time between."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.clean import clean
from gearpoly.recording.map_text import map_text
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.recording.survey import survey
from tests.made_texts import RATIO, chart, written

LINES = 250
AMPLITUDE = 2e-3
LINE = re.compile(r'(?:columns|keys)\.\w+ = (?:\{[^}]*\}|"[^"]*"|[\d.]+)')


def shafts(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both angles in turns at 60 rpm whose speed swings; the driven one is off by a wave once per driving turn."""
    driving = t + 0.01 * np.sin(t)
    te = AMPLITUDE * np.sin(2.0 * np.pi * driving)
    return driving, RATIO * driving + te / (2.0 * np.pi)


def pulse_times() -> tuple[np.ndarray, np.ndarray]:
    """The times at which either encoder passes a line, from a table far finer than both."""
    t = np.arange(0.0, 20.0, 1e-4)
    out = []
    for turned in shafts(t):
        lines = np.arange(1, int(turned[-1] * LINES))
        out.append(np.interp(lines / LINES, turned, t))
    return out[0], out[1]


FIRST, SECOND = pulse_times()


def in_columns(unit: float = 1.0, names: str = "t_A [s],t_B [s]") -> str:
    rows = [f"{a * unit:.9f}," + (f"{SECOND[k] * unit:.9f}" if k < SECOND.size else "") for k, a in enumerate(FIRST)]
    return "\n".join([names, *rows, ""])


def in_rows(names: tuple[str, str], head: str = "time [s],channel", separator: str = ",") -> str:
    events = sorted([(t, names[0]) for t in FIRST] + [(t, names[1]) for t in SECOND])
    return "\n".join([head, *(f"{t:.9f}{separator}{name}" for t, name in events), ""])


def between(names: str = "period driving [us],period driven [us]") -> str:
    first, second = np.diff(FIRST) * 1e6, np.diff(SECOND) * 1e6
    rows = [f"{a:.5f}," + (f"{second[k]:.5f}" if k < second.size else "") for k, a in enumerate(first)]
    return "\n".join([names, *rows, ""])


def cured(file: Path, tmp_path: Path, *, lines: int = LINES) -> Recording:
    """The file by the lines that its refusal names, with the pulses of a turn filled in."""
    with pytest.raises(InputFileError, match="and no angles") as caught:
        read_recording(file)
    told = "\n".join(LINE.findall(caught.value.wish)).replace('lines = "those on its label"', f"lines = {lines}")
    return read_recording(file, chart=chart(tmp_path, told))


def holds(read: Recording, *, half: float) -> None:
    """The transmission error is the wave that was put in: its size and its place on the driving shaft's true turn."""
    made = clean(read, ratio=RATIO)
    assert read.time_s is not None and made.time_s is not None
    true = shafts(made.time_s + (FIRST[0] - read.time_s[0] if read.time_s[0] == 0.0 else 0.0))[0]
    columns = np.column_stack([np.ones(true.size), np.sin(2.0 * np.pi * true), np.cos(2.0 * np.pi * true)])
    # Counted in lines, as they were made; the first and the last are a line off at most.
    assert abs(np.ptp(made.theta_1) / (2.0 * np.pi) - np.ptp(true)) < 2.0 / LINES
    level, sine, cosine = np.linalg.lstsq(columns, made.te, rcond=None)[0]
    rest = made.te - columns @ [level, sine, cosine]
    assert abs(np.hypot(sine, cosine) - AMPLITUDE) < half
    assert np.std(rest) < half
    assert abs(np.arctan2(cosine, sine)) < 0.05


@pytest.mark.long
@pytest.mark.parametrize(
    "names", ["t_A [s],t_B [s]", "pulse time driving [s],pulse time driven [s]", "Zeit 1 [s],Zeit 2 [s]"]
)
def test_a_column_of_times_for_each_encoder(tmp_path: Path, names: str) -> None:
    read = cured(written(tmp_path, in_columns(names=names)), tmp_path)
    # Pulses of the finer shaft are joined by straight lines: half a line of a wave is bent by 1e-5 of it.
    holds(read, half=0.01 * AMPLITUDE)
    assert any("driving and" in one and "pulses taken as angles" in one for one in read.remarks)


def test_columns_named_by_their_shafts_in_another_order(tmp_path: Path) -> None:
    rows = [",".join(reversed(line.split(","))) for line in in_columns().splitlines()[1:]]
    text = "\n".join(["driven pulse time [us],driving pulse time [us]", *rows, ""])
    with pytest.raises(InputFileError) as caught:
        read_recording(written(tmp_path, text))
    assert 'driving_pulse_s = { from = "driving pulse time [us]"' in caught.value.wish


@pytest.mark.parametrize("names", [("1", "2"), ("0", "1"), ("A", "B"), ("drive", "gear"), ("CH1", "CH2")])
@pytest.mark.parametrize(("head", "separator"), [("time [s],channel", ","), ("time_s;Kanal", ";")])
def test_a_row_for_each_pulse(tmp_path: Path, names: tuple[str, str], head: str, separator: str) -> None:
    read = cured(written(tmp_path, in_rows(names, head, separator)), tmp_path)
    holds(read, half=0.01 * AMPLITUDE)


@pytest.mark.parametrize(
    "names", ["period driving [us],period driven [us]", "dt1,dt2", "interval A [us],interval B [us]"]
)
def test_the_time_between_pulses(tmp_path: Path, names: str) -> None:
    """Both begin within a pulse of one another; nobody knows where, so the wave is turned by a line at most."""
    read = cured(written(tmp_path, between(names)), tmp_path)
    holds(read, half=0.03 * AMPLITUDE)


def test_the_map_that_read_writes_settles_it(tmp_path: Path) -> None:
    file = written(tmp_path, in_columns())
    (found,) = survey(file)
    assert len(found.doubts) == 1
    settled = re.sub(r"(?m)^# (?=columns|keys)", "", map_text(found)).replace(
        'lines = "those on its label"', f"lines = {LINES}"
    )
    (again,) = survey(file, chart(tmp_path, settled))
    assert not again.doubts and not again.refusal


@pytest.mark.long
def test_lost_pulses_are_counted_on(tmp_path: Path) -> None:
    lost = in_columns().splitlines()
    whole = [line.split(",") for line in lost[1:]]
    first = [a for k, (a, _) in enumerate(whole) if k not in (500, 501, 1700)]
    rows = [f"{a},{b}" for a, (_, b) in zip(first, whole, strict=False)]
    read = cured(written(tmp_path, "\n".join([lost[0], *rows, ""])), tmp_path)
    assert any(one.startswith("3 pulses of the driving shaft lost") for one in read.remarks)
    holds(read, half=0.01 * AMPLITUDE)


def test_levels_that_are_sampled_are_no_rows_of_pulses(tmp_path: Path) -> None:
    level = (np.arange(4000) // 7) % 2
    text = "\n".join(["time [s],ch", *(f"{k / 1000:.3f},{one}" for k, one in enumerate(level)), ""])
    with pytest.raises(InputFileError) as caught:
        read_recording(written(tmp_path, text))
    assert "pulse" not in str(caught.value)
