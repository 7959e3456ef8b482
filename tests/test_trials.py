"""Trials: killed, interrupted, disks full, odd surroundings. No half file, nothing lost, one message, no traceback."""

from __future__ import annotations

import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import IO, Any

import pyarrow.parquet as pq
import pytest

from gearpoly.study.store import MANIFEST_FILE, ROWS_FOLDER, read_store
from tests.made_command import Command
from tests.made_process import HEED
from tests.study_files import write_study

PAIR = Path(__file__).resolve().parents[1] / "data" / "pairs" / "ideal_18_25.toml"
FULL = Path("/dev/full")
PATIENCE = 300.0
"""s for one command on a crowded machine; no test measures it."""

LIMITED = (
    "import resource, runpy, sys; n = int(sys.argv.pop(1)); resource.setrlimit(resource.RLIMIT_FSIZE, (n, n)); "
    "sys.argv[0] = 'gearpoly'; runpy.run_module('gearpoly', run_name='__main__')"
)
"""Runs a command whose files may not grow beyond so many bytes, as on a disk that fills up."""


def run(*words: object, stdout: IO[str] | int = subprocess.PIPE, code: str = "", **env: str) -> Any:
    start = ["-c", code] if code else ["-m", "gearpoly"]
    return subprocess.run(
        [sys.executable, *start, *map(str, words)], stdout=stdout, stderr=subprocess.PIPE, text=True, check=False,
        timeout=PATIENCE, env=os.environ | env, errors="replace",
    )  # fmt: skip


def one_message(ran: Any) -> str:
    """The one line that a refused command says, which it is refused with exit 2."""
    said: str = ran.stderr
    assert ran.returncode == 2, said
    assert said.startswith("gearpoly: ")
    assert said.count("\n") == 1
    return said


# Standard output.


SHORT = ("simulate", PAIR, "--turns", "0.04", "--points-per-mesh", "8")
"""A simulation of one mesh."""


@pytest.mark.long
@pytest.mark.skipif(not FULL.is_char_device(), reason="no device here that is always full")
@pytest.mark.parametrize("words", [pytest.param(SHORT, marks=pytest.mark.slow), ("--help",), ("--version",)])
def test_results_that_cannot_be_printed_are_one_message(words: tuple[object, ...]) -> None:
    with FULL.open("w") as full:
        assert "standard output: No space left" in one_message(run(*words, stdout=full))


@pytest.mark.long
@pytest.mark.parametrize("words", [pytest.param(SHORT, marks=pytest.mark.slow), ("simulate", "--help")])
def test_a_pipe_that_nobody_reads_is_one_message(words: tuple[object, ...]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as broken:
        assert "standard output: Broken pipe" in one_message(run(*words, stdout=broken))


@pytest.mark.slow
def test_without_a_standard_output_only_what_is_asked_for_there_fails(tmp_path: Path) -> None:
    closed = "import os, sys; os.close(1); os.execv(sys.executable, [sys.executable, '-m', 'gearpoly', *sys.argv[1:]])"
    words = (*SHORT, "--csv")
    assert "standard output" in one_message(run(*words, "-", code=closed))
    done = run(*words, tmp_path / "te.csv", code=closed)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "te.csv").stat().st_size > 100


# Disks.


@pytest.mark.long
@pytest.mark.parametrize(
    "words",
    [
        ("export", PAIR, "--to", "r.svg"),
        pytest.param(
            ("simulate", PAIR, "--turns", "1", "--points-per-mesh", "8", "--csv", "r.csv"), marks=pytest.mark.slow
        ),
        pytest.param(("view", PAIR, "--html", "r.html"), marks=pytest.mark.slow),
        pytest.param(("plot", PAIR, "--to", "r.png"), marks=pytest.mark.slow),
        pytest.param(("export", PAIR, "--to", "r.stl"), marks=pytest.mark.slow),
        pytest.param(("export", PAIR, "--to", "r.dxf"), marks=pytest.mark.slow),
        pytest.param(("export", PAIR, "--to", "r.3mf"), marks=pytest.mark.slow),
    ],
)
def test_a_disk_that_fills_up_leaves_the_file_that_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[object, ...]
) -> None:
    monkeypatch.chdir(tmp_path)
    target = Path(str(words[-1]))
    target.write_text("what was there")
    said = one_message(run(4096, *words, code=LIMITED, MPLCONFIGDIR=str(tmp_path), NUMBA_DISABLE_JIT="0"))
    assert target.name in said
    assert target.read_text() == "what was there"
    assert not list(tmp_path.glob(".gearpoly-*"))


def test_a_study_on_a_full_disk_goes_on_where_there_is_room(tmp_path: Path, gearpoly_command: Command) -> None:
    study, out = write_study(tmp_path, 'outputs = ["te_pp_um"]\n', pairs=3), tmp_path / "out"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2048, hard))
    try:
        ran = gearpoly_command("study", study, "--out", out, "--workers", "1")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert ran.code == 2
    assert ran.err.count("\n") == 1
    assert not [*out.glob(".gearpoly-*"), *(out / ROWS_FOLDER).glob("*")]
    assert gearpoly_command("study", study, "--out", out, "--workers", "1").code == 0
    assert read_store(out)[0].done() == [(0, 1), (1, 2), (2, 3)]


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_is_read_only_is_told_first(tmp_path: Path, gearpoly_command: Command) -> None:
    tmp_path.chmod(0o500)
    ran = gearpoly_command("simulate", PAIR, "--csv", tmp_path / "r.csv")
    tmp_path.chmod(0o700)
    assert ran.code == 2
    assert "read-only" in ran.err


# Kills.


def table(out: Path) -> list[dict[str, Any]]:
    return [row for _, _, path in read_store(out)[0].parts() for row in pq.read_table(path).to_pylist()]


def killed(
    study: Path, out: Path, *, after: float, by: signal.Signals, workers: int, begun: bool = False
) -> tuple[int, str]:
    """A study as a terminal starts it, and its whole group killed or interrupted after so many s: since its start, or
    since it had ``begun`` to start workers."""
    words = ["-m", "gearpoly", "study", str(study), "--out", str(out), "--workers", str(workers)]
    running = subprocess.Popen(
        [sys.executable, "-c", HEED, sys.executable, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        text=True, start_new_session=True,
    )  # fmt: skip
    until = time.monotonic() + PATIENCE
    while begun and not (out / MANIFEST_FILE).exists() and time.monotonic() < until:
        time.sleep(0.02)
    time.sleep(after)
    os.killpg(running.pid, by)
    said = running.communicate(timeout=PATIENCE)[1]
    return running.returncode, said


def check_killed(tmp_path: Path, *, moments: list[float], by: signal.Signals, workers: int) -> None:
    """However often it is stopped, a study goes on to the table of one that never was; every part is whole."""
    study = write_study(tmp_path, 'outputs = ["te_pp_um", "backlash_mean_um"]\n', pairs=24)
    out, whole = tmp_path / "out", tmp_path / "whole"
    for after in moments:
        code, said = killed(study, out, after=after, by=by, workers=workers)
        assert code in (0, -by, 130), said
        if by == signal.SIGINT and code:
            # Before Python itself stands, an interrupt ends it without a word of ours.
            assert said.count("\n") == 1 or code == -by, said
            assert "Traceback" not in said or code == -by, said
        for part in (out / ROWS_FOLDER).glob("0*.parquet") if out.exists() else ():
            assert pq.read_table(part).num_rows >= 1
        if (out / MANIFEST_FILE).exists():
            json.loads((out / MANIFEST_FILE).read_text())
    for folder in (out, whole):
        done = run("study", study, "--out", folder, "--workers", "1")
        assert done.returncode == 0, done.stderr
    assert table(out) == table(whole)
    assert not [*out.glob(".gearpoly-*"), *(out / ROWS_FOLDER).glob(".gearpoly-*")]


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGINT])
def test_a_study_stopped_at_random_moments_loses_nothing(tmp_path: Path, by: signal.Signals, workers: int) -> None:
    draw = random.Random(workers)
    check_killed(tmp_path, moments=[draw.uniform(0.1, 12.0) for _ in range(12)], by=by, workers=workers)


@pytest.mark.long
@pytest.mark.parametrize(
    "after", [1.0, pytest.param(0.1, marks=pytest.mark.slow), pytest.param(0.4, marks=pytest.mark.slow)]
)
def test_an_interrupt_in_the_first_seconds_of_two_workers_is_one_line(tmp_path: Path, after: float) -> None:
    """It reaches the workers too, which are still starting: only their parent speaks."""
    study, out = write_study(tmp_path, pairs=500), tmp_path / "out"
    code, said = killed(study, out, after=after, by=signal.SIGINT, workers=2, begun=True)
    assert code == 130, said
    assert said.startswith("gearpoly: interrupted")
    assert said.count("\n") == 1


@pytest.mark.slow
@pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGINT])
def test_a_command_stopped_at_random_moments_leaves_the_old_file_or_the_new(tmp_path: Path, by: signal.Signals) -> None:
    words = ["-m", "gearpoly", *map(str, SHORT), "--csv", str(tmp_path / "r.csv")]
    assert subprocess.run([sys.executable, *words], check=False, capture_output=True, timeout=PATIENCE).returncode == 0
    new = (tmp_path / "r.csv").read_bytes()
    draw = random.Random(int(by))
    for _ in range(12):
        (tmp_path / "r.csv").write_bytes(b"old")
        begun = subprocess.Popen(
            [sys.executable, "-c", HEED, sys.executable, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        time.sleep(draw.uniform(0.1, 5.0))
        begun.send_signal(by)
        begun.wait(timeout=PATIENCE)
        assert (tmp_path / "r.csv").read_bytes() in (b"old", new)


# What a study leaves, damaged.


def small_table(tmp_path: Path, gearpoly_command: Command) -> tuple[Path, Path]:
    study, out = write_study(tmp_path, 'outputs = ["te_pp_um"]\n', pairs=3), tmp_path / "out"
    assert gearpoly_command("study", study, "--out", out, "--workers", "1").code == 0
    assert gearpoly_command("study-report", out).code == 0
    return study, out


@pytest.mark.long
def test_a_cut_off_part_is_named_and_made_anew_once_deleted(tmp_path: Path, gearpoly_command: Command) -> None:
    study, out = small_table(tmp_path, gearpoly_command)
    whole = table(out)
    part = out / ROWS_FOLDER / "000000001-000000002.parquet"
    part.write_bytes(part.read_bytes()[:-40])
    for words in (("study-report", out), ("study", study, "--out", out, "--workers", "1")):
        ran = gearpoly_command(*words)
        assert ran.code == 2
        assert part.name in ran.err
        assert "delete it and run the study again" in ran.err
    part.unlink()
    ran = gearpoly_command("study", study, "--out", out, "--workers", "1")
    assert "1 of them made now" in ran.out
    assert table(out) == whole


@pytest.mark.parametrize("text", ["", "{", "[]", '{"plan": 3}', "\x00", "[" * 9999, '{"gearpoly": "1", "plan": "{}"}'])
def test_a_damaged_manifest_is_named_and_its_rows_are_kept(
    tmp_path: Path, gearpoly_command: Command, text: str
) -> None:
    study = write_study(tmp_path, 'outputs = ["te_pp_um"]\n', pairs=3)
    out = tmp_path / "out"
    assert gearpoly_command("study", study, "--out", out, "--workers", "1").code == 0
    (out / MANIFEST_FILE).write_text(text)
    for words in (("study-report", out), ("study", study, "--out", out, "--workers", "1")):
        ran = gearpoly_command(*words)
        assert ran.code == 2
        assert "study.json: a damaged manifest" in ran.err
    (out / MANIFEST_FILE).unlink()
    assert "0 of them made now" in gearpoly_command("study", study, "--out", out, "--workers", "1").out


@pytest.mark.long
def test_rows_of_another_study_are_known_without_a_manifest(tmp_path: Path, gearpoly_command: Command) -> None:
    study, out = small_table(tmp_path, gearpoly_command)
    (out / MANIFEST_FILE).unlink()
    study.write_text(study.read_text().replace("seed = 7", "seed = 8"))
    ran = gearpoly_command("study", study, "--out", out, "--workers", "1")
    assert ran.code == 2
    assert "study.seed was 7, now 8" in ran.err


# Surroundings.

ODD = {
    "NUMBA_NUM_THREADS": "-1", "MPLBACKEND": "no such", "MPLCONFIGDIR": "/proc/none", "COLUMNS": "-7", "LINES": "x",
    "LANG": "xx_YY", "LC_ALL": "C", "TERM": "\x1b[31m", "OMP_NUM_THREADS": "-3", "HOME": "/proc/none", "TZ": "Mars",
    "FORCE_COLOR": "maybe", "SOURCE_DATE_EPOCH": "soon", "NUMBA_CPU_FEATURES": "abc", "PYTHONWARNINGS": "what",
    "NUMBA_THREADING_LAYER": "x", "XDG_CACHE_HOME": "/proc/none", "NUMBA_OPT": "most", "PYTHONIOENCODING": "ascii",
}  # fmt: skip
"""A value that makes no sense for each variable that Python or a library of ours reads."""


def check_odd(tmp_path: Path, names: list[str]) -> None:
    """A result, or one message that names the variable."""
    env = {name: ODD[name] for name in names}
    ran = run(*SHORT, "--fast", "--plot", tmp_path / "r.png", **env)
    if ran.returncode == 0:
        assert (tmp_path / "r.png").exists()
        assert "Traceback" not in ran.stderr
    else:
        assert any(name in one_message(ran) for name in names)


@pytest.mark.long
def test_variables_without_sense_together_stop_nothing(tmp_path: Path) -> None:
    refused = {"NUMBA_NUM_THREADS", "SOURCE_DATE_EPOCH", "NUMBA_CPU_FEATURES"}
    check_odd(tmp_path, sorted(ODD.keys() - refused))
    assert (tmp_path / "r.png").exists()


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(ODD))
def test_a_variable_without_sense_stops_nothing_or_is_named(tmp_path: Path, name: str) -> None:
    check_odd(tmp_path, [name])
