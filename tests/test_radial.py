"""The fast path against the certified polygons and against the oracle; neither shares code with its search."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from gearpoly.errors import SelfCheckError
from gearpoly.gear.deviations import Deviations, tip_relief
from gearpoly.gear.draw import draw_deviations, streams
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.gear.root import form_point
from gearpoly.gear.tolerances import default_thickness, limits_for, tolerances
from gearpoly.mesh import radial, radial_search
from gearpoly.mesh.bodies import Body
from gearpoly.mesh.contact import Closings, Feature, all_certified, closing_rotations
from gearpoly.mesh.pair import Flank, GearPair, active_start, mount, tight_centre_distance
from gearpoly.mesh.radial import closing_rotations_fast, spot_check
from gearpoly.units import UM, FloatArray
from tests.oracles.radial_gap import closing_rotation, closing_rotation_slow, closing_rotations_of_pairs

PROMISED = 1e-12
"""rad. What both kernels promise; the polygon kernel's bracket is 2.5e-13 on either side."""
ROUNDING = 2e-14
"""rad. Two exact formulations of the same polylines: ten times the rounding of coordinates of 120 mm (1.4e-14 mm)
about an axis 8 mm away, the worst pair here."""


def gears(
    z_1: int,
    z_2: int,
    *,
    points: int = 300,
    grade: int | None = None,
    rough: bool = False,
    eccentric: float = 0.0,
    wider: float = 0.0,
    relief: float = 0.0,
) -> GearPair:
    """A pair of module 2, as perfect or as spoilt as asked; all lengths in mm."""
    m = 2.0
    pair = [Gear(z=z_1, m=m), Gear(z=z_2, m=m)]
    a = tight_centre_distance(*pair)
    flanks = []
    for k, gear in enumerate(pair):
        l_start = active_start(gear, pair[1 - k], l_form=form_point(gear)[1])
        shapes = Deviations()
        if grade is not None:
            limit = tolerances(d=gear.z * m, m=m, grade=grade)
            thickness = default_thickness(a=a, m=m, alpha=gear.alpha, F_pT=limit.F_pT)
            shapes = draw_deviations(
                gear,
                limits_for(gear, grade=limit, thickness=thickness),
                rng=streams(1)[k],
                which="driving" if k == 0 else "driven",
                profile_errors="scatter" if rough else "smooth",
                roll_lengths=np.linspace(l_start, gear.l_a, points),
            ).deviations
        if relief > 0.0:
            tip = (tip_relief(gear, amount=relief, length=0.6, shape="parabolic"),)
            shapes = shapes + Deviations(drive=tip, coast=tip)
        flanks.append(draw_flanks(gear, shapes, l_start=l_start, points=points))
    return mount(
        *flanks, a=a + wider, eccentricity_1=(eccentric, 0.7), eccentricity_2=(0.7 * eccentric, 2.1)
    )  # fmt: skip


@dataclass(frozen=True)
class Run:
    """Bodies and positions of one run, as both kernels take them."""

    turning: Body
    fixed: Body
    how: dict[str, Any]

    def fast(self) -> Closings:
        return closing_rotations_fast(self.turning, self.fixed, **self.how)

    def certified(self) -> Closings:
        parts = list(closing_rotations(self.turning, self.fixed, **self.how))
        names = Closings.__dataclass_fields__
        joined: dict[str, Any] = {
            name: np.concatenate([np.atleast_1d(getattr(p, name)) for p in parts]) for name in names
        }
        return Closings(**{**joined, "positions": sum(part.positions for part in parts)})

    def check(self, closings: Closings, **options: Any) -> float:
        return spot_check(self.turning, self.fixed, closings, **self.how, **options)


def run(pair: GearPair, flank: Flank = "drive", *, positions: int = 120, near: float = 30.0 * UM) -> Run:
    """One driven turn and a bit, off the symmetric positions, with every pair that closes within ``near`` (mm)."""
    theta_2 = 0.0123 + np.linspace(0.0, 6.5, positions)
    sense = 1.0 if flank == "drive" else -1.0
    how = {
        "axis_distance": pair.a,
        "poses": -sense * theta_2,
        "guesses": sense * theta_2 / pair.ratio,
        "near": near / pair.r_b1,
    }
    return Run(pair.driving.body(flank), pair.driven.body(flank), how)


def oracle(r: Run, *, count: int = 5) -> dict[tuple[int, int, int], float]:
    """Closing of every near pair by exhaustion."""
    how = {key: value for key, value in r.how.items() if key != "near"}
    found = closing_rotations_of_pairs(r.turning.faces, r.fixed.faces, count=count, **how)
    rows = zip(*np.nonzero(found.offset <= found.offset[:, :1] + r.how["near"]), strict=True)
    return {(int(p), int(found.pair[p, k, 0]), int(found.pair[p, k, 1])): float(found.offset[p, k]) for p, k in rows}


def closings(found: Closings) -> dict[tuple[int, int, int], float]:
    rows = zip(found.pose, found.turning, found.fixed, found.rotation, strict=True)
    return {(int(p), int(i), int(j)): float(rotation) for p, i, j, rotation in rows}


SPOILT: dict[str, Any] = {"grade": 8, "eccentric": 0.03, "wider": 0.05}


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize(
    ("z_1", "z_2", "kind"),
    [
        (18, 25, {}),
        (18, 25, SPOILT),
        (18, 25, {"grade": 6, "relief": 0.02, "wider": 0.3}),
        (18, 25, {"points": 2000, "grade": 5}),
        (8, 8, SPOILT),  # deeply undercut
        (8, 60, SPOILT),
        (60, 8, {"grade": 6, "relief": 0.02}),
        (60, 60, {}),
    ],
)
def test_every_near_pair_as_the_certified_polygons_have_it(z_1: int, z_2: int, kind: Any, flank: Flank) -> None:
    r = run(gears(z_1, z_2, **kind), flank)
    fast, certified = r.fast(), r.certified()
    assert fast.positions == certified.positions == r.how["poses"].size
    for name in ("pose", "turning", "fixed", "feature"):
        np.testing.assert_array_equal(getattr(fast, name), getattr(certified, name))
    assert np.max(np.abs(fast.rotation - certified.rotation)) <= PROMISED
    # The polygon kernel reads place and normal off the witness line CERTIFIED = 2.5e-13 rad before the touch: at most
    # 60 mm away that is 1.5e-11 mm of travel, and on a slope of 1/4 it slides along a face by four times as much.
    assert np.max(np.abs(fast.point - certified.point)) <= 6e-11
    # That slide turns the normal by itself over the smallest radius of curvature here, 1 mm.
    assert np.max(np.abs(fast.normal - certified.normal)) <= 6e-11
    assert np.max(np.abs(fast.overrun - certified.overrun)) <= 6e-11
    assert not np.any(fast.repaired)
    np.testing.assert_allclose(np.hypot(*fast.normal.T), 1.0, atol=1e-15)  # one rounding
    exact = oracle(r)
    mine = closings(fast)
    assert mine.keys() == exact.keys()
    assert max(abs(mine[pair] - exact[pair]) for pair in mine) <= ROUNDING


def test_rough_flanks() -> None:
    r = run(gears(18, 25, grade=8, rough=True), positions=40)
    fast, certified = r.fast(), r.certified()
    np.testing.assert_array_equal(fast.fixed, certified.fixed)
    assert np.max(np.abs(fast.rotation - certified.rotation)) <= PROMISED
    assert np.max(np.abs(fast.point - certified.point)) <= 6e-11  # as above
    # The smooth normal swings by up to a radian from one vertex to the next, 15 um away: 6e-11 mm is 4e-9 of that.
    assert np.max(np.abs(fast.normal - certified.normal)) <= 1e-8


def test_corners_are_seen() -> None:
    """Without the corners' rows the agreement above would say little about features."""
    found = run(gears(18, 25, **SPOILT), positions=400).fast()
    for feature in Feature:
        assert np.count_nonzero(found.feature == feature) > 10
    assert np.all((found.overrun > 0.0) == (found.feature != Feature.FLANK))


def ragged(z: int, n: int, towards: float, rng: np.random.Generator) -> FloatArray:
    """Faces of no gear at all: teeth whose flanks wander to and fro by half an edge, so that radii fall and rise."""
    height = np.linspace(8.0, 12.0, n)
    step = height[1] - height[0]
    x, y = height + rng.uniform(-step, step, (z, n)), rng.uniform(-step, step, (z, n))
    angle = towards + 2.0 * math.pi * np.arange(z) / z
    points = (x + 1j * y) * np.exp(1j * angle)[:, None]
    return np.stack((points.real, points.imag), axis=-1)


@pytest.mark.parametrize("n", [3, 9, 10, 40, 200])
def test_ragged_outlines_that_are_no_gears(n: int) -> None:
    """Edges fold back in radius about both axes; branches and feet of perpendiculars decide."""
    rng = np.random.default_rng(n)
    z = 9
    turning, fixed = ragged(z, n, 0.0, rng), ragged(z, n, math.pi, rng)
    bodies = [Body(faces=faces, backs=faces[:, -1:]) for faces in (turning, fixed)]
    poses = rng.uniform(-0.05, 0.05, 60)
    how: dict[str, Any] = {"axis_distance": 21.0, "poses": poses, "guesses": -poses, "near": 0.1}
    r = Run(bodies[0], bodies[1], how)
    mine, exact = closings(r.fast()), oracle(r)
    assert mine.keys() == exact.keys()
    assert max(abs(mine[pair] - exact[pair]) for pair in mine) <= ROUNDING
    for (p, i, j), rotation in list(mine.items())[:5]:
        slow = closing_rotation_slow(
            turning[i], fixed[j], axis=(21.0, 0.0), pose=poses[p], rotation_guess=float(how["guesses"][p])
        )
        assert abs(rotation - slow) <= ROUNDING


@pytest.mark.parametrize("parts", [1, 2, 41])
@pytest.mark.parametrize("blunt", ["turning", "fixed"])
def test_an_edge_that_runs_across(blunt: str, parts: int) -> None:
    """A tip corner at 12 mm meets an edge that falls to 11.9 mm and rises to 12.05: twice on one circle, inside it."""
    z, a, half = 9, 21.0, math.sqrt(12.05**2 - 11.9**2)
    if blunt == "fixed":
        chin = 11.9 + 1j * np.linspace(half, -half, parts + 1)
        teeth = np.array([8.0, 10.0, 12.0 + 0j]), np.concatenate(([15.0 + 2.5j, 13.0 + 2.1j], chin)) - a
    else:
        chin = 11.9 + 1j * np.linspace(-half, half, parts + 1)
        teeth = (
            np.concatenate(([8.0 - 2.5j, 10.0 - 2.2j], chin)),
            np.array([15.0 + 3.0j, 12.06 + 0.5j, 12.0 + 0.0j]) - a,
        )
    turn = np.exp(2j * math.pi * np.arange(z) / z)[:, None]
    bodies = []
    for tooth in teeth:
        points = tooth * turn
        faces = np.stack((points.real, points.imag), axis=-1)
        bodies.append(Body(faces=faces, backs=faces[:, -1:]))
    how = {"axis_distance": a, "poses": np.zeros(1), "guesses": np.array([-0.2]), "near": 1e-3}
    found = Run(bodies[0], bodies[1], how).fast()
    # The circle of 12 mm first meets the edge's line where it enters it; nothing else stands in the way.
    assert (found.turning[0], found.fixed[0]) == (0, 0)
    assert abs(found.rotation[0] - (0.2 - math.acos(11.9 / 12.0))) <= ROUNDING
    assert found.feature[0] != (Feature.TURNING_CORNER if blunt == "turning" else Feature.FIXED_CORNER)


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "near"), [({"points": 200}, 1e-4), ({"points": 200, "grade": 8, "rough": True}, 5e-4)]
)
def test_bounds_are_bounds(kind: Any, near: float) -> None:
    """No block pair closes earlier than its bound says: every level, measured by the oracle on the blocks alone."""
    r = run(gears(12, 20, **kind), positions=3)
    found = r.fast()
    sizes: list[int] = []
    for row in found.first():
        pose = float(r.how["poses"][found.pose[row]])
        guess = float(r.how["guesses"][found.pose[row]])
        faces = r.turning.faces[found.turning[row]], r.fixed.faces[found.fixed[row]]
        blocks = [radial_search.blocks(face[None]) for face in faces]
        rows = [one[0] for one in blocks]
        spin = pose - guess
        at = (
            -r.how["axis_distance"] * math.cos(pose),
            r.how["axis_distance"] * math.sin(pose),
            math.cos(spin),
            math.sin(spin),
        )
        for b in range(1, rows[0].shape[0]):
            for c in range(1, rows[1].shape[0]):
                if b.bit_length() != c.bit_length():
                    continue
                bound = radial_search._bound(blocks[0], 0, b, blocks[1], 0, c, at)
                parts = [span(face, row.shape[0] // 2, k) for face, row, k in zip(faces, rows, (b, c), strict=True)]
                gap = closing_rotation(*parts, axis=(r.how["axis_distance"], 0.0), pose=pose, rotation_guess=guess)[1]
                if math.isnan(gap):
                    continue  # no common radius: any bound will do
                assert math.sin(gap) >= bound - ROUNDING
                sizes += [b] * (math.sin(gap) < bound + near)
    # A bound of minus infinity would pass as well: some are within 1 um here of the truth, or of 5 um of roughness.
    assert len(sizes) > 20


def span(face: FloatArray, leaves: int, block: int) -> FloatArray:
    """The vertices of one block: leaves share the edges evenly, and a block holds the leaves below it."""
    first = last = block
    while first < leaves:
        first, last = 2 * first, 2 * last + 1
    edges = face.shape[0] - 1
    return face[(first - leaves) * edges // leaves : (last + 1 - leaves) * edges // leaves + 1]


def test_many_turns_and_many_pairs() -> None:
    """Large angles lose no digits beyond their own, and where more pairs are near than there is room for at first, all
    are kept."""
    pair = gears(60, 60, grade=5)
    r = run(pair, positions=150, near=0.05 * pair.r_b1)
    r.how["poses"] = r.how["poses"] - 2000.0 * math.pi
    r.how["guesses"] = r.how["guesses"] + 2000.0 * math.pi
    fast, exact = closings(r.fast()), oracle(r, count=8)
    assert len(fast) > radial_search.ROOM * 150 + 64
    assert fast.keys() == exact.keys()
    assert max(abs(fast[pair] - exact[pair]) for pair in fast) <= ROUNDING


@pytest.mark.parametrize(("z_1", "z_2"), [(8, 8), (18, 25), (60, 8)])
def test_the_guess_may_be_off_by_a_fifth_of_a_pitch(z_1: int, z_2: int) -> None:
    r = run(gears(z_1, z_2, **SPOILT), positions=500)
    plain = r.fast()
    for shift in (-0.2 * 2.0 * math.pi / z_1, 0.2 * 2.0 * math.pi / z_1):
        found = Run(r.turning, r.fixed, {**r.how, "guesses": r.how["guesses"] + shift}).fast()
        np.testing.assert_array_equal(found.turning, plain.turning)
        np.testing.assert_array_equal(found.fixed, plain.fixed)
        # The shifted guess itself is rounded, by 1e-15 rad at 20 rad.
        assert np.max(np.abs(found.rotation + shift - plain.rotation)) <= ROUNDING


def test_where_nothing_touches_there_is_no_row() -> None:
    r = run(gears(18, 25), positions=20)
    empty = {**r.how, "poses": np.empty(0), "guesses": np.empty(0)}
    assert closing_rotations_fast(r.turning, r.fixed, **empty).pose.size == 0
    assert spot_check(r.turning, r.fixed, r.fast(), **empty) == 0.0
    apart = closing_rotations_fast(r.turning, r.fixed, **{**r.how, "axis_distance": 50.0})
    assert apart.positions == 20
    assert apart.pose.size == 0


def test_the_spot_check_passes_what_is_right() -> None:
    r = run(gears(18, 25, **SPOILT), positions=500)
    fast = r.fast()
    assert r.check(fast, samples=10) <= PROMISED
    assert r.check(fast, samples=10, rng=np.random.default_rng(5)) <= PROMISED


@pytest.mark.parametrize("shrunk", [1e-5, 1e-3])
def test_a_bound_too_optimistic_is_found_out(shrunk: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted fault: blocks a little smaller than their edges (mm)."""
    honest = radial_search.blocks

    def smaller(faces: FloatArray) -> FloatArray:
        rows = honest(faces)
        rows[..., 3] -= shrunk
        return rows

    r = run(gears(18, 25, points=2000, **SPOILT), positions=80)
    monkeypatch.setattr(radial_search, "blocks", smaller)
    wrong = r.fast()
    monkeypatch.undo()
    right = r.fast()
    assert np.max(np.abs(wrong.rotation[wrong.first()] - right.rotation[right.first()])) > PROMISED
    with pytest.raises(SelfCheckError, match="Please report it"):
        r.check(wrong, samples=80)


@pytest.mark.parametrize("blunt", ["turning", "fixed"])
def test_a_lost_tip_corner_is_found_out(blunt: str) -> None:
    """Planted fault: one body's last vertex is dropped."""
    r = run(gears(18, 25, **SPOILT))
    cut = {
        name: Body(faces=body.faces[:, :-1], backs=body.backs) if name == blunt else body
        for name, body in (("turning", r.turning), ("fixed", r.fixed))
    }
    wrong = Run(cut["turning"], cut["fixed"], r.how).fast()
    with pytest.raises(SelfCheckError, match="Please report it"):
        r.check(wrong, samples=120)


def test_a_pair_left_out_is_found_out() -> None:
    r = run(gears(18, 25), positions=30)
    fast = r.fast()
    keep = fast.first()
    names = [name for name in Closings.__dataclass_fields__ if name != "positions"]
    fewer = Closings(positions=fast.positions, **{name: getattr(fast, name)[keep] for name in names})
    with pytest.raises(SelfCheckError, match="Please report it"):
        r.check(fewer, samples=30)


@pytest.mark.long
def test_numba_stays_away_until_it_is_needed() -> None:
    code = "import sys, gearpoly.cli, gearpoly.mesh.radial; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_no_place_to_keep_compiled_code(monkeypatch: pytest.MonkeyPatch) -> None:
    from numba import njit

    def nowhere(*, cache: bool = False, **options: Any) -> Any:
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return njit(**options)

    monkeypatch.setattr(radial_search, "njit", nowhere)
    assert radial_search.compiled(lambda x: x + 1)(2) == 3


def test_its_promise_is_the_polygon_kernels() -> None:
    assert radial.AGREEMENT == PROMISED


def test_what_passes_the_certificate_as_it_stands_is_what_the_kernel_finds() -> None:
    """A second calculation: the kernel's own search ends at the same closings, and a closing that is off by ten times
    what it certifies (2.5e-13 rad) does not pass."""
    r = run(gears(18, 25, **SPOILT), positions=40)
    fast = r.fast()
    exact = oracle(r, count=40)
    assert all_certified(r.turning, r.fixed, fast, **r.how)
    assert max(abs(closings(fast)[pair] - exact[pair]) for pair in exact) <= PROMISED
    for off in (-2.5e-12, 2.5e-12):
        assert not all_certified(r.turning, r.fixed, replace(fast, rotation=fast.rotation + off), **r.how)
