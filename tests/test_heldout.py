"""What pays on data that a fit never saw."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.diagnose.heldout import unseen_misfit
from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import System

SAMPLES = 400
HALF = np.arange(SAMPLES) < SAMPLES // 2


def system(size: float, rng: np.random.Generator) -> System:
    """One tooth's deviation of so many um, held to 0 +- 0.5 by an inspection, in noise of 1; it touches in every eighth
    sample."""
    touching = (np.arange(SAMPLES) % 8 == 0).astype(float)
    target = size * touching + rng.standard_normal(SAMPLES)
    return System(white=[full(touching[:, None])], target=[target], precision=np.array([[4.0]]), prior=np.zeros(1))


def gained(plain: System) -> float:
    """Misfit that the same deviation, free, takes off both halves, each by what the other teaches."""
    wider = plain.with_columns([plain.white[0].dense()])
    ways = (([HALF], [~HALF]), ([~HALF], [HALF]))
    return sum(unseen_misfit(plain, seen, unseen) - unseen_misfit(wider, seen, unseen) for seen, unseen in ways)


def test_what_contradicts_an_inspection_pays() -> None:
    """6 um are 12 of its standard deviations, 144 in misfit; the samples alone follow either way. Half of it is asked:
    the fit leaves a part to the samples."""
    plain = system(6.0, np.random.default_rng(1))
    assert gained(plain) > 0.5 * (6.0 / 0.5) ** 2


@pytest.mark.parametrize("seed", range(5))
def test_what_the_inspection_knows_does_not_pay(seed: int) -> None:
    """A deviation of nothing: what is free follows noise, which the other half has not. Of 40 seeds one gained 0.4."""
    assert gained(system(0.0, np.random.default_rng(seed))) < 1.0
