"""Every example runs by itself, and the numbers that it asserts hold."""

from __future__ import annotations

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib import image

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = sorted(path for path in (ROOT / "examples").glob("*.py") if path.name != "first_run.py")
SLOW = {
    "diagnose_recording", "compare_recording", "guide_log", "which_recording", "grade_and_chance", "own_recording",
    "tolerance_study",
}  # fmt: skip
"""What a quicker test of the API, of drawn gears or of guide logs shows as well."""


def test_there_are_ten_and_each_asserts_a_number() -> None:
    assert len(EXAMPLES) >= 10
    for path in EXAMPLES:
        text = path.read_text(encoding="utf-8")
        assert len(text.splitlines()) <= 60, path.name
        assert re.search(r"^assert .*\d", text, re.MULTILINE), path.name
        # What it imports of gearpoly is the API alone.
        assert not re.search(r"(from|import) gearpoly\.", text), path.name


AS_A_PROGRAM = "ideal_pair"
"""The one that is started as a user starts it; the others run in this process, which has gearpoly loaded."""


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=pytest.mark.slow if path.stem in SLOW else (), id=path.stem)
        for path in EXAMPLES
        if path.stem != AS_A_PROGRAM
    ],
)
def test_an_example_runs(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """In a module of its own, as a user's Python would."""
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path), run_name="__main__")
    assert capfd.readouterr().out
    assert_one_picture(tmp_path, path.stem)


@pytest.mark.long
def test_an_example_is_a_program(tmp_path: Path) -> None:
    ran = subprocess.run(
        [sys.executable, str(ROOT / "examples" / f"{AS_A_PROGRAM}.py")], capture_output=True, text=True, check=False,
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout
    assert_one_picture(tmp_path, AS_A_PROGRAM)


def assert_one_picture(folder: Path, name: str) -> None:
    (picture,) = folder.iterdir()
    assert picture.name == f"{name}.png"
    # Paper, axes and a curve at least.
    colours = np.rint(255.0 * image.imread(picture)).astype(np.uint8).view(np.uint32)
    assert np.unique(colours).size > 10


def test_the_page_lists_every_example() -> None:
    page = (ROOT / "docs" / "reference" / "examples.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^\| `(\w+)\.py`", page, re.MULTILINE)) == [path.stem for path in EXAMPLES]
    gallery = re.findall(r"\(figures/(\w+)\.png\)", page)
    assert sorted(gallery) == [path.stem for path in EXAMPLES]
    figures = ROOT / "docs" / "reference" / "figures"
    assert (
        sum((figures / f"{name}.png").stat().st_size for name in gallery) < 1_000_000
    )  # of 1.5 MB that a page may weigh
