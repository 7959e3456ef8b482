"""Kinds of error of grade 4: what pitch and thickness do, and what the profile adds."""

from __future__ import annotations

import numpy as np

from gearpoly.studies.paper.base import (
    PAPER_POSITIONS,
    PairRecipe,
    PaperAnswer,
    PaperRow,
    PaperStudy,
    Question,
    make_pair,
    peak_to_peak,
    touch,
    verdict,
)
from gearpoly.studies.paper.picture import Line, Panel, PaperPicture
from gearpoly.units import DEG, UM, FloatArray

PAPER = (2.8083, 2.7167, 0.2)
"""arcmin. TEpp of the paper's first set: all errors, pitch and thickness only, profile only."""
PITCH_AND_THICKNESS_LESS, PROFILE_SHARE = 3.26, 7.12
"""Per cent by which pitch and thickness alone give less than all, and share of profile alone in all."""

KINDS_OF_ERROR = ("all errors", "pitch and thickness", "profile")


def curves(recipe: PairRecipe, *, seed: int) -> list[FloatArray]:
    """TE (361,) in rad of one draw with all its errors, its pitch and thickness alone, and its profiles alone."""
    kinds = (recipe, recipe.with_(profile="none"), recipe.with_(pitch=False, thickness="none"))
    return [touch(make_pair(kind, seed=seed), PAPER_POSITIONS).te for kind in kinds]


def ask(study: PaperStudy) -> PaperAnswer:
    """The three kinds for every set, with scattered (the paper's) and with smooth profiles."""
    base = PairRecipe(points=study.points)
    found = {
        profile: np.array([_measures(curves(base.with_(profile=profile), seed=seed)) for seed in range(study.sets)])
        for profile in ("scatter", "smooth")
    }
    mean, low, high = (function(found["scatter"], axis=0) for function in (np.mean, np.min, np.max))
    smooth = np.mean(found["smooth"], axis=0)
    one = found["scatter"][0]
    cycle = np.arange(0.0, 18 * 360.0, study.refine) * DEG
    whole = [peak_to_peak(touch(make_pair(base, seed=seed), cycle).te) for seed in range(study.sets)]
    rank = int(np.sum(found["scatter"][:, 0] < PAPER[0]))
    rows = (
        PaperRow(
            what="grade 4, first set, all errors: TEpp",
            paper="2.8083'",
            gearpoly=f"{one[0]:.4f}' (first set); {mean[0]:.2f}' mean, {low[0]:.2f}' to {high[0]:.2f}' over "
            f"{study.sets} sets",
            verdict=verdict(low[0] <= PAPER[0] <= high[0], 0.5 < mean[0] / PAPER[0] < 2.0),
            why=(
                f"the paper's set is one draw; {rank} of {study.sets} sets here stay below it. The angle goes with "
                f"1/r_b, and "
                "m = 2 mm is a guess: see the inverse problem"
            ),
        ),
        PaperRow(
            what="pitch and thickness only",
            paper="2.7167', 3.26 % less",
            gearpoly=f"{one[1]:.4f}', {one[3]:.1f} % less; mean {mean[3]:.1f} %, {low[3]:.1f} to {high[3]:.1f} %",
            verdict=verdict(low[3] <= PITCH_AND_THICKNESS_LESS <= high[3], 0.0 < mean[3] < 20.0),
            why=f"pitch makes nearly all of it. Smooth profiles, which hold their whole slope: {smooth[3]:.1f} % less",
        ),
        PaperRow(
            what="profile only",
            paper="0.2', 7.12 % of all",
            gearpoly=f"{one[2]:.4f}', {one[4]:.1f} % of all; mean {mean[2]:.3f}' and {mean[4]:.1f} %",
            verdict=verdict(low[4] <= PROFILE_SHARE <= high[4], mean[4] < 25.0),
            why=(
                "of 2000 scattered points the highest touch, and their heights differ little; the same um give "
                "fewer arcmin at a "
                f"larger module. Smooth profiles: {smooth[2]:.2f}' and {smooth[4]:.0f} %"
            ),
        ),
        PaperRow(
            what="pitch sets amplitude and waveform, profile adds ripple",
            paper="stated",
            gearpoly=f"correlation of the curves with and without profile errors {mean[5]:.3f} (least {low[5]:.3f})",
            verdict=verdict(bool(low[5] > 0.95), bool(mean[5] > 0.8)),
            why="the curves lie on each other but for the ripple",
        ),
    )
    picture = _picture(curves(base, seed=0), base.gears[1].r_b)
    return PaperAnswer(
        rows=rows,
        pictures=(picture,),
        text=_text(whole, float(mean[0])),
        values={"scatter": found["scatter"], "smooth": found["smooth"], "cycle": whole},
    )


def _text(whole: list[float], first_turn: float) -> tuple[str, ...]:
    """TEpp in arcmin of ``whole`` hunting cycles beside the mean of the first turn alone."""
    return (
        "One turn of the driven gear holds 25 of the 450 meshes after which the same teeth meet again. Over that "
        f"whole cycle (18 turns) TEpp is {np.mean(whole):.2f}' on average, {np.min(whole):.2f}' to "
        f"{np.max(whole):.2f}', against {first_turn:.2f}' in the first turn: a figure of one turn depends on where it "
        "begins.",
    )


def _picture(first: list[FloatArray], r_b2: float) -> PaperPicture:
    """The curves (N,) in rad of all errors and of each kind alone; ``r_b2`` in mm."""
    angle = PAPER_POSITIONS / DEG
    return PaperPicture(
        name="kinds",
        caption="First set of grade 4: all errors, and each kind alone.",
        panels=(
            Panel(
                x="driven angle / deg",
                y="TE along the line of action / um",
                lines=tuple(
                    Line(x=angle, y=te * r_b2 / UM, colour=k, label=KINDS_OF_ERROR[k], style="line")
                    for k, te in enumerate(first)
                ),
            ),
        ),
    )


def _measures(te: list[FloatArray]) -> tuple[float, ...]:
    """TEpp of the three kinds in arcmin, per cent that the second is below and the third of the first, and the first
    two curves' correlation."""
    whole, pitch, profile = (peak_to_peak(curve) for curve in te)
    like = float(np.corrcoef(te[0], te[1])[0, 1])
    return whole, pitch, profile, 100.0 * (1.0 - pitch / whole), 100.0 * profile / whole, like


QUESTION = Question(order=3, name="kinds", title="Kinds of error", ask=ask)
