"""One concealed case: the set-up as built, what is declared of it, what is hidden in it and how deep, and its files."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from proving.chain import Chain, Condition, Motion, motion, record
from proving.compliance import LAWS
from proving.drawn import Known, draw, index_covariance, make_pair, pair_file, slope_covariance
from proving.effects import RIVALS, Effect, apply, rival_effects, truth
from proving.flanks import Teeth
from proving.gears import FloatArray
from proving.ground import Entry
from proving.limit import Limit, sights
from proving.recipes import Recipe, recipe
from proving.rig import Rig
from proving.scenes import CAPS

CONFUSED = 3.0
"""A rival whose separability times the size over the limit stays below this cannot be excluded by these recordings."""
FLOOR = 0.01
"""um rms: two explanations closer than this differ by less than models of one pair do, however long the recording."""
POSITIVE = ("tooth_deflection", "misalignment", "friction", "tooth_crack", "mesh_resonance")
"""Physics that a negative size would turn into nonsense."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A case, ready to be written; text of the pair file included, recordings made on demand."""

    seed: int
    entry: Entry
    recipe: Recipe
    rig: Rig
    known: tuple[Known, Known]
    paths: tuple[Motion, ...]
    pair_text: str
    record_seed: tuple[int, ...]
    truth: dict[str, Any]

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """Conditions of the recordings, in order."""
        return self.recipe.conditions

    @property
    def chain(self) -> Chain:
        """The measuring chain of all recordings."""
        return self.recipe.chain

    def truth_text(self) -> str:
        """The truth file's text."""
        return json.dumps(self.truth, indent=1) + "\n"

    def files(self) -> Iterator[tuple[str, str]]:
        """Names and texts of the case's folder."""
        yield "pair.toml", self.pair_text
        rng = np.random.default_rng(self.record_seed)
        for k, (condition, path) in enumerate(zip(self.conditions, self.paths, strict=True)):
            yield f"rec_{k}.csv", record(self.rig, condition, self.chain, path, rng)


def _build(made: Recipe, rng: np.random.Generator) -> tuple[Rig, tuple[Known, Known]]:
    """The gears as drawn and as declared, nothing hidden yet."""
    pair = make_pair(made.pair)
    known, teeth = [], []
    for index in (1, 2):
        gear = pair.gear(index)
        E_s = -60.0 if gear.m >= 1 else -40.0
        thick = E_s + (rng.normal(0, made.uncertainty) if made.inspected else rng.uniform(-7, 7))
        drawn = draw(gear, made.grade, float(thick), rng)
        relief, off = made.relief[index - 1], made.eccentric[index - 1]
        if relief is not None:
            drawn = replace(drawn, relief=relief[0], relief_mm=relief[1], power=relief[2])
        teeth.append(drawn)
        known.append(
            Known(
                grade=made.grade, inspected=made.inspected, uncertainty=made.uncertainty, relief=relief,
                eccentricity=off, E_s=E_s,
            )
        )  # fmt: skip
    rig = Rig(
        pair=pair,
        teeth_1=teeth[0],
        teeth_2=teeth[1],
        eccentric_1=made.eccentric[0] or (0.0, 0.0),
        eccentric_2=made.eccentric[1] or (0.0, 0.0),
        deflect=made.deflect,
        law=str(rng.choice(LAWS)),
        scale=float(rng.uniform(0.96, 1.04)),
    )
    return rig, (known[0], known[1])


def _limit(rig: Rig, made: Recipe, paths: tuple[Motion, ...]) -> Limit:
    def prior(of: Any, index: int) -> FloatArray:
        gear = rig.pair.gear(index)
        if made.inspected:
            return np.asarray(made.uncertainty**2 * np.eye(gear.z))
        return np.asarray(of(gear, made.grade))

    look = sights(made.conditions, paths, made.chain)
    return Limit(
        rig, look, made.chain,
        index=(prior(index_covariance, 1), prior(index_covariance, 2)),
        slope=(prior(slope_covariance, 1), prior(slope_covariance, 2)),
        thickness=made.uncertainty if made.inspected else 4.0,
        compliance=0.08 if made.deflect else 0.0,
    )  # fmt: skip


def _signal(rig: Rig, limit: Limit, effect: Effect) -> FloatArray:
    """Whitened signal of one effect put into a rig."""
    if effect.physics in ("tooth_pitch", "cumulative_pitch"):
        p = apply(rig, effect).teeth(effect.gear).p - rig.teeth(effect.gear).p
        return limit.index_signal(effect.gear, p)
    return limit.difference(apply(rig, effect))


def _sized(rig: Rig, limit: Limit, effect: Effect, over: float) -> Effect:
    """The effect at a size over the limit: its signal may bend with size, so the guess is mended with its own slope."""
    cap, power = CAPS[effect.physics], 1.0
    last: tuple[float, float] | None = None
    for _ in range(6):
        n = limit.size_of(_signal(rig, limit, effect))
        if n <= 0.0:
            return effect.scaled(cap)
        size = abs(effect.size)
        if abs(n / over - 1) < 0.03 or (size >= cap and n < over):
            break
        if last is not None and abs(np.log(size / last[0])) > 1e-6:  # some signals grow with a power of the size
            power = float(np.clip(np.log(n / last[1]) / np.log(size / last[0]), 0.4, 3.0))
        last = (size, n)
        effect = effect.scaled(min(size * float(np.clip((over / n) ** (1 / power), 1e-4, 1e4)), cap))
    return effect


def _rivals(rig: Rig, limit: Limit, effect: Effect, over: float, loaded: bool) -> list[dict[str, Any]]:
    """What these recordings cannot tell from the effect, and how separable each is (sine of the angle between the
    signals)."""
    out: list[dict[str, Any]] = []
    s = limit.difference(apply(rig, effect))
    for name in RIVALS.get(effect.physics, ()):
        few = rival_effects(effect, rig, name, loaded)
        if not few:
            continue
        signals = [limit.difference(apply(rig, one)) for one in few]
        sine = limit.sine(s, s - np.stack(signals, axis=1) @ limit.fit(s, signals))
        if sine * over < 4 * CONFUSED:
            # Close: put the rival in at the size that it needs, since signals bend with size, and mend it twice.
            sizes = limit.fit(s, signals) * np.array([one.size for one in few])
            apart = np.inf
            for _ in range(3):
                meant = rig
                for one, size in zip(few, sizes, strict=True):
                    if abs(size) < 2 * CAPS[one.physics] and (size > 0 or one.physics not in POSITIVE):
                        meant = apply(meant, replace(one, size=float(size)))
                rest = s - limit.difference(meant)
                sine = min(sine, limit.sine(s, rest))
                apart = min(apart, limit.rms_um(meant, apply(rig, effect)))
                sizes = sizes + limit.fit(rest, signals) * np.array([one.size for one in few])
        else:
            apart = np.inf
        if sine * over < CONFUSED or apart < FLOOR:
            rival: dict[str, Any] = {"physics": few[0].physics, "separability": round(sine, 4)}
            if few[0].gear:
                rival["gear"] = few[0].gear
            out.append(rival)
    return out


def _alike(rig: Rig, limit: Limit, effect: Effect, made: Recipe) -> Effect:
    """The effect at a size at which a rival is left: smaller, if it must be, but not below four times the limit."""
    over = made.over
    loaded = max(c.torque for c in made.conditions) > 0 and rig.deflect
    while over > 4.0 and not _rivals(rig, limit, effect, over, loaded):
        over = max(4.0, 0.7 * over)
        effect = _sized(rig, limit, effect, over)
    return effect


def make(seed: int, entry: Entry) -> Case:
    """The case of one line of the plan: drawn, sized against its own limit, and described."""
    rng = np.random.default_rng([seed, entry.index])
    made = recipe(entry, rng)
    base, known = _build(made, rng)
    paths = tuple(motion(base, condition, rng) for condition in made.conditions)
    effects: list[Effect] = []
    limit: Limit | None = None
    if made.effects:
        if made.scale_torque:  # an undeclared deflection is as large as the load makes it
            limit = _limit(base, made, paths)
            n = limit.over(apply(base, made.effects[0]))
            top = max(c.torque for c in made.conditions)
            factor = min(entry.over / n, 1.0)
            weaker = tuple(
                replace(c, torque=float(f"{max(c.torque * factor, 1e-5 * top):.4g}")) for c in made.conditions
            )
            made = replace(made, conditions=weaker, effects=made.effects)
        limit = _limit(base, made, paths)
        for effect in made.effects:
            fixed = made.fixed or made.scale_torque
            effects.append(effect if fixed else _sized(base, limit, effect, made.over))
        if entry.klass == "look_alike":
            effects = [_alike(base, limit, effects[0], made)]
    rig = base
    for effect in effects:
        rig = apply(rig, effect)
    built: tuple[Teeth, Teeth] = (base.teeth_1, base.teeth_2)
    text = pair_file(
        base.pair, built, known, torque=max(c.torque for c in made.conditions),
        speed=made.conditions[0].speed, deflect=made.deflect, rng=rng,
    )  # fmt: skip
    record_seed = (seed, entry.index, 1)
    told = _truth(entry, made, base, rig, effects, limit)
    return Case(
        seed=seed, entry=entry, recipe=made, rig=rig, known=known, paths=paths, pair_text=text,
        record_seed=record_seed, truth=told,
    )  # fmt: skip


def _truth(
    entry: Entry, made: Recipe, base: Rig, rig: Rig, effects: list[Effect], limit: Limit | None
) -> dict[str, Any]:
    """The truth file: the bench's keys first, then class, depth and what is acceptable as an answer."""
    loaded = max(c.torque for c in made.conditions) > 0 and rig.deflect
    items: list[dict[str, Any]] = []
    depth: dict[str, Any] = {}
    if effects:
        assert limit is not None
        single = len(effects) == 1
        all_over = limit.size_of(_signal(base, limit, effects[0])) if single else limit.over(rig)
        for k, effect in enumerate(effects):
            item = truth(rig, effect, made.chain, made.conditions)
            alone = apply(base, effect)
            item["over_limit"] = round(limit.size_of(_signal(base, limit, effect)), 3)
            item["rms_um"] = round(limit.rms_um(alone), 5)
            others = base
            for j, other in enumerate(effects):
                others = others if j == k else apply(others, other)
            item["acceptable"] = _rivals(base, limit, effect, item["over_limit"], loaded)
            items.append(item)
        rms = limit.rms_um(rig)
        pooled = np.concatenate([v - v.mean() for v in limit.plain])
        hides = max(float(pooled.std()), made.chain.noise_um)
        depth = {
            "rms_um": round(rms, 5),
            "hidden_by_rms_um": round(hides, 5),
            "over_what_hides_it": round(rms / hides, 5),
            "over_limit": round(all_over, 3),
        }
    stranger = any(effect.physics == "disturbance" for effect in effects)
    return {
        "kind": "unknown" if stranger else "missing" if effects else "none",
        "truth": items,
        "concealed_by": made.concealed_by,
        "noise_um": made.chain.noise_um,
        "recordings": len(made.conditions),
        "class": entry.klass,
        "pair": made.pair,
        "depth": depth,
        "inspected": made.inspected,
        "grade": made.grade,
        "noise_colour": made.chain.colour,
        "law": base.law,
        "law_scale": base.scale,
        "declared_eccentricity_um": [0.0 if e is None else e[0] for e in made.eccentric],
        "zeros_known": made.chain.known,
        "zeros_deg": list(made.chain.zeros_deg),
        "hunting_cycles": round(made.conditions[0].turns / base.pair.hunting_turns, 3),
        "as_built": {
            name: {
                "pitch_um": [round(float(v), 4) for v in teeth.p],
                "profile_slope_um": [round(float(v), 4) for v in teeth.slope],
                "tooth_thickness_um": round(float(teeth.E_s[0]), 4),
            }
            for name, teeth in (("driving", rig.teeth_1), ("driven", rig.teeth_2))
        },
    }
