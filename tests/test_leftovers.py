"""What is fitted beside everything is found again at the end, and not lost in parts."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.entries import Cause, Entry
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.foreign import STANDS, large
from gearpoly.diagnose.leftovers import located_by_load, taken_back, untold, with_causes
from gearpoly.diagnose.residuals import _by_colour
from gearpoly.diagnose.unearned import Unearned
from gearpoly.infer.posterior import Posterior
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import UM
from tests.made_recordings import Rig, inspected, record
from tests.pair_files import made
from tests.physics_cases import Condition, recorded, rough
from tests.test_bumps import bumps

ORDER, GAIN = 0.83, 90.0
"""Of the pulses, and what they take of the misfit."""


@pytest.mark.slow
def test_a_train_of_which_no_line_stands_out_is_not_lost_in_the_fit(tmp_path: Path) -> None:
    """Its lines are fitted beside the teeth, each too faint to be put back for itself; together they are what was
    found."""
    rng = np.random.default_rng(2)
    file, path, truth = inspected(tmp_path, rng, z_1=11, z_2=13, hidden="", points=40)
    one = record(truth, Rig(zero_1=1.0, zero_2=2.0, noise=1.0), rng, cycles=6.0, stated=(1.0, 2.0))
    assert one.driven_angle_rad is not None
    assert one.driving_angle_rad is not None
    shape = bumps(one.driving_angle_rad / (2.0 * math.pi) * ORDER, 0.25)
    pitch = 1e-3 * math.sqrt(GAIN / float(shape @ shape))
    driven = one.driven_angle_rad + pitch * shape / truth.pair.r_b2
    struck = replace(one, driven_angle_rad=driven)
    located = [e for e in compare(file, [struck], path=path).located.entries if e.companion_of is None]
    assert located
    assert all(e.together for e in located)
    found = diagnose(file, [struck], path=path)
    assert not found.findings
    assert found.unexplained
    for entry in found.unexplained:
        assert entry.order is not None
        assert entry.order / ORDER == pytest.approx(round(entry.order / ORDER), abs=0.02)


def test_columns_stand_out_together_by_the_chance_of_one_wave() -> None:
    """The square of two columns in noise is exponential; of ten it is Gamma's, of mean 10."""
    assert large(1.01 * STANDS**2, 2)
    assert not large(0.99 * STANDS**2, 2)
    draws = np.random.default_rng(1).chisquare(10, 200_000)
    level = np.quantile(draws, 1.0 - math.exp(-0.5 * STANDS**2))
    assert large(1.05 * level, 10)
    assert not large(0.95 * level, 10)


@pytest.mark.parametrize(
    ("hz", "amplitude", "dropped"), [(50.0007, 0.07, False), (47.3, 0.07, True), (47.3, 0.2, False)]
)
def test_hum_below_the_noise_is_no_colour_of_it(hz: float, amplitude: float, dropped: bool) -> None:
    """Of noise of 0.3 um in recordings that never repeat themselves: a line of ten standard errors stays at the mains
    alone, elsewhere one of 29 does."""
    line = Entry(kind="time", hz=hz, hz_std=1e-3, amplitude_um=amplitude, std_um=7e-3, recordings=(0,), p_value=1e-13)
    model: Any = SimpleNamespace(observed=[SimpleNamespace(whole=False)])
    assert _by_colour(line, model, cast(Any, [SimpleNamespace(level=0.3 * UM)])) is dropped


@pytest.mark.slow
def test_a_sharp_line_below_the_noise_is_located_where_nothing_repeats() -> None:
    """0.6 um in noise of 0.8 um, 45 standard errors, in 1.7 hunting cycles: no colour of noise is that sharp. It once
    went without a word, as whatever is below such noise."""
    true, rng = rough(), np.random.default_rng(8)
    (one,) = recorded(true, (Condition(torque_nm=0.0),), rng, cycles=1.7, per_mesh=90, noise_um=0.8)
    assert one.driven_angle_rad is not None
    line = 0.6 * UM * np.cos(2.37 * one.driven_angle_rad) / made(true).pair.r_b2
    told = diagnose(true, [replace(one, driven_angle_rad=one.driven_angle_rad + line)], path=Path("pair.toml"))
    assert not told.findings
    (found,) = told.unexplained
    # At so even a speed time and angle are one: 7.5 turns of the driven shaft a second, 10 of the driving one.
    told_at = found.hz or (found.order or 0.0) * (7.5 if found.gear == "driven" else 10.0)
    assert told_at == pytest.approx(2.37 * 7.5, abs=0.1)
    assert found.amplitude_um == pytest.approx(0.6, abs=0.06)


@pytest.mark.parametrize(("gear", "z"), [(0, 17), (1, 51)])
def test_a_tooth_is_told_with_the_rms_over_its_own_pitch(gear: int, z: int) -> None:
    """A tooth that is 0.4 um off over its pitch, and nothing elsewhere, does 0.4 um / sqrt(z) rms to a whole turn. That
    was told in its stead, among teeth whose rms is that of their own contact."""
    gears = tuple(SimpleNamespace(z=n, encoder_deg=lambda tooth: 20.0 * tooth) for n in (17, 51))
    comparison = cast(Any, SimpleNamespace(aligned=(None,), gears=gears, alignment=SimpleNamespace(numbered=(1, 1))))
    turn = np.zeros(40 * z)
    turn[80:120] = 0.4 * UM
    place = Place(gear=gear, tooth=2)
    pit = Claim(physics=catalogue()["tooth_spall"], place=place, values=(6.0, 11.7, 12.5, 0.06))
    entry = taken_back(comparison, pit, float(np.sqrt(np.mean(turn**2))))
    assert (entry.kind, entry.tooth) == ("tooth", 2)
    assert entry.rms_um == pytest.approx(0.4)
    assert UM**2 * entry.mean_square(17, 51) == pytest.approx(float(np.mean(turn**2)))


def test_a_load_that_bends_teeth_otherwise_shows_at_every_mesh_and_between_recordings() -> None:
    """Of all that was located the foremost four of these, as they stand: no order of a shaft, and no tooth."""
    kinds: Any = ("shaft_order", "condition", "mesh_order", "tooth", "mesh_phase", "mesh_order", "condition")
    where = tuple(Entry(kind=kind, p_value=0.0, recordings=(k,)) for k, kind in enumerate(kinds))
    comparison: Any = SimpleNamespace(located=SimpleNamespace(where=where))
    assert located_by_load(comparison) == (where[1], where[2], where[4], where[5])


@pytest.mark.parametrize(("order", "entries"), [(3, 1), (2, 2)])
def test_a_wave_of_both_shafts_is_told_once(order: int, entries: int) -> None:
    """Twice per turn of 24 teeth is three times per turn of 36, and what it could be stands with it."""
    gears = (SimpleNamespace(z=24), SimpleNamespace(z=36))
    comparison: Any = SimpleNamespace(aligned=[None], gears=gears, located=SimpleNamespace(entries=()))
    wave = Entry(kind="shaft_order", gear="driving", order=2.0, amplitude_um=12.0, recordings=(0,), p_value=0.0)
    claim = Claim(physics=catalogue()["encoder_interpolation"], place=Place(gear=1, order=order), values=(400.0, 0.0))
    place = Unearned(claim=claim, rms=7e-3, posterior=Posterior(claims=(), unknown=0.8, nothing=0.0))
    cause = Cause(physics="encoder_interpolation", gear="driven", probability=0.2, parameters=(), says="")
    told = with_causes(comparison, [wave], [place], [(cause,)], [])
    assert len(told) == entries
    assert told[-1].could_be == (cause,)


def test_what_teeth_took_is_told_where_time_ended_but_no_burst_is() -> None:
    """Beside teeth that nobody inspected a burst of 0.9 um was located, of which nothing was left once they were
    fitted: teeth take waves, drifts and single teeth, and nothing that comes once."""
    known: Any = {"p_value": 1e-6, "recordings": (0,)}
    wave = Entry(kind="shaft_order", gear="driven", order=2.0, amplitude_um=6.9, **known)
    drift = Entry(kind="drift", amplitude_um=17.0, label="drift", **known)
    burst = Entry(kind="time", amplitude_um=0.9, label="burst", during_s=(29.8, 31.5), **known)
    tone = Entry(kind="time", amplitude_um=0.5, hz=12.0, **known)
    where = (wave, drift, burst, tone)
    comparison = cast(Any, SimpleNamespace(located=SimpleNamespace(where=where)))
    assert untold(comparison, ()) == (wave, drift, tone)
    assert untold(comparison, (wave,)) == (drift, tone)
