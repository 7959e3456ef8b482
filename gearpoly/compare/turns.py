"""Whether the declared gears can turn at all: a recording of one flank never asks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearpoly.errors import GearpolyError, JammedError
from gearpoly.mesh.pair import GearPair
from gearpoly.mesh.transmission import Backlash, both_flanks

JAM_PLACES_PER_PITCH = 2
"""Places per pitch at which the lost motion is looked at: it changes with the turns of the gears and from tooth to
tooth."""

MOST_JAM_PLACES = 1000
"""Most places over a hunting cycle, half a second of work: coprime gears of more than 500 meshes get fewer per pitch,
and still every turn of either gear."""


def jam_remarks(pair: GearPair) -> Iterator[str]:
    """Where and by how much the teeth of a declared ``pair`` overlap on their other flank, and what can be said all the
    same; nothing where they turn."""
    try:
        backlash(pair)
    except JammedError as jam:
        yield (
            f"as declared, {jam}. Each flank is compared by itself all the same: what one recorded flank shows of "
            "pitch, profiles and turns stands, the mean between both flanks does not"
        )
    except GearpolyError:
        return  # where the other flank cannot be reached at all, those who simulate it say so


def backlash(pair: GearPair) -> Backlash:
    """Backlash of a ``pair`` without load over a hunting cycle. Raises what ``both_flanks`` does."""
    size = min(JAM_PLACES_PER_PITCH * pair.meshes_per_cycle, MOST_JAM_PLACES)
    return both_flanks(pair, np.linspace(0.0, pair.cycle, size, endpoint=False), fast=True)
