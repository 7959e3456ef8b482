"""One typical claim of every physics, and recordings that the exact simulation makes with it written into the file."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.files.models import PairFile
from gearpoly.mesh.pair import Flank
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim, Scope
from gearpoly.physics.place import Place, Values
from gearpoly.physics.samples import Samples
from gearpoly.recording.recording import Recording
from gearpoly.scene import stage
from gearpoly.units import NM, RPM, UM, FloatArray
from tests.pair_files import made, pair_file, unloaded_te

TURN = 2.0 * math.pi
ZEROS = 1.1, 2.3
SPEED = 600.0

CASES: dict[str, tuple[Place, Values]] = {name: one.case for name, one in catalogue().items()}
"""One claim that is well above 0.3 um of noise, per physics: place and values, amplitudes first."""

CONTRACT: dict[str, set[str]] = {name: set(one.parameters) for name, one in catalogue().items()}
"""Names and parameters. Further parameters may stand beside these."""


@dataclass(frozen=True, kw_only=True)
class Condition:
    """What one recording is made under."""

    flank: Flank = "drive"
    torque_nm: float = 20.0
    speed_rpm: float = SPEED
    backward: bool = False


NAMES = sorted(catalogue())
CONDITIONS = tuple(Condition(flank=flank, torque_nm=t) for t in (20.0, 0.0) for flank in ("drive", "coast"))


CAMPAIGNS = {"mesh_resonance": (Condition(speed_rpm=600.0), Condition(speed_rpm=300.0))}
"""A resonance shows by two speeds; all else by full and nearly no torque, and both flanks."""


def claim_of(name: str) -> Claim:
    place, values = CASES[name]
    physics = catalogue()[name]
    shape = values[physics.amplitudes :]
    return Claim(physics=physics, place=replace(place, shape=shape, probe=values[: physics.amplitudes]), values=values)


def sized(claim: Claim, part: float) -> Values:
    """A claim's values with a part of its amplitudes."""
    a = claim.physics.amplitudes
    return (*(part * v for v in claim.values[:a]), *claim.values[a:])


def rough(z: tuple[int, int] = (12, 16), *, bends: bool = True, points: int = 800, seed: int = 5) -> PairFile:
    """An inspected pair whose teeth are apart by microns, so that one or two of them touch, and bulge nowhere."""
    rng = np.random.default_rng(seed)

    def sheet(teeth: int) -> dict[str, object]:
        pitch, slope = rng.normal(0.0, 3.0, teeth), rng.normal(0.0, 1.0, teeth)
        held = {"pitch_um": pitch.round(3).tolist(), "profile_slope_um": slope.round(3).tolist()}
        return {"inspection": {**held, "profile_crowning_um": 0.0}}

    gears = sheet(z[0]), sheet(z[1])
    model = {"tooth_deflection": bends}
    return pair_file(z, driving=gears[0], driven=gears[1], model=model, pair={"torque_nm": 20.0}, points=points)


def declared(name: str, *, z: tuple[int, int] = (12, 16)) -> PairFile:
    """What is known before the physics ``name`` is found."""
    return rough(z, bends=name != "tooth_deflection")


def samples_at(
    assembled: Assembled, theta_2: FloatArray, condition: Condition, number: int, *, time: bool = True
) -> Samples:
    """Samples of an unloaded pair; readings by ``ZEROS``, the driving encoder counts down."""
    pair = assembled.pair
    te = unloaded_te(assembled, theta_2, flank=condition.flank) / pair.r_b2
    theta_1 = (theta_2 - te) / pair.ratio
    return Samples(
        number=number,
        flank=condition.flank,
        torque=condition.torque_nm * NM,
        speed=condition.speed_rpm * RPM,
        theta_1=theta_1,
        theta_2=theta_2,
        time=theta_2 / (pair.ratio * condition.speed_rpm * RPM) if time else None,
        reading_1=ZEROS[0] - theta_1,
        reading_2=ZEROS[1] + theta_2,
        direction_1=-1,
        direction_2=1,
        counted=True,
        backward=condition.backward,
    )


def scope_of(file: PairFile, conditions: tuple[Condition, ...] = CONDITIONS) -> Scope:
    """What a diagnosis would know of recordings under ``conditions``."""
    assembled = made(file)
    pair = assembled.pair
    reach = tuple((m.flanks.span.l_start, m.gear.l_a) for m in (pair.driving, pair.driven))
    return Scope(
        file=file,
        gears=(pair.driving.gear, pair.driven.gear),
        flanks=tuple(c.flank for c in conditions),
        torques=tuple(c.torque_nm * NM for c in conditions),
        speeds=tuple(c.speed_rpm * RPM for c in conditions),
        encoders=(True, True),
        timed=True,
        counted=True,
        span=2.0 * pair.meshes_per_cycle / pair.driving.gear.z,
        inspected=(True, True),
        reach=(reach[0], reach[1]),
    )


def recorded(
    file: PairFile,
    conditions: tuple[Condition, ...],
    rng: np.random.Generator,
    *,
    cycles: float = 2.0,
    per_mesh: int = 20,
    noise_um: float = 0.3,
) -> list[Recording]:
    """Recordings of the pair of ``file`` with all that it states, white noise on the transmission error."""
    assembled = made(file)
    pair = assembled.pair
    out = []
    drifts = file.measurement.thermal_drift_um if file.measurement is not None else ()
    for number, condition in enumerate(conditions):
        n = round(pair.meshes_per_cycle * cycles * per_mesh)
        place = (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n
        theta_2 = rng.uniform(0.0, pair.cycle) + place * cycles * pair.cycle
        samples = samples_at(assembled, theta_2, condition, number)
        te = stage(assembled, samples).te + rng.normal(0.0, noise_um * UM, n)
        time = place * n * (pair.cycle * cycles / n) / (pair.ratio * condition.speed_rpm * RPM)
        if number < len(drifts) and drifts[number]:
            along = (2.0 * (time - time[0]) / np.ptp(time) - 1.0) * (-1.0 if condition.backward else 1.0)
            te = te + np.polynomial.legendre.legval(along, (0.0, *drifts[number])) * UM
        theta_1 = (theta_2 - te / pair.r_b2) / pair.ratio
        readings = []
        for zero, direction, theta, errors in zip(ZEROS, (-1, 1), (theta_1, theta_2), assembled.encoders, strict=True):
            truth = direction * theta * errors.scale + zero
            reading = truth
            for _ in range(40):
                reading = truth + errors.at(reading)
            readings.append(reading)
        if condition.backward:
            time, readings = time[-1] - time[::-1], [reading[::-1] for reading in readings]
        out.append(
            Recording(
                source=Path(f"{number}.csv"),
                time_s=time,
                driving_angle_rad=readings[0],
                driven_angle_rad=readings[1],
                backward=condition.backward,
                torque_nm=condition.torque_nm,
                speed_rpm=condition.speed_rpm,
                flank=condition.flank,
                driving_zero_rad=ZEROS[0],
                driven_zero_rad=ZEROS[1],
                driving_direction=-1,
            )
        )
    return out
