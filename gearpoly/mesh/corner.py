"""How a tip corner meets its mate's involute once it has left the line of action, and what the other pairs take over.

A tooth that ends below its mate's reach leaves the line of action at its own tip and goes on touching with the corner
there, which stands off ever farther (closed form of two involutes, derived here).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearpoly.mesh.pair import GearPair
from gearpoly.mesh.transmission import FlankContacts
from gearpoly.units import BoolArray, FloatArray, IntArray

FLANK_PLACES = 400
"""Places along the flank at which the gap is worked out; straight between them it errs by 1e-5 of a module."""


def corner_gap(pair: GearPair, gear: int, r_tip: float) -> tuple[FloatArray, FloatArray]:
    """Roll lengths (k,) in mm of ``gear`` (0 driving, 1 driven) at which whole flanks would touch, from the tip radius
    ``r_tip`` in mm up, and by how much later (k,) in mm along the line of action a corner at that radius does.

    In the frame of either axis a flank that touches on the line of action at the roll length l has its origin at
    l/r_b - alpha_w, and a point of it at the roll length y stands y/r_b - atan(y/r_b) behind that.
    """
    mine, mate = (one.gear for one in (pair.driving, pair.driven)[:: 1 if gear == 0 else -1])
    alpha, a = pair.alpha_w, pair.a
    xi = mine.roll_length(r_tip) / mine.r_b
    # Where the tooth stands, by the roll length at which it would touch were it whole; twice as far as it could.
    u = np.linspace(xi * mine.r_b, 2.0 * mine.l_a - xi * mine.r_b, FLANK_PLACES)
    corner = r_tip * np.exp(1j * (u / mine.r_b - alpha - (xi - math.atan(xi))))
    seen = a - corner  # from the mate's axis, turned by half a turn: both gears look alike
    eta = np.sqrt(np.maximum(np.abs(seen) ** 2 - mate.r_b**2, 0.0)) / mate.r_b
    l_mate = mate.r_b * (np.angle(seen) + eta - np.arctan(eta) + alpha)
    gap = u - (a * math.sin(alpha) - l_mate)
    # The driving gear turns until they touch: with its own corner on, or up to the corner of a driven tooth at rest.
    return (u - gap if gear == 0 else u), gap


def standing_off(rows: FlankContacts, pair: GearPair, off: FloatArray) -> tuple[IntArray, FloatArray, FlankContacts]:
    """Contacts that stand off by ``off`` (rows,) mm more along the line of action: positions (k,) at which any does,
    the transmission error (k,) in rad of the first touch there, and all contacts there, sorted anew."""
    moves = np.zeros(rows.theta_2.size, dtype=bool)
    moves[rows.position[off > 0.0]] = True
    at, mine = np.flatnonzero(moves), moves[rows.position]
    position, gap = (np.cumsum(moves) - 1)[rows.position[mine]], (rows.gap + off)[mine]
    order = np.lexsort((gap, position))
    where = np.flatnonzero(mine)[order]
    position, gap = position[order], gap[order]
    first = np.searchsorted(position, np.arange(at.size))
    least = gap[first]
    sense = 1.0 if rows.flank == "drive" else -1.0
    te = rows.te[at] - sense * pair.ratio * least / pair.r_b1
    touching = np.zeros(position.size, dtype=bool)
    touching[first] = True
    moved = replace(
        of_rows(rows, where), theta_2=rows.theta_2[at], te=te, position=position, gap=gap - least[position],
        touching=touching, pairs=np.ones(at.size, dtype=np.int64),
    )  # fmt: skip
    return at, te, moved


def of_rows(rows: FlankContacts, held: IntArray | BoolArray) -> FlankContacts:
    """Those contacts of ``rows`` that are ``held``, by their numbers or marked, at the same positions."""
    return replace(
        rows, position=rows.position[held], driving=rows.driving[held], driven=rows.driven[held], gap=rows.gap[held],
        point=rows.point[held], normal=rows.normal[held], feature=rows.feature[held], overrun=rows.overrun[held],
        touching=rows.touching[held],
    )  # fmt: skip
