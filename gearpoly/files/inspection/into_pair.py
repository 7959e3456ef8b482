"""An inspected gear into a pair file: a table added to one that is there, or the beginning of a new one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from gearpoly.errors import InputFileError
from gearpoly.files.faults import explain
from gearpoly.files.inspection.measured import MeasuredGear, OwnTrace, Translated, Which
from gearpoly.files.models import PairFile
from gearpoly.files.output import write_text
from gearpoly.files.paths import look
from gearpoly.files.sheet_csv import with_sheets
from gearpoly.files.toml import parse
from gearpoly.files.toml_text import table, value_text
from gearpoly.files.traces import read_text
from gearpoly.keys.kinds import NAME_SHOWN
from gearpoly.keys.sizes import with_sizes

SHEET_SAME_GEAR_TOLERANCE = 1e-4
"""Relative. Sheets print module and angle to 4 decimals; the next module or angle differs by a hundredth."""

COMPARED = ("teeth", "module_mm", "pressure_angle_deg", "profile_shift", "face_width_mm")
"""Keys that must agree where both files state them. A face width that was measured is none that was ordered."""

MATES: dict[Which, Which] = {"driving": "driven", "driven": "driving"}


@dataclass(frozen=True, kw_only=True)
class Target:
    """A pair file to be written: its ``tables`` so far, and its text, "" where there is none yet."""

    file: Path
    text: str
    tables: Mapping[str, Any]

    def gear(self, which: Which) -> dict[str, Any]:
        """The table of one gear with its sizes as module and coefficients, empty where there is none."""
        raw = self.tables.get(which, {})
        try:
            return with_sizes(raw)
        except PydanticCustomError as error:
            rule = error.context or {}
            where = f"{which}.{rule.get('key')}"
            raise InputFileError(
                self.file, where=where, found=rule.get("found", ""), wish=rule.get("wish", "")
            ) from None


def read_target(file: Path, *, which: Which) -> Target:
    """The pair file as it stands. Raises ``InputFileError`` where it has an inspection of the ``which`` gear."""
    if look(file) is None:
        return Target(file=file, text="", tables={})
    text = read_text(file)
    tables = parse(file, text)
    section = tables.get(which, {})
    if not isinstance(section, dict):
        raise InputFileError(file, where=which, found="no table", wish=f"want [{which}] with the keys of the gear")
    if "inspection" in section:
        wish = f"take [{which}.inspection] out of the file, or name another file"
        raise InputFileError(file, where=f"{which}.inspection", found="an inspection already", wish=wish)
    return Target(file=file, text=text, tables=tables)


def stated(target: Target, which: Which) -> dict[str, float]:
    """What the pair file states of the gear that a sheet may leave out."""
    gear = target.gear(which)
    out = {key: gear[key] for key in COMPARED[:3] if isinstance(gear.get(key), int | float)}
    return out | ({} if not gear or "pressure_angle_deg" in out else {"pressure_angle_deg": 20.0})


def write_gear(target: Target, sheet: MeasuredGear, keys: Translated, *, which: Which) -> tuple[list[Path], list[str]]:
    """Write the inspection ``keys`` of the ``which`` gear into its pair file, and its traces beside it.

    Gives the files that were written, and what is still open. Raises ``InputFileError`` where sheet and pair file are
    of different gears.
    """
    section, file = target.gear(which), target.file
    geometry = {key: value for key, value in sheet.geometry.items() if key != "helix_deg"}
    says: list[str] = []
    if section:
        _compare(target, sheet, section, which)
        lines = [target.text.rstrip("\n")]
    else:
        own, says = _own(sheet, geometry, which)
        lines = [target.text.rstrip("\n")] if target.text else [_beginning(sheet)]
        lines += ["", *table(which, own)]
    beside = file.with_name(f"{file.stem}_{which}_profiles.csv")
    inspection = dict(keys.keys)
    if "span_teeth" in inspection:
        inspection["span_teeth"] = int(str(inspection["span_teeth"]).partition(".")[0])
    if keys.traces:
        if look(beside) is not None:
            raise InputFileError(beside, found="this file exists", wish="want it out of the way: the profiles go there")
        inspection["profile_csv"] = beside.name
    lines += ["", *table(f"{which}.inspection", inspection, f"from {sheet.file.name}")]
    mate = MATES[which]
    text = "\n".join(lines) + "\n"
    raw = parse(file, text)
    if isinstance(raw.get(mate), dict):
        _check(file, raw)
    else:
        says.append(
            f"{file.name} has no [{mate}] yet: run this command for that gear too, with --as {mate}, or state its "
            "teeth and module in the file"
        )
    written = []
    if keys.traces:
        write_text(beside, traces_text(keys.traces, sheet.file.name))
        written.append(beside)
    write_text(file, text)
    return [*written, file], says


def _check(file: Path, raw: dict[str, Any]) -> None:
    """Refuse a pair file that would not be read."""
    whole = with_sheets(raw, file)
    try:
        PairFile.model_validate(whole)
    except ValidationError as error:
        raise explain(file, whole, error) from None


def _compare(target: Target, sheet: MeasuredGear, section: Mapping[str, Any], which: Which) -> None:
    for key in COMPARED[:4]:
        mine, theirs = sheet.geometry.get(key), section.get(key, 20.0 if key == "pressure_angle_deg" else None)
        if key == "profile_shift" and mine is not None:
            theirs = section.get(key, 0.0)
        if mine is None or not isinstance(theirs, int | float):
            continue
        if abs(mine - theirs) > SHEET_SAME_GEAR_TOLERANCE * max(abs(theirs), 1.0):
            wish = f"want {theirs:g}, as {target.file.name} has it for the {which} gear; or correct {which}.{key} there"
            raise InputFileError(sheet.file, where=key, found=f"{mine:g}", wish=wish)


def _own(sheet: MeasuredGear, geometry: Mapping[str, float], which: Which) -> tuple[dict[str, object], list[str]]:
    """The gear's own keys for a new pair file, and what the sheet does not say of them."""
    if "module_mm" not in geometry:
        wish = "want [gear] module_mm in a file that --map names, or a pair file that has the gear already"
        raise InputFileError(sheet.file, found="no module", wish=wish)
    own: dict[str, object] = {"teeth": int(geometry["teeth"])}
    own |= {
        key: geometry[key]
        for key in ("module_mm", "pressure_angle_deg", "profile_shift", "face_width_mm")
        if key in geometry
    }
    says = []
    for key, value in (("pressure_angle_deg", "20 deg"), ("profile_shift", "0")):
        if key not in geometry:
            says.append(
                f"{sheet.file.name} does not state {key}: {value} is taken; state it in [{which}] where it is not"
            )
    if "tip_diameter_mm" in geometry:
        if "profile_shift" in geometry:
            own["tip_diameter_mm"] = geometry["tip_diameter_mm"]
        else:
            says.append(
                f"the tip diameter, {geometry['tip_diameter_mm']:g} mm, is left out: state it as tip_diameter_mm in "
                f"[{which}] beside profile_shift"
            )
    return own, says


def _beginning(sheet: MeasuredGear) -> str:
    head = f"# A pair file of gearpoly, begun from {sheet.file.name}. All keys: docs/reference/pair_file.md."
    return f"{head}\n\nname = {value_text(sheet.name[:NAME_SHOWN])}"


def traces_text(traces: Sequence[OwnTrace], source: str) -> str:
    """Traces as ``inspection.profile_csv`` reads them."""
    lines = [f"# measured profiles from {source}: deviation normal to the flank, positive = more material"]
    lines.append("tooth,flank,roll_length_mm,deviation_um")
    for one in traces:
        lines += [f"{one.tooth},{one.flank},{l!r},{d!r}" for l, d in zip(one.roll_length, one.deviation, strict=True)]
    return "\n".join(lines) + "\n"
