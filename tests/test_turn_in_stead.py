"""Waves of one shaft's teeth against one curve of no cause over its turn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.fit import joined, settled
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.diagnose.turn_in_stead import turn_in_stead, waves_of, with_curve
from gearpoly.infer.unknown import turn_curves, waves
from gearpoly.keys.sections import PairFile
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.recording.recording import Recording
from gearpoly.scene import stage
from gearpoly.units import UM
from tests.pair_files import made
from tests.physics_cases import Condition, recorded, rough, samples_at, scope_of

PLAY_UM, WIDTH_RAD = 9.0, 0.08
"""What a key with play lets the gear turn by twice per turn, and over which angle."""


def with_play(one: Recording, true: PairFile) -> Recording:
    """A recording whose driven gear turns by so much on its shaft, each way once per turn."""
    assert one.driven_angle_rad is not None
    steps = np.tanh(np.sin(one.driven_angle_rad + 0.5) / WIDTH_RAD)
    return replace(one, driven_angle_rad=one.driven_angle_rad + PLAY_UM * UM / scope_of(true).gears[1].r_b * steps)


def wave(order: int, *values: float) -> Claim:
    return Claim(physics=catalogue()["cumulative_pitch"], place=Place(gear=1, order=order), values=values)


@pytest.mark.long
@pytest.mark.parametrize("hidden", ["pitch", "key"])
def test_waves_have_a_name_only_where_they_are_no_step(hidden: str, tmp_path: Path) -> None:
    """Cumulative pitches of orders 1 and 3 of an inspected gear, or a key with play, of which a search had made orders
    1, 3 and 5 of a pitch, each at 99 in 100 by itself: a square wave is more than two of its lines."""
    known, rng = rough((12, 16)), np.random.default_rng(4)
    waves = [wave(1, 11.0, 2.0), wave(3, 0.0, 3.5)]
    true = known
    for one in waves if hidden == "pitch" else ():
        true = one.written(true)
    (one,) = recorded(true, (Condition(torque_nm=0.0),), rng, cycles=3.0, per_mesh=16)
    one = with_play(one, known) if hidden == "key" else one
    path = tmp_path / "pair.toml"
    model = prepare(known, compare(known, [one], path=path), path=path)
    search = from_declared(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    search = settled(joined(search, waves))
    claims = waves_of(search, search.model.claims, 1)
    assert len(claims) == 2 and not waves_of(search, search.model.claims, 0)
    turn = turn_in_stead(search, claims, 1)
    if hidden == "pitch":
        assert turn.unknown < 1e-6
        return
    assert turn.unknown > 0.99
    left = with_curve(search, claims, turn)
    assert not left.model.claims
    assert left.linear.system.whiteness < 1.1 < search.linear.system.whiteness


def test_a_curve_over_the_turn_holds_a_step_and_nothing_that_every_mesh_has() -> None:
    """A square wave of a shaft is in it to the ringing of a series cut off; a wave of the mesh is not at all."""
    assembled = made(rough((12, 16)))
    theta_2 = np.linspace(0.1, 0.1 + assembled.pair.cycle, 1200, endpoint=False)
    scene = stage(assembled, samples_at(assembled, theta_2, Condition(torque_nm=0.0), 0))
    curve = turn_curves([scene], 1)[0].columns[0]
    basis = np.linalg.qr(curve)[0]
    angle = scene.samples.reading_2

    def held(what: np.ndarray) -> float:
        return float(np.sum((basis.T @ what) ** 2) / np.sum(what**2))

    # The mesh orders 16 and 48 are left out of it, the former of which a square wave of order 1 has none.
    assert held(np.tanh(np.sin(angle) / WIDTH_RAD)) > 0.999
    assert held(np.cos(16 * angle)) < 1e-3
    # Once per turn of the other shaft, which comes back to its beginning with this one only.
    assert held(np.cos(16 / 12 * angle)) < 0.05


def test_each_order_of_a_wave_without_a_name_is_a_wave_of_its_own() -> None:
    """Teeth may hold one of its harmonics and not another; of two recordings both sizes of an order are one wave."""
    assembled = made(rough((12, 16)))
    theta_2 = np.linspace(0.1, 0.1 + assembled.pair.cycle, 400, endpoint=False)
    scenes = [stage(assembled, samples_at(assembled, theta_2, Condition(torque_nm=0.0), k)) for k in (0, 1)]
    same, *_, apart = waves(scenes, 1, [2, 4, 6])
    assert same.by_order == [[0, 1], [2, 3], [4, 5]]
    assert apart.by_order == [[0, 1, 6, 7], [2, 3, 8, 9], [4, 5, 10, 11]]


@pytest.mark.slow
def test_a_key_with_play_is_located_at_its_shaft_and_has_no_name(tmp_path: Path) -> None:
    """The lines of a square wave of +-9 um are 36/(pi h) um: 11.5, 3.8 and 2.3 at orders 1, 3 and 5, the corners being
    a little round."""
    true = rough((12, 16))
    (one,) = recorded(true, (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=3.0, per_mesh=16)
    verdict = diagnose(true, [with_play(one, true)], path=tmp_path / "pair.toml")
    assert not verdict.findings
    lines = {e.order: e.amplitude_um for e in verdict.unexplained if e.gear == "driven" and e.order is not None}
    for order in (1, 3, 5):
        assert lines[order] == pytest.approx(4.0 * PLAY_UM / np.pi / order, rel=0.1)
