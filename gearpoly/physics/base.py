"""What every physics hands to the diagnosis."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from gearpoly.gear.deviations import Deviations
from gearpoly.gear.gear import Gear
from gearpoly.keys.also_turns import Part, lines_at, parts_of
from gearpoly.keys.sections import GearSection, PairFile, Section
from gearpoly.mesh.shafts import RUN_UP_SPEED_PART
from gearpoly.physics.parts import Parts
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True)
class Scope:
    """What is known before any search: the declared ``file``, both nominal ``gears``, and of each recording the
    ``flanks``, ``torques`` in N.mm and ``speeds`` in rad/s (None: unknown); which shafts have ``encoders``; whether all
    recordings are ``timed``; ``span`` in driving turns of the longest; ``inspected`` gears; ``place`` in rad of the
    encoder zeros and the contacts' range of roll lengths per gear ``reach``."""

    file: PairFile
    gears: tuple[Gear, Gear]
    flanks: tuple[str, ...]
    torques: tuple[float, ...]
    speeds: tuple[float | None, ...]
    encoders: tuple[bool, bool]
    timed: bool
    counted: bool
    span: float
    inspected: tuple[bool, bool]
    reach: tuple[tuple[float, float], tuple[float, float]]
    form: tuple[float, float] = (0.0, 0.0)
    """Sizes in um of a mean tooth's form that each gear's grade leaves open; 0 where it was inspected."""

    run_ups: tuple[tuple[float, float], ...] = ()
    """The least and the largest driving speed in rad/s of every recording whose speed changes much."""

    varied: bool = False
    """Whether the torque of any recording was read along it, and varies."""

    from_time: tuple[bool, bool] = (False, False)
    """Whether each shaft's angle is nothing but time, so that no reading tells where on its encoder a line stands."""

    finest: tuple[float, float] = (math.inf, math.inf)
    """Half the samples per turn of either shaft, in the recording that has the fewest. From there on an order is the
    alias of a slower one, and one of a whole sample per wave bends with the reading's own noise."""

    lines: tuple[frozenset[int], frozenset[int]] = (frozenset(), frozenset())
    """Lines per turn of encoders on either shaft from ``finest`` on that uneven samples tell from slower orders."""

    others_turn: tuple[bool, bool] = (False, False)
    """Whether a line is seen of something else that turns with the driving and the driven shaft."""

    unknown_waves: tuple[tuple[int, int], ...] = ()
    """Gears and orders of their shafts, from the second on, at which a wave is likelier of no cause of the catalogue
    than of any."""

    pulses: tuple[tuple[int, int, float], ...] = ()
    """Gears and whole orders of their shafts at which the torque pulses, and the rms in mm of what teeth give so."""

    stepped: bool = False
    """Whether coarse readings of a shaft that turns evenly may make waves of any order: none of more than half a wave
    per tooth is then told from an encoder's or a flank's."""

    ranges: tuple[float, ...] = ()
    """How far the transmission error of each recording ranges, um; empty where nothing was recorded yet."""

    wanders: tuple[int, ...] = ()
    """Terms, beyond the mean, of the slow course that is free in each recording: 0 where a drift is asked for its
    cause. It is free in a transmission error whose way through the rig nobody knows, too short to show what repeats,
    where a slow change is no more than the slow end of the noise; and where the course bends more than a cubic."""

    smooth: frozenset[tuple[int, int]] = frozenset()
    """Gears and whole orders of their shafts at which a smooth wave of another part of the drive is fitted."""

    @property
    def loaded(self) -> bool:
        """Whether load bends teeth in any recording."""
        return self.file.model.tooth_deflection and self.under_torque

    @property
    def under_torque(self) -> bool:
        """Whether a torque acts in any recording, whether teeth are declared to bend or not."""
        return max(self.torques) > 0.0

    @property
    def torque_changes(self) -> bool:
        """Whether the torque on the shafts changes along a recording, or from one to the next where their means
        compare: what a steady torque moves steadily has no zero to be seen from."""
        several = len(set(self.torques)) > 1 or (len(set(self.flanks)) > 1 and self.under_torque)
        return self.varied or (self.counted and several)

    @property
    def several_speeds(self) -> bool:
        """Whether a resonance was met at more than one speed: measured speeds of one set-up differ a little anyway."""
        known = [speed for speed in self.speeds if speed is not None]
        known += [end for ends in self.run_ups for end in ends]
        return bool(known) and max(known) - min(known) > RUN_UP_SPEED_PART * max(known)

    def shows(self, place: Place, *, once: bool = False, by_teeth: bool = False) -> bool:
        """Whether the recordings can show what a place's order does: the samples, and which shaft it is on; ``once``:
        its order is 1, stated or not; ``by_teeth``: teeth make it, with side bands of the mesh.

        A worm that turns with the driven gear makes waves at every whole order of its own, as large as the pair's, and
        so does any other part of the drive that the pair file states: a wave there is located, and named of neither.
        Beside another part, but no worm, what teeth make may be named where a smooth wave is fitted as well.
        """
        order = 1 if once else place.order
        if order is None:
            return True
        gear = place.gear or 0
        if gear == 1 and self.file.worm is not None:
            return False
        if self.others_at(gear, order) and not (by_teeth and (gear, order) in self.smooth):
            return False
        told = order < self.finest[gear] or order in self.lines[gear]
        return told and not (self.stepped and order > self.gears[gear].z / 2)

    def others_at(self, gear: int, order: int) -> tuple[str, ...]:
        """Other parts of the drive with a line at an ``order`` of the shaft of ``gear``, in words."""
        if not self.parts or self.span <= 0.0:
            return ()
        z_1, z_2 = (one.z for one in self.gears)
        return lines_at(self.parts, order * (z_2 / z_1 if gear == 0 else 1.0), turns=self.span * z_1 / z_2)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Other parts of the drive that the pair file states."""
        return parts_of(self.file.also_turns, z_1=self.gears[0].z, z_2=self.gears[1].z)

    @property
    def conditions(self) -> int:
        """Number of recordings."""
        return len(self.torques)

    def section(self, gear: int) -> GearSection:
        """The declared section of gear 0 (driving) or 1."""
        return self.file.driving if gear == 0 else self.file.driven


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One coordinate of a physics in its ``unit``, that of the pair file. ``most`` is the largest that it may be for a
    pair and a place, and ``why``; ``low`` the least that means anything (default: as much, of the other sign).
    ``step`` is a small change of it."""

    name: str
    unit: str
    most: Callable[[Scope, Place], float]
    why: str
    low: float = -math.inf
    step: float = 1.0
    switch: bool = False
    """Whether it only says that something is there (1) or not (0)."""

    def bounds(self, scope: Scope, place: Place) -> tuple[float, float]:
        """The least and the largest that it may be."""
        most = self.most(scope, place)
        return max(self.low, -most), most


MADE, MOUNTED, WORN, RUN, READ = 10, 20, 30, 40, 50
"""Ranks from which on a physics comes with the making of a gear, with its mounting, with wear and damage, with load and
shafts, and with the reading."""


@dataclass(frozen=True, kw_only=True)
class Physics:
    """One way in which reality may differ from the simulation.

    ``coordinates``: ``amplitudes`` of them are linear and 0 where the physics is absent, the others are shape.
    ``places`` lists where to look. ``write`` puts it into a pair file. ``effect`` is what it adds to the transmission
    error of a scene, (n,) in mm, to first order; None: load and shafts of the written file are solved again. ``report``
    turns values and covariance into the contract's parameters; ``says`` into a sentence; ``equation`` is the model in a
    line for the reader.

    ``rank`` says when it comes in the life of a pair, and so its place among the keys of the pair file and in the
    building of the pair: ``MADE``, ``MOUNTED``, ``WORN``, ``RUN`` or ``READ`` and on. ``keys`` are those that it adds
    to the tables of a pair file ("pair", "gear", "encoder", "measurement"); ``stands`` tells a reader which keys say
    that it is there. ``parameters`` are the contract's names, its size first. ``case`` is a typical case, well above a
    noise of 0.3 um: place and values. ``source`` says where the equation is from.
    """

    name: str
    rank: int
    source: str
    stands: str
    parameters: tuple[str, ...]
    case: tuple[Place, Values]
    coordinates: tuple[Quantity, ...]
    amplitudes: int
    places: Callable[[Scope], Iterable[Place]]
    write: Callable[[PairFile, Place, Values], PairFile]
    report: Callable[[Place, FloatArray, FloatArray], Reported]
    says: Callable[[Place, Values], str]
    equation: str
    ordinary: Values
    """Amplitudes of an ordinary fault of ordinary gears, in the units of the pair file: one that a bench meets, neither
    beneath every noise nor a wreck. A plan lays faults of this size side by side."""

    common: float = 1.0
    """How often it is met among the causes that the catalogue holds at its kind of place, to others there."""

    keys: Mapping[str, type[Section]] = field(default_factory=dict)
    shapes: Callable[[GearSection, Gear, int], Deviations] = lambda section, gear, which: Deviations()
    """What its keys make of the flanks of a gear, the driving one (0) or the driven."""

    build: Callable[[PairFile, Parts], Parts] = lambda file, parts: parts
    """What its keys change of the pair beside the flanks."""

    effect: Callable[[ContactsAtSamples, Place, Values], FloatArray] | None = None
    ordinary_orders: Callable[[Gear], tuple[int, ...]] = lambda gear: ()
    """Of a physics that has an order per turn of its gear: those at which it is met most."""

    instead: Callable[[Scope, Place], Iterable[Place]] = lambda scope, place: ()
    """Where it is too unlikely to be looked for, yet could stand for what another physics does at a place."""

    otherwise: Callable[[Scope, Place, Values], Iterable[tuple[Place, Values]]] = lambda scope, place, values: ()
    """The same in its other forms, too like it to be looked for apart: each is fitted in its stead once it is found."""

    sensible: Callable[[Scope, Place, Values], bool] = lambda scope, place, values: True
    """Whether it is still itself with such values, and not the nearest it has to something else."""

    unsearched: str = ""
    """Why a diagnosis does not look for it, though a pair file may state it; empty where it does."""

    slow: bool = False
    """It goes on over a whole recording and never repeats."""

    wavelike: bool = False
    """Its effect is mostly a wave of the place's order per turn of its gear."""

    once_per_turn: bool = False
    """Its effect is a wave of order 1 per turn of its gear, which its place does not state."""

    mean_tooth: bool = False
    """It is the same at every mesh, where a wrong compliance law shows too."""

    whole_gear: bool = False
    """It moves all teeth of a gear as one: on the other gear it does the same but for where teeth then meet."""

    law_doubt: float = 0.0
    """Relative standard error of its size, one sigma, for what compliance laws differ by."""

    @property
    def by_teeth(self) -> bool:
        """Whether it makes a wave as teeth do, which hand over from one pair to the next."""
        return not self.wavelike and not self.once_per_turn

    @property
    def twin(self) -> str:
        """The name of the same physics in the bench that knows nothing of this simulation."""
        return self.name

    @property
    def measures(self) -> bool:
        """Whether it is in the measuring chain: recordings show it, the gears do not."""
        return self.rank >= READ

    @property
    def reloads(self) -> bool:
        """Whether only load and shafts change, so that the contacts found stay."""
        return RUN <= self.rank < READ

    @property
    def fixed_amplitudes(self) -> bool:
        """Whether the amplitudes only say that it is there (1) or not (0)."""
        return all(one.switch for one in self.coordinates[: self.amplitudes])

    @property
    def shaped(self) -> bool:
        """Whether it has more to it than amplitudes."""
        return len(self.coordinates) > self.amplitudes


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A physics at a place with values."""

    physics: Physics
    place: Place
    values: Values

    @cached_property
    def key(self) -> tuple[str, int | None, int | None, int | None, str | None, tuple[int, ...]]:
        """What makes it another claim than others of the same physics."""
        p = self.place
        return self.physics.name, p.gear, p.tooth, p.order, p.flank, p.recordings

    @property
    def shapes_tooth(self) -> bool:
        """Whether it is about a single tooth, and has a shape there beside its size."""
        return self.place.tooth is not None and self.physics.shaped

    @property
    def takes_contact(self) -> bool:
        """Whether it takes a part of its path of contact from a single tooth, which it does or does not."""
        return self.shapes_tooth and self.physics.fixed_amplitudes

    @property
    def simulated(self) -> bool:
        """Whether only the set-up simulated with it tells all that it does, and no column: it has none, or a tooth may
        lose touch over it."""
        return self.physics.effect is None or self.shapes_tooth

    def written(self, file: PairFile) -> PairFile:
        """The pair file with this in it."""
        return self.physics.write(file, self.place, self.values)

    def otherwise(self, scope: Scope) -> list[Claim]:
        """The same claim in its other forms, with values to start from."""
        physics = self.physics
        return [
            Claim(physics=physics, place=place, values=values)
            for place, values in physics.otherwise(scope, self.place, self.values)
        ]

    @property
    def says(self) -> str:
        """The claim as a sentence."""
        return self.physics.says(self.place, self.values)
