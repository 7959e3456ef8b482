"""Small pairs with something hidden, and recordings of them that a rig adds something to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearpoly.files.models import PairFile
from gearpoly.keys.edit import on_gear
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray
from tests.pair_files import made
from tests.physics_cases import Condition, recorded, rough

UNLOADED = Condition(torque_nm=0.0)
COAST = Condition(torque_nm=0.0, flank="coast")


def inspected(z: tuple[int, int] = (8, 11)) -> PairFile:
    """A rigid pair inspected to 0.2 um, whose teeth are apart by microns."""
    return rough(z, bends=False, points=300)


def bending(z: tuple[int, int] = (12, 16)) -> PairFile:
    """The same of teeth that bend by the default law."""
    return rough(z, bends=True, points=400)


def graded(
    z: tuple[int, int] = (8, 11), *, bends: bool = False, seed: int = 7, pitch_um: float = 1.0, slope_um: float = 0.4
) -> tuple[PairFile, PairFile]:
    """A pair of grade 6 as it was built, with single pitches and slopes of these standard deviations, and as it is
    declared: by its grade and the limits of its thickness."""
    rng = np.random.default_rng(seed)
    true: dict[str, Any] = {"model": {"tooth_deflection": bends}}
    known: dict[str, Any] = {"model": {"tooth_deflection": bends}}
    for name, teeth in zip(("driving", "driven"), z, strict=True):
        size = {"teeth": teeth, "module_mm": 2.0, "face_width_mm": 20.0, "points_per_flank": 400}
        chain = np.cumsum(rng.normal(0.0, pitch_um, teeth))
        # A closed chain: the last pitch ends where the first began.
        chain -= chain[-1] * np.arange(1, teeth + 1) / teeth
        sheet = {
            "pitch_um": (chain - chain.mean()).round(3).tolist(),
            "profile_slope_um": rng.normal(0.0, slope_um, teeth).round(3).tolist(),
            "tooth_thickness_um": -60.0,
        }
        true[name] = {**size, "inspection": sheet}
        known[name] = {**size, "grade": 6, "limits": {"E_sns_um": -50, "E_sni_um": -70}}
    return PairFile.model_validate(true), PairFile.model_validate(known)


def sheet(file: PairFile, gear: int, **keys: object) -> PairFile:
    """The file with other keys in the inspection of a gear (0, 1)."""
    section = (file.driving, file.driven)[gear].inspection
    assert section is not None
    return on_gear(file, gear, inspection=section.model_copy(update=keys))


def listed(file: PairFile, gear: int, key: str) -> FloatArray:
    """What the inspection of a gear says of every tooth."""
    value = getattr((file.driving, file.driven)[gear].inspection, key)
    return np.asarray(value, dtype=np.float64)


def hidden(
    file: PairFile, physics: str, values: Sequence[float], *, gear: int | None = None, tooth: int | None = None,
    order: int | None = None, flank: Any = None, form: str | None = None, in_recordings: tuple[int, ...] = (),
) -> PairFile:  # fmt: skip
    """The pair with a physics that its file does not tell."""
    place = Place(gear=gear, tooth=tooth, order=order, flank=flank, form=form, recordings=in_recordings)
    return Claim(physics=catalogue()[physics], place=place, values=tuple(values)).written(file)


def record(
    true: PairFile, *conditions: Condition, seed: int = 1, cycles: float = 3.0, per_mesh: int = 12,
    noise_um: float = 0.3,
) -> list[Recording]:  # fmt: skip
    """Recordings of the pair as it is, one per condition, by the simulator and white noise."""
    rng = np.random.default_rng(seed)
    return recorded(true, conditions, rng, cycles=cycles, per_mesh=per_mesh, noise_um=noise_um)


def added(one: Recording, file: PairFile, um: FloatArray) -> Recording:
    """A recording whose driven shaft ran ahead by so much (n,) in um along the line of action."""
    assert one.driven_angle_rad is not None
    return replace(one, driven_angle_rad=one.driven_angle_rad + um * UM / made(file).pair.r_b2)
