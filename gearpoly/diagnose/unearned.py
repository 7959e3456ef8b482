"""A place that was located and did not earn a name."""

from __future__ import annotations

from dataclasses import dataclass

from gearpoly.infer.posterior import Posterior
from gearpoly.physics.base import Claim


@dataclass(frozen=True, kw_only=True)
class Unearned:
    """A ``claim`` that did not earn its name, with the ``rms`` in mm of what it did.

    ``posterior`` the probabilities at its place, none where time was over first; ``seen``: it is told only where
    something is located there in the end, since no claim was ever fitted.
    """

    claim: Claim
    rms: float
    posterior: Posterior | None
    seen: bool = False
