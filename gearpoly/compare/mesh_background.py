"""What a telescope's recording says of the mesh where its wave does not stand out: how large it is, and how often the
background holds as much.

The wave of one cycle per mesh in what the fit left is weighed against the waves beside it, one for each independent
line within half a cycle per mesh, but for whole orders of the driven shaft, which may be waves of the pair. In noise
the squares of all are alike, so that of m lines leaves (1 + z/m)^-m of the places with more than z times their mean.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from gearpoly.compare.beside import Aligned
from gearpoly.compare.entries import Entry
from gearpoly.compare.families import log_tail_line
from gearpoly.compare.locate import Located
from gearpoly.compare.on_sky import Sky, arcsec_words
from gearpoly.units import UM, FloatArray

BACKGROUND_BESIDE = 0.5
"""Cycles per mesh on either side within which lines count as background. In five real guide logs the power below the
mesh is 1.0 to 1.6 times that above it, so the lines are nearly alike."""

FOOT_LINES = 1.5
"""Independent lines about an order of the driven shaft that may be its foot, and about the mesh within which a wave
that was located may be the mesh's."""

MESH_KINDS = ("mesh_order", "mesh_phase", "mesh_curve")
"""Kinds of places that say where in the mesh a difference is."""


def mesh_wave(left: FloatArray, u: FloatArray, *, z_2: int) -> tuple[float, float] | None:
    """Amplitude in mm of one cycle per mesh in what a fit ``left`` (n,) in mm, of samples at ``u`` (n,) meshes of a
    driven gear of ``z_2`` teeth, and the part (0 to 1) of the places beside it that hold as much; ``None`` where the
    recording is too short to have any."""
    span = float(np.ptp(u))
    frequency = np.arange(1.0 - BACKGROUND_BESIDE, 1.0 + BACKGROUND_BESIDE, 1.0 / span)
    order = frequency * z_2
    frequency = frequency[np.abs(order - np.rint(order)) * span / z_2 > FOOT_LINES]
    if not frequency.size:
        return None
    at_mesh = abs(np.sum(left * np.exp(-2j * np.pi * u)))
    beside = np.array([abs(np.sum(left * np.exp(-2j * np.pi * f * u))) for f in frequency])
    z = np.atleast_1d(at_mesh**2 / np.mean(beside**2))
    tail = log_tail_line(z, np.array([float(frequency.size)]))
    return float(2.0 / left.size * at_mesh), float(np.exp(tail[0]))


def mesh_remarks(located: Located, aligned: Sequence[Aligned], sky: Sky) -> Iterator[str]:
    """For each recording without a place in the mesh how large a wave of the mesh is, and how much that says."""
    for k, (one, left) in enumerate(zip(aligned, located.left, strict=True)):
        u = one.theta_2 * sky.z[1] / (2.0 * math.pi)
        span = float(np.ptp(u))
        shown = any(k in entry.recordings and _of_the_mesh(entry, sky, span=span) for entry in located.where)
        # A long record was shortened for the search.
        found = mesh_wave(left, u, z_2=sky.z[1]) if not shown and left.size == u.size else None
        if found is not None:
            um, part = found[0] / UM, found[1]
            yield (
                f"recording {k}: mesh order 1, {um:.2g} um ({arcsec_words(sky.arcsec(um))} on the sky), lies within "
                f"the background: {100.0 * part:.2g} in 100 places beside it hold as much"
            )


def _of_the_mesh(entry: Entry, sky: Sky, *, span: float) -> bool:
    """Whether an ``entry`` is of the mesh, or a wave as often as it in a recording of ``span`` meshes."""
    period = sky.period_of(entry)
    mesh = sky.period(gear=None, order=1.0)
    return entry.kind in MESH_KINDS or (period is not None and abs(mesh / period - 1.0) * span < FOOT_LINES)
