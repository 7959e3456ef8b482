"""Files that state more than they hold, or never end: refused before time and memory are gone, the limit named."""

from __future__ import annotations

import importlib
import itertools
import struct
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording import apart
from gearpoly.recording.hdf5_reader import READER
from gearpoly.recording.read import read_recording
from gearpoly.recording.reader import SMALL_LIMIT_BYTES
from tests import recording_files as files
from tests.made_readings import needs, refusal
from tests.test_readers_mat5 import element, mat5, packed

ANGLES = ("driving_angle_deg", "driven_angle_deg")
MANY = 260_000_000
"""2 GB of numbers, which 4 GB of memory do not read: they took 9.2 GB."""


@needs("h5py")
@pytest.mark.parametrize("ending", ["h5", "mat"])
def test_hdf5_that_states_values_and_holds_none_or_few(tmp_path: Path, ending: str) -> None:
    h5py = importlib.import_module("h5py")
    file = tmp_path / f"rec.{ending}"
    with h5py.File(file, "w") as root:
        for name in ANGLES:
            root.create_dataset(name, shape=(MANY,), chunks=(1000,), compression="gzip", dtype="f8")
    assert f"{MANY} values stated, and none there" in refusal(file).found
    with h5py.File(file, "r+") as root:
        for name in ANGLES:
            root[name][:1000] = 1.0
    error = refusal(file)
    assert f"{2 * MANY} numbers" in error.found
    assert f"want at most {SMALL_LIMIT_BYTES // 2**20} MB" in error.wish


@pytest.mark.long
@needs("h5py")
def test_hdf5_of_a_chunk_that_is_unpacked_whole(tmp_path: Path) -> None:
    h5py = importlib.import_module("h5py")
    file = tmp_path / "rec.h5"
    with h5py.File(file, "w") as root:
        root[ANGLES[0]] = np.arange(10.0)
        few = np.zeros(10, dtype="i1")
        root.create_dataset(ANGLES[1], data=few, chunks=(300_000_000,), maxshape=(None,), compression=1)
    assert file.stat().st_size < 3_000_000
    assert "20 numbers, which take 572 MB" in refusal(file).found


@pytest.mark.long
@needs("pyarrow")
def test_parquet_of_one_value_many_times(tmp_path: Path) -> None:
    pa = importlib.import_module("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")
    file = tmp_path / "rec.parquet"
    same = pa.array(np.zeros(1_000_000))
    schema = pa.schema([(name, pa.float64()) for name in ANGLES])
    with parquet.ParquetWriter(file, schema) as writer:
        for _ in range(10):
            writer.write_table(pa.table([same, same], schema=schema))
    assert file.stat().st_size < 100_000
    assert "20000000 numbers, which take 610 MB" in refusal(file).found


@pytest.mark.parametrize("inside", ["variable", "struct"])
def test_mat5_of_zeros_that_pack_to_nothing(tmp_path: Path, inside: str) -> None:
    """The storage is one byte a number, so that a kilobyte unpacks to a million numbers of 8 bytes."""
    count = 40_000_000
    head = element(6, struct.pack("<II", 6, 0)) + element(5, struct.pack("<ii", count, 1))

    def zipped(begin: bytes, name: str) -> bytes:
        field = begin + element(1, name.encode()) + struct.pack("<II", 2, count)
        squeeze = zlib.compressobj(9)
        parts = [squeeze.compress(struct.pack("<II", 14, len(field) + count) + field)]
        parts += [squeeze.compress(bytes(1_000_000)) for _ in range(count // 1_000_000)]
        data = b"".join([*parts, squeeze.flush()])
        return struct.pack("<II", 15, len(data)) + data

    file = tmp_path / "rec.mat"
    if inside == "variable":
        file.write_bytes(mat5(*(zipped(head, name) for name in ANGLES)))
        assert f"{2 * count} numbers, which take 2441 MB" in refusal(file).found
        return
    names = b"".join(name.encode().ljust(32, b"\0") for name in ANGLES)
    body = element(6, struct.pack("<II", 2, 0)) + element(5, struct.pack("<ii", 1, 1)) + element(1, b"rec")
    body += struct.pack("<HHi", 5, 4, 32) + element(1, names)
    squeeze = zlib.compressobj(9)
    size = 600_000_000
    parts = [squeeze.compress(struct.pack("<II", 14, size) + body), squeeze.compress(bytes(1_000_000)), squeeze.flush()]
    data = b"".join(parts)
    file.write_bytes(mat5(struct.pack("<II", 15, len(data)) + data))
    assert "which take 1144 MB to read" in refusal(file).found
    assert packed(b"") is not None


@pytest.mark.slow
def test_a_line_without_end(tmp_path: Path) -> None:
    file = tmp_path / "rec.csv"
    file.write_text(",".join(ANGLES) + "\n" + "0," * 1_200_000, encoding="ascii")
    assert "no line end from byte 1048576" in refusal(file).found
    assert "1048576 bytes" in refusal(file).wish
    file.write_bytes(
        b"\r".join([b",".join(name.encode() for name in ANGLES), *(b"%d,%d" % (i, i) for i in range(100_000))])
    )
    assert read_recording(file).size == 100_000  # lines of old computers end


def test_a_header_without_end(tmp_path: Path) -> None:
    file = tmp_path / "rec.csv"
    file.write_text("".join(f"# remark{i} = 1\n" for i in range(3000)) + ",".join(ANGLES) + "\n0,0\n", encoding="ascii")
    assert "more than 2000 comment lines with =" in refusal(file).found
    file.write_text("# torque_nm = {" + "a." * 5000 + "b = 1}\n" + ",".join(ANGLES) + "\n0,0\n", encoding="ascii")
    error = refusal(file)
    assert "characters" in error.found
    assert len(str(error)) < 500


STUCK = """\
import os, sys, time
from gearpoly.recording.reader import Reader
def read(file):
    print("chatter of a library")
    if "stuck" in file.name:
        while True:
            pass
    if "crash" in file.name:
        os.abort()
    if "bug" in file.name:
        raise KeyError("a bug")
    if "greedy" in file.name:
        return bytearray(8 * 2**30)
    raise AssertionError(file)
READER = Reader(name="stuck", endings=(), recognises=bytes, read=read, module="h5py", apart=True)
"""


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "says"),
    [("stuck", "did not end within"), ("crash", "crashed"), ("greedy", "MemoryError"), ("bug", "KeyError")],
)
def test_a_library_that_crashes_or_never_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, says: str
) -> None:
    """Stands in for HDF5, in which some changed bytes lead links round in a circle, and others to a crash."""
    (tmp_path / "stuck_reader.py").write_text(STUCK, encoding="ascii")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(apart, "READING_LIMIT_S", 0.3 if name == "stuck" else 30.0)
    apart._end()  # the process that is kept knows nothing of the new path
    file = tmp_path / name
    file.write_bytes(b"x")
    reader: Any = importlib.import_module("stuck_reader").READER
    try:
        with pytest.raises((InputFileError, RuntimeError), match=says):
            apart.read_apart(reader, file)
    finally:
        apart._end()


SLOW = """
import time
import numpy as np
from gearpoly.recording.reader import Reader
from gearpoly.recording.table import Table

def read(file):
    time.sleep(1.5)
    return Table(columns={"time_s": np.arange(3.0)}, keys={})

READER = Reader(name="slow", endings=(), recognises=lambda head: False, read=read, module="json")
"""


@pytest.mark.long
@pytest.mark.parametrize("share", [0.3, 0.0, 0.9])
def test_a_process_that_others_hold_up_is_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, share: float
) -> None:
    """It works, and had a third of its time on a processor; one that sleeps, or had all of it, is ended."""
    (tmp_path / "slow_reader.py").write_text(SLOW, encoding="ascii")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(apart, "READING_LIMIT_S", 1.0)
    seen: list[float] = []
    monkeypatch.setattr(apart, "_worked", lambda pid: seen.append(0.0) or share * (len(seen) - 1))
    apart._end()
    file = tmp_path / "slow"
    file.write_bytes(b"x")
    reader: Any = importlib.import_module("slow_reader").READER
    try:
        if 0.0 < share < 0.5:
            assert apart.read_apart(reader, file).columns["time_s"].tolist() == [0.0, 1.0, 2.0]
        else:
            with pytest.raises(InputFileError, match="did not end within"):
                apart.read_apart(reader, file)
    finally:
        apart._end()


@pytest.mark.long
@needs("h5py")
def test_the_next_file_is_read_after_a_crash(tmp_path: Path) -> None:
    file = tmp_path / "rec.h5"
    files.write_hdf5(file, {name: np.arange(5.0) for name in ANGLES}, {"flank": "coast", "torque_nm": 2})
    assert read_recording(file).flank == "coast"
    apart._kept[0][1].kill()
    assert read_recording(file).size == 5
    first = apart._kept[0][1].pid
    assert read_recording(file).torque_nm == 2.0
    assert apart._kept[0][1].pid == first  # and is kept
    with pytest.raises(ImportError):
        apart.read_apart(replace(READER, module="no_such_module"), file)


@pytest.mark.long
@needs("h5py")
@pytest.mark.parametrize("damage", ["circle", "crash"])
def test_a_damaged_hdf5_that_its_library_does_not_survive(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, damage: str
) -> None:
    """Two files that random changes found, of HDF5 2.0.0: read or refused by whatever library is here."""
    monkeypatch.setattr(apart, "READING_LIMIT_S", 1.0)
    file = tmp_path / "rec.h5"
    file.write_bytes(zlib.decompress((Path(__file__).parent / "fuzz" / "found" / f"{damage}.h5.zlib").read_bytes()))
    try:
        assert read_recording(file).size
    except InputFileError as error:
        assert "damaged HDF5" in error.found
    apart._end()


def test_limits_grow_with_the_file(tmp_path: Path) -> None:
    sizes = (1, 10, 12, 113, 114, 4096)
    limits = []
    for size in sizes:
        with (tmp_path / "rec").open("wb") as stream:
            stream.truncate(size * 2**20)
        limits.append(importlib.import_module("gearpoly.recording.reader").memory_limit(tmp_path / "rec") / 2**20)
    assert limits == [384, 384, 432, 4068, 4096, 4096]
    assert all(one <= other for one, other in itertools.pairwise(limits))
