"""``gearpoly pair``: a pair file to begin with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

ORDER = 5


def pair(
    new: Annotated[Path, typer.Option(help="Write a commented pair file that runs as it stands (TOML).")],
    sheet: Annotated[
        Path | None, typer.Option(help="Write an empty inspection sheet too (CSV), which the pair file reads.")
    ] = None,
) -> None:
    """Write a pair file to begin with, and an inspection sheet to fill in."""
    import os

    from gearpoly.errors import InputFileError
    from gearpoly.files.output import check_targets, say_written, write_text
    from gearpoly.files.paths import look
    from gearpoly.files.sheet_csv import sheet_text
    from gearpoly.files.template import TEETH, pair_template

    check_targets([new, sheet], inputs=[])
    for target in (new, sheet):
        if target is not None and str(target) == "-":
            raise InputFileError(target, found="standard output", wish="want the name of a file")
        if target is not None and look(target) is not None:
            wish = "want a new name, since what was filled in would be lost"
            raise InputFileError(target, found="this file exists", wish=wish)
    beside = None if sheet is None else Path(os.path.relpath(sheet.resolve(), new.resolve().parent)).as_posix()
    if sheet is not None:
        write_text(sheet, sheet_text(TEETH))
    write_text(new, pair_template(sheet=beside))
    say_written(sheet, "an inspection sheet to fill in, one row per tooth")
    say_written(new, "a pair file to fill in; gearpoly simulate reads it as it stands")
