"""The root as a rack cuts it, found by brute force: no trochoid, no involute, only the tool and its
roll.

The gear turns about the origin and the tool, a rack with a rounded tip, moves along the line y = r
(the reference radius), tip down. The tool's half width at height y is w(y). In the space's own
frame the tool removes, at radius q, every angle up to

    theta(q) = max over psi of  psi - (q sin(psi) - w(q cos(psi))) / r

where psi is where the point stands when the tool's right edge passes it: each psi is one position
of the tool. This module shares nothing with gearpoly: plain numbers in, angles out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

POSITIONS = 801
"""Tool positions in the first sweep of each radius. The function has one narrow peak for each part
of the tool (flank, round); where both come within 1 nm of each other, 801 positions may take the
lower one."""
ZOOMS = 4
"""Each zoom takes 41 positions between the neighbours of the best one: 20 times finer. Four bring
1e-3 of the range to 1e-8, and the maximum, flat there, to 1e-16."""


@dataclass(frozen=True, kw_only=True)
class Cut:
    """A gear to cut: teeth, module and shift, and the tool's pressure angle (rad), dedendum side
    and tip round (modules)."""

    z: int
    m: float
    x: float
    alpha: float
    h_aP: float
    h_fP: float
    rho_fP: float

    @property
    def r(self) -> float:
        return self.m * self.z / 2

    @property
    def r_tip(self) -> float:
        return self.r + (self.h_aP + self.x) * self.m

    @property
    def r_root(self) -> float:
        return self.r + (self.x - self.h_fP) * self.m

    def half_width(self, y: Floats) -> Floats:
        """Half width of the tool's tooth in mm at height ``y`` (mm) above the gear's axis; -inf
        below its tip."""
        depth = self.r + self.x * self.m - y
        tip, rho = self.h_fP * self.m, self.rho_fP * self.m
        flank = self.m * math.pi / 4 - depth * math.tan(self.alpha)
        # The round touches the flank where its radius is normal to it.
        middle = tip - rho
        centre = self.m * math.pi / 4 - middle * math.tan(self.alpha) - rho / math.cos(self.alpha)
        touch = middle + rho * math.sin(self.alpha)
        arc = centre + np.sqrt(np.maximum(0.0, rho**2 - (depth - middle) ** 2))
        width = np.where(depth <= touch, flank, arc)
        # 1e-12 mm: the tip itself, where the root circle is made, must not fall to rounding.
        return np.where(depth <= tip + 1e-12, width, -np.inf)


def half_space(cut: Cut, q: Floats) -> Floats:
    """Half the angle (n,) in rad that the tool removes at the radii ``q`` (n,) in mm, from the
    middle of the space."""
    reach = np.arccos(np.clip(cut.r_root / q, -1.0, 1.0))

    def removed(psi: Floats) -> Floats:
        height = q[:, None] * np.cos(psi)
        return psi - (q[:, None] * np.sin(psi) - cut.half_width(height)) / cut.r

    psi = reach[:, None] * np.linspace(-1.0, 1.0, POSITIONS)
    theta = removed(psi)
    for _ in range(ZOOMS):
        best = np.argmax(theta, axis=1)
        rows = np.arange(q.size)
        low = psi[rows, np.maximum(best - 1, 0)]
        high = psi[rows, np.minimum(best + 1, psi.shape[1] - 1)]
        psi = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, 41)
        theta = removed(psi)
    return np.max(theta, axis=1)


def half_tooth(cut: Cut, q: Floats) -> Floats:
    """Half the angle (n,) in rad of what is left of the tooth at the radii ``q`` (n,) in mm; below
    0 nothing is."""
    return math.pi / cut.z - half_space(cut, q)


def face(cut: Cut, *, n: int, top: float | None = None) -> Floats:
    """One side of the tooth in its own frame as points (n, 2) in mm, from just above the root
    circle to ``top`` (mm; the tip).

    Radii crowd towards the root circle, where the fillet runs along it.
    """
    top = cut.r_tip if top is None else top
    q = cut.r_root + (top - cut.r_root) * np.linspace(1.0 / n, 1.0, n) ** 2
    angle = half_tooth(cut, q)
    return np.stack((q * np.cos(angle), q * np.sin(angle)), axis=-1)


def can_be_cut(cut: Cut, *, n: int = 400) -> bool:
    """Whether the tool leaves a tooth of some thickness at every radius from root to tip."""
    if cut.r_root <= 0.0:
        return False
    q = np.linspace(cut.r_root + 1e-9 * cut.m, cut.r_tip, n)
    return bool(np.min(half_tooth(cut, q)) > 0.0)
