"""What an inspection or a grade leaves open of every tooth: pitch, slope and form, with what is known of them
beforehand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.sparse import Sparse, full
from gearpoly.diagnose.tooth_columns import tooth_columns
from gearpoly.files.models import Inspection, PairFile
from gearpoly.keys.edit import changed, gear_section, on_gear
from gearpoly.mesh.pair import Flank
from gearpoly.physics.sheet import column
from gearpoly.scene import Scene
from gearpoly.units import FloatArray, IntArray, read_only

IDEAL_TEETH_STD_UM = 0.01
"""um. Doubt about the teeth of a gear that is declared ideal or inspected without any uncertainty."""

GRADE_LIMIT_SIGMAS = 2.0
"""Standard deviations at which a gear that passed its grade reaches a limit."""

STRAINED = 3.0
"""Standard deviations from which teeth have in common what a gear of their grade hardly has."""

LEANING_TOOTH_SIGMAS, SIGMA_OVER_MEDIAN = 5.0, 1.4826
"""Standard deviations of the teeth of its gear by which a tooth leans as none of them does, and that deviation over the
median one, so that few such teeth do not count."""

CHAIN_STD_OVER_F_P, CHAIN_STD_EXPONENT = 0.435, 0.8
"""Waves of drawn gears that keep to F_p: each as if its standard deviation were at most ``CHAIN_STD_OVER_F_P`` (z f_p^2
/ F_p^2)^-``CHAIN_STD_EXPONENT`` F_p, measured on closed chains of 17 to 100 teeth (tests/test_as_built.py)."""


@dataclass(frozen=True, kw_only=True)
class GearPrior:
    """One gear beforehand: covariance (z, z) in um^2 of its index deviations ``pitch``, standard deviations in um of
    every tooth's ``slope``, and of what all teeth have in common: ``mean_slope``, ``crowning``, ``thickness``.
    ``shared``: part of the drive flank's variance that the coast flank has as well, of pitch and of form (slope and
    crowning); ``own``: variance of the coast flank beyond that of the drive flank, over it, of pitch and of form.
    ``graded``: nobody inspected it; ``single`` the limit f_p of such a gear in um, along the line of action. ``form``:
    standard deviation in um of each half wave of every tooth's form, from two on; none where teeth are taken to have
    one form. ``wave``: what that is where they are not; 0 where forms are known. ``slope_measured``: whether an
    inspection holds the slopes; ``bulge``: standard deviation in um of what all teeth of an inspected gear may bulge
    where its inspection does not say. It is no parameter: beside pitches that are known well, bending and reliefs that
    nobody declared looked like one."""

    z: int
    pitch: FloatArray
    slope: float
    mean_slope: float
    crowning: float
    thickness: float
    shared: tuple[float, float]
    own: tuple[float, float]
    graded: bool
    single: float = 0.0
    form: tuple[float, ...] = ()
    wave: float = 0.0
    slope_measured: bool = True
    bulge: float = 0.0

    @property
    def size(self) -> int:
        """Number of parameters of one flank."""
        return (2 + len(self.form)) * self.z + 1


@dataclass(frozen=True, kw_only=True, eq=False)
class AsBuilt:
    """The layout of the as-built parameters, in um about what was declared: per flank and gear all pitches, all slopes,
    one crowning, and of each half wave of form one amplitude per tooth; and their ``precision`` (m, m)."""

    gears: tuple[GearPrior, GearPrior]
    flanks: tuple[Flank, ...]
    precision: FloatArray

    @property
    def size(self) -> int:
        """Number of parameters."""
        return len(self.flanks) * sum(gear.size for gear in self.gears)

    def start(self, flank: Flank, gear: int) -> int:
        """Where the parameters of one gear's flank begin."""
        before = self.flanks.index(flank) * sum(one.size for one in self.gears)
        return before + (self.gears[0].size if gear else 0)

    def pitch(self, values: FloatArray, flank: Flank, gear: int) -> FloatArray:
        """The pitches (z,) of one gear's flank."""
        start = self.start(flank, gear)
        return values[start : start + self.gears[gear].z]

    def slope(self, values: FloatArray, flank: Flank, gear: int) -> FloatArray:
        """The slopes (z,) of one gear's flank."""
        start = self.start(flank, gear) + self.gears[gear].z
        return values[start : start + self.gears[gear].z]

    def crowning(self, values: FloatArray, flank: Flank, gear: int) -> float:
        """What the teeth of one gear's flank have in common of crowning."""
        return float(values[self.start(flank, gear) + 2 * self.gears[gear].z])

    def form(self, values: FloatArray, flank: Flank, gear: int) -> FloatArray:
        """The forms of one gear's flank: of each of K half waves, from two on, its amplitude on every tooth (K, z)."""
        one, start = self.gears[gear], self.start(flank, gear)
        return values[start + 2 * one.z + 1 : start + one.size].reshape(len(one.form), one.z)

    def form_at(self, flank: Flank, gear: int, tooth: int) -> IntArray:
        """Where the half waves of a tooth's form stand (K,) among the parameters."""
        one = self.gears[gear]
        return self.start(flank, gear) + 2 * one.z + 1 + tooth + np.arange(len(one.form)) * one.z

    def at_tooth(self, flank: Flank, gear: int, tooth: int) -> IntArray:
        """Where the pitch and the slope of a tooth stand (2,) among the parameters."""
        start = self.start(flank, gear)
        return np.array([start + tooth, start + self.gears[gear].z + tooth])

    def known(self, at: IntArray) -> FloatArray:
        """Covariance (k, k) in um^2 beforehand of the parameters ``at`` (k,)."""
        units = np.zeros((self.size, at.size))
        units[at, np.arange(at.size)] = 1.0
        return np.asarray(np.linalg.solve(self.precision, units)[at])

    def opened(self, at: IntArray, std: float) -> AsBuilt:
        """The same with parameters ``at`` (k,) that may be further from what was known, by ``std`` in um."""
        # Inverse of a covariance to which something is added at a few places (Woodbury).
        columns = self.precision[:, at]
        inner = np.eye(at.size) / std**2 + self.precision[np.ix_(at, at)]
        precision = self.precision - columns @ np.linalg.solve(inner, columns.T)
        return replace(self, precision=read_only(precision))

    def alike(self, values: FloatArray, gears: Sequence[int]) -> FloatArray:
        """The parameters (m,) with the teeth of these ``gears`` without crowning and form, all of a flank leaning as
        its median tooth does; of two gears, each half as much as both lean apart, all that shows to first order."""
        out = values.copy()
        for flank in self.flanks:
            lean = {gear: float(np.median(self.slope(out, flank, gear))) for gear in gears}
            both = float(np.mean(list(lean.values()))) if len(gears) == 2 else 0.0
            for gear in gears:
                self.slope(out, flank, gear)[:] = lean[gear] - both
                start, one = self.start(flank, gear), self.gears[gear]
                out[start + 2 * one.z : start + one.size] = 0.0
        return out

    def upright(self, values: FloatArray, gears: Sequence[int]) -> FloatArray:
        """The parameters (m,) with the teeth of these ``gears`` that lean as none of their fellows does leaning as
        their median tooth."""
        out = values.copy()
        for flank in self.flanks:
            for gear in gears:
                slope = self.slope(out, flank, gear)
                apart = slope - np.median(slope)
                leaning = np.abs(apart) > LEANING_TOOTH_SIGMAS * SIGMA_OVER_MEDIAN * np.median(np.abs(apart))
                slope[leaning] -= apart[leaning]
        return out

    def as_declared(self, values: FloatArray, gears: Sequence[int]) -> FloatArray:
        """The parameters (m,) in um with the teeth of these ``gears`` as the pair file has them."""
        out = values.copy()
        for flank in self.flanks:
            for gear in gears:
                start = self.start(flank, gear)
                out[start : start + self.gears[gear].size] = 0.0
        return out

    def perturbed(self, values: FloatArray, gears: Sequence[int], rng: np.random.Generator) -> FloatArray:
        """The parameters (m,) in um with the slope of every tooth of these ``gears`` changed at random, by one standard
        deviation of its grade."""
        out = values.copy()
        for flank in self.flanks:
            for gear in gears:
                slope = self.slope(out, flank, gear)
                slope += self.gears[gear].slope * rng.normal(size=slope.size)
        return out

    def strained(self, values: FloatArray) -> bool:
        """Whether the teeth of a gear lean or bulge together as hardly any gear of its grade does."""
        return any(
            abs(self.crowning(values, flank, gear)) > STRAINED * one.crowning
            or abs(float(np.median(self.slope(values, flank, gear)))) > STRAINED * one.mean_slope
            for flank in self.flanks
            for gear, one in enumerate(self.gears)
            if one.graded
        )

    def columns(self, scene: Scene) -> Sparse:
        """Effects (n, m) in mm of one um of each parameter."""
        n, flank = scene.samples.size, scene.samples.flank
        if flank not in self.flanks:
            return full(np.zeros((n, 0))).beside(np.zeros((n, self.size)))
        at = self.start(flank, 0), self.start(flank, 1)
        out = tooth_columns(scene, at=at, size=self.size, waves=[len(one.form) for one in self.gears])
        # A resonance swings on after the contact of every tooth.
        return full(scene.swung(out.dense())) if scene.resonant else out

    def written(self, file: PairFile, values: FloatArray) -> PairFile:
        """The pair file with these deviations on top of what it declares."""
        for gear in (0, 1):
            section = gear_section(file, gear)
            keys: dict[str, object] = {}
            # What of the coast flank follows from the drive flank by default must not move along.
            for name in ("pitch_coast_um", "profile_slope_coast_um", "profile_crowning_coast_um"):
                keys[name] = _listed(column(section, name))
            for flank in self.flanks:
                tail = "_coast_um" if flank == "coast" else "_um"
                for name, more in (
                    ("pitch", self.pitch(values, flank, gear)),
                    ("profile_slope", self.slope(values, flank, gear)),
                    ("profile_crowning", np.array(self.crowning(values, flank, gear))),
                ):
                    keys[f"{name}{tail}"] = _listed(column(section, f"{name}{tail}") + more)
                if self.gears[gear].form:
                    keys[f"profile_form{tail}"] = tuple(map(_listed, self.form(values, flank, gear).T))
            file = on_gear(file, gear, inspection=changed(section.inspection or Inspection(), **keys))
        return file


def _listed(values: FloatArray) -> tuple[float, ...]:
    return tuple((np.round(values, 6) + 0.0).tolist())


def make_as_built(gears: tuple[GearPrior, GearPrior], flanks: Sequence[Flank]) -> AsBuilt:
    """The layout for the flanks that were recorded, drive first."""
    order: tuple[Flank, ...] = tuple(sorted(set(flanks), reverse=True))
    size = len(order) * sum(gear.size for gear in gears)
    flank_size = size // len(order)
    precision, at = np.zeros((size, size)), 0
    for gear in gears:
        # A tooth that stands ahead has more material on its drive flank and less on its coast flank.
        place, form = gear.shared
        own_place, own_form = gear.own
        for covariance, alike, own, coast in (
            (gear.pitch, -place, own_place, gear.thickness**2),
            (on_its_own(gear.z, gear.slope) + gear.mean_slope**2, form, own_form, 0.0),
            (np.array([[gear.crowning**2]]), form, own_form, 0.0),
            *((on_its_own(gear.z, wave), form, own_form, 0.0) for wave in gear.form),
        ):
            n = len(covariance)
            each = {"drive": covariance, "coast": (1.0 + own) * covariance + coast}
            joint = np.block([[each[a] if a == b else alike * covariance for b in order] for a in order])
            index = np.concatenate([np.arange(at, at + n) + k * flank_size for k in range(len(order))])
            precision[np.ix_(index, index)] = np.linalg.inv(joint)
            at += n
    return AsBuilt(gears=gears, flanks=order, precision=read_only(precision))


def on_its_own(z: int, each: float) -> FloatArray:
    """Covariance (z, z) in um^2 of teeth that deviate by ``each`` um, every one on its own."""
    return each**2 * np.eye(z)


def chain(z: int, *, single: float, cumulative: float) -> FloatArray:
    """Covariance (z, z) in um^2 of the pitches of a gear within its grade: a closed chain of single pitches, uniform
    within +-``single`` um (f_p) and independent, that ranges over at most ``cumulative`` um (F_p), both along the line
    of action. Derived here; measured on the chains of ``gearpoly.gear.chain``."""
    order = np.arange(1, z // 2 + 1)
    single, cumulative = max(min(single, cumulative), IDEAL_TEETH_STD_UM), max(cumulative, IDEAL_TEETH_STD_UM)
    free = single / math.sqrt(3.0) * math.sqrt(2.0 / z) / (2.0 * np.sin(np.pi * order / z))
    most = cumulative * CHAIN_STD_OVER_F_P * (z * (single / cumulative) ** 2) ** -CHAIN_STD_EXPONENT
    # The fastest wave of an even number of teeth has no second phase.
    power = np.where(2 * order == z, 0.5, 1.0) / (free**-2.0 + most**-2.0)
    # A closed chain is alike at every tooth: one row holds all, shifted by one from row to row.
    lag = np.arange(z)
    row = power @ np.cos(2.0 * np.pi / z * np.outer(order, lag) % (2.0 * np.pi))
    # All teeth as one are the mean's matter, and their thickness's.
    return np.asarray(row[np.subtract.outer(lag, lag) % z]) + on_its_own(z, IDEAL_TEETH_STD_UM)
