"""Synthetic residuals of a pair that never was: lines, tooth patterns and coloured noise at uneven samples.

No part of the program makes them, so that a sign or a tooth number that is wrong there is not wrong here as well.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import lfilter

from gearpoly.compare.set_up import AlignedResidual
from gearpoly.units import FloatArray


def samples(
    rng: np.random.Generator,
    *,
    z_1: int,
    z_2: int,
    cycles: float,
    per_mesh: int = 20,
    speed_rpm: float = 30.0,
    wobble: float = 0.01,
) -> tuple[FloatArray, FloatArray]:
    """Meshes and times (n,) of ``cycles`` hunting cycles from anywhere: even in time but for 20 % jitter, at a speed
    that wobbles by a percent once per turn and half a percent at 0.13 per turn."""
    meshes = math.lcm(z_1, z_2) * cycles
    # The wobble takes up to a twentieth of a turn, so a turn more is made and what is too long cut off.
    n = int((meshes + z_1) * per_mesh)
    dt = 60.0 / speed_rpm / z_1 / per_mesh
    t = np.arange(n) * dt + rng.uniform(-0.2, 0.2, n) * dt
    turns = t * speed_rpm / 60.0
    p, q = rng.uniform(0.0, 2.0 * np.pi, 2)
    angle = turns + wobble / (2.0 * np.pi) * np.sin(2.0 * np.pi * turns + p)
    angle += 0.5 * wobble / (2.0 * np.pi * 0.13) * np.sin(2.0 * np.pi * 0.13 * turns + q)
    u = angle * z_1
    kept = u - u[0] < meshes
    return u[kept] + rng.uniform(0.0, 1000.0), t[kept]


def noise(rng: np.random.Generator, n: int, kind: str, level: float = 1e-3) -> FloatArray:
    """Noise (n,) in mm of rms ``level``: ``white``, ``ar`` (first order, 0.6), or ``wandering`` (white, and a random
    walk that forgets after 2000 samples and adds up to more than half its size)."""
    white = rng.normal(size=n)
    if kind == "white":
        return level * white
    if kind == "ar":
        return level * 0.8 * np.asarray(lfilter([1.0], [1.0, -0.6], rng.normal(size=n + 500))[500:])
    walk = np.asarray(lfilter([1.0], [1.0, -0.9995], rng.normal(size=n + 8000))[8000:])
    return level * (white + 0.02 * walk)


def tooth_signal(u: FloatArray, *, z: int, pitch: FloatArray, slope: FloatArray, low: float, high: float) -> FloatArray:
    """Signal (n,) in mm of one gear whose teeth deviate by ``pitch`` and ``slope`` (z,): each carries from ``low`` to
    ``high`` about its pitch point, and where two do, each counts half."""
    total, count = np.zeros(u.size), np.zeros(u.size)
    first = np.floor(u).astype(int)
    for step in (-1, 0, 1, 2):
        n = first + step
        phase = u - n
        inside = (phase >= low) & (phase <= high)
        count += inside
        total += np.where(inside, pitch[n % z] + slope[n % z] * ((phase - low) / (high - low) - 0.5), 0.0)
    return total / np.maximum(count, 1.0)


def residual(
    u: FloatArray, t: FloatArray, values: FloatArray, *, z_1: int, z_2: int, torque: float | None = None
) -> AlignedResidual:
    """The residual that ``locate`` is given."""
    return AlignedResidual(
        theta_1=u * (2.0 * np.pi / z_1),
        theta_2=u * (2.0 * np.pi / z_2),
        residual=values,
        z_2=z_2,
        time_s=t,
        torque=torque,
    )


def healthy(rng: np.random.Generator, *, z_1: int, z_2: int, cycles: float, kind: str) -> AlignedResidual:
    """A healthy pair, inspected to 0.2 um: what the gauge left of pitch and slope, and noise of 1 um."""
    u, t = samples(rng, z_1=z_1, z_2=z_2, cycles=cycles)
    values = noise(rng, u.size, kind)
    for z, sense in ((z_1, 1.0), (z_2, -1.0)):
        pitch, slope = 2e-4 * rng.normal(size=(2, z))
        values = values + tooth_signal(u, z=z, pitch=pitch, slope=sense * slope, low=-0.8, high=0.8)
    return residual(u, t, values, z_1=z_1, z_2=z_2)
