"""What the page about sheets and designs shows: its samples are those of the script, its examples are read."""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import gearpoly
from gearpoly.files.inspection.sheet_map import SheetMap
from gearpoly.units import UM
from tests.made_command import Command
from tests.made_sheets import known, samples

ROOT = Path(__file__).parents[1]
SHEETS = ROOT / "data" / "sheets"
PAGE = (ROOT / "docs" / "reference" / "sheets.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```toml\n(.+?)```", PAGE, flags=re.DOTALL)


@pytest.mark.long
def test_samples_are_what_the_script_makes() -> None:
    made = samples()
    assert {one.name for one in SHEETS.iterdir()} == {*made, "README.md"}
    for name, data in made.items():
        assert (SHEETS / name).read_bytes() == data, f"python -m tests.made_sheets --out data/sheets ({name})"
        assert len(data) < 30_000


def test_the_known_deviations_are_in_the_samples(gearpoly_command: Command, tmp_path: Path) -> None:
    """Both gears from their sheets: pitch of every tooth and flank as it was put into the gears."""
    file = tmp_path / "pair.toml"
    base = ("pair", "--flank", "left", file)
    assert gearpoly_command(*base, "--from", SHEETS / "driving.mka", "--as", "driving").code == 0
    layout = ("--map", SHEETS / "driven_map.toml")
    assert gearpoly_command(*base, "--from", SHEETS / "driven.csv", "--as", "driven", *layout).code == 0
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("[driving]", "[pair]\ncentre_distance_mm = 43.3\n\n[driving]", 1), encoding="utf-8")
    pair, truth = gearpoly.Pair.read(file), gearpoly.Pair.of(known())
    for gear, each in (("driving", 0.01), ("driven", 0.02)):  # um, as the two sheets print
        at = np.array([getattr(truth, gear).nominal.l_pitch])
        for flank in ("drive", "coast"):
            mine, its = (np.diff(getattr(one, gear).deviation(at, flank=flank)[:, 0] / UM) for one in (truth, pair))
            # The level of the three traced teeth is not that of the others' mean slope.
            plain = [k for k in range(mine.size) if gear == "driven" or not {k, k + 1} & {0, 6, 12}]
            np.testing.assert_allclose(its[plain], mine[plain], atol=each)


def test_the_map_on_the_page_is_a_map() -> None:
    found = SheetMap.model_validate(tomllib.loads(BLOCKS[0]))
    assert set(SheetMap.model_fields) == found.model_fields_set
    assert found.columns["dT li"] == "single_pitch_left"


def test_the_inch_gear_on_the_page_is_what_its_comments_say() -> None:
    raw = tomllib.loads(BLOCKS[1]) | {"driven": {"teeth": 30, "diametral_pitch": 10}}
    pair = gearpoly.Pair.of(raw)
    gear = pair.driving.nominal
    assert (gear.m, gear.x, gear.rack.h_aP, gear.rack.h_fP) == pytest.approx((2.54, 0.0, 1.0, 1.25), abs=1e-12)
    # Coast flanks stand in by E_s cos(alpha); pins sink by E_s / (2 sin(alpha_K)), nearly.
    thin = -float(pair.driving.deviation(np.array([gear.l_pitch]), flank="coast")[0, 0])
    assert 0.0 < thin < 0.1
    alpha_K = math.acos(2.0 * gear.r_b / (56.83 - 4.3891))
    assert thin / math.sin(alpha_K) == pytest.approx(56.8706 - 56.83, rel=0.02)


def test_every_option_and_kind_of_column_is_on_the_page() -> None:
    for word in ("--as", "--flank", "--count", "--map", "--stage", "cumulative_pitch", "tooth_thickness", "ignored"):
        assert word in PAGE
