"""Guide logs of PHD2: what a star shows of the gears that turn a telescope's right-ascension axis.

A row holds how far the star stood off, and the pulse that was then sent to bring it back. The error that the mount
would have had unguided is what is left of the star's offset once all pulses before it, and every re-aiming of the
camera, are undone.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import check_file, shorten, unreadable
from gearpoly.recording.reader import RECORDING_LIMIT_BYTES, Reader
from gearpoly.recording.table import AXIS_CORRECTION, AXIS_ERROR, Table

LINE_LIMIT = 10_000
"""Characters of a line; rows have fewer than 300."""

PER_MS = 0.1
"""px per unit of time below which a guide rate is in px/ms: a guide camera sees 0.3 to 30 px/s, 0.0003 to 0.03 px/ms.
Some logs state one, some the other, none says which."""

POLE_DEG = 85.0
"""Declination in deg from which a star's motion says nothing of the axis: the cosine of the declination, by which it is
divided, is then wrong by more than a tenth for half a degree."""

LEAST_ROWS = 64
"""Rows of a section below which it is none: calibrations and trials have a few dozen."""

COLUMNS = ("Frame", "Time", "mount", "RARawDistance", "RADuration", "RADirection")


@dataclass(frozen=True, kw_only=True)
class Section:
    """One guiding section: its ``header`` by key, and for every frame its ``line``, time in s, offset of the star and
    pulse before the next frame (W positive) with the sums of lock positions, in px; nan where the star was lost."""

    line: int
    began: str
    header: Mapping[str, float] = field(default_factory=dict)
    rows: tuple[tuple[float, float, float, float], ...] = ()


def recognises(head: bytes) -> bool:
    """Whether a file's first bytes are those of a guide log."""
    return b"Guiding Begins at" in head or head.lstrip(b"\xef\xbb\xbf").startswith(b"PHD2 version")


def read_table(file: Path) -> Table:
    """Time, error and pulses of the longest guiding section of a log, in s and arcsec of the right-ascension axis; the
    error is positive where the axis is ahead. Raises ``InputFileError`` with the line at fault."""
    check_file(file, limit_bytes=RECORDING_LIMIT_BYTES)
    try:
        with file.open(encoding="utf-8-sig", errors="replace") as stream:
            found = [one for one in sections(file, stream) if len(one.rows) >= LEAST_ROWS]
    except OSError as error:
        raise unreadable(file, error) from None
    if not found:
        wish = f'want a section "Guiding Begins at ..." with at least {LEAST_ROWS} frames'
        raise InputFileError(file, found="a guide log without guiding", wish=wish)
    longest = max(found, key=lambda one: one.rows[-1][0])
    remarks = []
    if len(found) > 1:
        remarks.append(
            f"the log holds {len(found)} guiding sections; the longest was read, begun at {longest.began} "
            f"(line {longest.line})"
        )
    return _table(file, longest, remarks)


def _table(file: Path, section: Section, remarks: list[str]) -> Table:
    where = f"section of line {section.line}"
    known = section.header
    for key, says in (("scale", "Pixel scale"), ("rate", "xRate")):
        if not known.get(key, 0.0) > 0.0:
            wish = f"want {says} = a number above 0, without which pixels are no angle"
            raise InputFileError(file, where=where, found=f"no {says}", wish=wish)
    declination = known.get("declination")
    if declination is None:
        remarks.append("the log does not state the declination: errors are taken as on the equator, and may be larger")
        declination = 0.0
    if abs(declination) > POLE_DEG:
        wish = f"want a star within {POLE_DEG:g} deg of the equator; beyond, the axis hardly moves it"
        raise InputFileError(file, where=where, found=f"a declination of {declination:g} deg", wish=wish)
    time, offset, pulses, lock = np.array(section.rows).T
    lost = int(np.sum(np.isnan(offset)))
    if lost:
        remarks.append(f"{lost} frames without a star left out")
    rate = known["rate"] * (1000.0 if known["rate"] < PER_MS else 1.0)
    sent = rate * np.concatenate(([0.0], np.cumsum(pulses)[:-1]))
    arcsec = known["scale"] / math.cos(math.radians(declination))
    aimed = int(np.sum(np.diff(lock) != 0.0))
    if aimed:
        remarks.append(f"the camera was re-aimed {aimed} times, which is undone")
    remarks.append(f"guide log: {arcsec:.4g} arcsec of the axis per pixel, pulses of {rate:.4g} px/s undone")
    return Table(
        # A star that needs a pulse to the west has run ahead of the axis.
        columns={"time_s": time, AXIS_ERROR: -arcsec * (offset + sent + lock), AXIS_CORRECTION: arcsec * sent},
        keys={},
        remarks=remarks,
    )


def sections(file: Path, lines: Iterator[str]) -> Iterator[Section]:
    """The guiding sections of a log; the last may be cut off."""
    open_: Section | None = None
    header: dict[str, float] = {}
    rows: list[tuple[float, float, float, float]] = []
    names: list[str] = []
    lock: tuple[float, float] | None = None
    moved = 0.0
    for number, line in enumerate(_short(file, lines), start=1):
        begins = re.match(r"(Guiding|Calibration) Begins at (.*)", line)
        if begins or line.startswith("Guiding Ends"):
            if open_ is not None:
                yield replace(open_, header=header, rows=tuple(rows))
            open_, header, rows, names, lock, moved = None, {}, [], [], None, 0.0
            if begins and begins[1] == "Guiding":
                open_ = Section(line=number, began=shorten(begins[2].strip()))
        elif open_ is not None and line.startswith("Frame,"):
            names = line.strip().split(",")
            if missing := [name for name in COLUMNS if name not in names]:
                found = f"no column {' and no '.join(missing)}"
                raise InputFileError(file, where=f"line {number}", found=found, wish="want a log of PHD2 2.0 or later")
        elif open_ is not None and line[:1].isdigit() and names:
            if row := _row(file, number, names, line):
                rows.append((*row, moved))
        elif open_ is not None:
            header = {**dict(_header(line)), **header}
            aimed = re.search(r"(?:Lock position|new lock pos) = (-?[\d.]+), (-?[\d.]+)", line)
            if aimed:
                there = float(aimed[1]), float(aimed[2])
                moved += _along(there, lock, header.get("angle", 0.0))
                lock = there
    if open_ is not None:
        yield replace(open_, header=header, rows=tuple(rows))


def _short(file: Path, lines: Iterator[str]) -> Iterator[str]:
    for number, line in enumerate(lines, start=1):
        if len(line) > LINE_LIMIT:
            found = f"more than {LINE_LIMIT} characters"
            raise InputFileError(file, where=f"line {number}", found=found, wish="want a guide log with lines")
        yield line


def _header(line: str) -> Iterator[tuple[str, float]]:
    """What a header line states: px in arcsec, px per s or ms, the camera's angle and the declination in deg."""
    number = r"(-?\d+(?:\.\d+)?)"
    for key, words in (
        ("scale", rf"^Pixel scale = {number}"),
        ("rate", rf"^Mount = .*xRate = {number}"),
        ("angle", rf"^Mount = .*xAngle = {number}"),
        ("declination", rf"(?:^|, )Dec = {number} deg"),
    ):
        if found := re.search(words, line):
            yield key, float(found[1])


def _along(there: tuple[float, float], lock: tuple[float, float] | None, angle: float) -> float:
    """Motion in px of the lock position along the right ascension, whose direction on the camera is ``angle`` deg."""
    if lock is None:
        return 0.0
    x, y = there[0] - lock[0], there[1] - lock[1]
    return x * math.cos(math.radians(angle)) + y * math.sin(math.radians(angle))


def _row(file: Path, number: int, names: list[str], line: str) -> tuple[float, float, float] | None:
    """Time in s, offset in px and pulse in s (W positive) of one frame; None where a log was cut off within a row."""
    try:
        cells = dict(zip(names, next(csv.reader([line])), strict=False))
    except csv.Error:
        cells = {}
    if not all(name in cells for name in COLUMNS):
        return None
    where = f"line {number}"
    if cells["mount"] == "AO":
        wish = "want a log without adaptive optics, which moves the star where no gear does"
        raise InputFileError(file, where=where, found='frames of mount "AO"', wish=wish)
    values = []
    for name in ("Time", "RARawDistance", "RADuration"):
        text = cells[name] or ("nan" if name == "RARawDistance" else "0")
        try:
            values.append(float(text))
        except ValueError:
            found = f"{name} = {shorten(text)}"
            raise InputFileError(file, where=where, found=found, wish="want a number") from None
    time, offset, duration = values
    if not (math.isfinite(time) and math.isfinite(duration)) or math.isinf(offset):
        found = f"Time = {time:g}, RADuration = {duration:g}"
        raise InputFileError(file, where=where, found=found, wish="want finite numbers")
    sense = {"W": 1.0, "E": -1.0}.get(cells["RADirection"], 0.0)
    return time, offset, sense * duration / 1000.0


READER = Reader(name="PHD2 guide log", endings=(".txt", ".log"), recognises=recognises, read=read_table)
