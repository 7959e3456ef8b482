"""A torque that pulses with a shaft: what it does to the mesh, and that no tooth is blamed for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.infer.load_wave import LOAD_WAVE, apart, columns, given
from gearpoly.physics.place import Place
from gearpoly.scene import stage
from gearpoly.units import UM
from tests.pair_files import made
from tests.physics_cases import Condition, recorded, rough, samples_at

Z = (12, 16)
PART = 0.06
"""How far the torque pulses about its mean: a joint out of line by 14 deg makes as much."""


@pytest.mark.long
def test_a_torque_a_little_larger_moves_the_mesh_by_as_much() -> None:
    """The columns are the derivative of the simulation: a thousandth more torque is a thousandth of them, to the
    curvature of Hertz's law and of sharing."""
    assembled = made(rough(Z))
    theta_2 = np.linspace(0.1, 0.1 + assembled.pair.cycle, 600, endpoint=False)
    here = stage(assembled, samples_at(assembled, theta_2, Condition(torque_nm=20.0), 0))
    more = stage(assembled, replace(here.samples, torque=1.001 * here.samples.torque))
    np.testing.assert_allclose(
        (more.te - here.te) / 1e-3, given(here), rtol=0.03, atol=0.02 * np.max(np.abs(given(here)))
    )
    assert np.all(given(here) < 0.0)  # more torque, and the driven gear lags


def test_a_wave_is_drawn_at_its_shaft_and_for_each_recording() -> None:
    assembled = made(rough(Z))
    theta_2 = np.linspace(0.1, 0.1 + assembled.pair.cycle, 300, endpoint=False)
    scenes = [
        stage(assembled, samples_at(assembled, theta_2, Condition(torque_nm=t), k)) for k, t in enumerate((10.0, 20.0))
    ]
    for gear, order in ((0, 1), (1, 2)):
        place = Place(gear=gear, order=order)
        angle = order * (scenes[1].samples.theta_1 if gear == 0 else scenes[1].samples.theta_2)
        both = columns(scenes[1], place)
        np.testing.assert_allclose(np.hypot(*both.T), np.abs(given(scenes[1])), rtol=1e-12)
        np.testing.assert_allclose(both[:, 0], given(scenes[1]) * np.cos(angle), rtol=0.0, atol=1e-12)
        wide = apart(scenes, place)
        np.testing.assert_array_equal(wide[1][:, 2:], both)
        assert not np.any(wide[1][:, :2]) and not np.any(wide[0][:, 2:])


def test_it_is_no_physics_of_the_catalogue_and_writes_nothing() -> None:
    file = rough(Z)
    assert LOAD_WAVE.write(file, Place(gear=1, order=1), (0.1, 0.0)) is file


@pytest.mark.slow
@pytest.mark.parametrize(
    ("gear", "part", "twist"),
    [
        ("driven", PART, 0.0),
        # Inspected teeth took a wave once per turn before anybody asked whether the torque pulses, and of what shafts
        # and teeth gave an encoder off its axis was made, with a pitch that waves beside it.
        ("driving", 0.35, 1.0),
    ],
)
def test_a_pulsing_torque_is_located_at_its_shaft_and_no_tooth_is_blamed(
    gear: str, part: float, twist: float, tmp_path: Path
) -> None:
    """Once per turn the torque is more and less by a ``part``, and shafts give ``twist`` times what teeth do on the
    mean. Before such a wave was among the unknown causes, teeth side by side were named as cracked."""
    true = rough(Z)
    recordings = recorded(
        true, (Condition(torque_nm=20.0), Condition(torque_nm=40.0)), np.random.default_rng(4), noise_um=0.1
    )
    assembled = made(true)
    pulsing = []
    for one in recordings:
        assert one.driven_angle_rad is not None and one.driving_angle_rad is not None and one.torque_nm is not None
        load = part * np.cos(one.driven_angle_rad if gear == "driven" else one.driving_angle_rad)
        still = samples_at(assembled, one.driven_angle_rad, Condition(torque_nm=one.torque_nm), 0)
        change = stage(assembled, replace(still, load=load)).te - stage(assembled, still).te
        change += twist * load * float(np.mean(given(stage(assembled, still))))
        turned = -change / assembled.pair.r_b2 / assembled.pair.ratio
        pulsing.append(replace(one, driving_angle_rad=one.driving_angle_rad - turned))
    assert 0.2 < np.std(change) / UM < 5.0
    found = diagnose(true, pulsing, path=tmp_path / "pair.toml")
    assert not found.findings
    assert any(one.kind == "shaft_order" and one.gear == gear and one.order == 1.0 for one in found.unexplained)
