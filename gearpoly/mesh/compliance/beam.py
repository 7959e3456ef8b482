"""Where the load acts on a tooth, and the integrals over the sections below it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.compliance.outline import ToothSection
from gearpoly.units import FloatArray

RADIUS_TOLERANCE = 1e-9
"""Relative overshoot of the tip or base radius that is taken for rounding and pulled back.

Contact solvers place tip-corner contacts to about 1e-12; a real overshoot is a wrong caller and
must be heard.
"""

ELEMENTS = 100
"""Transverse elements between beam end and load, each with three Gauss points.

Doubling them changes compliances by less than 1e-5 (tested); the outline's own point spacing
matters as little.
"""

_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(3)


@dataclass(frozen=True, kw_only=True)
class LoadPoints:
    """Loads on the flanks of z teeth at k radii: all arrays (z, k), mm and rad.

    ``x``, ``y``: the point, along and across the centre line (y positive on either flank).
    ``beta``: angle of the load to the tooth's transverse axis, positive where the load presses
    towards the root. ``u``: where the line of load meets the centre line. ``depth``: how far that
    is from the flank, along the line of load.
    """

    x: FloatArray
    y: FloatArray
    beta: FloatArray
    u: FloatArray
    depth: FloatArray


@dataclass(frozen=True, kw_only=True)
class BeamIntegrals:
    """Integrals over the sections from ``start`` to the load, per unit face width, all (z, k).

    ``I_0``, ``I_1``, ``I_2``: of (x_load - x)^n / I in mm^(n-2), with I = h^3/12; ``A``: of 1/h, a
    number.
    """

    I_0: FloatArray
    I_1: FloatArray
    I_2: FloatArray
    A: FloatArray


def load_points(section: ToothSection, radius: npt.ArrayLike, flank: Literal["drive", "coast"]) -> LoadPoints:
    """The loads that act along the base tangent at ``radius`` (k,) mm of that flank.

    With the flank's half angle psi_y and pressure angle alpha_y the load is inclined by beta =
    alpha_y - psi_y. The base tangent is used and not the polyline's own normal: it is the line of
    action, and a deviation turns the normal by its slope only (1e-2 at most), which is second order
    in the compliance.

    Raises ``OutOfRangeError`` for radii off the flank. Derived here.
    """
    r_y = np.atleast_1d(np.asarray(radius, dtype=np.float64))
    low, high = max(section.r_b, section.r_f), section.r_a
    bad = ~((r_y >= low * (1.0 - RADIUS_TOLERANCE)) & (r_y <= high * (1.0 + RADIUS_TOLERANCE)))
    if r_y.ndim != 1 or bad.any():
        found = r_y[bad][0] if bad.any() else r_y.shape
        raise OutOfRangeError(
            f"load radius {found}: must be (k,), from {low:.6g} (base or root circle) to {high:.6g} mm (tip)"
        )
    r_y = np.clip(r_y, low, high)
    psi = section.psi_drive if flank == "drive" else section.psi_coast
    psi_y = np.array([np.interp(r_y, section.radius, row) for row in psi])
    beta = np.arccos(section.r_b / r_y) - psi_y
    x, y = r_y * np.cos(psi_y), r_y * np.sin(psi_y)
    return LoadPoints(x=x, y=y, beta=beta, u=x - y * np.tan(beta), depth=y / np.cos(beta))


def beam_integrals(
    section: ToothSection, *, start: FloatArray, stop: FloatArray, elements: int = ELEMENTS
) -> BeamIntegrals:
    """The integrals from ``start`` (z,) to ``stop`` (z, k), both positions along the centre line in
    mm.

    Raises ``OutOfRangeError`` where a load stands below the beam's end. Composite three-point Gauss
    quadrature; derived here.
    """
    length = stop - start[:, None]
    if (length < 0.0).any():
        tooth, at = np.argwhere(length < 0.0)[0]
        raise OutOfRangeError(
            f"tooth {tooth}: the load stands {stop[tooth, at]:.4g} mm up the centre line, "
            f"below the beam's end at {start[tooth]:.4g} mm"
        )
    # t runs from 0 at the beam's end to 1 at the load, the same for every load, so the arm is
    # length (1 - t).
    t = ((np.arange(elements)[:, None] + 0.5 * (1.0 + _GAUSS_X)) / elements).ravel()
    weight = np.tile(0.5 * _GAUSS_W / elements, elements)
    x = start[:, None, None] + length[:, :, None] * t
    h = np.array([np.interp(at, xs, hs) for at, xs, hs in zip(x, section.x, section.h, strict=True)])
    slender = 12.0 * weight / h**3
    arm = 1.0 - t
    return BeamIntegrals(
        I_0=length * slender.sum(axis=-1),
        I_1=length**2 * (slender @ arm),
        I_2=length**3 * (slender @ arm**2),
        A=length * (weight / h).sum(axis=-1),
    )
