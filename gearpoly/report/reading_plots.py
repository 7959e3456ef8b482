"""A small picture of what a recording's file holds: every column over time, with gaps, stops and turns marked."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gearpoly.errors import shown
from gearpoly.files.traces import shorten
from gearpoly.recording.survey import Seen, Survey
from gearpoly.report.plots import BLUE, GREY, ORANGE, ShownFigure, save

COLUMNS_DRAWN = 8
"""Columns that are drawn; a picture of more is not small."""

CURVE_POINTS = 4000
"""Points of a curve, each pair of which keeps the least and the largest reading of its stretch."""


def plot_surveys(surveys: Sequence[Survey], *, target: Path) -> None:
    """Write ``surveys_figure`` to ``target``."""
    save(surveys_figure(surveys), target)


def surveys_figure(surveys: Sequence[Survey]) -> Figure:
    """Every recording beside the next."""
    drawn = [[one for one in found.channels if one.span is not None and not _is_axis(found, one)] for found in surveys]
    drawn = [channels[:COLUMNS_DRAWN] for channels in drawn]
    rows = max(1, max(len(channels) for channels in drawn))
    figure = ShownFigure(figsize=(1.5 + 6.5 * len(surveys), 1.2 + 1.35 * rows), layout="constrained")
    axes: Any = figure.subplots(rows, len(surveys), squeeze=False)
    for column, (found, channels) in enumerate(zip(surveys, drawn, strict=True)):
        for row in range(rows):
            if row < len(channels):
                _channel(axes[row][column], found, channels[row])
            else:
                axes[row][column].set_axis_off()
        which = f", recording {found.number} of {found.of}" if found.of > 1 else ""
        title = f"{shown(found.file.name)}{which}: {found.rows} samples{_marks(found)}"
        axes[0][column].set_title(title, loc="left", fontsize=9)
        _runs(axes[0][column], found)
        last = axes[max(len(channels) - 1, 0)][column]
        last.set_xlabel("time / s" if found.time is not None else "row")
    return figure


def _channel(axis: Any, found: Survey, one: Seen) -> None:
    x = np.arange(1, one.values.size + 1, dtype=np.float64)
    if found.time is not None and found.time.size == one.values.size:
        x = found.time
    gaps = found.clock.gaps if found.clock is not None and x is found.time else ()
    keep = _thinned(one.values)
    for part in np.split(keep, np.searchsorted(keep, [row for row, _ in gaps])):
        axis.plot(x[part], one.values[part], color=BLUE if one.sure else GREY, linewidth=0.7)
    taken = f"\n{one.column}{'' if one.sure else '?'}" if one.column else ""
    axis.set_ylabel(f"{shorten(one.name, width=24)}{taken}", fontsize=7, rotation=0, ha="right", va="center")
    if one.turning is not None:
        for first, last in one.turning.stops:
            axis.axvspan(x[first - 1], x[last - 1], color=ORANGE, alpha=0.25, linewidth=0)
        for row in one.turning.reversals:
            axis.axvline(x[row - 1], color=ORANGE, linewidth=0.8)
    for row, wide in gaps:
        axis.axvspan(x[row - 1], x[row - 1] + wide, color=GREY, alpha=0.25, linewidth=0)
    axis.tick_params(labelsize=7)
    axis.margins(x=0.0)
    axis.grid(color=GREY, alpha=0.25, linewidth=0.5)
    axis.ticklabel_format(useOffset=False, axis="y")


def _runs(axis: Any, found: Survey) -> None:
    """The number and the flank of every run forth and back, over its rows."""
    for run in found.runs:
        first, last = (row - 1 for row in run.run.rows)
        begin, end = (first + 1, last + 1) if found.time is None else (found.time[first], found.time[last])
        words = f"{run.run.number}" if run.short else f"run {run.run.number}: {run.flank}"
        axis.text(
            0.5 * (begin + end), 0.94, words, transform=axis.get_xaxis_transform(), ha="center", va="top", fontsize=7,
            bbox={"facecolor": "white", "edgecolor": GREY, "linewidth": 0.5, "alpha": 0.85, "pad": 1.5},
        )  # fmt: skip


def _is_axis(found: Survey, one: Seen) -> bool:
    """Whether a channel is the time over which the others are drawn."""
    return found.time is not None and one.column == "time_s"


def _marks(found: Survey) -> str:
    """What the marks in the picture mean, where there are any."""
    turnings = [one.turning for one in found.channels if one.turning is not None]
    words = [
        *(["grey band: no samples"] if found.clock is not None and found.clock.gaps else []),
        *(["orange band: stop"] if any(one.stops for one in turnings) else []),
        *(["orange line: reversal"] if any(one.reversals for one in turnings) else []),
        *(["grey curve: in doubt or not taken"] if not all(one.sure for one in found.channels) else []),
    ]
    return f"\n{', '.join(words)}" if words else ""


def _thinned(values: np.ndarray[Any, np.dtype[np.float64]]) -> np.ndarray[Any, np.dtype[np.int64]]:
    """The samples of a curve of few points that looks as the whole one does."""
    size = values.size
    if size <= CURVE_POINTS:
        return np.arange(size)
    edges = np.linspace(0, size, CURVE_POINTS // 2 + 1).astype(np.int64)
    keep = []
    for first, end in itertools.pairwise(edges):
        part = values[first:end]
        if np.isfinite(part).any():
            keep += sorted((first + int(np.nanargmin(part)), first + int(np.nanargmax(part))))
        else:
            keep.append(int(first))
    return np.array(keep)
