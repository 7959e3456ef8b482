"""Titles of the blocks of an inspection table: which flank, or which quantity, the rows below are of."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from gearpoly.files.gde import Side
from gearpoly.files.inspection.table_heads import FLANK_WORDS, HEAD_LIMIT, SIGNED, meaning_of

NAMES_A_FLANK = frozenset({
    "flanke", "flanken", "zahnflanke", "zahnflanken", "flank", "flanks", "flanc", "flanco", "fianco",
})  # fmt: skip

ABOUT = NAMES_A_FLANK | {
    "tooth", "teeth", "zahn", "seite", "side", "lado", "lato", "dente", "teilung", "teilungen", "teilungsmessung",
    "profil", "profile", "pitch", "messung", "measurement", "measurements", "abweichung", "abweichungen", "deviation",
    "deviations", "auswertung", "ergebnis", "ergebnisse", "result", "results", "tabelle", "table", "block", "werte",
    "values", "data", "daten", "of", "the", "der", "die", "des", "and", "und", "in",
}  # fmt: skip
"""Words that may stand beside that of a flank in a title. A line that has others is of something else: the sense of
rotation, the hand of a helix, a name."""

LONGEST_TITLE_WORDS = 12
"""Words of a title; longer lines are sentences."""


@dataclass(frozen=True, kw_only=True)
class Title:
    """What a title says of the rows below: their ``side`` and ``meaning``, ``None`` and "" where it does not."""

    side: Side | None = None
    meaning: str = ""


def title_of(cells: Sequence[str]) -> Title | None:
    """What a line says as the title of a block; ``None`` where it is none. A title has no numbers and one flank."""
    text = " ".join(cell for cell in cells if cell)[:HEAD_LIMIT]
    bare = re.sub(r"[\[(].*?[\])]", " ", text)
    words = [word for word in re.split(r"[\s_./:;,=|-]+", bare.lower()) if word]
    if not words or len(words) > LONGEST_TITLE_WORDS or re.search(r"\d", bare):
        return None
    sides = {FLANK_WORDS[word] for word in words if word in FLANK_WORDS}
    # A letter alone is a flank only beside the word: "R. Meier" is none.
    if (
        len(sides) == 1
        and all(len(word) <= 2 for word in words if word in FLANK_WORDS)
        and not NAMES_A_FLANK & set(words)
    ):
        sides = set()
    meaning = _quantity(bare)
    if len(sides) == 1:
        if meaning or all(word in FLANK_WORDS or word in ABOUT for word in words):
            return Title(side=next(iter(sides)), meaning=meaning)
        return None
    return Title(meaning=meaning) if meaning and not sides else None


def _quantity(text: str) -> str:
    """The quantity that a title names, anywhere in it."""
    words = text.replace(",", " ").replace(":", " ").split()
    for k in range(len(words)):
        meaning = meaning_of(" ".join(words[k:]))[0]
        if meaning in SIGNED or meaning == "tooth_thickness":
            return meaning
    return ""


def together(titles: Iterable[Title | None]) -> Title | None:
    """What several titles say one below the other; ``None`` where none of them says anything."""
    side: Side | None = None
    meaning = ""
    for one in titles:
        if one is not None:
            side, meaning = one.side or side, one.meaning or meaning
    return Title(side=side, meaning=meaning) if side or meaning else None
