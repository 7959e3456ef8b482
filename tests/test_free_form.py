"""What no physics makes of a flank is estimated as a curve, and stands in the fitted file, which fits as well."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.assemble import assemble
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.gear.deviations import total
from gearpoly.keys.edit import on_gear
from gearpoly.keys.sections import FormSection
from gearpoly.report.diagnosis_report import verdict_json
from gearpoly.units import UM, FloatArray
from tests.made_pairfile import refusal
from tests.physics_cases import Condition, recorded, rough

GEARS = "[driving]\nteeth = 12\nmodule_mm = 2.0\n{}[driven]\nteeth = 16\nmodule_mm = 2.0\n"
TABLE = "[[driving.form]]\ntooth = {tooth}\nroll_length_mm = {l}\ndeviation_um = {d}\n"


def deviation_of(file: PairFile, l: FloatArray) -> FloatArray:
    """Deviation (z, n) in mm of the driving drive flanks."""
    made = assemble(file, path=Path("pair.toml"), seed=0)
    span = made.pair.driving.flanks.span
    return total(made.deviations[0].drive, l[None, :], z=file.driving.teeth, span=span)


def test_a_form_is_added_to_the_flank_of_its_tooth(tmp_path: Path) -> None:
    path = tmp_path / "pair.toml"
    path.write_text(GEARS.format(TABLE.format(tooth=3, l=[2.0, 4.0], d=[1.0, -3.0])))
    l = np.array([1.0, 2.0, 3.0, 4.0, 9.0])
    got = deviation_of(read_pair(path), l) / UM
    assert np.allclose(got[3], [1.0, 1.0, -1.0, -3.0, -3.0])  # straight between, level beyond
    assert np.all(np.delete(got, 3, axis=0) == 0.0)


@pytest.mark.parametrize(
    ("tooth", "l", "d", "says"),
    [
        (12, [1.0, 2.0], [0.0, 1.0], "want a tooth from 0 to 11"),
        (0, [2.0, 1.0], [0.0, 1.0], "want roll lengths that rise"),
        (0, [1.0, 2.0], [0.0, 1.0, 2.0], "want 2, one for each of roll_length_mm"),
        (0, [1.0], [0.0], "roll_length_mm"),
    ],
)
def test_a_form_that_is_none_is_refused(tooth: int, l: list[float], d: list[float], says: str, tmp_path: Path) -> None:
    assert says in str(refusal(tmp_path, GEARS.format(TABLE.format(tooth=tooth, l=l, d=d))))


def wavy(file: PairFile) -> PairFile:
    """The pair with a tooth whose flank waves as no physics does."""
    made = assemble(file, path=Path("pair.toml"), seed=0)
    span = made.pair.driving.flanks.span
    u = np.linspace(0.0, 1.0, 60)
    form = FormSection(
        tooth=4,
        roll_length_mm=tuple((span.l_start + u * (span.l_a - span.l_start)).tolist()),
        deviation_um=tuple((6.0 * np.sin(2.0 * np.pi * 1.5 * u)).tolist()),
    )
    return on_gear(file, 0, form=(form,))


@pytest.mark.slow
def test_a_flank_that_waves_is_not_named_and_the_fitted_file_has_it(tmp_path: Path) -> None:
    """Neither a pit nor a pitch error: its place is told, the curve lies within its error band where the tooth carries,
    and simulating the fitted file leaves the noise."""
    known, path = rough(points=300), tmp_path / "pair.toml"
    recordings = recorded(wavy(known), (Condition(torque_nm=20.0),), np.random.default_rng(4), per_mesh=20)
    found = diagnose(known, recordings, path=path)
    verdict = verdict_json(found)
    assert not verdict["missing"]
    (one,) = [entry for entry in verdict["unexplained"] if entry["kind"] == "tooth"]
    assert (one["gear"], one["tooth"]) == ("driving", 4) and one["probability"] > 0.99
    (curve,) = one["flank_curves"]
    l, d, std = (np.array(curve[name]) for name in ("roll_length_mm", "deviation_um", "std_um"))
    true = 6.0 * np.sin(2.0 * np.pi * 1.5 * (l - l[0]) / (l[-1] - l[0]))
    inside = slice(1, -1)
    # Straight between nine places: a wave of two thirds of the flank is off by h^2/8 d'' = 0.5 um at most.
    assert np.all(np.abs(d - true)[inside] < 3.0 * std[inside] + 0.5)
    fitted = tmp_path / "fitted.toml"
    fitted.write_text(dump_pair(found.fitted), encoding="utf-8")
    assert len(read_pair(fitted).driving.form) == 1
    assert found.after.unseen == pytest.approx(0.3 * UM, rel=0.1)
