"""Every physics of the contract's catalogue as a change of the rig, and the truth that the scorer reads of it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import atan2, cos, pi, sin, sqrt
from typing import Any

import numpy as np

from proving.chain import Chain, Condition
from proving.compliance import compliance
from proving.gears import DEG, UM
from proving.rig import Disturbance, Rig

CATALOGUE = (
    "eccentricity", "cumulative_pitch", "tooth_pitch", "profile_slope", "profile_crowning", "tip_relief",
    "undulation", "wear",
    "tooth_spall", "tooth_crack", "tooth_deflection", "misalignment", "friction", "centre_distance", "tooth_thickness",
    "shaft_windup", "mesh_resonance", "thermal_drift", "encoder_eccentricity", "encoder_interpolation", "encoder_scale",
)  # fmt: skip
"""Names of the contract, in its order."""

SIZES = {
    "eccentricity": "amplitude_um", "cumulative_pitch": "amplitude_um", "tooth_pitch": "deviation_um",
    "profile_slope": "slope_um", "profile_crowning": "crowning_um", "tip_relief": "amount_um", "undulation":
    "amplitude_um",
    "wear": "depth_um", "tooth_spall": "depth_um", "misalignment": "lead_um", "friction": "coefficient",
    "centre_distance": "offset_um", "tooth_thickness": "deviation_um", "shaft_windup": "compliance_urad_per_nm",
    "thermal_drift": "amplitude_um", "encoder_eccentricity": "amplitude_urad", "encoder_interpolation":
    "amplitude_urad",
}  # fmt: skip
"""The parameter that is the effect's size; not listed: crack, deflection, resonance and scale, see `apply`."""


@dataclass(frozen=True, kw_only=True)
class Effect:
    """One physics with its size and what fixes it beside its size.

    size: in the contract's unit of `SIZES` (signed); crack: compliance factor less 1; deflection: 1; scale: ratio
    less 1; resonance: (highest mesh frequency / natural frequency) squared. more: tooth, order, angle_deg, phase,
    lengths, ..."""

    physics: str
    gear: int = 0
    size: float = 1.0
    more: dict[str, Any] = field(default_factory=dict)

    def scaled(self, size: float) -> Effect:
        """The same effect with another size (magnitude; the sign stays)."""
        return replace(self, size=size * (-1.0 if self.size < 0 else 1.0))


def _shift(vector: tuple[float, float], amplitude: float, angle_deg: float) -> tuple[float, float]:
    x = vector[0] * cos(vector[1] * DEG) + amplitude * cos(angle_deg * DEG)
    y = vector[0] * sin(vector[1] * DEG) + amplitude * sin(angle_deg * DEG)
    return sqrt(x * x + y * y), atan2(y, x) / DEG % 360.0


def apply(rig: Rig, effect: Effect) -> Rig:
    """The rig with one effect in it."""
    name, index, size, more = effect.physics, effect.gear, effect.size, effect.more
    if name == "disturbance":
        return replace(rig, disturbances=(*rig.disturbances, replace(more["shape"], amplitude=size)))
    if name == "eccentricity":
        key = f"eccentric_{index}"
        moved: dict[str, Any] = {key: _shift(getattr(rig, key), size, more["angle_deg"])}
        return replace(rig, **moved)
    whole: dict[str, dict[str, Any]] = {
        "tooth_deflection": {"deflect": True},
        "misalignment": {"lead": rig.lead + size},
        "friction": {"friction": rig.friction + size},
        "centre_distance": {"pair": replace(rig.pair, offset=rig.pair.offset + UM * size)},
        "shaft_windup": {"windup": rig.windup + size},
        "thermal_drift": {"drift": rig.drift + size, "drift_bend": more.get("bend", rig.drift_bend)},
    }
    if name in whole:
        return replace(rig, **whole[name])
    if name == "mesh_resonance":
        return replace(rig, resonance=(more["mesh_hz"] / sqrt(size), more["damping_ratio"]))
    if name.startswith("encoder"):
        old = rig.encoder(index)
        changed: dict[str, dict[str, Any]] = {
            "encoder_eccentricity": {"eccentricity_urad": size, "angle_deg": more.get("angle_deg", 0.0)},
            "encoder_interpolation": {
                "interp_urad": size,
                "interp_order": more.get("order", 0),
                "interp_phase": more.get("phase", 0.0),
            },
            "encoder_scale": {"ratio": old.ratio * (1 + size)},
        }
        return rig.with_encoder(index, replace(old, **changed[name]))
    return rig.with_teeth(index, _teeth(rig, effect))


def _teeth(rig: Rig, effect: Effect) -> Any:
    name, size, more, teeth = effect.physics, effect.size, effect.more, rig.teeth(effect.gear)
    z = rig.pair.gear(effect.gear).z
    if name == "cumulative_pitch":
        wave = np.cos(more["order"] * 2 * pi * np.arange(z) / z + more["phase"])
        return replace(teeth, p=teeth.p + size * wave)
    if name == "tooth_pitch":
        return teeth.index_plus(more["tooth"], size)
    if name == "profile_slope":
        return replace(teeth, slope=teeth.slope + size)
    if name == "profile_crowning":
        return replace(teeth, crowning=teeth.crowning + size)
    if name == "tip_relief":
        return replace(teeth, relief=size, relief_mm=more["length_mm"], power=more.get("power", 1.0))
    if name == "undulation":
        return replace(teeth, waves=((more["order"], size, more["phase"], more["phase"] + 2.0),))
    if name == "wear":
        return replace(teeth, wear=size)
    if name == "tooth_spall":
        return replace(teeth, pits=((more["tooth"], size, more["from_mm"], more["to_mm"]),))
    if name == "tooth_crack":
        return teeth.softer(more["tooth"], 1 + size)
    if name == "tooth_thickness":
        return replace(teeth, E_s=teeth.E_s + size)
    raise ValueError(f"no physics {name!r} in the catalogue")


def truth(rig: Rig, effect: Effect, chain: Chain, conditions: tuple[Condition, ...]) -> dict[str, Any]:
    """What the scorer is told of one effect: the contract's names and units; encoder_deg where it sits on one tooth."""
    name, more = effect.physics, effect.more
    if name == "disturbance":
        shape: Disturbance = more["shape"]
        out: dict[str, Any] = {"shape": shape.kind, "amplitude_um": effect.size}
        if shape.kind == "hum":
            out["hz"] = shape.hz
            # Even samples in time show what is faster than half their rate below it as well.
            rates = [c.per_mesh * rig.pair.driving.z * c.speed / 60.0 for c in conditions]
            images = {round(abs(shape.hz - round(shape.hz / rate) * rate), 4) for rate in rates}
            out["images_hz"] = sorted(images - {round(shape.hz, 4)})
        elif shape.kind == "jump":
            out["at"] = shape.at
        else:
            out |= {"order": shape.order, "gear": shape.gear}
        return out
    out = {"physics": name}
    if effect.gear:
        out["gear"] = effect.gear
    if name in SIZES:
        out[SIZES[name]] = effect.size
    for key in ("order", "angle_deg", "length_mm", "from_mm", "to_mm", "damping_ratio"):
        if key in more and not (name.startswith("encoder") and key == "angle_deg"):
            out[key] = more[key]
    if name == "thermal_drift":
        out["amplitude_um"] = abs(effect.size)  # how far it goes, whichever way
    elif name == "tooth_crack":
        out["compliance_factor"] = 1 + effect.size
    elif name == "encoder_scale":
        out["ratio"] = 1 + effect.size
    elif name == "mesh_resonance":
        out["frequency_hz"] = more["mesh_hz"] / sqrt(effect.size)
    elif name == "tooth_deflection":
        force = max(c.torque for c in conditions) * 1000 / rig.pair.driven.r_b
        law = compliance(rig.pair, law=rig.law, scale=rig.scale)
        out["compliance_um_per_n"] = law.single(rig.pair.l_work(1), rig.pair.l_work(2), max(force, 1.0)) / UM
    if "tooth" in more:
        gear = rig.pair.gear(effect.gear)
        k = effect.gear - 1
        reading = chain.zeros_deg[k] + chain.directions[k] * more["tooth"] * 360.0 / gear.z
        out |= {"tooth": more["tooth"], "teeth": gear.z, "encoder_deg": reading % 360.0}
    return out
