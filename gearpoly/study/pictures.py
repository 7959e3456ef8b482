"""Pictures of a study: how each output is distributed, what drives it, and how many pairs keep a limit.

A picture is panels of one size. The page shows each as a drawing of its own, so that they stand beside one another on a
screen and below one another on a phone; ``figures`` puts them into one.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearpoly.report.plots import BLUE, GREY, ShownFigure
from gearpoly.report.study_plots import COLOURS
from gearpoly.study.answers import Answers
from gearpoly.study.groups import GroupSample
from gearpoly.study.labels import (
    LABEL_LINE_LETTERS,
    TITLE_LETTERS,
    UPRIGHT_LABEL_LETTERS,
    asked_words,
    axis_label,
    row_label,
)
from gearpoly.study.store import as_numbers
from gearpoly.study.words import factor_words, with_unit
from gearpoly.units import FloatArray

MOST_CURVES = 7
"""Groups drawn as curves of their own; more become ranges of percentiles."""

MOST_NAMED = 24
"""Combinations that an axis names; more only have a place in the order of the tables."""

MOST_CORNERS = 400
"""Corners of a drawn distribution: more than a page has pixels are of no use."""

PANEL_WIDTH = 4.6
"""Inches of a panel."""

LETTER = 0.15
"""Inches that one line of a name needs at 8 points, with the room above and below it."""

CLOUD = 1500
"""Dots in one picture of Sobol points."""


@dataclass(frozen=True, kw_only=True)
class StudyPicture:
    """``panels`` that draw into an axis each, of ``size`` (width, height) in inches; ``key`` says what colours are."""

    name: str
    caption: str
    panels: tuple[Callable[[Any], None], ...]
    size: tuple[float, float] = (PANEL_WIDTH, 2.9)
    columns: int = 3
    key: tuple[tuple[str, str], ...] = ()

    def figure(self) -> Figure:
        """All panels in one figure, and the key below them."""
        columns = min(self.columns, len(self.panels))
        rows = -(-len(self.panels) // columns)
        labels = [textwrap.fill(label, 80) for _, label in self.key]
        below = LETTER * sum(1 + label.count("\n") for label in labels)
        size = (max(self.size[0] * columns, 6.4), self.size[1] * rows + below)
        figure = ShownFigure(figsize=size, layout="constrained")
        axes = list(figure.subplots(rows, columns, squeeze=False).ravel())
        for axis in axes[len(self.panels) :]:
            axis.remove()
        for axis, panel in zip(axes, self.panels, strict=False):
            panel(axis)
        if self.key:
            handles = [Line2D([], [], color=colour, linewidth=3.0) for colour, _ in self.key]
            ncols = 1 if any(len(label) > LABEL_LINE_LETTERS for label in labels) else min(4, len(labels))
            figure.legend(handles, labels, loc="outside lower center", ncols=ncols, fontsize=8)
        return figure

    def drawn(self) -> list[Figure]:
        """Each panel in a figure of its own."""
        out = []
        for panel in self.panels:
            figure = Figure(figsize=self.size, layout="constrained")
            panel(figure.subplots())
            out.append(figure)
        return out


def pictures(answers: Answers) -> Iterator[StudyPicture]:
    """All that can be drawn of ``answers``."""
    names = [
        name for name in answers.store.plan.file.outputs if any(g.sample(name).values.size for g in answers.groups)
    ]
    for start in range(0, len(names), 6):
        yield _distributions(answers, names[start : start + 6], name=f"outputs_{start // 6 + 1}")
    if any(indices for _, indices in answers.sensitivity):
        yield _sensitivity(answers)
    if any(any(one.judged) for one in answers.yields):
        yield _yields(answers)
    if answers.store.plan.design.ranges:
        yield _points(answers)


def _grid(axis: Any) -> None:
    axis.grid(color=GREY, alpha=0.25, linewidth=0.5)


def _distributions(answers: Answers, names: list[str], *, name: str) -> StudyPicture:
    few = len(answers.groups) <= MOST_CURVES
    if few:
        return StudyPicture(
            name=name,
            caption="Share of pairs at or below a value, one curve per combination; dashed, its limit.",
            panels=tuple(partial(_curves, answers=answers, name=one) for one in names),
            key=tuple((COLOURS[k], g.words) for k, g in enumerate(answers.groups)) if len(answers.groups) > 1 else (),
        )
    x, over = _over(answers)
    return StudyPicture(
        name=name,
        caption="Median and range from the 5th to the 95th percentile of each combination; dashed, its limit.",
        panels=tuple(partial(_ranges, answers=answers, name=one, x=x, over=over) for one in names),
        size=(PANEL_WIDTH, 2.9 if over else max(2.9, 0.8 + _rows_height(answers))),
    )


def _bounds(answers: Answers, name: str) -> list[float]:
    """Limits of one output."""
    found = (one for one in answers.limits if one.output == name)
    return [bound for one in found for bound in (one.at_most, one.at_least) if bound is not None]


def _curves(axis: Any, *, answers: Answers, name: str) -> None:
    _grid(axis)
    for k, group in enumerate(answers.groups):
        values = group.sample(name).values
        if values.size:
            keep = np.unique(np.linspace(0, values.size - 1, min(values.size, MOST_CORNERS)).astype(int))
            axis.step(values[keep], (keep + 1) / values.size, where="post", color=COLOURS[k], linewidth=1.2)
    for bound in _bounds(answers, name):
        axis.axvline(bound, color=GREY, linewidth=1.2, linestyle="--")
    axis.set_xlabel(axis_label(name))
    axis.set_ylabel("share of pairs")
    axis.set_ylim(0.0, 1.0)


def _over(answers: Answers) -> tuple[FloatArray, str]:
    """What combinations are drawn over: the values of the one thing that is swept where these are numbers that rise;
    else their places, and no name."""
    plain = answers.store.plan.design.plain
    values = [group.values[plain[0].all_keys[0]] for group in answers.groups] if len(plain) == 1 else []
    if values and all(isinstance(v, int | float) for v in values) and np.all(np.diff(values) > 0):
        return np.array(values, dtype=np.float64), with_unit(plain[0])
    return np.arange(float(len(answers.groups))), ""


def _ranges(axis: Any, *, answers: Answers, name: str, x: FloatArray, over: str) -> None:
    _grid(axis)
    low, middle, high = _percentiles([group.sample(name) for group in answers.groups])
    if over:
        axis.fill_between(x, low, high, color=BLUE, alpha=0.25, linewidth=0.0)
        axis.plot(x, middle, color=BLUE, linewidth=1.2)
        axis.margins(x=0.0)
        axis.set_xlabel(over)
        axis.set_ylabel(axis_label(name, line=UPRIGHT_LABEL_LETTERS), fontsize=8)
    else:  # nothing lies between one combination and the next
        axis.errorbar(middle, x, xerr=[middle - low, high - middle], fmt="o", color=BLUE, markersize=3.0, capsize=2.0)
        axis.set_xlabel(axis_label(name))
        _name_rows(axis, answers)
    for bound in _bounds(answers, name):
        (axis.axhline if over else axis.axvline)(bound, color=GREY, linewidth=1.2, linestyle="--")


def _percentiles(samples: list[GroupSample]) -> tuple[FloatArray, ...]:
    """5th percentile, median and 95th of each sample; nan for an empty one."""
    known = [(s.values if s.values.size else [np.nan]) for s in samples]
    return tuple(np.array([np.quantile(values, q) for values in known]) for q in (0.05, 0.5, 0.95))


def _sensitivity(answers: Answers) -> StudyPicture:
    shown = [(name, indices) for name, indices in answers.sensitivity if indices]
    most = max(len(indices) for _, indices in shown)
    words = factor_words(answers.store.plan.file.sweep)
    return StudyPicture(
        name="sensitivity",
        caption="Sobol indices: full bars, what a factor makes on its own; pale bars, what it has a part in; lines, "
        "95 % intervals. Chance is what the grade leaves open.",
        panels=tuple(partial(_bars, name=name, indices=indices, words=words) for name, indices in shown),
        size=(PANEL_WIDTH, 1.3 + 0.42 * most),
    )


def _bars(axis: Any, *, name: str, indices: Any, words: Mapping[str, str]) -> None:
    _grid(axis)
    y = np.arange(len(indices))[::-1]
    for values, alpha, height in (([i.total for i in indices], 0.3, 0.7), ([i.first for i in indices], 1.0, 0.35)):
        middle = np.array([v.value for v in values])
        ends = np.array([[max(0.0, v.value - v.low), max(0.0, v.high - v.value)] for v in values]).T
        axis.barh(y, np.clip(middle, 0.0, None), height=height, color=BLUE, alpha=alpha)
        axis.errorbar(
            middle, y, xerr=ends, fmt="none", ecolor="#222222", elinewidth=0.8, capsize=2.0, alpha=max(alpha, 0.5)
        )
    axis.set_yticks(y, labels=[row_label(words.get(i.factor, i.factor)) for i in indices], fontsize=8)
    axis.set_xlim(0.0, max(1.05, max(i.total.value for i in indices) * 1.05))
    axis.set_xlabel("share of the variance")
    axis.set_title(axis_label(name, line=TITLE_LETTERS), loc="left", fontsize=9)


def _yields(answers: Answers) -> StudyPicture:
    judged = [one for one in answers.yields if any(one.judged)]
    return StudyPicture(
        name="yield",
        caption="Share of the drawn pairs that keep each limit, with its interval; dashed lines, the share that is "
        "asked. A combination of which no pair could be judged has no point.",
        panels=(partial(_kept, answers=answers),),
        size=(
            PANEL_WIDTH,
            max(2.2, 0.8 + max(_rows_height(answers), (0.1 + 0.14 * len(judged)) * len(answers.groups))),
        ),
        key=tuple((COLOURS[k % len(COLOURS)], asked_words(one)) for k, one in enumerate(judged)),
    )


def _kept(axis: Any, *, answers: Answers) -> None:
    _grid(axis)
    judged = [one for one in answers.yields if any(one.judged)]
    y = np.arange(len(answers.groups))
    apart = 0.7 / len(judged)  # of the way to the next combination
    for k, one in enumerate(judged):
        middle = np.array([found.value for found in one.shares])
        ends = np.array([[found.value - found.low, found.high - found.value] for found in one.shares]).T
        known = np.isfinite(middle)
        axis.errorbar(
            100.0 * middle[known], (y + apart * (k - 0.5 * (len(judged) - 1)))[known],
            xerr=100.0 * np.clip(ends[:, known], 0.0, None), fmt="o" if len(one.limits) == 1 else "D",
            color=COLOURS[k % len(COLOURS)], capsize=2.5, markersize=4.0,
        )  # fmt: skip
        axis.axvline(100.0 * one.share, color=COLOURS[k % len(COLOURS)], linewidth=1.0, linestyle=(4 * k, (4, 3)))
    axis.set_xlim(-4.0, 104.0)  # a point at 0 or 100 % is seen whole
    axis.set_xlabel("drawn pairs that keep it / %")
    _name_rows(axis, answers)


def _rows_height(answers: Answers) -> float:
    """Inches that the names of all combinations need below one another."""
    if len(answers.groups) > MOST_NAMED:
        return 0.08 * min(len(answers.groups), 60)
    lines = max(1 + row_label(group.words).count("\n") for group in answers.groups)
    return (LETTER * lines + 0.05) * len(answers.groups)


def _name_rows(axis: Any, answers: Answers) -> None:
    """Combinations from the top down, which stand at 0, 1, 2, ..., with their names where there are few."""
    axis.set_ylim(len(answers.groups) - 0.5, -0.5)
    if len(answers.groups) <= MOST_NAMED:
        labels = [row_label(group.words) for group in answers.groups]
        axis.set_yticks(range(len(labels)), labels=labels, fontsize=8)
    else:
        axis.set_ylabel("combination, in the order of the tables")


def _points(answers: Answers) -> StudyPicture:
    design = answers.store.plan.design
    names = list(answers.store.plan.file.outputs)[:3]
    sweeps = design.ranges[:4]
    columns = answers.store.columns(["status", *names, *(sweep.all_keys[0] for sweep in sweeps)])
    rows = np.flatnonzero(columns["status"] == "done")
    rows = rows[np.unique(np.linspace(0, rows.size - 1, min(rows.size, CLOUD)).astype(int))] if rows.size else rows

    def cloud(axis: Any, *, name: str, key: str, words: str) -> None:
        _grid(axis)
        axis.plot(
            as_numbers(columns[key])[rows], as_numbers(columns[name])[rows], ".", markersize=2.0, color=BLUE, alpha=0.5,
            rasterized=True,
        )  # fmt: skip
        axis.set_xlabel(words, fontsize=8)
        axis.set_ylabel(axis_label(name, line=UPRIGHT_LABEL_LETTERS), fontsize=7)

    return StudyPicture(
        name="points",
        caption="Every dot a pair: outputs over what the Sobol points vary.",
        panels=tuple(
            partial(cloud, name=name, key=one.all_keys[0], words=with_unit(one)) for name in names for one in sweeps
        ),
        size=(PANEL_WIDTH, 2.4),
        columns=len(sweeps),
    )
