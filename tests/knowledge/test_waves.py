"""Waves that turn with a shaft, and whose they are: the gear's, its encoder's, or another part's."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray
from tests.knowledge.rigs import COAST, UNLOADED, added, graded, hidden, inspected, record
from tests.knowledge.verdicts import Cause, Verdict, verdict
from tests.physics_cases import SPEED

pytestmark = pytest.mark.slow

LINES = ("shaft_order", "tone", "time")
"""Kinds of entries that place a wave."""

Z = 8, 11
HERTZ = SPEED / 60.0
"""Turns of the driving shaft per second."""


def placed(found: Verdict, order: float) -> bool:
    """Whether a wave of so many periods a driving turn has a place: by either shaft or in time, which one speed does
    not tell apart. A line of 33 turns is 0.03 wide."""
    periods = []
    for one in found.located(LINES):
        if one.get("order") is not None:
            periods.append(float(one["order"]) * (1.0 if one.get("gear") == "driving" else Z[0] / Z[1]))
        elif one.get("hz"):
            periods.append(float(one["hz"]) / HERTZ)
    return any(abs(one - order) < 0.02 for one in periods)


def angles(one: Recording) -> tuple[FloatArray, FloatArray]:
    """Angles of both shafts as they were read, rad."""
    assert one.driving_angle_rad is not None
    assert one.driven_angle_rad is not None
    return one.driving_angle_rad, one.driven_angle_rad


def test_an_eccentricity_and_an_encoder_s_are_one_of_both_on_one_flank() -> None:
    """Unloaded and on one flank both draw one wave a turn: either is told as one of both, or nothing but the order."""
    known = inspected()
    found = verdict(known, record(hidden(known, "eccentricity", (3.0, -4.0), gear=0), UNLOADED))
    both = [Cause(physics=name, gear="driving") for name in ("eccentricity", "encoder_eccentricity")]
    assert found.misnamed(*both) == [], found.told
    if found.missing:
        assert all(found.named(one) for one in both), found.told
    else:
        assert placed(found, 1.0), found.told


def test_both_flanks_tell_an_eccentricity_from_its_encoder() -> None:
    """An encoder errs alike on both flanks; a gear off its axis by twice the pressure angle apart."""
    known = inspected()
    found = verdict(known, record(hidden(known, "eccentricity", (3.0, -4.0), gear=0), UNLOADED, COAST, cycles=2.0))
    off = Cause(physics="eccentricity", gear="driving")
    assert found.misnamed(off) == [], found.told
    assert found.named(Cause(physics="encoder_eccentricity")) is None, found.told
    assert found.size(off, "amplitude_um") == pytest.approx(5.0, abs=0.2)  # its stated error is 0.05 um


def test_both_flanks_tell_an_eccentricity_from_uninspected_pitch() -> None:
    """Whole teeth out of their place err in step on both flanks; a gear off its axis does not."""
    true, known = graded(pitch_um=2.0)
    found = verdict(known, record(hidden(true, "eccentricity", (5.0, -3.0), gear=0), UNLOADED, COAST, cycles=2.0))
    off = Cause(physics="eccentricity", gear="driving")
    assert found.misnamed(off) == [], found.told
    assert found.size(off, "amplitude_um") == pytest.approx(5.83, abs=0.3)  # its stated error is 0.06 um


def test_a_wave_that_swells_is_no_gear_s() -> None:
    """From nothing to 8 um at the driven shaft's order 1: a belt slackens so within minutes, a gear does not."""
    known = inspected()
    (one,) = record(known, UNLOADED)
    grown = np.linspace(0.0, 8.0, one.size) * np.cos(angles(one)[1])
    found = verdict(known, [added(one, known, grown)])
    assert not found.missing, found.told
    assert placed(found, Z[0] / Z[1]), found.told


def test_a_wave_that_no_gear_makes_has_a_place_and_no_name() -> None:
    """0.8 um at order 3.37 of the driving shaft: some belt's or bearing's."""
    known = inspected()
    (one,) = record(known, UNLOADED)
    found = verdict(known, [added(one, known, 0.8 * np.cos(3.37 * angles(one)[0]))])
    assert not found.missing, found.told
    assert placed(found, 3.37), found.told


@cache
def among_strangers() -> Verdict:
    """Eight waves of other parts, all as large: in eleven turns one more lies at an order of a shaft by chance."""
    known = inspected()
    (one,) = record(known, UNLOADED, cycles=1.0)
    rng = np.random.default_rng(4)
    orders = [*(np.arange(2, 10) + rng.uniform(0.3, 0.7, 8)), 5.0]
    driving = angles(one)[0]
    waves = sum(0.6 * np.cos(order * driving + rng.uniform(0.0, 6.0)) for order in orders)
    return verdict(known, [added(one, known, np.asarray(waves))])


@pytest.mark.parametrize("physics", ["cumulative_pitch", "encoder_interpolation", "undulation"])
def test_a_wave_of_an_order_has_no_name_where_many_are_of_none(physics: str) -> None:
    found = among_strangers()
    assert found.named(Cause(physics=physics)) is None, found.told


def test_many_waves_of_other_parts_are_no_damage() -> None:
    """Where every pair of teeth meets once, nothing repeats that a pit would repeat."""
    found = among_strangers()
    assert not found.missing, found.told


def test_a_hum_at_a_whole_order_is_no_encoder_s_line() -> None:
    """50 Hz while the shaft turns ten times a second, all along: order 5, and nothing tells whose it is."""
    known = inspected()
    (one,) = record(known, UNLOADED)
    assert one.time_s is not None
    found = verdict(known, [added(one, known, 0.8 * np.cos(2.0 * np.pi * 50.0 * one.time_s))])
    assert not found.missing, found.told
    assert placed(found, 5.0), found.told


def test_an_encoder_s_line_at_a_whole_order_is_no_undulation() -> None:
    """64 periods a turn of the driving encoder, on nine teeth beside every order of the mesh. It is told as the
    encoder's or as one of its look-alikes, or has its place alone."""
    known = inspected((9, 11))
    line = Cause(physics="encoder_interpolation", gear="driving")
    true = hidden(known, "encoder_interpolation", (60.0, -20.0), gear=0, order=64)
    found = verdict(known, record(true, UNLOADED, cycles=2.0, per_mesh=24))
    assert found.misnamed(line) == [], found.told
    if found.missing:
        assert found.size(line, "order") == 64
        assert found.size(line, "amplitude_urad") == pytest.approx(63.2, rel=0.15)
    else:
        assert found.located(LINES), found.told


def test_an_encoder_s_line_above_half_the_sampling_rate_is_not_many_waves() -> None:
    """Order 470 in some 144 uneven samples a turn: its images lie at many orders below. It is told as the encoder's, or
    placed at an image or two, and no image is a wave of its own."""
    known = inspected((9, 11))
    line = Cause(physics="encoder_interpolation", gear="driving")
    true = hidden(known, "encoder_interpolation", (120.0, -60.0), gear=0, order=470)
    found = verdict(known, record(true, UNLOADED, cycles=2.0, per_mesh=16))
    assert found.misnamed(line) == [], found.told
    assert len(found.located(LINES)) <= 2, found.told


def test_a_pitch_wave_is_told_by_its_steps_from_an_encoder_s() -> None:
    """A tooth's error lasts for its whole mesh: order 3 of eleven teeth goes in steps."""
    known = inspected()
    true = hidden(known, "cumulative_pitch", (4.0, -2.0), gear=1, order=3, flank="drive")
    found = verdict(known, record(true, UNLOADED, cycles=2.0))
    wave = Cause(physics="cumulative_pitch", gear="driven")
    assert found.misnamed(wave) == [], found.told
    if found.missing:
        assert found.size(wave, "amplitude_um") == pytest.approx(4.47, abs=0.35)  # its stated error is 0.09 um
    else:
        assert placed(found, 3.0 * Z[0] / Z[1]), found.told
