"""What both flanks of uninspected teeth share, and whole turns that nobody counted between their recordings."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Literal

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from gearpoly.compare.compare import compare
from gearpoly.diagnose.as_built import AsBuilt, GearPrior, chain, make_as_built
from gearpoly.diagnose.both_flanks import SHARED, scattered, surprise, told, turns_told
from gearpoly.diagnose.prepare import only_shaft_read, prepare
from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import System
from gearpoly.physics.base import Claim
from gearpoly.physics.eccentricity import PHYSICS as ECCENTRICITY
from gearpoly.physics.place import Place
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray
from tests.physics_cases import Condition, recorded, rough

Z = 18, 24
ALPHA = np.radians(20.0)
NOISE = 0.1
"""um to which every parameter is read."""


def graded(z: int, *, shared: tuple[float, float] = (0.5, 0.5), known: bool = False) -> GearPrior:
    return GearPrior(
        z=z, pitch=chain(z, single=4.5, cumulative=15.0), slope=1.0, mean_slope=1.0, crowning=0.5, thickness=4.0,
        shared=shared, own=(0.0, 0.0), graded=not known,
    )  # fmt: skip


def teeth(*, shared: tuple[float, float] = (0.5, 0.5), known: bool = False) -> AsBuilt:
    one, two = (graded(z, shared=shared, known=known) for z in Z)
    return make_as_built((one, two), ["drive", "coast"])


def read(true: FloatArray, as_built: AsBuilt) -> System:
    """The system of recordings that tell every as-built parameter by itself, to ``NOISE``."""
    noisy = true + np.random.default_rng(5).normal(0.0, NOISE, true.size)
    size = as_built.size
    return System(
        white=[full(np.eye(size) / NOISE)], target=[noisy / NOISE], precision=as_built.precision, prior=np.zeros(size)
    )


def drawn(as_built: AsBuilt, seed: int) -> FloatArray:
    """Teeth as the prior has them."""
    return np.linalg.cholesky(np.linalg.inv(as_built.precision)) @ np.random.default_rng(seed).normal(
        size=as_built.size
    )


def asked(as_built: AsBuilt, system: System, **more: object) -> tuple[Any, Any, Any]:
    """Model, scenes and linear state, as far as the question needs them: recordings of either flank that read every
    parameter once, where an eccentricity leads by 20 deg on one flank and is as late on the other."""
    of_drive = np.arange(as_built.size) < as_built.size / len(as_built.flanks)

    def change(scenes: object, claim: Claim, values: tuple[float, ...]) -> list[FloatArray]:
        out = []
        for flank, mine, lead in (("drive", of_drive, -ALPHA), ("coast", ~of_drive, ALPHA)):
            one = np.zeros(as_built.size)
            if flank in as_built.flanks:
                one[as_built.start(flank, claim.place.gear or 0) :][: Z[claim.place.gear or 0]] = wave(claim, lead)
            out.append(one[mine])
        return out

    model = SimpleNamespace(as_built=as_built, claims=[], change=change, **more)
    parts = [of_drive, ~of_drive]
    split = replace(
        system, white=[system.white[0].rows(part) for part in parts], target=[system.target[0][part] for part in parts]
    )
    scenes = [SimpleNamespace(samples=SimpleNamespace(flank=flank)) for flank in ("drive", "coast")]
    noise = SimpleNamespace(whitened=lambda values: values / NOISE)
    return model, scenes, SimpleNamespace(system=split, noises=[noise, noise])


def wave(claim: Claim, lead: float) -> FloatArray:
    """What an eccentricity adds (z,) in um to the teeth of its gear on a flank that stands ``lead`` rad ahead."""
    z = Z[claim.place.gear or 0]
    turn = 2.0 * np.pi / z * np.arange(z) + lead
    return np.asarray(np.sign(lead) * (claim.values[0] * np.cos(turn) + claim.values[1] * np.sin(turn)))


@pytest.mark.long
def test_an_eccentricity_does_not_part_the_flanks() -> None:
    """Six um of it contradict whole teeth by four um; it is open, so that teeth are found to err as a whole."""
    start, whole = teeth(), drawn(teeth(shared=(0.999, 0.999)), 2)
    claim = Claim(physics=ECCENTRICITY, place=Place(gear=0), values=(6.0, 0.0))
    for flank, lead in (("drive", -ALPHA), ("coast", ALPHA)):
        whole[start.start(flank, 0) :][: Z[0]] += wave(claim, lead)
    gears = told(*asked(start, read(whole, start))).gears
    assert min(gear.shared[0] for gear in gears) >= 0.99


def test_surprise_is_the_evidence_of_the_recordings() -> None:
    """Differences between priors are those of the normal density of the readings, their parameters integrated out."""
    one, other = teeth(shared=(0.5, 0.5)), teeth(shared=(0.95, 0.8))
    system = read(drawn(other, 1), one)

    def density(prior: AsBuilt) -> float:
        covariance = np.linalg.inv(prior.precision) / NOISE**2 + np.eye(prior.size)
        return float(-2.0 * multivariate_normal(cov=covariance).logpdf(system.target[0]))

    # Determinants of 170 parameters, in double precision.
    assert surprise(one, system) - surprise(other, system) == pytest.approx(density(one) - density(other), rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("true", [(0.95, 0.5), (0.999, 0.95), (0.5, 0.99)])
def test_recordings_of_both_flanks_tell_what_these_share(true: tuple[float, float], seed: int) -> None:
    """From the half that nothing is known of to at most one step from the truth, pitch and form each by itself: 18
    teeth tell the variance that is left to a third."""
    start = teeth()
    found = told(*asked(start, read(drawn(teeth(shared=true), seed), start)))
    for gear in found.gears:
        for value, truth in zip(gear.shared, true, strict=True):
            assert abs(SHARED.index(value) - SHARED.index(truth)) <= 1


def test_inspected_gears_and_single_flanks_are_left_as_they_are() -> None:
    known = teeth(known=True)
    assert told(*asked(known, read(drawn(teeth(shared=(0.99, 0.99)), 1), known))) is known
    single = make_as_built((graded(Z[0]), graded(Z[1])), ["drive"])
    assert told(*asked(single, read(np.zeros(single.size), single))) is single


def test_one_tooth_that_errs_on_one_flank_alone_keeps_flanks_apart() -> None:
    """What the prior cannot make is not forced on it: sharing less is likelier than a tooth ten deviations off."""
    start, whole = teeth(), drawn(teeth(shared=(0.999, 0.999)), 2)
    whole[start.start("coast", 0) + 3] += 20.0
    gears = told(*asked(start, read(whole, start))).gears
    assert gears[0].shared[0] < 0.999 <= gears[1].shared[0]


@pytest.mark.parametrize(("read_shaft", "ways"), [("driven", 3), ("driving", 4)])
def test_turns_between_flanks_are_counted_by_the_teeth_of_the_mate(read_shaft: str, ways: int) -> None:
    """After a turn of the shaft that was read the mate has gone on by as many teeth as that shaft's gear has."""
    truth, start = teeth(shared=(0.99, 0.95)), teeth()
    mate = 0 if read_shaft == "driven" else 1
    for turns in range(ways):
        true = drawn(truth, 3)
        first = start.start("coast", mate)
        for at in (first, first + Z[mate]):
            # Tooth n passes where n - turns z is taken to pass.
            true[at : at + Z[mate]] = np.roll(true[at : at + Z[mate]], -turns * Z[1 - mate])
        model, scenes, linear = asked(start, read(true, start), turns_of=read_shaft)
        assert turns_told(model, scenes, linear) == turns


def test_turns_are_left_where_flanks_have_nothing_in_common() -> None:
    start = teeth()
    for seed in range(6):
        apart = drawn(teeth(shared=(0.0, 0.0)), seed)
        assert turns_told(*asked(start, read(apart, start), turns_of="driven")) == 0


@pytest.mark.long
@pytest.mark.parametrize(("read_shaft", "stays", "goes"), [("driven", 1, 0), ("driving", 0, 1)])
def test_counted_turns_leave_what_was_read(
    read_shaft: Literal["driving", "driven"], stays: int, goes: int, tmp_path: Path
) -> None:
    """After whole turns the shaft that was read shows the same angle, the mate another tooth; the drive flank stays,
    and the comparison follows."""
    file, path = rough(), tmp_path / "pair.toml"
    conditions = (Condition(torque_nm=0.0), Condition(torque_nm=0.0, flank="coast"))
    comparison = compare(file, recorded(file, conditions, np.random.default_rng(1), per_mesh=8), path=path)
    model = replace(prepare(file, comparison, path=path), turns_of=read_shaft)
    drive, coast = (one.samples for one in model.observed)
    model = model.turned(1)
    still, moved = (one.samples for one in model.observed)
    np.testing.assert_array_equal(still.theta_2, drive.theta_2)
    turn, z = 2.0 * np.pi, (12, 16)
    for gear, before, after in ((0, coast.reading_1, moved.reading_1), (1, coast.reading_2, moved.reading_2)):
        by = after - before
        # To the rounding of some hundred rad.
        np.testing.assert_allclose(np.abs(by), turn * (1.0 if gear == stays else z[stays] / z[goes]), atol=1e-9)
    there = comparison.turned(model.turned_by)
    np.testing.assert_array_equal(there.aligned[0].theta_2, comparison.aligned[0].theta_2)
    np.testing.assert_allclose(there.aligned[1].theta_1 - comparison.aligned[1].theta_1, moved.theta_1 - coast.theta_1)
    np.testing.assert_allclose(comparison.alignment.shift - there.alignment.shift, [0.0, model.turned_by])


@pytest.mark.parametrize(
    ("read", "turns_of"),
    [
        ([{"driven"}, {"driven"}], "driven"),
        ([{"driving"}, {"driving"}], "driving"),
        ([{"driven"}, {"driving"}], None),
        ([{"driven"}, {"driving", "driven"}], None),
    ],
)
def test_turns_are_open_where_one_shaft_alone_was_read(read: list[set[str]], turns_of: str | None) -> None:
    angle, te = np.linspace(0.0, 9.0, 20), np.zeros(20)
    recordings = [
        Recording(source=Path("rig"), te_rad=te, **{f"{shaft}_angle_rad": angle for shaft in sorted(shafts)})
        for shafts in read
    ]
    assert only_shaft_read(recordings) == turns_of


def inspected_teeth(own: float) -> AsBuilt:
    """Two gears read to 0.3 um on their drive flanks, whose coast flanks follow but for ``own`` of that variance."""
    one, two = (
        GearPrior(
            z=z, pitch=0.09 * np.eye(z), slope=0.3, mean_slope=0.0, crowning=1e-3, thickness=0.3, shared=(1.0, 1.0),
            own=(own, own), graded=False,
        )
        for z in Z
    )  # fmt: skip
    return make_as_built((one, two), ["drive", "coast"])


@pytest.mark.parametrize(("own", "seed"), [(0.05, 1), (0.05, 2), (4.0, 3), (25.0, 4)])
def test_coast_flanks_scatter_as_they_do(own: float, seed: int) -> None:
    """Half of 18 and of 24 teeth, every five of which share neighbours, tell a variance of pitch or of form to a factor
    of 1.8, one sigma; of 96 such (24 seeds) all but three within 4, their medians within a seventh of the truth."""
    true = drawn(inspected_teeth(own), seed)
    found = scattered(inspected_teeth(0.05), read(true, inspected_teeth(0.05)))
    for gear in found.gears:
        if own == 0.05:
            assert gear.own == (0.05, 0.05)
        else:
            assert all(own / 4.0 < one < 4.0 * own for one in gear.own)


@pytest.mark.parametrize("what", ["tooth", "wave", "slope"])
def test_what_is_to_be_found_is_no_scatter(what: str) -> None:
    """One tooth out of its place, a pitch wave and a slope of all teeth stay for the search: the prior stays."""
    known = inspected_teeth(0.05)
    true = drawn(known, 1)
    start = known.start("coast", 0)
    if what == "tooth":
        true[start + 4] += 8.0
    elif what == "wave":
        true[start : start + Z[0]] += 6.0 * np.cos(2.0 * np.pi * np.arange(Z[0]) / Z[0])
    else:
        true[start + Z[0] : start + 2 * Z[0]] += 5.0
    assert scattered(known, read(true, known)).gears[0].own == (0.05, 0.05)


def test_coast_flanks_that_lean_each_their_own_way_keep_their_place() -> None:
    """Slopes that scatter by 3 um say nothing of how far all teeth stand off: else another thickness is no news."""
    known = inspected_teeth(0.05)
    true = drawn(known, 1)
    start = known.start("coast", 0)
    true[start : start + Z[0]] -= 4.0
    true[start + Z[0] : start + 2 * Z[0]] += np.random.default_rng(4).normal(0.0, 3.0, Z[0])
    pitch, form = scattered(known, read(true, known)).gears[0].own
    # What half of 18 teeth look like where they follow: up to four times a reading's variance.
    assert pitch < 4.0
    # 3 um over 0.3 um, squared, to a factor of 3 as above.
    assert 100.0 / 3.0 < form < 300.0


def test_teeth_that_meet_every_turn_leave_no_turn_to_count() -> None:
    """20 teeth on 40: after a turn of the driven shaft every pair is the same again, so there is one place only."""
    one, two = graded(20), graded(40)
    start = make_as_built((one, two), ["drive", "coast"])
    assert turns_told(*asked(start, read(drawn(start, 1), start), turns_of="driven")) == 0
