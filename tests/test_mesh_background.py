"""A mesh that does not show in a telescope's recording: how large its wave is, and how often noise makes as much."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from gearpoly.compare.entries import Entry
from gearpoly.compare.mesh_background import mesh_remarks, mesh_wave
from gearpoly.units import FloatArray
from tests.made_command import Command
from tests.test_guide_logs import LOGS
from tests.test_on_sky import EQ6, wave

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


@pytest.mark.long
def test_noise_holds_as_much_as_it_says() -> None:
    """The part is uniform from 0 to 1 in noise: mean 1/2, with a deviation of sqrt(1/12/100) = 0.03 in 100 draws."""
    parts = [found[1] for k in range(100) if (found := mesh_wave(noise(k), U, z_2=Z_2)) is not None]
    assert np.mean(parts) == pytest.approx(0.5, abs=0.09)
    assert np.mean(np.array(parts) < 0.1) == pytest.approx(0.1, abs=0.09)  # three deviations of 10 in 100


def test_waves_of_the_driven_shaft_are_no_background() -> None:
    """A strong wave of order 53 beside the mesh changes its part by what leaks through 1.5 lines."""
    rest = noise(4)
    plain, beside = (mesh_wave(rest + size * np.cos(2.0 * math.pi * 53 / Z_2 * U), U, z_2=Z_2) for size in (0.0, 0.5))
    assert plain is not None and beside is not None
    assert beside[1] == pytest.approx(plain[1], abs=0.1)


def test_a_recording_of_half_a_turn_has_no_lines_beside() -> None:
    short = U < 0.5 * Z_2
    assert mesh_wave(noise(1)[short], U[short], z_2=Z_2) is None


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        (None, True),
        (wave(kind="mesh_order", order=1.0), False),
        (wave(kind="time", hz=47.0 / 478.69), False),
        (wave(gear="driven", order=47.1), False),  # a recording of six turns tells a sixth of an order
        (wave(gear="driven", order=5.0), True),
        (wave(gear="driven", order=48.0), True),
    ],
)
def test_a_mesh_that_shows_in_any_guise_is_not_said_to_be_hidden(entry: Entry | None, said: bool) -> None:
    located = SimpleNamespace(where=() if entry is None else (entry,), left=(1e-3 * noise(1),))
    aligned = [SimpleNamespace(theta_2=U * 2.0 * math.pi / Z_2)]
    words = list(mesh_remarks(located, aligned, EQ6))  # type: ignore[arg-type]
    assert bool(words) == said
    assert all("um (" in one and "lies within the background" in one for one in words)


@pytest.mark.long
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
