"""The simulated transmission error of one condition over a whole hunting cycle, ready to be read off at any angle.

Between hand-overs the curve is nearly straight, at hand-overs it bends sharply, so positions are added only where a
straight line would miss the curve by more than a stated error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.compare.periodic import periodic
from gearpoly.compare.sharing import Sharing, sharing_from_rows
from gearpoly.mesh.alike import alike, repeated
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.deflection import LEAST_LOAD, PairCompliance
from gearpoly.mesh.loaded import LoadedContacts
from gearpoly.mesh.meshing import Meshing
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.mesh.swings import swings_at
from gearpoly.mesh.transmission import FlankContacts, contacts
from gearpoly.mesh.varied import Giving, giving
from gearpoly.units import UM, FloatArray, read_only

EVEN_PER_MESH = 32
"""Even places per pitch: a hand-over then lies in every tenth interval, so that the others need no second look."""

MOST_EVEN_PLACES = 400_000
"""Most even places over a cycle; pairs of more than 12 500 meshes get fewer per pitch, down to
``LEAST_PLACES_PER_MESH``."""

LEAST_PLACES_PER_MESH = 8
"""Still enough that no stretch of single contact falls between two places."""

ERROR = 0.02 * UM
"""mm. Halving stops where straight lines follow the curve to this, a fifth of the least order line that is looked
for, and of either sign."""

SECOND_LOOK_AT = 0.3
"""Where in an interval the curve is looked at once more before it is taken for straight."""

MOST_INTERVAL_HALVINGS = 12
"""Times that an interval is halved at most: 1/32 of a pitch becomes 1e-5 of a pitch, less than encoders resolve."""

SHARERS = 40.0 * UM
"""mm. Pairs that close within this of the first are kept beside it: what an uninspected tooth may deviate by, so that
its pair may turn out to be the one that touches."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Template:
    """Simulated transmission error of a pair under one condition, periodic in the hunting cycle.

    ``theta_2`` (n,) driven rotations in rad, rising from 0 to ``cycle``; ``te`` (n,) in mm along the line of action,
    straight lines between; ``error`` in mm, the most by which a line was still seen to miss the curve. ``even``
    (meshes * per_mesh,) in mm is the same curve on even places of the cycle. ``torque`` in N.mm. ``sharing`` says which
    pairs carry there, and ``rigid`` (n,) in mm is the curve without load at ``theta_2``, None where nothing bends.
    ``twist`` in mm is what shafts add, and ``giving`` how teeth give where the torque varies, None where it does not.
    """

    flank: Flank
    torque: float
    theta_2: FloatArray
    te: FloatArray
    even: FloatArray
    per_mesh: int
    error: float
    sharing: Sharing
    rigid: FloatArray | None
    twist: float
    giving: Giving | None

    @property
    def cycle(self) -> float:
        """The hunting cycle as driven rotation in rad."""
        return float(self.theta_2[-1])

    @cached_property
    def mean(self) -> float:
        """Mean over the cycle, mm."""
        return float(np.trapezoid(self.te, self.theta_2)) / self.cycle

    def at(self, theta_2: FloatArray) -> FloatArray:
        """Transmission error in mm at any driven rotations in rad."""
        return periodic(theta_2, self.theta_2, self.te)

    def slope(self, theta_2: FloatArray) -> FloatArray:
        """d(TE)/d(theta_2) in mm/rad over 1/32 of a pitch: short against the stretch between hand-overs, long against
        chords, whose ripple of nanometres is steep but means nothing."""
        h = self.cycle * self.per_mesh / self.even.size / 64.0
        return (self.at(theta_2 + h) - self.at(theta_2 - h)) / (2.0 * h)

    def deflection(self, theta_2: FloatArray) -> FloatArray | None:
        """What load changes (n,) in mm; None where nothing bends."""
        if self.rigid is None:
            return None
        return periodic(theta_2, self.theta_2, self.te - self.rigid)

    def varied(self, theta_2: FloatArray, load: FloatArray) -> FloatArray:
        """What is added (n,) in mm where the torque is off by the part ``load`` (n,) of it."""
        twisted = self.twist * load
        if self.giving is None:
            return twisted
        return twisted + self.giving.interpolated(np.mod(theta_2, self.cycle), self.theta_2).by(load)


Found = dict[tuple[GearPair, Flank, str, int], FlankContacts]
"""Contacts at the places that all templates of a pair begin with: the pair as it stands, flank, which places, and how
many."""

Made = TypeVar("Made")


def make_template(
    assembled: Assembled,
    condition: Condition,
    *,
    error: float = ERROR,
    per_mesh: int | None = None,
    found: Found | None = None,
) -> Template:
    """Simulate ``assembled`` over one hunting cycle under ``condition``, lines true to ``error`` (mm).

    Teeth bend where the pair's file says so and the torque is above 0. A speed makes a mesh resonance swing; backward,
    flanks slide the other way, and hand-overs swing before them. ``found`` keeps contacts that templates of several
    torques, the largest first, share. Raises ``GeometryError`` where no teeth touch, ``SelfCheckError`` where the
    certified kernel disagrees, ``OutOfRangeError`` for a load beyond small deflections.
    """
    mesh = assembled.under(condition)
    pair, flank = mesh.pair, condition.flank
    near, found = _near(mesh), {} if found is None else found

    def searched(theta_2: FloatArray, places: str) -> FlankContacts:
        return _searched(mesh, theta_2, places, found)

    def curves(theta_2: FloatArray, *, places: str = "") -> tuple[FloatArray, FloatArray]:
        """Transmission error (n,) in mm with and without load."""
        met = mesh.met(searched(theta_2, places)) if places else mesh.at(theta_2, near=near, fast=True)
        return met.te * pair.r_b2, met.contacts.te * pair.r_b2

    per_mesh = per_mesh or _even_per_mesh(pair)
    theta_2 = np.linspace(0.0, pair.cycle, pair.meshes_per_cycle * per_mesh + 1)
    met = mesh.met(searched(theta_2[:-1], "even"))
    rows, load = met.contacts, met.load
    even = met.te * pair.r_b2
    te, free = np.append(even, even[0]), np.append(rows.te, rows.te[0]) * pair.r_b2
    theta_2, te, free, missed = _halved(theta_2, te, free, curves, error=error)
    give = _giving(mesh, theta_2, te, near=near)
    te, even, twist = _seen_by_shafts(mesh, theta_2, te, even)
    return Template(
        flank=flank,
        torque=condition.torque,
        theta_2=read_only(theta_2),
        te=read_only(te),
        even=read_only(even),
        per_mesh=per_mesh,
        error=missed,
        sharing=_sharing(pair, rows, load, mesh.compliance),
        rigid=None if mesh.compliance is None else read_only(free),
        twist=twist,
        giving=give,
    )


def sharings_of(assembled: Assembled, conditions: Sequence[Condition]) -> list[Sharing]:
    """Which pairs carry together on even places of one hunting cycle, for each recording by its condition; what lies
    between these places is not simulated. Raises what ``make_template`` does."""

    def shared(condition: Condition, found: Found) -> Sharing:
        mesh = assembled.under(condition)
        pair = mesh.pair
        places = np.linspace(0.0, pair.cycle, pair.meshes_per_cycle * _even_per_mesh(pair) + 1)[:-1]
        met = mesh.met(_searched(mesh, places, "even", found))
        return _sharing(pair, met.contacts, met.load, mesh.compliance)

    return _by_condition(assembled, conditions, shared)


def _even_per_mesh(pair: GearPair) -> int:
    return max(LEAST_PLACES_PER_MESH, min(EVEN_PER_MESH, MOST_EVEN_PLACES // pair.meshes_per_cycle))


def _near(mesh: Meshing) -> float:
    return 0.0 if mesh.compliance is None else mesh.near


def _searched(mesh: Meshing, theta_2: FloatArray, places: str, found: Found) -> FlankContacts:
    """Contacts that any torque may ask for, found once, at places that lie alike in every pitch of the cycle."""
    pair, flank = mesh.pair, mesh.condition.flank
    key, near = (pair, flank, places, theta_2.size), _near(mesh)
    if key not in found or found[key].near < near:
        one = theta_2.size // pair.meshes_per_cycle if alike(pair) else theta_2.size
        here = contacts(pair, theta_2[:one], flank=flank, near=max(near, SHARERS), fast=True)
        found[key] = here if one == theta_2.size else repeated(here, pair, theta_2=theta_2)
    return found[key]


Curves = Callable[..., tuple[FloatArray, FloatArray]]
"""Transmission error (n,) in mm with and without load at driven rotations (n,) in rad; ``places`` names those that
templates share."""


def _halved(
    theta_2: FloatArray, te: FloatArray, free: FloatArray, curves: Curves, *, error: float
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Places, curves with and without load on them, halved until straight lines between them are true to ``error`` mm;
    and what they miss at most, mm."""
    low = np.arange(theta_2.size - 1)
    missed = 0.0
    for level in range(MOST_INTERVAL_HALVINGS):
        middle = 0.5 * (theta_2[low] + theta_2[low + 1])
        here, freely = curves(middle, places="middle" if level == 0 else "")
        off = np.abs(here - 0.5 * (te[low] + te[low + 1]))
        if level == 0:
            # A corner that passes between two places bends the curve to both sides, and by chance not in the middle.
            aside, _ = curves(theta_2[low] + SECOND_LOOK_AT * (theta_2[low + 1] - theta_2[low]), places="aside")
            off = np.maximum(off, np.abs(aside - (1.0 - SECOND_LOOK_AT) * te[low] - SECOND_LOOK_AT * te[low + 1]))
        # A bend that hides from the middle (two that cancel, one at an end) lies beside one that does not.
        bad = off > 0.5 * error
        beside = np.diff(low) == 1
        bad[1:] |= beside & (off[:-1] > error)
        bad[:-1] |= beside & (off[1:] > error)
        # A line misses a bend by at most twice what shows at its middle, a smooth curve by just that.
        missed = max(missed, 2.0 * float(np.max(off, initial=0.0, where=~bad)))
        low, middle, here, freely = low[bad], middle[bad], here[bad], freely[bad]
        if not low.size:
            break
        theta_2, te = np.insert(theta_2, low + 1, middle), np.insert(te, low + 1, here)
        free = np.insert(free, low + 1, freely)
        first = low + np.arange(low.size)
        low = np.sort(np.concatenate((first, first + 1)))
    else:
        missed = max(missed, 2.0 * float(np.max(off)))
    return theta_2, te, free, missed


def _giving(mesh: Meshing, theta_2: FloatArray, te: FloatArray, *, near: float) -> Giving | None:
    """How teeth give to a torque that varies, in mm, at the places where the curve ``te`` (n,) in mm bends: there it
    bends too. ``None`` where nothing varies or bends; ``near`` in mm, within which pairs may come to carry."""
    pair, condition, compliance = mesh.pair, mesh.condition, mesh.compliance
    if not condition.varies or compliance is None:
        return None
    there = contacts(pair, theta_2, flank=condition.flank, near=near, fast=True)
    by = giving(there, compliance, te / pair.r_b2, torque=condition.torque, most=condition.varies, sharing=mesh.sharing)
    return by.times(pair.r_b2)


def _seen_by_shafts(
    mesh: Meshing, theta_2: FloatArray, te: FloatArray, even: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """The transmission error in mm at ``theta_2`` and on ``even`` places of the cycle with what the shafts add: their
    twist, also alone, and the swings of a resonance."""
    shafts, pair, condition = mesh.shafts, mesh.pair, mesh.condition
    if shafts.rigid:
        return te, even, 0.0
    twist = mesh.twist * pair.r_b2
    places = np.arange(even.size, dtype=np.float64) * (pair.cycle / even.size)
    if condition.speed and shafts.frequency is not None:
        speed, backward = condition.speed, condition.backward
        te, even = (
            here + swings_at(shafts, even, pair, at, here, speed=speed, time=None, backward=backward)
            for at, here in ((theta_2, te), (places, even))
        )
    return te + twist, even + twist, twist


def _sharing(pair: GearPair, rows: FlankContacts, load: LoadedContacts | None, by: PairCompliance | None) -> Sharing:
    """Which pairs carry on the even places, and what part of each pair's deviation reaches the transmission error."""
    share = None
    if load is not None and by is not None:
        _, contact = by.contact(np.maximum(load.force, LEAST_LOAD * float(np.max(load.force))), rows.point)
        stiffness = (load.force > 0.0) / (by.teeth(rows.driving, rows.driven, rows.point) + contact)
        share = stiffness / np.bincount(rows.position, weights=stiffness)[rows.position]
    pitch_point = pair.r_b1 * math.tan(pair.driving.alpha_w)
    path = pair.a * math.sin(pair.alpha_w)
    entry, exit_ = path - pair.driven.gear.l_a, pair.driving.gear.l_a
    begin, end = ((l - pitch_point) / pair.driving.gear.p_b for l in (entry, exit_))
    return sharing_from_rows(
        z_1=pair.driving.gear.z,
        z_2=pair.driven.gear.z,
        theta_2=rows.theta_2,
        position=rows.position,
        driving=rows.driving,
        gap=rows.gap,
        share=share,
        # On the coast flank the path is run through backwards, half a pitch late.
        contact=(begin, end) if rows.flank == "drive" else (0.5 - end, 0.5 - begin),
        flank=rows.flank,
        approach=None if load is None else np.abs(rows.te - load.te) * pair.r_b2,
    )


def templates_of(assembled: Assembled, conditions: Sequence[Condition]) -> list[Template]:
    """One simulation per recording, by its condition; those of one condition share theirs. Raises what
    ``make_template`` does."""
    return _by_condition(assembled, conditions, lambda one, found: make_template(assembled, one, found=found))


def _by_condition(
    assembled: Assembled, conditions: Sequence[Condition], make: Callable[[Condition, Found], Made]
) -> list[Made]:
    """What is to ``make`` of each recording's condition, once of those that share one."""
    loads = assembled.feels_torque
    swings = assembled.shafts.frequency is not None
    # What a condition changes nothing by does not part two of them.
    keys = [
        Condition(
            flank=one.flank,
            torque=one.torque if loads else 0.0,
            speed=one.speed if swings else None,
            backward=one.backward and loads,
            varies=one.varies if loads else 0.0,
        )
        for one in conditions
    ]
    made: dict[Condition, Made] = {}
    found: Found = {}
    # The largest torque asks for the pairs furthest from touch; the others find theirs among them.
    for key in sorted(dict.fromkeys(keys), key=lambda one: -one.heaviest):
        made[key] = make(key, found)
    return [made[key] for key in keys]
