"""What the simulation leaves of others, in mm rms: an effect that is no larger may be that."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearpoly.compare.noise import mean_innovation
from gearpoly.diagnose.fidelity import (
    BESIDE_ANOTHER,
    BESIDE_MESH,
    FAINT_EFFECT_MM,
    MEAN_TOOTH_BY_LAWS,
    OF_DEVIATIONS,
    OTHERS_BY_LAWS,
    participation,
)
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.scan import Candidate, columns_of
from gearpoly.diagnose.system import System
from gearpoly.infer.prior import order_of
from gearpoly.units import FloatArray

ECHO = 0.004
"""Part of the largest claim's effect below which another is taken for what the first leaves of itself."""

HARDLY_CHANGES_PART = 0.1
"""Part of what is seen of an effect below which it hardly changes along recordings."""

IN_STEP = 4.0
"""Size of a wave over what a reading's noise can make of it to first order: what is left of a wave beside the mean is
less than the wave, and several harmonics of the sampling make more together."""


def size_of(fit: Fit, one: Candidate) -> float:
    """Rms in mm of what a candidate adds and nothing else explains."""
    return mean_innovation(fit.noises) * math.sqrt(max(one.gain, 0.0) / fit.linear.system.samples)


def law_floor(fit: Fit, one: Candidate) -> float:
    """Rms in mm below which an effect may be what no compliance law gets right, as far as that reaches it."""
    physics, place = one.claim.physics, one.claim.place
    part, more = 0.0, 0.0
    if physics.mean_tooth:
        part, more = MEAN_TOOTH_BY_LAWS, fit.of_teeth
        if any(made.physics.mean_tooth and made.key != one.claim.key for made in fit.model.claims):
            part = BESIDE_ANOTHER
    if physics.whole_gear:
        # Where the rig took the means off, it is told by how eccentric teeth bend along their turns, or by nothing.
        part = OTHERS_BY_LAWS
    if physics.wavelike and place.order is not None:
        z = fit.model.scope.gears[place.gear or 0].z
        if place.order > z // 2 and abs((place.order + z // 2) % z - z // 2) <= BESIDE_MESH:
            part = OTHERS_BY_LAWS * magnified(fit, place.order, place.gear_name)
    # What is left of a tooth that follows the law is no more than that of all.
    floor = max(part * fit.deflection, min(more, BESIDE_ANOTHER * fit.deflection))
    if place.tooth is not None and fit.deflection > 0.0:
        floor = max(floor, OTHERS_BY_LAWS * bent_where(fit, one) + OF_DEVIATIONS * built_where(fit, one))
    return floor * part_recorded(fit, one) if size_of(fit, one) <= floor else floor


def magnified(fit: Fit, order: float, gear: str | None, recordings: Sequence[int] = ()) -> float:
    """By how much a resonance makes more of a wave of ``order`` per turn of a ``gear`` (None: per mesh), and so of
    what laws differ by in it, at most in any of ``recordings`` (none: in all); 1 where none does."""
    z_1, z_2 = (one.z for one in fit.model.scope.gears)
    per_driving = order * {"driving": 1.0, "driven": z_1 / z_2}.get(gear or "", float(z_1))
    scenes = [fit.scenes[k] for k in recordings] or fit.scenes
    hertz = np.array([per_driving * (scene.samples.speed or 0.0) / (2.0 * math.pi) for scene in scenes])
    return max(1.0, float(np.max(np.abs(scenes[0].assembled.shafts.gain(hertz)))))


def part_recorded(fit: Fit, one: Candidate) -> float:
    """Part of what may be left in the recordings that can pass for an effect: less than all of it where teeth as
    built could have the effect too, were they not held by their grade or inspection.

    Of what is known of the effect, K = D + P, only D lies in what is recorded, P in how unlikely such teeth are; to
    a leftover of the norm e belongs a gain of D e^2 / K at most.
    """
    columns, system = columns_beside(fit, one)
    effect = [white @ np.array(one.claim.values[: one.claim.physics.amplitudes]) for white in columns]
    right = sum((a.T @ e for a, e in zip(system.white, effect, strict=True)), np.zeros(system.size))
    taken = system.solved(right)
    recorded = sum(float(np.sum((e - a @ taken) ** 2)) for a, e in zip(system.white, effect, strict=True))
    known = sum(float(e @ e) for e in effect) - float(right @ taken)
    return math.sqrt(min(1.0, recorded / known)) if known > 0.0 else 1.0


def reading_floor(fit: Fit, one: Candidate) -> float:
    """Rms in mm below which a wave may be made of a reading's noise alone: that moves the angles by which the wave
    is drawn and the recorded error alike. Where samples come at the same phase of the wave turn after turn, as at
    the orders of the sampling itself, those products do not average out."""
    order, gear = one.claim.place.order, one.claim.place.gear or 0
    if not one.claim.physics.wavelike or order is None:
        return 0.0
    worst = 0.0
    for scene, noise in zip(fit.scenes, fit.noises, strict=True):
        samples = scene.samples
        angle = order * (samples.theta_1 if gear == 0 else samples.theta_2)
        in_step = math.hypot(float(np.mean(np.cos(angle))), float(np.mean(np.sin(angle))))
        worst = max(worst, in_step * order * noise.level**2 / scene.gear(gear).r_b)
    return IN_STEP * worst


def clock_floor(fit: Fit, one: Candidate) -> float:
    """Rms in mm below which an effect may be what a clock that is off does, where an angle was made of time. Where
    a single tooth stands is told by more than by what it moves at the ends of a recording; and that smears a wave, and
    makes none at another order, once per turn among them."""
    if not any(fit.model.scope.from_time) or one.claim.place.tooth is not None or order_of(one.claim) is not None:
        return 0.0
    return fit.late


def columns_beside(fit: Fit, one: Candidate) -> tuple[list[FloatArray], System]:
    """Whitened columns (n_k, a) per unit of each amplitude of a candidate or claim, and all that is believed
    without it."""
    linear = fit.linear
    mine = next((k for k, made in enumerate(fit.model.claims) if made.key == one.claim.key), None)
    if mine is None:
        return columns_of(fit.model, fit.scenes, linear, one), linear.system
    columns = [white[:, : one.claim.physics.amplitudes] for white in linear.white_of(mine)]
    return columns, linear.system.without(linear.layout.places(mine))


def simulation_floor(fit: Fit, one: Candidate) -> float:
    """Rms in mm below which an effect may be what the simulation leaves of others, as far as that reaches it."""
    echo = ECHO * fit.largest
    least = max(faint_floor(fit, one), echo)
    if size_of(fit, one) > least:
        return least
    if size_of(fit, one) > echo and not changes_along(fit, one):
        return echo
    return least * part_recorded(fit, one)


def faint_floor(fit: Fit, one: Candidate) -> float:
    """Rms in mm over all samples below which an effect may be what chords and contacts leave: of a single tooth,
    as much as they leave where it shows."""
    if one.claim.place.tooth is None or size_of(fit, one) > FAINT_EFFECT_MM:
        return FAINT_EFFECT_MM
    effect = np.concatenate(fit.model.change(fit.scenes, one.claim, one.claim.values))
    return FAINT_EFFECT_MM * math.sqrt(participation(effect))


def bent_where(fit: Fit, one: Candidate) -> float:
    """Rms in mm over all samples of the mean deflection, counted where an effect shows."""
    effects = fit.model.change(fit.scenes, one.claim, one.claim.values)
    squares = sum(
        bent**2 * participation(effect) * effect.size for bent, effect in zip(fit.deflections, effects, strict=True)
    )
    return math.sqrt(squares / fit.linear.system.samples)


def built_where(fit: Fit, one: Candidate) -> float:
    """Rms in mm over all samples of what teeth as built do in loaded recordings, counted where an effect shows."""
    effects = fit.model.change(fit.scenes, one.claim, one.claim.values)
    at, squares = fit.linear.layout.built, 0.0
    for scene, columns, effect in zip(fit.scenes, fit.linear.columns, effects, strict=True):
        square = float(effect @ effect)
        if scene.bends and square > 0.0:
            built = columns.times(at, fit.linear.system.solution[at])
            there = float(np.sum(effect**2 * (built - np.mean(built)) ** 2)) / square
            squares += there * participation(effect) * effect.size
    return math.sqrt(squares / fit.linear.system.samples)


def changes_along(fit: Fit, one: Candidate) -> bool:
    """Whether what is seen of an effect may be how it changes along a recording, as what chords and contacts leave
    does, which repeats with the pair. One that only sets recordings apart has to beat the doubt about how far a
    load bends, which is fitted beside it."""
    if one.claim.physics.slow and all(observed.whole for observed in fit.model.observed):
        return False
    mine = next((made for made in fit.model.claims if made.key == one.claim.key), None)
    effect = fit.model.change(fit.scenes, one.claim, one.claim.values, but=mine)
    squares = sum(part.size * float(np.var(part)) for part in effect)
    return math.sqrt(squares / fit.linear.system.samples) > HARDLY_CHANGES_PART * size_of(fit, one)
