"""Maps, and recordings that turn forth and back, with anything in them: they are read, or refused in one message."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly.errors import InputFileError
from gearpoly.recording.clean import clean
from gearpoly.recording.map_file import COLUMN, TEXT, TOP, read_map
from gearpoly.recording.read import read_recordings
from gearpoly.recording.recording import KEYS
from gearpoly.recording.survey import survey
from tests.fuzz.judge import FUZZ, SHORT, WANTED, judged
from tests.made_texts import own, run, table, written

VALUES = (
    "[1]", "[[1]]", "[{a = 1}]", "{a = 1}", "{}", "[]", "1979-05-27", "07:32:00", "true", "nan", "inf", "1e400", "-1",
    "9223372036854775808", '""', '"\\u0000"', '"\\U0001F600"', '"rot13"', '"hex"', '"idna"', '"column 9"',
)  # fmt: skip
PLACES = [
    *(f"{key} = {{}}" for key in TOP),
    *(f"text.{key} = {{}}" for key in TEXT),
    *(f"keys.{key} = {{}}" for key in KEYS),
    *(f'columns.driving_angle_deg = {{{{ from = "Winkel 1", unit = "deg", {key} = {{}} }}}}'
      for key in COLUMN if key not in ("from", "unit")),
    "columns.driving_angle_deg = {{ from = {} }}",
    'columns.driving_angle_deg = {{ from = "Winkel 1", unit = {} }}',
]  # fmt: skip


def _surveyed(file: Path, chart: Path) -> Any:
    return survey(file, read_map(chart))


@pytest.mark.parametrize("place", PLACES)
def test_any_value_at_any_place_of_a_map(tmp_path: Path, place: str) -> None:
    file = written(tmp_path, table(list(run(60).values()), ("t", "Winkel 1", "Winkel 2", "M")), name="log.txt")
    for value in VALUES:
        chart = written(tmp_path, place.format(value) + "\n", name="map.toml")
        judged("maps, value by value", partial(_surveyed, file, chart))


HUGE = (np.nan, 1e308, -1e308, 1e16, 5e-324, 0.0)


@st.composite
def forth_and_back(draw: st.DrawFn) -> dict[str, np.ndarray]:
    """Shafts that turn forth and back, with noise, lost motion, and a few readings or a stretch of them spoiled."""
    rng = np.random.default_rng(draw(st.integers(0, 10_000)))
    time = np.arange(draw(st.sampled_from((20, 200, 900)))) / 100.0
    rate = draw(st.sampled_from((0.1, 0.5, 3.0, 20.0)))
    way = np.sign(np.sin(2.0 * np.pi * rate * time + rng.uniform(0.0, 6.0)) + draw(st.sampled_from((0.0, 0.3))))
    driving = np.cumsum(draw(st.sampled_from((0.5, 1.8, 20.0))) * way)
    driving += draw(st.sampled_from((0.0, 1e-3, 2.0))) * rng.standard_normal(time.size)
    out = {"time_s": time, "driving_angle_deg": driving, "driven_angle_deg": 0.72 * driving + 0.2 * way}
    if draw(st.booleans()):
        out["torque_nm"] = -25.0 * way
    if draw(st.booleans()):
        out["te_um"] = 100.0 * out["driven_angle_deg"]
    for name in draw(st.lists(st.sampled_from(sorted(out)), max_size=3)):
        at = int(rng.integers(time.size))
        stretch = draw(st.booleans())
        out[name] = out[name].copy()
        out[name][at : time.size if stretch else at + 1] = draw(st.sampled_from(HUGE))
    return out


@pytest.mark.long
@settings(FUZZ, max_examples=WANTED or SHORT)
@given(columns=forth_and_back())
def test_forth_and_back_with_anything_in_it(folder: Path, columns: dict[str, np.ndarray]) -> None:
    file = written(folder, own(columns), name="rec.csv")
    judged("forth and back, surveyed", lambda: survey(file))
    for one in judged("forth and back", lambda: read_recordings(file)) or ():
        judged("forth and back, cleaned", partial(clean, one, ratio=0.72, r_b2=23.0))


def test_a_clock_that_was_set_tries_no_endless_list_of_turns(tmp_path: Path) -> None:
    """A gap of 10^16 s holds more turns than a list could."""
    held = run(900)
    held["time_s"][450:] += 1e16
    with pytest.raises(InputFileError):
        [clean(one, ratio=0.72) for one in read_recordings(written(tmp_path, own(held), name="rec.csv"))]
