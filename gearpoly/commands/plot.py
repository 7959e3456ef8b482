"""``gearpoly plot``: still pictures of a pair."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from gearpoly.options import FlankChoice, PairArgument, SeedOption

ORDER = 45


class What(StrEnum):
    """What to draw."""

    mesh = "mesh"
    deviations = "deviations"
    gaps = "gaps"


def plot(
    pair: PairArgument,
    to: Annotated[Path, typer.Option(help="Picture to write: png, svg or pdf.")],
    what: Annotated[
        What, typer.Option(help="mesh: close-up at a contact; deviations: maps of all teeth; gaps: of near pairs.")
    ] = What.mesh,
    at: Annotated[float, typer.Option(help="Driven angle in deg.")] = 0.0,
    flank: Annotated[FlankChoice, typer.Option(help="Which flanks touch.")] = FlankChoice.drive,
    seed: SeedOption = 0,
) -> None:
    """Draw still pictures of a pair: the mesh at a contact, tooth deviations, gaps of near pairs."""
    import math

    from gearpoly.assemble import assemble
    from gearpoly.errors import OutOfRangeError, blamed
    from gearpoly.files.output import check_targets, say_written
    from gearpoly.files.pairfile import read_pair
    from gearpoly.report.gear_plots import pair_figure
    from gearpoly.report.plots import check_format, save
    from gearpoly.units import DEG

    check_format(to)
    check_targets([to], inputs=[pair])
    if not math.isfinite(at):
        raise OutOfRangeError(f"--at {at:g}: want an angle in deg")
    file = read_pair(pair)
    assembled = assemble(file, path=pair, seed=seed)
    with blamed(pair, "driving, driven, pair"):
        figure = pair_figure(assembled, what.value, at * DEG, flank=flank.value, name=file.name)
    save(figure, to)
    say_written(to, what.value)
