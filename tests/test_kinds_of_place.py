"""Which physics stand against each other at one place."""

from __future__ import annotations

import pytest

from gearpoly.infer.prior import same_place
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        # At one torque axes that stand apart and axes that give way are the same; both open the backlash.
        ("centre_distance", "support_compliance", True),
        ("centre_distance", "shaft_windup", True),
        # What moves the axes hands over elsewhere at every mesh, as a crowning does.
        ("centre_distance", "profile_crowning", True),
        # A mean cannot be told from a mean, and a ripple not from a ripple.
        ("shaft_windup", "support_compliance", True),
        ("shaft_windup", "profile_crowning", False),
    ],
)
def test_what_moves_the_axes_shows_at_the_mesh_and_between_recordings(one: str, other: str, alike: bool) -> None:
    claims = [Claim(physics=catalogue()[name], place=Place(), values=(1.0,)) for name in (one, other)]
    assert same_place(claims[0], claims[1]) is same_place(claims[1], claims[0]) is alike
