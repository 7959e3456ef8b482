"""The stories in examples/stories come out as they are told."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import pytest

from tests.at_hand import SHARED

STORIES = Path(__file__).resolve().parents[1] / "examples" / "stories"
TELESCOPE = SHARED / "telescope"


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


@pytest.mark.slow
@pytest.mark.skipif(not TELESCOPE.is_dir(), reason="the telescope recordings are not here")
def test_telescope(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worm's wheel of 180 teeth that follows the stars turns in a sidereal day of 86 164 s, the worm in 478.69 s."""
    found = told("telescope", tmp_path, monkeypatch, TELESCOPE)
    # A wave of 7.5 standard deviations in 1675 s is known to sqrt(3) / (pi 7.5 1675 s) = 4.4e-5 Hz of the mesh's 0.098:
    # 0.21 s of the worm's turn. Four times that is allowed. A tooth more or less would be 40 s.
    assert found["worm's turn by the mesh, s"] == pytest.approx(478.69, abs=0.85)
    assert found["teeth of the driving gear"] == pytest.approx(12.0, abs=0.15)  # its turn is known to 0.3 %
    assert found["12:47, named"][0].startswith("The driving gear runs 34.")
    assert "Or else: encoder eccentricity" in found["12:47, named"][0]  # one flank leaves them alike
    assert "such as a worm" in found["12:47, named"][1]
    assert set(found["12:47, unnamed"]) == {"mesh_order", "mesh_phase"}
    assert any(words.startswith("order 1 of the mesh") for words in found["12:47, located"])
    before, after, noise = found["12:47, held-out rms before and after, noise, um"]
    assert noise < after < 0.5 * before  # worm and wander stay; what was named is more than half
    # Read as 9:47 nothing lies at the mesh, and a wave on the driving flanks counts the teeth that are really there.
    assert not any("mesh" in words for words in found["9:47, located"])
    assert any("12 times per turn" in words for words in found["9:47, named"])
    # Another maker's worm: its harmonics agree, on a whole wheel.
    assert found["the other mount, named"] == []
    periods = list(found["the other mount's worm by its harmonics, s"].values())
    assert max(periods) - min(periods) < 0.5  # each is known to 0.1 to 0.3 s
    assert found["teeth of the other mount's wheel"] == pytest.approx(225.0, abs=0.3)
