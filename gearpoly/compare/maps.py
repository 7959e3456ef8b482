"""The residual by tooth and mesh phase, for both gears and the mean tooth: the hunting decomposition.

r = D_1[n mod z_1, phase] + D_2[n mod z_2, phase] + M[phase]. Over a whole hunting cycle with coprime tooth numbers each
tooth meets every other, and the three separate. With a common divisor g, tooth n only ever meets teeth that leave the
same remainder by g: what all teeth of one remainder share may belong to either gear, and is split evenly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.noise import Noise
from gearpoly.units import FloatArray, IntArray, read_only

SWEEPS = 60
"""Rounds of alternating means at most; unfinished cycles of coprime gears need about ten."""


@dataclass(frozen=True, kw_only=True)
class Maps:
    """Means in mm by mesh phase: ``mean`` (b,) of all teeth, ``driving`` (z_1, b) and ``driven`` (z_2, b) what each
    tooth differs from it; nan where nothing was recorded. ``phase`` (b,) middles of the cells in pitches after the
    pitch point, 0 to 1. ``std_driving``, ``std_driven``: standard error of a cell, from the coloured noise.
    ``confounded`` the greatest common divisor where it is above 1: then only so much separates, as ``note`` says.
    """

    phase: FloatArray
    mean: FloatArray
    driving: FloatArray
    driven: FloatArray
    std_driving: float
    std_driven: float
    confounded: int
    note: str


def covariance(noise: Noise, *, lags: int) -> FloatArray:
    """Autocovariance (lags,) in mm^2 of the noise, by lag in samples, from its spectrum."""
    top = float(noise.frequency[-1])
    even = np.interp(np.linspace(0.0, top, 4097), noise.frequency, noise.density)
    return np.asarray(np.fft.irfft(even)[:lags])


def tooth_maps(u: FloatArray, residual: FloatArray, *, z_1: int, z_2: int, noise: Noise, cells: int = 16) -> Maps:
    """Decompose ``residual`` (n,) in mm at ``u`` (n,) meshes by tooth of each gear and ``cells`` mesh phases."""
    mesh = np.floor(u).astype(np.int64)
    cell = np.minimum(((u - mesh) * cells).astype(np.int64), cells - 1)
    # Only tooth pairs that met matter, so means run over the cells of the hunting cycle.
    period = math.lcm(z_1, z_2)
    place = np.mod(mesh, period) * cells + cell
    count = np.bincount(place, minlength=period * cells).astype(np.float64)
    total = np.bincount(place, weights=residual, minlength=period * cells)
    met = np.flatnonzero(count > 0)
    number, values = count[met], total[met] / count[met]
    meshes, at = met // cells, met % cells
    one, two = np.mod(meshes, z_1) * cells + at, np.mod(meshes, z_2) * cells + at
    m = _mean_by(at, values, number, cells)
    d_1, d_2 = _by_gear(values - m[at], number, one, two, z_1=z_1, z_2=z_2, cells=cells)
    held_1 = np.bincount(one, weights=number, minlength=z_1 * cells)
    held_2 = np.bincount(two, weights=number, minlength=z_2 * cells)
    # All teeth count alike in the mean one, however often each was met.
    for d, held, z in ((d_1, held_1, z_1), (d_2, held_2, z_2)):
        seen = (held > 0).reshape(z, cells)
        middle = np.sum(np.where(seen, d.reshape(z, cells), 0.0), axis=0) / np.maximum(np.sum(seen, axis=0), 1)
        d -= np.tile(middle, z)
        m = m + middle
    # Samples of one visit are neighbours in the noise; visits are too far apart to share it.
    visit = max(1, round(u.size / max(float(u[-1] - u[0]) * cells, 1.0)))
    cov = covariance(noise, lags=visit)
    lag = np.arange(1, visit)
    one_visit = (cov[0] + 2.0 * float(np.sum((1.0 - lag / visit) * cov[1:visit]))) / visit
    return Maps(
        phase=read_only((np.arange(cells) + 0.5) / cells),
        mean=read_only(m),
        driving=read_only(np.where(held_1 > 0, d_1, np.nan).reshape(z_1, cells)),
        driven=read_only(np.where(held_2 > 0, d_2, np.nan).reshape(z_2, cells)),
        std_driving=math.sqrt(max(one_visit, 0.0) * visit / max(float(np.median(held_1)), 1.0)),
        std_driven=math.sqrt(max(one_visit, 0.0) * visit / max(float(np.median(held_2)), 1.0)),
        confounded=math.gcd(z_1, z_2),
        note=_note(z_1, z_2),
    )


def _mean_by(index: IntArray, values: FloatArray, number: FloatArray, size: int) -> FloatArray:
    """Means (size,) of ``values`` (k,), each of ``number`` samples, by ``index``; 0 where there are none."""
    held = np.bincount(index, weights=number, minlength=size)
    total = np.bincount(index, weights=number * values, minlength=size)
    return np.where(held > 0, total / np.maximum(held, 1.0), 0.0)


def _by_gear(
    left: FloatArray, number: FloatArray, one: IntArray, two: IntArray, *, z_1: int, z_2: int, cells: int
) -> tuple[FloatArray, FloatArray]:
    """What each tooth of the driving (z_1 cells,) and the driven gear (z_2 cells,) has of ``left`` (k,), by
    alternating means; ``one`` and ``two`` (k,) are tooth and cell of both gears."""
    d_1, d_2 = np.zeros(z_1 * cells), np.zeros(z_2 * cells)
    coprime = math.gcd(z_1, z_2) == 1
    for _ in range(SWEEPS):
        old = np.concatenate([d_1, d_2])
        c_1 = _mean_by(one, left - d_1[one] - d_2[two], number, z_1 * cells)
        if coprime:
            d_1 = d_1 + c_1
            d_2 = d_2 + _mean_by(two, left - d_1[one] - d_2[two], number, z_2 * cells)
        else:
            # Half steps where the gears share remainders: what is common is split evenly, and the rounds still settle.
            c_2 = _mean_by(two, left - d_1[one] - d_2[two], number, z_2 * cells)
            d_1, d_2 = d_1 + 0.5 * c_1, d_2 + 0.5 * c_2
        if np.max(np.abs(np.concatenate([d_1, d_2]) - old)) < 1e-9:
            break
    return d_1, d_2


def _note(z_1: int, z_2: int) -> str:
    """What does not separate, in words; empty for coprime tooth numbers."""
    if z_1 == z_2:
        return "equal tooth numbers: each tooth meets one mate only, so nothing tells the two gears apart"
    g = math.gcd(z_1, z_2)
    if g == 1:
        return ""
    return (
        f"tooth numbers {z_1} and {z_2} share the divisor {g}: what the teeth of one remainder by {g} have in "
        "common may belong to either gear and is split evenly"
    )
