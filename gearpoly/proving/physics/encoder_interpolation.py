"""An encoder errs between its lines."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site, wave
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """Another encoder on that shaft."""
    old = rig.encoder(effect.gear)
    return rig.with_encoder(
        effect.gear,
        replace(
            old,
            interp_urad=effect.size,
            interp_order=effect.more.get("order", 0),
            interp_phase=effect.more.get("phase", 0.0),
        ),
    )


def example(site: Site) -> Effect:
    """1 um at the base circle."""
    return Effect(
        physics="encoder_interpolation",
        gear=site.gear,
        size=site.urad_per_um,
        more={"order": site.shapes.line_order, "phase": site.phase},
    )


PHYSICS = ConcealedPhysics(
    name="encoder_interpolation",
    size="amplitude_urad",
    apply=apply,
    example=example,
    cap=500.0,
    unit=20.0,
    plain=True,
    tells=("order",),
    kind=wave,
    place="wave",
    rivals=("undulation", "undulation'", "encoder_interpolation'"),
    source="a sine per line",
)
