"""The search goes back to contested steps, and comes back from those that lead nowhere."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import pytest

from gearpoly.diagnose.budget import Budget
from gearpoly.diagnose.search import CLAIMS_TO_DOUBT_ONE_END, MOST_CLAIMS, Road, beside_bending, disowned, run_search
from tests.made_fits import MadeFit


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


@dataclass(kw_only=True, eq=False)
class Walk(MadeFit):
    """A fit of which ``here`` is a name, whose first end is contested, and whose other ends are as good as
    ``worths``."""

    here: str = "start"


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, worths: dict[str, float], broken: tuple[str, ...]) -> list[int]:
    """For how many claims was looked: each end as good as ``worths`` says, ``broken`` ones no gears can turn at. A pair
    that nobody relieves."""
    asked: list[int] = []

    def forward(fit: Any, most: int = MOST_CLAIMS, *, until: Any = None) -> tuple[Any, list[Any], list[Road]]:
        asked.append(most)
        if fit.here != "start":
            return fit, [fit.here], []
        claims: list[Any] = ["other", "third"]
        roads = [Road(state=kept(fit), claim=claim, part=0.9 - 0.1 * k) for k, claim in enumerate(claims)]
        return replace(fit, here="first"), [], roads

    def kept(fit: Any) -> Any:
        return fit

    def accepted(fit: Any, claims: Any) -> Any:
        here = "+".join(claims)
        return None if here in broken else replace(fit, here=here)

    module = "gearpoly.diagnose.search"
    monkeypatch.setattr(f"{module}.forward", forward)
    monkeypatch.setattr(f"{module}.kept", kept)
    monkeypatch.setattr(f"{module}.come_back", lambda state, fit: replace(fit, here=state.here))
    monkeypatch.setattr(f"{module}.accepted", accepted)
    monkeypatch.setattr(f"{module}.gained_since", lambda fit, before: worths[before.here] - worths[fit.here])
    monkeypatch.setattr(f"{module}.misfit_saved", lambda fit, before: worths[before.here] - worths[fit.here])
    monkeypatch.setattr(f"{module}.relieved", lambda model: [])
    monkeypatch.setattr(f"{module}.beside_bending", lambda fit, found: False)
    monkeypatch.setattr(f"{module}.leaning", lambda fit, start: None)
    monkeypatch.setattr(f"{module}.settled", lambda fit: fit)
    for name in ("laws_anew", "withdrawn", "with_wider_laws", "forgotten", "without_idle"):
        monkeypatch.setattr(f"{module}.{name}", lambda fit: fit)
    return asked


@pytest.fixture
def broken() -> tuple[str, ...]:
    return ()


def walk(*claims: Any, beyond: float = 900.0) -> Any:
    return Walk(model=SimpleNamespace(claims=claims, law=None, budget=Budget()), linear=Linear(System(beyond=beyond)))


def claimed(*, tooth: int | None = None, shaped: bool = False) -> Any:
    """A claim about a tooth, or about all, of a size alone or of a shape too."""
    physics = SimpleNamespace(mean_tooth=tooth is None, shaped=shaped)
    return SimpleNamespace(physics=physics, place=SimpleNamespace(tooth=tooth))


@pytest.mark.parametrize(("worths", "end"), [({"first": 100.0, "leant": 60.0, "other": 95.0, "third": 97.0}, "leant"),
    ({"first": 100.0, "leant": 95.0, "other": 99.0, "third": 97.0}, "first")])  # fmt: skip
@pytest.mark.usefixtures("asked")
def test_flanks_that_all_lean_are_begun_from_the_start(end: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """From the state before any claim; kept where that ends better by more than chance makes."""
    begun: list[str] = []

    def leaning(fit: Any, start: Any) -> Any:
        begun.append(start.here)
        return replace(fit, here="leant")

    monkeypatch.setattr("gearpoly.diagnose.search.leaning", leaning)
    assert run_search(walk(beyond=0.0))[0].here == end
    assert begun == ["start"]


@pytest.mark.parametrize(
    ("worths", "end", "looks"),
    [
        ({"first": 100.0, "bending+reliefs": 20.0, "other": 100.0, "third": 100.0}, "bending+reliefs", [4, 4]),
        ({"first": 100.0, "bending+reliefs": 95.0, "other": 100.0, "third": 100.0}, "first", [4, 4, MOST_CLAIMS]),
    ],
)
def test_reliefs_are_asked_as_soon_as_nothing_else_is_told_beside_bending(
    asked: list[int], end: str, looks: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Kept, they end the search; else it goes on where it was."""
    monkeypatch.setattr("gearpoly.diagnose.search.relieved", lambda model: ["bending", "reliefs"])
    monkeypatch.setattr("gearpoly.diagnose.search.beside_bending", lambda fit, found: fit.here == "first")
    assert run_search(walk(beyond=0.0))[0].here == end
    assert asked[: len(looks)] == looks


@pytest.mark.parametrize(
    ("names", "beyond", "gain", "early"),
    [
        (("tooth_deflection",), 130.0, 6.0, True),
        (("tooth_deflection",), 130.0, 20.0, False),  # a candidate explains a seventh of it
        (("tooth_deflection",), 40.0, 2.0, False),  # hardly anything is left
        (("eccentricity",), 130.0, 6.0, False),
        (("tooth_deflection", "tip_relief"), 130.0, 6.0, False),  # reliefs are there already
        ((), 130.0, 6.0, False),
    ],
)
def test_nothing_is_told_beside_bending(
    names: tuple[str, ...], beyond: float, gain: float, early: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    state = [
        SimpleNamespace(physics=SimpleNamespace(name=name, shaped=shaped))
        for name, shaped in (("tooth_deflection", False), ("tip_relief", True), ("tip_relief", True))
    ]
    monkeypatch.setattr("gearpoly.diagnose.search.relieved", lambda model: state)
    fit = walk(*(SimpleNamespace(physics=SimpleNamespace(name=name, shaped=False)) for name in names), beyond=beyond)
    found: Any = [SimpleNamespace(gain=gain), SimpleNamespace(gain=0.5 * gain)]
    assert beside_bending(fit, found) is early


TOGETHER = {"first": 100.0, "bending+reliefs": 20.0, "other": 100.0, "third": 100.0}
"""Bending and reliefs together explain most."""


@pytest.mark.parametrize(
    ("worths", "end"),
    [
        ({"first": 100.0, "bending+reliefs": 20.0, "other": 50.0, "third": 70.0}, "bending+reliefs"),
        ({"first": 100.0, "bending+reliefs": 80.0, "other": 50.0, "third": 70.0}, "other"),
    ],
)
@pytest.mark.usefixtures("asked")
def test_what_makers_choose_is_tried_as_a_whole(end: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearpoly.diagnose.search.relieved", lambda model: ["bending", "reliefs"])
    assert run_search(walk())[0].here == end


@pytest.mark.parametrize("worths", [TOGETHER])
@pytest.mark.parametrize(
    ("claims", "end"),
    [
        ([claimed(), claimed()], "bending+reliefs"),  # less bending and wear fit one torque as well, or nearly
        ([claimed(tooth=k) for k in range(CLAIMS_TO_DOUBT_ONE_END)], "bending+reliefs"),  # pits that each take a little
        ([claimed(), claimed(shaped=True), claimed(shaped=True)], "first"),  # it is what would be tried
        ([claimed(), claimed(tooth=3)], "first"),
    ],
)
@pytest.mark.usefixtures("asked")
def test_what_makers_choose_is_tried_where_claims_may_be_parts_of_it(
    claims: list[Any], end: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At the torque of the design little is left once some of it has been taken for something else."""
    monkeypatch.setattr("gearpoly.diagnose.search.relieved", lambda model: ["bending", "reliefs"])
    assert run_search(walk(*claims, beyond=0.0))[0].here == end


@pytest.mark.parametrize("broken", [("other", "third")])
@pytest.mark.parametrize(
    ("few", "worths", "end", "looks"),
    [
        # Fewer that explain more: no more are looked for.
        (
            3,
            {"first": 100.0, "bending+reliefs": 20.0},
            "bending+reliefs",
            [CLAIMS_TO_DOUBT_ONE_END, CLAIMS_TO_DOUBT_ONE_END],
        ),
        # Fewer explain no more, and there is no end yet.
        (
            3,
            {"first": 100.0, "bending+reliefs": 99.0},
            "first",
            [CLAIMS_TO_DOUBT_ONE_END, CLAIMS_TO_DOUBT_ONE_END, MOST_CLAIMS, MOST_CLAIMS],
        ),
        # As many: both are gone on with, then weighed.
        (
            CLAIMS_TO_DOUBT_ONE_END,
            {"first": 100.0, "bending+reliefs": 20.0},
            "bending+reliefs",
            [CLAIMS_TO_DOUBT_ONE_END, CLAIMS_TO_DOUBT_ONE_END, MOST_CLAIMS, MOST_CLAIMS],
        ),
    ],
)
def test_many_claims_are_not_waited_for_where_few_explain_more(
    few: int, end: str, looks: list[int], asked: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Many pits, or few claims once bending and reliefs are made."""
    module = "gearpoly.diagnose.search"
    monkeypatch.setattr(f"{module}.relieved", lambda model: ["bending", "reliefs"])

    def accepted(fit: Any, claims: Any) -> Any:
        here = "+".join(claims)
        if here in ("other", "third"):
            return None
        return replace(fit.believing(claims=tuple(claimed(tooth=k) for k in range(few))), here=here)

    monkeypatch.setattr(f"{module}.accepted", accepted)
    ended, _ = run_search(walk(*(claimed(tooth=k) for k in range(CLAIMS_TO_DOUBT_ONE_END)), beyond=0.0))
    assert ended.here == end
    assert asked == looks


@pytest.mark.parametrize("worths", [{"start": 100.0}])
@pytest.mark.parametrize(
    ("beyond", "teeth", "gain", "stay"),
    [
        (300.0, MOST_CLAIMS - 1, 400.0, 1),  # of 1000 missing a part is left, and there is no end
        (300.0, MOST_CLAIMS - 1, 200.0, 0),  # nor is what explains less than that
        (30.0, MOST_CLAIMS - 1, 400.0, MOST_CLAIMS),  # so many pits explain it
        (300.0, MOST_CLAIMS - 2, 400.0, MOST_CLAIMS - 1),  # the search has come to an end
    ],
)
@pytest.mark.usefixtures("asked")
def test_faults_of_teeth_that_do_not_end_keep_no_name(
    beyond: float, teeth: int, gain: float, stay: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gearpoly.diagnose.search.gain_without", lambda fit, k: gain)
    end = disowned(walk(claimed(), *(claimed(tooth=k) for k in range(teeth)), beyond=beyond), 1000.0)
    assert len(end.model.claims) == stay
    assert end.disowned == teeth + 1 - stay


@pytest.mark.parametrize(
    ("worths", "broken", "end"),
    [
        ({"first": 100.0, "other": 50.0, "third": 70.0}, (), "other"),  # the best of all ends
        ({"first": 100.0, "other": 95.0, "third": 97.0}, (), "first"),  # not better by as much as chance makes
        ({"first": 100.0, "other": 10.0, "third": 70.0}, ("other",), "third"),  # what is no state is no end
        ({"first": 100.0, "other": 10.0, "third": 20.0}, ("other", "third"), "first"),
    ],
)
@pytest.mark.usefixtures("asked")
def test_the_best_end_is_kept(end: str) -> None:
    ended, found = run_search(walk())
    assert ended.here == end
    assert found == ([] if end == "first" else [end])


@pytest.mark.parametrize("worths", [{"first": 100.0, "other": 10.0, "third": 20.0}])
@pytest.mark.usefixtures("asked")
def test_nothing_is_gone_back_to_where_little_is_left() -> None:
    assert run_search(walk(beyond=100.0))[0].here == "first"


@pytest.mark.parametrize(
    ("worths", "end"),
    [
        ({"first": 100.0, "without": 80.0, "further": 40.0}, "further"),  # the claim held the teeth in a local minimum
        ({"first": 100.0, "without": 95.0, "further": 40.0}, "without"),  # nothing was saved but its freedoms
    ],
)
def test_what_fits_better_without_a_claim_is_looked_at_once_more(
    asked: list[int], end: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = "gearpoly.diagnose.search"
    monkeypatch.setattr(f"{module}.withdrawn", lambda fit: replace(fit, here="without") if fit.here == "first" else fit)

    def forward(fit: Any, *given: Any, **how: Any) -> tuple[Any, list[Any], list[Road]]:
        asked.append(len(fit.here))
        if fit.here == "start":
            return replace(fit, here="first"), [], []
        return replace(fit, here="further", model=replace_model(fit)), ["looked"], []

    monkeypatch.setattr(f"{module}.forward", forward)
    ended, found = run_search(walk(beyond=0.0))
    assert (ended.here, found) == (end, ["looked"] if end == "further" else [])


def replace_model(fit: Any) -> Any:
    """Another model than that of a fit, which claims as much."""
    return SimpleNamespace(**vars(fit.model))
