"""What the heads of an inspection table say: quantity, flank and unit of each column, in five languages or by a map."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

from gearpoly.errors import InputFileError, shown
from gearpoly.files.gde import Side
from gearpoly.files.inspection.klingelnberg_text import SIDE
from gearpoly.files.inspection.measured import SIDES
from gearpoly.files.inspection.sheet_map import Meaning, SheetMap

FLANKS: dict[str, Side] = {
    **SIDE,
    **dict.fromkeys(("lh", "lf", "li", "linker", "gauche", "izquierda", "izquierdo", "sinistra", "sinistro"), "left"),
    **dict.fromkeys(("rh", "rf", "re", "rechter", "droite", "derecha", "derecho", "destra", "destro"), "right"),
}  # fmt: skip
"""Words for a flank."""

HEADS = (
    ("tooth", r"(z(ahn|\W)?-?\s?(nr|no|nummer)\.?|zahn|tooth\s?(no\.?|number|#|pair)?|zahnpaar|z|dent|diente|dente)$"),
    ("flank", r"(flanke|flank|flanc|flanco|fianco|seite|side)$"),
    ("single_pitch", r"(f_?p|f_?pt|f_?pn)\b"),
    ("cumulative_pitch", r"(F_?p|F_?pn)\b"),
    ("single_pitch", r"(einzelteilung|teilungs-?einzel|single pitch|adjacent pitch|pitch var|spacing)"),
    ("cumulative_pitch", r"(teilungs-?summen|summenteilung|gesamtteilung|cumulative pitch|index)"),
    ("profile_slope", r"(f_?H(a|alpha|\u03b1)\b|profilwinkel|profile slope)"),
    ("profile_crowning", r"(C_?(a|alpha|\u03b1)\b|profilballigkeit|profile crown)"),
    ("tooth_thickness", r"(E_?sn?\b|zahndicken?abma|tooth thickness dev)"),
)
"""What a head means by how it begins; f_p and F_p differ by their case alone."""

NOT_TAKEN = re.compile(
    r"(f_?f|F_?|f_?H|C_?)(b|beta|\u03b2)\b|(f_?f|F_?)(a|alpha|\u03b1)\b|(F_?r|R_?s|f_?u|F_?pk|F_?pz\S*)(?![a-z])"
)
"""Quantities of ISO 1328 that a pair file has no place for: forms, totals, leads, runout."""

LENGTHS = {
    **dict.fromkeys(("um", "\u00b5m", "\u03bcm", "mum", "micron", "microns"), 1.0),
    **dict.fromkeys(("in", "inch", "inches", "zoll", '"', "''", "\u2033"), 25_400.0),
    **dict.fromkeys(("mil", "mils", "thou"), 25.4),
    "mm": 1e3,
    "nm": 1e-3,
    "m": 1e6,
}
"""Size in um of each unit of length; an inch is 25.4 mm (1959)."""

HEAD_LIMIT = 200
"""Characters of a head that are looked at: each costs time as the square of them."""

SIGNED = ("single_pitch", "cumulative_pitch", "profile_slope", "profile_crowning")

_UNIT = re.compile(r"[\[(]\s*(.*?)\s*[\])]")

WORDS = ", ".join(get_args(Meaning))


@dataclass(frozen=True, kw_only=True)
class Heads:
    """By column: what it holds ("ignored": nothing that is taken) and of which flank, and its size in um. ``unstated``
    are the heads of deviations without a unit."""

    meanings: list[tuple[str, Side | None]]
    factors: list[float]
    unstated: list[str]
    says: list[str]


def meaning_of(head: str) -> tuple[str, Side | None]:
    """What a head holds ("" where it says nothing known), and of which side."""
    text = re.sub(r"[\[(].*?[\])]", " ", head[:HEAD_LIMIT]).strip(" .:")
    words = [word for word in re.split(r"[\s_./-]+", text) if word]
    side = next((FLANKS[word.lower()] for word in words if word.lower() in FLANKS), None)
    plain = " ".join(word for word in re.split(r"\s+", text) if word.lower().strip(".,") not in FLANKS)
    plain = re.sub(r"_(left|right|links|rechts)$", "", plain, flags=re.IGNORECASE)
    if side is not None:
        plain = re.sub(r"^(flanke|flank|flanc)\s+(?=\S)", "", plain, flags=re.IGNORECASE)
    for meaning, pattern in HEADS:
        cased = meaning in ("single_pitch", "cumulative_pitch") and "_?p" in pattern
        if re.match(pattern, plain, 0 if cased else re.IGNORECASE):
            return meaning, side
    return ("not taken", side) if NOT_TAKEN.match(plain) else ("", side)


def stated(column: str) -> tuple[str, Side | None]:
    """What a map says that a column holds, and of which side."""
    stem, _, tail = column.rpartition("_")
    return (stem, SIDE[tail]) if tail in SIDES else (column, None)


def by_map(layout: SheetMap, head: str, k: int) -> str | None:
    """What a map says of the column of that head and number from 1; the number tells heads of one name apart."""
    return layout.columns.get(f"column {k}", layout.columns.get(head))


def heads_of(file: Path, line: int, heads: Sequence[str], units: Sequence[str], layout: SheetMap) -> Heads:
    """What each column holds by its head in that line, by the ``units`` below, or by the map.

    Raises ``InputFileError`` where a head says nothing known, stands twice, or has no length for a unit.
    """
    meanings: list[tuple[str, Side | None]] = []
    factors, unstated, says = [], [], []
    named = {stated(one) for k, head in enumerate(heads, start=1) if (one := by_map(layout, head, k)) is not None}
    flanks = ("flank", None) in named or any(meaning_of(head)[0] == "flank" for head in heads)
    for k, head in enumerate(heads, start=1):
        given = by_map(layout, head, k)
        meaning, side = stated(given) if given is not None else meaning_of(head)
        # A map speaks of the columns that it names; what it leaves out may go unread, but is not doubled.
        open_ = not meaning or (meaning, side) in named or (meaning in SIGNED and side is None and not flanks)
        if given is None and layout.columns and open_:
            meaning, side = "ignored", None
        if meaning == "not taken":
            says.append(f'"{shown(head)}" is not taken: a pair file has no place for it')
            meaning, side = "ignored", None
        where = f"line {line}, column {k}"
        if not meaning:
            wish = f'say in a file that --map names what it holds: [columns] "{shown(head)}" = "ignored", or {WORDS}'
            raise InputFileError(file, where=where, found=f'"{shown(head)}"', wish=wish)
        if (meaning, side) in meanings and meaning != "ignored":
            wish = (
                'want each once; state [columns] in a file that --map names, and "ignored" for the others; '
                f'"column {k}" = "{meaning}_right" names one by its number'
            )
            raise InputFileError(file, where=where, found=f'"{shown(head)}" again', wish=wish)
        factor = 1.0
        if meaning not in ("tooth", "flank", "ignored"):
            written = _UNIT.search(head[:HEAD_LIMIT])
            text = written[1] if written is not None else units[k - 1]
            factor = _factor(file, where, text or layout.unit or "")
            if not (text or layout.unit):
                unstated.append(head)
        factors.append(factor)
        meanings.append((meaning, side))
    found = [meaning for meaning, _ in meanings]
    if "tooth" not in found:
        wish = '[columns] in the map wants "NAME" = "tooth"'
        raise InputFileError(file, where=f"line {line}", found="no column of teeth", wish=wish)
    sided = [side for meaning, side in meanings if meaning in SIGNED]
    if "flank" not in found and None in sided:
        head = next(h for h, (meaning, side) in zip(heads, meanings, strict=True) if meaning in SIGNED and not side)
        wish = "want left or right in its name, or a column of flanks; or say it in a file that --map names"
        raise InputFileError(file, where=f"line {line}", found=f'"{shown(head)}" of which flank', wish=wish)
    return Heads(meanings=meanings, factors=factors, unstated=unstated, says=says)


def length_of(text: str) -> float | None:
    """The size in um of a unit of length, or of a multiple of one (0.0001 in); ``None`` where it is none."""
    many = re.fullmatch(r"(\d{0,6}(?:[.,]\d{1,9})?)\s*(\D+)", text.strip().lower())
    if many is None or many[2].strip() not in LENGTHS:
        return None
    size = LENGTHS[many[2].strip()] * (float(many[1].replace(",", ".")) if many[1] else 1.0)
    return size if size > 0.0 else None


def _factor(file: Path, where: str, text: str) -> float:
    """The size in um of a deviation in the unit ``text``, um where none is stated."""
    size = length_of(text) if text else 1.0
    if size is None:
        wish = "want a length: um, mm, nm, m, in, mil (an angle in rad times the radius is one)"
        raise InputFileError(file, where=where, found=f'unit "{shown(text)}"', wish=wish)
    return size
