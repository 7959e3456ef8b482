"""Channels under names of the owner's own come whole out of the process that reads them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.recording.apart import read_apart
from tests.made_reader import READER, read_table


@pytest.mark.long
def test_other_channels_come_through_with_units_and_times(tmp_path: Path) -> None:
    file = tmp_path / "a.made"
    file.write_bytes(b"x")
    found, wanted = read_apart(READER, file), read_table(file)
    assert list(found.others) == list(wanted.others)
    assert (found.keys, found.remarks, list(found.columns)) == (wanted.keys, wanted.remarks, list(wanted.columns))
    np.testing.assert_array_equal(found.columns["torque_nm"], wanted.columns["torque_nm"])
    for name, one in wanted.others.items():
        other = found.others[name]
        assert other.unit == one.unit
        np.testing.assert_array_equal(other.values, one.values)
        assert (other.time is None) == (one.time is None)
        if one.time is not None:
            np.testing.assert_array_equal(other.time, one.time)
