"""An inspection sheet in any format that is known, found by its first bytes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.gde import Turn
from gearpoly.files.gde_read import read_gde
from gearpoly.files.inspection.klingelnberg import read_klingelnberg
from gearpoly.files.inspection.klingelnberg_header import check_agrees
from gearpoly.files.inspection.klingelnberg_text import is_export
from gearpoly.files.inspection.measured import MeasuredGear
from gearpoly.files.inspection.sheet_map import SheetMap
from gearpoly.files.inspection.table import read_table

GDE_NAMES = {
    "number_of_teeth": "teeth",
    "normal_module": "module_mm",
    "normal_pressure_angle": "pressure_angle_deg",
    "profile_shift_coefficient": "profile_shift",
    "face_width": "face_width_mm",
    "tip_diameter": "tip_diameter_mm",
}
"""Names of a GDE file as keys of a pair file."""

OF_TABLES = ("columns", "blocks", "separator", "decimal", "unit", "first_tooth")
"""Keys of a map that say how a table is laid out."""


def read_sheet(
    file: Path, start: bytes, *, layout: SheetMap, known: Mapping[str, float], count: Turn | None
) -> MeasuredGear:
    """The gear of an inspection sheet that begins with the bytes ``start``.

    ``layout`` and ``known`` (keys of the pair file) say what it leaves open. Raises ``InputFileError`` where it cannot
    be read, or lacks what nobody stated.
    """
    both = {**known, **layout.known}
    for key in known.keys() & layout.known.keys():
        if abs(known[key] - layout.known[key]) > 1e-6 * max(1.0, abs(known[key])):
            found = f"{key} = {layout.known[key]:g} in the map, and {known[key]:g} in the pair file"
            raise InputFileError(file, found=found, wish="want one gear: correct one of the two")
    export = is_export(start)
    if not export and not start.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        return read_table(file, layout, known=both, count=count)
    for key in OF_TABLES:
        if getattr(layout, key):
            wish = f"leave {key} out of the map: such a file states that itself, and only tables need it"
            raise InputFileError(file, found=f"no table, and {key} in the map", wish=wish)
    count = count or layout.count
    return read_klingelnberg(file, known=both, count=count) if export else _gde(file, known=both, count=count)


def _gde(file: Path, *, known: Mapping[str, float], count: Turn | None) -> MeasuredGear:
    gear = read_gde(file, count=count)
    if count is not None and count != gear.count:
        wish = "leave --count, or count in the map, out: the file states it"
        found = f'tooth_count = "{gear.count}", and {count} is stated'
        raise InputFileError(file, where="inspection", found=found, wish=wish)
    geometry = {GDE_NAMES[key]: value for key, value in gear.geometry.items() if key in GDE_NAMES}
    for key, value in known.items():
        check_agrees(file, key, geometry.get(key), value)
    return MeasuredGear(
        file=file,
        name=gear.name,
        geometry={**{key: value for key, value in known.items() if key in GDE_NAMES.values()}, **geometry},
        count=gear.count,
        material=gear.pitch,
        profiles=gear.profiles,
        thickness=gear.thickness,
        says=("element names are gearpoly's own subset, not checked against the schema of VDI/VDE 2610",),
    )
