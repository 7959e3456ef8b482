"""The tip of one tooth has broken off, on both flanks."""

from __future__ import annotations

from dataclasses import dataclass, replace

from gearpoly.proving.gears import FloatArray, IdealPair
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Extra, Rig


@dataclass(frozen=True, kw_only=True)
class ShortenedTooth(Extra):
    """One tooth of gear 1 or 2 that ends a height (mm, radial) below the tip circle."""

    gear: int
    tooth: int
    height_mm: float
    teeth = True

    def ends(self, pair: IdealPair, index: int, ends: FloatArray) -> FloatArray:
        """The tooth ends where the rest of it does."""
        if index != self.gear:
            return ends
        gear, out = pair.gear(index), ends.copy()
        out[self.tooth] = gear.roll(gear.r_a - self.height_mm)
        return out


def apply(rig: Rig, effect: Effect) -> Rig:
    """A chip on one tooth."""
    chip = ShortenedTooth(gear=effect.gear, tooth=effect.more["tooth"], height_mm=effect.size)
    return replace(rig, extras=(*rig.extras, chip))


def example(site: Site) -> Effect:
    """A third of the module: more than the overlap of two pairs bridges."""
    m = site.pair.gear(site.gear).m
    return Effect(physics="tooth_chip", gear=site.gear, size=0.35 * m, more={"tooth": site.tooth})


PHYSICS = ConcealedPhysics(
    name="tooth_chip",
    size="height_mm",
    apply=apply,
    example=example,
    cap=1.5,
    unit=0.02,
    place="tooth",
    nearby=("tooth_flank",),
    rivals=("tooth_pitch", "tooth_spall"),
    one_sign=True,
    source="geometry: the involute ends at a smaller radius",
)
