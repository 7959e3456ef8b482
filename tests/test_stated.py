"""What recordings state of themselves, held against their own numbers."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.stated import refuse_twins, speed_remarks
from gearpoly.errors import InputFileError

TURNS = np.linspace(0.0, 2.0 * math.pi * 20.0, 400)


def turning(
    rpm: float, *, stated: float | None, scale: float = 1.0, backwards: bool = False, column: Any = None
) -> Any:
    """Twenty turns at ``rpm``, angles written down ``scale`` times as large."""
    time = TURNS / (2.0 * math.pi) * 60.0 / rpm
    return SimpleNamespace(
        cleaned=SimpleNamespace(recording=SimpleNamespace(speed_rpm=stated), ratio=0.72, speed_rpm=column),
        theta_1=scale * (TURNS[::-1] if backwards else TURNS),
        time_s=time,
    )


@pytest.mark.parametrize(
    ("one", "says"),
    [
        (turning(30.0, stated=33.0), None),
        (turning(30.0, stated=30.0, backwards=True), None),
        (turning(30.0, stated=None), None),
        (turning(30.0, stated=45.0), "turns at 30 rpm"),
        (turning(0.03, stated=None, column=np.full(400, 30.0)), "are the times in ms?"),
        (turning(3e4, stated=None, column=np.full(400, 30.0)), "are the times in s?"),
        (turning(30.0, stated=None, column=np.full(400, np.nan)), None),
        (turning(30.0, stated=30.0, scale=math.pi / 180.0), "are the angles in rad?"),
        (turning(30.0, stated=0.5), "is the speed in Hz?"),
        (turning(30.0, stated=math.pi), "is the speed in rad/s?"),
        (turning(30.0, stated=21.6), "is it the driven shaft's?"),
        (turning(30.0, stated=0.0), None),
    ],
)
def test_a_speed_that_angles_and_times_contradict_is_told(one: Any, says: str | None) -> None:
    remarks = list(speed_remarks([one]))
    assert len(remarks) == (says is not None)
    if says is not None:
        assert says in remarks[0]
        assert "recording 0" in remarks[0]


def test_the_speed_of_the_pair_is_held_against_the_unit_of_times_alone() -> None:
    """The pair file may state the speed of other recordings; a thousandth of it is a clock in ms, a thousand times as
    much one in s whose column says ms."""
    (said,) = speed_remarks([turning(0.03, stated=None)], of_pair=30.0)
    assert "is of a pair stated to turn at 30 rpm, but turns at 0.03 rpm" in said and "are the times in ms?" in said
    (said,) = speed_remarks([turning(3e4, stated=None)], of_pair=30.0)
    assert "but turns at 3e+04 rpm" in said and "are the times in s?" in said
    assert not list(speed_remarks([turning(45.0, stated=None)], of_pair=30.0))
    assert not list(speed_remarks([turning(30.0, stated=30.0)], of_pair=30000.0))


def test_a_recording_without_times_says_nothing_of_its_speed() -> None:
    one = turning(30.0, stated=60.0)
    one.time_s = None
    assert not list(speed_remarks([one]))


def test_a_recording_given_twice_is_refused() -> None:
    """Another of the same length is not the same, nor is the same rotation with other noise."""

    def cleaned(name: str, te: np.ndarray, torque: float = 5.0) -> Any:
        stated = SimpleNamespace(source=name, torque_nm=torque, speed_rpm=None, flank="drive")
        return SimpleNamespace(size=te.size, te=te, theta_2=TURNS, recording=stated)

    noise = np.random.default_rng(2).normal(size=(2, TURNS.size))
    refuse_twins([cleaned("a.csv", noise[0]), cleaned("b.csv", noise[1])])
    refuse_twins([cleaned("a.csv", noise[0]), cleaned("b.csv", noise[0], torque=10.0)])  # of rigid teeth, simulated
    with pytest.raises(InputFileError, match=r"c\.csv.*the same samples as a\.csv.*once"):
        refuse_twins([cleaned("a.csv", noise[0]), cleaned("b.csv", noise[1]), cleaned("c.csv", noise[0].copy())])
