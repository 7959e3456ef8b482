"""A wave that was found in a whitened residual: fixed to a shaft, or in time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Domain = Literal["order", "time"]

MAINS = (50.0, 60.0)
"""Hz at whose multiples a wave that may as well be fixed in time as in angle is hum; elsewhere something turns."""

MAINS_STRAYS, HIGHEST_HUM = 0.002, 20
"""Part by which a mains frequency strays, and the highest multiple of it that is taken for hum: beyond, what strays so
far is near some multiple anyway."""


@dataclass(frozen=True, kw_only=True)
class Peak:
    """A wave found: ``frequency`` in cycles per mesh, or in Hz; ``gain`` twice the log likelihood that it brings;
    ``log_false`` log of the expected number of such finds in noise; ``known``: it is an integer order of a shaft.
    ``std`` of the frequency, in its unit; ``rival`` the gain of the best wave of the other kind at its place, ``image``
    that of the wave in time which the same samples show where the sampling is even. ``faint``: it was found together
    with others only, as ``harmonic`` of a train of pulses (0: of none); ``leads``: it is the strongest of them.
    ``few``: the order of a shaft of which the recording holds too few turns to tell it from a drift (0: any other)."""

    domain: Domain
    frequency: float
    std: float
    gain: float
    log_false: float
    known: bool
    rival: float = 0.0
    image: float = 0.0
    harmonic: int = 0
    faint: bool = False
    leads: bool = False
    few: int = 0

    @property
    def hum(self) -> bool:
        """Whether its frequency is a multiple of the mains'."""
        return self.domain == "time" and is_hum(self.frequency, std=self.std)


def is_hum(hz: float, *, std: float) -> bool:
    """Whether a frequency in Hz, known to ``std``, is a multiple of the mains'."""
    off = MAINS_STRAYS * hz + 3.0 * std
    multiples = ((mains, round(hz / mains)) for mains in MAINS)
    return any(1 <= k <= HIGHEST_HUM and abs(hz - mains * k) < off for mains, k in multiples)
