"""The tooth as a beam sees it: its thickness along its own centre line, from its actual outline.

The frame is the tooth's own: x runs up the centre line from the gear axis, y to the
counter-clockwise (drive) side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearpoly.errors import GeometryError
from gearpoly.mesh.compliance.rows import interpolated
from gearpoly.units import FloatArray, read_only

ROOT_CIRCLE_TOLERANCE = 1e-9
"""Relative distance from the root radius within which a vertex counts as root land.

Far above rounding (1e-15) and far below the rise of the fillet over one point spacing; larger, and
the beam would start up the fillet; smaller, and a rounded land would count as fillet.
"""


@dataclass(frozen=True, kw_only=True)
class Mate:
    """The other gear by its numbers: teeth, profile shift, dedendum of its rack over the module."""

    teeth: int
    profile_shift: float
    dedendum: float


@dataclass(frozen=True, kw_only=True)
class ToothSection:
    """Sections of z teeth, transverse to their centre lines; lengths in mm, angles in rad, arrays
    read-only.

    ``x``, ``h`` (z, q): positions along the centre line, from where the lower fillet touches the
    root circle to the tip, and thickness there, linear in between (exact for the polylines).
    ``radius`` (n,), ``psi_drive``, ``psi_coast`` (z, n): the outline above the root land as half
    angles from the centre line, both positive. ``centre`` (z,): polar angle of the centre line in
    the frame of the input. ``x_e``, ``h_e`` (z,): effective end of the beam and its thickness.
    ``x_f``, ``h_f`` (z,): the same where the fillet touches the root circle. ``theta_f`` (z,): half
    angle of that place. ``H_p`` (z,): thickness at the reference circle. ``teeth``,
    ``profile_shift`` and ``mate`` (None: an equal gear) serve laws that know a gear by its numbers
    only. ``single`` is true where the
    input was one tooth without a leading axis.
    """

    x: FloatArray
    h: FloatArray
    radius: FloatArray
    psi_drive: FloatArray
    psi_coast: FloatArray
    centre: FloatArray
    x_e: FloatArray
    h_e: FloatArray
    x_f: FloatArray
    h_f: FloatArray
    theta_f: FloatArray
    H_p: FloatArray
    r: float
    r_b: float
    r_f: float
    bore_radius: float | None
    teeth: int | None
    profile_shift: float
    mate: Mate | None
    single: bool

    @property
    def r_a(self) -> float:
        """Tip radius in mm."""
        return float(self.radius[-1])


def _thickness(
    x_drive: FloatArray, y_drive: FloatArray, x_coast: FloatArray, y_coast: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Positions (z, 2 n) and thickness there, of sides (z, n), on the union of both sides' vertices: there the
    difference has its kinks."""
    low = np.maximum(x_drive[:, :1], x_coast[:, :1])
    # One tip corner may stand higher by the index deviation's tilt; the beam ends where both sides
    # still exist.
    high = np.minimum(x_drive[:, -1:], x_coast[:, -1:])
    x = np.sort(np.clip(np.concatenate((x_drive, x_coast), axis=1), low, high), axis=1)
    return x, interpolated(x, x_drive, y_drive) - interpolated(x, x_coast, y_coast)


def _check_outline(radius: FloatArray, drive: FloatArray, coast: FloatArray) -> None:
    if radius.ndim != 1 or radius.size < 3:
        raise GeometryError(f"radius has shape {radius.shape}: a flank needs 3 or more points, shape (n,)")
    if drive.shape != coast.shape or drive.shape[1:] != radius.shape:
        raise GeometryError(
            f"drive {drive.shape} and coast {coast.shape} do not fit radius {radius.shape}: both must be (n,) or (z, n)"
        )
    if not (np.isfinite(radius).all() and np.isfinite(drive).all() and np.isfinite(coast).all()):
        raise GeometryError("the outline holds a value that is not finite")
    if radius[0] <= 0.0 or (np.diff(radius) < -ROOT_CIRCLE_TOLERANCE * radius[0]).any():
        raise GeometryError("radius must be positive and must not fall from root to tip")


def _check_radii(radius: FloatArray, base: float, reference: float, bore: float | None) -> None:
    if not 0.0 < base < radius[-1] or not radius[0] < reference < radius[-1]:
        raise GeometryError(
            f"base radius {base} mm and reference radius {reference} mm must "
            f"lie below the tip radius {radius[-1]} mm, "
            f"the reference radius above the root radius {radius[0]} mm"
        )
    if bore is not None and not 0.0 < bore < radius[0]:
        raise GeometryError(f"bore radius {bore} mm must lie between 0 and the root radius {radius[0]} mm")


def _side(radius: FloatArray, psi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """x and y (z, n) of one side of every tooth in the tooth's own frame, at half angles ``psi`` (z, n), checked to run
    up the tooth."""
    x = radius * np.cos(psi)
    back = (np.diff(x, axis=1) <= 0.0).any(axis=1)
    if back.any():
        raise GeometryError(
            f"tooth {int(np.argmax(back))}: its outline turns back on itself along the centre line, "
            "so it is no beam; "
            "check the order of the points (root to tip) and the undercut"
        )
    return x, radius * np.sin(psi)


def _from_centre_lines(
    radius: FloatArray, drive: FloatArray, coast: FloatArray, reference: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Both sides (z, n) as half angles from the centre lines, where these stand (z,), and the half angles (z,) at the
    ``reference`` radius; all in rad."""
    at_reference = [np.array([np.interp(reference, radius, row) for row in side]) for side in (drive, coast)]
    centre = 0.5 * (at_reference[0] + at_reference[1])
    return drive - centre[:, None], centre[:, None] - coast, centre, 0.5 * (at_reference[0] - at_reference[1])


def _tables(radius: FloatArray, drive: FloatArray, coast: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions (z, q) along the centre lines and thickness there, mm. Raises ``GeometryError`` for a tooth that is
    pinched to nothing."""
    x_drive, y_drive = _side(radius, drive)
    x_coast, y_coast = _side(radius, coast)
    x, h = _thickness(x_drive, y_drive, x_coast, -y_coast)
    if (h <= 0.0).any():
        tooth, at = np.unravel_index(int(np.argmin(h)), h.shape)
        raise GeometryError(
            f"tooth {tooth} is pinched to nothing {x[tooth, at]:.4g} mm from the axis; "
            "less undercut or a lower tip is needed"
        )
    return x, h


def tooth_section(
    *,
    radius: npt.ArrayLike,
    drive: npt.ArrayLike,
    coast: npt.ArrayLike,
    base_radius: float,
    reference_radius: float,
    bore_radius: float | None = None,
    teeth: int | None = None,
    profile_shift: float = 0.0,
    mate: Mate | None = None,
) -> ToothSection:
    """The sections of one or z teeth from their actual outlines, root to tip.

    ``radius`` (n,) in mm, not falling; a root land is a run of points at the root radius.
    ``drive``, ``coast`` (n,) or (z, n): polar angles in rad of the counter-clockwise and the
    clockwise side (so ``coast`` is about ``-drive``) in a frame whose zero is near the tooth's
    centre line. The centre line itself is put midway between the sides at ``reference_radius``, so
    an index deviation turns the tooth and does not bend it out of shape. ``base_radius``,
    ``bore_radius`` in mm.

    The beam ends (``x_e``) midway on the root circle between where the involute, extended to it
    (radially below the base circle), meets it and where the fillet touches it.

    Raises ``GeometryError`` for arrays that do not fit, an outline that turns back, or a tooth
    pinched to nothing. Source of the effective end: the study in docs/explanation/paper.md, after Tavakoli and
    Houser (1986); thickness derived here.
    """
    grid = np.asarray(radius, dtype=np.float64)
    drive_in = np.asarray(drive, dtype=np.float64)
    single = drive_in.ndim == 1
    psi_d, psi_c = np.atleast_2d(drive_in), np.atleast_2d(np.asarray(coast, dtype=np.float64))
    _check_outline(grid, psi_d, psi_c)
    _check_radii(grid, base_radius, reference_radius, bore_radius)
    r_f = float(grid[0])
    # The last vertex on the root circle; a land's radii may waver by rounding.
    foot = int(np.argmax(grid > r_f * (1.0 + ROOT_CIRCLE_TOLERANCE))) - 1
    grid, psi_d, psi_c = grid[foot:], psi_d[:, foot:], psi_c[:, foot:]
    psi_d, psi_c, centre, half = _from_centre_lines(grid, psi_d, psi_c, reference_radius)
    x, h = _tables(grid, psi_d, psi_c)
    theta_f = 0.5 * (psi_d[:, 0] + psi_c[:, 0])
    theta_e = 0.5 * (np.minimum(_involute_at_root(half, r_f, base_radius, reference_radius), theta_f) + theta_f)
    x_e = np.maximum(r_f * np.cos(theta_e), x[:, 0])
    return ToothSection(
        x=read_only(x),
        h=read_only(h),
        radius=read_only(grid),
        psi_drive=read_only(psi_d),
        psi_coast=read_only(psi_c),
        centre=read_only(centre),
        x_e=read_only(x_e),
        h_e=read_only(interpolated(x_e[:, None], x, h)[:, 0]),
        x_f=read_only(x[:, 0]),
        h_f=read_only(h[:, 0]),
        theta_f=read_only(theta_f),
        H_p=read_only(2.0 * reference_radius * np.sin(half)),
        r=float(reference_radius),
        r_b=float(base_radius),
        r_f=r_f,
        bore_radius=None if bore_radius is None else float(bore_radius),
        teeth=teeth,
        profile_shift=float(profile_shift),
        mate=mate,
        single=single,
    )


def _involute_at_root(half: FloatArray, r_f: float, r_b: float, r: float) -> FloatArray:
    """Half angle at which the involute's extension meets the root circle, (z,); ``half`` is that at
    the reference circle.

    It is taken through the reference circle and not through the flank's lowest point, which
    undercut may have removed.
    """

    def inv(radius: float) -> float:
        alpha = math.acos(min(1.0, r_b / radius))
        return math.tan(alpha) - alpha

    # No involute exists below the base circle: inv = 0 there, which is the radial line.
    return half + inv(r) - inv(r_f)
