"""Every key of a pair file as a page, written from the models that read it: ``python -m gearpoly.files.reference``."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

from pydantic.fields import FieldInfo

from gearpoly.files.models import PairFile, Section
from gearpoly.files.output import write_text
from gearpoly.files.sheet_csv import SIDES_HELP

PAIR_FILE_PAGE_HEAD = """# The pair file

From the models that read it (`python -m gearpoly.files.reference docs/reference/pair_file.md`; a test compares).
TOML; a file needs no more than

```toml
[driving]
teeth = 18
module_mm = 2

[driven]
teeth = 25
module_mm = 2
```

Unknown keys are refused. What `[driving]` says of its gear `[driven]` says of the other. Angles and signs:
[nomenclature](nomenclature.md); what a diagnosis writes into which key:
[the catalogue](catalogue.md).

`gearpoly pair --new pair.toml --sheet sheet.csv` writes a commented pair file, and an inspection sheet that it reads
with `sheet_csv`. The sheet has a row per tooth, columns `gear`, `tooth` and keys of the inspection. Empty columns were
not measured, and a gear without any value counts as not inspected.

`gearpoly pair --from FILE PAIR` writes one from an inspection sheet or a design: [sheets](sheets.md).

`gearpoly pair --mount EQ6 pair.toml` writes the gears and the worm of a known telescope mount, with the source of every
number; `--mount` without a name lists the names.

{flanks}

`single_pitch_um` is f_p. The index deviations of the drive flank are its running sum times cos(alpha), mean removed,
minus for the driving gear and plus for the driven one. On the coast flank the signs are reversed. Its values add up
to 0 but for rounding, or are refused. `span_mm` and `over_pins_mm` give E_s, the same for all teeth, by ISO 21771
(external spur gears, odd and even numbers of teeth). Single pitches of the coast flank have no level of their own: they
stand where the mean thickness has them. `pitch_coast_um` has one: it says outright where the coast flanks stand, and a
thickness beside it counts for nothing. Where the two disagree, a remark says by how much.

Sizes are turned into the keys that describe the gear: module_mm = 25.4 / diametral_pitch, tip_diameter_mm =
module_mm (teeth + 2 profile_shift + 2 addendum), root_diameter_mm = module_mm (teeth + 2 profile_shift - 2 dedendum).
A fitted file has these keys in their place.
""".replace("{flanks}", SIDES_HELP.replace("\n# ", "\n").removeprefix("# "))

KEY_TABLE_COLUMNS = ("| key | meaning | default |", "| --- | --- | --- |")


def pair_file_reference(file: type[Section] = PairFile) -> str:
    """The page: a table of keys, their meaning with unit and bounds, and their default, for every table of the file."""
    parts = [PAIR_FILE_PAGE_HEAD]
    for path, many, model in _tables(file, ""):
        title = f"`[[{path}]]`, any number of them" if many else f"`[{path}]`" if path else "Top of the file"
        rows = [_row(name, field) for name, field in model.model_fields.items() if _nested(field) is None]
        about = (model.__doc__ or "").partition("; made by")[0].rstrip(".")
        if rows:
            parts.append("\n".join((f"## {title}", "", f"{about}.", "", *KEY_TABLE_COLUMNS, *rows)))
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _tables(model: type[Section], path: str, *, many: bool = False) -> Iterator[tuple[str, bool, type[Section]]]:
    """Every table below ``model``, the driven gear's left out: path, whether there may be many, and its model."""
    yield path, many, model
    for name, field in model.model_fields.items():
        nested = _nested(field)
        if nested is not None and name != "driven":
            below = f"{path}.{name}" if path else name
            yield from _tables(nested, below, many="tuple" in str(field.annotation))


def _nested(field: FieldInfo) -> type[Section] | None:
    """The table that a field holds, if it is one."""
    waiting = [field.annotation]
    while waiting:
        kind = waiting.pop()
        if isinstance(kind, type) and issubclass(kind, Section):
            return kind
        waiting += get_args(kind)
    return None


def _row(name: str, field: FieldInfo) -> str:
    """One key's line of its table."""
    meaning, _, default = (field.description or "").partition("; default: ")
    named = [choice for choice in get_args(field.annotation) if isinstance(choice, str)]
    if named:
        meaning += ": " + ", ".join(f'`"{choice}"`' for choice in named)
    return f"| `{name}` | {meaning} | {default or _default(field)} |"


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "must be stated"
    if field.default is None or field.default == ():
        return "none"
    if isinstance(field.default, bool):
        return f"`{str(field.default).lower()}`"
    return f'`"{field.default}"`' if isinstance(field.default, str) else f"`{field.default}`"


if __name__ == "__main__":
    write_text(Path(sys.argv[1]), pair_file_reference())
