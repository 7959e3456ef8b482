"""What is said of many recordings alike is said once, with their numbers."""

from __future__ import annotations

import pytest

from gearpoly.compare.entries import Entry
from gearpoly.report.alike import ranges, together
from gearpoly.report.compare_report import _entry_lines


@pytest.mark.parametrize(
    ("numbers", "words"),
    [([0], "0"), ([0, 1], "0 and 1"), ([0, 1, 2], "0 to 2"), ([0, 2, 3, 4, 9], "0, 2 to 4, 9")],
)
def test_rising_numbers_are_ranges(numbers: list[int], words: str) -> None:
    assert ranges(numbers) == words


def test_the_same_of_many_recordings_is_one_sentence() -> None:
    said = [f"recording {k}: no torque is stated, the 5 N.m are taken" for k in range(4)]
    assert together(["first", *said, "last"]) == [
        "first", "recordings 0 to 3: no torque is stated, the 5 N.m are taken", "last"
    ]  # fmt: skip


def test_other_numbers_are_told_once_and_counted() -> None:
    turns = [1.67, 1.67, 1.68, 1.67]
    told = together(f"recording {k}: {turn} driving turns" for k, turn in enumerate(turns))
    assert told == ["recordings 0 and 1, 3: 1.67 driving turns (and so recording 2, with other numbers)"]


def test_what_is_said_of_several_stretches_of_a_recording_names_it_once() -> None:
    said = [f"recording {k}: {count} samples left out" for k, count in ((0, 461), (0, 461), (1, 12), (1, 13), (2, 14))]
    assert together(said) == ["recording 0: 461 samples left out (and so recordings 1 and 2, with other numbers)"]


def test_two_recordings_and_other_words_stay_as_they_are() -> None:
    said = ["recording 0: a gap", "recording 1: a gap", "recording 2: a stop", "recording 0 reads both: rounding"]
    assert together(said) == said


def wave(order: float, size_um: float, recording: int, *, beside: str | None = None) -> Entry:
    return Entry(
        kind="shaft_order", gear="driving", order=order, amplitude_um=size_um, std_um=0.01, p_value=1e-9,
        recordings=(recording,), companion_of=beside,
    )  # fmt: skip


def test_the_same_wave_of_two_recordings_is_told_with_their_numbers() -> None:
    lines = _entry_lines((wave(3.0, 1.0, 0), wave(3.0, 1.2, 1), wave(4.0, 0.5, 0)), None)
    assert [line.endswith(f"(recording {k})") for k, line in enumerate(lines)] == [True, True, False]


def test_of_many_companions_eight_are_named() -> None:
    many = tuple(wave(30.0 + k, 0.05, 0, beside="driving tooth 7") for k in range(20))
    (line,) = _entry_lines(many, None)
    assert line.startswith("With driving tooth 7 come 20 weaker ones: order 30 of the driving shaft, ")
    assert line.endswith("order 37 of the driving shaft and 12 more")
