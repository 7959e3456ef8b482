"""Faults of a study file: one message with file, key, what stands there and what would do."""

from __future__ import annotations

from pathlib import Path

import pytest

from gearpoly.errors import GearpolyError, InputFileError
from gearpoly.study.read import read_study
from gearpoly.study.run import plan_study
from tests.study_files import GRADES, PAIR, write_study

LIST = '[[sweep]]\nkey = {}\nmethod = "list"\nvalues = {}'
SOBOL = '[[sweep]]\nkey = "pair.centre_distance_mm"\nmethod = "sobol"\nfrom = 25.1\nto = 25.3\n'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("sede = 3", ["sede", "unknown key", '"seed"']),
        (LIST.format('"driving.grade"', "[5]") + '\nmetod = "list"', ["sweep[0].metod", '"method"']),
        (LIST.format('"driving.grad"', "[5]"), ["sweep[0]", "driving.grad", '"driving.grade"']),
        ('[[sweep]]\nkey = "driving.grade"\nmethod = "list"\nvalues = []', ["values", "an empty sweep"]),
        ('[[sweep]]\nkey = "driving.grade"\nmethod = "list"', ["values", "an empty sweep"]),
        ('[[sweep]]\nmethod = "list"\nvalues = [5]', ["key", "neither"]),
        ('[[sweep]]\nkey = "driving.grade"\nmethod = "lsit"\nvalues = [5]', ["sweep[0].method", '"lsit"', '"grid"']),
        ('[[sweep]]\nkey = "driving.grade"\nmethod = "grid"\nfrom = 4\nto = 6', ["steps", "missing"]),
        ('[[sweep]]\nkey = "driving.grade"\nmethod = "grid"\nfrom = 4\nto = 6\nsteps = 4', ["whole numbers"]),
        ('[[sweep]]\nkey = "driving.grade"\nmethod = "list"\nvalues = [5, 99]', ["driving.grade = 99", "99"]),
        (GRADES.replace("[5, 6, 7]", "[[5]]"), ["a row of 1", "want 2"]),
        (GRADES + '[[sweep]]\nkey = "driving.grade"\nmethod = "list"\nvalues = [4]', ['"driving.grade" is set twice']),
        (SOBOL, ["samples", "missing"]),
        ("samples = 100\n" + SOBOL, ["samples", "100", "power of two, such as 128"]),
        ("samples = 8", ["samples", "sobol"]),
        ("sensitivity = true", ["sensitivity", "sobol"]),
        ("samples = 8\nsensitivity = true\n" + SOBOL, ["sensitivity", "pairs"]),
        ('outputs = ["te_ppum"]', ["outputs", "te_ppum", '"te_pp_um"']),
        ("outputs = []", ["outputs", "empty"]),
        ('turns = 1.0\noutputs = ["F_i_driving_um"]', ["F_i_driving_um", "hunting cycle"]),
        ('outputs = ["mesh_order_3_um"]', ["mesh_order_3_um", "more than 6 positions_per_mesh, found 5"]),
        ('[[limit]]\noutput = "te_pp_driven_arcmin"\nat_most = 1.0', ["limit", "te_pp_driven_arcmin", "te_pp_um"]),
        ('outputs = ["te_pp_arcmin"]', ["of which shaft", "te_pp_driving_arcmin", "te_pp_driven_arcmin"]),
        ('outputs = ["lost_motion_mean_arcmin"]', ["lost_motion_mean_driving_arcmin", "lost_motion_mean_driven_"]),
        ('[[limit]]\noutput = "te_pp_um"', ["at_most", "no bound"]),
        ('[until]\noutput = "te_pp_um"\npercentile = 100.0\nwidth = 1.0', ["until.percentile", "below 100"]),
        ("[set]\n\"driving.teeht\" = 12", ["set", "driving.teeht", '"driving.teeth"']),
        ("[set]\n\"driving.teeth\" = 2", ["driving.teeth", "2 is too small"]),
        ("pairs = 0", ["line"]),
        ('[[sweep]]\nkey = "pair.torque_nm"\nmethod = "grid"\nfrom = 0\nto = 1\nsteps = 100000\n'
         '[[sweep]]\nkey = "driving.bore_mm"\nmethod = "grid"\nfrom = 1\nto = 2\nsteps = 100000', ["combinations"]),
    ],
)  # fmt: skip
def test_message_names_file_key_and_cure(tmp_path: Path, text: str, says: list[str]) -> None:
    path = write_study(tmp_path, text)
    with pytest.raises(InputFileError) as caught:
        plan_study(read_study(path))
    assert str(path) in str(caught.value)
    for part in says:
        assert part in str(caught.value)


def test_outputs_by_default_are_those_that_the_positions_allow(tmp_path: Path) -> None:
    assert "F_i_driving_um" in read_study(write_study(tmp_path)).file.outputs
    outputs = read_study(write_study(tmp_path, "turns = 1.0\n")).file.outputs
    assert "te_pp_um" in outputs
    assert not any(name.startswith(("F_i", "side_band", "mesh")) for name in outputs)


def test_a_study_without_its_pair_says_where_it_looked(tmp_path: Path) -> None:
    path = write_study(tmp_path)
    (tmp_path / "pair.toml").unlink()
    with pytest.raises(InputFileError, match="no such file"):
        read_study(path)
    with pytest.raises(GearpolyError, match="none"):
        read_study(tmp_path / "none.toml")


def test_a_fault_of_the_pair_file_is_told(tmp_path: Path) -> None:
    path = write_study(tmp_path, pair=PAIR.replace("teeth = 11", "teht = 11"))
    with pytest.raises(InputFileError, match="teht"):
        plan_study(read_study(path))


def test_the_studies_that_come_along_are_sound() -> None:
    for path in sorted((Path(__file__).parents[1] / "data" / "studies").glob("*.toml")):
        assert plan_study(read_study(path)).design.rows > 1
