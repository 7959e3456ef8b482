"""Every physics of the contract's catalogue as a change of the rig, and the truth that the scorer reads of it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise
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
        "thermal_drift": {"drift": rig.drift + size},
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
    if name == "tooth_crack":
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


RIVALS: dict[str, tuple[str, ...]] = {
    "eccentricity": ("cumulative_pitch", "encoder_eccentricity"),
    "cumulative_pitch": ("eccentricity", "encoder_eccentricity", "undulation"),
    "encoder_eccentricity": ("eccentricity", "cumulative_pitch"),
    "tooth_pitch": ("tooth_crack", "tooth_spall"),
    "tooth_crack": ("tooth_pitch", "tooth_spall"),
    "tooth_spall": ("tooth_pitch", "tooth_crack"),
    "profile_slope": ("profile_slope'", "wear", "wear'", "tip_relief", "tip_relief'", "friction"),
    "profile_crowning": ("profile_crowning'", "wear", "wear'", "tip_relief", "tip_relief'", "tooth_deflection"),
    "tip_relief": ("profile_slope", "profile_slope'", "profile_crowning", "profile_crowning'", "wear", "wear'"),
    "wear": ("wear'", "profile_crowning", "profile_crowning'", "profile_slope", "tip_relief", "tip_relief'"),
    "undulation": ("encoder_interpolation", "cumulative_pitch", "undulation'"),
    "encoder_interpolation": ("undulation", "undulation'", "encoder_interpolation'"),
    "tooth_deflection": ("profile_crowning", "profile_crowning'", "shaft_windup", "misalignment"),
    "misalignment": ("shaft_windup", "centre_distance", "tooth_thickness", "thermal_drift"),
    "friction": ("profile_slope", "profile_slope'", "shaft_windup"),
    "centre_distance": ("tooth_thickness", "tooth_thickness'", "shaft_windup", "misalignment"),
    "tooth_thickness": ("tooth_thickness'", "centre_distance"),
    "shaft_windup": ("misalignment", "centre_distance", "thermal_drift"),
    "mesh_resonance": ("profile_crowning", "tip_relief", "tip_relief'", "profile_slope"),
    "thermal_drift": ("encoder_scale", "encoder_scale'"),
    "encoder_scale": ("encoder_scale'", "thermal_drift"),
}
"""What is worth comparing with what; a dash means the other gear. Whether it is a true look-alike is computed, case
by case."""


def rival_effects(effect: Effect, rig: Rig, name: str, loaded: bool) -> list[Effect]:
    """Small effects that together span one rival of an effect; empty where the rival cannot be."""
    other = name.endswith("'")
    name = name.rstrip("'")
    mine = effect.gear or 1
    gear = 3 - mine if other else mine
    more, pair = effect.more, rig.pair
    if name in ("tooth_crack", "tooth_deflection", "friction", "misalignment", "shaft_windup") and not loaded:
        return []
    if name == "tooth_deflection" and rig.deflect:
        return []
    order = more.get("order", 1)
    if other and name in ("undulation", "encoder_interpolation"):
        ratio = order * pair.gear(gear).z / pair.gear(mine).z
        if abs(ratio - round(ratio)) > 1e-9:
            return []
        order = round(ratio)
    if name in ("eccentricity", "encoder_eccentricity") and order != 1:
        return []
    if name == "cumulative_pitch" and order > pair.gear(gear).z // 2:
        return []
    size = 1.0 if name not in ("friction", "tooth_crack", "encoder_scale") else 0.02
    size = {"encoder_eccentricity": 20.0, "encoder_interpolation": 20.0, "encoder_scale": 1e-7}.get(name, size)
    two = [{"angle_deg": a, "phase": a * DEG, "order": order} for a in (0.0, 90.0)]
    if name in ("eccentricity", "cumulative_pitch", "encoder_eccentricity", "undulation", "encoder_interpolation"):
        return [Effect(physics=name, gear=gear, size=size, more=m) for m in two]
    if name == "tooth_spall":
        # One pit wherever it may be: the whole contact of the tooth in four parts.
        g = pair.gear(gear)
        rolls = np.linspace(pair.l_start(gear), g.l_tip, 5)
        radii = np.sqrt(g.r_b**2 + rolls**2)
        ends = pairwise(radii.tolist())
        return [
            Effect(physics=name, gear=gear, size=2.0, more={"tooth": more["tooth"], "from_mm": a, "to_mm": b})
            for a, b in ends
        ]
    if name == "tip_relief":
        deep = pair.gear(gear).m
        return [Effect(physics=name, gear=gear, more={"length_mm": f * deep}) for f in (0.25, 0.5)]
    whole = ("friction", "misalignment", "shaft_windup", "centre_distance", "thermal_drift", "tooth_deflection")
    keep = {"tooth": more["tooth"]} if "tooth" in more else {}
    return [Effect(physics=name, gear=0 if name in whole else gear, size=size, more=keep)]
