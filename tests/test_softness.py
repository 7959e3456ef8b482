"""How soft teeth are, beside what else gives way under load."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.exchange import without_idle
from gearpoly.diagnose.softness import with_declared_softness
from tests.made_fits import MadeFit
from tests.physics_cases import Condition, recorded, rough


@dataclass(kw_only=True, eq=False)
class Valley(MadeFit):
    """A fit that rests as soft as it begins."""

    misfit: dict[float, float]

    def __post_init__(self) -> None:
        system = SimpleNamespace(misfit=self.misfit[round(self.model.scale, 6)])
        self.linear = SimpleNamespace(system=system, under=lambda noises: SimpleNamespace(system=system))


def valleys(misfit: dict[float, float], *, scale: float, claims: int) -> Any:
    """A fit with a misfit by how soft its teeth are; they were found 2.2 times as soft as declared."""

    def made(scale: float) -> Any:
        model = SimpleNamespace(declared=declared, scale=scale, claims=(None,) * claims, law=None)
        model.softer = lambda ratio: made(scale * ratio)
        return model

    declared = SimpleNamespace(model=SimpleNamespace(tooth_deflection=True))
    return Valley(model=made(scale), misfit=misfit)


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
    declared: float, scale: float, claims: int, ends: float, tried: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    monkeypatch.setattr("gearpoly.diagnose.softness.settled", lambda fit: asked.append(fit) or fit)
    fit = valleys({1.0: declared, 2.2: 1000.0, 1.25: 1000.0}, scale=scale, claims=claims)
    assert with_declared_softness(fit).model.scale == pytest.approx(ends)
    assert len(asked) == tried


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
    simulated: bool, without: float, promised: float, stands: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To first order the last micrometre of a closed gap is like softer teeth. Gains of more than 20 count."""
    claim = SimpleNamespace(key="gap", values=(20.0,), simulated=simulated)

    def cost(fit: Any) -> float:
        return (100.0 if fit.model.claims else without) + 2.0 * len(fit.model.claims)

    module = "gearpoly.diagnose.exchange"
    monkeypatch.setattr(f"{module}.gain_without", lambda fit, k: 3.0)
    monkeypatch.setattr(f"{module}.significant", lambda fit, one: one.gain > 20.0)
    monkeypatch.setattr(f"{module}.settled", lambda fit: fit)
    monkeypatch.setattr(f"{module}.gained_since", lambda fit, before: cost(before) - cost(fit))
    monkeypatch.setattr(f"{module}.promised_more", lambda fit, claim: promised)
    monkeypatch.setattr(f"{module}._wave_without_name", lambda fit, one: None)
    search: Any = MadeFit(model=SimpleNamespace(claims=(claim,)))
    assert bool(without_idle(search).model.claims) is stands


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
