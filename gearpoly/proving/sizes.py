"""How large an effect is made: by its size over the limit, and a look-alike so small that its likeness is left."""

from __future__ import annotations

import numpy as np

from gearpoly.proving.effects import Effect
from gearpoly.proving.limit import DetectionLimit
from gearpoly.proving.physics import PHYSICS_BY_NAME
from gearpoly.proving.rig import Rig
from gearpoly.proving.rivals import rivals, whitened

LOOK_ALIKE_SIGMAS = 1.0
"""A look-alike is to be left within this many standard deviations: excluding it at three is then chance, 2 in 100."""
WEAKEST = 7.0
"""No look-alike is made weaker than this over the limit: it has to be seen before it can be mistaken for anything."""


def sized(rig: Rig, limit: DetectionLimit, effect: Effect, over: float) -> Effect:
    """The effect at a size over the limit: its signal may bend with size, so the guess is mended with its own slope."""
    cap, least, power = PHYSICS_BY_NAME[effect.physics].cap, PHYSICS_BY_NAME[effect.physics].least, 1.0
    last: tuple[float, float] | None = None
    for _ in range(6):
        n = limit.size_of(whitened(rig, limit, effect))
        if n <= 0.0:
            return effect.scaled(cap)
        size = abs(effect.size)
        if abs(n / over - 1) < 0.03 or (size >= cap and n < over) or (size <= least and n > over):
            break
        if last is not None and abs(np.log(size / last[0])) > 1e-6:  # some signals grow with a power of the size
            power = float(np.clip(np.log(n / last[1]) / np.log(size / last[0]), 0.4, 3.0))
        last = (size, n)
        wanted = size * float(np.clip((over / n) ** (1 / power), 1e-4, 1e4))
        effect = effect.scaled(max(least, min(wanted, cap)))
    return effect


def smaller(rig: Rig, limit: DetectionLimit, effect: Effect, over: float) -> Effect:
    """The effect at a size at which its nearest rival is left: smaller, if it must be."""
    near = min((one.separability for one in rivals(rig, limit, effect)), default=1.0)
    wanted = max(WEAKEST, LOOK_ALIKE_SIGMAS / max(near, 1e-6))
    return effect if wanted >= over else sized(rig, limit, effect, wanted)
