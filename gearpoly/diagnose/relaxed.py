"""A fit begun again from elsewhere, where it may rest in a local minimum.

Where recordings are long, another beginning is tried on a few thousand samples of each first. Most end no better, and
that shows there as well, in a fraction of the time; what does end better there is fitted to the whole recordings, and
they decide.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.fit import (
    BETTER_STATE_GAIN,
    PASSES,
    STEP_MOST_SHIFT_PITCHES,
    Fit,
    better_of,
    settled,
    shared,
    softly,
)
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.shortened import in_state_of, openings, shortened, sufficing
from gearpoly.diagnose.smoothing import smoothings
from gearpoly.diagnose.softness import with_best_law
from gearpoly.errors import GearpolyError
from gearpoly.units import FloatArray, IntArray

RELAXED = 8
"""Times that a fit begins once more with teeth alike."""

WORTH_WHILE = 0.01
"""Part of the misfit beyond noise by which another beginning must end better, too: where much is left without a cause
teeth creep on by a thousandth each time, and what is claimed next moves them all again. A spall of 40 um took 16 such
fits of whole recordings."""

FIRST_TRIAL_SAMPLES = 2500
"""Samples of a recording on which another beginning is tried first. They see a fall in misfit of ``BETTER_STATE_GAIN``
in four times as many as one of a quarter of it, which is what is asked of them."""


def from_declared(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> Fit:
    """The fit of the declared pair at all samples of whatever is open, from where it ends best. Raises what
    ``Fit.begun`` does.

    Of long recordings a part of the samples is fitted first, so that all of them have a step or two to go.
    """
    part = sufficing(model, foreign)
    if part is None:
        return _from_declared(model, foreign, step)
    with suppress(GearpolyError):  # what a part tells need not run at all; what was declared may
        model = in_state_of(model, _from_declared(*part, step).model)
    return shared(with_best_law(Fit.begun(model, foreign, step)))


def _from_declared(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> Fit:
    """The same at all samples that a model has.

    Where the zero moved farther than one step may go, teeth begin once more where it stands now: of a healthy pair with
    its zero off by a twentieth of a pitch 260 in misfit were left, of which a relief of 1.1 um was made.
    """
    fit = Fit.begun(model, foreign, step)
    graded = [gear for gear in (0, 1) if model.as_built.gears[gear].graded]
    now = fit.model
    if graded and abs(now.shift) > STEP_MOST_SHIFT_PITCHES * now.scope.gears[1].tau and not fit.over:
        # Teeth settled while the zero was still on its way. A few samples do not always tell.
        fit = _ended_better(fit, now.as_built.as_declared(now.built, graded), now.shift, better=BETTER_STATE_GAIN)
    return shared(with_best_law(relaxed(fit, first=True)))


def relaxed(fit: Fit, *, first: bool = False) -> Fit:
    """Begun once more with the slopes of a graded gear alike and no crowning, and with those teeth upright that lean as
    none of their fellows does, as long as that ends better; and with teeth as declared, as the ``first`` fit began.

    Without load a tooth touches here and there only, and where it does not, nothing tells any more that an earlier
    step was wrong: the fit rests with teeth that lean as none does. And what two crownings differ by is a slope and a
    late hand-over, so that fits creep along a bent valley in which both gears bulge as none of their grade does. Teeth
    that had settled for what was left out rest in a local minimum that its claim does not lead out of: a relief of
    0.4 um was made of that, of which the fit that began with declared teeth left nothing.
    """
    teeth = fit.model.as_built
    graded = [gear for gear in (0, 1) if teeth.gears[gear].graded]
    if not graded or fit.over:
        return fit
    tries = _Tries(fit)
    ways = [teeth.upright]
    if not all(scene.bends for scene in fit.scenes) or teeth.strained(fit.model.built):
        ways.insert(0, teeth.alike)
    if not first:
        tries.better_from(teeth.as_declared(fit.model.built, graded), fit.model.shift)
    for afresh in ways:
        for _ in range(RELAXED):
            now = tries.fit.model
            start = afresh(now.built, graded)
            if tries.fit.over or np.array_equal(start, now.built) or not tries.better_from(start, now.shift):
                break
    most = STEP_MOST_SHIFT_PITCHES * fit.model.scope.gears[1].tau
    for shift in (0.0, most, -most):
        now = tries.fit.model
        # Teeth that lean together hand over elsewhere, and to first order no column says that the zero is wrong.
        if teeth.strained(now.built) and not tries.fit.over:
            tries.better_from(teeth.alike(now.built, graded), shift)
    return tries.fit


@dataclass(frozen=True, kw_only=True, eq=False)
class Few:
    """A ``fit`` of few samples of each recording, those of the numbers ``where`` (n_k,), and which ``part`` of all they
    are."""

    fit: Fit
    where: list[IntArray]
    part: float


def few_of(whole: Fit) -> Few | None:
    """A fit of few samples that begins where the ``whole`` one stands; None where recordings are short, or gears cannot
    run so."""
    where = openings(whole.model, few=FIRST_TRIAL_SAMPLES)
    model, columns = shortened(whole.model, whole.foreign, few=FIRST_TRIAL_SAMPLES)
    sizes = [sum(one.samples.size for one in each.observed) for each in (model, whole.model)]
    if sizes[0] == sizes[1]:
        return None
    try:
        fit = Fit.begun(model, columns, lambda _: None, trial=PASSES)
    except GearpolyError:
        return None
    return Few(fit=fit, where=where, part=sizes[0] / sizes[1])


class _Tries:
    """Other beginnings of a ``fit``, tried on a few samples first; it is the best of them so far."""

    def __init__(self, fit: Fit) -> None:
        self.fit = fit
        self._few: Few | None = None
        self._begun = False

    def better_from(self, built: FloatArray, shift: float) -> bool:
        """Begin once more with teeth as ``built`` and this ``shift`` in rad of the driven zero; whether that ends
        better, and is kept."""
        better = max(BETTER_STATE_GAIN, WORTH_WHILE * self.fit.linear.system.beyond)
        if not self._begun:
            self._few, self._begun = few_of(self.fit), True
        few = self._few
        if few is not None:
            there = _ended_better(few.fit, built, shift, better=few.part * better)
            if there is few.fit:
                return False
            built, shift = there.model.built, there.model.shift
        whole = _ended_better(self.fit, built, shift, better=better)
        if whole is self.fit:
            return False
        self.fit = whole
        if few is not None:
            self._few = replace(few, fit=there)
        return True


def _ended_better(fit: Fit, built: FloatArray, shift: float, *, better: float) -> Fit:
    """Begun once more with teeth as ``built`` and this ``shift``, where that ends better; else the same ``fit``."""
    below = fit.linear.system.misfit - better

    def anew(one: Fit) -> Fit:
        return settled(softly(one.believing(built=built, shift=shift), smoothings(one.model)), below=below)

    return better_of(fit, anew, better=better)
