"""A part of a recording that holds no sample of what is asked for: a tooth that does not mesh in it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.linear import whole_effect
from gearpoly.diagnose.prepare import prepare
from gearpoly.errors import NotConvergedError
from gearpoly.gear.deviations import Deviations, Relief
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.mesh.pair import active_start
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.scene import stage
from tests.pair_files import made
from tests.physics_cases import Condition, recorded, rough, samples_at

Z = (12, 16)


@pytest.mark.parametrize("condition", [Condition(torque_nm=0.0), Condition(torque_nm=20.0), Condition(flank="coast")])
@pytest.mark.parametrize("bends", [True, False])
def test_of_no_samples_nothing_is_simulated(condition: Condition, bends: bool) -> None:
    assembled = made(rough(Z, bends=bends))
    samples = samples_at(assembled, np.linspace(0.1, 1.0, 20), condition, 0)
    none = stage(assembled, samples.at(np.zeros(0, dtype=np.int64)))
    assert none.te.size == 0 and none.weight.shape[1] == 0


def test_a_tooth_that_does_not_mesh_in_a_recording_changes_nothing_of_it(tmp_path: Path) -> None:
    """Of two runs one is shorter than a turn. Such a tooth ended a diagnosis of a joint that turned forth and back."""
    file, path = rough(Z), tmp_path / "pair.toml"
    (one,) = recorded(file, (Condition(torque_nm=20.0),), np.random.default_rng(3), cycles=1.0, per_mesh=8)
    model = prepare(file, compare(file, [one], path=path), path=path)
    claim = Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=1, tooth=9), values=(-60.0,))
    claimed = replace(model, claims=(claim,))
    (whole,) = claimed.scenes()
    away = np.setdiff1d(np.arange(whole.samples.size), whole.samples.meshing(1, 9, z=Z[1]))[:40]
    part = stage(whole.assembled, whole.samples.at(away))
    assert not part.samples.meshing(1, 9, z=Z[1]).size
    first, second = whole_effect(claimed, [whole, part], claim)
    assert np.ptp(first) > 0.02
    np.testing.assert_array_equal(second, np.zeros(40))


@pytest.mark.filterwarnings("error")
def test_a_relief_that_folds_its_flank_over_is_refused_at_once() -> None:
    """0.5 mm off within 0.05 mm: the flank would stand behind itself. The search for it had run to infinity."""
    gear = Gear(z=18, m=2.0)
    relief = Relief(amount=0.5, l_relief=gear.l_a - 0.05, power=2)
    start = active_start(gear, Gear(z=25, m=2.0), l_form=0.0)
    with pytest.raises(NotConvergedError, match="folds over"):
        draw_flanks(gear, Deviations(drive=(relief,), coast=(relief,)), l_start=start, points=200)
