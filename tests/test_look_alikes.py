"""What may stand in the place of a claim explains the same as it does."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from gearpoly.diagnose.judge import _look_alikes
from gearpoly.diagnose.scan import Candidate
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place


def test_what_gains_as_much_beside_a_claim_is_no_look_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three explain as much as the claim where it is left out: one all the same beside it, so something else."""
    physics = catalogue()
    claim = Claim(physics=physics["tooth_pitch"], place=Place(gear=0, tooth=3), values=(5.0,))
    ones = {
        "tooth_spall": (90.0, 5.0),
        "tooth_crack": (80.0, 80.0),
        "tooth_chip": (120.0, 60.0),
    }

    def scan(model: Any, scenes: Any, linear: Any, *, only: Any) -> Any:
        beside = linear == "with the claim"
        asked = list(only)
        found = [
            Candidate(claim=Claim(physics=one, place=place, values=(1.0,)), gain=ones[one.name][beside], freedoms=1)
            for one, place in asked
        ]
        return sorted(found, key=lambda one: -one.gain), None

    places = [(physics[name], Place(gear=0, tooth=3)) for name in ones]
    monkeypatch.setattr("gearpoly.diagnose.judge.scan", scan)
    monkeypatch.setattr("gearpoly.diagnose.judge._possible", lambda model, claim: iter(places))
    monkeypatch.setattr("gearpoly.diagnose.judge.polished", lambda model, scenes, linear, one: one)
    trial: Any = SimpleNamespace(others=None, scenes=None, linear="with the claim")
    found = _look_alikes(None, trial, None, claim, 100.0, ())  # type: ignore[arg-type]
    assert [one.claim.physics.name for one in found] == ["tooth_chip", "tooth_spall"]
