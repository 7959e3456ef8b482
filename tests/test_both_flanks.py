"""What both flanks of uninspected teeth share, and whole turns that nobody counted between their recordings."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from gearpoly.diagnose.as_built import AsBuilt, GearPrior, chain, make_as_built
from gearpoly.diagnose.both_flanks import SHARED, surprise, told, turns_told
from gearpoly.diagnose.system import System
from gearpoly.units import FloatArray

Z = 18, 24
NOISE = 0.1
"""um to which every parameter is read."""


def graded(z: int, *, shared: tuple[float, float] = (0.5, 0.5), known: bool = False) -> GearPrior:
    return GearPrior(
        z=z, pitch=chain(z, single=4.5, cumulative=15.0), slope=1.0, mean_slope=1.0, crowning=0.5, thickness=4.0,
        shared=shared, own=0.0, graded=not known,
    )  # fmt: skip


def teeth(*, shared: tuple[float, float] = (0.5, 0.5), known: bool = False) -> AsBuilt:
    one, two = (graded(z, shared=shared, known=known) for z in Z)
    return make_as_built((one, two), ["drive", "coast"])


def read(true: FloatArray, as_built: AsBuilt) -> System:
    """The system of recordings that tell every as-built parameter by itself, to ``NOISE``."""
    noisy = true + np.random.default_rng(5).normal(0.0, NOISE, true.size)
    size = as_built.size
    return System(
        white=[np.eye(size) / NOISE], target=[noisy / NOISE], precision=as_built.precision, prior=np.zeros(size)
    )


def drawn(as_built: AsBuilt, seed: int) -> FloatArray:
    """Teeth as the prior has them."""
    return np.linalg.cholesky(np.linalg.inv(as_built.precision)) @ np.random.default_rng(seed).normal(
        size=as_built.size
    )


def asked(as_built: AsBuilt, system: System, **more: object) -> tuple[Any, Any, Any]:
    """Model, scenes and linear state, as far as the question needs them."""
    model = SimpleNamespace(as_built=as_built, claims=[], method=SimpleNamespace(physics=()), **more)
    return model, [], SimpleNamespace(system=system, noises=[])


def test_surprise_is_the_evidence_of_the_recordings() -> None:
    """Differences between priors are those of the normal density of the readings, their parameters integrated out."""
    one, other = teeth(shared=(0.5, 0.5)), teeth(shared=(0.95, 0.8))
    system = read(drawn(other, 1), one)

    def density(prior: AsBuilt) -> float:
        covariance = np.linalg.inv(prior.precision) / NOISE**2 + np.eye(prior.size)
        return float(-2.0 * multivariate_normal(cov=covariance).logpdf(system.target[0]))

    # Determinants of 170 parameters, in double precision.
    assert surprise(one, system) - surprise(other, system) == pytest.approx(density(one) - density(other), rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("true", [(0.95, 0.5), (0.999, 0.95), (0.5, 0.99)])
def test_recordings_of_both_flanks_tell_what_these_share(true: tuple[float, float], seed: int) -> None:
    """From the half that nothing is known of to at most one step from the truth, pitch and form each by itself: 18
    teeth tell the variance that is left to a third."""
    start = teeth()
    found = told(*asked(start, read(drawn(teeth(shared=true), seed), start)))
    for gear in found.gears:
        for value, truth in zip(gear.shared, true, strict=True):
            assert abs(SHARED.index(value) - SHARED.index(truth)) <= 1


def test_inspected_gears_and_single_flanks_are_left_as_they_are() -> None:
    known = teeth(known=True)
    assert told(*asked(known, read(drawn(teeth(shared=(0.99, 0.99)), 1), known))) is known
    single = make_as_built((graded(Z[0]), graded(Z[1])), ["drive"])
    assert told(*asked(single, read(np.zeros(single.size), single))) is single


def test_one_tooth_that_errs_on_one_flank_alone_keeps_flanks_apart() -> None:
    """What the prior cannot make is not forced on it: sharing less is likelier than a tooth ten deviations off."""
    start, whole = teeth(), drawn(teeth(shared=(0.999, 0.999)), 2)
    whole[start.start("coast", 0) + 3] += 20.0
    gears = told(*asked(start, read(whole, start))).gears
    assert gears[0].shared[0] < 0.999 <= gears[1].shared[0]


@pytest.mark.parametrize(("read_shaft", "ways"), [("driven", 3), ("driving", 4)])
def test_turns_between_flanks_are_counted_by_the_teeth_of_the_mate(read_shaft: str, ways: int) -> None:
    """After a turn of the shaft that was read the mate has gone on by as many teeth as that shaft's gear has."""
    truth, start = teeth(shared=(0.99, 0.95)), teeth()
    mate = 0 if read_shaft == "driven" else 1
    for turns in range(ways):
        true = drawn(truth, 3)
        first = start.start("coast", mate)
        for at in (first, first + Z[mate]):
            # Tooth n passes where n - turns z is taken to pass.
            true[at : at + Z[mate]] = np.roll(true[at : at + Z[mate]], -turns * Z[1 - mate])
        model, scenes, linear = asked(start, read(true, start), turns_of=read_shaft)
        assert turns_told(model, scenes, linear) == turns


def test_turns_are_left_where_flanks_have_nothing_in_common() -> None:
    start = teeth()
    apart = teeth(shared=(0.0, 0.0))
    assert turns_told(*asked(start, read(drawn(apart, 4), start), turns_of="driven")) == 0
    known = teeth(known=True)
    assert turns_told(*asked(known, read(drawn(known, 4), known), turns_of="driven")) == 0
    assert turns_told(*asked(start, read(drawn(start, 4), start), turns_of=None)) == 0
