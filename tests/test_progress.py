"""Stages and what is done next, for people at a terminal; nothing for pipes."""

from __future__ import annotations

import sys

import pytest
from rich.progress import Progress

from gearpoly.diagnose.budget import STAGES, Watch
from gearpoly.report.progress import StageProgress, steps


def test_a_pipe_gets_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert not sys.stderr.isatty()
    with steps() as step:
        step("reading")
        step.reached(1, 5)
    told = capsys.readouterr()
    assert told.err == told.out == ""


def test_the_bar_follows_the_stages() -> None:
    """All stages in their order move the bar on; the next recording, thought of per finding, does not."""
    with Progress(disable=True) as bar:
        step = StageProgress(bar)
        watch = Watch(step, step.reached)
        seen = []
        for name in (*STAGES[:4], "next recording", *STAGES[4:]):
            watch.stage(name)(f"at {name}")
            seen.append((bar.tasks[0].completed, bar.tasks[0].total))
        assert seen == [(0, 5), (1, 5), (2, 5), (3, 5), (3, 5), (4, 5)]
        assert bar.tasks[0].description == "at leftovers ..."
