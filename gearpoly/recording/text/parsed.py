"""Plain rows of numbers by the quickest parser that is installed.

pyarrow reads them five times faster than numpy. It is 170 MB large, hence an extra; where it is missing numpy reads the
same numbers, bit by bit.
"""

from __future__ import annotations

import importlib
from typing import BinaryIO

from gearpoly.recording.arrow import doubles
from gearpoly.recording.finite import has_infinite
from gearpoly.units import FloatArray

LARGE_BYTES = 2**22
"""Size of a text from which pyarrow is imported: that takes 30 ms, as long as numpy takes for 3 MB."""


def parsed(
    stream: BinaryIO | bytes, *, columns: int, size: int, lines_above: int = 0, separator: str = ",", decimal: str = "."
) -> list[FloatArray] | None:
    """The columns (n,) of a text in UTF-8, a stream of about ``size`` bytes or a piece of so large a one, below so many
    ``lines_above``, with ``nan`` where a cell is empty.

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
    piece = isinstance(stream, bytes)
    # Threads and a pool of memory gain nothing on a few MB, and keep as much as the numbers take.
    pool = arrow.system_memory_pool() if piece else arrow.default_memory_pool()
    try:
        table = csv.read_csv(
            arrow.BufferReader(stream) if piece else stream,
            memory_pool=pool,
            read_options=csv.ReadOptions(skip_rows=lines_above, column_names=names, use_threads=not piece),
            parse_options=csv.ParseOptions(delimiter=separator),
            convert_options=csv.ConvertOptions(
                null_values=[""], decimal_point=decimal, column_types=dict.fromkeys(names, arrow.float64())
            ),
        )
    except arrow.ArrowException:
        return None
    out = []
    for name in names:
        values = doubles(table.column(name))
        table = table.drop_columns([name])  # so that only one column is held twice
        if values is None or not values.size or has_infinite(values):
            return None
        out.append(values)
    return out
