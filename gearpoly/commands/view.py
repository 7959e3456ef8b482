"""``gearpoly view``: the contact debugger as one page."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gearpoly.arguments import SEED
from gearpoly.options import FlankChoice, MapOption, PairArgument

if TYPE_CHECKING:
    from gearpoly.files.models import PairFile
    from gearpoly.view.scene import ViewScene

ORDER = 40


def view(
    pair: PairArgument,
    html: Annotated[
        Path | None,
        typer.Option(help="The page to write (- for standard output); default: the pair file's name, ending in .html."),
    ] = None,
    at: Annotated[float, typer.Option(help="Driven angle in deg at which the page opens.")] = 0.0,
    recording: Annotated[
        Path | None, typer.Option(help="Show this recording's mismatch beside the geometry, under its condition.")
    ] = None,
    map: MapOption = None,
    flank: Annotated[
        FlankChoice | None, typer.Option(help="Which flank carries; default drive, or the recording's.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="Decides what a grade leaves to chance; default 0.", min=SEED.least)
    ] = None,
) -> None:
    """Write the contact debugger: gears, contacts, gaps and TE in one page that any browser opens from disk."""
    from gearpoly.errors import OutOfRangeError
    from gearpoly.files.output import say_written, write_text
    from gearpoly.files.pairfile import read_pair
    from gearpoly.report.terminal import Terminal
    from gearpoly.view.document import document
    from gearpoly.view.html import check_page, page_text

    if not math.isfinite(at):
        raise OutOfRangeError(f"--at {at}: want a driven angle in deg, such as 12.5")
    if map is not None and recording is None:
        raise OutOfRangeError(f"--map {map}: a map is of a recording; want --recording beside it")
    target = Path(f"{pair.stem}.html") if html is None else html
    check_page(target)
    file = read_pair(pair)
    if recording is not None:
        if flank is not None or seed is not None:
            raise OutOfRangeError(
                "--recording brings its flank, and nothing is drawn by chance beside it; leave out --flank and --seed"
            )
        scene = _beside_recording(file, pair, recording, map=map, at=at)
    else:
        scene = _as_asked(file, pair, at=at, flank=flank, seed=seed or 0)
    text = page_text(document(scene))
    write_text(target, text)
    if str(target) != "-":
        console = Terminal()
        for remark in scene.remarks:
            console.print(f"note: {remark}", style="yellow", highlight=False, soft_wrap=True)
    say_written(target, f"{len(text.encode()) / 1e6:.2f} MB, open it in a browser")


def _beside_recording(file: PairFile, path: Path, recording: Path, *, map: Path | None, at: float) -> ViewScene:
    """The pair of the ``file`` at ``path`` under the condition of a recording, with its mismatch."""
    from gearpoly.diagnose.compare_as_built import compare_as_built
    from gearpoly.recording.map_file import read_map
    from gearpoly.recording.read import read_recording
    from gearpoly.report.progress import steps, watched
    from gearpoly.units import DEG
    from gearpoly.view.scene import positions, scene_beside

    with steps() as step:
        step("reading")
        read = read_recording(recording, worm=file.worm, chart=None if map is None else read_map(map))
        comparison = compare_as_built(file, [read], path=path, step=step)
    with watched(2 * positions(comparison.assembled.pair), "turning the gears") as progress:
        return scene_beside(comparison, path=path, theta_2=at * DEG, progress=progress)


def _as_asked(file: PairFile, path: Path, *, at: float, flank: FlankChoice | None, seed: int) -> ViewScene:
    """The pair of the ``file`` at ``path`` under its own torque, its chance decided by ``seed``."""
    from gearpoly.assemble import assemble
    from gearpoly.mesh.condition import Condition
    from gearpoly.report.progress import watched
    from gearpoly.units import DEG, NM
    from gearpoly.view.scene import positions, scene_of

    assembled = assemble(file, path=path, seed=seed)
    with watched(2 * positions(assembled.pair), "turning the gears") as progress:
        return scene_of(
            assembled,
            name=file.name,
            path=path,
            condition=Condition(flank="coast" if flank == FlankChoice.coast else "drive", torque=file.torque_nm * NM),
            theta_2=at * DEG,
            seed=seed,
            progress=progress,
        )
