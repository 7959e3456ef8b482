"""What a comparison says of its set of recordings."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from gearpoly.compare.remarks import apart_remarks
from gearpoly.units import UM

Z_2, R_B2 = 25, 23.492
PITCH = 2.0 * math.pi * R_B2 / Z_2  # mm along the line of action


def standing(mean: float, *, flank: str = "drive", computed: bool = False) -> Any:
    """A recording whose residual has this mean in mm; ``computed``: its rig made the transmission error."""
    recording = SimpleNamespace(run=None, computed=computed, own_zero=computed)
    return SimpleNamespace(cleaned=SimpleNamespace(recording=recording), flank=flank, r_b2=R_B2, mean=mean)


@pytest.mark.parametrize(
    ("mean", "flank", "computed", "told"),
    [
        (0.36 * PITCH, "drive", False, True),  # encoders were taken off in between: 2106 um
        (-0.36 * PITCH, "drive", False, True),
        (40.0 * UM, "drive", False, False),  # soft teeth and bearings
        (0.36 * PITCH, "coast", False, False),  # the backlash lies between
        (0.36 * PITCH, "drive", True, False),  # a rig that took a mean of its own off
    ],
)
def test_recordings_whose_encoders_have_other_zeros_are_told(
    mean: float, flank: str, computed: bool, told: bool
) -> None:
    both = standing(0.0, computed=computed), standing(mean, flank=flank, computed=computed)
    said = list(apart_remarks(both, z_2=Z_2))
    assert len(said) == told
    if told:
        assert f"{mean / UM:+.4g} um" in said[0]
        assert "other zeros" in said[0]
