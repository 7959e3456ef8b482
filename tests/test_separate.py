"""How far a recording would tell look-alikes apart: angles between signals beside everything that is open."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearpoly.diagnose.separate import least_sine

TURN = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
NOTHING = np.zeros((720, 1))
"""Something open that these recordings do not show."""


def parted(mine: list[np.ndarray], theirs: list[np.ndarray], opened: list[np.ndarray] | None = None) -> float:
    """The sine between two signals over some recordings, one rival."""
    columns = opened or [NOTHING] * len(mine)
    normal = np.eye(1) + sum(a.T @ a for a in columns)
    return least_sine(normal, [([a], [m], [[t]]) for a, m, t in zip(columns, mine, theirs, strict=True)])


def wave(phase_deg: float, amplitude: float = 1.0) -> np.ndarray:
    return amplitude * np.cos(TURN - math.radians(phase_deg))


def plane(phase_deg: float) -> np.ndarray:
    """A rival wave whose amplitude and phase are free."""
    return np.column_stack((wave(phase_deg), wave(phase_deg + 90.0)))


def test_a_wave_of_free_phase_makes_any_other_of_its_order() -> None:
    """One recording never tells it, at whatever phase it was fitted; one of fixed phase would."""
    assert parted([wave(20.0)], [plane(75.0)]) < 1e-6
    assert parted([wave(20.0)], [wave(80.0)[:, None]]) == pytest.approx(math.sin(math.radians(60.0)), abs=1e-9)


def test_two_flanks_tell_an_eccentric_gear_from_an_encoder_by_half_the_turn_of_phase() -> None:
    """Flanks at 20 and -20 deg turn an eccentricity's phase by 40 deg between them, an encoder's not: the encoder's
    wave meets both half-way, so the sine is that of 20 deg. With the phase of its best fit on the drive flank held, it
    would be told twice as well."""
    mine, theirs = [wave(20.0), wave(-20.0)], [plane(0.0), plane(0.0)]
    assert parted(mine, theirs) == pytest.approx(math.sin(math.radians(20.0)), abs=1e-9)
    held = [wave(20.0)[:, None]] * 2
    assert parted(mine, held) > 1.3 * parted(mine, theirs)


def test_what_is_open_beside_takes_from_the_signal() -> None:
    """Where everything of the signal is open anyway but a part at right angles, only that part has to be told."""
    signal = wave(0.0) + np.cos(3.0 * TURN)
    free = 1e4 * wave(0.0)[:, None]
    assert parted([signal], [np.cos(3.0 * TURN)[:, None]]) == pytest.approx(math.sqrt(0.5), abs=1e-6)
    assert parted([signal], [np.cos(3.0 * TURN)[:, None]], [free]) < 1e-3


def test_a_rival_that_shows_nothing_is_told() -> None:
    assert parted([wave(0.0)], [np.zeros((720, 2))]) == 1.0
