"""Long recordings made short enough to search, without losing what teeth can do.

Samples closer than a tooth's shape changes are averaged in groups; of many hunting cycles, as many whole ones are
searched as fit. The noise level is always taken from every sample.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.noise import spacing_of, whole_cycles
from gearpoly.compare.pieces import SAMPLES_PER_PIECE, pieces
from gearpoly.compare.set_up import AlignedResidual
from gearpoly.units import FloatArray

SAMPLES_PER_MESH = 24.0
"""Samples per mesh that averaging leaves at least: orders up to 12 per mesh, hand-overs to a twenty-fourth of a
pitch."""

SAMPLES_SEARCHED = 40960
"""Samples searched in one recording: of an 18/25 pair three hunting cycles at 24 to 30 per mesh. The normal matrix has
to come from all of them (teeth imitate the first orders of their shaft to a thousandth), so they decide the time."""


LONGEST_UNREDUCED_SAMPLES, COARSER_AT_MOST = 65536, 2
"""Samples that two hunting cycles may have, so that columns are known at all of them, and times as coarse as they may
be made for that: 12 samples to the mesh tell orders up to 6 of it. Of 82 629 samples of a run-up a search took more
than four minutes."""


@dataclass(frozen=True, kw_only=True)
class Shortening:
    """How one recording is shortened: means of ``group`` neighbours each, ``size`` of them from its beginning; the
    samples it has now are ``spacing`` meshes apart."""

    group: int
    size: int
    spacing: float

    def means(self, values: FloatArray) -> FloatArray:
        """What stands for ``values`` (n, ...): (size, ...)."""
        return np.array(_means(values[: self.size * self.group], self.group))

    def of(self, data: AlignedResidual) -> AlignedResidual:
        """The recording shortened, with the columns of what its simulation does not know exactly."""
        nuisance = None
        if data.changes is not None:
            theta_2 = data.theta_2[: self.size * self.group]
            parts = pieces(theta_2.size, size=self.group * SAMPLES_PER_PIECE)
            nuisance = np.concatenate([_means(data.changes(theta_2[here]), self.group) for here in parts])
        return replace(
            data,
            averaged=0.0 if self.group == 1 else self.group * self.spacing,
            theta_1=self.means(data.theta_1),
            theta_2=self.means(data.theta_2),
            residual=self.means(data.residual),
            time_s=None if data.time_s is None else self.means(data.time_s),
            nuisance=nuisance,
        )


def shortening(u: FloatArray, *, z_1: int, z_2: int) -> Shortening:
    """How a recording at ``u`` (n,) meshes is shortened: not at all, or by means over neighbours, and where these are
    too many still, to whole hunting cycles."""
    spacing = spacing_of(u)
    if u.size <= SAMPLES_SEARCHED:
        return Shortening(group=1, size=u.size, spacing=spacing)
    group = max(1, int(1.0 / (spacing * SAMPLES_PER_MESH)))
    u = _means(u, group)
    if u.size <= SAMPLES_SEARCHED:
        return Shortening(group=group, size=u.size, spacing=spacing)
    period = float(math.lcm(z_1, z_2))
    cycles = whole_cycles(u[:SAMPLES_SEARCHED], period)
    # Fewer than two whole cycles do not repeat: rather search a longer stretch then.
    if cycles < 2 and whole_cycles(u, period) >= 2:
        coarser = -(-int(np.searchsorted(u, u[0] + 2.0 * period)) // LONGEST_UNREDUCED_SAMPLES)
        if coarser <= COARSER_AT_MOST:
            group, u, cycles = group * coarser, _means(u, coarser), 2
    size = int(np.searchsorted(u, u[0] + cycles * period)) if cycles >= 2 else SAMPLES_SEARCHED
    return Shortening(group=group, size=size, spacing=spacing)


def _means(values: FloatArray, group: int) -> FloatArray:
    """Means (n // group, ...) of ``group`` neighbours of ``values`` (n, ...) each."""
    if group == 1:
        return values
    size = len(values) // group
    whole = values[: size * group].reshape(size, group, *values.shape[1:])
    return np.asarray(whole.mean(axis=1), dtype=np.float64)
