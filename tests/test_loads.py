"""A torque that varies along a recording: the simulation follows it, and names nothing for it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from gearpoly.assemble import Assembled
from gearpoly.cli import app
from gearpoly.compare.compare import compare
from gearpoly.compare.template import Template, make_template
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.nuisance import softened
from gearpoly.files.pairfile import dump_pair
from gearpoly.mesh.condition import Condition as Under
from gearpoly.mesh.pair import Flank
from gearpoly.mesh.varied import Giving
from gearpoly.recording.load import relative_load
from gearpoly.scene import stage
from gearpoly.units import NM, UM, FloatArray
from tests.pair_files import made
from tests.physics_cases import Condition, recorded, rough, samples_at

TORQUE = 20.0


def waves(n: int, *, part: float = 0.06) -> FloatArray:
    """Torque over its mean, less 1 (n,): a slow wave and a faster one."""
    x = np.arange(n) / n
    return np.asarray(part * np.sin(2.0 * np.pi * 3.3 * x) + 0.4 * part * np.cos(2.0 * np.pi * 20.7 * x))


@pytest.mark.long
@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_a_scene_under_varying_torque_is_each_sample_under_its_own(flank: Flank) -> None:
    """To first order: 2 % more bend the teeth by 0.09 um more. Where pairs come into touch meanwhile, some of 600
    samples, they bend less; measured 0.039 of the change in the mean square."""
    assembled = made(rough())
    theta_2 = np.linspace(0.0, assembled.pair.cycle, 600, endpoint=False)
    samples = samples_at(assembled, theta_2, Condition(flank=flank, torque_nm=TORQUE), 0)
    follows = stage(assembled, replace(samples, load=np.full(600, 0.02))).te
    more = stage(assembled, replace(samples, torque=1.02 * samples.torque)).te
    plain = stage(assembled, samples).te
    assert np.std(follows - more) < 0.06 * float(np.sqrt(np.mean((more - plain) ** 2)))
    assert np.sign(np.mean(follows - plain)) == (-1.0 if flank == "drive" else 1.0)


def test_a_parabola_goes_through_the_three_loads_that_made_it() -> None:
    """Nothing at the mean, and at both ends what was seen there, however far apart they lie; exact but for rounding."""
    rng = np.random.default_rng(2)
    up, down = rng.normal(0.0, 3.0, (2, 50))
    one = Giving(up=up, down=down, most=0.8, least=0.5)
    for off, added in ((0.0, 0.0 * up), (0.8, 0.8 * up), (-0.5, -0.5 * down)):
        assert one.by(np.full(50, off)) == pytest.approx(added, abs=1e-12)
    # Of what is in proportion to the load a straight line is left.
    assert replace(one, down=up).by(np.full(50, 0.3)) == pytest.approx(0.3 * up, abs=1e-12)


@cache
def followed(flank: Flank) -> tuple[Assembled, Template]:
    """A pair, and its curve at the mean torque that follows half as much again and half as much."""
    assembled = made(rough())
    return assembled, make_template(assembled, Under(flank=flank, torque=TORQUE * NM, varies=0.5))


@pytest.mark.long
@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("level", [-0.5, *(pytest.param(one, marks=pytest.mark.slow) for one in (-0.2, 0.5)), 0.3])
def test_a_template_is_followed_from_its_mean_torque_to_others(flank: Flank, level: float) -> None:
    """As if made under that torque: at both ends of the parabola to 0.01 of what changes, between them to 0.04 and 0.08
    where second pairs come to carry; as a part of the deflection it would be 0.10 to 0.22."""
    assembled, mean = followed(flank)
    at = np.linspace(0.0, assembled.pair.cycle, 997, endpoint=False)
    there = make_template(assembled, Under(flank=flank, torque=(1.0 + level) * TORQUE * NM))
    changes = there.at(at) - mean.at(at)
    assert np.std(mean.varied(at, np.full(at.size, level)) - changes) < 0.09 * np.sqrt(np.mean(changes**2))


@pytest.mark.long
@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_a_torque_that_goes_from_half_to_one_and_a_half_is_followed(flank: Flank) -> None:
    """Teeth that come to share on the way and Hertz's law bend the curve: a straight line from the mean torque errs by
    a tenth of what changes, a parabola by a few hundredths, measured 0.03 on both flanks."""
    assembled = made(rough())
    theta_2 = np.linspace(0.0, assembled.pair.cycle, 600, endpoint=False)
    samples = samples_at(assembled, theta_2, Condition(flank=flank, torque_nm=TORQUE), 0)
    levels = np.random.default_rng(3).choice(np.linspace(-0.5, 0.5, 9), 600)
    follows, plain = (stage(assembled, one).te for one in (replace(samples, load=levels), samples))
    own, line = np.empty(600), np.empty(600)
    for level in np.unique(levels):
        here = levels == level
        own[here] = stage(assembled, replace(samples, torque=(1.0 + level) * samples.torque)).te[here]
        line[here] = stage(assembled, replace(samples, load=np.full(600, 0.01))).te[here]
    line = plain + (line - plain) * levels / 0.01
    change = float(np.std(own - plain))
    assert np.std(follows - own) < 0.05 * change
    assert np.std(follows - own) < 0.6 * np.std(line - own)


def test_softer_teeth_follow_the_torque_too() -> None:
    """The derivative by the compliance carries the torque of each sample; 2 % as steps are 0.02."""
    assembled = made(rough())
    theta_2 = np.linspace(0.0, assembled.pair.cycle, 600, endpoint=False)
    samples = samples_at(assembled, theta_2, Condition(torque_nm=TORQUE), 0)
    steady, varying = (softened(stage(assembled, one)) for one in (samples, replace(samples, load=waves(600))))
    assert varying == pytest.approx(steady * (1.0 + waves(600)), rel=1e-9)


def test_a_sensor_s_noise_is_averaged_over_a_mesh() -> None:
    rng = np.random.default_rng(1)
    n, meshes = 20000, 1000.0
    noisy = TORQUE * (1.0 + waves(n) + rng.normal(0.0, 0.02, n))
    noisy[100:110] = np.nan
    load = relative_load(noisy, TORQUE, meshes=meshes)
    assert load is not None
    # 20 samples a mesh: 2 % become 0.45 %; the waves stay.
    assert np.std(load - waves(n)) == pytest.approx(0.02 / np.sqrt(20.0), rel=0.15)
    assert relative_load(np.full(n, TORQUE), TORQUE, meshes=meshes) is None
    assert relative_load(None, TORQUE, meshes=meshes) is None
    assert relative_load(noisy, 0.0, meshes=meshes) is None


def test_a_torque_column_that_is_off_the_stated_torque_counts() -> None:
    """What was read sample by sample goes before what the file says of all."""
    load = relative_load(np.full(100, 22.0), TORQUE, meshes=10.0)
    assert load == pytest.approx(np.full(100, 0.1))


@pytest.mark.long
@pytest.mark.parametrize("diagnosed", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_healthy_pair_under_a_torque_that_wanders_names_nothing(tmp_path: Path, diagnosed: bool) -> None:
    """6 % of 20 N m move the transmission error by 0.3 um, as much as the noise; followed, the noise is left, to the
    2 % by which 3 hunting cycles tell its level."""
    true, rng = rough(), np.random.default_rng(8)
    (steady,) = recorded(true, (Condition(torque_nm=TORQUE),), rng, cycles=3.0)
    assert steady.driving_angle_rad is not None
    assert steady.driven_angle_rad is not None
    load = waves(steady.driving_angle_rad.size)
    assembled = made(true)
    at = steady.driven_angle_rad - 2.3
    samples = samples_at(assembled, at, Condition(torque_nm=TORQUE), 0)
    steady_te = stage(assembled, samples).te
    change = sum(
        np.where(np.sign(load) == sign, np.abs(load) / 0.05, 0.0)
        * (stage(assembled, replace(samples, torque=(1.0 + 0.05 * sign) * TORQUE * NM)).te - steady_te)
        for sign in (-1.0, 1.0)
    )
    # The driving encoder counts down; the driven gear is held where it was read.
    off = np.asarray(change) / (assembled.pair.r_b2 * assembled.pair.ratio)
    varying = replace(steady, driving_angle_rad=steady.driving_angle_rad + off, torque_samples_nm=TORQUE * (1.0 + load))
    path = tmp_path / "pair.toml"
    assert compare(true, [replace(varying, torque_samples_nm=None)], path=path).located.residual_rms > 0.35 * UM
    followed = compare(true, [varying], path=path).located
    assert not followed.where
    assert followed.residual_rms < 0.35 * UM
    if not diagnosed:
        return
    diagnosis = diagnose(true, [varying], path=path)
    assert not diagnosis.findings
    assert not diagnosis.unexplained
    assert diagnosis.after.unseen == pytest.approx(0.3 * UM, rel=0.04)


@pytest.mark.long
def test_simulate_at_a_recording_follows_its_torque(tmp_path: Path) -> None:
    """``simulate --at`` and the scene of a diagnosis are one simulation: to rounding of the files' digits."""
    true, n = rough(), 400
    theta_2 = np.linspace(0.1, 2.0, n)
    assembled = made(true)
    samples = samples_at(assembled, theta_2, Condition(torque_nm=TORQUE), 0)
    steady = stage(assembled, samples).te
    load = relative_load(TORQUE * (1.0 + waves(n)), TORQUE, meshes=float(np.ptp(theta_2)) / (2.0 * np.pi / 16))
    te = stage(assembled, replace(samples, load=load)).te
    pair, rec, out = tmp_path / "pair.toml", tmp_path / "rec.csv", tmp_path / "te.csv"
    pair.write_text(dump_pair(true))
    rows = np.column_stack([np.degrees(theta_2), steady / UM, TORQUE * (1.0 + waves(n))])
    head = f"# torque_nm = {TORQUE}\n# driven_zero_deg = 0.0\ndriven_angle_deg,te_um,torque_nm"
    np.savetxt(rec, rows, delimiter=",", header=head, comments="", fmt="%.12g")
    assert CliRunner().invoke(app, ["simulate", str(pair), "--at", str(rec), "--csv", str(out)]).exit_code == 0
    table = np.genfromtxt(out, delimiter=",", names=True, comments="#")
    assert table["te_um"] == pytest.approx(te / UM, abs=1e-4)
