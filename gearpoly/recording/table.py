"""What a reader finds in a file: columns, keys and remarks, before anyone judges them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from gearpoly.recording.quantities import Unit
from gearpoly.units import FloatArray

AXIS_ERROR, AXIS_CORRECTION, WORM_ANGLE = "axis_error_arcsec", "axis_correction_arcsec", "worm_angle_deg"
"""Columns of guide logs and curves of periodic error: error of a telescope's axis, positive where it is ahead, what
pulses may have turned it by, and the angle of the worm. Only the pair file knows the worm between that axis and the
pair."""

MAPPED_AXIS = (AXIS_ERROR, AXIS_CORRECTION, WORM_ANGLE)
"""All of them, as a map and a table under names of its own may give them."""


PULSE_TIME, PULSE_CHANNEL = "pulse_time_s", "pulse_channel"
PULSE_TIMES = (
    *(f"{shaft}_{kind}" for shaft in ("driving", "driven") for kind in ("pulse_s", "interval_s")),
    PULSE_TIME,
    PULSE_CHANNEL,
)
"""Columns that a map may give in the place of angles: the times of each shaft's pulses, the times between them, or the
time of any pulse beside its channel, which is 0 for the driving shaft."""


OF_WORDS = "of words"
"""How it is said that columns hold words."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Channel:
    """A series of numbers under a name of the owner's own: ``values`` (m,) in the ``unit`` that the file states, empty
    where it states none; ``time`` (m,) in s where the format gives the channel times of its own. ``leaf`` is the
    channel's own name where the table calls it by a path, or by its ``number`` in the file (from 1; 0: none) since
    several are called so."""

    values: FloatArray
    unit: str = ""
    time: FloatArray | None = None
    leaf: str = ""
    number: int = 0

    def group(self, path: str) -> str:
        """The part of its ``path`` before its own name; empty where it has none."""
        if not self.leaf or path == self.leaf or self.number:
            return ""
        return path[: -len(self.leaf)].rstrip("/.") if path.endswith(self.leaf) else path.rpartition(".")[0]


def told_apart(names: Sequence[str]) -> list[str]:
    """The ``names`` of all columns of a file, those that several have with their numbers, and numbers for those
    without."""
    count = Counter(names)
    called = [f"{name} (column {k})" if name else f"column {k}" for k, name in enumerate(names, start=1)]
    out = [name if name and count[name] == 1 else other for name, other in zip(names, called, strict=True)]
    return out if len(set(out)) == len(out) else called


@dataclass(frozen=True, kw_only=True)
class Doubt:
    """What a reader could not tell, as a sentence (``says``), and the lines of a map that settle it (``ask``), the
    likeliest first: the file was read so for the time being."""

    says: str
    ask: tuple[str, ...]


@dataclass
class Table:
    """What a reader found: columns (n,) and keys under the contract's names, and remarks for the user.

    ``others`` are channels under names of the owner's own, by their path in the file (``rig/angle``, ``run.angle``, or
    the header of a column); names and units, or a map, say which columns they are. ``layout`` says how a text file was
    read, key by key of a map. ``places`` is half of the last place that a column was written to, where its numbers no
    longer show it. ``unread`` is what else the file holds and was not read, and the cure. ``worm_period_s`` is that of
    a telescope's worm, where the file states it, else 0. ``units`` are those that columns were in, ``mapped`` the
    columns that a map gives. ``jumps`` is what a map says of jumps of the time, ``entries`` the lines of a map that
    give columns as they were taken. ``paths`` are the columns' own places in a file of groups, by which a map may name
    them: a column by its path.
    """

    columns: dict[str, FloatArray]
    keys: dict[str, object]
    remarks: list[str] = field(default_factory=list)
    others: dict[str, Channel] = field(default_factory=dict)
    layout: dict[str, str] = field(default_factory=dict)
    places: dict[str, float] = field(default_factory=dict)
    doubts: list[Doubt] = field(default_factory=list)
    taken_from: dict[str, str] = field(default_factory=dict)
    unread: tuple[str, str] | None = None
    worm_period_s: float = 0.0
    units: dict[str, Unit] = field(default_factory=dict)
    mapped: set[str] = field(default_factory=set)
    jumps: str = ""
    entries: dict[str, str] = field(default_factory=dict)
    paths: dict[str, str] = field(default_factory=dict)
