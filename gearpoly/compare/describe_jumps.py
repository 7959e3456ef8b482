"""From the jumps that the fit holds to entries: by how much, when, and how sure."""

from __future__ import annotations

import math

from gearpoly.compare.entries import Entry
from gearpoly.compare.families import SHARES
from gearpoly.compare.regression import Solution
from gearpoly.compare.search import Search
from gearpoly.units import UM


def jump_entries(search: Search, solution: Solution, k: int) -> list[Entry]:
    """Entries of the jumps in recording ``k``, as they stand beside everything that was found after them."""
    out = []
    for jump in search.states[k].jumps:
        found = search.standing(k, solution, jump)
        if found is None:
            continue
        gain, amplitude, std = found.steps.at(found.at)
        level, _ = found.colour
        moment, moment_std = found.steps.moment(search.stretch(k), level=level, about=found.at, within=search.turn(k))
        timed = search.states[k].data.time_s is not None
        out.append(
            Entry(
                kind="time",
                hz=0.0,
                time_s=moment if timed else None,
                time_s_std=moment_std if timed else None,
                driving_turn=None if timed else moment,
                driving_turn_std=None if timed else moment_std,
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
