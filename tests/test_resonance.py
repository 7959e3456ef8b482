"""Resonance of the mesh, settled and run up to: the equation of motion by a general integrator, and limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gearpoly.mesh.condition import Condition as Under
from gearpoly.mesh.pair import Flank
from gearpoly.mesh.shafts import Shafts, runs_up, swings_along
from gearpoly.mesh.swings import SWINGS_PER_MESH, swings_at
from gearpoly.physics import catalogue
from gearpoly.scene import stage
from gearpoly.simulate import simulate
from gearpoly.units import NM, RPM, UM, FloatArray
from tests.pair_files import made, pair_file
from tests.physics_cases import Condition, rough, samples_at, scope_of

FLANKS: tuple[Flank, ...] = ("drive", "coast")


def settled(shafts: Shafts, orders: dict[int, complex], *, period: float, n: int) -> FloatArray:
    """Steady swing x of x'' + 2 D w (x' - e te') + w^2 (x - te) = 0 at n even times of one period, stepped in time; e
    is the part of the damping in the mesh.

    Each step of the classical Runge-Kutta rule is of fourth order; it starts from rest and runs until nothing of the
    start is left.
    """
    assert shafts.frequency is not None
    w, damping = 2.0 * math.pi * shafts.frequency, shafts.damping
    per = n * 64
    h = period / per

    def force(t: float) -> float:
        at = {k: c * np.exp(2j * math.pi * k * t / period) for k, c in orders.items()}
        faster = sum(float((2j * math.pi * k / period * c).real) for k, c in at.items())
        return w * w * sum(float(c.real) for c in at.values()) + 2.0 * shafts.in_mesh * damping * w * faster

    def rate(state: FloatArray, f: float) -> FloatArray:
        return np.array([state[1], f - w * w * state[0] - 2.0 * damping * w * state[1]])

    half = [force(0.5 * h * k) for k in range(2 * per)]
    state = np.zeros(2)
    out = np.zeros(n)
    for turn in range(math.ceil(18.0 / (damping * w * period)) + 1):
        for k in range(per):
            if k % 64 == 0:
                out[k // 64] = state[0]
            f = half[2 * k], half[2 * k + 1], half[(2 * k + 2) % (2 * per)]
            a = rate(state, f[0])
            b = rate(state + 0.5 * h * a, f[1])
            c = rate(state + 0.5 * h * b, f[1])
            d = rate(state + h * c, f[2])
            state = state + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        assert turn < 100
    return out


@pytest.mark.long
@pytest.mark.parametrize("in_mesh", [0.0, 0.6, 1.0])
def test_resonance_swings_as_its_equation_of_motion(in_mesh: float) -> None:
    """Below, near and above the natural frequency, in size and phase."""
    period, n = 0.1, 32
    orders = {1: 1.0 + 0.5j, 3: 0.4 - 0.2j, 5: 0.1j}
    t = np.arange(n) / n
    te = sum((c * np.exp(2j * np.pi * k * t)).real for k, c in orders.items())
    shafts = Shafts(frequency=32.0, damping=0.2, in_mesh=in_mesh)
    moving = settled(shafts, orders, period=period, n=n)
    # The start has died to e^-18 = 2e-8; the steps err by (w h)^4 = 1e-9.
    np.testing.assert_allclose(te + shafts.swings(np.asarray(te), period=period), moving, atol=1e-6)


def test_resonance_leaves_slow_things_alone_and_stops_fast_ones() -> None:
    shafts = Shafts(frequency=100.0, damping=0.07)
    gain = shafts.gain(np.array([0.0, 1.0, 100.0, 1e4]))
    assert gain[0] == 1.0
    assert abs(gain[1]) == pytest.approx(1.0, abs=2e-4)  # (f/f_n)^2
    assert gain[2] == pytest.approx(1.0 / (2j * 0.07), rel=1e-12)  # a quarter late, 1/(2 D) as large
    assert abs(gain[3]) < 1.1e-4
    assert np.all(gain[1:].imag < 0.0)  # the response is late
    np.testing.assert_array_equal(Shafts().swings(np.arange(8.0), period=1.0), 0.0)


@pytest.mark.long
@pytest.mark.parametrize("flank", FLANKS)
def test_resonance_through_the_simulation(flank: Flank) -> None:
    """The mesh harmonics of the simulated TE are those at rest times the gain at their frequencies."""
    speed, torque = 600.0, 15.0
    mesh = speed / 60.0 * 12
    resonance = {"frequency_hz": 1.6 * mesh, "damping_ratio": 0.06}
    swings, rests = made(pair_file((12, 12), pair={"resonance": resonance})), made(pair_file((12, 12)))
    # At the very places from which the swings are made, nothing is interpolated.
    n = 12 * SWINGS_PER_MESH
    theta = np.arange(n) * (rests.pair.cycle / n)
    runs = [
        simulate(
            one,
            theta,
            Under(flank=flank, torque=torque * NM, speed=s),
            seed=0,
            evenly=False,
            fast=True,
            progress=lambda *_: 0,
        )
        for one, s in ((rests, speed * RPM), (swings, speed * RPM), (swings, None))
    ]
    np.testing.assert_array_equal(runs[2].te, runs[0].te)  # no speed: quasi-static
    still, moving = (np.fft.rfft(run.te)[[12, 24, 36]] for run in runs[:2])
    k = np.array([1, 2, 3])
    gain = 1.0 / (1.0 - (k / 1.6) ** 2 + 2j * 0.06 * k / 1.6)
    np.testing.assert_allclose(moving, gain * still, rtol=1e-9)  # rounding of the transforms
    assert np.mean(runs[1].te) == pytest.approx(np.mean(runs[0].te), abs=1e-9 * float(np.ptp(runs[0].te)))


def test_cycle_te_is_the_mesh_alone() -> None:
    """Neither wind-up nor resonance are in what excites the resonance."""
    file = pair_file((12, 12), pair={"windup_urad_per_nm": 3.0, "resonance": {"frequency_hz": 100.0}})
    shaken, plain = made(file), made(pair_file((12, 12)))
    under = Under(flank="drive", torque=9.0 * NM)
    np.testing.assert_array_equal(shaken.under(under).cycle_te, plain.under(under).cycle_te)
    assert not shaken.shafts.rigid
    assert replace(shaken.shafts, windup=0.0, frequency=None).rigid


def settling(shafts: Shafts, te: np.ndarray, t: np.ndarray) -> np.ndarray:
    """The equation of motion from rest at the first value, by a general integrator."""
    assert shafts.frequency is not None
    w = 2.0 * np.pi * shafts.frequency
    slopes = np.diff(te) / np.diff(t)

    def rate(now: float, state: np.ndarray) -> tuple[float, float]:
        slope = slopes[min(int(np.searchsorted(t, now, side="right")), t.size - 1) - 1]
        braked = 2.0 * shafts.damping * w * (state[1] - shafts.in_mesh * slope)
        return state[1], w * w * (np.interp(now, t, te) - state[0]) - braked

    found = solve_ivp(rate, (t[0], t[-1]), (te[0], 0.0), t_eval=t, rtol=1e-9, atol=1e-12, max_step=t[1] - t[0])
    return np.asarray(found.y[0])


@pytest.mark.long
@pytest.mark.parametrize("in_mesh", [0.0, 0.7])
def test_what_a_resonance_adds_to_any_curve_is_its_equation_of_motion(in_mesh: float) -> None:
    rng = np.random.default_rng(4)
    t = np.arange(300) * 2e-4
    te = np.cumsum(rng.normal(0.0, 1.0, t.size))
    shafts = Shafts(frequency=180.0, damping=0.07, in_mesh=in_mesh)
    # The general integrator meets corners, at which its steps err by some 1e-6.
    np.testing.assert_allclose(te + shafts.follows(te, step=2e-4), settling(shafts, te, t), atol=5e-6)


@pytest.mark.slow
def test_changes_are_magnified_at_times_that_do_not_come_evenly() -> None:
    """Several at once, as the equation of motion has them; straight lines between samples miss (w dt)^2 / 8 of them
    twice, once for each grid: a thousandth."""
    rng = np.random.default_rng(5)
    t = np.arange(2000) * 1e-4 + rng.uniform(0.0, 4e-5, 2000)
    changes = np.column_stack([1.0 - np.cos(2.0 * np.pi * hz * (t - t[0])) for hz in (60.0, 150.0)])
    shafts = Shafts(frequency=180.0, damping=0.07, in_mesh=0.4)
    wanted = np.column_stack([settling(shafts, one, t) for one in changes.T])
    np.testing.assert_allclose(shafts.magnified(changes, time=t), wanted, atol=2e-3 * float(np.max(np.abs(wanted))))
    assert float(np.max(np.abs(wanted[:, 1]))) > 2.0 * float(np.max(changes[:, 1]))


@pytest.mark.parametrize("part", [0.4, 1.0, 1.7])
def test_a_run_up_at_one_speed_is_the_settled_swing(part: float) -> None:
    """Mesh orders 1 to 3 of 24 pitches below, at and above the natural frequency; the start has died to e^-6 of it."""
    pitch, rate = 2.0 * np.pi / 24, 3.0
    cycle, mesh = 24 * pitch, rate / pitch
    shafts = Shafts(frequency=mesh / part, damping=0.08)
    even = np.arange(24 * 128) * (cycle / (24 * 128))
    te = sum(np.cos(k * 2.0 * np.pi * even / pitch + k) / k**2 for k in (1, 2, 3))
    theta = np.linspace(0.3, 0.3 + 60 * pitch, 2400)
    here = sum(np.cos(k * 2.0 * np.pi * theta / pitch + k) / k**2 for k in (1, 2, 3))
    found = swings_along(shafts, te, cycle=cycle, pitch=pitch, theta_2=theta, time=theta / rate, here=here)
    settled = np.interp(theta, even, shafts.swings(te, period=cycle / rate), period=cycle)
    # Straight lines between 64 places of a pitch and 24 of a swing miss a fortieth of a per cent of the third order.
    np.testing.assert_allclose(found, settled, atol=0.02 * float(np.max(np.abs(settled))) + 2e-3)


def test_a_run_up_swings_most_where_the_mesh_passes_the_resonance() -> None:
    """From half to twice the natural frequency in 400 pitches; the largest swing comes late, as one that has to build
    up does, by no more than a few of its decay times (Lewis 1932)."""
    pitch = 2.0 * np.pi / 24
    time = np.linspace(0.0, 20.0, 60_000)
    hz = 10.0 + 1.5 * time  # of the mesh
    theta = pitch * (10.0 * time + 0.75 * time**2)
    shafts = Shafts(frequency=20.0, damping=0.05)
    even = np.arange(24 * 128) * (pitch / 128)
    te = np.cos(2.0 * np.pi * even / pitch)
    here = np.cos(2.0 * np.pi * theta / pitch)
    found = swings_along(shafts, te, cycle=24 * pitch, pitch=pitch, theta_2=theta, time=time, here=here)
    swing = np.abs(found + here)
    at = hz[int(np.argmax(swing))]
    decay = 1.0 / (2.0 * np.pi * 20.0 * 0.05)
    assert 20.0 < at < 20.0 + 4.0 * decay * 1.5 + 0.5
    assert 0.8 * 10.0 < float(np.max(swing)) <= 1.02 * 10.0  # 1/(2 D) were it to stay there
    assert runs_up(theta, time) is not None
    assert runs_up(theta, None) is None


@pytest.mark.parametrize(("wobble", "told"), [(0.0, False), (0.02, False), (0.2, True)])
def test_speed_that_wobbles_is_no_run_up(wobble: float, told: bool) -> None:
    time = np.linspace(0.0, 10.0, 20_000)
    theta = 30.0 * (time + wobble * (1.0 - np.cos(0.5 * time)))
    assert (runs_up(theta, time) is not None) is told
    assert (runs_up(-theta, time) is not None) is told


@pytest.mark.parametrize(("rpm", "several"), [((30.0, 30.03), False), ((30.0, 60.0), True)])
def test_one_speed_measured_twice_is_one_speed(rpm: tuple[float, float], several: bool) -> None:
    """Means of measured speeds differ in the third figure; a resonance is not met at another speed by that."""
    scope = scope_of(rough(), tuple(Condition(speed_rpm=speed) for speed in rpm))
    assert scope.several_speeds is several
    assert bool(list(catalogue()["mesh_resonance"].places(scope))) is several


@pytest.mark.long
@pytest.mark.parametrize(
    "part", [pytest.param(1.0, marks=pytest.mark.slow), 6.0, pytest.param(150.0, marks=pytest.mark.slow)]
)
def test_swings_at_samples_are_those_of_a_far_finer_curve(part: float) -> None:
    """Rough teeth hand over in bends between which no places lie. A resonance at 1 and 6 times the mesh frequency
    does not follow them, one at 150 times it follows them at once: 128 places a pitch come within 0.015 um of 512,
    where straight lines alone between the places of what it adds are off by twice that."""
    assembled = made(rough())
    pair, speed = assembled.pair, 300.0 * RPM
    shafts = Shafts(frequency=part * 60.0, damping=0.05)
    rng = np.random.default_rng(0)

    def te_at(theta_2: FloatArray) -> FloatArray:
        return stage(assembled, samples_at(assembled, theta_2, Condition(torque_nm=20.0), 0)).mesh_te

    theta_2 = np.sort(rng.uniform(0.0, pair.cycle, 1500))
    here, found, plain = te_at(theta_2), {}, {}
    for places in (128, 512):
        even = np.arange(pair.meshes_per_cycle * places) * (pair.cycle / (pair.meshes_per_cycle * places))
        curve = te_at(even)
        found[places] = swings_at(shafts, curve, pair, theta_2, here, speed=speed, time=None)
        added = shafts.swings(curve, period=pair.cycle / (speed * pair.ratio))
        plain[places] = np.interp(theta_2, even, added, period=pair.cycle)
    error, before = (float(np.std(one[128] - found[512])) for one in (found, plain))
    assert error < (0.015 if part < 100.0 else 0.05) * UM
    assert error < (0.6 if part < 100.0 else 1.05) * before


@pytest.mark.slow
def test_a_speed_that_wobbles_by_a_thousandth_is_followed() -> None:
    """Beside a resonance of gain 6 a speed that goes up and down by 0.5 % puts side bands beside the mesh order: a
    twentieth of what swings, which settled swings at the mean speed lack and the equation of motion has."""
    assembled = made(rough())
    pair, speed, shafts = assembled.pair, 300.0 * RPM, Shafts(frequency=62.0, damping=0.08)
    even = np.linspace(0.0, pair.cycle, pair.meshes_per_cycle * SWINGS_PER_MESH, endpoint=False)
    curve = stage(assembled, samples_at(assembled, even, Condition(torque_nm=20.0), 0)).mesh_te / pair.r_b2
    rate = speed * pair.ratio
    # Two turns of the driving shaft to one wobble.
    w, slow = 2.0 * math.pi * 62.0, 0.5 * speed

    def at(t: FloatArray) -> FloatArray:
        return rate * (t + 0.005 / slow * np.sin(slow * t))

    def te(t: FloatArray) -> FloatArray:
        return np.interp(at(t), even, curve, period=pair.cycle)

    def motion(t: float, x: FloatArray) -> list[float]:
        return [x[1], w * w * (float(te(np.array(t))) - x[0]) - 2.0 * 0.08 * w * x[1]]

    lasts = 3.0 * pair.cycle / rate
    times = np.linspace(0.3 * lasts, lasts, 4000)
    moved = solve_ivp(motion, (0.0, lasts), [0.0, 0.0], t_eval=times, max_step=4e-4, rtol=1e-7, atol=1e-12)
    expected = moved.y[0] - te(times)
    followed, settled_ = (
        swings_at(shafts, curve, pair, at(times), te(times), speed=speed, time=one) for one in (times, None)
    )
    later = times > 0.45 * lasts  # what it swung at the beginning has died away
    size = float(np.std(expected[later]))
    assert np.std((followed - expected)[later]) < 0.005 * size
    assert np.std((settled_ - expected)[later]) > 0.02 * size
