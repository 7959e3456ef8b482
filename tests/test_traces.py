"""Measured traces that an inspection names: sorted, converted, or refused with their line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.files.traces import read_traces
from tests.made_pairfile import write

TRACES = """\
# gear measuring machine, run 12
deviation_um,tooth,roll_length_mm,flank
0.5,3,4.0,coast
1.5,3,3.0,coast
-2.0,3,6.0,drive
0.0,0,3.5,drive
1.0,0,2.5,drive
-1.0,3,5.0,drive
"""


def test_traces_are_sorted_and_converted(tmp_path: Path) -> None:
    traces = read_traces(write(tmp_path, TRACES, "flanks.csv"), 18)
    assert [(t.tooth, t.flank) for t in traces] == [(0, "drive"), (3, "drive"), (3, "coast")]
    assert traces[0].roll_length.tolist() == [2.5, 3.5]
    # One rounding of the product um * 1e-3 mm/um.
    np.testing.assert_allclose(traces[0].deviation, [1e-3, 0.0], rtol=1e-15, atol=0.0)
    assert not traces[0].deviation.flags.writeable
    assert not traces[0].roll_length.flags.writeable


@pytest.mark.parametrize(
    ("before", "after", "where", "found", "wish"),
    [
        ("6.0,drive", "6.0,left", "line 5, column flank", '"left"', "drive or coast"),
        ("-2.0,3", "-2.0,18", "line 5, column tooth", '"18"', "0 to 17"),
        ("-2.0,3", "-2.0,-1", "line 5, column tooth", '"-1"', "0 to 17"),
        ("-2.0,3", "-2.0,3.5", "line 5, column tooth", '"3.5"', "0 to 17"),
        ("-2.0", "nan", "line 5, column deviation_um", '"nan"', "finite number"),
        ("-2.0", "", "line 5, column deviation_um", "an empty cell", "finite number"),
        ("-2.0", "x", "line 5, column deviation_um", '"x"', "finite number"),
        ("-2.0", "-2e9", "line 5, column deviation_um", '"-2e9"', "-10000 to 10000"),
        ("6.0", "-6.0", "line 5, column roll_length_mm", '"-6.0"', "0 or more"),
        ("6.0,drive", "6.0", "line 5", "3 cells", "want 4"),
        ("-1.0,3,5.0", "-1.0,3,6.0", "line 8", "as in line 5", "each roll length once"),
        ("-1.0,3,5.0,drive", "-1.0,4,5.0,drive", "line 5", "one point on tooth 3", "at least 2"),
        (",flank", ",flunk", "line 2", '"flunk"', 'nearest known column is "flank"'),
        (",flank", "", "line 2", 'no column "flank"', "roll_length_mm"),
        (",flank", ",tooth", "line 2", '"tooth" is the name of columns 2 and 4', "want each name once"),
        (TRACES.partition("flank\n")[2], "", "", "no rows", "want rows"),
        (TRACES, "", "", "an empty file", "want rows"),
    ],
)
def test_bad_trace_file(tmp_path: Path, before: str, after: str, where: str, found: str, wish: str) -> None:
    file = write(tmp_path, TRACES.replace(before, after, 1), "flanks.csv")
    with pytest.raises(InputFileError) as caught:
        read_traces(file, 18)
    error = caught.value
    assert (error.file, error.where) == (str(file), where)
    assert found in error.found
    assert wish in error.wish


def test_missing_trace_file(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="no such file"):
        read_traces(tmp_path / "none.csv", 18)
