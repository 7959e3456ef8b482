"""From the jumps that the fit holds to entries: by how much, when, and how sure."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.entries import Entry
from gearpoly.compare.families import SHARES
from gearpoly.compare.jump_search import a_turn, standing, stretch_of
from gearpoly.compare.jumps import size_of
from gearpoly.compare.model import JointModel
from gearpoly.compare.regression import Solution
from gearpoly.units import UM, FloatArray

JUMP_AGAIN_PART = 0.5
"""Part of a jump that another turn steps by at the same place where it is a tooth's: teeth come again as they were, but
for the mates that they meet."""

TOOTH_LOG_ODDS = 5.0
"""Log odds by which steps of other turns must speak for a tooth: of 0.3 um in 1 um of noise, which a pitch of 20
samples knows to 0.3 um, a fifth of 80 jumps that stood out by 15 were taken for teeth by noise alone, before this
was asked. At 3 one of them still was; of 80 others none is at 5."""


def jump_entries(search: JointModel, solution: Solution, k: int) -> list[Entry]:
    """Entries of the jumps in recording ``k``, as they stand beside everything that was found after them."""
    out = []
    for jump in search.states[k].jumps:
        found = standing(search, k, solution, jump)
        if found is None:
            continue
        gain, _, _ = found.steps.at(found.at)
        amplitude, std = size_of(found.left, found.at, width=jump.width)
        # Beside teeth that hardly came twice a jump and they may cancel: none is larger than all that was recorded.
        too_large = abs(amplitude) > float(np.ptp(search.states[k].data.residual))
        if too_large or _comes_round(search, solution, k, found.at, amplitude):
            continue
        level, _ = found.colour
        moment, moment_std = found.steps.moment(
            stretch_of(search, k), level=level, about=found.at, within=a_turn(search, k)
        )
        timed = search.states[k].data.time_s is not None
        along, side = stretch_of(search, k), jump.width // 2
        rise = float(along[min(found.at + side, along.size - 1)] - along[max(0, found.at - side)])
        out.append(
            Entry(
                kind="step",
                time_s=moment if timed else None,
                time_s_std=moment_std if timed else None,
                driving_turn=None if timed else moment,
                driving_turn_std=None if timed else moment_std,
                rise=rise,
                amplitude_um=amplitude / UM,
                std_um=std * math.sqrt(level) / UM,
                recordings=(k,),
                p_value=float(SHARES.jump * math.exp(min(0.0, found.log_false))),
                label="jump",
                rivals=("a slow drift",) if found.open else (),
                gain=gain / level,
            )
        )
    return out


def _comes_round(search: JointModel, solution: Solution, k: int, at: int, amplitude: float) -> bool:
    """Whether recording ``k`` steps as at sample ``at`` one turn of either shaft before and after too, from one pitch
    to the next, and by more than noise does: then a tooth or its neighbours came round, and nothing jumped."""
    s, places = search.states[k], search.places[k]
    rest = s.data.residual - s.slow @ solution.beta[places["slow"]]
    for z in (search.z_1, search.z_2):
        steps = [_step(s.data.u, rest, float(s.data.u[at]) + turn * z) for turn in (-1, 0, 1)]
        # Of the jump's own step the pitch after it holds all; another turn's is there with it or without it.
        beside = [one for one in (steps[0], steps[2]) if one is not None]
        again = all(one.by * amplitude > 0.0 and abs(one.by) > JUMP_AGAIN_PART * abs(amplitude) for one in beside)
        # Steps of a tooth are as large as the jump; where it was a jump they are none. Noise as it is over two pitches.
        density = float(np.interp(0.5, s.noise.frequency, s.noise.density))
        odds = sum((one.by - 0.5 * amplitude) * amplitude / (one.part * density) for one in beside)
        if again and odds > TOOTH_LOG_ODDS:
            return True
    return False


@dataclass(frozen=True)
class _Step:
    """A step ``by`` so many mm, whose variance in white noise is ``part`` of that of a sample."""

    by: float
    part: float


def _step(u: FloatArray, values: FloatArray, at: float) -> _Step | None:
    """By how much ``values`` (n,) over ``u`` (n,) meshes step at ``at``, from the mean of the pitch before to that of
    the pitch after; ``None`` beyond the recording."""
    low, middle, high = np.searchsorted(u, (at - 1.0, at, at + 1.0)).tolist()
    if low == 0 or high == u.size or middle in (low, high):
        return None
    return _Step(
        by=float(np.mean(values[middle:high]) - np.mean(values[low:middle])),
        part=1.0 / (middle - low) + 1.0 / (high - middle),
    )
