"""Waves too fast for a shortened record: found among all its samples and taken off before neighbours are averaged.

Means over neighbours would show them as slow waves where there are none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.describe import label_of
from gearpoly.compare.entries import Entry
from gearpoly.compare.even import Even, aliases
from gearpoly.compare.families import SHARES
from gearpoly.compare.lines import TIE, find_peaks
from gearpoly.compare.noise import Noise, NoiseEstimator
from gearpoly.compare.peak import Peak
from gearpoly.compare.sampling import REPEATS, Sampling, sampling_of
from gearpoly.units import UM, FloatArray

BELOW = 0.8
"""Part of the shortened record's highest frequency from which on waves are looked for here; the search proper sees what
is slower as well."""

FAST_ROUNDS, SAME_ROUND = 8, 0.5
"""Most rounds, and the part of the strongest wave's gain from which others are taken in its round."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fast:
    """What a recording's ``residual`` (n,) in mm is without its fast waves, the ``entries`` these make, and the
    ``noise`` of all its samples."""

    residual: FloatArray
    entries: tuple[Entry, ...]
    noise: Noise


def without_fast_waves(
    u: FloatArray,
    time_s: FloatArray | None,
    residual: FloatArray,
    *,
    k: int,
    spacing: float,
    z_1: int,
    z_2: int,
    recordings: int,
    floor: float,
    even: Even,
) -> Fast:
    """The ``residual`` (n,) in mm at ``u`` (n,) meshes of recording ``k`` of a set of ``recordings``, which is to be
    shortened to samples ``spacing`` meshes apart; waves below ``floor`` in mm are left."""
    estimator = NoiseEstimator(u, z_1=z_1, z_2=z_2)
    kept = estimator.kept
    lines = sampling_of(u=u[kept], time=None if time_s is None else time_s[kept], z_1=z_1, z_2=z_2)
    least = BELOW * 0.5 / spacing
    taken: list[tuple[Peak, FloatArray]] = []
    for turn in range(FAST_ROUNDS + 1):
        rest, repeating = estimator.parted(residual)
        repeats = float(np.std(repeating))
        del repeating
        noise = estimator.noise_in(rest, repeats=repeats)
        if turn == FAST_ROUNDS:
            break
        white = noise.whitened(rest)
        del rest  # the spectra need the room
        found = []
        for peak in find_peaks(lines, white, noise, recordings=recordings, least=least):
            places = lines.per_mesh(peak) * lines.period
            repeats_too = abs(places - round(places)) * lines.span / lines.period < REPEATS
            if not peak.known and lines.per_mesh(peak) >= least and (peak.domain == "time" or not repeats_too):
                found.append(peak)
        del white
        if not found:
            break
        rest, _ = estimator.parted(residual)
        # What is much weaker may be the strongest one's smear, over time or over angle.
        for peak in [p for p in found if p.gain >= SAME_ROUND * found[0].gain]:
            whole = time_s if peak.domain == "time" else u
            assert whole is not None  # no peaks over time without time
            waves = _waves(peak, whole)
            # What repeats was fitted first and took a part of the wave: compare like with like.
            seen = np.column_stack([estimator.parted(wave)[0] for wave in waves.T])
            ab = np.asarray(np.linalg.lstsq(seen, rest, rcond=None)[0], dtype=np.float64)
            if np.hypot(*ab) >= floor:
                taken.append((peak, ab))
            rest = rest - seen @ ab
            residual = residual - waves @ ab
        del seen, waves
    entries = []
    for peak, ab in taken:
        level = float(np.interp(lines.per_mesh(peak), noise.frequency, noise.density))
        std = math.sqrt(2.0 * level / lines.u.size)
        entries.append(_entry(peak, ab, std, k=k, z_1=z_1, z_2=z_2, lines=lines, even=even))
    return Fast(residual=residual, entries=tuple(entries), noise=noise)


def _waves(peak: Peak, x: FloatArray) -> FloatArray:
    """Cosine and sine (n, 2) at ``x`` (n,)."""
    angle = 2.0 * math.pi * peak.frequency * x
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _entry(peak: Peak, ab: FloatArray, std: float, *, k: int, z_1: int, z_2: int, lines: Sampling, even: Even) -> Entry:
    amplitude = float(np.hypot(*ab))
    timed = peak.domain == "time"
    tie = lines.time_grid is not None and peak.gain - peak.rival <= TIE
    per_mesh = lines.pace if lines.time_grid is not None else 1.0
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
        label="" if timed else label_of(peak.frequency, z=(z_1, z_2), span=lines.span),
        rivals=rivals,
        aliases=aliases(peak.frequency, even.time) if timed else aliases(peak.frequency * z_1, even.driving),
        gain=(amplitude / std) ** 2,
    )
