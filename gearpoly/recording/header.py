"""The header of a column: a name, and often a unit in one of the ways that people write it."""

from __future__ import annotations

import re

from gearpoly.recording.by_readings import rises, runs_evenly
from gearpoly.recording.quantities import DOUBTFUL, TIME, unit_written, units_written
from gearpoly.recording.words import CHANNEL_NAME_LIMIT
from gearpoly.units import FloatArray

_BRACKETS = (r"(.*\S)\s*\(([^()]*)\)", r"(.*\S)\s*\{([^{}]*)\}", r"(.*\S)\s*<([^<>]*)>")

_SUFFIX = r"(.*\S)[_,;]\s*(\S+)"

COUNT_UNIT_NAMES = ("count", "counts", "inc", "incs", "inkremente", "impulse", "pulses", "ticks", "cts")
"""Units of nothing but an encoder's counts."""

NO_SUFFIX = ("in", "min", "m", "as", "h", "d")
"""Units that no ending of a name after a line below is: ``angle_in`` is no inch, ``speed_min`` no minute."""


def header_unit(header: str) -> tuple[str, str]:
    """The name and the unit in a header such as ``Winkel Antrieb [°]``, ``torque / Nm``, ``t (s)`` or ``angle_deg``."""
    text = header.strip()
    if len(text) > CHANNEL_NAME_LIMIT:
        return text, ""
    text = re.sub(r"_\{(\w+)\}", r"_\1", text)  # as mathematicians lower an index
    if re.search(r"\S\[\d+\]$", text):
        return text, ""  # one of several, as programs count them
    if found := re.fullmatch(r"(.*?)\s*\[([^\[\]]*)\]\s*", text):
        return found[1].strip(), found[2].strip()
    for pattern in (*_BRACKETS, r"(.*\S)\s*/\s*(\S.*)", r"(.*\S)\s+in\s+(\S+)", _SUFFIX):
        found = re.fullmatch(pattern, text)
        known = found is not None and (units_written(found[2]) or found[2].strip().lower() in (*DOUBTFUL, "%"))
        ended = pattern is _SUFFIX and found is not None and (found[2].lower() in NO_SUFFIX or found[2][:1].isdigit())
        if found and known and not ended:
            return found[1].strip(), found[2].strip()
    return text, ""


def is_clock(name: str, values: FloatArray) -> bool:
    """Whether a channel is called by nothing but a unit of time, and runs on as one."""
    bare = name.strip()
    if unit_written(bare, TIME) is None or bare.lower() in NO_SUFFIX:
        return False
    return runs_evenly(values) if len(bare) == 1 else rises(values)
