"""The small file that says what a sheet leaves open: columns, decimal mark, direction of counting, the gear itself."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from gearpoly.errors import InputFileError, shown, shown_value
from gearpoly.files.toml import parse
from gearpoly.files.traces import nearest, read_text
from gearpoly.keys.kinds import Length, Section, field
from gearpoly.keys.sizes import with_sizes

Meaning = Literal[
    "tooth",
    "flank",
    "single_pitch",
    "single_pitch_left",
    "single_pitch_right",
    "cumulative_pitch",
    "cumulative_pitch_left",
    "cumulative_pitch_right",
    "profile_slope",
    "profile_slope_left",
    "profile_slope_right",
    "profile_crowning",
    "profile_crowning_left",
    "profile_crowning_right",
    "tooth_thickness",
    "ignored",
]
"""What a column may hold."""


class StatedGear(Section):
    """What is known of the gear beside its sheet."""

    teeth: int | None = field("number of teeth, 5 to 10000", ge=5, le=10_000)
    module_mm: float | None = field("module in mm, 0.05 to 100", ge=0.05, le=100.0)
    diametral_pitch: float | None = field("teeth per inch, instead of module_mm", ge=0.254, le=508.0)
    pressure_angle_deg: float | None = field("pressure angle in deg, 10 to 35", ge=10.0, le=35.0)
    profile_shift: float | None = field("profile shift coefficient, -5 to 5", ge=-5.0, le=5.0)
    face_width_mm: Length | None = field("face width in mm, above 0")
    start_mm: Length | None = field("diameter in mm where measured profiles start, near the root")
    end_mm: Length | None = field("diameter in mm where measured profiles end, near the tip")


class SheetMap(Section):
    """How a sheet is to be read; what is left out is found from the sheet itself."""

    separator: Literal[",", ";", "\t", "|"] | None = field("mark between columns")
    decimal: Literal[".", ","] | None = field("decimal mark of numbers")
    unit: Literal["um", "mm", "nm", "m", "in", "mil"] | None = field("unit of deviations whose heads state none")
    count: Literal["clockwise", "counterclockwise"] | None = field(
        "direction in which teeth are counted, seen on the datum face"
    )
    first_tooth: Literal[0, 1] | None = field("number of the first tooth")
    columns: Annotated[dict[str, Meaning], Field(max_length=500)] = field(
        "column heads and what they hold, a table", {}
    )
    blocks: Annotated[dict[str, Literal["left", "right"]], Field(max_length=500)] = field(
        "lines or titles of blocks, and the flank of each, a table", {}
    )
    gear: StatedGear = field("what is known of the gear beside its sheet, a table", StatedGear())

    @property
    def known(self) -> dict[str, float]:
        """Keys of a pair file that the map states."""
        return with_sizes({key: value for key, value in self.gear if value is not None})


def read_map(path: Path | None) -> SheetMap:
    """The map in a TOML file, or an empty one. Raises ``InputFileError`` with the key, its value and what would do."""
    if path is None:
        return SheetMap()
    raw = parse(path, read_text(path))
    try:
        found = SheetMap.model_validate(raw)
    except ValidationError as error:
        raise _explained(path, error) from None
    if found.gear.module_mm is not None and found.gear.diametral_pitch is not None:
        wish = "want one of the two, since module_mm = 25.4 / diametral_pitch"
        raise InputFileError(path, where="gear.diametral_pitch", found="stated, and module_mm too", wish=wish)
    return found


def _explained(path: Path, error: ValidationError) -> InputFileError:
    fault: Any = error.errors(include_url=False)[0]
    loc = [str(part) for part in fault["loc"]]
    model: type[Section] = StatedGear if loc[:1] == ["gear"] and len(loc) > 1 else SheetMap
    where = ".".join(loc)
    if fault["type"] == "extra_forbidden":
        close = nearest(loc[-1], model.model_fields)
        return InputFileError(path, where=shown(where), found="unknown key", wish=f'the nearest known key is "{close}"')
    found = shown_value(fault["input"]) if not isinstance(fault["input"], dict | list) else "a table or list"
    expected = fault.get("ctx", {}).get("expected")
    info = model.model_fields.get(loc[-1])
    wish = f"want {expected}" if expected else f"want {info.description}" if info is not None else fault["msg"]
    return InputFileError(path, where=shown(where), found=found, wish=wish)
