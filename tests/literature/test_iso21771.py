"""Numbers of a single gear against published ones: involute function, base tangent length, contact
ratio."""

from __future__ import annotations

import math

import pytest

from gearpoly.gear.gear import Gear, inv, inv_inverse
from gearpoly.units import DEG

# Seven decimals as involute tables print them.
INVOLUTE = [
    (10.0, 0.0017941),
    (14.5, 0.0055448),
    (20.0, 0.0149044),
    (22.5, 0.0215145),
    (25.0, 0.0299753),
    (30.0, 0.0537515),
    (45.0, 0.2146018),
]

# Base tangent length for m = 1 mm, 20 deg, x = 0 as design handbooks tabulate it: z, k, W_k in mm.
BASE_TANGENT = [
    (17, 2, 4.6663),
    (19, 3, 7.6464),
    (20, 3, 7.6604),
    (25, 3, 7.7305),
    (40, 5, 13.8448),
]


@pytest.mark.parametrize(("degrees", "value"), INVOLUTE)
def test_involute_function(degrees: float, value: float) -> None:
    assert inv(degrees * DEG) == pytest.approx(value, abs=0.5e-7)  # the table's last digit


@pytest.mark.parametrize("degrees", [0.01, 1.0, 14.5, 20.0, 30.0, 45.0, 70.0, 88.0])
def test_inverse_of_the_involute_function(degrees: float) -> None:
    # inv is flat near 0: an error of 1e-16 in its value is 1e-16/tan^2 in the angle.
    loss = 1e-15 / math.tan(degrees * DEG) ** 2
    angle = inv_inverse(inv(degrees * DEG))
    assert angle == pytest.approx(degrees * DEG, rel=1e-13, abs=loss)


def test_working_pressure_angle_of_a_shifted_pair() -> None:
    # KHK, Gear Technical Reference: m 3, z 12/24, x 0.6/0.36: 26.0886 deg, a = 56.4999 mm.
    value = 2.0 * math.tan(20.0 * DEG) * 0.96 / 36.0 + inv(20.0 * DEG)
    alpha_w = inv_inverse(value)
    assert value == pytest.approx(0.034316, abs=0.5e-6)
    assert alpha_w / DEG == pytest.approx(26.0886, abs=0.5e-4)
    a = (Gear(z=12, m=3.0, x=0.6).r_b + Gear(z=24, m=3.0, x=0.36).r_b) / math.cos(alpha_w)
    assert a == pytest.approx(56.4999, abs=0.5e-4)


@pytest.mark.parametrize(("z", "k", "W_k"), BASE_TANGENT)
def test_base_tangent_length_of_standard_gears(z: int, k: int, W_k: float) -> None:
    gear = Gear(z=z, m=1.0)
    assert gear.k_span == k
    assert gear.W_k == pytest.approx(W_k, abs=0.6e-4)  # four decimals, last digit of either rounding
    assert Gear(z=z, m=2.5).W_k == pytest.approx(2.5 * gear.W_k, rel=1e-14)


def test_base_tangent_length_of_a_shifted_gear() -> None:
    # KHK, Gear Technical Reference, span measurement: m 3, z 24, x 0.4: k 4, W 32.8266 mm.
    gear = Gear(z=24, m=3.0, x=0.4)
    assert gear.k_span == 4
    assert gear.W_k == pytest.approx(32.8266, abs=0.5e-4)


@pytest.mark.parametrize("z", [9, 12, 18, 27, 36, 50, 100, 101, 200])
def test_base_tangent_touches_both_flanks(z: int) -> None:
    # Contact lies at roll length W_k/2: above the root's form circle by far, below the tip.
    gear = Gear(z=z, m=1.0)
    assert gear.W_k / 2 < gear.l_a
    # And near the middle of the flank: rounding k moves it by a quarter of p_b on either side.
    assert abs(gear.W_k / 2 - gear.l_pitch) < 0.51 * 0.5 * gear.p_b


def test_one_tooth_more_is_one_base_pitch_more() -> None:
    # ISO 21771: W_k rises by p_b with k and by m cos(alpha) inv(alpha) with z.
    gear, next_one = Gear(z=19, m=2.0), Gear(z=20, m=2.0)
    step = 2.0 * math.cos(20.0 * DEG) * inv(20.0 * DEG)
    assert gear.k_span == next_one.k_span
    assert next_one.W_k - gear.W_k == pytest.approx(step, rel=1e-12)
    assert gear.p_b == pytest.approx(5.9043, abs=0.5e-4)  # pi 2 cos(20 deg)


def test_contact_ratio_of_the_research_pair() -> None:
    # Liu et al. 2020: 1.5707; six decimals from the closed form.
    driving, driven = Gear(z=18, m=2.0), Gear(z=25, m=2.0)
    a = driving.r + driven.r
    path = driving.l_a + driven.l_a - a * math.sin(driving.alpha)
    assert path / driving.p_b == pytest.approx(1.570708, abs=0.5e-6)


def test_tooth_comes_to_a_point_where_thickness_is_gone() -> None:
    # z 12, x 0: inv(alpha) + pi/(2 z) = inv(alpha_s), thickness along any circle is 2 r_y psi.
    gear = Gear(z=12, m=1.0)
    alpha_s = inv_inverse(inv(20.0 * DEG) + math.pi / 24.0)
    assert gear.psi(gear.r_b / math.cos(alpha_s)) == pytest.approx(0.0, abs=1e-15)
    assert 2.0 * gear.r * gear.psi(gear.r) == pytest.approx(math.pi / 2.0, rel=1e-14)
