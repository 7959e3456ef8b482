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
from typing import Any, ParamSpec, TypeVar, cast

import numpy as np
from numba import njit

from gearpoly.units import BoolArray, FloatArray, IntArray

P = ParamSpec("P")
R = TypeVar("R")

LEAF = 12
"""Edges in the smallest blocks. Fewer make more blocks to bound, more make more vertices to try; 8 to 16 cost the
same. It decides nothing but speed."""

ROOM = 4
"""Rows per pose that there is room for at first: two or three pairs are near. Where more are, all is found again."""

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


def _uncounted(function: Callable[P, R]) -> Callable[P, R]:
    """As ``compiled``, for a function that makes no array: nothing counts who holds those that come in, which is a
    third of a search otherwise."""
    return _compiled(function, inline=False, counts=False)


def _inlined(function: Callable[P, R]) -> Callable[P, R]:
    """The same, put in the place of its calls."""
    return _compiled(function, inline=True, counts=False)


def _compiled(function: Callable[P, R], *, inline: bool, counts: bool = True) -> Callable[P, R]:
    options: dict[str, Any] = {"nogil": True, "forceinline": inline}
    if not counts:
        options["_nrt"] = False  # as numba's own tests switch its counting off
    try:
        made = njit(cache=True, **options)(function)
    except RuntimeError:  # numba's word for: neither the package's folder nor the user's is writable
        made = njit(**options)(function)
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


@_inlined
def _bound(
    blocks_1: FloatArray, i: int, b: int, blocks_2: FloatArray, j: int, c: int, at: tuple[float, float, float, float]
) -> float:
    """Lower bound of the sine of the gap between block ``b`` of turning face ``i`` and ``c`` of fixed face ``j``;
    ``blocks_1``, ``blocks_2`` (z, 2^k, 8) as of ``blocks``.

    ``at``: the turning axis in the fixed body's frame (x, y) in mm, then cosine and sine of the turn from that frame
    into the turning body's.
    """
    ox, oy, wx, wy = at
    ux, uy = blocks_2[j, c, 0], blocks_2[j, c, 1]
    along, off = ux * ox + uy * oy, ux * oy - uy * ox
    start, end = blocks_2[j, c, 4] - along, blocks_2[j, c, 5] - along
    right, left = blocks_2[j, c, 2] - off, blocks_2[j, c, 3] - off
    near_along = max(start, -end, 0.0)
    near_off = max(right, -left, 0.0)
    low = max(blocks_1[i, b, 6], near_along * near_along + near_off * near_off)
    high = min(blocks_1[i, b, 7], max(start * start, end * end) + max(right * right, left * left))
    if low > high:
        return _NONE
    my_left = blocks_1[i, b, 3]
    if (
        start + end >= 0.0
        or blocks_1[i, b, 4] + blocks_1[i, b, 5] <= 0.0
        or low <= left * left
        or low <= my_left * my_left
    ):
        return _OPEN
    # The mate's chord, seen along the turning block's.
    vx, vy = wx * ux - wy * uy, wx * uy + wy * ux
    ex, ey = vx * blocks_1[i, b, 0] + vy * blocks_1[i, b, 1], vy * blocks_1[i, b, 0] - vx * blocks_1[i, b, 1]
    least = _NONE
    for k in range(2):
        r2 = low if k == 0 else high
        s, t = math.sqrt(r2 - my_left * my_left), -math.sqrt(r2 - left * left)
        real, imag = s * t + left * my_left, left * s - t * my_left
        if ex * real - ey * imag <= 0.0:
            return _OPEN
        least = min(least, (ex * imag + ey * real) / r2)
    return least


@_inlined
def _run(
    faces: FloatArray, i: int, start: int, end: int, at: tuple[float, float, float, float], out: FloatArray
) -> int:
    """Vertices ``start`` to ``end`` of face ``i`` of ``faces`` (z, n, 2) about the turning axis, with feet of
    perpendiculars between them.

    Fills rows of ``out`` with x, y, squared radius and place on the face; returns their number, negative where the
    radius neither rises throughout nor falls throughout.
    """
    ox, oy, wx, wy = at
    count = 0
    rises, falls = True, True
    for k in range(start, end + 1):
        u, v = faces[i, k, 0] - ox, faces[i, k, 1] - oy
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
                rises = False
                falls = False
        r2 = x * x + y * y
        if count > 0:
            rises = rises and r2 > out[count - 1, 2]
            falls = falls and r2 < out[count - 1, 2]
        out[count, 0], out[count, 1], out[count, 2], out[count, 3] = x, y, r2, k
        count += 1
    return count if rises or falls else -count


@_inlined
def _touch(points: FloatArray, k: int, line: FloatArray, l: int, side: float, best: FloatArray) -> None:
    """Point ``k`` against the point of edge ``l`` at its radius, as ``_try`` has it."""
    x, y, r2 = points[k, 0], points[k, 1], points[k, 2]
    a2, b2 = line[l, 2], line[l + 1, 2]
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


@_inlined
def _try(points: FloatArray, n: int, line: FloatArray, m: int, side: float, best: FloatArray) -> None:
    """Every one of ``points`` (n rows of ``_run``) against the point of ``line`` (m rows) at its radius; improves
    ``best``. Where the line's radius rises or falls throughout, there is one such point: it is near that of the point
    before. ``m`` is negative elsewhere.

    ``side`` +1 where the points are the turning body's, -1 where the line is. ``best``: sine and cosine of the least
    gap, place on the points' and on the line's face, side, and x, y of the turning body's point in mm.
    """
    many = abs(m)
    if m < 0:
        for k in range(abs(n)):
            for l in range(many - 1):
                a2, b2 = line[l, 2], line[l + 1, 2]
                if min(a2, b2) <= points[k, 2] <= max(a2, b2):
                    _touch(points, k, line, l, side, best)
        return
    first, last = line[0, 2], line[many - 1, 2]
    up = last >= first
    low, high = (first, last) if up else (last, first)
    l = 0
    for k in range(abs(n)):
        r2 = points[k, 2]
        if r2 < low or r2 > high:
            continue
        if up:
            while l > 0 and line[l, 2] > r2:
                l -= 1
            while line[l + 1, 2] < r2:
                l += 1
        else:
            while l > 0 and line[l, 2] < r2:
                l -= 1
            while line[l + 1, 2] > r2:
                l += 1
        _touch(points, k, line, l, side, best)


@_inlined
def _pair(
    faces: FloatArray,
    mine: FloatArray,
    i: int,
    mate_faces: FloatArray,
    mates: FloatArray,
    j: int,
    at: tuple[float, float, float, float],
    limit: float,
    passed: float,
    best: FloatArray,
    stack: IntArray,
    bounds: FloatArray,
    points: FloatArray,
    line: FloatArray,
) -> bool:
    """Least gap between turning face ``i`` and fixed face ``j``, if its sine is below ``limit``; fills ``best`` as in
    ``_try``.

    Returns whether there is one. Stops at once below the sine ``passed``.
    """
    still = (0.0, 0.0, 1.0, 0.0)
    best[0] = limit
    found = False
    leaves, mate_leaves = mine.shape[1] // 2, mates.shape[1] // 2
    edges, mate_edges = faces.shape[1] - 1, mate_faces.shape[1] - 1
    bounds[0], stack[0, 0], stack[0, 1] = _OPEN, 1, 1
    size = 1
    while size > 0:
        size -= 1
        b, c = stack[size, 0], stack[size, 1]
        if bounds[size] >= best[0]:
            continue
        if b >= leaves and c >= mate_leaves:
            b, c = b - leaves, c - mate_leaves
            n = _run(faces, i, b * edges // leaves, (b + 1) * edges // leaves, still, points)
            m = _run(mate_faces, j, c * mate_edges // mate_leaves, (c + 1) * mate_edges // mate_leaves, at, line)
            _try(points, n, line, m, 1.0, best)
            _try(line, m, points, n, -1.0, best)
            found = found or best[0] < limit
            if best[0] < passed:
                return True
            continue
        # Halve the longer block.
        halve_mine = c >= mate_leaves or (
            b < leaves and mine[i, b, 5] - mine[i, b, 4] >= mates[j, c, 5] - mates[j, c, 4]
        )
        for k in range(2):
            half = 2 * b + k if halve_mine else b
            mate_half = c if halve_mine else 2 * c + k
            value = _bound(mine, i, half, mates, j, mate_half, at)
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
    mine_blocks, mate_blocks = blocks(mine), blocks(mates)
    room, count = ROOM * poses.size + 64, -1
    while count < 0:
        rows = np.empty((room, 9))
        count = _search(
            mine, mine_blocks, mates, mate_blocks, tips[order], order, behind, float(axis_distance), poses, guesses,
            float(near), np.empty(7), np.empty((_STORE, 2), np.int64), np.empty(_STORE), np.empty((4 * LEAF + 4, 4)),
            np.empty((4 * LEAF + 4, 4)), rows,
        )  # fmt: skip
        room *= 2
    rows = rows[:count]
    return rows[:, :3].astype(np.int64), rows[:, 3:8], rows[:, 8] > 0.0


@_uncounted
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
    best: FloatArray,
    stack: IntArray,
    bounds: FloatArray,
    points: FloatArray,
    line: FloatArray,
    rows: FloatArray,
) -> int:
    """As ``search``, all numbers of a pair in one of ``rows`` (k, 9), vertices of the turning body as +1; ``tips``
    (z,) polar angles of the turning tip corners, rising, of the teeth in ``order``. Returns the number of rows, -1
    where there is no room for more. ``best``, ``stack``, ``bounds``, ``points`` and ``line`` are room to work in."""
    z_1 = turning.shape[0]
    z_2, m, _ = fixed.shape
    turn = 2.0 * math.pi
    pitch = turn / z_1
    reach2 = 0.0
    for i in range(z_1):
        reach2 = max(reach2, turning_blocks[i, 1, 7])
    passed = math.sin(-PASSED * pitch)

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
            ux, uy = fixed_blocks[j, 1, 0], fixed_blocks[j, 1, 1]
            along, off = ux * at[0] + uy * at[1], ux * at[1] - uy * at[0]
            u = max(fixed_blocks[j, 1, 4] - along, along - fixed_blocks[j, 1, 5], 0.0)
            v = max(fixed_blocks[j, 1, 2] - off, off - fixed_blocks[j, 1, 3], 0.0)
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
                if turning_blocks[i, 1, 6] <= tip2 <= turning_blocks[i, 1, 7] and ahead + behind[i] < -PASSED * pitch:
                    continue
                limit = min(first + near, 0.5 * math.pi)
                if not _pair(
                    turning, turning_blocks, i, fixed, fixed_blocks, j, at, math.sin(limit), passed,
                    best, stack, bounds, points, line,
                ) or best[0] < passed:  # fmt: skip
                    continue
                if count == rows.shape[0]:
                    return -1
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
    return count
