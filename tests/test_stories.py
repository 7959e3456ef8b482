"""The stories in examples/stories come out as they are told."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import pytest

STORIES = Path(__file__).resolve().parents[1] / "examples" / "stories"


def told(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch, *more: Path) -> dict[str, Any]:
    monkeypatch.syspath_prepend(STORIES)
    found: dict[str, Any] = importlib.import_module(name).main(folder, *more)
    assert (folder / f"{name}.png").stat().st_size > 20_000  # an empty canvas has less
    return found


@pytest.mark.slow
def test_relief_that_cancels_deflection(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = told("relief_cancels_deflection", tmp_path, monkeypatch)
    light, _, full = found["mismatch at every mesh, um rms, by torque"]
    assert full < 0.2 * light  # the ground's own reliefs leave 0.09 to 0.17 of what they do unloaded
    # Bending and the reliefs of both gears, each by its own name and nothing besides.
    for which in ("design torque alone", "three torques"):
        assert len(found[which]) == 3
    assert "The teeth bend under load." in found["three torques"]
    for gear in ("driving", "driven"):
        assert any(words.startswith(f"The tips of the {gear} gear are relieved") for words in found["three torques"])


@pytest.mark.slow
def test_crack_under_pitch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = told("crack_under_pitch", tmp_path, monkeypatch)
    assert found["tooth named"] == [found["cracked tooth"]]


@pytest.mark.slow
def test_encoder_or_gear(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = told("encoder_or_gear", tmp_path, monkeypatch)
    assert abs(found["phase between the flanks, deg"]) < 8.0  # noise and as-built pitch turn it by a few degrees
    assert found["of a gear it would be, deg"] == pytest.approx(40.0, abs=0.5)
    assert "eccentricity" in found["drive flank alone"][0].split("Or else")[1]
    assert found["both flanks"][0].startswith("The encoder")
    assert "Or else" not in found["both flanks"][0]
