"""Encoders that are read at different rates: two ages beside each other make no line, whatever the clocks."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.clean import Cleaned, clean
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray

TURN, RATIO, R_B2, UM, ROW = 2.0 * math.pi, 18.0 / 25.0, 23.49, 1e-3, 1e-3
SPEED = 0.5 * TURN
"""rad/s of the driving shaft: 53 um along the line of action from row to row."""

Clock = Callable[[float, np.random.Generator], FloatArray]


def te_um(theta_1: FloatArray) -> FloatArray:
    return np.asarray(6.0 * np.sin(theta_1) + 1.5 * np.sin(18.0 * theta_1) + 0.4 * np.cos(36.0 * theta_1))


def every(period_ms: float, begin_ms: float = 0.0, *, jitter_ms: float = 0.0, wanders_ms: float = 0.0) -> Clock:
    def instants(end: float, rng: np.random.Generator) -> FloatArray:
        n = np.arange(int(1e3 * end / period_ms) + 3)
        late = jitter_ms * rng.uniform(-1.0, 1.0, n.size) + wanders_ms * np.cumsum(rng.normal(size=n.size))
        return np.asarray(1e-3 * (begin_ms + period_ms * (n - 1) + late))

    return instants


def in_turn(*rows: int) -> Clock:
    """Read at rows that come at these distances, over and over: by the logger's own clock."""

    def instants(end: float, _: np.random.Generator) -> FloatArray:
        steps = np.tile(rows, int(end / ROW / sum(rows)) + 2)
        return np.asarray(ROW * (np.cumsum(steps) - sum(rows)))

    return instants


def recorded(
    driving: Clock | None, driven: Clock | None, *, turns: int = 25, noise_um: float = 0.0, back: bool = False
) -> Recording:
    """Rows of 1 ms with the readings that were last read; the motion sways a little, as every drive's does."""
    rng = np.random.default_rng(7)
    end = turns * TURN / SPEED
    t = ROW * np.arange(round(end / ROW))

    def theta_1(at: FloatArray) -> FloatArray:
        return np.asarray(SPEED * at + 0.002 * np.sin(SPEED * at))

    def theta_2(at: FloatArray) -> FloatArray:
        return np.asarray(RATIO * theta_1(at) + UM / R_B2 * te_um(theta_1(at)))

    columns = []
    for clock, angle in ((driving, theta_1), (driven, theta_2)):
        at = t if clock is None else clock(end, rng)
        read = angle(at) + UM / R_B2 * noise_um * rng.normal(size=at.size)
        held = read if clock is None else read[np.searchsorted(at, t + 1e-9, side="right") - 1]
        columns.append(np.mod(-held if back else held, TURN))
    return Recording(
        source=Path("rig.csv"), time_s=t, driving_angle_rad=columns[0], driven_angle_rad=columns[1], backward=back
    )


def left_um(one: Cleaned) -> FloatArray:
    """What the transmission error has beside the pair's own, in um, less its mean."""
    left = one.te * R_B2 / UM - te_um(one.theta_1)
    return np.asarray(left - left.mean())


def highest_line(values: FloatArray) -> float:
    """The amplitude of the highest line in values (n,)."""
    window = np.hanning(values.size)
    return float(np.max(np.abs(np.fft.rfft(values * window))) * 2.0 / window.sum())


@pytest.mark.parametrize(
    ("driving", "driven"),
    [
        (every(4), every(5)),  # as the logger: untouched it is a line of 76 um
        (every(5), every(4)),
        (every(4, 1), every(5, 3)),
        (every(4.0003, 0.3), every(5.0007, 0.1)),
        (every(3.7, 0.2), every(5.3, 0.1)),
        (every(3.7, 0.2), None),
        (None, every(5.3, 0.2)),
        (every(1.3), every(1.7, 0.2)),
        (every(10), every(16)),
        (in_turn(4, 5), every(7)),
        (in_turn(3, 5, 5), in_turn(4, 5)),
    ],
)
def test_two_rates_leave_no_line(driving: Clock | None, driven: Clock | None) -> None:
    one = clean(recorded(driving, driven), ratio=RATIO)
    assert float(np.std(left_um(one))) < 0.05
    assert highest_line(left_um(one)) < 0.02
    assert "put beside" in {deed.what for deed in one.done}


@pytest.mark.parametrize("back", [False, True])
def test_the_instants_are_the_readings_own(back: bool) -> None:
    """Times are those of the readings, to a thousandth of a row: by them alone the shaft's even motion comes out."""
    one = clean(recorded(every(3.7, 0.2), every(5.3, 0.1), back=back), ratio=RATIO)
    assert one.time_s is not None
    off = one.theta_1 - (SPEED * one.time_s + 0.002 * np.sin(SPEED * one.time_s))
    assert float(np.std(off)) < 1e-2 * SPEED * ROW


def test_clocks_that_tremble_leave_noise_and_no_line() -> None:
    """A tremble of 0.1 and 0.3 ms is 3 and 9 um of path, for which no reading is to blame: it stays, as noise."""
    one = clean(recorded(every(4, 0.2, jitter_ms=0.1), every(5, 0.2, jitter_ms=0.3)), ratio=RATIO)
    left = left_um(one)
    assert float(np.std(left)) == pytest.approx(53.0 * math.hypot(0.1, 0.3) / math.sqrt(3.0), rel=0.2)
    # The highest of n/2 lines of white noise is about sqrt(ln(n/2)) standard errors high, 1.2 by the window.
    assert highest_line(left) < 2.0 * 1.2 * float(np.std(left)) * math.sqrt(2.0 * math.log(left.size) / left.size)


def test_clocks_that_wander_are_followed() -> None:
    """Loops that wait after each of their rounds; a row's doubt would be 22 um rms of two shafts."""
    one = clean(recorded(every(4.1, wanders_ms=0.1), every(5.2, wanders_ms=0.1)), ratio=RATIO)
    assert float(np.std(left_um(one))) < 15.0
    assert highest_line(left_um(one)) < 3.0


def test_a_counter_is_no_clock() -> None:
    """Counts that pass tell when the shaft was where: were their rows made even, its own waves would be gone."""
    t = 1e-4 * np.arange(200_000)
    theta_1 = SPEED * t
    wave = 400.0 * UM / R_B2 * np.sin(theta_1)
    count = TURN / 2000.0
    columns = {"driving_angle_rad": theta_1, "driven_angle_rad": np.floor((RATIO * theta_1 + wave) / count) * count}
    one = clean(Recording(source=Path("rig.csv"), time_s=t, **columns), ratio=RATIO)
    waves = np.column_stack([np.sin(one.theta_1), np.cos(one.theta_1), np.ones(one.size)])
    sizes = np.linalg.lstsq(waves, one.te * R_B2 / UM, rcond=None)[0]
    assert float(np.hypot(sizes[0], sizes[1])) == pytest.approx(400.0, rel=0.01)


def test_counters_of_different_counts_leave_no_beat() -> None:
    """500 and 360 counts at 1000 rows a turn: the driving reading was up to a count old, 63 um at order 18.4."""
    rec = recorded(None, None)
    assert rec.driving_angle_rad is not None and rec.driven_angle_rad is not None
    held = [
        np.floor(x / (TURN / n)) * (TURN / n) for x, n in ((rec.driving_angle_rad, 500), (rec.driven_angle_rad, 360))
    ]
    one = clean(
        Recording(source=rec.source, time_s=rec.time_s, driving_angle_rad=held[0], driven_angle_rad=held[1]),
        ratio=RATIO,
    )
    assert float(np.std(left_um(one))) < 53.0 / math.sqrt(6.0)  # a row of each


def test_gaps_and_wild_readings_stay_out() -> None:
    rec = recorded(every(4), every(5))
    assert rec.driving_angle_rad is not None
    driving = rec.driving_angle_rad.copy()
    driving[5000:5200] = np.nan
    driving[9000:9004] = (driving[9000:9004] + 1.0) % TURN  # one reading, four rows
    one = clean(
        Recording(
            source=rec.source, time_s=rec.time_s, driving_angle_rad=driving, driven_angle_rad=rec.driven_angle_rad
        ),
        ratio=RATIO,
    )
    assert float(np.max(np.abs(left_um(one)))) < 0.5
    assert one.size >= 50_000 // 5 - 200 // 5 - 6


def test_what_lies_between_readings_too_far_apart_is_said() -> None:
    """Driven readings 16 ms apart are 7 a mesh, and the second mesh order has 3.5: what that leaves is no line."""
    one = clean(recorded(every(25), every(16), turns=50), ratio=RATIO)
    rms = float(np.std(left_um(one))) * UM / R_B2
    assert 0.3 * rms < one.doubt < 3.0 * rms
    assert clean(recorded(every(5), every(4)), ratio=RATIO).doubt < 0.01 * one.doubt
    assert any("arcsec rms" in deed.says for deed in one.done)


@pytest.mark.slow
def test_no_line_is_located_of_two_rates(tmp_path: Path) -> None:
    """A pair without deviations, its two encoders read each 4 and 5 rows: as where both are read in each row, only the
    waves are located that the recording has."""
    file = tmp_path / "pair.toml"
    gear = "teeth = {}\nmodule_mm = 2.0\nface_width_mm = 20.0\n"
    file.write_text(
        f"[model]\ntooth_deflection = false\n[driving]\n{gear.format(18)}[driven]\n{gear.format(25)}", encoding="utf-8"
    )
    found = []
    for clocks in ((None, None), (every(4), every(5)), (every(3.7), every(5.3))):
        entries = compare(read_pair(file), [recorded(*clocks, noise_um=0.3)], path=file).located.entries
        found.append({(entry.kind, entry.order) for entry in entries if entry.kind != "mesh_phase"})
    assert found[0] == found[1] == found[2]
    assert ("shaft_order", 1) in found[0]
