"""Studies that run, stop, are killed, go on, and always end with the same bytes."""

from __future__ import annotations

import errno
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.study import run as engine
from gearpoly.study.local import in_processes
from gearpoly.study.progress import Progress
from gearpoly.study.read import read_study
from gearpoly.study.run import Outcome, run_study
from gearpoly.study.statistics import percentile
from gearpoly.study.stop import looks
from tests.study_files import GRADES, PAIR, write_study

pq = pytest.importorskip("pyarrow.parquet")


def _run(path: Path, out: Path, **how: Any) -> Outcome:
    return run_study(read_study(path), out=out, **how)


def _bytes(out: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (out / "rows").glob("[0-9]*.parquet")}


def _csv(outcome: Outcome, target: Path) -> bytes:
    outcome.store.to_csv(target)
    return target.read_bytes()


@pytest.mark.long
def test_one_process_and_two_give_the_same_bytes(tmp_path: Path) -> None:
    path = write_study(tmp_path, GRADES, pairs=4)
    one = _run(path, tmp_path / "one")
    two = _run(path, tmp_path / "two", workers=2)
    assert _bytes(tmp_path / "one") == _bytes(tmp_path / "two")
    assert _csv(one, tmp_path / "one.csv") == _csv(two, tmp_path / "two.csv")
    assert one.rows == two.rows == 12
    found = one.store.columns(["index", "status", "te_pp_um", "driving.grade"])
    assert found["index"].tolist() == list(range(12))
    assert set(found["status"]) == {"done"}
    by_grade = [np.mean(found["te_pp_um"][found["driving.grade"] == grade]) for grade in (5, 6, 7)]
    assert by_grade == sorted(by_grade)


@pytest.mark.long
def test_every_part_says_what_it_is_of(tmp_path: Path) -> None:
    _run(write_study(tmp_path, GRADES, pairs=1), tmp_path / "out")
    for part in (tmp_path / "out" / "rows").glob("[0-9]*.parquet"):
        held = pq.read_schema(part).metadata
        assert held[b"gearpoly.seed"] == b"7"
        assert b'"gearpoly"' in held[b"gearpoly.versions"]
        assert b'"pair.driving.teeth": 11' in held[b"gearpoly.study"]
    # A plain reader finds one table in the folder.
    assert pq.read_table(tmp_path / "out" / "rows").num_rows == 3


@pytest.mark.long
def test_more_pairs_later_go_on_where_fewer_ended(tmp_path: Path) -> None:
    out = tmp_path / "out"
    _run(write_study(tmp_path, GRADES, pairs=3), out)
    before = {path: path.stat().st_mtime_ns for path in (out / "rows").iterdir()}
    grown = _run(write_study(tmp_path, GRADES, pairs=8), out)
    assert (grown.rows, grown.made) == (24, 15)
    assert all(path.stat().st_mtime_ns == when for path, when in before.items())
    whole = _run(write_study(tmp_path, GRADES, pairs=8), tmp_path / "whole")
    assert _csv(grown, tmp_path / "a.csv") == _csv(whole, tmp_path / "b.csv")
    with pytest.raises(InputFileError, match="fewer rows than the 24"):
        _run(write_study(tmp_path, GRADES, pairs=2), out)
    assert _run(write_study(tmp_path, GRADES, pairs=8), out).made == 0


@pytest.mark.parametrize(
    ("text", "pair", "says"),
    [
        (GRADES, PAIR.replace("width_mm = 10.0", "width_mm = 12.0"), "pair.driving.face_width_mm was 10.0, now 12.0"),
        (GRADES.replace("[5, 6, 7]", "[5, 6, 8]"), PAIR, "[5, 6, 8]"),
        ('outputs = ["te_pp_um"]\n' + GRADES, PAIR, "study.outputs was"),
        ('flank = "coast"\n' + GRADES, PAIR, "study.flank was drive, now coast"),
    ],
)  # fmt: skip
def test_a_changed_study_is_not_mixed_with_the_old_one(tmp_path: Path, text: str, pair: str, says: str) -> None:
    out = tmp_path / "out"
    _run(write_study(tmp_path, GRADES, pairs=1), out)
    kept = _bytes(out)
    with pytest.raises(InputFileError) as caught:
        _run(write_study(tmp_path, text, pair=pair, pairs=1), out)
    assert says in str(caught.value)
    assert "do not mix" in str(caught.value)
    assert _bytes(out) == kept


def test_other_things_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("years of work")
    with pytest.raises(InputFileError, match="other things"):
        _run(write_study(tmp_path), tmp_path / "mine")
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["thesis.txt"]


PAIRS = 12
ROWS = 3 * PAIRS
"""Of three grades."""

LONG = 'turns = 2.0\npositions_per_mesh = 40\noutputs = ["te_pp_um", "backlash_least_um"]\n' + GRADES


def _long(folder: Path) -> Path:
    """Rows of 15 ms, so that a kill lands among them."""
    path = write_study(folder, LONG, pairs=PAIRS)
    path.write_text(path.read_text().replace("positions_per_mesh = 5\n", ""))
    return path


@pytest.mark.long
@pytest.mark.parametrize("workers", ["1", pytest.param("2", marks=pytest.mark.slow)])
def test_kill_9_loses_and_doubles_nothing(tmp_path: Path, workers: str) -> None:
    path, out = _long(tmp_path), tmp_path / "out"
    command = [sys.executable, "-m", "gearpoly", "study", str(path), "--out", str(out), "--workers", workers]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    rows = out / "rows"
    deadline = time.monotonic() + 60.0  # a minute: starting takes seconds even on a busy machine
    while not (rows.is_dir() and len(list(rows.glob("[0-9]*.parquet"))) >= 5) and time.monotonic() < deadline:
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    kept = {path.name: path.stat().st_mtime_ns for path in rows.glob("[0-9]*.parquet")}
    assert 5 <= len(kept) < ROWS
    (rows / ".gearpoly-cut.parquet").write_bytes(b"what a killed writer leaves")
    again = _run(path, out)
    # Nothing that was there was made again, nothing is missing, nothing is there twice.
    assert all((rows / name).stat().st_mtime_ns == when for name, when in kept.items())
    assert again.made == ROWS - len(kept)
    assert again.store.column("index").tolist() == list(range(ROWS))
    assert not list(rows.glob(".gearpoly-*"))
    undisturbed = _run(path, tmp_path / "undisturbed")
    assert _csv(again, tmp_path / "a.csv") == _csv(undisturbed, tmp_path / "b.csv")
    assert _bytes(out) == _bytes(tmp_path / "undisturbed")


@pytest.mark.slow
def test_a_killed_worker_is_replaced(tmp_path: Path) -> None:
    path = _long(tmp_path)
    plan = engine.plan_study(read_study(path))
    seen: list[int] = []
    killed = False
    for rows in in_processes(plan, iter([(k, k + 1) for k in range(ROWS)]), workers=2):
        seen += [row.index for row in rows]
        if len(seen) == 10 and not killed:
            killed = True
            children = subprocess.run(
                ["ps", "-ww", "--ppid", str(os.getpid()), "-o", "pid,args"], capture_output=True, text=True
            )
            workers = [int(line.split()[0]) for line in children.stdout.splitlines() if "spawn_main" in line]
            assert len(workers) == 2
            os.kill(workers[0], signal.SIGKILL)
    assert sorted(seen) == list(range(ROWS))


def test_only_one_run_writes_at_a_time(tmp_path: Path) -> None:
    path, out = write_study(tmp_path, GRADES, pairs=2), tmp_path / "out"
    plan = engine.plan_study(read_study(path))
    with engine.opened(out, plan), pytest.raises(InputFileError, match="another run"):
        _run(path, out)
    assert _run(path, out).rows == 6


@pytest.mark.long
def test_a_full_disk_keeps_what_is_finished(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, out = write_study(tmp_path, GRADES, pairs=4), tmp_path / "out"
    whole, count = pq.write_table, 0

    def full(table: Any, where: Any, **how: Any) -> None:
        nonlocal count
        count += 1
        if count > 5:
            Path(where).write_bytes(b"half")
            raise OSError(errno.ENOSPC, "No space left on device")
        whole(table, where, **how)

    with monkeypatch.context() as patched:
        patched.setattr(pq, "write_table", full)
        with pytest.raises(InputFileError, match="No space left on device"):
            _run(path, out)
    assert len(_bytes(out)) == 5
    again = _run(path, out)
    assert again.made == 12 - 5
    _run(path, tmp_path / "whole")
    assert _bytes(out) == _bytes(tmp_path / "whole")


UNTIL = '[until]\noutput = "te_pp_um"\npercentile = 50.0\nwidth = {}\nat_least = 10\n'


@pytest.mark.long
def test_stops_where_a_percentile_is_known(tmp_path: Path) -> None:
    text = 'turns = 1.0\noutputs = ["te_pp_um"]\n' + GRADES
    path = write_study(tmp_path, text + UNTIL.format(14.0), pairs=100)
    one = _run(path, tmp_path / "one")
    assert one.rows < 300
    assert "percentile 50 of te_pp_um is known to 14" in one.why
    cuts = looks(read_study(path).file, 3)
    assert one.rows in cuts
    found = one.store.columns(["te_pp_um", "combination"])

    def widest(rows: int) -> float:
        values, of = found["te_pp_um"][:rows], found["combination"][:rows]
        return max(percentile(values[of == k], 50.0).width for k in range(3))

    assert widest(one.rows) <= 14.0
    assert all(widest(cut) > 14.0 for cut in cuts if cut < one.rows)
    assert _run(path, tmp_path / "one").made == 0
    # Wanting it better goes on from there.
    better = _run(write_study(tmp_path, text + UNTIL.format(12.0), pairs=100), tmp_path / "one")
    assert better.rows > one.rows
    assert better.made == better.rows - one.rows


@pytest.mark.slow
def test_where_it_stops_does_not_hang_on_who_was_done_when(tmp_path: Path) -> None:
    text = 'turns = 1.0\noutputs = ["te_pp_um"]\n' + GRADES + UNTIL.format(8.0)
    path = write_study(tmp_path, text, pairs=100)
    one = _run(path, tmp_path / "one")
    assert one.rows == _run(path, tmp_path / "two", workers=2).rows
    assert _bytes(tmp_path / "one") == _bytes(tmp_path / "two")


APART = "limits = { E_sns_um = -60.0, E_sni_um = -90.0, W_kns_um = -10.0, W_kni_um = -20.0 }"
"""Limits that no gear keeps; found without drawing one."""


@pytest.mark.long
@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_study_that_can_draw_nothing_ends_with_its_cause(tmp_path: Path, workers: int) -> None:
    pair = PAIR.replace("grade = 6\n", f"grade = 6\n{APART}\n", 1)
    path, out = write_study(tmp_path, GRADES, pair=pair, pairs=1000), tmp_path / "out"
    with pytest.raises(InputFileError) as caught:
        _run(path, out, workers=workers)
    says = str(caught.value)
    assert says.startswith(f"{path}: pair: all of the first 32 pairs are refused; row 0 (driving.grade = 5, ")
    assert "no gear passes: E_s from -90.00 to -60.00 um" in says
    assert says.endswith("ranges that overlap would do")
    # No half-written table: the folder takes the study as it is when mended.
    assert not list((out / "rows").iterdir())
    assert not (out / "study.json").exists()
    mended = pair.replace("W_kns_um = -10.0, W_kni_um = -20.0", "W_kns_um = -10.0, W_kni_um = -85.0")
    mended = mended.replace("E_sni_um = -90.0", "E_sni_um = -200.0")
    assert _run(write_study(tmp_path, GRADES, pair=mended, pairs=1), out).rows == 3


@pytest.mark.long
def test_the_cure_for_limits_too_close_for_the_grade_works(tmp_path: Path) -> None:
    close = PAIR.replace("grade = 6\n", "grade = 9\nlimits = { E_sns_um = -60.0, E_sni_um = -70.0 }\n", 1)
    with pytest.raises(InputFileError, match="the only pair is refused") as caught:
        _run(write_study(tmp_path, pair=close, pairs=1), tmp_path / "out")
    apart = re.search(r"E_s limits 2 F_pT = ([0-9.]+) um apart", str(caught.value))
    assert apart is not None
    cured = close.replace("-70.0", f"{-60.0 - float(apart[1])}")
    assert (
        _run(write_study(tmp_path, pair=cured, pairs=3), tmp_path / "out").store.column("status").tolist()
        == ["done"] * 3
    )


@pytest.mark.long
def test_no_study_ends_before_every_combination_was_tried(tmp_path: Path) -> None:
    """40 combinations, of which only the last can be drawn: more than the 32 rows that are enough otherwise."""
    keys = ["driving.limits.E_sns_um", "driving.limits.E_sni_um", "driving.limits.W_kns_um", "driving.limits.W_kni_um"]
    values = [[-60.0, -90.0, -10.0, -20.0 - 0.01 * k] for k in range(39)] + [[-60.0, -130.0, -56.0, -122.0]]
    text = f'outputs = ["te_pp_um"]\n[[sweep]]\nkeys = {keys}\nmethod = "list"\nvalues = {values}\n'.replace("'", '"')
    outcome = _run(write_study(tmp_path, text, pairs=2), tmp_path / "out")
    assert outcome.rows == 80
    assert outcome.store.column("status").tolist() == (["refused"] * 39 + ["done"]) * 2


def test_a_run_killed_before_its_manifest_is_taken_up(tmp_path: Path) -> None:
    out = tmp_path / "out"
    (out / "rows").mkdir(parents=True)
    (out / ".lock").touch()
    (out / ".gearpoly-half.json").touch()
    assert _run(write_study(tmp_path, pairs=1), out).made == 1


def test_progress_says_rate_and_time_left(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    progress = Progress(total=1000, done=200)
    now = 140.0
    progress.advance(80)
    assert progress.rate == pytest.approx(2.0)  # what an earlier run made does not count
    assert progress.left == pytest.approx(360.0)
    assert "280 of 1000 pairs, 2 pairs/s, 6 min left" in capsys.readouterr().err
