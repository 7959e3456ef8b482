"""``gearpoly simulate``: one pair over its hunting cycle, or at a recording's own samples."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gearpoly.arguments import POINTS_PER_MESH, TURNS_OF_DRIVEN
from gearpoly.options import FlankChoice, MapOption, PairArgument, SeedOption

if TYPE_CHECKING:
    from gearpoly.assemble import Assembled
    from gearpoly.course import Course
    from gearpoly.files.models import PairFile
    from gearpoly.mesh.pair import Flank

ORDER = 10


def simulate(
    pair: PairArgument,
    csv: Annotated[
        Path | None,
        typer.Option(help="Write TE, backlash and pairs over the driven angle (CSV; - for standard output)."),
    ] = None,
    json: Annotated[
        Path | None,
        typer.Option(help="Write everything, contact positions too (JSON; - for standard output)."),
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw TE, backlash and touching pairs (png, svg or pdf).")] = None,
    flank: Annotated[
        FlankChoice | None,
        typer.Option(help="Which flank carries; default drive, or the recording's."),
    ] = None,
    turns: Annotated[
        float | None,
        typer.Option(
            help="Turns of the driven gear, to the end of a mesh; default: a whole hunting cycle.",
            min=TURNS_OF_DRIVEN.least,
        ),
    ] = None,
    points_per_mesh: Annotated[
        int | None, typer.Option(help="Positions per pitch; default 40.", min=POINTS_PER_MESH.least)
    ] = None,
    at: Annotated[Path | None, typer.Option(help="Simulate at the samples and condition of this recording.")] = None,
    map: MapOption = None,
    fast: Annotated[
        bool,
        typer.Option("--fast", help="Compiled search, exact to 1e-12 rad; polygons certify a sample of positions."),
    ] = False,
    seed: SeedOption = 0,
    every_default: Annotated[
        bool, typer.Option("--defaults", help="List every value that the pair file left to its default.")
    ] = False,
) -> None:
    """Predict transmission error, backlash and contacts of a pair over its hunting cycle."""
    from gearpoly.assemble import assemble
    from gearpoly.course import over_turns, remarks_on, simulate_course
    from gearpoly.errors import blamed
    from gearpoly.files.output import say_written, write_text
    from gearpoly.files.pairfile import effective_defaults, read_pair
    from gearpoly.report.progress import watched
    from gearpoly.report.simulation_files import csv_text, json_text
    from gearpoly.report.terminal import Terminal

    outputs = [target for target in (csv, json, plot) if target is not None]
    _check_outputs(outputs, inputs=[one for one in (pair, at, map) if one is not None], plot=plot)
    _refuse_contradictions(at=at, map=map, turns=turns, points_per_mesh=points_per_mesh)
    file = read_pair(pair)
    assembled = assemble(file, path=pair, seed=seed)
    carries: Flank | None = None if flank is None else flank.value
    if at is None:
        course = over_turns(assembled, file, flank=carries, turns=turns, points_per_mesh=points_per_mesh)
    else:
        course = _along(assembled, file, at=at, map=map, flank=carries)
    with watched(course.steps, "turning the gears") as progress, blamed(pair, "driving, driven, pair"):
        simulation = simulate_course(assembled, course, file, seed=seed, fast=fast, progress=progress)
    remarks, defaults = remarks_on(file, course, simulation), effective_defaults(file)
    if csv is not None:
        write_text(csv, csv_text(simulation))
    if json is not None:
        write_text(json, json_text(simulation, name=file.name, defaults=defaults, remarks=remarks))
    if plot is not None:
        from gearpoly.report.plots import plot_run

        plot_run(simulation, name=file.name, target=plot)
    if all(str(target) != "-" for target in outputs):
        from gearpoly.report.summary import print_summary

        print_summary(Terminal(), simulation, name=file.name, defaults=defaults, listed=every_default, remarks=remarks)
    say_written(csv, "TE, backlash and touching pairs over the driven angle")
    say_written(json, "curves, contacts and key figures")
    say_written(plot, "curves of TE, backlash and touching pairs")


def _check_outputs(outputs: list[Path], *, inputs: list[Path], plot: Path | None) -> None:
    """Refuse what cannot be written before anything is computed."""
    from gearpoly.errors import OutOfRangeError
    from gearpoly.files.output import check_targets

    if sum(str(target) == "-" for target in outputs) > 1:
        raise OutOfRangeError("only one of --csv and --json can go to standard output")
    check_targets(outputs, inputs=inputs)
    if plot is not None:
        from gearpoly.report.plots import check_format

        check_format(plot)


def _refuse_contradictions(
    *, at: Path | None, map: Path | None, turns: float | None, points_per_mesh: int | None
) -> None:
    """Raise ``OutOfRangeError`` for options that do not go together."""
    from gearpoly.errors import OutOfRangeError

    if map is not None and at is None:
        raise OutOfRangeError(f"--map {map}: a map is of a recording; want --at beside it")
    if at is not None and (turns is not None or points_per_mesh is not None):
        raise OutOfRangeError("--at brings its own positions; leave out --turns and --points-per-mesh")


def _along(assembled: Assembled, file: PairFile, *, at: Path, map: Path | None, flank: Flank | None) -> Course:
    """The samples of the recording ``at``, read by its ``map``."""
    from gearpoly.course import along
    from gearpoly.recording.map_file import read_map
    from gearpoly.recording.read import read_recording

    chart = None if map is None else read_map(map)
    return along(assembled, file, read_recording(at, worm=file.worm, chart=chart), flank=flank)
