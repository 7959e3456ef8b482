"""``gearpoly diagnose`` from files to files: what is printed, the verdict's schema, the fitted file, an interrupt."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest
from pydantic import BaseModel, ConfigDict, Field

from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.recording.recording import Recording
from tests import made_process
from tests.made_command import Command
from tests.made_process import read_until
from tests.made_recordings import Rig, inspected, record
from tests.physics_cases import CONTRACT
from tests.recording_files import write_csv

pytestmark = pytest.mark.long


E_UM, ANGLE_DEG, NOISE_UM = 6.0, 40.0, 0.3
RIG = Rig(zero_1=1.0, zero_2=2.0, noise=NOISE_UM)


def csv(target: Path, one: Recording, **keys: object) -> Path:
    """One recording as a user has it."""
    assert one.time_s is not None and one.driving_angle_rad is not None and one.driven_angle_rad is not None
    columns = {
        "time_s": one.time_s,
        "driving_angle_deg": np.degrees(one.driving_angle_rad),
        "driven_angle_deg": np.degrees(one.driven_angle_rad),
    }
    stated = {"torque_nm": 0.0, "flank": one.flank}
    zeros = {f"{name}_zero_deg": math.degrees(z) for name, z in (("driving", RIG.zero_1), ("driven", RIG.zero_2))}
    write_csv(target, columns, stated | zeros | keys)
    return target


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with pair.toml, whose driving gear runs off its axis, which it does not say, and rec.csv of it."""
    folder = tmp_path_factory.mktemp("bench")
    rng = np.random.default_rng(5)
    hidden = f"[driving.eccentricity]\namplitude_um = {E_UM}\nangle_deg = {ANGLE_DEG}"
    _, _, truth = inspected(folder, rng, z_1=11, z_2=13, hidden=hidden, points=120, gauge=0.1)
    csv(folder / "rec.csv", record(truth, RIG, rng, cycles=2.0))
    return folder


def begun(*arguments: object, stderr: int = subprocess.PIPE) -> subprocess.Popen[str]:
    return made_process.begun("-m", "gearpoly", "diagnose", *arguments, stdout=subprocess.PIPE, stderr=stderr)


@pytest.fixture(scope="module")
def said(bench: Path) -> tuple[str, str]:
    """What a diagnosis prints and says on standard error while it writes all that takes no pictures."""
    targets = {"json": "v.json", "html": "v.html", "fitted": "fit.toml"}
    run = begun(bench / "pair.toml", bench / "rec.csv", *(w for k, v in targets.items() for w in (f"--{k}", bench / v)))
    out, err = run.communicate(timeout=300)
    assert run.returncode == 0, err
    return out, err


@pytest.fixture(scope="module")
def printed(said: tuple[str, str]) -> str:
    return said[0]


class Strict(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)


Size = Annotated[float, Field(ge=0.0)]
Chance = Annotated[float, Field(ge=0.0, le=1.0)]
Deg = Annotated[float, Field(ge=0.0, lt=360.0)]
Count = Annotated[int, Field(ge=0)]
Gear = Literal["driving", "driven"]


class Valued(Strict):
    value: float
    std: Size


class Rms(Strict):
    before: Size
    after: Size


class Alignment(BaseModel):
    # Further keys may stand beside the contract's.
    model_config = ConfigDict(strict=True, allow_inf_nan=False)
    driving_zero_deg: float
    driven_zero_deg: float
    std_deg: Size


class Where(BaseModel):
    model_config = ConfigDict(strict=True, allow_inf_nan=False)
    kind: Literal["shaft_order", "tooth", "mesh_phase", "mesh_order", "time", "drift", "step", "condition"]
    gear: Gear | None = None
    tooth: Count | None = None
    encoder_deg: Deg | None = None
    amplitude_um: Size | None = None
    std_um: Size | None = None
    rms_um: Size | None = None


class Alike(Strict):
    physics: str
    gear: Gear | None = None
    tooth: Count | None = None
    encoder_deg: Deg | None = None
    flank: Literal["coast"] | None = None
    probability: Chance
    parameters: dict[str, dict[Literal["value"], float]]


class Heldout(Strict):
    without: Size
    with_: Size = Field(alias="with")


class Separate(Strict):
    recording: dict[str, object]
    separability: Chance
    separability_now: Chance
    says: str = Field(min_length=5)


class Missing(Strict):
    physics: str
    gear: Gear | None = None
    parameters: dict[str, Valued]
    says: str = Field(min_length=5)
    heldout_rms_um: Heldout
    probability: Chance
    unknown_probability: Chance
    gain: Size
    model: str
    indistinguishable_from: list[Alike]
    would_separate: Separate | None = None


class Built(Strict):
    flanks: list[Literal["drive", "coast"]]
    pitch_um: list[float]
    pitch_std_um: list[Size]
    profile_slope_um: list[float]
    profile_slope_std_um: list[Size]
    grade_needed: Annotated[int, Field(ge=1, le=11)] | None
    grade_kept: Annotated[int, Field(ge=1, le=11)] | None
    grade_edition: Literal[1995, 2013]
    exceeds: list[dict[str, object]]


class BothBuilt(Strict):
    driving: Built
    driven: Built


class Squares(Strict):
    declared: Size
    as_built: Size
    with_names: Size
    std: Size


class Fit(Strict):
    heldout_rms_um: Rms
    train_rms_um: Rms
    as_built_only_heldout_rms_um: Size
    repeatable_mismatch_um: Rms
    held_out: str
    unseen_mean_square: Squares


class Verdict(Strict):
    """The contract's verdict of a pair that neither bends nor was recorded on its coast flank."""

    gearpoly: str
    pair: str
    status: Literal["nothing_missing", "explained", "partly_explained", "unexplained"]
    noise_um: Size
    noise_um_by_recording: list[Size]
    alignment: Alignment
    where: list[Where]
    missing: list[Missing]
    as_built: BothBuilt
    unexplained: list[Where]
    fit: Fit
    not_excluded: list[str]
    remarks: list[str]


def verdict_of(text: str) -> Verdict:
    verdict = Verdict.model_validate_json(text)
    for one in verdict.missing:
        assert set(one.parameters) >= CONTRACT[one.physics]
    for built, z in ((verdict.as_built.driving, 11), (verdict.as_built.driven, 13)):
        for values in (built.pitch_um, built.pitch_std_um, built.profile_slope_um, built.profile_slope_std_um):
            assert len(values) == z
    return verdict


def test_the_verdict_is_the_contract_s(bench: Path, printed: str) -> None:
    verdict = verdict_of((bench / "v.json").read_text())
    assert verdict.status == "explained"
    (one,) = verdict.missing
    # Gear and encoder off their axes look alike on one flank without numbers of either: e = A r_b1 / cos(alpha), 6 um
    # of 11 teeth. Two standard errors, and the 0.1 um of the gauge that 11 teeth leave of an order.
    alike = {one.physics} | {rival.physics for rival in one.indistinguishable_from}
    assert {"eccentricity", "encoder_eccentricity"} <= alike
    sizes = [one.parameters["amplitude_um"].value] if one.physics == "eccentricity" else []
    sizes += [r.parameters["amplitude_um"]["value"] for r in one.indistinguishable_from if r.physics == "eccentricity"]
    assert sizes == [pytest.approx(E_UM, abs=0.2)]
    assert one.would_separate.recording["flank"] == "coast"
    assert one.would_separate.separability > one.would_separate.separability_now
    # White noise of 0.3 um over 2288 samples is known to 1.5 %; unseen samples bear what 50 parameters err by.
    assert verdict.noise_um == pytest.approx(NOISE_UM, rel=0.05)
    assert verdict.fit.heldout_rms_um.after == pytest.approx(NOISE_UM, rel=0.1)
    assert verdict.fit.heldout_rms_um.before > 10.0 * verdict.fit.heldout_rms_um.after


def test_the_terminal_says_where_what_how_sure_what_else_and_what_next(bench: Path, printed: str) -> None:
    (one,) = verdict_of((bench / "v.json").read_text()).missing
    assert f"1. {one.says}" in printed
    assert "that it is this" in printed and "that a cause outside the catalogue does the same" in printed
    assert "or else, " in printed
    assert f"to decide: {one.would_separate.says}" in printed
    assert f"{one.heldout_rms_um.without:.4f} um rms without, {one.heldout_rms_um.with_:.4f} with" in printed
    for row in ("declared simulation", "with as-built teeth", "with what was missing", "driving gear as it runs"):
        assert row in printed
    assert "as built, drive flanks: pitch" in printed
    # What stands in brackets is said too.
    assert printed.startswith("made [front]")


def test_the_fitted_file_simulates_and_compares_to_the_noise(
    bench: Path, printed: str, gearpoly_command: Command
) -> None:
    simulated = gearpoly_command("simulate", bench / "fit.toml", "--turns", "1", "--points-per-mesh", "2")
    assert simulated.code == 0, simulated.err
    compared = gearpoly_command("compare", bench / "fit.toml", bench / "rec.csv", "--json", "-")
    assert compared.code == 0, compared.err
    told = json.loads(compared.out)
    assert "(fitted)" in (bench / "fit.toml").read_text()
    # All samples were fitted: the noise, known to 1.5 %, less what 50 parameters of 2288 samples took.
    assert told["recordings"][0]["residual_rms_um"] == pytest.approx(NOISE_UM, rel=0.05)
    assert told["where"] == []
    assert (bench / "v.html").read_text().startswith("<!")


@pytest.mark.slow
@pytest.mark.skipif(find_spec("reportlab") is None, reason="reportlab is not installed")
def test_the_command_writes_a_report_and_pictures(bench: Path, gearpoly_command: Command) -> None:
    report, pictures = bench / "report.pdf", bench / "pictures"
    ran = gearpoly_command(
        "diagnose", bench / "pair.toml", bench / "rec.csv", "--figures", pictures, "--pdf", report
    )  # fmt: skip
    assert f"wrote {pictures}: every picture" in ran.err and (pictures / "fit.svg").is_file()
    assert f"wrote {report}: the report for paper" in ran.err and report.read_bytes().startswith(b"%PDF")


def test_a_folder_for_pictures_is_no_file(bench: Path, gearpoly_command: Command) -> None:
    ran = gearpoly_command("diagnose", bench / "pair.toml", bench / "rec.csv", "--figures", bench / "rec.csv")
    assert ran.code == 2 and "this is a file; want the name of a folder" in ran.err


def test_only_the_verdict_goes_to_standard_output(
    bench: Path, printed: str, gearpoly_command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same recording gives the same verdict to the last digit, whichever way it goes out, here in this process.
    What draws the report and the pictures, whose pages tests/test_diagnosis_on_paper.py sees, is asked for both."""
    drawn: list[tuple[str, Path]] = []

    def noted(diagnosis: Diagnosis, target: Path) -> None:
        drawn.append((diagnosis.status, target))

    monkeypatch.setattr("gearpoly.report.diagnosis_pdf.check_extra", lambda: None)
    monkeypatch.setattr("gearpoly.report.diagnosis_pdf.write_pdf", noted)
    monkeypatch.setattr("gearpoly.report.diagnosis_figures.write_figures", noted)
    paper = ("--pdf", bench / "report.pdf", "--figures", bench / "pictures")
    ran = gearpoly_command("diagnose", bench / "pair.toml", bench / "rec.csv", "--json", "-", *paper)
    assert ran.code == 0, ran.err
    assert drawn == [("explained", bench / "report.pdf"), ("explained", bench / "pictures")]
    assert f"wrote {bench / 'report.pdf'}: the report for paper" in ran.err
    assert f"wrote {bench / 'pictures'}: every picture" in ran.err
    assert verdict_of(ran.out).status == "explained"
    assert ran.out.rstrip("\n") == (bench / "v.json").read_text().rstrip("\n")


def test_an_interrupt_in_the_search_leaves_nothing_behind(bench: Path, tmp_path: Path) -> None:
    """Interrupted while it looks for what is missing: 130 as every shell has it, one line, no file."""
    folder = tmp_path / "results"
    folder.mkdir()
    targets = [word for name in ("json", "html", "fitted") for word in (f"--{name}", str(folder / name))]
    # What is done shows on a terminal only.
    ours, theirs = os.openpty()
    run = begun(bench / "pair.toml", bench / "rec.csv", *targets, stderr=theirs)
    os.close(theirs)
    seen = read_until(ours, "looking for what is missing", of=run)
    run.send_signal(signal.SIGINT)
    seen += read_until(ours, None, of=run)
    os.close(ours)
    out, _ = run.communicate(timeout=120)
    assert run.returncode == 130, seen
    assert out == ""
    assert "gearpoly: interrupted; nothing half-written was left behind" in seen
    assert "Traceback" not in seen
    assert list(folder.iterdir()) == []
