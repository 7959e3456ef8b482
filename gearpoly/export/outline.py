"""One gear's outline at the detail that a drawing asks for, part by part, with its chord error measured.

The kernel's own polygons have thousands of points per flank; a cutter or a printer needs fifty. So every outline is
drawn anew from the same deviations, and how far its chords stand off is measured on a finer drawing rather than taken
from a formula, since magnified deviations bend flanks more than their involutes do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from gearpoly.errors import GeometryError, OutOfRangeError
from gearpoly.gear.deviations import Deviations
from gearpoly.gear.flank import Flanks, draw_flanks, points_for
from gearpoly.gear.gear import Gear
from gearpoly.gear.polygon import arc, rotate
from gearpoly.gear.root import FILLET_CHORD_ERROR, Root, draw_root, form_point
from gearpoly.units import UM, FloatArray, read_only

Kind = Literal["fillet", "flank", "tip", "land"]
Side = Literal["drive", "coast", ""]

CHORD_PER_MODULE = 5e-5
"""Default chord error over the module (0.1 um at m = 2 mm): it takes 3e-5 off the area of the smallest gears, below the
1e-4 that a solid's volume is promised to, and keeps 50 points per flank."""

LEAST_POINTS_PER_FLANK, MOST_POINTS_PER_FLANK = 8, 20_000
"""Points per flank: fewer than 8 do not show an involute, more than 20 000 make files that no tool opens."""

PLENTY = 500
"""Points per flank at which the default detail stops: profiles that scatter from point to point would otherwise ask
for all of them."""

CHORD_DIVISIONS = 8
"""Divisions of each chord on which its error is measured; the greatest stand-off between them is missed by 1 part in
64."""

FILLET_SHARE = 0.9
"""Share of the chord error that fillets are drawn to: their points follow the curvature at one end of each chord, which
errs by a few parts in a hundred."""

CHORD_FLOOR, CHORD_CEILING = 1e-7, 0.1
"""mm. Chord errors that can be asked for: 0.1 nm is what text formats resolve, 0.1 mm is no gear any more."""


@dataclass(frozen=True, kw_only=True)
class Detail:
    """How fine to draw: ``points`` per involute flank, or chord error ``chord`` in mm; neither: 5e-5 modules.

    Raises ``OutOfRangeError`` where both are given or one is out of range.
    """

    points: int | None = None
    chord: float | None = None

    def __post_init__(self) -> None:
        if self.points is not None and self.chord is not None:
            raise OutOfRangeError("--points and --chord-um both set the detail; want one of the two")
        if self.points is not None and not LEAST_POINTS_PER_FLANK <= self.points <= MOST_POINTS_PER_FLANK:
            verdict = (
                "too few for a closed outline and a watertight solid"
                if self.points < LEAST_POINTS_PER_FLANK
                else "more than tools open"
            )
            raise OutOfRangeError(
                f"--points {self.points}: {verdict}; "
                f"want {LEAST_POINTS_PER_FLANK} to {MOST_POINTS_PER_FLANK} points per flank"
            )
        if self.chord is not None and not CHORD_FLOOR <= self.chord <= CHORD_CEILING:
            raise OutOfRangeError(
                f"--chord-um {self.chord / UM:g}: want {CHORD_FLOOR / UM:g} to {CHORD_CEILING / UM:g} um"
            )


@dataclass(frozen=True, kw_only=True, eq=False)
class OutlinePart:
    """One smooth piece of the outline: ``points`` (k, 2) in mm, counter-clockwise, both ends shared with its
    neighbours.

    ``tooth`` whose it is (a land: the tooth before it), ``kind`` and, of fillets and flanks, ``side``. Tips and lands
    are arcs about the gear's centre.
    """

    tooth: int
    kind: Kind
    side: Side
    points: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Outline:
    """The closed outline of one gear at rotation 0, its axis of rotation at the origin, and its bore.

    ``parts`` follow one another counter-clockwise; ``centre`` (2,) in mm is the gear's own centre; ``bore`` (k, 2) the
    bore's points, counter-clockwise, and ``r_bore`` its radius in mm; ``flanks`` what was drawn, ``fine`` the same
    ``CHORD_DIVISIONS`` times as fine; ``chord_error`` in mm, measured: no point of the true outline is farther away;
    ``flank_error`` that of the involutes alone and ``fillet_error`` that of root, tip and bore.
    """

    gear: Gear
    parts: tuple[OutlinePart, ...]
    centre: FloatArray
    bore: FloatArray
    r_bore: float
    flanks: Flanks
    fine: Flanks
    chord_error: float
    flank_error: float
    fillet_error: float

    @cached_property
    def ring(self) -> FloatArray:
        """All points (N, 2) in mm, counter-clockwise, the first not repeated."""
        return read_only(np.concatenate([part.points[:-1] for part in self.parts]))


def draw_outline(
    gear: Gear, deviations: Deviations, *, l_start: float, centre_lines: FloatArray, centre: FloatArray, detail: Detail
) -> Outline:
    """The outline of ``gear`` with ``deviations``, its teeth at ``centre_lines`` (z,) in rad about ``centre`` (2,)
    in mm.

    Raises ``GeometryError`` where teeth cross, ``OutOfRangeError`` where the detail cannot be reached.
    """
    flanks, fine, error = _flanks(gear, deviations, l_start, detail)
    # Root, tip and bore follow what was asked for; with a number of points, the flanks, as long as it stays a root.
    chord = detail.chord or CHORD_PER_MODULE * gear.m
    if detail.points is not None:
        chord = min(max(error, FILLET_CHORD_ERROR), 0.01 * gear.m)
    parts = _parts(flanks, draw_root(gear, chord_error=FILLET_SHARE * chord), centre_lines, centre, chord=chord)
    r_bore = 0.5 * (gear.r_f if gear.d_bore is None else gear.d_bore)
    bore = np.concatenate(([[r_bore, 0.0]], arc(r_bore, 0.0, 2.0 * math.pi, chord_error=chord)))
    return Outline(
        gear=gear,
        parts=parts,
        centre=read_only(centre),
        bore=read_only(bore),
        r_bore=r_bore,
        flanks=flanks,
        fine=fine,
        chord_error=max(error, chord),
        flank_error=error,
        fillet_error=chord,
    )


def _flanks(gear: Gear, deviations: Deviations, l_start: float, detail: Detail) -> tuple[Flanks, Flanks, float]:
    """Flanks, the same finer, and the measured chord error in mm."""
    l_form = form_point(gear)[1]
    wanted = detail.chord or CHORD_PER_MODULE * gear.m
    most = PLENTY if detail.chord is None else MOST_POINTS_PER_FLANK
    n = detail.points or min(most, points_for(gear, l_form=l_form, chord_error=wanted))
    while True:
        # Deviations magnified beyond all measure run away; draw_flanks says so.
        with np.errstate(over="ignore", invalid="ignore"):
            flanks = draw_flanks(gear, deviations, l_start=l_start, points=n)
            fine = draw_flanks(gear, deviations, l_start=l_start, points=CHORD_DIVISIONS * (n - 1) + 1)
        error = stand_off(flanks, fine)
        if detail.points is not None or error <= wanted or (n == most and detail.chord is None):
            return flanks, fine, error
        if n == most:
            raise OutOfRangeError(
                f"--chord-um {wanted / UM:g} cannot be reached: with {most} points per flank z = {gear.z} still stands "
                f"off by {error / UM:.3g} um, since its deviations have corners"
            )
        # The error of a smooth flank falls with the square of the points; 2 % more spares another round.
        n = min(most, 2 + math.ceil(1.02 * (n - 1) * math.sqrt(error / wanted)))


def stand_off(flanks: Flanks, fine: Flanks) -> float:
    """The most in mm that the ``fine`` involutes stand off the chords of ``flanks``, whose points they hold."""
    worst = 0.0
    for coarse, dense in ((flanks.drive, fine.drive), (flanks.coast, fine.coast)):
        ends = coarse[:, flanks.root.n - 1 :]
        between = dense[:, fine.root.n - 1 :]
        chord = np.diff(ends, axis=1)
        z, n = chord.shape[:2]
        rows = between[:, :-1].reshape(z, n, CHORD_DIVISIONS, 2) - ends[:, :-1, None]
        off = rows[..., 0] * chord[:, :, None, 1] - rows[..., 1] * chord[:, :, None, 0]
        worst = max(worst, float(np.max(np.abs(off) / np.hypot(chord[..., 0], chord[..., 1])[..., None])))
    return worst


def _parts(
    flanks: Flanks, root: Root, centre_lines: FloatArray, centre: FloatArray, *, chord: float
) -> tuple[OutlinePart, ...]:
    """The outline's parts, counter-clockwise, starting with the coast fillet of the tooth nearest above angle 0.

    Each fillet turns with its flank. Where neighbouring fillets then overlap, the space ends at their crossing;
    where flanks do, ``GeometryError``.
    """
    gear, first = flanks.gear, flanks.root.n - 1
    # The land is drawn between fillets below; 1e-12 tells its points from the fillet's, whose first is on it too.
    start = max(0, int(np.argmax(root.r > gear.r_f * (1.0 + 1e-12))) - 1)
    r, nominal = root.r[start:], root.psi[start:]
    psi = {
        side: nominal + (angles[:, first : first + 1] - nominal[-1])
        for side, angles in (("drive", flanks.psi_drive), ("coast", flanks.psi_coast))
    }
    order = np.argsort(np.mod(centre_lines, 2.0 * math.pi))
    following = np.empty_like(order)
    following[order] = np.roll(order, -1)
    # Angular width (z, n) of the space after each tooth, at the fillet's radii and at the flank's.
    space = gear.tau - psi["drive"] - psi["coast"][following]
    above = gear.tau - flanks.psi_drive[:, first:] - flanks.psi_coast[following][:, first:]
    closed = np.flatnonzero(np.min(above, axis=1) <= 0.0)
    if closed.size:
        raise GeometryError(f"the flanks of teeth {closed[0]} and {following[closed[0]]} cross")
    parts: list[OutlinePart] = []
    bottoms = [_bottom(r, space[k]) for k in range(gear.z)]
    before = np.empty_like(order)
    before[following] = np.arange(gear.z)

    def placed(radii: FloatArray, angles: FloatArray) -> FloatArray:
        return read_only(np.stack((radii * np.cos(angles), radii * np.sin(angles)), axis=-1) + centre)

    for k in order.tolist():
        middle, own = float(centre_lines[k]), flanks.tooth(k)
        r_tip = float(own.r[-1])
        for side, cut in (("coast", bottoms[before[k]]), ("drive", bottoms[k])):
            sign = -1.0 if side == "coast" else 1.0
            angles = own.coast if side == "coast" else own.drive
            flank = placed(own.r[first:], middle + sign * angles[first:])
            low = placed(*_cut(r, psi[side][k], cut, middle, sign))
            if side == "coast":
                parts.append(OutlinePart(tooth=k, kind="fillet", side="coast", points=low))
                parts.append(OutlinePart(tooth=k, kind="flank", side="coast", points=flank))
                tip = rotate(arc(r_tip, -float(own.coast[-1]), float(own.drive[-1]), chord_error=chord), middle)
                ends = placed(np.full(2, r_tip), middle + np.array([-own.coast[-1], own.drive[-1]]))
                points = np.concatenate((ends[:1], tip + centre, ends[1:]))
                parts.append(OutlinePart(tooth=k, kind="tip", side="", points=read_only(points)))
            else:
                parts.append(OutlinePart(tooth=k, kind="flank", side="drive", points=read_only(flank[::-1])))
                parts.append(OutlinePart(tooth=k, kind="fillet", side="drive", points=read_only(low[::-1])))
        if bottoms[k] is None:
            stop = middle + float(psi["drive"][k, 0])
            land = arc(gear.r_f, stop, stop + float(space[k, 0]), chord_error=chord)
            ends = placed(np.full(2, gear.r_f), stop + np.array([0.0, space[k, 0]]))
            points = np.concatenate((ends[:1], land + centre, ends[1:]))
            parts.append(OutlinePart(tooth=k, kind="land", side="", points=read_only(points)))
    return _joined(parts)


def _bottom(r: FloatArray, space: FloatArray) -> float | None:
    """Radius in mm at which the two fillets of a space cross, the highest if several; None where land is left between
    them."""
    shut = np.flatnonzero(space <= 0.0)
    if not shut.size:
        return None
    i = int(shut[-1])
    share = space[i] / (space[i] - space[i + 1])
    return float(r[i] + share * (r[i + 1] - r[i]))


def _cut(
    r: FloatArray, psi: FloatArray, bottom: float | None, middle: float, sign: float
) -> tuple[FloatArray, FloatArray]:
    """Radii and directions of one fillet from its foot, or from ``bottom`` (mm), to the form circle."""
    if bottom is not None:
        keep = r > bottom
        angle = float(np.interp(bottom, r, psi))
        r, psi = np.concatenate(([bottom], r[keep])), np.concatenate(([angle], psi[keep]))
    return r, middle + sign * psi


def _joined(parts: list[OutlinePart]) -> tuple[OutlinePart, ...]:
    """The parts with each end exactly the next one's start: rounding differs by 1e-15 where two formulas meet."""
    out = []
    for k, part in enumerate(parts):
        points = part.points.copy()
        points[-1] = parts[(k + 1) % len(parts)].points[0]
        out.append(OutlinePart(tooth=part.tooth, kind=part.kind, side=part.side, points=read_only(points)))
    return tuple(out)
