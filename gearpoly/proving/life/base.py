"""What all cases of the real-life ground share: drawn gears, the limit of what anyone could know, files and truths."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from gearpoly.proving.case import build, limit_of, told_of
from gearpoly.proving.chain import Chain, Motion, RecordedCondition, motion
from gearpoly.proving.drawn import make_pair, pair_file
from gearpoly.proving.effects import Effect, apply, truth
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.limit import DetectionLimit
from gearpoly.proving.recipes import Recipe
from gearpoly.proving.rig import Rig
from gearpoly.proving.rivals import rivals, whitened
from gearpoly.proving.sizes import sized
from gearpoly.proving.unknown import unknown

NEAR_RIVAL_SEPARABILITY = 3.0
"""Separability times size over the limit below which to name a rival in the effect's stead is no false name."""

Record = Callable[[Rig, RecordedCondition, Chain, Motion, np.random.Generator], str]
Limiting = Callable[[Rig, Recipe, tuple[Motion, ...]], DetectionLimit]


@dataclass(frozen=True, kw_only=True)
class LifeCase:
    """A case ready to be written."""

    pair_text: str
    recordings: tuple[str, ...]
    truth: dict[str, Any]

    def truth_text(self) -> str:
        """The truth file's text."""
        return json.dumps(self.truth, indent=1) + "\n"

    def files(self) -> Iterator[tuple[str, str]]:
        """Names and texts of the case's folder."""
        yield "pair.toml", self.pair_text
        for k, text in enumerate(self.recordings):
            yield f"rec_{k}.csv", text


@dataclass(frozen=True, kw_only=True)
class Setting:
    """What a class decides of a case: the recipe; ``rig`` as changed from the one drawn, ``move`` and ``record`` what
    else than even running and the contract's file; ``limit``: if noise is not the chain's; ``declared``: the pair
    file's text from the honest one; ``aliases``: of an item, other orders that the samples show it at."""

    made: Recipe
    rig: Callable[[Rig], Rig] = lambda rig: rig
    move: Callable[[Rig, RecordedCondition, np.random.Generator], Motion] = motion
    record: Record
    limit: Limiting = limit_of
    declared: Callable[[str], str] = lambda text: text
    aliases: Callable[[dict[str, Any]], list[float]] = lambda item: []
    kind: str = ""
    told: dict[str, Any] = field(default_factory=dict)


def plain_recipe(
    entry: CaseEntry, pair: str, conditions: tuple[RecordedCondition, ...], chain: Chain,
    effects: tuple[Effect, ...] = (), *, grade: int = 6, inspected: bool = False, deflect: bool = False,
    background: tuple[Effect, ...] = (), background_over: tuple[float, ...] = (), fixed: bool = False,
    concealed_by: str = "",
) -> Recipe:  # fmt: skip
    """A recipe with the fields that real life does not vary left as they are."""
    return Recipe(
        pair=pair, grade=grade, inspected=inspected, uncertainty=0.5, deflect=deflect, conditions=conditions,
        chain=chain, effects=effects, over=entry.over, fixed=fixed, scale_torque=False, concealed_by=concealed_by,
        background=background, background_over=background_over,
    )  # fmt: skip


def turns(entry: CaseEntry, pair: str, otherwise: float) -> float:
    """Driving turns of a recording: the entry's hunting cycles, or what the class has otherwise."""
    return max(entry.cycles * make_pair(pair).hunting_turns, 1.5) if entry.cycles else otherwise


def finish(seed: int, entry: CaseEntry, setting: Setting, rng: np.random.Generator) -> LifeCase:
    """The case of a setting: gears drawn, effects sized against their own limit, files written, truth told."""
    made = setting.made
    drawn, known = build(made, rng)
    base = setting.rig(drawn)
    paths = tuple(setting.move(base, condition, rng) for condition in made.conditions)
    limit = setting.limit(base, made, paths) if made.effects or made.background else None
    effects = list(made.effects)
    if limit is not None and not made.fixed:
        effects = [sized(base, limit, effect, made.over) for effect in effects]
    rig = base
    for effect in effects:
        rig = apply(rig, effect)
    waves = []
    for wave, over in zip(made.background, made.background_over, strict=True):
        alone = setting.limit(base, replace(made, background=()), paths)
        wave = sized(base, alone, wave, over)
        waves.append((wave, alone.over(apply(base, wave))))  # less than asked for where the largest size cuts it
    known_to_be_so = limit is not None and setting.kind != "wrong_file"  # there nothing is to be named, whatever is in
    items = [_item(base, limit, effect, made, setting) for effect in effects] if known_to_be_so else []
    beside = [truth(rig, wave, made.chain, made.conditions) | {"over_limit": round(over, 3)} for wave, over in waves]
    for item in (*items, *beside):
        item["aliases"] = setting.aliases(item)
    for wave, _ in waves:
        rig = apply(rig, wave)
    text = pair_file(
        base.pair, (base.teeth_1, base.teeth_2), known, torque=max(c.torque for c in made.conditions),
        speed=made.conditions[0].speed, deflect=made.deflect, rng=rng,
    )  # fmt: skip
    noises = np.random.default_rng([seed, entry.index, 2])
    recordings = tuple(
        setting.record(rig, condition, made.chain, path, noises)
        for condition, path in zip(made.conditions, paths, strict=True)
    )
    told = _truth(entry, setting, base, items, beside)
    return LifeCase(pair_text=setting.declared(text), recordings=recordings, truth=told)


def _item(base: Rig, limit: DetectionLimit | None, effect: Effect, made: Recipe, setting: Setting) -> dict[str, Any]:
    """One effect: what and where, its size over the limit, its rivals and the unknown among them."""
    assert limit is not None
    hidden = apply(base, effect)
    item = told_of(hidden, effect, made)
    item["over_limit"] = round(limit.size_of(whitened(base, limit, effect)), 3)
    item["rms_um"] = round(limit.rms_um(hidden), 5)
    if "physics" in item:
        item["rivals"] = [one.told() for one in rivals(base, limit, effect)]
        item["unknown"] = unknown(base, limit, effect)
    return item


def _truth(
    entry: CaseEntry, setting: Setting, base: Rig, items: list[dict[str, Any]], beside: list[dict[str, Any]]
) -> dict[str, Any]:
    """The truth file. ``may_name`` has every name that would not be false."""
    made = setting.made
    names: list[dict[str, Any]] = []
    for item in items:
        if "physics" in item:
            names.append({k: item[k] for k in ("physics", "gear", "tooth", "order") if k in item})
            near = [one for one in item["rivals"] if one["separability"] * item["over_limit"] < NEAR_RIVAL_SEPARABILITY]
            names += [{k: v for k, v in one.items() if k in ("physics", "gear")} for one in near]
    kind = setting.kind or ("missing" if any("physics" in i for i in items) else "unknown" if items else "none")
    return {
        "kind": kind, "truth": items, "background": beside,
        "may_name": names,
        "class": entry.klass, "concealed_by": made.concealed_by, "noise_um": made.chain.noise_um, "pair": made.pair,
        "recordings": len(made.conditions), "inspected": made.inspected, "grade": made.grade,
        "hunting_cycles": round(made.conditions[0].turns / base.pair.hunting_turns, 3),
        "samples_per_mesh": made.conditions[0].per_mesh,
        "zeros_known": made.chain.known, "depth": {"over_limit": max((i["over_limit"] for i in items), default=0.0)},
    } | setting.told  # fmt: skip


__all__ = ["LifeCase", "Setting", "finish", "plain_recipe", "turns"]
