"""``gearpoly export``: error gears as drawings, solids, points and inspection files."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from gearpoly.options import FlankChoice, PairArgument, SeedOption

ORDER = 50


class GearChoice(StrEnum):
    """Which gears to write."""

    both = "both"
    driving = "driving"
    driven = "driven"


class CurveChoice(StrEnum):
    """How curves are written."""

    lines = "lines"
    arcs = "arcs"
    splines = "splines"


def export(
    pair: PairArgument,
    to: Annotated[
        Path,
        typer.Option(
            help="File to write; its ending says what: svg, dxf, stl, 3mf, step, csv, geojson, wkb, gde, rexs, or one "
            "that an installed package brings."
        ),
    ],
    gear: Annotated[GearChoice, typer.Option(help="Which gears.")] = GearChoice.both,
    at: Annotated[float, typer.Option(help="Driven angle in deg at which the gears stand in mesh.")] = 0.0,
    flank: Annotated[FlankChoice, typer.Option(help="Which flanks touch in mesh.")] = FlankChoice.drive,
    apart: Annotated[bool, typer.Option("--apart", help="Gears side by side, clear of each other.")] = False,
    magnify: Annotated[
        float, typer.Option(help="Exaggerate deviations from the ideal gear K times along the normal.", metavar="K")
    ] = 1.0,
    points: Annotated[int | None, typer.Option(help="Points per involute flank, 8 to 20000.")] = None,
    chord_um: Annotated[
        float | None,
        typer.Option(help="Most that a chord stands off its flank, um; default 0.05 per mm of module."),
    ] = None,
    curves: Annotated[
        CurveChoice | None, typer.Option(help="dxf: lines, arcs or splines; step: splines or lines; else lines.")
    ] = None,
    seed: SeedOption = 0,
) -> None:
    """Write error gears in the format of the file's ending: drawings, solids, points, inspection files, designs."""
    import sys

    from gearpoly.assemble import assemble
    from gearpoly.export.drawing import Request
    from gearpoly.export.outline import Detail
    from gearpoly.export.write import check_any, export_any
    from gearpoly.files.output import say_written
    from gearpoly.files.pairfile import read_pair
    from gearpoly.units import DEG, UM

    chosen = None if curves is None else curves.value
    check_any(to, chosen)
    request = Request(
        which=gear.value,
        at=at * DEG,
        flank=flank.value,
        apart=apart,
        magnify=magnify,
        detail=Detail(points=points, chord=None if chord_um is None else chord_um * UM),
    )
    file = read_pair(pair)
    assembled = assemble(file, path=pair, seed=seed)
    written = export_any(file, assembled, to, request, source=str(pair), seed=seed, curves=chosen)
    for remark in written.remarks:
        print(f"note: {remark}", file=sys.stderr)
    say_written(to, written.says)
