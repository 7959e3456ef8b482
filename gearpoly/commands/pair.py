"""``gearpoly pair``: a pair file to begin with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

ORDER = 5


class NamesNothing(TyperCommand):
    """A command whose ``--mount`` may stand without a name, which then lists the names."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """The arguments, with an empty name where there is none."""
        for k in range(len(args), 0, -1):
            if args[k - 1] == "--mount" and (k == len(args) or args[k].startswith("--")):
                args = [*args[:k], "", *args[k:]]
        return super().parse_args(ctx, args)


COMMAND = NamesNothing


def pair(
    target: Annotated[
        Path | None, typer.Argument(metavar="[PAIR]", help="With --mount: the pair file to write (TOML).")
    ] = None,
    new: Annotated[Path | None, typer.Option(help="Write a commented pair file that runs as it stands (TOML).")] = None,
    sheet: Annotated[
        Path | None, typer.Option(help="With --new: write an empty inspection sheet too (CSV), which the file reads.")
    ] = None,
    mount: Annotated[
        str | None,
        typer.Option(help="Write gears and worm of a telescope mount into PAIR; without a name: tell which are known."),
    ] = None,
) -> None:
    """Write a pair file to begin with: empty, with an inspection sheet to fill in, or a known telescope mount's."""
    from gearpoly.errors import InputFileError

    if mount is not None:
        if new is not None or sheet is not None:
            wish = "want --mount NAME PAIR, or --new PAIR [--sheet SHEET]"
            raise InputFileError("--mount", found="--new or --sheet beside it", wish=wish)
        _write_mount(mount, target)
        return
    if new is None:
        found = "neither --new nor --mount" if target is None else f"{target} without --new or --mount"
        raise InputFileError("pair", found=found, wish="want --new PAIR, or --mount NAME PAIR")
    _write_new(new, sheet)


def _write_mount(name: str, target: Path | None) -> None:
    from gearpoly.errors import InputFileError
    from gearpoly.files.mounts import find_mount, mount_text
    from gearpoly.files.output import say_written, write_text

    mount = find_mount(name)
    if target is None:
        raise InputFileError("--mount", found=f"{name} without a file", wish=f"want --mount {name} PAIR.toml")
    _check_new(target)
    write_text(target, mount_text(mount))
    ready = "gearpoly compare reads it as it stands" if mount.driving else "state the teeth of its transfer gears"
    say_written(target, f"{mount.maker} {mount.names[0]}; {ready}")


def _write_new(new: Path, sheet: Path | None) -> None:
    import os

    from gearpoly.files.output import say_written, write_text
    from gearpoly.files.sheet_csv import sheet_text
    from gearpoly.files.template import TEETH, pair_template

    _check_new(new, sheet)
    beside = None if sheet is None else Path(os.path.relpath(sheet.resolve(), new.resolve().parent)).as_posix()
    if sheet is not None:
        write_text(sheet, sheet_text(TEETH))
    write_text(new, pair_template(sheet=beside))
    say_written(sheet, "an inspection sheet to fill in, one row per tooth")
    say_written(new, "a pair file to fill in; gearpoly simulate reads it as it stands")


def _check_new(*targets: Path | None) -> None:
    """Refuse what exists, and standard output: what is written is there to be filled in."""
    from gearpoly.errors import InputFileError
    from gearpoly.files.output import check_targets
    from gearpoly.files.paths import look

    check_targets(targets, inputs=[])
    for target in targets:
        if target is not None and str(target) == "-":
            raise InputFileError(target, found="standard output", wish="want the name of a file")
        if target is not None and look(target) is not None:
            wish = "want a new name, since what was filled in would be lost"
            raise InputFileError(target, found="this file exists", wish=wish)
