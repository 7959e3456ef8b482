"""The paper study's figures: draws what ``picture`` describes, in the palette of ``plots``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearpoly.report.plots import BLUE, GREEN, GREY, ORANGE, save
from gearpoly.studies.paper.picture import Line, Panel, PaperPicture

COLOURS = (BLUE, ORANGE, GREEN, "#CC79A7", "#444444", "#E69F00", "#56B4E9")
"""Okabe and Ito's, with a dark grey for references."""

PANEL_WIDTH_INCHES, PANEL_HEIGHT_INCHES = 6.2, 4.2
"""Inches of one panel."""


def draw_picture(picture: PaperPicture, target: Path) -> None:
    """Write ``picture`` to ``target`` (png, svg or pdf), whole or not at all."""
    n = len(picture.panels)
    # Three beside one another are made narrower, so that their letters stay readable on a page.
    width = PANEL_WIDTH_INCHES * (max(1.6, n) if n < 3 else 0.75 * n)
    size = (2.0 * PANEL_WIDTH_INCHES, 0.7 * PANEL_HEIGHT_INCHES * n) if picture.tall else (width, PANEL_HEIGHT_INCHES)
    figure = Figure(figsize=size, layout="constrained")
    rows, columns = (n, 1) if picture.tall else (1, n)
    axes = figure.subplots(rows, columns, squeeze=False, sharex="col").ravel()
    for axis, panel in zip(axes, picture.panels, strict=True):
        _draw_panel(axis, panel)
    save(figure, target, colours=128)


def _draw_panel(axis: Axes, panel: Panel) -> None:
    for line in panel.lines:
        _draw_line(axis, line)
    axis.set_xlabel(panel.x)
    axis.set_ylabel(panel.y)
    axis.set_title(panel.title, loc="left", fontsize=10)
    axis.grid(color=GREY, alpha=0.25, linewidth=0.5)
    if panel.log:
        axis.set_yscale("log")
    else:
        # Offsets like 1e-5 + 3.2 hide the size that a reader looks for.
        axis.ticklabel_format(useOffset=False, axis="y")
    if panel.ticks:
        axis.set_xticks(range(len(panel.ticks)), labels=panel.ticks, fontsize=8)
    elif all(line.style in ("line", "thin") for line in panel.lines):
        axis.margins(x=0.0)
    if any(line.label for line in panel.lines):
        axis.legend(fontsize=8, framealpha=0.85)


def _draw_line(axis: Axes, line: Line) -> None:
    x, y = np.asarray(line.x, dtype=np.float64), np.asarray(line.y, dtype=np.float64)
    colour = COLOURS[line.colour % len(COLOURS)]
    label = line.label or None
    if line.style == "dots":
        axis.plot(x, y, linestyle="none", marker="o", markersize=4.0, color=colour, alpha=0.7, label=label)
    elif line.style == "joined":
        axis.plot(x, y, marker="o", markersize=3.5, linewidth=1.4, color=colour, label=label)
    elif line.style == "dashed":
        axis.plot(x, y, linestyle="--", linewidth=1.2, color=colour, label=label)
    else:
        thin = line.style == "thin"
        axis.plot(x, y, linewidth=0.6 if thin else 1.0, alpha=0.5 if thin else 1.0, color=colour, label=label)
