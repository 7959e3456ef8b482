"""Pictures of a study: how each output is distributed, what drives it, and how many pairs keep a limit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gearpoly.report.plots import BLUE, GREEN, GREY, ORANGE, save
from gearpoly.study.answers import Answers, Sample, words
from gearpoly.study.outputs import output
from gearpoly.study.store import as_numbers

COLOURS = (BLUE, ORANGE, GREEN, "#CC79A7", "#444444", "#E69F00", "#56B4E9")
"""Okabe and Ito's, with a dark grey."""

CURVES = 7
"""Groups drawn as curves of their own; more become bands of percentiles over the groups."""

STEPS = 400
"""Corners of a drawn distribution: more than a page has pixels are of no use."""

CLOUD = 1500
"""Dots in one picture of Sobol points."""


def draw_all(answers: Answers, folder: Path) -> list[tuple[Path, str]]:
    """Write every picture of ``answers`` as SVG into ``folder``; returns files and captions."""
    out = []
    for name, figure, caption in _figures(answers):
        target = folder / f"{name}.svg"
        save(figure, target)
        out.append((target, caption))
    return out


def _figures(answers: Answers) -> Iterator[tuple[str, Figure, str]]:
    names = [
        name for name in answers.store.plan.file.outputs if any(g.sample(name).values.size for g in answers.groups)
    ]
    for start in range(0, len(names), 6):
        part = names[start : start + 6]
        few = len(answers.groups) <= CURVES
        caption = (
            "Share of pairs at or below a value, one curve per combination."
            if few
            else "Median and the band from the 5th to the 95th percentile of each combination."
        )
        yield f"outputs_{start // 6 + 1}", _distributions(answers, part, few=few), caption
    if any(indices for _, indices in answers.sensitivity):
        yield (
            "sensitivity",
            _sensitivity(answers),
            "Sobol indices: full bars, what a factor makes on its own; pale bars, what it has a part in; lines, 95 % "
            "intervals. Chance is what the grade leaves open.",
        )
    for k, one in enumerate(answers.yields):
        yield (
            f"yield_{k + 1}",
            _yields(answers, k),
            f"Share of pairs with {words(one.limit)}; the line is what is asked.",
        )
    if answers.store.plan.design.ranges:
        yield "points", _points(answers), "Every dot a pair: outputs over what the Sobol points vary."


def _grid(count: int, *, columns: int = 3, height: float = 2.9) -> tuple[Figure, list[Any]]:
    columns = min(columns, count)
    rows = -(-count // columns)
    figure = Figure(figsize=(max(4.6 * columns, 6.4), height * rows), layout="constrained")
    axes = list(figure.subplots(rows, columns, squeeze=False).ravel())
    for axis in axes[count:]:
        axis.remove()
    for axis in axes[:count]:
        axis.grid(color=GREY, alpha=0.25, linewidth=0.5)
    return figure, axes[:count]


def axis_label(name: str) -> str:
    """An output's name with its unit."""
    unit = output(name).unit
    bare = name.removesuffix(f"_{unit}") if unit.isalpha() else name
    return f"{bare} / {unit}" if unit else name


def _distributions(answers: Answers, names: list[str], *, few: bool) -> Figure:
    figure, axes = _grid(len(names))
    for axis, name in zip(axes, names, strict=True):
        samples = [group.sample(name) for group in answers.groups]
        if few:
            for k, sample in enumerate(samples):
                _curve(axis, sample, COLOURS[k], answers.groups[k].label)
            axis.set_xlabel(axis_label(name))
            axis.set_ylabel("share of pairs")
            axis.set_ylim(0.0, 1.0)
        else:
            _bands(axis, samples)
            axis.set_ylabel(axis_label(name))
            axis.set_xlabel("combination")
    if few and len(answers.groups) > 1:
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(4, len(labels)), fontsize=8)
    return figure


def _curve(axis: Any, sample: Sample, colour: str, label: str) -> None:
    n = sample.values.size
    if not n:
        return
    keep = np.unique(np.linspace(0, n - 1, min(n, STEPS)).astype(int))
    axis.step(sample.values[keep], (keep + 1) / n, where="post", color=colour, linewidth=1.2, label=label)


def _bands(axis: Any, samples: list[Sample]) -> None:
    x = np.arange(len(samples))
    low, middle, high = (
        np.array([np.quantile(s.values, q) if s.values.size else np.nan for s in samples]) for q in (0.05, 0.5, 0.95)
    )
    axis.fill_between(x, low, high, color=BLUE, alpha=0.25, linewidth=0.0)
    axis.plot(x, middle, color=BLUE, linewidth=1.2)
    axis.margins(x=0.0)


def _sensitivity(answers: Answers) -> Figure:
    shown = [(name, indices) for name, indices in answers.sensitivity if indices]
    figure, axes = _grid(len(shown), height=0.9 + 0.42 * max(len(indices) for _, indices in shown))
    for axis, (name, indices) in zip(axes, shown, strict=True):
        y = np.arange(len(indices))[::-1]
        for values, alpha, height in (([i.total for i in indices], 0.3, 0.7), ([i.first for i in indices], 1.0, 0.35)):
            middle = np.array([v.value for v in values])
            ends = np.array([[max(0.0, v.value - v.low), max(0.0, v.high - v.value)] for v in values]).T
            axis.barh(y, np.clip(middle, 0.0, None), height=height, color=BLUE, alpha=alpha)
            axis.errorbar(
                middle, y, xerr=ends, fmt="none", ecolor="#222222", elinewidth=0.8, capsize=2.0, alpha=max(alpha, 0.5)
            )
        axis.set_yticks(y, labels=[i.factor for i in indices], fontsize=8)
        axis.set_xlim(0.0, max(1.05, max(i.total.value for i in indices) * 1.05))
        axis.set_title(name, loc="left", fontsize=9)
    return figure


def _yields(answers: Answers, which: int) -> Figure:
    found = answers.yields[which]
    figure, (axis,) = _grid(1, height=3.2)
    x = np.arange(len(found.shares))
    middle = np.array([one.value for one in found.shares])
    ends = np.array([[one.value - one.low, one.high - one.value] for one in found.shares]).T
    axis.errorbar(
        x, 100.0 * middle, yerr=100.0 * np.clip(ends, 0.0, None), fmt="o", color=BLUE, capsize=3.0, markersize=4.0
    )
    axis.axhline(100.0 * found.limit.share, color=ORANGE, linewidth=1.2, linestyle="--")
    if len(x) <= 12:
        axis.set_xticks(x, labels=[g.label for g in answers.groups], fontsize=8, rotation=0 if len(x) <= 4 else 30)
    else:
        axis.set_xlabel("combination")
    axis.margins(x=0.1)
    axis.set_ylabel("pairs that keep it / %")
    return figure


def _points(answers: Answers) -> Figure:
    design = answers.store.plan.design
    names = list(answers.store.plan.file.outputs)[:3]
    sweeps = design.ranges[:4]
    columns = answers.store.columns(["status", *names, *(sweep.all_keys[0] for sweep in sweeps)])
    rows = np.flatnonzero(columns["status"] == "done")
    rows = rows[np.unique(np.linspace(0, rows.size - 1, min(rows.size, CLOUD)).astype(int))] if rows.size else rows
    figure, axes = _grid(len(names) * len(sweeps), columns=len(sweeps), height=2.4)
    for k, name in enumerate(names):
        for l, sweep in enumerate(sweeps):
            axis = axes[k * len(sweeps) + l]
            x, y = as_numbers(columns[sweep.all_keys[0]])[rows], as_numbers(columns[name])[rows]
            axis.plot(x, y, ".", markersize=2.0, color=BLUE, alpha=0.5, rasterized=True)
            axis.set_xlabel(sweep.all_keys[0], fontsize=8)
            axis.set_ylabel(axis_label(name), fontsize=8)
    return figure
