"""What is kept of a pair: closed forms of made-up curves, and the same numbers as ``simulate`` gives."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly import api
from gearpoly.assemble import assemble
from gearpoly.errors import OutOfRangeError
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import read_pair
from gearpoly.gear.tolerances import tolerances
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.pair import GearPair
from gearpoly.positions import cycle_positions
from gearpoly.simulate import simulate
from gearpoly.study.composite import composite_tolerances, grade_of, own_curve, tooth_composite, total_composite
from gearpoly.study.labels import axis_label
from gearpoly.study.making import maker
from gearpoly.study.outputs import PLAIN, Curves, describe, output
from gearpoly.study.pipeline import make_row
from gearpoly.study.read import read_study
from gearpoly.study.run import plan_study
from gearpoly.units import NM, UM, FloatArray
from tests.study_files import PAIR, write_study

PER_MESH = 12


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> GearPair:
    path = tmp_path_factory.mktemp("pair") / "pair.toml"
    path.write_text(PAIR, encoding="utf-8")
    return assemble(read_pair(path), path=path, seed=0).pair


def _curves(pair: GearPair, te_um: FloatArray) -> Curves:
    return Curves(pair=pair, te=te_um * UM / pair.r_b2, per_mesh=PER_MESH, editions=(2013, 2013))


def _waves(pair: GearPair) -> FloatArray:
    """Progress in meshes over a whole hunting cycle."""
    return np.arange(pair.meshes_per_cycle * PER_MESH) / PER_MESH


def test_orders_and_side_bands_are_the_amplitudes_that_were_put_in(pair: GearPair) -> None:
    x = 2.0 * math.pi * _waves(pair)
    te = 3.0 * np.cos(x) + 0.7 * np.cos(2 * x + 1.0) + 5.0 * np.cos(x / 11) + 2.0 * np.sin(2 * x / 13) - 4.0
    te += 0.3 * np.cos(x * (1 - 1 / 11)) + 0.4 * np.cos(x * (1 + 1 / 11) + 2.0)
    found = {
        name: output(name).read(_curves(pair, te))
        for name in ("mesh_order_1_um", "mesh_order_2_um", "mesh_order_3_um", "shaft_order_driving_1_um",
                     "shaft_order_driven_2_um", "side_band_driving_1_um", "side_band_driven_1_um", "te_mean_um")
    }  # fmt: skip
    # 1e-9: rounding of a transform of 1716 points, far below any amplitude.
    assert found["mesh_order_1_um"] == pytest.approx(3.0, abs=1e-9)
    assert found["mesh_order_2_um"] == pytest.approx(0.7, abs=1e-9)
    assert found["mesh_order_3_um"] == pytest.approx(0.0, abs=1e-9)
    assert found["shaft_order_driving_1_um"] == pytest.approx(5.0, abs=1e-9)
    assert found["shaft_order_driven_2_um"] == pytest.approx(2.0, abs=1e-9)
    assert found["side_band_driving_1_um"] == pytest.approx(0.5, abs=1e-9)  # 0.3 and 0.4
    assert found["side_band_driven_1_um"] == pytest.approx(0.0, abs=1e-9)
    assert found["te_mean_um"] == pytest.approx(-4.0, abs=1e-9)


def test_each_gear_gets_its_own_curve_back(pair: GearPair) -> None:
    rng = np.random.default_rng(3)
    mesh = np.arange(pair.meshes_per_cycle)
    one, two = rng.normal(size=(11, PER_MESH)), rng.normal(size=(13, PER_MESH))
    # Neither has a part with the period of a mesh, which no rig could give to one gear rather than to the other.
    one, two = one - one.mean(axis=0), two - two.mean(axis=0)
    te = (one[mesh % 11] + two[mesh % 13]).ravel()
    np.testing.assert_allclose(own_curve(te, z=11, per_mesh=PER_MESH), one.ravel(), atol=1e-12)  # rounding of sums
    np.testing.assert_allclose(own_curve(te, z=13, per_mesh=PER_MESH), two.ravel(), atol=1e-12)
    curves = _curves(pair, te)
    assert output("F_i_driving_um").read(curves) == pytest.approx(np.ptp(one))
    assert output("F_i_driven_um").read(curves) == pytest.approx(np.ptp(two))


def test_tooth_to_tooth_is_the_largest_step_within_a_pitch() -> None:
    # One tooth stands 2 off between neighbours, on a slow wave that changes by 0.31 in a pitch where it is steepest.
    wave = np.sin(2 * math.pi * np.arange(240) / 240.0)
    curve = wave.copy()
    curve[60:72] += 2.0
    assert tooth_composite(wave, per_mesh=12) == pytest.approx(2 * math.sin(math.pi * 12 / 240))  # across its zero
    # From its last point to a pitch later, where the wave falls too.
    assert tooth_composite(curve, per_mesh=12) == pytest.approx(2.0 + wave[71] - wave[83])
    ramp = np.abs(np.arange(240.0) - 120.0)
    assert tooth_composite(ramp, per_mesh=12) == 12.0
    assert total_composite(ramp) == 120.0


def test_composite_tolerances_of_1995_are_the_annex_s_other_form() -> None:
    """Annex A of ISO 1328-1:1995 also states f_i' = K (9 + 0.3 m + 3.2 sqrt(m) + 0.34 sqrt(d)) at grade 5."""
    d, m = math.sqrt(50.0 * 125.0), math.sqrt(2.0 * 3.5)  # band means, so that bands do not matter
    for eps, K in ((1.57, 0.2 * 5.57 / 1.57), (4.5, 0.4)):
        F_i, f_i = composite_tolerances(d=d, m=m, grade=5, edition=1995, eps_alpha=eps)
        # 1e-12 um: rounding of sums.
        assert f_i / UM == pytest.approx(K * (9 + 0.3 * m + 3.2 * math.sqrt(m) + 0.34 * math.sqrt(d)), abs=1e-9)
        assert F_i - f_i == pytest.approx(tolerances(d=d, m=m, grade=5, edition=1995, rounded=False).F_pT)


@pytest.mark.parametrize("edition", [1995, 2013])
def test_the_grade_of_a_tolerance_is_that_grade(edition: int) -> None:
    for which in (0, 1):
        for grade in range(1, 12):
            limit = composite_tolerances(d=50.0, m=2.0, grade=grade, edition=edition, eps_alpha=1.57)[which]
            kind = {"d": 50.0, "m": 2.0, "edition": edition, "eps_alpha": 1.57}
            assert grade_of(limit, which, **kind) == grade  # type: ignore[arg-type]
            assert grade_of(limit * (1 + 1e-9), which, **kind) == grade + 1  # type: ignore[arg-type]
    assert math.isnan(grade_of(1.0, 0, d=3.0, m=0.1, edition=edition, eps_alpha=1.5))


def test_an_angle_of_either_shaft_is_the_arc_over_its_base_radius(pair: GearPair) -> None:
    """By Eq. 16 a driving rotation is z_2/z_1 times the driven one; j_bn = r_b1 lost motion on the driving shaft."""
    te = 30.0 * np.sin(2.0 * math.pi * _waves(pair))
    curves = replace(_curves(pair, te), j_bn=np.array([20.0, 50.0, 110.0]) * UM)
    arcmin = math.pi / 10800.0
    r_b = {"driving": 11.0 * math.cos(math.radians(20.0)), "driven": 13.0 * math.cos(math.radians(20.0))}  # m z/2 cos
    for shaft, radius in r_b.items():
        found = {name: output(f"{name}_{shaft}_arcmin").read(curves)
                 for name in ("te_pp", "lost_motion_least", "lost_motion_mean", "lost_motion_most")}  # fmt: skip
        arcs = {"te_pp": 60e-3, "lost_motion_least": 20e-3, "lost_motion_mean": 60e-3, "lost_motion_most": 110e-3}
        # 12 positions a mesh meet the sine's extremes, so nothing but rounding is left.
        assert found == pytest.approx({name: arc / radius / arcmin for name, arc in arcs.items()}, rel=1e-9)
        assert output(f"te_pp_{shaft}_urad").read(curves) == pytest.approx(60e-3 / radius * 1e6, rel=1e-9)


def test_every_angle_names_its_shaft() -> None:
    for name, one in PLAIN.items():
        if one.unit in ("arcmin", "urad"):
            shafts = [gear for gear in ("driving", "driven") if f"_{gear}_" in name]
            assert len(shafts) == 1
            assert f"{shafts[0]} shaft" in one.says
            assert f"{shafts[0]} shaft" in describe(name)
            assert f"{shafts[0]} shaft" in axis_label(name, line=200)


def test_every_output_says_what_it_is() -> None:
    for name, one in PLAIN.items():
        assert one.says
        assert not one.unit or name.endswith("_" + one.unit.lower().replace("/", "_per_"))
    with pytest.raises(OutOfRangeError, match="mesh_order_N_um"):
        output("mesh_order_0_um")


def test_a_row_is_what_simulate_gives_with_its_seed(tmp_path: Path) -> None:
    theirs = {"te_pp_driven_urad": "te_pp_urad", "te_pp_driven_arcmin": "te_pp_arcmin",
              "lost_motion_mean_driving_arcmin": "lost_motion_mean_arcmin"}  # fmt: skip
    names = ["te_pp_um", "te_mean_um", "backlash_least_um", "backlash_mean_um", *theirs]
    plan = plan_study(read_study(write_study(tmp_path, f"outputs = {names}\n".replace("'", '"'))))
    for index in (0, 3):  # the first is certified, too
        row = make_row(plan, index)
        file = read_pair(tmp_path / "pair.toml")
        assembled = assemble(file, path=tmp_path / "pair.toml", seed=row.seed)
        ran = simulate(
            assembled, cycle_positions(assembled.pair, points_per_mesh=5), Condition(flank="drive", torque=0.0),
            seed=row.seed, evenly=False, fast=True, progress=lambda done: None,
        ).summary()  # fmt: skip
        for name, value in zip(names, row.outputs, strict=True):
            assert value == pytest.approx(
                ran[theirs.get(name, name)], abs=1e-8
            )  # 1e-12 rad, what both kernels agree to, times r_b2


@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_a_loaded_row_is_what_simulate_gives(tmp_path: Path, flank: str) -> None:
    names = ["te_pp_um", "te_mean_um", "backlash_least_um", "load_share_peak", "force_peak_n", "contact_ratio",
             "mesh_stiffness_mean_n_per_um"]  # fmt: skip
    text = f'flank = "{flank}"\noutputs = {names}\n[set]\n"pair.torque_nm" = 20.0\n'.replace("'", '"')
    plan = plan_study(read_study(write_study(tmp_path, text)))
    row = make_row(plan, 0)
    found = dict(zip(names, row.outputs, strict=True))
    assembled = assemble(read_pair(tmp_path / "pair.toml"), path=tmp_path / "pair.toml", seed=row.seed)
    condition = Condition(flank="drive" if flank == "drive" else "coast", torque=20.0 * NM)
    ran = simulate(
        assembled, cycle_positions(assembled.pair, points_per_mesh=5), condition, seed=row.seed, evenly=True, fast=True,
        progress=lambda done: None,
    ).summary()  # fmt: skip
    for mine, theirs in (("te_pp_um", "te_pp_um"), ("te_mean_um", "te_mean_um"), ("load_share_peak", "share_largest"),
                         ("force_peak_n", "force_largest_n"), ("backlash_least_um", "backlash_least_um"),
                         ("mesh_stiffness_mean_n_per_um", "mesh_stiffness_mean_n_per_um")):  # fmt: skip
        assert found[mine] == pytest.approx(ran[theirs], rel=1e-7), mine  # forces balance to 1e-9 of the torque
    assert found["contact_ratio"] == pytest.approx(ran["contact_ratio"], abs=1e-12)  # the same counts, summed


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"tip_relief": {"amount_um": 8.0, "length_mm": 0.5, "shape": "parabolic", "flank": "drive"}},
        {"profile_errors": "scatter", "thickness_errors": "independent"},
        {"eccentricity": {"amplitude_um": 20.0, "angle_deg": 70.0}},
        {"limits": {"E_sns_um": -90.0, "E_sni_um": -150.0}},
        {"grade": None, "inspection": {"pitch_um": 3.0, "tooth_thickness_um": -80.0}},
    ],
)
def test_made_pairs_are_assembled_pairs(tmp_path: Path, changes: dict[str, object]) -> None:
    path = tmp_path / "pair.toml"
    path.write_text(PAIR, encoding="utf-8")
    raw = read_pair(path).model_dump(exclude_unset=True)
    raw["driving"] = {key: value for key, value in (raw["driving"] | changes).items() if value is not None}
    file = PairFile.model_validate(raw)
    quick = maker(file, path)
    for seed in (0, 5):
        one, two = assemble(file, path=path, seed=seed), quick.make(seed)
        assert one.pair.a == two.pair.a
        for mine, theirs in ((one.pair.driving, two.pair.driving), (one.pair.driven, two.pair.driven)):
            assert mine.eccentricity == pytest.approx(theirs.eccentricity)
            assert np.array_equal(mine.flanks.r, theirs.flanks.r)
            for side in ("psi_drive", "psi_coast"):
                # Rounding of angles, and of cosines that the one sums and the other makes by recurrence.
                np.testing.assert_allclose(getattr(mine.flanks, side), getattr(theirs.flanks, side), atol=5e-15)


@pytest.mark.long
def test_pairs_that_jam_or_cannot_be_made_are_rows_too(tmp_path: Path) -> None:
    jams = PAIR.replace("grade = 6\n", "grade = 6\nlimits = { E_sns_um = 30.0, E_sni_um = -10.0 }\n")
    rows = [make_row(plan_study(read_study(write_study(tmp_path, pair=jams))), k) for k in range(6)]
    assert {row.status for row in rows} == {"jams"}
    assert "overlap" in rows[0].reason
    assert all(math.isnan(value) for row in rows for value in row.outputs)
    far = '[[sweep]]\nkey = "pair.centre_distance_mm"\nmethod = "list"\nvalues = [25.2, 60.0]\n'
    row = make_row(plan_study(read_study(write_study(tmp_path, far))), 1)
    assert row.status == "refused"
    assert "reach" in row.reason
    # Tip circles of 13.6 and 15.4 mm still overlap here, but between two teeth the gears turn freely.
    row = make_row(plan_study(read_study(write_study(tmp_path, far.replace("60.0", "28.8")))), 1)
    assert row.status == "no_contact"
    assert "no drive flanks touch" in row.reason


def test_measured_traces_travel_with_the_plan(tmp_path: Path) -> None:
    lines = [
        "tooth,flank,roll_length_mm,deviation_um",
        *(f"{t},drive,{l},{t % 3}" for t in range(11) for l in (2.0, 6.0)),
    ]
    (tmp_path / "traces.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    inspected = PAIR.replace(
        "grade = 6\n", 'inspection = { profile_csv = "traces.csv", tooth_thickness_um = -80.0 }\n', 1
    )
    plan = plan_study(read_study(write_study(tmp_path, pair=inspected)))
    (tmp_path / "traces.csv").unlink()  # a worker elsewhere has no such file
    row = make_row(replace(plan), 0)
    assert row.status == "done", row.reason


@pytest.mark.long
def test_an_inspection_file_travels_with_the_plan(tmp_path: Path) -> None:
    (tmp_path / "drawn.toml").write_text(PAIR, encoding="utf-8")
    api.load(tmp_path / "drawn.toml", seed=3).export(tmp_path / "driving.gde", which="driving")
    inspected = PAIR.replace("grade = 6\n", 'inspection = { gde = "driving.gde" }\n', 1)
    plan = plan_study(read_study(write_study(tmp_path, pair=inspected)))
    (tmp_path / "driving.gde").unlink()  # a worker elsewhere has no such file
    row = make_row(replace(plan), 0)
    assert row.status == "done", row.reason
