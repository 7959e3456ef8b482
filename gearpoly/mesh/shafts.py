"""What lies between the mesh and the encoders: shafts that twist under torque, and a mesh that swings at speed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.units import FloatArray

RUN_UP_SPEED_PART = 0.05
"""Part of its mean by which a recording's speed may go up and down before it counts as a run-up, which meets a
resonance at many speeds: near one of damping 0.05 half of that moves the gain by a tenth at most."""

STEPS_PER_SWING, STEPS_PER_PITCH = 24.0, 128.0
"""Steps in time per period of the resonance and of the mesh, at the fastest, in which a speed is followed; straight
lines between are off by (2 pi / 24)^2 / 12 of what swings at the resonance itself."""

FINEST_STEPS = 4.0
"""Times as many steps at most for a resonance far above the mesh: it follows, and what swings of it is nothing."""

LEAD_IN_DECAY_TIMES, LONGEST_LEAD_IN_PART = 6.0, 0.5
"""Decay times of a swing that a recording is taken to have run before it began, at its first speed, and the most of
it as a part of the recording."""

BEGUN = 4.0
"""Pitches over which that speed is taken."""

TOO_FAST = 0.25
"""Frequency at which bends between even places count as a wave, as a part of the places' rate. Found here: of 0.25, 0.5
and 1 that at which resonances from the mesh frequency to 300 times that come out best beside a far finer curve."""

LEAST_STEP = 1e-7
"""Shortest step in s: no recording that anyone makes asks for more."""


@dataclass(frozen=True, kw_only=True)
class Shafts:
    """``windup`` in rad of driven rotation per N.mm of driven torque; natural ``frequency`` in Hz of the torsional
    resonance (None: none), its ``damping`` ratio, and the part of the damping that acts ``in_mesh``: it is moved by
    the teeth's own velocity too, the rest brakes against what stands still."""

    windup: float = 0.0
    frequency: float | None = None
    damping: float = 0.05
    in_mesh: float = 0.0

    @property
    def rigid(self) -> bool:
        """Whether they change nothing."""
        return self.windup == 0.0 and self.frequency is None

    def twist(self, *, torque: float, coast: bool) -> float:
        """Transmission error in rad under ``torque`` in N.mm: the driven side lags on the drive flank."""
        return (1.0 if coast else -1.0) * self.windup * torque

    def swings(self, te: FloatArray, *, period: float) -> FloatArray:
        """What the resonance adds to ``te`` (n,), even places over a ``period`` in s: every harmonic of frequency f
        is magnified by (1 + 2 i e D f/f_n)/(1 - (f/f_n)^2 + 2 i D f/f_n), e the part of the damping in the mesh.

        The static transmission error excites a mass between mesh stiffness and nothing (Tuplin 1953), with e = 1 where
        the mesh damps alone (Ozguven and Houser 1988); 0 where there is no resonance.
        """
        if self.frequency is None:
            return np.zeros(te.size)
        spectrum = np.fft.rfft(te)
        gain = self.gain(np.arange(spectrum.size) / period)
        gain[0] = 1.0
        return np.fft.irfft(spectrum * (gain - 1.0), te.size)

    def gain(self, frequency: FloatArray) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
        """Response over excitation at frequencies (n,) in Hz."""
        if self.frequency is None:
            return np.ones(frequency.shape, dtype=np.complex128)
        r = frequency / self.frequency
        braked = 2j * self.damping * r
        return np.asarray((1.0 + self.in_mesh * braked) / (1.0 - r**2 + braked), dtype=np.complex128)

    def follows(self, te: FloatArray, *, step: float) -> FloatArray:
        """What the resonance adds to ``te`` (n,) or (n, m), ``step`` s apart, once at rest at its first value.

        The equation of motion x'' + 2 D w (x' - e te') + w^2 (x - te) = 0 with e the part of the damping in the mesh,
        solved exactly for straight lines between the values.
        """
        if self.frequency is None:
            return np.zeros(te.shape)
        from scipy.signal import cont2discrete, lfilter  # slow to import, and few pairs swing

        w = 2.0 * math.pi * self.frequency
        braked = 2.0 * self.damping * w
        # A leading zero would be refused.
        upper = np.array([self.in_mesh * braked, w * w])[0 if self.in_mesh > 0.0 else 1 :]
        system = (upper, np.array([1.0, braked, w * w]))
        numerator, denominator, _ = cont2discrete(system, step, method="foh")
        off = te - te[0]
        return np.asarray(lfilter(np.ravel(numerator), np.ravel(denominator), off, axis=0) - off)

    def unmoved(self, missed: FloatArray, *, rate: float) -> FloatArray:
        """What the resonance adds (n,) where straight lines between places that come at ``rate`` Hz have ``missed``
        (n,) of what excites it: bends that are over before it moves, so it stays where it is."""
        if self.frequency is None:
            return np.zeros(missed.shape)
        return -missed / (1.0 + (self.frequency / (TOO_FAST * rate)) ** 2)

    def magnified(self, changes: FloatArray, *, time: FloatArray) -> FloatArray:
        """What ``changes`` (n,) or (n, m) of the excitation at ``time`` (n,) in s, in their unit, become, straight from
        sample to sample: for derivatives, since curves may bend between samples."""
        if self.frequency is None or time.size < 2:
            return changes
        step = max(float(time[-1] - time[0]) / (time.size - 1), LEAST_STEP)
        steps = np.arange(time.size, dtype=np.float64)
        even = _between(changes, np.interp(time[0] + step * steps, time, steps))
        return changes + _between(self.follows(even, step=step), (time - time[0]) / step)


def _between(values: FloatArray, place: FloatArray) -> FloatArray:
    """Values (n,) or (n, m) at places (k,) among their rows, straight from row to row."""
    before = np.clip(place.astype(np.int64), 0, len(values) - 2)
    part = (place - before).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray((1.0 - part) * values[before] + part * values[before + 1])


def runs_up(theta: FloatArray, time: FloatArray | None) -> tuple[float, float] | None:
    """The least and the largest speed in rad/s of a shaft at ``theta`` (n,) in rad over ``time`` (n,) in s, by its
    turns, where they differ so much that a resonance is not met at one speed; else ``None``."""
    if time is None:
        return None
    turns = np.floor((theta - theta[0]) * (np.sign(theta[-1] - theta[0]) / (2.0 * math.pi)))
    begin = np.flatnonzero(np.diff(turns, prepend=-1.0) > 0.0)
    if begin.size < 2:
        return None
    speeds = np.abs(np.diff(theta[begin]) / np.maximum(np.diff(time[begin]), LEAST_STEP))
    low, high = float(np.min(speeds)), float(np.max(speeds))
    return (low, high) if high - low > RUN_UP_SPEED_PART * float(np.mean(speeds)) else None


def swings_along(
    shafts: Shafts,
    te: FloatArray,
    *,
    cycle: float,
    pitch: float,
    theta_2: FloatArray,
    time: FloatArray,
    here: FloatArray,
) -> FloatArray:
    """What the resonance adds (n,) to a pair's transmission error ``te`` (m,), at even places of a hunting ``cycle``
    in rad, at ``theta_2`` (n,) in rad passed at ``time`` (n,) in s, however the speed changes, where that error is
    ``here`` (n,); ``pitch`` in rad of driven rotation."""
    if shafts.frequency is None:
        return np.zeros(theta_2.size)
    ends = runs_up(theta_2, time)
    fastest = abs(theta_2[-1] - theta_2[0]) / (time[-1] - time[0]) if ends is None else ends[1]
    mesh, lasts = STEPS_PER_PITCH * fastest / pitch, float(time[-1] - time[0])
    step = max(1.0 / float(np.clip(STEPS_PER_SWING * shafts.frequency, mesh, FINEST_STEPS * mesh)), LEAST_STEP)
    ago = min(LEAD_IN_DECAY_TIMES / (2.0 * math.pi * shafts.frequency * shafts.damping), LONGEST_LEAD_IN_PART * lasts)
    ahead = np.arange(-ago, lasts + step, step)
    begun = min(int(np.searchsorted(np.abs(theta_2 - theta_2[0]), BEGUN * pitch)), theta_2.size - 1)
    first = (theta_2[begun] - theta_2[0]) / (time[begun] - time[0])
    there = np.where(ahead < 0.0, theta_2[0] + first * ahead, np.interp(ahead, time - time[0], theta_2))
    even = np.arange(te.size) * (cycle / te.size)
    followed = np.interp(there, even, te, period=cycle)
    added, known = (np.interp(time - time[0], ahead, one) for one in (shafts.follows(followed, step=step), followed))
    rate = min(1.0 / step, abs(theta_2[-1] - theta_2[0]) / (time[-1] - time[0]) * te.size / cycle)
    return np.asarray(added + shafts.unmoved(here - known, rate=rate))
