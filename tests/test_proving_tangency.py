"""The search for where two flanks touch: it finds the smallest opening wherever it begins, and so the equilibrium."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearpoly.proving.contact import _open, closest
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.flanks import _TIP, ToothDeviations, table
from gearpoly.proving.gears import IdealPair
from gearpoly.proving.rig import Rig, meshing

THETA_2 = -6.23172639549104
"""rad: a mesh begins here, and the driving tooth touches near its lowest point."""
PITCH_1, SLOPE_1, CROWNING_1 = 14.842954987195216, -5.758142010802198, 21.07423924420764
PITCH_2, SLOPE_2, CROWNING_2 = 0.6289532385359945, -0.9675611339478215, -1.3432185163776455
"""um: the two teeth that meet there. A crowning of 21 um bends the driving flank by ten times as much as its involute
is bent against the mate's, and the first Newton step from the lowest point leads beyond the tip."""
BEFORE_1, BEFORE_2 = (7.37363248, -5.8741917), (-5.29391935, -2.05119816)
"""um: pitch and slope of the teeth in mesh before them."""


def pinion() -> IdealPair:
    return make_pair("12/47 m0.5 shifted")


def teeth(index: int) -> ToothDeviations:
    z = pinion().gear(index).z
    one = index == 1
    p, slope = np.zeros(z), np.zeros(z)
    # Mesh -46 is that of tooth 2 of 12 and 1 of 47; mesh -47 comes before it.
    here, before = (2, 1) if one else (1, 0)
    p[here], slope[here] = (PITCH_1, SLOPE_1) if one else (PITCH_2, SLOPE_2)
    p[before], slope[before] = BEFORE_1 if one else BEFORE_2
    crowning = np.full(z, CROWNING_1 if one else CROWNING_2)
    return replace(ToothDeviations.ideal(z, -40.0 if one else -36.0), p=p, slope=slope, crowning=crowning)


def opening(turn_um: float) -> tuple[float, ...]:
    """What `closest` takes of mesh -46, behind its limits: centre distance, angles of both gears, and the flanks. The
    driving gear stands ``turn_um`` along the line of action from where it would without deviations."""
    pair = pinion()
    g, h = pair.driving, pair.driven
    theta_1 = (h.r_b * THETA_2 + 1e-3 * turn_um) / g.r_b
    B1 = -pair.alpha_w + pair.l_work(1) / g.r_b + theta_1 + 46 * g.tau
    B2 = -pair.alpha_w + pair.l_work(2) / h.r_b - THETA_2 - 46 * h.tau
    rows = table(pair, 1, teeth(1), "drive")[2], table(pair, 2, teeth(2), "drive")[1]
    return pair.a, 0.0, B1, g.r_b, B2, h.r_b, *rows  # type: ignore[return-value]


@pytest.mark.parametrize("turn_um", [-15.0, -9.0, -5.5, -2.286, 0.0, 4.7])
def test_a_flank_that_bends_more_than_expected_still_shows_its_smallest_opening(turn_um: float) -> None:
    pair, rest = pinion(), opening(turn_um)
    low, tip_1, tip_2 = 0.05 * pair.driving.l_tip, float(rest[6][_TIP]), float(rest[7][_TIP])  # type: ignore[index]
    along = [o for o in (_open(l, *rest) for l in np.linspace(low, tip_1, 4001)) if o[2] <= tip_2]
    least = min(o[0] for o in along)
    # 0.55 um between two looks and a bend of 0.15 per mm leave 6e-9 mm; the search itself stays below 1e-9 mm.
    for begun in (low, 0.3, 0.6, 1.5, tip_1):
        found = closest(begun, low, tip_1, tip_2, 0.0149, *rest)
        assert found[0] == pytest.approx(least, abs=1e-8)
        assert found[1] == pytest.approx(0.4629, abs=0.005)


@pytest.mark.parametrize("crowning", [0.0, 5.0, 12.0, CROWNING_1, 40.0])
def test_the_equilibrium_there_hangs_steadily_on_the_angle(crowning: float) -> None:
    # The steepest flank here, of 40 um, slopes by 0.07: x changes by 0.07 um per um along the line of action. A search
    # that stops at the lowest point of the tooth made a jump of 1.2 um, or no equilibrium.
    one = teeth(1)
    rig = Rig(pair=pinion(), teeth_1=replace(one, crowning=np.full(12, crowning)), teeth_2=teeth(2))
    theta_2 = THETA_2 + np.arange(-600, 601) * 1e-3 / rig.pair.driven.r_b
    x = meshing(rig, theta_2, torque=0.0)
    assert np.abs(np.diff(x)).max() < 0.2e-3
