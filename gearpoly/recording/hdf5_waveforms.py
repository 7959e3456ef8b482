"""What HDF5 files state of a channel beside its numbers: its name, its unit and its times, where each channel is a
group, or a dataset with a sampling rate among its attributes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.deeds import in_full
from gearpoly.recording.hdf5_columns import Series, above, few, kept_elsewhere, one_text, text_of
from gearpoly.recording.header import header_unit
from gearpoly.recording.quantities import TIME, unit_written
from gearpoly.recording.stated_units import UNIT_NAMES
from gearpoly.recording.words import quantity_of
from gearpoly.units import FloatArray

SERIES_NAMES = ("data", "values", "value", "samples", "signal", "raw", "y", "messwerte")
"""Names of the numbers of a channel that is a group, or a struct, itself."""

NAME_ATTRIBUTES = ("name", "channelname", "label", "longname", "signalname", "title")
STEP_ATTRIBUTES = (
    "wfincrement",
    "dt",
    "deltat",
    "timestep",
    "xincrement",
    "increment",
    "sampleinterval",
    "samplinginterval",
)
RATE_ATTRIBUTES = ("fs", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency", "scanrate", "abtastrate")
START_ATTRIBUTES = ("wfstartoffset", "t0", "x0", "xorigin", "starttime", "wfstarttime", "start")
"""Attributes, in small letters alone, by which a channel states its name, the time between two samples or their rate,
and the time of the first."""

_HERTZ = {"": 1.0, "hz": 1.0, "s/s": 1.0, "1/s": 1.0, "khz": 1e3, "mhz": 1e6, "mhertz": 1e6}


@dataclass(kw_only=True)
class Stated:
    """What is said of one channel: its own name, its unit, its times (m,) in s, and when they begin, where that is a
    text."""

    leaf: str
    unit: str = ""
    time: FloatArray | None = None
    begun: str = ""
    said: str = ""
    taken: list[tuple[str, str]] = field(default_factory=list)


def stated(root: Any, groups: Mapping[str, Mapping[str, Any]], path: str, name: str) -> Stated:
    """What is said of the channel ``name`` in the group ``path``; ``taken`` are the datasets, by group and name, that
    are its times and nothing else."""
    one = groups[path][name]
    unit = one.unit if isinstance(one, Series) else ""
    of_group = name.lower() in SERIES_NAMES and path != "/"
    places = [] if isinstance(one, Series) else [one.attrs]
    about = [root[place].attrs for place in (path, *above(path)) if place in root]
    if of_group:
        places += about[:1]
    found = Stated(leaf=name, unit=unit or _first(places, UNIT_NAMES))
    called = _first(places, NAME_ATTRIBUTES)
    if of_group:
        called = called or _beside(groups[path], NAME_ATTRIBUTES)
        found.unit = found.unit or _beside(groups[path], UNIT_NAMES)
        found.leaf = called or path.rpartition("/")[2]
    elif called and not quantity_of(name):
        found.leaf = called
    beside = {other for other in groups[path] if other != name and quantity_of(other) == TIME}
    for other in beside if of_group else ():
        times = groups[path][other]
        seconds = unit_written(_first([times.attrs], UNIT_NAMES) or header_unit(other)[1], TIME)
        if seconds is not None and not kept_elsewhere(times) and times.size == one.size:
            held = times.values if isinstance(times, Series) else np.asarray(times[()])
            found.time, found.taken = held.reshape(-1).astype(np.float64) * seconds.size, [(path, other)]
            return found
    if beside or quantity_of(found.leaf) == TIME:
        return found
    _take_step(found, [one.attrs, *about], int(one.size))
    return found


def _take_step(found: Stated, held: Sequence[Any], size: int) -> None:
    """Give a channel of ``size`` readings the times that its attributes state."""
    for attributes in held:
        for key, value in _numbers(attributes):
            bare, unit = _bare(key)
            if bare in STEP_ATTRIBUTES and value > 0.0:
                seconds = unit_written(unit, TIME) if unit else None
                if unit and seconds is None:
                    continue
                step = value * (seconds.size if seconds is not None else 1.0)
            elif bare in RATE_ATTRIBUTES and value > 0.0 and unit.lower() in _HERTZ:
                step = 1.0 / (value * _HERTZ[unit.lower()])
            else:
                continue
            first = next((v for k, v in _numbers(attributes) if _bare(k)[0] in START_ATTRIBUTES), 0.0)
            found.begun = _first([attributes], START_ATTRIBUTES)
            found.time = first + step * np.arange(size, dtype=np.float64)
            found.said = (
                f"{shorten(key)} = {in_full(value)}{'' if unit else ', in Hz' if bare in RATE_ATTRIBUTES else ', in s'}"
            )
            return


def put_begins(file: Path, channels: Mapping[str, Stated]) -> None:
    """Let the times of channels that state when they begin count from the first of these.

    Raises ``InputFileError`` where they begin apart, and when is no date that is known.
    """
    texts = {one.begun for one in channels.values() if one.time is not None}
    if len(texts) < 2:
        return
    try:
        dates = {text: np.datetime64(text.rstrip("Z").replace(" ", "T"), "ns") for text in texts}
    except ValueError:
        shown = shorten(", ".join(sorted(texts)), width=120)
        wish = "want channels that begin together, or dates as 2026-02-03T10:15:00.250 for all of them"
        raise InputFileError(file, where="channels", found=f"different starts ({shown})", wish=wish) from None
    first = min(dates.values())
    for one in channels.values():
        if one.time is not None:
            one.time = one.time + float((dates[one.begun] - first) / np.timedelta64(1, "s"))


def _numbers(attributes: Any) -> Iterator[tuple[str, float]]:
    for key in attributes:
        value = np.asarray(attributes[key]) if few(attributes, key) else np.empty(0)
        if value.size == 1 and value.dtype.kind in "iuf" and np.isfinite(value.reshape(-1)[0]):
            yield key, float(value.reshape(-1)[0])


def _first(places: Sequence[Any], names: Sequence[str]) -> str:
    """The text of the first attribute that is called one of ``names``."""
    wanted = {re.sub(r"[^a-z0-9]", "", one) for one in names}
    for attributes in places:
        for key in attributes:
            if re.sub(r"[^a-z0-9]", "", key.lower()) in wanted and few(attributes, key):
                value = attributes[key]
                if isinstance(value, np.ndarray) and value.size == 1:
                    value = value.reshape(-1)[0]
                if isinstance(value, str | bytes):
                    return text_of(value)
    return ""


def _beside(held: Mapping[str, Any], names: Sequence[str]) -> str:
    """The text in a dataset of a group that is called one of ``names``, the last part of a path in a model."""
    for name, one in held.items():
        if (
            name.lower() in names
            and not isinstance(one, Series)
            and not kept_elsewhere(one)
            and (text := one_text(one))
        ):
            return text.rpartition("/")[2].strip('" ') if names is NAME_ATTRIBUTES else text
    return ""


def _bare(key: str) -> tuple[str, str]:
    """An attribute's name in small letters and figures alone, and the unit at its end."""
    hertz = re.fullmatch(r"(.*?)[\s_(\[/]+(k?hz|mhz)[)\]]?", key, re.IGNORECASE)
    name, unit = (hertz[1], hertz[2]) if hertz and hertz[1] else header_unit(key)
    return re.sub(r"[^a-z0-9]", "", name.lower()), unit
