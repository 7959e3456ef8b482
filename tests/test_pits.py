"""Pits that look like others: deep bowls of which nothing but the rim is touched, and edges beside the edge."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.exchange import reshaped
from gearpoly.diagnose.fit import joined, settled
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.files.models import PairFile
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place, Values
from gearpoly.units import FloatArray
from tests.physics_cases import Condition, recorded, scope_of

PITTED = catalogue()["tooth_spall"]


@dataclass(frozen=True, kw_only=True)
class Pitted:
    """An inspected pair of 24 and 36 teeth of a module, one tooth of a gear (0, 1) of which is pitted."""

    m: float
    tooth: int
    pit: Values
    gear: int = 0

    def file(self, *, hidden: bool = False) -> PairFile:
        rng = np.random.default_rng(9)
        gears: dict[str, Any] = {"model": {"tooth_deflection": True}}
        for name, z in (("driving", 24), ("driven", 36)):
            pitch, slope = rng.normal(0.0, 4.0, z), rng.normal(0.0, 1.5, z)
            sheet = {"pitch_um": pitch.round(2).tolist(), "profile_slope_um": slope.round(2).tolist()}
            size = {"teeth": z, "module_mm": self.m, "face_width_mm": 10.0 * self.m, "points_per_flank": 400}
            gears[name] = {**size, "inspection": {**sheet, "uncertainty_um": 0.2}}
        if hidden:
            keys = dict(zip(("depth_um", "from_mm", "to_mm", "wall_mm"), self.pit, strict=True))
            gears[("driving", "driven")[self.gear]]["spall"] = [{"tooth": self.tooth, **keys}]
        return PairFile.model_validate(gears)

    def recordings(self, seed: int, *, cycles: float, torques: tuple[float, ...] = (12.0, 3.0)) -> list[Any]:
        loads = tuple(Condition(torque_nm=torque * self.m**2) for torque in torques)
        return recorded(self.file(hidden=True), loads, np.random.default_rng(seed), cycles=cycles)


def profile(r: FloatArray, pit: Values) -> FloatArray:
    """What a pit takes off at radii r, as the pair file defines it."""
    depth, low, high, wall = pit
    wall = max(wall, 1e-3 * depth)  # steeper walls would fold the flank
    return 0.5 * depth * (np.tanh((r - low) / wall) - np.tanh((r - high) / wall))


@pytest.mark.parametrize("bowl", [(51.0, 11.96, 12.06, 0.045), (30.0, 12.06, 11.96, 0.1)])
def test_the_other_forms_of_a_bowl_cut_it_off_where_it_is_half_as_deep(bowl: Values) -> None:
    """By the definition of a pit: at the new edges the bowl takes off half of the new depth, as steeply."""
    depth, *edges, wall = bowl
    bowl_in_order = (depth, min(edges), max(edges), wall)
    place = Place(gear=0, tooth=4)
    forms = list(PITTED.otherwise(scope_of(Pitted(m=1.0, tooth=4, pit=bowl).file()), place, bowl))
    assert forms
    for _, (less, low, high, rise) in forms:
        assert 0.0 < less < depth
        assert low + high == pytest.approx(sum(edges))
        for edge, way in ((low, 1.0), (high, -1.0)):
            at = edge + np.array([-1e-6, 0.0, 1e-6])
            there = profile(at, bowl_in_order)
            assert there[1] == pytest.approx(0.5 * less)
            # A pit rises by half its depth over its wall, at its edge.
            assert way * (there[2] - there[0]) / 2e-6 == pytest.approx(0.5 * less / rise, rel=1e-3)


def test_a_pit_with_a_bottom_has_no_other_form() -> None:
    scope = scope_of(Pitted(m=1.0, tooth=4, pit=(4.0, 11.8, 12.2, 0.03)).file())
    assert not list(PITTED.otherwise(scope, Place(gear=0, tooth=4), (4.0, 11.8, 12.2, 0.03)))
    assert not list(PITTED.otherwise(scope, Place(gear=0, tooth=4), (0.0, 11.96, 12.06, 0.045)))


@pytest.mark.parametrize(("below", "over"), [(0.08, True), (0.15, False), (0.0, False)])
def test_a_pit_that_ends_near_the_tip_is_also_tried_as_one_that_reaches_over_it(below: float, over: bool) -> None:
    """Within a tenth of a module of the tip circle of 24 teeth of module 1, 13 mm; one that ends there does already."""
    scope, place = scope_of(Pitted(m=1.0, tooth=4, pit=(4.0, 11.8, 12.2, 0.03)).file()), Place(gear=0, tooth=4)
    forms = list(PITTED.otherwise(scope, place, (9.0, 12.2, 13.0 - below, 0.02)))
    assert forms == ([(place, (9.0, 12.2, 13.0, 0.02))] if over else [])


@pytest.mark.slow
def test_a_narrow_pit_with_steep_walls_is_as_deep_as_it_is(tmp_path: Path) -> None:
    """4.4 um over 0.28 mm at module 1: where teeth lose touch over its bottom, a bowl of 51 um is nearly as good, a fit
    that ran there rested 30 of misfit higher. An inspection to 0.2 um and noise of 0.3 um leave 0.3 um."""
    case = Pitted(m=1.0, tooth=4, pit=(4.4, 11.87, 12.155, 0.01))
    diagnosis = diagnose(case.file(), case.recordings(1, cycles=4.0), path=tmp_path / "pair.toml")
    (one,) = diagnosis.findings
    assert (one.claim.physics.name, one.claim.place.gear, one.tooth) == ("tooth_spall", 0, 4)
    assert one.parameters["depth_um"][0] == pytest.approx(4.4, rel=0.1)
    for name, edge in (("from_mm", 11.87), ("to_mm", 12.155)):
        assert abs(one.parameters[name][0] - edge) < 0.03
    assert diagnosis.after.unseen == pytest.approx(diagnosis.noise, rel=0.02)


@pytest.mark.slow
def test_a_pit_whose_fit_rests_beside_it_is_found_once_its_edges_are_moved(tmp_path: Path) -> None:
    """0.4 mm beside the true edge, walls at their steepest, plain steps lead nowhere: a third of the noise is left."""
    case = Pitted(m=3.0, tooth=19, pit=(17.6, 34.94, 36.41, 0.134))
    recordings, path = case.recordings(12, cycles=2.0), tmp_path / "pair.toml"
    model = prepare(case.file(), compare(case.file(), recordings, path=path), path=path)
    search = from_declared(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    beside: Values = (12.1, 35.3, 36.49, 0.01)
    search = settled(
        joined(search, [Claim(physics=PITTED, place=Place(gear=0, tooth=19, shape=beside[1:]), values=beside)])
    )
    assert search.linear.system.beyond > 0.1 * search.linear.system.samples
    search = reshaped(search)
    depth, low, high, _ = search.model.claims[0].values
    # Beside the stated error of a pit's edge, 0.08 mm.
    assert (low, high) == pytest.approx((34.94, 36.41), abs=0.08)
    assert depth == pytest.approx(17.6, rel=0.05)
    assert search.linear.system.beyond < 0.03 * search.linear.system.samples


@pytest.mark.slow
@pytest.mark.parametrize("pit", [(20.8, 17.755, 18.07, 0.02), (16.0, 17.684, 18.068, 0.02)])
def test_a_pit_over_which_other_teeth_carry_is_named_with_its_least_size(pit: Values, tmp_path: Path) -> None:
    """Unloaded, in two hunting cycles: teeth lose touch over the pit's bottom, so the next micrometre of its depth is
    hardly seen, and half of the recording leads a straight line from its edges astray; all that it does is seen well.
    Its edges are told within twice their stated errors, and so is how deep it is."""
    case = Pitted(m=1.0, gear=1, tooth=31, pit=pit)
    path = tmp_path / "pair.toml"
    diagnosis = diagnose(case.file(), case.recordings(1, cycles=2.0, torques=(0.0,)), path=path)
    (one,) = diagnosis.findings
    assert (one.claim.physics.name, one.claim.place.gear, one.tooth) == ("tooth_spall", 1, 31)
    for name, true in zip(("depth_um", "from_mm", "to_mm"), pit, strict=False):
        value, std = one.parameters[name]
        assert abs(value - true) < 2.0 * std
    assert one.at_least
    assert one.probability > 0.99
    # As well as noise allows: beside it, two cycles leave what many freedoms take of 2880 samples.
    assert diagnosis.after.unseen == pytest.approx(diagnosis.noise, rel=0.05)
