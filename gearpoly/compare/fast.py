"""Waves too fast for a shortened record: found among all its samples and taken off before neighbours are averaged.

Means over neighbours would show them as slow waves where there are none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.entries import Entry
from gearpoly.compare.families import SHARES
from gearpoly.compare.lines import TIE, LineSearch, Peak
from gearpoly.compare.noise import Noise, NoiseEstimator
from gearpoly.compare.set_up import AlignedResidual
from gearpoly.units import UM, FloatArray

BELOW = 0.8
"""Part of the shortened record's highest frequency from which on waves are looked for here; the search proper sees what
is slower as well."""

REPEATS = 0.4
"""Independent lines within which a wave may repeat with the pair: a fine shape of the teeth."""


ROUNDS, TOGETHER = 8, 0.5
"""Most rounds, and the part of the strongest wave's gain from which others are taken in its round."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fast:
    """A recording without its fast waves, the ``entries`` these make, and the ``noise`` of all its samples."""

    data: AlignedResidual
    entries: tuple[Entry, ...]
    noise: Noise


def without_fast_waves(
    data: AlignedResidual, *, k: int, spacing: float, z_1: int, z_2: int, recordings: int, floor: float
) -> Fast:
    """Recording ``k`` of a set of ``recordings`` that is to be shortened to samples ``spacing`` meshes apart; waves
    below ``floor`` in mm are left."""
    estimator = NoiseEstimator(data.u, z_1=z_1, z_2=z_2)
    noise = estimator.estimate(data.residual)
    kept = estimator.kept
    rest, _ = estimator.parted(data.residual)
    u, t = data.u[kept], None if data.time_s is None else data.time_s[kept]
    lines = LineSearch(u=u, time=t, z_1=z_1, z_2=z_2)
    least = BELOW * 0.5 / spacing
    taken: list[tuple[Peak, FloatArray]] = []
    residual = data.residual
    for _ in range(ROUNDS):
        found = []
        for peak in lines.peaks(noise.whitened(rest), noise, recordings=recordings):
            places = lines.per_mesh(peak) * lines.period
            repeats = abs(places - round(places)) * lines.span / lines.period < REPEATS
            if not peak.known and lines.per_mesh(peak) >= least and (peak.domain == "time" or not repeats):
                found.append(peak)
        # What is much weaker may be the strongest one's smear, over time or over angle.
        for peak in [p for p in found if p.gain >= TOGETHER * found[0].gain]:
            whole = data.time_s if peak.domain == "time" else data.u
            assert whole is not None  # no peaks over time without time
            waves = _waves(peak, whole)
            # What repeats was fitted first and took a part of the wave: compare like with like.
            seen = np.column_stack([estimator.parted(wave)[0] for wave in waves.T])
            ab = np.asarray(np.linalg.lstsq(seen, rest, rcond=None)[0], dtype=np.float64)
            if np.hypot(*ab) >= floor:
                taken.append((peak, ab))
            rest = rest - seen @ ab
            residual = residual - waves @ ab
        if not found:
            break
        noise = estimator.estimate(residual)
    entries = []
    for peak, ab in taken:
        level = float(np.interp(lines.per_mesh(peak), noise.frequency, noise.density))
        entries.append(_entry(peak, ab, math.sqrt(2.0 * level / u.size), k=k, z_1=z_1, z_2=z_2, lines=lines))
    return Fast(data=replace(data, residual=residual), entries=tuple(entries), noise=noise)


def _waves(peak: Peak, x: FloatArray) -> FloatArray:
    """Cosine and sine (n, 2) at ``x`` (n,)."""
    angle = 2.0 * math.pi * peak.frequency * x
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _entry(peak: Peak, ab: FloatArray, std: float, *, k: int, z_1: int, z_2: int, lines: LineSearch) -> Entry:
    amplitude = float(np.hypot(*ab))
    timed = peak.domain == "time"
    tie = lines.time_grid is not None and peak.gain - peak.rival <= TIE
    per_mesh = lines.dt / lines.spacing if lines.time_grid is not None else 1.0
    rivals: tuple[str, ...]
    if timed:
        rivals = (f"order {peak.frequency * per_mesh * z_1:.4g} of the driving shaft",) if tie else ()
    else:
        rivals = (f"order {peak.frequency * z_2:.4g} of the driven shaft",)
        rivals += (f"{peak.frequency / per_mesh:.4g} Hz",) if tie else ()
    return Entry(
        kind="time" if timed else "shaft_order",
        gear=None if timed else "driving",
        order=None if timed else peak.frequency * z_1,
        order_std=None if timed else peak.std * z_1,
        hz=peak.frequency if timed else None,
        hz_std=peak.std if timed else None,
        amplitude_um=amplitude / UM,
        std_um=std / UM,
        phase_deg=math.degrees(math.atan2(ab[1], ab[0])),
        recordings=(k,),
        p_value=float((SHARES.time if timed else SHARES.between) * math.exp(min(0.0, peak.log_false))),
        label="" if timed else "no integer of either shaft",
        rivals=rivals,
        gain=(amplitude / std) ** 2,
    )
