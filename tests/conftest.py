"""What tests of several subjects share: a command run in this process, a small pair to run it on, and a browser."""

from __future__ import annotations

import gc
import sys
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest

from gearpoly import cli
from gearpoly.__main__ import main
from gearpoly.mesh import transmission
from tests import remembered
from tests.chromium import Chromium
from tests.made_command import PAIR, Command, Ran, commands


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """What is imported and collected stays to the end, and looking through it for garbage again and again took an
    eighth of all tests' time: none is looked for meanwhile, and afterwards, less often, in what tests make alone."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.collect()
        gc.freeze()
        gc.set_threshold(5_000, 10, 10)
        gc.enable()


FIRST = (
    "documented_commands", "diagnose_command", "view_browser", "prove_run", "diagnose", "export", "simulate",
    "compare_end_to_end", "diagnosis_page_browser", "align", "api_as_commands", "study_run", "cures", "other_pair",
    "runs", "compare", "jumps", "diagnosis_on_paper", "courses", "locate", "proving_ground", "map_commands",
)  # fmt: skip
"""Files that take 10 s or more: begun last, one of them would leave a processor idle for as long."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    names = [f"test_{name}.py" for name in FIRST]
    items.sort(key=lambda one: names.index(one.path.name) if one.path.name in names else len(names))


@pytest.fixture(scope="session", autouse=True)
def _searched_once() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(transmission, "closing_rotations_fast", remembered.closing_rotations)
        yield


@pytest.fixture
def gearpoly_command(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Command:
    """Runs ``gearpoly ...`` in this process: exit code, standard output and standard error, on a wide terminal."""

    monkeypatch.setattr(cli, "app", commands())

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


@pytest.fixture(scope="session")
def browser() -> Iterator[Chromium]:
    with Chromium() as chromium:
        yield chromium


@pytest.fixture
def fresh(browser: Chromium) -> Iterator[Chromium]:
    """The browser as a user finds it; whatever a page writes to the console is an error."""
    browser.size(1440, 900)
    browser.dark(False)
    browser.console.clear()
    browser.requests.clear()
    yield browser
    assert browser.console == []
    assert all(url.startswith(("file:", "data:")) for url in browser.requests)
    browser.leave()
