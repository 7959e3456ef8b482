"""Whole turns between two recordings, told by teeth that nobody inspected."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from gearpoly.compare.among import further_on, turns_between
from gearpoly.compare.curve import Cycle, RecordedCurve

Z = 18, 25
MESHES, PER_MESH = 450, 8
CYCLE = cast(Cycle, SimpleNamespace(meshes=MESHES, pitch=2.0 * np.pi / Z[1], per_mesh=PER_MESH))


def seen(turns: int, *, turn: int, deflection: float, rng: np.random.Generator, meshes: int = MESHES) -> RecordedCurve:
    """A curve whose zero is so many turns of its encoder's shaft late: pitch errors of both gears, a ripple at every
    mesh, an offset by load, noise."""
    pitch = np.random.default_rng(3).normal(0.0, 3.0, Z[0]), np.random.default_rng(4).normal(0.0, 3.0, Z[1])
    theta_2 = np.sort(rng.uniform(0.0, meshes, 16 * meshes)) * CYCLE.pitch
    mesh = np.floor(theta_2 / CYCLE.pitch).astype(int) - turns * turn
    te = pitch[0][mesh % Z[0]] + pitch[1][mesh % Z[1]] - deflection + 0.2 * deflection * np.sin(Z[1] * theta_2)
    te = 1e-3 * (te + rng.normal(0.0, 1.0, te.size))
    template = SimpleNamespace(flank="drive")
    return cast(
        RecordedCurve, SimpleNamespace(theta_2=theta_2, te=te, weight=np.ones(te.size), turn=turn, template=template)
    )


def test_flanks_are_not_laid_on_one_another() -> None:
    """A tooth that stands ahead on one flank stands back on the other, and an eccentricity comes at another angle."""
    rng = np.random.default_rng(2)
    one = seen(0, turn=25, deflection=0.0, rng=rng)
    other = SimpleNamespace(**{**vars(seen(3, turn=25, deflection=0.0, rng=rng)), "template": None})
    other.template = SimpleNamespace(flank="coast")
    assert turns_between(one, cast(RecordedCurve, other), CYCLE) is None


@pytest.mark.parametrize("turns", [0, 1, 7, 17])
@pytest.mark.parametrize("turn", [25, 18])
def test_turns_are_told_by_the_mates_teeth(turns: int, turn: int) -> None:
    """Modulo the hunting cycle: after 18 turns of the driven shaft, or 25 of the driving, all is as before."""
    rng = np.random.default_rng(turns)
    one = seen(0, turn=turn, deflection=0.0, rng=rng)
    other = seen(turns, turn=turn, deflection=8.0, rng=rng)
    assert turns_between(one, other, CYCLE) == (turns % (MESHES // turn), True)


@pytest.mark.parametrize("turn", [25, 18])
def test_what_load_makes_of_the_encoders_own_teeth_does_not_hide_its_turns(turn: int) -> None:
    """Teeth of the shaft that was read come again after each of its turns: alike at every one, whatever load does."""
    rng = np.random.default_rng(turn)
    one, other = seen(0, turn=turn, deflection=0.0, rng=rng), seen(7, turn=turn, deflection=8.0, rng=rng)
    own = 1e-3 * np.random.default_rng(5).normal(0.0, 12.0, turn)  # mm: four times the errors of the mate's teeth
    other.te[:] += own[np.floor(other.theta_2 / CYCLE.pitch).astype(int) % turn]
    assert turns_between(one, other, CYCLE) == (7, True)


def test_where_nothing_else_tells_the_most_alike_will_do_or_the_angles_as_they_read() -> None:
    """Not the rounding of misfits that are all the same."""
    rng = np.random.default_rng(6)
    one, other = seen(0, turn=25, deflection=0.0, rng=rng), seen(7, turn=25, deflection=0.0, rng=rng)
    lies, steps = np.array([0, 3]), 7 * 25 * PER_MESH
    assert further_on(other, [(lies, one)], CYCLE, blind=False) == pytest.approx(lies + steps)
    for curve, turns in ((one, 0), (other, 7)):  # an order 1 of the mate, in noise: the next tooth is nearly as alike
        mesh = np.floor(curve.theta_2 / CYCLE.pitch) - 25 * turns
        curve.te[:] = 5e-3 * np.sin(2.0 * np.pi * mesh / Z[0]) + rng.normal(0.0, 0.012, curve.te.size)
    assert turns_between(one, other, CYCLE) == (7, False)
    assert further_on(other, [(lies, one)], CYCLE, blind=False) is None
    assert further_on(other, [(lies, one)], CYCLE, blind=True) == pytest.approx(lies + steps)
    other.te[:] = rng.normal(0.0, 1.0, other.te.size)
    assert further_on(other, [(lies, one)], CYCLE, blind=True) == pytest.approx(lies)


def test_what_is_too_short_or_all_alike_tells_nothing() -> None:
    rng = np.random.default_rng(1)
    whole = seen(0, turn=25, deflection=0.0, rng=rng)
    assert turns_between(whole, seen(3, turn=25, deflection=0.0, rng=rng, meshes=150), CYCLE) is None
    noise = cast(RecordedCurve, SimpleNamespace(**{**vars(whole), "te": rng.normal(0.0, 1e-3, whole.te.size)}))
    assert turns_between(noise, noise, CYCLE) == (0, True)  # the very same samples are as alike as can be
    assert turns_between(whole, noise, CYCLE) is None
