"""A wave as the fit of everything has it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.model import JointModel
from gearpoly.compare.peak import Peak
from gearpoly.compare.regression import Solution


@dataclass(frozen=True, kw_only=True)
class FittedWave:
    """``amplitude`` and its standard error ``std`` in mm, ``phase`` in rad (at u = 0 or time 0), and ``square``, chi
    square of its two terms."""

    amplitude: float
    std: float
    phase: float
    square: float


def fitted_wave(search: JointModel, solution: Solution, k: int, peak: Peak) -> FittedWave:
    """A wave in recording ``k``."""
    s = search.states[k]
    name, peaks = ("times", s.times) if peak.domain == "time" else ("orders", s.orders)
    at = search.places[k][name][2 * peaks.index(peak) :][:2]
    ab = solution.beta[at]
    scale = s.sampling.per_mesh(peak)
    rest = float(s.sampling.rest_at(peak.domain, np.array([peak.frequency]), s.noise)[0][0])
    covariance = solution.covariance[np.ix_(at, at)] * rest
    # Means over a stretch make a wave smaller by sin(x)/x; what is reported is the wave itself.
    damped = float(np.sinc(scale * s.data.averaged))
    ab, covariance = ab / damped, covariance / damped**2
    amplitude = float(np.hypot(*ab))
    along = ab / max(amplitude, 1e-300)
    std = math.sqrt(float(along @ covariance @ along))
    square = float(ab @ np.linalg.solve(covariance, ab))
    return FittedWave(amplitude=amplitude, std=std, phase=math.atan2(ab[1], ab[0]), square=square)
