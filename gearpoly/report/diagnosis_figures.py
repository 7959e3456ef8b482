"""Still pictures of a diagnosis, for reports on paper: what the page's plots show, whole."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gearpoly.compare.beside import Aligned
from gearpoly.diagnose.heldout import repeatable
from gearpoly.diagnose.verdict import BuiltGear, Diagnosis
from gearpoly.report.diagnosis_data import by_driven, marked, order_spectra, recording_label, tooth_residuals
from gearpoly.report.plots import BLUE, GREEN, GREY, ORANGE, ShownFigure, save
from gearpoly.units import DEG, UM, FloatArray

PAPER_WIDTH = 7.0
"""inches: what is left of A4 beside margins of 16 mm."""

Drawn = tuple[str, Figure, str]
"""Name, picture and caption."""


def figures(diagnosis: Diagnosis) -> Iterator[Drawn]:
    """All pictures of ``diagnosis``, one after the other, since they are large."""
    yield "fit", fit_figure(diagnosis), "Mismatch on data that the fit never saw, and the noise."
    for k, (one, left) in enumerate(zip(diagnosis.comparison.aligned, diagnosis.left, strict=True)):
        label = recording_label(k, one)
        yield f"curves_{k}", curves_figure(one, left, title=label), f"Recording {label}: recorded and simulated."
        yield f"orders_{k}", orders_figure(diagnosis, k), f"Recording {label}: what is left, by order."
        yield f"teeth_{k}", teeth_figure(diagnosis, k), f"Recording {label}: what is left, by tooth and mesh phase."
    yield "built", built_figure(diagnosis), "Index deviations of all teeth as built, with standard errors."


def write_figures(diagnosis: Diagnosis, folder: Path, *, ending: str = ".svg") -> list[Path]:
    """Write all pictures into ``folder``, which is made where it is not there; returns the files."""
    folder.mkdir(exist_ok=True)
    written = []
    for name, figure, _ in figures(diagnosis):
        written.append(folder / f"{name}{ending}")
        save(figure, written[-1])
    return written


def fit_figure(diagnosis: Diagnosis) -> Figure:
    """Repeatable mismatch of the declared simulation, with as-built teeth and with all names, beside the noise."""
    figure = Figure(figsize=(PAPER_WIDTH, 1.9), layout="constrained")
    axis = figure.subplots()
    rows = (
        ("declared simulation", diagnosis.before.unseen, ORANGE),
        ("with as-built teeth", diagnosis.as_built_only.unseen, GREY),
        ("with what was missing", diagnosis.after.unseen, BLUE),
    )
    for k, (_, rms, colour) in enumerate(rows):
        size = repeatable(rms, diagnosis.noise) / UM
        axis.barh(k, size, color=colour, height=0.6)
        at = max(size, diagnosis.noise / UM)  # clear of the noise's line
        axis.annotate(f"  {size:.3g} um", (at, k), va="center", fontsize=8)
    axis.axvline(diagnosis.noise / UM, color="black", linestyle=":", linewidth=1.2)
    axis.set_yticks(range(len(rows)), [words for words, _, _ in rows])
    axis.invert_yaxis()
    axis.margins(x=0.12)
    axis.set_xlabel("repeatable mismatch on unseen data / um rms (dotted: noise)")
    return figure


def curves_figure(one: Aligned, left: FloatArray, *, title: str) -> Figure:
    """Transmission error recorded and simulated, before and after, and both residuals, over the driven angle."""
    figure = ShownFigure(figsize=(PAPER_WIDTH, 4.6), layout="constrained")
    axes: Any = figure.subplots(2, 1, sharex=True)
    order = np.argsort(one.theta_2, kind="stable")
    x = one.theta_2[order] / DEG
    shown = (
        (axes[0], one.recorded, GREY, 1.6, "recorded"),
        (axes[0], one.simulated, ORANGE, 0.5, "simulated before"),
        (axes[0], one.recorded - left, BLUE, 0.5, "simulated after"),
        (axes[1], one.residual - np.mean(one.residual), ORANGE, 0.5, "before"),
        (axes[1], left - np.mean(left), BLUE, 0.5, "after"),
    )
    for axis, values, colour, width, label in shown:
        axis.plot(x, values[order] / UM, color=colour, linewidth=width, label=label, rasterized=x.size > 20_000)
    for axis, words in zip(axes, ("transmission error / um", "residual / um"), strict=True):
        axis.set_ylabel(words)
        axis.margins(x=0.0)
        axis.grid(color=GREY, alpha=0.25, linewidth=0.5)
        axis.legend(fontsize=7, loc="upper right", ncols=3)
    axes[1].set_xlabel("driven angle / deg")
    axes[0].set_title(title, fontsize=9, loc="left")
    return figure


def orders_figure(diagnosis: Diagnosis, k: int) -> Figure:
    """Order spectrum of what is left of recording ``k``, before and after, and what noise exceeds in one of a hundred
    recordings."""
    one, left = diagnosis.comparison.aligned[k], diagnosis.left[k]
    z = _teeth(diagnosis)
    orders, before, after, limit = order_spectra(one, left, diagnosis.comparison.located.noises[k], z=z)
    figure = Figure(figsize=(PAPER_WIDTH, 2.8), layout="constrained")
    axis = figure.subplots()
    for mesh in range(1, int(orders[-1] / z[0]) + 1):
        axis.axvline(mesh * z[0], color=GREY, linewidth=0.6, alpha=0.6)
    axis.semilogy(orders, before / UM, color=ORANGE, linewidth=0.5, label="before", rasterized=True)
    axis.semilogy(orders, after / UM, color=BLUE, linewidth=0.5, label="after", rasterized=True)
    axis.semilogy(orders, limit / UM, color="black", linewidth=0.9, linestyle="--", label="noise, 1 in 100")
    axis.set_ylim(bottom=float(np.min(limit)) / UM / 10.0)
    axis.margins(x=0.0)
    axis.set_xlabel(f"order of the driving shaft (grey: mesh orders, {z[0]} each)")
    axis.set_ylabel("amplitude / um")
    axis.legend(fontsize=7, loc="upper right", ncols=3)
    return figure


def teeth_figure(diagnosis: Diagnosis, k: int) -> Figure:
    """What is left of recording ``k`` by tooth and mesh phase, both gears, before and after, on one scale a gear."""
    one, left = diagnosis.comparison.aligned[k], diagnosis.left[k]
    coast = one.flank == "coast"
    pairs = tooth_residuals(one, left, diagnosis.comparison.located.noises[k], z=_teeth(diagnosis))
    numbered = diagnosis.comparison.alignment.numbered
    figure = Figure(figsize=(PAPER_WIDTH, 3.6), layout="constrained")
    axes: Any = figure.subplots(1, 4)
    for gear, name in enumerate(("driving", "driven")):
        values = [(by_driven(found, coast=coast) if gear else found.driving) / UM for found in pairs]
        top = max(1e-3, *(float(np.nanmax(np.abs(cells), initial=0.0)) for cells in values))
        for when, cells, axis in zip(("before", "after"), values, axes[2 * gear : 2 * gear + 2], strict=True):
            shown = axis.imshow(
                cells, aspect="auto", origin="lower", cmap="RdBu_r", vmin=-top, vmax=top, interpolation="nearest",
                extent=(-0.5, 0.5, -0.5, cells.shape[0] - 0.5),
            )  # fmt: skip
            axis.set_title(f"{name} gear, {when}", fontsize=8)
            axis.tick_params(labelsize=7)
            axis.set_xlabel("pitches", fontsize=7)
        axes[2 * gear].set_ylabel("tooth" if numbered[gear] else "tooth (numbering open)", fontsize=7)
        bar = figure.colorbar(shown, ax=axes[2 * gear + 1], shrink=0.9)
        bar.set_label("um", fontsize=7)
        bar.ax.tick_params(labelsize=7)
    return figure


def built_figure(diagnosis: Diagnosis) -> Figure:
    """Index deviations of both gears as built, tooth by tooth; orange: teeth of which something is named."""
    figure = Figure(figsize=(PAPER_WIDTH, 2.6), layout="constrained")
    axes: Any = figure.subplots(1, 2)
    for gear, (axis, made) in enumerate(zip(axes, diagnosis.built, strict=True)):
        _built(axis, made, marked(diagnosis, gear))
        axis.set_title(f"{('driving', 'driven')[gear]} gear", fontsize=9)
    axes[0].set_ylabel("index deviation / um")
    # Below both, where no tooth lies.
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=7)
    return figure


def _built(axis: Any, made: BuiltGear, named: list[int]) -> None:
    for flank, colour, shift in zip(made.flanks, (BLUE, GREEN), (-0.12, 0.12), strict=False):
        at = np.arange(flank.pitch.size) + shift
        axis.errorbar(at, flank.pitch, yerr=flank.pitch_std, fmt=".", color=colour, markersize=4, linewidth=0.8,
                      label=f"{flank.flank} flanks")  # fmt: skip
    for tooth in named:
        axis.axvline(tooth, color=ORANGE, linewidth=3.0, alpha=0.3)
    axis.axhline(0.0, color=GREY, linewidth=0.6)
    axis.grid(color=GREY, alpha=0.25, linewidth=0.5)
    axis.set_xlabel("tooth")


def _teeth(diagnosis: Diagnosis) -> tuple[int, int]:
    pair = diagnosis.comparison.assembled.pair
    return pair.driving.gear.z, pair.driven.gear.z
