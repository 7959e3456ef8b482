"""Still pictures of a run, and how every picture is written."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from gearpoly.errors import InputFileError
from gearpoly.files.output import written_aside
from gearpoly.report.summary import load_words
from gearpoly.simulate import Simulation
from gearpoly.units import DEG, UM

FORMATS = (".png", ".svg", ".pdf")

# Okabe and Ito's palette keeps its contrasts for all common kinds of colour blindness.
BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#777777"


class ShownFigure(Figure):
    """A figure that a notebook shows: matplotlib's own does so only where pyplot was imported before."""

    def _repr_png_(self) -> bytes:
        png = BytesIO()
        self.savefig(png, format="png", dpi=100)
        return png.getvalue()


def check_format(target: Path) -> None:
    """Raise ``InputFileError`` unless ``target`` ends in a picture format that can be written."""
    if target.suffix.lower() not in FORMATS:
        raise InputFileError(target, found=f'the ending "{target.suffix}"', wish=f"want one of {', '.join(FORMATS)}")


def saved(figure: Figure, target: Path | str | None) -> Figure:
    """The ``figure``, written to ``target`` if there is one."""
    if target is not None:
        save(figure, Path(target))
    return figure


def save(figure: Figure, target: Path, *, colours: int | None = None) -> None:
    """Write ``figure`` to ``target`` by its ending, whole or not at all; a .png for a page of many with so few
    ``colours``: of 128 none is off by a tenth, and it takes a quarter of the room."""
    check_format(target)
    with written_aside(target) as aside:
        # No date in the metadata: the same run gives the same file.
        dated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(target.suffix.lower(), {})
        figure.savefig(aside, dpi=150, metadata=dated)
        if colours is not None and target.suffix.lower() == ".png":
            from PIL import Image

            with Image.open(aside) as picture:
                # By the greatest distance between colours: by their number thin lines lose theirs.
                few = picture.convert("RGB").quantize(colours, Image.Quantize.MAXCOVERAGE)
            few.save(aside, optimize=True)


def plot_run(simulation: Simulation, *, name: str, target: Path) -> None:
    """Write ``run_figure`` to ``target``."""
    save(run_figure(simulation, name=name), target)


def run_figure(simulation: Simulation, *, name: str) -> Figure:
    """Transmission error, backlash and number of touching pairs over the driven angle, one below the other."""
    figure = ShownFigure(figsize=(11.0, 7.5), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 1))
    found = simulation.contacts
    order = np.argsort(found.theta_2, kind="stable")
    angle = found.theta_2[order] / DEG
    turns = np.ptp(angle) / 360.0 > 3.0
    axes[0].plot(angle, simulation.te_um[order], color=BLUE, linewidth=0.5 if turns else 0.9)
    axes[0].set_ylabel("TE along the line\nof action / um")
    axes[1].plot(angle, simulation.backlash.j_bn[order] / UM, color=ORANGE, linewidth=0.5 if turns else 0.9)
    axes[1].set_ylabel("normal backlash\n$j_{bn}$ / um")
    axes[2].plot(
        angle,
        simulation.pairs[order],
        color=GREEN,
        linewidth=0.4 if turns else 0.9,
        drawstyle="steps-post",
    )
    axes[2].set_ylabel("touching\npairs")
    axes[2].set_yticks(range(int(simulation.pairs.max()) + 2))
    axes[2].set_xlabel("driven angle / deg")
    figures = simulation.summary()
    axes[0].set_title(
        f"{name}: {simulation.flank} flank, {load_words(simulation)}    TEpp {figures['te_pp_um']:.3f} um = "
        f"{figures['te_pp_arcmin']:.3f} arcmin (driven)    mean backlash {figures['backlash_mean_um']:.2f} um",
        loc="left",
        fontsize=10,
    )
    for axis in axes:
        axis.grid(color=GREY, alpha=0.25, linewidth=0.5)
        axis.margins(x=0.0)
        # Offsets like 1e-5 + 3.2 hide the size that a reader looks for.
        axis.ticklabel_format(useOffset=False, axis="y")
    return figure
