"""Waves that stand out together only: trains of pulses, and the same faint hum in every recording."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.units import FloatArray
from tests.knowledge_compare.made import (
    TURN,
    Added,
    Motion,
    Told,
    drawn,
    pair,
    pitches,
    recorded,
    standing,
    told,
    waves,
)

pytestmark = pytest.mark.slow

FILE = pair(pitch_um=pitches(3))


def seen(added: Added, *, seed: int = 1, cycles: float = 3.01) -> Told:
    return told(FILE, recorded(drawn(FILE), seed=seed, noise=1.0, cycles=cycles, per_mesh=8, added=added))


def bumps(per_turn: float, um: float, width: float = 0.2) -> Added:
    """A bump once in each round of 1/``per_turn`` driving turns, of a standard deviation of ``width`` rad of it."""

    def made(m: Motion) -> FloatArray:
        round_ = TURN * per_turn * m.driving
        return um * np.exp(-0.5 * ((np.mod(round_ + np.pi, TURN) - np.pi) / width) ** 2)

    return made


def test_pulses_of_which_no_line_stands_out_are_found_together() -> None:
    """A ball over a pit strikes 4.83 times a turn: its harmonics crest at one moment, each of them below the noise's
    threshold."""
    found = seen(bumps(4.83, 0.6))
    places = [place for place, _ in waves(found, z=(11, 13))]
    assert places
    for place in places:
        assert abs(place / 4.83 - round(place / 4.83)) < 0.01


def test_one_bump_is_no_train() -> None:
    """What comes once only is no wave, though any train would take a part of it."""
    found = seen(lambda m: 8.0 * np.exp(-0.5 * ((m.part - 0.42) / 0.0015) ** 2))
    assert waves(found) == []


def test_the_pairs_own_lines_are_left_to_its_own_searches() -> None:
    """Something that strikes once a turn of a shaft is no train from outside."""
    found = seen(bumps(1.0, 3.0))
    assert standing(found)
    for _, e in waves(found):
        assert float(e["order"]).is_integer()


def test_hum_too_faint_for_one_recording_is_found_in_three() -> None:
    """What is fixed to the mains is there whenever somebody records."""

    def hum(m: Motion) -> FloatArray:
        return 0.115 * np.cos(TURN * 17.77 * m.time)

    ways = [
        recorded(drawn(FILE), seed=k, begin=0.3 * k, noise=1.0, cycles=3.01, per_mesh=8, added=hum) for k in (5, 6, 7)
    ]
    together = standing(told(FILE, *ways))
    assert together
    for e in together:
        assert abs(e["hz"] - 17.77) < 0.05
