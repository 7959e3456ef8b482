"""Where a pair is to be simulated: evenly over its hunting cycle, or at a recording's own samples and torque."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly import arguments
from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.pair import GearPair
from gearpoly.recording.recording import Recording
from gearpoly.units import BoolArray, FloatArray

USUAL_POINTS_PER_MESH = 40
"""Positions per pitch unless asked otherwise: resolves the twelfth mesh harmonic and a whole 18/25 cycle in seconds."""

MESH_ROUNDING = 1e-12
"""Part of a mesh count that the product of turns and teeth may round up: 0.1 turns of 30 teeth are 3 meshes, not 4."""


def cycle_positions(
    pair: GearPair, *, turns: float | None = None, points_per_mesh: int = USUAL_POINTS_PER_MESH
) -> FloatArray:
    """Driven rotations (N,) in rad: ``turns`` of the driven gear (default: a whole hunting cycle) at
    ``points_per_mesh`` a pitch, up to the end of the last mesh that is begun: means, contact ratio and peak to peak
    over a part of a mesh would say where it ends. Raises ``OutOfRangeError`` for no such number of either."""
    if turns is not None:
        arguments.TURNS_OF_DRIVEN.check("--turns", turns)
    arguments.POINTS_PER_MESH.check("--points-per-mesh", points_per_mesh)
    meshes = pair.meshes_per_cycle if turns is None else math.ceil(turns * pair.driven.gear.z * (1.0 - MESH_ROUNDING))
    count = max(1, meshes) * points_per_mesh
    return np.arange(count, dtype=np.float64) * (pair.driven.gear.tau / points_per_mesh)


@dataclass(frozen=True, kw_only=True, eq=False)
class At:
    """Driven rotations ``theta_2`` (N,) in rad at the samples of a recording, their ``time`` (N,) in s and ``torque``
    (N,) in N.m where they were recorded, and ``remarks`` on what had to be assumed."""

    theta_2: FloatArray
    time: FloatArray | None
    torque: FloatArray | None
    remarks: list[str]


def recording_positions(pair: GearPair, recording: Recording) -> At:
    """Where and under what a ``recording`` was made, drop-outs left out.

    From the driven encoder where there is one, else from the driving encoder and the recorded TE. Raises
    ``OutOfRangeError`` where no sample is left.
    """
    remarks = []

    def forward(angle: FloatArray, zero: float | None, direction: int, name: str) -> FloatArray:
        if zero is None:
            remarks.append(
                f"{name}_zero_deg is not stated: taken as 0, so teeth are numbered from the encoder's own zero "
                "(compare finds it)"
            )
        return direction * (np.unwrap(angle) - (zero or 0.0))

    if recording.driven_angle_rad is not None:
        keep = np.isfinite(recording.driven_angle_rad)
        theta_2 = forward(
            recording.driven_angle_rad[keep], recording.driven_zero_rad, recording.driven_direction, "driven"
        )
        theta_2 = theta_2 + _driven_turns(pair, recording, theta_2, keep)
    else:
        assert recording.driving_angle_rad is not None  # a Recording has one of the two
        te = recording.te_in_rad(pair.r_b2)
        assert te is not None  # and TE beside a single angle
        keep = np.isfinite(recording.driving_angle_rad) & np.isfinite(te)
        theta_1 = forward(
            recording.driving_angle_rad[keep],
            recording.driving_zero_rad,
            recording.driving_direction,
            "driving",
        )
        theta_2 = te[keep] + pair.ratio * theta_1
    dropped = keep.size - theta_2.size
    if dropped:
        remarks.append(f"{dropped} drop-outs of {keep.size} samples are left out")
    if theta_2.size == 0:
        raise OutOfRangeError(f"{recording.source}: no sample is left, all are drop-outs")
    time = recording.time_s
    if time is not None and not np.all(np.isfinite(time[keep])):
        time = None
    torque = recording.torque_samples_nm
    return At(
        theta_2=theta_2,
        time=None if time is None else time[keep],
        torque=None if torque is None else torque[keep],
        remarks=remarks,
    )


def _driven_turns(pair: GearPair, recording: Recording, theta_2: FloatArray, keep: BoolArray) -> float:
    """Whole driven turns in rad to add to ``theta_2``, since an encoder does not say which turn of the hunting cycle
    it is on.

    The turn decides which driving tooth meets, and the driving encoder tells; without its reading and both zeros it
    stays open.
    """
    if recording.driving_angle_rad is None or recording.driving_zero_rad is None or recording.driven_zero_rad is None:
        return 0.0
    reading = recording.driving_angle_rad[keep]
    both = np.isfinite(reading)
    theta_1 = recording.driving_direction * (np.unwrap(reading[both]) - recording.driving_zero_rad)
    ahead = float(np.median(theta_1 - theta_2[both] / pair.ratio))
    turns = np.arange(pair.driving.gear.z)
    apart = (ahead - 2.0 * np.pi * turns / pair.ratio + np.pi) % (2.0 * np.pi) - np.pi
    return 2.0 * np.pi * float(turns[np.argmin(np.abs(apart))])


def recorded_torque(recording: Recording, *, default: float) -> float:
    """Torque in N.m of a recording: as stated, else the mean of its torque column, else ``default``."""
    if recording.torque_nm is not None:
        return recording.torque_nm
    if recording.torque_samples_nm is not None:
        return max(0.0, float(np.nanmean(recording.torque_samples_nm)))
    return default
