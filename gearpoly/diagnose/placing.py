"""Where the teeth are, of what the declared pair's curve leaves open: found by fitting teeth as they were built."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from gearpoly.compare.noise import Noise
from gearpoly.diagnose.both_flanks import turns_told
from gearpoly.diagnose.fit import Fit, settled, shared
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.relieved import relieved
from gearpoly.diagnose.shortened import PLACING_SAMPLES, in_state_of, shortened
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim
from gearpoly.physics.eccentricity import PHYSICS as ECCENTRICITY
from gearpoly.physics.place import Place
from gearpoly.threads import each
from gearpoly.units import FloatArray

PHASES_TRIED, UNLOADED_PHASES_TRIED = 8, 16
"""Phases of a pitch that are tried where the curves do not place the teeth, of loaded teeth and of unloaded ones. These
hand over at once: of a 17/22 of module 4 with 0.3 um of noise fits came to their end from 3 of 32 places alone, and of
eight none was among them."""

ELSEWHERE = 5
"""Other places in the hunting cycle that are tried where the curves leave several."""

TRIAL_ROUNDS = (2, 6)
"""Rounds of simulating and fitting at a place, first at all and then at those that may still be best."""

HOPEFUL_PLACE_MISFIT, HOPEFUL_PHASE_MISFIT = 1.5, 1.15
"""Misfit over the least at which a place, or a phase of a pitch, may still be best after the first trial: of a pair
of 24 and 36 teeth the right tooth then had 1.28 times the least, of an unloaded one of 17 and 22 the wrong phases had
1.2 times or more."""

LOST = 2.0
"""Misfit beyond noise over that of noise alone from which a place is doubted: laws and what is missing leave less."""

CLOSELY = 6
"""Places that are tried closely at most, the best of the first trial and the stated one."""

CLOSELY_EACH = 3
"""Places that are tried closely with each of several claims. Of 16 claims about two printed pairs the first of eight
was the best each time; where noise makes all alike, to try all took 30 s of 70."""

OTHERS_CLOSELY = 3
"""Other claims that are tried closely in the stead of one, those that do best of the first trial. Of a printed 13/40
and a loaded 17/22 with seven others each, the best was one of the three, or within 6 of it in misfit; the rest were 60
to 330 behind the claim, where 10 decide, and to try them all closely took a third of 50 s."""

OTHER_CLAIMS_SAMPLES = (1500, PLACING_SAMPLES[1])
"""Samples of a recording on which other claims are tried, at first and then closely. Of a printed 13/40 with two
recordings of 3640 samples the first trial took 27 s with all of them and 17 s with these, and the three claims that did
best were the same."""

BETTER_PLACE_GAINS = 10.0, 0.005
"""Misfit, and part of the misfit, by which another place must be better than the stated one: more than three standard
deviations, and more than what a fit leaves undone."""

MOVES = 4
"""Times that a place told by eccentricities is mended: they bend the curve, so the first is not always the last."""


def placed(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> Model:
    """The ``model`` where teeth as they were built fit best: the tooth, where the curves leave several, and the place
    within a pitch, where they are flat. Raises what ``Fit.begun`` does."""
    pitch = model.scope.gears[1].tau
    if not model.phased or _lost(model, foreign, step):
        step("placing the teeth within their pitch")
        # Every tooth hands over at the same place of its pitch, also beside a wrong one: the nearer way round.
        ways = sorted(_phases(model, phases_tried(model)), key=abs)
        # Reliefs that nobody declared hand over elsewhere: they may be what the curve lacks, not the place.
        model = _best_of(model, foreign, ways, hopeful=HOPEFUL_PHASE_MISFIT, besides=relieved(model))
    model = _turned(model, foreign, step)
    if model.elsewhere:
        step("telling the teeth apart")
        model = _told_apart(model, foreign, step, pitch)
    return model


def only_teeth_tell(model: Model) -> bool:
    """Whether nothing but the teeth themselves tells where a pitch begins: nothing bends, and the curve is flat."""
    return not model.phased and not model.scope.under_torque


def phases_tried(model: Model) -> int:
    """Phases of a pitch at which a fit is begun, so that one of them leads to its end."""
    return PHASES_TRIED if model.scope.under_torque else UNLOADED_PHASES_TRIED


def _phases(model: Model, many: int) -> list[float]:
    """Ways in rad of driven rotation that move the teeth to each of so many phases of a pitch, rising."""
    return [k * model.scope.gears[1].tau / many for k in range(1 - many // 2, many // 2 + 1)]


def _turned(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> Model:
    """With the whole turns between recordings of either flank that no encoder has counted, where uninspected teeth
    tell."""
    mate = 0 if model.turns_of == "driven" else 1
    if model.turns_of is None or len(model.as_built.flanks) < 2 or not model.as_built.gears[mate].graded:
        return model
    step("counting turns between the flanks")
    trial, columns = shortened(model, foreign, few=PLACING_SAMPLES[-1])
    fit = Fit.begun(trial, columns, step, trial=TRIAL_ROUNDS[-1])
    return model.turned(turns_told(fit.model, fit.scenes, fit.linear))


def _told_apart(model: Model, foreign: list[FloatArray], step: Callable[[str], None], pitch: float) -> Model:
    """The ``model`` moved by whole ``pitch``es in rad of driven rotation to the teeth that fit best."""
    if any(model.scope.inspected):
        others = [-by if model.phased else -round(by / pitch) * pitch for by in model.elsewhere[:ELSEWHERE]]
        return _best_of(model, foreign, list(dict.fromkeys((0.0, *others))), hopeful=HOPEFUL_PLACE_MISFIT)
    if not _eccentric(model):
        return model
    before: tuple[Model, Fit] | None = None
    for _ in range(0 if model.budget.over else MOVES + 1):
        trial, columns = shortened(model, foreign, few=PLACING_SAMPLES[-1])
        # What a wrong place lacks is another wave on either flank, as long as they may err each for itself. Far from
        # rest neither place is judged rightly, nor told.
        fit = settled(shared(Fit.begun(trial, columns, step, trial=TRIAL_ROUNDS[-1])))
        # It was told to first order, and eccentricities bend the curve.
        if before is not None and _misfit(fit, by=before[1]) > _misfit(before[1], by=before[1]) - BETTER_PLACE_GAINS[0]:
            return before[0]
        by = off_by(fit)
        if by == 0:
            break
        before, model = (model, fit), _other_teeth(model, by * pitch)
    return model


def _eccentric(model: Model) -> bool:
    """Whether a gear is declared eccentric."""
    return any(model.scope.section(gear).eccentricity is not None for gear in (0, 1))


def well_placed(model: Model, begin: Callable[[Model], Fit]) -> Fit:
    """The fit of whole recordings that ``begin`` begins, begun again elsewhere in the hunting cycle as long as declared
    eccentricities are told to stand there and it then fits better: shortened recordings do not tell those of a few
    tenths of a micrometre. Raises what ``begin`` does at the first place."""
    fit = begin(model)
    if not model.elsewhere or any(model.scope.inspected) or not _eccentric(model):
        return fit
    pitch = model.scope.gears[1].tau
    for _ in range(MOVES):
        by = 0 if fit.over else off_by(fit)
        if by == 0:
            break
        model = _other_teeth(model, by * pitch)
        try:
            there = begin(model)
        except GearpolyError:  # gears that jam where they do not stand
            break
        if _misfit(there, by=fit) > _misfit(fit, by=fit) - BETTER_PLACE_GAINS[0]:
            break
        fit = there
    return fit


def _other_teeth(model: Model, by: float) -> Model:
    """All ``by`` rad of driven rotation further on, about teeth of which nothing is fitted yet."""
    return replace(model, built=np.zeros_like(model.built)).moved(by)


def _misfit(fit: Fit, *, by: Fit) -> float:
    """Misfit of a ``fit`` under the noise and what is known of teeth of another one."""
    return fit.linear.under(by.noises, by.model.as_built).system.misfit


def off_by(fit: Fit) -> int:
    """Pitches by which the teeth of a trial ``fit`` stand elsewhere in the hunting cycle, told by the declared
    eccentricities of gears that nobody inspected: at a wrong place each seems to lack what turning its eccentricity by
    so many teeth adds, to first order."""
    model = fit.model
    declared = [model.scope.section(gear).eccentricity for gear in (0, 1)]
    scenes, pair = fit.scenes, fit.scenes[0].pair
    period = math.lcm(*(gear.z for gear in model.scope.gears))
    places = np.arange(period)
    lacking, units = [], []
    for gear, mounted in enumerate((pair.driving, pair.driven)):
        one = declared[gear]
        if one is None:
            continue
        # The driving gear turns counter-clockwise, the driven one clockwise.
        turn = (1j if gear == 0 else -1j) * model.scope.gears[gear].tau
        centre = one.amplitude_um * np.exp(1j * mounted.sign * math.radians(one.angle_deg))
        more = centre * (np.exp(turn * places) - 1.0)
        lacking += [more.real, mounted.sign * more.imag]
        units += [Claim(physics=ECCENTRICITY, place=Place(gear=gear), values=v) for v in ((1.0, 0.0), (0.0, 1.0))]
    effects = [model.change(scenes, unit, unit.values) for unit in units]
    white = [
        noise.whitened(np.column_stack([effect[k] for effect in effects])) for k, noise in enumerate(fit.linear.noises)
    ]
    score, information = fit.linear.system.scores(white)
    by = np.array(lacking)
    gain = 2.0 * score @ by - np.einsum("ik,ij,jk->k", by, information, by)
    best = int(np.argmax(gain))
    if gain[best] < BETTER_PLACE_GAINS[0]:
        return 0
    return best if best <= period // 2 else best - period


def _lost(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> bool:
    """Whether teeth that nobody inspected fit nowhere near the recordings where the mean tooth has placed them: under
    load those that lean together look like others that hand over elsewhere."""
    if all(model.scope.inspected) or not model.scope.under_torque:
        return False
    trial, columns = shortened(model, foreign, few=PLACING_SAMPLES[-1])
    system = Fit.begun(trial, columns, step, trial=TRIAL_ROUNDS[-1]).linear.system
    return system.beyond > LOST * system.samples


def anywhere(
    model: Model, foreign: list[FloatArray], starts: Sequence[Sequence[Claim]], *, phases: int = PHASES_TRIED
) -> list[tuple[float, float]]:
    """The least misfit of a pair with each of these claims, wherever in their pitch its teeth may stand, by the noise
    of the fit that leaves least, over all samples as far as some tell, and how far on in rad of driven rotation they
    stand then, of so many ``phases``. Infinite where it cannot run so anywhere."""
    places = list(product(_phases(model, phases), range(len(starts))))
    bare = replace(model, built=np.zeros_like(model.built))

    def misfits(places: Sequence[tuple[float, int]], rounds: int, few: int) -> dict[tuple[float, int], float]:
        trial, columns = shortened(bare, foreign, few=few)
        tried = zip(places, _fits(trial, columns, places, starts, rounds=rounds), strict=True)
        fits = {place: fit for place, fit in tried if not isinstance(fit, GearpolyError)}
        if not fits:
            return {}
        by = _least_noise(list(fits.values()))
        return {one: fit.linear.under(by).system.misfit for one, fit in fits.items()}

    best = [(math.inf, 0.0)] * len(starts)
    for rounds, few in zip(TRIAL_ROUNDS, OTHER_CLAIMS_SAMPLES, strict=True):
        found = {} if model.budget.over else misfits(places, rounds, few)
        best = [
            min(((v, way) for (way, k), v in found.items() if k == one), default=(math.inf, 0.0))
            for one in range(len(starts))
        ]
        # The first is what the others would stand for.
        ones = [0, *sorted(range(1, len(starts)), key=lambda k: best[k])[:OTHERS_CLOSELY]]
        places = [one for k in ones for one in _nearest({o: v for o, v in found.items() if o[1] == k})]
    whole = sum(one.samples.size for one in model.observed)
    part = sum(one.samples.size for one in shortened(bare, foreign, few=PLACING_SAMPLES[-1])[0].observed) / whole
    return [(misfit / part, way) for misfit, way in best]


def _least_noise(fits: Sequence[Fit]) -> list[Noise]:
    """The noise of the fit that leaves least, by which misfits compare: beside teeth that stand wrongly what they leave
    passes for noise, under which all places are alike."""
    return min((fit.noises for fit in fits), key=lambda one: sum(noise.level**2 for noise in one), default=[])


def _nearest(found: dict[tuple[float, int], float]) -> list[tuple[float, int]]:
    """The places that may still be best after a first trial, of their misfits: few of those that are nearly as good as
    the best."""
    most = HOPEFUL_PHASE_MISFIT * min(found.values(), default=math.inf)
    return sorted((one for one, misfit in found.items() if misfit <= most), key=lambda one: found[one])[:CLOSELY_EACH]


def _best_of(
    model: Model, foreign: list[FloatArray], ways: list[float], *, hopeful: float, besides: Sequence[Claim] = ()
) -> Model:  # fmt: skip
    """All moved by the one of ``ways`` in rad of driven rotation that fits best, as declared or with the claims
    ``besides``, unless the first does as well; only what is ``hopeful`` times the least or better after a first trial
    is looked at closely. Unloaded teeth stay as they were fitted there: they do not always settle so well again."""
    starts = [(), besides] if besides else [()]
    tried = dict.fromkeys(product(ways, range(len(starts))), 0.0)
    counted, fits = 0, list[Fit | GearpolyError]()
    for rounds, few in zip(TRIAL_ROUNDS, PLACING_SAMPLES, strict=True):
        closest = sorted(tried.values())[:CLOSELY][-1]
        most = min(closest, hopeful * min(tried.values()))
        tried = {one: 0.0 for one, misfit in tried.items() if one[0] == ways[0] or misfit <= most}
        trial, columns = shortened(model, foreign, few=few)
        counted = sum(one.samples.size for one in trial.observed)
        if trial.budget.over:
            return model
        fits = _fits(trial, columns, list(tried) if len(tried) > len(starts) else [], starts, rounds=rounds)
        by = _least_noise([fit for fit in fits if not isinstance(fit, GearpolyError)])
        for one, fit in zip(tried, fits, strict=False):
            if not isinstance(fit, GearpolyError):
                tried[one] = fit.linear.under(by).system.misfit
            elif starts[one[1]]:
                # What is supposed beside the declared pair may take more off its teeth than there is.
                tried[one] = math.inf
            else:
                raise fit
    best, _ = min(tried, key=lambda one: tried[one])
    least, stated = (min(misfit for (way, _), misfit in tried.items() if way == one) for one in (best, ways[0]))
    # Where no place fits, what is missing says more than the place does, and a reading of the zero counts.
    blind = model.stated and least > (1.0 + LOST) * counted
    clear = least < (
        stated / HOPEFUL_PLACE_MISFIT if blind else stated - BETTER_PLACE_GAINS[0] - BETTER_PLACE_GAINS[1] * stated
    )
    there = model.moved(best) if clear else model
    end = dict(zip(tried, fits, strict=False)).get((best if clear else ways[0], 0))
    if model.scope.under_torque or end is None or isinstance(end, GearpolyError):
        return there
    return in_state_of(there, end.model)


def _fits(
    trial: Model, columns: list[FloatArray], places: Sequence[tuple[float, int]], starts: Sequence[Sequence[Claim]], *,
    rounds: int,
) -> list[Fit | GearpolyError]:  # fmt: skip
    """The fit of a ``trial`` moved by each of ``places`` in rad of driven rotation with those of the ``starts`` that it
    numbers, or why gears cannot run so."""

    def fitted(place: tuple[float, int]) -> Fit | GearpolyError:
        way, which = place
        here = replace(trial, claims=tuple(starts[which])).moved(way)
        try:
            return Fit.begun(here, columns, lambda _: None, trial=rounds)
        except GearpolyError as error:
            return error

    return each(fitted, places)
