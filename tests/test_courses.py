"""Slow courses that bend more than a cubic are followed, and neither what wanders nor a slow wave is taken for one."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.api import load
from gearpoly.compare.locate import Located, locate
from gearpoly.compare.set_up import GearKnown
from gearpoly.compare.slow import SLOW_CURVE_TERMS
from gearpoly.units import UM, FloatArray
from tests.residuals import noise, residual, samples

SHIPPED = Path(__file__).parents[1] / "data" / "recordings" / "eccentric_low_tooth"


def found(seed: int, *, kind: str, course: str, level: float = 1e-3, cycles: float = 2.0) -> tuple[Located, FloatArray]:
    rng = np.random.default_rng(seed)
    u, t = samples(rng, z_1=18, z_2=25, cycles=cycles, per_mesh=6)
    along = (t - t[0]) / (t[-1] - t[0])
    courses = {
        "none": np.zeros(u.size),
        "settles": 10.0 * UM * np.exp(-16.0 * along),
        "creeps": 2.0 * UM * np.log1p(100.0 * along),
        "wave": 3.0 * UM * np.sin(2.0 * math.pi * 3.3 * along + 1.0),
        "walk": 0.02 * UM * np.cumsum(rng.normal(size=u.size)),
    }
    values = noise(rng, u.size, kind, level) + courses[course]
    return locate([residual(u, t, values, z_1=18, z_2=25)], gears=(GearKnown(z=18), GearKnown(z=25))), values


@pytest.mark.long
@pytest.mark.parametrize(("kind", "level", "course", "half"), [
    ("ar", 5e-4, "settles", 5.0), ("white", 3e-4, "settles", 5.0), ("white", 3e-4, "creeps", math.log(101.0)),
])  # fmt: skip
def test_what_settles_or_creeps_is_followed(kind: str, level: float, course: str, half: float) -> None:
    """Half of what it ranges over, to a tenth: three curves round off the first hundredth of a recording. The noise is
    what it is without the course, to the few parts in a hundred that seven curves may take of it."""
    one, _ = found(1, kind=kind, course=course, level=level)
    assert one.slow_terms[0] > SLOW_CURVE_TERMS
    (drift,) = [entry for entry in one.entries if entry.drift]
    assert drift.amplitude_um == pytest.approx(half, rel=0.1)
    plain, _ = found(1, kind=kind, course="none", level=level)
    assert one.noise_level == pytest.approx(plain.noise_level, rel=0.05)


@pytest.mark.long
@pytest.mark.parametrize(("kind", "course"), [("white", "walk"), ("wandering", "none"), ("ar", "wave")])
def test_neither_what_wanders_nor_a_slow_wave_is_a_course(kind: str, course: str) -> None:
    """Of 30 random walks and 40 noises that wander none was taken for a course. A wave keeps its size."""
    one, _ = found(0, kind=kind, course=course)
    assert one.slow_terms == (SLOW_CURVE_TERMS,)
    if course == "wave":
        assert one.entries[0].amplitude_um == pytest.approx(3.0, rel=0.15)


def test_few_turns_have_no_course_but_a_cubic() -> None:
    """Of eight turns of the slower shaft such curves would take a part of what comes once per turn."""
    one, _ = found(1, kind="ar", course="settles", cycles=8.0 / 18.0)
    assert one.slow_terms == (SLOW_CURVE_TERMS,)


@pytest.mark.long
def test_a_run_back_settles_at_its_beginning_too() -> None:
    """The film of a recording from its end, told to be one: a sixtieth of it, at the end of its angles. Its noise is
    modelled from the other end, which tells a few parts in a thousand."""
    rng = np.random.default_rng(2)
    u, t = samples(rng, z_1=18, z_2=25, cycles=2.0, per_mesh=6)
    values = noise(rng, u.size, "white", 3e-4) + 10.0 * UM * np.exp(-60.0 * (t - t[0]) / (t[-1] - t[0]))
    forth = residual(u, t, values, z_1=18, z_2=25)
    back = replace(residual(-u[::-1], -t[::-1], values[::-1], z_1=18, z_2=25), backward=True)
    found_so = [locate([one], gears=(GearKnown(z=18), GearKnown(z=25))) for one in (forth, back)]
    first, second = ([entry for entry in one.entries if entry.drift] for one in found_so)
    assert second[0].amplitude_um == pytest.approx(first[0].amplitude_um, rel=0.01)
    assert found_so[1].noise_level == pytest.approx(found_so[0].noise_level, rel=0.01)


@pytest.mark.slow
def test_what_settles_hides_no_name(tmp_path: Path) -> None:
    """10 um that settle within an eighth of the recording: on a cubic they left 9 times the noise, and an eccentricity
    of 9 um and a low tooth lost their names. The drift comes out to 0.02 um at first, 0.12 um less beside teeth as
    built."""
    lines = (SHIPPED / "rec_0.csv").read_text(encoding="utf-8").splitlines()
    head = next(k for k, line in enumerate(lines) if not line.startswith("#"))
    rows = np.array([line.split(",") for line in lines[head + 1 :]], dtype=np.float64)
    names = lines[head].split(",")
    time, driven = rows[:, names.index("time_s")], names.index("driven_angle_deg")
    settles = 10.0 * np.exp(-8.0 * (time - time[0]) / np.ptp(time))  # um along the line of action
    rows[:, driven] += np.degrees(settles * 1e-3 / (25.0 * math.cos(math.radians(20.0))))
    file = tmp_path / "settles.csv"
    text = [*lines[: head + 1], *(",".join(f"{value:.8f}" for value in row) for row in rows)]
    file.write_text("\n".join(text) + "\n", encoding="utf-8")
    verdict = load(SHIPPED / "pair.toml").diagnose([file])
    assert {one.claim.physics.name for one in verdict.missing} == {"eccentricity", "tooth_pitch"}
    (drift,) = [one for one in verdict.to_dict()["unexplained"] if one["kind"] == "drift"]
    assert drift["amplitude_um"] == pytest.approx(5.0, abs=0.2)
