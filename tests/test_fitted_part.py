"""Long recordings are fitted as means of whole hunting cycles, and nothing that was located in all samples is lost."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import compare
from gearpoly.compare.template import make_template
from gearpoly.diagnose.fitted_part import LONG, fitted_part
from gearpoly.diagnose.foreign import columns_of
from gearpoly.mesh.condition import Condition
from gearpoly.recording.recording import Recording
from gearpoly.units import UM
from tests.made_recordings import TURN, inspected

N, PER_MESH, RATE = 200_000, 100, 20_000.0
FAST_HZ, SLOW_HZ, JUMP_AT = 4003.7, 1370.3, 180_000
"""20 and 7 waves per mesh: means over four samples hold up to 12. Three hunting cycles of 450 meshes end at 135 000."""


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> Comparison:
    rng = np.random.default_rng(7)
    file, path, made = inspected(tmp_path_factory.mktemp("long"), rng, gauge=0.2)
    template = make_template(made, Condition(flank="drive", torque=0.0))
    theta_2 = 3.0 + np.arange(N) * (TURN / made.pair.driven.gear.z / PER_MESH)
    time = np.arange(N) / RATE
    te = template.at(theta_2) + rng.normal(0.0, 0.3 * UM, N)
    te += UM * (0.4 * np.cos(TURN * FAST_HZ * time) + 0.5 * np.cos(TURN * SLOW_HZ * time))
    te += 3.0 * UM * (np.arange(N) >= JUMP_AT)
    theta_1 = (theta_2 - te / made.pair.r_b2) / made.pair.ratio
    recording = Recording(
        source=Path("long.csv"),
        time_s=time,
        driving_angle_rad=np.mod(theta_1 + 1.0, TURN),
        driven_angle_rad=np.mod(theta_2 + 2.0, TURN),
        torque_nm=0.0,
    )
    return compare(file, [recording], path=path)


def test_short_recordings_stay_as_they_are(compared: Comparison) -> None:
    one = compared.aligned[0]
    assert one.theta_2.size > LONG
    part = fitted_part(compared).comparison
    assert fitted_part(part).comparison is part


def test_means_are_of_neighbours_in_whole_hunting_cycles(compared: Comparison) -> None:
    whole, part = compared.aligned[0], fitted_part(compared).comparison.aligned[0]
    n = part.theta_2.size
    # Four to a mean leave 25 to the mesh; three cycles of 450 meshes are as many as 40960 samples hold.
    assert n == pytest.approx(3 * 450 * 25, abs=2)
    assert part.averaged == pytest.approx(4 / PER_MESH, rel=1e-3)
    for name in ("theta_2", "theta_1"):
        means = getattr(whole, name)[: 4 * n].reshape(n, 4).mean(axis=1)
        # The driving angle follows from the error, of which the fast wave was taken: up to 0.4 um at 18 mm.
        np.testing.assert_allclose(getattr(part, name), means, atol=1e-12 if name == "theta_2" else 3e-5)
    assert part.time_s is not None
    assert part.cleaned.size == n
    assert f"as means over 4 neighbours each: {n} in all" in part.cleaned.done[-1].says


def test_what_means_do_not_show_is_told_as_it_was_located(compared: Comparison) -> None:
    found = fitted_part(compared)
    told = {round(e.hz or 0.0): e for e in found.beyond if e.hz}
    assert told[round(FAST_HZ)].amplitude_um == pytest.approx(0.4, abs=0.02)
    (jump,) = [e for e in found.beyond if e.moment]
    assert jump.time_s == pytest.approx(JUMP_AT / RATE, abs=0.001)
    left = found.comparison.located.entries
    assert {e.hz for e in found.beyond}.isdisjoint({e.hz for e in left if e.hz})
    assert any(abs((e.hz or 0.0) - SLOW_HZ) < 0.1 for e in left)
    # The fast wave is gone from the means: at the frequency that it would take on there, 996 Hz, there is nothing.
    one = found.comparison.aligned[0]
    assert one.time_s is not None
    image = 2.0 * np.abs(np.mean(one.residual * np.exp(-1j * TURN * (RATE / 4 - FAST_HZ) * one.time_s)))
    # Noise of 0.3 um, halved by the means: 0.3/2 * sqrt(4/34 000) um of amplitude, four times that at most.
    assert image < 4.0 * 0.15 * UM * np.sqrt(4.0 / one.theta_2.size)


def test_columns_of_waves_are_as_small_as_means_make_them(compared: Comparison) -> None:
    found = fitted_part(compared)
    (wave,) = [e for e in found.comparison.located.entries if abs((e.hz or 0.0) - SLOW_HZ) < 0.1]
    whole, part = compared.aligned[0], found.comparison.aligned[0]
    n = part.theta_2.size
    means = columns_of(wave, whole)[: 4 * n].reshape(n, 4, 2).mean(axis=1)
    # sin(x)/x of 4 * 1370/20 000 turns; the sum over four samples instead of their integral adds its 2 %/16.
    np.testing.assert_allclose(columns_of(wave, part), means, atol=3e-3)
