"""Recordings of one set: what is common, what differs with the condition, and what a condition explains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.units import UM
from tests.knowledge_compare.made import (
    TURN,
    Added,
    drawn,
    drifts,
    pair,
    pitches,
    recorded,
    says,
    standing,
    told,
    whole,
)

pytestmark = pytest.mark.slow

PITCH = pitches(3)
FILE = pair(pitch_um=PITCH)
SOFT = pair(pitch_um=PITCH, bends=True)


def test_a_recording_whose_mean_differs_is_a_condition() -> None:
    """All recordings of a set share one zero, so their means compare: 0.8 um is no noise of a mean."""

    def off(um: float) -> Added:
        return lambda m: np.full(m.part.size, um)

    ways = [recorded(drawn(FILE), seed=k, begin=0.3 * k, per_mesh=8, added=off(um)) for k, um in enumerate((0, 0, 0.8))]
    found = told(FILE, *ways)
    (one,) = standing(found)
    assert (one["kind"], one["recordings"]) == ("condition", [2])
    assert one["rms_um"] == pytest.approx(0.8, abs=0.15)


def test_what_turns_in_one_recording_alone_is_told_of_that_one() -> None:
    """An order of a shaft is looked for in every recording; how large it is each says for itself."""

    def order_5(um: float) -> Added:
        return lambda m: um * np.cos(TURN * 5.0 * m.driven)

    ways = [recorded(drawn(FILE), seed=k, begin=0.3 * k, per_mesh=8, added=order_5(1.5 * k)) for k in range(2)]
    found = told(FILE, *ways)
    (one,) = [e for e in standing(found) if e["kind"] != "condition"]
    assert whole(one, "driven", 5)
    assert one["recordings"] == [1]
    assert one["amplitude_um"] == pytest.approx(1.5, abs=0.3)


def test_what_load_bends_is_no_condition() -> None:
    """Mean transmission error falls by some 10 um from 2 to 40 N.m: that is simulated, and is no difference."""
    ways = [recorded(drawn(SOFT), seed=k, torque_nm=t, per_mesh=8, cycles=1.01) for k, t in enumerate((2.0, 40.0))]
    found = told(SOFT, *ways)
    assert standing(found) == []


def test_compliance_laws_differ_by_ten_per_cent() -> None:
    """What a beam, a finite-element tooth and ISO 6336 differ by: a deflection 6 % larger than simulated is no find."""
    ways = [recorded(drawn(SOFT), seed=k, torque_nm=t, per_mesh=8, cycles=1.01) for k, t in enumerate((2.0, 42.0))]
    found = told(SOFT, ways[0], replace(ways[1], torque_nm=39.6))
    assert [e for e in standing(found) if e["kind"] != "condition"] == []
    assert all(e["rms_um"] < 2.0 for e in standing(found))


def test_a_recording_given_twice_is_refused() -> None:
    """Whatever it shows would count twice."""
    one = recorded(drawn(FILE), per_mesh=8)
    with pytest.raises(InputFileError, match="same samples"):
        told(FILE, one, replace(one))


def test_rigid_teeth_under_two_torques_are_no_twins() -> None:
    """The same curve under another torque is what rigid teeth are, so it is taken."""
    one = recorded(drawn(FILE), per_mesh=8, cycles=1.01)
    found = told(FILE, replace(one, torque_nm=5.0), replace(one, torque_nm=20.0))
    assert found["noise_um"] == pytest.approx(0.3, rel=0.1)


def test_a_torque_that_varies_along_the_recording_is_followed() -> None:
    """It swings by a third once in the recording: deflection swings with it, and there is no drift."""
    true = drawn(SOFT)
    parts = [recorded(true, torque_nm=t, per_mesh=8, cycles=1.01, noise=0.0, only="driven") for t in (16.0, 24.0, 32.0)]
    low, middle, high = (one.te_mm for one in parts)
    assert low is not None and middle is not None and high is not None
    part = (np.arange(middle.size) + 0.5) / middle.size
    x = np.cos(TURN * part)
    # Three torques make a parabola, which deflection is to a few nanometres.
    te = middle + 0.5 * x * (high - low) + 0.5 * x**2 * (high + low - 2.0 * middle)
    te = te + 0.3 * UM * np.random.default_rng(3).normal(size=te.size)
    one = replace(parts[1], te_mm=te, torque_samples_nm=24.0 + 8.0 * x)
    assert standing(told(SOFT, one)) == []
    assert drifts(told(SOFT, replace(one, torque_samples_nm=None))) != []


def test_a_torque_that_nobody_stated_is_told() -> None:
    """Half the torque would look like softer teeth."""
    file = SOFT.model_copy(update={"pair": SOFT.pair.model_copy(update={"torque_nm": 20.0})})
    one = recorded(drawn(SOFT), torque_nm=20.0, per_mesh=8, cycles=1.01)
    assert says(told(file, replace(one, torque_nm=None)), "torque", "20 N.m")
    assert not says(told(file, one), "no torque is stated")


def test_noise_is_pooled_over_all_samples_of_a_set() -> None:
    ways = [recorded(drawn(FILE), seed=k, begin=0.3 * k, per_mesh=8, noise=size) for k, size in enumerate((0.2, 0.6))]
    found = told(FILE, *ways)
    assert found["noise_um"] == pytest.approx(np.sqrt(0.5 * (0.2**2 + 0.6**2)), rel=0.05)
    assert found["noise_um_by_recording"] == [pytest.approx(0.2, rel=0.07), pytest.approx(0.6, rel=0.07)]
    assert standing(found) == []


def test_a_zero_that_one_recording_of_a_set_states_holds_for_all() -> None:
    found = told(
        FILE,
        recorded(drawn(FILE), seed=1, per_mesh=8),
        recorded(drawn(FILE), seed=2, begin=3.3, per_mesh=8, stated=None),
    )
    assert standing(found) == []
