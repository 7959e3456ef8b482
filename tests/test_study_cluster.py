"""A real Dask cluster on this machine: the same bytes, also when a worker is killed on the way."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from gearpoly.errors import GearpolyError
from gearpoly.study import cluster
from gearpoly.study.read import read_study
from gearpoly.study.run import plan_study, run_study
from tests.study_files import GRADES, write_study

pytest.importorskip("distributed")
pytest.importorskip("pyarrow")

CLUSTER = """
import sys
from distributed import LocalCluster

if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        print(cluster.scheduler_address, *(w.pid for w in cluster.workers.values()), flush=True)
        sys.stdin.read()
"""


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, list[int]]]:
    """Scheduler address and process ids of two workers, in a process of their own, as a cluster is."""
    script = tmp_path_factory.mktemp("cluster") / "cluster.py"
    script.write_text(CLUSTER, encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, str(script)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    words = process.stdout.readline().split()
    yield words[0], [int(word) for word in words[1:]]
    assert process.stdin is not None
    process.stdin.close()
    process.wait(timeout=60)
    process.stdout.close()


def _bytes(out: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (out / "rows").glob("[0-9]*.parquet")}


@pytest.mark.slow
def test_a_cluster_gives_the_same_bytes_though_a_worker_is_killed(
    tmp_path: Path, address: tuple[str, list[int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_study(tmp_path, GRADES, pairs=12)
    scheduler, workers = address
    whole, killed = cluster.on_cluster, []

    def watched(*arguments: object, **how: object) -> Iterator[object]:
        for count, rows in enumerate(whole(*arguments, **how)):  # type: ignore[arg-type]
            if count == 3:
                os.kill(workers[0], signal.SIGKILL)
                killed.append(workers[0])
            yield rows

    monkeypatch.setattr("gearpoly.study.run.on_cluster", watched)
    there = run_study(read_study(path), out=tmp_path / "there", scheduler=scheduler)
    assert killed
    here = run_study(read_study(path), out=tmp_path / "here")
    assert there.rows == here.rows == 36
    assert _bytes(tmp_path / "there") == _bytes(tmp_path / "here")
    there.store.to_csv(tmp_path / "there.csv")
    here.store.to_csv(tmp_path / "here.csv")
    assert (tmp_path / "there.csv").read_bytes() == (tmp_path / "here.csv").read_bytes()


@pytest.mark.slow
def test_a_worker_with_other_versions_is_refused(
    tmp_path: Path, address: tuple[str, list[int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "gearpoly.study.plan.versions", lambda: {"gearpoly": "0.0.0", "numpy": "1", "scipy": "1", "python": "3"}
    )
    study = read_study(write_study(tmp_path, pairs=2))
    with pytest.raises(GearpolyError, match="same versions everywhere"):
        run_study(study, out=tmp_path / "out", scheduler=address[0])


@pytest.mark.long
def test_a_cluster_that_does_not_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    monkeypatch.setattr(cluster, "ANSWER", 1.0)
    study = read_study(write_study(tmp_path, pairs=2))
    for wrong in (f"tcp://127.0.0.1:{port}", "not an address"):
        with pytest.raises(GearpolyError, match="no Dask scheduler answers"):
            run_study(study, out=tmp_path / "out", scheduler=wrong)
    assert plan_study(study).design.rows == run_study(study, out=tmp_path / "out").made
