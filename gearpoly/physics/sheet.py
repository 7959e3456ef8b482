"""Changes of what an inspection says of each tooth."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.keys.edit import changed, gear_section, on_gear
from gearpoly.keys.sections import GearSection, Inspection, PairFile
from gearpoly.physics.base import Scope
from gearpoly.physics.place import Place
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.units import FloatArray

SHEET_DECIMALS = 6
"""Decimals in um that are kept: a thousandth of a nanometre is below every kernel."""


def column(section: GearSection, key: str) -> FloatArray:
    """The values (z,) in um that an inspection gives for ``key``, its defaults worked out."""
    sheet = section.inspection or Inspection()
    value = getattr(sheet, key)
    if value is None and key == "pitch_coast_um":
        rack = math.cos(math.radians(section.pressure_angle_deg))
        return column(section, "tooth_thickness_um") * rack - column(section, "pitch_um")
    if value is None and key in ("profile_slope_coast_um", "profile_crowning_coast_um"):
        return column(section, key.replace("_coast", ""))
    return np.broadcast_to(np.asarray(0.0 if value is None else value, dtype=np.float64), (section.teeth,)).copy()


def added(file: PairFile, gear: int | None, key: str, more: FloatArray | float) -> Inspection:
    """The inspection of a gear with ``more`` (z,) um on top of ``key``.

    What a change of the drive flank would drag along by default (the coast flank's pitch, slope and crowning) stays.
    """
    section = gear_section(file, gear)
    sheet = section.inspection or Inspection()
    keep: dict[str, object] = {}
    coast = {
        "pitch_um": "pitch_coast_um",
        "profile_slope_um": "profile_slope_coast_um",
        "profile_crowning_um": "profile_crowning_coast_um",
    }.get(key)
    if coast is not None and getattr(sheet, coast) is None:
        keep[coast] = _listed(column(section, coast))
    keep[key] = _listed(column(section, key) + more)
    copy: Inspection = changed(sheet, **keep)
    return copy


def _listed(values: FloatArray) -> tuple[float, ...] | float:
    rounded = np.round(values, SHEET_DECIMALS) + 0.0
    return float(rounded[0]) if np.all(rounded == rounded[0]) else tuple(rounded.tolist())


def pitched(file: PairFile, place: Place, more: FloatArray) -> PairFile:
    """The pair with ``more`` (z,) um of index deviation on the flank of a place, or on both: a tooth that stands ahead
    has more material on its drive flank and less on its coast flank."""
    keys = {"drive": ("pitch_um",), "coast": ("pitch_coast_um",)}.get(place.flank or "", ("pitch_um", "pitch_coast_um"))
    for key in keys:
        ahead = -more if place.flank is None and key == "pitch_coast_um" else more
        file = on_gear(file, place.gear, inspection=added(file, place.gear, key, ahead))
    return file


def pitched_sense(scene: ContactsAtSamples, place: Place) -> float:
    """Sign with which an index deviation at a place adds material to the flank of a scene; 0 where it is another's."""
    if place.flank is None:
        return scene.samples.sense
    return 1.0 if scene.samples.flank == place.flank else 0.0


def pitched_flanks(scope: Scope) -> list[str | None]:
    """Flanks on which an index deviation is looked for: the one that was recorded; of two both at once first, as a
    tooth out of its place has it, then each."""
    recorded = sorted(set(scope.flanks), reverse=True)
    return [None, *recorded] if len(recorded) > 1 else [*recorded]


def added_on_both(file: PairFile, gear: int | None, key: str, more: float) -> Inspection:
    """The inspection of a gear with ``more`` um on top of ``key`` (profile_slope, profile_crowning) of both flanks."""
    section = gear_section(file, gear)
    keys = (f"{key}_um", f"{key}_coast_um")
    keep: dict[str, object] = {name: _listed(column(section, name) + more) for name in keys}
    copy: Inspection = changed(section.inspection or Inspection(), **keep)
    return copy
