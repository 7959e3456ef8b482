"""The drawn flanks of one gear: root, involute and deviations of every tooth as points.

All teeth share one grid of radii, because a deviation moves a point along its base tangent: only the angle at each
radius differs from tooth to tooth. That is exact, and it keeps a gear of 25 teeth at 2000 points in one (25, n) array
per side. A tooth whose tip is missing has as many points below the place where it ends, on a grid of its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from gearpoly.errors import GeometryError, NotConvergedError, told_at_most
from gearpoly.gear.deviations import Deviations, Scatter, Shape, Span, total
from gearpoly.gear.gear import Gear
from gearpoly.gear.root import Root, draw_root
from gearpoly.units import UM, FloatArray, read_only

SPACING = 1.5
"""Points are equidistant in l**SPACING: 1 is equal roll, 2 equal arc length. A chord of length h on the radius l
stands off by h^2/(8 l), and h = l dl / r_b, so 1.5 gives every chord the same error; it is the best of the three
(docs/explanation/performance.md)."""

SOLVE_TOLERANCE = 1e-15
"""mm. Where the search for the involute point under a given radius stops: the float64 floor of a roll length of 10
mm."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sides:
    """Both sides at the same radii ``r`` in mm: angles ``drive`` and ``coast`` from the centre line in rad, both
    positive. All are (n,), from the root of one tooth to its tip, or (z,), at the tips of all teeth."""

    r: FloatArray
    drive: FloatArray
    coast: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Flanks:
    """Both sides of all teeth, root to tip, each in its own tooth's frame (centre line at angle 0).

    ``r`` (n,) radii in mm; ``psi_drive`` and ``psi_coast`` (z, n) angles of the two sides from the centre line in
    rad, both positive, as if every tooth were whole; ``chipped`` has the sides of those whose tip is missing, by their
    numbers, with as many points; ``root`` the first ``root.n`` points; ``chord_error`` in mm, the most that a chord of
    the involute stands off.
    """

    gear: Gear
    span: Span
    root: Root
    r: FloatArray
    psi_drive: FloatArray
    psi_coast: FloatArray
    chord_error: float
    chipped: Mapping[int, Sides] = field(default_factory=dict)

    @cached_property
    def alike(self) -> bool:
        """Whether all teeth have one outline and stand where they should."""
        sides = self.psi_drive, self.psi_coast
        return not self.chipped and all(np.array_equal(psi, np.broadcast_to(psi[:1], psi.shape)) for psi in sides)

    def tooth(self, number: int) -> Sides:
        """One tooth as it is, from root to tip."""
        whole = Sides(r=self.r, drive=self.psi_drive[number], coast=self.psi_coast[number])
        return self.chipped.get(number, whole)

    @cached_property
    def tips(self) -> Sides:
        """Where the sides of all teeth end."""
        r = np.full(self.gear.z, self.gear.r_a)
        drive, coast = self.psi_drive[:, -1].copy(), self.psi_coast[:, -1].copy()
        for k, own in self.chipped.items():
            r[k], drive[k], coast[k] = own.r[-1], own.drive[-1], own.coast[-1]
        return Sides(r=read_only(r), drive=read_only(drive), coast=read_only(coast))

    @cached_property
    def drive(self) -> FloatArray:
        """Drive flanks as points (z, n, 2) in mm in each tooth's frame; the drive side is counter-clockwise of the
        centre line."""
        return self._points(self.psi_drive, {k: own.drive for k, own in self.chipped.items()})

    @cached_property
    def coast(self) -> FloatArray:
        """Coast flanks as points (z, n, 2) in mm in each tooth's frame."""
        return self._points(-self.psi_coast, {k: -own.coast for k, own in self.chipped.items()})

    def _points(self, angle: FloatArray, own: Mapping[int, FloatArray]) -> FloatArray:
        points = _points(self.r, angle)
        for k, mine in own.items():
            points[k] = _points(self.chipped[k].r, mine)
        return read_only(points)

    def mean_deviation(self, flank: str) -> float:
        """Mean normal deviation in mm of all involutes on ``flank`` ("drive" or "coast"), halfway up the true
        involute."""
        middle = (self.root.n + self.r.size) // 2
        psi = self.psi_drive if flank == "drive" else self.psi_coast
        return self.gear.r_b * (float(np.mean(psi[:, middle])) - self.gear.psi(float(self.r[middle])))

    def largest_deviation(self, flank: str) -> float:
        """The most in mm by which a point of an involute on ``flank`` stands off ``mean_deviation``, along the
        normal."""
        psi = (self.psi_drive if flank == "drive" else self.psi_coast)[:, self.root.n :]
        nominal = np.array([self.gear.psi(float(r)) for r in self.r[self.root.n :]])
        return float(np.max(np.abs(self.gear.r_b * (psi - nominal) - self.mean_deviation(flank))))

    def root_leverage(self) -> float:
        """The greatest 6 h / s^2 in 1/mm over the sections of all tooth roots, h from the section to the tip, s its
        thickness.

        Times force over face width it is the nominal bending stress of a beam under a transverse load at its tip
        (Lewis 1892).
        """
        fillet = slice(0, self.root.n)
        half = np.minimum(0.5 * (self.psi_drive[:, fillet] + self.psi_coast[:, fillet]), 0.5 * np.pi)
        height = self.gear.r_a - self.r[fillet] * np.cos(half)
        return float(np.max(6.0 * height / (2.0 * self.r[fillet] * np.sin(half)) ** 2))


def _points(r: FloatArray, angle: FloatArray) -> FloatArray:
    return np.stack((r * np.cos(angle), r * np.sin(angle)), axis=-1)


def points_for(gear: Gear, *, l_form: float, chord_error: float) -> int:
    """How many points keep every chord of the involute within ``chord_error`` (mm) of it, ends included (derived here).

    With n points equidistant in l^1.5 every chord's error is (l_a^1.5 - l_form^1.5)^2 / (18 r_b^2 (n - 1)^2).
    """
    reach = math.pow(gear.l_a, SPACING) - math.pow(l_form, SPACING)
    return max(8, 1 + math.ceil(reach / (gear.r_b * math.sqrt(18.0 * chord_error))))


def draw_flanks(
    gear: Gear,
    deviations: Deviations | None = None,
    *,
    l_start: float = 0.0,
    points: int | None = None,
    chord_error: float = 0.001 * UM,
) -> Flanks:
    """All flanks of ``gear`` with their ``deviations``.

    ``l_start``: roll length in mm where the active profile starts (not below the true form circle). ``points`` per
    involute flank; absent: as many as keep within ``chord_error`` mm. Raises ``GeometryError`` where deviations leave
    no tooth, or a chip no flank of it.
    """
    deviations = deviations or Deviations()
    root = draw_root(gear)
    span = Span(l_start=max(l_start, root.l_form), l_a=gear.l_a)
    n = points_for(gear, l_form=root.l_form, chord_error=chord_error) if points is None else points
    r, psi_drive, psi_coast = _drawn(gear, deviations, root, n, span=span, r_tip=gear.r_a)
    waist = float(np.min(psi_drive + psi_coast))
    if waist <= 0.0:
        raise GeometryError(
            "the deviations leave nothing of a tooth: both flanks cross; check their size and unit (um)"
        )
    reach = gear.l_a**SPACING - root.l_form**SPACING
    return Flanks(
        gear=gear,
        span=span,
        root=root,
        r=read_only(r),
        psi_drive=read_only(psi_drive),
        psi_coast=read_only(psi_coast),
        chord_error=reach**2 / (18.0 * (gear.r_b * (n - 1)) ** 2),
        chipped=_chipped(gear, deviations, root, n, span=span),
    )


def _drawn(
    gear: Gear, deviations: Deviations, root: Root, n: int, *, span: Span, r_tip: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Radii (n,) in mm and angles (z, n) in rad of both sides of all teeth up to the radius ``r_tip`` in mm."""
    l_tip = gear.roll_length(r_tip)
    L = np.linspace(root.l_form**SPACING, l_tip**SPACING, n) ** (1.0 / SPACING)
    L[0], L[-1] = root.l_form, l_tip
    psi_drive, psi_coast = (
        np.concatenate((root_angles(root, side[:, :1]), side[:, 1:]), axis=1)
        for side in (_involute_angles(gear, shapes, L, span=span) for shapes in (deviations.drive, deviations.coast))
    )
    r = np.concatenate((root.r, np.hypot(gear.r_b, L[1:])))
    r[-1] = r_tip
    return r, psi_drive, psi_coast


def _chipped(gear: Gear, deviations: Deviations, root: Root, n: int, *, span: Span) -> dict[int, Sides]:
    """The teeth whose tip is missing, as they are left. Raises ``GeometryError`` where no flank is left of one."""
    out: dict[int, Sides] = {}
    most = gear.r_a - float(np.hypot(gear.r_b, root.l_form))
    for tooth, height in deviations.missing_tips.items():
        if height >= most:
            raise GeometryError(
                f"tooth {tooth} misses {height:g} mm of its tip, which leaves nothing of its flanks above the form "
                f"circle; at most {told_at_most(most, 3)} mm would do"
            )
        r, drive, coast = _drawn(gear, deviations, root, n, span=span, r_tip=gear.r_a - height)
        out[tooth] = Sides(r=read_only(r), drive=read_only(drive[tooth]), coast=read_only(coast[tooth]))
    return out


def _involute_angles(gear: Gear, shapes: tuple[Shape, ...], L: FloatArray, *, span: Span) -> FloatArray:
    """Angle (z, n) of each flank at string lengths ``L`` (n,): the l with l + d(l) = L, by fixed point.

    The search contracts by |d'|, a few um per mm; a deviation steeper than its own base tangent has no such flank.
    """
    rough = tuple(shape for shape in shapes if isinstance(shape, Scatter))
    smooth = tuple(shape for shape in shapes if not isinstance(shape, Scatter))
    target = L - total(rough, np.broadcast_to(L, (gear.z, L.size)), z=gear.z, span=span)
    l = target
    for k in range(200):
        change = target - total(smooth, l, z=gear.z, span=span) - l
        l, largest = l + change, float(np.max(np.abs(change)))
        if k > 0 and not largest < gear.r_a:
            break  # it runs away, by more each time
        if largest <= SOLVE_TOLERANCE * max(1.0, gear.l_a):
            angles: FloatArray = gear.psi_b - l / gear.r_b + np.arctan(L / gear.r_b)
            return angles
    raise NotConvergedError(
        "a profile deviation is so steep that the flank folds over; check its size (um) against its length (mm)"
    )


ROOT_MARGIN = 1e-4
"""Part of the half pitch by which a root stays on its own side of the middle of its space: below 0.1 um per mm of
radius, and far above rounding."""


def root_angles(root: Root, ends: FloatArray) -> FloatArray:
    """The root (z, root.n) turned so that it meets each flank at ``ends`` (z, 1); the middle of the tooth space stays
    where it is, and what a large deviation turns past it stands along it, or the outline would fold over."""
    angles: FloatArray = root.psi + (ends - root.psi[-1])
    angles[:, 0] = root.psi[0]
    along = root.psi[0] * (1.0 - ROOT_MARGIN * np.arange(root.n) / root.n)
    return np.where(angles > root.psi[0], along, angles)
