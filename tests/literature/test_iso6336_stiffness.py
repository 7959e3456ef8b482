"""ISO 6336-1:2006, 9.3, and printed numbers of the other laws."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import gearpoly
from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.compliance import (
    ContactPair,
    Mate,
    contact_deflection,
    load_points,
    tooth_compliance,
    tooth_section,
)
from gearpoly.mesh.compliance.iso6336 import C_M, single_stiffness
from gearpoly.mesh.compliance.potential_energy import ring_coefficients
from gearpoly.mesh.deflection import Elasticity, pair_compliance
from tests.oracles.fem_tooth import rack_tooth

E, NU, B = 206000.0, 0.3, 20.0


def pair_stiffness(law: str, line_load: float, contact: str = "palmgren") -> float:
    """18/25, m 2, b 20: one pair at the pitch point, N/(mm um), secant at ``line_load`` N/mm."""
    W = line_load * B
    total, depth = 0.0, {}
    for z in (18, 25):
        tooth = rack_tooth(z, 2.0)
        section = tooth_section(
            radius=tooth.radius,
            drive=tooth.psi,
            coast=-tooth.psi,
            base_radius=tooth.r_b,
            reference_radius=tooth.r,
            bore_radius=10.0,
            teeth=z,
            mate=Mate(teeth=43 - z, profile_shift=0.0, dedendum=1.25),
        )
        q = tooth_compliance(section, radius=[tooth.r], face_width=B, youngs_modulus=E, poisson_ratio=NU, law=law)
        total += float(q[0])
        depth[z] = float(load_points(section, [tooth.r], "drive").depth[0, 0])
    sine = math.sin(math.radians(20.0))
    flanks = ContactPair(
        b=B,
        E_1=E,
        E_2=E,
        rho_1=18.0 * sine,
        rho_2=25.0 * sine,
        depth_1=depth[18],
        depth_2=depth[25],
    )
    total += 0.0 if law == "iso6336" else float(contact_deflection(W, flanks, law=contact)[0]) / W
    return 1e-3 / (B * total)


def test_single_stiffness_of_18_25() -> None:
    q = 0.04723 + 0.15551 / 18 + 0.25791 / 25
    assert 1.0 / q == pytest.approx(15.11, abs=0.005)  # two decimals, as worked by hand
    # C_B of the 1.25 rack is 0.975.
    assert single_stiffness(z_1=18, z_2=25) == pytest.approx(14.73, abs=0.005)
    assert single_stiffness(z_1=18, z_2=25, correction=C_M) == pytest.approx(0.8 * 14.73, abs=0.005)
    assert single_stiffness(z_1=18, z_2=25, E=E / 2) == pytest.approx(14.73 / 2, abs=0.005)
    # Stub depth 1.2 and 20 degrees make C_B one.
    assert single_stiffness(z_1=18, z_2=25, h_fP=1.2) == pytest.approx(1.0 / q, rel=1e-12)


def test_single_stiffness_with_profile_shift() -> None:
    # All nine terms, worked by hand for 20/30, x = 0.3 and 0.1.
    q = 0.04723 + 0.0077755 + 0.008597 - 0.001905 - 0.0017481 - 0.000193 - 0.00080627 + 0.0004761 + 0.0000182
    assert single_stiffness(z_1=20, z_2=30, x_1=0.3, x_2=0.1, h_fP=1.2) == pytest.approx(1.0 / q, rel=1e-5)


def q_of_nine_terms(z: tuple[int, int], x: tuple[float, float]) -> float:
    """q' in mm um/N with the nine constants of ISO 6336-1:2006, Table 9, as a scalar product."""
    constants = (0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182)
    terms = (1.0, 1 / z[0], 1 / z[1], x[0], x[0] / z[0], x[1], x[1] / z[1], x[0] ** 2, x[1] ** 2)
    return sum(c * term for c, term in zip(constants, terms, strict=True))


PAIRS = [((19, 60), (0.3, -0.3)), ((19, 104), (0.5, 0.15)), ((12, 120), (0.5, 0.0)), ((17, 200), (0.0, 0.0))]


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize(("z", "x"), PAIRS)
def test_a_pair_from_a_file_has_the_standards_stiffness(
    z: tuple[int, int], x: tuple[float, float], swapped: bool
) -> None:
    """Whichever gear drives: both teeth of a simulated pair add up to 1/c'_th, C_B = 0.975 for the 1.25 rack."""
    order = (1, 0) if swapped else (0, 1)
    sides = {
        name: {"teeth": z[k], "module_mm": 2.0, "profile_shift": x[k], "face_width_mm": B, "chord_error_um": 1.0}
        for name, k in zip(("driving", "driven"), order, strict=True)
    }
    pair = gearpoly.Pair.of(sides).mesh
    by = pair_compliance(pair, Elasticity(law="iso6336"))
    both = by.softest() * B * 1e3  # mm um/N
    assert both == pytest.approx(q_of_nine_terms(z, x) / 0.975, rel=1e-12)  # rounding


def test_the_standards_value_of_19_60() -> None:
    assert q_of_nine_terms((19, 60), (0.3, -0.3)) == pytest.approx(0.0584, abs=5e-5)  # printed digits
    assert single_stiffness(z_1=19, z_2=60, x_1=0.3, x_2=-0.3, h_fP=1.2) == pytest.approx(17.12, abs=5e-3)


def test_profile_shifts_outside_the_fit_are_named_by_gear() -> None:
    sides = {
        name: {"teeth": z, "module_mm": 2.0, "profile_shift": x, "face_width_mm": B, "chord_error_um": 1.0}
        for name, z, x in (("driving", 60, 0.3), ("driven", 19, -0.3))
    }
    with pytest.raises(OutOfRangeError, match=r"profile_shift -0\.3 of the pinion and 0\.3 of the wheel"):
        pair_compliance(gearpoly.Pair.of(sides).mesh, Elasticity(law="iso6336"))


@pytest.mark.parametrize("wrong", [{"z_1": 26}, {"x_1": -0.1}, {"x_1": 1.5, "x_2": 1.0}, {"x_1": -0.3, "x_2": -0.3}])
def test_outside_the_fit(wrong: dict[str, Any]) -> None:
    with pytest.raises(OutOfRangeError):
        single_stiffness(**({"z_1": 18, "z_2": 25} | wrong))


@pytest.mark.parametrize(
    "law", ["cantilever", "cantilever_published", "weber_banaschek", "potential_energy", "iso6336"]
)
@pytest.mark.parametrize("line_load", [200.0, 300.0])
def test_pair_at_the_pitch_point_within_20_per_cent(law: str, line_load: float) -> None:
    # 20 % is a sanity band: the standard's own fit leaves out contact point, load and body.
    assert pair_stiffness(law, line_load) == pytest.approx(14.7, rel=0.20)


def test_weber_banaschek_with_its_own_contact() -> None:
    # Its contact is softer than Palmgren's as published, its tooth stiffer than the cantilever:
    # same band.
    assert pair_stiffness("weber_banaschek", 250.0, "weber_banaschek") == pytest.approx(14.7, rel=0.20)


def test_linear_contact_is_too_stiff() -> None:
    """4(1-nu^2)/(pi E b) is a third of Palmgren's at 250 N/mm: the pair leaves the band."""
    assert pair_stiffness("weber_banaschek", 250.0, "linear") > 1.2 * 14.7


def test_stiffness_is_nearly_constant_above_100_n_per_mm() -> None:
    # ISO 6336-1 takes c' as constant there; Palmgren's tenth power on a quarter of the compliance
    # is 3 % from 100 to 300.
    stiffness = [pair_stiffness("cantilever", w) for w in (100.0, 200.0, 300.0)]
    assert stiffness[0] < stiffness[1] < stiffness[2] < 1.04 * stiffness[0]


def test_weber_banaschek_printed_numbers() -> None:
    """The printed numbers are the general form at nu = 0.3, to their digits."""
    strain = 1.0 - NU**2
    assert 12.0 * strain == pytest.approx(10.92, abs=0.005)
    shear = 2.4 * (1.0 + NU)
    assert shear == pytest.approx(3.1, abs=0.05)
    assert strain / shear == pytest.approx(0.294, abs=0.003)  # 0.2917; the print divides by 3.1
    assert strain * 18.0 / math.pi == pytest.approx(5.2, abs=0.05)
    assert strain * 2.0 * (1.0 - 2.0 * NU) / (1.0 - NU) == pytest.approx(1.0, abs=0.05)
    assert strain * 4.8 / math.pi == pytest.approx(1.4, abs=0.05)


def test_weber_banaschek_law_is_the_printed_formula() -> None:
    tooth = rack_tooth(18, 2.0, points=2000)
    section = tooth_section(
        radius=tooth.radius,
        drive=tooth.psi,
        coast=-tooth.psi,
        base_radius=tooth.r_b,
        reference_radius=tooth.r,
    )
    load = load_points(section, [tooth.r], "drive")
    u, tan2 = float(load.u[0, 0] - section.x_f[0]), math.tan(float(load.beta[0, 0])) ** 2
    y = np.linspace(0.0, u, 20001)
    h = np.interp(y + section.x_f[0], section.x[0], section.h[0])
    tooth_part = 10.92 * np.trapezoid((u - y) ** 2 / h**3, y) + 3.1 * (1.0 + 0.294 * tan2) * np.trapezoid(1.0 / h, y)
    arm = u / float(section.h_f[0])
    printed = (tooth_part + 5.2 * arm**2 + arm + 1.4 * (1.0 + 0.294 * tan2)) / (1.0 + tan2)
    q = tooth_compliance(
        section,
        radius=[tooth.r],
        face_width=B,
        youngs_modulus=E,
        poisson_ratio=NU,
        law="weber_banaschek",
    )
    assert float(q[0]) * B * E == pytest.approx(float(printed), rel=0.01)  # two printed digits: 1.04 stands as 1


def test_sainsot_polynomials_reach_the_printed_extremes() -> None:
    """The paper names the span of each function: L* 6.82-6.94, M* 1.08-3.29, P* 2.56-13.47, Q*
    0.141-0.62.

    The spans are of the ring's own values, the polynomials are a fit to them; a wrong digit in a
    leading coefficient moves an extreme by far more than the tolerances. Below 0.015 rad the
    polynomials leave the spans at once (M* 5.0 at 0.01 rad).
    """
    h, theta = np.meshgrid(np.linspace(1.4, 7.0, 57), np.linspace(0.015, 0.12, 43))
    stars = np.array([ring_coefficients(float(v), np.array(t)) for v, t in zip(h.ravel(), theta.ravel(), strict=True)])
    L, M, P, Q = stars.T
    assert L.max() == pytest.approx(6.94, rel=0.002)  # third digit
    assert L.min() == pytest.approx(6.82, rel=0.01)  # fit
    assert P.max() == pytest.approx(13.47, rel=0.004)  # fourth digit
    assert Q.min() == pytest.approx(0.141, rel=0.01)  # third digit
    assert M.min() == pytest.approx(1.08, rel=0.10)
    assert M.max() == pytest.approx(3.29, rel=0.15)
    assert P.min() == pytest.approx(2.56, rel=0.20)
    assert Q.max() == pytest.approx(0.62, rel=0.20)
