"""A curve of no cause pays for where it makes teeth lose touch, though the recordings tell nothing of it there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import multivariate_normal, norm

from gearpoly.compare.compare import compare
from gearpoly.diagnose.fit import joined, settled
from gearpoly.diagnose.in_stead import _as_drawn, _least_apart, _of_other_form, _of_values, unknown_in_stead
from gearpoly.diagnose.linear import CLAIMED_TOOTH_KNOTS as LOOSE_KNOTS
from gearpoly.diagnose.linear import Layout, Linear
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import System
from gearpoly.infer.free_form import FREE_FORM, FREE_FORM_KNOTS, curve_covariance
from gearpoly.infer.prior import SCALE_WEIGHTS, SCALES
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import FloatArray
from tests.physics_cases import Condition, recorded, rough, scope_of

TOUCHES = -5.0
"""um above which the flank of the stub below shows."""


def test_what_is_told_to_be_beyond_a_value_costs_the_part_of_the_prior_there() -> None:
    """Of two values that know nothing of each other the first is told to 0.1, the second to be below -6 only: a normal
    density over its largest times a normal tail, averaged over the scales."""
    prior, told = np.diag([9.0, 4.0]), np.diag([0.01, 1e8])
    by_hand = sum(
        weight
        * norm.pdf(2.0, scale=math.sqrt(9.0 * s**2 + 0.01)) / norm.pdf(0.0, scale=0.1)
        * norm.cdf(-6.0 / (2.0 * s))
        for s, weight in zip(SCALES, SCALE_WEIGHTS, strict=True)
    )  # fmt: skip
    apart = np.array([False, True])
    assert _of_values(np.array([2.0, -6.0]), told, prior, 2, apart=apart) == pytest.approx(math.log(by_hand), abs=1e-9)
    # Told to a tenth of a mm on either side of -6, it would have cost nothing.
    alone = math.log(
        sum(
            weight * multivariate_normal.pdf(2.0, cov=9.0 * s**2 + 0.01) / multivariate_normal.pdf(0.0, cov=0.01)
            for s, weight in zip(SCALES, SCALE_WEIGHTS, strict=True)
        )
    )
    assert _of_values(np.array([2.0, -6.0]), told, prior, 2) == pytest.approx(alone, abs=1e-3)
    assert _of_values(np.array([2.0, 0.0]), told, prior, 2, apart=apart) == pytest.approx(alone, abs=1e-9)


@dataclass(frozen=True)
class Stub:
    """A model whose one sample shows how far knots 8 and 9 stand above where teeth touch, and never knot 0."""

    claims: tuple[Claim, ...]

    def scenes(self) -> list[Any]:
        return []

    def residuals(self, scenes: list[Any]) -> list[FloatArray]:
        values = self.claims[0].values
        return [np.array([max(values[8], TOUCHES) + max(values[9], TOUCHES)])]


def test_a_curve_goes_no_deeper_than_where_teeth_lose_touch() -> None:
    """Knots that the last step of a fit took to -40 and -70 um are told to be below -5 um: the deeper one says how far
    both have come, to a sixteenth of the way. A knot that no tooth meets goes to what its neighbours make likely."""
    values = [2.0] * FREE_FORM_KNOTS
    values[0], values[8], values[9] = -30.0, -40.0, -70.0
    place = Place(gear=0, tooth=3, flank="drive", shape=tuple(np.linspace(1.0, 5.0, FREE_FORM_KNOTS).tolist()))
    claim = Claim(physics=FREE_FORM, place=place, values=tuple(values))
    noise = SimpleNamespace(whitened=lambda one: one / 0.3)
    search: Any = SimpleNamespace(model=Stub((claim,)), scenes=[], noises=[noise])
    apart = np.isin(np.arange(FREE_FORM_KNOTS), (0, 8, 9))
    least = _least_apart(search, claim, apart)
    rest = np.flatnonzero(~apart)
    prior = curve_covariance()
    likely = prior[np.ix_([0], rest)] @ np.linalg.solve(prior[np.ix_(rest, rest)], np.full(rest.size, 2.0))
    assert least[0] == pytest.approx(float(likely[0]))
    assert least[8] <= TOUCHES and least[9] <= TOUCHES
    assert least[8] > TOUCHES - 42.0 / 16.0
    np.testing.assert_array_equal(least[~apart], 2.0)


@dataclass(frozen=True)
class Fitted:
    """A fit of 80 samples with two as-built parameters, the forms of a tooth and its one claim."""

    linear: Linear
    model: Any


def fitted() -> Fitted:
    rng = np.random.default_rng(3)
    form = slice(2, 2 + LOOSE_KNOTS)
    layout = Layout(built=slice(0, 2), nuisance=slice(2, 2), foreign=slice(2, 2), forms=form, claims=[slice(14, 15)])
    columns = rng.standard_normal((80, 15))
    known = np.diag([1.0, 1.0, *np.full(LOOSE_KNOTS, 4.0), 1e-6])
    target = columns @ np.array([0.5, -0.3, *rng.normal(0.0, 0.5, LOOSE_KNOTS), 7.0]) + rng.standard_normal(80)
    white = [full(columns)]
    system = System(white=white, target=[target], precision=known, prior=np.zeros(15))
    linear = Linear(system=system, layout=layout, columns=white, target=[target], noises=[])
    tooth = Claim(physics=catalogue()["tooth_spall"], place=Place(gear=0, tooth=3), values=(7.0, 1.0, 2.0, 0.1))
    return Fitted(linear=linear, model=SimpleNamespace(claims=(tooth,)))


def test_a_form_that_is_left_open_pays_for_what_it_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside all that is believed but the claim, by the log of the likelihood's normalisation with forms over that
    without: -1/2 log(|I + R R' + F F' / 4| / |I + R R'|) of R as-built columns of prior 1 and F forms of prior 1/2. As
    drawn, nothing is paid and the misfit is that of a system that has no such columns."""
    search: Any = fitted()
    misfits: list[float] = []

    def log_evidence(search: Any, linear: Linear, claims: Any, dispersion: float) -> float:
        misfits.append(linear.system.misfit)
        return 0.0

    monkeypatch.setattr("gearpoly.diagnose.in_stead._log_evidence", log_evidence)
    columns = search.linear.columns[0].dense()
    rest, form = columns[:, :2], columns[:, 2:14]
    without = np.eye(80) + rest @ rest.T
    paid = np.linalg.slogdet(without)[1] - np.linalg.slogdet(without + 0.25 * form @ form.T)[1]
    assert _of_other_form(search, search.model.claims, 1.0) == pytest.approx(0.5 * paid, rel=1e-9)
    assert _as_drawn(search, search.model.claims, 1.0) == 0.0
    bare = search.linear.system.without(list(range(2, 14)))
    assert misfits == pytest.approx([search.linear.system.misfit, bare.misfit], rel=1e-6)
    assert misfits[1] > misfits[0] + 10.0


def test_parameters_that_are_fixed_leave_a_system_without_them() -> None:
    """All others where they stood, at the same values, as well known, with the same misfit."""
    system = fitted().linear.system
    gone, stay = list(range(2, 14)), [0, 1, 14]
    fixed, bare = system.fixed_at_zero(gone), system.without(gone)
    assert fixed.misfit == pytest.approx(bare.misfit, rel=1e-6)
    np.testing.assert_allclose(fixed.solution[stay], bare.solution, rtol=1e-6)
    np.testing.assert_allclose(fixed.solution[gone], 0.0, atol=1e-6)
    np.testing.assert_allclose(fixed.covariance[np.ix_(stay, stay)], bare.covariance, rtol=1e-6)
    assert system.fixed_at_zero([]).misfit == pytest.approx(system.misfit, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(("deviation", "surely"), [(lambda u: -12.0 * u, True), (lambda u: -9.0 * (u > 0.5), False)])
def test_a_tooth_that_leans_as_no_sheet_says_is_no_pit(deviation: Any, surely: bool, tmp_path: Path) -> None:
    """12 um that an inspected flank leans look like a pit whose wall is a mm wide, up to the tip; 9 um off its upper
    half are a pit."""
    known = rough((17, 22), bends=False)
    scope = scope_of(known)
    low, high = scope.reach[0]
    along = np.linspace(low, high, FREE_FORM_KNOTS)
    flank = Place(gear=0, tooth=3, flank="drive", shape=tuple(along.tolist()))
    u = (along - low) / (high - low)
    made = FREE_FORM.write(known, flank, tuple(deviation(u).tolist()))
    (one,) = recorded(made, (Condition(torque_nm=0.0),), np.random.default_rng(7), cycles=2.5, per_mesh=14)
    path = tmp_path / "pair.toml"
    model = prepare(known, compare(known, [one], path=path), path=path)
    search = from_declared(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    spall = catalogue()["tooth_spall"]
    r_from, r_to = (math.hypot(l, scope.gears[0].r_b) for l in (low + 0.5 * (high - low), high))
    pit = Claim(physics=spall, place=Place(gear=0, tooth=3), values=(9.0, r_from, r_to, 0.8 if surely else 0.02))
    search = settled(settled(joined(search, [pit])))
    unknown = unknown_in_stead(search, 0, 3)
    assert (unknown > 0.95) if surely else (unknown < 0.05)
