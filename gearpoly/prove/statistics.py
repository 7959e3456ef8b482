"""Shares of cases with the interval that so few cases leave."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

Z = 1.959963984540054
"""Standard normal quantile of a 95 % interval."""


@dataclass(frozen=True, kw_only=True)
class Share:
    """``hits`` of ``of`` cases with the Wilson interval [``low``, ``high``] of the rate, 95 %; NaN of none."""

    hits: int
    of: int

    @property
    def rate(self) -> float:
        """Hits over cases."""
        return self.hits / self.of if self.of else math.nan

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return self._wilson(-1.0)

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return self._wilson(1.0)

    def _wilson(self, side: float) -> float:
        """E. B. Wilson, JASA 22 (1927) 209-212: honest also at 0 of n and n of n."""
        n = self.of
        if not n:
            return math.nan
        p, z2 = self.rate, Z**2
        middle = p + z2 / (2 * n)
        half = Z * math.sqrt(p * (1 - p) / n + z2 / (4 * n**2))
        end = (middle + side * half) / (1 + z2 / n)
        # At 0 of n and n of n one end is the rate itself, whatever rounding says.
        return max(end, p) if side > 0.0 else max(0.0, min(end, p))

    def to_json(self) -> dict[str, Any]:
        """Counts, rate and interval; None where there were no cases."""
        if not self.of:
            return {"hits": 0, "of": 0, "rate": None, "interval_95": None}
        return {"hits": self.hits, "of": self.of, "rate": self.rate, "interval_95": [self.low, self.high]}


def share(values: Sequence[bool]) -> Share:
    """The share of true values."""
    return Share(hits=sum(values), of=len(values))


def quantile(values: Sequence[float], q: float) -> float | None:
    """A quantile; None of none."""
    return float(np.quantile(np.asarray(values), q)) if len(values) else None
