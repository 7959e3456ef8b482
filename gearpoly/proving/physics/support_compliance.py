"""Shafts and bearings give way: the axes stand further apart under torque."""

from __future__ import annotations

from dataclasses import dataclass, replace

from gearpoly.proving.gears import MM_PER_UM
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, RivalSetting, Site
from gearpoly.proving.rig import Extra, Rig


@dataclass(frozen=True, kw_only=True)
class Support(Extra):
    """Growth of the centre distance in um per N.m of driven torque."""

    um_per_nm: float
    teeth = True

    def under(self, rig: Rig, torque: float) -> Rig:
        """The axes moved apart in step with the torque."""
        return replace(rig, pair=replace(rig.pair, offset=rig.pair.offset + MM_PER_UM * self.um_per_nm * torque))


def apply(rig: Rig, effect: Effect) -> Rig:
    """Supports that give way."""
    return replace(rig, extras=(*rig.extras, Support(um_per_nm=effect.size)))


def example(site: Site) -> Effect:
    """20 um at the highest torque."""
    return Effect(physics="support_compliance", size=20.0 / max(site.torque, 1e-6))


def possible(beside: RivalSetting) -> bool:
    """Whether there is a torque."""
    return bool(beside.torque)


PHYSICS = ConcealedPhysics(
    name="support_compliance",
    size="um_per_nm",
    apply=apply,
    example=example,
    cap=20.0,
    unit=0.01,
    gear=False,
    shows="load",
    place="step",
    rivals=("shaft_windup", "misalignment", "friction"),
    one_sign=True,
    possible=possible,
    source="Hooke: in step with torque, as the contract has it",
)
