"""A tooth whose tip has broken off: where its contact ends, what its corner does then, and who takes over the load."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from scipy.integrate import quad
from scipy.optimize import brentq

from gearpoly import api
from gearpoly.assemble import Assembled, assemble
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.verdict import Finding
from gearpoly.errors import InputFileError, NoContactError
from gearpoly.export.design import export_design
from gearpoly.export.drawing import Request
from gearpoly.export.outline import Detail, draw_outline
from gearpoly.files.gde_read import read_gde
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.files.traces import read_traces
from gearpoly.gear.deviations import Deviations, MissingTip
from gearpoly.gear.draw import draw_deviations, streams
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.gear.polygon import gear_polygon
from gearpoly.gear.root import FILLET_CHORD_ERROR, form_point
from gearpoly.gear.tolerances import default_thickness, limits_for, tolerances
from gearpoly.mesh.bodies import WIDE_SHARE
from gearpoly.mesh.contact import Feature
from gearpoly.mesh.loaded import loaded
from gearpoly.mesh.pair import Flank, GearPair, Mounted, active_start, mount, tight_centre_distance
from gearpoly.mesh.transmission import contacts
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.scene import stage
from gearpoly.study.making import maker
from gearpoly.units import NM, UM, FloatArray
from tests.oracles.radial_gap import closing_rotation
from tests.pair_files import made, one_pitch, pair_file, under, unloaded_te
from tests.physics_cases import CONDITIONS, Condition, claim_of, declared, recorded, samples_at
from tests.test_radial import PROMISED, ROUNDING, Run, closings, run

GEARS = ("driving", "driven")
FLANKS: tuple[Flank, Flank] = ("drive", "coast")
TOOTH = 4


def chipped(gear: int, height: float, *, bends: bool = False, tooth: int = TOOTH) -> Assembled:
    """The 18/25 pair of module 2 without any deviation but a chip on one tooth."""
    return made(chipped_file(gear, height, bends=bends, tooth=tooth))


def chipped_file(gear: int, height: float, *, bends: bool = False, tooth: int = TOOTH) -> PairFile:
    even = {"inspection": {"tooth_thickness_um": 0.0}}
    tables: dict[str, Any] = {name: dict(even) for name in GEARS}
    tables[GEARS[gear]]["chip"] = [{"tooth": tooth, "height_mm": height}]
    return pair_file(model={"tooth_deflection": bends}, **tables)


def whole(*, bends: bool = False) -> Assembled:
    even = {"inspection": {"tooth_thickness_um": 0.0}}
    return made(pair_file(model={"tooth_deflection": bends}, driving=dict(even), driven=dict(even)))


def mounted(pair: GearPair, gear: int) -> Mounted:
    return pair.driving if gear == 0 else pair.driven


def rolls(pair: GearPair, theta_2: FloatArray, gear: int, flank: Flank) -> FloatArray:
    """Roll length (n,) in mm at which ``TOOTH`` of a deviation-free gear touches on the line of action, by the
    contract's zeros alone: contact passes the pitch point of mesh n's drive flank at n pitches, of the coast flank's
    half a tooth's thickness from there."""
    one = mounted(pair, gear).gear
    half = one.psi(one.r_b / math.cos(pair.alpha_w))
    angle = theta_2 / (pair.ratio if gear == 0 else 1.0)
    turned = np.mod(angle - TOOTH * one.tau + math.pi, 2.0 * math.pi) - math.pi
    if flank == "coast":
        # A tooth of either gear shows its coast flank a thickness later (driving) or earlier (driven).
        turned = turned - (2.0 * half if gear == 0 else -2.0 * half)
    # A driving drive flank is run up from root to tip, a driven one down; on the coast flank the other way round.
    up = 1.0 if (gear == 0) == (flank == "drive") else -1.0
    return np.asarray(one.r_b * (math.tan(pair.alpha_w) + up * turned))


# The outline.


@pytest.mark.parametrize("gear", [0, 1])
def test_both_flanks_of_one_tooth_end_at_the_lower_tip_and_all_else_stays(gear: int) -> None:
    height = 0.63
    before, after = mounted(whole().pair, gear).flanks, mounted(chipped(gear, height).pair, gear).flanks
    ideal = after.gear
    others = [k for k in range(ideal.z) if k != TOOTH]
    for side in FLANKS:
        np.testing.assert_array_equal(getattr(before, side)[others], getattr(after, side)[others])
        points = getattr(after, side)[TOOTH, after.root.n :]
        r = np.hypot(points[:, 0], points[:, 1])
        assert r[-1] == pytest.approx(ideal.r_a - height, abs=1e-14)
        assert np.all(np.diff(r) > 0.0)
        # On the involute all the way, and symmetric.
        psi = np.abs(np.arctan2(points[:, 1], points[:, 0]))
        np.testing.assert_allclose(psi, [ideal.psi(one) for one in r.tolist()], atol=1e-14)
    np.testing.assert_array_equal(after.drive[TOOTH], after.coast[TOOTH] * [1.0, -1.0])


@pytest.mark.parametrize("gear", [0, 1])
def test_what_is_missing_of_the_outline_is_the_area_between_both_tip_circles(gear: int) -> None:
    """Integral of 2 psi(r) r dr; a solid loses as much times its width. Chords cut two thirds of their error times
    their length off each arc, 0.7 and 1.9 mm long."""
    height = 0.63
    plain, cut = (mounted(one.pair, gear) for one in (whole(), chipped(gear, height)))
    ideal = cut.gear
    lost = quad(lambda r: 2.0 * ideal.psi(r) * r, ideal.r_a - height, ideal.r_a)[0]
    areas = [gear_polygon(one.flanks, one.centre_lines).area for one in (plain, cut)]
    assert areas[0] - areas[1] == pytest.approx(lost, abs=2.0 * FILLET_CHORD_ERROR)
    exported, chord = [], 1e-5
    for one in (plain, cut):
        drawn = draw_outline(
            ideal, Deviations(chips=(MissingTip(TOOTH, height),) if one is cut else ()),
            l_start=one.flanks.span.l_start, centre_lines=one.centre_lines, centre=one.centre,
            detail=Detail(chord=chord),
        )  # fmt: skip
        exported.append(shapely.Polygon(drawn.ring).area)
    assert exported[0] - exported[1] == pytest.approx(lost, abs=6.0 * chord)  # both flanks too, over 0.6 mm each


@pytest.mark.parametrize("flank", FLANKS)
def test_without_height_nothing_changes_to_the_last_bit(flank: Flank) -> None:
    a, b = whole(bends=True), chipped(0, 0.0, bends=True)
    assert not b.pair.driving.flanks.chipped
    for one, other in ((a.pair.driving, b.pair.driving), (a.pair.driven, b.pair.driven)):
        for side in FLANKS:
            assert getattr(one.flanks, side).tobytes() == getattr(other.flanks, side).tobytes()
            assert one.body(side).backs.tobytes() == other.body(side).backs.tobytes()
    theta_2 = one_pitch(a, 50, meshes=9)
    assert under(a, theta_2, 20.0, flank=flank)[0].te.tobytes() == under(b, theta_2, 20.0, flank=flank)[0].te.tobytes()


def test_of_several_chips_of_one_tooth_the_highest_counts() -> None:
    table = [{"tooth": TOOTH, "height_mm": one} for one in (0.3, 0.8, 0.0)]
    assembled = made(pair_file(driving={"chip": table}))
    assert set(assembled.pair.driving.flanks.chipped) == {TOOTH}
    assert assembled.pair.driving.flanks.tips.r[TOOTH] == assembled.pair.driving.gear.r_a - 0.8


def test_what_leaves_no_flank_is_refused_with_a_height_that_does(tmp_path: Path) -> None:
    path = tmp_path / "pair.toml"
    path.write_text(dump_pair(chipped_file(1, 3.9)), encoding="utf-8")
    with pytest.raises(InputFileError, match=r"driven: tooth 4 misses 3\.9 mm") as caught:
        assemble(read_pair(path), path=path, seed=0)
    most = float(str(caught.value).split("at most ")[1].split(" mm")[0])
    flanks = chipped(1, most).pair.driven.flanks
    left = flanks.tips.r[TOOTH] - math.hypot(flanks.gear.r_b, flanks.root.l_form)
    assert 0.0 < left < 1.1e-3
    path.write_text(dump_pair(chipped_file(1, 0.5)).replace("tooth = 4", "tooth = 25"), encoding="utf-8")
    with pytest.raises(InputFileError, match=r"chip.tooth.*want a tooth from 0 to 24"):
        read_pair(path)


# The path of contact.


@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("gear", [0, 1])
@pytest.mark.parametrize("height", [0.4, 1.0])
def test_the_path_of_contact_ends_at_the_lower_tip(gear: int, height: float, flank: Flank) -> None:
    """At the roll length sqrt((r_a - h)^2 - r_b^2) (ISO 21771:2007): this tooth's contact ratio falls by as many base
    pitches, and while another pair carries nothing else is seen."""
    pair = chipped(gear, height).pair
    ideal = mounted(pair, gear).gear
    steps = 4000
    theta_2 = (0.37 + np.arange(steps)) / steps * 6.0 * pair.driven.gear.tau + (TOOTH - 3.0) * pair.driven.gear.tau
    found = contacts(pair, theta_2, flank=flank, near=0.0, fast=True)
    # Rows that touch lie within the chords of both flanks, not at exactly 0.
    found = contacts(pair, theta_2, flank=flank, near=2.0 * pair.chord_noise, fast=True)
    mine = found.touching & ((found.driving, found.driven)[gear] == TOOTH) & (found.feature == int(Feature.FLANK))
    l = rolls(pair, theta_2[found.position[mine]], gear, flank)
    step = 6.0 * ideal.p_b / steps
    end = math.sqrt((ideal.r_a - height) ** 2 - ideal.r_b**2)
    other = mounted(pair, 1 - gear).gear
    begin = pair.a * math.sin(pair.alpha_w) - other.l_a
    # At an end a corner still touches within the chords: 2 (r_b1 + r_b2) ... sqrt(2 rho 2 nm) = 8 um further on.
    assert np.max(l) == pytest.approx(end, abs=step + 0.02)
    assert np.min(l) == pytest.approx(begin, abs=step + 0.02)
    assert np.count_nonzero(mine) * step / ideal.p_b == pytest.approx((end - begin) / ideal.p_b, abs=0.01)
    assert np.ptp(found.te) * pair.r_b2 <= pair.chord_noise


def later(pair: GearPair, gear: int, r_tip: float, l: float) -> float:
    """How much later in mm along the line of action a corner at ``r_tip`` touches than whole flanks at roll length
    ``l`` would: the mate's involute as points, the corner turned until it is on it, by bisection."""
    mine, mate = mounted(pair, gear).gear, mounted(pair, 1 - gear).gear
    rest = pair.a * math.sin(pair.alpha_w) - l
    foot = complex(pair.a, 0.0)

    def on_flank(one: Gear, at: float, y: float) -> complex:
        """Point of roll length ``y`` on a flank that touches the line of action at ``at``, about its own axis."""
        tau = -pair.alpha_w + (at - y) / one.r_b
        return (one.r_b + 1j * y) * complex(math.cos(tau), math.sin(tau))

    def outside(turn: float) -> float:
        """How far the corner stands from the mate's flank, by angle about the mate's axis."""
        # The driving gear turns on by turn / r_b1: with the corner, or with the flank that comes up to it.
        at_mine, at_mate = (l + turn, rest) if gear == 0 else (l, rest + turn)
        corner = foot - on_flank(mine, at_mine, mine.roll_length(r_tip))
        y = mate.roll_length(abs(corner))
        return float(np.angle(on_flank(mate, at_mate, y) / corner))

    low, high = -1e-3, 0.5
    return float(brentq(outside, low, high, xtol=1e-12))


@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("gear", [0, 1])
def test_below_a_contact_ratio_of_one_the_corner_carries_on(gear: int, flank: Flank) -> None:
    """2 mm down, pairs no longer follow one another: in between the corner touches, alone, and lags as geometry says;
    the next pair takes over where it lags less."""
    height = 2.0
    pair = chipped(gear, height).pair
    ideal = mounted(pair, gear).gear
    r_tip = ideal.r_a - height
    theta_2 = (0.37 + np.arange(1500)) / 1500 * 6.0 * pair.driven.gear.tau + (TOOTH - 3.0) * pair.driven.gear.tau
    found = contacts(pair, theta_2, flank=flank, near=0.0, fast=True)
    sense = 1.0 if flank == "drive" else -1.0
    lag = -sense * found.te * pair.r_b2
    corner = Feature.TURNING_CORNER if gear == 0 else Feature.FIXED_CORNER
    first = np.searchsorted(found.position, np.arange(theta_2.size))
    mine = ((found.driving, found.driven)[gear][first] == TOOTH) & (found.feature[first] == int(corner))
    mine &= lag > 2.0 * pair.chord_noise
    assert np.count_nonzero(mine) > 30
    l = rolls(pair, theta_2[mine], gear, flank)
    expected = [later(pair, gear, r_tip, one) for one in l.tolist()]
    np.testing.assert_allclose(lag[mine], expected, atol=2.0 * pair.chord_noise)
    # The mate's other neighbour, whole, touches with its own corner before it comes to the line of action.
    assert 1.0 * UM < np.max(lag) < 0.05
    # Where all other pairs carry nothing is seen.
    quiet = np.abs(rolls(pair, theta_2, gear, flank) - ideal.l_pitch) > 1.6 * ideal.p_b
    assert np.max(np.abs(lag[quiet])) <= pair.chord_noise


@pytest.mark.long
@pytest.mark.parametrize("gear", [0, 1])
def test_a_chip_that_the_neighbours_bridge_moves_nothing_without_load(gear: int) -> None:
    """As long as the path that is left is a base pitch long, one pair follows the other."""
    pair = whole().pair
    ideal, other = mounted(pair, gear).gear, mounted(pair, 1 - gear).gear
    begin = pair.a * math.sin(pair.alpha_w) - other.l_a
    bridged = ideal.r_a - math.hypot(ideal.r_b, begin + ideal.p_b)
    assert 1.0 < bridged < 1.6  # mm
    for height, shows in ((bridged - 0.02, False), (bridged + 0.1, True)):
        cut = chipped(gear, height)
        theta_2 = one_pitch(cut, 3600, meshes=18)
        for flank in FLANKS:
            moved = float(np.ptp(unloaded_te(cut, theta_2, flank=flank)))
            assert (moved > 10.0 * pair.chord_noise) == shows
            assert shows or moved <= pair.chord_noise


@pytest.mark.parametrize("gear", [0, 1])
def test_both_flanks_mirror_each_other(gear: int) -> None:
    """A deviation-free pair whose chipped tooth stands on the line of centres looks the same from either side."""
    cut = chipped(gear, 2.0)
    pair = cut.pair
    ideal = mounted(pair, gear).gear
    half = ideal.psi(ideal.r_b / math.cos(pair.alpha_w))
    # Driven rotation at which the tooth's centre line points at the mate, its drive flank at the pitch point before
    # (driving: counter-clockwise of it, turning so) or after that.
    centred = TOOTH * ideal.tau + (half if gear == 0 else -half)
    centred *= pair.ratio if gear == 0 else 1.0
    theta_2 = np.linspace(-1.5, 1.5, 601) * pair.driven.gear.tau
    drive = unloaded_te(cut, centred + theta_2)
    coast = unloaded_te(cut, centred - theta_2, flank="coast")
    np.testing.assert_allclose(coast, -drive, atol=1e-12)
    assert np.ptp(drive) > 1.0 * UM


# Both kernels.


def spoilt(seed: int) -> GearPair:
    """Random gears of random grades, off centre, with chips of every size on a third of their teeth."""
    rng = np.random.default_rng(seed)
    z = [int(one) for one in rng.integers(8, 61, 2)]
    gears = [Gear(z=one, m=2.0) for one in z]
    a = tight_centre_distance(*gears)
    points, grade = int(rng.integers(60, 400)), int(rng.integers(5, 10))
    flanks = []
    for k, gear in enumerate(gears):
        l_form = form_point(gear)[1]
        l_start = active_start(gear, gears[1 - k], l_form=l_form)
        limit = tolerances(d=gear.z * 2.0, m=2.0, grade=grade)
        shapes = draw_deviations(
            gear,
            limits_for(gear, grade=limit, thickness=default_thickness(a=a, m=2.0, alpha=gear.alpha, F_pT=limit.F_pT)),
            rng=streams(seed)[k],
            which="driving" if k == 0 else "driven",
            profile_errors="smooth",
            roll_lengths=np.linspace(l_start, gear.l_a, points),
        ).deviations
        room = gear.r_a - math.hypot(gear.r_b, l_form)
        teeth = rng.choice(gear.z, gear.z // 3, replace=False).tolist()
        chips = tuple(MissingTip(tooth, float(rng.uniform(0.0, 0.95)) * room) for tooth in teeth)
        flanks.append(draw_flanks(gear, shapes + Deviations(chips=chips), l_start=l_start, points=points))
    return mount(
        *flanks, a=a + float(rng.uniform(0.0, 0.3)), eccentricity_1=(float(rng.uniform(0.0, 0.04)), 0.7),
        eccentricity_2=(float(rng.uniform(0.0, 0.04)), 2.1),
    )  # fmt: skip


def one_by_one(r: Run) -> dict[tuple[int, int, int], float]:
    """Closing of every near pair by the oracle, which is asked for each pair of teeth by the line of centres: a fixed
    tooth that faces a chipped one may touch its neighbour as well."""
    turning, fixed = r.turning.faces, r.fixed.faces
    a, near = r.how["axis_distance"], r.how["near"]
    passed = -0.25 * 2.0 * math.pi / len(turning)
    out: dict[tuple[int, int, int], float] = {}
    for p, (pose, guess) in enumerate(zip(r.how["poses"].tolist(), r.how["guesses"].tolist(), strict=True)):
        ahead, towards = (
            np.angle((faces[:, -1, 0] + 1j * faces[:, -1, 1]) * np.exp(1j * turn) * sign)
            for faces, turn, sign in ((turning, guess, 1.0), (fixed, pose, -1.0))
        )
        found = {}
        for i in np.argsort(np.abs(ahead))[:5].tolist():
            for j in np.argsort(np.abs(towards))[:5].tolist():
                value = closing_rotation(turning[i], fixed[j], axis=(a, 0.0), pose=pose, rotation_guess=guess)[1]
                if value >= passed:
                    found[p, i, j] = value
        first = min(found.values(), default=0.0)
        out |= {key: value for key, value in found.items() if value <= first + near}
    return out


@pytest.mark.long
@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("seed", [0, 32, 45, *(pytest.param(one, marks=pytest.mark.slow) for one in (1, 2, 3, 57))])
def test_both_kernels_agree_on_random_gears_with_chips(seed: int, flank: Flank) -> None:
    """Every near pair: the compiled search, the certified polygons, and the oracle that shares no code with either.

    Among them tips that pass each other by (32), and corners that graze a tip on their way in (45, 57). Where several
    neighbours are gone the gears lose each other for more than a pitch, and nobody is asked.
    """
    pair = spoilt(seed)
    r = run(pair, flank, positions=90, near=60.0 * UM)
    found = r.fast(), r.certified()
    fast, certified = (closings(one) for one in found)
    first = found[0].first()
    lost = set(found[0].pose[first][found[0].rotation[first] > WIDE_SHARE * pair.driving.gear.tau].tolist())
    assert len(lost) < 5
    exact = {key: value for key, value in one_by_one(r).items() if key[0] not in lost}
    feature = [dict(zip(closings(one), one.feature.tolist(), strict=True)) for one in found]
    for each, promised in ((fast, ROUNDING), (certified, PROMISED)):
        mine = {key: value for key, value in each.items() if key[0] not in lost}
        assert mine.keys() == exact.keys()
        assert max(abs(mine[key] - exact[key]) for key in exact) <= promised
    assert all(feature[0][key] == feature[1][key] for key in exact)


def test_where_so_many_neighbours_are_gone_that_the_gears_slip_it_is_said() -> None:
    """Three stumps that meet three: the driving gear turns freely for a good part of a pitch, and nothing is known of
    what it does then. Stumps that meet whole teeth still touch."""
    chips = [{"tooth": tooth, "height_mm": 3.0} for tooth in (3, 4, 5)]
    assembled = made(pair_file(driving={"chip": chips}))
    assert np.ptp(unloaded_te(assembled, one_pitch(assembled, 60, meshes=9))) > 0.3  # mm
    assembled = made(pair_file(driving={"chip": chips}, driven={"chip": chips}))
    for fast in (True, False):
        with pytest.raises(NoContactError, match="no drive flanks touch at driven angle"):
            contacts(assembled.pair, one_pitch(assembled, 60, meshes=9), near=0.0, fast=fast)


# Under load.


@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("gear", [0, 1])
def test_past_the_lower_tip_the_other_pair_carries_all(gear: int, flank: Flank) -> None:
    """Once the corner stands off by more than teeth give, load is shared as if that tooth's pair were not there; below
    the chip the tooth gives as it did."""
    plain, cut = whole(bends=True), chipped(gear, 0.8, bends=True)
    theta_2 = one_pitch(plain, 600, meshes=2) + (TOOTH - 1.0) * plain.pair.driven.gear.tau
    if flank == "coast":
        theta_2 = theta_2 + 0.5 * plain.pair.driven.gear.tau
    torque = 20.0
    l = rolls(cut.pair, theta_2, gear, flank)
    ideal = mounted(cut.pair, gear).gear
    end = ideal.roll_length(ideal.r_a - 0.8)
    clear, below = (l > end + 0.6) & (l < ideal.l_a - 0.05), (l < end - 0.05) & (l > 0.0)
    assert np.count_nonzero(clear) > 20 and np.count_nonzero(below) > 100
    before, by = under(plain, theta_2[clear], torque, flank=flank)
    after = under(cut, theta_2[clear], torque, flank=flank)[0]
    rows = before.contacts
    kept = (rows.driving, rows.driven)[gear] != TOOTH
    alone = loaded(
        replace(
            rows, position=rows.position[kept], driving=rows.driving[kept], driven=rows.driven[kept],
            gap=rows.gap[kept], point=rows.point[kept], normal=rows.normal[kept], feature=rows.feature[kept],
            overrun=rows.overrun[kept], touching=rows.touching[kept],
        ),
        by, torque=torque * NM,
    )  # fmt: skip
    r_b2 = cut.pair.r_b2
    assert np.min(np.abs(after.te - before.te)) * r_b2 > 1.0 * UM
    # Chords of both pairs count, of the one that carries and of the one that touched first.
    np.testing.assert_allclose(after.te * r_b2, alone.te * r_b2, atol=4.0 * cut.pair.chord_noise)
    # Vertices lie elsewhere on the chipped tooth, 4 um apart; 3 um of deflection change by 3e-4 from one to the next.
    kept = [under(one, theta_2[below], torque, flank=flank)[0].te * r_b2 for one in (plain, cut)]
    np.testing.assert_allclose(*kept, atol=1e-3 * UM)


# What a diagnosis is shown.


@pytest.mark.long
@pytest.mark.parametrize("k", range(len(CONDITIONS)))
def test_its_effect_is_the_same_beside_it_and_before_it(k: int) -> None:
    """In a scene that has the chip its contacts are gone; the effect is told from the whole tooth all the same."""
    claim = claim_of("tooth_chip")
    # One that touches first, so that it is missed without load too.
    claim = replace(claim, place=replace(claim.place, tooth=9))
    effect = claim.physics.effect
    assert effect is not None
    file = declared("tooth_chip")
    bare, cut = made(file), made(claim.written(file))
    theta_2 = (np.arange(1500) + 0.37) * (bare.pair.cycle / 1500)
    samples = samples_at(bare, theta_2, CONDITIONS[k], k)
    before = effect(stage(bare, samples), claim.place, claim.values)
    np.testing.assert_allclose(effect(stage(cut, samples), claim.place, claim.values), before, atol=1e-12)
    assert np.max(np.abs(before)) > 1.0 * UM


DRIVE, COAST = Condition(), Condition(flank="coast")
PIT = Claim(
    physics=catalogue()["tooth_spall"], place=Place(gear=0, tooth=3), values=(40.0, 13.4, 14.1, 0.06)
)  # over the last 0.6 mm of the flank, far deeper than teeth give
"""A pit that leaves as much of the drive flank as the chip of the typical case does."""


def found_of(claim: Claim, *conditions: Condition) -> Finding:
    """The only finding of recordings of a pair with a ``claim`` in it."""
    file = declared("tooth_chip")
    made_of = recorded(claim.written(file), conditions, np.random.default_rng(11))
    (found,) = diagnose(file, made_of, path=Path("pair.toml")).findings
    return found


@pytest.mark.slow
def test_one_flank_leaves_a_pit_at_the_tip_beside_it() -> None:
    """A pit with steep walls takes the same contact away; the coast flank would tell."""
    found = found_of(claim_of("tooth_chip"), DRIVE)
    (rival,) = found.rivals
    assert (found.claim.physics.name, rival.claim.physics.name) == ("tooth_chip", "tooth_spall")
    assert (found.claim.place.tooth, rival.claim.place.tooth) == (3, 3)
    assert 0.05 < rival.probability < found.probability
    assert found.probability + rival.probability > 0.95
    assert found.separation is not None
    assert found.separation.recording.flank == "coast"


@pytest.mark.slow
@pytest.mark.parametrize("claim", [claim_of("tooth_chip"), PIT], ids=["chip", "pit"])
def test_both_flanks_tell_a_missing_tip_from_a_pit_there(claim: Claim) -> None:
    found = found_of(claim, DRIVE, COAST)
    assert (found.claim.physics.name, found.claim.place.tooth) == (claim.physics.name, 3)
    assert found.probability > 0.95
    assert not found.rivals


# Studies.


def test_a_study_draws_chipped_gears_as_a_single_run_does(tmp_path: Path) -> None:
    document = chipped_file(0, 0.7).model_dump(exclude_unset=True)
    for name in GEARS:
        del document[name]["inspection"]
        document[name]["grade"] = 6
    file, path = PairFile.model_validate(document), tmp_path / "pair.toml"
    one, other = assemble(file, path=path, seed=7).pair, maker(file, path).make(7).pair
    for name in GEARS:
        mine, theirs = getattr(one, name).flanks, getattr(other, name).flanks
        for side in FLANKS:
            np.testing.assert_allclose(getattr(mine, side), getattr(theirs, side), atol=1e-12)
    assert set(other.driving.flanks.chipped) == {TOOTH}


@pytest.mark.long
@pytest.mark.parametrize("gear", [0, 1])
def test_traces_of_an_inspection_end_where_the_tip_is_missing(gear: int, tmp_path: Path) -> None:
    """At the roll length of the corner, sqrt((r_a - h)^2 - r_b^2), to a step of the trace; others reach the tip. The
    files say so, and with the chip stated beside the traces the same gear is drawn again."""
    name, height = GEARS[gear], 0.8
    drawn = api.Pair.of(tomllib.loads(dump_pair(chipped_file(gear, height))))
    ideal = Gear(z=18 if gear == 0 else 25, m=2.0)
    corner = math.sqrt((ideal.r_a - height) ** 2 - ideal.r_b**2)
    csv, gde = tmp_path / "g.traces.csv", tmp_path / "g.gde"
    drawn.export(csv, which=name)
    drawn.export(gde, which=name)
    traces = read_traces(csv, ideal.z)
    step = float(traces[0].roll_length[1] - traces[0].roll_length[0])
    for one in traces:
        end = corner if one.tooth == TOOTH else ideal.l_a
        assert -1e-9 <= end - one.roll_length[-1] <= step, (one.tooth, one.flank)
    assert f"# tooth {TOOTH} ends 0.8 mm below its tip circle" in csv.read_text("utf-8")
    sheet = read_gde(gde)
    assert sheet.name.endswith(f"tooth {TOOTH + 1} ends 0.8 mm below its tip circle, and its traces end there")
    ends = {one.tooth: one.roll_length[-1] for one in sheet.profiles}
    assert min(ends, key=lambda tooth: ends[tooth]) == TOOTH + 1

    raw = tomllib.loads(dump_pair(chipped_file(gear, height)))
    raw[name]["inspection"] = {"tooth_thickness_um": 0.0, "profile_csv": str(csv)}
    again = api.Pair.of(raw)
    both = [(one.driving if gear == 0 else one.driven).polygon for one in (drawn, again)]
    # Both ends of a trace are rounded numbers of 16 digits; areas of 900 mm^2 then agree to 1e-9.
    assert both[0].symmetric_difference(both[1]).area < 1e-6


def test_traces_end_earlier_where_the_flank_stands_off(tmp_path: Path) -> None:
    """A flank that stands in by d meets the circle that is left where its involute is d longer."""
    height, off = 0.8, -40.0
    raw = tomllib.loads(dump_pair(chipped_file(0, height)))
    raw["driving"]["inspection"]["pitch_um"] = off
    drawn = api.Pair.of(raw)
    ideal, csv = Gear(z=18, m=2.0), tmp_path / "g.traces.csv"
    drawn.export(csv, which="driving")
    corner = math.sqrt((ideal.r_a - height) ** 2 - ideal.r_b**2)
    (one,) = (one for one in read_traces(csv, ideal.z) if (one.tooth, one.flank) == (TOOTH, "drive"))
    step = float(one.roll_length[1] - one.roll_length[0])
    assert -1e-9 <= corner - off * UM - one.roll_length[-1] <= step


def test_a_design_says_that_a_chip_is_left_out(tmp_path: Path) -> None:
    file = chipped_file(1, 0.8)
    assert export_design(file, made(file), tmp_path / "d.rexs", Request()).remarks == (
        "not part of a design and left out: driving.inspection, driven.inspection, driven.chip",
    )
