"""Closed chains of index deviations: single pitches within f_p, all of them within F_p, back where they started.

Drawing whole gears until one passes accepts one in ten million at 200 teeth. Large gears are therefore drawn tooth by
tooth from the same conditional distribution.
"""

from __future__ import annotations

import math

import numpy as np

from gearpoly.errors import NoGearPassesError
from gearpoly.units import UM, FloatArray, IntArray

MAX_CHAINS = 200_000
"""Proposals for one chain of index deviations. The worst accepted rate in use is about 1 in
1000."""


def closed_chain(z: int, *, f: float, F: float, rng: np.random.Generator) -> FloatArray:
    """Index deviations (z,) in mm of one side, the first 0: uniform among all that keep both pitch
    limits and close.

    Steps are at most ``f`` (mm), also from the last tooth to the first, and the range is at most
    ``F`` (mm): independent uniform steps, given that they close and keep F. Loose limits are met by
    drawing again. Tight ones, which chance meets once in millions, by forward filtering and
    backward sampling in cells, with the place within each cell drawn last; what then breaks a limit
    is drawn again, so the cells leave no trace in the distribution (derived here).
    """
    f = min(f, F)
    if f <= 0.0:
        return np.zeros(z)
    # A closed chain ranges over 1.25 of this root on average; below it fewer than 1 in 50 fit.
    if min(f * math.sqrt(z / 3.0), f * (z // 2)) <= F:
        return _chain_by_rejection(z, f, F, rng)
    return _chain_in_corridor(z, f, F, rng)


def _chain_by_rejection(z: int, f: float, F: float, rng: np.random.Generator) -> FloatArray:
    rows = max(1, 20_000 // z)
    for _ in range(1 + MAX_CHAINS // rows):
        chains = np.zeros((rows, z))
        np.cumsum(rng.uniform(-f, f, (rows, z - 1)), axis=1, out=chains[:, 1:])
        good = (np.abs(chains[:, -1]) <= f) & (np.ptp(chains, axis=1) <= F)
        if np.any(good):
            first: FloatArray = chains[int(np.argmax(good))].copy()
            return first
    raise NoGearPassesError(_chain_message(z, f, F))


def _chain_message(z: int, f: float, F: float) -> str:
    return (
        f"no chain of {z} index deviations within f_pT = {f / UM:.3g} um and F_pT = {F / UM:.3g} "
        f"um was found; "
        f"a larger F_pT (or a smaller f_pT) would do"
    )


def _chain_in_corridor(z: int, f: float, F: float, rng: np.random.Generator) -> FloatArray:
    """The same distribution as by rejection, for tight F: a corridor a little wider than F, of
    cells of width f/K."""
    # The number of chains grows as exp(range / gap) near F; one gap wider accepts most.
    gap = min(0.5 * F, 3.0 * F**3 / (z * math.pi**2 * f**2))
    # K cells a step lose exp(-z/2K) of all draws; 8e6 cells in all (64 MB) bound the memory.
    K = math.ceil(min(max(z, 64), 8e6 * f / (z * F)))
    h = f / K
    N = math.ceil((F + gap) / h)
    slack = N * h - F
    centre = _forward(z, N, K, N // 2)[1]
    for _ in range(MAX_CHAINS):
        start = int(rng.integers(N))
        # Chains that start at the centre are the most: the count is log-concave and even.
        messages, ways = _forward(z, N, K, start)
        if rng.random() > math.exp(min(0.0, ways - centre)):
            continue
        cells = _backward(messages, K, start, rng)
        chain = (cells + rng.random(z)) * h
        # A chain wider than F goes; the others fit the corridor in (N h - range) places.
        if np.max(np.abs(np.roll(chain, -1) - chain)) > f or np.ptp(chain) > F:
            continue
        if rng.random() * (N * h - float(np.ptp(chain))) <= slack:
            index: FloatArray = chain - chain[0]
            return index
    raise NoGearPassesError(_chain_message(z, f, F))


def _forward(z: int, N: int, K: int, start: int) -> tuple[FloatArray, float]:
    """Weights (z, N) of reaching each cell from ``start`` by steps of at most K cells, each row of
    sum 1; and the log of the number of closed chains."""
    messages = np.zeros((z, N))
    messages[0, start] = 1.0
    low = np.maximum(np.arange(N) - K, 0)
    high = np.minimum(np.arange(N) + K + 1, N)
    total = np.zeros(N + 1)
    ways = 0.0
    for t in range(1, z):
        np.cumsum(messages[t - 1], out=total[1:])
        row = total[high] - total[low]
        size = float(np.sum(row))
        messages[t] = row / size
        ways += math.log(size)
    return messages, ways + math.log(float(np.sum(messages[-1, low[start] : high[start]])))


def _backward(messages: FloatArray, K: int, start: int, rng: np.random.Generator) -> IntArray:
    """One closed chain of cells (z,) drawn from the last to the first by its ``messages``."""
    z, N = (int(size) for size in messages.shape)
    cells = np.empty(z, dtype=np.int64)
    cells[0] = at = start
    pick = rng.random(z)
    for t in range(z - 1, 0, -1):
        low = max(at - K, 0)
        weights = np.cumsum(messages[t, low : min(at + K + 1, N)])
        mark = pick[t] * weights[-1]
        at = low + int(np.searchsorted(weights, mark, side="right"))
        cells[t] = at
    return cells
