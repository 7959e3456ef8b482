"""Arguments and options that several commands share: one name, one meaning, one text in the help."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from gearpoly.arguments import SEED


class FlankChoice(StrEnum):
    """Which flank carries, or touches."""

    drive = "drive"
    coast = "coast"


PairArgument = Annotated[Path, typer.Argument(help="Pair file (TOML): what is known of the two gears.")]

RecordingsArgument = Annotated[
    list[Path], typer.Argument(help="Recordings of one set-up (CSV, Parquet, HDF5, MAT, TDMS, UFF58).")
]

MapsOption = Annotated[
    list[Path] | None,
    typer.Option("--map", help="Read recordings by this map (TOML, from gearpoly read): one for all, or one for each."),
]

MapOption = Annotated[
    Path | None, typer.Option("--map", help="Read the recording by this map (TOML, from gearpoly read).")
]

SeedOption = Annotated[int, typer.Option(help="Decides what a grade leaves to chance.", min=SEED.least)]
