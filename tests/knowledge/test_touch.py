"""What a tooth that deviates far does to the teeth beside it: they carry, and its own size shows no more."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gearpoly.files.models import PairFile
from tests.knowledge.rigs import UNLOADED, hidden, inspected, record
from tests.knowledge.verdicts import Cause, verdict
from tests.physics_cases import Condition

pytestmark = pytest.mark.slow

Z, TOOTH = (18, 25), 7
LAGGING = Cause(physics="tooth_pitch", gear="driving", tooth=TOOTH)
PITTED = Cause(physics="tooth_spall", gear="driving", tooth=TOOTH)


def fine(*, lag_um: float = 0.0, pits: list[dict[str, float]] | None = None, bends: bool = False) -> PairFile:
    """Inspected gears of module 0.5; one driving tooth stands back, or is pitted."""
    rng = np.random.default_rng(9)
    gears: dict[str, Any] = {"model": {"tooth_deflection": bends}}
    for name, z in zip(("driving", "driven"), Z, strict=True):
        pitch = rng.normal(0.0, 1.0, z).round(2)
        pitch[TOOTH] -= lag_um if name == "driving" else 0.0
        sheet = {"pitch_um": pitch.tolist(), "profile_slope_um": [0.0] * z, "uncertainty_um": 0.2}
        gears[name] = {"teeth": z, "module_mm": 0.5, "face_width_mm": 5.0, "points_per_flank": 300, "inspection": sheet}
    if pits:
        gears["driving"]["spall"] = [{"tooth": TOOTH, **pit} for pit in pits]
    return PairFile.model_validate(gears)


def test_a_tooth_out_of_the_mesh_is_named_though_its_size_shows_no_more() -> None:
    """24 um back its neighbours carry over it, and 48 um would do the same: to first order nothing is lost without it.
    The size is the least that it may be, or so wide that it holds the true one."""
    found = verdict(fine(), record(fine(lag_um=24.0), UNLOADED, cycles=2.0))
    assert found.misnamed(LAGGING) == [], found.told
    size = found.size(LAGGING, "deviation_um")
    assert -60.0 < size < -2.0


def test_a_loaded_tooth_out_of_the_mesh_is_no_crack() -> None:
    """Bent by 1 and 2 um, pairs close over a tooth that stands 20 um back as over one that gives ten times as much."""
    loads = Condition(torque_nm=0.8), Condition(torque_nm=2.0)
    found = verdict(fine(bends=True), record(fine(lag_um=20.0, bends=True), *loads, cycles=1.0))
    assert found.misnamed(LAGGING) == [], found.told
    assert found.named(LAGGING) is not None, found.told


def test_a_pit_with_an_uneven_bottom_is_a_pit() -> None:
    """No pit is cut by a formula: here half of its bottom lies 1.2 um deeper than the rest of 6 um. It is named where
    it is, or its tooth is told without a name. Nothing else is made of the difference."""
    pits = [
        {"depth_um": 6.0, "from_mm": 4.38, "to_mm": 4.62, "wall_mm": 0.02},
        {"depth_um": 1.2, "from_mm": 4.38, "to_mm": 4.50, "wall_mm": 0.02},
    ]
    found = verdict(fine(), record(fine(pits=pits), UNLOADED, cycles=3.0))
    assert found.misnamed(PITTED) == [], found.told
    tooth = found.located(("tooth", "tooth_curve"), gear="driving", tooth=TOOTH)
    assert found.named(PITTED) is not None or tooth, found.told


@pytest.mark.xfail(strict=False, reason="a mate's pit is drawn to first order only: no such rival is fitted to its end")
def test_a_pit_of_teeth_that_always_meet_may_be_the_mate_s() -> None:
    """On 12 and 12 teeth, tooth 4 meets tooth 4 and no other: either may have it, and the verdict holds both."""
    known = inspected((12, 12))
    true = hidden(known, "tooth_spall", (4.0, 11.7, 12.3, 0.02), gear=0, tooth=4)
    found = verdict(known, record(true, UNLOADED, cycles=7.0, per_mesh=60))
    either = [Cause(physics="tooth_spall", gear=gear, tooth=4) for gear in ("driving", "driven")]
    assert found.misnamed(*either) == [], found.told
    if found.missing:
        assert all(found.named(one) for one in either), found.told
    else:
        assert any(found.located(("tooth", "tooth_curve"), gear=one.gear, tooth=4) for one in either)
