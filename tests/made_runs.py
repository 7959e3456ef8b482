"""Recordings of a backlash test, made from the simulator: forth, a stop, and back on the other flanks, in one file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray
from tests.made_recordings import te_of

TURN = 2.0 * math.pi
RATE = 200.0
"""Samples per second; the driven shaft turns once a second at speed."""


@dataclass(frozen=True, kw_only=True)
class Turned:
    """A motion: driven rotations (n,) in rad over times (n,) in s, and which way (n,) the driving shaft last drove."""

    time: FloatArray
    driven: FloatArray
    way: FloatArray


def motion(turns: tuple[float, ...], *, stop: float = 0.5, ramp: float = 0.15, start: float = 1.3) -> Turned:
    """Runs of so many driven ``turns``, signed, with stops of so many seconds between; ``ramp`` s from a stop to a turn
    a second."""
    driven, way = [np.full(round(stop * RATE), start)], [np.full(round(stop * RATE), np.sign(turns[0]))]
    at = start
    for run in turns:
        seconds = abs(run) + ramp
        t = np.arange(round(seconds * RATE)) / RATE
        speed = np.clip(np.minimum(t / ramp, (seconds - t) / ramp), 0.0, 1.0)
        speed *= 1.0 + 0.05 * np.sin(TURN * 0.37 * t + 1.0)  # no drive turns as evenly as its samples come
        moved = np.cumsum(speed) / RATE * TURN * np.sign(run)
        driven += [at + moved, np.full(round(stop * RATE), at + moved[-1])]
        way += [np.full(moved.size + round(stop * RATE), np.sign(run))]
        at += moved[-1]
    whole = np.concatenate(driven)
    return Turned(time=np.arange(whole.size) / RATE, driven=whole, way=np.concatenate(way))


def recorded(
    made: Assembled,
    turned: Turned,
    rng: np.random.Generator,
    *,
    torque_nm: float = 0.0,
    noise_um: float = 0.2,
    hangs: bool = False,
    wrapped: bool = True,
    zeros: tuple[float, float] = (0.7, 2.2),
) -> Recording:
    """What two encoders read of that motion: the drive flanks carry forward and the coast flanks back, or the drive
    flanks both ways where the load ``hangs`` on them. Half a second of standing takes up the lost motion."""
    te = te_of(made, turned.driven, flank="drive", torque_nm=torque_nm)
    back = turned.way < 0.0
    if not hangs and back.any():
        te = np.where(back, te_of(made, turned.driven, flank="coast", torque_nm=torque_nm), te)
    te = te + rng.normal(0.0, noise_um * UM / made.pair.r_b2, te.size)
    readings = [(turned.driven - te) / made.pair.ratio + zeros[0], turned.driven + zeros[1]]
    first, second = (np.mod(one, TURN) for one in readings) if wrapped else readings
    return Recording(
        source=Path("test.csv"),
        time_s=turned.time,
        driving_angle_rad=first,
        driven_angle_rad=second,
        torque_nm=torque_nm,
        driving_zero_rad=zeros[0],
        driven_zero_rad=zeros[1],
    )
