"""A search is begun again where another physics stands better, and what it told of the first place is kept."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose import search as search_module
from gearpoly.diagnose.contest import Refitted
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.search import _fitted_without
from gearpoly.diagnose.searched import _better_place, _known
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place


def wear(gear: int) -> Claim:
    return Claim(physics=catalogue()["wear"], place=Place(gear=gear), values=(10.0,))


@pytest.mark.parametrize(
    ("behind", "elsewhere", "way"), [(-40.0, True, 0.02), (-5.0, True, None), (-40.0, False, None), (12.0, True, None)]
)
def test_teeth_move_only_where_another_form_is_clearly_better(
    behind: float, elsewhere: bool, way: float | None
) -> None:
    """By more than ten in misfit, and at another place; of several the best."""
    best = Refitted(claim=wear(0), behind=behind, elsewhere=elsewhere, way=0.02)
    other = Refitted(claim=wear(1), behind=30.0, elsewhere=True, way=-0.01)
    found: Any = SimpleNamespace(refitted={("a",): (other,), ("b",): (best,)})
    assert _better_place(found) == way
    assert _better_place(SimpleNamespace(refitted={}) if way is None else found) == way  # type: ignore[arg-type]


def test_a_whole_search_tells_more_than_a_part_of_the_samples() -> None:
    """What was found at the first place is behind by what both searches told; others stay as roughly known."""
    first, other = Refitted(claim=wear(1), behind=-14.0, elsewhere=True), Refitted(claim=wear(0), behind=3.0)
    (told,) = _known({("k",): (first, other)}, [wear(1), wear(0)], 38.0).values()
    assert [one.behind for one in told] == [38.0, 3.0]


@pytest.mark.parametrize(
    ("phased", "way", "misfit", "placed"),
    [(False, 0.01, 80.0, True), (False, 0.01, 130.0, False), (False, 0.0, 80.0, False), (True, 0.01, 80.0, False)],
)
def test_without_a_claim_unplaced_teeth_are_placed_anew(
    phased: bool, way: float, misfit: float, placed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where neither curves nor zeros say where in their pitch teeth stand, a claim of all teeth may stand for a wrong
    place: the fit without it is begun at the best place too, and kept where it leaves less by the same noise."""

    def made(name: str, left: float, **more: Any) -> Any:
        system = SimpleNamespace(misfit=left)
        linear = SimpleNamespace(system=system, under=lambda _: SimpleNamespace(system=system))
        looked = {"looked": name, "formed": 0.0, "disowned": 0}
        return SimpleNamespace(name=name, linear=linear, noises=(), foreign=[], step=None, **looked, **more)

    scope = SimpleNamespace(torques=(0.0,), under_torque=False)
    moved: list[float] = []
    model: Any = SimpleNamespace(phased=phased, stated=False, claims=(wear(0),), built=np.ones(3), scope=scope)
    there = made("placed", misfit)
    monkeypatch.setattr(search_module, "joined", lambda *_, **__: made("without", 300.0, model=model))
    for same in ("settled", "relaxed"):
        monkeypatch.setattr(search_module, same, lambda fit: fit)
    monkeypatch.setattr(search_module, "multi_started", lambda *_, **__: made("without", 120.0, model=model))
    monkeypatch.setattr(search_module, "anywhere", lambda *_, phases: [(1.0, way)] if phases == 16 else [])

    def changed(one: Any, **changes: Any) -> Any:
        if "looked" in changes:
            return SimpleNamespace(**{**vars(one), **changes})
        return SimpleNamespace(moved=lambda by: moved.append(by) or one)

    monkeypatch.setattr(search_module, "replace", changed)
    monkeypatch.setattr(Fit, "begun", lambda *_: there)
    fit = made("with", 110.0, model=model)
    ended: Any = _fitted_without(fit, 0)
    assert ended.name == ("placed" if placed else "without")
    assert ended.looked == "without"  # what was looked at is not forgotten
    assert moved == ([way] if way and not phased else [])
