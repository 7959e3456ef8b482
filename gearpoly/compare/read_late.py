"""Angles of both shafts that were read at different moments: a transmission error that follows the speed.

Derived here. Where the driven angle is read by delta later than the driving one, it has turned on by delta times its
speed meanwhile. At even speed that is a part of the zero. Where the speed changes, the transmission error follows it:
3 ms between two loggers are 230 um where the driven shaft of a 24/35 of module 1.5 turns by 13 to 42 rpm. Two clocks
that do not run alike let delta grow. What is seen so is taken off, and told.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.sinusoids import cosine_and_sine
from gearpoly.compare.slow import slow_curves
from gearpoly.mesh.pair import GearPair
from gearpoly.recording.clean import Cleaned
from gearpoly.units import UM, BoolArray, FloatArray

FEWEST_MESH_MEANS = 60
"""Means over a mesh from which on the speed is looked for in them: half of them foretell the rest, with 18 unknowns."""

UNSTEADY = 0.01
"""Relative rms of the speed from which on it is looked for: at less, 1 ms is a tenth of a micron at 60 rpm."""

FORETOLD_LEFT_PART, FEWEST_SPEED_SWINGS, FORETOLD_LEFT_PART_SLOWLY = 0.1, 8, 0.002
"""Part of the square of what unseen stretches hold that may be left once the speed is in, where the speed swings so
many times across its slow course, and where it swings less. Of chance courses of drift and speed (rms 1 to 30 %) that
swing 8 to 12 times 4 in 1000 came below a tenth, of 578 that swing more often none. Of 4261 with fewer swings none came
below 0.008."""

SWING_PART = 0.5
"""Part of the rms of the speed's swing that a swing has on either side. A judgement: a sine has 1.41 of it."""

FORETOLD_STRETCHES = 8
"""Contiguous stretches of a recording, of which every other one is foretold by the rest."""

ORDERS_BESIDE = 3
"""Orders of both shafts fitted beside: speed and eccentricity may both come once per turn."""

RATE_SEEN = 5.0
"""Standard errors from which on both clocks are taken to run at different rates."""

SPEED_MEANS_PER_MESH, SAMPLES_PER_MEAN = 4, 4
"""Means per mesh, and samples in each at least, that give the speed which is taken off."""


@dataclass(frozen=True, kw_only=True)
class Late:
    """The driven angle was read ``by`` s (standard error ``std``) after the driving one in the middle of a recording,
    and ``rate`` s per s later as it went on (0: it stayed); ``size`` in mm is what that makes between slow and fast."""

    by: float
    std: float
    rate: float
    size: float

    @property
    def says(self) -> str:
        """The same in words."""
        which = "after" if self.by > 0.0 else "before"
        clocks = f", and both clocks differ by {abs(self.rate) * 1e6:.3g} s in a million" if self.rate else ""
        return (
            f"the transmission error follows the speed by {self.size / UM:.3g} um, as if the driven angle were read "
            f"{abs(self.by) * 1e3:.4g} +- {self.std * 1e3:.2g} ms {which} the driving angle{clocks}; it is taken off. "
            "What drags with the speed on soft shafts would look the same"
        )


def on_one_clock(cleaned: Sequence[Cleaned], pair: GearPair) -> list[Cleaned]:
    """The recordings, each whose transmission error follows the speed without that, and with a word of it."""
    out = []
    for one in cleaned:
        late = read_late(one, pair)
        if late is None:
            out.append(one)
            continue
        assert one.time_s is not None
        t, cells = one.time_s, _cells(one, pair, per_mesh=SPEED_MEANS_PER_MESH, least=SAMPLES_PER_MEAN)
        x = t - 0.5 * (t[0] + t[-1])
        sense = -1.0 if one.backward else 1.0
        speed = np.interp(t, cells.time, cells.speed)
        behind = sense * (late.by + late.rate * sense * x) * speed
        recording = replace(one.recording, remarks=(late.says, *one.recording.remarks))
        out.append(replace(one, te=one.te - behind, theta_2=one.theta_2 - behind, recording=recording))
    return out


@dataclass(frozen=True, kw_only=True, eq=False)
class _Cells:
    """Means over stretches of the mesh: ``time`` (k,) in s, ``te`` (k,) in mm, ``theta_2`` and ``theta_1`` (k,) in rad,
    and the driven shaft's ``speed`` (k,) in rad/s there."""

    time: FloatArray
    te: FloatArray
    theta_1: FloatArray
    theta_2: FloatArray
    speed: FloatArray


def _cells(one: Cleaned, pair: GearPair, *, per_mesh: int, least: int) -> _Cells:
    """Means over ``per_mesh`` parts of a mesh, of ``least`` samples or more."""
    assert one.time_s is not None
    u = one.theta_2 / pair.driven.gear.tau
    per_mesh = max(1, min(per_mesh, int(one.size / max(float(np.ptp(u)), 1e-300) / least)))
    _, cell = np.unique(np.floor((u - u[0]) * per_mesh), return_inverse=True)
    held = np.bincount(cell)
    time, te, theta_1, theta_2 = (
        np.bincount(cell, weights=values) / held
        for values in (one.time_s, one.te * pair.r_b2, one.theta_1, one.theta_2)
    )
    # From the first sample of each to the first of the next: the mean over all of it.
    first = np.cumsum(held) - held
    last = np.minimum(first + held, one.size - 1)
    took = one.time_s[last] - one.time_s[first]
    speed = np.zeros(time.size)
    np.divide(one.theta_2[last] - one.theta_2[first], took, out=speed, where=took > 0.0)
    if time.size > 1 and took[-1] <= 0.0:
        speed[-1] = speed[-2]
    return _Cells(time=time, te=te, theta_1=theta_1, theta_2=theta_2, speed=speed)


def read_late(one: Cleaned, pair: GearPair) -> Late | None:
    """By how much the driven angle of a recording was read after the driving one; None where the speed hardly changes,
    where the transmission error does not follow it, or no time was recorded."""
    if one.time_s is None or one.recording.from_time or one.recording.computed:
        return None
    cells = _cells(one, pair, per_mesh=1, least=1)
    speed = cells.speed
    mean = float(np.mean(speed))
    if speed.size < FEWEST_MESH_MEANS or mean <= 0.0 or float(np.std(speed)) < UNSTEADY * mean:
        return None
    x = cells.time - 0.5 * (one.time_s[0] + one.time_s[-1])
    orders = np.arange(1.0, ORDERS_BESIDE + 1.0) / (2.0 * math.pi)
    waves = [cosine_and_sine(angle, orders) for angle in (cells.theta_1, cells.theta_2)]
    beside = np.concatenate([slow_curves(x), *waves], axis=1)
    swing = speed - beside @ np.linalg.lstsq(beside, speed, rcond=None)[0]
    part = FORETOLD_LEFT_PART if _swings(swing) >= FEWEST_SPEED_SWINGS else FORETOLD_LEFT_PART_SLOWLY
    whole = np.column_stack([pair.r_b2 * speed, pair.r_b2 * speed * x, beside])
    block = np.minimum(np.arange(x.size) * FORETOLD_STRETCHES // x.size, FORETOLD_STRETCHES - 1) % 2 == 0
    for columns in (whole[:, [0, *range(2, whole.shape[1])]], whole):
        if _foretold(columns, cells.te, block) < part * _foretold(beside, cells.te, block):
            break
    else:
        return None
    beta, std = _fit(whole, cells.te)
    rate = float(beta[1]) if abs(beta[1]) > RATE_SEEN * std[1] else 0.0
    if not rate:
        beta, std = _fit(whole[:, [0, *range(2, whole.shape[1])]], cells.te)
    sense = -1.0 if one.backward else 1.0
    size = pair.r_b2 * abs(float(beta[0])) * float(np.ptp(speed))
    return Late(by=sense * float(beta[0]), std=float(std[0]), rate=rate, size=size)


def _swings(values: FloatArray) -> int:
    """How often ``values`` (n,) go from one side to the other, farther than half of their rms on both: a run that
    starts and stops swings twice, however much its even part trembles."""
    far = values[np.abs(values) > SWING_PART * float(np.sqrt(np.mean(values**2)))]
    return int(np.count_nonzero(np.diff(np.sign(far))))


def _fit(columns: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least squares (q,) of ``columns`` (n, q) and their standard errors in what is left."""
    beta = np.linalg.lstsq(columns, values, rcond=None)[0]
    left = values - columns @ beta
    spread = float(left @ left) / max(values.size - beta.size, 1)
    variance = spread * np.maximum(np.diag(np.linalg.pinv(columns.T @ columns)), 0.0)
    return np.asarray(beta), np.asarray(np.sqrt(variance))


def _foretold(columns: FloatArray, values: FloatArray, block: BoolArray) -> float:
    """Sum of squares of what either half of ``values`` (n,) keeps of what the other half foretells of it."""
    total = 0.0
    for seen in (block, ~block):
        beta = np.linalg.lstsq(columns[seen], values[seen], rcond=None)[0]
        total += float(np.sum((values[~seen] - columns[~seen] @ beta) ** 2))
    return total
