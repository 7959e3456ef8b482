"""As much of recordings as suffices where many fits are tried: a few thousand samples of each."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearpoly.compare.noise import NoiseEstimator, whole_cycles
from gearpoly.diagnose.model import Model, Observed
from gearpoly.units import FloatArray, IntArray

SUFFICIENT_HUNTING_CYCLES, SUFFICIENT_SAMPLES = 3, 12_000
"""Whole hunting cycles and samples of a recording that suffice for that; a wrong place misfits by a tenth and more."""

PLACING_SAMPLES = (2000, 4000)
"""Samples of a recording on which the places are tried, at first and then closely: 2000 tell a misfit to a
thirtieth, 4000 to a 45th."""

AS_MANY_AS = 2
"""Recordings that have so many each; of more all have as many together, since all tell of the same teeth."""

ASKEW = 1.0618
"""Part by which the step from one such sample to the next is longer than even: at even steps samples that come so many
to the mesh would see the same few places of every pitch."""


SUFFICE = 12_000
"""Samples of all recordings together that propose: of an 18/25 pair 13 to the mesh of two hunting cycles. Recordings
are thinned from twice as many on, where proposing costs less than half of what a whole search does. A broken tip in two
recordings of 26 000 samples, which time had left without a name, was then weighed within 94 s. A judgement."""


def in_state_of(model: Model, other: Model) -> Model:
    """The model with everything that a fit moves as an ``other`` has it, which may have other samples."""
    return replace(
        model, claims=other.claims, built=other.built, shift=other.shift, rates=other.rates, scale=other.scale,
        law=other.law, as_built=other.as_built,
    )  # fmt: skip


def sufficing(model: Model, foreign: list[FloatArray]) -> tuple[Model, list[FloatArray]] | None:
    """The model with the part of its samples that suffices to propose, and so much of foreign columns; None where that
    is most of them."""
    if sum(one.samples.size for one in model.observed) < 2 * SUFFICE:
        return None
    return _seen(model, foreign, [opening(one, model, few=SUFFICE // len(model.observed)) for one in model.observed])


def shortened(model: Model, foreign: list[FloatArray], *, few: int) -> tuple[Model, list[FloatArray]]:
    """The model with as much of its recordings as suffices to place the teeth, a ``few`` samples of each, and so much
    of foreign columns."""
    return _seen(model, foreign, openings(model, few=few))


def openings(model: Model, *, few: int) -> list[IntArray]:
    """Numbers (k,) of the samples of each recording that suffice to place the teeth, a ``few`` of each."""
    few = min(few, AS_MANY_AS * few // len(model.observed))
    return [opening(one, model, few=few) for one in model.observed]


def _seen(model: Model, foreign: list[FloatArray], wheres: list[IntArray]) -> tuple[Model, list[FloatArray]]:
    observed = tuple(seen_at(one, where, model) for one, where in zip(model.observed, wheres, strict=True))
    return replace(model, observed=observed), [one[where] for one, where in zip(foreign, wheres, strict=True)]


def _meshes(one: Observed, model: Model) -> FloatArray:
    """Meshes (n,) of driven rotation."""
    return one.samples.theta_2 / model.scope.gears[1].tau


def opening(one: Observed, model: Model, *, few: int) -> IntArray:
    """Numbers (k,) of the samples of a recording that suffice to place the teeth: of whole hunting cycles of a long
    one, else of all, about a ``few``."""
    u, period = _meshes(one, model), math.lcm(*(gear.z for gear in model.scope.gears))
    cycles = whole_cycles(u, period)
    wanted = max(SUFFICIENT_HUNTING_CYCLES, math.ceil(SUFFICIENT_SAMPLES * max(cycles, 1) / u.size))
    n = int(np.flatnonzero(u - u[0] >= wanted * period)[0]) if wanted < cycles else u.size
    if n < 2 * few:
        return np.arange(n)
    return np.asarray(np.arange(0.0, n, ASKEW * n / few), dtype=np.int64)


def seen_at(one: Observed, where: IntArray, model: Model) -> Observed:
    """A recording at the samples of these numbers (k,)."""
    if where.size == one.samples.size:
        return one
    estimator = NoiseEstimator(_meshes(one, model)[where], z_1=model.scope.gears[0].z, z_2=model.scope.gears[1].z)
    jumps = tuple(int(np.searchsorted(where, jump)) for jump in one.jumps if jump <= where[-1])
    return replace(
        one, samples=one.samples.at(where), recorded=one.recorded[where], fit=one.fit[where], jumps=jumps,
        estimator=estimator,
    )  # fmt: skip
