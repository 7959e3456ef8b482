"""Compliance against thickness: how much softer the lower thickness deviation of each grade makes a tooth."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.gear.deviations import pitch_and_thickness
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.mesh.compliance import tooth_compliance, tooth_section
from gearpoly.studies.paper.base import (
    PAPER_ELASTICITY,
    PAPER_GRADES,
    PairRecipe,
    PaperAnswer,
    PaperRow,
    PaperStudy,
    Question,
    limits_of,
    verdict,
)
from gearpoly.studies.paper.picture import Line, Panel, PaperPicture
from gearpoly.units import UM, FloatArray

PAPER_TIP = (0.3797e-3, 0.0484e-3)
"""um/N. At the tip, grade 4 less perfect, and grade 5 less grade 4."""

CHORD = 0.02 * UM
"""mm. A coarse outline is enough here: compliance follows the outline's thickness, so it errs by 1e-5 of itself."""


def compliance(gear: Gear, r: FloatArray, *, E_s: float, law: str = PAPER_ELASTICITY.law) -> FloatArray:
    """Compliance (k,) in um/N of a tooth with thickness deviation ``E_s`` mm, loaded at radii ``r`` (k,) mm."""
    thin = pitch_and_thickness(gear, index=np.zeros(gear.z), E_s=np.full(gear.z, E_s))
    flanks = draw_flanks(gear, thin, chord_error=CHORD)
    section = tooth_section(
        radius=flanks.r,
        drive=flanks.psi_drive[0],
        coast=-flanks.psi_coast[0],
        base_radius=gear.r_b,
        reference_radius=gear.r,
        bore_radius=0.5 * gear.r_f,
        teeth=gear.z,
    )
    width = PairRecipe().b if gear.b is None else gear.b
    c = tooth_compliance(
        section,
        radius=r,
        face_width=width,
        youngs_modulus=PAPER_ELASTICITY.E,
        poisson_ratio=PAPER_ELASTICITY.nu,
        law=law,
    )
    return c / UM


def along_path(gears: tuple[Gear, Gear], *, E_s: tuple[float, float], places: int) -> tuple[FloatArray, FloatArray]:
    """Places (k,) on the path in mm from the pitch point, and the compliance (k,) in um/N of both teeth there."""
    driving, driven = gears
    half = driving.l_pitch + driven.l_pitch
    l_1 = np.linspace(max(half - driven.l_a, 0.0) + 1e-9, driving.l_a - 1e-9, places)
    r = [np.hypot(gear.r_b, np.maximum(l, 1e-6)) for gear, l in ((driving, l_1), (driven, half - l_1))]
    both = compliance(driving, r[0], E_s=E_s[0]) + compliance(driven, r[1], E_s=E_s[1])
    return l_1 - driving.l_pitch, both


def ask(study: PaperStudy) -> PaperAnswer:
    """The research pair's teeth perfect and at the lower thickness deviation of each grade."""
    recipe = PairRecipe()
    gears = recipe.gears
    driving, driven = (
        [limits_of(recipe.with_(grade=grade), gear)["E_sni"] for grade in PAPER_GRADES] for gear in gears
    )
    steps = [0.0, *driving]
    gear = gears[0]
    low = math.hypot(gear.r_b, max(0.0, gear.l_pitch + gears[1].l_pitch - gears[1].l_a))
    r = np.linspace(low, gear.r_a, 80 // study.refine)
    curves = [compliance(gear, r, E_s=E) for E in steps]
    tip = np.diff([curve[-1] for curve in curves])
    bottom = np.diff([curve[0] for curve in curves])
    path, mesh = along_path(gears, E_s=(driving[0], driven[0]), places=41)
    bend = np.diff(mesh, 2)
    rows = (
        *_tip_rows(tip, steps),
        PaperRow(
            what="the same at the lowest contact",
            paper="about 0",
            gearpoly=f"{1e3 * bottom[0]:.4f}e-3 um/N, {bottom[0] / tip[0]:.2f} of the tip's",
            verdict=verdict(bottom[0] < 0.1 * tip[0], bottom[0] < 0.5 * tip[0]),
            why="the lowest contact of 18 teeth still stands on a beam; at the root itself it is nought",
        ),
        PaperRow(
            what="compliance from tip to root",
            paper="falls",
            gearpoly=f"falls from {curves[1][-1] * 1e3:.3f}e-3 to {curves[1][0] * 1e3:.3f}e-3 um/N",
            verdict=verdict(bool(np.all(np.diff(curves[1]) > 0.0)), True),
            why="a shorter beam",
        ),
        PaperRow(
            what="compliance of both teeth over the path",
            paper="concave",
            gearpoly="second differences of one sign: a trough with its least near the pitch point",
            verdict=verdict(bool(np.all(bend > 0.0)), bool(np.mean(bend > 0.0) > 0.9)),
            why="we read concave as hollow upwards: one tooth stiffens where the other softens",
        ),
        _thinner_row(tip, steps),
    )
    picture = _picture(gear, r, curves, path, mesh)
    return PaperAnswer(
        rows=rows,
        pictures=(picture,),
        text=(),
        values={"tip": tip, "bottom": bottom, "bend": bend, "curve": curves[1], "E_sni": steps},
    )


def _thinner_row(tip: FloatArray, steps: list[float]) -> PaperRow:
    """Whether each further step of E_sni softens the tip more."""
    return PaperRow(
        what="thinner teeth are softer",
        paper="stated",
        gearpoly=f"each step of E_sni adds {1e6 * tip[1] / -(steps[2] - steps[1]) * UM:.2f}e-6 um/N per um, "
        f"more than "
        f"the first's {1e6 * tip[0] / -steps[1] * UM:.2f}e-6",
        verdict=verdict(bool(np.all(tip > 0.0)) and tip[1] / (steps[1] - steps[2]) > tip[0] / -steps[1], False),
        why="with h^-3 each further micrometre counts more",
    )


def _tip_rows(tip: FloatArray, steps: list[float]) -> tuple[PaperRow, ...]:
    """How much softer the tip is from grade to grade, um/N, by the ``steps`` of E_sni in mm."""
    return (
        PaperRow(
            what="tip compliance, grade 4 less perfect",
            paper="0.3797e-3 um/N",
            gearpoly=f"{1e3 * tip[0]:.4f}e-3 um/N (18 teeth, E_sni {steps[1] / UM:.1f} um)",
            verdict=verdict(abs(tip[0] / PAPER_TIP[0] - 1.0) < 0.1, tip[0] > 0.0),
            why="m, b and E_sni are lost and only E_sni/(m b) enters: see the inverse problem for what would give it",
        ),
        PaperRow(
            what="tip compliance, grade 5 less grade 4",
            paper="0.0484e-3 um/N, 0.127 of that",
            gearpoly=f"{1e3 * tip[1]:.4f}e-3 um/N, {tip[1] / tip[0]:.3f} of that (E_sni {steps[2] / UM:.1f} um)",
            verdict=verdict(abs(tip[1] / tip[0] / 0.1275 - 1.0) < 0.1, tip[1] > 0.0),
            why="a tooth's compliance is nearly linear in thickness, so the ratio says how E_sni grows from grade "
            "4 to 5",
        ),
    )


def _picture(gear: Gear, r: FloatArray, curves: list[FloatArray], path: FloatArray, mesh: FloatArray) -> PaperPicture:
    """Compliances (k,) in um/N over the radii ``r`` in mm, and both teeth over the path."""
    names = ("perfect", *(f"grade {g}" for g in PAPER_GRADES))
    return PaperPicture(
        name="thickness",
        caption="Driving tooth at the lower thickness deviation of each grade, law as published, and both teeth "
        "over the path.",
        panels=(
            Panel(
                x="load radius / mm",
                y="tooth compliance / (1e-3 um/N)",
                lines=tuple(
                    Line(x=r, y=1e3 * curve, colour=k, label=names[k], style="line") for k, curve in enumerate(curves)
                ),
            ),
            Panel(
                x="load radius / mm",
                y="difference / (1e-3 um/N)",
                lines=(
                    *(
                        Line(
                            x=r,
                            y=1e3 * (curves[k + 1] - curves[k]),
                            colour=k + 1,
                            label=f"{names[k + 1]} less {names[k]}",
                            style="line",
                        )
                        for k in range(3)
                    ),
                    Line(
                        x=[gear.r_a] * 2,
                        y=[1e3 * value for value in PAPER_TIP],
                        colour=4,
                        style="dots",
                        label="paper, at the tip",
                    ),
                ),
            ),
            Panel(
                x="contact from the pitch point / mm",
                y="compliance of both teeth / (1e-3 um/N)",
                lines=(Line(x=path, y=1e3 * mesh, colour=1, label="grade 4", style="line"),),
            ),
        ),
    )


QUESTION = Question(order=5, name="thickness", title="Compliance against thickness", ask=ask)
