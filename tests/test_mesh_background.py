"""A mesh that does not show in a telescope's recording: how large its wave is, and how often noise makes as much."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.mesh_background import mesh_wave
from gearpoly.units import FloatArray
from tests.made_command import Command
from tests.made_guide_log import made_log
from tests.test_guide_logs import LOGS
from tests.test_on_sky import PAIR

Z_2 = 47
U = np.linspace(0.0, 6.0 * Z_2, 3000)


def noise(seed: int) -> FloatArray:
    return np.random.default_rng(seed).standard_normal(U.size)


def test_a_wave_has_its_amplitude() -> None:
    """0.5 mm on noise of 1 mm: sqrt(2/n) of it is the error of either component, 5 of them cover every draw."""
    wave = 0.5 * np.cos(2.0 * math.pi * U + 0.3)
    found = mesh_wave(noise(1) + wave, U, z_2=Z_2)
    assert found is not None
    assert found[0] == pytest.approx(0.5, abs=5.0 * math.sqrt(2.0 / U.size))
    assert found[1] < 1e-9  # z is 0.5^2 n / 4 = 188


def test_noise_holds_as_much_as_it_says() -> None:
    """The part is uniform from 0 to 1 in noise: mean 1/2, with a deviation of sqrt(1/12/200) = 0.02 in 200 draws."""
    parts = [found[1] for k in range(200) if (found := mesh_wave(noise(k), U, z_2=Z_2)) is not None]
    assert np.mean(parts) == pytest.approx(0.5, abs=0.06)
    assert np.mean(np.array(parts) < 0.1) == pytest.approx(0.1, abs=0.065)  # three deviations of 20 in 200


def test_waves_of_the_driven_shaft_are_no_background() -> None:
    """A strong wave of order 53 beside the mesh changes its part by what leaks through 1.5 lines."""
    rest = noise(4)
    plain, beside = (mesh_wave(rest + size * np.cos(2.0 * math.pi * 53 / Z_2 * U), U, z_2=Z_2) for size in (0.0, 0.5))
    assert plain is not None and beside is not None
    assert beside[1] == pytest.approx(plain[1], abs=0.1)


def test_a_recording_of_half_a_turn_has_no_lines_beside() -> None:
    short = U < 0.5 * Z_2
    assert mesh_wave(noise(1)[short], U[short], z_2=Z_2) is None


def test_a_mesh_that_shows_is_not_spoken_of_and_one_that_does_not_is(tmp_path: Path, gearpoly_command: Command) -> None:
    """The made log has a mesh of 47 to one turn; a driven gear of 41 teeth has none there."""
    log = tmp_path / "log.txt"
    log.write_text(made_log(frames=1500, dithered=(-1, 0.0), lost=-1)[0], encoding="utf-8")
    for teeth, said in ((47, False), (41, True)):
        pair = tmp_path / f"{teeth}.toml"
        pair.write_text(PAIR.replace("teeth = 47", f"teeth = {teeth}"), encoding="utf-8")
        ran = gearpoly_command("compare", pair, log)
        assert ran.code == 0, ran.err
        assert ("mesh order 1, " in ran.out and "lies within the background" in ran.out) == said


@pytest.mark.skipif(not LOGS.is_dir(), reason="the real guide logs are not beside this checkout")
@pytest.mark.parametrize("log", ["log01.txt", "log02.txt", "log03.txt"])
def test_the_mesh_of_a_real_log_is_located_or_said_to_be_hidden(
    tmp_path: Path, gearpoly_command: Command, log: str
) -> None:
    """By two commands from the raw log: the mount's pair file, and the comparison."""
    pair = tmp_path / "eq6.toml"
    assert gearpoly_command("pair", "--mount", "EQ6", pair).code == 0
    ran = gearpoly_command("compare", pair, LOGS / log)
    assert ran.code == 0, ran.err
    assert ("Mesh order 1, " in ran.out) == (log == "log01.txt")
    assert ("lies within the background" in ran.out) == (log != "log01.txt")
