"""A search is begun again where another physics stands better, and what it told of the first place is kept."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from gearpoly.diagnose.contest import Refitted
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
