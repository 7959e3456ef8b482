"""What a diagnosis says of itself as a whole."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from gearpoly.diagnose.diagnose import _of_another_pair
from gearpoly.diagnose.search import MOST


def ended(claims: int, left: float) -> Any:
    """A search that named so much and leaves that mean square, in noise."""
    system = SimpleNamespace(whiteness=left)
    return SimpleNamespace(model=SimpleNamespace(claims=[None] * claims), linear=SimpleNamespace(system=system))


@pytest.mark.parametrize(
    ("claims", "left", "says"),
    [
        (0, 1.02, None),
        (3, 1.3, None),
        (MOST, 1.1, f"{MOST} physics are named: perhaps"),
        (1, 10.0, "1 physics are named, and 3.0 times the noise is left"),
        (0, 5.0, "nothing is named, and 2.0 times the noise is left"),
    ],
)
def test_the_pair_is_doubted_where_its_physics_do_not_end(claims: int, left: float, says: str | None) -> None:
    remarks = list(_of_another_pair(ended(claims, left)))
    assert len(remarks) == (says is not None)
    if says is not None:
        assert remarks[0].startswith(says)
        assert "another pair" in remarks[0]
