"""``gearpoly study``: many pairs, drawn and swept, resumable, on this machine or a cluster."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gearpoly.arguments import WORKERS

ORDER = 60


def study(
    study: Annotated[Path, typer.Argument(help="Study file (TOML): pair, sweeps, number of pairs, outputs.")],
    out: Annotated[Path, typer.Option(help="Folder of the table; a half-finished one is gone on with.")],
    workers: Annotated[int | None, typer.Option(help="Processes; default: one per core.", min=WORKERS.least)] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler (tcp://host:8786) to run on instead.")
    ] = None,
    csv: Annotated[Path | None, typer.Option(help="Write the whole table as CSV, too.")] = None,
) -> None:
    """Draw and sweep thousands of pairs; gearpoly study-report reads the answers off them."""
    import os

    from gearpoly.errors import OutOfRangeError
    from gearpoly.files.output import check_target, say_written
    from gearpoly.report.terminal import Terminal
    from gearpoly.study.read import read_study
    from gearpoly.study.run import run_study
    from gearpoly.study.summary import print_outcome

    if csv is not None:
        check_target(csv)
    if scheduler is not None and workers is not None:
        raise OutOfRangeError("--scheduler brings its own workers; leave out --workers")
    outcome = run_study(read_study(study), out=out, workers=workers or os.cpu_count() or 1, scheduler=scheduler)
    if csv is not None:
        outcome.store.to_csv(csv)
    print_outcome(Terminal(), outcome)
    say_written(outcome.store.folder, "the table, in rows/")
    say_written(csv, "the table as CSV")
