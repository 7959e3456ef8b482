"""The ends of rows: cells that no name stands above are left out, and those that one stands above stay."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.recording.read import read_recording
from tests.made_texts import table, written


@pytest.mark.parametrize("mark", [";", ",", "\t"])
@pytest.mark.parametrize("more", [2, 3, 7])
@pytest.mark.parametrize("above", ["", "Pruefstand{}Getriebe 7\n\n"])
def test_cells_without_names_at_the_end_of_rows_are_left_out(tmp_path: Path, mark: str, more: int, above: str) -> None:
    """Two or more separators behind each row, and none behind the names: these were not found."""
    time = np.arange(500) / 50.0
    names = ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]")
    columns = (time, np.mod(170.0 * time, 360.0), np.mod(122.4 * time, 360.0))
    text = table(columns, names, separator=mark, decimal="." if mark == "," else ",")
    head, _, rows = text.partition("\n")
    file = written(tmp_path, above.format(mark) + head + "\n" + rows.replace("\n", mark * more + "\n"))
    read = read_recording(file)
    assert read.driven_angle_rad is not None and read.time_s is not None
    np.testing.assert_allclose(np.degrees(read.driven_angle_rad), columns[2], atol=1e-5)
    assert any(f"{more} empty cells without names" in remark for remark in read.remarks)


def test_empty_cells_with_names_stay_columns(tmp_path: Path) -> None:
    time = np.arange(500) / 50.0
    text = table((time, 170.0 * time, 122.4 * time), ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]"))
    head, _, rows = text.partition("\n")
    file = written(tmp_path, head + ";Temperatur [°C];Druck [bar]\n" + rows.replace("\n", ";;\n"))
    read = read_recording(file)
    assert read.driven_angle_rad is not None
    np.testing.assert_allclose(np.degrees(read.driven_angle_rad), 122.4 * time, atol=1e-4)
    assert not any("without names" in remark for remark in read.remarks)


def test_rows_that_begin_with_a_time_stamp_end_so_too(tmp_path: Path) -> None:
    time = np.arange(500) / 50.0
    rows = [f"2026-03-04 10:15:{t:06.3f};{170.0 * t:.5f};{122.4 * t:.5f};;" for t in time]
    names = "Zeitstempel;Winkel Antrieb [°];Winkel Abtrieb [°]"
    read = read_recording(written(tmp_path, "\n".join([names, *rows, ""])))
    assert read.driven_angle_rad is not None and read.time_s is not None
    np.testing.assert_allclose(np.degrees(read.driven_angle_rad), 122.4 * time, atol=1e-4)
    np.testing.assert_allclose(read.time_s, time, atol=1e-6)
