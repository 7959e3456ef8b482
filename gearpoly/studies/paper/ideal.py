"""Two gears without deviations: no transmission error, no backlash, and the contact ratio of theory."""

from __future__ import annotations

import numpy as np

from gearpoly.mesh.transmission import FlankContacts, mean_pairs
from gearpoly.studies.paper.base import (
    PAPER_POSITIONS,
    PairRecipe,
    PaperAnswer,
    PaperRow,
    PaperStudy,
    Question,
    backlash,
    make_pair,
    peak_to_peak,
    touch,
    verdict,
)
from gearpoly.studies.paper.picture import Line, Panel, PaperPicture
from gearpoly.units import DEG, UM, FloatArray

RATIO = 1.570708
"""ISO 21771 contact ratio of 18/25 teeth, 20 deg, standard addenda."""


def ask(study: PaperStudy) -> PaperAnswer:
    """TE, backlash and touching pairs of the ideal research pair, at the paper's 361 positions and exactly."""
    pair = make_pair(PairRecipe(points=study.points), seed=None)
    drive, j_bn = backlash(pair, PAPER_POSITIONS)
    counted = int(np.sum(drive.pairs))
    # Every pitch of an ideal pair is like every other, so one holds the mean over any number of turns.
    pitch = np.arange(200, dtype=np.float64) * (pair.driven.gear.tau / 200)
    exact = mean_pairs(pair, touch(pair, pitch))
    te_um = drive.te * pair.r_b2 / UM
    chord = pair.chord_noise / UM
    rows = (
        PaperRow(
            what="ideal gears: transmission error",
            paper="0 everywhere",
            gearpoly=f"TEpp {np.ptp(te_um):.5f} um = {peak_to_peak(drive.te):.5f}'",
            verdict=verdict(float(np.ptp(te_um)) <= 1.01 * chord, False),
            why=f"chords of {study.points} points stand off by up to {chord:.5f} um, and no more is seen",
        ),
        PaperRow(
            what="ideal gears: backlash",
            paper="0 everywhere",
            gearpoly=f"{np.min(j_bn) / UM:.5f} to {np.max(j_bn) / UM:.5f} um",
            verdict=verdict(float(np.max(j_bn)) / UM <= 2.02 * chord, False),
            why="the same chords, on both flanks",
        ),
        PaperRow(
            what="ideal gears: contact ratio",
            paper="theory 1.5707; counted 1.5709, said to be 0.52 % off",
            gearpoly=f"exact mean {exact:.5f} (theory {pair.eps_alpha:.6f}); {counted}/361 = {counted / 361:.4f}",
            verdict=verdict(abs(exact - RATIO) < 5e-4, abs(exact - RATIO) < 0.01),
            why=(
                f"0.52 % would be 1.5789 = 570/361, not 1.5709; at the same 361 positions gearpoly counts {counted}. "
                "At the first and last position, and wherever contact begins, a count hangs on the last digit"
            ),
        ),
    )
    picture = _picture(te_um, drive)
    return PaperAnswer(
        rows=rows,
        pictures=(picture,),
        text=(),
        values={"te_um": te_um, "j_um": j_bn / UM, "counted": counted, "exact": exact, "chord_um": chord},
    )


def _picture(te_um: FloatArray, drive: FlankContacts) -> PaperPicture:
    """What chords leave of the transmission error, and how many pairs touch."""
    angle = PAPER_POSITIONS / DEG
    first = angle <= 60.0
    return PaperPicture(
        name="ideal",
        caption="Ideal pair: what is left of TE is the height of the chords; touching pairs at the paper's positions.",
        tall=True,
        panels=(
            Panel(
                x="driven angle / deg",
                y="TE along the line\nof action / nm",
                lines=(Line(x=angle[first], y=1e3 * te_um[first], style="line"),),
            ),
            Panel(
                x="driven angle / deg",
                y="touching pairs",
                lines=(Line(x=angle[first], y=drive.pairs[first], colour=2, style="joined"),),
            ),
        ),
    )


QUESTION = Question(order=1, name="ideal", title="The ideal pair", ask=ask)
