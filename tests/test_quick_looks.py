"""What saves time in reading changes nothing in what is read: each quick look against the long way."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly.errors import InputFileError
from gearpoly.recording import spikes
from gearpoly.recording.arrow import doubles
from gearpoly.recording.read import read_recording
from gearpoly.recording.reversals import BACKWARD_LIMIT, reversals, turned_back
from gearpoly.recording.sense import pauses_between, turns_one_way, without_wraps
from gearpoly.recording.spikes import single_spikes
from gearpoly.recording.text import parsed
from gearpoly.recording.unwrapping import continuous
from gearpoly.units import TURN
from tests.made_readings import needs
from tests.made_texts import GERMAN, own, run, table, written


def angle(seed: int, *, turns_round: bool, noise: float, wild: int) -> np.ndarray:
    """A shaft of 3 deg a sample, with noise in steps, some spikes, and perhaps a way back."""
    rng = np.random.default_rng(seed)
    step = np.full(400, 0.05)
    if turns_round:
        step[200 + seed % 100 :] *= -1.0
    out = np.cumsum(step) + 0.05 * noise * rng.standard_normal(400)
    out[rng.integers(0, 400, wild)] += rng.choice([-1.0, 1.0], wild)
    return out


CASES = [
    (seed, back, noise, wild)
    for seed in range(12)
    for back in (False, True)
    for noise in (0.0, 0.1, 3.0)
    for wild in (0, 2)
]


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize(("seed", "back", "noise", "wild"), CASES)
def test_spikes_are_the_same_without_the_quick_look(
    monkeypatch: pytest.MonkeyPatch, seed: int, back: bool, noise: float, wild: int, moving: bool
) -> None:
    x = angle(seed, turns_round=back, noise=noise, wild=wild)
    quick = single_spikes(x, moving=moving)
    monkeypatch.setattr(spikes, "_may_hold_spikes", lambda x, *, moving: True)
    np.testing.assert_array_equal(quick, single_spikes(x, moving=moving))
    if noise == 0.0 and wild:
        assert quick.any()  # so that both ways are gone


@pytest.mark.parametrize("size", [2.0, 4.0, 20.0])
def test_a_spike_of_a_few_steps_is_no_reversal(size: float) -> None:
    """Beside two steps of motion to either side it is neither quiet nor large, and a shaft does not turn round for it;
    a reading that comes one step late is no spike, nor is a turn back."""
    rng = np.random.default_rng(3)
    x = np.arange(400) * 0.05 + 1e-4 * rng.standard_normal(400)
    late, back = x.copy(), x.copy()
    x[150] += size * 0.05
    assert np.flatnonzero(single_spikes(x, moving=True)).tolist() == [150]
    late[150::10] = late[149::10][: late[150::10].size]
    assert not single_spikes(late, moving=True).any()
    back[200:] = back[200] - 0.4 * (back[200:] - back[200])
    assert not single_spikes(back, moving=True).any()


def test_a_spike_at_either_end_is_seen() -> None:
    for at in (0, 1, 398, 399):
        x = angle(0, turns_round=False, noise=0.0, wild=0)
        x[at] += 3.0
        assert single_spikes(x)[at] == (at in (0, 399))  # beside an end the reflected neighbour is the sample itself


@pytest.mark.parametrize(("seed", "back", "noise", "wild"), CASES)
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_shaft_that_turns_one_way_is_told_at_once(seed: int, back: bool, noise: float, wild: int, way: float) -> None:
    whole = way * angle(seed, turns_round=back, noise=noise, wild=wild)
    for reading in (whole, np.mod(whole, TURN)):
        long, _ = without_wraps(reading, pauses_between(None, np.arange(reading.size)))
        steps = np.diff(long)
        one_way = bool(np.all(steps >= 0.0) or np.all(steps <= 0.0))
        assert turns_one_way(None, reading, whole) == one_way
        assert (turned_back(long) == 0.0) == one_way
        if turned_back(long) <= BACKWARD_LIMIT:
            assert reversals(long) == []
    gap = np.arange(400.0)
    gap[100:] += 10.0
    assert not turns_one_way(gap, np.mod(whole, TURN), whole)
    missing = whole.copy()
    missing[7] = np.nan
    assert not turns_one_way(None, whole, missing) and not turns_one_way(None, missing, whole)


@given(seed=st.integers(0, 10_000), drops=st.integers(0, 50), way=st.sampled_from([1.0, -1.0]))
@settings(max_examples=50, deadline=None)
def test_an_angle_gets_its_turns_back(seed: int, drops: int, way: float) -> None:
    rng = np.random.default_rng(seed)
    whole = way * np.cumsum(rng.uniform(0.5, 1.0, 300))
    rows = np.setdiff1d(np.arange(300), rng.integers(1, 299, drops))
    found = continuous(np.mod(whole, TURN)[rows], rows.astype(np.float64), rows)
    # Turns come back by whole numbers, so the way from the first sample on does to double precision.
    held = np.ones(rows.size, dtype=np.bool_) if drops == 0 else np.diff(rows, prepend=rows[0] - 1) == 1
    step = np.diff(found.angle)[held[1:]]
    np.testing.assert_allclose(step, np.diff(whole[rows])[held[1:]], rtol=0.0, atol=1e-10)


@needs("pyarrow")
@pytest.mark.parametrize("piece", [64, 10**6])
def test_large_texts_are_read_bit_by_bit_as_small_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, piece: int
) -> None:
    held = {**run(900), "torque_nm": np.random.default_rng(0).normal(25.0, 1.0, 900)}
    dropped = {**held, "driven_angle_deg": np.where(np.arange(900) % 100 == 3, np.nan, held["driven_angle_deg"])}
    files = [
        written(tmp_path, own(held), name="own.csv"),
        written(tmp_path, own(dropped).replace("nan", ""), name="empty.csv"),
        written(tmp_path, own(held).replace("\n", "\r\n"), name="windows.csv"),
        written(tmp_path, table(list(held.values()), GERMAN), name="german.csv"),
    ]
    small = [read_recording(file) for file in files]
    monkeypatch.setattr(parsed, "LARGE_BYTES", 0)
    monkeypatch.setattr("gearpoly.recording.text.foreign.PLAIN_CELLS", piece)
    asked = []
    real = parsed.doubles
    monkeypatch.setattr(parsed, "doubles", lambda column: asked.append(1) or real(column))
    for file, one in zip(files, small, strict=True):
        asked.clear()
        other = read_recording(file)
        assert asked, "not read by pyarrow"
        for name in ("time_s", "driving_angle_rad", "driven_angle_rad", "torque_samples_nm"):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name))


@pytest.mark.parametrize(
    ("bad", "says"),
    [
        ("1.0,2.0", "line 9: 2 cells"),
        ("1.0,2.0,x,4.0", 'line 9, column driven_angle_deg: "x"'),
        ("1.0,2.0,inf,4.0", '"inf"'),
        ("# torque_nm = 2.0", "the comment"),
        ("1.0,2.0,1_0,4.0", '"1_0"'),
    ],
)
def test_faults_of_large_texts_are_told_as_those_of_small_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, bad: str, says: str
) -> None:
    lines = own(run(50)).splitlines()
    at = next(k for k, line in enumerate(lines) if line[0].isdigit())
    file = written(tmp_path, "\n".join([*lines[:8], bad, *lines[8:]]) + "\n", name="own.csv")
    assert at < 8
    found = []
    for least in (2**22, 0):
        monkeypatch.setattr(parsed, "LARGE_BYTES", least)
        with pytest.raises(InputFileError) as caught:
            read_recording(file)
        found.append(str(caught.value))
    assert found[0] == found[1] and says in found[0]


def test_columns_of_arrow_keep_their_gaps() -> None:
    arrow = pytest.importorskip("pyarrow")
    chunks = [
        arrow.array([1.0, None, 3.0, 4.0] * 5).slice(3, 11),
        arrow.array([], type=arrow.float64()),
        arrow.array([5.0]),
    ]
    column = arrow.chunked_array(chunks)
    np.testing.assert_array_equal(doubles(column), [np.nan if one is None else one for one in column.to_pylist()])
    assert doubles(arrow.chunked_array([[1, 2]])) is None


@pytest.mark.long
def test_reading_a_table_imports_nothing_that_it_does_not_need(tmp_path: Path) -> None:
    """Each of these takes longer than the numbers of most files."""
    file = written(tmp_path, own(run(200)), name="own.csv")
    code = (
        "import sys; from gearpoly.recording.survey import survey; survey(__import__('pathlib').Path(sys.argv[1])); "
        "print([one for one in ('scipy', 'pandas', 'pydantic', 'pyarrow', 'h5py', 'shapely') if one in sys.modules])"
    )
    ran = subprocess.run([sys.executable, "-c", code, str(file)], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"
