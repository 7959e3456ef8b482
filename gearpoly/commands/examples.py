"""``gearpoly examples``: the sample data, into a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

ORDER = 2


def examples(
    folder: Annotated[Path, typer.Argument(help="New folder to write to.")] = Path("data"),
) -> None:
    """Copy the sample data into a folder: pair files, recordings with their truths, sheets, studies."""
    from gearpoly.files.output import say_written
    from gearpoly.files.samples import copy_samples

    say_written(copy_samples(folder), "pair files, recordings with their truths, sheets and studies")
