"""Nothing is named against unseen data: what all names, each of them and any two are worth where no fit looked.

Every recording is cut into blocks, and each is foretold from all the others. Only what is continuous is fitted again;
claims are refused here, never chosen.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.noise import pooled_level
from gearpoly.diagnose.blocks import Blocks, gained
from gearpoly.diagnose.conditions import held_places, shaped_teeth, with_and_without
from gearpoly.diagnose.exchange import without_idle
from gearpoly.diagnose.fit import Fit, joined, settled
from gearpoly.diagnose.heldout import Checked, Rms, cross_validated, foretold_to, held
from gearpoly.diagnose.kept import Kept, come_back
from gearpoly.diagnose.linear import Linear, whole_effect
from gearpoly.diagnose.system import Mask, System
from gearpoly.diagnose.teeth_scale import of_pitches
from gearpoly.diagnose.weigh import gain_without
from gearpoly.errors import GearpolyError
from gearpoly.infer.prior import SHAPED_BY_KEYS, order_of
from gearpoly.physics.base import Claim
from gearpoly.units import FloatArray, IntArray

SURELY = 2.0
"""Standard errors by which unseen data must fit better with two claims that cancel than without both: one in fifty
refused by chance."""

LEAST_BLOCKS, MOST_BLOCKS, WHOLE_TURN_BLOCKS_FROM = 8, 12, 3
"""Blocks of a recording: at least so many, or what is slow is not foretold at its ends; at most so many, since more
tell nothing new. From so many turns of the gear in question on, where nothing slow is claimed, a block is a whole turn
or more: a wave that only one turn has is then not foretold by the rest of that turn."""

ONCE, SEEN_AGAIN = 0.9, 25.0
"""Part of what a tooth does that one pass of it holds, from which on it came into mesh once, since a second pass at the
end of a recording may be cut; and misfit in the other passes from which on it was seen again all the same, five
standard deviations: at the bottom of a pit one sample of 2880 held more than nine parts of ten, and three other passes
57. A judgement."""

LACK_OF_FIT = 1.2
"""Times the rms expected of unseen samples, mostly noise, that they may be left at beside names: what repeats and is
not understood may look like any of them. Of 320 sets of names in six runs of the proof, held against noise alone, the
false ones that stood above 1.1 did so at 1.24, 1.26, 1.28 and from 3.3 on, the right ones at 1.14, 1.17 and 1.19, and
at 1.23 and 3.1 where slow waves end within a recording; coarse encoders aside, whose stated noise leaves their steps
out."""

UNFINISHED = 1.05
"""Mean square of what is left of unseen samples, over that of noise, from which on no physics of all teeth is named by
a search that time stopped, nor one of a tooth that explains less than is left: what was not asked may make it. Of a
file with another pressure angle 4.3 um of relief left 1.11, and a centre distance, which was not asked any more, 1.01;
spalls and a missing tip of pairs that were not the declared ones left 1.32 to 1.46. A missing tip that was true left
1.18, and explained twice as much. These were plain mean squares; with the covariance of the prediction it is less:
beside waves of a drive 1.02 in the place of 1.10, by which a right pitch had lost its name."""

CANCELLING_COSINE = -0.5
"""Cosine between what two claims do, from which on they cancel in good part: neither is then worth more than both."""


ROSE = 1e-3
"""Part of itself by which the rms of unseen samples may be larger with a name than without: what is told to four
figures. Of 206 names of nine runs of the proof those of index deviations apart, which teeth as built may take over,
it was larger with three: by 6e-5 with a right one, by 5e-3 and 3e-2 with two false ones."""

WANDERING_NOISE_DENSITY, FEWEST_CYCLES_IN_WANDER = 100.0, 4.0
"""Density of a recording's noise at a wave's order over its median from which the noise wanders there, and how often
the wave has to come round then: the few lines of a random walk below that are as uneven as chance makes them, and
blocks between seen ones are foretold by their neighbours. Of 18 names of waves that a bench knows it was 0.2 to 3; of a
false one, 0.38 mm once per turn of 2.7 in a walk of millimetres, 6000."""

RMS_LEFT_WITHOUT_CLAIM = 0.9
"""Part of the rms of unseen samples that has to be left without one of several claims, or none of them alone makes it
larger. A judgement."""


def without_unfinished(search: Fit) -> tuple[Fit, list[tuple[Claim, float]]]:
    """A search that time has stopped without its claims about all teeth, where more is left than noise, and without
    those about one tooth that explain less than is left; and what they did, in mm rms."""
    number = _numbers(search)
    if Blocks(_held(search), number).unseen().misfit / number.size <= UNFINISHED:
        return search, []
    search, of_all = _without(search, [k for k, one in enumerate(search.model.claims) if one.physics.mean_tooth])
    left = search.linear.system.beyond
    teeth = [k for k, one in enumerate(search.model.claims) if one.place.tooth is not None]
    search, of_one = _without(search, [k for k in teeth if gain_without(search, k) <= left])
    return search, of_all + of_one


def checked(
    search: Fit,
    begun: Kept,
    start: Linear,
    comparison: Comparison,
    *,
    unfinished: Sequence[tuple[Claim, float]] = (),
    keys: bool = False,
) -> tuple[Fit, Checked | None]:
    """Take back of the claims what unseen data speak against: one or two that make them fit no better, one by one those
    that make their rms larger, and then all where the declared pair or as-built teeth alone do as well, or where the
    rms of unseen samples that is told would be larger with names than without by more than it is known to, or is well
    above the noise. Where ``keys`` of the pair file were put right, what all teeth do is taken back too; ``unfinished``
    claims were before, since time had ended. ``start`` is the fit of the state ``begun`` before any claim. The fit
    without them, and what was found; None where nothing is claimed."""
    refused: list[tuple[Claim, float]] = []
    if not search.model.claims and not unfinished:
        return search, None
    search, of_keys = _without(search, [k for k, one in enumerate(search.model.claims) if keys and _as_keys_do(one)])
    search, unchecked = _without(search, [k for k, one in enumerate(search.model.claims) if not repeats(search, one)])
    while (these := _idle(search)) is not None:
        search, gone = _without(search, these)
        if not gone:
            break
        refused += gone
    while (worst := next((k for k in (_runs_off(search, start), _rises(search)) if k is not None), None)) is not None:
        search, gone = _without(search, [worst])
        if not gone:
            break
        refused += gone
    number = _numbers(search)
    model = search.model
    before_any, start = start, start.under(search.noises)
    declared = Blocks(_declared(search, start, comparison), number).unseen()
    as_built = Blocks(start.system, number).unseen()
    named = Blocks(_held(search), number).unseen()
    gains = [gained(one, named, number) for one in (declared, as_built)]
    rms = _told(search, before_any)
    # How probable names are was weighed before: here they must only not be worse where no fit looked.
    larger = rms[1] > rms[0] * (1.0 + _doubt(search))
    worse = any(gain <= 0.0 for gain, _ in gains) or larger
    noise = pooled_level(search.noises, [scene.samples.size for scene in search.scenes])
    expected = foretold_to(search.linear, [one.fit for one in model.observed], noise, hold=held_places(search))
    if rms[1] > LACK_OF_FIT * expected or worse:
        refused += [(one, model.rms_of(search.scenes, one)) for one in model.claims]
        # Where none was left either: what was fitted about it stays fitted to it.
        search = come_back(begun, search)
    least = min(gains)
    count = number.size
    return search, Checked(
        declared=declared.misfit / count,
        as_built=as_built.misfit / count,
        named=named.misfit / count,
        std=least[1] / count,
        rms=rms,
        noise=noise,
        expected=expected,
        larger=larger,
        refused=tuple(refused),
        unchecked=tuple(unchecked),
        unfinished=tuple(unfinished),
        of_keys=tuple(of_keys),
    )


def _without(search: Fit, these: Sequence[int]) -> tuple[Fit, list[tuple[Claim, float]]]:
    """Without the claims of these numbers, everything fitted again, and each with the rms in mm of what it did. The
    same and none where gears cannot run without them."""
    if not these:
        return search, []
    model = search.model
    search.step("fitting without " + ", ".join(model.claims[k].physics.name.replace("_", " ") for k in these))
    gone = [(model.claims[k], model.rms_of(search.scenes, model.claims[k])) for k in these]
    try:
        return without_idle(settled(joined(search, [], instead=these))), gone
    except GearpolyError:
        return search, []


def _idle(search: Fit) -> tuple[int, ...] | None:
    """The claim with which unseen data fit worse, or two that cancel and make it no better for sure; None where all
    pay."""
    model, number = search.model, _numbers(search)
    known = [k for k, one in enumerate(model.claims) if repeats(search, one)]
    if not known:
        return None
    layout, whole, held_at = search.linear.layout, Blocks(_held(search), number), shaped_teeth(search)

    def mine(k: int) -> list[int]:
        places = layout.places(k) + layout.form_places(model, k)
        return [place - sum(one < place for one in held_at) for place in places if place not in held_at]

    worst: tuple[float, tuple[int, ...]] = (0.0, ())
    for k in known:
        if model.claims[k].simulated:
            _, wider = with_and_without(model, search.scenes, search.linear, k)
            gain = Blocks(wider, number).worth([wider.size - 1])[0]
        else:
            gain = whole.worth(mine(k))[0]
        worst = min(worst, (gain, (k,)))
    if worst[1]:
        return worst[1]
    effects = {}
    for k in known:
        values = np.array(model.claims[k].values)
        effects[k] = np.concatenate([white @ values for white in search.linear.white_of(k)])
    for j, k in combinations(known, 2):
        size = math.sqrt(float(effects[j] @ effects[j]) * float(effects[k] @ effects[k]))
        if float(effects[j] @ effects[k]) >= CANCELLING_COSINE * size:
            continue
        gain, std = whole.worth([*mine(j), *mine(k)])
        if gain <= SURELY * std:
            return j, k
    return None


def _told(search: Fit, start: Linear) -> tuple[float, float]:
    """The plain rms in mm of held-out samples, colour and all, with as-built teeth alone and with the claims: what only
    whitening makes better is not seen."""
    masks = [one.fit for one in search.model.observed]
    return foretold_best(start, masks, hold=[]).unseen, unseen_of(search).unseen


def unseen_of(search: Fit) -> Rms:
    """The rms in mm of what the whole fit leaves of held-out samples."""
    return foretold_best(search.linear, [one.fit for one in search.model.observed], hold=held_places(search))


def foretold_best(linear: Linear, masks: list[Mask], *, hold: list[int]) -> Rms:
    """Rms in mm of what one part of the samples (``masks``) leaves of the other, parameters ``hold`` as the whole has
    them; with waves that no pair makes or without them, whichever leaves less: half of a short recording may tell a
    slow wave so badly that the other half is further off with it. Beside another wheel's wave of 1 um 40 um of pitch
    lost their name, with 1.99 um of unseen rms, and 1.38 um without that wave."""
    waves = sorted(set(range(linear.layout.foreign.start, linear.layout.foreign.stop)) - set(hold))
    both = [cross_validated(linear, masks, hold=hold), cross_validated(linear, masks, leave=waves, hold=hold)]
    return min(both, key=lambda one: one.unseen)


def _runs_off(search: Fit, start: Linear) -> int | None:
    """Of several claims with which the rms of unseen samples is larger than before any, the one without which it is
    least; None where it is not larger, or no claim alone makes it so: of a printed wheel a right runout was refused
    together with a wrong spall."""
    model = search.model
    if len(model.claims) < 2:
        return None
    without, whole = _told(search, start)
    if whole <= without * (1.0 + _doubt(search)):
        return None
    each = _without_each(search)
    best = int(np.argmin(each))
    return best if each[best] < RMS_LEFT_WITHOUT_CLAIM * whole else None


def _rises(search: Fit) -> int | None:
    """The claim with which the rms of unseen samples is larger than without it, the one by most; None where there is
    none. Whether index deviations are a fault of one tooth or as all teeth were made, unseen samples do not tell."""
    model = search.model
    masks = [one.fit for one in model.observed]
    least, worst = cross_validated(search.linear, masks, hold=held_places(search)).unseen / (1.0 + ROSE), None
    for k, without in enumerate(_without_each(search)):
        if without < least and not of_pitches(model, model.claims[k]):
            least, worst = without, k
    return worst


def _without_each(search: Fit) -> list[float]:
    """The rms in mm of unseen samples without each claim, all else fitted again."""
    masks, layout, hold = [one.fit for one in search.model.observed], search.linear.layout, held_places(search)
    out = []
    for k in range(len(search.model.claims)):
        mine = layout.places(k) + layout.form_places(search.model, k)
        rest = [place for place in hold if place not in mine]
        out.append(cross_validated(search.linear, masks, leave=mine, hold=rest).unseen)
    return out


def _as_keys_do(claim: Claim) -> bool:
    """Whether a wrong key of the gears' shape may look like a claim: what all teeth of a gear have, and where they
    stand to each other."""
    shaped = claim.physics.mean_tooth and claim.place.gear is not None
    return shaped or claim.physics.name in SHAPED_BY_KEYS


def _doubt(search: Fit) -> float:
    """Relative standard error of an rms of all unseen samples, were they normal: 1 / sqrt(2 n)."""
    unseen = sum(int(np.count_nonzero(~one.fit)) for one in search.model.observed)
    return 1.0 / math.sqrt(2.0 * max(1, unseen))


def _held(search: Fit) -> System:
    """The fit of everything, shapes of single teeth as they stand."""
    return held(search.linear, shaped_teeth(search)).system.without(shaped_teeth(search))


def _declared(search: Fit, start: Linear, comparison: Comparison) -> System:
    """What the declared simulation leaves of the recordings, beside the same nuisances as all else has."""
    at = slice(start.layout.nuisance.start, start.layout.foreign.stop)
    left = [one.residual for one in comparison.aligned]
    return replace(
        start.system,
        white=[a.only(np.arange(at.start, at.stop)) for a in start.system.white],
        target=[noise.whitened(rest) for noise, rest in zip(search.noises, left, strict=True)],
        precision=start.system.precision[at, at],
        prior=start.system.prior[at],
    )


def _numbers(search: Fit) -> IntArray:
    """The block (n,) of every sample of all recordings in a row."""
    claims = search.model.claims
    slow = any(one.physics.slow for one in claims)
    gears = [one.place.gear for one in claims if one.place.gear is not None and not one.physics.mean_tooth]
    slowest = max(gears, key=lambda gear: search.model.scope.gears[gear].z, default=None)
    out, first = [], 0
    for scene in search.scenes:
        along = _turned(search, scene.samples.number, slowest)
        turns = int(along[-1])
        count = LEAST_BLOCKS if slow or slowest is None or turns < WHOLE_TURN_BLOCKS_FROM else min(turns, MOST_BLOCKS)
        out.append(first + np.minimum((along * (count / along[-1])).astype(np.int64), count - 1))
        first += count
    return np.concatenate(out)


def _turned(search: Fit, k: int, gear: int | None) -> FloatArray:
    """Turns (n,) of a gear, or of the driven one, since the beginning of recording ``k``, never less than before."""
    samples = search.scenes[k].samples
    angle = samples.theta_1 if gear == 0 else samples.theta_2
    return np.asarray(np.maximum.accumulate(angle - np.min(angle)) / (2.0 * math.pi))


def _comes_round(search: Fit, k: int, claim: Claim, *, gear: int) -> bool:
    """Whether recording ``k`` holds a turn of a claim's ``gear``, and so many waves of it as its noise asks for."""
    turns, noise, order = float(_turned(search, k, gear)[-1]), search.noises[k], order_of(claim) or 1.0
    there = float(np.interp(order / search.model.scope.gears[gear].z, noise.frequency, noise.density))
    wanders = there > WANDERING_NOISE_DENSITY * float(np.median(noise.density))
    return turns >= 1.0 and (not wanders or order * turns >= FEWEST_CYCLES_IN_WANDER)


def repeats(search: Fit, claim: Claim) -> bool:
    """Whether what a claim is about came more than once: its tooth into mesh, its gear round; what is the same at every
    mesh, or goes on slowly, is seen in every part of a recording."""
    gear, tooth = claim.place.gear, claim.place.tooth
    if gear is None or claim.physics.mean_tooth or claim.physics.slow:
        return True
    if tooth is None:
        return any(_comes_round(search, k, claim, gear=gear) for k in range(len(search.scenes)))
    effects = search.model.change(search.scenes, claim, claim.values, but=claim)
    if not any(map(np.any, effects)):  # a tooth that has left the mesh: only the whole tells
        effects = whole_effect(search.model, search.scenes, claim)
    z = search.model.scope.gears[gear].z
    passes = []
    for scene, noise, effect in zip(search.scenes, search.noises, effects, strict=True):
        angle = scene.samples.theta_1 if gear == 0 else scene.samples.theta_2
        turn = np.floor(angle / (2.0 * math.pi) - tooth / z + 0.5).astype(np.int64)
        passes += np.bincount(turn - np.min(turn), (effect / noise.level) ** 2).tolist()
    again = sum(passes) - max(passes)
    return bool(again > SEEN_AGAIN or max(passes) < ONCE * sum(passes))
