"""One physics of all teeth in the stead of several that a search made of it step by step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.fit import joined, settled
from gearpoly.diagnose.one_for_all import one_for_all
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from tests.physics_cases import Condition, recorded, rough, scope_of


def of_all(name: str, gear: int, *values: float) -> Claim:
    """A physics of all teeth of a gear."""
    physics = catalogue()[name]
    place = next(one for one in physics.places(scope_of(rough((12, 16)))) if one.gear == gear)
    return Claim(physics=physics, place=place, values=values)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("true", "begun", "ends"),
    [
        ([("wear", 1, 20.0)], [("tip_relief", 0, 25.0, 0.9), ("profile_slope", 0, 30.0)], ["wear"]),
        (
            [("tip_relief", 0, 15.0, 0.9), ("tip_relief", 1, 15.0, 0.9)],
            [("tip_relief", 0, 15.0, 0.9), ("tip_relief", 1, 15.0, 0.9)],
            ["tip_relief", "tip_relief"],
        ),
    ],
)
def test_what_one_explains_as_well_is_one(
    true: list[tuple[str, int, float]], begun: list[tuple[str, int, float]], ends: list[str], tmp_path: Path
) -> None:
    """20 um of wear of the driven gear, fitted with a relief and a slope of the driving one, are the wear; two reliefs
    are two. The size to 3 %: teeth of a grade may take a part of it."""
    known = rough((12, 16), bends=False)
    made = known
    for name, gear, *values in true:
        made = of_all(name, gear, *values).written(made)
    (one,) = recorded(made, (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=4.0, per_mesh=16)
    path = tmp_path / "pair.toml"
    model = prepare(known, compare(known, [one], path=path), path=path)
    search = from_declared(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    search = settled(joined(search, [of_all(name, gear, *values) for name, gear, *values in begun]))
    search = one_for_all(search)
    assert [claim.physics.name for claim in search.model.claims] == ends
    if ends == ["wear"]:
        (wear,) = search.model.claims
        assert wear.place.gear == 1
        assert wear.values[0] == pytest.approx(20.0, rel=0.03)
