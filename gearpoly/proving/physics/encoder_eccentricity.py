"""An encoder runs eccentrically on its shaft."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site, once_per_turn
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """Another encoder on that shaft."""
    old = rig.encoder(effect.gear)
    return rig.with_encoder(
        effect.gear, replace(old, eccentricity_urad=effect.size, angle_deg=effect.more.get("angle_deg", 0.0))
    )


def example(site: Site) -> Effect:
    """1 um at the base circle."""
    return Effect(
        physics="encoder_eccentricity", gear=site.gear, size=site.urad_per_um, more={"angle_deg": site.angle_deg}
    )


PHYSICS = ConcealedPhysics(
    name="encoder_eccentricity",
    size="amplitude_urad",
    apply=apply,
    example=example,
    cap=3000.0,
    unit=20.0,
    plain=True,
    shows="coast",
    kind=once_per_turn,
    place="wave",
    rivals=("eccentricity", "cumulative_pitch"),
    source="a sine once per turn",
)
