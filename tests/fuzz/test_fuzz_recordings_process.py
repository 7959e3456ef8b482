"""What a whole process takes for files below 10 MB that state much, hold much or never end: 20 s and 1.5 GB."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from gearpoly.recording.reader import NUMBER_BYTES, SMALL_LIMIT_BYTES
from tests import recording_files as files
from tests.fuzz.judge import BOUND

ROOT = Path(__file__).parents[2]
ANGLES = ("driving_angle_deg", "driven_angle_deg")
MOST_MB = 1500.0
BESIDE_MB = 4000.0
"""Address space beyond which the system ends a process: threads and libraries map far more than they use."""

READ = """\
import json, resource, sys, time
from pathlib import Path
resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[1]), int(sys.argv[1])))
from gearpoly.errors import GearpolyError
from gearpoly.recording.clean import clean
from gearpoly.recording.read import read_recording
def held():
    # What getrusage says begins with what the process that forked this one held.
    try:
        status = Path("/proc/self/status").read_text()
        return int(status.split("VmHWM:")[1].split()[0])
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
for file in map(Path, sys.argv[2:]):
    begun = time.process_time()
    try:
        recording = read_recording(file)
        clean(recording, ratio=0.72, r_b2=23.5)
        says = "read"
    except GearpolyError as error:
        says = str(error)
    own, child = (most / 1024 for most in (held(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
    print(json.dumps([file.name, says, time.process_time() - begun, own, child]), flush=True)
"""


def taken(*given: Path) -> Iterator[tuple[str, str, float, float]]:
    """Name, what was said, s and peak MB so far of every file, read one after the other by one process."""
    ran = subprocess.run(
        [sys.executable, "-c", READ, str(int(BESIDE_MB * 2**20)), *map(str, given)],
        capture_output=True,
        text=True,
        check=False,
        timeout=BOUND * len(given),
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert ran.returncode == 0, ran.stderr[-2000:]
    for line in ran.stdout.splitlines():
        name, says, seconds, own, child = json.loads(line)
        yield name, says, seconds, own + child


def hdf5(file: Path) -> None:
    h5py = importlib.import_module("h5py")
    with h5py.File(file, "w") as root:
        for name in ANGLES:
            root.create_dataset(name, shape=(260_000_000,), chunks=(1000,), compression="gzip", dtype="f8")
        root[ANGLES[0]][:1000] = root[ANGLES[1]][:1000] = 1.0


def parquet(file: Path, *, groups: int = 20) -> None:
    pa = importlib.import_module("pyarrow")
    writer = importlib.import_module("pyarrow.parquet").ParquetWriter
    schema = pa.schema([(name, pa.float64()) for name in ANGLES])
    turned = np.arange(500_000.0)
    block = pa.table([pa.array(turned % 360.0), pa.array(0.72 * turned % 360.0)], schema=schema)
    with writer(file, schema, compression="zstd") as held:
        for _ in range(groups):
            held.write_table(block)


def most(file: Path) -> None:
    """As many numbers as a small file may hold."""
    parquet(file, groups=SMALL_LIMIT_BYTES // NUMBER_BYTES // 1_000_000 - 1)


def mat5(file: Path) -> None:
    files.write_mat5(file, {name: np.zeros(10_000_000, dtype="i1") for name in ANGLES}, {})


def circle(file: Path) -> None:
    file.write_bytes(zlib.decompress((Path(__file__).parent / "found" / "circle.h5.zlib").read_bytes()))


def line(file: Path) -> None:
    file.write_text(",".join(ANGLES) + "\n" + "0," * 5_000_000, encoding="ascii")


def rows(file: Path) -> None:
    """The rows that take longest: as many cells as fit, one in a row empty."""
    file.write_text(",".join(ANGLES) + "\n" + "1,\n,1\n" * 1_600_000, encoding="ascii")


def remarks(file: Path) -> None:
    file.write_text("".join(f"# torque {i} = 1\n" for i in range(500_000)) + ",".join(ANGLES) + "\n", encoding="ascii")


def sets(file: Path) -> None:
    file.write_bytes(b"    -1\n   151\nx\n    -1\n" * 400_000)


def pipe(file: Path) -> None:
    os.mkfifo(file)


MADE: dict[str, Callable[[Path], None]] = {
    "few.h5": hdf5, "many.parquet": parquet, "zeros.mat": mat5, "line.csv": line, "remarks.csv": remarks,
    "sets.unv": sets, "pipe.csv": pipe,
}  # fmt: skip
SLOW: dict[str, Callable[[Path], None]] = {"rows.csv": rows, "circle.h5": circle, "most.parquet": most}


def check(folder: Path, made: dict[str, Callable[[Path], None]]) -> dict[str, str]:
    for name, write in made.items():
        write(folder / name)
        assert (folder / name).stat().st_size < 10 * 2**20, name
    said = {}
    for name, says, seconds, peak in taken(*(folder / name for name in made), Path("/dev/zero")):
        assert seconds < BOUND, (name, seconds)
        assert peak < MOST_MB, (name, peak)
        said[name] = says
    assert "pipe or a device" in said["zero"]
    return said


@pytest.mark.slow
def test_files_that_state_much_or_never_end(tmp_path: Path) -> None:
    for module in ("h5py", "pyarrow"):
        pytest.importorskip(module)
    said = check(tmp_path, MADE)
    for name in ("few.h5", "many.parquet", "zeros.mat"):
        assert "want at most 384 MB" in said[name]  # where size is the reason, the limit is named
    assert "pipe or a device" in said["pipe.csv"]
    assert "line end" in said["line.csv"]


@pytest.mark.slow
def test_files_that_hold_as_much_as_they_may(tmp_path: Path) -> None:
    for module in ("h5py", "pyarrow"):
        pytest.importorskip(module)
    said = check(tmp_path, SLOW)
    assert said["most.parquet"] == "read"
    assert "did not end within" in said["circle.h5"] or "damaged" in said["circle.h5"]
