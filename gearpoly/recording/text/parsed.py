"""Plain rows of numbers by the quickest parser that is installed.

pyarrow reads them five times faster than numpy. It is 170 MB large, hence an extra; where it is missing numpy reads the
same numbers, bit by bit.
"""

from __future__ import annotations

import importlib
from collections.abc import Collection
from pathlib import Path
from typing import Any, BinaryIO

import numpy.typing as npt

from gearpoly.recording.arrow import codes_of, doubles
from gearpoly.recording.finite import has_infinite

LARGE_BYTES = 2**22
"""Size of a text from which pyarrow is imported: that takes 30 ms, as long as numpy takes for 3 MB."""


def parsed(
    stream: Path | BinaryIO | bytes,
    *,
    columns: int,
    size: int,
    lines_above: int = 0,
    separator: str = ",",
    decimal: str = ".",
    texts: Collection[int] = (),
) -> list[npt.NDArray[Any]] | None:
    """The columns (n,) of a text in UTF-8, a file or a stream of about ``size`` bytes or a piece of so large a one,
    below so many ``lines_above``, with ``nan`` where a cell is empty; of the columns of these numbers that are
    ``texts`` the characters (n, length), short ones filled up with zeros.

    ``None`` where it is small, pyarrow is missing, or any row is not one of ``columns`` finite numbers: whoever reads
    it line by line says which.
    """
    if size < LARGE_BYTES:
        return None
    try:
        arrow, csv = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.csv")
    except ImportError:
        return None
    names = [str(k) for k in range(columns)]
    types = {name: arrow.binary() if k in texts else arrow.float64() for k, name in enumerate(names)}
    piece = isinstance(stream, bytes)
    # Threads and a pool of memory gain nothing on a few MB, and keep as much as the numbers take.
    pool = arrow.system_memory_pool() if piece else arrow.default_memory_pool()
    try:
        table = csv.read_csv(
            arrow.BufferReader(stream) if piece else arrow.OSFile(str(stream)) if isinstance(stream, Path) else stream,
            memory_pool=pool,
            read_options=csv.ReadOptions(skip_rows=lines_above, column_names=names, use_threads=not piece),
            parse_options=csv.ParseOptions(delimiter=separator),
            convert_options=csv.ConvertOptions(null_values=[""], decimal_point=decimal, column_types=types),
        )
    except arrow.ArrowException:
        return None
    out = []
    for k, name in enumerate(names):
        values: npt.NDArray[Any] | None = (codes_of if k in texts else doubles)(table.column(name))
        table = table.drop_columns([name])  # so that only one column is held twice
        if values is None or not values.size or (k not in texts and has_infinite(values)):
            return None
        out.append(values)
    return out
