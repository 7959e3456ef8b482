"""Reliefs that nobody declared, under teeth that nobody took to bend: at the design torque they hide each other, and
they move where pairs hand over, by which a curve is placed."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import compare
from gearpoly.diagnose import left_open
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.fit import settled
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.files.models import PairFile
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from tests.pair_files import pair_file
from tests.physics_cases import ZEROS, Condition, declared, recorded, scope_of

Z = 19, 24
RELIEFS = (9.0, 1.0), (9.0, 1.0)
"""um over mm: from about the end of single contact to the tip; at 90 N.m they leave the least ripple."""
TORQUES = 2.0, 45.0, 90.0


def hidden(rng: np.random.Generator) -> tuple[PairFile, PairFile]:
    """The pair as it is, and as it is declared: rigid and without reliefs. All slopes lean one way, so that declared
    teeth hand over at the end of double contact, where relieved ones do in its middle."""

    def sheet(z: int, slope: float) -> dict[str, object]:
        pitch = rng.normal(0.0, 2.0, z)
        return {
            "pitch_um": (pitch - pitch.mean()).round(3).tolist(),
            "profile_slope_um": (slope + rng.normal(0.0, 0.5, z)).round(3).tolist(),
        }

    sheets = sheet(Z[0], 1.5), sheet(Z[1], -1.0)
    gears = [
        {"inspection": dict(one), "tip_relief": {"amount_um": amount, "length_mm": length}}
        for one, (amount, length) in zip(sheets, RELIEFS, strict=True)
    ]
    true = pair_file(Z, driving=gears[0], driven=gears[1], model={"tooth_deflection": True}, points=800)
    known = pair_file(
        Z, driving={"inspection": sheets[0]}, driven={"inspection": sheets[1]}, model={"tooth_deflection": False},
        points=800,
    )  # fmt: skip
    return true, known


def found(folder: Path) -> Diagnosis:
    true, known = hidden(np.random.default_rng(11))
    conditions = tuple(Condition(torque_nm=one) for one in TORQUES)
    recordings = recorded(true, conditions, np.random.default_rng(12), cycles=2.0, per_mesh=14, noise_um=0.5)
    return diagnose(known, recordings, path=folder / "pair.toml")


def off_pitches(comparison: Comparison) -> float:
    zero = comparison.alignment.zeros.driven
    assert zero is not None
    return math.remainder(zero - ZEROS[1], 2.0 * math.pi) / (2.0 * math.pi / Z[1])


@pytest.mark.slow
def test_reliefs_and_bending_are_told_though_the_curve_was_placed_by_another_hand_over(tmp_path: Path) -> None:
    diagnosis = found(tmp_path)
    named = {(f.claim.physics.name, f.claim.place.gear): f for f in diagnosis.findings}
    assert set(named) == {("tooth_deflection", None), ("tip_relief", 0), ("tip_relief", 1)}
    for gear, (amount, length) in enumerate(RELIEFS):
        parameters = named["tip_relief", gear].parameters
        for name, true in (("amount_um", amount), ("length_mm", length)):
            value, std = parameters[name]
            assert abs(value - true) < max(2.0 * std, 0.05 * true), (gear, name, value, std)
    # A fit that is right as a whole places the curve as well as its noise allows; a hundredth of a pitch is generous.
    assert abs(off_pitches(diagnosis.comparison)) < 0.01
    assert diagnosis.after.unseen == pytest.approx(0.5e-3, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(("hand_over", "held"), [(left_open.HAND_OVER, False), (0.0, True)])
def test_a_wrong_place_is_left_only_where_reliefs_may_have_moved_it(
    hand_over: float, held: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All reliefs and bending claimed, but the zeros an eighth of a pitch late: the fit finds back, unless it is held
    to the doubt of an alignment that knows nothing of reliefs."""
    monkeypatch.setattr(left_open, "HAND_OVER", hand_over)
    true, known = hidden(np.random.default_rng(11))
    conditions = tuple(Condition(torque_nm=one) for one in TORQUES[::2])
    recordings = recorded(true, conditions, np.random.default_rng(12), cycles=2.0, per_mesh=10, noise_um=0.5)
    path = tmp_path / "pair.toml"
    comparison = compare(known, recordings, path=path)
    model = prepare(known, comparison, path=path)
    model = replace(model, shift_std=1e-3 * model.scope.gears[1].tau)
    search = from_declared(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    begun = comparison.alignment.zeros.driven
    assert begun is not None
    late = math.remainder(begun - ZEROS[1], 2.0 * math.pi) - 0.125 * model.scope.gears[1].tau
    claims = (
        Claim(physics=catalogue()["tooth_deflection"], place=Place(), values=(1.0,)),
        *(
            Claim(physics=catalogue()["tip_relief"], place=Place(gear=gear), values=relief)
            for gear, relief in enumerate(RELIEFS)
        ),
    )
    search = settled(replace(search, model=replace(search.model.moved(late), claims=claims)))
    off = off_pitches(comparison.moved(search.model.offset).refined(search.model.shift, search.shift_std))
    assert abs(off) > 0.06 if held else abs(off) < 0.01


def test_a_relief_as_short_as_a_corner_is_none() -> None:
    """At a twentieth of a module it is a chamfer, a burr, or what a simulation lacks about corners."""
    physics, scope = catalogue()["tip_relief"], scope_of(declared("tip_relief"))
    assert not physics.sensible(scope, Place(gear=0), (5.0, 0.05))
    assert physics.sensible(scope, Place(gear=0), (5.0, 0.2))
