"""The proving ground: its plan, its cases and files, and that seed and index alone decide every byte."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections import Counter
from dataclasses import replace
from math import cos, gcd, pi, radians
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.proving.case import limit_of, make, numbered
from gearpoly.proving.chain import Chain, RecordedCondition, motion, te
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.drawn import BENCH_PAIRS, make_pair
from gearpoly.proving.effects import CATALOGUE, Effect, apply, instance, truth
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.gears import MM_PER_UM
from gearpoly.proving.ground import (
    BENCH_CASES_BY_CLASS,
    BENCH_CONCEALED_BY,
    LOOK_ALIKES,
    MASKED,
    ONE_FLANK,
    PHYSICS_BESIDE_BACKGROUND,
    SINGLE,
    counts,
    plan,
)
from gearpoly.proving.limit import DetectionLimit, sights
from gearpoly.proving.recipes import recipe
from gearpoly.proving.rig import ideal
from gearpoly.proving.write import seal, write_case

PAIR = make_pair("18/25 m2")


def test_the_plan_has_the_mix_that_the_proof_needs() -> None:
    entries = plan(7)
    mix = [e for e in entries if e.klass != "false_alarm"]
    assert len(mix) >= 300
    healthy = [e for e in mix if not e.physics]
    assert 0.25 <= len(healthy) / len(mix) < 0.3  # a quarter, and the healthy ones among the short recordings
    alone = {e.physics[0] for e in entries if e.klass == "single"}
    assert alone == set(SINGLE) <= set(CATALOGUE)
    assert [e.index for e in entries] == list(range(len(entries)))
    assert [e.klass for e in plan(8)] != [e.klass for e in entries]


def test_every_way_to_conceal_is_there() -> None:
    cases = {klass: [e for e in plan(7) if e.klass == klass] for klass in BENCH_CASES_BY_CLASS}
    assert all(cases.values())
    assert set(BENCH_CASES_BY_CLASS) == set(BENCH_CONCEALED_BY)
    assert {e.physics[0] for e in cases["masked"]} == set(MASKED)
    assert {e.physics[0] for e in cases["look_alike"]} == set(LOOK_ALIKES)
    assert {e.physics[0] for e in cases["one_flank"]} == set(ONE_FLANK)
    assert {e.physics[0] for e in cases["beside"]} == set(PHYSICS_BESIDE_BACKGROUND)
    assert min(e.over for e in cases["beside"]) * 0.88 >= 7.0  # sizes are moved by up to 12 %
    assert {e.variant % 5 for e in cases["stranger"]} == set(range(5))  # every shape of a stranger
    assert len({e.klass for e in plan(7, quick=True)}) == len(BENCH_CASES_BY_CLASS) - 1
    assert 16 <= len(plan(7, quick=True)) <= 20


def test_two_hundred_healthy_pairs_run_beneath_60_um_in_coloured_noise() -> None:
    hard = 0
    for entry in plan(7):
        if entry.klass in ("healthy", "false_alarm"):
            made = recipe(entry, np.random.default_rng([7, entry.index]))
            off = [0.0 if one is None else one[0] for one in made.eccentric]
            hard += max(off) >= 25.0 and made.chain.colour >= 0.6  # 25 um on the smallest module
    assert hard >= 200


@pytest.mark.long
def test_pairs_of_every_kind_in_every_ground() -> None:
    seen = Counter(recipe(e, np.random.default_rng([9, e.index])).pair for e in plan(9))
    assert set(seen) == set(BENCH_PAIRS)
    assert min(seen.values()) >= 20
    pairs = [make_pair(name) for name in seen]
    common = [gcd(pair.driving.z, pair.driven.z) > 1 for pair in pairs]
    assert any(common) and not all(common)
    assert {min(p.driving.m for p in pairs), max(p.driving.m for p in pairs)} == {0.5, 6.0}
    assert len({p.driving.alpha_deg for p in pairs}) >= 2
    assert any(p.driving.x != 0 for p in pairs)


@pytest.mark.long
def test_recordings_are_no_longer_than_they_need_to_be() -> None:
    """The bench has 18 000 samples a recording, and the longest that is asked for has ten hunting cycles."""
    sizes = []
    for entry in plan(7):
        made = recipe(entry, np.random.default_rng([7, entry.index]))
        z = make_pair(made.pair).driving.z
        sizes.append([round(c.turns * z * c.per_mesh) for c in made.conditions])
    assert np.median([n for case in sizes for n in case]) < 18_000
    assert max(sum(case) for case in sizes) < 100_000
    assert np.mean([sum(case) for case in sizes]) < 30_000


def test_the_docs_show_the_counts() -> None:
    page = Path(__file__).resolve().parents[1] / "docs" / "explanation" / "prove.md"
    assert counts() in page.read_text(encoding="utf-8")


def test_each_physics_is_tried_small_and_large() -> None:
    sizes: dict[str, list[float]] = {}
    for entry in plan(1):
        if entry.klass == "single":
            sizes.setdefault(entry.physics[0], []).append(entry.over)
    assert all(len(set(values)) >= 4 for values in sizes.values())
    assert min(min(v) for v in sizes.values()) == 0.5
    assert max(max(v) for v in sizes.values()) == 30.0


@pytest.mark.parametrize("physics", CATALOGUE)
def test_every_physics_changes_the_recordings_that_can_show_it(physics: str) -> None:
    rng = np.random.default_rng(11)
    conditions = tuple(
        RecordedCondition(torque=t, turns=2.0, flank=f, speed=200.0)
        for t, f in ((20.0, "drive"), (80.0, "drive"), (2.0, "coast"))
    )
    effect = instance(physics, PAIR, conditions, rng)
    rig = ideal(PAIR, E_s=-50.0)
    rig = rig if physics == "tooth_deflection" else replace(rig, deflect=True)
    chain = Chain()
    paths = tuple(motion(rig, c, rng) for c in conditions)
    known = (np.eye(18), np.eye(25))
    look = sights(conditions, paths, chain)
    limit = DetectionLimit(rig, look, chain, index=known, slope=known, thickness=1.0, compliance=0.0, zero=1e-3)
    changed = apply(rig, effect)
    assert limit.rms_um(changed) > 0.02  # instances are meant to leave about a micrometre
    told = truth(changed, effect, chain, conditions)
    assert told["physics"] == physics
    if effect.gear:
        assert told["gear"] == effect.gear
    null = {"tooth_deflection", "mesh_resonance"}
    if physics not in null:
        assert limit.over(apply(rig, effect.scaled(0.0))) == pytest.approx(0.0, abs=1e-6)


def test_encoder_deg_is_the_reading_at_the_pitch_point() -> None:
    chain = Chain(zeros_deg=(10.0, 350.0), directions=(1, -1))
    pit = Effect(physics="tooth_pitch", gear=2, size=1.0, more={"tooth": 5})
    told = truth(ideal(PAIR), pit, chain, ())
    assert told["encoder_deg"] == pytest.approx(350.0 - 5 * 360 / 25)


@pytest.mark.parametrize("size", [-0.8, 0.8])
def test_a_drift_is_as_large_as_it_goes_far(size: float) -> None:
    """The contract's amplitude has no direction."""
    still, rng = ideal(PAIR), np.random.default_rng(1)
    drifting = apply(still, Effect(physics="thermal_drift", size=size))
    condition = RecordedCondition(torque=0.0, turns=5.0)
    path = motion(still, condition, rng)
    gone = te(drifting, condition, path, at=path.time) - te(still, condition, path, at=path.time)
    told = truth(drifting, Effect(physics="thermal_drift", size=size), Chain(), (condition,))
    assert told["amplitude_um"] == pytest.approx(np.ptp(gone) / MM_PER_UM, rel=1e-3)


def entry_of(klass: str, physics: tuple[str, ...], over: float = 8.0, variant: int = 1) -> CaseEntry:
    return CaseEntry(index=5, klass=klass, physics=physics, over=over, variant=variant, quick=True)


@pytest.mark.long
def test_a_case_has_the_size_over_the_limit_that_was_asked_for() -> None:
    case = make(3, entry_of("single", ("tooth_pitch",), 8.0))
    item = case.truth["truth"][0]
    assert item["over_limit"] == pytest.approx(8.0, rel=0.2)  # moved by up to 12 %, sized to 3 %
    assert case.truth["kind"] == "missing"


@pytest.mark.long
def test_look_alikes_name_their_rivals_the_nearest_first() -> None:
    case = make(3, entry_of("look_alike", ("encoder_eccentricity",), 25.0))
    item = case.truth["truth"][0]
    first, *others = item["rivals"]
    assert (first["physics"], first["gear"]) == ("eccentricity", item["gear"])
    # So weak that the rival is left within about one standard deviation, but no weaker than has to be detected.
    assert item["over_limit"] == pytest.approx(7.0, rel=0.05) or item["over_limit"] * first["separability"] < 1.3
    # What is excluded is told, too: the nearest that is decides how well the effect has to be named.
    assert all(one["separability"] >= first["separability"] for one in others)
    assert any(one["separability"] * item["over_limit"] > 3.0 for one in others) or item["over_limit"] < 25.0


@pytest.mark.slow
def test_sizes_of_several_are_counted_with_the_others_open() -> None:
    """Two reliefs and the deflection that they cancel: each alone is seen better than beside the others."""
    case = make(4, entry_of("cancelling", ("relief_cancels_deflection",), 0.0))
    bending, *reliefs = case.truth["truth"]
    assert bending["physics"] == "tooth_deflection"
    assert [one["gear"] for one in reliefs] == [1, 2]
    bare = case.rig
    for index in (1, 2):
        bare = bare.with_teeth(index, replace(bare.teeth(index), relief=0.0))
    limit = limit_of(bare, case.recipe, case.paths)
    for index, one in enumerate(reliefs, start=1):
        alone = limit.over(bare.with_teeth(index, case.rig.teeth(index)))
        assert one["amount_um"] == case.rig.teeth(index).relief
        assert 0.8 * alone < one["over_limit"] < 0.97 * alone  # the other relief could make a part of it
    depth = case.truth["depth"]
    light, half, full = depth["mesh_ripple_um"]
    assert full < 0.3 * depth["mesh_ripple_without_relief_um"][2]
    assert min(light, half) > 2 * full


def test_strangers_are_of_unknown_kind() -> None:
    case = make(3, entry_of("stranger", ("disturbance",), 10.0, variant=0))
    assert case.truth["kind"] == "unknown"
    assert "order" in case.truth["truth"][0]


@pytest.mark.long
def test_backgrounds_are_of_both_kinds_loud_and_faint() -> None:
    made = {e.index: (e, recipe(e, np.random.default_rng([7, e.index]))) for e in plan(7)}
    beside = [one for e, one in made.values() if e.klass == "beside"]
    kinds = Counter(tuple(wave.more["shape"].kind for wave in one.background) for one in beside)
    assert kinds == {("hum",): 8, ("line",): 8, ("hum", "line"): 8}
    sizes = [over for one in beside for over in one.background_over]
    # What need not be told from noise is below 3, what has to be located above 7: nothing lies between.
    assert not [over for over in sizes if 3.0 <= over < 7.0]
    assert 0.25 < np.mean([over < 3.0 for over in sizes]) < 0.45
    for kind in ("hum", "line"):
        of = [
            over for one in beside for wave, over in zip(one.background, one.background_over, strict=True)
            if wave.more["shape"].kind == kind
        ]  # fmt: skip
        assert min(of) < 3.0 and max(of) > 50.0
    for one in beside:  # hum needs times, and a mesh of which it is no harmonic
        if any(wave.more["shape"].kind == "hum" for wave in one.background):
            assert one.chain.timed
            harmonic = 50.0 / (one.conditions[0].speed / 60.0 * make_pair(one.pair).driving.z)
            assert abs(harmonic - round(harmonic)) > 0.05  # a driving order or more away
    healthy = [one for e, one in made.values() if e.klass == "healthy"]
    faint = [one.background_over for one in healthy if one.background]
    assert len(faint) == len(healthy) // 4
    assert all(0.3 <= over <= 1.0 for sizes in faint for over in sizes)
    others = [one for e, one in made.values() if e.klass not in ("healthy", "beside")]
    assert not any(one.background for one in others)


@pytest.mark.long
def test_the_case_beside_a_background_is_what_it_is_without_one() -> None:
    """The physics has its own size over the limit, the waves have theirs, and the recordings hold both and no more."""
    case = make(3, entry_of("beside", ("undulation",), 20.0, variant=2))
    (item,) = case.truth["truth"]
    hum, line = case.truth["background"]
    assert case.truth["kind"] == "missing"
    assert item["physics"] == "undulation"
    assert item["over_limit"] == pytest.approx(20.0, rel=0.2)  # moved by up to 12 %, sized to 3 %
    assert (hum["shape"], hum["hz"], line["shape"]) == ("hum", 50.0, "line")
    assert {"order", "gear"} <= set(line)
    for wave, over in zip((hum, line), case.recipe.background_over, strict=True):
        assert wave["over_limit"] == pytest.approx(over, rel=0.05)  # sized to 3 %, then beside the effect
    condition, path = case.conditions[0], case.paths[0]
    plain = te(replace(case.rig, extras=()), condition, path)
    rest = (te(case.rig, condition, path) - plain) / MM_PER_UM
    # Two waves at frequencies of their own: half the sum of the squared amplitudes, to a line's width.
    assert np.mean(rest**2) == pytest.approx(0.5 * (hum["amplitude_um"] ** 2 + line["amplitude_um"] ** 2), rel=0.05)


@pytest.mark.parametrize(("per_mesh", "images"), [(10, [28.0]), (14, []), (6, [3.2])])
def test_hum_faster_than_half_the_sampling_rate_has_an_image(per_mesh: int, images: list[float]) -> None:
    """At 26 rpm 18 teeth mesh 7.8 times a second: 78, 109.2 and 46.8 samples a second."""
    shape = Disturbance(kind="hum", amplitude=1.0, hz=50.0)
    conditions = (RecordedCondition(torque=0.0, speed=26.0, per_mesh=per_mesh),)
    told = truth(ideal(PAIR), Effect(physics="disturbance", more={"shape": shape}), Chain(), conditions)
    assert told["images_hz"] == pytest.approx(images)


def test_a_healthy_pair_may_have_a_background_fainter_than_its_limit() -> None:
    case = make(3, replace(entry_of("healthy", (), 0.0, variant=9), quick=True))
    assert case.truth["kind"] == "none"
    assert case.truth["truth"] == []
    for wave, over in zip(case.truth["background"], case.recipe.background_over, strict=True):
        assert 0.29 < wave["over_limit"] < 1.03  # sized to 3 %
        assert wave["over_limit"] == pytest.approx(over, rel=0.05)
    assert [one.kind for one in case.rig.extras] == [wave["shape"] for wave in case.truth["background"]]


@pytest.mark.long
def test_files_follow_the_contract(tmp_path: Path) -> None:
    quick = plan(2, quick=True)
    index = next(e.index for e in quick if e.klass == "healthy")
    digest = write_case(2, index, tmp_path / "open", truths=tmp_path / "sealed", quick=True)
    name = quick[index].name
    sealed = (tmp_path / "sealed" / f"{name}.truth.json").read_bytes()
    assert hashlib.sha256(sealed).hexdigest() == digest
    assert not list((tmp_path / "open").glob("*.json"))
    told = json.loads(sealed)
    assert {"kind", "truth", "concealed_by", "noise_um", "recordings"} <= set(told)
    assert told["kind"] == "none"
    stated = tomllib.loads((tmp_path / "open" / name / "pair.toml").read_text())
    pair = make_pair(told["pair"])
    assert stated["driving"]["teeth"] == pair.driving.z
    recordings = sorted((tmp_path / "open" / name).glob("rec_*.csv"))
    assert len(recordings) == told["recordings"]
    for path in recordings:
        lines = path.read_text().splitlines()
        head = [line for line in lines if line.startswith("#")]
        assert any(line.startswith("# torque_nm = ") for line in head)
        columns = lines[len(head)].split(",")
        assert set(columns) <= {"time_s", "driving_angle_deg", "driven_angle_deg", "te_um"}
        data = np.loadtxt(lines[len(head) + 1 :], delimiter=",")
        if "time_s" in columns:
            assert np.all(np.diff(data[:, columns.index("time_s")]) > 0)
        assert np.all(np.isfinite(data))


@pytest.mark.long
def test_composite_noise_is_what_the_truth_says() -> None:
    """Readings less the noiseless composite error have the stated rms, whatever encoder the noise fell on."""
    case = make(4, entry_of("single", ("encoder_interpolation",), 5.0))
    text = dict(case.files())["rec_0.csv"].splitlines()
    head = [line for line in text if line.startswith("#")]
    data = np.loadtxt(text[len(head) + 1 :], delimiter=",")
    chain, pair = case.chain, case.rig.pair
    theta = [chain.directions[k] * (np.radians(data[:, 1 + k]) - radians(chain.zeros_deg[k])) for k in range(2)]
    x = (pair.driven.r_b * theta[1] - pair.driving.r_b * theta[0]) * 1e3
    rest = x - te(case.rig, case.conditions[0], case.paths[0]) * 1e3
    # 10 000 samples of a possibly coloured noise; counts of the encoders add some nm.
    assert rest.std() == pytest.approx(chain.noise_um, rel=0.05)
    assert abs(rest.mean()) < 0.1 * chain.noise_um


@pytest.mark.long
def test_order_does_not_matter(tmp_path: Path) -> None:
    few = [e.index for e in plan(6, quick=True) if not e.physics][:2]
    one = {k: write_case(6, k, tmp_path / "one", quick=True) for k in few}
    other = {k: write_case(6, k, tmp_path / "other", quick=True) for k in few[::-1]}
    assert one == other
    assert seal({str(k): v for k, v in one.items()}) == seal({str(k): v for k, v in other.items()})
    for path in sorted((tmp_path / "one").rglob("*.*")):
        assert path.read_bytes() == (tmp_path / "other" / path.relative_to(tmp_path / "one")).read_bytes()


def test_index_deviation_is_normal_while_the_grade_is_an_arc() -> None:
    """A wave of index deviations of amplitude A, normal, spans 2 A / cos(alpha) of arc, which is what F_p limits."""
    wave = Effect(physics="cumulative_pitch", gear=1, size=2.0, more={"order": 1, "phase": 0.0})
    p = apply(ideal(PAIR), wave).teeth_1.p
    assert np.ptp(p) / cos(radians(20)) == pytest.approx(4.0 / cos(radians(20)), rel=1e-9)
    assert p == pytest.approx(2.0 * np.cos(2 * pi * np.arange(18) / 18))


@pytest.mark.parametrize(
    ("gear", "more", "told"),
    [(1, {}, False), (2, {}, True), (1, {"column": "angles"}, True), (1, {"known": True}, False),
     (1, {"inspected": True}, True), (1, {"eccentric": ((20.0, 30.0), None)}, True),
     (1, {"eccentric": (None, (20.0, 30.0))}, False)],
)  # fmt: skip
def test_a_tooth_has_no_number_where_nothing_gives_it_one(gear: int, more: dict[str, Any], told: bool) -> None:
    """The driving shaft of a rig that computes the transmission error is not read: its teeth are told apart by a sheet
    or an eccentricity, or not at all. Its stated zero holds up to whole turns, which no reading tells."""
    facts = {"column": "te_um", "known": False, "inspected": False, "eccentric": (None, None)} | more
    chain = Chain(column=facts["column"], known=facts["known"])
    made: Any = SimpleNamespace(chain=chain, inspected=facts["inspected"], eccentric=facts["eccentric"])
    assert numbered(made, gear) is told


def test_a_turn_of_the_driven_gear_moves_the_driving_teeth() -> None:
    """Why a zero alone gives no number to a shaft that is not read: no z_2 of the ground is a multiple of z_1."""
    assert all(z_2 % z_1 for z_1, z_2, *_ in BENCH_PAIRS.values())


@pytest.mark.long
def test_the_478_cases_of_the_bench_stay_as_they_are() -> None:
    """Plan, pair, chain, campaign and what is hidden of every case, as they were before the bench had other grounds."""
    told = []
    for e in plan(7):
        made = recipe(e, np.random.default_rng([7, e.index]))
        hidden = [
            (one.physics, one.gear, one.size, sorted((k, v) for k, v in one.more.items() if k != "shape"))
            for one in made.effects
        ]
        campaign = [(c.torque, c.speed, c.flank, c.turns, c.per_mesh) for c in made.conditions]
        chain = (made.chain.noise_um, made.chain.zeros_deg)
        told.append((e.index, e.klass, e.physics, e.over, e.variant, made.pair, made.grade, *chain, hidden, campaign))
    seen = hashlib.sha256(repr(told).encode()).hexdigest()
    assert seen == "4a89cb4b8c069fa4c4bdf7c60ab151537f8023626a2f93b7b17ade388255e703"
