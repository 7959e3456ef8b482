"""``gearpoly plan``: which recordings to make, before any is made."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gearpoly.options import PairArgument

ORDER = 35


def plan(
    pair: PairArgument,
    json: Annotated[Path | None, typer.Option(help="Write the plan (JSON; - for standard output).")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw what each recording tells apart (png, svg or pdf).")] = None,
) -> None:
    """Say which recordings would tell the pair's look-alikes apart."""
    from gearpoly.diagnose.plan import plan as run
    from gearpoly.errors import blamed
    from gearpoly.files.output import check_targets, say_written, write_text
    from gearpoly.files.pairfile import read_pair
    from gearpoly.report.plan_report import json_text, print_plan
    from gearpoly.report.progress import steps
    from gearpoly.report.terminal import Terminal

    check_targets([json, plot], inputs=[pair])
    if plot is not None:
        from gearpoly.report.plan_plots import plan_figure
        from gearpoly.report.plots import check_format, save

        check_format(plot)
    file = read_pair(pair)
    with steps() as step, blamed(pair, "driving, driven, pair"):
        made = run(file, path=pair, step=step)
    if json is not None:
        write_text(json, json_text(made))
    if plot is not None:
        save(plan_figure(made), plot)
    if str(json) != "-":
        print_plan(Terminal(), made)
    say_written(json, "the plan")
    say_written(plot, "what each recording tells apart")
