"""The virtual bench against closed forms: tooth compliance, load, friction, cracks, and the measuring chain."""

from __future__ import annotations

from dataclasses import replace
from math import log, pi, radians, sqrt

import numpy as np
import pytest

from gearpoly.proving.chain import Chain, RecordedCondition, motion, noise, te
from gearpoly.proving.compliance import BENCH_LAWS, beam, compliance
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.flanks import ToothDeviations
from gearpoly.proving.gears import MM_PER_UM, FloatArray
from gearpoly.proving.rig import EncoderDeviation, Rig, ideal, mesh

PAIR = make_pair("18/25 m2")
Z_1, Z_2 = 18, 25
NM = 1e-6
"""mm per nm."""


def driven(n: int, turns: float = 18.0, start: float = 0.0137) -> FloatArray:
    return start + np.linspace(0, 2 * pi * turns, n, endpoint=False)


def with_p(rig: Rig, index: int, p: FloatArray) -> Rig:
    return rig.with_teeth(index, replace(rig.teeth(index), p=p))


def order(x: FloatArray, angle: FloatArray, k: float) -> complex:
    """Amplitude and phase of cos(k angle + phase) in x, by least squares with a mean."""
    A = np.stack([np.cos(k * angle), np.sin(k * angle), np.ones_like(angle)], axis=1)
    c, s, _ = np.linalg.lstsq(A, x, rcond=None)[0]
    return complex(c, -s)


def test_beam_against_the_uniform_cantilever() -> None:
    L, t, b, E, nu = 6.0, 3.0, 10.0, 206000.0, 0.3
    x = np.linspace(0, L, 2001)
    got = beam(x, np.full(x.size, t / 2), y_load=0.0, slant=0.0, b=b, E=E, nu=nu)
    bending, shear = L**3 / (3 * E * b * t**3 / 12), 1.2 * L / (E / (2 * (1 + nu)) * b * t)
    assert got == pytest.approx(bending + shear, rel=1e-6)  # trapezoid rule with 2000 steps


@pytest.mark.parametrize("law", BENCH_LAWS)
def test_stiffness_of_steel_teeth(law: str) -> None:
    c = compliance(PAIR, law=law)
    l_1, l_2 = PAIR.l_work(1), PAIR.l_work(2)
    stiffness = 1 / (c.single(l_1, l_2, 3000.0) * 20.0) / 1000  # N/(mm um)
    assert 12 < stiffness < 20  # ISO 6336-1 gives 14 with its correction 0.8, 17.5 without
    tip = np.interp(PAIR.driving.l_tip, c.l_1, c.c_1) / np.interp(PAIR.l_start(1), c.l_1, c.c_1)
    assert tip > 2  # a tooth is softest at its tip


def test_contact_laws_against_their_formulas() -> None:
    E, nu, b, F = 206000.0, 0.3, 20.0, 3000.0
    assert compliance(PAIR, law="sainsot").contact(F, 4.0) == pytest.approx(4 * (1 - nu**2) / (pi * E * b))
    # Palmgren's 3.84e-5 F^0.9 / L^0.8 (mm, N) for steel rollers, of which 1.275 / E^0.9 is the general form.
    assert compliance(PAIR, law="palmgren").contact(F, 4.0) * F == pytest.approx(3.84e-5 * F**0.9 / b**0.8, rel=0.5)
    got = compliance(PAIR, law="weber")
    # Twice the load on a line contact: the logarithm falls by ln 2.
    drop = 2 * (1 - nu**2) / (pi * E * b) * log(2)
    assert got.contact(F, 4.0) - got.contact(2 * F, 4.0) == pytest.approx(drop, rel=1e-9)


def test_load_on_a_single_pair_deflects_it_by_its_own_compliance() -> None:
    rig = replace(ideal(PAIR), deflect=True)
    at = np.array([0.0])  # the pitch point: one pair carries, all of the load
    torque = 60.0
    x = mesh(rig, at, torque=torque).x[0]
    force = torque * 1000 / PAIR.driven.r_b
    want = compliance(PAIR).single(PAIR.l_work(1), PAIR.l_work(2), force) * force
    assert -x == pytest.approx(want, rel=1e-3)  # the contact point moves by the deflection
    assert mesh(rig, at, torque=torque, flank="coast").x[0] > 0  # load makes the coast error more positive


def test_misalignment_by_the_two_branches() -> None:
    g, at = 10.0, np.array([0.0])
    base = replace(ideal(PAIR), deflect=True, lead=g)
    c = compliance(PAIR).single(PAIR.l_work(1), PAIR.l_work(2), 1.0)
    for torque in (20.0, 200.0):
        F = torque * 1000 / PAIR.driven.r_b
        want = sqrt(2 * F * g * MM_PER_UM * c) if F * c < g * MM_PER_UM / 2 else F * c + g * MM_PER_UM / 2
        assert -mesh(base, at, torque=torque).x[0] == pytest.approx(want, rel=2e-3)  # as above


def test_friction_lowers_approach_and_raises_recess() -> None:
    rig = replace(ideal(PAIR), deflect=True)
    theta_2 = np.array([-0.02, 0.02])  # just before and after tooth 0's pitch point, one pair
    mu, torque = 0.08, 60.0
    dry, bare = (mesh(replace(rig, friction=f), theta_2, torque=torque) for f in (mu, 0.0))
    for k, sign in ((0, -1.0), (1, 1.0)):
        rho_2 = PAIR.l_work(2) - PAIR.driven.r_b * theta_2[k]
        assert dry.x[k] / bare.x[k] == pytest.approx(1 / (1 + sign * mu * rho_2 / PAIR.driven.r_b), rel=2e-4)
    assert dry.x[0] < bare.x[0] < 0
    assert bare.x[1] < dry.x[1] < 0


def test_crack_softens_one_tooth_only() -> None:
    rig = replace(ideal(PAIR), deflect=True)
    cracked = rig.with_teeth(2, rig.teeth_2.softer(6, 1.5))
    theta_2 = driven(2500, turns=1, start=0.0)
    diff = mesh(cracked, theta_2, torque=60.0).x - mesh(rig, theta_2, torque=60.0).x
    where = theta_2[np.abs(diff) > 1e-3 * MM_PER_UM] / PAIR.driven.tau
    assert where.min() > 5
    assert where.max() < 7
    at = mesh(cracked, np.array([6 * PAIR.driven.tau]), torque=60.0).x[0]
    c = compliance(PAIR)
    own = np.interp(PAIR.l_work(2), c.l_2, c.c_2)
    more = at - mesh(rig, np.array([6 * PAIR.driven.tau]), torque=60.0).x[0]
    assert -more == pytest.approx(0.5 * own * 60000 / PAIR.driven.r_b, rel=2e-3)  # half its own compliance more


def test_undulation_is_a_wave_of_its_order() -> None:
    teeth = replace(ToothDeviations.ideal(Z_2), waves=((61, 0.4, 0.3, 1.0),))
    theta_2 = driven(8000, turns=2)
    x = mesh(ideal(PAIR).with_teeth(2, teeth), theta_2, torque=0.0).x / MM_PER_UM
    assert 0.3 < abs(order(x, theta_2, 61)) < 0.4  # the leading of two pairs cuts into it


def test_wind_up_and_encoders_add_what_they_should() -> None:
    rig = ideal(PAIR)
    condition = RecordedCondition(torque=10.0, turns=4)
    path = motion(rig, condition, np.random.default_rng(1))
    wound = te(replace(rig, windup=0.5), condition, path)
    assert np.allclose(wound, -PAIR.driven.r_b * 5e-6, atol=1e-9)  # 0.5 urad/(N.m) at 10 N.m
    off = te(replace(rig, encoder_1=EncoderDeviation(eccentricity_urad=50.0, angle_deg=30.0)), condition, path)
    theta_1 = path.theta_2 * Z_2 / Z_1
    assert np.allclose(off, -PAIR.driving.r_b * 50e-6 * np.sin(theta_1 - radians(30)), atol=1e-9)
    lines = te(replace(rig, encoder_2=EncoderDeviation(interp_urad=2.0, interp_order=1024)), condition, path)
    assert np.allclose(lines, PAIR.driven.r_b * 2e-6 * np.cos(1024 * path.theta_2), atol=1e-9)
    hum = te(replace(rig, extras=(Disturbance(kind="hum", amplitude=0.7, hz=50.0),)), condition, path)
    assert np.allclose(hum, 0.7 * MM_PER_UM * np.cos(2 * pi * 50 * path.time), atol=1e-9)
    warm = te(replace(rig, drift=3.0), condition, path)
    assert warm[-1] - warm[0] == pytest.approx(3 * MM_PER_UM, rel=0.02)  # the samples end one interval early


@pytest.mark.long
@pytest.mark.parametrize("f_n", [60.0, 200.0, 700.0])
def test_resonance_has_the_gain_of_one_degree_of_freedom(f_n: float) -> None:
    rig = ideal(PAIR)
    rig = rig.with_teeth(1, replace(rig.teeth_1, slope=np.full(Z_1, 3.0)))
    condition = RecordedCondition(torque=0.0, speed=120.0, turns=40, per_mesh=40, wobble=0.0, uneven=0.0)
    path = motion(rig, condition, np.random.default_rng(2))
    f, zeta = 120 / 60 * Z_1, 0.05
    still, moved = te(rig, condition, path), te(replace(rig, resonance=(f_n, zeta)), condition, path)
    late = path.time > 4
    rings, forces = (
        [order(x[late], path.theta_2[late], harmonic * Z_2) for harmonic in (1, 2, 3)] for x in (moved, still)
    )
    for harmonic, (ring, force) in enumerate(zip(rings, forces, strict=True), start=1):
        r = harmonic * f / f_n
        gain = 1 / complex(1 - r * r, 2 * zeta * r)
        # The force's steps are rounded by a hundredth of a pitch, and 40 samples a mesh, a fortieth, fold its upper
        # harmonics down.
        assert abs(ring - gain * force) < 0.025 * abs(gain * forces[0])


def test_noise_has_the_stated_level_and_colour() -> None:
    x = noise(Chain(noise_um=0.7, colour=0.6), 200_000, np.random.default_rng(4)) / MM_PER_UM
    assert x.std() == pytest.approx(0.7, rel=0.01)  # 200 000 samples, four times fewer independent ones
    assert np.corrcoef(x[1:], x[:-1])[0, 1] == pytest.approx(0.6, abs=0.01)
