"""What a physics sees of a recording: the exact contacts at its own samples, and what moves with them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from gearpoly.gear.deviations import Deviations, Span
from gearpoly.gear.gear import Gear
from gearpoly.mesh.pair import GearPair
from gearpoly.mesh.shafts import Shafts
from gearpoly.physics.samples import Samples
from gearpoly.units import FloatArray, IntArray

DeviationOf = Callable[[IntArray, FloatArray], FloatArray]
"""Normal deviation in mm of tooth numbers (P, n) at roll lengths (P, n) in mm."""


class ContactsAtSamples(Protocol):
    """A set-up simulated at the ``samples`` of one recording, (n,) of them, with rows (P, n) of touching pairs.

    Gears are counted 0 (driving) and 1. ``gearpoly.scene`` makes one; a physics asks no more of it than this.
    """

    @property
    def samples(self) -> Samples:
        """Where and under what the recording was made."""

    @property
    def pair(self) -> GearPair:
        """The simulated pair."""

    @property
    def deviations(self) -> tuple[Deviations, Deviations]:
        """What both gears deviate by."""

    @property
    def bends(self) -> bool:
        """Whether load bends teeth here."""

    @property
    def force(self) -> FloatArray:
        """Normal force (P, n) in N."""

    @property
    def spans(self) -> tuple[Span, Span]:
        """Between which roll lengths the flanks of both gears work."""

    def gear(self, gear: int, /) -> Gear:
        """The deviation-free gear."""

    def teeth(self, gear: int, /) -> IntArray:
        """Tooth numbers (P, n)."""

    def roll(self, gear: int, /) -> FloatArray:
        """Roll lengths (P, n) in mm."""

    def tooth_compliance(self, gear: int, /) -> FloatArray:
        """Compliance (P, n) in mm/N of sound teeth at their contacts."""

    def moved_by(self, deviation: FloatArray, /) -> FloatArray:
        """Change (n,) in mm of the transmission error when pairs have ``deviation`` (P, n) mm more material."""

    def deviated(self, gear: int, deviation: DeviationOf, /) -> FloatArray:
        """The same for a deviation of the flanks of one gear."""

    def deviated_tooth(
        self, gear: int, tooth: int | None, deviation: Callable[[FloatArray], FloatArray], /
    ) -> FloatArray:
        """The same for a deviation (k,) in mm at roll lengths (k,) in mm of a single tooth."""

    def standing_off(self, gear: int, tooth: int, off: Callable[[FloatArray], FloatArray], /) -> FloatArray:
        """Change (n,) in mm of the transmission error when the contacts of one whole tooth at roll lengths (k,) in mm
        stand off by (k,) mm: the other pairs take over as much as that lets go."""

    def displaced(self, gear: int, x: FloatArray, y: FloatArray, /) -> FloatArray:
        """The same when the centre of one gear moves by (x, y) (n,) mm in the global frame."""

    def swings(self, shafts: Shafts, /) -> FloatArray:
        """What a resonance of ``shafts`` adds (n,) in rad to the transmission error of the mesh."""
