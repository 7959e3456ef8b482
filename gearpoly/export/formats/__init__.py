"""The formats that geometry can leave in: every module here is one, found by its ending without registration.

A module states ``ENDINGS`` (lower case, longest match wins), ``CURVES`` (how it can write curves, the default first)
and ``write(drawing, target, curves)``, which gives the chord error that it states; heavy imports wait inside ``write``.
Other installed packages bring theirs by entry points of the group ``gearpoly.exporters``.
"""

from __future__ import annotations

import pkgutil
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Protocol, cast

from gearpoly.errors import InputFileError, MissingExtraError
from gearpoly.export.brought import brought
from gearpoly.export.drawing import Drawing
from gearpoly.files.rexs.source import REXS_ENDINGS as DESIGNS


class Format(Protocol):
    """What a module of this package holds, and what an entry point leads to."""

    ENDINGS: tuple[str, ...]
    CURVES: tuple[str, ...]

    def write(self, drawing: Drawing, target: Path, curves: str) -> float:
        """Write ``drawing`` to ``target`` with ``curves`` one of ``CURVES``; gives the chord error in mm that the file
        states."""
        ...


@cache
def formats() -> dict[str, Format]:
    """All formats by ending."""
    found = [import_module(f"{__name__}.{one.name}") for one in pkgutil.iter_modules(__path__)]
    own = {ending: cast(Format, module) for module in found for ending in module.ENDINGS}
    return own | {ending: cast(Format, kind) for kind in brought({*own, *DESIGNS}) for ending in kind.ENDINGS}


def format_for(target: Path) -> Format:
    """The format of ``target`` by its ending. Raises ``InputFileError`` naming all known endings."""
    name = target.name.lower()
    matching = [ending for ending in formats() if name.endswith(ending) and name != ending]
    if not matching:
        known = ", ".join(sorted({*formats(), *DESIGNS}))
        found = f'the ending "{target.suffix}"' if target.suffix else "no ending"
        raise InputFileError(target, found=found, wish=f"want one of {known}")
    return formats()[max(matching, key=len)]


def missing(package: str, extra: str) -> MissingExtraError:
    """The error for an optional ``package`` that the ``extra`` brings."""
    return MissingExtraError(f"this format needs {package}: pip install 'gearpoly[{extra}]'")
