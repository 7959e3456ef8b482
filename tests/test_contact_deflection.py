"""Flattening of two flanks at their contact: published formulas, Hertz's pressure, derivatives."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.compliance import ContactPair, contact_deflection

E, NU, B = 206e3, 0.3, 20.0

PAIR = ContactPair(b=B, E_1=E, E_2=E, rho_1=6.2, rho_2=8.6, depth_1=1.6, depth_2=1.6)


def test_palmgren_is_the_published_formula_and_not_linear() -> None:
    W = np.array([100.0, 1000.0, 5000.0])
    deflection, slope = contact_deflection(W, PAIR)
    np.testing.assert_allclose(deflection / W, 1.275 / (E**0.9 * B**0.8 * W**0.1), rtol=1e-12)
    ten, _ = contact_deflection(10.0 * W, PAIR)
    np.testing.assert_allclose(ten / deflection, 10.0**0.9, rtol=1e-12)
    mixed = ContactPair(b=B, E_1=E, E_2=E / 2.0)
    # E_12 of E and E/2 is 2 E/3.
    np.testing.assert_allclose(contact_deflection(W, mixed)[0] / deflection, 1.5**0.9, rtol=1e-12)
    np.testing.assert_allclose(slope, 0.9 * deflection / W, rtol=1e-12)


def test_palmgren_stands_at_0_55_of_the_roller_it_comes_from() -> None:
    """Palmgren's steel roller, 3.84e-5 W^0.9/b^0.8 mm, against the published E_12."""
    W = 5000.0
    ratio = float(contact_deflection(W, PAIR)[0]) / (3.84e-5 * W**0.9 / B**0.8)
    assert ratio == pytest.approx(0.55, abs=0.01)  # 3.84e-5 has three digits


@pytest.mark.parametrize("law", ["palmgren", "linear", "weber_banaschek"])
def test_contact_slope_is_the_derivative(law: str) -> None:
    W, step = np.array([50.0, 500.0, 5000.0]), 1e-3
    high, low = (contact_deflection(W + s, PAIR, law=law)[0] for s in (step, -step))
    # Central difference: truncation (step/W)^2 = 4e-10, rounding 1e-16 * 1e5.
    np.testing.assert_allclose((high - low) / (2.0 * step), contact_deflection(W, PAIR, law=law)[1], rtol=1e-8)
    assert float(contact_deflection(0.0, PAIR, law=law)[0]) == 0.0


def test_weber_contact_is_hertz_pressure_on_a_half_plane() -> None:
    W, d = 2000.0, 1.6
    deflection, _ = contact_deflection(W, PAIR, law="weber_banaschek")
    a = math.sqrt(8.0 * W * (1.0 - NU**2) / (math.pi * B * E * (1.0 / 6.2 + 1.0 / 8.6)))
    p_0 = 2.0 * W / (math.pi * a * B)
    z = np.linspace(0.0, d, 200001) / a
    root = np.sqrt(1.0 + z**2)
    sigma_z, sigma_x = -p_0 / root, -p_0 * ((1.0 + 2.0 * z**2) / root - 2.0 * z)
    strain = (1.0 - NU**2) / E * (sigma_z - NU / (1.0 - NU) * sigma_x)
    # The formula drops (a/d)^2/4; a/d is 0.03 here.
    assert float(deflection) == pytest.approx(-2.0 * float(np.trapezoid(strain, z * a)), rel=1e-3)


def test_bad_contact_is_refused() -> None:
    with pytest.raises(OutOfRangeError, match="pushes"):
        contact_deflection([10.0, -1.0], PAIR)
    with pytest.raises(OutOfRangeError, match="palmgren"):
        contact_deflection(1.0, PAIR, law="hertz")
    with pytest.raises(OutOfRangeError, match="rho_1"):
        contact_deflection(1.0, ContactPair(b=B, E_1=E, E_2=E), law="weber_banaschek")
    with pytest.raises(OutOfRangeError, match="face width"):
        ContactPair(b=0.0, E_1=E, E_2=E)
