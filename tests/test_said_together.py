"""What is said of many recordings alike is said once, with their numbers."""

from __future__ import annotations

import pytest

from gearpoly.report.alike import runs, together


@pytest.mark.parametrize(
    ("numbers", "words"),
    [([0], "0"), ([0, 1], "0 and 1"), ([0, 1, 2], "0 to 2"), ([0, 2, 3, 4, 9], "0, 2 to 4, 9")],
)
def test_rising_numbers_are_ranges(numbers: list[int], words: str) -> None:
    assert runs(numbers) == words


def test_the_same_of_many_recordings_is_one_sentence() -> None:
    said = [f"recording {k}: no torque is stated, the 5 N.m are taken" for k in range(4)]
    assert together(["first", *said, "last"]) == [
        "first", "recordings 0 to 3: no torque is stated, the 5 N.m are taken", "last"
    ]  # fmt: skip


def test_other_numbers_are_told_once_and_counted() -> None:
    turns = [1.67, 1.67, 1.68, 1.67]
    told = together(f"recording {k}: {turn} driving turns" for k, turn in enumerate(turns))
    assert told == ["recordings 0 and 1, 3: 1.67 driving turns (and so recording 2, with other numbers)"]


def test_two_recordings_and_other_words_stay_as_they_are() -> None:
    said = ["recording 0: a gap", "recording 1: a gap", "recording 2: a stop", "recording 0 reads both: rounding"]
    assert together(said) == said
