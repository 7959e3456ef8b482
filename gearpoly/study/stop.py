"""When it is enough: looks at a percentile after so many draws of every combination, and stops where it is known.

The looks come after a number of draws that the study fixes, not when workers happen to be done, so that one worker and
many stop at the same row.
"""

from __future__ import annotations

import math

from gearpoly.study.models import StudyFile, Until
from gearpoly.study.statistics import percentile
from gearpoly.study.store import Store, as_numbers

GROWTH = 1.2
"""Each look comes after a fifth more draws: at most a sixth of the work is past what was needed, and looking seldom
keeps the confidence close to what it says (looking often finds narrow intervals by chance)."""


def looks(file: StudyFile, combinations: int) -> list[int]:
    """Rows after which to look, none where the study has no ``[until]``."""
    if file.until is None:
        return []
    out, draws = [], file.until.at_least
    while draws < file.pairs:
        out.append(draws * combinations)
        draws = math.ceil(draws * GROWTH)
    return out


def enough(store: Store, until: Until, rows: int) -> bool:
    """Whether the first ``rows`` rows of every combination know the percentile to the width; a combination of which no
    pair runs is known well enough."""
    found = store.columns(["combination", "status", until.output], rows=rows)
    values, of = as_numbers(found[until.output]), found["combination"]
    good = (found["status"] == "done") & (values == values)
    for k in range(store.plan.design.combinations):
        mine = values[good & (of == k)]
        if mine.size and not percentile(mine, until.percentile, confidence=until.confidence).width <= until.width:
            return False
    return bool(good.any())
