"""Pictures of a study: how each output is distributed, what drives it, and how many pairs keep a limit."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gearpoly.report.plots import BLUE, GREEN, GREY, ORANGE, save
from gearpoly.study.answers import Answers
from gearpoly.study.groups import Sample, sweep_name
from gearpoly.study.outputs import output
from gearpoly.study.store import as_numbers
from gearpoly.units import FloatArray

COLOURS = (BLUE, ORANGE, GREEN, "#CC79A7", "#444444", "#E69F00", "#56B4E9")
"""Okabe and Ito's, with a dark grey."""

CURVES = 7
"""Groups drawn as curves of their own; more become bands of percentiles over the groups."""

NAMED = 24
"""Combinations that an axis names; more only have a place in the order of the tables."""

STEPS = 400
"""Corners of a drawn distribution: more than a page has pixels are of no use."""

LINE, UPRIGHT = 46, 26
"""Letters of one line of a label along an axis of 4.6 inches, and up one of 2.9 or 2.4."""

CLOUD = 1500
"""Dots in one picture of Sobol points."""


def draw_all(answers: Answers, folder: Path) -> list[tuple[Path, str]]:
    """Write every picture of ``answers`` as SVG into ``folder``; returns files and captions."""
    out = []
    for name, figure, caption in figures(answers):
        target = folder / f"{name}.svg"
        save(figure, target)
        out.append((target, caption))
    return out


def figures(answers: Answers) -> Iterator[tuple[str, Figure, str]]:
    """Name, picture and caption of all that can be drawn of ``answers``."""
    names = [
        name for name in answers.store.plan.file.outputs if any(g.sample(name).values.size for g in answers.groups)
    ]
    for start in range(0, len(names), 6):
        part = names[start : start + 6]
        few = len(answers.groups) <= CURVES
        caption = (
            "Share of pairs at or below a value, one curve per combination; dashed, its limit."
            if few
            else "Median and range from the 5th to the 95th percentile of each combination; dashed, its limit."
        )
        yield f"outputs_{start // 6 + 1}", _distributions(answers, part, few=few), caption
    if any(indices for _, indices in answers.sensitivity):
        yield (
            "sensitivity",
            _sensitivity(answers),
            "Sobol indices: full bars, what a factor makes on its own; pale bars, what it has a part in; lines, 95 % "
            "intervals. Chance is what the grade leaves open.",
        )
    if any(any(one.judged) for one in answers.yields):
        yield (
            "yield",
            _yields(answers),
            "Share of the drawn pairs that keep each limit, with its interval; dashed lines, the share that is asked. "
            "A combination of which no pair could be judged has no point.",
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


def axis_label(name: str, *, line: int = LINE) -> str:
    """What an output is and its unit, in lines that an axis of a small picture holds."""
    one = output(name)
    return textwrap.fill(f"{one.says} / {one.unit}" if one.unit else one.says, line)


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
            x, over = _over(answers)
            _bands(axis, x, samples, joined=bool(over))
            axis.set_ylabel(axis_label(name, line=UPRIGHT), fontsize=8)
            if over:
                axis.set_xlabel(over)
            else:
                _name_combinations(axis, answers)
        for limit in answers.limits:
            if limit.output == name:
                bound = limit.at_most if limit.at_most is not None else limit.at_least
                (axis.axvline if few else axis.axhline)(bound, color=GREY, linewidth=1.2, linestyle="--")
    if few and len(answers.groups) > 1:
        named = {label: handle for axis in axes
                 for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)}  # fmt: skip
        labels = [group.label for group in answers.groups if group.label in named]
        figure.legend(
            [named[label] for label in labels],
            labels,
            loc="outside lower center",
            ncols=min(4, len(labels)),
            fontsize=8,
        )
    return figure


def _curve(axis: Any, sample: Sample, colour: str, label: str) -> None:
    n = sample.values.size
    if not n:
        return
    keep = np.unique(np.linspace(0, n - 1, min(n, STEPS)).astype(int))
    axis.step(sample.values[keep], (keep + 1) / n, where="post", color=colour, linewidth=1.2, label=label)


def _over(answers: Answers) -> tuple[FloatArray, str]:
    """What combinations are drawn over: the values of the one thing that is swept where these are numbers that rise;
    else their places, and no name."""
    plain = answers.store.plan.design.plain
    values = [group.values[plain[0].all_keys[0]] for group in answers.groups] if len(plain) == 1 else []
    if values and all(isinstance(v, int | float) for v in values) and np.all(np.diff(values) > 0):
        return np.array(values, dtype=np.float64), sweep_name(plain[0])
    return np.arange(float(len(answers.groups))), ""


def _bands(axis: Any, x: FloatArray, samples: list[Sample], *, joined: bool) -> None:
    low, middle, high = (
        np.array([np.quantile(s.values, q) if s.values.size else np.nan for s in samples]) for q in (0.05, 0.5, 0.95)
    )
    if joined:
        axis.fill_between(x, low, high, color=BLUE, alpha=0.25, linewidth=0.0)
        axis.plot(x, middle, color=BLUE, linewidth=1.2)
        axis.margins(x=0.0)
    else:  # nothing lies between one combination and the next
        axis.errorbar(x, middle, yerr=[middle - low, high - middle], fmt="o", color=BLUE, markersize=3.0, capsize=2.0)
        axis.set_xlim(-0.5, len(samples) - 0.5)


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
        axis.set_title(axis_label(name), loc="left", fontsize=9)
    return figure


def _yields(answers: Answers) -> Figure:
    judged = [one for one in answers.yields if any(one.judged)]
    figure, (axis,) = _grid(1, height=3.6 + 0.2 * len(judged))
    figure.set_figwidth(max(6.4, min(14.0, 1.6 + 0.9 * len(answers.groups))))
    x = np.arange(len(answers.groups))
    apart = min(0.18, 0.6 / len(judged))  # of the way to the next combination
    for k, one in enumerate(judged):
        middle = np.array([found.value for found in one.shares])
        ends = np.array([[found.value - found.low, found.high - found.value] for found in one.shares]).T
        known = np.isfinite(middle)
        axis.errorbar(
            (x + apart * (k - 0.5 * (len(judged) - 1)))[known], 100.0 * middle[known],
            yerr=100.0 * np.clip(ends[:, known], 0.0, None), fmt="o" if len(one.limits) == 1 else "D",
            color=COLOURS[k % len(COLOURS)], capsize=3.0, markersize=4.5, label=textwrap.fill(one.words, 80),
        )  # fmt: skip
        axis.axhline(100.0 * one.share, color=COLOURS[k % len(COLOURS)], linewidth=1.0, linestyle=(k, (4, 3)))
    axis.set_xlim(-0.5, len(x) - 0.5)
    _name_combinations(axis, answers)
    axis.set_ylim(-4.0, 104.0)  # a point at 0 or 100 % is seen whole
    axis.set_ylabel("drawn pairs that keep it / %")
    figure.legend(loc="outside lower left", fontsize=8)
    return figure


def _name_combinations(axis: Any, answers: Answers) -> None:
    """Ticks with the combinations' names where there are few, which stand at 0, 1, 2, ..."""
    labels = [textwrap.fill(group.label, 24) for group in answers.groups]
    if len(labels) <= NAMED:
        upright = len(labels) > 6
        axis.set_xticks(range(len(labels)), labels=labels, fontsize=7 if upright else 8, rotation=90 if upright else 0)
    else:
        axis.set_xlabel("combination, in the order of the tables")


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
            axis.set_ylabel(axis_label(name, line=UPRIGHT), fontsize=7)
    return figure
