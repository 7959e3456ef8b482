"""Long recordings made short enough to search, without losing what teeth can do.

Samples closer than a tooth's shape changes are averaged in groups; of many hunting cycles, as many whole ones are
searched as fit. The noise level is always taken from every sample.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearpoly.compare.noise import spacing_of, whole_cycles
from gearpoly.compare.set_up import AlignedResidual
from gearpoly.units import FloatArray

PER_MESH = 24.0
"""Samples per mesh that averaging leaves at least: orders up to 12 per mesh, hand-overs to a twenty-fourth of a
pitch."""

SAMPLES = 40960
"""Samples searched in one recording: of an 18/25 pair three hunting cycles at 24 to 30 per mesh. The normal matrix has
to come from all of them (teeth imitate the first orders of their shaft to a thousandth), so they decide the time."""


def spacing_after(data: AlignedResidual) -> float | None:
    """Meshes from sample to sample once ``data`` is shortened; ``None`` where its samples stay as they are."""
    group = _group(data)
    return None if group == 1 else group * spacing_of(data.u)


def _group(data: AlignedResidual) -> int:
    return 1 if data.u.size <= SAMPLES else max(1, int(1.0 / (spacing_of(data.u) * PER_MESH)))


def reduced(data: AlignedResidual, *, z_1: int, z_2: int) -> AlignedResidual:
    """``data``, or a shorter one: means of neighbouring samples, then whole hunting cycles from its beginning."""
    n = data.u.size
    if n <= SAMPLES:
        return data
    group = _group(data)
    out = data if group == 1 else _averaged(data, group)
    if out.u.size <= SAMPLES:
        return out
    period = float(math.lcm(z_1, z_2))
    cycles = whole_cycles(out.u[:SAMPLES], period)
    # Fewer than two whole cycles do not repeat: rather search a longer stretch then.
    if cycles < 2 and whole_cycles(out.u, period) >= 2:
        cycles = 2
    end = int(np.searchsorted(out.u, out.u[0] + cycles * period)) if cycles >= 2 else SAMPLES
    return _cut(out, end)


def _averaged(data: AlignedResidual, group: int) -> AlignedResidual:
    size = data.u.size // group

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(values[: size * group].reshape(size, group, *values.shape[1:]).mean(axis=1), dtype=np.float64)

    return replace(
        data,
        averaged=group * spacing_of(data.u),
        theta_1=mean(data.theta_1),
        theta_2=mean(data.theta_2),
        residual=mean(data.residual),
        time_s=None if data.time_s is None else mean(data.time_s),
        nuisance=None if data.nuisance is None else mean(data.nuisance),
    )


def _cut(data: AlignedResidual, end: int) -> AlignedResidual:
    return replace(
        data,
        theta_1=data.theta_1[:end],
        theta_2=data.theta_2[:end],
        residual=data.residual[:end],
        time_s=None if data.time_s is None else data.time_s[:end],
        nuisance=None if data.nuisance is None else data.nuisance[:end],
    )
