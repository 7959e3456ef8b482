"""A plan of recordings as a picture: what each recording leaves alike, and what it shows."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from gearpoly.diagnose.alike import SHOWS
from gearpoly.diagnose.plan import TOLD_APART_SINE, Plan
from gearpoly.errors import shown
from gearpoly.report.plan_report import words
from gearpoly.report.plots import BLUE, GREEN, GREY, ORANGE, ShownFigure

ROW = 0.3
"""Height of a row in inches: names of 9 points with air between them."""

KEY = (
    "Below, a number is what recordings 1 to that number give: all of them in green beyond the border, in blue before."
)
"""How the picture is read, in its last line above it."""

LINE_LENGTH = 110
"""Characters of a line above the picture."""


def plan_figure(plan: Plan) -> ShownFigure:
    """Look-alikes by the sine of the angle between them and hidden physics by their size, each with every number of
    recordings; above, which recordings these are."""
    alike = [(words(f"{one.one} and {one.other}"), (one.first, *one.after)) for one in plan.look_alikes]
    hidden = [(words(one.physics), (one.first, *one.after)) for one in plan.hidden]
    says = [
        textwrap.fill(f"{number}. {one.says}", LINE_LENGTH, subsequent_indent="    ")
        for number, one in enumerate((plan.first, *plan.further), 1)
    ]
    lines = 2 + sum(one.count("\n") + 1 for one in says)
    rows = [max(1, len(part)) + 2.5 for part in (alike, hidden)]
    figure = ShownFigure(figsize=(11.0, 0.4 + 0.2 * lines + ROW * sum(rows)), layout="constrained")
    axes: Any = figure.subplots(2, 1, height_ratios=rows)
    figure.suptitle("\n".join([shown(plan.name), *says, KEY]), ha="left", x=0.01, fontsize=9)
    _rows(axes[0], alike, border=TOLD_APART_SINE)
    axes[0].set_xlim(-0.02, 1.02)
    axes[0].set_xlabel(f"sine of the angle between two physics, told apart from {TOLD_APART_SINE:g}")
    _rows(axes[1], hidden, border=SHOWS)
    axes[1].set_xscale("symlog", linthresh=SHOWS)  # what is hidden may be none of it or a hundred times the border
    most = max((value for _, values in hidden for value in values), default=SHOWS)
    axes[1].set_xlim(-0.1 * SHOWS, 1.5 * max(most, SHOWS))
    axes[1].set_xlabel(f"standard deviations of an ordinary fault, shown from {SHOWS:g}")
    return figure


def _rows(axis: Any, rows: Sequence[tuple[str, Sequence[float | None]]], *, border: float) -> None:
    """A row per name: what each number of recordings gives, from the first to all of them, beside the ``border``."""
    axis.axvline(border, color=ORANGE, linewidth=1.0)
    for k, (_, values) in enumerate(rows):
        seen = [(number, value) for number, value in enumerate(values, 1) if value is not None]
        if not seen:
            continue
        ends = [value for _, value in seen]
        axis.plot((min(ends), max(ends)), (k, k), color=GREY, linewidth=0.8, zorder=1)
        for number, value in seen:
            last = number == len(values)
            colour = GREY if not last else GREEN if value >= border else BLUE
            axis.plot(value, k, "o", color=colour, markersize=10, zorder=2 + number)
            axis.text(value, k, str(number), color="white", fontsize=7, ha="center", va="center_baseline",
                      zorder=2.5 + number)  # fmt: skip
    axis.set_yticks(range(len(rows)), [name for name, _ in rows], fontsize=9)
    axis.set_ylim(max(len(rows), 1) - 0.4, -0.6)
    axis.grid(axis="x", color=GREY, alpha=0.25, linewidth=0.5)
    if not rows:
        axis.text(0.5, 0.5, "none", transform=axis.transAxes, ha="center", color=GREY)
