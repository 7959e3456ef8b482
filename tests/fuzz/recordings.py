"""Recordings made wrong: in their columns and keys, in what their formats state beside them, and in their bytes."""

from __future__ import annotations

import importlib
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

from gearpoly.recording.recording import COLUMNS, KEYS
from tests import recording_files as files
from tests.fuzz.mutate import NASTY
from tests.made_guide_log import made_log
from tests.made_readings import FORMATS

Draw = Any
Columns = dict[str, Any]

RATIO, R_B2 = 18.0 / 25.0, 23.49
BAD = (math.nan, math.inf, -math.inf, 0.0, -1.0, 1e308, -1e308, 5e-324, 1e16, 2.0**53)
SIZES = (b"\0", b"\xff", b"\x7f", b"\x80", b"\xff" * 4, b"\xff\xff\xff\x7f", b"\0" * 4, b"\xff" * 8, b"\0" * 8, b"\x01")
"""Counts, offsets and lengths that formats hold in their binary parts, made wrong."""

ATTRIBUTES = ("scale_factor", "add_offset", "_FillValue", "missing_value", "valid_range", "units", "unit_string")
WAVEFORM = ("wf_increment", "wf_start_offset", "wf_start_time")


def run(size: int) -> Columns:
    """Everything that can be said of a steady run: angles, errors, channels, condition."""
    t = np.arange(size) / 50.0
    theta = 2.0 * math.pi * t
    te = 20e-3 / R_B2 * np.sin(theta)
    out: Columns = {
        "time_s": t,
        "driving_angle_deg": np.degrees(theta) % 360.0,
        "driven_angle_deg": np.degrees(RATIO * theta + te),
        "te_um": 1e3 * R_B2 * te,
        "te_urad": 1e6 * te,
        "te_arcsec": 3600.0 * np.degrees(te),
        "torque_nm": 25.0 + 0.1 * np.cos(theta),
        "speed_rpm": np.full(size, 60.0),
        "backlash_um": np.full(size, 80.0),
        "contact_pairs": np.full(size, 1),
    }
    for shaft, angle in (("driving", theta), ("driven", RATIO * theta)):
        out[f"{shaft}_a"] = (np.mod(4 * angle, 2 * math.pi) < math.pi).astype(float)
        out[f"{shaft}_b"] = (np.mod(4 * angle - 1.57, 2 * math.pi) < math.pi).astype(float)
        out[f"{shaft}_index"] = (np.mod(angle, 2 * math.pi) < 0.3).astype(float)
        out[f"{shaft}_count"] = np.floor(16 * angle / (2 * math.pi))
    return out


GOOD: dict[str, object] = {
    "torque_nm": 25.5, "speed_rpm": 60.0, "flank": "drive", "driving_zero_deg": 1.0, "driven_zero_deg": -2.0,
    "driving_direction": 1, "driven_direction": -1, "reversed": 0, "driving_lines": 4, "driven_lines": 4,
    "driving_counts_per_line": 4, "driven_counts_per_line": 4, "driving_count_bits": 8, "sample_rate_hz": 50.0,
    "driven_count_modulus": 256,
}  # fmt: skip


CHANGES = ("value", "block", "type", "shape", "length", "name", "order", "hold", "key", "many")


@st.composite
def tables(draw: Draw) -> tuple[Columns, dict[str, object]]:
    """Columns and keys of a recording: mostly both angles and a few more, with up to three things wrong."""
    whole = run(draw(st.sampled_from((1, 2, 8, 60, 170))))
    names = draw(
        st.sampled_from((("driving_angle_deg", "driven_angle_deg"), ("driven_angle_deg", "te_um"), ("te_urad",)))
    )
    more = draw(st.lists(st.sampled_from(sorted(whole)), max_size=5, unique=True))
    columns = {name: whole[name] for name in dict.fromkeys([*names, *more])}
    keys = {name: GOOD[name] for name in draw(st.lists(st.sampled_from(sorted(GOOD)), max_size=8, unique=True))}
    for _ in range(draw(st.sampled_from((0, 0, 1, 1, 2, 3)))):
        _spoil(draw, columns, keys)
    return columns, keys


def _spoil(draw: Draw, columns: Columns, keys: dict[str, object]) -> None:
    name = draw(st.sampled_from(sorted(columns)))
    values = np.atleast_1d(columns[name])
    at = draw(st.integers(0, max(0, len(values) - 1)))
    change = draw(st.sampled_from(CHANGES))
    if change in ("value", "block") and len(values):
        values = np.array(values, dtype=complex).real
        values[at : at + (1 if change == "value" else 40)] = draw(st.sampled_from(BAD))
        columns[name] = values
    elif change == "type":
        kind = draw(st.sampled_from(("i1", "u8", "f4", "f2", "?", "c16", "S3", "i8", ">f8")))
        with np.errstate(all="ignore"):
            columns[name] = np.nan_to_num(np.asarray(values, dtype=complex).real).astype(kind)
    elif change == "shape":
        columns[name] = draw(
            st.sampled_from((np.stack([values, values]), np.asarray(values)[None, :], np.float64(3.0)))
        )
    elif change == "length":
        columns[name] = values[: draw(st.integers(0, 3))] if draw(st.booleans()) else np.tile(values, 2)
    elif change == "name":
        columns[draw(st.sampled_from((*COLUMNS, *KEYS, name + "s", name.upper(), "x" * 300, *NASTY[:6])))] = (
            columns.pop(name)
        )
    elif change == "order":
        columns[name] = values[::-1]
    elif change == "hold":
        columns[name] = np.repeat(values, draw(st.integers(2, 30)))[: len(values)]
    elif change == "key":
        key = draw(st.sampled_from((*KEYS, "driving_zero", "", "a.b", "x" * 2000)))
        keys[key] = draw(st.sampled_from((*BAD, *NASTY, True, 10**30)))
    else:
        columns.update({f"channel {i}": values for i in range(draw(st.sampled_from((3, 40))))})


def _csv(draw: Draw, file: Path, columns: Columns, keys: dict[str, object]) -> None:
    separator = draw(st.sampled_from((",", ",", ",", ";", "\t", " , ")))
    number = draw(st.sampled_from((repr, "{:.4f}".format, "{:.6g}".format, lambda v: str(v).replace(".", ","))))
    size = max((np.size(v) for v in columns.values()), default=0)
    cells = [
        np.resize(np.asarray(v).reshape(-1), size).tolist() if np.size(v) else [""] * size for v in columns.values()
    ]
    rows = [
        separator.join(number(c) if isinstance(c, float) else str(c) for c in row) for row in zip(*cells, strict=True)
    ]
    head = [f"# {key} = {files.toml(value)}" for key, value in keys.items()]
    end = draw(st.sampled_from(("\n", "\n", "\r\n", "\r")))
    text = end.join([*head, separator.join(columns), *rows, ""])
    codec = draw(st.sampled_from(("utf-8", "utf-8", "utf-8-sig", "utf-16", "latin-1")))
    file.write_bytes(text.encode(codec, errors="replace"))


def _hdf5(draw: Draw, file: Path, columns: Columns, keys: dict[str, object]) -> None:
    h5py = importlib.import_module("h5py")
    with h5py.File(file, "w", libver=draw(st.sampled_from(("earliest", "latest")))) as root:
        holder = root.require_group(draw(st.sampled_from(("/", "run", "run/deep"))))
        for name, values in columns.items():
            packed = draw(st.sampled_from(({}, {"compression": "gzip"}, {"chunks": True}, {"fillvalue": 3})))
            if np.ndim(values) == 0:
                packed = {}
            if draw(st.integers(0, 9)) == 0:
                data = holder.create_dataset(
                    name, shape=(draw(st.sampled_from((0, 9, 10**9))),), dtype="f8", chunks=(9,)
                )
            else:
                data = holder.create_dataset(name, data=values, **packed)
            few = draw(st.sampled_from((0, 0, 0, 2)))  # most of them are refused
            for key in draw(st.lists(st.sampled_from(ATTRIBUTES), max_size=few, unique=True)):
                data.attrs[key] = draw(st.sampled_from((0.1, 0.0, math.nan, "deg", "s", b"\xff", [1.0, 2.0], -1, True)))
        if draw(st.integers(0, 9)) == 0:
            link = draw(
                st.sampled_from((h5py.SoftLink("/"), h5py.ExternalLink("no.h5", "/"), h5py.SoftLink("/nowhere")))
            )
            holder["driving_angle_deg" if "driving_angle_deg" not in holder else "link"] = link
        holder.attrs.update(keys)


def _parquet(draw: Draw, file: Path, columns: Columns, keys: dict[str, object]) -> None:
    options = {
        "row_group_size": draw(st.sampled_from((1, 7, 1000))),
        "compression": draw(st.sampled_from(("snappy", "gzip", "zstd", "none"))),
        "use_dictionary": draw(st.booleans()),
        "version": draw(st.sampled_from(("1.0", "2.6"))),
        "data_page_version": draw(st.sampled_from(("1.0", "2.0"))),
    }
    files.write_parquet(file, columns, keys, **options)


def _tdms(draw: Draw, file: Path, columns: Columns, keys: dict[str, object]) -> None:
    nptdms = importlib.import_module("nptdms")
    start = np.datetime64("2026-01-01T00:00:00.000000")
    with nptdms.TdmsWriter(file) as writer:
        channels = []
        for name, values in columns.items():
            stated = {
                key: draw(st.sampled_from((0.02, 0.02, 0.5, 0.0, -1.0, math.nan, start, start + 300_000, "x", 3)))
                for key in draw(st.lists(st.sampled_from((*WAVEFORM, "unit_string")), max_size=3, unique=True))
            }
            channels.append(nptdms.ChannelObject("rig", name, np.asarray(values), stated))
        for _ in range(draw(st.sampled_from((1, 1, 3)))):
            writer.write_segment([nptdms.RootObject({}), nptdms.GroupObject("rig", keys), *channels])


def _uff(draw: Draw, file: Path, columns: Columns, keys: dict[str, object], *, binary: bool) -> None:
    files.write_uff(file, {n: np.asarray(v, dtype=float).reshape(-1) for n, v in columns.items()}, keys, binary=binary)
    if draw(st.booleans()):
        return
    data = file.read_bytes()
    number = draw(st.sampled_from((b"nan", b"inf", b"1e999", b"-1", b"1.00000e+00", b"0.1", b"x"))).rjust(13)
    at = draw(st.sampled_from([i for i in range(len(data)) if data.startswith(b"  0.00000e+00", i)] or [0]))
    data = data[:at] + number + data[at + 13 :]
    kind = draw(st.sampled_from((b"        17", b"         0", b"        -1")))
    file.write_bytes(
        data.replace(b"         0    0    0    0 NONE", kind + b"    0    0    0 NONE", draw(st.integers(0, 9)))
    )


def write(draw: Draw, name: str, folder: Path, columns: Columns, keys: dict[str, object]) -> Path:
    """A file of the format ``name`` with that in it; raises whatever its writer does where it cannot hold it."""
    file_name, _, writer = FORMATS[name]
    file = folder / file_name
    file.unlink(missing_ok=True)
    own: dict[str, Callable[..., None]] = {"csv": _csv, "parquet": _parquet, "tdms": _tdms, "hdf5 root": _hdf5}
    if name in own:
        own[name](draw, file, columns, keys)
    elif name.startswith("uff"):
        _uff(draw, file, columns, keys, binary="binary" in name)
    else:
        writer(file, columns, keys)
    return file


@st.composite
def damaged(draw: Draw, whole: bytes) -> bytes:
    """The bytes of a file, half of them whole, else with sizes, single bits or blocks changed, or cut off."""
    data = bytearray(whole)
    for _ in range(draw(st.sampled_from((0, 0, 0, 1, 1, 2, 4)))):
        if not data:
            break
        # Heads and directories lie at the ends.
        at = draw(st.integers(0, len(data) - 1) | st.integers(0, min(2500, len(data) - 1)))
        change = draw(st.sampled_from(("bit", "size", "offset", "block", "drop", "insert", "cut", "tail")))
        if change == "bit":
            data[at] ^= 1 << draw(st.integers(0, 7))
        elif change == "size":
            size = draw(st.sampled_from(SIZES))
            data[at : at + len(size)] = size
        elif change == "offset":
            data[at : at + 8] = draw(st.integers(0, len(data))).to_bytes(8, "little")
        elif change == "block":
            other = draw(st.integers(0, len(data) - 1))
            data[at : at + 32] = data[other : other + 32]
        elif change == "drop":
            del data[at : at + draw(st.integers(1, 40))]
        elif change == "insert":
            data[at:at] = draw(st.binary(min_size=1, max_size=12))
        elif change == "cut":
            del data[at:]
        else:
            data += draw(st.sampled_from((bytes(data[:200]), b"\0" * 500, b"    -1\n")))
    return bytes(data)


CELLS = ("nan", "inf", "-1e308", "1e999", "", "x", "0", "-5", "DROP", '"', "W", "9" * 400, "\x1b[2J")


WORDS = (
    "INFO: SET LOCK POSITION, new lock pos = 1.0, 2.0", "INFO: DITHER by 1e9, 0, new lock pos = 999999, -5",
    "INFO: Server received PAUSE", "INFO: LOCK SHIFT, enabled = 1", "Calibration Begins at now", "AO = x, xRate = 3",
    "Pixel scale = 0.5 arc-sec/px", "Dec = -89.0 deg",
)  # fmt: skip
"""Lines between the frames of a log."""


@st.composite
def guide_logs(draw: Draw) -> bytes:
    """A guide log with up to four lines wrong: a cell or a number of the header replaced, lines dropped, doubled, moved
    or put into one, sections begun anew, words between frames, decimal commas."""
    lines = made_log(frames=draw(st.sampled_from((3, 90))), lost=2, dithered=(1, 4.0))[0].splitlines()
    for _ in range(draw(st.integers(0, 4))):
        at = draw(st.integers(0, len(lines) - 1) | st.integers(0, min(9, len(lines) - 1)))
        change = draw(
            st.sampled_from(("cell", "number", "drop", "double", "move", "join", "section", "words", "comma"))
        )
        if change == "cell":
            cells = lines[at].split(",")
            cells[draw(st.integers(0, len(cells) - 1))] = draw(st.sampled_from(CELLS))
            lines[at] = ",".join(cells)
        elif change == "number":
            lines[at] = re.sub(r"-?\d+\.?\d*", lambda _: draw(st.sampled_from(CELLS)), lines[at], count=2)
        elif change == "drop" and len(lines) > 1:
            del lines[at]
        elif change == "double":
            lines[at:at] = [lines[at]] * draw(st.sampled_from((1, 100)))
        elif change == "move":
            lines.append(lines[at])
        elif change == "join":
            lines[at] = lines[at] * 60
        elif change == "words":
            lines.insert(at, draw(st.sampled_from(WORDS)))
        elif change == "comma":
            lines = [line.replace(".", ",") for line in lines]
        else:
            lines[at:at] = lines[: draw(st.integers(1, 9))]
    return draw(damaged("\n".join(lines).encode()))


HEADS = ("", "Prüfstand;3\n", "# torque_nm = 25.0\n", "Datum: 03.04.2026\n\n", "s;°;°;Nm\n", "1;2;3;4\n" * 9, '"\n')
SURE = ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Kraft [N]", "Temperatur", "Druck")
NAMES = (
    *SURE, "Winkel 1", "Drehmoment [Nm]", "angle_out (rad)", "t", "", "TE [arcsec]",
    "Drehzahl / 1/min", "Zähler Antrieb",
    "time_s", "driving_angle_deg", "x" * 300, '"', "[", "/", "(in)",
)  # fmt: skip
STAMPS = ("03/04/2026 10:00:{:02d}", "2026-04-03T10:00:{:02d}Z", "10:{:02d}", "99.99.9999", "{:d}/{:d}", "24:00:00 PM")


@st.composite
def foreign_texts(draw: Draw) -> bytes:
    """A table as loggers of several countries write it, with up to four lines or cells wrong, in any encoding."""
    columns = list(run(draw(st.sampled_from((3, 40, 300)))).values())[: draw(st.integers(1, 6))]
    separator = draw(st.sampled_from((";", ";", "\t", ",", " ", "|")))
    decimal = draw(st.sampled_from((",", ".")))
    number = draw(st.sampled_from(("{:.3f}", "{:.5f}", "{:,.1f}", "{:.0f}", "{:.4g}")))
    rows = [[number.format(v).replace(".", decimal) for v in row] for row in zip(*columns, strict=True)]
    if draw(st.integers(0, 3)) == 0:
        stamp = draw(st.sampled_from(STAMPS))
        rows = [[stamp.format(k % 60, k % 13), *row] for k, row in enumerate(rows)]
    names = [*SURE, ""][: len(rows[0])]
    if draw(st.booleans()):
        names = [draw(st.sampled_from(NAMES)) for _ in rows[0]]
    lines = [separator.join(row) for row in (names, *rows)]
    for _ in range(draw(st.integers(0, 4))):
        at = draw(st.integers(0, len(lines) - 1) | st.integers(0, min(4, len(lines) - 1)))
        change = draw(st.sampled_from(("cell", "drop", "double", "head", "again", "join")))
        if change == "cell":
            cells = lines[at].split(separator)
            cells[draw(st.integers(0, len(cells) - 1))] = draw(st.sampled_from((*CELLS, *NASTY[:8], "1.2.3", "1,2,3")))
            lines[at] = separator.join(cells)
        elif change == "drop" and len(lines) > 1:
            del lines[at]
        elif change == "double":
            lines[at:at] = [lines[at]] * draw(st.sampled_from((1, 50)))
        elif change == "head":
            lines[at:at] = draw(st.sampled_from(HEADS)).split("\n")
        elif change == "again":
            lines += lines[: draw(st.integers(1, len(lines)))]
        else:
            lines[at] = separator.join(lines)
    codec = draw(st.sampled_from(("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-32", "cp1252")))
    end = draw(st.sampled_from(("\n", "\r\n", "\r")))
    text = end.join([*lines, ""]).encode(codec, errors="replace")
    return draw(damaged(text)) if draw(st.booleans()) else text


ENTRIES = (
    'columns.driving_angle_deg = { from = "column 2", unit = "deg" }',
    'columns.driven_angle_deg = { from = "Winkel Abtrieb", unit = "rad", scale = 1e300 }',
    'columns.driven_angle_deg = { from = "column 3", unit = "rev", zero = -1e308, wraps = 1e-300 }',
    'columns.torque_nm = { from = "column 3", unit = "lbf.ft", sign = -1 }',
    'columns.time_s = { from = "column 1", unit = "ms", wraps = 3 }',
    'columns.driving_count = { from = "column 2" }\nkeys.driving_lines = 4\nkeys.driving_counts_per_line = 4',
    'text = { decimal = ",", thousands = "." }', 'text.separator = " "', 'text.encoding = "utf-16"',
    "text = { header_line = 2, units_line = 3 }", "section = 2", 'leave_out = ["column 1"]', 'keys.flank = "coast"',
    "keys.torque_nm = 1e999", "columns = 3", "text.encoding = \"idna\"", "text.header_line = 999999",
)  # fmt: skip


@st.composite
def maps(draw: Draw) -> bytes:
    """A map of some lines that may contradict one another, whole or damaged."""
    lines = draw(st.lists(st.sampled_from(ENTRIES), max_size=4))
    text = "\n".join(lines).encode()
    return draw(damaged(text)) if draw(st.integers(0, 3)) == 0 else text
