"""What pays on data that a fit never saw."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.compare.noise import Noise
from gearpoly.diagnose.heldout import cross_validated, log_predictive
from gearpoly.diagnose.linear import Layout, Linear
from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import System
from gearpoly.diagnose.unseen import foretold_best

SAMPLES = 400
HALF = np.arange(SAMPLES) < SAMPLES // 2


def system(size: float, rng: np.random.Generator) -> System:
    """One tooth's deviation of so many um, held to 0 +- 0.5 by an inspection, in noise of 1; it touches in every eighth
    sample."""
    touching = (np.arange(SAMPLES) % 8 == 0).astype(float)
    target = size * touching + rng.standard_normal(SAMPLES)
    return System(white=[full(touching[:, None])], target=[target], precision=np.array([[4.0]]), prior=np.zeros(1))


def gained(plain: System) -> float:
    """Twice the log odds that the same deviation, free, gives both halves, each by what the other teaches."""
    wider = plain.with_columns([plain.white[0].dense()])
    return 2.0 * sum(log_predictive(wider, [half]) - log_predictive(plain, [half]) for half in (HALF, ~HALF))


def test_what_contradicts_an_inspection_pays() -> None:
    """6 um are 12 of its standard deviations, 144 in misfit; the samples alone follow either way. Half of it is asked:
    the fit leaves a part to the samples."""
    plain = system(6.0, np.random.default_rng(1))
    assert gained(plain) > 0.5 * (6.0 / 0.5) ** 2


@pytest.mark.parametrize("seed", range(5))
def test_what_the_inspection_knows_does_not_pay(seed: int) -> None:
    """A deviation of nothing: what is free follows noise, which the other half has not. Of 40 seeds one gained 0.4."""
    assert gained(system(0.0, np.random.default_rng(seed))) < 1.0


def waved(period: float, size: float, rng: np.random.Generator) -> Linear:
    """A mean, and a wave of no gear pair with such a period in recordings, of such a size, in noise of 1."""
    turned = 2.0 * np.pi * np.arange(SAMPLES) / (period * SAMPLES)
    columns = full(np.column_stack((np.ones(SAMPLES), np.cos(turned), np.sin(turned))))
    target = size * np.cos(turned - 0.4) + rng.standard_normal(SAMPLES)
    precision, none = np.diag([1e-6, 1e-6, 1e-6]), slice(0, 0)
    layout = Layout(built=slice(0, 1), nuisance=slice(1, 1), foreign=slice(1, 3), forms=none, claims=[])
    plain = System(white=[columns], target=[target], precision=precision, prior=np.zeros(3))
    noises: list[Noise] = []
    return Linear(system=plain, layout=layout, columns=[columns], target=[target], noises=noises)


def test_a_wave_that_half_a_recording_hardly_tells_foretells_nothing() -> None:
    """Twelve periods to a recording: half of it tells a wave of 3, and noise of 1 is left of the other half. Of a wave
    of a quarter of a period, half a recording knows an arc, and the other half is foretold worse with it."""
    rng = np.random.default_rng(4)
    fast, slow = waved(1.0 / 12.0, 3.0, rng), waved(4.0, 0.05, rng)
    assert foretold_best(fast, [HALF], hold=[]).unseen == cross_validated(fast, [HALF]).unseen
    assert foretold_best(fast, [HALF], hold=[]).unseen == pytest.approx(1.0, abs=4.0 / np.sqrt(2.0 * SAMPLES))
    without = cross_validated(slow, [HALF], leave=[1, 2])
    assert without.unseen < cross_validated(slow, [HALF]).unseen
    assert foretold_best(slow, [HALF], hold=[]).unseen == without.unseen
