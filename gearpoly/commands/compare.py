"""``gearpoly compare``: recordings laid on the simulation of their pair."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gearpoly.options import MapsOption, PairArgument, RecordingsArgument

ORDER = 20


def compare(
    pair: PairArgument,
    recordings: RecordingsArgument,
    map: MapsOption = None,
    json: Annotated[
        Path | None, typer.Option(help="Write alignment, noise and where they differ (JSON; - for standard output).")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw maps by tooth and phase, order and time spectra (png, svg or pdf).")
    ] = None,
) -> None:
    """Lay recordings on the simulation of their pair and say where they differ, against the noise."""
    from gearpoly.diagnose.compare_as_built import compare_as_built as run
    from gearpoly.errors import blamed
    from gearpoly.files.output import check_targets, say_written, write_text
    from gearpoly.files.pairfile import read_pair
    from gearpoly.recording.read import read_set
    from gearpoly.report.compare_report import json_text, print_comparison
    from gearpoly.report.progress import steps
    from gearpoly.report.terminal import Terminal

    check_targets([json, plot], inputs=[pair, *recordings, *(map or [])])
    if plot is not None:
        from gearpoly.report.compare_plots import plot_comparison
        from gearpoly.report.plots import check_format

        check_format(plot)
    file = read_pair(pair)
    with steps() as step, blamed(pair, "driving, driven, pair"):
        step("reading")
        comparison = run(file, read_set(recordings, map, worm=file.worm), path=pair, step=step)
    if json is not None:
        write_text(json, json_text(comparison))
    if plot is not None:
        plot_comparison(comparison, target=plot)
    if str(json) != "-":
        print_comparison(Terminal(), comparison)
    say_written(json, "alignment, noise and where they differ")
    say_written(plot, "maps by tooth and phase, spectra")
