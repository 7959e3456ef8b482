"""What changes nothing about the gears changes no name: order and length of the files, their first sample, their
rate."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from gearpoly.files.models import PairFile
from gearpoly.recording.recording import Recording
from tests.knowledge.rigs import COAST, UNLOADED, hidden, inspected, record
from tests.knowledge.verdicts import Verdict, verdict

pytestmark = pytest.mark.slow


def cut(one: Recording, first: int, last: int | None = None) -> Recording:
    """The samples of a recording from one on, up to another."""
    arrays = {f.name: getattr(one, f.name) for f in fields(one) if isinstance(getattr(one, f.name), np.ndarray)}
    return replace(one, **{name: values[first:last] for name, values in arrays.items()})


def names(found: Verdict) -> set[tuple[str, str | None, int | None]]:
    return {(one["physics"], one.get("gear"), one.get("tooth")) for one in found.missing}


@pytest.fixture(scope="module")
def known() -> PairFile:
    return inspected()


@pytest.fixture(scope="module")
def true(known: PairFile) -> PairFile:
    """A tooth 4 um behind, and a driven gear 5 um off its axis."""
    off = hidden(known, "eccentricity", (3.0, 4.0), gear=1)
    return hidden(off, "tooth_pitch", (-4.0,), gear=0, tooth=3, flank="drive")


TRUE = {("eccentricity", "driven", None), ("tooth_pitch", "driving", 3)}


def test_files_in_another_order_have_the_same_names(known: PairFile, true: PairFile) -> None:
    both = record(true, UNLOADED, COAST)
    assert names(verdict(known, both)) == names(verdict(known, both[::-1])) == TRUE


@pytest.mark.parametrize("first", [0, 5, 11])
def test_the_first_sample_changes_no_name(known: PairFile, true: PairFile, first: int) -> None:
    """12 samples a mesh: from other places of the pitch on."""
    both = [cut(one, first) for one in record(true, UNLOADED, COAST)]
    assert names(verdict(known, both)) == TRUE


def test_more_samples_change_no_name(known: PairFile, true: PairFile) -> None:
    assert names(verdict(known, record(true, UNLOADED, COAST, per_mesh=31))) == TRUE


@pytest.mark.parametrize("half", [0, 1])
def test_half_a_recording_has_no_name_that_the_whole_denies(known: PairFile, true: PairFile, half: int) -> None:
    both = record(true, UNLOADED, COAST, cycles=4.0)
    middle = both[0].size // 2
    parts = [cut(one, 0, middle) if half == 0 else cut(one, middle) for one in both]
    assert names(verdict(known, parts)) <= TRUE
