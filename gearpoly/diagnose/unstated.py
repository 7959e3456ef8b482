"""Gears of which the pair file states neither grade nor inspection: how far their teeth deviate is read off the
recordings, so that what all teeth have is no fault of one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from gearpoly.diagnose.as_built import IDEAL_TEETH_STD_UM, SIGMA_OVER_MEDIAN, GearPrior, make_as_built
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.prepare import BASE, base_prior, form_of
from gearpoly.diagnose.shortened import PLACING_SAMPLES, shortened
from gearpoly.diagnose.teeth_scale import COARSEST, USUAL, is_unstated, wider
from gearpoly.gear.nominal import nominal_gears
from gearpoly.keys.edit import gear_section
from gearpoly.units import FloatArray

UNSTATED_GRADE_ROUNDS = 8
"""Rounds of simulating and fitting. Unloaded teeth of a coarse gear touch elsewhere than declared ones: of a 13/40 of
module 1 with 3 um of noise the first round told 1.7 times the limits of grade 5, the eighth 2.8."""

OTHER_LIMITS = 2.0
"""Times the limits that the steps from tooth to tooth ask for which all others are taken: a grade is that of the worst
of pitch, total pitch and profile (ISO 1328-1:2013, 5.1), and one of them is often two grades better than another. Of
six drawn gears without faults, the once-per-turn wave of the pitches alone asked for up to 1.8 times. A judgement."""

TEETH_SEEN_OVER_DOUBT = 4.0
"""By how many times their own doubt the steps from tooth to tooth must deviate, or they say nothing of the teeth. What
wanders in five telescope logs makes it 0.9 to 3.0, teeth of six printed gears 19 to 70. Of a 24/36 of module 1 as grade
10 has it, beneath 3 um of noise, it was 4.7 and 5.9: taken as ideal, five names were made of their teeth."""

COARSER_GEAR_LIMITS = 1.2
"""Times the limits that it was first seen to have from which on a gear is taken to be coarser: half a grade."""

RANDOM_WAVE_CHANCE = 1e-3
"""Chance of a wave of random teeth that is taken for a fault of finer ones. Of 1000 gears each of 12 to 60 teeth, drawn
within a grade, none to 5 had such a wave. A pitch wave of 24 um had made grade 10 of a gear of grade 7, and had no
name."""

MOST_WAVES_LEFT_OUT, FEWEST_WAVES_COMPARED = 3, 5
"""Waves that are left out at most, and the fewest among which one can stand out."""


def as_seen(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> tuple[Model, tuple[str, ...]]:
    """The model with limits for gears that have none stated, as their own teeth have them, and what to tell of that.

    The median step from tooth to tooth decides, once per turn and waves that stand out left out: one tooth off its
    place, an eccentricity or a pitch wave is a fault as it is of graded gears. Raises what ``Fit.begun`` does.
    """
    unstated = [gear for gear in (0, 1) if is_unstated(model, gear)]
    if not unstated or model.budget.over:
        return model, ()
    step("asking how far the teeth deviate")
    fit = Fit.begun(
        *shortened(limited(model, dict.fromkeys(unstated, COARSEST)), foreign, few=PLACING_SAMPLES[-1]),
        step,
        trial=UNSTATED_GRADE_ROUNDS,
        limits_over_usual=COARSEST / USUAL,
    )
    seen = {gear: COARSEST * by for gear in unstated if (by := _over_limits(fit, gear)) > 0.0}
    found = like_its_mate(seen, unstated)
    says = tuple(_says(gear, by, own=gear in seen) for gear, by in found.items())
    return (limited(model, found, others=OTHER_LIMITS) if found else model), says


def as_fitted(fit: Fit) -> tuple[Model, tuple[str, ...]] | None:
    """The model of a ``fit`` of whole recordings with wider limits for gears that have none stated, where their teeth
    are coarser beside all that is fitted now than they were seen to be at first; None where they are not.

    The first look has few samples, and knows neither forms nor laws: of a printed 13/40 it left 4.3 times the noise and
    took grade 10 for grade 7, and one tooth of forty was named.
    """
    model = fit.model
    graded = [gear for gear in (0, 1) if is_unstated(model, gear) and model.as_built.gears[gear].graded]
    over = {gear: _over_limits(fit, gear) for gear in graded}
    if not any(by > COARSER_GEAR_LIMITS for by in over.values()) or fit.over:
        return None
    gears = [
        one if over.get(k, 0.0) <= COARSER_GEAR_LIMITS else wider(one, over[k])
        for k, one in enumerate(model.as_built.gears)
    ]
    scope = replace(model.scope, form=(form_of(gears[0]), form_of(gears[1])))
    says = tuple(_says(gear, gears[gear].single / _finer(model, gear).single, own=over[gear] > 0.0) for gear in graded)
    return replace(model, scope=scope, as_built=make_as_built((gears[0], gears[1]), model.as_built.flanks)), says


def _says(gear: int, by: float, *, own: bool) -> str:
    """A word on a gear of so many times the limits of grade 5, by its ``own`` teeth or by its mate's."""
    return (
        f"no grade of the {('driving', 'driven')[gear]} gear is stated, and "
        + (
            f"its teeth deviate as those of grade {grade_of(by)} do"
            if own
            else f"it is taken to be of grade {grade_of(by)} as its mate"
        )
        + ": what such teeth may have is not looked for; state a grade, or inspect it"
    )


def like_its_mate(seen: dict[int, float], unstated: Sequence[int]) -> dict[int, float]:
    """Limits by gear over those of grade 5, with those of its mate for a gear whose own teeth say nothing: the gears of
    a pair are made alike. Of a 13/40 of module 1 as grade 10 has it, 40 teeth told their grade beneath 3 um of noise
    and 13 did not, and two pitch waves of these were named."""
    return {gear: seen.get(gear, max(seen.values())) for gear in unstated} if seen else {}


def grade_of(by: float) -> int:
    """The grade, 1 or more, whose limits are so many times those of grade 5."""
    return max(1, BASE + math.ceil(2.0 * math.log2(by) - 1e-9))


def limited(model: Model, by: dict[int, float], *, others: float = 1.0) -> Model:
    """The model with limits of so many times those of grade 5 for these gears, and as many times that again for all
    ``others`` than the limit of single pitches."""
    gears = nominal_gears(model.declared)
    priors: list[GearPrior] = list(model.as_built.gears)
    for gear, times in by.items():
        priors[gear] = base_prior(gear_section(model.declared, gear), gears, gear, by=times, others=others)
    both = priors[0], priors[1]
    scope = replace(
        model.scope,
        inspected=(not both[0].graded, not both[1].graded),
        form=(form_of(both[0]), form_of(both[1])),
    )
    return replace(model, scope=scope, as_built=make_as_built(both, model.as_built.flanks))


def _over_limits(fit: Fit, gear: int) -> float:
    """Limits of a gear by the steps of its teeth over those that it was taken to have; 0 where these say nothing."""
    teeth, at = fit.model.as_built, fit.linear.layout.built
    built, covariance = fit.linear.system.solution[at], fit.linear.system.covariance[at, at]
    seen = [
        _step(
            teeth.pitch(built, flank, gear),
            _block(covariance, teeth.start(flank, gear), teeth.gears[gear].z),
            common=math.gcd(*(one.z for one in teeth.gears)),
        )
        for flank in teeth.flanks
    ]
    most = max(seen)
    return math.sqrt(3.0) * most / teeth.gears[gear].single if most > IDEAL_TEETH_STD_UM else 0.0


def _finer(model: Model, gear: int) -> GearPrior:
    """The gear as grade 5 has it."""
    return base_prior(gear_section(model.declared, gear), nominal_gears(model.declared), gear)


def _block(covariance: FloatArray, start: int, z: int) -> FloatArray:
    return covariance[start : start + z, start : start + z]


def _step(pitch: FloatArray, covariance: FloatArray, *, common: int = 1) -> float:
    """Standard deviation in um of the steps between teeth of these index deviations (z,), by their median, what they
    are known to (z, z) taken off; 0 where that is nearly all of it. ``common`` as in ``between``."""
    steps = between(pitch.size, common=common)
    scatter = SIGMA_OVER_MEDIAN * float(np.median(np.abs(without_waves(steps @ pitch))))
    doubt = math.sqrt(float(np.median(np.diag(steps @ covariance @ steps.T))))
    return math.sqrt(scatter**2 - doubt**2) if scatter > TEETH_SEEN_OVER_DOUBT * doubt else 0.0


def without_waves(steps: FloatArray) -> FloatArray:
    """Steps (z,) from tooth to tooth without the waves of which the largest has more of their power than that of any
    of as many random teeth, by Fisher's test (1929): P(g > x) <= n (1 - x)^(n - 1) for n waves."""
    waves = np.fft.rfft(steps)
    # A mean step is none, once per turn was left out, and half a wave per tooth has no phase.
    first, last = 2, (steps.size - 1) // 2
    for _ in range(MOST_WAVES_LEFT_OUT):
        power = np.abs(waves[first : last + 1]) ** 2
        count = int(np.count_nonzero(power))
        if count < FEWEST_WAVES_COMPARED:
            break
        part = float(np.max(power) / np.sum(power))
        if count * (1.0 - part) ** (count - 1) > RANDOM_WAVE_CHANCE:
            break
        waves[first + int(np.argmax(power))] = 0.0
    return np.asarray(np.fft.irfft(waves, steps.size))


def between(z: int, *, common: int = 1) -> FloatArray:
    """What makes of index deviations (z,) the steps from tooth to tooth (z,), without what is once per turn, and what
    every so many teeth have in ``common``: where tooth numbers of both gears have a common divisor, as many classes of
    teeth meet only each other, and how far these stand apart on either gear nothing tells."""
    angle = 2.0 * np.pi / z * np.arange(z)
    classes = (np.arange(z)[:, None] % common == np.arange(common)).astype(np.float64)
    once = np.column_stack((classes, np.cos(angle), np.sin(angle)))
    without = np.eye(z) - once @ np.linalg.pinv(once)
    return np.asarray((np.roll(np.eye(z), -1, axis=0) - np.eye(z)) @ without)
