"""Numbers of a single gear against published ones: involute function, base tangent length, contact
ratio."""

from __future__ import annotations

import math

import pytest

from gearpoly.gear.gear import Gear, inv, inv_inverse
from gearpoly.gear.metrology import thickness_from_pins, thickness_from_span
from gearpoly.keys.sizes import addendum_of, dedendum_of, module_of, profile_shift_of
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


def test_size_over_pins_of_a_standard_gear() -> None:
    # KHK, Gear Technical Reference, over pins measurement of spur gears: m 1, z 20, x 0, pins of 1.7: inv 0.0268197,
    # 24.1350 deg, M = 22.2941.
    gear = Gear(z=20, m=1.0)
    phi = inv_inverse(1.7 / (2.0 * gear.r_b) - math.pi / 40.0 + inv(gear.alpha))
    assert phi / DEG == pytest.approx(24.1350, abs=1e-4)
    assert 2.0 * gear.r_b / math.cos(phi) + 1.7 == pytest.approx(22.2941, abs=0.5e-4)
    # E_s of the printed size is none; a size of 0.1 um is 0.13 um of thickness here, and it is printed to 0.1 um.
    assert thickness_from_pins(gear, 22.2941, D=1.7) == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("z", [17, 20, 35])
@pytest.mark.parametrize("x", [-0.1, 0.0, 0.4])
def test_span_and_pins_by_their_closed_forms(z: int, x: float) -> None:
    # W_k = m cos(alpha) ((k - 1/2) pi + z inv alpha) + 2 x m sin(alpha); d_K = d_b / cos(alpha_K) with inv(alpha_K) =
    # D / d_b - pi / (2 z) + inv alpha + 2 x tan(alpha) / z, odd z times cos(90 deg / z). Thin teeth by E_s add E_s / d.
    m, alpha, D, E_s = 2.0, 20.0 * DEG, 3.5, -0.05
    gear = Gear(z=z, m=m, x=x)
    k = gear.k_span
    W = m * math.cos(alpha) * ((k - 0.5) * math.pi + z * inv(alpha)) + 2.0 * x * m * math.sin(alpha)
    assert gear.W_k == pytest.approx(W, abs=1e-12)
    assert thickness_from_span(gear, W + E_s * math.cos(alpha), k=k) == pytest.approx(E_s, abs=1e-12)
    d_b = z * m * math.cos(alpha)
    alpha_K = inv_inverse(D / d_b - math.pi / (2 * z) + inv(alpha) + 2.0 * x * math.tan(alpha) / z + E_s / (z * m))
    M = d_b / math.cos(alpha_K) * (1.0 if z % 2 == 0 else math.cos(0.5 * math.pi / z)) + D
    assert thickness_from_pins(gear, M, D=D) == pytest.approx(E_s, abs=1e-12)


@pytest.mark.parametrize(("P_d", "m"), [(1, 25.4), (8, 3.175), (10, 2.54), (12, 2.11667), (20, 1.27), (64, 0.39688)])
def test_module_of_a_diametral_pitch(P_d: float, m: float) -> None:
    # 25.4 mm to the inch, as tables of modules beside diametral pitches print it.
    assert module_of(P_d) == pytest.approx(m, abs=0.51e-5)


def test_profile_shift_addendum_and_dedendum_from_diameters() -> None:
    # KHK, Gear Technical Reference, profile shifted spur gear: m 3, z 12, x 0.6: the tip is 2 (1 + x) m above the
    # reference circle but for the shortening, which an addendum from the diameter holds.
    gear = Gear(z=12, m=3.0, x=0.6)
    assert profile_shift_of(2.0 * gear.r_a, z=12, m=3.0, h_aP=1.0) == pytest.approx(0.6, abs=1e-12)
    assert addendum_of(2.0 * gear.r_a, z=12, m=3.0, x=0.6) == pytest.approx(1.0, abs=1e-12)
    assert dedendum_of(2.0 * gear.r_f, z=12, m=3.0, x=0.6) == pytest.approx(1.25, abs=1e-12)
    # d_a 44.840, from the same page: shortened by y = 0.8333 against x_1 + x_2 = 0.96.
    assert addendum_of(44.840, z=12, m=3.0, x=0.6) == pytest.approx(1.0 + 0.8333 - 0.96, abs=1e-4)
