"""The root against the brute-force envelope of the rounded rack, and what is known of it in closed
form."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from gearpoly.errors import GeometryError
from gearpoly.gear.deviations import Deviations, Index
from gearpoly.gear.flank import Flanks, draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.gear.polygon import gear_polygon, tooth_polygons
from gearpoly.gear.rack import Rack
from gearpoly.gear.root import draw_root, fillet_point, form_point
from gearpoly.units import DEG, UM
from tests.oracles.rack_envelope import Cut, can_be_cut, face, half_tooth

M = 2.0  # mm; the root scales with m, so one module will do

RACKS = {
    "A": Rack(),
    "C": Rack(rho_fP=0.25),
    "D": Rack(h_fP=1.4, rho_fP=0.39),
    # A hair under the largest round: the flat between the rounds is 1e-9 m wide.
    "full radius": Rack(rho_fP=Rack().rho_fP_max - 2e-9),
    "sharp": Rack(rho_fP=0.0),
    "14.5 deg": Rack(alpha=14.5 * DEG),
    "25 deg": Rack(alpha=25.0 * DEG, rho_fP=0.3),
    "deep": Rack(h_aP=1.25, h_fP=1.5, rho_fP=0.2),
}
TEETH = (8, 9, 11, 14, 17, 18, 25, 60, 200)
SHIFTS = (-0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0)

PROMISE = 0.1 * UM
"""What the root is promised to."""
FLOOR = 1e-9
"""mm. Vertices lie on the envelope itself: what remains is the zoom of the oracle and rounding."""


def cut_of(z: int, x: float, rack: Rack) -> Cut:
    return Cut(z=z, m=M, x=x, alpha=rack.alpha, h_aP=rack.h_aP, h_fP=rack.h_fP, rho_fP=rack.rho_fP)


def flanks_or_none(z: int, x: float, rack: Rack) -> Flanks | None:
    try:
        return draw_flanks(Gear(z=z, m=M, x=x, rack=rack), chord_error=0.02 * UM)
    except GeometryError:
        return None


def worst(flanks: Flanks, cut: Cut) -> tuple[float, float]:
    """Distance in mm of the envelope from the drawn face, and of the face's vertices from the
    envelope along their circle."""
    line = shapely.LineString(flanks.drive[0])
    off = float(np.max(shapely.distance(shapely.points(face(cut, n=60)), line)))
    # At the root circle itself the envelope's angle is the tool's whole flat; start just above.
    above = np.flatnonzero(flanks.r > cut.r_root * (1.0 + 1e-9))
    some = above[:: max(1, above.size // 40)]
    gap = flanks.psi_drive[0, some] - half_tooth(cut, flanks.r[some])
    return off, float(np.max(np.abs(flanks.r[some] * gap)))


@pytest.mark.long
@pytest.mark.parametrize("shifts", [SHIFTS[::3], pytest.param(SHIFTS, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", RACKS)
def test_face_is_the_envelope_of_the_rack(name: str, shifts: tuple[float, ...]) -> None:
    drawn = 0
    for z in TEETH:
        for x in shifts:
            cut = cut_of(z, x, RACKS[name])
            flanks = flanks_or_none(z, x, RACKS[name])
            # Refused or drawn, the rack itself decides which is right.
            assert can_be_cut(cut) == (flanks is not None), f"z = {z}, x = {x}"
            if flanks is None:
                continue
            drawn += 1
            off, vertices = worst(flanks, cut)
            assert off < PROMISE, f"z = {z}, x = {x}"
            assert vertices < FLOOR, f"z = {z}, x = {x}"
    assert drawn > 0.64 * len(TEETH) * len(shifts)  # the others are pointed


def test_the_oracle_sees_a_wrong_fillet() -> None:
    # Planted fault: the gear's rack has a round 2 % smaller than the tool that the oracle uses.
    gear = Gear(z=18, m=M, rack=Rack(rho_fP=0.38 * 0.98))
    off, vertices = worst(draw_flanks(gear), cut_of(18, 0.0, Rack()))
    assert off > 10 * PROMISE
    assert vertices > 1000 * FLOOR


@pytest.mark.parametrize(("z", "x"), [(4, -0.8), (4, -0.5), (5, -0.8), (6, -0.8), (12, 1.0)])
def test_a_gear_that_the_rack_destroys_is_refused(z: int, x: float) -> None:
    assert not can_be_cut(cut_of(z, x, Rack()))
    with pytest.raises(GeometryError):
        draw_flanks(Gear(z=z, m=M, x=x))


def undercut_limit(rack: Rack) -> float:
    """Teeth, not whole, at which the rack's straight flank ends at the interference point: 2 (h_fP
    - rho (1 - sin)) / sin^2."""
    sine = math.sin(rack.alpha)
    return 2.0 * (rack.h_fP - rack.rho_fP * (1.0 - sine)) / sine**2


@pytest.mark.parametrize(("rack", "limit"), [(Rack(), 17.1), (Rack(rho_fP=0.0), 21.4)])
def test_undercut_sets_in_below_the_known_number_of_teeth(rack: Rack, limit: float) -> None:
    assert undercut_limit(rack) == pytest.approx(limit, abs=0.05)  # one decimal is published
    z = math.floor(limit)
    assert draw_root(Gear(z=z, m=M, rack=rack)).undercut
    assert not draw_root(Gear(z=z + 1, m=M, rack=rack)).undercut


def shift_at_limit(z: int) -> float:
    """Profile shift at which the flank ends at the interference point: z sin^2/2 = h_fP - rho (1 -
    sin) - x."""
    sine = math.sin(Rack().alpha)
    return 1.25 - 0.38 * (1.0 - sine) - 0.5 * z * sine**2


@pytest.mark.parametrize("z", [8, 12, 17])
def test_profile_shift_ends_undercut_where_the_formula_says(z: int) -> None:
    x = shift_at_limit(z)
    assert draw_root(Gear(z=z, m=M, x=x - 1e-3)).undercut
    root = draw_root(Gear(z=z, m=M, x=x + 1e-9))
    assert not root.undercut
    # The flank's end moves by m dx / sin(alpha) along the base tangent.
    assert root.l_form == pytest.approx(1e-9 * M / math.sin(Rack().alpha), rel=1e-4)


@pytest.mark.parametrize("z", [8, 12, 17])
@pytest.mark.parametrize("less", [1e-5, 1e-7, 1e-9, 1e-12])
def test_the_slightest_undercut_is_a_gear_too(z: int, less: float) -> None:
    # What the trochoid cuts off shrinks with the shift that is missing: 3e-3 mm at 1e-3 (measured).
    root = draw_root(Gear(z=z, m=M, x=shift_at_limit(z) - less))
    assert 0.0 <= root.l_form < 1e-3


@pytest.mark.parametrize("z", [18, 25, 40, 200])
@pytest.mark.parametrize("x", [0.0, 0.4])
def test_true_form_circle(z: int, x: float) -> None:
    # ISO 21771, d_Ff of a rack-cut gear, with h = (h_fP - rho (1 - sin) - x) m:
    # d_Ff^2 = (d sin - 2 h / sin)^2 + d_b^2.
    gear = Gear(z=z, m=M, x=x)
    sine = math.sin(gear.alpha)
    h = (1.25 - 0.38 * (1.0 - sine) - x) * M
    d_Ff = math.sqrt((2 * gear.r * sine - 2 * h / sine) ** 2 + (2 * gear.r_b) ** 2)
    root = draw_root(gear)
    assert 2 * root.r[-1] == pytest.approx(d_Ff, rel=1e-14)  # float64
    assert not root.undercut


@pytest.mark.parametrize(("z", "x"), [(18, 0.0), (25, 0.3), (12, 0.5), (200, -0.5)])
def test_fillet_meets_the_involute_without_a_kink(z: int, x: float) -> None:
    gear = Gear(z=z, m=M, x=x)
    gamma, l_form, undercut = form_point(gear)
    assert not undercut
    step = 1e-6  # central differences: truncation 1e-12, rounding 1e-10
    r, psi = fillet_point(gear, np.array([gamma - step, gamma, gamma + step]))
    assert psi[1] == pytest.approx(gear.psi(float(r[1])), abs=1e-14)
    slope_fillet = (psi[2] - psi[0]) / (r[2] - r[0])
    # An involute's angle falls by l / (r r_b) per radius: d inv(alpha_r)/dr = tan(alpha_r)/r.
    slope_involute = -l_form / (float(r[1]) * gear.r_b)
    assert slope_fillet == pytest.approx(slope_involute, abs=1e-7)


def test_undercut_fillet_crosses_the_involute() -> None:
    gear = Gear(z=10, m=M)
    gamma, l_form, undercut = form_point(gear)
    r, psi = fillet_point(gear, np.array(gamma))
    assert undercut
    assert float(psi) == pytest.approx(gear.psi(float(r)), abs=1e-14)  # float64 of the crossing
    assert gear.roll_length(float(r)) == pytest.approx(l_form, rel=1e-12)


def test_undercut_leaves_a_waist() -> None:
    flanks = draw_flanks(Gear(z=8, m=M, x=-0.5))
    half = flanks.drive[0, :, 1]
    waist = int(np.argmin(half[: flanks.root.n]))
    assert flanks.root.undercut
    assert half[waist] < np.max(half[flanks.root.n :])  # the tooth is wider above its waist


@pytest.mark.parametrize("name", RACKS)
def test_teeth_and_gears_are_valid_polygons(name: str) -> None:
    for z in (8, 17, 40):
        for x in (-0.5, 0.0, 0.2):
            try:
                gear = Gear(z=z, m=M, x=x, rack=RACKS[name])
            except GeometryError:
                continue
            flanks = draw_flanks(gear, points=60)
            centres = -gear.tau * np.arange(z)
            teeth = tooth_polygons(flanks, centres)
            whole = gear_polygon(flanks, centres)
            assert all(tooth.is_valid for tooth in teeth)
            assert whole.is_valid
            # Chords between mid spaces close the teeth; with their polygon the teeth fill the gear.
            hub = 0.5 * z * gear.r_f**2 * math.sin(gear.tau)
            hole = sum(shapely.Polygon(ring).area for ring in whole.interiors)
            area = sum(tooth.area for tooth in teeth) + hub - hole
            assert whole.area == pytest.approx(area, rel=1e-12)  # sums of 1e4 products


@pytest.mark.parametrize("alpha", [17.5 * DEG, 20.0 * DEG, 22.5 * DEG])
def test_full_radius_rack(alpha: float) -> None:
    # The largest round leaves a flat of no width, and rounding must not make that a crossing.
    largest = Rack(alpha=alpha, rho_fP=0.2).rho_fP_max
    rack = Rack(alpha=alpha, rho_fP=largest)
    for z in (12, 15, 26, 27, 40, 113):
        gear = Gear(z=z, m=M, rack=rack)
        flanks = draw_flanks(gear, points=60)
        assert gear_polygon(flanks, -gear.tau * np.arange(z)).is_valid


@pytest.mark.parametrize(("index", "past"), [(50.0, False), (70.0, True)])
def test_a_root_turned_past_the_middle_of_its_space_stays_on_its_own_side(index: float, past: bool) -> None:
    """Five teeth, shift -0.5: a root begins 12.87 mrad from the middle of its space, and an index deviation turns it by
    its size over r_b = 5 cos(20 deg) = 4.70 mm: 60.5 um reach the middle."""
    gear = Gear(z=5, m=2.0, x=-0.5)
    drive = np.array([index, 0.0, 0.0, 0.0, 0.0]) * UM
    flanks = draw_flanks(gear, Deviations(drive=(Index(drive),)), points=60)
    root = slice(1, flanks.root.n)
    turned = flanks.root.psi[root] + drive[0] / gear.r_b
    assert (turned[0] > flanks.root.psi[0]) == past
    here = turned <= flanks.root.psi[0]
    # Rounding of angles near 1 rad.
    np.testing.assert_allclose(flanks.psi_drive[0, root][here], turned[here], rtol=0.0, atol=1e-12)
    assert (flanks.psi_drive <= flanks.root.psi[0]).all()
    lines = np.arange(5) * gear.tau
    tooth_polygons(flanks, lines)  # raises where an outline crosses itself
    gear_polygon(flanks, lines)
