"""What every physics hands to the diagnosis."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from gearpoly.compare.also_turns import Part, lines_at, parts_of
from gearpoly.files.models import GearSection, PairFile, Section
from gearpoly.gear.gear import Gear
from gearpoly.mesh.shafts import UNEVEN
from gearpoly.physics.scene import Scene
from gearpoly.units import FloatArray

GEARS = ("driving", "driven")

Values = tuple[float, ...]
"""Amplitudes first, then shape, in the units of the pair file."""


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

    stepped: bool = False
    """Whether coarse readings at even angles may make waves of any order: none of more than half a wave per tooth is
    then told from an encoder's or a flank's."""

    ranges: tuple[float, ...] = ()
    """How far the transmission error of each recording ranges, um; empty where nothing was recorded yet."""

    wanders: tuple[bool, ...] = ()
    """Whether each recording may wander by itself: a transmission error whose way through the rig nobody knows, too
    short to show what repeats. There a slow change is no more than the slow end of the noise."""

    @property
    def loaded(self) -> bool:
        """Whether load bends teeth in any recording."""
        return self.file.model.tooth_deflection and max(self.torques) > 0.0

    @property
    def several_speeds(self) -> bool:
        """Whether a resonance was met at more than one speed: measured speeds of one set-up differ a little anyway."""
        known = [speed for speed in self.speeds if speed is not None]
        known += [end for ends in self.run_ups for end in ends]
        return bool(known) and max(known) - min(known) > UNEVEN * max(known)

    def shows(self, place: Place, *, once: bool = False) -> bool:
        """Whether the recordings can show what a place's order does: the samples, and which shaft it is on; ``once``:
        its order is 1, stated or not.

        A worm that turns with the driven gear makes waves at every whole order of its own, as large as the pair's, and
        so does any other part of the drive that the pair file states: a wave there is located, and named of neither.
        """
        order = 1 if once else place.order
        if order is None:
            return True
        gear = place.gear or 0
        if (gear == 1 and self.file.worm is not None) or self.others_at(gear, order):
            return False
        return order < self.finest[gear] and not (self.stepped and order > self.gears[gear].z / 2)

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
class Place:
    """Where a physics might be: ``gear`` 0 (driving) or 1, ``tooth``, ``order``, ``flank``, ``recordings`` (none: in
    all), ``form`` (none: as declared, or the plainest); ``shape`` the values of its shape to start from; ``probe`` the
    amplitudes at which its effect is looked at (0: by steps of one unit).
    """

    gear: int | None = None
    tooth: int | None = None
    order: int | None = None
    flank: str | None = None
    recordings: tuple[int, ...] = ()
    form: str | None = None
    shape: Values = ()
    probe: Values = ()

    @property
    def gear_name(self) -> str | None:
        """ "driving" or "driven"."""
        return None if self.gear is None else GEARS[self.gear]


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

    def bounds(self, scope: Scope, place: Place) -> tuple[float, float]:
        """The least and the largest that it may be."""
        most = self.most(scope, place)
        return max(self.low, -most), most


Reported = dict[str, tuple[float, float]]
"""Parameter name: value and standard error."""


@dataclass(frozen=True, kw_only=True)
class Physics:
    """One way in which reality may differ from the simulation.

    ``coordinates``: ``amplitudes`` of them are linear and 0 where the physics is absent, the others are shape.
    ``places`` lists where to look. ``write`` puts it into a pair file. ``effect`` is what it adds to the transmission
    error of a scene, (n,) in mm, to first order; None: simulate the written file. ``report`` turns values and
    covariance into the contract's parameters; ``says`` into a sentence. ``family`` groups places that stand for one
    question, of which only the best is kept; ``equation`` is the model in a line for the reader.
    """

    name: str
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

    effect: Callable[[Scene, Place, Values], FloatArray] | None = None
    ordinary_orders: Callable[[Gear], tuple[int, ...]] = lambda gear: ()
    """Of a physics that has an order per turn of its gear: those at which it is met most."""

    instead: Callable[[Scope, Place], Iterable[Place]] = lambda scope, place: ()
    """Where it is too unlikely to be looked for, yet could stand for what another physics does at a place."""

    otherwise: Callable[[Scope, Place, Values], Iterable[tuple[Place, Values]]] = lambda scope, place, values: ()
    """The same in its other forms, too like it to be looked for apart: each is fitted in its stead once it is found."""

    sensible: Callable[[Scope, Place, Values], bool] = lambda scope, place, values: True
    """Whether it is still itself with such values, and not the nearest it has to something else."""

    reloads: bool = False
    """Only load and shafts change, so the contacts found stay."""

    measures: bool = False
    """It is in the measuring chain: recordings show it, the gears do not."""

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

    fixed_amplitudes: bool = field(default=False)
    """The amplitudes only say whether it is there (1) or not (0)."""

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


def changed(section: Any, **keys: object) -> Any:
    """A copy of a section of the pair file with other ``keys``, as if they had been stated."""
    assert isinstance(section, Section)
    return section.model_copy(update=keys)


def on_gear(file: PairFile, gear: int | None, **keys: object) -> PairFile:
    """The pair file with other keys of one gear."""
    name = GEARS[gear or 0]
    copy: PairFile = changed(file, **{name: changed(getattr(file, name), **keys)})
    return copy


def on_pair(file: PairFile, **keys: object) -> PairFile:
    """The pair file with other keys of [pair]."""
    copy: PairFile = changed(file, pair=changed(file.pair, **keys))
    return copy


def gear_section(file: PairFile, gear: int | None) -> GearSection:
    """The section of gear 0 (driving) or 1."""
    return file.driving if gear in (0, None) else file.driven


def polar(x: float, y: float, covariance: FloatArray) -> tuple[tuple[float, float], tuple[float, float]]:
    """Length and direction in deg (0 to 360) of a vector with its covariance (2, 2), each with its standard error."""
    length = math.hypot(x, y)
    along = np.array([x, y]) / max(length, 1e-300)
    across = np.array([-along[1], along[0]])
    std = math.sqrt(max(float(along @ covariance @ along), 0.0))
    turn = math.sqrt(max(float(across @ covariance @ across), 0.0)) / max(length, 1e-300)
    return (length, std), (math.degrees(math.atan2(y, x)) % 360.0, min(math.degrees(turn), 180.0))


def plain(*names: str) -> Callable[[Place, FloatArray, FloatArray], Reported]:
    """A report of the coordinates as they are, under ``names``."""

    def report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
        return {name: (float(values[k]), math.sqrt(max(float(covariance[k, k]), 0.0))) for k, name in enumerate(names)}

    return report


def vector(amplitude: str) -> Callable[[Place, FloatArray, FloatArray], Reported]:
    """A report of x and y as ``amplitude`` (its name with the unit) and ``angle_deg``."""

    def report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
        length, angle = polar(float(values[0]), float(values[1]), covariance)
        return {amplitude: length, "angle_deg": angle}

    return report


def phased(amplitude: str) -> Callable[[Place, FloatArray, FloatArray], Reported]:
    """A report of cosine and sine parts as ``order``, ``amplitude`` (its name with the unit) and ``angle_deg``, the
    phase of amplitude cos(. + angle)."""

    def report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
        mirrored = covariance * np.array([[1, -1], [-1, 1]])
        length, angle = polar(float(values[0]), -float(values[1]), mirrored)
        return {"order": (float(place.order or 1), 0.0), amplitude: length, "angle_deg": angle}

    return report


def wave(x: float, y: float) -> tuple[float, float]:
    """Amplitude and phase in deg of x cos + y sin = A cos(. + phase)."""
    return math.hypot(x, y), math.degrees(math.atan2(-y, x))


def own_of(place: Place) -> str:
    """ "driving gear" or "driven gear"."""
    return f"{place.gear_name} gear"


def tooth_of(place: Place) -> str:
    """ "Tooth 7 of the driven gear", or "A tooth ..." where the numbering is open."""
    number = "A tooth" if place.tooth is None else f"Tooth {place.tooth}"
    return f"{number} of the {own_of(place)}"
