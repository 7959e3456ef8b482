"""What an unloaded pair transmits: transmission error, backlash and touching pairs over the driven angle.

TE = theta_2 - (z_1/z_2) theta_1, positive where the driven gear is ahead (Liu et al. 2020, Eq. 16). The driven gear
is held at theta_2 and the driving gear turned until it touches, forward for the drive flank and backward for the
coast flank.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearpoly.errors import GeometryError, JammedError
from gearpoly.mesh.contact import Closings, Feature, closing_rotations
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.units import DEG, UM, FloatArray, IntArray

NEAR = 10.0 * UM
"""mm along the line of action. Pairs that would close within this of the first touch are kept beside it; it decides
only how many neighbours a user sees, never which pairs touch."""

JAM = 1e-9
"""mm. Normal backlash below minus this is a jam: a thousand times the kernel's bracket, a thousandth of what chords
leave."""

Progress = Callable[[int], None]
"""Called with the number of positions finished since the last call."""


def _no_progress(done: int) -> None:
    """Nobody watches."""


@dataclass(frozen=True, kw_only=True)
class FlankContacts:
    """Contacts of all near pairs of one flank, one row each, sorted by position and then by closing.

    ``theta_2`` (N,) driven rotation in rad; ``te`` (N,) transmission error in rad. Rows (k,): ``position`` index into
    theta_2, ``driving`` and ``driven`` tooth numbers, ``gap`` in mm along the line of action beyond the first touch,
    ``point`` (k, 2) in mm and unit ``normal`` (k, 2) from the driving into the driven tooth, in the global frame,
    ``feature`` and ``overrun`` as in ``Closings``. ``touching`` (k,) marks the rows that touch, ``pairs`` (N,) counts
    them. ``repaired`` counts contacts solved twice.
    """

    flank: Flank
    theta_2: FloatArray
    te: FloatArray
    position: IntArray
    driving: IntArray
    driven: IntArray
    gap: FloatArray
    point: FloatArray
    normal: FloatArray
    feature: IntArray
    overrun: FloatArray
    touching: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
    pairs: IntArray
    repaired: int


def contacts(
    pair: GearPair,
    theta_2: FloatArray,
    *,
    flank: Flank = "drive",
    near: float = NEAR,
    progress: Progress = _no_progress,
) -> FlankContacts:
    """First touch and all near pairs of one ``flank`` at driven rotations ``theta_2`` (N,) in rad, unloaded and
    certified; pairs are near that close within ``near`` mm along the line of action.

    Raises ``GeometryError`` at a position where no pair touches, ``NotConvergedError`` where a contact cannot be
    certified.
    """
    sense = 1.0 if flank == "drive" else -1.0
    guess = theta_2 / pair.ratio
    parts: list[Closings] = []
    for part in closing_rotations(
        pair.driving.body(flank),
        pair.driven.body(flank),
        axis_distance=pair.a,
        poses=-sense * theta_2,
        guesses=sense * guess,
        near=near / pair.r_b1,
    ):
        parts.append(part)
        progress(part.positions)
    rows = _joined(parts)
    first = rows.first()
    if first.size != theta_2.size:
        missing = np.setdiff1d(np.arange(theta_2.size), rows.pose)[0]
        raise GeometryError(
            f"no {flank} flanks touch at driven angle {theta_2[missing] / DEG:.4f} deg; the gears do not reach "
            "each other there"
        )
    flip = np.array([1.0, sense])
    gap = (rows.rotation - rows.rotation[first][rows.pose]) * pair.r_b1
    touching, pairs = _touching(rows, gap, positions=theta_2.size, within=pair.chord_noise)
    return FlankContacts(
        flank=flank,
        theta_2=theta_2,
        te=-pair.ratio * sense * rows.rotation[first],
        position=rows.pose,
        driving=rows.turning,
        driven=rows.fixed,
        gap=gap,
        point=rows.point * flip,
        normal=rows.normal * flip,
        feature=rows.feature,
        overrun=rows.overrun,
        touching=touching,
        pairs=pairs,
        repaired=int(np.count_nonzero(rows.repaired)),
    )


def _joined(parts: list[Closings]) -> Closings:
    names = Closings.__dataclass_fields__
    return Closings(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in names if name != "positions"},
        positions=sum(part.positions for part in parts),
    )


def _touching(
    rows: Closings, gap: FloatArray, *, positions: int, within: float
) -> tuple[np.ndarray[tuple[int, ...], np.dtype[np.bool_]], IntArray]:
    """Which rows touch, and how many per position.

    Chords let one of several truly touching pairs lead by at most their sagittas, so pairs ``within`` (mm) of the
    first touch with it. A tip corner that has left the path of contact stands off by less than that for a while: it
    counts only where no flank touches.
    """
    near = gap <= within
    on_flank = near & (rows.feature == int(Feature.FLANK))
    flanks = np.bincount(rows.pose[on_flank], minlength=positions)
    first = np.zeros(gap.size, dtype=bool)
    first[rows.first()] = True
    touching = np.where(flanks[rows.pose] > 0, on_flank, first)
    return touching, np.bincount(rows.pose[touching], minlength=positions)


def mean_pairs(pair: GearPair, found: FlankContacts, *, resolution: float = 1e-4) -> float:
    """Mean number of touching pairs over uniformly spaced positions, that is, the contact ratio of the pair as it is.

    Where the count changes from one position to the next, the change is located by halving to ``resolution`` of a
    pitch, all at once, so that the mean does not depend on how the sampling falls on the mesh.
    """
    if found.theta_2.size < 2:
        return float(np.mean(found.pairs))
    step = found.theta_2[1] - found.theta_2[0]
    changes = np.flatnonzero(np.diff(found.pairs))
    low, width = found.theta_2[changes], step
    count_low, count_high = found.pairs[changes], found.pairs[changes + 1]
    while changes.size and width > resolution * pair.driven.gear.tau:
        width *= 0.5
        middle = contacts(pair, low + width, flank=found.flank).pairs
        low = np.where(middle == count_low, low + width, low)
    share = (low + 0.5 * width - found.theta_2[changes]) / step
    # The last sample's step closes the cycle on the first.
    between = 0.5 * (found.pairs + np.roll(found.pairs, -1))
    between[changes] = share * count_low + (1.0 - share) * count_high
    return float(np.mean(between))


@dataclass(frozen=True, kw_only=True)
class Backlash:
    """Lost motion of a pair: ``j_bn`` (N,) normal backlash in mm at each driven rotation of ``drive`` and ``coast``
    contacts."""

    drive: FlankContacts
    coast: FlankContacts
    j_bn: FloatArray


def both_flanks(
    pair: GearPair, theta_2: FloatArray, *, near: float = NEAR, progress: Progress = _no_progress
) -> Backlash:
    """Drive and coast contacts at ``theta_2`` (N,) in rad, and the backlash between them, j_bn = (TE_coast -
    TE_drive) r_b2.

    Raises ``JammedError`` where there is none left.
    """
    drive = contacts(pair, theta_2, flank="drive", near=near, progress=progress)
    coast = contacts(pair, theta_2, flank="coast", near=near, progress=progress)
    j_bn = (coast.te - drive.te) * pair.r_b2
    worst = int(np.argmin(j_bn))
    if j_bn[worst] < -JAM:
        teeth = [int(f.driving[np.searchsorted(f.position, worst)]) for f in (drive, coast)]
        mates = [int(f.driven[np.searchsorted(f.position, worst)]) for f in (drive, coast)]
        raise JammedError(
            f"the gears jam: at driven angle {theta_2[worst] / DEG:.3f} deg the teeth overlap by "
            f"{-j_bn[worst] / UM:.3f} um "
            f"(drive flank: driving tooth {teeth[0]} on driven {mates[0]}; coast flank: {teeth[1]} on {mates[1]}); "
            "thin the teeth (tooth_thickness_um, E_sns_um) or enlarge centre_distance_mm"
        )
    return Backlash(drive=drive, coast=coast, j_bn=j_bn)
