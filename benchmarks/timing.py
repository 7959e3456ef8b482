"""How long work takes, for all benchmarks that compare two ways in one run."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

REPEATS = 5


def seconds(work: Callable[[], object]) -> float:
    """Median processor time in s of ``REPEATS`` runs after one that warms up."""
    work()
    times = []
    for _ in range(REPEATS):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return float(np.median(times))
