"""MAT 5 is walked by this package: the walk meets what SciPy, which wrote the common files, never writes."""

from __future__ import annotations

import importlib
import importlib.util
import math
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from gearpoly.recording.read import read_recording
from tests.made_readings import refusal


def mat5(*elements: bytes, order: str = "<") -> bytes:
    mark = b"\x00\x01IM" if order == "<" else b"\x01\x00MI"
    return b"MATLAB 5.0 MAT-file".ljust(124) + mark + b"".join(elements)


def element(kind: int, data: bytes, *, order: str = "<", size: int | None = None) -> bytes:
    return struct.pack(order + "II", kind, len(data) if size is None else size) + data + b"\0" * (-len(data) % 8)


def packed(data: bytes) -> bytes:
    squeezed = zlib.compress(data)
    return struct.pack("<II", 15, len(squeezed)) + squeezed  # the only element that is not filled up


def matrix(
    name: str, values: npt.NDArray[Any], *, order: str = "<", kind: int = 6, stored: int = 9, count: int | None = None
) -> bytes:
    shape = struct.pack(order + "ii", values.size if count is None else count, 1)
    body = element(6, struct.pack(order + "II", kind, 0), order=order) + element(5, shape, order=order)
    body += element(1, name.encode(), order=order) + element(stored, values.tobytes(), order=order)
    return element(14, body, order=order)


ANGLE = np.arange(10.0)


def test_mat5_of_the_other_byte_order_and_short_storage(tmp_path: Path) -> None:
    file = tmp_path / "rec.mat"
    big = matrix("driving_angle_deg", ANGLE.astype(">f8"), order=">")
    small = matrix("driven_angle_deg", ANGLE.astype("u1"), order=">", stored=2)  # as MATLAB stores whole doubles
    file.write_bytes(mat5(big, small, order=">"))
    recording = read_recording(file)
    assert recording.driven_angle_rad is not None
    np.testing.assert_array_equal(recording.driven_angle_rad, ANGLE * (math.pi / 180.0))
    np.testing.assert_array_equal(recording.driving_angle_rad, recording.driven_angle_rad)


def test_mat5_sizes_that_lie(tmp_path: Path) -> None:
    file = tmp_path / "rec.mat"
    good = matrix("driving_angle_deg", ANGLE)
    for planted, found in [
        (matrix("driven_angle_deg", ANGLE, count=11), "80 bytes for 11 numbers"),
        (matrix("driven_angle_deg", ANGLE, count=2**31 - 1), "65536 MB to read"),
        (matrix("driven_angle_deg", ANGLE, count=-1), "the shape"),
        (matrix("driven_angle_deg", ANGLE)[:-8], "it ends at byte"),
        (element(14, b""), "no column driven_angle_deg"),
        (packed(struct.pack("<II", 14, 2**32 - 1)), "of 0 bytes instead of 4294967295"),
        (packed(struct.pack("<II", 14, 1000) + b"\0" * 8), "of 8 bytes instead of 1000"),
        (packed(struct.pack("<II", 14, 1000) + b"\0" * 8)[:-2], "it ends at byte"),
        (element(99, b"12345678"), "type 99"),
        (matrix("driven_angle_deg", ANGLE, kind=1), "a cell"),
        (matrix("driven_angle_deg", ANGLE, kind=3), "a object"),
        (matrix("driven_angle_deg", ANGLE, kind=16), "a function"),
        (matrix("driven_angle_deg", ANGLE, kind=17), "no column driven_angle_deg"),
    ]:
        file.write_bytes(mat5(good, planted))
        assert found in refusal(file).found


@pytest.mark.long
def test_mat5_bomb_is_not_unpacked(tmp_path: Path) -> None:
    # 80 MB of zeros behind a tag that states 200 bytes: no more than the stated bytes may be unpacked.
    tracemalloc = importlib.import_module("tracemalloc")
    file = tmp_path / "rec.mat"
    inner = matrix("driven_angle_deg", ANGLE)[8:]
    bomb = zlib.compress(struct.pack("<II", 14, len(inner)) + inner + b"\0" * 80_000_000, 1)
    packed = struct.pack("<II", 15, len(bomb)) + bomb
    file.write_bytes(mat5(matrix("driving_angle_deg", ANGLE), packed))
    tracemalloc.start()
    assert read_recording(file).size == 10
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5_000_000  # the packed bytes (0.35 MB) and small change; the bomb would be 80 MB


def test_mat5_keys_beside_columns_and_whole_workspaces(tmp_path: Path) -> None:
    savemat = importlib.import_module("scipy.io").savemat
    file = tmp_path / "rec.mat"
    workspace: dict[str, Any] = {
        "driving_angle_deg": ANGLE,
        "driven_angle_deg": ANGLE,
        "torque_nm": 12.5,
        "flank": "coast",
        "notes": "from the old rig",
        "setup": {"operator": "A", "gain": 3.0},
        "cells": np.array([1, "two"], dtype=object),
    }
    for packed in (False, True):
        savemat(file, workspace, do_compression=packed)
        recording = read_recording(file)
        assert (recording.torque_nm, recording.flank) == (12.5, "coast")
        assert any("notes" in remark for remark in recording.remarks)
    savemat(file, {"a": {"driving_angle_deg": ANGLE}, "b": {"driven_angle_deg": ANGLE}})
    read = read_recording(file)  # a struct for each shaft: both are called by their names, and no two by the same
    np.testing.assert_array_equal(read.driving_angle_rad, read.driven_angle_rad)
    savemat(file, {"driving_angle_deg": ANGLE, "driven_angle_deg": ANGLE + 1j})
    assert "complex" in refusal(file).found
    savemat(file, {"driving_angle_deg": ANGLE, "driven_angle_deg": "text of some length"})
    assert "a text" in refusal(file).found
    savemat(file, {"driving_angle_deg": ANGLE, "driven_angle_deg": ANGLE, "torque_nm": "25 N.m"})
    assert 'torque_nm = "25 N.m"' in refusal(file).found
