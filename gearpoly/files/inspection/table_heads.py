"""What the heads of an inspection table say: quantity, flank and unit of each column, in five languages."""

from __future__ import annotations

import re

from gearpoly.files.gde import Side
from gearpoly.files.inspection.klingelnberg_text import SIDE_WORDS

FLANK_WORDS: dict[str, Side] = {
    **SIDE_WORDS,
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

LENGTH_UNITS_UM = {
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

VALUES = ("", "wert", "werte", "messwert", "value", "values", "abweichung", "deviation", "valeur", "valor", "valore")
"""Heads that name no quantity: that of the block's title is meant."""

UNIT = re.compile(r"[\[(]\s*(.*?)\s*[\])]")


def meaning_of(head: str) -> tuple[str, Side | None]:
    """What a head holds ("" where it says nothing known), and of which side."""
    text = re.sub(r"[\[(].*?[\])]", " ", head[:HEAD_LIMIT]).strip(" .:")
    words = [word for word in re.split(r"[\s_./-]+", text) if word]
    side = next((FLANK_WORDS[word.lower()] for word in words if word.lower() in FLANK_WORDS), None)
    plain = " ".join(word for word in re.split(r"\s+", text) if word.lower().strip(".,") not in FLANK_WORDS)
    plain = re.sub(r"_(left|right|links|rechts)$", "", plain, flags=re.IGNORECASE)
    if side is not None:
        plain = re.sub(r"^(flanke|flank|flanc)\s+(?=\S)", "", plain, flags=re.IGNORECASE)
    for meaning, pattern in HEADS:
        cased = meaning in ("single_pitch", "cumulative_pitch") and "_?p" in pattern
        if re.match(pattern, plain, 0 if cased else re.IGNORECASE):
            return meaning, side
    return ("not taken", side) if NOT_TAKEN.match(plain) else ("", side)


def length_of(text: str) -> float | None:
    """The size in um of a unit of length, or of a multiple of one (0.0001 in); ``None`` where it is none."""
    many = re.fullmatch(r"(\d{0,6}(?:[.,]\d{1,9})?)\s*(\D+)", text.strip().lower())
    if many is None or many[2].strip() not in LENGTH_UNITS_UM:
        return None
    size = LENGTH_UNITS_UM[many[2].strip()] * (float(many[1].replace(",", ".")) if many[1] else 1.0)
    return size if size > 0.0 else None
