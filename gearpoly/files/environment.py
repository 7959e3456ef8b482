"""What a command is given beside its files: the words of its line and the variables that libraries read."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from gearpoly.errors import InputFileError

WORD_LIMIT = 4096
"""Characters of one word of a command line: the longest path that Linux takes."""

_WHOLE = re.compile(r"[1-9]\d{0,3}")
_VARIABLES = {
    "NUMBA_NUM_THREADS": (_WHOLE, "a whole number from 1"),
    "NUMBA_CPU_FEATURES": (re.compile(r"([+-][\w.-]+(,[+-][\w.-]+)*)?"), "features with their signs, such as +avx2"),
    "SOURCE_DATE_EPOCH": (re.compile(r"\d{1,11}"), "seconds since 1970"),
}
"""Variables at which a library gives up as soon as it is imported: what it takes, and in words."""


def check_arguments(words: Sequence[str]) -> None:
    """Raise ``InputFileError`` for a word of the command line that is no UTF-8, holds control characters or is longer
    than any path: it could be neither printed nor written into a result."""
    for word in words:
        if len(word) > WORD_LIMIT:
            raise InputFileError(word, found=f"{len(word)} characters", wish=f"want at most {WORD_LIMIT}")
        if not word.isprintable() and re.search(r"[\x00-\x1f\x7f-\x9f\ud800-\udfff]", word):
            found = "a name with control characters, or that is no UTF-8"
            raise InputFileError(word, found=found, wish="rename it, or give it a link with another name")


def check_environment(variables: Mapping[str, str]) -> None:
    """Raise ``InputFileError`` for a variable of the environment that would stop a library from being imported."""
    for name, (good, want) in _VARIABLES.items():
        value = variables.get(name)
        if value is not None and not good.fullmatch(value):
            raise InputFileError(f"environment variable {name}", found=f'"{value}"', wish=f"want {want}, or unset it")
