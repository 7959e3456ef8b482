"""What a fit leaves is located however the fitted gears run between the samples."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from gearpoly.diagnose.residuals import locate_residuals
from gearpoly.errors import OutOfRangeError


class AskedTwiceError(Exception):
    """The second set of curves was asked for."""


def test_gears_that_bend_too_far_between_the_samples_share_as_the_declared_ones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[str] = []

    def sharings_of(assembled: str, conditions: Any) -> Any:
        asked.append(assembled)
        raise OutOfRangeError("teeth bend by more than 5% of the module") if len(asked) == 1 else AskedTwiceError

    monkeypatch.setattr("gearpoly.diagnose.residuals.sharings_of", sharings_of)
    model = SimpleNamespace(assembled=lambda file="fitted": file, declared="declared")
    with pytest.raises(AskedTwiceError):
        locate_residuals(SimpleNamespace(model=model, scenes=[]), SimpleNamespace(gears=()), [])  # type: ignore[arg-type]
    assert asked == ["fitted", "declared"]
