"""Places of the teeth that would read alike are told once."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

from gearpoly.compare.zeros import Alignment
from gearpoly.report.compare_report import zeros_apart
from gearpoly.units import DEG


def zeros(driving_deg: float | None, driven_deg: float | None, rms: float) -> Any:
    angles = [None if one is None else one * DEG for one in (driving_deg, driven_deg)]
    return SimpleNamespace(driving=angles[0], driven=angles[1], rms=rms)


def test_rivals_that_read_as_the_chosen_or_as_a_better_one_are_left_out() -> None:
    rivals = [zeros(70.0, None, 1.0), zeros(50.0, None, 1.1), zeros(430.0, None, 1.2), zeros(50.0, None, 1.3)]
    found = cast("Alignment", SimpleNamespace(zeros=zeros(70.0, None, 0.9), rivals=(*rivals, zeros(10.0, None, 1.4))))
    assert [one.rms for one in zeros_apart(found)] == [1.1, 1.4]


def test_both_shafts_count() -> None:
    rivals = (zeros(70.0, 20.0, 1.0), zeros(70.0, 34.4, 1.1))
    found = cast("Alignment", SimpleNamespace(zeros=zeros(70.0, 20.0, 0.9), rivals=rivals))
    assert [one.rms for one in zeros_apart(found)] == [1.1]
