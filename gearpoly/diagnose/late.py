"""What a clock that is off does to a simulated curve: teeth take over earlier or later than its angle says."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearpoly.compare.noise import mean_innovation
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.nuisance import late_of
from gearpoly.scene import Scene


def by_clock(scenes: Sequence[Scene], linear: Linear, doubts: Sequence[float]) -> float:
    """Rms in mm, over what noise leaves of it, by which the curve of the teeth as they are fitted now is off where the
    angle's rate is off by as much as it is still in doubt, from the middle of each recording on: ``doubts`` (k,), parts
    of ``RATE_STD``.

    What the recordings tell of the rate is in the fit, and moves its angles. Of pitch steps of 10 um, a rate that was
    off by 0.8 in a thousand over 74 meshes made 9 um of a tip relief.
    """
    at, off = linear.layout.built, []
    for scene, columns, noise, doubt in zip(scenes, linear.columns, linear.noises, doubts, strict=True):
        angle = scene.samples.theta_2
        curve = scene.mesh_te + columns.times(at, linear.system.solution[at])
        off.append(doubt * noise.whitened(late_of(scene, np.gradient(curve, angle))))
    return mean_innovation(linear.noises) * math.sqrt(float(np.mean(np.concatenate(off) ** 2)))
