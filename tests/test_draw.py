"""Drawn error gears: limits, distribution, reproducibility, and what an inspector measures on the
drawn flanks."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest
from scipy.stats import ks_2samp, kstest

from gearpoly.errors import NoGearPassesError, OutOfRangeError
from gearpoly.gear.chain import closed_chain
from gearpoly.gear.deviations import Span, total
from gearpoly.gear.draw import Drawn, draw_deviations, streams
from gearpoly.gear.flank import Flanks, draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.gear.metrology import Which, base_tangent_deviations, cumulative_pitch, profile_deviations, single_pitch
from gearpoly.gear.polygon import rotate
from gearpoly.gear.tolerances import Limits, default_thickness, limits_for, tolerances
from gearpoly.units import FloatArray

ROUNDING = 1e-12
"""mm. Sums of up to 1000 deviations of 0.1 mm in float64."""
UNLIKELY = 1e-3
"""p-value below which two samples of a fixed seed count as different; a wrong law gives far
less."""


def graded(z: int, *, grade: int = 5, m: float = 2.0) -> tuple[Gear, Limits]:
    gear = Gear(z=z, m=m)
    t = tolerances(d=z * m, m=m, grade=grade)
    thickness = default_thickness(a=z * m, m=m, alpha=gear.alpha, F_pT=t.F_pT)
    return gear, limits_for(gear, grade=t, thickness=thickness)


def inspect(gear: Gear, limits: Limits, drawn: Drawn, which: Which) -> None:
    """Every limit, from the numbers alone, in a second formulation: cumulative sums and loops."""
    cosine = math.cos(gear.alpha)
    z, k = gear.z, gear.k_span
    for side in (drawn.index, drawn.index_coast):
        arcs = side / cosine
        steps = [arcs[(n + 1) % z] - arcs[n] for n in range(z)]
        assert abs(sum(steps)) < ROUNDING
        assert max(map(abs, steps)) <= limits.f_pT + ROUNDING
        assert max(arcs) - min(arcs) <= limits.F_pT + ROUNDING
    assert drawn.index[0] == 0.0
    for n in range(z):
        E_s = (drawn.index[n] + drawn.index_coast[n]) / cosine
        assert E_s == pytest.approx(drawn.E_s[n], abs=ROUNDING)
        assert limits.E_sni - ROUNDING <= E_s <= limits.E_sns + ROUNDING
        far = (n + k - 1) % z
        drive, coast = (n, far) if which == "driving" else (far, n)
        W_k = drawn.index[drive] + drawn.index_coast[coast]
        assert limits.W_kni - ROUNDING <= W_k <= limits.W_kns + ROUNDING


@pytest.mark.parametrize("which", ["driving", "driven"])
@pytest.mark.parametrize("z", [6, 18, 25, 80, 200])
def test_graded_gears_keep_every_limit(z: int, which: Which) -> None:
    gear, limits = graded(z)
    for seed in range(3):
        drawn = draw_deviations(gear, limits, rng=streams(seed)[0], which=which)
        inspect(gear, limits, drawn, which)
        # Every tooth and both flanks differ.
        for numbers in (drawn.index, drawn.index_coast, drawn.E_s, drawn.f_Halpha, drawn.f_falpha):
            assert np.unique(numbers).size == numbers.size


@pytest.mark.slow
def test_a_thousand_teeth() -> None:
    gear, limits = graded(1000)
    inspect(gear, limits, draw_deviations(gear, limits, rng=streams(1)[0]), "driving")


@pytest.mark.long
def test_limits_narrower_than_twice_F_p_are_kept_by_drawing_again() -> None:
    gear, limits = graded(18)
    narrow = limits_for(
        gear,
        stated={"f_pt": 0.0076, "F_p": 0.03, "F_alpha": 0.0051, "E_sns": -0.04, "E_sni": -0.06},
    )
    tried = []
    for seed in range(20):
        drawn = draw_deviations(gear, narrow, rng=streams(seed)[0])
        inspect(gear, narrow, drawn, "driving")
        tried.append(drawn.gears)
    assert max(tried) > 1
    assert draw_deviations(gear, limits, rng=streams(0)[0]).gears == 1


def test_base_tangent_limits_of_their_own() -> None:
    gear, limits = graded(25)
    middle = 0.5 * (limits.W_kns + limits.W_kni)
    own = {"W_kns": middle + 0.009, "W_kni": middle - 0.009}
    tight = limits_for(
        gear,
        grade=tolerances(d=50.0, m=2.0, grade=5),
        stated={"E_sns": limits.E_sns, "E_sni": limits.E_sni, **own},
    )
    for seed in range(5):
        inspect(gear, tight, draw_deviations(gear, tight, rng=streams(seed)[0]), "driving")


@pytest.mark.long
@pytest.mark.parametrize("which", ["driving", "driven"])
def test_independent_thickness(which: Which) -> None:
    gear, limits = graded(25)
    E, W = [], []
    for seed in range(40):
        drawn = draw_deviations(gear, limits, rng=streams(seed)[1], which=which, thickness_errors="independent")
        assert np.all(np.abs(single_pitch(drawn.index, alpha=gear.alpha)) <= limits.f_pT + ROUNDING)
        assert cumulative_pitch(drawn.index, alpha=gear.alpha) <= limits.F_pT + ROUNDING
        E.append(drawn.E_s)
        W.append(base_tangent_deviations(gear, index=drawn.index, index_coast=drawn.index_coast, which=which))
    E_s, W_k = np.array(E), np.array(W)
    assert np.all((E_s <= limits.E_sns + ROUNDING) & (E_s >= limits.E_sni - ROUNDING))
    assert np.all((W_k <= limits.W_kns + ROUNDING) & (W_k >= limits.W_kni - ROUNDING))
    # Teeth know nothing of their neighbours: 1000 pairs, so correlations of 0.1 are three sigma.
    assert abs(np.corrcoef(E_s[:, :-1].ravel(), E_s[:, 1:].ravel())[0, 1]) < 0.1


@pytest.mark.long
@pytest.mark.parametrize("gears", [200, pytest.param(600, marks=pytest.mark.slow)])
def test_independent_thickness_is_that_of_drawing_teeth_again(gears: int) -> None:
    gear, limits = graded(8, grade=8)
    narrow = limits_for(
        gear,
        stated={"f_pt": limits.f_pT, "F_p": limits.F_pT, "E_sns": -0.05, "E_sni": -0.1},
    )
    rng, cosine, k = np.random.default_rng(5), math.cos(gear.alpha), gear.k_span
    ours, naive = [], []
    for seed in range(gears):
        drawn = draw_deviations(gear, narrow, rng=streams(seed)[0], thickness_errors="independent")
        ours.append(drawn.E_s[3])
        first = (3 - (k - 1)) % 8
        while True:
            E_s = rng.uniform(narrow.E_sni, narrow.E_sns)
            W_k = drawn.index[first] - drawn.index[3] + E_s * cosine
            if narrow.W_kni <= W_k <= narrow.W_kns:
                break
        naive.append(E_s)
    assert ks_2samp(ours, naive).pvalue > UNLIKELY


# The law of the chains.


def chains_by_chance(z: int, f: float, F: float, count: int, rng: np.random.Generator) -> FloatArray:
    """Independent uniform steps, kept where the last one closes the chain within ``f`` and the
    range within ``F``."""
    found: list[FloatArray] = []
    while len(found) < count:
        steps = rng.uniform(-f, f, (50_000, z))
        steps[:, -1] = -np.sum(steps[:, :-1], axis=1)
        index = np.cumsum(steps, axis=1) - steps
        good = (np.abs(steps[:, -1]) <= f) & (np.ptp(index, axis=1) <= F)
        found.extend(index[good])
    return np.array(found[:count])


@pytest.mark.long
@pytest.mark.parametrize(
    ("z", "F"),
    [(6, 1.2), pytest.param(9, 1.7, marks=pytest.mark.slow), pytest.param(12, 1.5, marks=pytest.mark.slow), (12, 2.4)],
)
@pytest.mark.parametrize("chains", [400, pytest.param(1200, marks=pytest.mark.slow)])
def test_chains_are_those_of_chance(z: int, F: float, chains: int) -> None:
    rng = np.random.default_rng(20)
    ours = np.array([closed_chain(z, f=1.0, F=F, rng=rng) for _ in range(chains)])
    chance = chains_by_chance(z, 1.0, F, chains, rng)
    for number in (
        lambda c: np.ptp(c, axis=1),
        lambda c: c[:, 1],
        lambda c: c[:, z // 2],
        lambda c: np.max(np.abs(np.diff(c, axis=1)), axis=1),
        lambda c: np.mean(c, axis=1),
        lambda c: np.sum(np.diff(c, axis=1) ** 2, axis=1),
    ):
        # Six numbers of eight cases: one of them all falls below UNLIKELY in 5 of 100 runs of a right law.
        assert ks_2samp(number(ours), number(chance)).pvalue > UNLIKELY / 48


@pytest.mark.parametrize("chains", [150, pytest.param(500, marks=pytest.mark.slow)])
def test_the_two_ways_to_draw_a_chain_agree_where_they_meet(chains: int) -> None:
    # At F = f sqrt(z/3) the sampler changes its way; the range must not jump there.
    z, edge, rng = 27, 3.0, np.random.default_rng(3)
    below, above = (
        [np.ptp(closed_chain(z, f=1.0, F=F, rng=rng)) / F for _ in range(chains)]
        for F in (edge * (1.0 - 1e-6), edge * (1.0 + 1e-6))
    )
    assert ks_2samp(below, above).pvalue > UNLIKELY


@pytest.mark.long
@pytest.mark.parametrize("count", [200, pytest.param(600, marks=pytest.mark.slow)])
def test_no_tooth_is_special_but_the_first_is_zero(count: int) -> None:
    # The chain closes, so steps from any tooth follow one law, also the closing one.
    rng = np.random.default_rng(8)
    chains = np.array([closed_chain(40, f=1.0, F=2.5, rng=rng) for _ in range(count)])
    steps = np.roll(chains, -1, axis=1) - chains
    assert np.all(chains[:, 0] == 0.0)
    assert ks_2samp(steps[:, 5], steps[:, -1]).pvalue > UNLIKELY
    assert ks_2samp(steps[:, 5], -steps[:, 20]).pvalue > UNLIKELY


def test_limits_that_bind_alone() -> None:
    rng = np.random.default_rng(1)
    assert np.all(closed_chain(20, f=0.0, F=1.0, rng=rng) == 0.0)
    assert np.all(closed_chain(20, f=1.0, F=0.0, rng=rng) == 0.0)
    assert np.ptp(closed_chain(20, f=5.0, F=0.5, rng=rng)) <= 0.5
    assert np.max(np.abs(np.diff(closed_chain(20, f=0.1, F=99.0, rng=rng)))) <= 0.1


# Streams.


def same(a: Drawn, b: Drawn) -> bool:
    return all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for name in ("index", "index_coast", "E_s", "f_Halpha", "f_falpha")
    )


def test_one_seed_one_gear() -> None:
    gear, limits = graded(25)
    first = draw_deviations(gear, limits, rng=streams(7)[0])
    assert same(first, draw_deviations(gear, limits, rng=streams(7)[0]))
    assert not same(first, draw_deviations(gear, limits, rng=streams(7)[1]))
    assert not same(first, draw_deviations(gear, limits, rng=streams(8)[0]))


def test_the_mate_has_no_part_in_it() -> None:
    (gear, limits), (mate, others) = graded(18), graded(25)
    alone = draw_deviations(mate, others, rng=streams(3)[1], which="driven")
    driving, driven = streams(3)
    draw_deviations(gear, limits, rng=driving)
    assert same(alone, draw_deviations(mate, others, rng=driven, which="driven"))


def test_options_leave_other_numbers_alone() -> None:
    gear, limits = graded(18)
    smooth = draw_deviations(gear, limits, rng=streams(3)[0])
    grid = np.linspace(2.0, 9.0, 50)
    scatter = draw_deviations(gear, limits, rng=streams(3)[0], profile_errors="scatter", roll_lengths=grid)
    apart = draw_deviations(gear, limits, rng=streams(3)[0], thickness_errors="independent")
    assert np.array_equal(smooth.index, scatter.index)
    assert np.array_equal(smooth.index_coast, scatter.index_coast)
    assert np.array_equal(smooth.index, apart.index)
    assert np.array_equal(smooth.f_Halpha, apart.f_Halpha)
    # A tooth's profile does not depend on how many others there are.
    more = draw_deviations(Gear(z=30, m=2.0), limits, rng=streams(3)[0])
    assert np.array_equal(smooth.f_Halpha, more.f_Halpha[:, :18])


# Profiles.

SPAN = Span(l_start=2.0, l_a=9.0)


@pytest.mark.parametrize("side", ["drive", "coast"])
def test_an_inspector_finds_the_profile_that_was_drawn(side: Literal["drive", "coast"]) -> None:
    gear, limits = graded(25)
    drawn = draw_deviations(gear, limits, rng=streams(2)[0])
    l = np.linspace(SPAN.l_start, SPAN.l_a, 4001)
    shapes = getattr(drawn.deviations, side)
    traces = total(shapes, l[None, :], z=25, span=SPAN)
    row = 0 if side == "drive" else 1
    slope, form, all_of_it = profile_deviations(SPAN.u(l), traces)
    # On another grid than it was drawn on: 5 half waves on 1001 places, see draw._U.
    assert slope == pytest.approx(drawn.f_Halpha[row], abs=1e-5 * limits.f_HalphaT)
    assert form == pytest.approx(drawn.f_falpha[row], rel=1e-4)
    assert np.all(np.abs(drawn.f_Halpha) <= limits.f_HalphaT + ROUNDING)
    assert np.all(drawn.f_falpha <= limits.f_falphaT + ROUNDING)
    assert np.all(all_of_it <= limits.F_alphaT * (1.0 + 1e-4))
    # Form and slope leave a flank where its index deviation has it, but for the odd waves' lean.
    index = drawn.index if side == "drive" else drawn.index_coast
    assert np.mean(traces, axis=1) == pytest.approx(index, abs=1e-3 * limits.f_falphaT)


def test_slope_of_a_cosine() -> None:
    # Least squares: 12 integral (u - 1/2) cos(n pi u) du = -24/(n pi)^2 for odd n, 0 for even.
    u = np.linspace(0.0, 1.0, 2001) ** 1.5
    for n in range(2, 6):
        slope, _form, whole = profile_deviations(u, np.cos(n * np.pi * u))
        exact = -24.0 / (n * np.pi) ** 2 if n % 2 else 0.0
        assert slope == pytest.approx(exact, abs=1e-5)  # trapezoids: n^2 pi^2 du^2 / 12
        assert whole == pytest.approx(2.0, abs=1e-5)


def test_slope_and_form_are_uniform_where_the_total_does_not_bind() -> None:
    gear = Gear(z=200, m=2.0)
    limits = Limits(f_HalphaT=0.004, f_falphaT=0.006, F_alphaT=0.01)
    drawn = draw_deviations(gear, limits, rng=streams(4)[0])
    assert kstest(drawn.f_Halpha.ravel(), "uniform", (-0.004, 0.008)).pvalue > UNLIKELY
    assert kstest(drawn.f_falpha.ravel(), "uniform", (0.0, 0.006)).pvalue > UNLIKELY


def test_scatter_is_uniform_within_the_total() -> None:
    gear = Gear(z=18, m=2.0)
    grid = np.linspace(SPAN.l_start, SPAN.l_a, 60)
    limits = Limits(F_alphaT=0.008)
    drawn = draw_deviations(gear, limits, rng=streams(4)[0], profile_errors="scatter", roll_lengths=grid)
    for shapes in (drawn.deviations.drive, drawn.deviations.coast):
        points = total(shapes, grid[None, :], z=18, span=SPAN)
        assert np.ptp(points, axis=1).max() <= 0.008
        assert kstest(points.ravel(), "uniform", (-0.004, 0.008)).pvalue > UNLIKELY
    with pytest.raises(OutOfRangeError, match="roll_lengths of two or more"):
        draw_deviations(gear, limits, rng=streams(4)[0], profile_errors="scatter")


# The base tangent on the drawn flanks.


def measured_W_k(flanks: Flanks, which: Which, n: int) -> float:
    """Distance in mm of two parallel anvils on the outer flanks of the k teeth from tooth ``n`` on,
    from points alone."""
    gear, k = flanks.gear, flanks.gear.k_span
    sense = -1.0 if which == "driving" else 1.0
    far = n + k - 1
    left, right = (n, far) if which == "driving" else (far, n)  # left: counter-clockwise end
    middle = sense * gear.tau * (n + 0.5 * (k - 1))
    e = np.array([-math.sin(middle), math.cos(middle)])
    involute = slice(flanks.root.n, None)
    drive = rotate(flanks.drive[left % gear.z, involute], sense * gear.tau * left)
    coast = rotate(flanks.coast[right % gear.z, involute], sense * gear.tau * right)
    return float(np.max(drive @ e) - np.min(coast @ e))


@pytest.mark.parametrize("which", ["driving", "driven"])
@pytest.mark.parametrize("z", [18, 25])
def test_base_tangent_length_of_the_polylines(z: int, which: Which) -> None:
    gear, limits = graded(z, grade=9)
    limits = Limits(
        f_pT=limits.f_pT,
        F_pT=limits.F_pT,
        E_sns=limits.E_sns,
        E_sni=limits.E_sni,
        W_kns=limits.W_kns,
        W_kni=limits.W_kni,
    )
    drawn = draw_deviations(gear, limits, rng=streams(6)[0], which=which)
    flanks = draw_flanks(gear, drawn.deviations, points=4000)
    expected = gear.W_k + base_tangent_deviations(gear, index=drawn.index, index_coast=drawn.index_coast, which=which)
    for n in range(z):
        # 4000 points: the best vertex lies within 1e-6 mm of the tangent point's projection.
        assert measured_W_k(flanks, which, n) == pytest.approx(expected[n], abs=1e-6)
    # The other numbering measures other pairs of flanks: it must not pass for this one.
    other: Which = "driven" if which == "driving" else "driving"
    assert np.ptp(expected) > 1e-3
    swapped = base_tangent_deviations(gear, index=drawn.index, index_coast=drawn.index_coast, which=other)
    assert np.max(np.abs(gear.W_k + swapped - expected)) > 1e-3


def test_mean_base_tangent_deviation_is_the_mean_thickness() -> None:
    gear, limits = graded(25)
    drawn = draw_deviations(gear, limits, rng=streams(6)[0])
    W = base_tangent_deviations(gear, index=drawn.index, index_coast=drawn.index_coast, which="driving")
    assert np.mean(W) == pytest.approx(np.mean(drawn.E_s) * math.cos(gear.alpha), abs=ROUNDING)


# Limits that contradict one another.


def test_thickness_and_base_tangent_apart() -> None:
    gear, limits = graded(18)
    apart = limits_for(
        gear,
        grade=tolerances(d=36.0, m=2.0, grade=5),
        stated={"E_sns": -0.05, "E_sni": -0.08, "W_kns": -0.1, "W_kni": -0.12},
    )
    with pytest.raises(NoGearPassesError, match=r"W_k from -75.18 to -46.98 .* -120.00 to -100.00"):
        draw_deviations(gear, apart, rng=streams(1)[0])
    assert limits.E_sns > limits.E_sni


@pytest.mark.long
@pytest.mark.parametrize("errors", ["graded", "independent"])
def test_no_room_for_the_thickness(errors: Literal["graded", "independent"]) -> None:
    gear = Gear(z=18, m=2.0)
    stated = {"f_pt": 0.0076, "F_p": 0.03, "E_sns": -0.04, "E_sni": -0.04}
    limits = limits_for(gear, stated=stated)
    with pytest.raises(NoGearPassesError) as caught:
        draw_deviations(gear, limits, rng=streams(1)[0], thickness_errors=errors)
    for word in ("none of 400", "f_pT = 7.60 um", "E_s from -40.00 to -40.00", "2 F_pT = 60.00 um"):
        assert word in str(caught.value)
    # What the message says would do does.
    wide = limits_for(gear, stated=stated | {"E_sni": -0.10})
    assert draw_deviations(gear, wide, rng=streams(1)[0], thickness_errors=errors).gears == 1


def test_no_room_for_the_profile() -> None:
    limits = Limits(f_HalphaT=0.004, f_falphaT=0.006, F_alphaT=0.0)
    with pytest.raises(NoGearPassesError, match=r"F_alphaT of 10.00 um always would do"):
        draw_deviations(Gear(z=18, m=2.0), limits, rng=streams(1)[0])


def test_an_ideal_gear_has_no_deviation() -> None:
    drawn = draw_deviations(Gear(z=18, m=2.0), Limits(), rng=streams(1)[0])
    l = np.linspace(SPAN.l_start, SPAN.l_a, 20)[None, :]
    for shapes in (drawn.deviations.drive, drawn.deviations.coast):
        assert not np.any(total(shapes, l, z=18, span=SPAN))
