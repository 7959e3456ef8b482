"""Fuzzers: a short run with the other tests, ``GEARPOLY_FUZZ`` inputs each with ``make fuzz``, and their table."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import settings

from tests.fuzz.judge import FUZZ, TALLIES, WANTED, table

settings.register_profile("fuzz", FUZZ)
if WANTED:
    settings.load_profile("fuzz")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if WANTED and TALLIES:
        terminalreporter.section("fuzzed")
        for line in table():
            terminalreporter.line(line)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where a fuzzer writes its inputs, each over the one before."""
    return tmp_path_factory.mktemp("fuzz")
