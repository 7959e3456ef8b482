"""What as-built teeth hold and no gear of their grade has is told; what gears within it have is not."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import f as snedecor
from scipy.stats import norm as normal
from scipy.stats import t as student

from gearpoly.compare.compare import compare
from gearpoly.compare.set_up import GearKnown
from gearpoly.diagnose.as_built import chain
from gearpoly.diagnose.beyond_grade import BEYOND_GRADE_CHANCE, _Held, beyond_grade
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.files.models import PairFile
from tests.pair_files import pair_file
from tests.physics_cases import Condition, recorded

Z = 24
PRIOR = chain(Z, single=7.0, cumulative=26.0)


def held(pitch: np.ndarray[tuple[int, ...], np.dtype[np.float64]], freedom: float = math.inf) -> _Held:
    return _Held(pitch=pitch, known=np.asarray(np.linalg.inv(PRIOR)), freedom=freedom)


def drawn(count: int, seed: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.random.default_rng(seed).multivariate_normal(np.zeros(Z), PRIOR, size=count)


@pytest.mark.long
def test_gears_of_their_grade_have_no_order_and_no_tooth_beyond_it() -> None:
    """The chance is that of any of all orders, or of any tooth: of 400 gears a twentieth at most has one below 0.05,
    to three standard deviations of such a count."""
    most = 0.05 * 400 + 3.0 * math.sqrt(0.05 * 400)
    waves = [min(held(one).chance_of_wave(k) for k in range(1, Z // 2)) for one in drawn(400, 1)]
    teeth = [min(held(one).chance_of_tooth(k) for k in range(Z)) for one in drawn(400, 2)]
    assert sum(one < 0.05 for one in waves) <= most
    assert sum(one < 0.05 for one in teeth) <= most
    # It is no bound that nothing ever reaches: half as many are near it.
    assert sum(one < 0.2 for one in waves) >= 0.5 * 0.2 * 400 - 3.0 * math.sqrt(0.1 * 400)


def test_an_order_or_a_tooth_far_beyond_the_grade_is() -> None:
    angle = 2.0 * np.pi / Z * np.arange(Z)
    within = drawn(1, 3)[0]
    assert held(within + 60.0 * np.cos(3.0 * angle)).chance_of_wave(3) < BEYOND_GRADE_CHANCE
    off = within.copy()
    off[7] += 60.0
    assert held(off).chance_of_tooth(7) < BEYOND_GRADE_CHANCE
    assert held(within).chance_of_tooth(7) > BEYOND_GRADE_CHANCE


@pytest.mark.parametrize("mean", [0.0, -3.0, 40.0])
def test_how_thick_all_teeth_are_says_nothing_of_one(mean: float) -> None:
    """The prior holds the mean of a drive flank to 0, which the thickness moves on the other one. A tooth that is 60 um
    off is so beside its neighbours alone, too, of which single pitches of 7 um leave 3 um open."""
    within = drawn(1, 3)[0]
    plain = within - np.mean(within)
    assert held(plain + mean).chance_of_tooth(7) == pytest.approx(held(plain).chance_of_tooth(7), rel=1e-6)
    assert held(plain + mean).chance_of_tooth(7) > BEYOND_GRADE_CHANCE
    off = plain.copy()
    off[7] += 60.0
    assert held(off - np.mean(off) + mean).chance_of_tooth(7) < BEYOND_GRADE_CHANCE


@pytest.mark.parametrize("ratio", [4.0, 9.0, 25.0])
def test_a_scale_read_off_few_teeth_makes_it_likelier(ratio: float) -> None:
    """The tail of two squares over a scale of n freedoms is Fisher's: P(F > x / 2) = (1 + x / n)^(-n / 2)."""
    freedom = Z - 3.0
    one = held(np.zeros(Z), freedom)
    assert one._tail(ratio, 2) == pytest.approx(float(snedecor.sf(ratio / 2.0, 2.0, freedom)), rel=1e-9)
    assert one._tail(ratio, 2) > held(np.zeros(Z))._tail(ratio, 2)
    assert one._tail(ratio, 1) == pytest.approx(2.0 * float(student.sf(math.sqrt(ratio), freedom)), rel=1e-9)
    assert held(np.zeros(Z))._tail(ratio, 1) == pytest.approx(2.0 * float(normal.sf(math.sqrt(ratio))), rel=1e-9)


@pytest.mark.parametrize("direction", [1, -1])
def test_a_tooth_is_found_by_its_reading(direction: int) -> None:
    """The inverse of where it passes, to a third of a pitch, whichever way the encoder counts."""
    gear = GearKnown(z=23, zero=math.radians(311.0), direction=direction)
    for tooth in range(23):
        reading = gear.encoder_deg(tooth)
        assert reading is not None
        assert [gear.tooth_at(reading + off) for off in (0.0, 5.2, -5.2, 360.0)] == [tooth] * 4
    assert gear.tooth_at(None) is None
    assert GearKnown(z=23).tooth_at(12.0) is None


GEARS = 17, 23


NO_LOAD = {"tooth_deflection": False}


def graded() -> PairFile:
    return pair_file(GEARS, driving={"grade": 6}, driven={"grade": 6}, model=NO_LOAD, points=800, inspected=False)


@pytest.mark.slow
@pytest.mark.parametrize(("amplitude", "told"), [(25.0, [("driving", 3.0)]), (0.0, [])])
def test_a_wave_that_the_teeth_took_up_is_told(amplitude: float, told: list[tuple[str, float]], tmp_path: Path) -> None:
    """25 um three times per turn of a gear that says grade 6, F_p = 20 um or so, fitted by teeth alone."""
    own = np.random.default_rng(3).uniform(-3.0, 3.0, GEARS[0])
    wave = amplitude * np.cos(3.0 * 2.0 * np.pi / GEARS[0] * np.arange(GEARS[0]))
    sheet = {"inspection": {"pitch_um": (own + wave).round(3).tolist()}}
    made = pair_file(GEARS, driving=sheet, model=NO_LOAD, points=800)
    (one,) = recorded(made, (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=2.0, per_mesh=12)
    path = tmp_path / "pair.toml"
    comparison = compare(graded(), [one], path=path)
    model = prepare(graded(), comparison, path=path)
    free = [np.zeros((one.samples.size, 0)) for one in model.observed]
    search = from_declared(model, free, lambda _: None)
    found = beyond_grade(search, comparison, comparison)
    assert [(one.gear, one.order) for one in found] == told
    # Teeth hold their deviation for a pitch: a staircase has sinc(3 / 17) of its wave, to what proud ones hold longer.
    stairs = amplitude * float(np.sinc(3.0 / GEARS[0]))
    assert [one.amplitude_um for one in found] == pytest.approx([stairs] * len(told), rel=0.12)
