"""Readers of other installed packages, taken beside gearpoly's own once they are seen to be whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.plugins import READERS_GROUP, Plugin, plugins
from gearpoly.recording.apart import read_apart
from gearpoly.recording.reader import Reader
from gearpoly.recording.table import Table

OWN_TEXT = b'# flank = "drive"\ndriving_angle_deg,driven_angle_deg\n0.0,0.0\n'
"""How a recording of gearpoly's own begins; a reader that takes it for its own format takes every text."""


def brought(own: Sequence[Reader]) -> list[Reader]:
    """The readers of installed packages, beside gearpoly's ``own``.

    Raises ``PluginError`` where one does not load, lacks a part, has another's name or takes any text for its own.
    """
    found: list[Reader] = []
    for plugin in plugins(READERS_GROUP):
        reader = plugin.load()
        if not isinstance(reader, Reader):
            raise plugin.fault(f"{type(reader).__name__}, not a gearpoly.recording.reader.Reader")
        fault = plugin.call("it is not whole", _fault, plugin, reader)
        if not fault and reader.name in {one.name for one in [*own, *found]}:
            fault = f"there is a reader named {reader.name} already"
        if fault:
            raise plugin.fault(fault)
        found.append(_told(plugin, reader))
    return found


def _fault(plugin: Plugin, reader: Reader) -> str:
    """What is wrong with a reader by itself, in words; empty where nothing is."""
    if not (isinstance(reader.name, str) and reader.name.strip()):
        return "it has no name"
    if not all(ending.startswith(".") and ending == ending.lower() for ending in reader.endings):
        return f"its endings are {reader.endings}; want small letters behind a dot"
    if reader.fallback or reader.recognises(OWN_TEXT):
        return "it takes any text for its format; want first bytes that no other format has"
    if reader.apart and not reader.module:
        return "it reads in a process of its own for a library that it does not name as module"
    if reader.apart and (plugin.attribute != "READER" or reader.read.__module__ != plugin.module):
        return "what reads in a process of its own is found there as READER in the module of its read"
    return ""


def _told(plugin: Plugin, reader: Reader) -> Reader:
    """The reader, with whatever its functions get wrong told as a fault of its package."""
    read = partial(read_apart, reader) if reader.apart else reader.read

    def table(file: Path, *more: Any) -> Table:
        return _whole(plugin, file, plugin.call(f"{file}: its reading failed", read, file, *more))

    def tables(file: Path, *more: Any, **named: Any) -> list[Table]:
        assert reader.several is not None
        made = plugin.call(f"{file}: its reading failed", reader.several, file, *more, **named)
        return [_whole(plugin, file, one) for one in made]

    return replace(
        reader,
        recognises=plugin.guarded("recognises", reader.recognises),
        read=table,
        several=None if reader.several is None else tables,
        apart=False,
    )


def _whole(plugin: Plugin, file: Path, table: object) -> Table:
    """A table whose columns are numbers (n,), with nothing said yet of what they mean."""
    if not isinstance(table, Table):
        raise plugin.fault(f"{file}: its read gave {type(table).__name__}, not Table")
    for name, values in list(table.columns.items()):
        numbers = plugin.call(f"{file}: its column {name} is no numbers", np.asarray, values, dtype=float)
        if numbers.ndim != 1:
            raise plugin.fault(f"{file}: its column {name} has {numbers.ndim} dimensions; want one")
        table.columns[name] = numbers
    return table
