"""Raw encoder channels: known rotations are encoded, spoiled in known ways, and must come back."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.pulses import check_index, find_edges, find_levels, pulses, quadrature, unwrap_counter
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from tests import recording_files as files

FloatArray = npt.NDArray[np.float64]

TURN = 2.0 * math.pi
RATIO = 18.0 / 25.0
RATE = 50_000.0


def rotation(seconds: float = 4.0, turns_per_s: float = 0.8) -> tuple[FloatArray, FloatArray]:
    """Times and a driving rotation with a speed that wobbles by 5 %."""
    t = np.arange(int(seconds * RATE)) / RATE
    return t, TURN * turns_per_s * (t + 0.05 / (TURN * 3.0) * np.sin(TURN * 3.0 * t)) + 0.3


def square(phase: FloatArray, *, low: float = 0.2, high: float = 4.8) -> FloatArray:
    return np.where(np.mod(phase, TURN) < math.pi, high, low)


def sine(phase: FloatArray) -> FloatArray:
    return 2.5 + np.sin(phase)


def index_pulse(theta: FloatArray, lines: int, *, low: float = 0.2, high: float = 4.8) -> FloatArray:
    """High for one line at the beginning of every turn, as encoders have it."""
    return np.where(np.mod(theta, TURN) < TURN / lines, high, low)


def shaft(
    name: str, theta: FloatArray, lines: int, *, analogue: bool = False, index: bool = True
) -> dict[str, FloatArray]:
    wave = sine if analogue else square
    held = {f"{name}_a": wave(lines * theta), f"{name}_b": wave(lines * theta - 0.5 * math.pi)}
    return held | ({f"{name}_index": index_pulse(theta, lines)} if index else {})


def keys(driving: int, driven: int) -> dict[str, object]:
    return {"driving_lines": driving, "driven_lines": driven}


def read(folder: Path, columns: files.Columns, stated: files.Keys) -> Recording:
    file = folder / "raw.mat"
    files.write_mat5(file, columns, stated, packed=False)
    return read_recording(file)


def refusal(folder: Path, columns: files.Columns, stated: files.Keys) -> InputFileError:
    with pytest.raises(InputFileError) as caught:
        read(folder, columns, stated)
    assert caught.value.wish.startswith("want ")
    return caught.value


def angles(recording: Recording) -> tuple[FloatArray, FloatArray, FloatArray]:
    assert recording.time_s is not None
    assert recording.driving_angle_rad is not None
    assert recording.driven_angle_rad is not None
    return recording.time_s, recording.driving_angle_rad, recording.driven_angle_rad


def same_but_for_turns(got: FloatArray, want: FloatArray, tolerance: float) -> None:
    """Equal up to whole turns, one number for all samples."""
    off = got - want
    assert np.max(np.abs(off - TURN * np.rint(off[0] / TURN))) < tolerance


def said(recording: Recording, *words: str) -> str:
    found = [remark for remark in recording.remarks if all(word in remark for word in words)]
    assert found, (words, recording.remarks)
    return found[0]


@pytest.mark.long
@pytest.mark.parametrize("analogue", [False, True])
@pytest.mark.parametrize("file_format", ["csv", "parquet"])
def test_quadrature_gives_the_rotation_back(tmp_path: Path, analogue: bool, file_format: str) -> None:
    t, theta = rotation(2.6)
    lines = (256, 180)
    columns = {"time_s": t, **shaft("driving", theta, lines[0], analogue=analogue)}
    columns |= shaft("driven", RATIO * theta, lines[1], analogue=analogue)
    file = tmp_path / f"raw.{file_format}"
    if file_format == "csv":
        columns = {name: np.round(values[::2], 6) for name, values in columns.items()}
        files.write_csv(file, columns, keys(*lines))
    else:
        pytest.importorskip("pyarrow")
        files.write_parquet(file, columns, keys(*lines))
    step = 2.0 / RATE if file_format == "csv" else 1.0 / RATE
    got_t, theta_1, theta_2 = angles(read_recording(file))
    truth = np.interp(got_t, t, theta)
    # Square waves place an edge to half a sample, at 0.84 turns a second; sines within the curvature of a sample.
    tolerance = 0.55 * step * TURN * 0.84 if not analogue else 2e-6
    # The index itself is placed to as much, and shifts all.
    same_but_for_turns(theta_1, truth, 2.2 * tolerance if not analogue else 0.55 * step * TURN * 0.84 + 2e-5)
    same_but_for_turns(theta_2, RATIO * truth, 2.2 * tolerance if not analogue else 0.55 * step * TURN * 0.84 + 2e-5)
    if analogue:
        # The shape is free of the index; what is left is the straight line between edges 1/1024 of a turn apart.
        for got, want in ((theta_1, truth), (theta_2, RATIO * truth)):
            assert np.ptp(got - want) < 2e-5


def test_common_times_are_the_coarser_shafts_own_edges(tmp_path: Path) -> None:
    t, theta = rotation(1.5)
    for lines, base in (((1000, 100), "driven"), ((60, 1000), "driving")):
        columns = {"time_s": t} | shaft("driving", theta, lines[0], analogue=True, index=False)
        columns |= shaft("driven", RATIO * theta, lines[1], analogue=True, index=False)
        recording = read(tmp_path, columns, keys(*lines))
        _, theta_1, theta_2 = angles(recording)
        own, count = (theta_2, lines[1]) if base == "driven" else (theta_1, lines[0])
        steps = np.diff(own) * 4 * count / TURN
        # Every edge of the coarser shaft is there, none moved: a step is one count, to the rounding of the products.
        np.testing.assert_allclose(steps, 1.0, rtol=0.0, atol=1e-9)
        turned = (theta[-1] - theta[0]) * (RATIO if base == "driven" else 1.0)
        assert abs(own.size - turned * 4 * count / TURN) <= 4  # those before the other shaft's first edge are left out
        said(recording, "has the fewest readings", f"{base}_angle_deg")
        said(recording, "no index")


def test_reversed_encoder_counts_down(tmp_path: Path) -> None:
    t, theta = rotation(4.0)
    columns = {"time_s": t} | shaft("driving", -theta, 256) | shaft("driven", RATIO * theta, 180)
    recording = read(tmp_path, columns, keys(256, 180) | {"driving_direction": -1})
    got_t, theta_1, theta_2 = angles(recording)
    truth = np.interp(got_t, t, theta)
    tolerance = 1.2 * TURN * 0.84 / RATE  # an edge and the index, each to half a sample
    same_but_for_turns(theta_1, -truth, tolerance)
    same_but_for_turns(theta_2, RATIO * truth, tolerance)
    assert recording.driving_direction == -1
    said(recording, "driving_index", "2 turns checked, 0 with lost counts")


@pytest.mark.parametrize("seed", range(3))
def test_noise_and_a_bouncing_start(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    t, theta = rotation(2.6)
    still = int(0.2 * RATE)
    theta = np.concatenate([np.full(still, theta[0]), theta])
    theta[:still] += 2e-4 * rng.standard_normal(still)  # trembling on the spot, across an edge
    t = np.arange(theta.size) / RATE
    columns = {"time_s": t} | shaft("driving", theta, 256) | shaft("driven", RATIO * theta, 180)
    for name in columns:
        if name != "time_s":
            columns[name] = columns[name] + 0.2 * rng.standard_normal(t.size)  # the dead band is 0.9 V to each side
    recording = read(tmp_path, columns, keys(256, 180))
    got_t, theta_1, theta_2 = angles(recording)
    truth = np.interp(got_t, t, theta)
    tolerance = (
        1.2 * TURN * 0.84 / RATE + 1.5e-3
    )  # while it trembles, an edge is passed at up to 4 sigma from its place
    same_but_for_turns(theta_1, truth, tolerance)
    same_but_for_turns(theta_2, RATIO * truth, tolerance)


def test_levels_are_found_and_stated(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    t, theta = rotation(2.6)
    for wave, low, high in [
        (square(100 * theta, low=-3.0, high=7.0) + 0.1 * rng.standard_normal(t.size), -3.0, 7.0),
        (index_pulse(theta, 500, low=1.0, high=2.0), 1.0, 2.0),
        (square(100 * theta, low=0.0, high=1.0), 0.0, 1.0),
    ]:
        found = find_levels(wave)
        # The median of 25 000 samples with 0.1 of noise errs by 0.001; the rare pulse has fewer, without noise.
        assert found == (pytest.approx(low, abs=5e-3), pytest.approx(high, abs=5e-3))
    assert find_levels(np.full(9, 2.0)) == (2.0, 2.0)
    assert find_edges(np.full(9, 2.0), np.arange(9.0)).sample.size == 0
    columns = {"time_s": t} | shaft("driving", theta, 64, index=False) | shaft("driven", RATIO * theta, 64, index=False)
    recording = read(tmp_path, columns, keys(64, 64))
    said(recording, "driving_a: levels 0.2 and 4.8 found", "threshold 2.5 +- 0.92", "100% of them within one sample")


def test_slow_edges_are_interpolated() -> None:
    # A ramp from 0 to 1 V over ten samples crosses the middle where a straight line says so.
    x = np.concatenate([np.zeros(20), np.linspace(0.0, 1.0, 11), np.ones(20)])
    t = 0.1 * np.arange(x.size)
    edges = find_edges(x, t)
    assert edges.rising.tolist() == [True]
    assert edges.time[0] == pytest.approx(2.5, abs=1e-12)  # rounding only
    assert edges.sharp == 0.0
    back = find_edges(1.0 - x, t)
    assert back.rising.tolist() == [False]
    assert back.time[0] == pytest.approx(2.5, abs=1e-12)
    # A bounce inside the dead band is no edge of its own, and the last crossing counts.
    x[24], x[26] = 0.6, 0.45
    bounced = find_edges(x, t)
    assert bounced.rising.tolist() == [True]
    assert 2.6 <= bounced.time[0] <= 2.7


def quadrature_states(states: list[int]) -> tuple[FloatArray, FloatArray]:
    """Both channels for phases 0 to 3 of the cycle, three samples each."""
    phase = np.repeat(states, 3)
    return np.isin(phase, (1, 2)).astype(np.float64), np.isin(phase, (2, 3)).astype(np.float64)


def decode(states: list[int]) -> tuple[list[float], int, int]:
    a, b = quadrature_states(states)
    t = np.arange(a.size, dtype=np.float64)
    got = quadrature(find_edges(a, t), find_edges(b, t))
    return got.count.tolist(), got.illegal.size, got.against.size


def test_the_cycle_of_four_states() -> None:
    assert decode([0, 1, 2, 3, 0, 1]) == ([1.0, 2.0, 3.0, 4.0, 5.0], 0, 0)
    assert decode([0, 3, 2, 1, 0, 3]) == ([0.0, -1.0, -2.0, -3.0, -4.0], 0, 0)
    # There and back over the same edge reads the same place twice.
    assert decode([0, 1, 2, 3, 2, 3, 0, 1]) == ([1.0, 2.0, 3.0, 3.0, 3.0, 4.0, 5.0], 0, 1)
    # Both channels at once: two counts onward, one illegal transition.
    assert decode([0, 1, 3, 0, 1]) == ([1.0, 3.0, 4.0, 5.0], 1, 0)
    assert decode([2, 1, 3, 2, 1]) == ([0.0, -2.0, -3.0, -4.0], 1, 0)


def test_illegal_transitions_are_told_and_bridged(tmp_path: Path) -> None:
    t, theta = rotation(3.2)
    columns = {"time_s": t} | shaft("driving", theta, 256) | shaft("driven", RATIO * theta, 180)
    # Both channels held for the time of one edge: two edges fall into one sample.
    held = find_edges(columns["driving_a"], t).sample[400]
    edges = np.sort(np.concatenate([find_edges(columns[f"driving_{c}"], t).sample for c in "ab"]))
    at = int(np.searchsorted(edges, held))
    for channel in ("driving_a", "driving_b"):
        columns[channel][edges[at] : edges[at + 1]] = columns[channel][edges[at] - 1]
    recording = read(tmp_path, columns, keys(256, 180))
    remark = said(recording, "driving: 1 illegal transitions")
    assert f"row {edges[at + 1] + 1} " in remark
    said(recording, "driving_index", "0 with lost counts")
    got_t, theta_1, _ = angles(recording)
    same_but_for_turns(theta_1, np.interp(got_t, t, theta), 2.2 * TURN / 1024)  # one reading waited for two counts


def test_lost_pulses_are_found_by_the_index(tmp_path: Path) -> None:
    t, theta = rotation(6.0)
    columns = {"time_s": t} | shaft("driving", theta, 256) | shaft("driven", RATIO * theta, 180)
    a = find_edges(columns["driving_a"], t)
    lost = int(np.searchsorted(a.time, 2.0))
    lost += not a.rising[lost]
    columns["driving_a"][a.sample[lost] : a.sample[lost + 1]] = 0.2  # one pulse of A gone: four counts
    recording = read(tmp_path, columns, keys(256, 180))
    remark = said(recording, "driving: 4 counts lost between")
    begin, end = (float(part.split(";")[0]) for part in remark.split("between ")[1].split(" and "))
    assert begin < 2.0 < end
    assert end - begin == pytest.approx(1.0 / 0.8, rel=0.06)  # a turn; the speed wobbles by 5 %
    said(recording, "driving_index", "1 with lost counts")
    said(recording, "driving", "steps against the run")
    got_t, theta_1, theta_2 = angles(recording)
    gap = np.isnan(theta_1)
    assert gap.any()
    # Readings between a good and a missing one of the driving shaft, 1.3 ms apart, are missing too.
    assert got_t[gap].min() >= begin - 2e-3
    assert got_t[gap].max() <= end + 2e-3
    assert not np.isnan(theta_2).any()
    truth = np.interp(got_t, t, theta)
    # Right again after the turn: no four counts (0.025 rad) are missing.
    same_but_for_turns(theta_1[~gap], truth[~gap], 1.2 * TURN * 0.84 / RATE)


@pytest.mark.long
def test_a_wrong_line_count_is_refused(tmp_path: Path) -> None:
    t, theta = rotation(7.0)  # four turns of the driven shaft
    columns = {"time_s": t} | shaft("driving", theta, 256) | shaft("driven", RATIO * theta, 180)
    error = refusal(tmp_path, columns, keys(250, 180))
    assert error.where == "column driving_index"
    assert "1024 counts from index to index" in error.found
    assert "1000 by driving_lines" in error.found
    assert "perhaps 256" in error.wish
    assert "perhaps 180" in refusal(tmp_path, columns, keys(256, 90)).wish


def test_spurious_and_missing_index_pulses() -> None:
    per_turn = 1000.0
    time = np.arange(1, 10_001) * 1e-3
    count = np.arange(1.0, 10_001.0)
    index = np.array([0.5, 1.5, 1.9, 2.5, 4.5, 5.5, 6.5, 7.5])  # one at 1.9 too many, the one at 3.5 missing
    check = check_index(time, count, index, per_turn)
    assert check.ignored == (1.9,)
    assert check.lost == ()
    assert check.turns == 7
    assert check.always == 0
    np.testing.assert_allclose(check.count, count - 500.0, rtol=0.0, atol=1e-9)  # rounding
    # Five counts too many in one turn, in both directions of counting.
    for sign in (1.0, -1.0):
        jumped = sign * (count + np.where(time > 5.0, 5.0, 0.0))
        check = check_index(time, jumped, index[3:], per_turn)
        assert check.lost == ((4.5, 5.5, -5),)
        after = time >= 5.6
        np.testing.assert_allclose(check.count[after], sign * (count[after] - 2500.0), rtol=0.0, atol=1e-9)
        assert np.isnan(check.count[(time > 4.6) & (time < 5.4)]).all()


def test_single_pulses(tmp_path: Path) -> None:
    t, theta = rotation(3.0)
    columns = {"time_s": t, "driving_a": sine(60 * theta), "driven_a": sine(60 * RATIO * theta)}
    recording = read(tmp_path, columns, keys(60, 60))
    got_t, theta_1, theta_2 = angles(recording)
    truth = np.interp(got_t, t, theta)
    sagitta = 2.0 / 48.0**2 / 8.0 * (TURN * 0.8 * 0.05 * TURN * 3.0)
    for got, want in ((theta_1, truth), (theta_2, RATIO * truth)):
        # A straight line between pulses 1/48 s apart errs by h^2/8 times the acceleration, to either side.
        assert np.ptp(got - want) < 1.1 * sagitta
    assert np.all(np.diff(theta_1) > 0.0)
    said(recording, "driving: pulses, direction unseen")
    # Lost pulses show by their time.
    edges = find_edges(columns["driving_a"], t)
    rise = np.flatnonzero(edges.rising)
    for gone, number in ((40, 1), (90, 2)):
        begin, end = edges.sample[rise[gone]] - 200, edges.sample[rise[gone + number - 1]] + 700
        columns["driving_a"][begin:end] = 1.5
    recording = read(tmp_path, columns, keys(60, 60))
    said(recording, "driving: 3 pulses lost by their time")
    got_t, theta_1, _ = angles(recording)
    # The straight line now spans three intervals; a lost pulse that is not counted on would leave 0.1 rad.
    assert np.ptp(theta_1 - np.interp(got_t, t, theta)) < 9.0 * sagitta
    # One pulse too many is told, not judged.
    extra = edges.sample[rise[20]] + 700  # while the wave is low
    columns["driving_a"][extra : extra + 20] = 3.5
    said(read(tmp_path, columns, keys(60, 60)), "too early, at row")


def test_pulses_in_a_run_up_are_not_lost() -> None:
    t = np.arange(0.0, 4.0, 1e-4)
    theta = 0.5 * TURN * t * t  # from standstill: every interval is shorter than the one before
    got = pulses(find_edges(sine(60 * theta), t))
    assert got.lost == ()
    assert got.count.tolist() == list(np.arange(1.0, got.count.size + 1.0))


@pytest.mark.parametrize("bits", [12, 16])
@pytest.mark.parametrize("direction", [1, -1])
def test_counters_that_wrap(tmp_path: Path, bits: int, direction: int) -> None:
    t, theta = rotation(6.0)
    t, theta = t[::20], theta[::20]
    count_1 = np.floor(direction * theta * 4096.0 / TURN) + (2**16 - 5000 if direction > 0 else 5000)
    count_2 = np.floor(RATIO * theta * 20000.0 / TURN) + 60000.0
    columns = {"time_s": t, "driving_count": count_1 % 2**bits, "driven_count": count_2 % 2**16}
    stated: dict[str, object] = {
        "driving_lines": 1024, "driving_counts_per_line": 4, "driving_count_bits": bits, "driving_direction": direction,
        "driven_lines": 10000, "driven_counts_per_line": 2, "driven_count_bits": 16,
    }  # fmt: skip
    recording = read(tmp_path, columns, stated)
    got_t, theta_1, theta_2 = angles(recording)
    np.testing.assert_array_equal(got_t, t)  # both counters are read at the samples, so nothing is interpolated
    # A counter tells the last count passed, and the reading begins at 0: two counts at most.
    assert np.ptp(direction * theta_1 - theta) < 1.001 * TURN / 4096
    assert np.ptp(theta_2 - RATIO * theta) < 1.001 * TURN / 20000
    # Without the width its jumps tell the same, and a remark says so.
    without = {key: value for key, value in stated.items() if key != "driving_count_bits"}
    again = read(tmp_path, columns, without)
    np.testing.assert_array_equal(angles(again)[1], theta_1)
    assert any(f"state driving_count_modulus = {2**bits}" in one for one in again.remarks)


def test_counters_with_an_index_and_drop_outs(tmp_path: Path) -> None:
    t, theta = rotation(6.0)
    t, theta = t[::10], theta[::10]
    count = np.floor(theta * 4096.0 / TURN)
    count[900:950] = math.nan
    columns = {"time_s": t, "driving_count": count, "driving_index": index_pulse(theta, 256)}
    columns["driven_angle_deg"] = np.degrees(RATIO * theta)
    recording = read(tmp_path, columns, {"driving_lines": 1024, "driving_counts_per_line": 4})
    got_t, theta_1, theta_2 = angles(recording)
    np.testing.assert_array_equal(got_t, t)
    good = ~np.isnan(theta_1)
    assert int(np.sum(~good)) == 50
    # One count, and the index to half a sample of 0.2 ms.
    same_but_for_turns(theta_1[good], theta[good], 1.1 * TURN / 4096 + 1.1e-4 * TURN * 0.84)
    # To degrees and back: two roundings.
    np.testing.assert_allclose(theta_2, RATIO * theta, rtol=5e-16, atol=0.0)
    assert "driven: " not in "".join(recording.remarks)


@pytest.mark.parametrize("stated", [False, True])
@pytest.mark.parametrize("down", [False, True])
def test_a_counter_that_begins_anywhere_and_is_set_by_the_index(tmp_path: Path, down: bool, stated: bool) -> None:
    """The readings before the first index are left out; those after it are what the shaft turned."""
    t, theta = rotation(6.0)
    t, theta = t[::100], theta[::100]
    whole = np.floor(theta * 4096.0 / TURN)
    index, begins = 700.0, 1234.0
    set_ = whole >= index
    count = np.where(set_, np.mod(whole - index, 4096.0), whole + begins)
    count = -count if down else count
    columns = {"time_s": t, "driving_count": count, "driven_angle_deg": np.degrees(RATIO * theta)}
    condition: dict[str, object] = {"driving_lines": 1024, "driving_counts_per_line": 4}
    condition |= {"driving_direction": -1} if down else {}
    recording = read(tmp_path, columns, condition | ({"driving_count_modulus": 4096} if stated else {}))
    _, theta_1, _ = angles(recording)
    good = np.isfinite(theta_1)
    np.testing.assert_array_equal(good, set_)
    turned = (whole - whole[set_][0])[set_] * (TURN / 4096.0) * (-1.0 if down else 1.0)
    np.testing.assert_allclose(theta_1[good] - theta_1[good][0], turned, rtol=0.0, atol=1e-9)
    row = int(np.argmax(set_)) + 1
    assert any(f"set to 0 by the index in row {row} for the first time" in one for one in recording.remarks)


def test_unwrap_counter_knows_both_ways() -> None:
    up = np.array([250.0, 254.0, 2.0, math.nan, 10.0])
    got = unwrap_counter(up, 256.0)
    np.testing.assert_array_equal(got[[0, 1, 2, 4]], [250.0, 254.0, 258.0, 266.0])
    assert math.isnan(got[3])
    np.testing.assert_array_equal(unwrap_counter(up[[4, 2, 1, 0]], 256.0), [10.0, 2.0, -2.0, -6.0])


def test_mixed_sources_torque_and_sample_rate(tmp_path: Path) -> None:
    t, theta = rotation(3.0)
    columns = shaft("driving", theta, 100, analogue=True) | {
        "driven_angle_deg": np.degrees(RATIO * theta) % 360.0 * 0.0 + np.degrees(RATIO * theta),
        "torque_nm": 20.0 + t,
    }
    recording = read(tmp_path, columns, {"driving_lines": 100, "sample_rate_hz": RATE})
    got_t, theta_1, theta_2 = angles(recording)
    truth = np.interp(got_t, t, theta)
    assert np.ptp(theta_1 - truth) < 1e-5  # as in the sines above
    np.testing.assert_allclose(theta_2, RATIO * truth, rtol=0.0, atol=1e-9)  # both are straight between samples
    assert recording.torque_samples_nm is not None
    np.testing.assert_allclose(recording.torque_samples_nm, 20.0 + got_t, rtol=1e-12)  # rounding
    recording = read(tmp_path, columns, {"driving_lines": 100})
    assert recording.time_s is None
    said(recording, "evenly spaced")


def test_bad_raw_channels(tmp_path: Path) -> None:
    t, theta = rotation(1.5)
    good = {"time_s": t} | shaft("driving", theta, 100) | shaft("driven", RATIO * theta, 100)
    assert "driven_lines" in refusal(tmp_path, good, {"driving_lines": 100}).found
    assert "whole number" in refusal(tmp_path, good, {"driving_lines": 100.5, "driven_lines": 100}).wish
    flat = good | {"driven_b": np.full(t.size, 2.0)}
    error = refusal(tmp_path, flat, keys(100, 100))
    assert (error.where, "2 and 2" in error.found) == ("column driven_b", True)
    broken = good | {"driving_a": np.where(np.arange(t.size) == 77, math.nan, good["driving_a"])}
    assert refusal(tmp_path, broken, keys(100, 100)).where == "column driving_a, row 78"
    clock = good | {"time_s": np.where(np.arange(t.size) == 77, 0.0, t)}
    assert refusal(tmp_path, clock, keys(100, 100)).where == "column time_s, row 78"
    lone = {name: values for name, values in good.items() if name != "driven_a"}
    assert "driven_b" in refusal(tmp_path, lone, keys(100, 100)).found
    lone = {name: values for name, values in good.items() if name not in ("driven_a", "driven_b")}
    assert "driven_index alone" in refusal(tmp_path, lone, keys(100, 100)).found
    counts = good | {"driven_count": theta}
    assert "driven_counts_per_line" in refusal(tmp_path, counts, keys(100, 100)).found
    count = {"time_s": t, "driving_count": np.floor(theta * 100), "driven_angle_deg": theta}
    assert "driving_counts_per_line" in refusal(tmp_path, count, {"driving_lines": 100}).found
    bits = {"driving_lines": 100, "driving_counts_per_line": 4, "driving_count_bits": 4}
    fast = count | {"driving_count": (5.0 * np.arange(t.size)) % 16}
    assert "a quarter" in refusal(tmp_path, fast, bits).wish
