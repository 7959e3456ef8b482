"""Inspection files read: XML that may come from anywhere, so parsed without entities, every unit and count checked."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from gearpoly.errors import InputFileError, MissingExtraError, shown
from gearpoly.files.gde import GDE_UNITS, GEOMETRY, REQUIRED, ROOT, TOLERANCES, GearInspection, Profile, Side, Turn
from gearpoly.files.paths import unreadable
from gearpoly.files.traces import (
    DEVIATION_LIMIT_UM,
    FILE_LIMIT_BYTES,
    check_file,
    nearest,
    parse_number,
)
from gearpoly.keys.kinds import NAME_SHOWN


def read_gde(path: Path | str, *, count: Turn | None = None) -> GearInspection:
    """Read and check one inspection file.

    Raises ``InputFileError`` naming the block, what stands there and what would do; also for entities and other XML
    that could make a parser work or fetch without end. ``MissingExtraError`` without defusedxml.
    """
    file = Path(path)
    check_file(file, limit_bytes=FILE_LIMIT_BYTES)
    root = _Block(file, _parsed(file), "")
    if root.tag != ROOT:
        raise root.fault(f"<{shown(root.tag)}>", f"want <{ROOT}> (docs/reference/export.md has the subset)")
    root.check_blocks(("identification", "geometry", "tolerances", "inspection"))
    identification = root.child("identification")
    name = identification.child("name") if identification is not None else None
    block = root.needed("geometry")
    geometry = block.numbers(GEOMETRY)
    for key in REQUIRED:
        if key not in geometry:
            raise block.fault(f"no <{key}>", f"want <{key}>, of {', '.join(REQUIRED)}")
    z = geometry["number_of_teeth"]
    if z != int(z) or not 5 <= z <= 10_000:
        raise block.fault(f"number_of_teeth = {z:g}", "want a whole number from 5 to 10000")
    if geometry.get("helix_angle", 0.0) != 0.0:
        raise block.fault(f"helix_angle = {geometry['helix_angle']:g} deg", "want 0: only spur gears are read")
    tolerances = root.child("tolerances")
    measured = root.needed("inspection")
    measured.check_blocks(("pitch", "tooth_thickness", "profile"))
    if measured.element.get("tooth_count") is not None or count is None:
        count = cast(Turn, measured.choice("tooth_count", ("clockwise", "counterclockwise")))
    arc = math.cos(math.radians(geometry["normal_pressure_angle"]))
    pitch: dict[Side, tuple[float, ...]] = {}
    for one in measured.children("pitch"):
        side = cast(Side, one.choice("flank", ("left", "right")))
        if side in pitch:
            raise one.fault(f"<pitch> of the {side} flank twice", "want each flank once")
        # A deviation along the reference circle is its normal part over cos(alpha).
        factor = arc if one.choice("direction", ("normal", "arc")) == "arc" else 1.0
        pitch[side] = tuple(factor * value for value in one.row("um", count=int(z)))
    thick = measured.child("tooth_thickness")
    profiles = tuple(_profile(one, int(z)) for one in measured.children("profile"))
    seen: set[tuple[int, str]] = set()
    for profile in profiles:
        if (profile.tooth, profile.flank) in seen:
            found = f"tooth {profile.tooth}, {profile.flank} flank twice"
            raise measured.fault(found, "want each flank's profile once")
        seen.add((profile.tooth, profile.flank))
    if not pitch and not profiles and thick is None:
        raise measured.fault("nothing measured", "want <pitch>, <tooth_thickness> or <profile>")
    return GearInspection(
        name=shown((name.text if name is not None else "") or file.stem, width=NAME_SHOWN),
        geometry=geometry,
        tolerances={} if tolerances is None else tolerances.numbers(TOLERANCES),
        count=count,
        pitch=pitch,
        thickness=None if thick is None else thick.row("um", count=int(z)),
        profiles=profiles,
    )


def _profile(block: _Block, z: int) -> Profile:
    text = block.element.get("tooth", "")
    if not (text.isascii() and text.isdigit() and len(text) < 9 and 1 <= int(text) <= z):
        raise block.fault(f'tooth = "{shown(text)}"', f"want a tooth number from 1 to {z}")
    side = cast(Side, block.choice("flank", ("left", "right")))
    here = _Block(block.file, block.element, f"inspection.profile[tooth {text}, {side}]")
    here.check_blocks(("roll_length", "deviation"))
    roll = here.needed("roll_length").row("mm")
    deviation = here.needed("deviation").row("um", count=len(roll))
    if len(roll) < 2:
        raise here.fault(f"{len(roll)} points", "want at least 2")
    if roll[0] < 0.0 or any(b <= a for a, b in itertools.pairwise(roll)):
        raise here.fault("roll lengths that do not rise from 0 or more", "want them in mm, each larger than the last")
    return Profile(tooth=int(text), flank=side, roll_length=roll, deviation=deviation)


def _parsed(file: Path) -> Any:
    try:
        from defusedxml import DefusedXmlException
        from defusedxml.ElementTree import ParseError, fromstring
    except ImportError:
        raise MissingExtraError("GDE files need defusedxml: pip install 'gearpoly[gde]'") from None
    try:
        data = file.read_bytes()
    except OSError as error:
        raise unreadable(file, error) from None
    try:
        return fromstring(data)
    except DefusedXmlException as error:
        found = f"XML that declares entities or fetches others ({type(error).__name__})"
        raise InputFileError(
            file, found=found, wish="want plain data: nothing of the kind is expanded; take <!DOCTYPE ...> out"
        ) from None
    except (ParseError, ValueError, LookupError, RecursionError) as error:
        line = getattr(error, "position", (0, 0))[0]
        where = f"line {line}" if line else ""
        raise InputFileError(
            file, where=where, found=f"no XML ({shown(str(error))})", wish="want the whole file in XML: export it again"
        ) from None


@dataclass(frozen=True)
class _Block:
    """One element with the path that messages call it by."""

    file: Path
    element: Any
    where: str

    @property
    def tag(self) -> str:
        # A namespace changes nothing about what a block is.
        return str(self.element.tag).rpartition("}")[2]

    @property
    def text(self) -> str:
        return (self.element.text or "").strip()

    def fault(self, found: str, wish: str) -> InputFileError:
        return InputFileError(self.file, where=self.where, found=found, wish=wish)

    def children(self, tag: str) -> list[_Block]:
        here = f"{self.where}.{tag}".lstrip(".")
        found = [_Block(self.file, one, here) for one in self.element if isinstance(one.tag, str)]
        return [one for one in found if one.tag == tag]

    def child(self, tag: str) -> _Block | None:
        found = self.children(tag)
        if len(found) > 1:
            raise found[1].fault("a second one", f"want one <{tag}>")
        return found[0] if found else None

    def needed(self, tag: str) -> _Block:
        found = self.child(tag)
        if found is None:
            raise self.fault(f"no <{tag}>", f"want a block <{tag}>")
        return found

    def check_blocks(self, known: tuple[str, ...]) -> None:
        """Refuse a block of another name, since a slip of the keyboard would silently drop what was measured."""
        for one in self.element:
            tag = str(one.tag).rpartition("}")[2]
            if isinstance(one.tag, str) and tag not in known:
                wish = f"the nearest known block is <{nearest(tag, known)}> (known: {', '.join(known)})"
                raise self.fault(f"unknown block <{shown(tag)}>", wish)

    def choice(self, name: str, known: tuple[str, ...]) -> str:
        value = self.element.get(name)
        if value not in known:
            found = f"no {name}" if value is None else f'{name} = "{shown(value)}"'
            raise self.fault(found, f"want {name} = {' or '.join(known)}")
        return str(value)

    def row(self, unit: str, *, count: int | None = None) -> tuple[float, ...]:
        """Numbers separated by blanks, in ``unit``; ``count`` of them where given."""
        stated, known = self.element.get("unit"), GDE_UNITS[unit]
        if known and stated not in known:
            found = "no unit" if stated is None else f'unit "{shown(stated)}"'
            raise self.fault(found, f"want {' or '.join(known)}")
        if not known and stated is not None:
            raise self.fault(f'unit "{shown(stated)}"', "want a plain number without unit")
        factor = known[stated] if stated is not None else 1.0
        values = []
        for cell in self.text.split():
            value = parse_number(cell)
            if value is None or not math.isfinite(value):
                raise self.fault(f'"{shown(cell)}"', "want finite numbers with decimal points")
            values.append(factor * value)
            if unit == "um" and abs(values[-1]) > DEVIATION_LIMIT_UM:
                raise self.fault(f"{cell} {stated}", f"want -{DEVIATION_LIMIT_UM:.0f} to {DEVIATION_LIMIT_UM:.0f} um")
        if count is not None and len(values) != count:
            raise self.fault(f"{len(values)} values", f"want {count}")
        return tuple(values)

    def numbers(self, known: dict[str, str]) -> dict[str, float]:
        """The single numbers of a block by name, as the file has them."""
        self.check_blocks(tuple(known))
        out = {}
        for name, unit in known.items():
            one = self.child(name)
            if one is not None:
                (out[name],) = one.row(unit, count=1)
        return out
