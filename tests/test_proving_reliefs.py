"""Reliefs that cancel the deflection at one torque and show at every other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearpoly.proving.compliance import BENCH_LAWS
from gearpoly.proving.drawn import BENCH_PAIRS, draw, make_pair
from gearpoly.proving.effects import apply
from gearpoly.proving.ground import plan
from gearpoly.proving.recipes import recipe
from gearpoly.proving.reliefs import cancelling, mean_tooth, over_a_pitch, sag, spanning
from gearpoly.proving.rig import Rig, ideal
from gearpoly.proving.scenes import design_torque


@pytest.mark.parametrize("name", BENCH_PAIRS)
@pytest.mark.parametrize("law", BENCH_LAWS)
def test_ripple_vanishes_at_the_design_torque_only(name: str, law: str) -> None:
    pair = make_pair(name)
    torque = design_torque(pair)
    rig = replace(ideal(pair), law=law, deflect=True)
    one, two = cancelling(rig, torque)
    whole = apply(apply(rig, one), two)
    bare = {part: over_a_pitch(rig, part * torque).std() for part in (0.02, 0.5, 1.0)}
    left = {part: over_a_pitch(whole, part * torque).std() for part in (0.02, 0.5, 1.0)}
    assert left[1.0] < 0.13 * bare[1.0]  # what straight reliefs cannot follow of teeth that are softer at their tips
    assert left[0.5] > 4 * left[1.0]
    assert left[0.02] > 6 * left[1.0]
    assert left[0.02] > 10 * bare[0.02]
    # With even stiffness the amount were F/k itself; softer tips share less, so less relief does.
    for effect in (one, two):
        assert 0.75 < effect.size / sag(rig, torque) < 1.0


@pytest.mark.parametrize("index", [1, 2])
def test_relief_begins_where_single_contact_ends(index: int) -> None:
    """From there to the tip the contact goes (eps - 1) base pitches along the path, which is roll length."""
    pair = make_pair("18/25 m2")
    g = pair.gear(index)
    start = g.roll(g.r_a - spanning(pair, index))
    assert g.l_tip - start == pytest.approx((pair.eps - 1) * pair.p_b, rel=1e-12)


def test_drawn_teeth_are_cancelled_as_they_are() -> None:
    """What is left is counted against the rigid teeth of the pair file, slopes included."""
    pair = make_pair("15/28 m1.5 shifted")
    rng = np.random.default_rng(3)
    rig = Rig(
        pair=pair, teeth_1=draw(pair.driving, 5, -60.0, rng), teeth_2=draw(pair.driven, 5, -60.0, rng),
        eccentric_1=(20.0, 10.0),
    )  # fmt: skip
    torque = design_torque(pair)
    one, two = cancelling(rig, torque)
    rigid = mean_tooth(rig)
    assert rigid.eccentric_1 == (0.0, 0.0)
    declared = over_a_pitch(rigid, torque)
    bare = over_a_pitch(replace(rigid, deflect=True), torque) - declared
    left = over_a_pitch(replace(apply(apply(rigid, one), two), deflect=True), torque) - declared
    assert left.std() < 0.25 * bare.std()  # the slopes, 1 um, move where the load is handed over


def test_the_ground_conceals_both_and_declares_neither() -> None:
    entry = next(e for e in plan(3) if e.klass == "cancelling")
    made = recipe(entry, np.random.default_rng([3, entry.index]))
    assert made.cancels
    assert not made.deflect
    assert [effect.physics for effect in made.effects] == ["tooth_deflection"]
    torques = [c.torque for c in made.conditions]
    assert max(torques) == pytest.approx(design_torque(make_pair(made.pair)), abs=1e-3)
    assert min(torques) < 0.05 * max(torques)
