"""A pair under one condition: contacts, load on the teeth, and what shafts add, from one set-up."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from gearpoly.mesh.condition import Condition
from gearpoly.mesh.deflection import Elasticity, PairCompliance, pair_compliance
from gearpoly.mesh.loaded import LoadedContacts, Sharing, TooNearError, load_reach, loaded
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.mesh.shafts import Shafts
from gearpoly.mesh.swings import SWINGS_PER_MESH, swings_at
from gearpoly.mesh.transmission import CERTIFIED_SAMPLE, NEAR_PAIR_MM, FlankContacts, contacts
from gearpoly.mesh.varied import GENTLE, giving
from gearpoly.units import FloatArray, IntArray, read_only

FARTHER = 1.2
"""How far pairs are looked for once more, as a multiple of how far they closed: another pair that comes to carry only
lowers that, so once more is enough."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Met:
    """Teeth in mesh at driven rotations: their ``contacts``, unloaded, and their ``load``, None where nothing bends."""

    contacts: FlankContacts
    load: LoadedContacts | None

    @property
    def te(self) -> FloatArray:
        """Transmission error (N,) of the mesh alone in rad, loaded where there is load."""
        return self.contacts.te if self.load is None else self.load.te

    @property
    def pairs(self) -> IntArray:
        """Number of touching pairs (N,), of carrying ones where there is load."""
        return self.contacts.pairs if self.load is None else self.load.pairs


@dataclass(frozen=True, kw_only=True, eq=False)
class Meshing:
    """A ``pair`` as it meshes under ``condition``: the ``compliance`` of its teeth on that flank (None: nothing bends),
    how pairs share the load, the ``shafts`` between mesh and encoders, and by how much the axes have moved apart,
    ``support`` in mm per N.mm of torque."""

    pair: GearPair
    condition: Condition
    compliance: PairCompliance | None
    sharing: Sharing
    shafts: Shafts
    support: float = 0.0

    @property
    def reach(self) -> float:
        """The most in mm that a pair alone can give under the largest torque; 0 where nothing bends."""
        return 0.0 if self.compliance is None else load_reach(self.compliance, self.condition.heaviest)

    @property
    def near(self) -> float:
        """mm along the line of action within which pairs are kept, since they may come to carry."""
        return NEAR_PAIR_MM + self.reach

    def with_elasticity(self, elasticity: Elasticity | None) -> Meshing:
        """The same gears with teeth that give otherwise (None: not at all). Raises what ``pair_compliance`` does."""
        return replace(self, compliance=compliance_under(self.pair, elasticity, self.condition))

    def at(
        self, theta_2: FloatArray, *, near: float | None = None, fast: bool = False, certified: int = CERTIFIED_SAMPLE
    ) -> Met:
        """Contacts and load at driven rotations ``theta_2`` (N,) in rad; pairs are looked for within ``near`` mm, and
        of a ``fast`` run so many positions are ``certified``.

        Raises ``NoContactError`` where no teeth touch, ``NotConvergedError`` or ``SelfCheckError`` where a contact
        cannot be certified, ``OutOfRangeError`` for a load beyond small deflections.
        """
        within = self.near if near is None else near
        return self.met(
            contacts(self.pair, theta_2, flank=self.condition.flank, near=within, fast=fast, certified=certified),
            fast=fast,
        )

    def met(self, rows: FlankContacts, *, fast: bool = True) -> Met:
        """The load on contacts that were found already; raises what ``at`` does. They are found anew, ``fast`` or each
        certified, where the load closes pairs that had not been looked for."""
        try:
            met = Met(contacts=rows, load=self.carried(rows))
        except TooNearError as short:
            approach = short.approach
        else:
            if met.load is None:
                return met
            approach = float(np.max(met.load.approach, initial=0.0)) * self.condition.heaviest / self.condition.torque
            if approach <= rows.near:
                return met
        return self.at(rows.theta_2, near=FARTHER * approach, fast=fast)

    def carried(self, rows: FlankContacts) -> LoadedContacts | None:
        """How contacts share the torque; None where nothing bends."""
        if self.compliance is None:
            return None
        return loaded(rows, self.compliance, torque=self.condition.torque, sharing=self.sharing)

    @property
    def twist(self) -> float:
        """What twisting shafts add to the transmission error, rad."""
        return self.shafts.twist(torque=self.condition.torque, coast=self.condition.coast)

    def further_te(self, theta_2: FloatArray, te: FloatArray, *, time: FloatArray | None = None) -> FloatArray:
        """What shafts and resonance add (N,) in rad to the transmission error ``te`` (N,) in rad of the mesh alone at
        ``theta_2`` (N,) in rad; over ``time`` (N,) in s a resonance follows a run-up."""
        out = np.full(theta_2.size, self.twist)
        speed, backward = self.condition.speed, self.condition.backward
        if self.shafts.frequency is None or speed is None:
            return out
        whole = self.cycle_te
        return out + swings_at(self.shafts, whole, self.pair, theta_2, te, speed=speed, time=time, backward=backward)

    def varied_te(self, met: Met, off: FloatArray | None) -> FloatArray | float:
        """What a torque adds to the transmission error (N,) in rad that is off its mean by the part ``off`` (N,) of it
        (None: steady): shafts twist, and teeth give, by the stiffness of their load where that is little, else as a
        parabola through the contacts under the mean, the least and the largest torque has it, which second contacts
        and Hertz's law bend."""
        if off is None:
            return 0.0
        torque, load = self.condition.torque, met.load
        twist = off * (self.twist + self.parting)
        if load is None or self.compliance is None:
            return twist
        most = float(np.max(np.abs(off)))
        if most < GENTLE:
            sense = 1.0 if self.condition.coast else -1.0
            return twist + off * (sense * torque / (load.stiffness * self.pair.r_b2**2))
        gives = giving(met.contacts, self.compliance, load.te, torque=torque, most=most, sharing=self.sharing)
        return twist + gives.by(off)

    @property
    def parting(self) -> float:
        """What axes that move apart add to the transmission error to first order, rad: flanks open by
        da sin(alpha_w) each (ISO 21771:2007, d inv(alpha_w)/da), so the driven side lags on the drive flank."""
        sense = 1.0 if self.condition.coast else -1.0
        return sense * self.support * self.condition.torque * math.sin(self.pair.alpha_w) / self.pair.r_b2

    @property
    def cycle_te(self) -> FloatArray:
        """Transmission error of the mesh alone in rad at even places of a hunting cycle, ``SWINGS_PER_MESH`` a
        pitch."""
        still = replace(self.condition, speed=None, varies=0.0)
        return _cycle_te(self.pair, still, self.compliance, self.sharing)


def compliance_under(pair: GearPair, elasticity: Elasticity | None, condition: Condition) -> PairCompliance | None:
    """How far the teeth of ``pair`` give under ``condition``; None where nothing bends: rigid teeth, or no torque.

    Raises what ``pair_compliance`` does.
    """
    if elasticity is None or condition.torque == 0.0:
        return None
    return kept_compliance(pair, elasticity.running(backward=condition.backward), condition.flank)


@lru_cache(maxsize=64)
def kept_compliance(pair: GearPair, elasticity: Elasticity, flank: Flank) -> PairCompliance:
    """``pair_compliance``, kept: recordings of a set share their gears, and so their compliance."""
    return pair_compliance(pair, elasticity, flank=flank)


@lru_cache(maxsize=8)
def _cycle_te(pair: GearPair, condition: Condition, compliance: PairCompliance | None, sharing: Sharing) -> FloatArray:
    still = Meshing(pair=pair, condition=condition, compliance=compliance, sharing=sharing, shafts=Shafts())
    size = pair.meshes_per_cycle * SWINGS_PER_MESH
    even = np.arange(size, dtype=np.float64) * (pair.cycle / size)
    return read_only(still.at(even, fast=True).te)
