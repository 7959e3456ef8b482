"""A map is taken by every command that takes a recording: 9 um once per turn and 3 um of the mesh come back."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from tests.made_command import Command

Z, BASE_RADIUS_MM = (18, 25), 25.0 * math.cos(math.radians(20.0))
COUNTS = 3_600_000
PAIR = """\
name = "rigid"
[pair]
torque_nm = 5.0
speed_rpm = 30.0
[model]
tooth_deflection = false
[driving]
teeth = 18
module_mm = 2.0
face_width_mm = 20.0
[driven]
teeth = 25
module_mm = 2.0
face_width_mm = 20.0
"""
MAP = f"""\
columns.time_s = {{ from = "uhr", unit = "ms" }}
columns.driving_angle_deg = {{ from = "kanal 1", unit = "rev" }}
columns.driven_angle_deg = {{ from = "kanal 2", unit = "rev", scale = {1.0 / COUNTS!r}, wraps = 16777216, sign = -1 }}
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, Path]:
    """A pair, and the log of a rig whose driven encoder counts down in 24 bits, with its map."""
    folder = tmp_path_factory.mktemp("mapped")
    time = np.arange(10_200) / 500.0
    turns = 2.0 * math.pi * (0.5 * time + 0.02 * np.sin(0.8 * time))
    te = 9.0 * np.cos(turns - 0.7) + 3.0 * np.cos(18.0 * turns + 1.0)
    te += 0.2 * np.random.default_rng(1).standard_normal(time.size)
    driven = turns * Z[0] / Z[1] + 1e-3 * te / BASE_RADIUS_MM
    counts = np.floor(-driven / (2.0 * math.pi) * COUNTS).astype(np.int64) % 2**24
    rows = zip(1e3 * time, turns / (2.0 * math.pi), counts, strict=True)
    lines = ["uhr;kanal 1;kanal 2", *(f"{t:.3f};{a:.9f};{c}".replace(".", ",") for t, a, c in rows)]
    (folder / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "pair.toml").write_text(PAIR, encoding="utf-8")
    (folder / "map.toml").write_text(MAP, encoding="utf-8")
    return folder / "pair.toml", folder / "log.csv", folder / "map.toml"


def amplitudes(verdict: Path) -> dict[tuple[str, float], float]:
    found = json.loads(verdict.read_text(encoding="utf-8"))
    return {(one["kind"], one["order"]): one["amplitude_um"] for one in found["where"] if "order" in one}


@pytest.mark.long
@pytest.mark.parametrize(
    ("command", "more"), [("compare", ()), pytest.param("diagnose", ("--within", "5"), marks=pytest.mark.slow)]
)
def test_both_waves_are_located(
    gearpoly_command: Command, tmp_path: Path, files: tuple[Path, Path, Path], command: str, more: tuple[str, ...]
) -> None:
    pair, log, chart = files
    ran = gearpoly_command(command, pair, log, "--map", chart, "--json", tmp_path / "out.json", *more)
    assert ran.code == 0, ran.err
    found = amplitudes(tmp_path / "out.json")
    # The base pitch of rigid teeth is that of the polygon, so that nothing else is at these orders.
    assert found["shaft_order", 1] == pytest.approx(9.0, abs=0.1)
    assert found["mesh_order", 1] == pytest.approx(3.0, abs=0.1)


@pytest.mark.long
def test_samples_and_mismatch_are_shown(gearpoly_command: Command, tmp_path: Path, files: tuple[Path, ...]) -> None:
    pair, log, chart = files
    short = tmp_path / "short.csv"
    short.write_text("\n".join(log.read_text(encoding="utf-8").split("\n")[:1301]) + "\n", encoding="utf-8")
    ran = gearpoly_command("simulate", pair, "--at", short, "--map", chart, "--csv", tmp_path / "at.csv")
    assert ran.code == 0, ran.err
    assert len((tmp_path / "at.csv").read_text(encoding="utf-8").splitlines()) == 1301
    ran = gearpoly_command("view", pair, "--recording", log, "--map", chart, "--html", tmp_path / "v.html")
    assert ran.code == 0, ran.err
    assert (tmp_path / "v.html").stat().st_size > 100_000
    ran = gearpoly_command("read", log, "--map", chart, "--plot", tmp_path / "p.png")
    assert ran.code == 0, ran.err
    assert (tmp_path / "p.png").stat().st_size > 10_000
    # Without the map the names say nothing, and nothing is written.
    for words in (("compare", pair, log, "--json"), ("simulate", pair, "--at", log, "--csv")):
        ran = gearpoly_command(*words, tmp_path / "none")
        assert ran.code == 2 and "columns.driving_angle_deg" in ran.err
        assert not (tmp_path / "none").exists()
