"""What the model is worth on data that its fit never saw."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Observed
from gearpoly.diagnose.sparse import Sparse
from gearpoly.diagnose.system import Mask, System
from gearpoly.physics.base import Claim
from gearpoly.units import UM, FloatArray

BLOCKS_BETWEEN_JUMPS = 4
"""Blocks into which every stretch between jumps is cut where a recording jumps: a level after a jump is not to be
foretold from what was before."""

SLOW_BLOCKS_BETWEEN_JUMPS = 8
"""The same where something slow is asked for, which may swing from end to end within a third of a recording: the first
block is foretold from what came later, and what warms up happens there."""


@dataclass(frozen=True, kw_only=True)
class Rms:
    """Root mean squares in mm over all samples: on the samples that the fit saw, and on those that it did not."""

    seen: float
    unseen: float


WELL_ABOVE = 1.1
"""Times the noise from which on what is left is said to be more than is understood. A judgement: "left 1 times the
noise" was said of 1.01."""


@dataclass(frozen=True, kw_only=True)
class Checked:
    """Mean square of what is left of unseen samples, 1 where noise alone is: of the ``declared`` simulation, of
    ``as_built`` teeth alone, and with all ``named`` physics; ``std`` of the lesser of what names gain; ``rms`` in mm
    of held-out samples without names and with them, of which ``noise`` is to be left and ``expected``, with what one
    part of the recordings cannot know of the other; ``larger``: more was left with names than without, by more than it
    is known to. ``refused``: names that were taken back, each with the rms in mm of what it does; ``unchecked``: those
    that were since nothing repeats them, so that nothing unseen tells of them; ``unfinished``: those that were since
    time ended before all was asked; ``of_keys``: those that were since a key of the pair file was put right."""

    declared: float
    as_built: float
    named: float
    std: float
    rms: tuple[float, float]
    noise: float
    expected: float
    larger: bool = False
    refused: tuple[tuple[Claim, float], ...] = ()
    unchecked: tuple[tuple[Claim, float], ...] = ()
    unfinished: tuple[tuple[Claim, float], ...] = ()
    of_keys: tuple[tuple[Claim, float], ...] = ()

    @property
    def taken_back(self) -> tuple[tuple[Claim, float], ...]:
        """All names that were."""
        return (*self.refused, *self.unchecked, *self.unfinished, *self.of_keys)

    @property
    def says(self) -> Iterator[str]:
        """A word about what was taken back, and about what could not be checked."""
        if self.refused:
            names = ", ".join(_names(self.refused))
            without, with_ = self.rms
            why = "fit no better with it than without"
            if self.larger and self.named < self.as_built:
                why = "are left larger with it than without"
            elif not self.larger and with_ > WELL_ABOVE * self.expected:
                why = f"are left {with_ / self.noise:.2g} times the noise, so that more is in them than is understood"
            yield (
                f"not named, since unseen data {why}: {names} (mean square "
                f"over that of the noise: {self.named:.4g} with names, {self.as_built:.4g} with as-built teeth alone, "
                f"{self.declared:.4g} as declared, +- {self.std:.2g}; rms {with_ / UM:.4g} um with names, "
                f"{without / UM:.4g} without)"
            )
        for name in _names(self.unfinished):
            yield (
                f"not named, since time ended with more left than noise: {name} (what is "
                "left may be of another cause that makes this one needless; give it longer with --within SECONDS)"
            )
        for name in _names(self.of_keys):
            yield (
                f"not named, since a key of the pair file was put right by the recordings: {name} (by how much that "
                "key is still off looks alike; write into the pair file what the drawing says, and run again)"
            )
        for name in _names(self.unchecked):
            yield (
                f"not named, since no unseen data tell of it: {name} (in these "
                "recordings it came once only, or hardly more often where noise wanders; record more turns)"
            )


def _names(these: Sequence[tuple[Claim, float]]) -> list[str]:
    """The physics of claims, each once."""
    return list(dict.fromkeys(one.physics.name.replace("_", " ") for one, _ in these))


def cross_validated(
    linear: Linear, masks: list[Mask], *, leave: list[int] | None = None, hold: list[int] | None = None
) -> Rms:
    """Fit on one part and look at the other, then the other way round; ``leave`` parameters out, ``hold`` others at
    what the whole recordings gave: a drift says nothing about the part that was not seen.

    Where a part is empty (nothing was held out), both figures are those of the whole.
    """
    if hold:
        linear, leave = held(linear, hold), sorted({*(leave or []), *hold})
    system, columns = linear.system, linear.columns
    if leave:
        system = system.without(leave)
        keep = np.setdiff1d(np.arange(linear.system.size), np.asarray(leave))
        columns = [c.only(keep) for c in columns]
    others = [~mask for mask in masks]
    if not all(np.any(mask) for mask in others):
        whole = _rms(system, columns, linear.target, masks)
        return Rms(seen=whole, unseen=whole)
    seen, unseen = [], []
    for fit, rest in ((masks, others), (others, masks)):
        x = system.at(fit).solution
        seen.append(_square(x, columns, linear.target, fit))
        unseen.append(_square(x, columns, linear.target, rest))
    return Rms(seen=_root(seen), unseen=_root(unseen))


def foretold_to(linear: Linear, masks: list[Mask], noise: float, *, hold: list[int]) -> float:
    """The rms in mm that unseen samples may be left at, ``noise`` (mm) and what the part that was seen does not tell
    of the others: the variance of a prediction (Bishop 2006, equation 3.59), and twice what it scatters by itself, as a
    sum of few squares. Half of a recording that holds one hunting cycle hardly knows a wave beside an order of a shaft
    from that order."""
    system, columns = linear.system.without(hold), linear.columns
    keep = np.setdiff1d(np.arange(linear.system.size), np.asarray(hold, dtype=np.int64))
    others = [~mask for mask in masks]
    if not all(np.any(mask) for mask in others):
        return noise
    mean, variance, count = 0.0, 0.0, 0
    for fit, rest in ((masks, others), (others, masks)):
        unseen = [own.rows(mask).only(keep) for own, mask in zip(columns, rest, strict=True)]
        doubt = system.at(fit).covariance @ sum(a.gram() for a in unseen)
        mean += float(np.trace(doubt))
        variance += 2.0 * float(np.sum(doubt * doubt.T))
        count += sum(a.shape[0] for a in unseen)
    return math.hypot(noise, math.sqrt(max(0.0, mean + 2.0 * math.sqrt(max(0.0, variance))) / max(1, count)))


def beside_jumps(observed: Sequence[Observed], jumps: list[list[int]]) -> tuple[Observed, ...]:
    """The recordings with their parts chosen such that both hold samples before and after every one of ``jumps``."""
    return tuple(
        replace(one, fit=blocks(one.fit.size, at), jumps=tuple(at)) if at else one
        for one, at in zip(observed, jumps, strict=True)
    )


def blocks(size: int, jumps: Sequence[int] = (), *, parts: int = BLOCKS_BETWEEN_JUMPS) -> Mask:
    """Every other block (size,) of each stretch between jumps: of what goes on slowly, one half of a recording says
    nothing about the other, but its blocks say what lies between them."""
    lengths = np.diff([0, *sorted(jumps), size])
    return np.concatenate([(np.arange(n) * parts // max(n, 1)) % 2 == 0 for n in lengths.tolist()])


def held(linear: Linear, places: list[int]) -> Linear:
    """The same with what the solution gives ``places`` taken off the targets."""
    x = np.zeros(linear.system.size)
    x[places] = linear.system.solution[places]
    target = [y - a @ x for y, a in zip(linear.target, linear.columns, strict=True)]
    white = [y - a @ x for y, a in zip(linear.system.target, linear.system.white, strict=True)]
    return replace(linear, target=target, system=replace(linear.system, target=white))


def _rms(system: System, columns: list[Sparse], target: list[FloatArray], masks: list[Mask]) -> float:
    return _root([_square(system.solution, columns, target, masks)])


def _square(x: FloatArray, columns: list[Sparse], target: list[FloatArray], masks: list[Mask]) -> tuple[float, int]:
    left = [(y - a @ x)[mask] for a, y, mask in zip(columns, target, masks, strict=True)]
    return sum(float(r @ r) for r in left), sum(r.size for r in left)


def _root(parts: list[tuple[float, int]]) -> float:
    return math.sqrt(sum(square for square, _ in parts) / max(1, sum(number for _, number in parts)))


def repeatable(rms: float, noise: float) -> float:
    """What of an rms is no noise, mm."""
    return math.sqrt(max(rms**2 - noise**2, 0.0))


def log_predictive(system: System, seen: list[Mask]) -> float:
    """Log probability of all other samples by what the ``seen`` ones tell and what was known beforehand, but for a
    constant of the samples alone: the evidence of all over that of the seen ones (Bishop 2006, equation 3.86), and half
    of what was known beforehand: an inspection is seen by both halves, and what contradicts it pays too.

    What the seen ones leave open costs no more than that. Half of 13 turns of a shaft knew waves of 0.62 and 1.25 per
    turn so badly that the other half lay 300 noises off, and told nothing of 20 um of a profile slope.
    """
    half = system.at(seen)
    cost = system.misfit - half.misfit + 0.5 * half.strain
    return -0.5 * (cost + system.log_determinant - half.log_determinant)
