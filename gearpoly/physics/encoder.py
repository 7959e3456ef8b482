"""What a wrong reading of a shaft does to the recorded transmission error."""

from __future__ import annotations

import numpy as np

from gearpoly.physics.base import Values
from gearpoly.physics.scene import Scene
from gearpoly.units import URAD, FloatArray


def misread(scene: Scene, gear: int | None, order: int, values: Values) -> FloatArray:
    """Change (n,) in mm of the recorded transmission error where an encoder reads ``values`` (cosine and sine, urad)
    too much, ``order`` times per turn."""
    driving = gear in (0, None)
    reading = scene.samples.reading_1 if driving else scene.samples.reading_2
    sense = scene.samples.direction_1 if driving else scene.samples.direction_2
    error = values[0] * np.cos(order * reading) + values[1] * np.sin(order * reading)
    # TE = theta_2 - (z_1/z_2) theta_1.
    part = -scene.pair.ratio if driving else 1.0
    return np.asarray(part * sense * error * URAD * scene.pair.r_b2)
