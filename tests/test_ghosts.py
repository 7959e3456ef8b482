"""A claim that makes a small part of a ghost order is not what is there."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.entries import Entry
from gearpoly.diagnose.ghosts import _remnant_of
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import UM

Z = (18, 25)


@pytest.mark.parametrize(
    ("order", "made", "label", "remnant"),
    [
        (55, 0.03, "ghost order: no mesh harmonic", True),  # an image of 55 is 30
        (55, 0.20, "ghost order: no mesh harmonic", False),  # most of it
        (57, 0.03, "ghost order: no mesh harmonic", False),  # 57 has images at 7 and 32
        (55, 0.03, "side band +5 of mesh order 1", False),  # a pitch may make it
    ],
)
def test_a_tenth_of_a_ghost_order_is_no_name(order: int, made: float, label: str, remnant: bool) -> None:
    """0.29 um located at order 30 of 25 teeth."""
    theta = np.linspace(0.0, 40.0, 5000)
    claim = Claim(
        physics=catalogue()["undulation"], place=Place(gear=1, order=order, flank="drive"), values=(0.03, 0.0)
    )
    effect = made * UM * np.cos(30 * theta + 0.4) + 0.5 * UM * np.cos(5 * theta)
    scene = SimpleNamespace(samples=SimpleNamespace(theta_2=theta))
    scope = SimpleNamespace(gears=[SimpleNamespace(z=z) for z in Z])
    model = SimpleNamespace(scope=scope, change=lambda scenes, one, values, but: [effect])
    search: Any = SimpleNamespace(model=model, scenes=[scene])
    entry = Entry(
        kind="shaft_order", p_value=0.0, recordings=(0,), gear="driven", order=30.0, amplitude_um=0.29, label=label
    )
    assert bool(list(_remnant_of(search, claim, [entry]))) == remnant
