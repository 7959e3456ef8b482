"""Recordings to test on: those of this repository, and those of other rigs where they lie beside it."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.read import read_recording

ROOT = Path(__file__).resolve().parents[1]
SHIPPED = ROOT / "data" / "recordings"
SHARED = ROOT.parent / "shared" / "recordings"
BENCH = SHARED / "bench"


def here(*paths: Path) -> list[Path]:
    """Those of the ``paths`` that are on this machine."""
    return [path for path in paths if path.exists()]


def shipped_and_beside(shipped: str, beside: str) -> list[Any]:
    """A folder of this repository, and, among the slow tests, one of another rig that shows the same."""
    return [SHIPPED / shipped, *(pytest.param(path, marks=pytest.mark.slow) for path in here(BENCH / beside))]


def recordings(folder: Path) -> list[Path]:
    return sorted(folder.glob("rec_*.csv"))


def truths(folder: Path) -> list[dict[str, Any]]:
    """What is hidden in the recordings of a ``folder``."""
    return list(json.loads(folder.with_name(f"{folder.name}.truth.json").read_text(encoding="utf-8"))["truth"])


@cache
def diagnosed(folder: Path) -> Diagnosis:
    """The diagnosis of a ``folder``, once for all tests of one process."""
    pair = folder / "pair.toml"
    return diagnose(read_pair(pair), [read_recording(path) for path in recordings(folder)], path=pair)
