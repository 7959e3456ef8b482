"""The touching pairs of teeth at the samples of one recording, and how small changes move the transmission error.

By the envelope theorem the transmission error moves with the deviation at the contact points of the touching pairs,
each weighed by its stiffness: first-order effects of small changes need no further simulation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.gear.deviations import Deviations, Index, Span
from gearpoly.gear.gear import Gear
from gearpoly.mesh.deflection import Elasticity
from gearpoly.mesh.meshing import Meshing, kept_compliance
from gearpoly.mesh.pair import GearPair, active_start
from gearpoly.physics.samples import Samples
from gearpoly.physics.shown import DeviationOf
from gearpoly.units import FloatArray, IntArray

Held = tuple[IntArray, FloatArray, FloatArray]
"""Samples, roll lengths in mm and weights of one tooth's contacts, (k,) each."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TouchingPairs:
    """The pairs of teeth of a set-up that touch at the samples (n,) of one recording, in rows (P, n).

    ``tooth_1``, ``tooth_2``, roll lengths ``l_1``, ``l_2`` in mm, ``weight`` in the transmission error (0: none),
    normal ``force`` in N, ``n_x``, ``n_y`` the normal from the driving into the driven tooth.
    """

    samples: Samples
    assembled: Assembled
    tooth_1: IntArray
    tooth_2: IntArray
    l_1: FloatArray
    l_2: FloatArray
    n_x: FloatArray
    n_y: FloatArray
    weight: FloatArray
    force: FloatArray

    @cached_property
    def mesh(self) -> Meshing:
        """The pair as it meshes under the condition of the recording."""
        return self.assembled.under(self.samples.condition)

    @property
    def pair(self) -> GearPair:
        """The simulated pair."""
        return self.mesh.pair

    @property
    def deviations(self) -> tuple[Deviations, Deviations]:
        """What both gears deviate by."""
        return self.assembled.deviations

    @property
    def bends(self) -> bool:
        """Whether load bends teeth here."""
        return self.assembled.elasticity is not None and self.samples.torque > 0.0

    def teeth(self, gear: int) -> IntArray:
        """Tooth numbers (P, n) of gear 0 (driving) or 1."""
        return self.tooth_1 if gear == 0 else self.tooth_2

    def gear(self, gear: int) -> Gear:
        """The deviation-free gear 0 (driving) or 1."""
        return (self.pair.driving if gear == 0 else self.pair.driven).gear

    def carried(self, gear: int, tooth: int) -> float:
        """What a tooth carries in the mean, over what the median tooth of its gear does; 1 where that is nothing."""
        z = self.gear(gear).z
        by_tooth = np.bincount(self.teeth(gear).ravel(), weights=self.weight.ravel(), minlength=z)
        usual = float(np.median(by_tooth))
        return float(by_tooth[tooth]) / usual if usual > 0.0 else 1.0

    def roll(self, gear: int) -> FloatArray:
        """Roll lengths (P, n) in mm at which the flanks of gear 0 (driving) or 1 hold what now is in contact.

        A whole flank that stands off its place, as a coast flank of thin teeth does, brings its profile along: at the
        tip of a tooth thinner by 60 um touches what was drawn 0.06 mm of roll beyond it.
        """
        standing = self._standing[gear]
        return (self.l_1 if gear == 0 else self.l_2) - standing[self.teeth(gear)] * (self.weight > 0.0)

    @cached_property
    def _standing(self) -> tuple[FloatArray, FloatArray]:
        """Index deviations (z,) in mm of both gears' flanks in contact."""
        out = []
        for which, made in enumerate(self.assembled.deviations):
            total = np.zeros(self.gear(which).z)
            for shape in made.coast if self.samples.coast else made.drive:
                if isinstance(shape, Index):
                    total = total + shape.p
            out.append(total)
        return out[0], out[1]

    @cached_property
    def spans(self) -> tuple[Span, Span]:
        """Between which roll lengths the flanks of both gears work."""
        gears = self.pair.driving.gear, self.pair.driven.gear
        starts = [
            active_start(gear, mate, l_form=mounted.flanks.root.l_form)
            for gear, mate, mounted in zip(gears, gears[::-1], (self.pair.driving, self.pair.driven), strict=True)
        ]
        return Span(l_start=starts[0], l_a=gears[0].l_a), Span(l_start=starts[1], l_a=gears[1].l_a)

    def moved_by(self, deviation: FloatArray) -> FloatArray:
        """Change (n,) in mm of the transmission error when pairs have ``deviation`` (P, n) mm more material."""
        return np.asarray(self.samples.sense * np.einsum("pn,pn->n", self.weight, deviation))

    def deviated(self, gear: int, deviation: DeviationOf) -> FloatArray:
        """The same for a deviation of the flanks of one gear."""
        return self.moved_by(deviation(self.teeth(gear), self.roll(gear)))

    def deviated_tooth(self, gear: int, tooth: int | None, deviation: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """The same for a deviation (k,) in mm at roll lengths (k,) in mm of a single tooth."""
        if tooth is None:
            return np.zeros(self.samples.size)
        n, roll, weight = self._held[gear][tooth]
        return np.bincount(n, weights=weight * deviation(roll), minlength=self.samples.size).astype(np.float64)

    @cached_property
    def _held(self) -> tuple[list[Held], list[Held]]:
        """Of every tooth of both gears: samples at which it is in contact, roll lengths in mm there, and weights with
        the sign of the flank."""
        out: tuple[list[Held], list[Held]] = ([], [])
        p, n = np.nonzero(self.weight > 0.0)
        for gear in (0, 1):
            tooth = self.teeth(gear)[p, n]
            order = np.argsort(tooth, kind="stable")
            edges = np.searchsorted(tooth[order], np.arange(self.gear(gear).z + 1))
            roll, weight = self.roll(gear)[p, n][order], self.samples.sense * self.weight[p, n][order]
            for low, high in pairwise(edges.tolist()):
                part = slice(low, high)
                out[gear].append((n[order][part], roll[part], weight[part]))
        return out

    def displaced(self, gear: int, x: FloatArray, y: FloatArray) -> FloatArray:
        """The same when the centre of one gear moves by (x, y) (n,) mm in the global frame."""
        # Towards the mate closes the gap: the driving gear along the normal, the driven against it.
        towards = 1.0 if gear == 0 else -1.0
        return self.moved_by(towards * (x * self.n_x + y * self.n_y))

    def tooth_compliance(self, gear: int) -> FloatArray:
        """Compliance (P, n) in mm/N of the teeth of one gear at their contacts, were they sound: a crack is a factor of
        it, also where one is claimed already."""
        return self._tooth_compliance[gear]

    @cached_property
    def _tooth_compliance(self) -> tuple[FloatArray, FloatArray]:
        out = []
        elasticity = replace(self.assembled.elasticity or Elasticity(), cracks=())
        sound = kept_compliance(self.pair, elasticity, self.samples.flank)
        for gear, l, r_b in ((0, self.l_1, self.pair.r_b1), (1, self.l_2, self.pair.r_b2)):
            table = sound.driving if gear == 0 else sound.driven
            tooth = self.teeth(gear)
            out.append(table.at(tooth.ravel(), np.hypot(l, r_b).ravel()).reshape(tooth.shape))
        return out[0], out[1]
