"""Long recordings are fitted as means of whole hunting cycles, and nothing that was located in all samples is lost."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import compare
from gearpoly.compare.reduce import Shortening
from gearpoly.compare.template import make_template
from gearpoly.diagnose.fitted_part import LONG_RECORDING_SAMPLES, _means, fitted_part
from gearpoly.diagnose.foreign import columns_of
from gearpoly.mesh.condition import Condition
from gearpoly.recording.recording import Recording
from gearpoly.units import UM
from tests.made_recordings import TURN, inspected

N, PER_MESH, RATE = 200_000, 100, 20_000.0
FAST, SLOW, JUMP_AT = 360.333, 123.333, 170_000
"""Orders of the driving shaft, 20 and 7 waves per mesh: means over four samples hold up to 12. Three hunting cycles of
450 meshes end at 135 000."""


pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> Comparison:
    rng = np.random.default_rng(7)
    file, path, made = inspected(tmp_path_factory.mktemp("long"), rng, gauge=0.2)
    template = make_template(made, Condition(flank="drive", torque=0.0))
    theta_2 = 3.0 + np.arange(N) * (TURN / made.pair.driven.gear.z / PER_MESH)
    time = np.arange(N) / RATE
    te = template.at(theta_2) + rng.normal(0.0, 0.3 * UM, N)
    turned = theta_2 * 25.0 / 18.0
    te += UM * (0.4 * np.cos(FAST * turned) + 0.5 * np.cos(SLOW * turned))
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
    assert one.theta_2.size > LONG_RECORDING_SAMPLES
    part = fitted_part(compared).comparison
    assert part.aligned[0].theta_2.size < LONG_RECORDING_SAMPLES
    short = replace(part, aligned=tuple(replace(one, averaged=0.0) for one in part.aligned))
    assert fitted_part(short).comparison is short


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
    (fast,) = [e for e in found.beyond if e.kind == "shaft_order"]
    assert fast.order == pytest.approx(FAST, abs=0.01)
    assert fast.amplitude_um == pytest.approx(0.4, abs=0.02)
    (jump,) = [e for e in found.beyond if e.moment]
    assert jump.time_s == pytest.approx(JUMP_AT / RATE, abs=0.001)
    assert [e.order for e in found.comparison.located.entries] == [pytest.approx(SLOW, abs=0.01)]
    # The fast wave is gone from the means: at the order that it would take on there, 450 - 360, there is nothing.
    one = found.comparison.aligned[0]
    image = 2.0 * np.abs(np.mean(one.residual * np.exp(1j * (PER_MESH / 4 * 18 - FAST) * one.theta_1)))
    # Noise of 0.3 um, halved by the means: 0.15 * sqrt(4/34 000) um of amplitude, four times that at most.
    assert image < 4.0 * 0.15 * UM * np.sqrt(4.0 / one.theta_2.size)


def test_of_a_run_up_every_speed_is_kept(compared: Comparison, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearpoly.diagnose.fitted_part.runs_up", lambda theta_1, time_s: (1.0, 2.0))
    one = fitted_part(compared).comparison.aligned[0]
    # 200 000 samples as means of three: 66 666, and the last two are left.
    assert one.theta_2.size == N // 3
    assert one.time_s is not None
    assert one.time_s[-1] * RATE == pytest.approx(3 * (N // 3) - 2)


def test_cycles_are_cut_where_nothing_is_averaged(compared: Comparison) -> None:
    """Every fourth sample, 25 to the mesh, twice over: more hunting cycles than are fitted, and no two to a mean."""
    whole = compared.aligned[0]
    every = Shortening(group=4, size=N // 4, spacing=1 / PER_MESH)
    thin = replace(_means(whole, every), averaged=0.0)
    u = thin.theta_2
    twice = np.concatenate([u, u + float(np.ptp(u)) * u.size / (u.size - 1)])
    names = ("theta_1", "theta_2", "te", "keep")
    cleaned = replace(
        thin.cleaned, **{name: np.tile(getattr(thin.cleaned, name), 2) for name in names},
        time_s=np.arange(2 * u.size) * 4.0 / RATE,
    )  # fmt: skip
    long = replace(
        thin, cleaned=cleaned, theta_2=twice, recorded=np.tile(thin.recorded, 2), residual=np.tile(thin.residual, 2)
    )
    part = fitted_part(replace(compared, aligned=(long,))).comparison.aligned[0]
    assert long.theta_2.size > LONG_RECORDING_SAMPLES
    assert part.averaged == 0.0
    assert part.theta_2.size == pytest.approx(3 * 450 * 25, abs=2)


def test_columns_of_waves_are_as_small_as_means_make_them(compared: Comparison) -> None:
    found = fitted_part(compared)
    (wave,) = found.comparison.located.entries
    whole, part = compared.aligned[0], found.comparison.aligned[0]
    n = part.theta_2.size
    means = columns_of(wave, whole)[: 4 * n].reshape(n, 4, 2).mean(axis=1)
    # A sum over four samples is larger than their integral, sin(x)/x, by x^2/6 of a sample's x = pi 6.85/100: 0.8 %;
    # columns are drawn at estimated angles, whose noise is another for means.
    drawn = columns_of(wave, part)
    assert float(np.sum(drawn * means) / np.sum(means**2)) == pytest.approx(1.0 - 0.008, abs=0.002)
