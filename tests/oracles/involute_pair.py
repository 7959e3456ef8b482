"""Test faces and transmission errors of involute pairs, straight from the formulas.

A second, independent construction of the canonical geometry, for x = 0 and s = pi m / 2, so that
the contact judge can be tested without the package, and the package against both. Derived here.

Driving axis at the origin, driven at (a, 0). The string of length L from base point angle `theta`
draws the drive flank: point = r_b e(theta) + L e(theta + 90 deg), theta = psi_b - l / r_b, L = l +
d(l), d normal and positive for more material. The drive flank's pitch point of driving tooth n
stands at polar angle -n tau_1, of driven tooth n at pi + n tau_2 about its own axis. mm and rad.
"""

# scipy ships no type information.
# mypy: disable-error-code="import-untyped"

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, minimize_scalar

FloatArray = npt.NDArray[np.float64]

ROOT_POINTS = 10  # points of the simple root below the involute, for both gears


def involute(angle: float) -> float:
    """inv(alpha) = tan(alpha) - alpha (ISO 21771)."""
    return math.tan(angle) - angle


@dataclass(frozen=True)
class InvoluteGear:
    """One gear with per-tooth drive-flank deviations, as a continuous curve.

    index and slope (z,) mm: d(l) = index + slope (u - 1/2) + wave sin(2 pi u), u from 0 at the
    involute's start to 1 at the tip. ecc (2,) mm: vector from the axis of rotation to the gear's
    own centre, at rotation 0 in the global directions. driven: teeth start at pi and run the other
    way.
    """

    z: int
    m: float
    alpha: float
    driven: bool
    index: FloatArray
    slope: FloatArray
    wave: float = 0.0
    ecc: tuple[float, float] = (0.0, 0.0)

    @property
    def r(self) -> float:
        """Reference radius."""
        return self.m * self.z / 2

    @property
    def r_b(self) -> float:
        """Base radius."""
        return self.r * math.cos(self.alpha)

    @property
    def r_a(self) -> float:
        """Tip radius, addendum 1."""
        return self.r + self.m

    @property
    def r_f(self) -> float:
        """Root radius, dedendum 1.25."""
        return self.r - 1.25 * self.m

    @property
    def l_tip(self) -> float:
        """String length at the tip."""
        return math.sqrt(self.r_a**2 - self.r_b**2)

    @property
    def l_start(self) -> float:
        """Where the involute begins: a little above the base circle, below any active profile."""
        return 0.02 * self.m

    def pitch_angle(self, tooth: int) -> float:
        """Polar angle of the tooth's drive-flank pitch point at rotation 0."""
        tau = 2 * math.pi / self.z
        return math.pi + tooth * tau if self.driven else -tooth * tau

    def deviation(self, tooth: int, l_y: FloatArray) -> FloatArray:
        """Normal deviation d(l), mm."""
        u = (l_y - self.l_start) / (self.l_tip - self.l_start)
        wave = self.wave * np.sin(2 * math.pi * u)
        out: FloatArray = self.index[tooth] + self.slope[tooth] * (u - 0.5) + wave
        return out

    def point(self, tooth: int, string: FloatArray) -> FloatArray:
        """Points (..., 2) of the deviated drive flank at string lengths L, mm."""
        string = np.asarray(string, dtype=np.float64)
        l_y = string
        for _ in range(60):  # contraction: |d'| is below 1e-2, so 60 rounds pass float64
            following = string - self.deviation(tooth, l_y)
            if np.array_equal(following, l_y):
                break
            l_y = following
        # Own frame turned so that the nominal pitch point has polar angle pitch_angle.
        theta = self.pitch_angle(tooth) + involute(self.alpha) - l_y / self.r_b
        c, s = np.cos(theta), np.sin(theta)
        return np.stack(
            [
                self.r_b * c - string * s + self.ecc[0],
                self.r_b * s + string * c + self.ecc[1],
            ],
            axis=-1,
        )

    def faces(self, n: int, *, spacing: str = "arc") -> FloatArray:
        """Drive faces (z, ROOT_POINTS + n, 2): root land, radial root, n involute points, tip last.

        spacing "arc": equal arc length, ds = L dL / r_b; "roll": equal roll angle.
        """
        string = self.strings(n, spacing=spacing)
        land = ROOT_POINTS // 2
        out = np.empty((self.z, ROOT_POINTS + n, 2))
        ecc = np.array(self.ecc)
        for tooth in range(self.z):
            flank = self.point(tooth, string)
            foot = flank[0] - ecc
            angle, top = math.atan2(foot[1], foot[0]), math.hypot(*foot)
            # Mid root land lies a quarter pitch less the thickening from the flank; any arc will
            # do.
            phi = angle + np.linspace(0.2 * math.pi / self.z, 0.0, land)
            radius = np.linspace(self.r_f, top, ROOT_POINTS - land + 2)[1:-1]
            out[tooth, :land] = self.r_f * np.stack([np.cos(phi), np.sin(phi)], 1) + ecc
            direction = np.array([math.cos(angle), math.sin(angle)])
            out[tooth, land:ROOT_POINTS] = radius[:, None] * direction + ecc
            out[tooth, ROOT_POINTS:] = flank
        return out

    def coast_faces(self, n: int, *, E_s: float = 0.0, spacing: str = "arc") -> FloatArray:
        """Coast faces (z, ROOT_POINTS + n, 2): the mirror image of a drive face about the tooth's
        middle.

        Its index deviation is -index + E_s cos(alpha), E_s mm along the reference circle; slope and
        wave are as on the drive face.
        """
        other = replace(self, index=-self.index + E_s * math.cos(self.alpha), ecc=(0.0, 0.0)).faces(n, spacing=spacing)
        # The middle stands a quarter pitch clockwise of the drive flank's nominal pitch point.
        middle = np.array([self.pitch_angle(k) for k in range(self.z)]) - math.pi / (2 * self.z)
        c, s = np.cos(2 * middle)[:, None], np.sin(2 * middle)[:, None]
        x, y = other[..., 0], other[..., 1]
        return np.stack([c * x + s * y + self.ecc[0], s * x - c * y + self.ecc[1]], axis=-1)

    def strings(self, n: int, *, spacing: str = "arc") -> FloatArray:
        """The n string lengths L of the involute's points, mm."""
        if spacing == "arc":
            return np.sqrt(np.linspace(self.l_start**2, self.l_tip**2, n))
        return np.linspace(self.l_start, self.l_tip, n)


@dataclass(frozen=True)
class InvolutePair:
    """Two test gears at their reference centre distance."""

    driving: InvoluteGear
    driven: InvoluteGear

    @property
    def a(self) -> float:
        """Reference centre distance."""
        return self.driving.r + self.driven.r

    def guesses(self, theta_2: FloatArray) -> FloatArray:
        """Driving rotation of the perfect pair."""
        return theta_2 * self.driven.z / self.driving.z

    def te(self, theta_2: FloatArray, theta_1: FloatArray) -> FloatArray:
        """TE = theta_2 - (z_1 / z_2) theta_1, rad on the driven shaft."""
        return theta_2 - theta_1 * self.driving.z / self.driven.z


def make_pair(
    z_1: int,
    z_2: int,
    *,
    m: float = 2.0,
    alpha: float = math.radians(20.0),
    index: tuple[FloatArray, FloatArray] | None = None,
    slope: tuple[FloatArray, FloatArray] | None = None,
    wave: tuple[float, float] = (0.0, 0.0),
    ecc: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 0.0), (0.0, 0.0)),
) -> InvolutePair:
    """A pair of test gears; deviations default to none. Units as in InvoluteGear."""
    zeros = (np.zeros(z_1), np.zeros(z_2))
    index, slope = index or zeros, slope or zeros
    return InvolutePair(
        InvoluteGear(z_1, m, alpha, False, index[0], slope[0], wave[0], ecc[0]),
        InvoluteGear(z_2, m, alpha, True, index[1], slope[1], wave[1], ecc[1]),
    )


def pair_faces(
    z_1: int,
    z_2: int,
    m: float,
    alpha: float,
    n: int,
    *,
    index: tuple[FloatArray, FloatArray] | None = None,
    slope: tuple[FloatArray, FloatArray] | None = None,
    wave: tuple[float, float] = (0.0, 0.0),
    ecc: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 0.0), (0.0, 0.0)),
    spacing: str = "arc",
) -> tuple[FloatArray, FloatArray, InvolutePair]:
    """Turning faces (z_1, n + 10, 2), fixed faces (z_2, n + 10, 2), and the pair itself."""
    pair = make_pair(z_1, z_2, m=m, alpha=alpha, index=index, slope=slope, wave=wave, ecc=ecc)
    return pair.driving.faces(n, spacing=spacing), pair.driven.faces(n, spacing=spacing), pair


def conjugate_rotation(pair: InvolutePair, theta_2: float, *, axis_distance: float | None = None) -> float:
    """Driving rotation of deviation-free involutes on any axes and eccentricities: exact.

    Each gear runs true about its own centre. With the centres at distance a' in direction gamma,
    r_b1 (theta_1 - gamma) - r_b2 (theta_2 + gamma) = (r_b1 + r_b2)(inv alpha' - inv alpha). Derived
    here. Valid while some pair touches inside its path of contact; a constant index deviation is
    out.
    """
    one, two = pair.driving, pair.driven
    a = pair.a if axis_distance is None else axis_distance
    c2 = complex(a, 0.0) + complex(*two.ecc) * complex(math.cos(theta_2), -math.sin(theta_2))

    def residual(theta_1: float) -> float:
        c1 = complex(*one.ecc) * complex(math.cos(theta_1), math.sin(theta_1))
        line = c2 - c1
        gamma = math.atan2(line.imag, line.real)
        alpha_w = math.acos((one.r_b + two.r_b) / abs(line))
        wedge = (one.r_b + two.r_b) * (involute(alpha_w) - involute(one.alpha))
        return one.r_b * (theta_1 - gamma) - two.r_b * (theta_2 + gamma) - wedge

    near = theta_2 * two.z / one.z
    # 1e-15 rad: the floor of float64 for angles of a few radians.
    return float(brentq(residual, near - 0.05, near + 0.05, xtol=1e-15, rtol=1e-15))


def analytic_te(
    pair: InvolutePair, theta_2: float, *, axis_distance: float | None = None, teeth: int = 2
) -> tuple[float, tuple[int, int]]:
    """Unloaded TE (rad) of continuous flanks and the touching pair, by optimisation on the curves.

    For the meshes within `teeth` of the pitch point: polar gap of the two continuous flanks at
    equal radius about the driving axis, on a grid, refined by bounded minimisation between grid
    neighbours, with both ends of the overlap (tip corners) solved for. Involutes only: no root.
    """
    one, two = pair.driving, pair.driven
    a = pair.a if axis_distance is None else axis_distance
    near = theta_2 * two.z / one.z
    turn, back = (
        complex(math.cos(near), math.sin(near)),
        complex(math.cos(theta_2), -math.sin(theta_2)),
    )
    middle = round(theta_2 * two.z / (2 * math.pi))
    best, touching = math.inf, (-1, -1)
    for mesh in range(middle - teeth, middle + teeth + 1):
        pair_of_teeth = (mesh % one.z, mesh % two.z)
        gap, low, high = _gap_curve(one, two, pair_of_teeth, turn, back, a)
        if not low < high:
            continue
        grid = np.linspace(low, high, 400)
        values = [gap(float(v)) for v in grid]
        k = int(np.argmin(values))
        least = values[k]
        bracket = (float(grid[max(k - 1, 0)]), float(grid[min(k + 1, 399)]))
        # xatol 1e-9 mm on a smooth minimum: value good to curvature x 1e-18; ends are in the grid.
        found = minimize_scalar(gap, bounds=bracket, method="bounded", options={"xatol": 1e-9})
        least = min(least, float(found.fun))
        if least < best:
            best, touching = least, pair_of_teeth
    # near is exactly (z_2 / z_1) theta_2, so only the small gap enters TE.
    return -best * one.z / two.z, touching


def _gap_curve(
    one: InvoluteGear,
    two: InvoluteGear,
    teeth: tuple[int, int],
    turn: complex,
    back: complex,
    a: float,
) -> tuple[Callable[[float], float], float, float]:
    """Gap (rad) as a function of the driven string length, and the string range that both share."""

    def driving_point(string: float) -> complex:
        p = one.point(teeth[0], np.array(string))
        return complex(p[0], p[1]) * turn

    def driven_point(string: float) -> complex:
        p = two.point(teeth[1], np.array(string))
        return complex(p[0], p[1]) * back + a

    bottom, top = abs(driving_point(one.l_start)), abs(driving_point(one.l_tip))

    def gap(string: float) -> float:
        q = driven_point(string)
        rho = min(max(abs(q), bottom), top)  # the ends are solved to rounding only
        string_1 = brentq(
            lambda v: abs(driving_point(v)) - rho,
            one.l_start - 1e-9,  # the bracket must hold the ends themselves
            one.l_tip + 1e-9,
            xtol=1e-15,
            rtol=1e-15,
        )
        p = driving_point(string_1)
        return math.atan2((p.conjugate() * q).imag, (p.conjugate() * q).real)

    # About the driving axis the driven flank's radius falls as its string grows.
    def end(radius: float, otherwise: float, outside: bool) -> float:
        def miss(v: float) -> float:
            return abs(driven_point(v)) - radius

        if outside:
            return otherwise
        return float(brentq(miss, two.l_start, two.l_tip, xtol=1e-15, rtol=1e-15))

    r_start, r_tip = abs(driven_point(two.l_start)), abs(driven_point(two.l_tip))
    if r_tip >= top or r_start <= bottom:
        return gap, 1.0, 0.0
    return gap, end(top, two.l_start, r_start <= top), end(bottom, two.l_tip, r_tip >= bottom)
