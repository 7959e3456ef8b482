"""The joint model of a set of recordings: as-built teeth, slow curves, and what the search has found so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from gearpoly.compare.columns import (
    Dense,
    SomeColumns,
    Waves,
    as_built_part,
    pair_deviation,
    shape_deviation,
    shape_entries,
    shape_part,
    waves,
)
from gearpoly.compare.few_turns import first_orders, without_first
from gearpoly.compare.jumps import Jump
from gearpoly.compare.noise import Noise, NoiseEstimator
from gearpoly.compare.peak import Peak
from gearpoly.compare.regression import Solution, Stack, solve
from gearpoly.compare.sampling import Sampling, sampling_of
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.compare.sharing import Carried
from gearpoly.compare.slow import slow_curves
from gearpoly.compare.teeth import BEYOND_PATH_PITCHES, ToothFind
from gearpoly.units import UM, FloatArray, IntArray

CREDIBLE = 3.0
"""Prior standard deviations to which a tooth's estimate may move the hand-over. While a large wave is not yet found the
teeth stand in for it, beyond all belief, and would hand over where no teeth do."""

HEIGHTS = 3.0
"""Prior standard deviation of a found tooth's shape, over the find's own size."""

TOOTH_SHAPE_KNOT_PITCHES = 1.0 / 12.0
"""Pitches between the knots of a found tooth's free shape."""


@dataclass
class Tooth:
    """A tooth that was found, in one recording: its free shape's ``entries`` and ``heights`` (k,) in mm at the
    knots."""

    find: ToothFind
    entries: tuple[IntArray, FloatArray]
    heights: FloatArray

    @property
    def name(self) -> str:
        which = "all" if self.find.recording is None else str(self.find.recording)
        return f"tooth {self.find.gear} {self.find.tooth} {which}"

    @property
    def prior_std(self) -> float:
        """mm. Heights are of the find's size; where a knot is hardly ever in contact only this keeps it from running
        away."""
        return HEIGHTS * max(abs(self.find.amplitude), UM)


@dataclass
class Wander:
    """How far the ends of contact wander with a wave of order 1 that was found on a shaft of ``z`` teeth: an axis that
    runs out moves both gears' distance too, by as much as the wave. ``std`` in pitches, ``heights`` (4,) as fitted:
    cosine and sine at the begin, then at the end."""

    z: int
    std: float = 0.0
    heights: FloatArray = field(default_factory=lambda: np.zeros(4))

    def shifts(self, s: State) -> list[FloatArray]:
        """What a shift of 1 pitch at crest does to each pair (P, n), in mm."""
        if self.z not in s.shifts:
            angle = (2.0 * np.pi / self.z) * s.data.u
            s.shifts[self.z] = [end * wave for end in s.carried.ends() for wave in (np.cos(angle), np.sin(angle))]
        return s.shifts[self.z]


@dataclass
class State:
    """One recording in the search; ``waves`` and ``shifts`` are kept from one fit to the next."""

    data: AlignedResidual
    carried: Carried
    sampling: Sampling
    slow: FloatArray
    estimator: NoiseEstimator
    noise: Noise
    flank_at: int
    orders: list[Peak] = field(default_factory=list)
    times: list[Peak] = field(default_factory=list)
    jumps: list[Jump] = field(default_factory=list)
    teeth: list[Tooth] = field(default_factory=list)
    wander: dict[int, Wander] = field(default_factory=dict)
    waves: dict[str, Waves] = field(default_factory=dict)
    shifts: dict[int, list[FloatArray]] = field(default_factory=dict)

    @property
    def coast(self) -> bool:
        return self.data.flank == "coast"

    @property
    def slow_precision(self) -> FloatArray:
        """1/mm^2 (q,), of each slow curve beforehand: no course goes farther than what was recorded, of which a
        Legendre polynomial of degree k may hold 2k + 1 times as much. In noise that seemed to wander, two periods of
        10 um in a recording were fitted by 24 mm of slow curves that cancelled."""
        farthest = max(float(np.ptp(self.data.residual)), float(np.max(np.abs(self.data.residual))), 1e-12)
        return np.asarray((farthest * (2.0 * np.arange(self.slow.shape[1]) + 1.0)) ** -2.0)


class JointModel:
    """All recordings of a set, what has been found in them so far, and the fit of everything at once."""

    def __init__(self, residuals: Sequence[AlignedResidual], gears: tuple[GearKnown, GearKnown], floor: float) -> None:
        self.gears = gears
        self.floor = floor
        self.z_1, self.z_2 = gears[0].z, gears[1].z
        self.tooth_parameters = 2 * (self.z_1 + self.z_2)
        self.flanks = sorted({r.flank for r in residuals}, reverse=True)
        searches = [self._lines(r) for r in residuals]
        firsts = first_orders(searches)
        self.states = [self._state(*each) for each in zip(residuals, searches, firsts, strict=True)]
        self.beta_built = np.zeros(self.tooth_parameters * len(self.flanks))
        self.finds: list[ToothFind] = []
        self.built_rms = 0.0
        self.places: list[dict[str, IntArray]] = []
        self.refused: list[tuple[int, bool, int]] = []

    def _lines(self, data: AlignedResidual) -> Sampling:
        return sampling_of(u=data.u, time=data.time_s, z_1=self.z_1, z_2=self.z_2, averaged=data.averaged > 0.0)

    def _state(self, data: AlignedResidual, sampling: Sampling, slowest: Peak | None) -> State:
        x = data.u if data.time_s is None else data.time_s
        return State(
            data=data,
            carried=data.carried(self.z_1, self.z_2),
            sampling=sampling,
            orders=[] if slowest is None else [slowest],
            slow=slow_curves(x),
            estimator=(estimator := NoiseEstimator(data.u, z_1=self.z_1, z_2=self.z_2)),
            noise=estimator.estimate(without_first(data.u, data.residual, slowest)),
            flank_at=self.flanks.index(data.flank) * self.tooth_parameters,
        )

    def built_precision(self) -> FloatArray:
        parts = []
        for gear in self.gears:
            pitch, slope = gear.prior_std
            parts += [np.full(gear.z, pitch**-2.0), np.full(gear.z, slope**-2.0)]
        return np.tile(np.concatenate(parts), len(self.flanks))

    def fit(self, *, passes: int = 2) -> Solution:
        """Fit everything found so far; twice, since an unloaded pair that deviates may hand over elsewhere."""
        self.stacks: list[Stack] = []  # their columns take much room
        before: list[Stack] | None = None
        for _ in range(passes):
            stacks, precision = self._stacks()
            solution = solve(stacks, precision=precision, before=before)
            before = stacks
            self.beta_built = solution.beta[: self.beta_built.size]
            for s, places in zip(self.states, self.places, strict=True):
                for tooth in s.teeth:
                    tooth.heights = solution.beta[places[tooth.name]]
                self._let_wander(s, places, solution.beta)
        self.stacks = stacks
        return solution

    def _let_wander(self, s: State, places: dict[str, IntArray], beta: FloatArray) -> None:
        """Keep what the fit says of the ends of contact, and let them move by as much as first orders allow."""
        for z, wander in s.wander.items():
            wander.heights = beta[places[f"ends {z}"]]
        kept = {}
        for j, peak in enumerate(s.orders):
            for z in {self.z_1, self.z_2}:
                if abs(peak.frequency * z - 1.0) < 1e-9 and s.data.ends_per_mm > 0.0:
                    size = float(np.hypot(*beta[places["orders"][2 * j :][:2]]))
                    kept[z] = s.wander.get(z, Wander(z=z))
                    kept[z].std = max(size * s.data.ends_per_mm, 1e-9)
        s.wander = kept

    def _stacks(self) -> tuple[list[Stack], FloatArray]:
        precision = [self.built_precision()]
        at = precision[0].size
        stacks, self.places = [], []
        self.built_rms = 0.0
        common: dict[str, IntArray] = {}
        for s in self.states:
            own = self.beta_built[s.flank_at : s.flank_at + self.tooth_parameters]
            deviation = self.deviation(s)
            weight = s.carried.weights(deviation)
            built = as_built_part(s.carried, weight, coast=s.coast)
            shapes = [shape_part(t.entries, weight, knots=t.heights.size, coast=s.coast) for t in s.teeth]
            # Linear about the present estimate: the curve's change there, less what the columns make of it.
            change = s.carried.change(deviation) * (-1.0 if s.coast else 1.0)
            self.built_rms = max(self.built_rms, float(np.std(change)))
            within = CREDIBLE / np.sqrt(self.built_precision()[: self.tooth_parameters])
            values = s.data.residual - change + built.apply(np.clip(own, -within, within))
            for shape, tooth in zip(shapes, s.teeth, strict=True):
                values = values + shape.apply(tooth.heights)
            ends = {z: np.stack([np.einsum("pn,pn->n", weight, shift) for shift in wander.shifts(s)], axis=1)
                    for z, wander in s.wander.items()}  # fmt: skip
            for z, columns in ends.items():
                ends[z] = columns * (-1.0 if s.coast else 1.0)
                values = values + ends[z] @ s.wander[z].heights
            parts: list[tuple[SomeColumns, IntArray]] = [(built, s.flank_at + np.arange(self.tooth_parameters))]
            places: dict[str, IntArray] = {}

            u, t = s.data.u, s.data.time_s
            own_parts: list[tuple[str, SomeColumns, FloatArray]] = [("slow", Dense(columns=s.slow), s.slow_precision)]
            if s.data.nuisance is not None:
                own_parts.append(("nuisance", Dense(columns=s.data.nuisance), np.ones(s.data.nuisance.shape[1])))
            for z, columns in ends.items():
                own_parts.append((f"ends {z}", Dense(columns=columns), np.full(4, s.wander[z].std ** -2.0)))
            for name, x, peaks in (("orders", u, s.orders), ("times", t, s.times)):
                if peaks and x is not None:
                    held = waves(x, np.array([p.frequency for p in peaks]), before=s.waves.get(name))
                    s.waves[name] = held
                    known = [0.0 if not p.few else float(np.ptp(s.data.residual)) ** -2.0 for p in peaks]
                    own_parts.append((name, held, np.repeat(known, 2)))
            if s.jumps:
                steps = np.stack([jump.column(u.size) for jump in s.jumps], axis=1)
                own_parts.append(("jumps", Dense(columns=steps), np.zeros(len(s.jumps))))
            for shape, tooth in zip(shapes, s.teeth, strict=True):
                if tooth.find.recording is None and tooth.name in common:
                    # One tooth, one shape: what all recordings show alike has one set of heights.
                    places[tooth.name] = common[tooth.name]
                    parts.append((shape, places[tooth.name]))
                else:
                    own_parts.append((tooth.name, shape, np.full(shape.size, tooth.prior_std**-2.0)))
            for name, part, prior in own_parts:
                places[name] = at + np.arange(part.size)
                parts.append((part, places[name]))
                precision.append(prior)
                at += part.size
                if name.endswith("all"):
                    common[name] = places[name]
            stacks.append(Stack(values=values, noise=s.noise, parts=parts))
            self.places.append(places)
        return stacks, np.concatenate(precision)

    def knots(self, s: State) -> FloatArray:
        low, high = s.carried.contact[0] - BEYOND_PATH_PITCHES, s.carried.contact[1] + BEYOND_PATH_PITCHES
        return np.linspace(low, high, max(4, round((high - low) / TOOTH_SHAPE_KNOT_PITCHES) + 1))

    def deviation(self, s: State) -> FloatArray:
        """Deviation (P, n) in mm of the pairs of a recording, as estimated so far."""
        own = self.beta_built[s.flank_at : s.flank_at + self.tooth_parameters]
        within = CREDIBLE / np.sqrt(self.built_precision()[: self.tooth_parameters])
        out = pair_deviation(s.carried, np.clip(own, -within, within), coast=s.coast)
        for tooth in s.teeth:
            out += shape_deviation(tooth.entries, tooth.heights)
        for wander in s.wander.values():
            for height, shift in zip(wander.heights, wander.shifts(s), strict=True):
                out += height * shift
        return out

    def renew_noise(self, solution: Solution) -> None:
        for s, left in zip(self.states, solution.left, strict=True):
            s.noise = s.estimator.estimate(without_first(s.data.u, left, next((p for p in s.orders if p.few), None)))

    def new_tooth(self, s: State, find: ToothFind) -> Tooth:
        """A found tooth in recording ``s``, its shape still flat."""
        knots = self.knots(s)
        entries = shape_entries(s.carried, gear=find.gear, tooth=find.tooth, knots=knots, coast=s.coast)
        return Tooth(find=find, entries=entries, heights=np.zeros(knots.size))
