"""One concealed case: the set-up as built, what is declared of it, what is hidden in it and how deep, and its files."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearpoly.proving.chain import ZERO_STD, Chain, Motion, RecordedCondition, motion, record
from gearpoly.proving.compliance import BENCH_LAWS
from gearpoly.proving.drawn import (
    GearAsStated,
    draw,
    form_deviation,
    index_covariance,
    make_pair,
    pair_file,
    slope_covariance,
)
from gearpoly.proving.effects import Effect, apply, truth
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.flanks import ToothDeviations
from gearpoly.proving.gears import MM_PER_UM, RAD_PER_DEG, FloatArray
from gearpoly.proving.limit import DetectionLimit, sights
from gearpoly.proving.recipes import Recipe, recipe
from gearpoly.proving.reliefs import cancelling, mean_tooth, over_a_pitch
from gearpoly.proving.rig import Rig
from gearpoly.proving.rivals import rivals, whitened
from gearpoly.proving.sizes import sized, smaller
from gearpoly.proving.unknown import unknown

UNKNOWN_ZERO_STD_DEG = 10.0
"""Standard deviation in deg of a zero that nobody stated: as far as the next tooth."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A case, ready to be written; text of the pair file included, recordings made on demand."""

    seed: int
    entry: CaseEntry
    recipe: Recipe
    rig: Rig
    known: tuple[GearAsStated, GearAsStated]
    paths: tuple[Motion, ...]
    pair_text: str
    record_seed: tuple[int, ...]
    truth: dict[str, Any]

    @property
    def conditions(self) -> tuple[RecordedCondition, ...]:
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


def build(made: Recipe, rng: np.random.Generator) -> tuple[Rig, tuple[GearAsStated, GearAsStated]]:
    """The gears as drawn and as declared, nothing hidden yet."""
    pair = make_pair(made.pair)
    known, teeth = [], []
    for index in (1, 2):
        gear = pair.gear(index)
        E_s = -60.0 if gear.m >= 1 else -40.0
        thick = E_s + (rng.normal(0, made.uncertainty) if made.inspected else rng.uniform(-7, 7))
        form = 0.0 if made.inspected else form_deviation(gear, made.grade)
        drawn = draw(gear, made.grade, float(thick), rng, form=form)
        relief, off = made.relief[index - 1], made.eccentric[index - 1]
        if relief is not None:
            drawn = replace(drawn, relief=relief[0], relief_mm=relief[1], power=relief[2])
        teeth.append(drawn)
        known.append(
            GearAsStated(
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
        law=str(rng.choice(BENCH_LAWS)),
        scale=float(rng.uniform(0.96, 1.04)),
    )
    return rig, (known[0], known[1])


def limit_of(rig: Rig, made: Recipe, paths: tuple[Motion, ...]) -> DetectionLimit:
    def prior(of: Any, index: int) -> FloatArray:
        gear = rig.pair.gear(index)
        if made.inspected:
            return np.asarray(made.uncertainty**2 * np.eye(gear.z))
        return np.asarray(of(gear, made.grade))

    def form(index: int) -> float:
        return 0.0 if made.inspected else form_deviation(rig.pair.gear(index), made.grade)

    look = sights(made.conditions, paths, made.chain)
    return DetectionLimit(
        rig, look, made.chain,
        index=(prior(index_covariance, 1), prior(index_covariance, 2)),
        slope=(prior(slope_covariance, 1), prior(slope_covariance, 2)),
        thickness=made.uncertainty if made.inspected else 4.0,
        compliance=0.08 if rig.deflect else 0.0,
        zero=rig.pair.driven.r_b * RAD_PER_DEG / MM_PER_UM * (ZERO_STD if made.chain.known else UNKNOWN_ZERO_STD_DEG),
        form=(form(1), form(2)),
        waves=tuple(wave.more["shape"] for wave in made.background),
    )  # fmt: skip


def _behind(rig: Rig, made: Recipe, paths: tuple[Motion, ...]) -> tuple[tuple[Effect, float], ...]:
    """The waves of the background at their sizes over their own limits, as those of any other unknown: beside the
    effects, and each with the other known."""
    if not made.background:
        return ()
    limit = limit_of(rig, replace(made, background=()), paths)
    waves = [sized(rig, limit, wave, over) for wave, over in zip(made.background, made.background_over, strict=True)]
    return tuple((wave, limit.over(apply(rig, wave))) for wave in waves)


def make(seed: int, entry: CaseEntry) -> Case:
    """The case of one line of the plan: drawn, sized against its own limit, and described."""
    rng = np.random.default_rng([seed, entry.index])
    made = recipe(entry, rng)
    base, known = build(made, rng)
    paths = tuple(motion(base, condition, rng) for condition in made.conditions)
    if made.scale_torque:  # an undeclared deflection is as large as the load makes it
        n = limit_of(base, made, paths).over(apply(base, made.effects[0]))
        top = max(c.torque for c in made.conditions)
        factor = min(entry.over / n, 1.0)
        weaker = tuple(replace(c, torque=float(f"{max(c.torque * factor, 1e-5 * top):.4g}")) for c in made.conditions)
        made = replace(made, conditions=weaker)
    effects = list(made.effects)
    limit = limit_of(base, made, paths) if effects else None
    if limit is not None and not (made.fixed or made.scale_torque):
        effects = [sized(base, limit, effect, made.over) for effect in effects]
    if limit is not None and entry.klass == "look_alike":
        effects = [smaller(base, limit, effects[0], made.over)]
    if made.cancels:
        effects += cancelling(base, max(c.torque for c in made.conditions))
    rig = base
    for effect in effects:
        rig = apply(rig, effect)
    behind = _behind(rig, made, paths)
    built: tuple[ToothDeviations, ToothDeviations] = (base.teeth_1, base.teeth_2)
    text = pair_file(
        base.pair, built, known, torque=max(c.torque for c in made.conditions),
        speed=made.conditions[0].speed, deflect=made.deflect, rng=rng,
    )  # fmt: skip
    told = _truth(entry, made, base, rig, effects, paths, limit)
    if behind:
        told["background"] = [
            truth(rig, wave, made.chain, made.conditions) | {"over_limit": round(over, 3)} for wave, over in behind
        ]
    for wave, _ in behind:
        rig = apply(rig, wave)
    return Case(
        seed=seed, entry=entry, recipe=made, rig=rig, known=known, paths=paths, pair_text=text,
        record_seed=(seed, entry.index, 1), truth=told,
    )  # fmt: skip


def _items(
    made: Recipe, base: Rig, rig: Rig, effects: list[Effect], paths: tuple[Motion, ...], limit: DetectionLimit
) -> list[dict[str, Any]]:
    """Every effect as the scorer reads it: what and where, its size over the limit with the sizes of the others open,
    and its rivals, the nearest first."""
    # Where bending is hidden, all else is hidden in teeth that bend, by a law as little known as a declared one.
    bends = [effect for effect in effects if effect.physics == "tooth_deflection"]
    bent = apply(base, bends[0]) if bends else base
    within = limit_of(bent, made, paths) if bends and len(effects) > 1 else limit
    rest = [effect for effect in effects if effect not in bends]
    signals = [whitened(bent, within, effect) for effect in rest]
    items: list[dict[str, Any]] = []
    for effect in effects:
        item = told_of(rig, effect, made)
        before, about = (base, limit) if effect in bends else (bent, within)
        s = whitened(before, about, effect)
        others = [signal for one, signal in zip(rest, signals, strict=True) if one is not effect]
        if others and effect not in bends:
            columns, free = np.stack(others, axis=1), np.full(len(others), np.inf)
            s = s - columns @ about.fit(s, columns, low=-free, high=free)
        item["over_limit"] = round(about.size_of(s), 3)
        item["rms_um"] = round(about.rms_um(apply(before, effect)), 5)
        item["rivals"] = [one.told() for one in rivals(before, about, effect)]
        if "physics" in item:
            item["unknown"] = unknown(before, about, effect)
        items.append(item)
    return items


def told_of(rig: Rig, effect: Effect, made: Recipe) -> dict[str, Any]:
    """What the scorer is told of an effect: its tooth as far as that can be known."""
    item = truth(rig, effect, made.chain, made.conditions)
    if "tooth" in item and not numbered(made, effect.gear):
        item |= {"tooth": None, "encoder_deg": None, "hidden_tooth": item["tooth"]}
    return item


def numbered(made: Recipe, gear: int) -> bool:
    """Whether anything tells the teeth of gear 1 or 2 apart: an inspection, a declared eccentricity, or an encoder on
    their shaft. Where the rig computes the transmission error the driving shaft is not read. Its zero is stated up to
    whole turns of both shafts then, and a turn of the driven gear moves it by z_2 teeth: the numbers stay open, as no
    pair of the ground has a z_2 that is a multiple of z_1."""
    read = gear == 2 or made.chain.column == "angles"
    return read or made.inspected or made.eccentric[gear - 1] is not None


def _depth(made: Recipe, base: Rig, rig: Rig, limit: DetectionLimit, over: float) -> dict[str, Any]:
    """How deep all effects together lie: beneath what hides them, beneath the noise per sample, over the limit."""
    rms = limit.rms_um(rig)
    hides = max(float(limit.plain.std()), made.chain.noise_um)
    out: dict[str, Any] = {
        "rms_um": round(rms, 5),
        "hidden_by_rms_um": round(hides, 5),
        "over_what_hides_it": round(rms / hides, 5),
        "over_noise": round(rms / made.chain.noise_um, 5),
        "over_limit": round(over, 3),
    }
    if made.cancels:  # what each recording shows at every mesh, and would show without the reliefs
        bare = mean_tooth(replace(base, deflect=True))
        plain, whole = mean_tooth(base), mean_tooth(rig)
        for key, other in (("mesh_ripple_um", whole), ("mesh_ripple_without_relief_um", bare)):
            out[key] = [
                round(float((over_a_pitch(other, c.torque) - over_a_pitch(plain, c.torque)).std()), 4)
                for c in made.conditions
            ]
    return out


def _truth(
    entry: CaseEntry, made: Recipe, base: Rig, rig: Rig, effects: list[Effect], paths: tuple[Motion, ...],
    limit: DetectionLimit | None,
) -> dict[str, Any]:  # fmt: skip
    """The truth file: the bench's keys first, then class, depth and what may be mistaken for it."""
    items: list[dict[str, Any]] = []
    depth: dict[str, Any] = {}
    if limit is not None:
        items = _items(made, base, rig, effects, paths, limit)
        depth = _depth(made, base, rig, limit, items[0]["over_limit"] if len(items) == 1 else limit.over(rig))
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
