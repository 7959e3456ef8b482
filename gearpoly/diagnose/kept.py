"""States of a fit to come back to."""

from __future__ import annotations

from typing import Any

Kept = tuple[dict[str, Any], dict[str, Any]]
"""A state to come back to: of the model, and of the fit."""


def without_columns(kept: Kept) -> Kept:
    """A state without what the next fit makes anew, which is large: a hundred columns at all samples."""
    return kept[0], {name: value for name, value in kept[1].items() if name not in ("scenes", "linear")}
