"""A guided mount: red noise of 10 to 1000 times the gears' effects, the angle from the clock, few samples per mesh."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt
from typing import Any

import numpy as np
from scipy.linalg import solve_triangular

from gearpoly.proving.case import limit_of
from gearpoly.proving.chain import Chain, Motion, RecordedCondition, te
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import Effect, instance
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.gears import MM_PER_UM, RAD_PER_DEG, FloatArray
from gearpoly.proving.life import records
from gearpoly.proving.life.base import LifeCase, Setting, finish, plain_recipe, turns
from gearpoly.proving.limit import DetectionLimit, Sight
from gearpoly.proving.recipes import Recipe
from gearpoly.proving.rig import Rig

WANDER_PAIRS = ("12/47 m0.5 shifted", "12/47 m0.5 shifted", "13/40 m1", "18/25 m2")
HIDDEN_IN_WANDER: tuple[tuple[str, ...], ...] = (
    ("eccentricity",), (), ("eccentricity", "profile_crowning"), ("profile_crowning",), ("tooth_pitch",),
    ("eccentricity",), ("profile_slope",), ("cumulative_pitch",),
)  # fmt: skip
WANDER_SIZES = {"eccentricity": 15.0, "profile_crowning": 20.0, "profile_slope": 15.0, "tooth_pitch": 15.0,
         "cumulative_pitch": 8.0}  # fmt: skip
RATIOS = (10.0, 30.0, 100.0, 10.0, 300.0, 30.0, 1000.0)
"""Rms of the wander over that of the gears' effects."""
ALIASES_LISTED = 6
"""Aliases that a truth lists."""
RATE = 2e-3
"""Largest relative error of the clock's rate, as measured on real mounts (0.03 to 0.22 %)."""


def covariance(time: FloatArray, *, rough: float, rough_s: float, smooth: float, smooth_s: float) -> FloatArray:
    """Covariance (um^2) of the wander at times in s: an exponential part, whose spectrum falls by 1/f^2, and a smooth
    one (Matern 3/2), whose spectrum falls by 1/f^4. Rms in um, times of memory in s."""
    apart = np.abs(time[:, None] - time[None, :])
    far = sqrt(3.0) * apart / smooth_s
    return np.asarray(rough**2 * np.exp(-apart / rough_s) + smooth**2 * (1.0 + far) * np.exp(-far))


def make(seed: int, entry: CaseEntry, rng: np.random.Generator) -> LifeCase:
    """One case."""
    v = entry.variant
    pair_name = WANDER_PAIRS[v % len(WANDER_PAIRS)]
    pair = make_pair(pair_name)
    per_mesh = (1.3, 2.6, 4.0, 6.0, 1.8, 3.1)[v % 6]
    condition = RecordedCondition(
        torque=0.0, speed=0.5, turns=turns(entry, pair_name, float(rng.uniform(3.0, 12.0))), per_mesh=per_mesh,
        wobble=0.0, uneven=float(rng.uniform(0.0, 0.2)),
    )  # fmt: skip
    hidden = HIDDEN_IN_WANDER[(v + v // 8) % len(HIDDEN_IN_WANDER)]
    effects = tuple(
        replace(one, size=WANDER_SIZES[one.physics] * float(rng.uniform(0.6, 1.6)) * (1 if one.size > 0 else -1))
        for one in (instance(name, pair, (condition,), rng) for name in hidden)
    )
    waves = tuple(
        Effect(physics="disturbance", more={"shape": Disturbance(
            kind="line", amplitude=1.0, gear=2, order=float(order), phase=float(rng.uniform(0, 2 * pi)))})
        for order in rng.choice([2, 3, 5, 9, 10], int(rng.integers(0, 3)), replace=False)
    )  # fmt: skip
    size = 0.5 * max((abs(one.size) for one in effects), default=10.0)
    wander = size * RATIOS[(v + v // 7) % len(RATIOS)]
    turn = 60.0 / condition.speed
    share = float(10 ** rng.uniform(-4.0, -2.0))
    red = {
        "rough": wander * share, "rough_s": turn * float(rng.uniform(0.05, 0.3)),
        "smooth": wander * sqrt(1 - share**2), "smooth_s": turn * float(rng.uniform(2.0, 6.0)),
    }  # fmt: skip
    rate = RATE * float(rng.uniform(-1, 1))
    chain = Chain(
        noise_um=size * float(rng.uniform(0.03, 0.3)), known=False, zeros_deg=(0.0, float(rng.uniform(0, 360)))
    )

    def spread(time: FloatArray) -> FloatArray:
        return covariance(time, **red) + chain.noise_um**2 * np.eye(time.size)

    def limit(rig: Rig, made: Recipe, paths: tuple[Motion, ...]) -> DetectionLimit:
        """All samples at once, the wander's spectrum known; a ramp is as free as the rate."""

        def whiten(sight: Sight, chain: Chain, values: FloatArray) -> FloatArray:
            key = sight.time.size
            if key not in roots:
                gone = sight.time / sight.time[-1]
                ramp = 1e3 * wander * gone
                roots[key] = np.linalg.cholesky(spread(sight.time) + ramp[:, None] * ramp)
            return np.asarray(solve_triangular(roots[key], values, lower=True))

        roots: dict[int, FloatArray] = {}
        look = tuple(
            Sight(condition=c, path=p, time=p.time, run=1, share=1.0)
            for c, p in zip(made.conditions, paths, strict=True)
        )
        plain = limit_of(rig, made, paths)
        return plain.seen_with(look, whiten)

    def record(rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator) -> str:
        red_noise = np.linalg.cholesky(spread(path.time)) @ rng.standard_normal(path.time.size)
        stated = chain.zeros_deg[1] + (path.start + path.rate * (1 + rate) * path.time) / RAD_PER_DEG
        x = te(rig, condition, path) / MM_PER_UM + red_noise
        table: records.Table = {"time_s": (path.time, "%.4f"), "driven_angle_deg": (stated, "%.6f")}
        if v % 2:
            arcsec = x * MM_PER_UM / rig.pair.driven.r_b / RAD_PER_DEG * 3600.0
            table["te_arcsec"] = (arcsec, "%.3f")
        else:
            table["te_um"] = (x, "%.3f")
        return records.text(records.heading(condition, chain, rng), table)

    def aliases(item: dict[str, Any]) -> list[float]:
        return folded(item, pair.driving.z, pair.driven.z, pair.driven.z * per_mesh)

    made = plain_recipe(
        entry, pair_name, (condition,), chain, effects, grade=8, fixed=True, background=waves,
        background_over=tuple(float(rng.choice([1.0, 10.0, 30.0])) for _ in waves),
        concealed_by="wander of mount and air, and few samples per mesh",
    )  # fmt: skip
    told = {
        "wander": {**{k: round(x, 4) for k, x in red.items()}, "over_effects": round(wander / size, 1)},
        "rate_error": rate, "teeth_resolved": per_mesh >= 4.0,
    }  # fmt: skip
    return finish(
        seed, entry, Setting(made=made, record=record, limit=limit, aliases=aliases, told=told), rng
    )  # fmt: skip


def folded(item: dict[str, Any], z_1: int, z_2: int, per_turn: float) -> list[float]:
    """Other orders of the item's shaft at which samples at even steps, so many per driven turn, show its order alike;
    the lowest of all first."""
    if item.get("order") is None:
        return []
    ratio = z_2 / z_1 if item.get("gear") == 1 else 1.0
    order = item["order"] * ratio
    last = int(2 * order / per_turn) + 1
    found = sorted({round(abs(order - k * per_turn) / ratio, 4) for k in range(1, last + 1)})
    return [one for one in found if abs(one - item["order"]) > 1e-3][:ALIASES_LISTED]
