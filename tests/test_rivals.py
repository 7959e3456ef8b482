"""What a rival costs, and which doubts count, when probabilities of one place are shared."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearpoly.diagnose.contest import Refitted
from gearpoly.diagnose.earned import _doubted
from gearpoly.diagnose.fidelity import BESIDE_ANOTHER, FAINT_EFFECT_MM
from gearpoly.diagnose.judge import Judged, _as_far_as_simulated, _as_other_tips, _behind, _told_apart
from gearpoly.diagnose.trial import Trial
from gearpoly.infer.posterior import Explanation, Posterior
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import UM
from tests.made_diagnosis import findings

SPALL = (30.0, 47.2, 48.8, 0.01)
CHIP = (1.0, 1.6)


def claim(name: str, values: tuple[float, ...], **place: Any) -> Claim:
    return Claim(physics=catalogue()[name], place=Place(gear=1, tooth=18, **place), values=values)


def tip_at(r_a: float, *flanks: str) -> Any:
    """A model of two gears of module 2 with tip circles of this radius in mm, recorded on one flank or more."""
    return SimpleNamespace(
        scope=SimpleNamespace(gears=(SimpleNamespace(r_a=r_a, m=2.0),) * 2),
        as_built=SimpleNamespace(flanks=flanks or ("drive",)),
    )


def test_a_freedom_costs_what_it_might_have_told() -> None:
    """Schwarz (1978): half the log of the data for each; a refit has counted one (Akaike) for each already."""
    spall, chip = claim("tooth_spall", SPALL), claim("tooth_chip", CHIP)
    gain, far = 14035.5, tip_at(60.0)
    two = 2.0 * (math.log(gain) - 2.0)
    assert _behind(far, chip, Refitted(claim=spall, behind=1.23), gain) == pytest.approx(1.23 + two)
    # The other way round the simpler one is ahead, though it fits a little worse.
    assert _behind(far, spall, Refitted(claim=chip, behind=1.23), gain) == pytest.approx(1.23 - two)
    assert _behind(far, spall, Refitted(claim=spall, behind=3.0), gain) == 3.0
    # One that fits better is ahead: as if level it fell with the claim, below causes that it had beaten.
    assert _behind(far, spall, Refitted(claim=spall, behind=-57.8), gain) == -57.8
    # Data that hardly tell one freedom from none cannot tell two from one.
    assert _behind(far, chip, Refitted(claim=spall, behind=0.5), 4.0) == 0.5


def test_a_missing_tip_and_a_pit_that_ends_at_the_tip_circle_are_one_as_likely_as_the_other() -> None:
    """Both say that the flank is gone there, and no tip breaks off with the sharp edge that is drawn: up to a tenth of
    the gain. The pit's end, depth and wall then tell nothing, so they cost nothing; but one pit of four reaches the
    tip. Of a pit whose edge lies a tenth of a module below the tip circle, or of a larger difference, nothing of the
    kind is known: three freedoms less cost less (Schwarz 1978), and a refit counts 2 for each."""
    spall, chip = claim("tooth_spall", SPALL), claim("tooth_chip", CHIP)
    gain = 2000.0
    at_tip, below = tip_at(SPALL[2]), tip_at(SPALL[2] + 0.2)
    freedoms = len(SPALL) - len(CHIP)
    dearer = freedoms * (math.log(gain) - 2.0)
    for fits in (130.0, 5.0, -130.0):
        assert _behind(at_tip, spall, Refitted(claim=chip, behind=fits - 2.0 * freedoms), gain) == -math.log(16.0)
        assert _behind(at_tip, chip, Refitted(claim=spall, behind=fits + 2.0 * freedoms), gain) == math.log(16.0)
    # The coast flank tells a pit of the drive flank, and the tip alone is excused by how its edge was drawn.
    both = tip_at(SPALL[2], "drive", "coast")
    far = 130.0 - 2.0 * freedoms
    assert _behind(both, spall, Refitted(claim=chip, behind=far), gain) == pytest.approx(min(far - dearer, 0.0))
    far = 130.0 + 2.0 * freedoms
    assert _behind(both, chip, Refitted(claim=spall, behind=far), gain) == pytest.approx(far + dearer)
    for tip, fits in ((at_tip, 300.0), (below, 130.0)):
        far = fits - 2.0 * freedoms
        assert _behind(tip, spall, Refitted(claim=chip, behind=far), gain) == pytest.approx(far - dearer)
    assert _behind(below, chip, Refitted(claim=spall, behind=5.0), gain) == pytest.approx(5.0 + dearer)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_once_per_turn_a_claim_is_ahead_or_behind_by_no_less_than_the_simulation_is_known_to(sense: float) -> None:
    """4 sigma of what the simulation may be wrong by are taken off what 10 sigma tell, whoever is ahead. Beside a pure
    first order of 7 um an eccentric gear was 10 sigma behind what has no cause, and lost its name and the encoder's."""
    samples, noise = 10_000, 0.3e-3
    doubt = 100.0 * FAINT_EFFECT_MM / noise
    assert doubt == pytest.approx(4.0)
    trial = SimpleNamespace(
        dispersion=1.0,
        plain=SimpleNamespace(samples=samples),
        linear=SimpleNamespace(noises=[SimpleNamespace(innovation=noise)]),
    )
    one = Claim(physics=catalogue()["eccentricity"], place=Place(gear=1), values=(1.0, 0.0))
    mine = 100.0

    def told(sigmas: float) -> float:
        other = Explanation(claim=None, log_evidence=mine - sense * 0.5 * sigmas**2, weight=1.0)
        standing = Explanation(claim=one, log_evidence=mine, weight=1.0)
        kept, moved = _as_far_as_simulated(cast("Trial", trial), one, [standing, other], FAINT_EFFECT_MM)
        assert kept.log_evidence == mine
        return moved.log_evidence

    assert told(3.9) == mine
    assert told(10.0) == pytest.approx(mine - sense * 0.5 * 6.0**2)


def test_wear_of_either_gear_under_load_is_told_by_more_than_laws_leave() -> None:
    """Where teeth give by 15 um, laws may be 0.06 um off, 9.4 sigma of 24 000 samples with 1 um of noise: the mate's
    wear 5.7 sigma behind is as likely, one 20 sigma behind by 10.6 sigma less, and what has no cause counts as it is.
    Unloaded only chords and contacts are left, 0.012 um or 1.9 sigma."""
    samples, noise = 24_000, 1.0 * UM
    trial = SimpleNamespace(
        dispersion=1.0,
        plain=SimpleNamespace(samples=samples),
        linear=SimpleNamespace(noises=[SimpleNamespace(innovation=noise)]),
    )
    wear = [Claim(physics=catalogue()["wear"], place=Place(gear=gear), values=(14.0,)) for gear in (0, 1)]
    relief = Claim(physics=catalogue()["tip_relief"], place=Place(gear=0), values=(1.0, 0.5))

    def told(deflection: float) -> list[float]:
        behind = [(wear[0], 0.0), (wear[1], 5.7), (relief, 20.0), (None, 5.7)]
        these = [Explanation(claim=one, log_evidence=-0.5 * by**2, weight=1.0) for one, by in behind]
        found = _told_apart(cast("Trial", trial), wear[0], these, effect=[np.ones(1)], deflection=deflection)
        return [math.sqrt(-2.0 * one.log_evidence) for one in found]

    faint = math.sqrt(samples) * BESIDE_ANOTHER * 15.0
    assert told(15.0 * UM) == pytest.approx([0.0, 0.0, 20.0 - faint, 5.7])
    assert told(0.0) == pytest.approx(
        [0.0, 5.7 - math.sqrt(samples) * FAINT_EFFECT_MM / UM, 20.0 - 1.859, 5.7], abs=1e-3
    )


@pytest.mark.parametrize(("by_columns", "fitted"), [(0.9, 0.1), (0.1, 0.9)])
@pytest.mark.parametrize(("name", "values"), [("tooth_crack", (0.6,)), ("tooth_spall", SPALL)])
def test_of_a_tooth_the_unknown_counts_that_leaves_the_claim_less(
    name: str, values: tuple[float, ...], by_columns: float, fitted: float
) -> None:
    """Whatever its shape, a flank does the same under every torque: that none fits says nothing for a crack where what
    is free under every torque was likelier. Of a pit a curve that was fitted may have come to rest too early, and one
    of columns knows nothing of teeth that lose touch."""
    one = claim(name, values)
    judged = Judged(gain=100.0, posterior=Posterior(claims=((one, 1.0 - by_columns),), unknown=by_columns, nothing=0.0))
    told = _doubted(one, judged, fitted).posterior
    assert told.unknown == pytest.approx(0.9)
    assert told.of(one) + told.unknown == pytest.approx(1.0)
    assert _doubted(one, judged, None) is judged


def test_a_head_is_likelier_than_not_or_one_of_several() -> None:
    """Of two equal gears either may run off its axis, and either encoder: no one of four heads the others alone."""
    one = findings()[0]
    alone = one.says
    assert replace(one, probability=0.51).says == alone
    assert replace(one, probability=0.27, rivals=3 * one.rivals).says == (
        f"One of 4 that look alike here, of which none is likelier than not: {alone}"
    )
    # What has no rival is not one of anything.
    assert replace(one, probability=0.27, rivals=()).says == alone


@pytest.mark.parametrize(
    ("physics", "values", "inspected", "flanks", "open_"),
    [
        ("tip_relief", (10.0, 0.3), False, 1, True),  # 0.15 of a module of 2 mm
        ("tip_relief", (10.0, 0.3), False, 2, True),
        ("tip_relief", (10.0, 0.3), True, 1, False),
        ("tip_relief", (10.0, 0.6), False, 1, False),
        ("centre_distance", (30.0,), False, 1, True),
        ("centre_distance", (30.0,), False, 2, False),
        ("centre_distance", (30.0,), True, 1, False),
        ("wear", (10.0,), False, 1, False),
    ],
)
def test_tips_that_nobody_measured_do_what_little_off_a_tip_does(
    physics: str, values: tuple[float, ...], inspected: bool, flanks: int, open_: bool
) -> None:
    """A tip circle that is off moves where pairs take over on both flanks alike, and so does a relief of a few tenths
    of a mm; a longer one is seen on its own way up the flank."""
    gear = None if physics == "centre_distance" else 0
    one = Claim(physics=catalogue()[physics], place=Place(gear=gear), values=values)
    model: Any = SimpleNamespace(
        scope=SimpleNamespace(inspected=(inspected, inspected), gears=(SimpleNamespace(m=2.0),) * 2),
        as_built=SimpleNamespace(flanks=("drive", "coast")[:flanks]),
    )
    assert _as_other_tips(model, one) is open_
