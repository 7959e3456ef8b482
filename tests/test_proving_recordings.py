"""The virtual bench against recordings from a rig that is neither it nor the simulator.

Skipped where they are not at hand.
"""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt
import pytest

from gearpoly.proving.effects import Effect, apply
from gearpoly.proving.flanks import ToothDeviations
from gearpoly.proving.gears import IdealGear, IdealPair
from gearpoly.proving.rig import EncoderDeviation, Rig, mesh
from tests.at_hand import BENCH

pytestmark = pytest.mark.skipif(not BENCH.is_dir(), reason="the bench recordings are not part of this repository")


def declared(name: str) -> Rig:
    told = tomllib.loads((BENCH / name / "pair.toml").read_text())
    gears, teeth = [], []
    for key in ("driving", "driven"):
        one = told[key]
        z = one["teeth"]
        gears.append(IdealGear(z=z, m=one["module_mm"], b=one["face_width_mm"], bore=one["bore_mm"]))
        seen = one["inspection"]
        teeth.append(
            replace(
                ToothDeviations.ideal(z, seen["tooth_thickness_um"]),
                p=np.array(seen["pitch_um"]),
                slope=np.array(seen["profile_slope_um"]),
            )
        )
    pair = IdealPair(driving=gears[0], driven=gears[1])
    return Rig(pair=pair, teeth_1=teeth[0], teeth_2=teeth[1], deflect=told["model"]["tooth_deflection"])


@lru_cache(maxsize=8)
def recording(name: str, k: int) -> tuple[dict[str, str], npt.NDArray[np.float64]]:
    """Comment lines and every third sample of a recording."""
    lines = (BENCH / name / f"rec_{k}.csv").read_text().splitlines()
    meta = dict(line[1:].split(" = ") for line in lines if line.startswith("#"))
    stated = {key.strip(): value for key, value in meta.items()}
    return stated, np.loadtxt(lines[len(stated) + 1 :: 3], delimiter=",")


def left(rig: Rig, name: str, k: int) -> tuple[float, float]:
    """Standard deviation and mean in um of recording less prediction, by the stated zeros."""
    stated, data = recording(name, k)
    r_1, r_2 = rig.pair.driving.r_b, rig.pair.driven.r_b
    theta_1 = np.radians(data[:, 1] - float(stated["driving_zero_deg"]))
    theta_2 = np.radians(data[:, 2] - float(stated["driven_zero_deg"]))
    # Whole turns of the two counters: those that bring the two angles together.
    turns = [(i, j) for i in range(-13, 13) for j in range(-10, 10)]
    off = np.mean(r_2 * theta_2 - r_1 * theta_1)
    i, j = min(turns, key=lambda t: abs(off + 2 * np.pi * (r_2 * t[1] - r_1 * t[0])))
    theta_1, theta_2 = theta_1 + 2 * np.pi * i, theta_2 + 2 * np.pi * j
    x = r_2 * theta_2 - r_1 * theta_1
    got = mesh(rig, theta_2, torque=float(stated["torque_nm"]), flank=stated["flank"].strip('"'))
    # Encoder errors belong to the reading.
    x_read = got.x + r_2 * rig.encoder_2.error(theta_2) - r_1 * rig.encoder_1.error(theta_1)
    rest = (x - x_read) * 1e3
    return float(rest.std()), float(rest.mean())


def test_control_leaves_noise_and_gauge() -> None:
    assert left(declared("control_inspected"), "control_inspected", 0)[0] == pytest.approx(
        0.39, abs=0.015
    )  # published 0.39


def test_eccentricity_by_the_contracts_angle() -> None:
    name = "ecc_under_pitch"
    hidden = json.loads((BENCH / f"{name}.truth.json").read_text())["truth"][0]
    rig = declared(name)
    assert left(rig, name, 0)[0] == pytest.approx(3.75, abs=0.03)  # published to two decimals, zeros rough
    off = Effect(physics="eccentricity", gear=1, size=hidden["amplitude_um"], more={"angle_deg": hidden["angle_deg"]})
    assert left(apply(rig, off), name, 0)[0] == pytest.approx(0.44, abs=0.02)


def test_encoder_eccentricity_on_the_coast_flank() -> None:
    name = "encoder_ecc"
    size = json.loads((BENCH / f"{name}.truth.json").read_text())["truth"][0]["amplitude_urad"]

    def at(angle: float, k: int) -> float:
        rig = replace(declared(name), encoder_1=EncoderDeviation(eccentricity_urad=size, angle_deg=angle))
        return left(rig, name, k)[0]

    best = min(np.arange(0, 360, 30.0), key=lambda a: at(float(a), 0))
    best = min(best + np.arange(-18, 19, 3.0), key=lambda a: at(float(a), 0))
    assert at(float(best), 0) == pytest.approx(0.39, abs=0.04)  # the angle is found to 1.5 deg: 0.05 um
    assert at(float(best), 1) == pytest.approx(0.39, abs=0.04)


@pytest.mark.long
def test_friction_case_falls_like_its_mean_error() -> None:
    """Mean TE of the recordings falls by 8.16 and 8.71 um; three laws differ from it by what laws differ."""
    name = "friction"
    rig = replace(declared(name), friction=0.0677)
    no_load = replace(rig, deflect=False)
    means = [left(no_load, name, k)[1] for k in range(3)]
    assert means[0] - means[1] == pytest.approx(8.16, abs=0.2)  # the unloaded prediction is the same but for sampling
    assert means[1] - means[2] == pytest.approx(8.71, abs=0.2)
    for law in ("sainsot", "weber", "palmgren"):
        rests = [left(replace(rig, law=law), name, k)[1] for k in range(3)]
        assert abs(rests[0] - rests[1]) < 0.12 * 8.16
        assert abs(rests[1] - rests[2]) < 0.12 * 8.71
