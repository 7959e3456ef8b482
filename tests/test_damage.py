"""Wear, undulation and spalls on the drawn flanks: how much, which tooth, which side; and what they do to the TE."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from gearpoly.assemble import Assembled
from gearpoly.gear.gear import Gear
from gearpoly.mesh.pair import Flank, Mounted
from gearpoly.units import DEG, UM, FloatArray
from tests.pair_files import made, one_pitch, pair_file, under, unloaded_te

GEARS = ("driving", "driven")
FLANKS: tuple[Flank, ...] = ("drive", "coast")
SENSE = {"drive": 1.0, "coast": -1.0}


def mounted(assembled: Assembled, gear: int) -> Mounted:
    return assembled.pair.driving if gear == 0 else assembled.pair.driven


def standing_off(gear: Gear, r: FloatArray, psi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Roll length (n,) in mm of the foot of each drawn point (radius, angle) on the ideal involute, and how far the
    point stands out along the normal there: the nearest point of a fine polyline, by its own tangents."""
    l = np.linspace(0.2 * gear.l_a, 1.02 * gear.l_a, 20_001)
    angle = gear.psi_b - l / gear.r_b + np.arctan(l / gear.r_b)
    ideal = np.hypot(gear.r_b, l) * np.exp(1j * angle)
    foot, off = np.empty(r.size), np.empty(r.size)
    for k, point in enumerate(r * np.exp(1j * psi)):
        j = int(np.clip(np.argmin(np.abs(ideal - point)), 1, l.size - 2))
        along = ideal[j + 1] - ideal[j - 1]
        part = ((point - ideal[j]) * along.conjugate()).real / abs(along) ** 2
        foot[k] = l[j] + part * (l[j + 1] - l[j - 1])
        # The tooth lies on the side of its centre line, clockwise of its drive flank: out is to the left of up.
        off[k] = ((point - ideal[j]) * along.conjugate()).imag / abs(along)
    return foot, off


def measured(assembled: Assembled, gear: int, flank: Flank, tooth: int) -> tuple[FloatArray, FloatArray]:
    """The same for a drawn tooth, root left out."""
    flanks = mounted(assembled, gear).flanks
    psi = flanks.psi_drive if flank == "drive" else flanks.psi_coast
    held = np.hypot(flanks.gear.r_b, 0.3 * flanks.gear.l_a) < flanks.r
    return standing_off(flanks.gear, flanks.r[held][::7], psi[tooth, held][::7])


def more(gear: int, **keys: Any) -> Assembled:
    """A pair of which one gear carries further keys; its teeth are as thick as nominal."""
    even = {"inspection": {"tooth_thickness_um": 0.0}}
    tables: dict[str, Any] = {GEARS[gear]: even | keys, GEARS[1 - gear]: even}
    return made(pair_file(**tables))


# mm. Steps of 0.5 um of the polyline bend by (5e-4)^2/(8 x 2) = 2e-8 mm; deviations of 20 um move the foot by as much
# times their slope, which the law is asked at.
FOUND = 1e-7


@pytest.mark.parametrize("gear", [0, 1])
@pytest.mark.parametrize("flank", FLANKS)
def test_wear_takes_off_what_the_contract_says(gear: int, flank: Flank) -> None:
    """-w |l - l_pitch|/(l_tip - l_pitch): on all teeth and both flanks, none at the reference circle."""
    w = 12.0
    worn = more(gear, wear_um=w)
    ideal = mounted(worn, gear).gear
    for tooth in (0, 5, ideal.z - 1):
        l, d = measured(worn, gear, flank, tooth)
        expected = -w * UM * np.abs(l - ideal.r * math.sin(ideal.alpha)) / (ideal.l_a - ideal.r * math.sin(ideal.alpha))
        np.testing.assert_allclose(d, expected, atol=FOUND)
        assert d[-1] == pytest.approx(-w * UM, rel=0.02)  # the last point looked at is within a seventh of a percent
    _, other = measured(worn, 1 - gear, flank, 0)
    np.testing.assert_allclose(other, 0.0, atol=FOUND)


@pytest.mark.parametrize("gear", [0, 1])
def test_a_spall_is_cut_into_one_tooth_of_the_drive_flank(gear: int) -> None:
    """All its depth in the middle, half of it at its edges, nothing beyond, on that tooth alone."""
    ideal = mounted(made(pair_file()), gear).gear
    low, high, depth, tooth = ideal.r - 0.3, ideal.r + 0.6, 15.0, 4
    spall = {"tooth": tooth, "depth_um": depth, "from_mm": low, "to_mm": high}
    cut = more(gear, spall=[spall])
    l, d = measured(cut, gear, "drive", tooth)
    r = np.hypot(ideal.r_b, l)
    # tanh(2) = 0.96 two walls (0.05 mm each) inside an edge, and as much missing outside.
    np.testing.assert_allclose(d[(r > low + 0.2) & (r < high - 0.2)], -depth * UM, rtol=1e-3)
    np.testing.assert_allclose(d[(r < low - 0.2) | (r > high + 0.2)], 0.0, atol=1e-3 * depth * UM)
    for edge in (low, high):
        assert np.interp(edge, r, d) == pytest.approx(-0.5 * depth * UM, rel=0.05)  # points stand 0.03 mm apart
    for flank, other in (("coast", tooth), ("drive", tooth - 1), ("drive", tooth + 1)):
        np.testing.assert_allclose(measured(cut, gear, flank, other)[1], 0.0, atol=FOUND)


@pytest.mark.parametrize("gear", [0, 1])
def test_a_spall_lowers_te_where_its_pair_carries_alone(gear: int) -> None:
    """By its depth, and by nothing while other pairs carry; the coast flank does not feel it."""
    whole = made(pair_file())
    ideal = mounted(whole, gear).gear
    depth, tooth = 6.0, 2
    spall = {"tooth": tooth, "depth_um": depth, "from_mm": ideal.r - 0.2, "to_mm": ideal.r + 0.2, "wall_mm": 0.03}
    cut = made(pair_file(**{GEARS[gear]: {"spall": [spall]}}))
    theta = one_pitch(whole, 800, meshes=8) - 4.0 * whole.pair.driven.gear.tau
    change = unloaded_te(cut, theta) - unloaded_te(whole, theta)
    # Tooth n is at its pitch point n pitches after 0; the spall reaches 0.2 mm of radius to either side, and l runs
    # r/l faster: less than a fifth of a pitch.
    phase = theta / whole.pair.driven.gear.tau - tooth
    # Chords lag by up to 0.3 nm on each gear, twice.
    np.testing.assert_allclose(change[np.abs(phase) > 0.25], 0.0, atol=1.2e-6)
    assert np.min(change) == pytest.approx(-depth * UM, rel=5e-3)  # walls of 0.03 mm reach less than 1 % at the middle
    assert abs(phase[np.argmin(change)]) < 0.1
    np.testing.assert_allclose(
        unloaded_te(cut, theta, flank="coast"), unloaded_te(whole, theta, flank="coast"), atol=1e-12
    )


def test_a_deep_spall_with_steep_walls_does_not_fold_the_flank() -> None:
    spall = {"tooth": 0, "depth_um": 300.0, "from_mm": 17.8, "to_mm": 18.4, "wall_mm": 0.001}
    flanks = mounted(made(pair_file(driving={"spall": [spall]})), 0).flanks
    middle = int(np.argmin(np.abs(flanks.r - 18.1)))
    lost = (flanks.psi_drive[1] - flanks.psi_drive[0])[middle] * flanks.gear.r_b
    assert lost == pytest.approx(0.3, rel=0.35)  # the walls are as wide as the spall, so its floor is not reached


def wave_of(order: int, phase: float, angle: FloatArray, *, a: float) -> FloatArray:
    return a * UM * np.cos(order * angle + phase * DEG)


def drive_angles(ideal: Gear, l: FloatArray, gear: int, tooth: int, flank: Flank) -> FloatArray:
    """Rotation from that at which the reference circle of tooth 0 is in contact to that at which ``l`` of a tooth
    is."""
    up = (1.0 if gear == 0 else -1.0) * SENSE[flank]
    return tooth * ideal.tau + up * (l - ideal.r * math.sin(ideal.alpha)) / ideal.r_b


@pytest.mark.parametrize("gear", [0, 1])
@pytest.mark.parametrize("flank", [*FLANKS, "both"])
def test_an_undulation_runs_over_the_flanks_it_names(gear: int, flank: str) -> None:
    order, a, phase = 47, 2.0, 25.0
    table = {"order": order, "amplitude_um": a, "angle_deg": phase, "flank": flank}
    wavy = more(gear, undulation=[table])
    ideal = mounted(wavy, gear).gear
    for side in FLANKS:
        for tooth in (0, 7):
            l, d = measured(wavy, gear, side, tooth)
            expected = wave_of(order, phase, drive_angles(ideal, l, gear, tooth, side), a=a)
            if flank not in (side, "both"):
                expected = np.zeros(l.size)
            # The last point's foot lies beyond the tip by its deviation; all others as for wear.
            np.testing.assert_allclose(d, expected, atol=FOUND)


@pytest.mark.long
@pytest.mark.parametrize(
    ("gear", "flank"),
    [(0, "drive"), (1, "coast"), *(pytest.param(*one, marks=pytest.mark.slow) for one in ((0, "coast"), (1, "drive")))],
)
@pytest.mark.parametrize("order", [47])
def test_an_undulation_is_one_order_line_of_its_own_amplitude(gear: int, flank: Flank, order: int) -> None:
    """All touching pairs ride the same wave, so TE is A cos(n theta + phase), material ahead on the drive flank."""
    a, phase = 0.05, 130.0
    table = {"order": order, "amplitude_um": a, "angle_deg": phase, "flank": flank}
    sound, wavy = made(pair_file((12, 16))), made(pair_file((12, 16), **{GEARS[gear]: {"undulation": [table]}}))
    pair = sound.pair
    n = pair.meshes_per_cycle * 36
    theta_2 = np.arange(n) * (pair.cycle / n)
    change = unloaded_te(wavy, theta_2, flank=flank) - unloaded_te(sound, theta_2, flank=flank)
    turns = n * (pair.meshes_per_cycle / (pair.driving.gear.z, pair.driven.gear.z)[gear]) / n
    line = np.fft.rfft(change)[round(turns * order)] * 2.0 / n
    # Tooth 0's drive pitch point passes the line of centres at 0; its coast flank's half a tooth to either side.
    ideal = mounted(sound, gear).gear
    late = 0.0 if flank == "drive" else (1.0 if gear == 0 else -1.0) * ideal.s / ideal.r
    # The angle of the driving shaft on the coast flank is theta_1 = (theta_2 - TE) z_2/z_1, later by the lost motion.
    if flank == "coast" and gear == 0:
        late += float(np.mean(unloaded_te(sound, theta_2, flank=flank))) / pair.r_b2 / pair.ratio
    expected = SENSE[flank] * a * UM * np.exp(1j * (phase * DEG - order * late))
    # Second order: the wave turns the normal by order a/rho = 1e-3 at least, and TE rises by half its square times the
    # relative radius of curvature, 2 mm: 1e-6 mm, 2 % of the wave, most of it at twice the order; chords lag by 0.3 nm.
    assert abs(line - expected) < 0.01 * a * UM
    # Nothing else stands out, but for that second order.
    rest = np.fft.rfft(change) * 2.0 / n
    rest[round(turns * order)] = 0.0
    assert np.max(np.abs(rest)) < 0.03 * a * UM


@pytest.mark.long
def test_an_undulation_keeps_its_amplitude_under_load() -> None:
    """Shares of the load add up to one, and all pairs ride the same wave."""
    table = {"order": 47, "amplitude_um": 0.05, "angle_deg": 0.0}
    sound, wavy = made(pair_file((12, 16))), made(pair_file((12, 16), driven={"undulation": [table]}))
    n = sound.pair.meshes_per_cycle * 36
    theta_2 = np.arange(n) * (sound.pair.cycle / n)
    change = (under(wavy, theta_2, 3.0)[0].te - under(sound, theta_2, 3.0)[0].te) * sound.pair.r_b2
    line = np.fft.rfft(change)[3 * 47] * 2.0 / n
    # Beside the path a tip's corner carries, which rides its own place of the wave: under 3 N.m over 1 % of a pitch.
    assert abs(line - 0.05 * UM) < 0.02 * 0.05 * UM


def test_wear_lowers_te_by_both_dips() -> None:
    """Unloaded, x falls by w |l - l_pitch|/(l_tip - l_pitch) of the pair nearest its pitch point, most halfway between
    two pitch points."""
    w = 1.0
    sound, worn = made(pair_file()), made(pair_file(driving={"wear_um": w}))
    theta = np.linspace(-0.5, 0.5, 101) * sound.pair.driven.gear.tau
    change = unloaded_te(worn, theta) - unloaded_te(sound, theta)
    ideal = sound.pair.driving.gear
    l_off = np.abs(theta) / sound.pair.ratio * ideal.r_b
    # The slope turns the normal by w r_b/(rho (l_a - l_pitch)) = 1.2e-3 rad at rho = 3 mm, and TE rises by half its
    # square times the relative radius of curvature, 2.5 mm: 1.8e-6 mm. Chords lag by 0.3 nm on each gear, twice.
    np.testing.assert_allclose(change, -w * UM * l_off / (ideal.l_a - ideal.l_pitch), atol=3e-6)
