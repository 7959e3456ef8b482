"""What an unloaded pair transmits: transmission error, backlash and touching pairs over the driven angle.

TE = theta_2 - (z_1/z_2) theta_1, positive where the driven gear is ahead (Liu et al. 2020, Eq. 16). The driven gear
is held at theta_2 and the driving gear turned until it touches, forward for the drive flank and backward for the
coast flank.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.errors import GeometryError, JammedError, NoContactError, SelfCheckError, told_at_most
from gearpoly.gear.gear import inv
from gearpoly.gear.rack import STANDARD, free_round
from gearpoly.mesh.bodies import WIDE_SHARE, Body
from gearpoly.mesh.contact import Closings, Feature, closing_rotations
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.mesh.radial import closing_rotations_fast, spot_check
from gearpoly.threads import each, threads
from gearpoly.units import DEG, UM, FloatArray, IntArray

NEAR_PAIR_MM = 10.0 * UM
"""mm along the line of action. Pairs that would close within this of the first touch are kept beside it; it decides
only how many neighbours a user sees, never which pairs touch."""

JAM = 1e-9
"""mm. Normal backlash below minus this is a jam: a thousand times the kernel's bracket, a thousandth of what chords
leave."""

_POLYGONS = threading.Lock()
"""Prepared polygons build their indices on first use, which two threads must not do at once."""

CERTIFIED_SAMPLE = 64
"""Positions of a fast run that the polygon kernel certifies: 20 ms, and a fault in one position of twenty cannot
hide."""

FAST_CHUNK, ABREAST = 5000, 8
"""Positions of a fast run that one thread searches, and so many times as many between two reports of progress."""

LEAST_CHUNK = 500
"""Positions below which a thread of its own is not worth it: they take 10 ms, and bounds of the teeth's blocks 3."""

FOLLOWED = 0.15
"""Of the base pitch. Eccentricities and deviations together that both kernels follow without question. Of 3000 random
pairs of 6 to 80 teeth, deviations up to 1.5 mm at module 2 among them, the first about which they differ stood 0.166 of
a base pitch off."""

Progress = Callable[[int], None]
"""Called with the number of positions finished since the last call."""


def _no_progress(done: int) -> None:
    """Nobody watches."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FlankContacts:
    """Contacts of all near pairs of one flank, one row each, sorted by position and then by closing.

    ``theta_2`` (N,) driven rotation in rad; ``te`` (N,) transmission error in rad. Rows (k,): ``position`` index into
    theta_2, ``driving`` and ``driven`` tooth numbers, ``gap`` in mm along the line of action beyond the first touch,
    ``point`` (k, 2) in mm and unit ``normal`` (k, 2) from the driving into the driven tooth, in the global frame,
    ``feature`` and ``overrun`` as in ``Closings``. ``touching`` (k,) marks the rows that touch, ``pairs`` (N,) counts
    them. ``certified`` counts contacts (fast runs: positions) that the polygon kernel certified, ``repaired`` those
    solved twice.
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
    certified: int
    repaired: int
    near: float = math.inf


def contacts(
    pair: GearPair,
    theta_2: FloatArray,
    *,
    flank: Flank = "drive",
    near: float = NEAR_PAIR_MM,
    fast: bool = False,
    certified: int = CERTIFIED_SAMPLE,
    progress: Progress = _no_progress,
) -> FlankContacts:
    """First touch and all near pairs of one ``flank`` at driven rotations ``theta_2`` (N,) in rad, unloaded; pairs
    are near that close within ``near`` mm along the line of action.

    Every contact is certified by the polygon kernel. With ``fast`` the compiled radial gap of the same polylines
    finds them thirty times sooner, to 1e-12 rad, and the polygon kernel certifies so many positions of the run.

    Raises ``NoContactError`` at a position where no pair touches, ``NotConvergedError`` where a contact cannot be
    certified.
    """
    sense = 1.0 if flank == "drive" else -1.0
    expected = expected_closing(pair, flank)
    bodies = pair.driving.body(flank), pair.driven.body(flank)
    poses, guesses = -sense * theta_2, sense * theta_2 / pair.ratio + expected
    reach = near / pair.r_b1
    search = _fast_closings if fast else closing_rotations
    parts: list[Closings] = []
    for found in search(*bodies, axis_distance=pair.a, poses=poses, guesses=guesses, near=reach):
        parts.append(found)
        progress(found.positions)
    rows = _joined(parts)
    first = rows.first()
    _refuse_apart(rows, pair, theta_2, flank)
    if fast:
        certify_some(pair, rows, flank=flank, poses=poses, guesses=guesses, near=reach, samples=certified)
    flip = np.array([1.0, sense])
    gap = (rows.rotation - rows.rotation[first][rows.pose]) * pair.r_b1
    touching, pairs = touching_rows(rows, gap, positions=theta_2.size, within=pair.chord_noise)
    return FlankContacts(
        flank=flank,
        theta_2=theta_2,
        te=-pair.ratio * sense * (rows.rotation[first] + expected),
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
        certified=certified if fast else rows.pose.size,
        repaired=int(np.count_nonzero(rows.repaired)),
        near=near,
    )


def _refuse_apart(rows: Closings, pair: GearPair, theta_2: FloatArray, flank: Flank) -> None:
    """Raise ``NoContactError`` at the first of the driven rotations ``theta_2`` (N,) at which nothing touches."""
    first = rows.first()
    held = rows.pose[first][rows.rotation[first] <= WIDE_SHARE * pair.driving.gear.tau]
    if held.size != theta_2.size:
        missing = np.setdiff1d(np.arange(theta_2.size), held)[0]
        raise NoContactError(
            f"no {flank} flanks touch at driven angle {theta_2[missing] / DEG:.4f} deg; "
            "the gears do not reach each other there"
        )


def _fast_closings(
    turning: Body, fixed: Body, *, axis_distance: float, poses: FloatArray, guesses: FloatArray, near: float
) -> Iterator[Closings]:
    """What ``closing_rotations`` finds, by the compiled search, some parts of the positions abreast."""

    # Even parts, so that no thread waits for another long.
    parts = max(1, math.ceil(poses.size / FAST_CHUNK), min(threads(), poses.size // LEAST_CHUNK))
    size = math.ceil(max(poses.size, 1) / parts)

    def searched(start: int) -> Closings:
        part = slice(start, start + size)
        found = closing_rotations_fast(
            turning, fixed, axis_distance=axis_distance, poses=poses[part], guesses=guesses[part], near=near
        )
        return replace(found, pose=found.pose + start)

    # Of no positions one part all the same: a tooth may not mesh in a short recording at all.
    starts = list(range(0, max(1, poses.size), size))
    for k in range(0, len(starts), ABREAST):
        yield from each(searched, starts[k : k + ABREAST])


def certify_some(
    pair: GearPair,
    rows: Closings,
    *,
    flank: Flank,
    poses: FloatArray,
    guesses: FloatArray,
    near: float,
    samples: int,
) -> None:
    """Certify ``samples`` positions of a fast run, as ``radial.spot_check`` does.

    Raises ``SelfCheckError`` where both kernels differ, but ``GeometryError`` where the flanks stand so far off their
    places that neither is sure to know which teeth face each other.
    """
    bodies = pair.driving.body(flank), pair.driven.body(flank)
    try:
        with _POLYGONS:
            spot_check(*bodies, rows, axis_distance=pair.a, poses=poses, guesses=guesses, near=near, samples=samples)
    except SelfCheckError:
        off = sum(one.eccentricity[0] + one.flanks.largest_deviation(flank) for one in (pair.driving, pair.driven))
        if off <= FOLLOWED * pair.driving.gear.p_b:
            raise
        raise GeometryError(
            f"{flank} flanks stand up to {off / UM:.0f} um off their places, more than {FOLLOWED:.0%} of the base "
            f"pitch, so that it is not certain which teeth face each other; check the deviations and eccentricities "
            "and their unit (um)"
        ) from None


def expected_closing(pair: GearPair, flank: Flank) -> float:
    """Driving rotation in rad, in the sense of closing, by which contacts lie beyond those of deviation-free gears at
    tight mesh.

    A larger centre distance parts the flanks by (r_b1 + r_b2)(inv(alpha_w') - inv(alpha_w)) along the line of action,
    missing material by its mean depth (both exact for involutes). It only tells the search where to start.
    """
    parted = 0.0
    if pair.a > pair.r_b1 + pair.r_b2:
        parted = (pair.r_b1 + pair.r_b2) * (inv(pair.alpha_w) - inv(pair.driving.alpha_w))
    material = sum(mounted.flanks.mean_deviation(flank) for mounted in (pair.driving, pair.driven))
    return (parted - material) / pair.r_b1


def _joined(parts: list[Closings]) -> Closings:
    names = Closings.__dataclass_fields__
    return Closings(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in names if name != "positions"},
        positions=sum(part.positions for part in parts),
    )


def touching_rows(
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


def mean_count(
    pair: GearPair,
    theta_2: FloatArray,
    counts: IntArray,
    count_at: Callable[[FloatArray], IntArray],
    *,
    resolution: float,
) -> float:
    """Mean of a number of touching pairs over driven rotations: the contact ratio of the pair as it is.

    ``counts`` (N,) at evenly spaced ``theta_2`` (N,) in rad. Where the count changes from one position to the next,
    ``count_at`` locates the change by halving to ``resolution`` of a pitch, all at once, so that the mean does not
    depend on how the sampling falls on the mesh.
    """
    if theta_2.size < 2:
        return float(np.mean(counts))
    step = float(theta_2[1] - theta_2[0])
    # The last position stands for a step too; where it ends, the count is asked for.
    following = np.append(counts[1:], count_at(theta_2[-1:] + step))
    changes = np.flatnonzero(counts != following)
    low, width = theta_2[changes], step
    while changes.size and width > resolution * pair.driven.gear.tau:
        width *= 0.5
        low = np.where(count_at(low + width) == counts[changes], low + width, low)
    share = (low + 0.5 * width - theta_2[changes]) / step
    between = counts.astype(np.float64)
    between[changes] = share * counts[changes] + (1.0 - share) * following[changes]
    return float(np.mean(between))


def mean_pairs(pair: GearPair, found: FlankContacts, *, resolution: float = 1e-4, fast: bool = False) -> float:
    """Unloaded contact ratio over evenly spaced positions, changes located to ``resolution`` of a pitch."""

    def count_at(theta_2: FloatArray) -> IntArray:
        return contacts(pair, theta_2, flank=found.flank, fast=fast).pairs

    return mean_count(pair, found.theta_2, found.pairs, count_at, resolution=resolution)


def _root_advice(pair: GearPair) -> str:
    """Which roots stand in the way of the mate's tip, and what would leave it free."""
    said = ""
    for name, mounted, mate in (("driving", pair.driving, pair.driven), ("driven", pair.driven, pair.driving)):
        rack, h_aP = mounted.gear.rack, mate.gear.rack.h_aP
        free = free_round(alpha=rack.alpha, h_fP=rack.h_fP, h_aP=h_aP)
        if rack.rho_fP <= free + STANDARD:
            continue
        cure = f"a root_radius of at most {told_at_most(free, 4)}" if free > 0.0 else f"a dedendum above {h_aP:g}"
        said += f"the {name} gear's root_radius = {rack.rho_fP:g} may stand in the way of its mate's tip ({cure} "
        said += "leaves it free); "
    return said


@dataclass(frozen=True, kw_only=True, eq=False)
class Backlash:
    """Lost motion of a pair: ``j_bn`` (N,) normal backlash in mm at each driven rotation of ``drive`` and ``coast``
    contacts."""

    drive: FlankContacts
    coast: FlankContacts
    j_bn: FloatArray


def both_flanks(
    pair: GearPair,
    theta_2: FloatArray,
    *,
    near: float = NEAR_PAIR_MM,
    fast: bool = False,
    progress: Progress = _no_progress,
) -> Backlash:
    """Drive and coast contacts at ``theta_2`` (N,) in rad, and the backlash between them, j_bn = (TE_coast -
    TE_drive) r_b2.

    Raises ``JammedError`` where there is none left.
    """
    drive = contacts(pair, theta_2, flank="drive", near=near, fast=fast, progress=progress)
    coast = contacts(pair, theta_2, flank="coast", near=near, fast=fast, progress=progress)
    j_bn = (coast.te - drive.te) * pair.r_b2
    worst = int(np.argmin(j_bn))
    if j_bn[worst] < -JAM:
        teeth = [int(f.driving[np.searchsorted(f.position, worst)]) for f in (drive, coast)]
        mates = [int(f.driven[np.searchsorted(f.position, worst)]) for f in (drive, coast)]
        raise JammedError(
            f"the gears jam: at driven angle {theta_2[worst] / DEG:.3f} deg the teeth overlap by "
            f"{-j_bn[worst] / UM:.3f} um "
            f"(drive flank: driving tooth {teeth[0]} on driven {mates[0]}; coast flank: {teeth[1]} on {mates[1]}); "
            f"{_root_advice(pair)}thin the teeth (tooth_thickness_um, E_sns_um) or enlarge centre_distance_mm"
        )
    return Backlash(drive=drive, coast=coast, j_bn=j_bn)
