"""Where results may go: never onto what is read, onto each other, or onto what is no file."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import IO

import pytest

from gearpoly.errors import InputFileError
from gearpoly.files.output import check_targets, write_text
from tests.made_command import Command

PAIR = Path(__file__).resolve().parents[1] / "data" / "pairs" / "ideal_18_25.toml"


def test_no_result_replaces_what_is_read(tmp_path: Path) -> None:
    recording, link = tmp_path / "rec.csv", tmp_path / "link.csv"
    recording.write_text("kept")
    link.symlink_to(recording)
    for target in (recording, link, tmp_path / "." / "rec.csv"):
        with pytest.raises(InputFileError, match="this is what is read"):
            check_targets([None, target], inputs=[PAIR, recording])
    assert recording.read_text() == "kept"


@pytest.mark.parametrize("place", ["v.json", "-"])
def test_two_results_need_two_places(place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputFileError, match="two results are to go there"):
        check_targets([Path(place), Path(place)], inputs=[PAIR])
    check_targets([Path(place), Path("other.html")], inputs=[PAIR])


def test_a_pipe_or_device_is_no_file(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.json"
    os.mkfifo(pipe)
    with pytest.raises(InputFileError, match="device or pipe"):
        check_targets([pipe], inputs=[])
    with pytest.raises(InputFileError, match="device or pipe"):
        write_text(pipe, "text")
    assert pipe.is_fifo()


def test_a_link_stays_and_its_file_is_replaced(tmp_path: Path) -> None:
    file, link = tmp_path / "real.json", tmp_path / "link.json"
    file.write_text("old")
    link.symlink_to(file)
    write_text(link, "new")
    assert link.is_symlink()
    assert file.read_text() == "new"
    assert sorted(tmp_path.iterdir()) == [link, file]


def run(*arguments: str, stdout: IO[str] | int = subprocess.PIPE) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "gearpoly", *arguments]
    return subprocess.run(command, stdout=stdout, stderr=subprocess.PIPE, text=True, check=False, timeout=120)


@pytest.mark.long
@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="no device here that is always full")
def test_standard_output_that_fails_is_one_message() -> None:
    with Path("/dev/full").open("w") as full:
        done = run("simulate", str(PAIR), "--points-per-mesh", "4", "--turns", "0.2", "--csv", "-", stdout=full)
    assert done.returncode == 2
    assert done.stderr.startswith("gearpoly: standard output: ")
    assert "Traceback" not in done.stderr


def test_plan_names_the_file_that_lacks_a_face_width(tmp_path: Path, gearpoly_command: Command) -> None:
    pair = tmp_path / "bare.toml"
    pair.write_text("[driving]\nteeth = 18\nmodule_mm = 2\n[driven]\nteeth = 25\nmodule_mm = 2\n")
    done = gearpoly_command("plan", pair)
    assert done.code == 2
    assert str(pair) in done.err
    assert "face_width_mm" in done.err
