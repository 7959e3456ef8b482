"""The exact closing rotation of two polylines, one of which turns about the origin: the judge of
contact.

In polar coordinates about the turning axis a rotation only shifts the angle. So a pair of facing
faces touches first where the difference of polar angles *at equal radius* is least. A straight edge
at distance p from the origin has dphi/dr = +-p / (r sqrt(r^2 - p^2)); for two edges the difference
of these changes sign nowhere (or vanishes everywhere), so on every common stretch of two edges the
least lies at an end of the stretch. Ends are vertices of either polyline, tip corners included, and
the feet of perpendiculars from the origin, where an edge turns round in radius. Feet are inserted
as vertices, each polyline falls into runs that are monotonic in radius, and every pair of runs is
merged like two sorted lists. Nothing is dropped: fillets, root lands and far teeth go through the
same code. What is not in the faces (tip lands, the other side of a tooth) is not seen.

Derived here. This file shares no code with the package that it judges.

Signs. The turning body's faces are given about the origin at rotation 0, the fixed body's about its
own axis at pose 0. A rotation and a pose are counter-clockwise (a driven gear that has advanced by
theta_2 has pose -theta_2). `sense=+1`: the body turns counter-clockwise until it touches, and
`first` is the least closing rotation. `sense=-1`: the mirror image (y -> -y), and `first` is the
greatest. Lengths in mm, angles in rad.
"""

# numba ships no type information and infers the types of compiled functions from their arguments.
# mypy: disable-error-code="import-untyped, untyped-decorator, no-untyped-def, no-untyped-call"

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

# A pair counts as facing when it closes no earlier than this part of a turning pitch before the
# guess. A tooth that has already passed closes a whole pitch earlier than the one that faces, and
# the widest gap of a facing pair is under 3/4 pitch (a tooth fills the rest), so any part up to 1/4
# works. Larger: passed teeth are taken for contact. Smaller: the guess has to be better.
BACK = 0.25

# How many turning teeth are tried for one fixed tooth, counting from one pitch too early.
TRIES = 4

# Tolerance in t on a segment of the slow formulation: closes the seams between segments in extended
# precision (eps 1e-19). On a 3 um edge it is 3e-18 mm.
SEAM = 1e-15


class Closing(NamedTuple):
    """First touch of the whole bodies: N positions."""

    rotation: FloatArray  # (N,) rad; nan where no pair shares a radius
    pair: IntArray  # (N, 2) turning and fixed tooth; -1 where none
    offset: FloatArray  # (N,) rotation - guess, precise to 1e-15 rad however large the guess
    radius: FloatArray  # (N,) mm, where it touches, about the turning axis


class PairClosings(NamedTuple):
    """Closing rotations of the facing pairs, nearest first: N positions, up to K pairs."""

    rotation: FloatArray  # (N, K) rad, nan beyond the last pair
    pair: IntArray  # (N, K, 2), -1 beyond the last pair
    offset: FloatArray  # (N, K) rotation - guess
    radius: FloatArray  # (N, K) mm


@njit(cache=True, nogil=True)
def _runs(x, y, r2, runs, source, cos_b, sin_b, shift_x, shift_y):
    """Move a polyline, insert the feet of its edges, find its monotonic runs.

    Returns the numbers of points and of runs; run k is the index range runs[k]..runs[k + 1].
    """
    count = 0
    for k in range(source.shape[0]):
        u = cos_b * source[k, 0] - sin_b * source[k, 1] + shift_x
        v = sin_b * source[k, 0] + cos_b * source[k, 1] + shift_y
        if count > 0:
            px = x[count - 1]
            py = y[count - 1]
            dx = u - px
            dy = v - py
            start = px * dx + py * dy
            if start < 0.0 and u * dx + v * dy > 0.0:
                t = -start / (dx * dx + dy * dy)
                x[count] = px + t * dx
                y[count] = py + t * dy
                r2[count] = x[count] * x[count] + y[count] * y[count]
                count += 1
        x[count] = u
        y[count] = v
        r2[count] = u * u + v * v
        count += 1
    n_runs = 0
    runs[0] = 0
    direction = 0
    for k in range(1, count):
        step = r2[k] - r2[k - 1]
        now = 1 if step > 0.0 else (-1 if step < 0.0 else direction)
        if direction != 0 and now != direction:
            n_runs += 1
            runs[n_runs] = k - 1
        direction = now
    n_runs += 1
    runs[n_runs] = count - 1
    return count, n_runs


@njit(cache=True, nogil=True, inline="always")
def _on_edge(ux, uy, u2, vx, vy, rho2):
    """The point of edge u -> v (radius rising) on the circle of squared radius rho2."""
    dx = vx - ux
    dy = vy - uy
    b = ux * dx + uy * dy
    c = rho2 - u2
    # This root of dd t^2 + 2 b t - c = 0 has no cancellation for b >= 0.
    denominator = b + math.sqrt(max(b * b + (dx * dx + dy * dy) * c, 0.0))
    t = c / denominator if denominator > 0.0 else 0.0
    return ux + t * dx, uy + t * dy


@njit(cache=True, nogil=True, inline="always")
def _key(cross, dot, rho2):
    """Monotonic in the angle over -pi..pi, cheaper than the angle: its sine, continued."""
    s = cross / rho2
    if dot < 0.0:
        s = 2.0 - s if s >= 0.0 else -2.0 - s
    return s


@njit(cache=True, nogil=True)
def _at_or_above(r2, first, step, size, value):
    """Place in a run (radius rising from `first`) of the first vertex with r2 >= value."""
    low, high = 0, size
    while low < high:
        middle = (low + high) // 2
        if r2[first + step * middle] < value:
            low = middle + 1
        else:
            high = middle
    return low


@njit(cache=True, nogil=True)
def _merge(best, ax, ay, ar, a_from, a_to, bx, by, br, b_from, b_to):
    """Improve best = (key, cross, dot, r2) over a run of the turning and one of the fixed."""
    key_best, cross_best, dot_best, r2_best = best
    if ar[a_from] > ar[a_to]:
        a_from, a_to = a_to, a_from
    if br[b_from] > br[b_to]:
        b_from, b_to = b_to, b_from
    low = max(ar[a_from], br[b_from])
    if low > min(ar[a_to], br[b_to]):
        return best
    a_step = 1 if a_to >= a_from else -1
    b_step = 1 if b_to >= b_from else -1
    na = abs(a_to - a_from) + 1
    nb = abs(b_to - b_from) + 1
    i = a_from + a_step * _at_or_above(ar, a_from, a_step, na, low)
    j = b_from + b_step * _at_or_above(br, b_from, b_step, nb, low)
    a_end = a_to + a_step
    b_end = b_to + b_step
    while i != a_end and j != b_end:
        if ar[i] <= br[j]:
            rho2 = ar[i]
            px, py = ax[i], ay[i]
            if j == b_from:  # equal least radii: the vertex itself
                qx, qy = bx[j], by[j]
            else:
                k = j - b_step
                qx, qy = _on_edge(bx[k], by[k], br[k], bx[j], by[j], rho2)
            i += a_step
        else:
            rho2 = br[j]
            qx, qy = bx[j], by[j]
            k = i - a_step  # exists: the turning run begins below this radius
            px, py = _on_edge(ax[k], ay[k], ar[k], ax[i], ay[i], rho2)
            j += b_step
        # P x (Q - P) rather than P x Q: near contact the difference is exact.
        dx = qx - px
        dy = qy - py
        cross = px * dy - py * dx
        dot = rho2 + px * dx + py * dy
        # The division of _key only where it can win: most candidates lose without it.
        if dot < 0.0 or cross < key_best * rho2:
            key = _key(cross, dot, rho2)
            if key < key_best:
                key_best, cross_best, dot_best, r2_best = key, cross, dot, rho2
    return key_best, cross_best, dot_best, r2_best


@njit(cache=True, nogil=True)
def _pair_gap(ax, ay, ar, a_runs, a_n, bx, by, br, b_runs, b_n):
    """Least angle from turning to fixed face at equal radius, and its squared radius, or inf."""
    best = (np.inf, 0.0, 1.0, 0.0)
    for p in range(a_n):
        for q in range(b_n):
            best = _merge(best, ax, ay, ar, a_runs[p], a_runs[p + 1], bx, by, br, b_runs[q], b_runs[q + 1])
    if best[0] == np.inf:
        return np.inf, 0.0
    return math.atan2(best[1], best[2]), best[3]


@njit(cache=True, nogil=True)
def _probe(ax, ay, ar, a_runs, a_n, qx, qy, q2):
    """One candidate, a vertex of the fixed face against the turning face: never below the least."""
    angle = np.inf
    for p in range(a_n):
        first, last = a_runs[p], a_runs[p + 1]
        if ar[first] > ar[last]:
            first, last = last, first
        if ar[first] < q2 <= ar[last]:
            step = 1 if last >= first else -1
            k = first + step * _at_or_above(ar, first, step, abs(last - first) + 1, q2)
            h = k - step
            px, py = _on_edge(ax[h], ay[h], ar[h], ax[k], ay[k], q2)
            angle = min(angle, math.atan2(px * qy - py * qx, px * qx + py * qy))
    return angle


@njit(cache=True, nogil=True)
def _bulk(turning, fixed, axis_distance, poses, guesses, back, window, size):
    """All positions of sense +1; see closing_rotations_of_pairs."""
    z1, n, _ = turning.shape
    z2, m, _ = fixed.shape
    # The turning faces never move: the fixed body is turned back by the guess instead.
    ax = np.empty((z1, 2 * n))
    ay = np.empty((z1, 2 * n))
    ar = np.empty((z1, 2 * n))
    a_runs = np.empty((z1, 2 * n + 1), np.int64)
    a_n = np.empty(z1, np.int64)
    tip = np.empty(z1)
    reach2 = 0.0
    for i in range(z1):
        count, a_n[i] = _runs(ax[i], ay[i], ar[i], a_runs[i], turning[i], 1.0, 0.0, 0.0, 0.0)
        tip[i] = math.atan2(turning[i, n - 1, 1], turning[i, n - 1, 0])
        reach2 = max(reach2, ar[i, :count].max())
    centre = np.empty((z2, 2))
    extent = np.empty(z2)
    for j in range(z2):
        for axis in range(2):
            centre[j, axis] = 0.5 * (fixed[j, :, axis].min() + fixed[j, :, axis].max())
        extent[j] = 0.0
        for k in range(m):
            dx = fixed[j, k, 0] - centre[j, 0]
            dy = fixed[j, k, 1] - centre[j, 1]
            extent[j] = max(extent[j], math.sqrt(dx * dx + dy * dy))
    bx = np.empty(2 * m)
    by = np.empty(2 * m)
    br = np.empty(2 * m)
    b_runs = np.empty(2 * m + 1, np.int64)

    offset = np.full((poses.size, size), np.inf)
    radius2 = np.zeros((poses.size, size))
    pair = np.full((poses.size, size, 2), -1, np.int64)
    pitch = 2.0 * math.pi / z1
    for p in range(poses.size):
        cg, sg = math.cos(guesses[p]), math.sin(guesses[p])
        cp, sp = math.cos(poses[p]), math.sin(poses[p])
        # Sine and cosine of pose - guess from products: subtracting two large angles would round.
        cos_b, sin_b = cp * cg + sp * sg, sp * cg - cp * sg
        shift_x, shift_y = axis_distance * cg, -axis_distance * sg
        for j in range(z2):
            u = cos_b * centre[j, 0] - sin_b * centre[j, 1] + shift_x
            v = sin_b * centre[j, 0] + cos_b * centre[j, 1] + shift_y
            if math.sqrt(u * u + v * v) - extent[j] > math.sqrt(reach2):
                continue  # whole face outside the circle that the turning body sweeps
            count, b_n = _runs(bx, by, br, b_runs, fixed[j], cos_b, sin_b, shift_x, shift_y)
            near = 0
            for k in range(count):
                if br[k] < br[near]:
                    near = k
            if br[near] > reach2:
                continue
            angle = math.atan2(by[near], bx[near])
            begin = -back - pitch
            for _ in range(TRIES):
                # The next turning tooth clockwise whose tip corner lies `begin` or more behind.
                i, gap_i = -1, np.inf
                for k in range(z1):
                    gap = (angle - tip[k] - begin) % (2.0 * math.pi)
                    if gap < gap_i:
                        i, gap_i = k, gap
                begin += gap_i + 0.5 * pitch
                if _probe(ax[i], ay[i], ar[i], a_runs[i], a_n[i], bx[near], by[near], br[near]) < (-back):
                    continue  # has passed
                value, r2 = _pair_gap(ax[i], ay[i], ar[i], a_runs[i], a_n[i], bx, by, br, b_runs, b_n)
                if value < -back:
                    continue
                if value <= window:
                    at = size
                    while at > 0 and value < offset[p, at - 1]:
                        at -= 1
                    for k in range(size - 1, at, -1):
                        offset[p, k] = offset[p, k - 1]
                        radius2[p, k] = radius2[p, k - 1]
                        pair[p, k] = pair[p, k - 1]
                    if at < size:
                        offset[p, at] = value
                        radius2[p, at] = r2
                        pair[p, at, 0] = i
                        pair[p, at, 1] = j
                break  # later turning teeth close a pitch later
    return offset, pair, radius2


def closing_rotations_of_pairs(
    turning_faces: FloatArray,
    fixed_faces: FloatArray,
    *,
    axis_distance: float,
    poses: FloatArray,
    guesses: FloatArray,
    sense: int = 1,
    count: int = 4,
    window: float = math.inf,
    back: float | None = None,
) -> PairClosings:
    """Closing rotations of all facing pairs, nearest first, from every vertex of every face.

    turning_faces (z1, n, 2) about the origin, fixed_faces (z2, m, 2) about their own axis, which
    stands at (axis_distance, 0), root to tip, mm; poses and guesses (N,) rad. For each fixed tooth
    exactly one turning tooth faces it: the first that closes no earlier than `back` before the
    guess (default BACK of a turning pitch), so the guess must be within `back` of every pair that
    counts and the turning teeth must stand a pitch apart to about 1/8. `window` drops pairs that
    close later than that after the guess; `count` is K. Derived here.
    """
    mirror = np.array([1.0, float(sense)])
    if back is None:
        back = BACK * 2.0 * math.pi / turning_faces.shape[0]
    guesses = np.ascontiguousarray(guesses, dtype=np.float64)
    offset, pair, radius2 = _bulk(
        np.ascontiguousarray(turning_faces * mirror),
        np.ascontiguousarray(fixed_faces * mirror),
        float(axis_distance),
        np.ascontiguousarray(poses, dtype=np.float64) * sense,
        guesses * sense,
        float(back),
        float(window),
        int(count),
    )
    none = np.isinf(offset)
    offset = np.where(none, np.nan, offset) * sense
    radius = np.where(none, np.nan, np.sqrt(radius2))
    return PairClosings(guesses[:, None] + offset, pair, offset, radius)


def closing_rotations(
    turning_faces: FloatArray,
    fixed_faces: FloatArray,
    *,
    axis_distance: float,
    poses: FloatArray,
    guesses: FloatArray,
    sense: int = 1,
    back: float | None = None,
) -> Closing:
    """First touch of the turning with the fixed body; see closing_rotations_of_pairs."""
    all_pairs = closing_rotations_of_pairs(
        turning_faces,
        fixed_faces,
        axis_distance=axis_distance,
        poses=poses,
        guesses=guesses,
        sense=sense,
        count=1,
        back=back,
    )
    return Closing(
        all_pairs.rotation[:, 0],
        all_pairs.pair[:, 0],
        all_pairs.offset[:, 0],
        all_pairs.radius[:, 0],
    )


def closing_rotation(
    turning_face: FloatArray,
    fixed_face: FloatArray,
    *,
    axis: tuple[float, float],
    pose: float,
    rotation_guess: float,
    sense: int = 1,
) -> tuple[float, float]:
    """Closing rotation of one facing pair, and the same less the guess.

    turning_face (n, 2) about the origin, fixed_face (m, 2) about `axis`, mm; pose and guess rad.
    The answer lies within half a turn of the guess; (nan, nan) where the faces share no radius.
    """
    cg, sg = math.cos(rotation_guess), sense * math.sin(rotation_guess)
    cp, sp = math.cos(pose), sense * math.sin(pose)
    x, y = axis[0], sense * axis[1]
    mirror = np.array([1.0, float(sense)])
    sides = []
    for face, move in (
        (turning_face * mirror, (1.0, 0.0, 0.0, 0.0)),
        (
            fixed_face * mirror,
            (cp * cg + sp * sg, sp * cg - cp * sg, x * cg + y * sg, y * cg - x * sg),
        ),
    ):
        room = 2 * face.shape[0]
        px, py, r2 = np.empty(room), np.empty(room), np.empty(room)
        runs = np.empty(room + 1, np.int64)
        _, n_runs = _runs(px, py, r2, runs, np.ascontiguousarray(face), *move)
        sides.append((px, py, r2, runs, n_runs))
    offset = float(_pair_gap(*sides[0], *sides[1])[0])
    if math.isinf(offset):
        return math.nan, math.nan
    return rotation_guess + sense * offset, sense * offset


def closing_rotation_slow(
    turning_face: FloatArray,
    fixed_face: FloatArray,
    *,
    axis: tuple[float, float],
    pose: float,
    rotation_guess: float,
) -> float:
    """Closing rotation less the guess of one pair (sense +1), by brute force in extended precision.

    Every vertex of either against every segment of the other, both roots of the circle, no runs, no
    sorting, no feet: an extremal radius inside a segment is a double root, and beside it the least
    lies on one of the branches. inf where nothing is shared.
    """
    wide = np.longdouble
    turn, fix = turning_face.astype(wide), fixed_face.astype(wide)

    def rotated(points: npt.NDArray[np.longdouble], angle: float) -> npt.NDArray[np.longdouble]:
        c, s = np.cos(wide(angle)), np.sin(wide(angle))
        return np.stack([c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]], 1)

    turn = rotated(turn, rotation_guess)
    fix = rotated(fix, pose) + np.array(axis, dtype=wide)
    least = math.inf
    for vertices, line, sign in ((turn, fix, 1), (fix, turn, -1)):
        u, d = line[:-1], np.diff(line, axis=0)
        dd = (d * d).sum(1)
        b = (u * d).sum(1)
        c = (u * u).sum(1)[None, :] - (vertices * vertices).sum(1)[:, None]
        square = b[None, :] ** 2 - dd[None, :] * c
        root = np.sqrt(np.maximum(square, 0))
        for branch in (-1, 1):
            t = (-b[None, :] + branch * root) / dd[None, :]
            row, column = np.nonzero((square >= 0) & (t >= -SEAM) & (t <= 1 + SEAM))
            point = u[column] + t[row, column][:, None] * d[column]
            p = vertices[row]
            cross = p[:, 0] * point[:, 1] - p[:, 1] * point[:, 0]
            angle = sign * np.arctan2(cross, (p * point).sum(1))
            if angle.size:
                least = min(least, float(angle.min()))
    return least
