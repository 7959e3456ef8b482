"""Refusals that take more than a file and a second one: extras, objects of MATLAB, runs, several recordings in one."""

from __future__ import annotations

import importlib
import re
import sys
import tomllib
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from unittest import mock

import numpy as np

from gearpoly.recording.map_file import read_map
from gearpoly.recording.read import read_recording
from tests import recording_files as files
from tests.cures.cure import RATIO, RUN, Cure, command, put, read, rows, text, with_columns
from tests.cures.formats import mat, tdms, wave, written
from tests.cures.sheets import ASKED, COUNT, GEAR, curves, sheet
from tests.cures.tables import HAND, TABLE
from tests.cures.texts import BACK, LOGGED, ROWS, WHOLE, T
from tests.test_loggers import mat5, matrix, opaque
from tests.test_rexs import OLD

PYPROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
BROUGHT = {"pyarrow": "pyarrow", "h5py": "h5py", "nptdms": "nptdms", "defusedxml": "defusedxml"}


def without(module: str, name: str, attempt: Callable[[Path], object]) -> Cure:
    """A file whose format needs a package that is not there; the extra that is named brings it."""

    def bad(folder: Path) -> None:
        hidden = {one: None for one in sys.modules if one.partition(".")[0] == module} | {module: None}
        with ExitStack() as stack:
            stack.enter_context(mock.patch.dict(sys.modules, hidden))
            attempt(folder)

    def good(folder: Path, message: str) -> None:
        extra = re.search(r"pip install '?gearpoly\[(\w+)\]", message)
        assert extra is not None
        needs = PYPROJECT["project"]["optional-dependencies"][extra[1]]
        assert any(one.lower().startswith(BROUGHT[module]) for one in needs)
        attempt(folder)

    return Cure(name=name, says="pip install", bad=bad, good=good)


def _parquet(folder: Path) -> object:
    files.write_parquet(folder / "a.parquet", RUN, {})
    return read(folder, "a.parquet")


def _made_before(folder: Path, write: Callable[[Path], object], name: str) -> object:
    if not (folder / name).exists():
        with mock.patch.dict(sys.modules):
            for one in [one for one, held in sys.modules.items() if held is None]:
                del sys.modules[one]
            write(folder / name)
    return read(folder, name)


def _old_pyarrow(folder: Path) -> None:
    with mock.patch.object(importlib.import_module("pyarrow"), "__version__", "14.0.1"):
        _parquet(folder)


def _design(folder: Path) -> object:
    put(folder, "a.rexs", OLD)
    return command("pair", "--from", folder / "a.rexs", folder / "p.toml")


def _gde(folder: Path) -> object:
    put(folder, "a.gde", HAND)
    return command("pair", "--from", folder / "a.gde", folder / "p.toml", *ASKED)


def _several(folder: Path, chart: str | None) -> object:
    put(folder, "log.txt", LOGGED + "\n" + LOGGED)
    put(folder, "map.toml", chart or "")
    return read_recording(folder / "log.txt", chart=None if chart is None else read_map(folder / "map.toml"))


def _objects(kind: str, *beside: bytes) -> Callable[[Path], object]:
    return lambda file: file.write_bytes(mat5(*beside, opaque("T", kind)))


def _beside(folder: Path) -> None:
    put(folder, "a.mka", curves())
    put(folder, "p_driving_profiles.csv", "")
    command("pair", "--from", folder / "a.mka", folder / "p.toml", *ASKED)


def _moved_away(folder: Path, message: str) -> None:
    (folder / "p_driving_profiles.csv").rename(folder / "mine.csv")
    command("pair", "--from", folder / "a.mka", folder / "p.toml", *ASKED)


SET_BACK = RATIO * WHOLE - np.where(np.arange(T.size) > 680, 4.0, 0.0)
HALF_TIMED = (
    'columns.driving_angle_deg = { from = "a", unit = "deg" }\n'
    'columns.driven_angle_deg = { from = "b", unit = "deg" }\n'
)


def _half_timed(folder: Path, *, both: bool) -> object:
    names = {"driving_angle_deg": "a", "driven_angle_deg": "b"}
    nptdms = importlib.import_module("nptdms")
    with nptdms.TdmsWriter(folder / "a.tdms") as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("rig", to, RUN[name], properties=wave()(name) if both or to == "a" else {})
                for name, to in names.items()
            ]
        )
    put(folder, "map.toml", HALF_TIMED)
    return read(folder, "a.tdms", maps=True)


CURES = [
    without(
        "pyarrow",
        "no pyarrow",
        lambda folder: _made_before(folder, lambda file: files.write_parquet(file, RUN, {}), "a.parquet"),
    ),
    without("nptdms", "no npTDMS", lambda folder: _made_before(folder, tdms(), "a.tdms")),
    without("defusedxml", "no defusedxml for a design", _design),
    without("defusedxml", "no defusedxml for a sheet", _gde),
    Cure(
        name="old pyarrow",
        says="pip install --upgrade gearpoly[parquet] (pyarrow 15 or later)",
        bad=_old_pyarrow,
        good=lambda folder, message: _parquet(folder),
    ),
    Cure(
        name="several recordings",
        says="section = 1 in a map",
        bad=lambda folder: _several(folder, None),
        good=lambda folder, message: _several(folder, "section = 1\n"),
    ),
    Cure(
        name="runs",
        says="want one of them: rec.csv#1",
        bad=lambda folder: (
            put(folder, "rec.csv", with_columns(driving_angle_deg=2.0 * BACK, driven_angle_deg=2.0 * RATIO * BACK)),
            read_recording(folder / "rec.csv"),
        ),
        good=lambda folder, message: read_recording(folder / "rec.csv#1"),
    ),
    Cure(
        name="read a part of a format without parts",
        says="want a.mat without #2",
        bad=lambda folder: (mat()(folder / "a.mat"), command("read", folder / "a.mat#2")),
        good=lambda folder, message: command("read", folder / "a.mat"),
    ),
    text(
        "one shaft back",
        "cut the recording there",
        with_columns(driven_angle_deg=SET_BACK),
        rows(*ROWS[:640]),
        ratio=RATIO,
    ),
    text(
        "marked as UTF-8", "export it again as UTF-8", b"\xef\xbb\xbf" + LOGGED.encode("cp1252"), LOGGED, file="log.txt"
    ),
    written("object alone", "in MATLAB: S = ", _objects("MyOwnClass", matrix("gain", np.arange(1.0))), mat(), "a.mat"),
    written(
        "object beside another",
        "in MATLAB: S = ",
        _objects("MyOwnClass", matrix("gain", np.arange(3.0))),
        mat(),
        "a.mat",
    ),
    Cure(
        name="some have times",
        says="want columns that all have times, or one that is time_s",
        bad=lambda folder: _half_timed(folder, both=False),
        good=lambda folder, message: _half_timed(folder, both=True),
    ),
    Cure(name="profiles there", says="want it out of the way", bad=_beside, good=_moved_away),
    sheet(
        "mate that is none",
        "want",
        TABLE,
        file="a.csv",
        layout=COUNT + GEAR,
        pair="[driven]\nteeth = 2\nmodule_mm = 2.0\n",
        good_pair="[driven]\nteeth = 20\nmodule_mm = 2.0\n",
    ),
]
