"""What the header of one of Klingelnberg's exports says of the gear, in German or English."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from gearpoly.errors import InputFileError, shown
from gearpoly.files.inspection.klingelnberg_text import Export

RANGE = ("start_mm", "end_mm")
"""Diameters between which profiles were measured."""

LABELS = {
    "teeth": r"z(ä|ae|\W)hnezahl|(no\.?|number) of teeth",
    "module_mm": r"normalmodul|normal module|^modul\b|^module\b",
    "pressure_angle_deg": r"eingriffswinkel|pressure angle",
    "helix_deg": r"schr(ä|ae|\W)gungswinkel|helix angle",
    "profile_shift": r"profilversch\w*|profile shift|addendum mod\w*",
    "face_width_mm": r"zahnbreite|face ?width",
    "tip_diameter_mm": r"kopfkreis|tip diameter|tip circle|outside diameter",
    "start_mm": r"(start|anfang|beginn?)\b.*\bda\b",
    "end_mm": r"\bend\w*\b.*\bde\b",
}
"""What a line of the header holds, by its label in German or English."""

BOUNDS = (("module_mm", 0.05, 100.0), ("pressure_angle_deg", 10.0, 35.0), ("profile_shift", -5.0, 5.0))
"""Those of a pair file; what lies outside was taken from another line."""


def gear_header(export: Export, known: Mapping[str, float]) -> dict[str, float]:
    """Keys of a pair file that the header states, over those that are ``known`` beside it; with :data:`RANGE`.

    Raises ``InputFileError`` where both contradict each other, and for a gear that is not spur or has no teeth.
    """
    file, header = export.file, _found(export)
    for key, value in known.items():
        if key not in RANGE:
            check_agrees(file, key, header.get(key), value)
    _refuse_units(export, known)
    # Where profiles run is the machine's to say, and yours where it says it otherwise.
    header = {**known, **header, **{key: known[key] for key in RANGE if key in known}}
    helix = header.pop("helix_deg", 0.0)
    if helix != 0.0:
        wish = "want a spur gear, which is all that gearpoly simulates"
        raise InputFileError(file, found=f"a helix angle of {helix:g} deg", wish=wish)
    if "teeth" not in header:
        wish = "want a line with Zähnezahl or No. of teeth, or [gear] teeth in a file that --map names"
        raise InputFileError(file, found="no number of teeth in the header", wish=wish)
    z = header["teeth"]
    if z != int(z) or not 5 <= z <= 10_000:
        raise InputFileError(file, found=f"{z:g} teeth", wish="want a whole number from 5 to 10000")
    for key, low, high in BOUNDS:
        if key in header and not low <= header[key] <= high:
            wish = f"want {low:g} to {high:g}; is the line of the header another quantity?"
            raise InputFileError(file, where=key, found=f"{header[key]:g}", wish=wish)
    return header


def check_agrees(file: Path, key: str, found: float | None, stated: float) -> None:
    """Raise ``InputFileError`` where a sheet states another number than is stated beside it."""
    if found is not None and abs(found - stated) > 1e-3 * max(abs(stated), 0.1):
        wish = f"want one gear: correct {key} in the pair file or the map, or name another sheet"
        raise InputFileError(file, where=key, found=f"{found:g}, and {stated:g} is stated beside it", wish=wish)


def _found(export: Export) -> dict[str, float]:
    """Geometry by key: the first line of each kind that holds a number."""
    out: dict[str, float] = {}
    for key, pattern in LABELS.items():
        for line in export.fields:
            plain = key not in RANGE and re.search(r"\b(start|anfang|ende?|beginn?)\b", line.label, re.I)
            numbers = line.numbers()
            if numbers and not plain and re.search(pattern, line.label, re.IGNORECASE):
                out[key] = numbers[0]
                if key == "profile_shift" and "mm]" in line.label and "module_mm" in out:
                    out[key] /= out["module_mm"]
                break
    return out


def _refuse_units(export: Export, known: Mapping[str, float]) -> None:
    """Refuse inches, and a range of profiles that is no diameter unless the diameters are stated beside it."""
    units, profile = (export.preamble.get(key, "").lower() for key in ("UNITS", "PROFILE"))
    if "inch" in units:
        raise InputFileError(
            export.file, where="UNITS", found=f'"{shown(units)}"', wish="want mm: export it again in mm"
        )
    by_diameter = not profile or any(word in profile for word in ("diam", "durchm"))
    curves = any(curve.kind == "profile" for curve in export.curves)
    if curves and not by_diameter and not all(key in known for key in RANGE):
        wish = "state the diameters in mm between which they run, [gear] start_mm and end_mm in a file that --map names"
        raise InputFileError(export.file, where="PROFILE", found=f'profiles over "{shown(profile)}"', wish=wish)
