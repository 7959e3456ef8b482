"""In which direction a machine counted teeth, from where it touched both flanks of each."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearpoly.files.gde import Side, Turn
from gearpoly.files.inspection.klingelnberg_text import Probe
from gearpoly.units import FloatArray

UNEVEN_PITCH_PART = 0.1
"""Part of a pitch by which a step from tooth to tooth may differ from one pitch: gears differ by a thousandth, a number
that belongs to another tooth by one."""


def counting(probes: Sequence[Probe], z: int) -> tuple[Turn | None, str]:
    """The direction in which teeth are counted seen on the datum face, or None where points do not tell it; and words.

    The right flank of a tooth that points up lies clockwise of its left one. So teeth are counted clockwise where the
    way from left to right flank of a tooth has the sense of the way from tooth n to tooth n + 1, whatever face the
    machine's own angle was seen on (derived here).
    """
    if not probes:
        return None, "the direction of counting is as stated: the file has no probed points that would show it"
    told = {one for turn in (1.0, -1.0) if (one := _sense(probes, z, turn)) is not None}
    if len(told) != 1:
        return None, "the direction of counting is as stated: the probed points do not show it"
    (sense,) = told
    count: Turn = "clockwise" if sense > 0 else "counterclockwise"
    return count, f"teeth are counted {count} seen on the datum face, by where left and right flanks were probed"


def _sense(probes: Sequence[Probe], z: int, turn: float) -> float | None:
    """Sense of left to right over sense of counting; ``turn`` is the unknown sense of the table's angle."""
    tau = 2.0 * math.pi / z
    angles: dict[Side, FloatArray] = {}
    for side in ("left", "right"):
        mine = {one.tooth: one for one in probes if one.side == side}
        if sorted(mine) != list(range(1, z + 1)):
            return None
        polar = np.array([math.atan2(mine[n].y, mine[n].x) for n in range(1, z + 1)])
        table = np.radians([mine[n].phi for n in range(1, z + 1)])
        # Points of one half pitch are in the machine's frame, and the table turned; others are in the gear's own.
        turned = float(np.ptp(_wrapped(polar - polar[0]))) < 0.5 * tau
        angles["left" if side == "left" else "right"] = polar + turn * table if turned else polar
    steps = np.concatenate([_wrapped(np.roll(a, -1) - a) for a in angles.values()])
    sense = math.copysign(1.0, float(np.mean(steps)))
    if float(np.max(np.abs(steps - sense * tau))) > UNEVEN_PITCH_PART * tau:
        return None
    across = _wrapped(angles["right"] - angles["left"])
    width = float(np.mean(across))
    # A tooth is wider than a tenth of its pitch and narrower than nine tenths.
    if not 0.1 * tau < abs(width) < 0.9 * tau or float(np.ptp(across)) > UNEVEN_PITCH_PART * tau:
        return None
    return sense * math.copysign(1.0, width)


def _wrapped(angles: FloatArray) -> FloatArray:
    """Angles from -pi to pi."""
    out: FloatArray = (angles + math.pi) % (2.0 * math.pi) - math.pi
    return out
