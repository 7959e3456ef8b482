"""``gearpoly pair``: a pair file to begin with, empty or from an inspection sheet or a design."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

ORDER = 5


class GearChoice(StrEnum):
    """Which gear of the pair a file is of."""

    driving = "driving"
    driven = "driven"


class SideChoice(StrEnum):
    """A flank, seen on the datum face with the tooth pointing up."""

    left = "left"
    right = "right"


class CountChoice(StrEnum):
    """The direction in which a sheet counts teeth, seen on the datum face."""

    clockwise = "clockwise"
    counterclockwise = "counterclockwise"


def pair(
    target: Annotated[
        Path | None, typer.Argument(metavar="PAIR", help="With --from: the pair file to write, or to complete.")
    ] = None,
    new: Annotated[Path | None, typer.Option(help="Write a commented pair file that runs as it stands (TOML).")] = None,
    sheet: Annotated[
        Path | None, typer.Option(help="With --new: write an empty inspection sheet too (CSV), which the file reads.")
    ] = None,
    source: Annotated[
        Path | None,
        typer.Option(
            "--from", help="Inspection sheet (mka, mew, gde, CSV) or design (rexs, rexsj, rexsz) to write into PAIR."
        ),
    ] = None,
    which: Annotated[
        GearChoice | None, typer.Option("--as", help="Which gear the sheet is of; of a design, what its first gear is.")
    ] = None,
    flank: Annotated[
        SideChoice | None, typer.Option(help="Which flank of the sheet is the drive flank, seen on the datum face.")
    ] = None,
    count: Annotated[
        CountChoice | None,
        typer.Option(help="How the sheet counts teeth, seen on the datum face, where it does not say so itself."),
    ] = None,
    layout: Annotated[
        Path | None, typer.Option("--map", help="What a sheet leaves open: columns, numbers, the gear itself (TOML).")
    ] = None,
    stage: Annotated[int | None, typer.Option(help="Which stage of a design, by its id.")] = None,
) -> None:
    """Write a pair file: one to fill in, or from an inspection sheet or a design."""
    from gearpoly.errors import OutOfRangeError

    given = {"--as": which, "--flank": flank, "--count": count, "--map": layout, "--stage": stage}
    if (new is None) == (source is None):
        raise OutOfRangeError("want one of --new FILE, for a pair file to fill in, and --from FILE PAIR")
    if new is not None:
        for name, value in (("PAIR", target), *given.items()):
            if value is not None:
                raise OutOfRangeError(f"{name} goes with --from FILE; leave it out with --new")
        _new(new, sheet)
        return
    if sheet is not None:
        raise OutOfRangeError("--sheet goes with --new; leave it out with --from")
    if target is None or source is None:
        raise OutOfRangeError("--from FILE wants the pair file to write as well: gearpoly pair --from FILE PAIR")
    _from(source, target, which=which, flank=flank, count=count, layout=layout, stage=stage)


def _new(new: Path, sheet: Path | None) -> None:
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


def _from(
    source: Path,
    target: Path,
    *,
    which: GearChoice | None,
    flank: SideChoice | None,
    count: CountChoice | None,
    layout: Path | None,
    stage: int | None,
) -> None:
    import sys

    from gearpoly.errors import escaped
    from gearpoly.files.output import check_targets, say_written
    from gearpoly.files.pair_from import Choices, pair_from

    check_targets([target], inputs=[source, *([layout] if layout is not None else [])])
    choices = Choices(
        which=None if which is None else which.value,
        drive=None if flank is None else flank.value,
        count=None if count is None else count.value,
        layout=layout,
        stage=stage,
    )
    made = pair_from(source, target, choices)
    for one in made.says:
        print(f"note: {escaped(one)}", file=sys.stderr)
    for file, what in made.files:
        say_written(file, what)
