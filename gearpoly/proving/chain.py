"""The measuring chain: how the shafts move, what the encoders read, what noise lies on it, what a file says."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi, sqrt

import numpy as np
from scipy.signal import cont2discrete, lfilter

from gearpoly.proving.gears import MM_PER_UM, RAD_PER_DEG, FloatArray
from gearpoly.proving.rig import Rig, meshing

FORCED = 96
"""Points per mesh at which a resonance is forced: steps of the transmission error are rounded by a hundredth of a
pitch."""

ZERO_STD = 0.05
"""Standard deviation in deg of a zero that is read off the teeth by eye."""


@dataclass(frozen=True, kw_only=True)
class RecordedCondition:
    """One recording: torque in N.m, speed of the driving shaft in rpm, flank, length in driving turns, samples per
    mesh.

    wobble: relative amplitude of the speed's slow waves; uneven: spread of the sampling times over the sampling
    interval."""

    torque: float
    speed: float = 30.0
    flank: str = "drive"
    turns: float = 50.0
    per_mesh: float = 20
    wobble: float = 0.004
    uneven: float = 0.2


@dataclass(frozen=True, kw_only=True)
class Chain:
    """What the set-up adds to every recording.

    noise_um: rms per sample along the line of action; colour: AR(1) coefficient from sample to sample, 0 white;
    zeros_deg: true readings at the angle zeros; known: whether a rough reading of them is stated; directions: +1 or -1;
    steps_deg: one count of each encoder; column: "angles" or "te_um"; decimals: digits that a file has of an angle in
    deg; wrapped: whether an encoder starts again at 0 after a turn.
    """

    noise_um: float = 0.3
    colour: float = 0.0
    zeros_deg: tuple[float, float] = (0.0, 0.0)
    known: bool = True
    directions: tuple[int, int] = (1, 1)
    steps_deg: tuple[float, float] = (0.0, 0.0)
    column: str = "angles"
    timed: bool = True
    decimals: int = 8
    wrapped: bool = False


@dataclass(frozen=True, kw_only=True)
class Motion:
    """Sampling times in s and the driven angles in rad that the motor gives; start_rad of the driven shaft, span in
    s."""

    time: FloatArray
    theta_2: FloatArray
    span: tuple[float, float]
    waves: tuple[tuple[float, float, float], ...]
    start: float
    rate: float

    @property
    def angles(self) -> tuple[float, float]:
        """Driven angles in rad at start and end."""
        first, last = self.angle(np.array(self.span))
        return float(first), float(last)

    def angle(self, time: FloatArray) -> FloatArray:
        """Driven angle in rad at any time in s."""
        out = self.start + self.rate * time
        for amplitude, omega, phase in self.waves:
            out += self.rate * amplitude / omega * np.sin(omega * time + phase)
        return out


def campaign_turns(conditions: tuple[RecordedCondition, ...], turns: float) -> tuple[RecordedCondition, ...]:
    """The same recordings of another length, in driving turns."""
    return tuple(replace(one, turns=turns) for one in conditions)


def motion(rig: Rig, condition: RecordedCondition, rng: np.random.Generator) -> Motion:
    """A recording's times and driven angles: the speed wobbles, the sampling is uneven, the start is anywhere."""
    g, h = rig.pair.driving, rig.pair.driven
    n = round(condition.turns * g.z * condition.per_mesh)
    seconds = condition.turns * 60.0 / condition.speed
    rate = 2 * pi * condition.speed / 60.0 * g.z / h.z
    ideal = np.arange(n) * (seconds / n)
    time = ideal + rng.uniform(-1, 1, n) * condition.uneven * seconds / n
    turn = 2 * pi * condition.speed / 60.0
    waves = tuple(
        (condition.wobble * rng.uniform(0.3, 1.0), turn * f, rng.uniform(0, 2 * pi))
        for f in (rng.uniform(0.05, 0.2), rng.uniform(0.6, 1.4), rng.uniform(2.1, 3.3))
    )
    start = rng.uniform(-2, 2) * 2 * pi
    plain = Motion(time=time, theta_2=time, span=(0.0, seconds), waves=waves, start=start, rate=rate)
    return Motion(time=time, theta_2=plain.angle(time), span=(0.0, seconds), waves=waves, start=start, rate=rate)


def _rings(rig: Rig, condition: RecordedCondition, path: Motion, at: FloatArray) -> FloatArray:
    """What a mass on a spring adds (mm) to the static transmission error, at times in s.

    The static error, taken as straight between points of a grid, forces the mass; its motion is then exact, at the
    points and between, so that a stiff spring needs no finer grid than a soft one.
    """
    assert rig.resonance is not None
    f_n, zeta = rig.resonance
    omega = 2 * pi * f_n
    mesh_hz = condition.speed / 60.0 * rig.pair.driving.z
    step = 1.0 / (FORCED * mesh_hz)
    # Free vibration has died to 1e-4 after 9 / (zeta omega) seconds; so long it runs before the recording.
    lead = min(9 / (zeta * omega), 0.5 * path.span[1]) + 5 / mesh_hz
    grid = np.arange(path.span[0] - lead, path.span[1] + 2 / mesh_hz, step)
    force = meshing(rig, path.angle(grid), torque=condition.torque, flank=condition.flank, span=path.angles)
    force = force - force.mean()
    denominator = np.array([1.0, 2 * zeta * omega, omega * omega])
    moved = []
    for numerator in ([omega * omega], [omega * omega, 0.0]):  # the mass's place and its speed
        num, den, _ = cont2discrete((np.array(numerator), denominator), step, method="foh")
        moved.append(lfilter(num.ravel(), den, force))
    k = np.clip(((at - grid[0]) / step).astype(int), 0, grid.size - 2)
    gone, rise = at - grid[k], (force[k + 1] - force[k]) / step
    lag = 2 * zeta / omega * rise  # behind a force that rises evenly
    free = moved[0][k] - force[k] + lag
    swing = omega * sqrt(1 - zeta * zeta)
    turn = (moved[1][k] - rise + zeta * omega * free) / swing
    return np.asarray(np.exp(-zeta * omega * gone) * (free * np.cos(swing * gone) + turn * np.sin(swing * gone)) - lag)


def te(rig: Rig, condition: RecordedCondition, path: Motion, *, at: FloatArray | None = None) -> FloatArray:
    """Transmission error in mm along the line of action as noiseless encoders read it, at the path's samples (or at
    times in s)."""
    time = path.time if at is None else at
    theta_2 = path.theta_2 if at is None else path.angle(at)
    x = meshing(rig, theta_2, torque=condition.torque, flank=condition.flank, span=path.angles)
    if rig.resonance is not None:
        x = x + _rings(rig, condition, path, time)
    r_1, r_2 = rig.pair.driving.r_b, rig.pair.driven.r_b
    theta_1 = (r_2 * theta_2 - x) / r_1
    if rig.drift:
        gone = (time - path.span[0]) / (path.span[1] - path.span[0])
        x = x + MM_PER_UM * rig.drift * np.expm1(-rig.drift_bend * gone) / np.expm1(-rig.drift_bend)
    for one in rig.extras:
        x = x + one.x(time, theta_1, theta_2, path.span)
    return np.asarray(x + r_2 * rig.encoder_2.error(theta_2) - r_1 * rig.encoder_1.error(theta_1))


def noise(chain: Chain, n: int, rng: np.random.Generator) -> FloatArray:
    """Noise in mm with the chain's rms and colour, n samples."""
    white = rng.standard_normal(n + 200)
    if chain.colour:
        white = lfilter([sqrt(1 - chain.colour**2)], [1.0, -chain.colour], white)
    return np.asarray(MM_PER_UM * chain.noise_um * white[200:])


def record(rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator) -> str:
    """The text of one recording's CSV, after the contract's layout."""
    r_1, r_2 = rig.pair.driving.r_b, rig.pair.driven.r_b
    lies = noise(chain, path.time.size, rng)
    x = te(rig, condition, path) + lies
    head = [
        f"# torque_nm = {condition.torque:g}",
        f"# speed_rpm = {condition.speed:g}",
        f'# flank = "{condition.flank}"',
    ]
    if chain.known:  # the two zeros are read off the teeth by eye
        rough = [(z + e) % 360.0 for z, e in zip(chain.zeros_deg, rng.normal(0, ZERO_STD, 2), strict=True)]
        head += [f"# driving_zero_deg = {rough[0]:.3f}", f"# driven_zero_deg = {rough[1]:.3f}"]
    for name, direction in zip(("driving", "driven"), chain.directions, strict=True):
        if direction < 0:
            head.append(f"# {name}_direction = -1")
    # The driven encoder takes its part of the noise; the driving one reads what makes the composite error x.
    theta_2 = path.theta_2 + rig.encoder_2.error(path.theta_2) + rng.uniform(0.3, 0.7) * lies / r_2
    theta_1 = (r_2 * theta_2 - x) / r_1
    readings = []
    for theta, zero, direction, step in zip(
        (theta_1, theta_2), chain.zeros_deg, chain.directions, chain.steps_deg, strict=True
    ):
        reading = zero + direction * theta / RAD_PER_DEG
        reading = np.round(reading / step) * step if step else reading
        readings.append(np.mod(reading, 360.0) if chain.wrapped else reading)
    columns = [path.time] if chain.timed else []
    names = ["time_s"] if chain.timed else []
    if chain.column == "te_um":
        columns += [readings[1], x / MM_PER_UM]
        names += ["driven_angle_deg", "te_um"]
        formats = [f"%.{chain.decimals}f", "%.5f"]
    else:
        columns += readings
        names += ["driving_angle_deg", "driven_angle_deg"]
        formats = [f"%.{chain.decimals}f"] * 2
    formats = ([f"%.{min(6, chain.decimals)}f"] if chain.timed else []) + formats
    line = ",".join(formats)
    rows = [line % row for row in zip(*(c.tolist() for c in columns), strict=True)]
    return "\n".join([*head, ",".join(names), *rows]) + "\n"
