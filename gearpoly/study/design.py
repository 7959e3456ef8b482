"""Which pair has which number: combinations of the sweeps, draws of each, and the random stream of every pair.

Row ``index`` of the table is draw ``index // combinations`` of combination ``index % combinations``: the first rows
hold a little of everything, more pairs only add rows behind, and nothing depends on who computes a row or when.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from gearpoly.errors import OutOfRangeError
from gearpoly.study.keys import is_whole
from gearpoly.study.models import StudyFile, Sweep
from gearpoly.units import FloatArray

CHANCE_FACTOR = "chance"
"""Name of the factor that stands for what the grade leaves to chance."""

MOST_COMBINATIONS = 2_000_000
"""Combinations of all sweeps above which a study is taken for a slip: their list alone would take gigabytes."""


@dataclass(frozen=True, kw_only=True)
class Design:
    """The combinations of one study file."""

    file: StudyFile

    @cached_property
    def plain(self) -> tuple[Sweep, ...]:
        """Sweeps over lists and grids."""
        return tuple(sweep for sweep in self.file.sweep if sweep.method != "sobol")

    @cached_property
    def ranges(self) -> tuple[Sweep, ...]:
        """Sweeps over ranges by Sobol points."""
        return tuple(sweep for sweep in self.file.sweep if sweep.method == "sobol")

    @cached_property
    def levels(self) -> tuple[tuple[Any, ...], ...]:
        """The values of each list and grid, in the order of ``plain``."""
        return tuple(_levels(sweep) for sweep in self.plain)

    @property
    def blocks(self) -> int:
        """Rows per Sobol point: 1, or for sensitivity A, B and one per factor, chance among them."""
        return len(self.ranges) + 3 if self.file.sensitivity else 1

    @cached_property
    def points(self) -> FloatArray:
        """Scrambled Sobol points (samples, d) in 0..1, both halves for sensitivity; (1, 0) where no sweep asks."""
        if not self.ranges or self.file.samples is None:
            return np.zeros((1, 0))
        from scipy.stats import qmc  # slow to import, and few studies sweep ranges

        d = len(self.ranges) * (2 if self.file.sensitivity else 1)
        # Its own stream: the pairs drawn stay the same whatever is swept.
        rng = np.random.default_rng(np.random.SeedSequence(self.file.seed, spawn_key=(0, 1)))
        points: FloatArray = qmc.Sobol(d, scramble=True, rng=rng).random_base2(self.file.samples.bit_length() - 1)
        return points

    @property
    def combinations(self) -> int:
        """Combinations of all sweeps. Raises ``OutOfRangeError`` where they are past counting."""
        count = int(self.points.shape[0]) * self.blocks
        for values in self.levels:
            count *= len(values)
        if count > MOST_COMBINATIONS:
            raise OutOfRangeError(f"the sweeps have {count} combinations; {MOST_COMBINATIONS} at most would do")
        return count

    @property
    def rows(self) -> int:
        """Rows of the whole table."""
        return self.combinations * self.file.pairs

    @property
    def keys(self) -> tuple[str, ...]:
        """Every key that is swept, in the order of the file: columns of the table."""
        return tuple(key for sweep in self.file.sweep for key in sweep.all_keys)

    def place(self, index: int) -> tuple[int, int]:
        """Combination and draw of row ``index``."""
        draw, combination = divmod(index, self.combinations)
        return combination, draw

    def stream(self, index: int) -> int:
        """Number of the random stream of row ``index``."""
        combination, draw = self.place(index)
        if self.file.sensitivity:
            # Chance is the last factor: A and B have streams of their own, and the last block is A with B's.
            point, block = divmod(combination, self.blocks)
            return 2 * point + int(block in (1, self.blocks - 1))
        return index if self.file.draws == "own" else draw

    def seed(self, index: int) -> int:
        """Seed of the pair of row ``index``, 63 bits: ``gearpoly simulate --seed`` draws the same gears from it."""
        sequence = np.random.SeedSequence(self.file.seed, spawn_key=(self.stream(index),))
        return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(1))

    def values(self, combination: int) -> dict[str, Any]:
        """Values of all swept keys of one combination, in the order of the file."""
        rest, block = divmod(combination, self.blocks)
        rest, point = divmod(rest, self.points.shape[0])
        found: dict[str, Any] = {}
        for sweep, values in zip(reversed(self.plain), reversed(self.levels), strict=True):
            rest, k = divmod(rest, len(values))
            found |= _assigned(sweep, values[k])
        for k, sweep in enumerate(self.ranges):
            half = len(self.ranges) if block == 1 or (block >= 2 and block - 2 == k) else 0
            found |= _assigned(sweep, _scaled(sweep, float(self.points[point, half + k])))
        return {key: found[key] for key in self.keys}

    def corners(self) -> list[dict[str, Any]]:
        """Combinations that a reader of the file would try first: each end of every sweep with the rest at its
        first value."""
        first = {key: value for sweep in self.file.sweep for key, value in _assigned(sweep, _ends(sweep)[0]).items()}
        ends = [first | _assigned(sweep, end) for sweep in self.file.sweep for end in _ends(sweep)]
        return ends or [first]


def _levels(sweep: Sweep) -> tuple[Any, ...]:
    if sweep.method == "list":
        assert sweep.values is not None  # the file was checked
        return sweep.values
    assert sweep.start is not None  # as above
    assert sweep.to is not None
    assert sweep.steps is not None
    values = np.linspace(sweep.start, sweep.to, sweep.steps).tolist()
    if all(is_whole(key) for key in sweep.all_keys):
        whole = [round(value) for value in values]
        if any(abs(a - b) > 1e-9 for a, b in zip(whole, values, strict=True)):  # rounding of linspace, no more
            raise OutOfRangeError(
                f"{sweep.all_keys[0]} takes whole numbers, but a grid of {sweep.steps} steps from {sweep.start:g} to "
                f"{sweep.to:g} does not hit them; other steps, or a list, would do"
            )
        return tuple(whole)
    return tuple(values)


def _ends(sweep: Sweep) -> list[Any]:
    if sweep.method == "sobol":
        return [_scaled(sweep, 0.0), _scaled(sweep, np.nextafter(1.0, 0.0))]
    levels = _levels(sweep)
    return list(levels)


def _assigned(sweep: Sweep, value: Any) -> dict[str, Any]:
    keys = sweep.all_keys
    values = value if isinstance(value, tuple) else itertools.repeat(value, len(keys))
    return dict(zip(keys, values, strict=True))


def _scaled(sweep: Sweep, u: float) -> Any:
    """A place ``u`` in 0..1 of a range; every whole number of a range of whole ones is equally likely."""
    assert sweep.start is not None  # the file was checked
    assert sweep.to is not None
    if all(is_whole(key) for key in sweep.all_keys):
        return min(int(sweep.start + u * (sweep.to - sweep.start + 1.0)), int(sweep.to))
    return sweep.start + u * (sweep.to - sweep.start)
