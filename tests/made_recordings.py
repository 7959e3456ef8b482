"""Recordings made from the simulator with known zeros, for tests of what finds those zeros again."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

from gearpoly.assemble import Assembled
from gearpoly.compare.beside import BesideSimulation
from gearpoly.compare.stand_in import known_pair
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import read_pair
from gearpoly.mesh.deflection import pair_compliance
from gearpoly.mesh.loaded import load_reach, loaded
from gearpoly.mesh.transmission import NEAR_PAIR_MM, contacts
from gearpoly.recording.recording import Flank, Recording
from gearpoly.units import DEG, NM, UM, FloatArray

TURN = 2.0 * math.pi


def inspected(
    folder: Path,
    rng: np.random.Generator,
    *,
    z_1: int = 18,
    z_2: int = 25,
    scatter: float = 1.5,
    wave: float = 4.0,
    bends: bool = False,
    gauge: float = 0.0,
    hidden: str = "",
    stated: str = "",
    points: int = 300,
) -> tuple[PairFile, Path, Assembled]:
    """A pair file of two inspected gears with pitch errors (um: scatter and an order-1 wave), and the true pair.

    The file holds the truth plus ``gauge`` noise (um), and lacks ``hidden``, further TOML of the true driving gear;
    ``stated`` TOML of that gear is in both. ``points`` per flank leave ripples of 4 nm.
    """

    def one(z: int) -> tuple[FloatArray, FloatArray]:
        angle = TURN * np.arange(z) / z
        return rng.normal(0.0, scatter, z) + wave * np.cos(angle - rng.uniform(0.0, TURN)), rng.normal(0.0, 0.7, z)

    gears = {"driving": (z_1, *one(z_1)), "driven": (z_2, *one(z_2))}

    def text(noise: float, extra: str) -> str:
        lines = ['name = "made [front]"', "[model]", f"tooth_deflection = {str(bends).lower()}"]
        for name, (z, pitch, slope) in gears.items():
            lists = [(values + noise * rng.normal(size=z)).round(4).tolist() for values in (pitch, slope)]
            lines += [
                f"[{name}]\nteeth = {z}\nmodule_mm = 2.0\nface_width_mm = 20.0\npoints_per_flank = {points}",
                f"[{name}.inspection]\nuncertainty_um = {max(noise, 0.01)}\ntooth_thickness_um = -60.0",
                f"pitch_um = {lists[0]}\nprofile_slope_um = {lists[1]}",
                stated + "\n" + extra if name == "driving" else "",
            ]
        return "\n".join(lines)

    truth, declared = folder / "truth.toml", folder / "pair.toml"
    truth.write_text(text(0.0, hidden), encoding="utf-8")
    declared.write_text(text(gauge, ""), encoding="utf-8")
    return read_pair(declared), declared, known_pair(read_pair(truth), path=truth)


def te_of(made: Assembled, theta_2: FloatArray, *, flank: Flank, torque_nm: float) -> FloatArray:
    """Transmission error (n,) in rad at ``theta_2`` (n,) in rad, straight from the kernel."""
    if made.elasticity is None or torque_nm == 0.0:
        return contacts(made.pair, theta_2, flank=flank, near=0.0, fast=True).te
    bends = pair_compliance(made.pair, made.elasticity, flank=flank)
    near = NEAR_PAIR_MM + load_reach(bends, torque_nm * NM)
    found = contacts(made.pair, theta_2, flank=flank, near=near, fast=True)
    return loaded(found, bends, torque=torque_nm * NM).te


@dataclass(frozen=True, kw_only=True)
class Rig:
    """True zeros of both encoders in rad, which way they count, noise in um rms with its lag-1 correlation."""

    zero_1: float
    zero_2: float
    direction_1: int = 1
    direction_2: int = 1
    noise: float = 0.3
    correlation: float = 0.0


RIG = Rig(zero_1=2.1, zero_2=4.4)
HALF_1, HALF_2 = math.pi / 18, math.pi / 25
"""Half a tooth of a pair of 18 and 25, rad."""


def record(
    made: Assembled,
    rig: Rig,
    rng: np.random.Generator,
    *,
    cycles: float = 1.0,
    per_mesh: int = 16,
    flank: Flank = "drive",
    torque_nm: float = 0.0,
    stated: tuple[float | None, float | None] = (None, None),
    wrapped: bool = False,
    only: str = "",
    drift_um: float = 0.0,
) -> Recording:
    """One recording from anywhere in the cycle, unevenly sampled. ``stated`` zeros in rad; ``only``: the one shaft
    whose angle is kept, beside the transmission error; ``drift_um`` a slow half wave over the recording."""
    pair = made.pair
    n = round(pair.meshes_per_cycle * cycles * per_mesh)
    place = (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n
    theta_2 = rng.uniform(0.0, pair.cycle) + place * cycles * pair.cycle
    white = rng.normal(0.0, rig.noise * UM, n)
    noise = lfilter([math.sqrt(1.0 - rig.correlation**2)], [1.0, -rig.correlation], white)
    noise = noise + drift_um * UM * np.sin(math.pi * place)
    te = te_of(made, theta_2, flank=flank, torque_nm=torque_nm) + noise / pair.r_b2
    theta_1 = (theta_2 - te) / pair.ratio
    readings = [
        zero + way * angle
        for zero, way, angle in (
            (rig.zero_1, rig.direction_1, theta_1),
            (rig.zero_2, rig.direction_2, theta_2),
        )
    ]
    # Each recording begins at a turn of its own, as encoders do when they are switched on.
    readings = [
        np.mod(x, TURN) if wrapped else x - TURN * math.floor(x[0] / TURN + rng.integers(-2, 3)) for x in readings
    ]
    return Recording(
        source=Path(f"{flank}_{torque_nm:g}.csv"),
        time_s=place * n * 0.006,
        driving_angle_rad=None if only == "driven" else readings[0],
        driven_angle_rad=None if only == "driving" else readings[1],
        te_mm=te * pair.r_b2 if only else None,
        torque_nm=torque_nm,
        flank=flank,
        driving_zero_rad=stated[0],
        driven_zero_rad=stated[1],
        driving_direction=1 if rig.direction_1 > 0 else -1,
        driven_direction=1 if rig.direction_2 > 0 else -1,
    )


def off_deg(found: float | None, true: float) -> float:
    """Error of a zero in deg, within half a turn."""
    assert found is not None
    return math.remainder(found - true, TURN) / DEG


def errors(beside: BesideSimulation, rig: Rig) -> tuple[float, float]:
    """Errors of both zeros in deg."""
    zeros = beside.alignment.zeros
    return off_deg(zeros.driving, rig.zero_1), off_deg(zeros.driven, rig.zero_2)


def flat_pair(folder: Path, extra: str = "") -> Path:
    """A pair file free of deviations, whose curve says nothing of its teeth."""
    path = folder / "flat.toml"
    gears = "".join(
        f"[{name}]\nteeth = {z}\nmodule_mm = 2.0\nface_width_mm = 20.0\npoints_per_flank = 300\n{extra}\n"
        for name, z in (("driving", 18), ("driven", 25))
    )
    path.write_text("[pair]\ncentre_distance_mm = 43.05\n" + gears, encoding="utf-8")
    return path
