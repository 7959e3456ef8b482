"""What a diagnosis says of itself as a whole."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from gearpoly.diagnose.remarks import _of_another_pair, of_compliance
from gearpoly.diagnose.search import MOST_CLAIMS
from tests.made_fits import MadeFit


def ended(claims: int, left: float, disowned: int) -> Any:
    """A search that named so much, took so much back, and leaves that mean square, in noise."""
    model, linear = SimpleNamespace(claims=[None] * claims), SimpleNamespace(system=SimpleNamespace(whiteness=left))
    return MadeFit(model=model, linear=linear, disowned=disowned)


@pytest.mark.parametrize(
    ("claims", "left", "disowned", "says"),
    [
        (0, 1.02, 0, None),
        (3, 1.3, 0, None),
        (MOST_CLAIMS, 1.1, 0, f"{MOST_CLAIMS} physics are named: perhaps"),
        (1, 10.0, 0, "1 physics are named, and 3.0 times the noise is left"),
        (0, 5.0, 0, "nothing is named, and 2.0 times the noise is left"),
        (1, 1.1, 7, "1 physics are named, since 7 more would explain but a part"),
    ],
)
def test_the_pair_is_doubted_where_its_physics_do_not_end(
    claims: int, left: float, disowned: int, says: str | None
) -> None:
    remarks = list(_of_another_pair(ended(claims, left, disowned)))
    assert len(remarks) == (says is not None)
    if says is not None:
        assert remarks[0].startswith(says)
        assert "another pair" in remarks[0]


@pytest.mark.parametrize(
    ("scale", "says"),
    [
        (None, None),
        ((1.12, 0.01), None),  # laws differ by as much
        ((0.513, 0.005), "0.51 times as much"),  # 36 N.m on the driving shaft, 90 stated
        ((2.674, 0.009), "2.67 times as much"),  # a tilt
    ],
)
def test_teeth_far_softer_than_any_law_has_them_say_what_to_check(
    scale: tuple[float, float] | None, says: str | None
) -> None:
    said = list(of_compliance(scale))
    assert len(said) == (says is not None)
    if says is not None:
        assert says in said[0]
        assert "check torque_nm" in said[0]
        assert ("shafts that give" in said[0]) == (scale is not None and scale[0] > 1.0)  # they make nothing harder
