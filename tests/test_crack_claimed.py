"""A crack that is claimed already: what a little more of it does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.scene import stage
from tests.pair_files import made
from tests.physics_cases import Condition, rough, samples_at


@pytest.mark.long
@pytest.mark.parametrize("more", [0.0, 0.5, 2.0])
def test_a_crack_already_claimed_does_not_enlarge_what_more_of_it_does(more: float) -> None:
    """Its column is what the simulation of a crack larger and smaller by 0.02 says, about a crack of any size: to a
    fifth, since a pair that gives more also takes less of the load."""
    claim = Claim(physics=catalogue()["tooth_crack"], place=Place(gear=0, tooth=3), values=(more,))
    file, step = rough(), 0.02
    condition = Condition(torque_nm=20.0)
    theta = np.linspace(0.0, made(file).pair.cycle, 1200, endpoint=False)
    samples = samples_at(made(file), theta, condition, 0)

    def te(value: float) -> np.ndarray:
        return stage(made(replace(claim, values=(value,)).written(file)), samples).te

    scene = stage(made(claim.written(file)), samples)
    assert claim.physics.effect is not None
    column = claim.physics.effect(scene, claim.place, (1.0,))
    slope = (te(more + step) - te(max(more - step, 0.0))) / (step + min(step, more))
    part = float(column @ slope) / float(slope @ slope)
    assert part == pytest.approx(1.0, abs=0.2)
