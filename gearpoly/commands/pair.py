"""``gearpoly pair``: a pair file to begin with, empty or from an inspection sheet or a design."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand

if TYPE_CHECKING:
    from gearpoly.files.pair_from import MadeFiles

ORDER = 5


class OneGear(StrEnum):
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
        Path | None,
        typer.Argument(metavar="PAIR", help="With --from or --mount: the pair file to write or to complete."),
    ] = None,
    new: Annotated[Path | None, typer.Option(help="Write a commented pair file that runs as it stands (TOML).")] = None,
    sheet: Annotated[
        Path | None, typer.Option(help="With --new: write an empty inspection sheet too (CSV), which the file reads.")
    ] = None,
    mount: Annotated[
        str | None,
        typer.Option(help="Write gears and worm of a telescope mount into PAIR; without a name: tell which are known."),
    ] = None,
    source: Annotated[
        Path | None,
        typer.Option(
            "--from", help="Inspection sheet (mka, mew, gde, CSV) or design (rexs, rexsj, rexsz) to write into PAIR."
        ),
    ] = None,
    which: Annotated[
        OneGear | None, typer.Option("--as", help="Which gear the sheet is of; of a design, what its first gear is.")
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
    """Write a pair file: one to fill in, a known telescope mount's, or from an inspection sheet or a design."""
    from gearpoly.errors import OutOfRangeError
    from gearpoly.files.new_pair import write_mount, write_new
    from gearpoly.files.pair_from import Choices, pair_from

    given = {"--as": which, "--flank": flank, "--count": count, "--map": layout, "--stage": stage}
    if sum(one is not None for one in (new, source, mount)) != 1:
        wish = "--new FILE, for a pair file to fill in, --mount NAME PAIR, for a telescope's, and --from FILE PAIR"
        raise OutOfRangeError(f"want one of {wish}")
    if source is None:
        way = "--new" if mount is None else "--mount"
        for name, value in given.items():
            if value is not None:
                raise OutOfRangeError(f"{name} goes with --from FILE; leave it out with {way}")
    if new is None and sheet is not None:
        raise OutOfRangeError(f"--sheet goes with --new; leave it out with {'--from' if mount is None else '--mount'}")
    if new is not None:
        if target is not None:
            raise OutOfRangeError("PAIR goes with --from FILE and --mount NAME; leave it out with --new")
        _told(write_new(new, sheet))
    elif mount is not None:
        _told(write_mount(mount, target))
    elif target is None or source is None:
        raise OutOfRangeError("--from FILE wants the pair file to write as well: gearpoly pair --from FILE PAIR")
    else:
        choices = Choices(
            which=None if which is None else which.value,
            drive=None if flank is None else flank.value,
            count=None if count is None else count.value,
            layout=layout,
            stage=stage,
        )
        _told(pair_from(source, target, choices))


def _told(made: MadeFiles) -> None:
    """Say what was written, and what is open."""
    import sys

    from gearpoly.errors import escaped
    from gearpoly.files.output import say_written

    for one in made.says:
        print(f"note: {escaped(one)}", file=sys.stderr)
    for file, what in made.files:
        say_written(file, what)
