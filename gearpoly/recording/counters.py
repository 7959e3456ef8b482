"""The readings of an encoder's counter: where it goes round, or is set back by the index pulse, and what that tells.

A counter of 16 or 32 bits goes round at 65 536 or 4 294 967 296, others once a turn of the shaft or at any number; one
that is set to 0 by the index goes round there too, but for counts that were lost. All of them are undone by taking
from sample to sample the step that is nearest to none, modulo what the counter goes round at. Readings below zero are
no matter. A counter that begins anywhere is set to 0 where the index comes first, by less than a turn: what was read
before has no known place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.by_readings import begins_again_about
from gearpoly.recording.deeds import in_full
from gearpoly.recording.pulses import unwrap_counter
from gearpoly.units import BoolArray, FloatArray, IntArray

COUNTER_JUMP_STEPS = 50.0
"""Large steps from sample to sample (nineteen of twenty are smaller) beyond which a counter was set back or went round:
no shaft runs up so much within a sample. Half a turn is enough where it is ten of them."""

JUMP_LEAST = 16.0
"""Counts below which a jump is none: a counter that stands still has no usual step."""

QUARTER = 0.25
"""Part of what a counter goes round at, up to which usual steps tell the direction beyond doubt."""

TURNS_MOST = 8
"""Turns of the shaft after which a counter may go round, where nobody says so: multi-turn encoders have powers of two
beyond."""

BITS = range(8, 33)
"""Widths of counters that are tried where nobody states one."""

MODULUS_MOST_STEPS_OFF = 4.0
"""Usual steps by which a jump may be off what a counter goes round at: the shaft turned on by one meanwhile, at a speed
of its own."""

FEWEST_READINGS_FOR_INDEX = 16
"""Readings from which it is told where the index set a counter: its usual step has to be known."""


@dataclass(frozen=True, kw_only=True)
class Counter:
    """A counter's channel ``name``, counts ``per_turn`` of its shaft, and what it goes round at (``modulus``) if that
    is stated."""

    file: Path
    name: str
    per_turn: float
    modulus: float | None = None


def counted(counter: Counter, raw: FloatArray, remarks: list[str]) -> FloatArray:
    """Counts (n,) without jumps where the counter goes round; ``nan`` stays. What was found is put into ``remarks``.

    Raises ``InputFileError`` where steps are so large that the direction is open, and where the counter jumps by what
    no counter goes round at.
    """
    if counter.modulus in (None, counter.per_turn):
        raw = from_the_index(counter.name, raw, counter.per_turn, remarks)
    good = np.isfinite(raw)
    steps = np.diff(raw[good])
    if not steps.size:
        return raw
    if counter.modulus is not None:
        count = unwrap_counter(raw, counter.modulus)
        usual = float(np.median(np.abs(np.diff(count[good]))))
        if usual > QUARTER * counter.modulus:
            wish = f"want at most a quarter of its {in_full(counter.modulus)}; check where it wraps, or sample faster"
            found = f"{in_full(usual)} counts from sample to sample"
            raise InputFileError(counter.file, where=f"column {counter.name}", found=found, wish=wish)
        return count
    jumps = _jumps(steps, np.diff(np.flatnonzero(good)), counter.per_turn)
    if not jumps.any():
        return raw
    modulus = _found(counter.per_turn, steps, jumps)
    row = int(np.flatnonzero(good)[int(np.argmax(jumps)) + 1]) + 1
    if modulus is None:
        found_about = begins_again_about(raw)
        guess = f"{float(np.median(np.abs(steps[jumps] - np.median(steps[~jumps])))):.0f}"
        if found_about is not None:  # the steps beside each jump tell it closer than the usual one
            guess = f"{found_about[0]:.0f} +- {math.ceil(found_about[1])}"
        wish = (
            f"want {counter.name}_modulus, about {guess}, if the counter goes round there, or a recording without "
            "a reset"
        )
        found = f"a jump by {in_full(steps[int(np.argmax(jumps))])}"
        raise InputFileError(counter.file, where=f"column {counter.name}, row {row}", found=found, wish=wish)
    count = unwrap_counter(raw, modulus)
    what = "once a turn, or is set back by the index" if modulus == counter.per_turn else f"at {in_full(modulus)}"
    remarks.append(
        f"{counter.name} goes round {what}, as its {int(np.sum(jumps))} jumps tell (first in row {row}); state "
        f"{counter.name}_modulus = {in_full(modulus)} to be sure"
    )
    return count


def from_the_index(name: str, raw: FloatArray, turn: float, remarks: list[str]) -> FloatArray:
    """Readings (n,) of a counter with those left out (``nan``) that came before the index first set it to 0, told in
    ``remarks``; as they are where it goes round once a ``turn`` from the beginning, or does not."""
    good = np.flatnonzero(np.isfinite(raw))
    if good.size < FEWEST_READINGS_FOR_INDEX:
        return raw
    held = raw[good]
    steps = np.diff(held)
    usual = float(np.median(steps))
    near = max(MODULUS_MOST_STEPS_OFF * float(np.quantile(np.abs(steps), 0.95)), 1.0)
    set_ = np.flatnonzero(np.abs(steps - usual) > near)
    if set_.size < 2 or abs(held[set_[0]] - held[0]) > turn:
        return raw
    whole = np.abs(np.abs(steps[set_] - usual) - turn) <= near
    # Counting down it goes on below the counts of a turn, or below 0.
    after = held[set_[0] + 1]
    at_zero = min(abs(after), abs(abs(after) - turn)) <= near
    if whole[0] or not whole[1:].all() or not at_zero:
        return raw
    row = int(good[set_[0] + 1])
    out = raw.copy()
    out[:row] = np.nan
    remarks.append(
        f"{name} is set to 0 by the index in row {row + 1} for the first time: the readings before it, of less than a "
        "turn, have no known place and are left out"
    )
    return out


def _jumps(steps: FloatArray, samples: IntArray, per_turn: float) -> BoolArray:
    """Which ``steps`` (n,) of a counter, taken over so many ``samples`` (n,), no shaft turns."""
    size = np.abs(steps)
    large = float(np.quantile(size, 0.95))
    half = max(0.5 * per_turn, 10.0 * large)
    # Over a gap the shaft turned on as long.
    least = np.where(samples == 1, min(half, COUNTER_JUMP_STEPS * large), max(half, COUNTER_JUMP_STEPS * large))
    return np.asarray(size > np.maximum(least, JUMP_LEAST))


def _found(per_turn: float, steps: FloatArray, jumps: BoolArray) -> float | None:
    """What all ``jumps`` among the ``steps`` (n,) of a counter agree that it goes round at; ``None`` where they do
    not, or it is nothing that counters go round at."""
    usual = float(np.median(steps[~jumps])) if (~jumps).any() else 0.0
    largest = float(np.max(np.abs(steps[~jumps]), initial=abs(usual)))
    tried = [*(per_turn * k for k in range(1, TURNS_MOST + 1)), *(2.0**bits for bits in BITS)]
    # Set back by the index, a counter jumps by the counts of a turn, without those that were lost.
    span = np.abs(steps[jumps] - usual)
    near = [one for one in tried if np.all(np.abs(span - one) <= max(MODULUS_MOST_STEPS_OFF * largest, 1.0))]
    return min(near, key=lambda one: float(np.max(np.abs(span - one))), default=None)
