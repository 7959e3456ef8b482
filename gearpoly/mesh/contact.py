"""First touch of two toothed bodies by certified polygon collision: outlines, axes and poses in, closing rotations
out.

Nothing here knows what a gear is. A *turning* body turns counter-clockwise about the origin towards a *fixed* body
that stands on its own axis at a given pose. For every pose and every pair of near teeth the kernel returns the
rotation at which the two faces first touch, the point, the common normal and what touches.

Candidates come from an STRtree. The rotation is found by bisection with a time-of-impact guess on windows of few
points, coarse to fine, for all poses at once (``impact``). Every answer is then certified on the whole faces, and
solved again where that fails; pairs that the windows left out are shown to stand clear on whole faces, or solved
(``certificate``). Nothing uncertified leaves the kernel, and no near pair is missing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np
import shapely

from gearpoly.mesh.bodies import (
    Body,
    ComplexArray,
    Jobs,
    Meeting,
    complex_points,
    coordinates,
    lines,
)
from gearpoly.mesh.certificate import HALF_BRACKET, certify, overlapping, uncertified
from gearpoly.mesh.features import Feature as Feature  # part of what Closings says
from gearpoly.mesh.features import describe
from gearpoly.mesh.impact import coarse, refine
from gearpoly.units import BoolArray, FloatArray, IntArray

CHUNK = 384
"""Poses worked at once; keeps each chunk's whole faces (poses x pairs x 2000 points x 16 bytes) near the processor's
cache."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Closings:
    """Certified closing rotations, one row per pose and near pair, sorted by pose and then by rotation.

    ``pose`` index of the pose; ``turning``, ``fixed`` teeth; ``rotation`` of the turning body beyond the guess in
    rad; ``point`` (k, 2) in mm and unit ``normal`` (k, 2), in the fixed frame, from the turning into the fixed body;
    ``feature`` which touches; ``overrun`` in rad: how far the mate's tangent has turned past the corner's own flank
    (0 on flanks). ``repaired`` says which rows had to be solved again on whole faces; ``positions`` poses were
    worked, touching or not.
    """

    positions: int
    pose: IntArray
    turning: IntArray
    fixed: IntArray
    rotation: FloatArray
    point: FloatArray
    normal: FloatArray
    feature: IntArray
    overrun: FloatArray
    repaired: BoolArray

    def at(self, poses: IntArray) -> Closings:
        """The rows of these ``poses`` (k,), rising, which are counted anew from 0."""
        rows = np.flatnonzero(np.isin(self.pose, poses))
        arrays = {f.name: getattr(self, f.name)[rows] for f in fields(self) if f.name not in ("positions", "pose")}
        return Closings(positions=poses.size, pose=np.searchsorted(poses, self.pose[rows]), **arrays)

    def first(self) -> IntArray:
        """Row of the first touch of each pose that has any."""
        return np.flatnonzero(np.diff(self.pose, prepend=-1))


def closing_rotations(
    turning: Body,
    fixed: Body,
    *,
    axis_distance: float,
    poses: FloatArray,
    guesses: FloatArray,
    near: float,
) -> Iterator[Closings]:
    """Certified first touches of all near pairs, a chunk of poses at a time.

    ``axis_distance`` in mm from the turning body's axis (the origin) to the fixed body's, along +x. ``poses`` (N,):
    angle of the fixed body in rad. ``guesses`` (N,): rotation of the turning body in rad near which it touches
    (within a quarter of a tooth). ``near`` in rad: pairs that close within this of the first are returned too. Yields
    ``Closings`` whose ``pose`` counts over all poses. Raises ``NotConvergedError`` if a contact cannot be certified.
    """
    m = Meeting(turning=turning, fixed=fixed, a=axis_distance)
    tree = shapely.STRtree(shapely.polygons(turning.hulls))
    for start in range(0, poses.size, CHUNK):
        part = slice(start, start + CHUNK)
        jobs, repaired = _solve(m, tree, poses[part], guesses[part], near=near)
        yield _describe(m, jobs, repaired, start=start, positions=poses[part].size, near=near)


def all_certified(
    turning: Body,
    fixed: Body,
    known: Closings,
    *,
    axis_distance: float,
    poses: FloatArray,
    guesses: FloatArray,
    near: float,
) -> bool:
    """Whether closings that are ``known`` of all ``poses`` pass the certificate as they stand: each pair clear on whole
    faces just before and crossing just after, and no other pair in contact by where the last that is near closes.
    Arguments as for ``closing_rotations``."""
    m = Meeting(turning=turning, fixed=fixed, a=axis_distance)
    turn, back = np.exp(1j * poses)[known.pose], np.exp(-1j * guesses)[known.pose]
    place = complex_points(known.point) * back * np.exp(-1j * known.rotation)
    jobs = Jobs(
        known.pose, known.turning, known.fixed, turn, back, known.rotation.copy(),
        np.argmin(np.abs(m.turning.points[known.turning] - place[:, None]), axis=1), np.zeros_like(known.pose),
    )  # fmt: skip
    seen = jobs.seen(m, m.fixed.points[jobs.fixed], jobs.rotation)
    jobs.at_fixed = np.argmin(np.abs(seen - place[:, None]), axis=1)
    tree = shapely.STRtree(shapely.polygons(m.turning.hulls))
    return not np.any(uncertified(m, jobs)) and len(_missed(m, tree, jobs, poses, guesses, near=near)) == 0


def _solve(
    m: Meeting, tree: shapely.STRtree, poses: FloatArray, guesses: FloatArray, *, near: float
) -> tuple[Jobs, BoolArray]:
    """Certified touches of all near pairs of a chunk; poses that touch far from their guess are searched around
    again. The last of those that are near closes ``near`` after the first, wherever that is."""
    jobs = coarse(m, _candidates(m, tree, poses, guesses, slack=m.back_off + max(m.back_off, near)), near=near)
    refine(m, jobs)
    first = _first_rotation(jobs, poses.size)
    far = np.flatnonzero(~(np.abs(first) <= m.back_off))
    if far.size:
        again = coarse(m, _candidates(m, tree, poses[far], guesses[far], slack=m.wide + near), near=near)
        again.pose = far[again.pose]
        refine(m, again)
        jobs = jobs.take(~np.isin(jobs.pose, far)).joined(again)
    repaired = certify(m, jobs)
    missed = _missed(m, tree, jobs, poses, guesses, near=near)
    if len(missed) == 0:
        return jobs, repaired
    repaired = np.concatenate((repaired, certify(m, missed)))
    return jobs.joined(missed), repaired


def _missed(
    m: Meeting, tree: shapely.STRtree, jobs: Jobs, poses: FloatArray, guesses: FloatArray, *, near: float
) -> Jobs:
    """Pairs that ``jobs`` left out and that do not stand clear on whole faces where the last near pair closes.

    The thinned faces that chose the jobs end at the true form circle, but a mate's tip also touches below it, on the
    fillet of an undercut pinion or at the end of a worn flank.
    """
    first = _first_rotation(jobs, poses.size)
    last = np.where(np.isfinite(first), first + near, m.wide)

    def others(at: IntArray, rotation: FloatArray, known: Jobs, near_by: shapely.STRtree) -> Jobs:
        """Pairs beside ``known`` that do not stand clear at ``rotation`` (at,) beyond the guess of the poses ``at``."""
        found = _candidates(m, near_by, poses[at], guesses[at] + rotation, slack=0.0)
        found.rotation, found.back = rotation[found.pose], np.exp(-1j * guesses[at])[found.pose]
        found.pose = at[found.pose]
        found = found.take(~np.isin(_pair_keys(m, found), _pair_keys(m, known)))
        return found.take(overlapping(m, found))

    missed = others(np.arange(poses.size), last, jobs, tree)
    # Where contact is far from its guess, or was not found at all, tips may have gone in deep by then, or touch and
    # pass before that.
    far = np.flatnonzero(~(np.abs(first) <= m.back_off))
    back, solid = 0.0, shapely.STRtree(shapely.polygons(m.turning.solid_hulls)) if far.size else tree
    while far.size:
        missed = missed.joined(others(far, last[far] - back, jobs.joined(missed), solid))
        back += m.turning.tip
        far = far[last[far] - back > -m.wide]
    return missed


def _pair_keys(m: Meeting, jobs: Jobs) -> IntArray:
    """One number (jobs,) for each pose and pair of teeth."""
    return np.asarray((jobs.pose * m.turning.faces.shape[0] + jobs.turning) * m.fixed.faces.shape[0] + jobs.fixed)


def _first_rotation(jobs: Jobs, positions: int) -> FloatArray:
    """First touch (positions,) in rad beyond the guess, inf where nothing touches."""
    first = np.full(positions, np.inf)
    np.minimum.at(first, jobs.pose, jobs.rotation)
    return first


def mirrored(body: Body) -> Body:
    """``body`` seen in the line of centres: its clockwise faces become counter-clockwise ones."""
    flip = np.array([1.0, -1.0])
    return Body(faces=body.faces * flip, backs=body.backs * flip, working=body.working)


def _candidates(m: Meeting, tree: shapely.STRtree, poses: FloatArray, guesses: FloatArray, *, slack: float) -> Jobs:
    """Pairs whose hulls come together within ``slack`` rad of the guess, from the tree of the turning teeth."""
    turn, back = np.exp(1j * poses), np.exp(-1j * guesses)
    hulls = complex_points(m.fixed.hulls)
    at = hulls[None] * turn[:, None, None] + m.a
    # A fixed tooth wholly outside the turning body's reach cannot touch it; turning does not change radii.
    pose, tooth = np.nonzero(np.min(np.abs(at), axis=2) <= m.turning.reach)
    seen = at[pose, tooth] * back[pose, None]
    margin = slack * m.turning.reach
    boxes = shapely.box(
        seen.real.min(axis=1) - margin, seen.imag.min(axis=1) - margin,
        seen.real.max(axis=1) + margin, seen.imag.max(axis=1) + margin,
    )  # fmt: skip
    row, mate = tree.query(boxes)
    pose, tooth = pose[row], tooth[row]
    held = ~_out_of_reach(m, turn[pose], tooth, mate)
    pose, tooth, mate = pose[held], tooth[held], mate[held]
    order = np.lexsort((mate, tooth, pose))
    pose, tooth, mate = pose[order], tooth[order], mate[order]
    zero = np.zeros(pose.size, dtype=np.int64)
    return Jobs(
        pose, mate, tooth, turn[pose], back[pose], np.full(pose.size, -m.back_off), zero, zero,
    )  # fmt: skip


def _out_of_reach(m: Meeting, turn: ComplexArray, tooth: IntArray, mate: IntArray) -> BoolArray:
    """Which pairs (rows,) have no radius in common: broken teeth pass each other by, however close, and such a pair
    would be followed for ever."""
    out = np.zeros(tooth.size, dtype=bool)
    reach = m.turning.reaches[mate]
    doubtful = np.flatnonzero(np.abs(m.fixed.points[tooth, -1] * turn + m.a) > reach)
    if doubtful.size:
        faces = lines(m.fixed.points[tooth[doubtful]] * turn[doubtful, None] + m.a)
        out[doubtful] = shapely.distance(faces, shapely.Point(0.0, 0.0)) > reach[doubtful]
    return out


def _describe(m: Meeting, jobs: Jobs, repaired: BoolArray, *, start: int, positions: int, near: float) -> Closings:
    """Contact points, normals and features from the witness lines just before the touch."""
    rows = np.arange(len(jobs))
    before = jobs.rotation - HALF_BRACKET
    at = jobs.windows(m)
    mine = m.turning.points[jobs.turning[:, None], at[0]]
    mates = jobs.seen(m, m.fixed.points[jobs.fixed[:, None], at[1]], before)
    ends = complex_points(shapely.get_coordinates(shapely.shortest_line(lines(mine), lines(mates))).reshape(-1, 2, 2))
    places = [_place(line, end) for line, end in ((mine, ends[:, 0]), (mates, ends[:, 1]))]
    frame = jobs.back * np.exp(-1j * before)
    # Polylines touch with a vertex of one on an edge of the other: the vertex is the one nearer to its witness end.
    to_vertex = [
        np.abs(line[rows, np.rint(place).astype(np.int64)] - end)
        for line, place, end in ((mine, places[0], ends[:, 0]), (mates, places[1], ends[:, 1]))
    ]
    normal, feature, overrun = describe(
        m.turning,
        m.fixed,
        teeth=(jobs.turning, jobs.fixed),
        places=(at[0][:, 0] + places[0], at[1][:, 0] + places[1]),
        turning_is_vertex=to_vertex[0] <= to_vertex[1],
        spin=jobs.turn * frame,
    )
    first = _first_rotation(jobs, positions)
    order = np.lexsort((jobs.rotation, jobs.pose))
    order = order[(jobs.rotation <= first[jobs.pose] + near)[order]]
    world = (ends[:, 0] / frame)[order]
    return Closings(
        positions=positions,
        pose=jobs.pose[order] + start,
        turning=jobs.turning[order],
        fixed=jobs.fixed[order],
        rotation=jobs.rotation[order],
        point=coordinates(world),
        normal=coordinates((normal / frame)[order]),
        feature=feature[order],
        overrun=overrun[order],
        repaired=repaired[order],
    )


def _place(line: ComplexArray, point: ComplexArray) -> FloatArray:
    """Where along each window (jobs, k) its own ``point`` (jobs,) lies, as vertex number plus share of the edge."""
    edge = np.diff(line, axis=1)
    along = ((point[:, None] - line[:, :-1]) * edge.conj()).real / np.abs(edge) ** 2
    share = np.clip(along, 0.0, 1.0)
    off = np.abs(line[:, :-1] + share * edge - point[:, None])
    best = np.argmin(off, axis=1)
    place: FloatArray = best + share[np.arange(len(best)), best]
    return place
