"""How long a diagnosis may look, and by how much longer what was found is weighed."""

from __future__ import annotations

import pytest

from gearpoly.diagnose.budget import WEIGHING_OVER_SEARCH, Budget


def test_time_is_prolonged_once() -> None:
    """What was begun in the time that weighing has is not given still more."""
    budget = Budget(seconds=60.0)
    assert budget.further.seconds == pytest.approx(60.0 * WEIGHING_OVER_SEARCH)
    assert budget.further.further == budget.further
    assert budget.further.begun == budget.begun
