"""Bending and reliefs that cancel it, recorded at the torque of the design alone, where hardly anything repeats."""

from __future__ import annotations

import pytest

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.files.pairfile import read_pair
from gearpoly.proving.case import Case, make
from gearpoly.proving.entry import CaseEntry
from gearpoly.recording.read import read_recording

pytestmark = pytest.mark.slow

SEED = 3
"""A pair of module 1, the quickest of the first fifteen."""


@pytest.fixture(scope="module")
def case() -> Case:
    entry = CaseEntry(index=0, klass="cancelling", physics=("relief_cancels_deflection",), over=0.0, variant=0)
    return make(SEED, entry)


@pytest.fixture(scope="module")
def found(case: Case, tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    folder = tmp_path_factory.mktemp("alone")
    for name, text in case.files():
        (folder / name).write_text(text)
    pair = folder / "pair.toml"
    recording = folder / f"rec_{len(case.conditions) - 1}.csv"
    return diagnose(read_pair(pair), [read_recording(recording)], path=pair)


def test_all_three_are_named_and_no_pit(found: Diagnosis) -> None:
    """Alone, each makes the recording worse; single steps end with faults of many teeth."""
    named = [(one.claim.physics.name, one.claim.place.gear) for one in found.findings]
    assert sorted(named, key=str) == [("tip_relief", 0), ("tip_relief", 1), ("tooth_deflection", None)]


def test_stated_errors_hold_what_one_torque_leaves_open(case: Case, found: Diagnosis) -> None:
    """Within two of them the bench's own law and reliefs; at least a twentieth, since one torque tells no law."""
    truth = {(one["physics"], one.get("gear")): one for one in case.truth["truth"]}
    checked = 0
    for one in found.findings:
        gear = one.claim.place.gear
        mine = truth[one.claim.physics.name, None if gear is None else gear + 1]
        for name, (value, std) in one.parameters.items():
            if name in mine:
                assert abs(value - mine[name]) < 2.0 * std
                assert std >= 0.05 * abs(value)
                checked += 1
    assert checked == 5
