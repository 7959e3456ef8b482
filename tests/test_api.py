"""The Python API: what is offered is listed and documented, results are the command line's, tables and pictures."""

from __future__ import annotations

import inspect
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import gearpoly
from gearpoly import api
from gearpoly.report.simulation_files import CSV_HEADER
from tests.made_command import Command
from tests.test_diagnose_command import ANGLE_DEG, E_UM, NOISE_UM, bench  # noqa: F401

ROOT = Path(__file__).resolve().parents[1]
GRADED = ROOT / "data" / "pairs" / "graded_18_25.toml"
REFERENCE = ROOT / "docs" / "reference" / "api.md"


def test_what_is_offered_is_listed_once_and_is_there() -> None:
    assert sorted(gearpoly.__all__) == gearpoly.__all__ == dir(gearpoly)
    assert set(gearpoly.__all__) == set(api.__all__) | {"__version__"}
    assert all(getattr(gearpoly, name) is getattr(api, name) for name in api.__all__)
    assert (ROOT / "gearpoly" / "py.typed").is_file()


@pytest.mark.parametrize("name", sorted(set(gearpoly.__all__) - {"__version__"}))
def test_what_is_offered_is_documented_and_typed(name: str) -> None:
    """Also every public member of a class of the API: a docstring, and a type for what it takes and gives."""
    one = getattr(gearpoly, name)
    text = REFERENCE.read_text(encoding="utf-8")
    assert f":: gearpoly.{name}\n" in text or f"`{name}`" in text
    assert inspect.getdoc(one)
    if inspect.isclass(one) and one.__module__.startswith("gearpoly.api"):
        for member, value in vars(one).items():
            if member.startswith("_") or member in one.__dataclass_fields__:
                continue
            found = getattr(value, "fget", None) or getattr(value, "func", None) or getattr(value, "__func__", value)
            assert inspect.getdoc(found), f"{name}.{member}"
            assert "return" in found.__annotations__, f"{name}.{member}"


KNOWN_BY_ALL = {"Any", "Literal", "Mapping", "None", "Path", "Self", "Sequence"}


def annotations(one: object) -> list[str]:
    """What a function of the API, or a class with its public members, takes and gives."""
    members = (
        [one, *(value for name, value in vars(one).items() if not name.startswith("_"))]
        if inspect.isclass(one)
        else [one]
    )
    found = [getattr(v, "fget", None) or getattr(v, "func", None) or getattr(v, "__func__", v) for v in members]
    return [str(kind) for each in found for kind in getattr(each, "__annotations__", {}).values()]


def test_every_type_of_a_signature_has_an_entry() -> None:
    text = REFERENCE.read_text(encoding="utf-8")
    entries = set(re.findall(r":: gearpoly\.(?:\w+\.)*(\w+)", text)) | set(re.findall(r"`([A-Z]\w+)`", text))
    offered = [getattr(gearpoly, name) for name in gearpoly.__all__ if name != "__version__"]
    named = {word for one in offered for kind in annotations(one) for word in re.findall(r"\b[A-Z]\w+", kind)}
    assert len(named) > 20 and not named - entries - KNOWN_BY_ALL


def test_nothing_heavy_is_loaded_before_it_is_asked_for() -> None:
    """Processor time of the import itself, beside the interpreter's own: 0.15 s at most; it takes 0.01 s."""
    code = (
        "import sys, time; before = time.process_time(); import gearpoly; spent = time.process_time() - before\n"
        "heavy = {'numpy', 'scipy', 'shapely', 'matplotlib', 'pandas', 'pydantic'} & set(sys.modules)\n"
        "print(spent < 0.15, sorted(heavy))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert ran.stdout == "True []\n"


def test_no_name_is_a_module_of_the_package() -> None:
    """Importing a module binds its name in the package, and would hide a function of that name."""
    there = {path.stem for path in (ROOT / "gearpoly").iterdir() if path.suffix == ".py" or path.is_dir()}
    assert not there & set(gearpoly.__all__)


def shown_in_a_notebook(figure: Figure) -> bool:
    """Whether a notebook finds a picture in it without pyplot."""
    return figure._repr_png_().startswith(b"\x89PNG") and "pyplot" not in type(figure).__module__  # type: ignore[attr-defined]


def test_a_simulation_is_the_commands(tmp_path: Path, gearpoly_command: Command) -> None:
    run = gearpoly.load(GRADED, seed=3).simulate(turns=0.2, fast=True)
    target = tmp_path / "te.csv"
    ran = gearpoly_command("simulate", str(GRADED), "--seed", "3", "--turns", "0.2", "--fast", "--csv", str(target))
    assert ran.code == 0, ran.err
    run.to_csv(tmp_path / "mine.csv")
    assert (tmp_path / "mine.csv").read_text() == target.read_text()
    columns = np.loadtxt(target, delimiter=",", skiprows=1).T
    mine = (run.driven_angle_deg, run.driving_angle_deg, None, run.te_um, run.backlash_um, run.contact_pairs)
    for theirs, ours in zip(columns, mine, strict=True):
        if ours is not None:
            np.testing.assert_allclose(ours, theirs, atol=1e-6)  # the file's last place
    assert run.te_pp_um == pytest.approx(np.ptp(run.te_um), rel=1e-12)
    assert run.backlash_mean_um == pytest.approx(run.backlash_um.mean(), rel=1e-12)
    figure = run.plot(tmp_path / "te.svg")
    assert figure.axes[0].lines[0].get_ydata() == pytest.approx(run.te_um)
    assert shown_in_a_notebook(figure)
    assert (tmp_path / "te.svg").stat().st_size > 5000


@pytest.mark.slow
def test_a_diagnosis_is_the_commands(bench: Path, tmp_path: Path) -> None:  # noqa: F811
    pair = gearpoly.load(bench / "pair.toml")
    found = pair.diagnose(bench / "rec.csv")
    assert [one.claim.physics.name for one in found.missing] == ["eccentricity"]
    value, std = found.missing[0].parameters["amplitude_um"]
    assert value == pytest.approx(E_UM, abs=max(4.0 * std, 0.05))
    assert found.noise_um == pytest.approx(NOISE_UM, rel=0.1) and found.after_um < 1.1 * NOISE_UM < found.before_um
    assert found.says[0].startswith("The driving gear runs 6") and found.status == found.verdict["status"]
    assert re.fullmatch(
        rf"<Diagnosed \S+pair\.toml: explained, eccentricity, unseen {found.before_um:.3g} um rms before, .* um>",
        repr(found),
    )
    with pytest.raises(gearpoly.OutOfRangeError, match=r"^recording 1: want 0$"):
        found.plot(recording=1)
    with pytest.raises(gearpoly.OutOfRangeError, match=r'^ending ".tif": want ".png", ".svg" or ".pdf"$'):
        found.to_figures(tmp_path / "pictures", ending=".tif")
    assert not (tmp_path / "pictures").exists()
    found.to_json(tmp_path / "v.json")
    assert json.loads((tmp_path / "v.json").read_text()) == json.loads(json.dumps(found.to_dict()))
    found.to_fitted(tmp_path / "fitted.toml")
    back = gearpoly.load(tmp_path / "fitted.toml")
    assert back.file.driving.eccentricity.angle_deg == pytest.approx(ANGLE_DEG, abs=1.0)
    # What was named is gone from a comparison with the fitted pair.
    assert back.compare(bench / "rec.csv").residual_rms_um < 1.2 * NOISE_UM
    assert found.plot().axes[1].get_ylabel() == "residual / um"
    assert shown_in_a_notebook(found.plot()) and shown_in_a_notebook(pair.compare(bench / "rec.csv").plot())
    found.to_html(tmp_path / "page.html")
    assert (tmp_path / "page.html").stat().st_size > 100_000


@pytest.mark.long
def test_recordings_need_no_gear_that_keeps_the_limits(bench: Path) -> None:  # noqa: F811
    """As on the command line: only what shows or simulates such a gear is refused, with the limits' message."""
    text = (bench / "pair.toml").read_text(encoding="utf-8")
    section = tomllib.loads(text)
    section["driven"].pop("inspection", None)
    section["driven"] |= {"grade": 6, "limits": {"E_sns_um": -50, "E_sni_um": -50.5}}
    pair = gearpoly.Pair.of(section)
    assert pair.compare(bench / "rec.csv").residual_rms_um > 0.0
    with pytest.raises(gearpoly.InputFileError, match="none of 400 gears drawn"):
        pair.export("pair.stl")
    with pytest.raises(gearpoly.InputFileError, match="none of 400 gears drawn"):
        pair.simulate()


def test_comparisons_and_plans_write_what_the_commands_do(
    bench: Path,  # noqa: F811
    tmp_path: Path,
    gearpoly_command: Command,
) -> None:
    pair = gearpoly.load(bench / "pair.toml")
    pair.compare(bench / "rec.csv").to_json(tmp_path / "mine.json")
    pair.plan().to_json(tmp_path / "plan.json")
    theirs = {"mine.json": ("compare", "rec.csv"), "plan.json": ("plan",)}
    for name, (command, *files) in theirs.items():
        paths = [str(bench / one) for one in files]
        ran = gearpoly_command(command, str(bench / "pair.toml"), *paths, "--json", str(tmp_path / f"their_{name}"))
        assert ran.code == 0
        assert (tmp_path / name).read_bytes() == (tmp_path / f"their_{name}").read_bytes()


@pytest.mark.long
def test_recordings_are_files_or_what_was_read(bench: Path) -> None:  # noqa: F811
    pair, file = gearpoly.load(bench / "pair.toml"), bench / "rec.csv"
    read = gearpoly.read(file)
    assert len(read) == 1 and isinstance(read[0], gearpoly.Recording)
    for given in (str(file), read[0]):
        found = pair.compare(given)
        assert found.where[0]["kind"] == "shaft_order" and found.where[0]["order"] == 1
        assert found.says[0].startswith("order 1 of the driving shaft")
        assert found.to_dict()["noise_um"] == found.noise_um
        assert f": 1 recording, residual {found.residual_rms_um:.3g} um rms, noise " in repr(found)


@pytest.mark.long
def test_tables_have_every_sample(bench: Path) -> None:  # noqa: F811
    pytest.importorskip("pandas")
    pair = gearpoly.load(bench / "pair.toml")
    compared = pair.compare(bench / "rec.csv")
    table = compared.to_pandas()
    assert list(table) == ["recording", "time_s", "driven_angle_deg", "recorded_um", "simulated_um", "residual_um"]
    assert len(table) == compared.comparison.aligned[0].theta_2.size
    np.testing.assert_allclose(table.recorded_um - table.simulated_um, table.residual_um, atol=1e-9)  # um
    assert float(table.residual_um.std(ddof=0)) == pytest.approx(compared.residual_rms_um, rel=1e-6)
    run = pair.simulate(turns=0.1, fast=True)
    assert list(run.to_pandas()) == CSV_HEADER.split(",") and len(run.to_pandas()) == run.te_um.size


@pytest.mark.long
def test_tables_ask_for_pandas(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    run = gearpoly.load(GRADED).simulate(turns=0.1, fast=True)
    with pytest.raises(gearpoly.MissingExtraError, match=r"pip install 'gearpoly\[pandas\]'"):
        run.to_pandas()


@pytest.mark.long
def test_a_plan_says_what_to_record(bench: Path) -> None:  # noqa: F811
    made = gearpoly.load(bench / "pair.toml").plan()
    assert made.says[0].startswith("Record the drive flank") and any("coast flank" in one for one in made.says)
    assert made.to_dict()["first"]["says"] == made.says[0]
    assert repr(made).startswith("<Planned: Record the drive flank") and len(repr(made)) < 300


def test_a_study_is_made_gone_on_with_and_read(tmp_path: Path) -> None:
    study = f"""
name = "two grades"
pair = "{GRADED}"
pairs = 3
positions_per_mesh = 8
turns = 0.2
outputs = ["te_pp_um", "backlash_least_um"]
[[sweep]]
name = "grade"
keys = ["driving.grade", "driven.grade"]
method = "list"
values = [4, 7]
[set]
"pair.torque_nm" = 0.0
"""
    (tmp_path / "study.toml").write_text(study, encoding="utf-8")
    made = gearpoly.run_study(tmp_path / "study.toml", tmp_path / "out")
    assert made.pairs == 6 and gearpoly.open_study(tmp_path / "out").pairs == 6
    assert made.plot().axes[0].get_ylabel() == "share of pairs" and shown_in_a_notebook(made.plot())
    with pytest.raises(gearpoly.OutOfRangeError, match='no picture "bear"; want one of outputs_1'):
        made.plot(what="bear")
    pandas = pytest.importorskip("pandas")
    table = made.to_pandas()
    assert isinstance(table, pandas.DataFrame) and len(table) == 6
    grades = table.groupby("driving.grade").te_pp_um.mean()
    assert grades[7] > 1.5 * grades[4]  # limits are 2.8 times as wide; three pairs of each scatter


def test_errors_of_the_api_are_the_commands() -> None:
    with pytest.raises(gearpoly.InputFileError) as caught:
        gearpoly.load("none.toml")
    assert isinstance(caught.value, gearpoly.GearpolyError) and caught.value.file == "none.toml"


def test_a_pair_is_saved_and_loaded_alike(tmp_path: Path) -> None:
    gearpoly.load(GRADED).save(tmp_path / "pair.toml")
    assert gearpoly.load(tmp_path / "pair.toml").file == gearpoly.load(GRADED).file
