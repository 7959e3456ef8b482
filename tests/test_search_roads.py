"""The search goes back to contested steps, and comes back from those that lead nowhere."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import pytest

from gearpoly.diagnose.budget import Budget
from gearpoly.diagnose.scan import Candidate
from gearpoly.diagnose.search import MANY, MOST, Road, Search
from gearpoly.errors import GeometryError


@dataclass
class System:
    beyond: float = 900.0
    samples: int = 1000
    misfit: float = 1900.0


@dataclass
class Linear:
    system: System = field(default_factory=System)

    def under(self, noises: Any) -> Linear:
        return self


class Walk(Search):
    """A search whose state is a name, whose first end is contested, and whose other ends are as good as ``worths``."""

    def __init__(self, worths: dict[str, float], *, broken: tuple[str, ...] = (), gain: float = 0.0) -> None:
        self.worths, self.broken, self.gain = worths, broken, gain
        self.here = "start"
        self.asked: list[int] = []
        self.linear: Any = Linear()
        self.noises: list[Any] = []
        self.looked: Any = None

        self.model: Any = SimpleNamespace(claims=[], budget=Budget())

    def forward(self, most: int = MOST) -> tuple[list[Candidate], list[Road]]:
        self.asked.append(most)
        if self.here == "start":
            self.here = "first"
            claims: list[Any] = ["other", "third"]
            roads = [
                Road(state=({"here": "start"}, {}), claim=claim, part=0.9 - 0.1 * k) for k, claim in enumerate(claims)
            ]
            return [], roads
        found: list[Any] = [self.here]
        return found, []

    def accept(self, claims: Any) -> bool:
        self.here = "+".join(claims)
        if self.here in self.broken:
            # As far as a fit comes that ends on gears that cannot turn.
            try:
                raise GeometryError("tip below base")
            except GeometryError:
                return False
        return True

    def kept(self) -> Any:
        return {"here": self.here}, {"noises": self.noises}

    def restore(self, state: Any) -> None:
        self.here = state[0]["here"]

    def gained(self, kept: Any) -> float:
        return self.worths[kept[0]["here"]] - self.worths[self.here]

    def laws_anew(self) -> bool:
        return False

    def withdraw(self) -> None:
        pass

    def widen(self) -> None:
        pass

    def forget(self) -> None:
        pass

    def gain_without(self, k: int) -> float:
        return self.gain

    def settle(self) -> None:
        pass

    def drop_idle(self) -> None:
        pass


def claimed(*, tooth: int | None = None, shaped: bool = False) -> Any:
    """A claim about a tooth, or about all, of a size alone or of a shape too."""
    physics = SimpleNamespace(mean_tooth=tooth is None, shaped=shaped)
    return SimpleNamespace(physics=physics, place=SimpleNamespace(tooth=tooth))


@pytest.fixture(autouse=True)
def no_design(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pair that nobody relieves."""
    monkeypatch.setattr("gearpoly.diagnose.search.relieved", lambda model: [])


@pytest.mark.parametrize(
    ("worths", "end"),
    [
        ({"first": 100.0, "bending+reliefs": 20.0, "other": 50.0, "third": 70.0}, "bending+reliefs"),
        ({"first": 100.0, "bending+reliefs": 80.0, "other": 50.0, "third": 70.0}, "other"),
    ],
)
def test_what_makers_choose_is_tried_as_a_whole(
    worths: dict[str, float], end: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gearpoly.diagnose.search.relieved", lambda model: ["bending", "reliefs"])
    walk = Walk(worths)
    walk.run()
    assert walk.here == end


@pytest.mark.parametrize(
    ("claims", "end"),
    [
        ([claimed(), claimed()], "bending+reliefs"),  # less bending and wear fit one torque as well, or nearly
        ([claimed(tooth=k) for k in range(MANY)], "bending+reliefs"),  # pits that each take a little
        ([claimed(), claimed(shaped=True), claimed(shaped=True)], "first"),  # it is what would be tried
        ([claimed(), claimed(tooth=3)], "first"),
    ],
)
def test_what_makers_choose_is_tried_where_claims_may_be_parts_of_it(
    claims: list[Any], end: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At the torque of the design little is left once some of it has been taken for something else."""
    monkeypatch.setattr("gearpoly.diagnose.search.relieved", lambda model: ["bending", "reliefs"])
    walk = Walk({"first": 100.0, "bending+reliefs": 20.0, "other": 100.0, "third": 100.0})
    walk.linear.system.beyond = 0.0
    walk.model.claims = claims
    walk.run()
    assert walk.here == end


@pytest.mark.parametrize(
    ("few", "worth", "end", "asked"),
    [
        (3, 20.0, "bending+reliefs", [MANY, MANY]),  # fewer that explain more: no more are looked for
        (3, 99.0, "first", [MANY, MANY, MOST, MOST]),  # fewer explain no more, and there is no end yet
        (MANY, 20.0, "bending+reliefs", [MANY, MANY, MOST, MOST]),  # as many: both are gone on with, then weighed
    ],
)
def test_many_claims_are_not_waited_for_where_few_explain_more(
    few: int, worth: float, end: str, asked: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gearpoly.diagnose.search.relieved", lambda model: ["bending", "reliefs"])

    class Several(Walk):
        """Many pits, or few claims once bending and reliefs are made."""

        def accept(self, claims: Any) -> bool:
            self.model.claims = [claimed(tooth=k) for k in range(few)]
            return super().accept(claims)

        def restore(self, state: Any) -> None:
            super().restore(state)
            self.model.claims = [claimed(tooth=k) for k in range(MANY)]

    walk = Several({"first": 100.0, "bending+reliefs": worth}, broken=("other", "third"))
    walk.linear.system.beyond = 0.0
    walk.model.claims = [claimed(tooth=k) for k in range(MANY)]
    walk.run()
    assert walk.here == end
    assert walk.asked == asked


@pytest.mark.parametrize(
    ("beyond", "teeth", "gain", "kept"),
    [
        (300.0, MOST - 1, 400.0, 1),  # of 1000 missing a part is left, and there is no end
        (300.0, MOST - 1, 200.0, 0),  # nor is what explains less than that
        (30.0, MOST - 1, 400.0, MOST),  # so many pits explain it
        (300.0, MOST - 2, 400.0, MOST - 1),  # the search has come to an end
    ],
)
def test_faults_of_teeth_that_do_not_end_keep_no_name(beyond: float, teeth: int, gain: float, kept: int) -> None:
    walk = Walk({"start": 100.0}, gain=gain)
    walk.linear.system.beyond = beyond
    walk.model.claims = [claimed(), *(claimed(tooth=k) for k in range(teeth))]
    walk.disown(1000.0)
    assert len(walk.model.claims) == kept
    assert walk.disowned == teeth + 1 - kept


@pytest.mark.parametrize(
    ("worths", "broken", "end"),
    [
        ({"first": 100.0, "other": 50.0, "third": 70.0}, (), "other"),  # the best of all ends
        ({"first": 100.0, "other": 95.0, "third": 97.0}, (), "first"),  # not better by as much as chance makes
        ({"first": 100.0, "other": 10.0, "third": 70.0}, ("other",), "third"),  # what is no state is no end
        ({"first": 100.0, "other": 10.0, "third": 20.0}, ("other", "third"), "first"),
    ],
)
def test_the_best_end_is_kept(worths: dict[str, float], broken: tuple[str, ...], end: str) -> None:
    walk = Walk(worths, broken=broken)
    found = walk.run()
    assert walk.here == end
    assert found == ([] if end == "first" else [end])


def test_nothing_is_gone_back_to_where_little_is_left() -> None:
    walk = Walk({"first": 100.0, "other": 10.0, "third": 20.0})
    walk.linear.system.beyond = 0.1 * walk.linear.system.samples
    walk.run()
    assert walk.here == "first"
    assert walk.gained(walk.kept()) == 0.0
