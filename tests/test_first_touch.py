"""The first touch of unloaded teeth as a smooth maximum over near pairs."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.as_built import make_as_built
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.placing import placed
from gearpoly.diagnose.prepare import graded_prior, prepare
from gearpoly.diagnose.smoothing import smoothings
from gearpoly.files.models import PairFile
from gearpoly.gear.nominal import nominal_gears
from gearpoly.mesh.first_touch import FAINTEST_SHARE, smooth_first
from gearpoly.mesh.pair import Flank
from gearpoly.mesh.transmission import FlankContacts
from gearpoly.physics.samples import Samples
from gearpoly.scene import Scene, stage
from gearpoly.units import UM, FloatArray
from tests.pair_files import made
from tests.physics_cases import ZEROS, Condition, recorded, samples_at

Z = 19, 24


def pair(pitch_um: FloatArray | None = None, *, graded: bool = False) -> PairFile:
    """Unloaded gears, ideal but for the driving gear's pitches; or all that is declared of gears of grade 6."""
    gears: dict[str, Any] = {"model": {"tooth_deflection": False}}
    for name, z in zip(("driving", "driven"), Z, strict=True):
        gears[name] = {"teeth": z, "module_mm": 3.0, "face_width_mm": 25.0, "points_per_flank": 400}
        sheet: dict[str, Any] = {"tooth_thickness_um": -60.0}
        if name == "driving" and pitch_um is not None:
            sheet["pitch_um"] = pitch_um.tolist()
        gears[name] |= {"grade": 6, "limits": {"E_sns_um": -50, "E_sni_um": -70}} if graded else {"inspection": sheet}
    return PairFile.model_validate(gears)


def seen(file: PairFile, flank: Flank = "drive") -> Samples:
    theta_2 = np.linspace(0.0, 4.0 * 2.0 * math.pi / Z[1], 97)
    return samples_at(made(file), theta_2, Condition(torque_nm=0.0, flank=flank), 0)


def rows(gaps_um: list[list[float]], flank: Flank = "drive") -> FlankContacts:
    """Near pairs at some positions, by what each closes after the first."""
    scene = stage(made(pair()), seen(pair(), flank))
    position = np.repeat(np.arange(len(gaps_um)), [len(one) for one in gaps_um])
    gap = UM * np.concatenate([np.array(one) for one in gaps_um])
    return replace(scene.rows, flank=flank, theta_2=np.zeros(len(gaps_um)), position=position, gap=gap)


@pytest.mark.parametrize(("flank", "sense"), [("drive", 1.0), ("coast", -1.0)])
def test_two_pairs_that_touch_at_once_share_it(flank: Flank, sense: float) -> None:
    """Closed forms: of k equal terms width log k above, ahead on the drive flank and behind on the coast flank; of two
    that close 1 um after another, 1 and exp(-1/2) of a width of 2 um."""
    weight, above = smooth_first(rows([[0.0], [0.0, 0.0], [0.0, 1.0]], flank), width=2.0 * UM)
    part = math.exp(-0.5)
    assert weight == pytest.approx([1.0, 0.5, 0.5, 1.0 / (1.0 + part), part / (1.0 + part)], rel=1e-12)
    assert above / UM == pytest.approx([0.0, 2.0 * sense * math.log(2.0), 2.0 * sense * math.log1p(part)], rel=1e-12)


def test_a_narrow_maximum_is_the_first_touch() -> None:
    """As the width goes to 0 only the first pair counts; what lies ten widths behind weighs less than exp(-10)."""
    weight, above = smooth_first(rows([[0.0, 1.0, 3.0]]), width=0.1 * UM)
    assert weight.tolist() == [pytest.approx(1.0, abs=1e-4), 0.0, 0.0]
    assert math.exp(-10.0) < FAINTEST_SHARE
    assert abs(above[0]) < 0.1 * UM * 1e-4


@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_weights_are_the_derivative_of_the_smooth_curve(flank: Flank) -> None:
    """Moving one tooth by a hundredth of a micrometre moves the curve as the columns of teeth say: a width of 2 um
    bends by (0.01 / 2) / 4 of that at most, and weights below a thousandth are left out."""
    at, by = 3, 0.01

    def curve(um: float) -> Scene:
        pitch = 2.0 * np.sin(2.1 * np.arange(Z[0]))
        pitch[at] += um
        file = pair(pitch)
        return stage(made(file), seen(file, flank), smoothing=2.0 * UM)

    here, there = curve(0.0), curve(by)
    file = pair(graded=True)
    gears = nominal_gears(file)
    teeth = make_as_built((graded_prior(file.driving, gears, 0), graded_prior(file.driven, gears, 1)), (flank,))
    column = teeth.columns(here).dense()[:, teeth.start(flank, 0) + at]
    # A tooth that stands ahead has as much less material on its coast flank.
    change = (there.te - here.te) / (by if flank == "drive" else -by)
    assert np.max(np.abs(change)) > 0.4 * UM
    assert change == pytest.approx(column, abs=0.005 * UM)


def drawn(seed: int) -> PairFile:
    """The same gears with teeth that scatter as those of grade 6 do."""
    rng = np.random.default_rng(seed)
    gears: dict[str, Any] = {"model": {"tooth_deflection": False}}
    for name, z in zip(("driving", "driven"), Z, strict=True):
        pitch = np.cumsum(rng.uniform(-7.0, 7.0, z))
        pitch -= np.linspace(0.0, pitch[-1], z)
        gears[name] = {"teeth": z, "module_mm": 3.0, "face_width_mm": 25.0, "points_per_flank": 400}
        gears[name]["inspection"] = {
            "pitch_um": (pitch - pitch.mean()).round(3).tolist(),
            "profile_slope_um": rng.normal(0.0, 3.0, z).round(3).tolist(),
            "tooth_thickness_um": -60.0,
        }
    return PairFile.model_validate(gears)


def begun(seed: int, folder: Path) -> tuple[Any, list[FloatArray], FloatArray]:
    """What a diagnosis begins with of half a hunting cycle, ten samples to the mesh, without a zero; and the truth of
    the driven rotation."""
    rng = np.random.default_rng(seed)
    (one,) = recorded(drawn(seed), (Condition(torque_nm=0.0),), rng, cycles=0.5, per_mesh=10)
    assert one.driven_angle_rad is not None
    truth = one.driven_angle_rad - ZEROS[1]
    one = replace(one, driving_zero_rad=None, driven_zero_rad=None)
    known, path = pair(graded=True), folder / "pair.toml"
    model = prepare(known, compare(known, [one], path=path), path=path)
    return model, [np.zeros((one.driven_angle_rad.size, 0))], truth


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 3])
def test_a_short_recording_of_unloaded_teeth_tells_where_a_pitch_begins(seed: int, tmp_path: Path) -> None:
    """Places are tried a sixteenth of a pitch apart. Of six such recordings fits that began with the exact first touch
    ended 0.01 to 0.034 of a pitch off, those of these two 0.031 and 0.034; with a smooth one all within 0.015."""
    model, foreign, truth = begun(seed, tmp_path)
    assert not model.phased
    there = placed(model, foreign, lambda _: None)
    pitch = 2.0 * math.pi / Z[1]
    off = np.asarray(there.observed[0].samples.theta_2 + there.shift - truth[: there.observed[0].samples.size])
    assert abs(math.remainder(float(np.mean(off)), pitch)) < 0.02 * pitch


@pytest.mark.long
def test_teeth_that_are_known_or_fitted_or_loaded_touch_as_they_do(tmp_path: Path) -> None:
    """Only a beginning is soft, and it ends with the exact first touch."""
    model, foreign, _ = begun(1, tmp_path)
    widths = smoothings(model)
    assert len(widths) == 2
    assert widths[0] > widths[1] > 0.0
    known = [replace(one, graded=False) for one in model.as_built.gears]
    assert smoothings(replace(model, as_built=replace(model.as_built, gears=(known[0], known[1])))) == ()
    assert smoothings(replace(model, scope=replace(model.scope, torques=(1.0,)))) == ()
    assert Fit.begun(model, foreign, lambda _: None, trial=2).model.smoothing == 0.0
