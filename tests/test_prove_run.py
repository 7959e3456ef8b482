"""The proof from end to end with diagnosers that only pretend: sealing, going on, the same bytes, the page."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from gearpoly.__main__ import main
from gearpoly.cli import app
from gearpoly.diagnose.method import Method
from gearpoly.errors import GearpolyError, InputFileError
from gearpoly.files.pairfile import read_pair
from gearpoly.physics import catalogue
from gearpoly.physics.samples import Samples
from gearpoly.prove import pool, work
from gearpoly.prove import run as proving_run
from gearpoly.prove.arms import arms
from gearpoly.prove.board import board_json
from gearpoly.prove.diagnoser import How, wrong
from gearpoly.prove.drawn import draw_sizes
from gearpoly.prove.page import board_text, page
from gearpoly.prove.run import Proof, prove_folder, prove_ground
from gearpoly.proving.ground import plan
from gearpoly.proving.grounds import GROUNDS
from gearpoly.proving.rig import BenchError
from gearpoly.study import progress
from tests import made_process
from tests.made_jobs import nap, refuse
from tests.made_prove import BENCH, broken, endless, fake, silent, slow, stuck, write_cases

pytestmark = pytest.mark.long


def quiet(what: str) -> None:
    """Says nothing."""


def verdicts(out: Path) -> dict[str, bytes]:
    # What is still being written aside begins with a dot.
    return {path.name: path.read_bytes() for path in sorted((out / "verdicts" / "plain").glob("[!.]*.json"))}


def board(proof: Proof) -> dict[str, Any]:
    """The scoreboard without what is time."""
    return {key: value for key, value in board_json(proof).items() if key != "seconds"}


@pytest.fixture
def bench(tmp_path: Path) -> Path:
    return write_cases(tmp_path / "bench", BENCH)


def test_a_folder_laid_out_like_the_bench(bench: Path, tmp_path: Path) -> None:
    proof = prove_folder(bench, out=tmp_path / "out", diagnoser=fake, say=quiet)
    told = {one.name: one for one in proof.scores}
    assert list(told) == ["alpha", "beta", "delta", "gamma"]
    assert told["alpha"].claims == 1
    assert told["beta"].items[0].first
    assert told["delta"].located
    assert told["gamma"].items[0].named
    assert not told["gamma"].items[0].placed
    found = board(proof)
    misses = {one["case"]: one["misses"] for one in found["failures"]}
    assert misses["alpha"] == ["false_alarms", "false_names", "false_name_cases"]
    assert {"right_tooth", "named_first", "extras", "in_reported_set"} <= set(misses["gamma"])
    assert "beta" not in misses


def test_truths_are_hashed_before_anything_is_scored(
    bench: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[str] = []
    scored: list[int] = []
    real = proving_run.score

    def noted(*args: Any, **how: Any) -> Any:
        scored.append(len(said))
        return real(*args, **how)

    monkeypatch.setattr(proving_run, "score", noted)
    proof = prove_folder(bench, out=tmp_path / "out", diagnoser=fake, say=said.append)
    sealed = next(k for k, line in enumerate(said) if proof.sealed in line)
    assert min(scored) > sealed
    for line in (tmp_path / "out" / "truths.sha256").read_text().splitlines():
        digest, name = line.split("  ")
        assert hashlib.sha256((bench / name).read_bytes()).hexdigest() == digest


def test_a_truth_that_changes_under_way_stops_the_proof(bench: Path, tmp_path: Path) -> None:
    def meddling(pair: Path, recordings: Any, how: How) -> dict[str, Any]:
        (bench / "alpha.truth.json").write_text('{"kind": "none", "truth": [], "noise_um": 2.0}')
        return fake(pair, recordings, how)

    with pytest.raises(InputFileError, match="a truth changed"):
        prove_folder(bench, out=tmp_path / "out", diagnoser=meddling, say=quiet)


def test_a_bench_that_fails_names_the_case_and_the_seed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A fault of the bench is none of the user's files: one line, exit 1, and no case half written."""

    def failing(seed: int, entry: Any) -> Any:
        raise BenchError("no equilibrium at 1 of 114 positions")

    monkeypatch.setitem(GROUNDS, "real-life", replace(GROUNDS["real-life"], make=failing))
    out = tmp_path / "out"
    argv = ["gearpoly", "prove", "--ground", "real-life", "--seed", "7", "--workers", "1", "--out", str(out)]
    monkeypatch.setattr(sys, "argv", argv)
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 1
    said = [line for line in capsys.readouterr().err.splitlines() if "equilibrium" in line]
    assert len(said) == 1
    assert (
        "case_000 of the real-life ground of seed 7: no equilibrium at 1 of 114 positions. This is a fault in"
        in said[0]
    )
    assert list((out / "cases").iterdir()) == list((out / "truths").iterdir()) == []


def test_two_workers_write_the_same_bytes(bench: Path, tmp_path: Path) -> None:
    one = prove_folder(bench, out=tmp_path / "one", workers=1, diagnoser=fake, say=quiet)
    two = prove_folder(bench, out=tmp_path / "two", workers=2, diagnoser=fake, say=quiet)
    assert verdicts(tmp_path / "one") == verdicts(tmp_path / "two")
    assert board(one) == board(two)


@pytest.mark.slow
def test_a_killed_run_goes_on(bench: Path, tmp_path: Path) -> None:
    script = (
        "from pathlib import Path; from gearpoly.prove.run import prove_folder; from tests.made_prove import slow\n"
        f"prove_folder(Path({str(bench)!r}), out=Path({str(tmp_path / 'out')!r}), diagnoser=slow)"
    )
    root = Path(__file__).resolve().parents[1]
    place = tmp_path / "out" / "verdicts" / "plain"
    killed = subprocess.Popen([sys.executable, "-c", script], cwd=root, stdout=subprocess.DEVNULL)
    deadline = time.monotonic() + 60.0  # a start takes seconds on a busy machine
    while not list(place.glob("[!.]*.json")) and time.monotonic() < deadline:
        time.sleep(0.02)
    os.kill(killed.pid, signal.SIGKILL)
    killed.wait()
    before = verdicts(tmp_path / "out")
    assert 0 < len(before) < len(BENCH)
    proof = prove_folder(bench, out=tmp_path / "out", diagnoser=slow, say=quiet)
    runs = (tmp_path / "runs.txt").read_text().split()
    assert all(runs.count(Path(name).stem) == 1 for name in before)  # finished cases are not done again
    assert board(proof) == board(prove_folder(bench, out=tmp_path / "fresh", diagnoser=slow, say=quiet))


STUCK = """
import sys
from functools import partial
from gearpoly import __main__
from gearpoly.prove import run
from tests.made_prove import stuck
if __name__ == "__main__":
    run.prove_folder = partial(run.prove_folder, diagnoser=stuck)
    __main__.command()
"""


@pytest.fixture
def begun(bench: Path, tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """The command with two workers, both of them busy for an hour with what is left; two cases are finished."""
    script = tmp_path / "stuck.py"
    script.write_text(STUCK)
    root = Path(__file__).resolve().parents[1]
    place = tmp_path / "out" / "verdicts" / "plain"
    process = made_process.begun(
        script, "prove", "--on", bench, "--out", tmp_path / "out", "--workers", "2", env={"PYTHONPATH": str(root)},
        cwd=root, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    marks = [tmp_path / "beta.begun", tmp_path / "gamma.begun", place / "alpha.json", place / "delta.json"]
    deadline = time.monotonic() + 120.0  # two starts of Python on a busy machine
    while not all(mark.exists() for mark in marks) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert process.poll() is None
    yield process
    if process.poll() is None:
        process.kill()
        process.communicate()


def workers_of(process: subprocess.Popen[str]) -> list[int]:
    listed = subprocess.run(["ps", "-ww", "--ppid", str(process.pid), "-o", "pid,args"], capture_output=True, text=True)
    return [int(line.split()[0]) for line in listed.stdout.splitlines() if "spawn_main" in line]


def gone(pid: int) -> bool:
    """Whether a process has ended; one that nobody has asked for yet has, too."""
    status = Path("/proc") / str(pid) / "status"
    return not status.exists() or "State:\tZ" in status.read_text()


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize(
    "how", ["a worker is killed", pytest.param("the command is interrupted", marks=pytest.mark.slow)]
)
def test_workers_that_die_leave_what_is_finished(
    begun: subprocess.Popen[str], bench: Path, tmp_path: Path, how: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    workers = workers_of(begun)
    assert len(workers) == 2
    if how == "a worker is killed":
        os.kill(workers[0], signal.SIGKILL)
    else:  # only the command: what is under way would go on for an hour
        os.kill(begun.pid, signal.SIGINT)
    _, said = begun.communicate(timeout=60.0)  # it takes a second; an hour if it waited
    assert all(gone(pid) for pid in workers)
    assert "Traceback" not in said
    if how == "a worker is killed":
        assert begun.returncode == 2
        assert "a worker process died at beta or gamma (killed, or out of memory?)" in said
        assert "what is finished is kept" in said
    else:
        assert begun.returncode == 130
        assert "interrupted; what is finished is kept" in said
    kept = verdicts(tmp_path / "out")
    assert set(kept) == {"alpha.json", "delta.json"}
    # The same again, by a diagnoser that comes to an end, makes what is left.
    place = tmp_path / "out" / "verdicts" / "plain"
    before = {name: (place / name).stat().st_mtime_ns for name in kept}
    code = json.loads(kept["alpha.json"])["key"].split()[1]
    left = [job for job in ("beta", "gamma") if not (place / f"{job}.json").exists()]
    assert left == ["beta", "gamma"]
    monkeypatch.setattr("time.sleep", lambda seconds: None)
    told: list[str] = []
    prove_folder(bench, out=tmp_path / "out", diagnoser=stuck, say=told.append)
    assert any("2 of 4 diagnoses are there from a run before" in one for one in told)
    assert all((place / name).stat().st_mtime_ns == when for name, when in before.items())
    assert json.loads((place / "beta.json").read_text())["key"].split()[1] == code
    assert len(verdicts(tmp_path / "out")) == len(BENCH)


def test_what_takes_long_is_named_in_the_progress(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(pool, "LOOK_EVERY", 0.05)
    monkeypatch.setattr(pool, "SLOW_JOB", 0.2)
    monkeypatch.setattr(progress, "EVERY", 0.0)
    pool.each(nap, [0.0, 0.01, 1.5], workers=2, what="naps", name=lambda job: f"nap {job:g}")
    said = capsys.readouterr().err
    assert "gearpoly prove: 2 of 3 naps" in said
    assert "nap 1.5 for" in said
    assert "3 of 3 naps" in said


@pytest.mark.parametrize("workers", [1, 2])
def test_what_a_worker_refuses_is_told_as_it_is(workers: int) -> None:
    with pytest.raises(GearpolyError, match="No space left on device; check space"):
        pool.each(refuse, ["check space"], workers=workers, what="cases", name=str)


def test_other_recordings_and_other_code_are_diagnosed_again(bench: Path, tmp_path: Path) -> None:
    def runs() -> int:
        return len((tmp_path / "runs.txt").read_text().split())

    prove_folder(bench, out=tmp_path / "out", diagnoser=slow, say=quiet)
    prove_folder(bench, out=tmp_path / "out", diagnoser=slow, say=quiet)
    assert runs() == 4
    path = bench / "beta" / "rec_1.csv"
    path.write_text(path.read_text() + "2\n")
    prove_folder(bench, out=tmp_path / "out", diagnoser=slow, say=quiet)
    assert runs() == 5
    assert not prove_folder(bench, out=tmp_path / "out", diagnoser=silent, say=quiet).scores[1].claims


def test_an_error_of_the_diagnosis_is_a_failed_case(bench: Path, tmp_path: Path) -> None:
    proof = prove_folder(bench, out=tmp_path / "out", diagnoser=broken, say=quiet)
    (beta,) = (one for one in proof.scores if one.name == "beta")
    assert beta.error.startswith("ZeroDivisionError: no such luck (made_prove.py, broken)")
    assert not beta.reported


def test_a_diagnosis_without_an_end_is_a_failed_case(
    bench: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(work, "LONGEST_DIAGNOSIS_S", 0.2)
    proof = prove_folder(bench, out=tmp_path / "out", diagnoser=endless, say=quiet)
    assert {one.name: one.error for one in proof.scores if one.error} == {
        "beta": "TooLongError: not done after 0.2 s of processor time"
    }


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_ground_that_cannot_be_written_is_refused(tmp_path: Path, workers: int) -> None:
    few = [entry.index for entry in plan(6, quick=True) if not entry.physics][:workers]
    (tmp_path / "cases").mkdir()
    for k in few:
        (tmp_path / "cases" / f"case_{k:03d}").touch()  # where its folder has to be
    with pytest.raises(GearpolyError, match="cases: File exists; could not be written"):
        prove_ground(6, out=tmp_path, workers=workers, quick=True, indices=few, diagnoser=silent, say=quiet)


@pytest.mark.slow
def test_two_processes_write_the_same_ground(tmp_path: Path) -> None:
    few = [entry.index for entry in plan(6, quick=True) if not entry.physics][:2]
    how: dict[str, Any] = {"quick": True, "indices": few, "diagnoser": silent, "say": quiet}
    one = prove_ground(6, out=tmp_path / "one", workers=1, **how)
    two = prove_ground(6, out=tmp_path / "two", workers=2, **how)
    assert one.truths == two.truths
    files = sorted(path.relative_to(tmp_path / "one") for path in (tmp_path / "one" / "cases").rglob("*.*"))
    assert len(files) >= 2 * len(few)
    assert all((tmp_path / "one" / path).read_bytes() == (tmp_path / "two" / path).read_bytes() for path in files)


@pytest.mark.slow
def test_the_ground_is_written_apart_from_its_truths(tmp_path: Path) -> None:
    proof = prove_ground(3, out=tmp_path, quick=True, indices=[0], diagnoser=silent, say=quiet)
    assert [one.name for one in proof.scores] == ["case_000"]
    assert not list((tmp_path / "cases").rglob("*.truth.json"))
    assert len(list((tmp_path / "truths").glob("*.truth.json"))) == 1
    # Gone on with: nothing is written again.
    first = {p: p.stat().st_mtime_ns for p in (tmp_path / "cases").rglob("*.csv")}
    again = prove_ground(3, out=tmp_path, quick=True, indices=[0], diagnoser=silent, say=quiet)
    assert {p: p.stat().st_mtime_ns for p in (tmp_path / "cases").rglob("*.csv")} == first
    assert again.sealed == proof.sealed
    # A truth that somebody changed between two runs is the sealed one again.
    (changed,) = (tmp_path / "truths").glob("*.truth.json")
    sealed = changed.read_bytes()
    changed.write_text('{"kind": "none", "truth": [], "noise_um": 1.0}')
    assert prove_ground(3, out=tmp_path, quick=True, indices=[0], diagnoser=silent, say=quiet).sealed == proof.sealed
    assert changed.read_bytes() == sealed


@pytest.mark.parametrize(
    ("break_it", "words"),
    [
        (lambda bench: (bench / "beta" / "pair.toml").unlink(), None),
        (lambda bench: (bench / "beta.truth.json").unlink(), "no such file"),
        (lambda bench: [path.unlink() for path in (bench / "beta").glob("rec_*")], "no recording"),
    ],
)
def test_a_folder_that_is_not_laid_out_so_is_refused(bench: Path, tmp_path: Path, break_it: Any, words: Any) -> None:
    break_it(bench)
    if words is None:  # a folder without a pair file is no case
        assert len(prove_folder(bench, out=tmp_path / "out", diagnoser=fake, say=quiet).scores) == 3
        return
    with pytest.raises(InputFileError, match=words):
        prove_folder(bench, out=tmp_path / "out", diagnoser=fake, say=quiet)


def test_the_page_lists_every_failure(bench: Path, tmp_path: Path) -> None:
    found = board_json(prove_folder(bench, out=tmp_path / "out", diagnoser=fake, say=quiet))
    assert json.loads(board_text(found)) == json.loads(json.dumps(found))
    text = page([found], figures=["figures/proof_size.png"])
    assert "| gamma | missing, made | tooth_spall driven tooth 9 | tooth_spall driven tooth 10 |" in text
    assert "wrong tooth" in text
    assert "| alpha | none, made | nothing | friction | false alarm, a name that may not stand |" in text
    assert found["truths_sha256"] in text
    # Every row with a goal has its cases beside it.
    assert (
        "| false alarms: healthy, yet something named or left unexplained | 100.0 % (1 of 1; 20.7 to 100.0) |" in text
    )
    assert "| at most 5 % | **missed** | alpha" in text
    goals = [row for row in found["rows"] if row["reached"] is not None]
    assert f"{sum(row['reached'] for row in goals)} of {len(goals)} goals are reached" in text
    draw_sizes(found, tmp_path / "size.png")
    assert (tmp_path / "size.png").stat().st_size > 5000  # an empty canvas has less


def test_controls_are_chosen_by_the_plan_alone() -> None:
    entries = plan(5)
    found = {arm.key: arm for arm in arms(entries)}
    assert set(found) == {"struck", "known_wrong", "no_whitening", "no_exact", "one_torque"}
    assert all(len(arm.how) >= 12 for arm in found.values())
    for k, how in found["struck"].how.items():
        assert how.without == entries[k].physics
        assert entries[k].over >= 7.0


def test_the_command_refuses_what_it_cannot_do(tmp_path: Path, bench: Path) -> None:
    runner = CliRunner()
    for arguments, words in (
        (["--on", str(tmp_path / "none")], "no such folder"),
        (["--on", str(bench), "--quick"], "scored as it is"),
        (["--on", str(bench), "--seed", "4"], "--seed is for the seeded ground"),
        (["--seed", "-1"], "want 0 or a positive"),
        (["--json", str(tmp_path / "no" / "x.json")], "no folder"),
    ):
        found = runner.invoke(app, ["prove", "--out", str(tmp_path / "out"), *arguments])
        assert isinstance(found.exception, GearpolyError)
        assert words in str(found.exception)


def test_json_to_standard_output_is_all_that_goes_there(
    bench: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def pretended(folder: Path, **how: Any) -> Proof:
        return prove_folder(folder, **how, diagnoser=fake)

    monkeypatch.setattr(proving_run, "prove_folder", pretended)
    # The command asks for its functions when it runs.
    app(
        ["prove", "--on", str(bench), "--json", "-", "--workers", "1", "--out", str(tmp_path / "out")],
        standalone_mode=False,
    )
    told = capfd.readouterr()
    assert json.loads(told.out)["cases"] == 4
    assert "truths sealed" in told.err
    assert f"wrote {tmp_path / 'out'}: cases and verdicts" in told.err


PAIR = """
[pair]
torque_nm = 0.0
[driving]
teeth = 18
module_mm = 2.0
[driving.eccentricity]
amplitude_um = AMPLITUDE
angle_deg = 30.0
[driven]
teeth = 25
module_mm = 2.0
[driven.tip_relief]
amount_um = 10.0
length_mm = 0.6
"""


def made(tmp_path: Path, amplitude: float) -> Path:
    path = tmp_path / f"pair_{amplitude}.toml"
    path.write_text(PAIR.replace("AMPLITUDE", str(amplitude)))
    return path


def test_known_parameters_wrong_by_five_percent(tmp_path: Path) -> None:
    file = read_pair(made(tmp_path, 20.0))
    off = wrong(file)
    assert off.driving.eccentricity is not None
    assert off.driven.tip_relief is not None
    assert off.driving.eccentricity.amplitude_um == pytest.approx(21.0)
    assert off.driven.tip_relief.amount_um == pytest.approx(10.5)
    assert off.material.youngs_modulus_gpa == pytest.approx(1.05 * 206.0)
    assert file.driving.eccentricity is not None
    assert file.driving.eccentricity.amplitude_um == 20.0


def test_first_order_lacks_what_grows_with_the_square(tmp_path: Path) -> None:
    """A small eccentricity is its first order; of a large one the rest grows with the square of the amplitude."""
    theta_2 = np.linspace(0.0, 2.0 * np.pi, 500)
    samples = Samples(
        number=0, flank="drive", torque=0.0, speed=None, theta_1=theta_2 * 25 / 18, theta_2=theta_2, time=None,
        reading_1=theta_2, reading_2=theta_2, direction_1=1, direction_2=1, counted=True,
    )  # fmt: skip

    def lacking(amplitude: float) -> float:
        path = made(tmp_path, amplitude)
        file = read_pair(path)
        (exact,) = Method().scenes(file, [samples], path=path)
        (first,) = Method(exact=False).scenes(file, [samples], path=path)
        assert np.ptp(exact.te) > 1.8e-3 * amplitude  # mm: twice the amplitude, nearly
        return float(np.std(exact.te - first.te))

    small, large = lacking(20.0), lacking(80.0)
    assert 8.0 < large / small < 32.0  # 16, but the relief's corners move with the first order, too


def test_without_whitening_and_without_a_physics() -> None:
    assert (
        len(Method(without=frozenset({"friction"})).physics)
        == sum(not one.unsearched for one in catalogue().values()) - 1
    )
    from gearpoly.compare.noise import estimate_noise

    rng = np.random.default_rng(1)
    u = np.arange(4500) / 10.0
    values = np.zeros(u.size)
    for k in range(1, u.size):
        values[k] = 0.8 * values[k - 1] + rng.normal()
    noise = estimate_noise(u, 1e-3 * values, z_1=9, z_2=10)
    white = Method(whiten=False).noise(noise)
    assert noise.ar.size
    assert not white.ar.size
    assert np.allclose(white.whitened(values), values / white.level)
