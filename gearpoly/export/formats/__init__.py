"""The formats that geometry can leave in: every module here is one, found by its ending without registration.

A module states ``ENDINGS`` (lower case, longest match wins), ``SAYS`` (what it writes, in a few words), ``CURVES`` (how
it can write curves, the default first) and ``write(drawing, target, curves)``, which gives the chord error that it
states; heavy imports wait inside ``write``.
"""

from __future__ import annotations

import pkgutil
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Protocol, cast

from gearpoly.errors import InputFileError, MissingExtraError
from gearpoly.export.drawing import Drawing


class Format(Protocol):
    """What a module of this package holds."""

    ENDINGS: tuple[str, ...]
    SAYS: str
    CURVES: tuple[str, ...]

    def write(self, drawing: Drawing, target: Path, curves: str) -> float:
        """Write ``drawing`` to ``target`` with ``curves`` one of ``CURVES``; gives the chord error in mm that the file
        states."""
        ...


@cache
def formats() -> dict[str, Format]:
    """All formats by ending."""
    found = [import_module(f"{__name__}.{one.name}") for one in pkgutil.iter_modules(__path__)]
    return {ending: cast(Format, module) for module in found for ending in module.ENDINGS}


def format_for(target: Path) -> Format:
    """The format of ``target`` by its ending. Raises ``InputFileError`` naming all known endings."""
    name = target.name.lower()
    matching = [ending for ending in formats() if name.endswith(ending) and name != ending]
    if not matching:
        known = ", ".join(sorted(formats()))
        found = f'the ending "{target.suffix}"' if target.suffix else "no ending"
        raise InputFileError(target, found=found, wish=f"want one of {known}")
    return formats()[max(matching, key=len)]


def missing(package: str, extra: str) -> MissingExtraError:
    """The error for an optional ``package`` that the ``extra`` brings."""
    return MissingExtraError(f"this format needs {package}: pip install 'gearpoly[{extra}]'")
