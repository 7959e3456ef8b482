"""Where the teeth are, of what the declared pair's curve leaves open: found by fitting teeth as they were built."""

from __future__ import annotations

from collections.abc import Callable

from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.model import Model
from gearpoly.units import FloatArray

PHASES = 8
"""Phases of a pitch that are tried where the curves do not place the teeth."""

ELSEWHERE = 5
"""Other places in the hunting cycle that are tried where the curves leave several."""

TRIALS = (2, 6)
"""Rounds of simulating and fitting at each, first at all and then at those that may still be best."""

HOPEFUL, HOPEFUL_PHASE = 1.5, 1.15
"""Misfit over the least at which a place, or a phase of a pitch, may still be best after the first trial: of a pair
of 24 and 36 teeth the right tooth then had 1.28 times the least, of an unloaded one of 17 and 22 the wrong phases had
1.2 times or more."""

BETTER = 10.0, 0.005
"""Misfit, and part of the misfit, by which another place must be better than the stated one: more than three standard
deviations, and more than what a fit leaves undone."""


def placed(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> None:
    """Move ``model`` to where teeth as they were built fit best: the tooth, where the curves leave several, and the
    place within a pitch, where they are flat. Raises what ``Fit.begun`` does."""
    if model.elsewhere and _differ(model):
        step("telling the teeth apart")
        ways = [0.0, *(-by for by in model.elsewhere[:ELSEWHERE])]
        _best_of(model, foreign, step, ways, hopeful=HOPEFUL)
    if not model.phased:
        step("placing the teeth within their pitch")
        # Every tooth hands over at the same place of its pitch.
        ways = [k * model.scope.gears[1].tau / PHASES for k in range(PHASES)]
        _best_of(model, foreign, step, ways, hopeful=HOPEFUL_PHASE)


def _differ(model: Model) -> bool:
    """Whether anything is declared that makes one tooth another than the next."""
    sections = model.scope.file.driving, model.scope.file.driven
    return any(one.eccentricity is not None for one in sections) or any(model.scope.inspected)


def _best_of(
    model: Model, foreign: list[FloatArray], step: Callable[[str], None], ways: list[float], *, hopeful: float
) -> None:
    """Move all by the one of ``ways`` in rad of driven rotation that fits best, unless the first does as well; only
    what is ``hopeful`` times the least or better after a first trial is looked at closely."""
    kept, noises = model.kept(), None
    tried = dict.fromkeys(ways, 0.0)
    for rounds in TRIALS:
        least = min(tried.values())
        tried = {way: 0.0 for way, misfit in tried.items() if way == ways[0] or misfit <= hopeful * least}
        for way in tried if len(tried) > 1 else ():
            model.moved(way)
            fit = Fit.begun(model, foreign, step, trial=rounds)
            # By the same noise, so that the misfits compare.
            noises = noises or fit.noises
            tried[way] = fit.linear.under(noises).system.misfit
            model.restore(kept)
            model.moved(-way)
    best, stated = min(tried, key=lambda way: tried[way]), tried[ways[0]]
    if tried[best] < stated - BETTER[0] - BETTER[1] * stated:
        model.moved(best)
