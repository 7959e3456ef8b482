"""Messages in the words of Python: what the command line calls ``--points-per-mesh`` is the argument
``points_per_mesh`` here."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from gearpoly.errors import GearpolyError, InputFileError
from gearpoly.units import UM

PYTHON_FOR_COMMAND_WORDS = (
    ("gearpoly study --out", "gearpoly.run_study"),
    ("--gear driving or --gear driven", 'which="driving" or which="driven"'),
    ("--as driving or --as driven", 'which="driving" or which="driven"'),
    ("--flank left or --flank right", 'flank="left" or flank="right"'),
    ("--count clockwise or counterclockwise", 'count="clockwise" or count="counterclockwise"'),
    ("--as driving", 'which="driving"'),
    ("--as driven", 'which="driven"'),
    ("--count clockwise", 'count="clockwise"'),
    ("--count counterclockwise", 'count="counterclockwise"'),
    ("run this command for that gear too", "call it for that gear too"),
    ("leave out --write, or --map to write a new one", "leave out map to write a new one"),
    ("a single --gear", "a single gear (which)"),
    ("(--apart draws", "(apart=True draws"),
    ("--map map.toml", 'map="map.toml"'),
    ("--within SECONDS", "within=SECONDS"),
    ("--gear", "which"),
    ("--at", "theta_2"),
    ("want an angle in deg", "want an angle in rad"),
    ("--chord-um", "chord"),
    ("--out", "folder"),
    ("--apart", "apart"),
    ("--as", "which"),
    ("--confidence", "confidence"),
    ("--count", "count"),
    ("--curves", "curves"),
    ("--flank", "flank"),
    ("--html", "target"),
    ("--limit", "limits"),
    ("--magnify", "magnify"),
    ("--map", "map"),
    ("--mount", "name"),
    ("--points-per-mesh", "points_per_mesh"),
    ("--points", "points"),
    ("--scheduler", "scheduler"),
    ("--share", "share"),
    ("--sheet", "sheet"),
    ("--stage", "stage"),
    ("--turns", "turns"),
    ("--workers", "workers"),
    ("--write", "target"),
)
"""What the command line says and what Python says instead, whole phrases before the options in them. Other options
stay: they are of a command that a message names."""

_CHORD = re.compile(r"--chord-um ([0-9.e+-]+)")
_COMMAND = "(?<!gearpoly pair )(?<!gearpoly read FILE )"
_SAID = re.compile(
    _COMMAND + "(?:" + "|".join(f"{re.escape(said)}(?![\\w-])" for said, _ in PYTHON_FOR_COMMAND_WORDS) + ")"
)


def in_words_of_python(text: str) -> str:
    """A message of the command line with the arguments of Python; chord errors are mm there."""
    text = _CHORD.sub(lambda found: f"chord {float(found[1]) * UM:g} mm", text)
    return _SAID.sub(lambda found: dict(PYTHON_FOR_COMMAND_WORDS)[found[0]], text)


@contextmanager
def told_in_python() -> Iterator[None]:
    """Whatever gearpoly raises inside names arguments of Python."""
    try:
        yield
    except GearpolyError as error:
        error.args = tuple(in_words_of_python(one) if isinstance(one, str) else one for one in error.args)
        if isinstance(error, ImportError):  # which keeps its text beside its arguments
            error.msg = error.args[0]
        if isinstance(error, InputFileError):
            error.file = in_words_of_python(error.file) if error.file.startswith("--") else error.file
            error.found, error.wish = in_words_of_python(error.found), in_words_of_python(error.wish)
        raise
