"""Channels under an owner's own names in HDF5, MATLAB, TDMS and universal files: by name and unit, or by a map."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray
from tests.made_command import Command
from tests.made_readings import needs
from tests.made_texts import DEGREE, GERMAN, OWN, chart, own, run, same
from tests.recording_files import uff_header

RUN = run(1200)
UNITS = ("s", "deg", "deg", "N.m")
NAMES = ("Zeit", "Winkel Antrieb", "Winkel Abtrieb", "Drehmoment Abtrieb")
BARE = ("A", "B", "C", "D")
JOINTS = {".h5": "/", ".tdms": "/", ".mat": "."}

Series = Mapping[str, tuple[FloatArray, str]]


def hdf5(file: Path, groups: Mapping[str, Series]) -> None:
    with importlib.import_module("h5py").File(file, "w") as root:
        for group, held in groups.items():
            for name, (values, unit) in held.items():
                root.require_group(group or "/").create_dataset(name, data=values).attrs["units"] = unit


def tdms(file: Path, groups: Mapping[str, Series]) -> None:
    nptdms = importlib.import_module("nptdms")
    with nptdms.TdmsWriter(file) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject(group or "rig", name, values, properties={"unit_string": unit})
                for group, held in groups.items()
                for name, (values, unit) in held.items()
            ]
        )


def nested(groups: Mapping[str, Series]) -> dict[str, Any]:
    held: dict[str, Any] = {}
    for group, inside in groups.items():
        place = held
        for part in group.split("/") if group else ():
            place = place.setdefault(part, {})
        place |= {name: values for name, (values, _) in inside.items()}
    return held


def mat5(file: Path, groups: Mapping[str, Series]) -> None:
    importlib.import_module("scipy.io").savemat(file, nested(groups), do_compression=True)


def mat73(file: Path, groups: Mapping[str, Series]) -> None:
    with importlib.import_module("h5py").File(file, "w", userblock_size=512) as root:
        for group, held in groups.items():
            for name, (values, _) in held.items():
                data = root.require_group(group or "/").create_dataset(name, data=values[None, :])
                data.attrs["MATLAB_class"] = np.bytes_("double")
    with file.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")


def uff(file: Path, groups: Mapping[str, Series]) -> None:
    (held,) = groups.values()
    parts = []
    for name, (values, _) in held.items():
        parts += [
            uff_header(name, values.size, {}, binary=True, even=True),
            values.astype("<f8").tobytes(),
            b"    -1\n",
        ]
    file.write_bytes(b"".join(parts))


Writer = Callable[[Path, Mapping[str, Series]], None]
GROUPED: dict[str, tuple[str, str, Writer]] = {
    "hdf5": ("a.h5", "h5py", hdf5),
    "tdms": ("a.tdms", "nptdms", tdms),
    "mat5": ("a.mat", "scipy", mat5),
    "mat73": ("a.mat", "h5py", mat73),
}
EVERY = [pytest.param(name, marks=needs(module)) for name, (_, module, _) in GROUPED.items()]


def named(names: tuple[str, ...] = NAMES, *, by: int = 1) -> dict[str, tuple[FloatArray, str]]:
    return {name: (values[::by], unit) for name, values, unit in zip(names, RUN.values(), UNITS, strict=True)}


def saved(folder: Path, form: str, groups: Mapping[str, Series]) -> tuple[Path, str]:
    """The file, and what stands between the parts of its paths."""
    name, _, writer = GROUPED[form]
    writer(folder / name, groups)
    return folder / name, JOINTS[Path(name).suffix]


def check(recording: Recording, *, by: int = 1) -> None:
    same(recording.time_s, RUN["time_s"][::by], half=0.0)
    same(recording.driving_angle_rad, RUN["driving_angle_deg"][::by] * DEGREE, half=0.0)
    same(recording.driven_angle_rad, RUN["driven_angle_deg"][::by] * DEGREE, half=0.0)
    same(recording.torque_samples_nm, RUN["torque_nm"][::by], half=0.0)


def lines(names: tuple[str, ...], *, prefix: str = "") -> str:
    return "".join(
        f'columns.{column} = {{ from = "{prefix}{name}", unit = "{unit}" }}\n'
        for column, name, unit in zip(OWN, names, UNITS, strict=True)
    )


@pytest.mark.parametrize("form", ["hdf5", "tdms"])
def test_names_and_units_that_are_sure_are_taken(tmp_path: Path, form: str) -> None:
    """The units stand in attributes or properties; the group is called as no shaft is."""
    file, _ = saved(tmp_path, form, {"Pruefstand": named()})
    check(read_recording(file))


@pytest.mark.parametrize("form", EVERY)
@pytest.mark.parametrize("group", ["", "rig", "rig/run"])
def test_a_map_settles_names_that_say_nothing(tmp_path: Path, form: str, group: str) -> None:
    file, joint = saved(tmp_path, form, {group: named(BARE), "noise": {"x": (np.arange(7.0), "V")}})
    prefix = f"{group}/" if group else ("rig/" if form == "tdms" else "")
    if form == "tdms":  # a group may hold a slash in its name
        joint = "/"
    with pytest.raises(InputFileError, match="map"):
        read_recording(file)
    check(read_recording(file, chart=chart(tmp_path, lines(BARE, prefix=prefix.replace("/", joint)))))
    check(read_recording(file, chart=chart(tmp_path, lines(BARE))))  # by their own names, which are there once


def test_a_map_of_a_universal_file(tmp_path: Path) -> None:
    file = tmp_path / "a.uff"
    uff(file, {"": named(BARE)})
    check(read_recording(file, chart=chart(tmp_path, lines(BARE))))


@pytest.mark.parametrize("form", EVERY)
def test_the_map_that_read_writes_is_taken(tmp_path: Path, form: str, gearpoly_command: Command) -> None:
    """The command names every channel by its path and asks for what it does not know; its lines without the # do."""
    names = ("Zeit", "Winkel 1", "Winkel 2", "Kraft")
    file, _ = saved(tmp_path, form, {"rig": named(names)})
    written = tmp_path / "map.toml"
    assert gearpoly_command("read", file, "--write", written).code == 0
    text = written.read_text(encoding="utf-8")
    text = "".join(
        line.removeprefix("# ") + "\n" for line in text.splitlines() if "columns." in line and "or " not in line
    )
    recording = read_recording(file, chart=chart(tmp_path, text))
    same(recording.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=0.0)


@pytest.mark.parametrize("form", EVERY)
def test_two_recordings_in_a_file_are_told_apart_by_a_map(tmp_path: Path, form: str) -> None:
    """Nothing of the other recording is taken along, though only it has a torque."""
    first, second = named(OWN), named(OWN, by=2)
    del first["torque_nm"]
    file, joint = saved(tmp_path, form, {"run_1": first, "run_2": second})
    with pytest.raises(InputFileError, match=rf"run_1{joint}driv\w+_deg. and .run_2{joint}driv\w+_deg. may"):
        read_recording(file)
    both = "".join(
        f'columns.{name} = {{ from = "{{0}}{joint}{name}" }}\n' for name in ("driving_angle_deg", "driven_angle_deg")
    )
    read = read_recording(file, chart=chart(tmp_path, both.replace("{0}", "run_1")))
    assert read.size == 1200 and read.torque_samples_nm is None
    check(read_recording(file, chart=chart(tmp_path, both.replace("{0}", "run_2"))), by=2)


@pytest.mark.parametrize("form", EVERY)
def test_a_map_gives_what_stands_beside_the_columns(tmp_path: Path, form: str) -> None:
    """A torque of the owner's own name, in a group of its own, and one that the map leaves out."""
    held = named(OWN)
    torque = held.pop("torque_nm")[0]
    file, joint = saved(tmp_path, form, {"run": held, "sensors": {"M": (10.0 * torque, "V")}})
    assert read_recording(file).torque_samples_nm is None
    line = f'columns.torque_nm = {{ from = "sensors{joint}M", unit = "N.m", scale = 0.1 }}'
    mapped = read_recording(file, chart=chart(tmp_path, line))
    assert mapped.torque_samples_nm is not None
    np.testing.assert_allclose(mapped.torque_samples_nm, torque, rtol=1e-14)


@pytest.mark.parametrize("form", EVERY)
def test_a_name_that_is_nearly_one_is_settled_by_a_map(tmp_path: Path, form: str) -> None:
    held = named(("time", *OWN[1:]))
    file, joint = saved(tmp_path, form, {"run": held})
    if form in ("hdf5", "tdms"):  # which state its unit, so that it is sure
        check(read_recording(file))
    else:
        with pytest.raises(InputFileError, match='nearest known column is "time_s"'):
            read_recording(file)
    check(read_recording(file, chart=chart(tmp_path, f'columns.time_s = {{ from = "run{joint}time", unit = "s" }}')))
    left = read_recording(file, chart=chart(tmp_path, f'leave_out = ["run{joint}time"]'))
    assert left.time_s is None


@pytest.mark.parametrize("form", ["hdf5", "tdms"])
def test_shafts_named_by_groups(tmp_path: Path, form: str) -> None:
    """Antrieb/Winkel and Abtrieb/Winkel name both shafts; one group called input names none."""
    driving, driven = ({"Winkel": (RUN[name], "deg")} for name in OWN[1:3])
    file, _ = saved(tmp_path, form, {"Antrieb": driving, "Abtrieb": driven})
    recording = read_recording(file)
    same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.0)
    same(recording.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=0.0)
    file, _ = saved(tmp_path, form, {"Input": driving, "Rig": driven})
    with pytest.raises(InputFileError, match="no word says of which shaft"):
        read_recording(file)


@pytest.mark.parametrize("form", ["hdf5", "tdms"])
def test_a_unit_that_contradicts_a_name_is_asked_about(tmp_path: Path, form: str) -> None:
    held = named(OWN)
    held["driving_angle_deg"] = (np.radians(RUN["driving_angle_deg"]), "rad")
    file, _ = saved(tmp_path, form, {"run": held})
    with pytest.raises(InputFileError, match='the unit "rad"'):
        read_recording(file)


def test_packed_datasets_of_other_names_are_unpacked(tmp_path: Path) -> None:
    """scale_factor, add_offset and _FillValue hold for every dataset."""
    h5py = pytest.importorskip("h5py")
    file = tmp_path / "a.h5"
    with h5py.File(file, "w") as root:
        for column, name in zip(OWN[1:3], GERMAN[1:3], strict=True):
            stored = np.round((RUN[column] - 5.0) / 0.01).astype("i4")
            stored[7] = -1
            data = root.create_dataset(f"rig/{name.partition(' [')[0]}", data=stored)
            data.attrs.update({"scale_factor": 0.01, "add_offset": 5.0, "_FillValue": np.int32(-1), "units": "degrees"})
    recording = read_recording(file)
    assert recording.driving_angle_rad is not None
    assert np.flatnonzero(np.isnan(recording.driving_angle_rad)).tolist() == [7]
    off = np.delete(recording.driving_angle_rad / DEGREE - RUN["driving_angle_deg"], 7)
    assert np.abs(off).max() <= 0.005 + 1e-9  # half of the last place


def test_structs_in_an_array_are_named_by_their_number(tmp_path: Path) -> None:
    """rig.run(2).B of MATLAB, as Simulink keeps signals."""
    file = tmp_path / "a.mat"
    element = np.zeros(2, dtype=[(name, object) for name in BARE])
    for k in range(2):
        for name, values in zip(BARE, RUN.values(), strict=True):
            element[k][name] = values[:: k + 1]
    importlib.import_module("scipy.io").savemat(file, {"rig": {"run": element}})
    check(read_recording(file, chart=chart(tmp_path, lines(BARE, prefix="rig.run(2)."))), by=2)


@needs("h5py")
@pytest.mark.parametrize("inner", ["", "log"])
def test_structs_in_an_array_of_mat_73_are_named_as_those_of_mat_5(tmp_path: Path, inner: str) -> None:
    """Each field is a list of references to its values, one for each struct, as -v7.3 writes them; a value may be a
    struct again (rig.run(2).log.B)."""
    h5py = importlib.import_module("h5py")
    file = tmp_path / "a.mat"
    with h5py.File(file, "w", userblock_size=512) as root:
        rig, kept = root.create_group("rig"), root.create_group("#refs#")
        runs = rig.create_group("run")
        for group in (rig, runs):
            group.attrs["MATLAB_class"] = np.bytes_("struct")
        held = {}
        for k in range(2):
            struct = kept.create_group(f"s{k}")
            struct.attrs["MATLAB_class"] = np.bytes_("struct")
            for name, values in zip(BARE, RUN.values(), strict=True):
                data = struct.create_dataset(name, data=values[None, :: k + 1])
                data.attrs["MATLAB_class"] = np.bytes_("double")
            if inner:
                held.setdefault(inner, []).append(struct.ref)
            else:
                for name in BARE:
                    held.setdefault(name, []).append(struct[name].ref)
        for name, references in held.items():
            runs.create_dataset(name, data=np.array(references, dtype=object)[:, None], dtype=h5py.ref_dtype)
    with file.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")
    prefix = f"rig.run(2).{inner}." if inner else "rig.run(2)."
    check(read_recording(file, chart=chart(tmp_path, lines(BARE, prefix=prefix))), by=2)


@needs("nptdms")
def test_channels_of_other_names_that_begin_apart(tmp_path: Path) -> None:
    """Each channel has a wf_start_time of its own: times count from the first, and the later one begins 2 s after."""
    nptdms = importlib.import_module("nptdms")
    file = tmp_path / "a.tdms"
    begin = np.datetime64("2026-03-01T12:00:00", "us")
    late = RUN["time_s"] >= 2.0
    with nptdms.TdmsWriter(file) as writer:
        channels = []
        for name, values, start in (
            ("Winkel Antrieb", RUN["driving_angle_deg"], begin),
            ("Winkel Abtrieb", RUN["driven_angle_deg"][late], begin + np.timedelta64(2, "s")),
        ):
            wave = {"wf_start_time": start, "wf_increment": 0.01, "unit_string": "deg"}
            channels.append(nptdms.ChannelObject("rig", name, values, properties=wave))
        writer.write_segment(channels)
    recording = read_recording(file)
    assert recording.time_s is not None and recording.driving_angle_rad is not None
    np.testing.assert_allclose(recording.time_s, RUN["time_s"][late], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(recording.driving_angle_rad, RUN["driving_angle_deg"][late] * DEGREE, atol=1e-9)


@needs("nptdms")
@pytest.mark.parametrize("name", ["Zeit", "Marke"])
def test_time_stamps_beside_channels_of_other_names(tmp_path: Path, name: str) -> None:
    nptdms = importlib.import_module("nptdms")
    file = tmp_path / "a.tdms"
    stamps = np.datetime64("2026-03-01T23:59:59", "us") + np.round(1e6 * RUN["time_s"]).astype("m8[us]")
    with nptdms.TdmsWriter(file) as writer:
        channels = [nptdms.ChannelObject("rig", name, stamps)]
        channels += [
            nptdms.ChannelObject("rig", label, RUN[column], properties={"unit_string": "deg"})
            for label, column in zip(NAMES[1:3], OWN[1:3], strict=True)
        ]
        writer.write_segment(channels)
    recording = read_recording(file)
    assert recording.time_s is not None
    np.testing.assert_allclose(recording.time_s, RUN["time_s"], rtol=0.0, atol=1e-9)


def test_a_name_that_is_nearly_one_in_text_and_parquet(tmp_path: Path, gearpoly_command: Command) -> None:
    """Refused with the nearest column; a map settles it, and read shows what there is all the same."""
    held = {"time" if name == "time_s" else name: values for name, values in RUN.items()}
    text = tmp_path / "a.csv"
    text.write_text(own(held, digits=9), encoding="utf-8")
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    packed = tmp_path / "a.parquet"
    parquet.write_table(pa.table({name: pa.array(values) for name, values in held.items()}), packed)
    settled = chart(tmp_path, 'columns.time_s = { from = "time", unit = "s" }')
    for file, half in ((text, 0.5e-9), (packed, 0.0)):
        with pytest.raises(InputFileError, match='unknown column "time"; the nearest known column is "time_s"'):
            read_recording(file)
        same(read_recording(file, chart=settled).time_s, RUN["time_s"], half=half)
    written = tmp_path / "map.toml"
    assert gearpoly_command("read", packed, "--write", written).code == 0
    assert '# columns.time_s = { from = "time", unit = "s" }' in written.read_text(encoding="utf-8")
