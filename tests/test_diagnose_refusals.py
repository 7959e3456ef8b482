"""What ``gearpoly diagnose`` refuses: one message with file, key, value and cure, exit 2, and no file behind."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from tests.made_command import Command
from tests.made_recordings import Rig, inspected, record
from tests.recording_files import write_csv

ZERO = 30.0
RIG = Rig(zero_1=math.radians(ZERO), zero_2=math.radians(ZERO))
OTHERS = "[driving]\nteeth = 17\nmodule_mm = 2.0\n[driven]\nteeth = 25\nmodule_mm = 2.0\n"


@pytest.fixture
def bench(tmp_path: Path) -> Path:
    """A pair of 11 and 13 teeth, whole.csv of it, later.csv whose stated zero is 20 deg off (half a tooth is 13.8 deg),
    short.csv of a third of a turn; and files of a pair that is another one, or out of reach."""
    folder = tmp_path / "bench"
    folder.mkdir()
    rng = np.random.default_rng(2)
    _, path, truth = inspected(folder, rng, z_1=11, z_2=13, points=60)
    for name, off, cycles in (("whole", 0.0, 1.0), ("later", 20.0, 1.0), ("short", 0.0, 0.026)):
        one = record(truth, RIG, rng, cycles=cycles, per_mesh=12)
        assert one.driving_angle_rad is not None and one.driven_angle_rad is not None
        angles = {"driving": one.driving_angle_rad, "driven": one.driven_angle_rad}
        columns = {f"{shaft}_angle_deg": np.degrees(angle) for shaft, angle in angles.items()}
        write_csv(folder / f"{name}.csv", columns, {"driving_zero_deg": ZERO, "driven_zero_deg": ZERO + off})
    (folder / "others.toml").write_text(OTHERS, encoding="utf-8")
    apart = path.read_text(encoding="utf-8").replace("[model]", "[pair]\ncentre_distance_mm = 29.0\n[model]")
    (folder / "apart.toml").write_text(apart, encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    ("pair", "recordings", "says"),
    [
        # 11/13 is 0.846, a quarter above 17/25.
        (
            "others.toml",
            ["whole.csv"],
            ["whole.csv", "0.846", "11 on 13 teeth", "0.68", "want a recording of this pair"],
        ),
        (
            "pair.toml",
            ["whole.csv", "later.csv"],
            ["later.csv", "driven_zero_deg", "50.000", "20.000 deg", "one by one"],
        ),
        ("pair.toml", ["short.csv"], ["short.csv", "driving turns", "record longer"]),
        ("apart.toml", ["whole.csv"], ["apart.toml", "centre", "29"]),
    ],
    ids=["another pair", "zeros apart", "too short", "out of reach"],
)
def test_what_cannot_be_diagnosed_is_one_message(
    pair: str, recordings: list[str], says: list[str], bench: Path, gearpoly_command: Command
) -> None:
    out = bench / "out"
    out.mkdir()
    targets = [word for name in ("json", "html", "fitted") for word in (f"--{name}", out / name)]
    ran = gearpoly_command("diagnose", bench / pair, *(bench / one for one in recordings), *targets)
    assert ran.code == 2, ran.err
    assert ran.out == ""
    (line,) = ran.err.strip().splitlines()
    assert line.startswith("gearpoly: ")
    for word in says:
        assert word in line
    assert list(out.iterdir()) == []


@pytest.mark.long
def test_a_declared_pair_that_jams_says_where_and_what_still_stands(bench: Path, gearpoly_command: Command) -> None:
    """Teeth 60 um too thick on both gears, where 60 um of backlash were: each flank is diagnosed by itself all the
    same, and a note says where the pair jams, which keys cure it, and what of the result stands."""
    text = (bench / "pair.toml").read_text(encoding="utf-8").replace("thickness_um = -60.0", "thickness_um = 60.0")
    (bench / "jams.toml").write_text(text, encoding="utf-8")
    ran = gearpoly_command("diagnose", bench / "jams.toml", bench / "whole.csv")
    assert ran.code == 0, ran.err
    (note,) = (line for line in ran.out.splitlines() if "jam" in line)
    for word in ("driven angle", "overlap by", "tooth_thickness_um", "centre_distance_mm", "stands"):
        assert word in note
