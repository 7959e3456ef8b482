"""``gearpoly simulate``: one pair over its hunting cycle, or at a recording's own samples."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

ORDER = 10


class FlankChoice(StrEnum):
    """Which flank carries."""

    drive = "drive"
    coast = "coast"


def simulate(
    pair: Annotated[Path, typer.Argument(help="Pair file (TOML): what is known of the two gears.")],
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
        typer.Option(help="Turns of the driven gear, to the end of a mesh; default: a whole hunting cycle.", min=0.0),
    ] = None,
    points_per_mesh: Annotated[int | None, typer.Option(help="Positions per pitch; default 40.", min=1)] = None,
    at: Annotated[Path | None, typer.Option(help="Simulate at the samples and condition of this recording.")] = None,
    map: Annotated[Path | None, typer.Option(help="Read the recording by this map (TOML, from gearpoly read).")] = None,
    fast: Annotated[
        bool,
        typer.Option("--fast", help="Compiled search, exact to 1e-12 rad; polygons certify a sample of positions."),
    ] = False,
    seed: Annotated[int, typer.Option(help="Decides what a grade leaves to chance.", min=0)] = 0,
    every_default: Annotated[
        bool, typer.Option("--defaults", help="List every value that the pair file left to its default.")
    ] = False,
) -> None:
    """Predict transmission error, backlash and contacts of a pair over its hunting cycle."""
    import numpy as np

    from gearpoly import positions
    from gearpoly.assemble import assemble, root_remarks
    from gearpoly.errors import OutOfRangeError, blamed
    from gearpoly.files.output import check_targets, say_written, write_text
    from gearpoly.files.pairfile import effective_defaults, read_pair
    from gearpoly.mesh.condition import Condition
    from gearpoly.report.progress import watched
    from gearpoly.report.simulation_files import csv_text, json_text
    from gearpoly.report.terminal import Terminal
    from gearpoly.simulate import simulate as run
    from gearpoly.simulate import strength_remarks
    from gearpoly.units import NM, RPM

    outputs = [target for target in (csv, json, plot) if target is not None]
    if sum(str(target) == "-" for target in outputs) > 1:
        raise OutOfRangeError("only one of --csv and --json can go to standard output")
    check_targets(outputs, inputs=[one for one in (pair, at, map) if one is not None])
    if map is not None and at is None:
        raise OutOfRangeError(f"--map {map}: a map is of a recording; want --at beside it")
    if plot is not None:
        from gearpoly.report.plots import check_format, plot_run

        check_format(plot)
    file = read_pair(pair)
    assembled = assemble(file, path=pair, seed=seed)
    remarks: list[str] = []
    time = off = None
    backward = False
    torque, speed = file.torque_nm, file.pair.speed_rpm
    side = flank.value if flank is not None else "drive"
    if at is not None:
        if turns is not None or points_per_mesh is not None:
            raise OutOfRangeError("--at brings its own positions; leave out --turns and --points-per-mesh")
        from gearpoly.recording.chain import corrected
        from gearpoly.recording.load import relative_load
        from gearpoly.recording.map_file import read_map
        from gearpoly.recording.read import read_recording

        recording = corrected(
            read_recording(at, worm=file.worm, chart=None if map is None else read_map(map)),
            *assembled.encoders,
            ratio=assembled.pair.ratio,
            r_b2=assembled.pair.r_b2,
        )
        there = positions.recording_positions(assembled.pair, recording)
        theta_2, time = there.theta_2, there.time
        remarks = [*there.remarks, *recording.remarks]
        side = recording.flank if flank is None else side
        backward = recording.backward
        torque = positions.recorded_torque(recording, default=torque)
        turned = float(np.ptp(theta_2)) / assembled.pair.driven.gear.tau
        off = relative_load(there.torque, torque, meshes=turned)
        speed = recording.speed_rpm if recording.speed_rpm is not None else speed
    else:
        theta_2 = positions.cycle_positions(
            assembled.pair, turns=turns, points_per_mesh=points_per_mesh or positions.POINTS_PER_MESH
        )
    condition = Condition(
        flank="coast" if side == "coast" else "drive",
        torque=torque * NM,
        speed=None if speed is None else speed * RPM,
        backward=backward,
    )
    to_stdout = any(str(target) == "-" for target in outputs)
    console = Terminal(stderr=to_stdout)
    with watched(2 * theta_2.size, "turning the gears") as progress, blamed(pair, "driving, driven, pair"):
        simulation = run(
            assembled,
            theta_2,
            condition,
            seed=seed,
            evenly=at is None,
            fast=fast,
            time=time,
            off=off,
            progress=progress,
        )
    remarks += root_remarks(file) + strength_remarks(simulation)
    defaults = effective_defaults(file)
    if csv is not None:
        write_text(csv, csv_text(simulation))
    if json is not None:
        write_text(json, json_text(simulation, name=file.name, defaults=defaults, remarks=remarks))
    if plot is not None:
        plot_run(simulation, name=file.name, target=plot)
    if not to_stdout:
        from gearpoly.report.summary import print_summary

        print_summary(console, simulation, name=file.name, defaults=defaults, listed=every_default, remarks=remarks)
    say_written(csv, "TE, backlash and touching pairs over the driven angle")
    say_written(json, "curves, contacts and key figures")
    say_written(plot, "curves of TE, backlash and touching pairs")
