"""Refusals of recordings in the binary formats, and of guide logs."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.recording.read import read_set
from tests import recording_files as files
from tests.cures.cure import BASE, RUN, Cure, one_of_two, put, read

T = RUN["time_s"]


def written(name: str, says: str, bad: Callable[[Path], Any], good: Callable[[Path], Any], file: str) -> Cure:
    """A file of a format that is refused, and one in its place that is read."""

    def attempt(folder: Path, write: Callable[[Path], Any]) -> object:
        (folder / file).unlink(missing_ok=True)
        write(folder / file)
        return read(folder, file)

    return Cure(
        name=name,
        says=says,
        bad=lambda folder: attempt(folder, bad),
        good=lambda folder, message: attempt(folder, good),
    )


def cut(write: Callable[[Path], Any], share: float) -> Callable[[Path], None]:
    """What ``write`` writes, cut off."""

    def run(file: Path) -> None:
        write(file)
        data = file.read_bytes()
        file.write_bytes(data[: int(share * len(data))])

    return run


def changed(write: Callable[[Path], Any], old: bytes, new: bytes) -> Callable[[Path], None]:
    """What ``write`` writes, with bytes changed once."""

    def run(file: Path) -> None:
        write(file)
        data = file.read_bytes()
        assert old in data
        file.write_bytes(data.replace(old, new, 1))

    return run


# HDF5 and MAT 7.3


def hdf5(keys: dict[str, Any] | None = None, **columns: Any) -> Callable[[Path], None]:
    """The usual run as HDF5 with other or further datasets, none where it is None, and what ``keys`` states."""
    held = {**RUN, **columns}
    return lambda file: files.write_hdf5(file, {name: one for name, one in held.items() if one is not None}, keys or {})


def h5(change: Callable[[Any], None]) -> Callable[[Path], None]:
    """The usual run as HDF5 after a change of the open file."""

    def run(file: Path) -> None:
        files.write_hdf5(file, RUN, {})
        with importlib.import_module("h5py").File(file, "r+") as root:
            change(root)

    return run


def _external(root: Any) -> None:
    del root["torque_nm"]
    root.create_dataset("torque_nm", shape=(T.size,), dtype="<f8", external=[("raw.bin", 0, 8 * T.size)])


def _unwritten(root: Any) -> None:
    del root["torque_nm"]
    root.create_dataset("torque_nm", shape=(T.size,), dtype="<f8", chunks=(T.size,))


def attributed(name: str, value: Any) -> Callable[[Path], None]:
    return h5(lambda root: root["torque_nm"].attrs.update({name: value}))


HDF5 = [
    written(
        "text in a column",
        "want plain numbers",
        h5(lambda root: (root.pop("torque_nm"), root.create_dataset("torque_nm", data=np.array([b"x"] * T.size)))),
        hdf5(),
        "a.h5",
    ),
    written("outside", "want the numbers in the file itself", h5(_external), hdf5(), "a.h5"),
    written("not written", "close it where it is written, and copy it then", h5(_unwritten), hdf5(), "a.h5"),
    written(
        "unit",
        "convert the values, or take the unit out where it is wrong",
        attributed("units", "kgf.m"),
        attributed("units", "N.m"),
        "a.h5",
    ),
    written(
        "unsigned",
        "want numbers of an unsigned type, as they are meant",
        attributed("_Unsigned", "true"),
        hdf5(),
        "a.h5",
    ),
    written("long attribute", "want one value", attributed("units", np.zeros(2000)), hdf5(), "a.h5"),
    written(
        "packed",
        "want the number that CF conventions have",
        attributed("scale_factor", "x"),
        attributed("scale_factor", 1.0),
        "a.h5",
    ),
    written("a list", "want one value", hdf5({"torque_nm": [1.0, 2.0]}), hdf5({"torque_nm": 1.0}), "a.h5"),
    written("a matrix", "want one value a sample", hdf5(torque_nm=np.ones((T.size // 2, 2))), hdf5(), "a.h5"),
    written("unequal", "want one value in each column for every sample", hdf5(torque_nm=np.ones(9)), hdf5(), "a.h5"),
    written(
        "without rows",
        "want rows of numbers",
        lambda file: files.write_hdf5(file, {name: one[:0] for name, one in RUN.items()}, {}),
        hdf5(),
        "a.h5",
    ),
    written(
        "nothing",
        "want columns of time_s, driving_angle_deg",
        lambda file: files.write_hdf5(file, {}, {}),
        hdf5(),
        "a.h5",
    ),
    written(
        "infinite",
        "want a finite number (nan for a drop-out)",
        hdf5(torque_nm=np.where(T > 1.0, np.inf, 1.0)),
        hdf5(torque_nm=np.where(T > 1.0, np.nan, 1.0)),
        "a.h5",
    ),
    written("cut off", "want the whole file; copy or export it again", cut(hdf5(), 0.5), hdf5(), "a.h5"),
    written(
        "many groups",
        "at most 2000 groups",
        h5(lambda root: [root.create_group(f"g{k % 2}/{k}") for k in range(3000)]),
        hdf5(),
        "a.h5",
    ),
    written(
        "too many numbers",
        "or store it without compression",
        lambda file: files.write_hdf5(
            file, {name: np.zeros(13_000_000) for name in ("driving_angle_deg",)}, {}, compression="gzip"
        ),
        hdf5(),
        "a.h5",
    ),
    written(
        "7.3: key",
        "want one value",
        lambda file: files.write_mat73(file, RUN, {"flank": "d" * 2000}),
        lambda file: files.write_mat73(file, RUN, {"flank": "drive"}),
        "a.mat",
    ),
]


# Parquet


def parquet(columns: dict[str, Any] | None = None, keys: dict[str, Any] | None = None) -> Callable[[Path], None]:
    return lambda file: files.write_parquet(file, {**RUN, **(columns or {})}, keys or {})


def _twice(file: Path) -> None:
    pa = importlib.import_module("pyarrow")
    again = {**RUN, "torque": RUN["torque_nm"] + 1.0}
    table = pa.Table.from_arrays([pa.array(one) for one in again.values()], names=[*RUN, "torque_nm"])
    importlib.import_module("pyarrow.parquet").write_table(table, file)


PARQUET = [
    one_of_two("parquet", "torque_nm", (4, 5), _twice, "a.parquet"),
    written("words", "want plain numbers", parquet({"torque_nm": ["x"] * T.size}), parquet(), "a.parquet"),
]

# MAT 5


def mat(keys: dict[str, Any] | None = None, *, packed: bool = False, **columns: Any) -> Callable[[Path], None]:
    held = {**RUN, **columns}
    return lambda file: importlib.import_module("scipy.io").savemat(
        file, {**{name: one for name, one in held.items() if one is not None}, **(keys or {})}, do_compression=packed
    )


def _saved_twice(file: Path) -> None:
    mat()(file)
    with file.open("ab") as stream:
        importlib.import_module("scipy.io").savemat(other := file.with_name("b.mat"), {"torque_nm": T})
        stream.write(other.read_bytes()[128:])


def _saved_as_4(file: Path) -> None:
    importlib.import_module("scipy.io").savemat(file, dict(RUN), format="4")


def _saved_again(file: Path) -> None:
    io = importlib.import_module("scipy.io")
    _saved_twice(file)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        held = io.loadmat(file)
    io.savemat(file, {name: one for name, one in held.items() if not name.startswith("__")})


MAT = [
    written("complex", "want plain numbers", mat(torque_nm=T + 1j), mat(), "a.mat"),
    written(
        "cell as a key",
        "want a number or a text",
        mat({"flank": np.array([[1]], dtype=object)}),
        mat({"flank": "drive"}),
        "a.mat",
    ),
    written("variable twice", "load the file and save it again", _saved_twice, _saved_again, "a.mat"),
    written("MAT 4", "load it, then save with -v7", _saved_as_4, mat(), "a.mat"),
    written("long text", "want a short text", mat({"flank": "d" * 9000}), mat({"flank": "drive"}), "a.mat"),
    written("cut off", "want the whole file; save it again", cut(mat(), 0.9), mat(), "a.mat"),
    written(
        "key twice",
        "want each key once",
        mat({"keys": {"torque_nm": 2.0}, "speed_rpm": 30.0, "torque_nm": 25.0}),
        mat({"speed_rpm": 30.0, "torque_nm": 25.0}),
        "a.mat",
    ),
]

# TDMS


def tdms(change: Callable[[str], dict[str, Any]] = lambda name: {}, **columns: Any) -> Callable[[Path], None]:
    """The usual run as TDMS with properties of each channel."""

    def run(file: Path) -> None:
        nptdms = importlib.import_module("nptdms")
        held = {**RUN, **columns}
        with nptdms.TdmsWriter(file) as writer:
            writer.write_segment(
                [
                    nptdms.ChannelObject("rig", name, one, properties=change(name))
                    for name, one in held.items()
                    if one is not None
                ]
            )

    return run


def wave(**more: Any) -> Callable[[str], dict[str, Any]]:
    """The waveform properties of all channels, with others for the torque."""
    usual = {"wf_start_time": np.datetime64("2026-01-01T00:00:00"), "wf_increment": 0.01}
    return lambda name: {
        key: value for key, value in {**usual, **(more if name == "torque_nm" else {})}.items() if value is not None
    }


LATE = np.datetime64("2026-01-01T00:00:02")

TDMS = [
    written("words", "want plain numbers", tdms(torque_nm=["x"] * T.size), tdms(), "a.tdms"),
    written(
        "begins later",
        "leave time_s out to have the waveform times used",
        tdms(wave(wf_start_time=LATE)),
        tdms(wave(wf_start_time=LATE), time_s=None),
        "a.tdms",
    ),
    written(
        "no rate",
        "want wf_increment in s for every channel, or a channel time_s",
        tdms(wave(wf_increment=None), time_s=None),
        tdms(wave(), time_s=None),
        "a.tdms",
    ),
    written(
        "no start",
        "want a time stamp for every channel",
        tdms(wave(wf_start_time=None), time_s=None),
        tdms(wave(), time_s=None),
        "a.tdms",
    ),
    written(
        "no seconds", "want seconds", tdms(wave(wf_increment="fast"), time_s=None), tdms(wave(), time_s=None), "a.tdms"
    ),
    written(
        "apart",
        "want both shafts recorded together",
        tdms(
            lambda name: (
                wave()(name)
                | ({"wf_start_time": np.datetime64("2027-01-01T00:00:00")} if name == "driven_angle_deg" else {})
            ),
            time_s=None,
        ),
        tdms(wave(), time_s=None),
        "a.tdms",
    ),
    written(
        "three of two",
        "want two of them; leave one out",
        tdms(
            lambda name: wave()(name) | ({"wf_start_time": LATE} if name == "te_um" else {}),
            time_s=None,
            te_um=np.sin(T),
        ),
        tdms(wave(), time_s=None),
        "a.tdms",
    ),
    written(
        "pulses apart",
        "want raw channels sampled together",
        tdms(
            lambda name: wave()(name) | ({"wf_start_time": LATE} if name == "driven_angle_deg" else {}),
            time_s=None,
            driving_a=np.sign(np.sin(9.0 * T)),
        ),
        tdms(wave(), time_s=None),
        "a.tdms",
    ),
    written(
        "no values",
        "want rows of numbers",
        tdms(wave(wf_start_time=LATE), time_s=None, torque_nm=np.empty(0)),
        tdms(wave(), time_s=None),
        "a.tdms",
    ),
    written("cut off", "want the whole file; copy or export it again", cut(tdms(), 0.05), tdms(), "a.tdms"),
]

SEVERAL = [
    Cure(
        name="a text map for another format",
        says="want no [text] in a map for another format",
        bad=lambda folder: (
            mat()(folder / "a.mat"),
            put(folder, "map.toml", 'text.decimal = ","\n'),
            read(folder, "a.mat", maps=True),
        ),
        good=lambda folder, message: (put(folder, "map.toml", ""), read(folder, "a.mat", maps=True)),
    ),
    Cure(
        name="part of a format without parts",
        says="want a.mat without #2",
        bad=lambda folder: (mat()(folder / "a.mat"), read(folder, "a.mat#2")),
        good=lambda folder, message: read(folder, "a.mat"),
    ),
    Cure(
        name="a folder",
        says="want a file",
        bad=lambda folder: read_set([folder], None),
        good=lambda folder, message: (put(folder, "rec.csv", BASE), read(folder)),
    ),
    Cure(
        name="nothing there",
        says="want the path of a file that exists",
        bad=read,
        good=lambda folder, message: (put(folder, "rec.csv", BASE), read(folder)),
    ),
    Cure(
        name="a pipe",
        says="write it to one first",
        bad=lambda folder: read_set([Path("/dev/null")], None),
        good=lambda folder, message: (put(folder, "rec.csv", BASE), read(folder)),
    ),
    Cure(
        name="a circle of links",
        says="want a path whose links lead to a file",
        bad=lambda folder: ((folder / "rec.csv").symlink_to(folder / "rec.csv"), read(folder)),
        good=lambda folder, message: ((folder / "rec.csv").unlink(), put(folder, "rec.csv", BASE), read(folder)),
    ),
]

CURES = [*HDF5, *PARQUET, *MAT, *TDMS, *SEVERAL]
