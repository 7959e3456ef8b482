"""Keys of the pair file that the recordings contradict: which other values are tried."""

from __future__ import annotations

import pytest

from gearpoly.diagnose.misdeclared import ANGLES, PROFILE_SHIFTS_TRIED, OtherKeys, other_keys
from gearpoly.gear.nominal import nominal_gears
from gearpoly.mesh.pair import tight_centre_distance
from tests.pair_files import pair_file

STATED = pair_file((15, 28), driving={"profile_shift": 0.1}, driven={"profile_shift": -0.05})


def every() -> list[OtherKeys]:
    return [one for way in other_keys(STATED) for one in way]


def shifts(one: OtherKeys) -> tuple[float, float]:
    return one.file.driving.profile_shift, one.file.driven.profile_shift


def test_other_shifts_leave_the_axes_where_they_are() -> None:
    """Without backlash gears whose shifts have the same sum run at the same distance (ISO 21771:2007, 6.3), to
    rounding."""
    stated = tight_centre_distance(*nominal_gears(STATED))
    tried = [one for one in every() if one.shift is not None]
    assert len(tried) == 2 * len(PROFILE_SHIFTS_TRIED)
    for one in tried:
        assert sum(shifts(one)) == pytest.approx(0.05, abs=1e-12)
        assert tight_centre_distance(*nominal_gears(one.file)) == pytest.approx(stated, abs=1e-9)


def test_what_the_file_states_is_not_tried_as_another_value() -> None:
    assert {one.file.driving.pressure_angle_deg for one in every()} == set(ANGLES)
    angles = [one for one in every() if one.file.driving.pressure_angle_deg != 20.0]
    assert len(angles) == len(ANGLES) - 1
    assert all(one.file != STATED for one in every())


def test_a_key_is_told_beside_what_the_file_has() -> None:
    said = [one.says for one in every()]
    assert any(
        "pressure_angle_deg 22.5 the recordings fit, and with 20 as in the pair file they do not" in s for s in said
    )
    one = next(one for one in every() if one.shift == pytest.approx(0.3))
    assert "profile_shift 0.400 (driving) and -0.350 (driven) the recordings fit" in one.says
    assert "with 0.100 (driving) and -0.050 (driven) as in the pair file" in one.says
