"""What a pair runs under."""

from __future__ import annotations

from dataclasses import dataclass

from gearpoly import arguments
from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.pair import Flank
from gearpoly.units import NM


@dataclass(frozen=True, kw_only=True)
class Condition:
    """What a pair runs under: ``flank`` that carries, ``torque`` in N.mm on the driven shaft, ``speed`` of the driving
    shaft in rad/s (None: unknown, or too slow to swing).

    ``backward``: the pair runs backwards; ``varies``: the most by which the torque is off its mean along a recording,
    as a part of it. Frozen, so that what was made under it can be kept by it; whatever else a pair feels, such as a
    temperature, is one more field. Raises ``OutOfRangeError`` for a flank or a torque that is none.
    """

    flank: Flank
    torque: float
    speed: float | None = None
    backward: bool = False
    varies: float = 0.0

    def __post_init__(self) -> None:
        arguments.check_choice("--flank", self.flank, arguments.FLANKS)
        check_torque(self.torque)

    @property
    def heaviest(self) -> float:
        """The largest torque in N.mm."""
        return self.torque * (1.0 + self.varies)

    @property
    def coast(self) -> bool:
        """Whether the coast flank carries."""
        return self.flank == "coast"


def check_torque(torque: float) -> None:
    """Refuse a ``torque`` in N.mm that is no finite magnitude: raises ``OutOfRangeError``."""
    if not 0.0 <= torque < float("inf"):
        raise OutOfRangeError(
            f"torque {torque / NM:g} N.m: a torque is a finite magnitude, 0 or more; the flank says which way"
        )
