"""What is known of the pair: ``pair.toml`` read, checked, defaulted and written back.

The models hold the file's own keys in the file's own units (um, deg, N.m); geometry converts them.
A section that is absent is ``None`` where its absence means something (no limits, not inspected, no
relief, no eccentricity).
"""

from __future__ import annotations

import json
import math
import os
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn, Self, get_args

from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Strict,
    Tag,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails, PydanticCustomError

from gearpoly.errors import InputFileError
from gearpoly.files.traces import nearest, read_text, shorten

# Bounds catch a mistaken unit or digit; whether the gear can be cut is for the geometry to say.
Um = Annotated[float, Field(ge=-1e4, le=1e4)]
UmSize = Annotated[float, Field(ge=0.0, le=1e4)]
Length = Annotated[float, Field(gt=0.0, le=1e5)]

_NUMBER, _LIST = "@number", "@list"


def _number_or_list(value: object) -> str:
    return _LIST if isinstance(value, list | tuple) else _NUMBER


PerTooth = Annotated[
    Annotated[Um, Tag(_NUMBER)] | Annotated[Annotated[tuple[Um, ...], Strict(False)], Tag(_LIST)],
    Discriminator(_number_or_list),
]
"""One number for all teeth, or one per tooth in the order of meshing."""


def _field(description: str, default: Any = None, **bounds: Any) -> Any:
    return Field(default=default, description=description, **bounds)


def _broken(key: str, found: str, wish: str) -> NoReturn:
    """Refuse values that are fine one by one but not together; ``key`` counts from the model that
    checks.
    """
    raise PydanticCustomError("rule", "{key}: {found}; {wish}", {"key": key, "found": found, "wish": wish})


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class PairSection(_Section):
    """How the two gears are mounted and run."""

    centre_distance_mm: Length | None = _field(
        "centre distance in mm, above 0; default: tight mesh of the deviation-free gears"
    )
    torque_nm: float = _field(
        "torque on the driven shaft in N.m, 0 or more; its flank says which way it acts",
        0.0,
        ge=0.0,
        le=1e9,
    )
    speed_rpm: float | None = _field(
        "speed of the driving shaft in rpm, above 0; default: quasi-static", gt=0.0, le=1e6
    )


class ModelSection(_Section):
    """What the simulation takes into account."""

    tooth_deflection: bool = _field("true: teeth bend under load, false: rigid teeth", True)


class MaterialSection(_Section):
    """The material of both gears; default: steel."""

    youngs_modulus_gpa: float = _field("Young's modulus in GPa, above 0 to 10000", 206.0, gt=0.0, le=1e4)
    poisson_ratio: float = _field("Poisson's ratio, between -1 and 0.5", 0.3, gt=-1.0, lt=0.5)


class Limits(_Section):
    """Limits instead of, or over, those of the grade, in um."""

    f_pt_um: UmSize | None = _field("single pitch limit in um, 0 or more")
    F_p_um: UmSize | None = _field("total cumulative pitch limit in um, 0 or more")
    F_alpha_um: UmSize | None = _field("total profile limit in um, 0 or more")
    f_Halpha_um: UmSize | None = _field("profile slope limit in um, 0 or more")
    f_falpha_um: UmSize | None = _field("profile form limit in um, 0 or more")
    E_sns_um: Um | None = _field("upper tooth thickness deviation in um, along the reference circle; negative thins")
    E_sni_um: Um | None = _field("lower tooth thickness deviation in um, along the reference circle; negative thins")
    W_kns_um: Um | None = _field("upper base tangent length deviation in um; a drawn gear above it is drawn again")
    W_kni_um: Um | None = _field("lower base tangent length deviation in um; a drawn gear below it is drawn again")

    @model_validator(mode="after")
    def _upper_above_lower(self) -> Self:
        for symbol in ("E_sn", "W_kn"):
            upper, lower = getattr(self, f"{symbol}s_um"), getattr(self, f"{symbol}i_um")
            if upper is not None and lower is not None and upper < lower:
                found = f"{upper}, below {symbol}i_um = {lower}"
                _broken(
                    f"{symbol}s_um",
                    found,
                    f"want the upper deviation {symbol}s_um at or above the lower {symbol}i_um",
                )
        return self


class Inspection(_Section):
    """Measured deviations in um; each a number for all teeth or a list with one per tooth."""

    uncertainty_um: UmSize = _field("standard uncertainty of the inspection in um, 0 or more", 0.5)
    pitch_um: PerTooth | None = _field("index deviation of the drive flanks in um, positive = more material")
    pitch_coast_um: PerTooth | None = _field(
        "index deviation of the coast flanks in um; default: from pitch and thickness"
    )
    profile_slope_um: PerTooth | None = _field(
        "rise of material from active root to tip in um, of both flanks unless per flank"
    )
    profile_slope_coast_um: PerTooth | None = _field(
        "profile slope of the coast flanks in um; default: the drive flanks'"
    )
    profile_crowning_um: PerTooth | None = _field(
        "material missing at both ends in um, of both flanks unless per flank"
    )
    profile_crowning_coast_um: PerTooth | None = _field(
        "profile crowning of the coast flanks in um; default: the drive flanks'"
    )
    tooth_thickness_um: PerTooth | None = _field(
        "tooth thickness deviation E_s in um along the reference circle; negative thins"
    )
    profile_csv: str | None = _field("file of measured traces in quotes, relative to the pair file", min_length=1)


class TipRelief(_Section):
    """Material taken off towards the tip on purpose."""

    amount_um: UmSize = Field(description="relief at the tip in um, 0 or more")
    length_mm: Length = Field(description="radial length down from the tip in mm, above 0")
    shape: Literal["linear", "parabolic"] = _field("how the relief grows towards the tip", "linear")
    flank: Literal["both", "drive", "coast"] = _field("which flanks are relieved", "both")


class Eccentricity(_Section):
    """The gear's own centre as seen from its axis of rotation."""

    amplitude_um: UmSize = Field(description="distance of the gear's centre from its axis in um, 0 or more")
    angle_deg: float = _field(
        "angle in deg from the pitch point of tooth 0's drive flank, in the order of meshing",
        0.0,
        ge=-1e4,
        le=1e4,
    )


class GearSection(_Section):
    """One gear: its rack, its blank, its quality, and what was measured of it."""

    teeth: int = Field(ge=5, le=10_000, description="number of teeth, 5 or more")
    module_mm: float = Field(ge=0.05, le=100.0, description="module in mm, 0.05 to 100")
    pressure_angle_deg: float = _field("pressure angle in deg, 10 to 35", 20.0, ge=10.0, le=35.0)
    addendum: float = _field("addendum over the module, above 0 to 3", 1.0, gt=0.0, le=3.0)
    dedendum: float = _field("dedendum over the module, above 0 to 4", 1.25, gt=0.0, le=4.0)
    root_radius: float = _field("tip radius of the rack over the module, 0 to 1", 0.38, ge=0.0, le=1.0)
    profile_shift: float = _field("profile shift coefficient, -5 to 5", 0.0, ge=-5.0, le=5.0)
    face_width_mm: Length | None = _field("face width in mm, above 0")
    bore_mm: Length | None = _field("diameter of the bore in mm, above 0; default: half the root diameter")
    grade: int | None = _field("ISO 1328-1 grade; default: ideal gear", ge=0, le=12)
    grade_edition: Literal[1995, 2013] = _field("edition of ISO 1328-1, 1995 or 2013", 2013)
    points_per_flank: int | None = _field(
        "points on each involute flank, 8 to 200000; default: from chord_error_um", ge=8, le=200_000
    )
    chord_error_um: float = _field(
        "largest distance of a chord from its flank in um, 0.000001 to 10", 0.001, ge=1e-6, le=10.0
    )
    profile_errors: Literal["smooth", "scatter"] = _field(
        "how drawn profile errors vary: in smooth waves, or (the paper's) each point on its own",
        "smooth",
    )
    thickness_errors: Literal["graded", "independent"] = _field(
        "drawn thickness: the coast flank keeps the grade's pitch limits too, or (the paper's) "
        "each tooth's E_s on its own",
        "graded",
    )
    limits: Limits | None = _field("limits over the grade's, a table")
    inspection: Inspection | None = _field("what was measured, a table")
    tip_relief: TipRelief | None = _field("tip relief, a table")
    eccentricity: Eccentricity | None = _field("eccentricity, a table")

    @model_validator(mode="after")
    def _keys_agree(self) -> Self:
        if self.grade is not None and self.grade_edition == 2013 and not 1 <= self.grade <= 11:
            wish = "want 1 to 11, which the 2013 edition defines, or grade_edition = 1995 for 0 to 12"
            _broken("grade", f"{self.grade}, outside the 2013 edition", wish)
        if self.points_per_flank is not None and "chord_error_um" in self.model_fields_set:
            found = f"{self.points_per_flank}, and chord_error_um = {self.chord_error_um} too"
            _broken(
                "points_per_flank",
                found,
                "want one of the two, since each sets the number of points",
            )
        for key, values in self.inspection or ():
            if isinstance(values, tuple) and len(values) != self.teeth:
                wish = f"want {self.teeth}, one per tooth, or one number for all teeth"
                _broken(f"inspection.{key}", f"a list of {len(values)} values", wish)
        return self


class PairFile(_Section):
    """Everything that is known of a pair, in the file's units; made by :func:`read_pair`."""

    name: str = _field("name of the pair in quotes", "unnamed pair")
    pair: PairSection = _field("how the gears are mounted and run, a table", PairSection())
    model: ModelSection = _field("what is taken into account, a table", ModelSection())
    material: MaterialSection = _field("material of both gears, a table", MaterialSection())
    driving: GearSection = Field(description="the driving gear, a table")
    driven: GearSection = Field(description="the driven gear, a table")

    @model_validator(mode="after")
    def _gears_agree(self) -> Self:
        for key, called in (("module_mm", "module"), ("pressure_angle_deg", "pressure angle")):
            mine, mate = getattr(self.driven, key), getattr(self.driving, key)
            if mine != mate:
                default = "" if key in self.driven.model_fields_set else " by default"
                mate_default = "" if key in self.driving.model_fields_set else " by default"
                found = f"{mine}{default}, but driving.{key} = {mate}{mate_default}"
                _broken(
                    f"driven.{key}",
                    found,
                    f"want the same {called} in both gears, or they do not mesh",
                )
        if self.model.tooth_deflection and self.pair.torque_nm > 0.0:
            for gear in ("driving", "driven"):
                if getattr(self, gear).face_width_mm is None:
                    torque = f"pair.torque_nm = {self.pair.torque_nm} bends the teeth"
                    wish = f"want a face width in mm, since {torque} (or tooth_deflection = false)"
                    _broken(f"{gear}.face_width_mm", "missing", wish)
        return self


def read_pair(path: Path | str) -> PairFile:
    """Read and check a pair file.

    Raises ``InputFileError`` with the file, the dotted key (or line and column), what stands there
    and what would do: the most basic fault first (unknown keys, then bad values, then missing keys,
    then keys that contradict one another).
    """
    file = Path(path)
    raw = _parse(file, read_text(file))
    try:
        pair = PairFile.model_validate(raw)
    except ValidationError as error:
        raise _explain(file, raw, error) from None
    for gear, section in (("driving", pair.driving), ("driven", pair.driven)):
        traces = profile_csv_path(file, section)
        if traces is not None and not traces.is_file():
            found = f"no such file, {traces}"
            wish = "want the path of a trace file, relative to the pair file"
            raise InputFileError(file, where=f"{gear}.inspection.profile_csv", found=found, wish=wish)
    return pair


def profile_csv_path(file: Path | str, gear: GearSection) -> Path | None:
    """Where the measured traces of a gear of the pair file ``file`` lie, or ``None``; for
    :func:`~.traces.read_traces`.
    """
    if gear.inspection is None or gear.inspection.profile_csv is None:
        return None
    return Path(file).parent / gear.inspection.profile_csv


def moved(pair: PairFile, *, source: Path | str, target: Path | str) -> PairFile:
    """The pair as a file ``target`` must hold it, so that trace files named in ``source`` are still
    found.
    """
    gears: dict[str, GearSection] = {}
    for name, gear in (("driving", pair.driving), ("driven", pair.driven)):
        traces = profile_csv_path(source, gear)
        if (
            traces is not None
            and gear.inspection is not None
            and not Path(gear.inspection.profile_csv or "").is_absolute()
        ):
            relative = Path(os.path.relpath(traces, Path(target).parent)).as_posix()
            inspection = gear.inspection.model_copy(update={"profile_csv": relative})
            gears[name] = gear.model_copy(update={"inspection": inspection})
    return pair.model_copy(update=gears)


_COMPUTED = {
    "centre_distance_mm": "tight mesh of the deviation-free gears",
    "speed_rpm": "quasi-static",
    "bore_mm": "half the root diameter",
}


def effective_defaults(pair: PairFile) -> list[tuple[str, object]]:
    """The keys that the file left to their defaults and that have an effect: dotted key and value.

    A default that the geometry computes is given in words. Absent sections below a gear have no
    defaults to show.
    """
    return list(_defaults(pair, ""))


def _defaults(section: _Section, prefix: str) -> Iterator[tuple[str, object]]:
    idle: set[str] = set()
    if isinstance(section, GearSection):
        if section.points_per_flank is not None:
            idle.add("chord_error_um")
        if section.grade is None:
            idle.add("grade_edition")
            if section.limits is None:  # nothing is drawn at random
                idle |= {"profile_errors", "thickness_errors"}
    for key, value in section:
        if isinstance(value, _Section):
            yield from _defaults(value, f"{prefix}{key}.")
        elif key not in section.model_fields_set and key not in idle:
            if value is not None:
                yield f"{prefix}{key}", value
            elif key in _COMPUTED:
                yield f"{prefix}{key}", _COMPUTED[key]
            elif key == "grade" and not section.model_fields_set & {"limits", "inspection"}:
                yield f"{prefix}{key}", "ideal gear"


def dump_pair(pair: PairFile) -> str:
    """The pair as TOML text that :func:`read_pair` reads back equal; keys left to their defaults
    stay left out.
    """
    return "\n".join(_dump(pair, "")) + "\n"


def _dump(section: _Section, prefix: str) -> Iterator[str]:
    tables: list[tuple[str, _Section]] = []
    for key, value in section:
        default = type(section).model_fields[key].default
        if value is None or (key not in section.model_fields_set and value == default):
            continue
        if isinstance(value, _Section):
            tables.append((key, value))
        else:
            yield f"{key} = {_toml(value)}"
    for key, table in tables:
        yield f"\n[{prefix}{key}]"
        yield from _dump(table, f"{prefix}{key}.")


def _toml(value: object) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")  # TOML also forbids a bare DEL
    if isinstance(value, tuple):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    return str(value).lower() if isinstance(value, bool) else repr(value)


# From here on: faults in words.


def _parse(file: Path, text: str) -> dict[str, Any]:
    wish = "want TOML: `key = value`, text in quotes, decimal points, each key and section once"
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputFileError(file, found="lists or tables nested too deep", wish=wish) from None
    except ValueError as error:  # TOMLDecodeError, or an integer with more digits than Python converts
        message = str(error)
    place = re.search(r" \(at (?:line (\d+), column (\d+)|end of document)\)$", message)
    if place is None:
        raise InputFileError(file, found=shorten(message), wish=wish)
    lines = text.splitlines() or [""]
    line, column = (int(place[1]), int(place[2])) if place[1] else (len(lines), len(lines[-1]) + 1)
    standing = lines[line - 1].strip() if line <= len(lines) else ""
    found = f"`{shorten(standing)}` ({message[: place.start()]})"
    raise InputFileError(file, where=f"line {line}, column {column}", found=found, wish=wish)


def _sections(
    model: type[_Section] = PairFile, path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], type[_Section]]]:
    """Every section that a pair file can have, with its path."""
    yield path, model
    for key, info in model.model_fields.items():
        for kind in (info.annotation, *get_args(info.annotation)):
            if isinstance(kind, type) and issubclass(kind, _Section):
                yield from _sections(kind, (*path, key))


_SECTIONS = dict(_sections())
_WANT = {
    "int_type": "a whole number",
    "float_type": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "string_type": "text in quotes",
    "string_too_short": "text that is not empty",
    "tuple_type": "a list of numbers",
}
_BOUND = {
    "greater_than_equal": ("ge", "too small", "{} or more"),
    "greater_than": ("gt", "too small", "more than {}"),
    "less_than_equal": ("le", "too large", "{} or less"),
    "less_than": ("lt", "too large", "less than {}"),
}


def _explain(file: Path, raw: dict[str, Any], error: ValidationError) -> InputFileError:
    """The one message for the most basic fault, and of equals the first in the file."""
    faults = error.errors(include_url=False)
    fault = min(faults, key=lambda fault: (_rank(fault), _position(raw, _loc(fault))))
    loc, kind, context = _loc(fault), fault["type"], fault.get("ctx", {})
    if kind == "rule":
        where = ".".join((*(str(key) for key in loc), context["key"]))
        return InputFileError(file, where=where, found=context["found"], wish=context["wish"])
    where = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in loc).lstrip(".")
    if kind == "extra_forbidden":
        return InputFileError(file, where=shorten(where), found="unknown key", wish=_place_for(loc))
    path = tuple(key for key in loc if isinstance(key, str))
    info = _SECTIONS[path[:-1]].model_fields[path[-1]]
    found = _shown(fault["input"])
    want = ""
    if kind == "missing":
        found = "missing"
    elif kind in _BOUND:
        bound, verdict, want = _BOUND[kind]
        found, want = f"{found} is {verdict}", want.format(f"{context[bound]:g}") + ": "
    elif kind != "model_type":
        want = f"{_WANT.get(kind) or context.get('expected', 'another value')}: "
    return InputFileError(file, where=where, found=found, wish=f"want {want}{info.description}")


def _rank(fault: ErrorDetails) -> int:
    return {"extra_forbidden": 0, "missing": 2, "rule": 3}.get(fault["type"], 1)


def _loc(fault: ErrorDetails) -> tuple[int | str, ...]:
    if fault["type"] == "extra_forbidden":  # the writer's own key, whatever it is called
        return fault["loc"]
    return tuple(key for key in fault["loc"] if key not in (_NUMBER, _LIST))


def _position(raw: dict[str, Any], loc: tuple[int | str, ...]) -> tuple[float, ...]:
    """Where the key stands in the file; a missing key comes after what its section holds."""
    position: list[float] = []
    here: Any = raw
    for key in loc:
        if isinstance(key, int):
            position.append(key)
        else:
            known = isinstance(here, dict) and key in here
            position.append(list(here).index(key) if known else math.inf)
            here = here[key] if known else None
    return tuple(position)


def _place_for(loc: tuple[int | str, ...]) -> str:
    """What the writer of an unknown key most likely meant."""
    path, name = tuple(str(key) for key in loc[:-1]), str(loc[-1])
    here = f"in [{'.'.join(path)}]" if path else "at the top of the file"
    # The other gear's sections hold the same keys: look in this gear's, from the outermost in.
    in_gear = path[:1] in (("driving",), ("driven",))
    gear = path[0] if in_gear else "driving"
    mate = {"driving": "driven", "driven": "driving"}[gear]
    others = [other for other in _SECTIONS if other != path and other[:1] != (mate,)]

    def called(other: tuple[str, ...]) -> str:
        if not other:
            return "at the top of the file, before any [section]"
        text = f"in [{'.'.join(other)}]"
        if not in_gear and other[0] == gear:
            text += f" and [{'.'.join((mate, *other[1:]))}]"
        return text

    for other in others:
        if name in _SECTIONS[other].model_fields:
            return f"there is none {here}, it belongs {called(other)}"
    own = _SECTIONS[path].model_fields
    if close := nearest(name, own, cutoff=0.6):  # difflib's own idea of a close match
        return f'the nearest known key {here} is "{close}"'
    for other in others:  # farther away, so it must look closer
        if close := nearest(name, _SECTIONS[other].model_fields, cutoff=0.75):
            return f'none {here} is like it, the nearest known key is "{close}" {called(other)}'
    return f'the nearest known key {here} is "{nearest(name, own)}" (known: {", ".join(own)})'


def _shown(value: object) -> str:
    """A value as the file has it, short."""
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)} values"
    if isinstance(value, str):
        return shorten(json.dumps(value, ensure_ascii=False))
    try:
        return shorten(str(value).lower() if isinstance(value, bool) else str(value))
    except ValueError:  # a hexadecimal integer with more digits than Python prints
        return "a huge integer"
