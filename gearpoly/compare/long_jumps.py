"""Jumps in records too long to be searched whole: suspected among all samples, weighed in a stretch about their place,
and taken off before the record is shortened."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearpoly.compare.describe_jumps import jump_entries
from gearpoly.compare.entries import Entry
from gearpoly.compare.jump_search import AS_MODELLED, JUMP_STAYS_TURNS
from gearpoly.compare.jumps import Left, weigh_steps
from gearpoly.compare.model import JointModel
from gearpoly.compare.noise import NoiseEstimator
from gearpoly.compare.reduce import SAMPLES_SEARCHED, shortening
from gearpoly.compare.search import run_search
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.compare.slow import FINE_TERMS, slow_curves
from gearpoly.compare.sudden import sudden
from gearpoly.units import UM, BoolArray, FloatArray

SUSPECT_MEANS = 4096
"""Means that stand for the whole record while jumps are suspected only; how sharp they are shows in the stretch."""

MOST_STRETCHES = 6
"""Most stretches that are looked at closely."""


def without_jumps(
    data: AlignedResidual, *, k: int, gears: tuple[GearKnown, GearKnown], floor: float
) -> tuple[AlignedResidual, list[Entry]]:
    """Recording ``k`` without its jumps, and the entries that these make; as it is where it can be searched whole."""
    entries: list[Entry] = []
    if data.residual.size <= SAMPLES_SEARCHED:
        return data, entries
    estimator = NoiseEstimator(data.u, z_1=gears[0].z, z_2=gears[1].z)
    barred = np.zeros(data.residual.size, dtype=np.bool_)
    turn = JUMP_STAYS_TURNS * max(gear.z for gear in gears)
    period = float(math.lcm(gears[0].z, gears[1].z))
    at_once = list(sudden(data.u, data.residual, turn=turn, period=period))
    for _ in range(MOST_STRETCHES):
        at = at_once.pop(0) if at_once else _suspect(data, estimator, gears=gears, barred=barred)
        if at is None:
            break
        low, high = (int(np.searchsorted(data.u, data.u[at] + side * turn)) for side in (-1.0, 1.0))
        barred[low:high] = True
        for entry in _about(data, at, gears=gears, floor=floor):
            place = sample_of(entry, time_s=data.time_s, theta_1=data.theta_1)
            residual = data.residual.copy()
            residual[place:] -= (entry.amplitude_um or 0.0) * UM
            data = replace(data, residual=residual)
            entries.append(replace(entry, recordings=(k,)))
    return data, entries


def sample_of(entry: Entry, *, time_s: FloatArray | None, theta_1: FloatArray) -> int:
    """The first sample after a jump, in a recording at ``time_s`` (n,) in s and ``theta_1`` (n,) in rad."""
    if entry.time_s is not None and time_s is not None:
        return int(np.searchsorted(time_s, entry.time_s))
    return int(np.searchsorted((theta_1 - theta_1[0]) / (2.0 * math.pi), entry.driving_turn or 0.0))


def _suspect(
    data: AlignedResidual, estimator: NoiseEstimator, *, gears: tuple[GearKnown, GearKnown], barred: BoolArray
) -> int | None:
    """The sample at which what does not repeat steps most, if its noise would hardly step so much anywhere."""
    rest, _ = estimator.parted(data.residual)
    group = -(-rest.size // SUSPECT_MEANS)
    size = rest.size // group

    def means(values: FloatArray) -> FloatArray:
        return np.asarray(values[: size * group].reshape(size, group).mean(axis=1))

    u, short = means(data.u), means(rest)
    noise = NoiseEstimator(u, z_1=gears[0].z, z_2=gears[1].z).estimate(short)
    white = noise.whitened(slow_curves(u, FINE_TERMS))
    normal = np.asarray(np.linalg.inv(white.T @ white), dtype=np.float64)
    target = noise.whitened(short)
    beta = normal @ (white.T @ target)
    left = Left(
        whites=(white,),
        beta=beta,
        covariance=normal,
        rest=target - white @ beta,
        noise=noise,
    )
    turn = JUMP_STAYS_TURNS * max(gear.z for gear in gears)
    low, high = (int(np.searchsorted(u, at)) for at in (u[0] + turn, u[-1] - turn))
    if low >= high:  # so short a recording shows of no step that it stays
        return None
    steps = weigh_steps(left, low=low, high=high, barred=barred[: size * group : group])
    gain = steps.at(steps.best)[0]
    return steps.best * group if steps.log_false(gain, colour=(1.0, AS_MODELLED), recordings=1) < 0.0 else None


def _about(data: AlignedResidual, at: int, *, gears: tuple[GearKnown, GearKnown], floor: float) -> list[Entry]:
    """The jumps in a stretch about sample ``at`` that is short enough to be searched whole."""
    group = shortening(data.u, z_1=gears[0].z, z_2=gears[1].z).group
    begin = max(0, min(at - group * SAMPLES_SEARCHED // 2, data.u.size - group * SAMPLES_SEARCHED))
    here = slice(begin, begin + group * SAMPLES_SEARCHED)
    stretch = replace(
        data,
        theta_1=data.theta_1[here],
        theta_2=data.theta_2[here],
        residual=data.residual[here],
        time_s=None if data.time_s is None else data.time_s[here],
    )
    search = JointModel([shortening(stretch.u, z_1=gears[0].z, z_2=gears[1].z).of(stretch)], gears, floor)
    solution = run_search(search)
    before = float(stretch.theta_1[0] - data.theta_1[0]) / (2.0 * math.pi)
    return [
        entry if entry.driving_turn is None else replace(entry, driving_turn=entry.driving_turn + before)
        for entry in jump_entries(search, solution, 0)
    ]
