"""What a claim is worth on a torque or a flank that its fit never saw, and from the beginning of a recording to its
end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.diagnose.exchange import without_idle
from gearpoly.diagnose.fit import Fit, joined, settled
from gearpoly.diagnose.linear import Linear, whole_effect
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.relaxed import relaxed
from gearpoly.diagnose.system import System
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim, Scope
from gearpoly.scene import Scene
from gearpoly.units import FloatArray

Recordings = Sequence[int]

SWELLING_GAIN_PART, LEAST_SWELLING_GAIN = 0.05, 40.0
"""Part of a claim's gain that letting it swell or fade gains from which it is not steady (one that grows from half to
one and a half has 0.08), and the least of that gain: six standard deviations."""

WAVE_OFF_LINE_CYCLES = 3.0
"""Cycles per recording by which a wave has to be off a line to have nothing in common with a slow swell of it: of
Legendre's polynomials of degree 1 and 2 a hundredth of the power is left there, spherical Bessel functions at 3 pi."""

MOST_OF = 0.5
"""Part of what waves of unknown make gain that a swell has to gain without them, to be what made them: a drive's wave
2 cycles per recording off an order gains 30 times as much as a swell that mimics it. A judgement."""

ONE_SIZE = 1e-6
"""Unevenness of cosine squared plus sine squared from which on columns are no wave of one size."""


def conditions(scope: Scope) -> list[list[int]]:
    """Numbers of the recordings that were made on the same flank under the same torque, by condition, whichever way the
    pair ran."""
    made: dict[tuple[str, float], list[int]] = {}
    for k, (flank, torque) in enumerate(zip(scope.flanks, scope.torques, strict=True)):
        made.setdefault((flank, round(torque, 3)), []).append(k)
    return list(made.values())


def foretold(plain: System, wider: System, made: Sequence[Recordings]) -> float:
    """By how much less of a misfit the recordings of each condition of ``made`` are foretold by all others under
    ``wider`` than under ``plain``, summed over the conditions.

    What is foretold is as uncertain as the others leave it. The misfit of one condition about that is what it adds to
    the misfit of the others when all are fitted at once (the chain rule of normal densities), so a claim that shows
    under one condition only counts as it does there, and one of which two conditions tell opposite sizes counts less
    than nothing: of two that know it equally well, 2 I a b with the sizes a, b and their information I. Derived here.
    What was known beforehand is seen under every condition and foretold by none, and what contradicts it counts once.
    """
    every = plain.misfit - wider.misfit
    out = plain.strain - wider.strain
    for held in made:
        rest = [k for k in range(len(plain.target)) if k not in held]
        out += every - (plain.of(rest).misfit - wider.of(rest).misfit)
    return out


def with_and_without(model: Model, scenes: list[Scene], linear: Linear, k: int) -> tuple[System, System]:
    """The systems without claim ``k`` and with it.

    A claim that bends with its size (the set-up with it is simulated, or its tooth may lose touch where it is pitted)
    stands there by its whole effect: of a gap that has closed the next micrometre is like softer teeth, the whole of it
    is not. A shape is then held as it stands: a part of a short recording would lead straight lines to others.
    """
    claim, layout = model.claims[k], linear.layout
    mine = layout.places(k) + layout.form_places(model, k)
    plain = linear.system.without(mine)
    if not claim.simulated:
        return plain, linear.system
    if claim.place.tooth is None:
        whole = model.change(scenes, claim, claim.values, but=claim)
    else:
        whole = whole_effect(model, scenes, claim)
    held = [*claim.values[: claim.physics.amplitudes], *(0.0,) * (len(claim.values) - claim.physics.amplitudes)]
    columns, target = [], []
    for noise, effect, white, y in zip(linear.noises, whole, linear.white_of(k), linear.system.target, strict=True):
        columns.append(noise.whitened(effect[:, None]))
        target.append(y - white @ held + columns[-1][:, 0])
    plain = replace(plain, target=target)
    return plain, plain.with_columns(columns)


def elsewhere(search: Fit, k: int) -> float | None:
    """By how much less of a misfit each torque and flank is foretold by the others with claim ``k``; None where all
    recordings were made under one condition."""
    made = conditions(search.model.scope)
    if len(made) < 2:
        return None
    return foretold(*with_and_without(search.model, search.scenes, search.linear, k), made)


def swells(linear: Linear, model: Model, k: int) -> bool:
    """Whether what claim ``k`` explains swells or fades along recordings: no gear does within minutes, and no encoder.

    Its columns times Legendre's polynomials 1 and 2 over every recording are weighed against the claim, beside all
    else and again without waves of unknown make near its own orders: those may have taken what a swell leaves there,
    and have, where a swell does most of what they do. What is slow, and a resonance in a run-up, is not steady by its
    nature.
    """
    claim = model.claims[k]
    if claim.physics.slow or (claim.physics.fixed_amplitudes and model.scope.run_ups):
        return False
    ramps = _ramps(linear, model, k)
    near = [
        linear.layout.foreign.start + column
        for wave in model.strangers
        if _beats(linear, model, claim, wave)
        for column in wave
    ]
    for gone in ([], near) if near else ([],):
        bare = linear.system.without(gone)
        gain = linear.system.without([*gone, *linear.layout.places(k)]).misfit - bare.misfit
        swelling = bare.misfit - bare.with_columns(ramps).misfit
        theirs = bare.misfit - linear.system.misfit
        if swelling > max(LEAST_SWELLING_GAIN, SWELLING_GAIN_PART * gain, MOST_OF * theirs):
            return True
    return False


def _ramps(linear: Linear, model: Model, k: int) -> list[FloatArray]:
    """White columns (n_k, q) of what claim ``k`` does where it swells along each recording by itself."""
    mine, columns = linear.layout.claims[k], []
    for j, (noise, own, one) in enumerate(zip(linear.noises, linear.columns, model.observed, strict=True)):
        amplitudes = own.part(mine)[:, : model.claims[k].physics.amplitudes]
        x = one.samples.along[:, None]
        ramps = noise.whitened(np.concatenate((amplitudes * x, amplitudes * (1.5 * x**2 - 0.5)), axis=1))
        wide = np.zeros((ramps.shape[0], len(linear.noises) * ramps.shape[1]))
        wide[:, j * ramps.shape[1] : (j + 1) * ramps.shape[1]] = ramps
        columns.append(wide)
    return columns


def _beats(linear: Linear, model: Model, claim: Claim, wave: Sequence[int]) -> bool:
    """Whether a ``wave`` of unknown make, by its foreign columns, is so near a whole order of a claim's shaft in any
    recording that a swell of the claim would look like it, or is no wave of one frequency."""
    if len(wave) % 2:
        return True
    shaft = claim.place.gear or 0
    for own, one in zip(linear.columns, model.observed, strict=True):
        pairs = [
            own.part(linear.layout.foreign.start + np.array(two)) for two in zip(wave[::2], wave[1::2], strict=True)
        ]
        turns = float(np.ptp((one.samples.theta_1, one.samples.theta_2)[shaft])) / (2.0 * math.pi)
        for pair in pairs:
            if not np.any(pair):
                continue
            if np.ptp(np.sum(pair**2, axis=1)) > ONE_SIZE:
                return True
            cycles = abs(float(np.ptp(np.unwrap(np.arctan2(pair[:, 1], pair[:, 0]))))) / (2.0 * math.pi)
            if abs(cycles / turns - round(cycles / turns)) * turns < WAVE_OFF_LINE_CYCLES:
                return True
    return False


def without_dear(search: Fit) -> Fit:
    """Without every claim that does not pay on held-out torques and flanks, the dearest first, and what is not steady;
    the same ``search`` where none went."""
    needed: set[tuple[object, ...]] = set()
    while True:
        dear = [
            (cost, k)
            for k, claim in enumerate(search.model.claims)
            if claim.key not in needed and (cost := _cost(search, k)) is not None
        ]
        if not dear or search.over:
            return search
        _, k = max(dear)
        claim = search.model.claims[k]
        search.step(f"fitting without {claim.physics.name.replace('_', ' ')}")
        try:
            search = without_idle(relaxed(settled(joined(search, [], instead=[k]))))
        except GearpolyError:
            # Gears that cannot run without it need it.
            needed.add(claim.key)


def _cost(search: Fit, k: int) -> float | None:
    """What claim ``k`` costs in misfit on conditions that its fit never saw; None where it pays there and is steady."""
    made = conditions(search.model.scope)
    plain, wider = with_and_without(search.model, search.scenes, search.linear, k)
    cost = -foretold(plain, wider, made) if len(made) > 1 else 0.0
    return None if cost <= 0.0 and not swells(search.linear, search.model, k) else cost


def held_places(search: Fit) -> list[int]:
    """Parameters that no part of the recordings tells the other: of what goes on over a whole recording and never
    repeats (slow claims, and wandering), and the shapes of single teeth."""
    layout, claims = search.linear.layout, search.model.claims
    wandering = sum(search.model.scope.wanders)
    slow = [p for k, claim in enumerate(claims) if claim.physics.slow for p in layout.places(k)]
    last = layout.foreign.stop - wandering - search.model.slow_courses
    return [*range(last, layout.foreign.stop), *slow, *shaped_teeth(search)]


def shaped_teeth(search: Fit) -> list[int]:
    """Parameters of the shapes of claims about single teeth, and of the doubt about their forms. A part of a recording
    sees such a tooth a few times and would move its edges farther than straight lines from the present ones hold; they
    are foretold as they stand. In four turns twelve knots of form took 0.325 um of unseen samples for 0.316 um."""
    layout = search.linear.layout
    out: list[int] = []
    for k, claim in enumerate(search.model.claims):
        if claim.place.tooth is not None:
            out += layout.places(k)[claim.physics.amplitudes :] + layout.form_places(search.model, k)
    return out
