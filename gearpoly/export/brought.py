"""Exporters of other installed packages, taken beside gearpoly's own formats once they are seen to be whole."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gearpoly.export.drawing import Drawing
from gearpoly.plugins import EXPORTERS_GROUP, Plugin, plugins

CURVE_FORMS = ("lines", "arcs", "splines")
"""How curves can be asked for."""


@dataclass(frozen=True, kw_only=True)
class Brought:
    """The format that an entry point leads to, a module or another object with its ``ENDINGS``, ``CURVES`` and
    ``write``."""

    plugin: Plugin
    holder: Any
    ENDINGS: tuple[str, ...]
    CURVES: tuple[str, ...]

    def write(self, drawing: Drawing, target: Path, curves: str) -> float:
        """As every format writes. Raises ``PluginError`` where it fails, writes nothing or states no chord error."""
        error = self.plugin.guarded("write", self.holder.write, float)(drawing, target, curves)
        if not (math.isfinite(error) and error >= 0.0):
            raise self.plugin.fault(f"its write states a chord error of {error} mm")
        if not (target.is_file() and target.stat().st_size):
            raise self.plugin.fault("its write wrote nothing")
        return float(error)


def brought(taken: Collection[str]) -> list[Brought]:
    """The formats of installed packages, beside those whose endings are ``taken``.

    Raises ``PluginError`` where one does not load, lacks a part, or has an ending that another has.
    """
    found: list[Brought] = []
    for plugin in plugins(EXPORTERS_GROUP):
        holder = plugin.load()
        fault = plugin.call("it is not whole", _fault, holder)
        if not fault:
            known = {*taken, *(ending for one in found for ending in one.ENDINGS)}
            both = sorted(known & set(holder.ENDINGS))
            fault = f"there is a format with the ending {both[0]} already" if both else ""
        if fault:
            raise plugin.fault(fault)
        found.append(Brought(plugin=plugin, holder=holder, ENDINGS=tuple(holder.ENDINGS), CURVES=tuple(holder.CURVES)))
    return found


def _fault(holder: Any) -> str:
    """What is wrong with a format by itself, in words; empty where nothing is."""
    if not holder.ENDINGS or not all(one.startswith(".") and one == one.lower() for one in holder.ENDINGS):
        return f"its ENDINGS are {holder.ENDINGS}; want small letters behind a dot"
    if not holder.CURVES or not set(holder.CURVES) <= set(CURVE_FORMS):
        return f"its CURVES are {holder.CURVES}; want some of {', '.join(CURVE_FORMS)}"
    return "" if callable(holder.write) else "its write is no function"
