"""How soft teeth are, beside what else gives way under load."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.search import Search
from gearpoly.diagnose.softness import Softness
from tests.physics_cases import Condition, recorded, rough


class Valleys:
    """A fit that rests as soft as it begins, with a misfit by how soft that is; teeth were found 2.2 times as soft as
    declared."""

    def __init__(self, misfit: dict[float, float], *, scale: float = 2.2, claims: int = 1) -> None:
        self.misfit, self.noises = misfit, None
        declared = SimpleNamespace(model=SimpleNamespace(tooth_deflection=True))
        self.model = SimpleNamespace(declared=declared, scale=scale, claims=[None] * claims, soften=self.soften)
        self.settled = 0

    @property
    def linear(self) -> Any:
        system = SimpleNamespace(misfit=self.misfit[round(self.model.scale, 6)])
        return SimpleNamespace(system=system, under=lambda noises: SimpleNamespace(system=system))

    def soften(self, by: float) -> None:
        self.model.scale *= by

    def declared_ratio(self) -> float:
        return 1.0

    def settle(self) -> None:
        self.settled += 1

    def kept(self) -> Any:
        return self.model.scale, {"noises": None}

    def restore(self, kept: Any) -> None:
        self.model.scale = kept[0]

    def tried(self, change: Callable[[], None], *, better: float) -> bool:
        fit: Any = self
        return Fit.tried(fit, change, better=better)


@pytest.mark.parametrize(
    ("declared", "scale", "claims", "ends", "tried"),
    [
        (900.0, 2.2, 1, 1.0, 1),
        (995.0, 2.2, 1, 2.2, 1),  # no better by more than chance
        (900.0, 1.25, 1, 1.25, 0),  # within what is open of a declared compliance
        (900.0, 2.2, 0, 2.2, 0),  # nothing is claimed that could be what gives way
    ],
)
def test_the_declared_softness_is_gone_back_to_where_that_fits_better(
    declared: float, scale: float, claims: int, ends: float, tried: int
) -> None:
    fit: Any = Valleys({1.0: declared, 2.2: 1000.0, 1.25: 1000.0}, scale=scale, claims=claims)
    Softness.declared_softness(fit)
    assert fit.model.scale == pytest.approx(ends)
    assert fit.settled == tried


@pytest.mark.parametrize(
    ("simulated", "without", "promised", "stands"),
    [
        (True, 900.0, 0.0, True),
        (True, 115.0, 0.0, False),
        (False, 900.0, 0.0, False),
        (True, 900.0, 790.0, False),  # all but ten of it no step made true
    ],
)
def test_a_claim_that_bends_with_its_size_goes_only_where_all_fits_without_it(
    simulated: bool, without: float, promised: float, stands: bool
) -> None:
    """To first order the last micrometre of a closed gap is like softer teeth. Gains of more than 20 count."""
    claim = SimpleNamespace(key="gap", values=(20.0,), simulated=simulated)
    claims = [claim]

    def cost() -> float:
        return 100.0 if claims else without

    search: Any = SimpleNamespace(
        model=SimpleNamespace(claims=claims),
        gain_without=lambda k: 3.0,
        significant=lambda one: one.gain > 20.0,
        kept=lambda: (list(claims), cost()),
        settle=lambda: None,
        gained=lambda kept: kept[1] - cost() + 2.0 * (1 - len(claims)),
        restore=lambda kept: claims.extend(kept[0]),
        promised=lambda claim: promised,
        _wave_without_name=lambda one: None,
    )
    Search.drop_idle(search)
    assert bool(claims) is stands


@pytest.mark.slow
def test_a_gap_across_the_face_is_told_from_soft_teeth(tmp_path: Path) -> None:
    """25 um at three torques, the pair declared straight: named, to twice what is stated, teeth as soft as declared."""
    known = rough((12, 16))
    true = known.model_copy(update={"pair": known.pair.model_copy(update={"misalignment_um": 25.0})})
    conditions = tuple(Condition(torque_nm=one) for one in (2.0, 20.0, 60.0))
    recordings = recorded(true, conditions, np.random.default_rng(5), per_mesh=14, noise_um=0.3)
    found = diagnose(known, recordings, path=tmp_path / "pair.toml")
    assert [one.claim.physics.name for one in found.findings] == ["misalignment"]
    lead, std = found.findings[0].parameters["lead_um"]
    assert abs(lead - 25.0) < 2.0 * std
    assert found.compliance_scale is not None
    assert found.compliance_scale[0] == pytest.approx(1.0, abs=0.1)
