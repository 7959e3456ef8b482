"""Contact of all positions of a recording, remembered: nothing is solved twice. Where few teeth differ from those of a
solution that is known, only the positions are solved that these teeth reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearpoly.proving.equilibrium import SLOTS, solve
from gearpoly.proving.gears import BoolArray, FloatArray, IntArray
from gearpoly.proving.memo import Memo, digest

KEPT_SOLUTIONS_BYTES = 64_000_000
"""Bytes of transmission errors, of reference solutions and of whole solutions that are kept, each: those of the largest
case of a ground."""
DIFFERING_TEETH_PART = 0.3
"""Part of the teeth of either gear that may differ from those of a known solution; of more, too little is left."""


@dataclass(frozen=True, kw_only=True)
class Positions:
    """Positions and all that acts there but the flanks, as `solve` takes it: driven angles (rad), moments (N.mm),
    factors on the compliance; side; teeth; geometry; eccentricities; compliance of teeth and contact; friction, gap
    across the face width (mm)."""

    theta_2: FloatArray
    moments: FloatArray
    soft: FloatArray
    side: float
    z: IntArray
    geo: FloatArray
    ecc: FloatArray
    nodes: FloatArray
    contact: FloatArray
    deflect: bool
    friction: float
    lead: float

    @property
    def loaded(self) -> bool:
        """Whether teeth bend anywhere; else the load and what answers it change nothing."""
        return self.deflect and bool(self.moments.any())

    def key(self) -> bytes:
        """Differs where the contact of the same flanks does."""
        load = (self.moments, self.soft, self.nodes, self.contact, self.friction, self.lead) if self.loaded else ()
        return digest(self.theta_2, self.side, self.geo, self.ecc, *load)


@dataclass(frozen=True, kw_only=True)
class FlankRows:
    """The flanks of both gears as rows of `table`, and the factors on the compliance of their teeth."""

    rows_1: FloatArray
    rows_2: FloatArray
    own_1: FloatArray
    own_2: FloatArray

    def key(self, loaded: bool) -> bytes:
        """Differs where the flanks do, and where teeth bend, their compliance."""
        return digest(self.rows_1, self.rows_2, *((self.own_1, self.own_2) if loaded else ()))

    def moved(self, other: FlankRows, loaded: bool) -> tuple[BoolArray, BoolArray]:
        """Which teeth of either gear are others."""
        one = (self.rows_1 != other.rows_1).any(axis=1)
        two = (self.rows_2 != other.rows_2).any(axis=1)
        if loaded:
            one, two = one | (self.own_1 != other.own_1), two | (self.own_2 != other.own_2)
        return one, two


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """What the teeth do at n positions.

    x in mm; counts: pairs in reach; tooth_1, tooth_2, roll_1, roll_2 (mm), weights (share of a change of the flanks
    that reaches x), forces (N), deflections (mm): shape (n, SLOTS), zero where no pair is."""

    x: FloatArray
    counts: IntArray
    tooth_1: IntArray
    tooth_2: IntArray
    roll_1: FloatArray
    roll_2: FloatArray
    weights: FloatArray
    forces: FloatArray
    deflections: FloatArray

    @staticmethod
    def empty(n: int) -> Mesh:
        """Nothing known at n positions."""
        tooth_1, tooth_2 = (np.zeros((n, SLOTS), dtype=np.int64) for _ in range(2))
        return Mesh(
            x=np.empty(n), counts=np.zeros(n, dtype=np.int64), tooth_1=tooth_1, tooth_2=tooth_2,
            **{k: np.zeros((n, SLOTS)) for k in ("roll_1", "roll_2", "weights", "forces", "deflections")},
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class KnownSolution:
    """A solution that others begin at: its flanks, x (mm), and first and last mesh looked at (n, 2)."""

    flanks: FlankRows
    x: FloatArray
    reach: IntArray


NO_SOLUTION = KnownSolution(
    flanks=FlankRows(rows_1=np.empty((0, 0)), rows_2=np.empty((0, 0)), own_1=np.empty(0), own_2=np.empty(0)),
    x=np.empty(0), reach=np.empty((0, 2), dtype=np.int64),
)  # fmt: skip
NONE_MOVED = np.zeros(0, dtype=np.bool_)

_errors: Memo[tuple[FloatArray, int]] = Memo(KEPT_SOLUTIONS_BYTES)
_known: Memo[KnownSolution] = Memo(KEPT_SOLUTIONS_BYTES)
_meshes: Memo[tuple[Mesh, int]] = Memo(KEPT_SOLUTIONS_BYTES)


def error(at: Positions, of: FlankRows) -> tuple[FloatArray, int]:
    """Transmission error in mm at all positions, and how many were not found."""
    place, loaded = at.key(), at.loaded
    key = (place, of.key(loaded))
    found = _errors.get(key)
    if found is None:
        known = _known.get(place)
        begin, moved = NO_SOLUTION, (NONE_MOVED, NONE_MOVED)
        if known is not None:
            moved = of.moved(known.flanks, loaded)
            begin = known if max(one.mean() for one in moved) <= DIFFERING_TEETH_PART else NO_SOLUTION
        out, reach = Mesh.empty(1), np.empty((at.theta_2.size, 2), dtype=np.int64)
        x = np.empty(at.theta_2.size)
        failed = _solve(at, of, begin, moved, x, reach, out, whole=False)
        kept = x.view()
        kept.setflags(write=False)
        found = (kept, failed)
        _errors.put(key, found, x.nbytes)
        if known is None and not failed:
            _known.put(place, KnownSolution(flanks=of, x=x, reach=reach), x.nbytes + reach.nbytes)
    return found


def contacts(at: Positions, of: FlankRows) -> tuple[Mesh, int]:
    """What the teeth do at all positions, and how many were not found."""
    key = (at.key(), of.key(loaded=True))
    found = _meshes.get(key)
    if found is None:
        out, reach = Mesh.empty(at.theta_2.size), np.empty((at.theta_2.size, 2), dtype=np.int64)
        failed = _solve(at, of, NO_SOLUTION, (NONE_MOVED, NONE_MOVED), out.x, reach, out, whole=True)
        found = (out, failed)
        _meshes.put(key, found, sum(array.nbytes for array in vars(out).values()))
    return found


def _solve(
    at: Positions, of: FlankRows, known: KnownSolution, moved: tuple[BoolArray, BoolArray], x: FloatArray,
    reach: IntArray, out: Mesh, *, whole: bool,
) -> int:  # fmt: skip
    failed = solve(
        at.theta_2, at.moments, at.soft, at.side, at.z, at.geo, at.ecc, of.rows_1, of.rows_2, at.nodes, of.own_1,
        of.own_2, at.contact, at.deflect, at.friction, at.lead, known.x, known.reach, moved[0], moved[1], x, reach,
        whole, out.tooth_1, out.tooth_2, out.roll_1, out.roll_2, out.weights, out.forces, out.deflections, out.counts,
    )  # fmt: skip
    return int(failed) + int(np.count_nonzero(~np.isfinite(x)))
