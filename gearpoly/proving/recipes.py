"""What goes into a case of each class: the pair, what is declared, the campaign, the chain and what is hidden."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearpoly.proving.background import HUM_SPEED_RPM, background
from gearpoly.proving.chain import Chain, RecordedCondition, campaign_turns
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import Effect, instance
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.gears import IdealPair
from gearpoly.proving.physics import PHYSICS_BY_NAME
from gearpoly.proving.reliefs import sag, spanning
from gearpoly.proving.rig import ideal
from gearpoly.proving.scenes import (
    COMMON_PAIRS,
    COPRIME,
    campaign,
    chain,
    design_torque,
    stranger,
)

QUICK_PER_MESH = 10
"""Samples per mesh of the cases for everyday use: the fifth mesh harmonic still shows."""

LEAST_TURNS = 1.5
"""Driving turns of the shortest recording: of 24/36 half a hunting cycle is so long."""

CONCEALED_BY = {
    "two": "each other",
    "one_flank": "it shows on one flank only, or differs between the flanks by a phase",
    "look_alike": "its likeness: no recording made tells it from its rivals",
    "beside": "noise, and waves of the measuring chain or of a bearing that nobody declares",
    "stranger": "noise; and no mechanism of the catalogue makes it",
}
"""What conceals the effects of a class, in words."""

Declared = tuple[float, float, float] | None
Vector = tuple[float, float] | None


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """Everything about a case but the drawn gears and the final sizes.

    relief, eccentric: declared ones, driving then driven; fixed: the effects' sizes stand as they are; over: the size
    over the limit that they shall have; scale_torque: the torque makes the size; cancels: reliefs of both gears come
    with them that take up the deflection at the highest torque; background: waves beside them that nobody declares,
    background_over: the size of each over its own limit."""

    pair: str
    grade: int
    inspected: bool
    uncertainty: float
    deflect: bool
    conditions: tuple[RecordedCondition, ...]
    chain: Chain
    effects: tuple[Effect, ...]
    over: float
    fixed: bool
    scale_torque: bool
    concealed_by: str
    cancels: bool = False
    relief: tuple[Declared, Declared] = (None, None)
    eccentric: tuple[Vector, Vector] = (None, None)
    background: tuple[Effect, ...] = ()
    background_over: tuple[float, ...] = ()


def _kind(physics: tuple[str, ...], klass: str, rng: np.random.Generator) -> str:
    """The campaign in which the hidden physics can show."""
    shows = {PHYSICS_BY_NAME[name].shows for name in physics if name in PHYSICS_BY_NAME}
    if "speeds" in shows:
        return "speeds"
    if klass == "look_alike":
        # Only what leaves the look-alikes alike: one flank, one torque; lost motion needs both flanks to show at all.
        alone = {"shaft_windup": "flanks", "tooth_crack": "one"}
        return alone.get(physics[0], "coast" if shows == {"flanks"} else "free")
    if "load" in shows:
        return "load"
    if klass == "one_flank" or "flanks" in shows:
        return "coast"
    if physics and PHYSICS_BY_NAME[physics[0]].shows == "coast":
        return "coast"
    return str(rng.choice(["free", "free", "free", "two"]))


def _declared_eccentricity(pair: IdealPair, rng: np.random.Generator) -> tuple[Vector, Vector]:
    """60 um on one gear, up to 40 on the other; less on the smallest module, where 60 um would be an eighth of a
    tooth."""
    large = 60.0 if pair.driving.m >= 1 else 25.0
    two = [(large, round(float(rng.uniform(0, 360)), 2)), (round(float(rng.uniform(0, 0.66)) * large, 2), 0.0)]
    two[1] = (two[1][0], round(float(rng.uniform(0, 360)), 2))
    return (two[0], two[1]) if rng.random() < 0.5 else (two[1], two[0])


def _relief(pair: IdealPair) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Declared reliefs of both gears, um, mm, power: what half the design torque bends, halved for errors of the
    teeth."""
    amount = round(0.5 * sag(ideal(pair), 0.5 * design_torque(pair)), 2)
    lengths = [round(0.6 * spanning(pair, index), 3) for index in (1, 2)]
    return (amount, lengths[0], 1.0), (amount, lengths[1], 1.0)


def recipe(entry: CaseEntry, rng: np.random.Generator) -> Recipe:
    """Draw what one line of the plan asks for."""
    if entry.klass == "smallest":
        return _smallest(entry, rng)
    made = _masked(entry, rng) if entry.klass in ("masked", "cancelling") else _plain(entry, rng)
    made = _beside(made, entry, rng.spawn(1)[0])  # a stream of its own: the case beside it stays as it is without
    if entry.quick:
        made = replace(made, conditions=tuple(replace(c, per_mesh=QUICK_PER_MESH) for c in made.conditions))
    if entry.cycles:
        turns = max(entry.cycles * make_pair(made.pair).hunting_turns, LEAST_TURNS)
        made = replace(made, conditions=campaign_turns(made.conditions, turns))
    return made


def _beside(made: Recipe, entry: CaseEntry, rng: np.random.Generator) -> Recipe:
    """The same with its background, if the plan gives it one; hum needs times, and a speed of its own."""
    waves = background(entry, make_pair(made.pair), rng)
    if any(wave.more["shape"].kind == "hum" for wave, _ in waves):
        conditions = tuple(replace(c, speed=HUM_SPEED_RPM) for c in made.conditions)
        made = replace(made, chain=replace(made.chain, timed=True), conditions=conditions)
    return replace(made, background=tuple(wave for wave, _ in waves), background_over=tuple(over for _, over in waves))


def _plain(entry: CaseEntry, rng: np.random.Generator) -> Recipe:
    """Nothing, or effects that are given their sizes over the limit."""
    physics = entry.physics
    coprime = rng.random() < 0.65
    name = str(rng.choice(COPRIME if coprime else COMMON_PAIRS))
    pair = make_pair(name)
    inspected = bool(rng.random() < 0.7)
    colour, noise = float(rng.choice([0.0, 0.0, 0.4, 0.6])), float(rng.choice([0.3, 0.3, 1.0, 1.0, 2.0]))
    cycles = float(rng.choice([2.0, 2.0, 2.0, 3.0]))
    eccentric: tuple[Vector, Vector] = (None, None)
    relief: tuple[Declared, Declared] = (None, None)
    kind = _kind(physics, entry.klass, rng)
    text = "nothing is hidden"
    if entry.klass in ("healthy", "false_alarm"):
        kind = str(rng.choice(["free", "coast", "load", "two", "all"]))
        if entry.klass == "false_alarm":  # load has its own part of the healthy ones
            kind = str(rng.choice(["free", "free", "coast", "two"]))
        if entry.klass == "false_alarm" or entry.variant % 3 != 2:
            eccentric, colour = _declared_eccentricity(pair, rng), 0.6
            text = "nothing is hidden; 60 um of declared eccentricity and coloured noise tempt to find something"
        if entry.variant % 10 == 7:
            cycles = float(rng.choice([0.4, 0.8, 1.5]))
        if entry.variant % 10 == 4:
            kind, cycles, noise = "free", 10.0, 1.0
    elif entry.klass == "short":
        cycles = float(rng.choice([0.5, 0.8, 1.2, 1.7]))
        text = "a recording shorter than two hunting cycles: tooth and tooth are not told apart by repetition"
    elif entry.klass == "single":
        if entry.variant % 11 == 3 and kind == "free":
            cycles, noise = 10.0, 1.0
        text = "noise per sample, and the deviations of teeth that it has to be told from"
        if rng.random() < 0.2 and not set(physics) & {"eccentricity", "encoder_eccentricity"}:
            eccentric = _declared_eccentricity(pair, rng)
            text = "60 um of declared eccentricity, and noise"
    if kind == "speeds":  # pitch errors ring even in the stiffest spring: only noise makes that small
        noise = 3.0
    text = CONCEALED_BY.get(entry.klass, text)
    if entry.quick:
        cycles = min(cycles, 2.0)
    if kind != "free":  # several recordings say more than long ones
        cycles = min(cycles, 2.0)
    conditions = campaign(kind, pair, rng, cycles=cycles)
    if entry.klass == "stranger" and entry.variant % 5 == 1:  # hum needs a speed at which 50 Hz is no mesh harmonic
        conditions = tuple(replace(c, speed=26.0) for c in conditions)
    effects = _hidden(entry, pair, conditions, rng)
    deflect = kind not in ("free", "coast") and physics != ("tooth_deflection",)
    if deflect and kind in ("two", "all") and rng.random() < 0.3 and "tip_relief" not in physics:
        relief = _relief(pair)
    plain = any(PHYSICS_BY_NAME[name].plain for name in physics)
    return Recipe(
        pair=name,
        grade=int(rng.choice([4, 5, 5, 6] if not inspected else [4, 5, 6, 7])),
        inspected=inspected,
        uncertainty=float(rng.choice([0.2, 0.2, 0.5])),
        deflect=deflect,
        conditions=conditions,
        chain=chain(rng, noise_um=noise, colour=colour, inspected=inspected, plain=plain),
        effects=effects,
        over=entry.over * float(rng.uniform(0.88, 1.12)),
        fixed=False,
        scale_torque=physics == ("tooth_deflection",),
        concealed_by=text,
        relief=relief,
        eccentric=eccentric,
    )


def _hidden(
    entry: CaseEntry, pair: IdealPair, conditions: tuple[RecordedCondition, ...], rng: np.random.Generator
) -> tuple[Effect, ...]:
    """The effects that are hidden, of two the second on the other gear; sizes are given later."""
    gear = int(rng.integers(1, 3))
    if entry.klass == "stranger":
        return (stranger(entry.variant, pair, conditions, rng),)
    effects = tuple(
        instance(p, pair, conditions, rng, gear=gear if k == 0 else 3 - gear) for k, p in enumerate(entry.physics)
    )
    return (_alike(effects[0]),) if entry.klass == "look_alike" else effects


def _alike(effect: Effect) -> Effect:
    """The form of an effect that has a true look-alike: an order-1 pitch wave is one to an eccentricity."""
    if effect.physics == "cumulative_pitch":
        return replace(effect, more={**effect.more, "order": 1})
    return effect


def _masked(entry: CaseEntry, rng: np.random.Generator) -> Recipe:
    """Something small beneath something large that is known, or two that cancel each other at the design torque."""
    what = entry.physics[0]
    name = str(rng.choice(COPRIME + COMMON_PAIRS[:2]))
    pair = make_pair(name)
    noise = float(rng.choice([0.3, 1.0]))
    eccentric: tuple[Vector, Vector] = (None, None)
    grade, inspected, deflect = 5, True, True
    effects: tuple[Effect, ...]
    if what == "relief_under_eccentricity":
        conditions = campaign("two", pair, rng, cycles=2.0)
        eccentric = _declared_eccentricity(pair, rng)
        relief = instance("tip_relief", pair, conditions, rng)
        # On a straight line, as the contract has it where no shape is stated: amount and shape are hard to tell apart.
        # In two hunting cycles 0.45 um of noise leave what 1 um does in ten.
        effects, noise = (replace(relief, size=2.0, more={**relief.more, "power": 1.0}),), 0.45
        text = "60 um of declared eccentricity, thirty times larger; two torques"
    elif what == "relief_cancels_deflection":
        conditions = campaign("load", pair, rng, cycles=2.0)
        effects, deflect = (Effect(physics="tooth_deflection"),), False
        text = "each other: at the design torque the mesh ripple nearly vanishes"
    elif what == "crack_under_pitch":
        conditions = campaign("load", pair, rng, cycles=2.0)
        grade, inspected = int(rng.choice([6, 7])), bool(rng.random() < 0.5)
        crack = instance("tooth_crack", pair, conditions, rng)
        effects = (replace(crack, size=float(rng.uniform(0.15, 0.6))),)
        text = "invisible unloaded; under load no larger than the pitch errors"
    else:
        conditions = campaign(str(rng.choice(["free", "two"])), pair, rng, cycles=2.0)
        deflect = len(conditions) > 1
        grade = 8
        spall = instance("tooth_spall", pair, conditions, rng)
        effects = (replace(spall, size=float(rng.uniform(4.0, 9.0)) * min(1.0, pair.driving.m / 2 + 0.25)),)
        text = "grade 8 pitch errors several times larger"
    return Recipe(
        pair=name,
        grade=grade,
        inspected=inspected,
        uncertainty=0.2,
        deflect=deflect,
        conditions=conditions,
        chain=chain(rng, noise_um=noise, colour=0.0, inspected=True, plain=False),
        effects=effects,
        over=0.0,
        fixed=True,
        scale_torque=False,
        concealed_by=text,
        cancels=what == "relief_cancels_deflection",
        eccentric=eccentric,
    )


def _smallest(entry: CaseEntry, rng: np.random.Generator) -> Recipe:
    """The least tooth pitch error in ten hunting cycles, the least order line in ten turns, under 1 um of noise."""
    name = str(rng.choice(COPRIME))
    pair = make_pair(name)
    lap = entry.variant // 2
    if entry.physics[0] == "tooth_pitch":
        conditions = campaign("free", pair, rng, cycles=2.0 if entry.quick else 10.0)
        size = (0.3, 0.8, 0.4, 0.6, 0.5, 0.35)[lap % 6]
        text = "noise per sample, two to three times larger; the gauge knows every tooth to 0.05 um"
    else:
        # Ten turns at 70 samples a mesh leave 0.013 um on an order line.
        turns = 10.0 / pair.hunting_turns
        conditions = tuple(replace(c, per_mesh=70) for c in campaign("free", pair, rng, cycles=turns))
        size = (0.08, 0.2, 0.1, 0.15, 0.12, 0.09)[lap % 6]
        text = "noise per sample, five to twelve times larger, in ten turns"
    hidden = instance(entry.physics[0], pair, conditions, rng)
    return Recipe(
        pair=name,
        grade=5,
        inspected=True,
        uncertainty=0.05,
        deflect=False,
        conditions=conditions,
        chain=chain(rng, noise_um=1.0, colour=0.0, inspected=True, plain=False),
        effects=(hidden.scaled(size),),
        over=0.0,
        fixed=True,
        scale_torque=False,
        concealed_by=text,
    )


__all__ = ["Recipe", "recipe"]
