"""Recordings of every format made wrong: a recording, which is then cleaned, or one line."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly.keys.sections import WormSection
from gearpoly.recording.clean import clean
from gearpoly.recording.map_file import read_map
from gearpoly.recording.map_text import map_text
from gearpoly.recording.read import read_recording, read_recordings
from gearpoly.recording.survey import survey
from gearpoly.report.reading_report import json_text
from tests.fuzz.judge import FUZZ, WANTED, judged
from tests.fuzz.recordings import R_B2, RATIO, damaged, foreign_texts, guide_logs, maps, tables, write
from tests.made_readings import EVERY

SHORT = 12
"""Inputs of each format in a short run: there are fourteen."""


@pytest.mark.long
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


@pytest.mark.long
@settings(FUZZ, max_examples=WANTED or 5 * SHORT)
@given(text=foreign_texts(), chart=maps())
def test_text_of_any_country_is_read_or_refused_in_one_line(folder: Path, text: bytes, chart: bytes) -> None:
    """As it is, surveyed, and by a map that may be of another file."""
    file, lines = folder / "Messung.csv", folder / "map.toml"
    file.write_bytes(text)
    lines.write_bytes(chart)
    judged("recordings, text", lambda: read_recordings(file))
    found = judged("surveyed, text", lambda: survey(file))
    for one in found or ():
        lines.write_text(map_text(one), encoding="utf-8")
        again = judged("recordings, written map", lambda: read_map(lines))
        assert again is not None, "a map that was written is a map"
        assert json_text([one])
    lines.write_bytes(chart)
    judged("recordings, map", lambda: read_recordings(file, chart=read_map(lines)))
    judged("surveyed, map", lambda: survey(file, read_map(lines)))
