"""Runs forth and back of one file that one flank carries both ways, though they come back apart: by far less than the
stated teeth have backlash.

Derived here. Between runs on either flank lies the backlash. Less comes from friction, from what hangs on the shafts,
and from encoders that read another angle coming back. The reader cannot tell: it does not know the pair.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from gearpoly.compare.turns import backlash
from gearpoly.errors import GearpolyError
from gearpoly.files.models import GearSection, PairFile
from gearpoly.mesh.pair import GearPair
from gearpoly.recording.lost_motion import LostMotion
from gearpoly.recording.recording import Recording
from gearpoly.recording.runs import carried_by_one, lost_motions
from gearpoly.units import ARCMIN

SAME_FLANK_LOST_MOTION_PART = 0.25
"""Lost motion over the least simulated backlash below which no flank changed. Of an 18/25 whose driving encoder read
0.5 arcmin otherwise coming back it was 0.02, on the other flank it is 1 where the stated thickness is right. A
judgement between both: a thickness would have to be off by three quarters of the backlash."""


def with_flanks(recordings: Sequence[Recording], file: PairFile, pair: GearPair) -> list[Recording]:
    """The recordings, with those runs on the flank that their file states between which far less than the backlash of
    ``pair`` lies; as they are where the file says nothing of the thickness of both gears."""
    out: list[Recording] = []
    for path, these in itertools.groupby(recordings, key=_file_of):
        runs = list(these)
        if path is not None and all(one.run is not None and one.run.in_file is not None for one in runs):
            found = sorted((one for _, _, one in lost_motions(runs)), key=lambda one: abs(one.mean))
            if found and all(_thickness_stated(gear) for gear in (file.driving, file.driven)):
                runs = _beside(runs, found[len(found) // 2], pair)
        out += runs
    return out


def _file_of(one: Recording) -> Path | None:
    return None if one.run is None else one.run.file


def _thickness_stated(gear: GearSection) -> bool:
    """Whether the file says how thick the teeth are: what a grade leaves open says little of the backlash."""
    sheet = gear.inspection
    limited = gear.limits is not None and gear.limits.E_sns_um is not None
    return limited or (sheet is not None and sheet.tooth_thickness_um is not None)


def _beside(runs: list[Recording], lost: LostMotion, pair: GearPair) -> list[Recording]:
    """The runs of one file, beside the backlash of the pair."""
    try:
        least = float(np.min(backlash(pair).j_bn))
    except GearpolyError:
        return runs  # a pair that cannot run is told where it is simulated
    along = abs(lost.mean) * (1.0 if lost.along else {"driving": pair.r_b1, "driven": pair.r_b2}[lost.side])
    if along >= SAME_FLANK_LOST_MOTION_PART * least:
        return runs
    r_b = pair.r_b2 if lost.side == "driven" else pair.r_b1
    why = (
        f"one flank carries both ways, as the file states: {along / r_b / ARCMIN:.2g} arcmin lie between them, of "
        f"{least / r_b / ARCMIN:.3g} or more that the teeth have as backlash; friction leaves that, or an encoder that "
        "reads another angle coming back"
    )
    return carried_by_one(runs, why)
