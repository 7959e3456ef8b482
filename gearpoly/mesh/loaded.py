"""The pair under torque: how the touching teeth share the load and how far the driving gear turns on while they give.

Every near pair closes at its own rotation. Turned on by phi from the first touch, pair i is pressed together by
lever_i (phi - phi_i) along its normal, and gives c_i W_i in its teeth and h(W_i) in its contact. Equilibrium: only
pressed pairs carry, and their moments about the driven axis balance the torque. The study's own procedure (Liu et al.
2020, Eqs. 17-21) adds pairs as a turn reaches them and never lets one go, so that with three near pairs one may pull.
Each pair's point is that of its own closing; the teeth's compliance changes by less than 0.3 % while they give (18/25
at 120 N.m).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from gearpoly.errors import NotConvergedError, OutOfRangeError, told_at_most
from gearpoly.mesh.condition import check_torque
from gearpoly.mesh.deflection import LEAST_LOAD, PairCompliance
from gearpoly.mesh.transmission import FlankContacts
from gearpoly.units import NM, UM, FloatArray, IntArray

Sharing = Literal["equilibrium", "paper"]

BALANCED = 1e-12
"""Part of the whole force by which no force moves any more where the iteration for the contact law stops; moments then
balance to 1e-9 of the torque with room to spare, since each step balances them anew."""

ITERATIONS = 200
"""Iterations allowed for the study's procedure. The load enters its own stiffness only by its tenth power, so each
gains a digit and 13 are usual; across a gap it enters by its square root, and each gains only a factor of two."""

SMALL = 0.05
"""Of the module. Deflections above it are no longer small against the teeth, and the outline that was used has
moved."""

LOCKING = 0.1
"""Part of r_b2 that friction must leave of a normal force's lever. At a tenth forces are ten times the load's, and a
little more friction holds any load: no pair of gears is run so."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadedContacts:
    """The pair under one torque at the positions of its unloaded contacts (N positions, rows as in ``FlankContacts``).

    ``te`` (N,) loaded transmission error in rad; ``approach`` (N,) how far the driving gear turned on along the line of
    action, mm; ``force`` (rows,) normal force in N, 0 where a pair does not touch; ``share`` (rows,) of the force sum;
    ``pairs`` (N,) touching pairs; ``stiffness`` (N,) tangent mesh stiffness in N/mm along the line of action.
    """

    contacts: FlankContacts
    torque: float
    te: FloatArray
    approach: FloatArray
    force: FloatArray
    share: FloatArray
    pairs: IntArray
    stiffness: FloatArray

    @property
    def mean_pairs(self) -> float:
        """Mean of the counts at these positions; ``transmission.mean_count`` places begin and end of touch between
        them."""
        return float(np.mean(self.pairs))


class TooNearError(OutOfRangeError):
    """Pairs closed by ``approach`` mm under a load, farther than they were looked for: others may carry too."""

    def __init__(self, message: str, *, approach: float) -> None:
        super().__init__(message)
        self.approach = approach


def load_reach(compliance: PairCompliance, torque: float) -> float:
    """The most that a pair alone under the whole ``torque`` (N.mm) can give, mm: near pairs up to this may carry
    load. Never above ``SMALL`` of the module, from where on ``loaded`` refuses the torque, whatever stands behind."""
    force = torque / compliance.pair.r_b2 / _least_lever(compliance)
    # A contact anywhere on the path; laws that ask for the place vary with it only in their logarithm.
    pitch_point = np.array([compliance.pair.driving.gear.r, 0.0])
    if force == 0.0:
        return 0.0
    alone = 1.2 * force * float(compliance.secant(np.array(force), np.array(compliance.softest()), pitch_point))
    return min(alone, SMALL * compliance.pair.driving.gear.m)


def loaded(
    contacts: FlankContacts, compliance: PairCompliance, *, torque: float, sharing: Sharing = "equilibrium"
) -> LoadedContacts:
    """Share ``torque`` (N.mm on the driven shaft) among the near pairs of ``contacts``.

    The contacts must hold every pair that closes under the load: within ``load_reach``, but for a tooth that is alone
    in mesh with a corner, where a normal off the line of action has less lever. Raises ``TooNearError`` where they may
    not, ``OutOfRangeError`` for a negative torque or deflections that are no longer small, ``NotConvergedError`` where
    forces do not settle.
    """
    check_torque(torque)
    pair = compliance.pair
    point = contacts.point
    lever_1, lever_2 = levers(contacts, compliance)
    problem = _Problem(
        closing=contacts.gap / pair.r_b1,
        lever_1=lever_1,
        lever_2=lever_2,
        teeth=compliance.teeth(contacts.driving, contacts.driven, point),
        point=point,
        torque=torque,
    )
    phi, force = (_studys if sharing == "paper" else _equilibrium)(problem, compliance, contacts)
    most = float(np.max(phi, initial=0.0)) * pair.r_b1
    if most > SMALL * pair.driving.gear.m:
        raise OutOfRangeError(
            f"torque {torque / NM:g} N.m bends the teeth by more than {SMALL * pair.driving.gear.m / UM:g} um, "
            f"{SMALL:.0%} of the module; small deflections no longer hold, so lower the torque or widen the faces"
        )
    if torque > 0.0 and most > contacts.near:
        raise TooNearError(
            f"pairs were looked for within {contacts.near / UM:.1f} um of the first touch, but "
            f"torque {torque / NM:g} N.m closes {most / UM:.1f} um; find the contacts with near= above that",
            approach=most,
        )
    position, positions = contacts.position, contacts.theta_2.size
    least = np.maximum(force, LEAST_LOAD * torque / pair.r_b2)
    touches = force != 0.0
    softness = compliance.tangent(least, problem.teeth, point)
    tangent = np.where(touches, lever_1 * lever_2 / softness, 0.0)
    sense = 1.0 if contacts.flank == "drive" else -1.0
    total = np.bincount(position, weights=force, minlength=positions)
    return LoadedContacts(
        contacts=contacts,
        torque=torque,
        te=contacts.te - sense * pair.ratio * phi,
        approach=phi * pair.r_b1,
        force=force,
        share=force / np.where(total > 0.0, total, 1.0)[position],
        pairs=contacts.pairs if torque == 0.0 else np.bincount(position[touches], minlength=positions),
        stiffness=np.bincount(position, weights=tangent, minlength=positions) / (pair.r_b1 * pair.r_b2),
    )


def _least_lever(compliance: PairCompliance) -> float:
    """The least lever of a normal force about the driven axis over r_b2, which friction shortens: 1 - mu rho_2/r_b2.

    Raises ``OutOfRangeError`` where friction alone can hold the load: the teeth lock before their tips pass.
    """
    mu, gear = abs(compliance.elasticity.friction), compliance.pair.driven.gear
    # No contact lies farther up the driven flank than its tip, a corner contact beside the path hardly so.
    # Backwards recess locks first, nearer to the driven root: this is then on the safe side.
    least = 1.0 - mu * gear.l_a / gear.r_b
    if least <= LOCKING:
        raise OutOfRangeError(
            f"friction_coefficient = {mu:g}: where the driven tip enters, friction takes more than "
            f"{1.0 - LOCKING:.0%} of the torque and the teeth lock; "
            f"want at most {told_at_most((1.0 - LOCKING) * gear.r_b / gear.l_a, 2)} for these gears"
        )
    return least


def levers(contacts: FlankContacts, compliance: PairCompliance) -> tuple[FloatArray, FloatArray]:
    """Levers (rows,) in mm on which the normal forces are pressed by the driving and turn the driven gear, what
    friction adds to the latter included."""
    point, normal = contacts.point, contacts.normal
    lever_1 = np.abs(point[:, 0] * normal[:, 1] - point[:, 1] * normal[:, 0])
    lever_2 = np.abs((point[:, 0] - compliance.pair.a) * normal[:, 1] - point[:, 1] * normal[:, 0])
    return lever_1, lever_2 + _friction_lever(contacts, compliance)


def _friction_lever(contacts: FlankContacts, compliance: PairCompliance) -> FloatArray:
    """By how much friction lengthens the lever (rows,) in mm on which each normal force turns the driven gear.

    The driving flank drags the driven one along the way it slides over it; below zero in approach, where the same
    torque needs more normal force, above it in recess.
    """
    mu = compliance.elasticity.friction
    if mu == 0.0:
        return np.zeros(contacts.position.size)
    p, n, a, ratio = contacts.point, contacts.normal, compliance.pair.a, compliance.pair.ratio
    from_2 = p - np.array([a, 0.0])
    # Velocities of both flanks at the contact for unit driving speed: counter-clockwise, and clockwise about (a, 0).
    sliding = np.stack((-p[:, 1] - ratio * from_2[:, 1], p[:, 0] + ratio * from_2[:, 0]), axis=-1)
    along = np.stack((-n[:, 1], n[:, 0]), axis=-1)
    drag = np.sign(np.sum(sliding * along, axis=-1))[:, None] * along
    # Forward moment about the driven axis is clockwise.
    turns = -(from_2[:, 0] * drag[:, 1] - from_2[:, 1] * drag[:, 0])
    pushes = -(from_2[:, 0] * n[:, 1] - from_2[:, 1] * n[:, 0])
    return np.asarray(mu * turns * np.sign(pushes))


def weights(
    rows: FlankContacts, load: LoadedContacts | None, by: PairCompliance | None
) -> tuple[FloatArray, FloatArray]:
    """Weight (rows,) of each pair's normal deviation in the transmission error, and its force (rows,) in N.

    Moments balance, sum k_i l_1i (phi - phi_i) l_2i = T, and material d closes a pair d/l_1 sooner, so that x moves by
    r_b1 sum k_i l_2i d_i / sum k_i l_1i l_2i (derived here).
    """
    if load is None or by is None:
        first = np.zeros(rows.position.size)
        first[np.searchsorted(rows.position, np.arange(rows.theta_2.size))] = 1.0
        return first, np.zeros(first.size)
    lever_1, lever_2 = levers(rows, by)
    least = np.maximum(load.force, LEAST_LOAD * float(np.max(load.force, initial=0.0)))
    teeth = by.teeth(rows.driving, rows.driven, rows.point)
    turns = lever_2 * (load.force > 0.0) / by.tangent(least, teeth, rows.point)
    whole = np.bincount(rows.position, weights=turns * lever_1)[rows.position]
    return by.pair.r_b1 * turns / whole, load.force


@dataclass(frozen=True, kw_only=True)
class _Problem:
    """Near pairs, row by row: closing rotations (rad), levers (mm), tooth compliance (mm/N), contact points."""

    closing: FloatArray
    lever_1: FloatArray
    lever_2: FloatArray
    teeth: FloatArray
    point: FloatArray
    torque: float


def _equilibrium(
    problem: _Problem, compliance: PairCompliance, contacts: FlankContacts
) -> tuple[FloatArray, FloatArray]:
    """Rotation phi (N,) in rad beyond the first touch and forces (rows,) in N that balance the torque."""
    start = np.searchsorted(contacts.position, np.arange(contacts.theta_2.size + 1))
    if problem.torque == 0.0:
        return np.zeros(start.size - 1), np.zeros(problem.closing.size)
    # numba is imported at the first load.
    from gearpoly.mesh.balance import balance

    law = compliance.flattening(problem.point)
    whole = problem.torque / compliance.pair.r_b2
    phi, force, restless = balance(
        start, problem.closing, problem.lever_1, problem.lever_2, problem.teeth,
        np.ascontiguousarray(np.broadcast_to(law.level, problem.closing.shape)), law.power, law.logarithm,
        compliance.elasticity.misalignment, problem.torque, whole, LEAST_LOAD * whole, BALANCED * whole,
    )  # fmt: skip
    if restless:
        raise NotConvergedError(UNSETTLED)
    return phi, force


UNSETTLED = "the forces between the teeth do not settle; check the compliance laws, the material and the friction"


def _studys(problem: _Problem, compliance: PairCompliance, contacts: FlankContacts) -> tuple[FloatArray, FloatArray]:
    """As ``_equilibrium`` by the study's procedure: each turn brings in every pair that it reaches, and none leaves
    when the others' help makes the turn smaller.

    With secant contact stiffness the problem is linear for a given set of touching pairs; the stiffness is brought up
    to date until the forces stand still.
    """
    whole = problem.torque / compliance.pair.r_b2
    grid = _Grid.of(contacts)
    closing, lever_1, lever_2, teeth = (
        grid.fill(rows, empty)
        for rows, empty in (
            (problem.closing, np.inf), (problem.lever_1, 1.0), (problem.lever_2, 1.0), (problem.teeth, 1.0)
        )
    )  # fmt: skip
    point = np.stack([grid.fill(problem.point[:, k], 0.0) for k in (0, 1)], axis=-1)
    there = np.isfinite(closing)
    phi, force = np.zeros(closing.shape[0]), np.full(closing.shape, whole)
    if problem.torque == 0.0:
        return phi, np.zeros(problem.closing.size)
    at = np.arange(phi.size)
    for _ in range(ITERATIONS):
        k = 1.0 / compliance.secant(np.maximum(force, LEAST_LOAD * whole), teeth, point)
        # Pairs are sorted by closing rotation, so those that touch are the first few.
        weight = np.where(there, k * lever_1 * lever_2, 0.0)
        moment = problem.torque + np.cumsum(weight * np.where(there, closing, 0.0), axis=1)
        turns, m = moment / np.cumsum(weight, axis=1), np.zeros(phi.size, dtype=np.int64)
        for _ in range(closing.shape[1]):
            m = np.maximum(m, np.count_nonzero(closing < turns[at, m][:, None], axis=1) - 1)
        phi = turns[at, m]
        touches = there & (np.arange(closing.shape[1]) <= m[:, None])
        before, force = force, k * lever_1 * np.where(touches, phi[:, None] - np.where(there, closing, 0.0), 0.0)
        if np.any(touches & (lever_2 <= 0.0)):
            break  # friction locks the teeth
        if np.max(np.abs(force - before)) <= BALANCED * whole:
            return phi, force[grid.position, grid.place]
    raise NotConvergedError(UNSETTLED)


@dataclass(frozen=True)
class _Grid:
    """Rows of contacts laid out as positions by near pairs, first touch first."""

    position: IntArray
    place: IntArray
    shape: tuple[int, int]

    @staticmethod
    def of(contacts: FlankContacts) -> _Grid:
        count = np.bincount(contacts.position, minlength=contacts.theta_2.size)
        start = np.concatenate(([0], np.cumsum(count)[:-1]))
        place = np.arange(contacts.position.size) - start[contacts.position]
        return _Grid(contacts.position, place, (contacts.theta_2.size, int(count.max(initial=1))))

    def fill(self, rows: FloatArray, empty: float) -> FloatArray:
        """Rows as an array of positions by pairs, ``empty`` where there is no pair."""
        out = np.full(self.shape, empty)
        out[self.position, self.place] = rows
        return out
