"""How the torque of a recording varies along it, where it was recorded sample by sample."""

from __future__ import annotations

import numpy as np

from gearpoly.units import FloatArray

STEADY_TORQUE_PART = 1e-3
"""Part of the torque by which it may be off its mean, and from the stated one, to count as steady: a thousandth of the
deflection is what no two compliance laws agree on."""


def relative_load(torque: FloatArray | None, mean: float, *, meshes: float) -> FloatArray | None:
    """Torque along a recording over its ``mean``, less 1 (n,), from ``torque`` (n,) in the unit of ``mean`` with nan
    where none was read; None where it is steady, or nothing loads the pair.

    It is averaged over one of the ``meshes`` that the recording holds: sensors are noisy, and what varies faster is the
    mesh's own.
    """
    if torque is None or mean <= 0.0 or not np.isfinite(torque).any():
        return None
    n = torque.size
    read = np.isfinite(torque)
    whole = np.interp(np.arange(n), np.flatnonzero(read), torque[read])
    width = max(1, round(n / max(meshes, 1.0)))
    sums = np.concatenate(([0.0], np.cumsum(whole)))
    first = np.maximum(np.arange(n) - width // 2, 0)
    last = np.minimum(np.arange(n) + width - width // 2, n)
    load = (sums[last] - sums[first]) / (last - first) / mean - 1.0
    return np.asarray(load) if np.hypot(np.mean(load), np.std(load)) > STEADY_TORQUE_PART else None


def most_off(load: FloatArray | None) -> float:
    """The most by which a torque is off its mean, as a part of it: 0 where ``load``, as ``relative_load`` has it, is
    steady."""
    return 0.0 if load is None else float(np.max(np.abs(load)))
