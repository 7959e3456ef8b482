"""What the tests of every command share: the command run in this process, and a small pair to run it on."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from gearpoly.__main__ import main
from tests.made_command import PAIR, Command, Ran


@pytest.fixture
def gearpoly_command(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Command:
    """Runs ``gearpoly ...`` in this process: exit code, standard output and standard error, on a wide terminal."""

    def run(*arguments: str | Path) -> Ran:
        monkeypatch.setattr(sys, "argv", ["gearpoly", *map(str, arguments)])
        monkeypatch.setenv("COLUMNS", "200")
        capfd.readouterr()
        code = 0
        try:
            main()
        except SystemExit as stop:
            code = int(stop.code or 0)
        captured = capfd.readouterr()
        return Ran(code, captured.out, captured.err)

    return run


@pytest.fixture
def pair_file(tmp_path: Path) -> Path:
    file = tmp_path / "pair.toml"
    file.write_text(PAIR, encoding="utf-8")
    return file
