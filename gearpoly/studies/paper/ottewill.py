"""Ottewill's 18/18 pair: transmission error over all relative phases of both eccentricities and all tooth sequences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearpoly.gear.flank import Flanks
from gearpoly.mesh.deflection import pair_compliance
from gearpoly.mesh.loaded import load_reach, loaded
from gearpoly.mesh.pair import GearPair, mount
from gearpoly.mesh.transmission import NEAR_PAIR_MM
from gearpoly.studies.paper.base import (
    PAPER_ELASTICITY,
    PairRecipe,
    PaperAnswer,
    PaperRow,
    PaperStudy,
    Question,
    flanks_of,
    peak_to_peak,
    touch,
    verdict,
)
from gearpoly.studies.paper.picture import Line, Panel, PaperPicture
from gearpoly.units import ARCMIN, DEG, NM, UM, FloatArray, read_only

ECCENTRICITY = (0.05588, 0.04826)
"""mm. Largest of each gear in the experiment."""

OTTEWILL_TORQUE_NM = 5.5

PAIR = PairRecipe(
    z=(18, 18),
    m=6.0,
    b=7.5,
    grade=6,
    stated={"f_pt": 7.6 * UM, "F_alpha": 5.1 * UM, "E_sns": -50.0 * UM, "E_sni": -70.0 * UM},
)
"""As in data/pairs/ottewill_18_18.toml: its maxima are measured, E_sns is a guess that keeps the teeth from jamming."""

OTTEWILL_PER_PITCH = 12
"""Positions per pitch: one turn holds the pair's whole cycle, since both gears have 18 teeth."""


def closed_form(phase: FloatArray) -> FloatArray:
    """TEpp in arcmin of two eccentric, otherwise perfect gears, unloaded: 2/r_b |e_1 - e_2 exp(i phase)|.

    ``phase`` in rad as seen along the line of action. First order in the eccentricities, derived here: gear 1 moves its
    flank by e_1 sin(theta + alpha), gear 2 by e_2 sin(theta - angle - alpha), so phase = angle + 2 alpha.
    """
    r_b = PAIR.gears[1].r_b
    e_1, e_2 = ECCENTRICITY
    distance = np.abs(e_1 - e_2 * np.exp(1j * np.asarray(phase)))
    return np.asarray(2.0 * distance / r_b / ARCMIN)


def shifted(flanks: Flanks, teeth: int) -> Flanks:
    """The same gear with its errors moved on by ``teeth``: another tooth sequence, its eccentricity left in place."""
    return replace(
        flanks,
        psi_drive=read_only(np.roll(flanks.psi_drive, teeth, axis=0)),
        psi_coast=read_only(np.roll(flanks.psi_coast, teeth, axis=0)),
    )


def mounted(flanks: tuple[Flanks, Flanks], *, sequence: int, phase: float) -> GearPair:
    """Both gears with their eccentricities, ``phase`` rad apart as in ``closed_form``, and the driven gear's errors
    ``sequence`` teeth on."""
    return mount(
        flanks[0],
        shifted(flanks[1], sequence),
        eccentricity_1=(ECCENTRICITY[0], 0.0),
        eccentricity_2=(ECCENTRICITY[1], phase - 2.0 * PAIR.gears[0].alpha),
    )


def ask(study: PaperStudy) -> PaperAnswer:
    """TEpp of the loaded and unloaded pair over phases and sequences, with and without errors of grade 6."""
    theta_2 = np.arange(18 * OTTEWILL_PER_PITCH, dtype=np.float64) * (2.0 * np.pi / (18 * OTTEWILL_PER_PITCH))
    phases = np.arange(0.0, 360.0, 20.0 if study.refine == 1 else 90.0) * DEG
    sequences = range(0, 18, 1 if study.refine == 1 else 9)
    recipe = PAIR.with_(points=min(study.points, 500))
    smooth = recipe.with_(profile="smooth")
    perfect = flanks_of(recipe, seed=None)
    alone = np.array([peak_to_peak(touch(mounted(perfect, sequence=0, phase=p), theta_2).te) for p in phases])
    graded, bent = _over_builds(flanks_of(smooth, seed=0), phases, sequences, theta_2)
    form = closed_form(phases)
    low, high = float(np.min(alone)), float(np.max(alone))
    least, most = float(np.min(bent)), float(np.max(bent))
    off = float(np.max(np.abs(alone - form)))
    rows = (
        PaperRow(
            what="Ottewill, eccentricity alone: smallest TEpp",
            paper="closed form 1.03' (2|e_1 - e_2|/r_b)",
            gearpoly=f"{low:.3f}'",
            verdict=verdict(abs(low - form[0]) < 0.05, low < 2.0),
            why="the closed form is of first order in the eccentricity; centre distance changes by both",
        ),
        PaperRow(
            what="Ottewill, eccentricity alone: largest TEpp",
            paper="closed form 14.11' (2(e_1 + e_2)/r_b)",
            gearpoly=f"{high:.3f}'; over all phases within {off:.3f}' of the closed form",
            verdict=verdict(abs(high - 14.11) < 0.05, high > 13.0),
            why="as above",
        ),
        PaperRow(
            what="Ottewill with errors at 5.5 N.m: smallest TEpp",
            paper="within 3.4 % of the measured (value lost)",
            gearpoly=f"{least:.2f}' over all phases and sequences; closed form 1.03'",
            verdict="same trend",
            why=(
                "the measured value is not in the text that survived, so this is no comparison. Nearly equal "
                "eccentricities in "
                "phase cancel, and the errors of pitch and profile are what is left"
            ),
        ),
        PaperRow(
            what="Ottewill with errors at 5.5 N.m: largest TEpp",
            paper="within 4.8 % of the measured (value lost)",
            gearpoly=f"{most:.2f}', {100.0 * (most / 14.11 - 1.0):+.1f} % beside the closed form's 14.11'",
            verdict="same trend",
            why="errors add to the eccentricities or take from them, with the sequence; again no measured value to "
            "compare with",
        ),
    )
    picture = _picture(phases, alone, bent)
    return PaperAnswer(
        rows=rows,
        pictures=(picture,),
        text=_text(bent, graded, points=recipe.points),
        values={"alone": alone, "form": form, "graded": graded, "bent": bent},
    )


def _text(bent: FloatArray, graded: FloatArray, *, points: int) -> tuple[str, ...]:
    """What was turned, and how much the sequence and the load change TEpp (phases, sequences) in arcmin."""
    spread = np.max(bent, axis=1) / np.min(bent, axis=1)
    return (
        f"{len(bent)} relative phases times {bent.shape[1]} tooth sequences of one set (seed 0, smooth profiles, "
        f"{points} points per flank), {OTTEWILL_PER_PITCH} positions per pitch, law as published. The sequence alone "
        f"changes TEpp by up "
        f"to a factor {float(np.max(spread)):.2f} at one phase, so two builds of the same gears are not the same "
        f"measurement. Load "
        f"changes TEpp by at most {float(np.max(np.abs(bent - graded))):.2f}'.",
    )


def _over_builds(
    drawn: tuple[Flanks, Flanks], phases: FloatArray, sequences: range, theta_2: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """TEpp (p, s) in arcmin of error gears over phases in rad and tooth sequences, unloaded and under load."""
    graded, bent = np.zeros((len(phases), len(sequences))), np.zeros((len(phases), len(sequences)))
    bends = pair_compliance(mounted(drawn, sequence=0, phase=0.0), PAPER_ELASTICITY)
    for k, sequence in enumerate(sequences):
        teeth = replace(bends.driven, c=np.roll(bends.driven.c, sequence, axis=0))
        for i, phase in enumerate(phases):
            pair = mounted(drawn, sequence=sequence, phase=phase)
            found = touch(pair, theta_2, near=NEAR_PAIR_MM + load_reach(bends, OTTEWILL_TORQUE_NM * NM))
            graded[i, k] = peak_to_peak(found.te)
            bent[i, k] = peak_to_peak(
                loaded(found, replace(bends, pair=pair, driven=teeth), torque=OTTEWILL_TORQUE_NM * NM).te
            )
    return graded, bent


def _picture(phases: FloatArray, alone: FloatArray, bent: FloatArray) -> PaperPicture:
    """TEpp in arcmin over the ``phases`` (p,) in rad: of eccentricity ``alone`` (p,), and of all sequences (p, s)."""
    degrees = phases / DEG
    return PaperPicture(
        name="ottewill",
        caption="TEpp over the relative phase of both eccentricities; the band is all tooth sequences of one set "
        "at 5.5 N.m.",
        panels=(
            Panel(
                x="relative phase of the eccentricities along the line of action / deg",
                y="TEpp of the driven shaft / arcmin",
                lines=(
                    Line(x=degrees, y=alone, style="dots", label="eccentricity alone"),
                    Line(x=np.arange(361), y=closed_form(np.arange(361.0) * DEG), style="dashed", label="closed form"),
                    Line(x=degrees, y=np.min(bent, axis=1), colour=1, label="grade 6, least of the sequences"),
                    Line(x=degrees, y=np.max(bent, axis=1), colour=2, label="grade 6, most of the sequences"),
                ),
            ),
        ),
    )


QUESTION = Question(order=8, name="ottewill", title="Ottewill's pair", ask=ask)
