"""Where the load acts on a tooth, and the integrals over the sections below it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.compliance.outline import ToothSection
from gearpoly.mesh.compliance.rows import interpolated
from gearpoly.units import FloatArray

RADIUS_TOLERANCE = 1e-9
"""Relative overshoot of the tip or base radius that is taken for rounding and pulled back.

Contact solvers place tip-corner contacts to about 1e-12; a real overshoot is a wrong caller and
must be heard.
"""

ELEMENTS = 200
"""Transverse elements between beam end and the highest load, each with three Gauss points; loads
stand between elements.

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
    psi_y = interpolated(
        np.broadcast_to(r_y, (psi.shape[0], r_y.size)), np.broadcast_to(section.radius, psi.shape), psi
    )
    beta = np.arccos(section.r_b / r_y) - psi_y
    x, y = r_y * np.cos(psi_y), r_y * np.sin(psi_y)
    return LoadPoints(x=x, y=y, beta=beta, u=x - y * np.tan(beta), depth=y / np.cos(beta))


def beam_integrals(
    section: ToothSection, *, start: FloatArray, stop: FloatArray, elements: int = ELEMENTS
) -> BeamIntegrals:
    """The integrals from ``start`` (z,) to ``stop`` (z, k), both positions along the centre line in
    mm.

    Raises ``OutOfRangeError`` where a load stands below the beam's end. Composite three-point Gauss
    quadrature, once along each tooth: going up by d from a load with integrals I_n adds d I_0 to
    I_1 and 2 d I_1 + d^2 I_0 to I_2, and what the sections between add by themselves. All summands
    are positive, so nothing cancels. Derived here.
    """
    low = stop < start[:, None]
    if low.any():
        tooth, at = np.argwhere(low)[0]
        raise OutOfRangeError(
            f"tooth {tooth}: the load stands {stop[tooth, at]:.4g} mm up the centre line, "
            f"below the beam's end at {start[tooth]:.4g} mm"
        )
    order = np.argsort(stop, axis=1)
    rise = np.diff(np.take_along_axis(stop, order, axis=1), axis=1, prepend=start[:, None])
    whole = np.maximum(rise.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    # Elements of each rise: as many for all teeth, and no longer than the whole over ``elements``.
    count = np.maximum(1, np.ceil(elements * np.max(rise / whole, axis=0)).astype(np.int64))
    first = np.concatenate(([0], np.cumsum(count)[:-1]))
    of, part = np.repeat(np.arange(count.size), count), 1.0 / np.repeat(count, count)
    # t runs from 0 at the beginning of a rise to 1 at its load.
    t = (((np.arange(of.size) - first[of]) * part)[:, None] + part[:, None] * 0.5 * (1.0 + _GAUSS_X)).ravel()
    weight = (part[:, None] * 0.5 * _GAUSS_W).ravel()
    of, first = np.repeat(of, _GAUSS_X.size), first * _GAUSS_X.size
    x = (start[:, None] + np.cumsum(rise, axis=1) - rise)[:, of] + rise[:, of] * t
    h = interpolated(x, section.x, section.h)
    slender, arm = 12.0 * weight / h**3, 1.0 - t

    def over_rises(summands: FloatArray, power: int) -> FloatArray:
        return np.asarray(np.add.reduceat(summands, first, axis=1) * rise**power)

    I_0 = np.cumsum(over_rises(slender, 1), axis=1)
    under = np.pad(I_0[:, :-1], ((0, 0), (1, 0)))
    I_1 = np.cumsum(over_rises(slender * arm, 2) + rise * under, axis=1)
    below = np.pad(I_1[:, :-1], ((0, 0), (1, 0)))
    I_2 = np.cumsum(over_rises(slender * arm**2, 3) + 2.0 * rise * below + rise**2 * under, axis=1)
    A = np.cumsum(over_rises(weight / h, 1), axis=1)
    back = np.argsort(order, axis=1)
    I_0, I_1, I_2, A = (np.take_along_axis(one, back, axis=1) for one in (I_0, I_1, I_2, A))
    return BeamIntegrals(I_0=I_0, I_1=I_1, I_2=I_2, A=A)
