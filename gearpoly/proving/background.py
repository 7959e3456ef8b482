"""What every rig has beside its effects and nobody declares: mains hum and the line of a bearing, loud or faint.

Neither is of the catalogue, so neither may get a name; a loud one is to be located, a faint one may stay silent."""

from __future__ import annotations

from math import pi

import numpy as np

from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.effects import Effect
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.gears import IdealPair
from gearpoly.proving.scenes import odd_order

BACKGROUND_KINDS = (("hum",), ("line",), ("hum", "line"))
"""What lies beside: hum, a bearing's line, or both."""
LEVELS = (10.0, 30.0, 2.0, 15.0, 100.0, 1.0)
"""Sizes over each wave's own limit: a third faint; the loudest comes near the noise per sample, as on a real rig."""
HEALTHY = 4
"""Of so many healthy pairs one has a background."""
FAINT_SIZES_OVER_LIMIT = (0.3, 1.0)
"""Sizes over its own limit of what lies beside nothing: too faint for any method, yet not nothing."""
MAINS_HZ = 50.0
HUM_SPEED_RPM = 26.0
"""Speed in rpm of the driving shaft where there is hum: 50 Hz is no mesh harmonic of any pair then."""


def background(entry: CaseEntry, pair: IdealPair, rng: np.random.Generator) -> tuple[tuple[Effect, float], ...]:
    """Waves beside a case's effects, each with its size over its own limit; their amplitudes are first guesses."""
    v = entry.variant
    if entry.klass == "beside":
        lap = v // len(LEVELS)
        kinds = BACKGROUND_KINDS[(v + v // 12) % len(BACKGROUND_KINDS)]
        levels = [LEVELS[(v + lap + 3 * k) % len(LEVELS)] * float(rng.uniform(0.88, 1.12)) for k in range(len(kinds))]
    elif entry.klass == "healthy" and v % HEALTHY == 1:
        kinds = BACKGROUND_KINDS[(v // HEALTHY) % len(BACKGROUND_KINDS)]
        levels = [float(rng.uniform(*FAINT_SIZES_OVER_LIMIT)) for _ in kinds]
    else:
        return ()
    return tuple((_wave(kind, pair, rng), level) for kind, level in zip(kinds, levels, strict=True))


def _wave(kind: str, pair: IdealPair, rng: np.random.Generator) -> Effect:
    """Hum at the mains' frequency, or a line at an order that is none of either shaft."""
    phase = float(rng.uniform(0, 2 * pi))
    if kind == "hum":
        shape = Disturbance(kind=kind, amplitude=1.0, hz=MAINS_HZ, phase=phase)
    else:
        gear = int(rng.integers(1, 3))
        order = odd_order(pair, gear, 2.5, 9.5, rng)
        shape = Disturbance(kind=kind, amplitude=1.0, gear=gear, order=order, phase=phase)
    return Effect(physics="disturbance", size=1.0, more={"shape": shape})
