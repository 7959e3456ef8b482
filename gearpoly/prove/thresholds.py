"""What counts as right, from the frozen file beside the bench."""

from __future__ import annotations

import hashlib
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gearpoly.proving

FILE = Path(gearpoly.proving.__file__).parent / "thresholds.toml"


@dataclass(frozen=True, kw_only=True)
class Thresholds:
    """The values of ``gearpoly/proving/thresholds.toml`` (its comments say what each is) with the ``sha256`` of its
    bytes."""

    tooth: float
    order: float
    hz: float
    harmonics: int
    relative: float
    sigmas: float
    detected_from: float
    separable: float
    within: float
    floor_um: float
    true_look_alike: float
    mismatch_over_noise: float
    relief_within_um: float
    least_chance: float
    bins: int
    short_cycles: float
    goal: dict[str, Any]
    sha256: str
    values: dict[str, Any]


def read_thresholds(path: Path = FILE) -> Thresholds:
    """The thresholds of a file; ``KeyError`` where one is missing, which is a bug of the file."""
    raw = path.read_bytes()
    values = tomllib.loads(raw.decode())
    return Thresholds(
        tooth=values["match"]["tooth"],
        order=values["match"]["order"],
        hz=values["match"]["hz"],
        harmonics=values["match"]["harmonics"],
        relative=values["parameter"]["relative"],
        sigmas=values["parameter"]["sigmas"],
        detected_from=values["detection"]["over_limit"],
        separable=values["naming"]["separable"],
        within=values["look_alike"]["within"],
        floor_um=values["look_alike"]["floor_um"],
        true_look_alike=values["look_alike"]["true"],
        mismatch_over_noise=values["removed"]["mismatch_over_noise"],
        relief_within_um=values["relief"]["within_um"],
        least_chance=values["reliability"]["least"],
        bins=values["reliability"]["bins"],
        short_cycles=values["length"]["short"],
        goal=values["goal"],
        sha256=hashlib.sha256(raw).hexdigest(),
        values=values,
    )
