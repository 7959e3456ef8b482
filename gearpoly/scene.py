"""A set-up simulated at the samples of one recording, and how its load and shafts answer changes.

Every sample is simulated at its own angle, so nothing is interpolated.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearpoly.assemble import Assembled, with_tip
from gearpoly.mesh.corner import of_rows, standing_off
from gearpoly.mesh.deflection import Elasticity
from gearpoly.mesh.first_touch import REACHED, smooth_first
from gearpoly.mesh.loaded import weights
from gearpoly.mesh.meshing import Meshing, Met
from gearpoly.mesh.shafts import Shafts
from gearpoly.mesh.swings import swings_at
from gearpoly.mesh.transmission import NEAR_PAIR_MM, FlankContacts
from gearpoly.physics.samples import Samples
from gearpoly.touching import TouchingPairs
from gearpoly.units import UM, BoolArray, FloatArray, IntArray

SOFTER_LAWS_FACTOR, LOOKED_BEYOND_MM = 1.6, NEAR_PAIR_MM + 25.0 * UM
"""How much farther pairs are looked for than the load closes, so that softer laws and gaps across the face (mm) need no
second search."""

CERTIFIED_POSITIONS = 2
"""Positions of one recording that the polygon kernel certifies each time it is simulated: a diagnosis does so 300 to
1600 times, so that as many are seen as of ten to fifty simulations of a user. Five cost a twentieth of all its time."""

TAKEN_OVER = 0.1
"""Modules. How far the next pair lags at most behind one that lets go: 0.075 where 3 mm are missing of a tooth of an
18/25 pair of module 2, and its form circle is next. 1.5 mm are bridged, and nothing lags."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene(TouchingPairs):
    """A set-up simulated at the samples of one recording: its touching pairs, and how load and shafts answer changes.

    ``rows`` the contacts as they were found; ``te`` (n,) in mm, of the mesh alone ``mesh_te``, at one place always the
    same; ``soft`` (n,) compliance in mm/N of all touching pairs together, 0 where nothing bends.
    """

    rows: FlankContacts
    te: FloatArray
    mesh_te: FloatArray
    soft: FloatArray

    def standing_off(self, gear: int, tooth: int, off: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Change (n,) in mm of the transmission error when the contacts of one tooth, whole before, at roll lengths
        (k,) in mm stand off by ``off`` (k,) mm more: load is shared anew, and pairs may let go of each other."""
        where, whole = self._whole(gear, tooth)
        rows, mine, roll = whole._of_tooth(gear, tooth)
        by = np.zeros(mine.size)
        # Beyond what was looked at no other pair is known to take over.
        by[mine] = np.minimum(off(roll), rows.near)
        at, _, moved = standing_off(rows, whole.pair, by)
        out = np.zeros(self.samples.size)
        if at.size:
            carried = Met(contacts=moved, load=whole.mesh.carried(moved))
            out[where[at]] = carried.te * whole.pair.r_b2 - whole.mesh_te[at]
        return out

    def _of_tooth(self, gear: int, tooth: int) -> tuple[FlankContacts, BoolArray, FloatArray]:
        """All contacts (k,) at the positions at which a tooth has any, which of them are its own, and the roll lengths
        of these in mm: a tooth is asked about at many sizes, and is in mesh for two pitches of a turn."""
        if (gear, tooth) not in self._teeth:
            rows, pair = self._taken_over, self.pair
            mine = (rows.driving if gear == 0 else rows.driven) == tooth
            there = np.zeros(rows.theta_2.size, dtype=bool)
            there[rows.position[mine]] = True
            held = there[rows.position]
            near, mine = of_rows(rows, held), mine[held]
            r2 = (near.point[mine, 0] - gear * pair.a) ** 2 + near.point[mine, 1] ** 2
            self._teeth[gear, tooth] = near, mine, np.sqrt(np.maximum(r2 - self.gear(gear).r_b ** 2, 0.0))
        return self._teeth[gear, tooth]

    @cached_property
    def _teeth(self) -> dict[tuple[int, int], tuple[FlankContacts, BoolArray, FloatArray]]:
        """Contacts about single teeth, as far as they were asked for."""
        return {}

    def _whole(self, gear: int, tooth: int) -> tuple[IntArray, Scene]:
        """The samples (k,) at which a tooth may be in mesh, and the same there with its tip in place."""
        if tooth not in (self.pair.driving, self.pair.driven)[gear].flanks.chipped:
            return np.arange(self.samples.size), self
        if (gear, tooth) not in self._with_tips:
            where = self.samples.meshing(gear, tooth, z=self.gear(gear).z)
            self._with_tips[gear, tooth] = where, stage(with_tip(self.assembled, gear, tooth), self.samples.at(where))
        return self._with_tips[gear, tooth]

    @cached_property
    def _taken_over(self) -> FlankContacts:
        """Contacts with all pairs that may take over what another lets go."""
        if self.mesh.compliance is not None:
            return self.rows
        return _met(self.mesh, self.samples, near=TAKEN_OVER * self.gear(0).m).contacts

    @cached_property
    def _with_tips(self) -> dict[tuple[int, int], tuple[IntArray, Scene]]:
        """Scenes with a tip in place that is missing, as far as they were asked for."""
        return {}

    def bending(self, elasticity: Elasticity | None) -> FloatArray:
        """Transmission error (n,) in mm of the same gears with other ``elasticity`` (None: rigid), shafts included."""
        return self.te + self.samples.loaded * self.swung(self._loaded_te(elasticity) - self.mesh_te)

    def with_load_of(self, assembled: Assembled) -> FloatArray:
        """Transmission error (n,) in mm of these gears with what load, shafts and resonance do in another set-up."""
        s, shafts, r_b2 = self.samples, assembled.shafts, self.pair.r_b2
        te = self._loaded_te(assembled.elasticity)
        twist = assembled.under(s.condition).twist
        te = te + _varied(s, te - self.rows.te * r_b2) + s.loaded * twist * r_b2
        if shafts.frequency is not None and s.speed is not None:
            te = self.mesh_te + self.swings(shafts) * r_b2 + self._magnified(shafts, te - self.mesh_te)
        return te

    def _loaded_te(self, elasticity: Elasticity | None) -> FloatArray:
        """Transmission error (n,) in mm of the mesh alone."""
        mesh = self.mesh.with_elasticity(elasticity)
        # Unloaded contacts are found to any distance.
        enough = mesh.compliance is None or mesh.near <= self.rows.near
        met = mesh.met(self.rows) if enough else _met(mesh, self.samples, near=mesh.near)
        return met.te * self.pair.r_b2

    @property
    def resonant(self) -> bool:
        """Whether a resonance of the shafts magnifies what the mesh does."""
        return self.assembled.shafts.frequency is not None and self.samples.speed is not None

    def swung(self, changes: FloatArray) -> FloatArray:
        """``changes`` (n,) or (n, m) of the mesh's own transmission error as a resonance, if there is one, magnifies
        them."""
        return self._magnified(self.assembled.shafts, changes) if self.resonant else changes

    def _magnified(self, shafts: Shafts, changes: FloatArray) -> FloatArray:
        if self.samples.backward:
            return shafts.magnified(changes[::-1], time=self.passed[-1] - self.passed[::-1])[::-1]
        return shafts.magnified(changes, time=self.passed)

    @cached_property
    def passed(self) -> FloatArray:
        """Time (n,) in s, by the speed where the recording has none."""
        s = self.samples
        if s.time is not None or s.speed is None:
            return np.zeros(s.size) if s.time is None else s.time
        return np.asarray(np.abs(s.theta_2 - s.theta_2[0]) / (s.speed * self.pair.ratio))

    def swings(self, shafts: Shafts) -> FloatArray:
        """What a resonance of ``shafts`` adds (n,) in rad to the transmission error of the mesh."""
        s = self.samples
        if s.speed is None:
            return np.zeros(s.size)
        here = self.mesh_te / self.pair.r_b2
        return swings_at(
            shafts, self.cycle_te, self.pair, s.theta_2, here, speed=s.speed, time=s.time, backward=s.backward
        )

    @cached_property
    def cycle_te(self) -> FloatArray:
        """Transmission error in rad of the mesh alone at even places of a hunting cycle."""
        return self.mesh.cycle_te


def _met(mesh: Meshing, samples: Samples, *, near: float) -> Met:
    # Within one hunting cycle: whole cycles change nothing, and small angles keep their digits.
    return mesh.at(np.mod(samples.theta_2, mesh.pair.cycle), near=near, fast=True, certified=CERTIFIED_POSITIONS)


def _varied(samples: Samples, bent: FloatArray) -> FloatArray | float:
    """What a torque that varies along a recording adds (n,) to the transmission error of teeth that are ``bent`` (n,)
    by its mean, in the same unit: deflection is nearly proportional to torque."""
    return 0.0 if samples.load is None else samples.load * bent


def stage(assembled: Assembled, samples: Samples, *, smoothing: float = 0.0) -> Scene:
    """Simulate a set-up at the samples of a recording; where nothing bends, with a smooth maximum of so many mm over
    the pairs that may touch first.

    Raises ``GeometryError`` where no teeth touch, ``SelfCheckError`` where the certified kernel disagrees,
    ``OutOfRangeError`` for a load beyond small deflections.
    """
    mesh = assembled.under(samples.condition)
    pair = mesh.pair
    near = LOOKED_BEYOND_MM + SOFTER_LAWS_FACTOR * mesh.reach
    if mesh.compliance is None:
        near = max(NEAR_PAIR_MM, REACHED * smoothing)
    met = _met(mesh, samples, near=near)
    rows, load = met.contacts, met.load
    weight, force = weights(rows, load, mesh.compliance)
    mesh_te = met.te * pair.r_b2
    if load is None and smoothing > 0.0:
        weight, above = smooth_first(rows, width=smoothing)
        mesh_te = mesh_te + above
    held = weight > 0.0
    position = rows.position[held]
    start = np.searchsorted(position, np.arange(samples.size))
    slot = np.arange(position.size) - start[position]
    shape = (int(slot.max(initial=0)) + 1, samples.size)

    def laid(values: FloatArray) -> FloatArray:
        out = np.zeros(shape)
        out[slot, position] = values[held]
        return out

    def numbered(values: IntArray) -> IntArray:
        out = np.zeros(shape, dtype=np.int64)
        out[slot, position] = values[held]
        return out

    r_1 = np.hypot(rows.point[:, 0], rows.point[:, 1])
    r_2 = np.hypot(rows.point[:, 0] - pair.a, rows.point[:, 1])
    further = mesh.further_te(samples.theta_2, met.te, time=samples.time) + mesh.varied_te(met, samples.load)
    soft = np.zeros(samples.size)
    if load is not None:
        # Stiffness is stated for rotations of both shafts: moments over rotation, over both base radii.
        soft = 1.0 / load.stiffness
    return Scene(
        samples=samples,
        assembled=assembled,
        rows=rows,
        te=mesh_te + further * pair.r_b2,
        mesh_te=mesh_te,
        tooth_1=numbered(rows.driving),
        tooth_2=numbered(rows.driven),
        l_1=laid(np.sqrt(np.maximum(r_1**2 - pair.r_b1**2, 0.0))),
        l_2=laid(np.sqrt(np.maximum(r_2**2 - pair.r_b2**2, 0.0))),
        n_x=laid(rows.normal[:, 0]),
        n_y=laid(rows.normal[:, 1]),
        weight=laid(weight),
        force=laid(force),
        soft=soft,
    )
