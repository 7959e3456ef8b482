"""Figures of a page: size against detection, and how often a stated chance is right."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gearpoly.prove.reliability import NAME, PLACE

KIND_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Colours that people who see few of them tell apart (Okabe and Ito)."""


def draw_sizes(board: dict[str, Any], target: Path) -> None:
    """Share of single effects reported, named and in the reported set over their size, with Wilson bars."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    some = [one for one in board["by_size"] if one["cases"]]
    colours = {"reported": "#0072B2", "in_set": "#009E73", "named": "#D55E00"}
    texts = {"reported": "something reported", "in_set": "in the reported set", "named": "named, right tooth"}
    for shift, (key, colour) in zip((-0.12, 0.0, 0.12), colours.items(), strict=True):
        here = [(k, one[key]) for k, one in enumerate(some) if one[key]["of"]]
        x = [k + shift for k, _ in here]
        y = [100 * one["rate"] for _, one in here]
        low = [100 * (one["rate"] - one["interval_95"][0]) for _, one in here]
        high = [100 * (one["interval_95"][1] - one["rate"]) for _, one in here]
        axes.errorbar(x, y, yerr=[low, high], fmt="o-", color=colour, capsize=2, elinewidth=1, label=texts[key])
    axes.set_xticks(range(len(some)), [f"{_range(one['over_limit'])}\n({one['cases']})" for one in some])
    axes.set_xlabel("size over the theoretical limit (cases)")
    axes.set_ylabel("share of single effects, %")
    axes.set_ylim(-3, 103)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(target, dpi=150, metadata={"Software": None})


def _range(ends: list[float | None]) -> str:
    low, high = ends
    return f"from {low:g}" if high is None else f"{low:g} to {high:g}"


def draw_reliability(boards: Sequence[dict[str, Any]], labels: Sequence[str], target: Path) -> None:
    """How often chances were right over the mean of those stated, in bins with Wilson bars and counts; a verdict that
    knows how sure it is lies on the diagonal."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.6, 4.6))
    FigureCanvasAgg(figure)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, kind, title in zip(panels, (NAME, PLACE), ("of a name", "that something is there"), strict=True):
        axes.plot([0, 1], [0, 1], color="0.6", lw=1, ls="--", zorder=0)
        for k, (board, label) in enumerate(zip(boards, labels, strict=True)):
            some = [one for one in board["by_expert"]["all"]["reliability"][kind] if one["right"]["of"]]
            x = [one["stated"] for one in some]
            y = [one["right"]["rate"] for one in some]
            low = [one["right"]["rate"] - one["right"]["interval_95"][0] for one in some]
            high = [one["right"]["interval_95"][1] - one["right"]["rate"] for one in some]
            colour = KIND_COLOURS[k % len(KIND_COLOURS)]
            axes.errorbar(
                x, y, yerr=[low, high], fmt="o-", ms=4, lw=0.8, color=colour, capsize=2, elinewidth=1, label=label
            )
            for one in some:  # counts of several runs one above the other
                at = (one["stated"], one["right"]["rate"])
                # Towards the middle, where there is room.
                shift = -5 if one["stated"] > 0.5 else 5, -12 - 9 * k if one["right"]["rate"] > 0.5 else 5 + 9 * k
                side = "right" if one["stated"] > 0.5 else "left"
                axes.annotate(
                    str(one["right"]["of"]), at, shift, textcoords="offset points", fontsize=7, color=colour, ha=side
                )
        axes.set_title(f"chance {title}", fontsize=10)
        axes.set_xlabel("chance stated, mean of each bin")
        axes.set_xlim(-0.03, 1.06)
        axes.set_ylim(-0.03, 1.06)
        axes.set_aspect("equal")
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("share that was right (counts beside)")
    # Square axes and a constrained layout would cut the labels below.
    figure.subplots_adjust(left=0.08, right=0.98, bottom=0.12, top=0.84, wspace=0.08)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="upper center", ncols=3, frameon=False)
    figure.savefig(target, dpi=130, metadata={"Software": None})
