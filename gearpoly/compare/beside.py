"""Recordings beside the simulation of their pair, as data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.compare.also_turns import with_parts
from gearpoly.compare.angles import smoothed
from gearpoly.compare.entries import Entry
from gearpoly.compare.even import even_rate
from gearpoly.compare.locate import Located
from gearpoly.compare.other_pair import OtherPair
from gearpoly.compare.same_ratio import SameRatio
from gearpoly.compare.scale import Scale
from gearpoly.compare.set_up import GearKnown
from gearpoly.compare.template import Template
from gearpoly.compare.zeros import Alignment
from gearpoly.keys.also_turns import Part
from gearpoly.keys.sections import WormSection
from gearpoly.mesh.pair import Flank
from gearpoly.recording.clean import Cleaned
from gearpoly.units import FloatArray

JERKS_OF_SMOOTH_MOTION = 0.01
"""Part of the second differences of readings that may be above one step where a motion is smooth: at an even speed each
advance is of so many steps or one more. Advances that jitter by a fifth of a step (normal, 200 000 readings) have 6 in
1000, by three tenths 32: then rounding forgets its pattern from sample to sample, exp(-(2 pi 0.3)^2/2) = 0.2. Of two
shafts turned by hand 3 and 5 in 1000 were."""

ROUNDING_TOLD = 0.1
"""Part of what a recording differs by, rms, from which the rounding of its readings is worth a word: it then holds a
hundredth of the mean square."""

ROUNDING_OVER_MISMATCH = 2.0
"""Times the whole mismatch, rms, from which on a reading's steps are no rounding: that adds to all else. A commanded
axis that moved 2.5 deg from sample to sample, with gaps, was said to be read in steps of 2.5 deg, 213 um, and all that
12 um of mismatch held to come of it. A judgement."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Aligned:
    """One recording beside its simulation, sample by sample (n,).

    ``theta_1``, ``theta_2`` in rad, as read, 0 at the contract's angle zero; ``recorded``, ``simulated`` and
    ``residual`` (their difference) in mm along the line of action; means of a set compare. ``torque`` in N.mm,
    ``speed`` of the driving shaft in rad/s where known, ``template`` the simulation over a hunting cycle, ``swings`` in
    mm what a resonance adds to it in a run-up, ``load`` (n,) how far the torque is off ``torque`` along the recording,
    as a part of it, ``steps`` in rad to which both shafts' readings are rounded, where that shows, ``driven_share`` the
    part of the noise of single samples that the driven angle has, ``averaged`` meshes over which each sample is a mean
    (0: it is none). Arrays are taken over, and sealed; what follows from others is worked out when asked for, since
    recordings are long.
    """

    cleaned: Cleaned
    theta_2: FloatArray
    recorded: FloatArray
    residual: FloatArray
    r_b2: float
    flank: Flank
    torque: float
    speed: float | None
    template: Template
    swings: FloatArray | None = None
    load: FloatArray | None = None
    steps: tuple[float | None, float | None] = (None, None)
    driven_share: float = 0.0
    averaged: float = 0.0

    def __post_init__(self) -> None:
        for values in (self.theta_2, self.recorded, self.residual):
            values.setflags(write=False)

    def moved(self, offset: float) -> Aligned:
        """The same where both shafts turn by ``offset`` in rad of driven rotation more."""
        theta_2 = self.theta_2 + offset
        simulated = self.template.at(theta_2)
        if self.swings is not None:
            simulated = simulated + self.swings
        if self.load is not None:
            simulated = simulated + self.template.varied(theta_2, self.load)
        return replace(self, theta_2=theta_2, residual=self.recorded - simulated)

    @property
    def theta_1(self) -> FloatArray:
        """Driving rotation (n,) in rad, as read."""
        return np.asarray((self.theta_2 - self.recorded / self.r_b2) / self.cleaned.ratio)

    @property
    def estimated(self) -> tuple[FloatArray, FloatArray]:
        """Driving and driven rotation (n,) in rad, as estimated: without the noise of single samples, at which columns
        of encoders and of free waves are drawn."""
        smooth = smoothed(self.recorded)
        theta_2 = self.theta_2 - self.driven_share * (self.recorded - smooth) / self.r_b2
        return np.asarray((theta_2 - smooth / self.r_b2) / self.cleaned.ratio), np.asarray(theta_2)

    @property
    def simulated(self) -> FloatArray:
        """Simulated transmission error (n,) in mm."""
        return np.asarray(self.recorded - self.residual)

    @property
    def doubt(self) -> float:
        """The rms in mm to which the transmission error is known where readings lie between an encoder's own."""
        return self.cleaned.doubt * self.r_b2

    @property
    def time_s(self) -> FloatArray | None:
        """Time (n,) in s, where recorded."""
        return self.cleaned.time_s

    @property
    def ran(self) -> str:
        """On which flank, and which way round if it was not forward, in words."""
        return f"{self.flank} flank, backwards" if self.cleaned.backward else f"{self.flank} flank"

    def turned_round(self, entry: Entry) -> Entry:
        """An ``entry`` in the order of these samples, which is not the recording's where the pair ran backwards."""
        turns = float(np.ptp(self.theta_1)) / (2.0 * np.pi)
        return entry.turned_round(turns) if self.cleaned.backward else entry

    @property
    def mean(self) -> float:
        """Mean of the residual, mm."""
        return float(np.mean(self.residual))

    @property
    def rms(self) -> float:
        """Rms of the residual about its mean, mm."""
        return float(np.std(self.residual))

    @property
    def _errors(self) -> tuple[float, float]:
        """Range in rad of what rounding makes of either reading: a step, but of readings that were kept where they
        change no more than the shaft turned since the sample before; 0 of steps that are no rounding."""
        samples = max(float(np.ptp(self.cleaned.keep)), 1.0)
        first, second = (
            min(step or 0.0, float(np.ptp(angle)) / samples)
            for angle, step in zip((self.cleaned.theta_1, self.cleaned.theta_2), self.steps, strict=True)
        )
        lever, most = self.r_b2 / math.sqrt(12.0), ROUNDING_OVER_MISMATCH * self.rms
        return (
            first if self.cleaned.ratio * first * lever < most else 0.0,
            second if second * lever < most else 0.0,
        )

    @property
    def rounding(self) -> float:
        """What the rounding of both readings makes of the transmission error, mm rms: evenly spread over its range."""
        first, second = self._errors
        return math.hypot(self.cleaned.ratio * first, second) / math.sqrt(12.0) * self.r_b2

    @property
    def stepped(self) -> bool:
        """Whether the readings' rounding may make waves of any order: it is a good part of the mismatch, and samples
        come so evenly that it follows a pattern."""
        if self.rounding < ROUNDING_TOLD * self.rms:
            return False
        angles = zip((self.theta_1, self.theta_2), self.steps, strict=True)
        return any(even_rate(angle, rounding=(step or 0.0) / math.sqrt(12.0)) is not None for angle, step in angles)

    @property
    def coarse(self) -> float:
        """The largest wave in mm that the rounding of both readings makes where they are ``stepped``: the first
        harmonic of a saw tooth of one step, of an amplitude of a step over pi."""
        return self._first_harmonic if self.stepped else 0.0

    @property
    def _first_harmonic(self) -> float:
        """The amplitude in mm of the first harmonic of what rounding makes, evenly spread over its range."""
        return self.rounding * math.sqrt(12.0) / math.pi

    @property
    def coarse_for_a_while(self) -> float:
        """The largest wave in mm that it makes while a shaft turns evenly for a while, where speeds change smoothly: at
        no order of the pair, as long as samples per step stay what they are (0: its rounding makes noise)."""
        if self.rounding < ROUNDING_TOLD * self.rms:
            return 0.0
        angles = zip((self.cleaned.theta_1, self.cleaned.theta_2), self.steps, strict=True)
        smooth = any(step is not None and _is_smooth(angle / step) for angle, step in angles)
        return self._first_harmonic if smooth else self.coarse

    @property
    def cycles(self) -> float:
        """Hunting cycles that the recording holds."""
        return float(np.ptp(self.theta_2)) / self.template.cycle


@dataclass(frozen=True, kw_only=True, eq=False)
class BesideSimulation:
    """A set of recordings beside the simulation of their pair. ``gears`` is what is known of both gears, ``remarks``
    what had to be assumed, ``parts`` what else turns in the drive, ``worm`` what the driven gear turns in a
    telescope, ``scale`` what one reading was times the truth, before it was taken out, ``another`` the pair whose teeth
    show in the stead of the declared ones."""

    name: str
    assembled: Assembled
    aligned: tuple[Aligned, ...]
    alignment: Alignment
    gears: tuple[GearKnown, GearKnown]
    remarks: tuple[str, ...]
    parts: tuple[Part, ...] = ()
    worm: WormSection | None = None
    scale: Scale | None = None
    another: OtherPair | SameRatio | None = None

    def named(self, entries: Sequence[Entry]) -> tuple[Entry, ...]:
        """The ``entries`` with the other parts of the drive that have a line there."""
        return with_parts(
            entries,
            self.parts,
            z=(self.gears[0].z, self.gears[1].z),
            turns=[float(np.ptp(one.theta_2)) / (2.0 * math.pi) for one in self.aligned],
            speeds=[one.speed for one in self.aligned],
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison(BesideSimulation):
    """The same, with where they differ."""

    located: Located

    def refined(self, shift: float, std: float) -> Comparison:
        """The same with zeros that a fit of everything moved by ``shift`` in rad of driven rotation, known to ``std``;
        the residuals stay those of the declared pair where compare laid it."""
        return self._with(self.alignment.refined(shift, std, ratio=self._ratio, directions=self._directions))

    @property
    def _ratio(self) -> float:
        return self.gears[0].z / self.gears[1].z

    @property
    def _directions(self) -> tuple[int, int]:
        return self.gears[0].direction, self.gears[1].direction

    def _with(self, alignment: Alignment) -> Comparison:
        zeros = (alignment.zeros.driving, alignment.zeros.driven)
        first, second = (replace(gear, zero=zero) for gear, zero in zip(self.gears, zeros, strict=True))
        return replace(self, alignment=alignment, gears=(first, second))

    def moved(self, offset: float) -> Comparison:
        """The same where all turn by ``offset`` in rad of driven rotation more, both shafts together."""
        there = self._with(
            self.alignment.moved(
                offset, ratio=self._ratio, directions=self._directions, z=(self.gears[0].z, self.gears[1].z)
            )
        )
        return replace(there, aligned=tuple(one.moved(offset) for one in self.aligned))

    def turned(self, by: float) -> Comparison:
        """The same where the recordings of the coast flank are ``by`` rad of driven rotation further on."""
        coast = np.array([one.flank == "coast" for one in self.aligned])
        aligned = tuple(one.moved(by) if moves else one for one, moves in zip(self.aligned, coast, strict=True))
        alignment = replace(self.alignment, shift=self.alignment.shift - by * coast)
        return replace(self, aligned=aligned, alignment=alignment)


def _is_smooth(steps: FloatArray) -> bool:
    """Whether readings (n,), in their steps, turn so smoothly that their rounding follows a pattern."""
    bent = np.abs(np.diff(steps, n=2))
    return bool(bent.size) and float(np.mean(bent > 1.5)) <= JERKS_OF_SMOOTH_MOTION
