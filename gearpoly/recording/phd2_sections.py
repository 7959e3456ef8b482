"""The guiding sections of a PHD2 guide log, line by line: headers, frames, pulses, and where the camera was aimed.

Sources of the layout: the wiki of PHD2 ("PHD2 Guide Log Format"), logs of PHD2 2.0 to 2.6, of the ASIAIR and of KStars,
which writes the same. A section that cannot be used keeps its fault, since another one of the log may be good.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.deeds import in_full

GUIDE_LOG_LINE_LIMIT = 10_000
"""Characters of a line; rows have fewer than 300."""

PER_MS = 0.1
"""px per unit of time below which a guide rate is in px/ms: a guide camera sees 0.3 to 30 px/s, 0.0003 to 0.03 px/ms.
Some logs state one, some the other, none says which."""

GUIDE_LOG_COLUMNS = ("Frame", "Time", "mount", "RARawDistance", "RADuration", "RADirection")

DECIMALS = (
    "Time", "dx", "dy", "RARawDistance", "DECRawDistance", "RAGuideDistance", "DECGuideDistance", "SNR",
)  # fmt: skip
"""Columns with a decimal point, which some logs write as the comma that also parts the columns."""

STAR_SEEN_CODES = (0, 1)
"""Error codes of frames that show the star: none, and saturated. By others it is lost, weak or another one."""

LOG_NUMBER_PATTERN = r"([+-]?\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)"

SENSES = {"W": 1.0, "WEST": 1.0, "E": -1.0, "EAST": -1.0}
"""Directions of pulses along the right ascension; a pulse to the west takes the star back that the axis lets fall."""


@dataclass(frozen=True)
class Frame:
    """One frame: ``time`` in s, offset of the star along the camera's axes ``x``, ``y`` and along the right ascension
    ``offset`` in px (nan where it is not stated, or the star was lost), pulse sent after it in s, W positive, and the
    number of the lock position that it was aimed at."""

    time: float
    x: float
    y: float
    offset: float
    pulse: float
    aim: int


@dataclass
class GuidingSection:
    """One guiding section: its ``number`` from 1 and ``line`` in the log, when it ``began``, what its header states,
    its ``frames``, the lock positions ``aims`` in px, how often it was ``dithered`` and ``paused``, whether the lock
    position was ``shifted`` along unseen, whether its numbers have decimal ``commas``, and its ``fault``, if any."""

    number: int
    line: int
    began: str
    header: dict[str, float] = field(default_factory=dict)
    frames: list[Frame] = field(default_factory=list)
    aims: list[tuple[float, float] | None] = field(default_factory=lambda: [None])
    dithered: int = 0
    paused: int = 0
    shifted: bool = False
    commas: bool = False
    fault: InputFileError | None = None

    @property
    def seconds(self) -> float:
        """How long it lasts, in s."""
        return self.frames[-1].time - self.frames[0].time if self.frames else 0.0

    @property
    def pulsed(self) -> bool:
        """Whether any pulse was sent along the right ascension."""
        return any(frame.pulse != 0.0 for frame in self.frames)


@dataclass(frozen=True)
class Log:
    """A whole log: its guiding sections in order, and how many calibrations it holds."""

    sections: tuple[GuidingSection, ...]
    calibrations: int


def read_log(file: Path, lines: Iterator[str]) -> Log:
    """All sections of a log; the last may be cut off. Raises ``InputFileError`` for lines that no log has."""
    found: list[GuidingSection] = []
    calibrations = 0
    open_: GuidingSection | None = None
    names: list[str] = []
    for number, line in enumerate(_short(file, lines), start=1):
        begins = re.match(r"(Guiding|Calibration) Begins at (.*)", line)
        if begins or line.startswith("Guiding Ends"):
            open_, names = None, []
            if begins and begins[1] == "Guiding":
                open_ = GuidingSection(number=len(found) + 1, line=number, began=shorten(begins[2].strip()))
                found.append(open_)
            calibrations += bool(begins and begins[1] == "Calibration")
        elif open_ is None or open_.fault is not None:
            continue
        elif line.startswith("Frame,"):
            names = line.strip().split(",")
            if missing := [name for name in GUIDE_LOG_COLUMNS if name not in names]:
                wish = "want a log of PHD2 2.0 or later"
                open_.fault = _fault(file, number, f"no column {' and no '.join(missing)}", wish)
        elif re.match(r'"?Frame"?[;\t]', line):
            wish = "want the log as PHD2 wrote it: a spreadsheet saved this one again; or save it with commas between "
            wish += "the columns, and points in the numbers"
            marks = "tabs" if "\t" in line else "semicolons"
            open_.fault = _fault(file, number, f"columns parted by {marks}", wish)
        elif line[:1].isdigit() and names:
            _take_frame(file, number, names, line, open_)
        else:
            _take_words(line, open_)
    return Log(sections=tuple(found), calibrations=calibrations)


def _short(file: Path, lines: Iterator[str]) -> Iterator[str]:
    for number, line in enumerate(lines, start=1):
        if len(line) > GUIDE_LOG_LINE_LIMIT:
            raise _fault(file, number, f"more than {GUIDE_LOG_LINE_LIMIT} characters", "want a guide log with lines")
        yield line


def _fault(file: Path, number: int, found: str, wish: str) -> InputFileError:
    return InputFileError(file, where=f"line {number}", found=found, wish=wish)


def _take_words(line: str, section: GuidingSection) -> None:
    """What a line of the header, or one between frames, says."""
    if not section.frames:
        section.header = {**dict(_header(line)), **section.header}
    aimed = re.search(rf"(?:Lock position|new lock pos) = {LOG_NUMBER_PATTERN}, {LOG_NUMBER_PATTERN}", line)
    if aimed:
        section.aims.append((_number(aimed[1]), _number(aimed[2])))
    if not line.startswith("INFO:"):
        return
    section.dithered += line.startswith("INFO: DITHER")
    section.paused += bool(re.search(r"\b(?:SET_)?PAUSED?\b", line)) and "UNPAUSED" not in line
    section.shifted |= bool(re.search(r"LOCK SHIFT, enabled = 1", line))


def _header(line: str) -> Iterator[tuple[str, float]]:
    """What a header line states: px in arcsec, px per s or ms, the camera's angle and the declination in deg."""
    for key, words in (
        ("scale", rf"^Pixel scale = {LOG_NUMBER_PATTERN}"),
        ("rate", rf"^Mount\b.*xRate = {LOG_NUMBER_PATTERN}"),
        ("angle", rf"^Mount\b.*xAngle = {LOG_NUMBER_PATTERN}"),
        ("declination", rf"(?:^|, )Dec = {LOG_NUMBER_PATTERN} deg"),
    ):
        if found := re.search(words, line):
            yield key, _number(found[1])


def _number(text: str) -> float:
    return float(text.replace(",", "."))


def _take_frame(file: Path, number: int, names: list[str], line: str, section: GuidingSection) -> None:
    """Put the frame of a line into its ``section``; a row that was cut off is left out."""
    cells = _cells(names, line, section)
    broken = not line.endswith("\n") and len(cells) < len(names)
    if broken or not all(name in cells for name in GUIDE_LOG_COLUMNS):
        return
    if cells["mount"] == "AO":
        wish = "want a log without adaptive optics, which moves the star where no gear does"
        section.fault = _fault(file, number, 'frames of mount "AO"', wish)
        return
    values = {}
    for name, absent in (("Time", ""), ("dx", "nan"), ("dy", "nan"), ("RARawDistance", "nan"), ("RADuration", "0")):
        text = cells.get(name) or absent
        try:
            values[name] = float(text)
        except ValueError:
            wish = "want a number; delete the line if it is torn"
            section.fault = _fault(file, number, f"{name} = {shorten(text)}", wish)
            return
    time, pulse = values["Time"], values["RADuration"]
    if not (math.isfinite(time) and math.isfinite(pulse)) or any(map(math.isinf, values.values())):
        found = ", ".join(f"{name} = {in_full(value)}" for name, value in values.items())
        section.fault = _fault(file, number, found, "want finite numbers")
        return
    if section.frames and time == section.frames[-1].time:
        return  # a row that was written twice
    if section.frames and time < section.frames[-1].time:
        wish = "want times that rise; the clock was set while it guided: cut the log there, and begin it with a header"
        section.fault = _fault(file, number, f"Time = {in_full(time)} after {in_full(section.frames[-1].time)}", wish)
        return
    seen = cells["mount"] != "DROP" and cells.get("ErrorCode", "0").strip() in ("", *map(str, STAR_SEEN_CODES))
    x, y, offset = (values[name] if seen else math.nan for name in ("dx", "dy", "RARawDistance"))
    way = cells["RADirection"].strip()
    sense = SENSES.get(way.upper(), 0.0)
    if pulse < 0.0 or (pulse > 0.0 and not sense):  # left out, a pulse would be read as motion of the axis
        found = f"RADuration = {in_full(pulse)} with RADirection = {shorten(way) or 'nothing'}"
        wish = "want durations of 0 ms or more, with W or E; write them so, or delete the line if it is torn"
        section.fault = _fault(file, number, found, wish)
        return
    aim = len(section.aims) - 1
    section.frames.append(Frame(time, x, y, offset, sense * pulse / 1000.0, aim))


def _cells(names: list[str], line: str, section: GuidingSection) -> Mapping[str, str]:
    """The cells of a row by column. Where a computer writes decimal commas, a number takes two of them."""
    try:
        cells = next(csv.reader([line.strip()]))
    except csv.Error:
        return {}
    # A time has three decimals, so without a point in it the next cell holds them.
    section.commas |= len(cells) > 2 and "." not in cells[1] and re.fullmatch(r"\d{3}", cells[2]) is not None
    if section.commas:
        cells = list(_joined(names, cells))
    return dict(zip(names, cells, strict=False))


def _joined(names: list[str], cells: list[str]) -> Iterator[str]:
    waiting = iter(cells)
    for name in names:
        cell = next(waiting, None)
        if cell is None:
            return
        if name in DECIMALS and cell:
            decimals = next(waiting, None)
            if decimals is None:
                return
            cell = f"{cell}.{decimals}"
        yield cell
