"""Alignment of gears that nobody inspected: placed by eccentricities and load, or honestly left open."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.assemble import Assembled
from gearpoly.compare.beside import BesideSimulation
from gearpoly.compare.compare import lay_beside
from gearpoly.compare.curve import PITCH_WAVE, SHAFT_DOUBT
from gearpoly.compare.stand_in import known_pair
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.recording import Flank
from gearpoly.units import DEG, UM
from tests.made_recordings import HALF_1, HALF_2, RIG, TURN, Rig, errors, flat_pair, inspected, off_deg, record


@pytest.mark.long
def test_graded_gears_that_bend_are_placed_within_a_pitch_only(tmp_path: Path) -> None:
    """The mesh shape under load tells the phase, but all teeth look alike to who has not inspected them."""
    rng = np.random.default_rng(17)
    _, _, made = inspected(tmp_path, rng, bends=True, wave=1.0)
    path = flat_pair(tmp_path, "grade = 6")
    recording = record(made, RIG, rng, torque_nm=100.0)
    beside = lay_beside(read_pair(path), [recording], path=path)
    found = beside.alignment
    assert found.phased
    assert found.numbering == "open"
    assert found.rivals
    pitch = TURN / 25
    within = math.remainder((found.zeros.driven or 0.0) - RIG.zero_2, pitch) / DEG
    assert abs(within) < 4.0 * found.std_driven / DEG < 0.5
    stated = (RIG.zero_1 + 0.3 * HALF_1, RIG.zero_2 - 0.3 * HALF_2)
    again = lay_beside(read_pair(path), [record(made, RIG, rng, torque_nm=100.0, stated=stated)], path=path)
    assert again.alignment.numbering == "stated"
    assert abs(errors(again, RIG)[1]) < 4.0 * again.alignment.std_driven / DEG


@pytest.mark.long
def test_eccentricities_alone_tell_the_teeth_nearly(tmp_path: Path) -> None:
    """Two ideal gears, 60 and 40 um off their axes: nothing but two waves, whose phases say which tooth is which."""
    path = tmp_path / "pair.toml"
    path.write_text(
        "".join(
            f"[{name}]\nteeth = {z}\nmodule_mm = 2.0\npoints_per_flank = 300\n"
            f"[{name}.inspection]\ntooth_thickness_um = -80.0\n"
            f"[{name}.eccentricity]\namplitude_um = {e}\nangle_deg = {angle}\n"
            for name, z, e, angle in (("driving", 18, 60.0, 30.0), ("driven", 25, 40.0, 250.0))
        ),
        encoding="utf-8",
    )
    rng = np.random.default_rng(18)
    made = known_pair(read_pair(path), path=path)
    beside = lay_beside(read_pair(path), [record(made, RIG, rng)], path=path)
    found = beside.alignment
    # Encoders may be off their axes too, by 6 um that nobody declared: a tenth of 60 um is a tenth of a rad.
    assert 3.0 < found.std_driven / DEG < 10.0
    assert abs(errors(beside, RIG)[1]) < 2.0 * found.std_driven / DEG
    # So the turn is known, and the tooth only nearly; nothing more is claimed.
    assert found.numbering == "open"


# Gears of which only a grade and their eccentricities are known.


def graded(
    folder: Path,
    rng: np.random.Generator,
    *,
    eccentric: tuple[float, float] = (60.0, 40.0),
    teeth: tuple[int, int] = (18, 25),
    bends: bool = False,
    wave: float = 3.0,
    scatter: float = 1.5,
) -> tuple[Path, Assembled]:
    """A pair file with a grade and declared eccentricities (um), and the true pair: with index deviations of its own,
    a first order of ``wave`` and ``scatter`` (um), and a profile slope."""
    head = f"[model]\ntooth_deflection = {str(bends).lower()}\n"
    truth, declared = head, head
    for name, z, e in zip(("driving", "driven"), teeth, eccentric, strict=True):
        gear = f"[{name}]\nteeth = {z}\nmodule_mm = 2.0\nface_width_mm = 20.0\npoints_per_flank = 300\n"
        off = f"[{name}.eccentricity]\namplitude_um = {e}\nangle_deg = {rng.uniform(0.0, 360.0):.2f}\n" if e else ""
        angle = TURN * np.arange(z) / z
        pitch = rng.normal(0.0, scatter, z) + wave * np.cos(angle - rng.uniform(0.0, TURN))
        sheet = f"tooth_thickness_um = -100.0\npitch_um = {pitch.round(3).tolist()}\n"
        truth += f"{gear}[{name}.inspection]\n{sheet}profile_slope_um = {rng.normal():.3f}\n{off}"
        declared += f"{gear}grade = 6\n[{name}.limits]\nE_sns_um = -80.0\nE_sni_um = -120.0\n{off}"
    (folder / "truth.toml").write_text(truth, encoding="utf-8")
    (folder / "pair.toml").write_text(declared, encoding="utf-8")
    path = folder / "truth.toml"
    return folder / "pair.toml", known_pair(read_pair(path), path=path)


def expected_stds(beside: BesideSimulation, eccentric: tuple[float, float]) -> tuple[float, float]:
    """Standard errors in rad of the turns that lines of ``eccentric`` (um) tell: what else may be of their order, over
    them. Noise is nothing beside that: 0.3 um over thousands of samples."""
    doubts = [math.hypot(SHAFT_DOUBT[0], PITCH_WAVE * (gear.F_pT or 0.0)) for gear in beside.gears]
    one, two = (doubt / (e * UM) for doubt, e in zip(doubts, eccentric, strict=True))
    z_1, z_2 = (gear.z for gear in beside.gears)
    if math.gcd(z_1, z_2) == 1:
        return one, two
    # Few pairs of teeth ever meet, so the shafts turn together: both lines tell of one place.
    both = 1.0 / math.hypot(1.0 / one, z_1 / z_2 / two)
    return both, both * z_1 / z_2


def nearest_deg(beside: BesideSimulation, rig: Rig) -> float:
    """How far the truth is from the nearest place that is listed, the larger of both shafts in deg."""
    found = beside.alignment
    return min(
        max(abs(off_deg(zero, true)) for zero, true in ((one.driving, rig.zero_1), (one.driven, rig.zero_2)) if zero)
        for one in (found.zeros, *found.rivals)
    )


LEFT = 6.0 * UM
"""mm rms. What deviations of both gears leave, and a few deg of 60 and 40 um; a wrong turn leaves 20 um and more."""

DOWN = Rig(zero_1=0.3, zero_2=5.9, direction_1=-1, direction_2=-1)


@pytest.mark.long
@pytest.mark.parametrize(
    ("rig", "flanks", "teeth", "cycles"),
    [
        (RIG, ["drive"], (18, 25), 1.0),
        (DOWN, ["coast"], (18, 25), 1.0),
        (RIG, ["drive", "coast", "drive"], (18, 25), 0.3),
        (RIG, ["drive"], (20, 30), 6.0),
    ],
    ids=["drive", "coast only, both count down", "a set of three", "a common factor"],
)
def test_declared_eccentricities_tell_the_turns_of_graded_gears(
    tmp_path: Path, rig: Rig, flanks: list[Flank], teeth: tuple[int, int], cycles: float
) -> None:
    rng = np.random.default_rng(20)
    path, made = graded(tmp_path, rng, teeth=teeth)
    recordings = [record(made, rig, rng, flank=flank, cycles=cycles) for flank in flanks]
    beside = lay_beside(read_pair(path), recordings, path=path)
    found = beside.alignment
    assert found.rough
    assert not found.phased
    stds = found.std_driving, found.std_driven
    # Turns are round and teeth whole: up to a fifth more of some 15 deg, and a little less.
    np.testing.assert_array_less(stds, 1.2 * np.array(expected_stds(beside, (60.0, 40.0))))
    np.testing.assert_array_less(0.9 * np.array(expected_stds(beside, (60.0, 40.0))), stds)
    # A wave of 3 um and the scatter's own first order, a third of its 1.5 um, are half of what is allowed for.
    np.testing.assert_array_less(np.abs(errors(beside, rig)) * DEG, 2.0 * np.array(stds))
    assert max(one.rms for one in beside.aligned) < LEFT
    # A tooth is 20 and 14.4 deg: some others are as likely, the true one among them.
    assert found.numbering == "open"
    assert found.rivals
    assert nearest_deg(beside, rig) < 180.0 / 25


@pytest.mark.long
def test_an_eccentricity_tells_the_turn_of_its_own_shaft_only(tmp_path: Path) -> None:
    rng = np.random.default_rng(21)
    path, made = graded(tmp_path, rng, eccentric=(60.0, 0.0))
    beside = lay_beside(read_pair(path), [record(made, RIG, rng)], path=path)
    found = beside.alignment
    assert found.rough
    assert found.std_driving == pytest.approx(expected_stds(beside, (60.0, 1.0))[0], rel=0.1)  # pitches are whole
    assert found.std_driven == pytest.approx(TURN / math.sqrt(12.0), rel=0.01)  # anywhere: 25 teeth, all alike
    assert abs(errors(beside, RIG)[0]) * DEG < 2.0 * found.std_driving
    assert len(found.rivals) > 3
    words = " ".join(beside.remarks)
    assert "the driving shaft to" in words
    assert "the driven shaft to 104 deg" in words


@pytest.mark.long
def test_eccentricities_of_half_a_module_tell_the_teeth(tmp_path: Path) -> None:
    """180 um on either gear: a tooth is six and more standard errors."""
    rng = np.random.default_rng(22)
    path, made = graded(tmp_path, rng, eccentric=(180.0, 180.0), wave=1.0, scatter=0.5)
    beside = lay_beside(read_pair(path), [record(made, RIG, rng)], path=path)
    found = beside.alignment
    assert found.numbering == "curves"
    assert not found.rivals
    assert np.max(np.abs(errors(beside, RIG))) < 180.0 / 25
    assert np.all(np.abs(errors(beside, RIG)) * DEG < 3.0 * np.array([found.std_driving, found.std_driven]))


@pytest.mark.long
def test_load_places_graded_gears_within_the_pitch_and_eccentricity_turns_them(tmp_path: Path) -> None:
    rng = np.random.default_rng(23)
    path, made = graded(tmp_path, rng, bends=True)
    recordings = [record(made, RIG, rng, cycles=0.4, torque_nm=torque, flank="coast") for torque in (2.0, 80.0)]
    beside = lay_beside(read_pair(path), recordings, path=path)
    found = beside.alignment
    assert found.phased
    # Four stated standard errors, of the truth's tooth among those that are listed.
    assert nearest_deg(beside, RIG) < 4.0 * found.std_driving / DEG < 0.5
    assert np.max(np.abs(errors(beside, RIG))) < 25.0  # one tooth off at most, by a wave of 3 um beside 40
    assert max(one.rms for one in beside.aligned) < LEFT + 1.0 * UM
    assert found.numbering == "open"


@pytest.mark.long
@pytest.mark.parametrize(
    ("stated", "only"),
    [((RIG.zero_1 + 0.3 * HALF_1, None), ""), ((None, RIG.zero_2 - 0.3 * HALF_2), ""), ((None, RIG.zero_2), "driven")],
    ids=["driving", "driven", "driven, beside a transmission error"],
)
def test_one_stated_zero_leaves_the_other_turn_to_the_eccentricities(
    tmp_path: Path, stated: tuple[float | None, float | None], only: str
) -> None:
    rng = np.random.default_rng(24)
    path, made = graded(tmp_path, rng)
    beside = lay_beside(read_pair(path), [record(made, RIG, rng, stated=stated, only=only)], path=path)
    found, zeros = beside.alignment, beside.alignment.zeros
    # The curves know less than half a tooth, so what is stated stays.
    if stated[0] is not None:
        assert off_deg(zeros.driving, stated[0]) == pytest.approx(0.0, abs=1e-6)
        assert abs(off_deg(zeros.driven, RIG.zero_2)) * DEG < 2.0 * found.std_driven
    elif stated[1] is not None:
        assert off_deg(zeros.driven, stated[1]) == pytest.approx(0.0, abs=1e-6)
        assert only or abs(off_deg(zeros.driving, RIG.zero_1)) * DEG < 2.0 * found.std_driving
    assert beside.aligned[0].rms < LEFT
    assert found.numbering == "open"


@pytest.mark.slow
def test_stated_errors_of_turns_cover_the_truth(tmp_path: Path) -> None:
    """24 pairs whose first orders deviate by all that the grade and a coupling leave open."""
    scores = []
    for seed in range(24):
        rng = np.random.default_rng(300 + seed)
        rig = Rig(zero_1=rng.uniform(0.0, TURN), zero_2=rng.uniform(0.0, TURN))
        # F_p of grade 6 is 24 um: cosine and sine of 8 um each, so the wave is Rayleigh distributed.
        path, made = graded(tmp_path, rng, eccentric=(80.0, 60.0), wave=float(rng.rayleigh(8.0)))
        beside = lay_beside(read_pair(path), [record(made, rig, rng, cycles=0.4)], path=path)
        found = beside.alignment
        scores.append(np.array(errors(beside, rig)) * DEG / (found.std_driving, found.std_driven))
    z = np.array(scores)
    # Of 24 normal numbers at least 20 lie within two sigma with 99.5 %, and the rms lies within 0.6 and 1.45.
    assert np.all(np.count_nonzero(np.abs(z) < 2.0, axis=0) >= 20)
    rms = np.sqrt(np.mean(z**2, axis=0))
    assert np.all((rms > 0.6) & (rms < 1.45))


# The stated error.
