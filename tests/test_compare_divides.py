"""What differs most comes first, whatever teeth could take of it, and how the whole mismatch divides is told; strong
slow waves are no noise."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from gearpoly.assemble import Assembled, assemble
from gearpoly.compare.compare import compare
from gearpoly.compare.locate import Located, locate
from gearpoly.compare.set_up import GearKnown
from gearpoly.files.pairfile import read_pair
from gearpoly.report.compare_report import comparison_json
from gearpoly.units import UM
from tests.made_recordings import Rig, record
from tests.residuals import noise, residual, samples

RUNOUT = "[driving.eccentricity]\namplitude_um = 20.0\nangle_deg = 40.0\n"


def text(hidden: str) -> str:
    gear = "teeth = {z}\nmodule_mm = 2.0\nface_width_mm = 20.0\ngrade = 5\npoints_per_flank = 300\n"
    return (
        "[model]\ntooth_deflection = false\n[pair]\ncentre_distance_mm = 29.05\n[driving]\n"
        f"{gear.format(z=12)}{hidden}[driven]\n{gear.format(z=17)}"
    )


@cache
def made(folder: Path) -> tuple[Path, Assembled]:
    """A pair of grade 5 on paper, and the one that was drawn with a driving gear 20 um off its axis."""
    declared, truth = folder / "pair.toml", folder / "truth.toml"
    declared.write_text(text(""), encoding="utf-8")
    truth.write_text(text(RUNOUT), encoding="utf-8")
    return declared, assemble(read_pair(truth), path=truth, seed=7)


def located(folder: Path, cycles: float) -> Located:
    path, true = made(folder)
    rig = Rig(zero_1=1.0, zero_2=2.0, noise=0.3)
    recording = record(true, rig, np.random.default_rng(11), cycles=cycles, per_mesh=16, stated=(1.0, 2.0))
    return compare(read_pair(path), [recording], path=path).located


@pytest.mark.long
@pytest.mark.parametrize(
    "cycles", [0.5, 1.0, *(pytest.param(many, marks=pytest.mark.slow) for many in (2.01, 6.01, 12.01))]
)
def test_an_eccentricity_stays_first_however_long_it_is_watched(tmp_path: Path, cycles: float) -> None:
    """Over two cycles and more the teeth of a grade could take all of it."""
    found = located(tmp_path, cycles)
    first = found.where[0]
    assert (first.kind, first.gear, first.order) == ("shaft_order", "driving", 1.0)
    # An axis off by e moves the contact by e along the line of action; the drawn gear's own pitch has up to 5 um at
    # order 1 (a third of the F_p of 16 um of its grade), which is part of what differs.
    assert first.amplitude_um == pytest.approx(20.0, abs=5.0)
    whole = first.amplitude_um / math.sqrt(2.0)
    assert found.residual_rms / UM == pytest.approx(whole, rel=0.25)
    # The division says the same: most is listed, and a tenth at most is neither listed nor of teeth (0.3 um of noise,
    # and what contacts do that move on their teeth).
    division = found.division
    assert division.physics / UM > 0.9 * whole
    assert division.as_built < 0.5 * division.physics
    assert division.noise < 0.1 * division.physics


@pytest.mark.long
def test_the_division_adds_up_and_stands_in_the_json(tmp_path: Path) -> None:
    path, true = made(tmp_path)
    rig = Rig(zero_1=1.0, zero_2=2.0, noise=0.3)
    recording = record(true, rig, np.random.default_rng(12), cycles=1.0, per_mesh=12, stated=(1.0, 2.0))
    found = compare(read_pair(path), [recording], path=path)
    told = comparison_json(found)
    parts = told["divides_um"]
    assert set(parts) == {"physics", "as_built", "noise"}
    # What the parts share (a tooth's shape and a wave) is a few per cent of the rms.
    assert math.hypot(*parts.values()) == pytest.approx(told["residual_rms_um"], rel=0.1)
    assert [e["kind"] for e in told["where"]] == [e.kind for e in found.located.where]


@pytest.mark.slow
def test_what_teeth_within_their_grade_hold_is_listed_as_theirs(tmp_path: Path) -> None:
    found = located(tmp_path, 2.01)
    first = found.where[0]
    beyond = [e for e in found.entries if (e.gear, e.order) == ("driving", 1.0)]
    assert first.as_built == (not beyond)
    assert first.to_json().get("as_built", False) == first.as_built


KNOWN = (GearKnown(z=15, uncertainty=0.2 * UM), GearKnown(z=30, uncertainty=0.2 * UM))


@pytest.mark.long
@pytest.mark.parametrize("turns", [2.2, 3.4])
def test_a_strong_first_order_of_few_turns_is_no_noise(turns: float) -> None:
    """As on a printed pair of 15 on 30 teeth: 170 um once per turn of the driven shaft, noise of 1 um."""
    rng = np.random.default_rng(5)
    u, t = samples(rng, z_1=15, z_2=30, cycles=turns)
    wave = 170.0 * UM * np.cos(2.0 * math.pi * u / 30.0 + 1.0)
    found = locate([residual(u, t, wave + noise(rng, u.size, "white", UM), z_1=15, z_2=30)], gears=KNOWN)
    first = found.where[0]
    assert (first.gear, first.order) == ("driven", 1.0)
    assert first.amplitude_um == pytest.approx(170.0, rel=0.01)
    assert found.noise_level / UM == pytest.approx(1.0, rel=0.15)  # 10 % of doubt where little repeats, and chance


@pytest.mark.long
@pytest.mark.parametrize("lines", [2.3, pytest.param(5.4, marks=pytest.mark.slow)])
def test_a_strong_wave_of_few_turns_of_the_record_is_no_noise(lines: float) -> None:
    """It spreads over all the lines from which the noise about it is read, and used to be taken for wandering."""
    rng = np.random.default_rng(6)
    u, t = samples(rng, z_1=15, z_2=30, cycles=15)
    wave = 10.0 * UM * np.cos(2.0 * math.pi * lines * (t - t[0]) / (t[-1] - t[0]) + 0.4)
    found = locate([residual(u, t, wave + noise(rng, u.size, "white", 0.1 * UM), z_1=15, z_2=30)], gears=KNOWN)
    first = found.where[0]
    # At a nearly even speed so few turns do not tell time from angle.
    hz = first.hz if first.hz is not None else (first.order or 0.0) * (u[-1] - u[0]) / 15 / (t[-1] - t[0])
    assert hz == pytest.approx(lines / (t[-1] - t[0]), rel=0.02)
    assert first.amplitude_um == pytest.approx(10.0, rel=0.05)  # few turns share a little with the slow curves
    assert found.noise_level / UM == pytest.approx(0.1, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["white", "ar", "wandering"])
def test_noise_that_wanders_is_no_strong_wave(kind: str) -> None:
    """At a true rate of 5 %, more than 4 of 30 come in 1.6 % of such tests."""
    hits = 0
    for seed in range(30):
        rng = np.random.default_rng(seed)
        u, t = samples(rng, z_1=15, z_2=30, cycles=20, per_mesh=8)
        hits += bool(locate([residual(u, t, noise(rng, u.size, kind), z_1=15, z_2=30)], gears=KNOWN).entries)
    assert hits <= 4
