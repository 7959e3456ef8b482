"""The radial gap of two polylines by branch and bound over blocks of edges, compiled; importing this imports numba.

About the turning axis a rotation only shifts polar angles, so two faces first touch by the least difference of their
polar angles at equal radius (kernel.md, "Radial gap"). For two straight edges on which the radius rises (or falls)
throughout, that difference is monotonic in the radius: dphi/dr = p / (r sqrt(r^2 - p^2)) with p the signed distance
of an edge's line from the axis, and this rises with p at every r. So the least lies where a vertex of either face, or
the foot of the perpendicular from the axis on an edge, stands at the radius of a point of the other.

Lower bound for two blocks. All points of a block lie on the clockwise side of a line along its chord, set off by the
block's farthest point. On each circle about the axis that side is one arc, which ends counter-clockwise where the
line leaves the circle outwards, and begins where a line that runs inwards enters it. Hence the gap between the two
lines is never above that between the blocks, and it is monotonic too: its least over the radii that the blocks share
lies at an end of these. Blocks of which that cannot be said (the line misses the circle, runs the other way, or stands
more than a quarter turn off) are split without judgement. Halving blocks ends at ``LEAF`` edges, where every vertex
is tried. What is pruned cannot hold a smaller gap, however rough the faces are: no step assumes that they are smooth.

Gaps are compared by their sines, which rise with them within a quarter turn.

All compiled code stands in this one file: numba keeps what it compiled until a function's own file changes, and would
not notice a change in another.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

import numpy as np
from numba import njit

from gearpoly.units import BoolArray, FloatArray, IntArray

P = ParamSpec("P")
R = TypeVar("R")

LEAF = 8
"""Edges in the smallest blocks. Fewer make more blocks to bound, more make more vertices to try; 6 to 12 cost the
same. It decides nothing but speed."""

PASSED = 0.25
"""Turning pitches. A pair that closes earlier than this before the guess has passed and is not counted. A tooth and a
space fill a pitch, so passed pairs close by more than both tips' thickness early; the guess has to be better than
this."""

FIRST_AHEAD = 1.25
"""Turning pitches by which the first turning tooth that is tried may lie ahead of the fixed tip: further ahead, it has
passed on any radius that it shares with the fixed tooth."""

TRIES = 5
"""Turning teeth tried per fixed tooth, from START on clockwise; later ones close more than a pitch late."""

BLOCK_MARGIN = 1e-13
"""mm. Blocks are drawn larger by this, ten times the rounding of coordinates, so that a vertex on a border is in."""

_NONE, _OPEN = 2.0, -2.0  # beyond any sine: no common radius; nothing can be said
_UNIT, _OFF, _ALONG, _RADII = 0, 2, 4, 6  # where a block's chord, offsets, extents and squared radii stand in its row
_ROW = 8
_SORTED = 192  # block pairs in store up to which they stand in the order of their bounds; beyond, the newest is next
_STORE = 256  # more than _SORTED by the 62 halvings that two faces of 2^31 blocks could take


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """``function`` compiled by numba at its first call, and kept on disk where there is a place to keep it."""
    return _compiled(function, inline=False)


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """As ``compiled``, put in the place of its calls: a quarter of a search is calls of ``_bound`` otherwise."""
    return _compiled(function, inline=True)


def _compiled(function: Callable[P, R], *, inline: bool) -> Callable[P, R]:
    try:
        made = njit(cache=True, nogil=True, forceinline=inline)(function)
    except RuntimeError:  # numba's word for: neither the package's folder nor the user's is writable
        made = njit(nogil=True, forceinline=inline)(function)
    return cast("Callable[P, R]", made)


@compiled
def blocks(faces: FloatArray) -> FloatArray:
    """Bounds (z, 2^k, 8) of the blocks of faces (z, n, 2) in mm, as a heap: block b splits into 2 b and 2 b + 1.

    Of a block: its chord's unit vector, then least and greatest offset to its left and extent along it from the
    origin, mm, then least and greatest squared distance from the origin, mm^2.
    """
    z, n, _ = faces.shape
    count = 1
    while count * LEAF < n - 1:
        count *= 2
    out = np.zeros((z, 2 * count, _ROW))
    for t in range(z):
        for b in range(1, 2 * count):
            span = count
            first = b
            while first < count:  # the leftmost leaf below b
                first *= 2
            top = b
            while top > 1:
                top //= 2
                span //= 2
            start = (first - count) * (n - 1) // count
            end = (first - count + span) * (n - 1) // count
            ux = faces[t, end, 0] - faces[t, start, 0]
            uy = faces[t, end, 1] - faces[t, start, 1]
            length = math.hypot(ux, uy)
            if length > 0.0:
                ux, uy = ux / length, uy / length
            else:
                ux, uy = 1.0, 0.0
            row = out[t, b]
            row[_UNIT], row[_UNIT + 1] = ux, uy
            row[_OFF], row[_ALONG], row[_RADII] = np.inf, np.inf, np.inf
            row[_OFF + 1], row[_ALONG + 1], row[_RADII + 1] = -np.inf, -np.inf, -np.inf
            for k in range(start, end + 1):
                x, y = faces[t, k, 0], faces[t, k, 1]
                off, along, r2 = ux * y - uy * x, ux * x + uy * y, x * x + y * y
                row[_OFF] = min(row[_OFF], off - BLOCK_MARGIN)
                row[_OFF + 1] = max(row[_OFF + 1], off + BLOCK_MARGIN)
                row[_ALONG] = min(row[_ALONG], along - BLOCK_MARGIN)
                row[_ALONG + 1] = max(row[_ALONG + 1], along + BLOCK_MARGIN)
                row[_RADII + 1] = max(row[_RADII + 1], r2 * (1.0 + BLOCK_MARGIN))
                if k < end:
                    dx, dy = faces[t, k + 1, 0] - x, faces[t, k + 1, 1] - y
                    square = dx * dx + dy * dy
                    share = -(x * dx + y * dy) / square if square > 0.0 else 0.0
                    if 0.0 < share < 1.0:
                        r2 = (x + share * dx) ** 2 + (y + share * dy) ** 2
                row[_RADII] = min(row[_RADII], r2 * (1.0 - BLOCK_MARGIN))
    return out


@inlined
def _bound(mine: FloatArray, b: int, mates: FloatArray, c: int, at: tuple[float, float, float, float]) -> float:
    """Lower bound of the sine of the gap between block ``b`` of a turning and ``c`` of a fixed face; ``mine``,
    ``mates`` (2^k, 8) as of ``blocks``.

    ``at``: the turning axis in the fixed body's frame (x, y) in mm, then cosine and sine of the turn from that frame
    into the turning body's.
    """
    ox, oy, wx, wy = at
    ux, uy = mates[c, 0], mates[c, 1]
    along, off = ux * ox + uy * oy, ux * oy - uy * ox
    start, end = mates[c, 4] - along, mates[c, 5] - along
    right, left = mates[c, 2] - off, mates[c, 3] - off
    near_along = max(start, -end, 0.0)
    near_off = max(right, -left, 0.0)
    low = max(mine[b, 6], near_along * near_along + near_off * near_off)
    high = min(mine[b, 7], max(start * start, end * end) + max(right * right, left * left))
    if low > high:
        return _NONE
    my_left = mine[b, 3]
    if start + end >= 0.0 or mine[b, 4] + mine[b, 5] <= 0.0 or low <= left * left or low <= my_left * my_left:
        return _OPEN
    # The mate's chord, seen along the turning block's.
    vx, vy = wx * ux - wy * uy, wx * uy + wy * ux
    ex, ey = vx * mine[b, 0] + vy * mine[b, 1], vy * mine[b, 0] - vx * mine[b, 1]
    least = _NONE
    for k in range(2):
        r2 = low if k == 0 else high
        s, t = math.sqrt(r2 - my_left * my_left), -math.sqrt(r2 - left * left)
        real, imag = s * t + left * my_left, left * s - t * my_left
        if ex * real - ey * imag <= 0.0:
            return _OPEN
        least = min(least, (ex * imag + ey * real) / r2)
    return least


@compiled
def _run(face: FloatArray, start: int, end: int, at: tuple[float, float, float, float], out: FloatArray) -> int:
    """Vertices ``start`` to ``end`` of ``face`` (n, 2) about the turning axis, with feet of perpendiculars between
    them.

    Fills rows of ``out`` with x, y, squared radius and place on the face; returns their number.
    """
    ox, oy, wx, wy = at
    count = 0
    for k in range(start, end + 1):
        u, v = face[k, 0] - ox, face[k, 1] - oy
        x, y = wx * u - wy * v, wx * v + wy * u
        if count > 0:
            px, py = out[count - 1, 0], out[count - 1, 1]
            dx, dy = x - px, y - py
            begin = px * dx + py * dy
            if begin < 0.0 and x * dx + y * dy > 0.0:
                share = -begin / (dx * dx + dy * dy)
                fx, fy = px + share * dx, py + share * dy
                out[count, 0], out[count, 1], out[count, 2] = fx, fy, fx * fx + fy * fy
                out[count, 3] = k - 1 + share
                count += 1
        out[count, 0], out[count, 1], out[count, 2], out[count, 3] = x, y, x * x + y * y, k
        count += 1
    return count


@compiled
def _try(points: FloatArray, n: int, line: FloatArray, m: int, side: float, best: FloatArray) -> None:
    """Every one of ``points`` (n rows of ``_run``) against the point of ``line`` (m rows) at its radius; improves
    ``best``.

    ``side`` +1 where the points are the turning body's, -1 where the line is. ``best``: sine and cosine of the least
    gap, place on the points' and on the line's face, side, and x, y of the turning body's point in mm.
    """
    for k in range(n):
        r2 = points[k, 2]
        x, y = points[k, 0], points[k, 1]
        for l in range(m - 1):
            a2, b2 = line[l, 2], line[l + 1, 2]
            if (r2 < a2 or r2 > b2) and (r2 < b2 or r2 > a2):
                continue
            ax, ay = line[l, 0], line[l, 1]
            dx, dy = line[l + 1, 0] - ax, line[l + 1, 1] - ay
            # |A + t D|^2 = r2, the root within the edge, without cancellation.
            half, rest = ax * dx + ay * dy, r2 - a2
            root = math.sqrt(max(half * half + (dx * dx + dy * dy) * rest, 0.0))
            below = half + root if b2 >= a2 else half - root
            t = rest / below if below != 0.0 else 0.0
            gx, gy = ax + t * dx - x, ay + t * dy - y
            # From the turning to the fixed point: P x (Q - P), in which nothing cancels near contact.
            cross = side * (x * gy - y * gx)
            dot = r2 + x * gx + y * gy
            if dot > 0.0 and cross < best[0] * r2:
                best[0], best[1] = cross / r2, dot / r2
                best[2], best[3], best[4] = points[k, 3], line[l, 3] + t * (line[l + 1, 3] - line[l, 3]), side
                best[5], best[6] = (x, y) if side > 0.0 else (x + gx, y + gy)


@compiled
def _pair(
    face: FloatArray,
    mine: FloatArray,
    mate_face: FloatArray,
    mates: FloatArray,
    at: tuple[float, float, float, float],
    limit: float,
    passed: float,
    best: FloatArray,
    stack: IntArray,
    bounds: FloatArray,
    runs: FloatArray,
) -> bool:
    """Least gap between one turning and one fixed face, if its sine is below ``limit``; fills ``best`` as in ``_try``.

    Returns whether there is one. Stops at once below the sine ``passed``.
    """
    still = (0.0, 0.0, 1.0, 0.0)
    best[0] = limit
    found = False
    leaves, mate_leaves = mine.shape[0] // 2, mates.shape[0] // 2
    edges, mate_edges = face.shape[0] - 1, mate_face.shape[0] - 1
    bounds[0], stack[0, 0], stack[0, 1] = _OPEN, 1, 1
    size = 1
    while size > 0:
        size -= 1
        b, c = stack[size, 0], stack[size, 1]
        if bounds[size] >= best[0]:
            continue
        if b >= leaves and c >= mate_leaves:
            b, c = b - leaves, c - mate_leaves
            n = _run(face, b * edges // leaves, (b + 1) * edges // leaves, still, runs[0])
            m = _run(mate_face, c * mate_edges // mate_leaves, (c + 1) * mate_edges // mate_leaves, at, runs[1])
            _try(runs[0], n, runs[1], m, 1.0, best)
            _try(runs[1], m, runs[0], n, -1.0, best)
            found = found or best[0] < limit
            if best[0] < passed:
                return True
            continue
        # Halve the longer block.
        halve_mine = c >= mate_leaves or (b < leaves and mine[b, 5] - mine[b, 4] >= mates[c, 5] - mates[c, 4])
        for k in range(2):
            half = 2 * b + k if halve_mine else b
            mate_half = c if halve_mine else 2 * c + k
            value = _bound(mine, half, mates, mate_half, at)
            if value >= best[0]:
                continue
            # The least bound goes on top, so that little is looked at that could have been pruned.
            place = size
            while size < _SORTED and place > 0 and bounds[place - 1] < value:
                bounds[place] = bounds[place - 1]
                stack[place, 0], stack[place, 1] = stack[place - 1, 0], stack[place - 1, 1]
                place -= 1
            bounds[place], stack[place, 0], stack[place, 1] = value, half, mate_half
            size += 1
    return found


@compiled
def _longer(rows: FloatArray) -> FloatArray:
    """The same rows with as much room again behind them."""
    out = np.empty((2 * rows.shape[0], rows.shape[1]))
    for k in range(rows.shape[0]):  # spelt out: numba takes seconds to compile a copy of slices
        for l in range(rows.shape[1]):
            out[k, l] = rows[k, l]
    return out


def search(
    turning: FloatArray,
    fixed: FloatArray,
    *,
    axis_distance: float,
    poses: FloatArray,
    guesses: FloatArray,
    near: float,
) -> tuple[IntArray, FloatArray, BoolArray]:
    """All pairs that close within ``near`` (rad) of the first at each pose, sorted by pose and closing.

    ``turning`` and ``fixed`` (z, n, 2) faces in mm; ``poses`` and ``guesses`` (N,) in rad. Returns, one row per pair:
    pose, turning and fixed tooth (k, 3); rotation beyond the guess in rad, places on both faces, and x, y of the
    contact on the turning face in its own frame in mm (k, 5); whether the turning body's vertex touches (k,).
    """
    points = turning[..., 0] + 1j * turning[..., 1]
    tips = np.angle(points[:, -1])
    order = np.argsort(tips)
    # How far each face stands clockwise of its tip corner.
    behind = np.max(np.angle(points[:, -1:] * points.conj()), axis=1, initial=0.0)
    mine, mates, guesses, poses = (np.ascontiguousarray(x, dtype=np.float64) for x in (turning, fixed, guesses, poses))
    rows = _search(
        mine, blocks(mine), mates, blocks(mates), tips[order], order, behind, float(axis_distance), poses, guesses,
        float(near),
    )  # fmt: skip
    return rows[:, :3].astype(np.int64), rows[:, 3:8], rows[:, 8] > 0.0


@compiled
def _search(
    turning: FloatArray,
    turning_blocks: FloatArray,
    fixed: FloatArray,
    fixed_blocks: FloatArray,
    tips: FloatArray,
    order: IntArray,
    behind: FloatArray,
    axis_distance: float,
    poses: FloatArray,
    guesses: FloatArray,
    near: float,
) -> FloatArray:
    """As ``search``, all numbers of a pair in one row (k, 9), vertices of the turning body as +1; ``tips`` (z,) polar
    angles of the turning tip corners, rising, of the teeth in ``order``."""
    z_1 = turning.shape[0]
    z_2, m, _ = fixed.shape
    turn = 2.0 * math.pi
    pitch = turn / z_1
    reach2 = 0.0
    for i in range(z_1):
        reach2 = max(reach2, turning_blocks[i, 1, 7])
    passed = math.sin(-PASSED * pitch)

    best = np.empty(7)
    stack = np.empty((_STORE, 2), np.int64)
    bounds = np.empty(_STORE)
    runs = np.empty((2, 4 * LEAF + 4, 4))
    rows = np.empty((2 * poses.size + 64, 9))
    count = 0
    leader = 0
    for pose in range(poses.size):
        cp, sp = math.cos(poses[pose]), math.sin(poses[pose])
        cg, sg = math.cos(guesses[pose]), math.sin(guesses[pose])
        at = (-axis_distance * cp, axis_distance * sp, cp * cg + sp * sg, sp * cg - cp * sg)
        begin = count
        first = np.inf
        for turn_of in range(z_2):
            # Begin with the tooth that led at the last pose: an early first closing prunes the others.
            j = (leader + turn_of) % z_2
            root = fixed_blocks[j, 1]
            along = root[0] * at[0] + root[1] * at[1]
            off = root[0] * at[1] - root[1] * at[0]
            u = max(root[4] - along, along - root[5], 0.0)
            v = max(root[2] - off, off - root[3], 0.0)
            if u * u + v * v > reach2:
                continue
            u, v = fixed[j, m - 1, 0] - at[0], fixed[j, m - 1, 1] - at[1]
            tip2 = u * u + v * v
            tip = math.atan2(at[2] * v + at[3] * u, at[2] * u - at[3] * v)
            start = tip + FIRST_AHEAD * pitch
            if start > math.pi:
                start -= turn
            k = 0
            while k < z_1 and tips[k] <= start:
                k += 1
            k -= 1
            for attempt in range(min(TRIES, z_1)):
                i = order[(k - attempt) % z_1]
                ahead = tip - tips[(k - attempt) % z_1]
                if ahead > math.pi:
                    ahead -= turn
                elif ahead < -math.pi:
                    ahead += turn
                whole = turning_blocks[i, 1]
                if whole[6] <= tip2 <= whole[7] and ahead + behind[i] < -PASSED * pitch:
                    continue
                limit = min(first + near, 0.5 * math.pi)
                if not _pair(
                    turning[i], turning_blocks[i], fixed[j], fixed_blocks[j], at, math.sin(limit), passed,
                    best, stack, bounds, runs,
                ) or best[0] < passed:  # fmt: skip
                    continue
                if count == rows.shape[0]:
                    rows = _longer(rows)
                rotation = math.atan2(best[0], best[1])
                row = count
                while row > begin and rows[row - 1, 3] > rotation:
                    for l in range(9):
                        rows[row, l] = rows[row - 1, l]
                    row -= 1
                mine = best[4] > 0.0
                rows[row, 0], rows[row, 1], rows[row, 2], rows[row, 3] = pose, i, j, rotation
                rows[row, 4], rows[row, 5] = (best[2], best[3]) if mine else (best[3], best[2])
                rows[row, 6], rows[row, 7], rows[row, 8] = best[5], best[6], best[4]
                count += 1
                first = rows[begin, 3]
                while rows[count - 1, 3] > first + near:
                    count -= 1
                if rotation + 0.5 * pitch > first + near:
                    break  # the next turning tooth closes about a pitch later
        if count > begin:
            leader = int(rows[begin, 2])
    return rows[:count]
