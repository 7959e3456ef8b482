"""The contact kernel on raw bodies, which is all that it knows: closed forms, symmetries, planted faults."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from gearpoly.errors import NotConvergedError
from gearpoly.mesh import bodies, certificate, contact
from gearpoly.mesh.bodies import Body, Jobs, Meeting, window
from gearpoly.mesh.contact import Closings, Feature, closing_rotations, mirrored
from gearpoly.units import BoolArray, FloatArray
from tests.oracles.involute_pair import InvoluteGear, make_pair, pair_faces
from tests.oracles.radial_gap import closing_rotation_slow, closing_rotations_of_pairs
from tests.oracles.radial_gap import closing_rotations as radial_gap

# rad. Half the certified bracket and rounding of coordinates below 50 mm: what the kernel promises is 1e-12.
PROMISED = 1e-12


def points(values: np.ndarray) -> FloatArray:
    return np.stack((values.real, values.imag), axis=-1)


def run(
    turning: Body,
    fixed: Body,
    *,
    a: float,
    poses: FloatArray,
    guesses: FloatArray | None = None,
    near: float = 0.0,
) -> Closings:
    parts = list(
        closing_rotations(
            turning,
            fixed,
            axis_distance=a,
            poses=poses,
            guesses=np.zeros(poses.size) if guesses is None else guesses,
            near=near,
        )
    )
    names = [name for name in Closings.__dataclass_fields__ if name != "positions"]
    return Closings(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in names},
        positions=sum(part.positions for part in parts),
    )


# Two discs: smooth faces with a closed form.


def disc(*, c: float, R: float, n: int, directions: tuple[float, ...], side: float = 1.0) -> Body:
    """Discs of radius R mm centred at c mm from the axis; their faces are the counter-clockwise (side -1: clockwise)
    halves."""
    theta = np.linspace(math.radians(170.0), math.radians(10.0), n)
    arc = c + R * np.exp(1j * theta * side)
    back = np.array([c + R - 1e-3, c - side * 0.5j * R])
    turn = np.exp(1j * np.array(directions))[:, None]
    return Body(faces=points(arc * turn), backs=points(back * turn))


def discs_touch(c: tuple[float, float], R: tuple[float, float], a: float, poses: FloatArray) -> FloatArray:
    """Rotation at which the discs touch, turning counter-clockwise: cosine rule on axis, centre and centre."""
    mate = a - c[1] * np.exp(1j * poses)
    D = np.abs(mate)
    cosine: FloatArray = (c[0] ** 2 + D**2 - (R[0] + R[1]) ** 2) / (2.0 * c[0] * D)
    return np.angle(mate) - np.arccos(cosine)


@pytest.mark.parametrize("n", [300, 3000])
def test_two_discs_touch_where_the_cosine_rule_says(n: int) -> None:
    c, R, a = (18.0, 14.0), (3.0, 5.0), 33.0
    turning = disc(c=c[0], R=R[0], n=n, directions=(0.0,))
    fixed = disc(c=c[1], R=R[1], n=n, directions=(math.pi,))
    poses = np.linspace(-0.1, 0.1, 41)
    exact = discs_touch(c, R, a, poses)
    found = run(turning, fixed, a=a, poses=poses, guesses=exact + 0.003)
    np.testing.assert_array_equal(found.pose, np.arange(poses.size))
    late = found.rotation + 0.003
    centres = c[0] * np.exp(1j * exact), a - c[1] * np.exp(1j * poses)
    normal = (centres[1] - centres[0]) / (R[0] + R[1])
    lever = np.abs((centres[0].conj() * normal).imag)
    step = math.radians(160.0) / (n - 1)
    # Inscribed chords stand back by R step^2/8 each; never early, but for the bracket.
    assert np.min(late) >= -PROMISED
    assert np.max(late * lever) <= 1.01 * sum(R) * step**2 / 8.0
    assert np.all(found.feature == Feature.FLANK)
    assert np.all(found.overrun == 0.0)
    # The vertex that touches is within half a step of the true place on either circle.
    touch = centres[0] + R[0] * normal
    assert np.max(np.abs(found.point - points(touch))) < max(R) * step
    # Smoothed tangents make the normal as good as the place; chords would be off by up to step/2 more.
    assert np.max(np.abs(found.normal - points(normal))) < 0.51 * step
    assert np.allclose(np.hypot(found.normal[:, 0], found.normal[:, 1]), 1.0, atol=1e-14)  # a few roundings


def test_the_first_of_several_teeth_touches_and_the_others_wait() -> None:
    c, R, a = (18.0, 14.0), (1.5, 1.8), 33.0
    directions = (0.0, 1.6, -1.6)
    turning = disc(c=c[0], R=R[0], n=1500, directions=directions)
    fixed = disc(c=c[1], R=R[1], n=1500, directions=tuple(math.pi + d for d in (0.0, 2.0, -2.0)))
    poses = np.array([0.0, -2.0, 2.0])
    # Poses of 2 rad bring fixed teeth 0, 1, 2 to the line of centres; the guess chooses among the turning ones.
    exact = discs_touch(c, R, a, np.zeros(3)) - np.array(directions)[[1, 2, 0]]
    found = run(turning, fixed, a=a, poses=poses, guesses=exact + 0.002)
    np.testing.assert_array_equal(found.turning, [1, 2, 0])
    np.testing.assert_array_equal(found.fixed, [0, 1, 2])
    sagitta = sum(R) * (math.radians(160.0) / 1499) ** 2 / 8.0
    late = found.rotation + 0.002
    assert np.all((late > -PROMISED) & (late < sagitta / 10.0))  # levers are above 10 mm


# A corner on a flat face.


def bar(*, inner: float, outer: float, n: int, direction: float, depth: float = 4.0) -> Body:
    """A straight radial face from ``inner`` to ``outer`` mm with material on its clockwise side."""
    face = np.linspace(inner, outer, n) + 0j
    back = np.array([outer - 1j * depth, inner - 1j * depth])
    turn = np.exp(1j * direction)
    return Body(faces=points(face * turn)[None], backs=points(back * turn)[None])


def test_a_turning_corner_on_a_flat_face() -> None:
    a, outer = 36.0, 20.0
    poses = -np.linspace(0.01, 0.2, 20)
    # The fixed flat runs through its own axis: normal (-sin, cos) of the pose, distance -a sin(pose) from the origin.
    # The corner 20 e^(i rotation) reaches it on the near side of the fixed axis.
    exact = poses + np.arcsin(-a * np.sin(poses) / outer)
    found = run(
        bar(inner=10.0, outer=outer, n=200, direction=0.0),
        bar(inner=8.0, outer=18.0, n=151, direction=math.pi),
        a=a,
        poses=poses,
        guesses=exact - 0.002,
    )
    np.testing.assert_allclose(found.rotation, 0.002, atol=PROMISED, rtol=0.0)
    assert np.all(found.feature == Feature.TURNING_CORNER)
    np.testing.assert_allclose(found.point, points(outer * np.exp(1j * exact)), atol=1e-10, rtol=0.0)
    # Material of the fixed body lies above: the normal into it is the flat's own.
    np.testing.assert_allclose(found.normal, points(1j * np.exp(1j * poses)), atol=1e-12, rtol=0.0)
    # The turning face has turned past the flat by the difference of their directions.
    np.testing.assert_allclose(found.overrun, exact - poses, atol=1e-11, rtol=0.0)


def test_a_fixed_corner_on_a_flat_face() -> None:
    a, tip = 36.0, 18.0
    poses = np.linspace(0.01, 0.2, 20)
    corner = a - tip * np.exp(1j * poses)
    exact = np.angle(corner)  # the turning flat is radial
    found = run(
        bar(inner=10.0, outer=20.0, n=200, direction=0.0),
        bar(inner=8.0, outer=tip, n=151, direction=math.pi),
        a=a,
        poses=poses,
        guesses=exact - 0.002,
    )
    np.testing.assert_allclose(found.rotation, 0.002, atol=PROMISED, rtol=0.0)
    assert np.all(found.feature == Feature.FIXED_CORNER)
    np.testing.assert_allclose(found.point, points(corner), atol=1e-10, rtol=0.0)
    np.testing.assert_allclose(found.normal, points(1j * np.exp(1j * exact)), atol=1e-12, rtol=0.0)
    np.testing.assert_allclose(found.overrun, poses - exact, atol=1e-11, rtol=0.0)


# Bodies with many teeth, from formulas outside the package.


def closed(gear: InvoluteGear, faces: FloatArray, working: int = 9) -> Body:
    """Half teeth from the faces of test gears: over the tip to the tooth's middle, down into the body, and back."""
    middle = np.array([gear.pitch_angle(k) for k in range(gear.z)]) - math.pi / (2 * gear.z)
    foot = np.angle(faces[:, 0, 0] + 1j * faces[:, 0, 1])
    back = np.stack(
        (gear.r_a * np.exp(1j * middle), 0.8 * gear.r_f * np.exp(1j * middle), 0.8 * gear.r_f * np.exp(1j * foot)),
        axis=1,
    )
    return Body(faces=faces, backs=points(back), working=working)


def deviated(n: int = 400, seed: int = 3) -> tuple[Body, Body, float]:
    rng = np.random.default_rng(seed)
    turning, fixed, pair = pair_faces(
        18,
        25,
        2.0,
        math.radians(20.0),
        n,
        index=(rng.uniform(-5e-3, 5e-3, 18), rng.uniform(-5e-3, 5e-3, 25)),
        slope=(rng.uniform(-6e-3, 6e-3, 18), rng.uniform(-6e-3, 6e-3, 25)),
        wave=(1e-3, -1.5e-3),
    )
    return closed(pair.driving, turning), closed(pair.driven, fixed), pair.a


def settings(count: int, seed: int = 0) -> tuple[FloatArray, FloatArray]:
    theta_2 = np.random.default_rng(seed).uniform(0.0, 30.0, count)
    return -theta_2, theta_2 * 25 / 18


def rough(n: int = 300) -> tuple[Body, Body, float]:
    """Every vertex on its own, by up to 2 um: slopes of 10 degrees and more between neighbours."""
    turning, fixed, a = deviated(n)
    rng = np.random.default_rng(11)
    sides = []
    for body in (turning, fixed):
        z = body.points
        shake = np.exp(1j * rng.uniform(-2e-3, 2e-3, z.shape) / np.abs(z))
        sides.append(replace(body, faces=points(z * shake)))
    return sides[0], sides[1], a


def worst_error(turning: Body, fixed: Body, a: float, *, count: int = 200, seed: int = 0) -> float:
    poses, guesses = settings(count, seed)
    found = run(turning, fixed, a=a, poses=poses, guesses=guesses)
    first = found.first()
    assert first.size == count
    exact = radial_gap(turning.faces, fixed.faces, axis_distance=a, poses=poses, guesses=guesses)
    return float(np.max(np.abs(found.rotation[first] - exact.offset)))


def test_agrees_with_the_radial_gap_on_smooth_and_on_rough_faces() -> None:
    assert worst_error(*deviated()) < PROMISED
    turning, fixed, a = rough()
    poses, guesses = settings(300)
    found = run(turning, fixed, a=a, poses=poses, guesses=guesses)
    # Rough faces have many peaks; windows take a wrong one often, and the repair is what makes them right.
    assert np.count_nonzero(found.repaired) > 50
    assert worst_error(turning, fixed, a) < PROMISED


def test_single_pairs_agree_with_brute_force_in_extended_precision() -> None:
    turning, fixed, a = deviated(120)
    poses, guesses = settings(12, seed=5)
    found = run(turning, fixed, a=a, poses=poses, guesses=guesses, near=5e-3)
    assert found.pose.size > poses.size
    for row in range(found.pose.size):
        p = found.pose[row]
        slow = closing_rotation_slow(
            turning.faces[found.turning[row]],
            fixed.faces[found.fixed[row]],
            axis=(a, 0.0),
            pose=float(poses[p]),
            rotation_guess=float(guesses[p]),
        )
        assert found.rotation[row] == pytest.approx(slow, abs=PROMISED)


def test_certificates_hold_on_whole_faces_of_all_teeth() -> None:
    """The kernel's claim, asked of shapely anew: all faces of both bodies, none left out, rotated by plain matrices."""
    for turning, fixed, a in (deviated(), rough()):
        poses, guesses = settings(60, seed=2)
        found = run(turning, fixed, a=a, poses=poses, guesses=guesses, near=2e-3)

        def lines(body: Body, angle: float, shift: float = 0.0) -> shapely.MultiLineString:
            c, s = math.cos(angle), math.sin(angle)
            x, y = body.faces[..., 0], body.faces[..., 1]
            moved = np.stack((c * x - s * y + shift, s * x + c * y), axis=-1)
            return shapely.multilinestrings(list(shapely.linestrings(moved)))

        slack = 2.0 * certificate.HALF_BRACKET  # the bracket is 2.5e-13 either way; coordinates round at 1e-15 rad
        for row in found.first():
            p = found.pose[row]
            at = guesses[p] + found.rotation[row]
            held = lines(fixed, poses[p], a)
            assert not shapely.intersects(lines(turning, at - slack), held)
            assert shapely.intersects(lines(turning, at + slack), held)
        for row in range(found.pose.size):
            p = found.pose[row]
            at = guesses[p] + found.rotation[row]
            mine = replace(turning, faces=turning.faces[found.turning[row]][None])
            mate = replace(fixed, faces=fixed.faces[found.fixed[row]][None])
            held = lines(mate, poses[p], a)
            assert not shapely.intersects(lines(mine, at - slack), held)
            assert shapely.intersects(lines(mine, at + slack), held)


@pytest.mark.parametrize("near", [0.0, 1e-4, 5e-3, 0.025, 0.06])
def test_near_pairs_are_all_there_and_no_others(near: float) -> None:
    """Also where near is more than a search goes back before its guess: a soft pair under load reaches far."""
    turning, fixed, a = deviated(200)
    poses, guesses = settings(300, seed=4)
    found = run(turning, fixed, a=a, poses=poses, guesses=guesses, near=near)
    exact = closing_rotations_of_pairs(
        turning.faces, fixed.faces, axis_distance=a, poses=poses, guesses=guesses, count=6
    )
    wanted = set()
    for p, k in zip(*np.nonzero(exact.pair[:, :, 0] >= 0), strict=True):
        if exact.offset[p, k] <= exact.offset[p, 0] + near:
            wanted.add((int(p), int(exact.pair[p, k, 0]), int(exact.pair[p, k, 1])))
    rows = list(zip(found.pose.tolist(), found.turning.tolist(), found.fixed.tolist(), strict=True))
    assert set(rows) == wanted
    assert len(rows) == len(wanted)
    # Sorted by pose, then by rotation: the first row of each pose touches.
    assert np.all(np.diff(found.pose) >= 0)
    assert np.all(np.diff(found.rotation)[np.diff(found.pose) == 0] >= 0.0)


# Symmetries.


def test_the_frame_does_not_matter() -> None:
    turning, fixed, a = deviated()
    poses, guesses = settings(80)
    plain = run(turning, fixed, a=a, poses=poses, guesses=guesses, near=1e-3)

    def turned(body: Body, angle: float) -> Body:
        turn = np.exp(1j * angle)
        return replace(
            body, faces=points(body.points * turn), backs=points((body.backs[..., 0] + 1j * body.backs[..., 1]) * turn)
        )

    # Bodies drawn at other angles, turned back by pose and guess; whole turns on top.
    moved = run(
        turned(turning, 0.7),
        turned(fixed, -1.9),
        a=a,
        poses=poses + 1.9 + 2.0 * math.pi,
        guesses=guesses - 0.7 - 2.0 * math.pi,
        near=1e-3,
    )
    # The guess is only where the search starts.
    other = run(turning, fixed, a=a, poses=poses, guesses=guesses + 0.004, near=1e-3)
    # Lengths have no say in an angle: ten times everything.
    scaled = run(
        replace(turning, faces=10.0 * turning.faces, backs=10.0 * turning.backs),
        replace(fixed, faces=10.0 * fixed.faces, backs=10.0 * fixed.backs),
        a=10.0 * a,
        poses=poses,
        guesses=guesses,
        near=1e-3,
    )
    for found, shift, scale in ((moved, 0.0, 1.0), (other, 0.004, 1.0), (scaled, 0.0, 10.0)):
        np.testing.assert_array_equal(found.turning, plain.turning)
        np.testing.assert_array_equal(found.fixed, plain.fixed)
        np.testing.assert_array_equal(found.feature, plain.feature)
        np.testing.assert_allclose(found.rotation + shift, plain.rotation, atol=PROMISED, rtol=0.0)
        # 1e-12 rad moves a touch along a face of 30 um chords by the ratio of curvature to kink: far below 1 nm.
        np.testing.assert_allclose(found.point / scale, plain.point, atol=1e-6, rtol=0.0)


@pytest.mark.long
@pytest.mark.parametrize("shift", [-0.07, -0.035, 0.008])
def test_the_guess_may_be_early_by_a_fifth_of_a_tooth_and_late_by_a_little(shift: float) -> None:
    """No pair may be lost for it: a lost pair has no contact, so no certificate can miss it."""
    turning, fixed, a = deviated(200)
    poses, guesses = settings(200)
    plain = run(turning, fixed, a=a, poses=poses, guesses=guesses)
    found = run(turning, fixed, a=a, poses=poses, guesses=guesses + shift)
    np.testing.assert_array_equal(found.turning, plain.turning)
    np.testing.assert_array_equal(found.fixed, plain.fixed)
    np.testing.assert_allclose(found.rotation + shift, plain.rotation, atol=PROMISED, rtol=0.0)


def test_mirrored_bodies_turn_the_other_way() -> None:
    turning = disc(c=18.0, R=3.0, n=800, directions=(0.3,))
    clockwise = mirrored(disc(c=18.0, R=3.0, n=800, directions=(-0.3,), side=-1.0))
    np.testing.assert_allclose(clockwise.faces, turning.faces, atol=1e-14, rtol=0.0)
    again = mirrored(mirrored(turning))
    np.testing.assert_array_equal(again.faces, turning.faces)
    # The coast side of test gears, mirrored, against the oracle that turns clockwise on the faces as they are.
    pair = make_pair(18, 25)
    coast = pair.driving.coast_faces(300, E_s=-0.05), pair.driven.coast_faces(300, E_s=-0.03)
    theta_2 = np.linspace(0.0, 6.0, 60)
    exact = radial_gap(*coast, axis_distance=pair.a, poses=-theta_2, guesses=pair.guesses(theta_2), sense=-1)

    def side(gear: InvoluteGear, faces: FloatArray) -> Body:
        middle = np.array([gear.pitch_angle(k) for k in range(gear.z)]) - math.pi / (2 * gear.z)
        foot = np.angle(faces[:, 0, 0] + 1j * faces[:, 0, 1])
        hub = 0.8 * gear.r_f
        back = np.stack((gear.r_a * np.exp(1j * middle), hub * np.exp(1j * middle), hub * np.exp(1j * foot)), axis=1)
        return mirrored(Body(faces=faces, backs=points(back), working=9))

    found = run(
        side(pair.driving, coast[0]),
        side(pair.driven, coast[1]),
        a=pair.a,
        poses=theta_2,
        guesses=-pair.guesses(theta_2),
    )
    np.testing.assert_allclose(-found.rotation, exact.offset, atol=PROMISED, rtol=0.0)
    np.testing.assert_array_equal(found.turning, exact.pair[:, 0])
    # In the mirror the turning body still turns counter-clockwise, so it pushes upwards.
    assert np.all(found.normal[:, 1] > 0.0)


# Where it must refuse, and what repairs it.


def test_bodies_out_of_reach_give_no_row() -> None:
    turning, fixed, _ = deviated(50)
    found = run(turning, fixed, a=60.0, poses=np.zeros(3))
    assert found.pose.size == 0
    assert found.positions == 3


def test_a_solid_that_pokes_through_its_face_cannot_be_certified() -> None:
    turning = bar(inner=10.0, outer=20.0, n=50, direction=0.0)
    # The back lies ahead of the face: the face's own solid is already across the mate when the face arrives.
    wrong = replace(turning, backs=turning.backs * np.array([1.0, -1.0]))
    with pytest.raises(NotConvergedError, match="turning tooth 0 with fixed tooth 0"):
        run(wrong, bar(inner=8.0, outer=18.0, n=50, direction=math.pi), a=36.0, poses=np.array([0.01]))


def displaced(monkeypatch: pytest.MonkeyPatch, by: float) -> None:
    honest = contact.refine

    def refine(m: Meeting, jobs: Jobs) -> None:
        honest(m, jobs)
        jobs.rotation = jobs.rotation + by

    monkeypatch.setattr(contact, "refine", refine)


@pytest.mark.long
@pytest.mark.parametrize("by", [1e-12, -1e-12, 1e-8, 1e-3, -1e-3])
def test_wrong_answers_are_found_and_repaired(monkeypatch: pytest.MonkeyPatch, by: float) -> None:
    turning, fixed, a = deviated()
    displaced(monkeypatch, by)
    poses, guesses = settings(40)
    assert np.all(run(turning, fixed, a=a, poses=poses, guesses=guesses).repaired)
    assert worst_error(turning, fixed, a, count=40) < PROMISED


@pytest.mark.parametrize("by", [1e-12, -1e-6, 1e-3])
def test_plain_bisection_repairs_what_aiming_does_not(monkeypatch: pytest.MonkeyPatch, by: float) -> None:
    turning, fixed, a = deviated()
    displaced(monkeypatch, by)
    monkeypatch.setattr(certificate, "_aim_again", lambda m, jobs: None)
    assert worst_error(turning, fixed, a, count=40) < PROMISED


def test_nothing_uncertified_leaves(monkeypatch: pytest.MonkeyPatch) -> None:
    turning, fixed, a = deviated()
    displaced(monkeypatch, 1e-12)
    for repair in ("_aim_again", "_bisect"):
        monkeypatch.setattr(certificate, repair, lambda m, jobs: None)
    poses, guesses = settings(5)
    with pytest.raises(NotConvergedError, match="could not be certified"):
        run(turning, fixed, a=a, poses=poses, guesses=guesses)


def test_windows_keep_the_tip_corner_and_stay_on_the_face() -> None:
    turning, _, _ = deviated(400)
    last = turning.faces.shape[1] - 1
    for stride in (1, 6, 30):
        numbers = window(turning, np.array([0, turning.working, 200, last - 1, last]), stride)
        assert np.all(numbers >= (0 if stride == 1 else turning.working))
        assert np.all(numbers <= last)
        assert np.all(np.diff(numbers, axis=1) == stride)
        assert numbers[-1, -1] == last


# Planted faults: the oracle must see them, and the certificate must catch what it is there for.


def uncertified(monkeypatch: pytest.MonkeyPatch) -> None:
    def trusting(m: Meeting, jobs: Jobs) -> BoolArray:
        return np.zeros(len(jobs), dtype=bool)

    monkeypatch.setattr(contact, "certify", trusting)


def test_small_windows_without_certificates_turn_the_oracle_red(monkeypatch: pytest.MonkeyPatch) -> None:
    turning, fixed, a = deviated()
    with monkeypatch.context() as patch:
        patch.setattr(bodies, "WINDOW_VERTICES", 3)
        uncertified(patch)
        assert worst_error(turning, fixed, a) > 1e-9
    with monkeypatch.context() as patch:
        # The same windows under certificates: slower, but right.
        patch.setattr(bodies, "WINDOW_VERTICES", 3)
        assert worst_error(turning, fixed, a) < PROMISED
    with monkeypatch.context() as patch:
        uncertified(patch)
        assert worst_error(*rough()) > 1e-9


def test_a_lost_corner_and_a_shifted_axis_turn_the_oracle_red() -> None:
    turning, fixed, a = deviated()
    poses, guesses = settings(400)
    exact = radial_gap(turning.faces, fixed.faces, axis_distance=a, poses=poses, guesses=guesses).offset
    faults = {
        "driving tip corner": (replace(turning, faces=turning.faces[:, :-1]), fixed, a),
        "driven tip corner": (turning, replace(fixed, faces=fixed.faces[:, :-1]), a),
        "axis off by a picometre": (turning, fixed, a + 1e-9),
    }
    for name, (mine, mate, distance) in faults.items():
        found = run(mine, mate, a=distance, poses=poses, guesses=guesses)
        assert np.max(np.abs(found.rotation[found.first()] - exact)) > 10.0 * PROMISED, name
