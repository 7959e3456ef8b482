"""What a channel was taken for, and what is so of channels that stand beside each other: runs, twins, and two of one
name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.errors import shown
from gearpoly.recording.header import header_unit
from gearpoly.recording.map_lines import entry
from gearpoly.recording.quantities import ANGLE, COUNT, Unit
from gearpoly.recording.table import Channel
from gearpoly.recording.words import run_of


@dataclass(frozen=True, kw_only=True)
class Meaning:
    """What the channel ``channel`` was taken for, or may be.

    ``column`` is the contract's name, empty where it is none of them. Its numbers times ``unit``'s size are in that
    column's unit. ``why`` says what it was known by. ``doubt`` says what is not known, and is empty where nothing is;
    ``ask`` are the lines of a map that would settle it. ``dimension`` is that of the quantity, and ``named`` says
    whether words of the name tell it, and not the unit alone; ``twice``, whether another channel is called so too.
    ``shaft`` and ``run`` are those that its name says, the run where several stand side by side.
    """

    channel: str
    column: str = ""
    unit: Unit | None = None
    dimension: str = ""
    why: str = ""
    doubt: str = ""
    named: bool = True
    twice: bool = False
    ask: tuple[str, ...] = ()
    shaft: str = ""
    run: str = ""


ONE_OF_SEVERAL_RUNS = "one of several runs"
"""Stands for the quantity of a channel whose name says its run, and neither shaft nor quantity."""


def of_runs(channels: Mapping[str, Channel], found: Sequence[Meaning]) -> list[Meaning]:
    """What was ``found``, of runs side by side with the run of each; columns of one run each are no two shafts."""
    runs = {one.channel: run_of(header_unit(channels[one.channel].leaf or one.channel)[0]) for one in found}
    if len(set(runs.values()) - {""}) < 2:
        return list(found)
    out = []
    for one in found:
        run = runs[one.channel]
        told = one.shaft or not run or one.dimension not in ("", ANGLE, COUNT) or (one.column and not one.doubt)
        doubt = "one of several runs side by side, and its name says no shaft"
        other = Meaning(channel=one.channel, dimension=ONE_OF_SEVERAL_RUNS, why=one.why, doubt=doubt)
        out.append(replace(one if told else other, run=run))
    return out


def without_twins(channels: Mapping[str, Channel], found: Sequence[Meaning]) -> list[Meaning]:
    """What was ``found``, without what states once more what another channel states in the same numbers: a trace that
    comes with a time for each channel. What lies in another group is of another recording."""
    out: list[Meaning] = []
    for one in found:
        held = channels[one.channel]
        twin = next(
            (
                other.channel
                for other in out
                if one.column and other.column == one.column and other.unit == one.unit
                if channels[other.channel].group(other.channel) == held.group(one.channel)
                if np.array_equal(channels[other.channel].values, held.values, equal_nan=True)
            ),
            None,
        )
        out.append(
            one
            if twin is None
            else Meaning(channel=one.channel, why=f'the same readings as "{shown(twin)}"', dimension=one.dimension)
        )
    return out


def called_twice(channels: Mapping[str, Channel], found: Sequence[Meaning]) -> list[Meaning]:
    """What was ``found``, with a doubt of each that may be a column and whose name another one has too."""
    numbers: dict[str, list[int]] = {}
    meant = {one.channel for one in found if one.column}
    for name, channel in channels.items():
        if channel.number and channel.leaf and name in meant:
            numbers.setdefault(channel.leaf, []).append(channel.number)
    out = []
    for one in found:
        held = channels[one.channel]
        alike = numbers.get(held.leaf, ()) if held.number and held.leaf else ()
        if one.column and len(alike) > 1:
            doubt = f'"{shown(held.leaf)}" is the name of columns {" and ".join(map(str, alike))}'
            doubt += f", and {one.doubt}" if one.doubt else ""
            ask = one.ask or (entry(one.column, one.channel, one.unit),)
            one = replace(one, doubt=doubt, twice=True, ask=ask)
        out.append(one)
    return out
