"""The truth of a case, as the scorer reads it."""

from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gearpoly.errors import InputFileError

GEARS = {1: "driving", 2: "driven", "driving": "driving", "driven": "driven"}

SIZES = {
    "eccentricity": "amplitude_um", "cumulative_pitch": "amplitude_um", "tooth_pitch": "deviation_um",
    "profile_slope": "slope_um", "profile_crowning": "crowning_um", "tip_relief": "amount_um",
    "undulation": "amplitude_um", "wear": "depth_um", "tooth_spall": "depth_um", "tooth_crack": "compliance_factor",
    "tooth_deflection": "compliance_um_per_n", "misalignment": "lead_um", "friction": "coefficient",
    "centre_distance": "offset_um", "tooth_thickness": "deviation_um", "shaft_windup": "compliance_urad_per_nm",
    "mesh_resonance": "frequency_hz", "thermal_drift": "amplitude_um", "encoder_eccentricity": "amplitude_urad",
    "encoder_interpolation": "amplitude_urad", "encoder_scale": "ratio",
}  # fmt: skip
"""The parameter that says how much of it there is."""

FROM_ONE = ("tooth_crack", "encoder_scale")
"""Physics whose size counts from 1."""

FURTHER = ("angle_deg", "length_mm", "from_mm", "to_mm", "damping_ratio")
"""Parameters beside the size of which truths may tell."""


@dataclass(frozen=True, kw_only=True)
class Rival:
    """What the recordings of a case cannot tell from an effect; ``separability`` is a sine."""

    physics: str
    gear: str | None
    separability: float


@dataclass(frozen=True, kw_only=True)
class Item:
    """One effect concealed in a case.

    ``physics`` by the contract's name, ``shape`` for one outside the catalogue (then ``physics`` is empty); ``gear``,
    ``teeth`` of it, ``tooth`` and ``encoder_deg`` where they are; ``order``, ``hz``; ``parameters`` in the contract's
    units; ``over_limit`` its size over the theoretical limit (None: not known) and ``acceptable`` rivals.
    """

    physics: str
    shape: str = ""
    gear: str | None = None
    tooth: int | None = None
    teeth: int | None = None
    encoder_deg: float | None = None
    order: float | None = None
    hz: float | None = None
    parameters: dict[str, float] = field(default_factory=dict)
    over_limit: float | None = None
    acceptable: tuple[Rival, ...] = ()

    @property
    def label(self) -> str:
        """What and where in a few words."""
        words = [self.physics or self.shape or "unknown"]
        if self.gear:
            words.append(self.gear)
        if self.tooth is not None:
            words.append(f"tooth {self.tooth}")
        if self.order is not None:
            words.append(f"order {self.order:g}")
        return " ".join(words)

    def separable(self, least: float) -> bool:
        """Whether size over limit, alone and times the separability of every rival, exceeds ``least``; always where
        the size is not known."""
        if self.over_limit is None:
            return True
        sines = [rival.separability for rival in self.acceptable]
        return self.over_limit * min([1.0, *sines]) > least

    def alike(self, least: float) -> bool:
        """Whether a rival stands so near that naming this alone would be more than the recordings say."""
        if self.over_limit is None:
            return False
        return any(rival.separability * self.over_limit < least for rival in self.acceptable)


@dataclass(frozen=True, kw_only=True)
class Truth:
    """The truth of a case: ``kind`` none, missing or unknown; ``klass`` and ``pair`` as the ground names them; the true
    ``noise_um``; ``z`` teeth of both gears; ``over_limit`` of all effects together."""

    kind: str
    items: tuple[Item, ...]
    klass: str
    pair: str
    noise_um: float
    z: tuple[int, int]
    hunting_cycles: float | None
    over_limit: float | None
    concealed_by: str


def read_truth(path: Path, *, pair: Path) -> Truth:
    """The truth file at ``path`` of a case whose pair file is ``pair``. Raises ``InputFileError`` for one that is
    none."""
    try:
        raw: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        kind = raw["kind"]
        items = tuple(_item(one) for one in raw["truth"])
        noise = float(raw["noise_um"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputFileError(
            path, found=f"{type(error).__name__}: {error}", wish="want a truth file with kind, truth and noise_um"
        ) from None
    if kind not in ("none", "missing", "unknown"):
        raise InputFileError(path, where="kind", found=repr(kind), wish="want none, missing or unknown")
    declared = tomllib.loads(pair.read_text(encoding="utf-8"))
    return Truth(
        kind=kind,
        items=items,
        klass=raw.get("class", kind),
        pair=raw.get("pair", declared.get("name", "")),
        noise_um=noise,
        z=(int(declared["driving"]["teeth"]), int(declared["driven"]["teeth"])),
        hunting_cycles=raw.get("hunting_cycles"),
        over_limit=raw.get("depth", {}).get("over_limit"),
        concealed_by=raw.get("concealed_by", ""),
    )


def _item(raw: dict[str, Any]) -> Item:
    physics = raw.get("physics", "")
    known = {name: float(raw[name]) for name in (SIZES.get(physics, ""), *FURTHER) if name in raw}
    gear = raw.get("gear")
    return Item(
        physics=physics,
        shape=raw.get("shape", "" if physics else "line"),
        gear=GEARS[gear] if gear else None,
        tooth=raw.get("tooth"),
        teeth=raw.get("teeth"),
        encoder_deg=raw.get("encoder_deg"),
        order=raw.get("order"),
        hz=raw.get("hz"),
        parameters=known,
        over_limit=raw.get("over_limit"),
        acceptable=tuple(
            Rival(physics=one["physics"], gear=GEARS.get(one.get("gear")), separability=float(one["separability"]))
            for one in raw.get("acceptable", ())
        ),
    )
