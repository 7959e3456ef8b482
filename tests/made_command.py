"""A command that was run, and a small pair of grade 6 to run it on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import typer.main

from gearpoly.cli import app

PAIR = """\
name = "test pair"
[pair]
centre_distance_mm = 43.05
[driving]
teeth = 18
module_mm = 2.0
points_per_flank = 200
grade = 6
[driven]
teeth = 25
module_mm = 2.0
points_per_flank = 200
grade = 6
"""


@cache
def commands() -> Callable[..., object]:
    """The command line. Typer reads the options of all commands from their annotations, 0.05 s: a process does that
    once, and so do all tests that run commands in theirs."""
    return typer.main.get_command(app)


@dataclass(frozen=True)
class Ran:
    """What a command left: its exit ``code`` and both streams."""

    code: int
    out: str
    err: str


Command = Callable[..., Ran]


def recording(folder: Path, text: str) -> Path:
    file = folder / "rec.csv"
    file.write_text(text, encoding="utf-8")
    return file
