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
from gearpoly.units import FloatArray, read_only

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
    one, two = np.mod(mesh, z_1) * cells + cell, np.mod(mesh, z_2) * cells + cell
    # Only tooth pairs that met matter, so means run over the cells of the hunting cycle.
    period = math.lcm(z_1, z_2)
    place = np.mod(mesh, period) * cells + cell
    count = np.bincount(place, minlength=period * cells).astype(np.float64)
    total = np.bincount(place, weights=residual, minlength=period * cells)
    met = np.flatnonzero(count > 0)
    number, values = count[met], total[met] / count[met]
    meshes, at = met // cells, met % cells
    one, two = np.mod(meshes, z_1) * cells + at, np.mod(meshes, z_2) * cells + at

    def mean_by(index: np.ndarray[tuple[int, ...], np.dtype[np.int64]], v: FloatArray, size: int) -> FloatArray:
        held = np.bincount(index, weights=number, minlength=size)
        return np.where(held > 0, np.bincount(index, weights=number * v, minlength=size) / np.maximum(held, 1.0), 0.0)

    m = mean_by(at, values, cells)
    left = values - m[at]
    d_1, d_2 = np.zeros(z_1 * cells), np.zeros(z_2 * cells)
    # Half steps where the gears share remainders, so that what is common is split evenly and the rounds still settle.
    g = math.gcd(z_1, z_2)
    share = 1.0 if g == 1 else 0.5
    for _ in range(SWEEPS):
        old = np.concatenate([d_1, d_2])
        c_1 = mean_by(one, left - d_1[one] - d_2[two], z_1 * cells)
        c_2 = mean_by(two, left - d_1[one] - d_2[two], z_2 * cells)
        if g == 1:
            d_1 = d_1 + c_1
            c_2 = mean_by(two, left - d_1[one] - d_2[two], z_2 * cells)
            d_2 = d_2 + c_2
        else:
            d_1, d_2 = d_1 + share * c_1, d_2 + share * c_2
        if np.max(np.abs(np.concatenate([d_1, d_2]) - old)) < 1e-9:
            break
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
    std_1 = math.sqrt(max(one_visit, 0.0) * visit / max(float(np.median(held_1)), 1.0))
    std_2 = math.sqrt(max(one_visit, 0.0) * visit / max(float(np.median(held_2)), 1.0))
    note = ""
    if g > 1:
        note = (
            f"tooth numbers {z_1} and {z_2} share the divisor {g}: what the teeth of one remainder by {g} have in "
            "common may belong to either gear and is split evenly"
        )
        if z_1 == z_2:
            note = "equal tooth numbers: each tooth meets one mate only, so nothing tells the two gears apart"
    return Maps(
        phase=read_only((np.arange(cells) + 0.5) / cells),
        mean=read_only(m),
        driving=read_only(np.where(held_1 > 0, d_1, np.nan).reshape(z_1, cells)),
        driven=read_only(np.where(held_2 > 0, d_2, np.nan).reshape(z_2, cells)),
        std_driving=std_1,
        std_driven=std_2,
        confounded=g,
        note=note,
    )
