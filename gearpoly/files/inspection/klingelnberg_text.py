"""The lines of Klingelnberg's ``.mka`` (curves) and ``.mew`` (values) exports: header, curves, tables, results.

Grammar only; what a value means is :mod:`.klingelnberg`'s. Written from what public readers of such files know of them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from gearpoly.errors import InputFileError, shown
from gearpoly.files.gde import Side
from gearpoly.files.inspection.text import any_text
from gearpoly.files.traces import TRACE_LINE_LIMIT

NOT_MEASURED, NOT_AVAILABLE = -9999.0, 8999.0
"""Results that stand for none."""

UNDEFINED = -2147483.648
"""Curve value of a point without reading, unless the header names another."""

MOST_CURVE_POINTS = 100_000
"""Points of one curve; machines write 480."""

LABEL_LIMIT = 200
"""Characters of a label that are looked at; theirs have 70."""

FIELDS_LIMIT = 10_000
"""Lines ``label: value`` of a header, all of which are searched for each quantity; machines write 432 at most."""

SIDE_WORDS: dict[str, Side] = {
    "links": "left", "linke": "left", "left": "left", "l": "left",
    "rechts": "right", "rechte": "right", "right": "right", "r": "right",
}  # fmt: skip

PREAMBLE = ("TYPE", "VERSION", "SEPARATOR", "UNITS", "ANGLE", "PROFILE", "LANGUAGE", "UNDEFINED", "FILTER")
"""Keys of the lines ``KEY value ! comment`` at the top."""

_HEADER = re.compile(r"HEADER\s+KS\.(MK|MW)\.FILE\b")
_CURVE = re.compile(
    r"(?:(?P<title>[^\W\d_]+)\s*:\s*)?(?:Zahn-?\s?Nr|Tooth[- ]?No)\.?\s*:?\s*(?P<tooth>\d{1,6})\s*(?P<letter>[a-z]?)\s*"
    r"(?P<twist>/\s*[^\W\d_]+\s*:\s*\d+\s*)?(?P<side>links|rechts|left|right)\s*/\s*(?P<count>\d{1,9})\s*"
    r"(?:Werte|values|points)\s*/?\s*(?P<axis>[xzd])\s*=\s*(?P<place>[-+.,\d]+)",
    re.IGNORECASE,
)
_TABLE = re.compile(r"(linke|rechte|left|right)\s+(?:Zahnflanke|tooth flank|flank)\s*:?", re.IGNORECASE)
_PROBES = re.compile(r"(?:Teilung|Pitch)\s*:", re.IGNORECASE)
_TITLE = re.compile(r"([^\W\d_]+)\s*:")
_NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eEdD][-+]?\d{1,3})?")
_FIELD = re.compile(r"(?:\d{1,3}\s*:)?(?P<label>[^:]*[^\W\d_][^:]*):(?P<value>.*)")


@dataclass(frozen=True, kw_only=True)
class Field:
    """One line ``label....: value`` of the header: label without its dots, value as printed, line from 1."""

    label: str
    value: str
    line: int

    def numbers(self) -> tuple[float, ...]:
        """The numbers of the value, in order; words are passed over."""
        found = (number(token) for token in self.value.replace(":", " ").split())
        return tuple(value for value in found if value is not None)


@dataclass(frozen=True, kw_only=True)
class SheetCurve:
    """One trace: ``kind`` "profile" or "other", tooth from 1, ``letter`` of a further trace, axial ``place`` in mm;
    values in um, nan where the machine has none."""

    kind: Literal["profile", "other"]
    tooth: int
    letter: str
    side: Side
    place: float
    values: tuple[float, ...]
    line: int


@dataclass(frozen=True, kw_only=True)
class PitchTable:
    """The pitch table of one side: column names and, by tooth, their values in um."""

    side: Side
    names: tuple[str, ...]
    rows: dict[int, tuple[float, ...]]
    line: int


@dataclass(frozen=True, kw_only=True)
class Probe:
    """Where one flank was touched: table angle in deg, x and y in mm."""

    tooth: int
    side: Side
    phi: float
    x: float
    y: float


@dataclass(kw_only=True)
class Export:
    """All that stands in one file. ``unread`` are lines that fit no rule."""

    file: Path
    kind: Literal["curves", "values"]
    preamble: dict[str, str] = field(default_factory=dict)
    fields: list[Field] = field(default_factory=list)
    curves: list[SheetCurve] = field(default_factory=list)
    tables: list[PitchTable] = field(default_factory=list)
    probes: list[Probe] = field(default_factory=list)
    results: list[Field] = field(default_factory=list)
    unread: list[int] = field(default_factory=list)


def number(token: str) -> float | None:
    """The number that ``token`` is, with a decimal point or comma, or None."""
    if len(token) > 40 or not _NUMBER.fullmatch(token):
        return None
    value = float(re.sub("[dD]", "e", token.replace(",", ".")))
    return value if math.isfinite(value) else None


def is_export(start: bytes) -> bool:
    """Whether a file that begins with these bytes calls itself an export."""
    return bool(re.match(rb"(?:\xef\xbb\xbf)?\s*HEADER\s+KS\.M[KW]\.FILE\b", start))


def read_export(file: Path) -> Export:
    """The parts of an export. Raises ``InputFileError`` with the line for a curve or a table that is cut off."""
    lines = any_text(file).splitlines()
    head = _HEADER.match(lines[0].strip()) if lines else None
    if head is None:
        wish = "want HEADER KS.MK.FILE (curves, .mka) or HEADER KS.MW.FILE (values, .mew)"
        raise InputFileError(file, where="line 1", found=f'"{shown(lines[0] if lines else "")}"', wish=wish)
    out = Export(file=file, kind="curves" if head[1] == "MK" else "values")
    _Lines(out, lines).read()
    return out


class _Lines:
    """One pass over the lines of an export."""

    def __init__(self, out: Export, lines: list[str]) -> None:
        self.out, self.lines, self.at, self.title = out, lines, 1, ""

    def read(self) -> None:
        while self.at < len(self.lines):
            line = self.lines[self.at].strip()
            self.at += 1
            if len(line) > TRACE_LINE_LIMIT:
                raise self.fault(f"{len(line)} characters", f"want lines of at most {TRACE_LINE_LIMIT}")
            if line and not self.block(line) and not self.plain(line):
                self.out.unread.append(self.at)

    def block(self, line: str) -> bool:
        """Read a curve, a table or a result that begins with ``line``."""
        if curve := _CURVE.fullmatch(line):
            self.curve(curve)
        elif table := _TABLE.fullmatch(line):
            self.table(SIDE_WORDS[table[1].lower()])
        elif _PROBES.fullmatch(line) and self.probe_head():
            self.probes()
        elif result := _result(line):
            self.out.results.append(Field(label=_label(result[0]), value=result[1], line=self.at))
        elif title := _TITLE.fullmatch(line):
            self.title = title[1].lower()
        else:
            return False
        return True

    def plain(self, line: str) -> bool:
        """Read a line of the header, or numbers below one."""
        key, _, rest = line.partition("!")[0].strip().partition(" ")
        if key.rstrip(":") in PREAMBLE:
            self.out.preamble[key.rstrip(":")] = rest.strip()
            return True
        # Without a colon the pattern would try every letter of a long line in vain.
        if ":" in line and (found := _FIELD.fullmatch(line)):
            if len(self.out.fields) == FIELDS_LIMIT:
                raise self.fault("a header without end", f"want at most {FIELDS_LIMIT} lines of it; export it again")
            self.out.fields.append(Field(label=_label(found["label"]), value=found["value"].strip(), line=self.at))
            self.title = ""
            return True
        # Below a line of the header (tip and root diameters) there may be a row of numbers.
        return not self.title and all(number(token) is not None for token in line.split())

    def fault(self, found: str, wish: str) -> InputFileError:
        return InputFileError(self.out.file, where=f"line {self.at}", found=found, wish=wish)

    def curve(self, head: re.Match[str]) -> None:
        line, count = self.at, int(head["count"])
        if not 1 <= count <= MOST_CURVE_POINTS:
            raise self.fault(f"a curve of {count} values", f"want 1 to {MOST_CURVE_POINTS}")
        values: list[float] = []
        undefined = number(self.out.preamble.get("UNDEFINED", "")) or UNDEFINED
        while len(values) < count:
            tokens = [number(token) for token in self.peek().split()]
            if not tokens or any(token is None for token in tokens):
                wish = "want as many numbers as its head says; the file may be cut off: export it again"
                self.at = line
                raise self.fault(f"a curve of {len(values)} values, and its head says {count}", wish)
            self.at += 1
            # The sign of "no reading" is the largest number that the format prints, rounded at will.
            values += [math.nan if v is None or v <= undefined + 1.0 else v for v in tokens]
        if len(values) > count:
            raise self.fault(f"a curve of {len(values)} values, and its head says {count}", "export the file again")
        title = (head["title"] or self.title).lower()
        kind: Literal["profile", "other"] = (
            "profile"
            if title in ("profil", "profile") and not head["twist"] and head["axis"].lower() == "z"
            else "other"
        )
        self.out.curves.append(
            SheetCurve(
                kind=kind,
                tooth=int(head["tooth"]),
                letter=head["letter"],
                side=SIDE_WORDS[head["side"].lower()],
                place=number(head["place"]) or 0.0,
                values=tuple(values),
                line=line,
            )
        )

    def peek(self) -> str:
        """The next line that holds something, or "" at the end."""
        while self.at < len(self.lines) and not self.lines[self.at].strip():
            self.at += 1
        return self.lines[self.at].strip() if self.at < len(self.lines) else ""

    def table(self, side: Side) -> None:
        names = self.peek().split()
        begin = next((k for k, name in enumerate(names) if name in ("fp", "Fp")), None)
        if begin is None:
            self.at += 1
            raise self.fault(f'"{shown(" ".join(names))}" below the title of a pitch table', "want Zahn-Nr. fp Fp Fr")
        self.at += 1
        table = PitchTable(side=side, names=tuple(names[begin:]), rows={}, line=self.at)
        lines: dict[int, int] = {}
        for first, values in self.rows(len(names) - begin):
            if first in table.rows:
                found = f"tooth {first} twice in a pitch table, first in line {lines[first]}"
                raise self.fault(found, "want each tooth once")
            table.rows[first], lines[first] = tuple(values), self.at
        if not table.rows:
            raise self.fault("a pitch table without rows", "want a row per tooth; export the file again")
        self.out.tables.append(table)

    def rows(self, width: int) -> Iterator[tuple[int, list[float]]]:
        """Rows of a tooth number and ``width`` numbers, up to the first line that is none."""
        while True:
            tokens = self.peek().split()
            values = [number(token) for token in tokens]
            if len(tokens) != width + 1 or not tokens[0].isdecimal() or len(tokens[0]) > 6:
                return
            self.at += 1
            if any(value is None for value in values):
                raise self.fault(f'"{shown(" ".join(tokens))}" in a pitch table', "want numbers")
            yield int(tokens[0]), [value for value in values[1:] if value is not None]

    def probe_head(self) -> bool:
        return "PHI" in self.peek().split()

    def probes(self) -> None:
        self.at += 1
        while True:
            tokens = self.peek().split()
            if len(tokens) != 6 or not tokens[0].isdecimal() or tokens[1].lower() not in SIDE_WORDS:
                return
            self.at += 1
            phi, x, y = (number(token) for token in tokens[2:5])
            if phi is None or x is None or y is None or len(tokens[0]) > 6:
                raise self.fault(f'"{shown(" ".join(tokens))}" among the probed points', "want numbers")
            self.out.probes.append(Probe(tooth=int(tokens[0]), side=SIDE_WORDS[tokens[1].lower()], phi=phi, x=x, y=y))


def _result(line: str) -> tuple[str, str] | None:
    """Label and value of a line ``12345 : label : value``, or None."""
    code, _, rest = line.partition(":")
    label, colon, value = rest.rpartition(":")
    if not colon or len(code.strip()) != 5 or not code.strip().isdecimal() or len(value.split()) != 1:
        return None
    return label, value.strip()


def _label(text: str) -> str:
    """A label without the dots that lead to its value, as far as labels go."""
    return " ".join(re.sub(r"\.{2,}", " ", text[:LABEL_LIMIT]).strip(" .").split())
