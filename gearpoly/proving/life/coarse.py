"""Cheap encoders: 12 to 14 bits, errors once and twice per turn, readings that repeat, turned by hand, stopped."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi, sqrt

import numpy as np

from gearpoly.proving.case import limit_of
from gearpoly.proving.chain import Chain, Motion, RecordedCondition
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import Effect, instance
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.gears import MM_PER_UM, RAD_PER_DEG, FloatArray
from gearpoly.proving.life import records
from gearpoly.proving.life.base import LifeCase, Setting, finish, plain_recipe, turns
from gearpoly.proving.limit import DetectionLimit
from gearpoly.proving.recipes import Recipe
from gearpoly.proving.rig import Rig
from gearpoly.proving.scenes import COMMON_PAIRS, COPRIME

HIDDEN_BY_COARSE_ENCODERS: tuple[tuple[str, ...], ...] = (
    ("eccentricity",), (), ("encoder_eccentricity",), ("profile_crowning",), ("tooth_pitch",), ("cumulative_pitch",),
    (), ("encoder_scale",),
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class ByHand(Motion):
    """A shaft turned by hand: angles in rad at knots in s, at rest before the first and after the last."""

    knots: tuple[tuple[float, float], ...]

    def angle(self, time: FloatArray) -> FloatArray:
        """Driven angle: even between knots."""
        at, angle = np.array(self.knots).T
        return np.asarray(np.interp(time, at, angle))


def by_hand(rig: Rig, condition: RecordedCondition, rng: np.random.Generator) -> ByHand:
    """A recording of even times: at rest, turned unevenly (0.5 to 1.5 of the mean speed), a stop in the middle, on."""
    z = rig.pair.driving.z / rig.pair.driven.z
    n = round(condition.turns * rig.pair.driving.z * condition.per_mesh)
    seconds = condition.turns * 60.0 / condition.speed
    time = np.arange(n, dtype=np.float64) * np.float64(seconds / n)
    parts = rng.uniform(0.5, 1.5, 24)
    parts[12] = 0.0
    angle = np.concatenate([[0.0], np.cumsum(parts) / parts.sum()]) * condition.turns * 2 * pi * z
    start = float(rng.uniform(-2, 2) * 2 * pi)
    at = np.linspace(0.03 * seconds, 0.97 * seconds, angle.size)
    knots = tuple(zip(at.tolist(), (start + angle).tolist(), strict=True))
    plain = ByHand(time=time, theta_2=time, span=(0.0, seconds), waves=(), start=start, rate=0.0, knots=knots)
    return replace(plain, theta_2=plain.angle(time))


def counting_noise_um(rig: Rig, chain: Chain) -> float:
    """Rms in um of rounding both readings to counts that are passed at random: a step over the root of 12."""
    steps = [
        step * RAD_PER_DEG * rig.pair.gear(k).r_b / MM_PER_UM for k, step in zip((1, 2), chain.steps_deg, strict=True)
    ]
    return sqrt(sum(step**2 for step in steps) / 12.0)


def make(seed: int, entry: CaseEntry, rng: np.random.Generator) -> LifeCase:
    """One case."""
    v = entry.variant
    name = str(rng.choice(COPRIME + COMMON_PAIRS[:2]))
    pair = make_pair(name)
    bits = (12, 13, 14)[v % 3]
    repeat = (1, 1, 2, 4)[v % 4]
    hand = v % 3 == 1
    condition = RecordedCondition(
        torque=0.0, speed=20.0, turns=turns(entry, name, 2.2 * pair.hunting_turns), per_mesh=14, wobble=0.01, uneven=0.1
    )
    effects = tuple(
        instance(one, pair, (condition,), rng)
        for one in HIDDEN_BY_COARSE_ENCODERS[(v + v // 8) % len(HIDDEN_BY_COARSE_ENCODERS)]
    )
    # On the other shaft than the effect's: a pitch wave of the same order would be the same.
    other = 3 - effects[0].gear if effects and effects[0].gear else 1 + v % 2
    twice = Effect(physics="disturbance", more={"shape": Disturbance(
        kind="line", amplitude=1.0, gear=other, order=2.0, phase=float(rng.uniform(0, 2 * pi)))})  # fmt: skip
    step = 360.0 / 2**bits
    chain = Chain(
        noise_um=0.5, known=bool(rng.random() < 0.5), steps_deg=(step, step),
        zeros_deg=(float(rng.uniform(0, 360)), float(rng.uniform(0, 360))),
    )  # fmt: skip

    def limit(rig: Rig, made: Recipe, paths: tuple[Motion, ...]) -> DetectionLimit:
        """Counts as white noise; what is repeated, or recorded at rest, says nothing new."""
        fresh = tuple(
            replace(p, time=p.time[keep], theta_2=p.theta_2[keep])
            for p, keep in ((p, _new(p, repeat)) for p in paths)
        )  # fmt: skip
        noisy = sqrt(made.chain.noise_um**2 + counting_noise_um(rig, made.chain) ** 2)
        return limit_of(rig, replace(made, chain=replace(made.chain, noise_um=noisy)), fresh)

    def record(rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator) -> str:
        table = records.angle_table(rig, condition, chain, path, rng)
        held = np.arange(path.time.size) // repeat * repeat
        kept = {key: (values if key == "time_s" else values[held], form) for key, (values, form) in table.items()}
        return records.text(records.heading(condition, chain, rng), kept)

    made = plain_recipe(
        entry, name, (condition,), chain, effects, background=(twice,), background_over=((10.0, 2.0, 30.0)[v % 3],),
        concealed_by="counts of the encoders, tens of micrometres each",
    )  # fmt: skip
    told = {
        "bits": bits, "repeat": repeat, "turned_by_hand": hand,
        "step_um": [round(step * RAD_PER_DEG * pair.gear(k).r_b / MM_PER_UM, 3) for k in (1, 2)],
        "say": ["count", "resolution", "step", "staircase"],
    }  # fmt: skip
    if hand:
        return finish(seed, entry, Setting(made=made, record=record, limit=limit, told=told, move=by_hand), rng)
    return finish(seed, entry, Setting(made=made, record=record, limit=limit, told=told), rng)


def _new(path: Motion, repeat: int) -> FloatArray:
    moved = np.abs(np.diff(path.theta_2, prepend=path.theta_2[0] - 1.0)) > 1e-12
    return np.asarray(moved & (np.arange(path.time.size) % repeat == 0))
