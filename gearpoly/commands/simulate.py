"""``gearpoly simulate``: one pair over its hunting cycle, or at a recording's own samples."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gearpoly.arguments import POINTS_PER_MESH, SEED, TURNS

if TYPE_CHECKING:
    from gearpoly.assemble import Assembled
    from gearpoly.files.models import PairFile
    from gearpoly.mesh.condition import Condition
    from gearpoly.units import FloatArray

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
        typer.Option(
            help="Turns of the driven gear, to the end of a mesh; default: a whole hunting cycle.", min=TURNS.least
        ),
    ] = None,
    points_per_mesh: Annotated[
        int | None, typer.Option(help="Positions per pitch; default 40.", min=POINTS_PER_MESH.least)
    ] = None,
    at: Annotated[Path | None, typer.Option(help="Simulate at the samples and condition of this recording.")] = None,
    map: Annotated[Path | None, typer.Option(help="Read the recording by this map (TOML, from gearpoly read).")] = None,
    fast: Annotated[
        bool,
        typer.Option("--fast", help="Compiled search, exact to 1e-12 rad; polygons certify a sample of positions."),
    ] = False,
    seed: Annotated[int, typer.Option(help="Decides what a grade leaves to chance.", min=SEED.least)] = 0,
    every_default: Annotated[
        bool, typer.Option("--defaults", help="List every value that the pair file left to its default.")
    ] = False,
) -> None:
    """Predict transmission error, backlash and contacts of a pair over its hunting cycle."""
    from gearpoly.assemble import assemble, root_remarks
    from gearpoly.errors import OutOfRangeError, blamed
    from gearpoly.files.output import check_targets, say_written, write_text
    from gearpoly.files.pairfile import effective_defaults, read_pair
    from gearpoly.report.progress import watched
    from gearpoly.report.simulation_files import csv_text, json_text
    from gearpoly.report.terminal import Terminal
    from gearpoly.simulate import simulate as run
    from gearpoly.simulate import strength_remarks

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
    if at is None:
        asked = _over_turns(assembled, file, flank=flank, turns=turns, points_per_mesh=points_per_mesh)
    elif turns is not None or points_per_mesh is not None:
        raise OutOfRangeError("--at brings its own positions; leave out --turns and --points-per-mesh")
    else:
        asked = _at_recording(assembled, file, at=at, map=map, flank=flank)
    to_stdout = any(str(target) == "-" for target in outputs)
    console = Terminal(stderr=to_stdout)
    with watched(2 * asked.theta_2.size, "turning the gears") as progress, blamed(pair, "driving, driven, pair"):
        simulation = run(
            assembled,
            asked.theta_2,
            asked.condition,
            seed=seed,
            evenly=at is None,
            fast=fast,
            time=asked.time,
            off=asked.off,
            progress=progress,
        )
    remarks = [*asked.remarks, *root_remarks(file), *strength_remarks(simulation)]
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


@dataclass(frozen=True, kw_only=True, eq=False)
class _Asked:
    """Where and under what the pair is simulated: driven angles (n,) in rad, times (n,) in s and relative deviations of
    the torque (n,) where a recording has them, and what had to be assumed."""

    theta_2: FloatArray
    condition: Condition
    time: FloatArray | None = None
    off: FloatArray | None = None
    remarks: tuple[str, ...] = ()


def _over_turns(
    assembled: Assembled, file: PairFile, *, flank: FlankChoice | None, turns: float | None, points_per_mesh: int | None
) -> _Asked:
    """Even places of whole meshes, under what the pair file states."""
    from gearpoly import positions
    from gearpoly.mesh.condition import Condition
    from gearpoly.units import NM, RPM

    speed = file.pair.speed_rpm
    return _Asked(
        theta_2=positions.cycle_positions(
            assembled.pair, turns=turns, points_per_mesh=points_per_mesh or positions.POINTS_PER_MESH
        ),
        condition=Condition(
            flank="coast" if flank is FlankChoice.coast else "drive",
            torque=file.torque_nm * NM,
            speed=None if speed is None else speed * RPM,
        ),
    )


def _at_recording(
    assembled: Assembled, file: PairFile, *, at: Path, map: Path | None, flank: FlankChoice | None
) -> _Asked:
    """The samples of a recording, under its condition; what it does not state is the pair file's."""
    import numpy as np

    from gearpoly import positions
    from gearpoly.mesh.condition import Condition
    from gearpoly.recording.chain import corrected
    from gearpoly.recording.load import relative_load
    from gearpoly.recording.map_file import read_map
    from gearpoly.recording.read import read_recording
    from gearpoly.units import NM, RPM

    pair = assembled.pair
    read = read_recording(at, worm=file.worm, chart=None if map is None else read_map(map))
    recording = corrected(read, *assembled.encoders, ratio=pair.ratio, r_b2=pair.r_b2)
    there = positions.recording_positions(pair, recording)
    torque = positions.recorded_torque(recording, default=file.torque_nm)
    turned = float(np.ptp(there.theta_2)) / pair.driven.gear.tau
    speed = recording.speed_rpm if recording.speed_rpm is not None else file.pair.speed_rpm
    coast = (recording.flank if flank is None else flank.value) == "coast"
    return _Asked(
        theta_2=there.theta_2,
        condition=Condition(
            flank="coast" if coast else "drive",
            torque=torque * NM,
            speed=None if speed is None else speed * RPM,
            backward=recording.backward,
        ),
        time=there.time,
        off=relative_load(there.torque, torque, meshes=turned),
        remarks=(*there.remarks, *recording.remarks),
    )
