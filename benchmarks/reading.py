"""How fast recordings are read, against each format's own library, and how much memory that takes.

For every format one recording is written, then read in fresh processes: by the format's own library into plain arrays,
and by ``read_recording``. CSV is read by pandas, and by ``numpy.loadtxt``. Printed are the processor times (the least
of five; that of a process apart counts too), their ratio (goal: at least half the library's speed) and the peak memory
beyond the imports, of both processes together, over the size of the file's numbers at 8 bytes (goal: at most 5 times).
Linux only.
Run from the repository's root: python -m benchmarks.reading [samples [format ...]]

Small files: python -m benchmarks.reading first [samples [format ...]] compares whole processes, from their start over
all imports to the numbers of one file (2000 samples), which is what one small file costs.
Large ones: python -m benchmarks.reading command [MB [format ...]] times `gearpoly read` of a file of 100 MB: wall and
processor time of the whole command (goal: 2 s).
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tests import recording_files as files

SAMPLES = 1_000_000
COLUMNS = 4
REPEATS = 5
SMALL = 2000
LARGE_MB = 100.0

KEYS: dict[str, object] = {"torque_nm": 25.0, "speed_rpm": 30.0, "flank": "drive", "driving_zero_deg": 12.5}


def recorded(samples: int) -> dict[str, files.FloatArray]:
    rng = np.random.default_rng(1)
    time_s = np.cumsum(rng.uniform(0.5, 1.5, samples)) * 1e-4
    driving = 360.0 * 0.5 * time_s
    return {
        "time_s": time_s,
        "driving_angle_deg": driving % 360.0,
        "driven_angle_deg": 0.72 * driving + 1e-4 * rng.standard_normal(samples),
        "torque_nm": 25.0 + 0.1 * rng.standard_normal(samples),
    }


def by_csv(file: Path) -> Any:
    return importlib.import_module("pandas").read_csv(file, skiprows=len(KEYS), engine="c")


def by_numpy(file: Path) -> Any:
    return np.loadtxt(file, delimiter=",", skiprows=len(KEYS) + 1)


def by_parquet(file: Path) -> Any:
    table = importlib.import_module("pyarrow.parquet").read_table(file)
    return [table.column(name).to_numpy() for name in table.column_names]


def by_hdf5(file: Path) -> Any:
    with importlib.import_module("h5py").File(file, "r") as root:
        return [root[name][()] for name in root if hasattr(root[name], "dtype")]


def by_mat5(file: Path) -> Any:
    return importlib.import_module("scipy.io").loadmat(file)


def by_tdms(file: Path) -> Any:
    source = importlib.import_module("nptdms").TdmsFile.read(file)
    return [channel[:] for group in source.groups() for channel in group.channels()]


def by_text(file: Path) -> Any:
    return importlib.import_module("pandas").read_csv(file, sep=";", decimal=",", encoding="cp1252", engine="c")


def by_matio(file: Path) -> Any:
    return importlib.import_module("matio").load_from_mat(str(file))


def write_german(file: Path, columns: files.Columns, keys: files.Keys) -> None:
    names = "Zeit [s];Winkel Antrieb [°];Winkel Abtrieb [°];Drehmoment Abtrieb [Nm]\n"
    cells = [[f"{v:.9f}".replace(".", ",") for v in column.tolist()] for column in columns.values()]
    text = names + "".join(";".join(row) + "\n" for row in zip(*cells, strict=True))
    file.write_text(text, encoding="cp1252")


def write_table(file: Path, columns: files.Columns, keys: files.Keys, *, version: str) -> None:
    frame = importlib.import_module("pandas").DataFrame(dict(columns))
    importlib.import_module("matio").save_to_mat(str(file), {"T": frame}, version=version)


def by_uff(file: Path) -> Any:
    return [one["data"] for one in importlib.import_module("pyuff").UFF(str(file)).read_sets()]


CASES: dict[str, tuple[str, str, files.Writer, Callable[[Path], Any]]] = {
    "CSV": ("a.csv", "pandas", files.write_csv, by_csv),
    "CSV, numpy": ("n.csv", "numpy", files.write_csv, by_numpy),
    "CSV, German": ("g.csv", "pandas", write_german, by_text),
    "Parquet": ("a.parquet", "pyarrow", files.write_parquet, by_parquet),
    "HDF5": ("a.h5", "h5py", files.write_hdf5, by_hdf5),
    "HDF5, gzip": ("b.h5", "h5py", lambda f, c, k: files.write_hdf5(f, c, k, compression="gzip"), by_hdf5),
    "MAT 5": ("a.mat", "scipy", lambda f, c, k: files.write_mat5(f, c, k, packed=False), by_mat5),
    "MAT 5, packed": ("b.mat", "scipy", files.write_mat5, by_mat5),
    "MAT 5, struct": ("c.mat", "scipy", lambda f, c, k: files.write_mat5(f, c, k, struct="rec"), by_mat5),
    "MAT 7.3": ("d.mat", "h5py", files.write_mat73, by_hdf5),
    "MAT 5, table": ("t.mat", "matio", lambda f, c, k: write_table(f, c, k, version="v7"), by_matio),
    "MAT 7.3, table": ("u.mat", "matio", lambda f, c, k: write_table(f, c, k, version="v7.3"), by_matio),
    "TDMS": ("a.tdms", "nptdms", files.write_tdms, by_tdms),
    "UFF58, text": ("a.uff", "pyuff", lambda f, c, k: files.write_uff(f, c, k, binary=False), by_uff),
    "UFF58, binary": ("b.uff", "pyuff", files.write_uff, by_uff),
}


def processes() -> list[str]:
    """This process and the one in which some formats are read."""
    return ["self", *Path(f"/proc/self/task/{os.getpid()}/children").read_text(encoding="ascii").split()]


def peak_mb() -> float:
    """Largest resident memory of all processes so far, in MB.

    ru_maxrss would do elsewhere, but here it begins with what the parent held when it forked.
    """
    states = (Path(f"/proc/{one}/status").read_text(encoding="ascii") for one in processes())
    return sum(float(state.split("VmHWM:")[1].split()[0]) for state in states) / 1024.0


def processor_s() -> float:
    """Time of the processors that all processes had so far, in s; that of this one's threads counts, ended or not."""
    others = (Path(f"/proc/{one}/schedstat").read_text(encoding="ascii") for one in processes()[1:])
    return time.process_time() + sum(float(one.split()[0]) for one in others) / 1e9


def measure(name: str, ours: bool, folder: Path) -> None:
    """The body of one fresh process; prints seconds and MB."""
    from gearpoly.recording.read import read_recording, readers

    file_name, library, _, theirs = CASES[name]
    readers()
    for module in (library, "pyarrow.parquet" if library == "pyarrow" else library, "scipy.io"):
        importlib.import_module(module)
    file = folder / file_name
    small = folder / f"small_{file_name}"
    read: Callable[[Path], Any] = read_recording if ours else theirs
    if library in ("pandas", "pyarrow"):
        importlib.import_module("pyarrow.csv")  # which large texts are read by
    read(small)  # imports made on the way
    before = peak_mb()
    times = []
    for _ in range(REPEATS):
        start = processor_s()
        held = read(file)
        times.append(processor_s() - start)
        del held
    print(json.dumps([min(times), peak_mb() - before]))


def first(name: str, ours: bool, folder: Path) -> None:
    """The body of one fresh process that reads one file; prints the seconds of the processors from its start on."""
    file_name, _, _, theirs = CASES[name]
    read: Callable[[Path], Any] = theirs
    if ours:
        from gearpoly.recording.read import read_recording as read
    read(folder / file_name)
    print(json.dumps([processor_s(), peak_mb()]))


def _with_bytecode(place: str) -> dict[str, str]:
    """The environment in which modules are compiled once, as they are where they are installed."""
    return {**os.environ, "PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": str(Path(place) / "compiled")}


def compare_first(samples: int, names: list[str]) -> None:
    """Print what one small file costs in a fresh process, here and in the format's own library."""
    print(f"{samples} samples, {COLUMNS} columns, one file in a fresh process")
    print(f"{'format':16}{'library':>9}{'theirs s':>10}{'ours s':>9}{'speed':>8}")
    with tempfile.TemporaryDirectory() as place:
        for name, (file_name, library, write, _) in CASES.items():
            if (names and name not in names) or importlib.util.find_spec(library) is None:
                continue
            write(Path(place) / file_name, recorded(samples), KEYS)
            least = {}
            for who in ("theirs", "ours"):
                command = [sys.executable, "-m", "benchmarks.reading", "--first", name, who, place]
                runs = [
                    subprocess.run(command, check=True, capture_output=True, text=True, env=_with_bytecode(place))
                    for _ in range(REPEATS)
                ]
                least[who] = min(json.loads(one.stdout)[0] for one in runs)
            print(
                f"{name:16}{library:>9}{least['theirs']:10.3f}{least['ours']:9.3f}"
                f"{least['theirs'] / least['ours']:7.2f}x"
            )


def time_command(megabytes: float, names: list[str]) -> None:
    """Print how long ``gearpoly read`` takes for a file of about so many ``megabytes``: the least of three."""
    resource = importlib.import_module("resource")
    print(f"{'format':16}{'MB':>8}{'wall s':>9}{'processor s':>13}")
    with tempfile.TemporaryDirectory() as place:
        for name, (file_name, library, write, _) in CASES.items():
            if (names and name not in names) or importlib.util.find_spec(library) is None:
                continue
            file = Path(place) / file_name
            write(file, recorded(20_000), KEYS)
            write(file, recorded(int(20_000 * megabytes * 1e6 / file.stat().st_size)), KEYS)
            times = []
            for _ in range(3):
                before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
                command = [sys.executable, "-m", "gearpoly", "read", str(file)]
                subprocess.run(command, check=True, capture_output=True, env=_with_bytecode(place))
                wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
                used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
                times.append((wall, used))
            wall, used = (min(each) for each in zip(*times, strict=True))
            print(f"{name:16}{file.stat().st_size / 1e6:8.0f}{wall:9.2f}{used:13.2f}")
            file.unlink()


def main() -> None:
    if sys.argv[1:2] in (["--of"], ["--first"]):
        body = measure if sys.argv[1] == "--of" else first
        body(sys.argv[2], sys.argv[3] == "ours", Path(sys.argv[4]))
        return
    if sys.argv[1:2] == ["first"]:
        compare_first(int(sys.argv[2]) if len(sys.argv) > 2 else SMALL, sys.argv[3:])
        return
    if sys.argv[1:2] == ["command"]:
        time_command(float(sys.argv[2]) if len(sys.argv) > 2 else LARGE_MB, sys.argv[3:])
        return
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else SAMPLES
    size_mb = 8.0 * COLUMNS * samples / 2**20
    print(f"{samples} samples, {COLUMNS} columns, {size_mb:.1f} MB of numbers")
    print(f"{'format':16}{'library':>9}{'theirs s':>10}{'ours s':>9}{'speed':>8}{'their mem':>11}{'our mem':>9}")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, (file_name, library, write, _) in CASES.items():
            if sys.argv[2:] and name not in sys.argv[2:]:
                continue
            if importlib.util.find_spec(library) is None:
                print(f"{name:16}{library:>9}  not installed")
                continue
            write(folder / file_name, recorded(samples), KEYS)
            write(folder / f"small_{file_name}", recorded(100), KEYS)
            found = {}
            for who in ("theirs", "ours"):
                command = [sys.executable, "-m", "benchmarks.reading", "--of", name, who, place]
                done = subprocess.run(command, check=True, capture_output=True, text=True)
                found[who] = json.loads(done.stdout)
            (t_1, m_1), (t_2, m_2) = found["theirs"], found["ours"]
            print(
                f"{name:16}{library:>9}{t_1:10.4f}{t_2:9.4f}{t_1 / t_2:7.2f}x"
                f"{m_1 / size_mb:10.1f}x{m_2 / size_mb:8.1f}x"
            )


if __name__ == "__main__":
    main()
