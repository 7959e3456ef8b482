"""The sample data come out of the package whole, or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from gearpoly.errors import InputFileError
from gearpoly.files import samples
from tests.made_command import Command

DATA = Path(__file__).resolve().parents[1] / "data"


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_examples_copies_all_of_them(tmp_path: Path, gearpoly_command: Command) -> None:
    ran = gearpoly_command("examples", str(tmp_path / "mine"))
    assert ran.code == 0 and ran.err.startswith(f"wrote {tmp_path / 'mine'}: ")
    assert files(tmp_path / "mine") == files(DATA)
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]  # nothing is left beside it


def test_what_is_there_is_not_written_over(tmp_path: Path, gearpoly_command: Command) -> None:
    (tmp_path / "mine").mkdir()
    ran = gearpoly_command("examples", str(tmp_path / "mine"))
    assert ran.code == 2 and "it is there already; want the name of a new folder" in ran.err
    ran = gearpoly_command("examples", str(tmp_path / "none" / "mine"))
    assert ran.code == 2 and "there is no folder" in ran.err


def test_an_installed_package_has_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "samples" / "recordings").mkdir(parents=True)
    monkeypatch.setattr(samples, "SAMPLE_FOLDERS", (tmp_path / "samples", DATA))
    assert samples.samples() == tmp_path / "samples"
    monkeypatch.setattr(samples, "SAMPLE_FOLDERS", (tmp_path / "none",))
    with pytest.raises(InputFileError, match="no sample data here; install a wheel"):
        samples.samples()
