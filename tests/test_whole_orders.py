"""A wave on a whole order of a shaft is that order, unless it is clearly fixed in time."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.entries import Entry
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, UM, FloatArray

Z, TURNS, SECONDS = (14, 30), 8.0, 90.0
R_B2 = 30.0 * math.cos(20.0 * DEG)
"""mm: half of 30 teeth of module 2 on the base circle."""


def located(folder: Path, seed: int, *, strays: float, timely: bool = False) -> list[Entry]:
    """Orders 1 to 3 of a sensor on the driven shaft, which reads nothing in 15 deg of its turn, in noise of 5 um; the
    shaft ``strays`` from a steady speed by so many rad. ``timely``: the third wave is fixed in time, at the frequency
    that order 3 has in the mean."""
    path = folder / "pair.toml"
    path.write_text("[driving]\nteeth = 14\nmodule_mm = 2.0\n[driven]\nteeth = 30\nmodule_mm = 2.0\n", encoding="utf-8")
    rng, along = np.random.default_rng(seed), np.arange(9000) / 9000
    walk: FloatArray = np.cumsum(rng.normal(size=along.size))
    walk -= np.polyval(np.polyfit(along, walk, 1), along)
    theta_2 = 2.0 * math.pi * TURNS * along + strays / float(np.std(walk)) * walk
    third = 2.0 * math.pi * 3.0 * TURNS * along if timely else 3.0 * theta_2
    te = 120.0 * np.cos(theta_2 + 0.5) + 70.0 * np.cos(2.0 * theta_2 + 1.0) + 40.0 * np.cos(third)
    te += 5.0 * rng.normal(size=along.size)
    read = np.mod(theta_2 / DEG + 25.0, 360.0) < 345.0
    recording = Recording(
        source=Path("poti.csv"),
        time_s=SECONDS * along[read],
        driving_angle_rad=theta_2[read] * Z[1] / Z[0],
        driven_angle_rad=(theta_2 + te * UM / R_B2)[read],
    )
    return list(compare(read_pair(path), [recording], path=path).located.entries)


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_at_a_steady_speed_whole_orders_are_told_as_such(seed: int, tmp_path: Path) -> None:
    """The shaft strays by half a degree: over time and over angle such waves differ by 0.0002 of their power, less than
    what each leaves of the others while it is placed. One was told as 0.0889 Hz, another as order 0.9334 of the driving
    shaft. Their size is told to 1 um by what the sensor's gaps hide."""
    found = located(tmp_path, seed, strays=0.5 * DEG)
    sizes = {(one.kind, one.gear, one.order): one.amplitude_um for one in found[:3]}
    assert sizes == {
        ("shaft_order", "driven", k): pytest.approx(size, abs=1.0) for k, size in ((1, 120), (2, 70), (3, 40))
    }


@pytest.mark.long
def test_a_wave_fixed_in_time_is_no_order_where_the_speed_tells_them_apart(tmp_path: Path) -> None:
    """The shaft strays by 0.15 rad, 0.45 rad of order 3: at that order a fifth of the wave's power is lost."""
    found = located(tmp_path, 0, strays=0.15, timely=True)
    assert [(one.kind, one.order) for one in found[:2]] == [("shaft_order", 1), ("shaft_order", 2)]
    assert found[2].hz == pytest.approx(3.0 * TURNS / SECONDS, abs=1e-3)
    assert not any("order" in rival for rival in found[2].rivals)
