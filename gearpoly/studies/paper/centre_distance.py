"""Five centre distances: what moves with them, and by how much exactly."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.gear.gear import inv
from gearpoly.mesh.pair import GearPair
from gearpoly.studies.paper.base import (
    PAPER_POSITIONS,
    PairRecipe,
    PaperAnswer,
    PaperRow,
    PaperStudy,
    Question,
    backlash,
    make_pair,
    peak_to_peak,
    verdict,
)
from gearpoly.studies.paper.picture import Line, Panel, PaperPicture
from gearpoly.units import DEG, UM, FloatArray

ERRORS = (0.0, 0.025, 0.05, 0.075, 0.1)
"""mm beyond tight mesh. The paper's five are lost; it says only that their steps are equal."""

LINEAR = 0.02
"""Share of a step by which equal steps of centre distance may give unequal steps here: inv is not linear, and bends by
1 % over 0.1 mm at a = 43 mm."""


def shift(pair: GearPair) -> float:
    """By how much a centre distance beyond tight mesh lowers TE, along the line of action in mm: (r_b1 + r_b2) (inv
    alpha' - inv alpha). Exact for involutes; derived here."""
    return (pair.r_b1 + pair.r_b2) * (inv(pair.alpha_w) - inv(math.acos((pair.r_b1 + pair.r_b2) / pair.a_w)))


def ask(study: PaperStudy) -> PaperAnswer:
    """Mean TE, TEpp and mean backlash of the first grade-4 set and of the ideal pair at all distances."""
    out: dict[str, list[tuple[float, float, float]]] = {"grade 4": [], "ideal": []}
    exact, curves = [], []
    for error in ERRORS:
        for name, seed in (("grade 4", 0), ("ideal", None)):
            pair = make_pair(PairRecipe(points=study.points, a_error=error), seed=seed)
            drive, j_bn = backlash(pair, PAPER_POSITIONS)
            te_um = drive.te * pair.r_b2 / UM
            out[name].append((float(np.mean(te_um)), peak_to_peak(drive.te), float(np.mean(j_bn)) / UM))
            if name == "grade 4":
                curves.append(te_um)
        exact.append(shift(pair) / UM)
    graded, ideal, theory = np.array(out["grade 4"]), np.array(out["ideal"]), np.array(exact)
    te_steps, j_steps = np.diff(graded[:, 0]), np.diff(graded[:, 2])
    worst = float(np.max(np.abs(ideal[:, 0] + theory)))
    worst_j = float(np.max(np.abs(ideal[:, 2] - 2.0 * theory)))
    off = float(np.max(np.abs(graded[:, 0] - graded[0, 0] + theory)))
    spread = float(np.ptp(graded[:, 1]))
    equal = bool(np.all(te_steps < 0.0)) and float(np.ptp(te_steps)) < 3.0 * LINEAR * abs(float(np.mean(te_steps)))
    rows = (
        PaperRow(
            what="centre distance: mean TE",
            paper="falls in equal steps",
            gearpoly="steps of " + ", ".join(f"{step:.2f}" for step in te_steps) + " um per 25 um",
            verdict=verdict(equal, bool(np.all(te_steps < 0.0))),
            why=(
                f"exactly -(r_b1 + r_b2)(inv alpha' - inv alpha): the ideal pair keeps it within {1e3 * worst:.2f} "
                f"nm, the error "
                f"gears within {off:.2f} um; 100 um give {theory[-1]:.2f} um, to first order 34.20 um"
            ),
        ),
        PaperRow(
            what="centre distance: mean backlash",
            paper="rises in equal steps",
            gearpoly="steps of " + ", ".join(f"{step:.2f}" for step in j_steps) + " um per 25 um",
            verdict=verdict(bool(np.all(j_steps > 0.0)) and np.ptp(j_steps) < 3.0 * LINEAR * np.mean(j_steps), True),
            why=f"twice the fall of TE, on the ideal pair within {1e3 * worst_j:.2f} nm",
        ),
        PaperRow(
            what="centre distance: TEpp",
            paper="unrelated",
            gearpoly=", ".join(f"{value:.4f}'" for value in graded[:, 1]),
            verdict=verdict(spread < 0.05 * float(np.mean(graded[:, 1])), spread < 0.2 * float(np.mean(graded[:, 1]))),
            why="involutes stay conjugate; only which scattered points meet changes",
        ),
    )
    picture = _picture(curves, graded, theory)
    return PaperAnswer(
        rows=rows,
        pictures=(picture,),
        text=(),
        values={"graded": graded, "ideal": ideal, "theory": theory},
    )


def _picture(curves: list[FloatArray], graded: FloatArray, theory: FloatArray) -> PaperPicture:
    """The curves at all distances, and their means beside the closed form."""
    angle = PAPER_POSITIONS / DEG
    um = np.array(ERRORS) / UM
    return PaperPicture(
        name="centre_distance",
        caption="First set of grade 4 at five centre distances: TE keeps its shape; means follow the closed form.",
        panels=(
            Panel(
                x="driven angle / deg",
                y="TE along the line of action / um",
                lines=tuple(
                    Line(x=angle, y=te, colour=k, label=f"+{um[k]:.0f} um", style="line") for k, te in enumerate(curves)
                ),
            ),
            Panel(
                x="centre distance beyond tight mesh / um",
                y="change of the mean / um",
                lines=(
                    Line(x=um, y=graded[:, 0] - graded[0, 0], style="dots", label="TE, grade 4"),
                    Line(x=um, y=-theory, style="dashed", label="-(r_b1 + r_b2)(inv alpha' - inv alpha)"),
                    Line(x=um, y=graded[:, 2] - graded[0, 2], colour=1, style="dots", label="backlash, grade 4"),
                    Line(x=um, y=2.0 * theory, colour=1, style="dashed", label="twice that"),
                ),
            ),
        ),
    )


QUESTION = Question(order=4, name="centre_distance", title="Five centre distances", ask=ask)
