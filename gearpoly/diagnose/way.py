"""The way of a fit towards rest: steps lengthened in bent valleys, and damped where contacts change on the way.

Damping is Levenberg's with Marquardt's scale (1944, 1963).
"""

from __future__ import annotations

import math

import numpy as np

from gearpoly.diagnose.system import System
from gearpoly.units import FloatArray

NEGLIGIBLE = 1.0
"""Fall in misfit below which a fit need not be repeated: a tenth of what any claim must gain."""

HALF_DONE = 0.01
"""The same as a part of the misfit beyond noise: while something large is missing, the rest need not be exact."""

SAME_WAY_COSINE, MOST_LENGTHENING = 0.8, 3.0
"""Cosine between two steps from which they go the same way, and then the most by which the second is lengthened:
reliefs against deflection lie in a bent valley, in which plain steps are too short."""

FIRST_DAMPING, DAMPING_AFTER_GOOD_STEP, DAMPING_AFTER_BAD_STEP = 0.01, 0.25, 8.0
"""Damping of the first step that is tried again, as a part of each parameter's own information, and the factors by
which it falls after a good step and rises after a bad one: the ways that data tell least bend first."""

UNDAMPED_BELOW = 1e-4
"""Damping below which a step is not damped."""

POOR = 0.2
"""Part of its promise that a step must keep, or the next is more careful."""

VAIN = 10.0
"""Promises in units of what is enough below which a step that follows one in vain is not made."""

TRIALS_OF_ONE_STEP = 4
"""Trials of one step after which a fit rests where it is."""


class Way:
    """The way that a fit has come: the next ``step`` (m,), 0 for what is not in the simulation; the ``misfit`` there,
    the ``fall`` in it that the linear system promises for the step, and the fall that is not worth one, ``enough``.
    Misfits are in sigmas squared. Whoever walks keeps the state of the last ``go``, from which ``again`` leads on."""

    def __init__(self) -> None:
        self._at: FloatArray | None = None
        self._last: FloatArray | None = None
        self._system: System | None = None
        self._start = np.zeros(0)
        self._inside = np.zeros(0, dtype=np.bool_)
        self.misfit = math.inf
        self._gained = math.inf
        self._promise = 0.0
        self._damping = 0.0
        self._trials = 0
        self.step: FloatArray = np.zeros(0)
        self.fall = math.inf
        self.enough = NEGLIGIBLE

    def overshot(self, system: System, present: FloatArray) -> bool:
        """Whether the last step ended at a larger misfit than it began with, by the same noise."""
        self._gained = self.misfit - system.misfit_at(present)
        return self._gained < -self.enough

    @property
    def rests(self) -> bool:
        """Whether the next step is not worth its simulation: it promises little, or not much after one that kept
        nothing of its promise."""
        return self.fall < self.enough or (self._gained < NEGLIGIBLE and self.fall < VAIN * self.enough)

    def again(self) -> bool:
        """A more careful step from the state of the last ``go``; whether it is worth a trial."""
        self._trials += 1
        self._damping = max(self._damping * DAMPING_AFTER_BAD_STEP, FIRST_DAMPING)
        self._damped()
        return self._trials < TRIALS_OF_ONE_STEP and self.fall > self.enough

    def go(self, system: System, present: FloatArray) -> None:
        """Look from the ``present`` state (m,) towards the solution.

        What is not in the simulation starts where the last solution had it.
        """
        first = self._at is None
        self.misfit, self._trials = system.misfit_at(present), 0
        self.enough = NEGLIGIBLE + HALF_DONE * system.beyond
        self._inside = ~np.isnan(present)
        self._start = np.where(self._inside, present, 0.0 if self._at is None else self._at)
        self._system = system
        if not first and self._gained < POOR * self._promise:
            self._damping = max(self._damping * DAMPING_AFTER_BAD_STEP, FIRST_DAMPING)
        else:
            self._damping = (
                self._damping * DAMPING_AFTER_GOOD_STEP
                if self._damping > UNDAMPED_BELOW / DAMPING_AFTER_GOOD_STEP
                else 0.0
            )
        self._damped()
        if first:
            self.fall = math.inf
        if self._damping > 0.0:
            self._last = None
            return
        step, length = self.step, 1.0
        if self._last is not None:
            last, now = (one @ system.normal for one in (self._last, step))
            before, here = float(last @ self._last), float(now @ step)
            if float(last @ step) > SAME_WAY_COSINE * math.sqrt(before * here) > 0.0:
                # A row of steps, each this part of the one before, comes to rest this much farther on.
                length = min(MOST_LENGTHENING, 1.0 / max(1.0 - math.sqrt(here / before), 1.0 / MOST_LENGTHENING))
        self._last = step if length == 1.0 else None
        self.step = length * step

    def _damped(self) -> None:
        """The step to the solution, or a damped part of it."""
        system = self._system
        assert system is not None
        whole = system.solution - self._start
        towards = system.normal @ whole
        if self._damping > 0.0:
            whole = system.damped(towards, np.where(self._inside, self._damping, 0.0))
        self.fall = float(2.0 * towards @ whole - whole @ system.normal @ whole)
        self._at = self._start + whole
        self.step = np.where(self._inside, whole, 0.0)
        # What is not in the simulation is fitted at both ends.
        self._promise = self.misfit - system.misfit_at(np.where(self._inside, self._at, np.nan))
