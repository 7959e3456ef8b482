"""Where the teeth are is found with what they do: a pair of which nothing is missing stays one."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from tests.knowledge.rigs import UNLOADED, graded, hidden, record
from tests.knowledge.verdicts import verdict

pytestmark = pytest.mark.slow


def test_declared_eccentricities_tell_how_far_on_the_teeth_are() -> None:
    """No zero is stated, and every tooth of a grade may be any other. The eccentricities that the file states would be
    turned by as much: where they fit, nothing is missing."""
    true, known = graded()
    for gear, off in enumerate(((20.0, 5.0), (-12.0, 15.0))):
        true, known = (hidden(one, "eccentricity", off, gear=gear) for one in (true, known))
    (one,) = record(true, UNLOADED)
    found = verdict(known, [replace(one, driving_zero_rad=None, driven_zero_rad=None)])
    assert not found.missing, found.told


def test_a_zero_that_is_a_third_of_a_pitch_late_is_no_fault() -> None:
    """Curves of ideal teeth without load are flat: no column says where a pitch begins but the teeth as they are."""
    true, known = graded()
    (one,) = record(true, UNLOADED)
    assert one.driving_zero_rad is not None and one.driven_zero_rad is not None
    pitch = 2.0 * math.pi / 11
    late = replace(
        one,
        driving_zero_rad=one.driving_zero_rad - 0.3 * pitch * 11 / 8,
        driven_zero_rad=one.driven_zero_rad + 0.3 * pitch,
    )
    found = verdict(known, [late])
    assert not found.missing, found.told
