"""Recordings of every format made wrong: a recording, which is then cleaned, or one line."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly.files.models import WormSection
from gearpoly.recording.clean import clean
from gearpoly.recording.read import read_recording
from tests.fuzz.judge import FUZZ, WANTED, judged
from tests.fuzz.recordings import R_B2, RATIO, damaged, guide_logs, tables, write
from tests.made_readings import EVERY

SHORT = 12
"""Inputs of each format in a short run: there are fourteen."""


@pytest.mark.parametrize("name", EVERY)
@settings(FUZZ, max_examples=WANTED or SHORT)
@given(data=st.data())
def test_a_recording_is_read_and_cleaned_or_refused_in_one_line(folder: Path, name: str, data: st.DataObject) -> None:
    columns, keys = data.draw(tables())
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            file = write(data.draw, name, folder, columns, keys)
    except Exception:  # the writer's library cannot hold it, and says so in its own way
        return
    file.write_bytes(data.draw(damaged(file.read_bytes())))
    recording = judged(f"recordings, {name}", lambda: read_recording(file))
    if recording is not None:
        judged(f"cleaned, {name}", lambda: clean(recording, ratio=RATIO, r_b2=R_B2))


@settings(FUZZ, max_examples=WANTED or SHORT)
@given(log=guide_logs())
def test_a_guide_log_is_read_or_refused_in_one_line(folder: Path, log: bytes) -> None:
    file = folder / "guide.log"
    file.write_bytes(log)
    judged("recordings, PHD2", lambda: read_recording(file, worm=WormSection(wheel_teeth=180)))
