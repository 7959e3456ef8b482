"""The scorer on verdicts whose worth is known."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from gearpoly.errors import InputFileError
from gearpoly.prove.controls import shuffled
from gearpoly.prove.profile import by_size
from gearpoly.prove.row import Row
from gearpoly.prove.rows import rows
from gearpoly.prove.score import CaseScore, score
from gearpoly.prove.statistics import Share, Z
from gearpoly.prove.thresholds import read_thresholds
from gearpoly.prove.truth import Truth, read_truth
from tests.made_prove import PAIR, claim, verdict

LIMITS = read_thresholds()


def truth(tmp_path: Path, *items: dict[str, Any], kind: str = "missing", **more: Any) -> Truth:
    pair, path = tmp_path / "pair.toml", tmp_path / "x.truth.json"
    pair.write_text(PAIR)
    path.write_text(json.dumps({"kind": kind, "truth": list(items), "noise_um": 1.0, **more}))
    return read_truth(path, pair=pair)


def row(scores: list[CaseScore], key: str) -> Row:
    return next(one for one in rows(scores, LIMITS) if one.key == key)


CRACK = {
    "physics": "tooth_crack", "gear": 2, "tooth": 6, "teeth": 25, "encoder_deg": 350.0, "compliance_factor": 1.4,
    "over_limit": 10.0,
}  # fmt: skip


def test_the_encoder_decides_which_tooth(tmp_path: Path) -> None:
    told = truth(tmp_path, CRACK)
    found = score("a", verdict(claim("tooth_crack", "driven", tooth=None, encoder_deg=356.0)), told, LIMITS)
    assert found.items[0].placed
    assert found.items[0].first
    # One tooth is 14.4 deg: beyond half of it the next one is nearer, and a right number does not help.
    wrong = score("b", verdict(claim("tooth_crack", "driven", tooth=6, encoder_deg=357.3)), told, LIMITS)
    assert wrong.items[0].named
    assert not wrong.items[0].placed
    assert wrong.extras == 1
    assert row([found, wrong], "right_tooth").share == Share(hits=1, of=2)
    assert row([found, wrong], "right_tooth").cases == ("b",)
    assert row([found, wrong], "named_first").cases == ("b",)


def test_readings_wrap_at_a_turn(tmp_path: Path) -> None:
    told = truth(tmp_path, {**CRACK, "encoder_deg": 359.0})
    assert score("a", verdict(claim("tooth_crack", "driven", encoder_deg=2.0)), told, LIMITS).items[0].placed


def test_the_wrong_gear_is_not_the_truth(tmp_path: Path) -> None:
    told = truth(tmp_path, {"physics": "wear", "gear": 1, "depth_um": 2.0, "over_limit": 9.0})
    found = score("a", verdict(claim("wear", "driven", depth_um=(2.0, 0.1))), told, LIMITS)
    assert not found.items[0].named
    assert found.extras == 1


def test_an_order_is_part_of_the_name(tmp_path: Path) -> None:
    told = truth(tmp_path, {"physics": "undulation", "gear": 1, "order": 61, "amplitude_um": 0.5})
    right = claim("undulation", "driving", order=(61, 0.0), amplitude_um=(0.5, 0.01))
    wrong = claim("undulation", "driving", order=(60, 0.0), amplitude_um=(0.5, 0.01))
    assert score("a", verdict(right), told, LIMITS).items[0].placed
    assert not score("a", verdict(wrong), told, LIMITS).items[0].named
    # Even samples show 60 and 61 alike where they are aliases, and who tells the lowest of them is right.
    even = truth(tmp_path, {"physics": "undulation", "gear": 1, "order": 61, "amplitude_um": 0.5, "aliases": [60.0]})
    assert score("a", verdict(wrong), even, LIMITS).items[0].placed


def test_rivals_named_and_look_alikes_named_singly(tmp_path: Path) -> None:
    item = {
        "physics": "encoder_eccentricity", "gear": 1, "amplitude_urad": 40.0, "over_limit": 18.0,
        "rivals": [{"physics": "eccentricity", "gear": 1, "separability": 0.05}],
    }  # fmt: skip
    told = truth(tmp_path, item)
    mine = claim("encoder_eccentricity", "driving", amplitude_urad=(41.0, 1.0))
    rival = claim("eccentricity", "driving", amplitude_um=(0.7, 0.1))
    both = claim("eccentricity", "driving", rivals=[mine])
    alone = score("a", verdict(mine), told, LIMITS)
    other = score("b", verdict(rival), told, LIMITS)
    ranged = score("c", verdict(both), told, LIMITS)
    assert [one.items[0].singly for one in (alone, other, ranged)] == [True, True, False]
    assert [one.items[0].in_set for one in (alone, other, ranged)] == [True, False, True]
    assert [one.items[0].set_size for one in (alone, other, ranged)] == [1, 1, 2]
    assert ranged.items[0].alike_named
    assert ranged.extras == other.extras == 0
    found = row([alone, other, ranged], "look_alikes_named_singly")
    assert found.cases == ("a", "b")
    assert found.reached is False
    # Naming a look-alike is no failure to name first: size times separability is only 0.9.
    assert row([other], "named_first").share == Share(hits=0, of=0)
    assert row([other], "named_first").reached is None


def eccentric(tmp_path: Path, over: float, *rivals: dict[str, Any]) -> Truth:
    item = {"physics": "encoder_eccentricity", "gear": 1, "amplitude_urad": 40.0, "over_limit": over}
    return truth(tmp_path, {**item, "rivals": list(rivals)})


@pytest.mark.parametrize(
    ("separability", "first", "false", "singly"),
    [
        (0.04, None, False, True),  # 0.8 standard deviations: to name either alone is more than the recordings say
        (0.10, None, False, False),  # 2.0: either may be named, and one may well be excluded by chance
        (0.20, None, True, False),  # 4.0: the rival is excluded, but by no more than chance can undo
        (0.26, False, True, False),  # 5.2: the effect has to be named, and first
    ],
)
def test_the_nearest_rival_decides_what_has_to_be_named(
    tmp_path: Path, separability: float, first: bool | None, false: bool, singly: bool
) -> None:
    far = {"physics": "cumulative_pitch", "gear": 1, "separability": 0.9}
    told = eccentric(tmp_path, 20.0, {"physics": "eccentricity", "gear": 1, "separability": separability}, far)
    other = score("a", verdict(claim("eccentricity", "driving", amplitude_um=(0.7, 0.1))), told, LIMITS)
    assert row([other], "named_first").reached is first
    assert (other.extras == 1) is false
    assert other.items[0].singly is singly
    right = score("b", verdict(claim("encoder_eccentricity", "driving", amplitude_urad=(41.0, 1.0))), told, LIMITS)
    assert row([right], "named_first").reached is (None if first is None else True)


def test_two_signals_closer_than_models_agree_are_not_told_apart(tmp_path: Path) -> None:
    """However long the recording, and however far apart in standard deviations."""
    near = {"physics": "eccentricity", "gear": 1, "separability": 0.3, "apart_um": 0.009}
    other = claim("eccentricity", "driving", amplitude_um=(0.7, 0.1))
    close = score("a", verdict(other), eccentric(tmp_path, 20.0, near), LIMITS)
    apart = score("b", verdict(other), eccentric(tmp_path, 20.0, {**near, "apart_um": 0.011}), LIMITS)
    assert row([close], "named_first").reached is None
    assert close.extras == 0
    assert not close.items[0].singly  # nobody has to report it either
    assert row([apart], "named_first").reached is False
    assert apart.extras == 1


def test_without_a_size_an_effect_is_large(tmp_path: Path) -> None:
    item = {"physics": "eccentricity", "gear": 1, "amplitude_um": 4.0}
    same = {"physics": "encoder_eccentricity", "gear": 1, "separability": 0.0}
    said = verdict(claim("encoder_eccentricity", "driving", amplitude_urad=(200.0, 1.0)))
    unlike = score("a", said, truth(tmp_path, {**item, "rivals": [{**same, "separability": 0.01}]}), LIMITS)
    alike = score("b", said, truth(tmp_path, {**item, "rivals": [same]}), LIMITS)
    assert row([unlike], "named_first").reached is False
    assert unlike.extras == 1
    assert row([alike], "named_first").reached is None
    assert alike.items[0].singly


def test_false_alarms_named_or_only_located(tmp_path: Path) -> None:
    told = truth(tmp_path, kind="none")
    named = score("a", verdict(claim("friction", coefficient=(0.01, 0.001))), told, LIMITS)
    located = score("b", verdict(unexplained=[{"kind": "mesh_order", "order": 1}]), told, LIMITS)
    quiet = [score(f"c{k}", verdict(), told, LIMITS) for k in range(38)]
    assert row([named, located, *quiet], "false_alarms").cases == ("a", "b")
    assert row([named, located, *quiet], "false_alarms").reached is True  # 2 of 40 are just the 5 % allowed
    assert row([named, located, *quiet[:37]], "false_alarms").reached is False
    assert row([named, located, *quiet], "false_names").cases == ("a",)


def test_a_stranger_is_located_on_either_shaft_and_must_get_no_name(tmp_path: Path) -> None:
    told = truth(tmp_path, {"order": 3.6, "gear": 1, "amplitude_um": 0.6}, kind="unknown")
    mine = {"kind": "shaft_order", "gear": "driving", "order": 3.59}
    mate = {"kind": "shaft_order", "gear": "driven", "order": 5.0}  # 3.6 x 25/18
    whole = {"kind": "shaft_order", "gear": "driving", "order": 4}
    assert score("a", verdict(unexplained=[mine]), told, LIMITS).located
    assert score("b", verdict(unexplained=[mate]), told, LIMITS).located
    assert not score("c", verdict(unexplained=[whole]), told, LIMITS).located
    named = score("d", verdict(claim("undulation", "driving", order=(4, 0.0)), unexplained=[mine]), told, LIMITS)
    assert named.located
    assert row([named], "strangers_named").cases == ("d",)


HUM = {"shape": "hum", "hz": 50.0, "images_hz": [28.0], "amplitude_um": 0.4, "over_limit": 20.0}
BEARING = {"shape": "line", "order": 3.6, "gear": 1, "amplitude_um": 0.1, "over_limit": 12.0}


def test_a_background_is_located_wave_by_wave_beside_what_has_a_name(tmp_path: Path) -> None:
    told = truth(tmp_path, CRACK, background=[HUM, BEARING])
    crack = claim("tooth_crack", "driven", encoder_deg=350.0)
    hum = {"kind": "time", "hz": 50.01}
    line = {"kind": "shaft_order", "gear": "driven", "order": 5.0}  # 3.6 x 25/18
    both = score("a", verdict(crack, unexplained=[hum, line]), told, LIMITS)
    one = score("b", verdict(crack, unexplained=[hum]), told, LIMITS)
    assert [found for _, found in both.background] == [True, True]
    assert row([both, one], "background_located").share == Share(hits=3, of=4)
    assert row([both, one], "background_located").cases == ("b",)
    # The physics counts in the rows of names as if it stood alone, and no stranger's row counts the background.
    assert row([both], "named_first").reached is True
    assert both.extras == 0
    assert row([both], "strangers_located").share == Share(hits=0, of=0)
    # Half the mean rate of sampling is 39 Hz: 78 - 50 Hz is what even samples show.
    assert score("c", verdict(unexplained=[{"kind": "time", "hz": 28.02}]), told, LIMITS).background[0][1]
    assert not score("d", verdict(unexplained=[{"kind": "time", "hz": 39.0}]), told, LIMITS).background[0][1]


def test_to_locate_the_background_alone_is_not_to_detect_what_it_lies_beside(tmp_path: Path) -> None:
    told = truth(tmp_path, CRACK, background=[HUM], depth={"over_limit": 10.0})
    hum = {"kind": "time", "hz": 50.0}
    only = score("a", verdict(unexplained=[hum]), told, LIMITS)
    more = score("b", verdict(unexplained=[hum, {"kind": "tooth", "gear": "driven", "tooth": 6}]), told, LIMITS)
    assert row([only, more], "detected").cases == ("a",)


def test_a_name_for_the_background_is_false_and_a_faint_one_may_stay_silent(tmp_path: Path) -> None:
    crack = claim("tooth_crack", "driven", encoder_deg=350.0)
    wave = claim("undulation", "driving", order=(4, 0.0), amplitude_um=(0.1, 0.01))
    loud, faint = truth(tmp_path, CRACK, background=[BEARING]), {**BEARING, "over_limit": 2.0}
    named = score("a", verdict(crack, wave), loud, LIMITS)
    silent = score("b", verdict(crack), truth(tmp_path, CRACK, background=[faint]), LIMITS)
    assert row([named, silent], "background_named").cases == ("a",)
    assert row([silent], "background_located").share == Share(hits=0, of=0)
    assert row([named], "background_located").cases == ("a",)


def test_a_healthy_pair_beside_a_faint_background_raises_no_alarm_by_locating_it(tmp_path: Path) -> None:
    told = truth(tmp_path, kind="none", background=[{**HUM, "over_limit": 0.8}])
    hum, other = {"kind": "time", "hz": 50.3}, {"kind": "time", "hz": 62.0}
    found = [
        score("a", verdict(unexplained=[hum]), told, LIMITS),
        score("b", verdict(unexplained=[hum, other]), told, LIMITS),
        score("c", verdict(claim("friction", coefficient=(0.01, 0.001)), unexplained=[hum]), told, LIMITS),
    ]
    assert row(found, "false_alarms").cases == ("b", "c")
    assert row(found, "false_alarms_background").share == Share(hits=2, of=3)
    assert row(found, "false_names").cases == ("c",)


def test_a_shape_among_what_is_missing_lies_beside_it(tmp_path: Path) -> None:
    """So a list of both, as anyone may write it, is read like a background of its own."""
    told = truth(tmp_path, CRACK, HUM)
    assert [item.physics for item in told.items] == ["tooth_crack"]
    assert [item.hz for item in told.background] == [50.0]
    with pytest.raises(InputFileError, match="truth: no physics; want one, or kind none or unknown"):
        truth(tmp_path, HUM)


@pytest.mark.parametrize("item", [CRACK, {"shape": "jump", "amplitude_um": 1.0}])
def test_a_background_is_of_waves(tmp_path: Path, item: dict[str, Any]) -> None:
    """A name has its place in the truth; anything would locate a jump, so no alarm beside it would count."""
    with pytest.raises(InputFileError, match=r"background: .* want waves of no physics: order and gear, or hz"):
        truth(tmp_path, CRACK, background=[item])


def test_hum_jumps_and_pulses(tmp_path: Path) -> None:
    hum = truth(tmp_path, {"shape": "hum", "hz": 50.0, "amplitude_um": 1.0}, kind="unknown")
    assert score("a", verdict(unexplained=[{"kind": "time", "hz": 50.02}]), hum, LIMITS).located
    assert not score("a", verdict(unexplained=[{"kind": "time", "hz": 60.0}]), hum, LIMITS).located
    jump = truth(tmp_path, {"shape": "jump", "at": 0.4, "amplitude_um": 1.0}, kind="unknown")
    assert score("a", verdict(unexplained=[{"kind": "step", "time_s": 3.0}]), jump, LIMITS).located
    assert not score("a", verdict(), jump, LIMITS).located
    pulse = truth(tmp_path, {"shape": "pulse", "order": 0.31, "gear": 2, "amplitude_um": 1.0}, kind="unknown")
    third = {"kind": "shaft_order", "gear": "driven", "order": 0.93}
    assert score("a", verdict(unexplained=[third]), pulse, LIMITS).located


def test_errors_of_sizes_and_angles(tmp_path: Path) -> None:
    item = {"physics": "eccentricity", "gear": 1, "amplitude_um": 5.0, "angle_deg": 359.0, "over_limit": 30.0}
    said = claim("eccentricity", "driving", amplitude_um=(5.2, 0.15), angle_deg=(1.0, 1.5))
    size, angle = score("a", verdict(said), truth(tmp_path, item), LIMITS).items[0].parameters
    assert size.off == pytest.approx(0.2)
    assert size.relative == pytest.approx(0.04)
    assert size.main
    assert (size.within(1.0), size.within(2.0)) == (False, True)
    assert angle.off == pytest.approx(2.0)
    assert not angle.main


def test_a_crack_counts_from_one(tmp_path: Path) -> None:
    said = claim("tooth_crack", "driven", encoder_deg=350.0, compliance_factor=(1.44, 0.01))
    (size,) = score("a", verdict(said), truth(tmp_path, CRACK), LIMITS).items[0].parameters
    assert size.relative == pytest.approx(0.1)  # 0.04 of 0.4, not of 1.4


def test_a_failed_diagnosis_counts_as_silent(tmp_path: Path) -> None:
    told = truth(tmp_path, CRACK, depth={"over_limit": 10.0})
    found = score("a", None, told, LIMITS, error="ValueError: no")
    assert row([found], "detected").cases == ("a",)
    assert row([found], "errors").reached is False


def test_only_effects_above_the_limit_have_to_be_detected(tmp_path: Path) -> None:
    weak = score("a", verdict(), truth(tmp_path, CRACK, depth={"over_limit": 6.9}), LIMITS)
    strong = score("b", verdict(), truth(tmp_path, CRACK, depth={"over_limit": 7.0}), LIMITS)
    assert row([weak, strong], "detected").share == Share(hits=0, of=1)


def test_both_of_two(tmp_path: Path) -> None:
    other = {"physics": "friction", "coefficient": 0.05, "over_limit": 9.0}
    told = truth(tmp_path, CRACK, other)
    crack = claim("tooth_crack", "driven", encoder_deg=350.0)
    one = score("a", verdict(crack), told, LIMITS)
    two = score("b", verdict(claim("friction"), crack), told, LIMITS)
    assert row([one, two], "both_named").cases == ("a",)
    assert two.extras == 0


def test_energy_removed_is_over_the_true_noise(tmp_path: Path) -> None:
    told = truth(tmp_path, CRACK, depth={"over_limit": 10.0})  # noise 1 um
    half = score("a", verdict(before=math.sqrt(3.0), after=math.sqrt(2.0)), told, LIMITS)
    assert half.removed == pytest.approx(0.5)
    assert row([half], "energy_removed").value == pytest.approx(0.5)
    # Where hardly anything repeats there is nothing to remove.
    assert row([score("b", verdict(before=1.01, after=1.0), told, LIMITS)], "energy_removed").value is None


def test_coverage_must_be_neither_too_low_nor_too_high(tmp_path: Path) -> None:
    told = truth(tmp_path, {**CRACK, "over_limit": 30.0})

    def of(off: float) -> CaseScore:
        said = claim("tooth_crack", "driven", encoder_deg=350.0, compliance_factor=(1.4 + off, 0.1))
        return score("a", verdict(said), told, LIMITS)

    inside, outside = of(0.15), of(0.25)
    assert row([inside] * 19 + [outside], "coverage_2").reached is True
    assert row([inside] * 20, "coverage_2").reached is True  # 20 of 20 may be chance
    assert row([inside] * 300, "coverage_2").reached is False  # errors stated too large
    assert row([inside] * 8 + [outside] * 2, "coverage_2").reached is False


def test_wilson_at_the_ends_and_in_the_middle() -> None:
    """Of n cases and no hit the interval ends at z^2 / (n + z^2); it is symmetric under hits and misses."""
    none = Share(hits=0, of=20)
    assert none.low == 0.0
    assert none.high == pytest.approx(Z**2 / (20 + Z**2))
    most = Share(hits=17, of=20)
    few = Share(hits=3, of=20)
    assert most.low == pytest.approx(1.0 - few.high)
    assert few.low < few.rate < few.high
    assert Share(hits=7, of=7).high == 1.0
    assert math.isnan(Share(hits=0, of=0).rate)


def test_the_smallest_is_the_size_from_which_on_all_are_named(tmp_path: Path) -> None:
    def pitch(size: float, said: bool, klass: str = "smallest") -> CaseScore:
        item = {**CRACK, "physics": "tooth_pitch", "deviation_um": -size}
        named = claim("tooth_pitch", "driven", encoder_deg=350.0, deviation_um=(-size, 0.1))
        told = truth(tmp_path, item, **{"class": klass})
        return score(f"{size}", verdict(named) if said else verdict(), told, LIMITS)

    lucky = [pitch(0.2, True), pitch(0.3, False), pitch(0.4, True), pitch(0.8, True), pitch(5.0, False, "single")]
    found = row(lucky, "smallest_tooth_pitch_um")
    assert found.value == pytest.approx(0.4)
    assert found.reached is True
    assert found.cases == ("0.3",)
    assert "3 of 4" in found.note
    assert row([pitch(0.3, True), pitch(0.8, False)], "smallest_tooth_pitch_um").reached is False
    assert row([], "smallest_tooth_pitch_um").reached is None


def test_shuffled_labels_are_right_by_chance(tmp_path: Path) -> None:
    said = claim("tooth_crack", "driven", encoder_deg=350.0)
    scores = [score(f"{k}", verdict(said), truth(tmp_path, CRACK), LIMITS) for k in range(40)]
    found = shuffled(scores, {one.name: [said] for one in scores}, LIMITS)
    assert found["expected"] == pytest.approx(1 / 25)
    low, high = found["right_tooth"]["interval_95"]
    assert low < 1 / 25 < high  # 2000 seeded guesses


def test_sizes_fall_into_their_bins(tmp_path: Path) -> None:
    scores = [score("a", verdict(), truth(tmp_path, {**CRACK, "over_limit": n}), LIMITS) for n in (0.5, 1.0, 30.0)]
    assert [one["cases"] for one in by_size(scores)] == [1, 1, 0, 0, 0, 0, 1]


def test_a_truth_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="want none, missing, unknown or wrong_file"):
        truth(tmp_path, kind="perhaps")
    (tmp_path / "x.truth.json").write_text("{")
    with pytest.raises(InputFileError, match="want a truth file"):
        read_truth(tmp_path / "x.truth.json", pair=tmp_path / "pair.toml")


def test_thresholds_are_read_by_the_scorer_only() -> None:
    root = Path(__file__).resolve().parents[1]
    readers = [p for p in (root / "gearpoly").rglob("*.py") if "thresholds.toml" in p.read_text()]
    assert {p.parent.name for p in readers} == {"prove"}
    assert not [p for p in (root / "gearpoly" / "proving").rglob("*.py") if "thresholds" in p.read_text()]


def test_a_truth_that_no_physics_has_is_refused(tmp_path: Path) -> None:
    """It would count as never named; what lies outside the catalogue is told by its shape."""
    with pytest.raises(InputFileError, match=r"truth\.physics: 'tooth_pich'; want one of centre_distance"):
        truth(tmp_path, {"physics": "tooth_pich", "gear": 1})
    assert truth(tmp_path, {"shape": "line", "order": 3.3}, kind="unknown").items[0].label == "line order 3.3"


@pytest.mark.parametrize("text", ["teeth = ", "[driving]\nteeth = 18\n[driven]\nmodule_mm = 2.0\n"])
def test_a_truth_of_no_pair_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "x.truth.json").write_text('{"kind": "none", "truth": [], "noise_um": 1.0}')
    (tmp_path / "pair.toml").write_text(text)
    with pytest.raises(InputFileError, match=r"pair\.toml.*want (a pair file|TOML)"):
        read_truth(tmp_path / "x.truth.json", pair=tmp_path / "pair.toml")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[]", "the whole is no object"),
        ("3", "the whole is no object"),
        ("[" * 5000, "no truth"),
        ('{"kind": 3, "truth": [], "noise_um": 1}', "kind is not a text"),
        ('{"kind": "none", "noise_um": 1}', "no truth"),
        ('{"kind": "none", "truth": {}, "noise_um": 1}', "truth is not a list"),
        ('{"kind": "none", "truth": [3], "noise_um": 1}', "truth[0]. is no object"),
        ('{"kind": "none", "truth": [], "noise_um": true}', "noise_um is not a number"),
        ('{"kind": "none", "truth": [], "noise_um": NaN}', "noise_um is not a number"),
        ('{"kind": "none", "truth": [], "noise_um": 1' + "0" * 400 + "}", "noise_um is not a number of ordinary size"),
        ('{"kind": "none", "truth": [], "noise_um": 1, "depth": []}', "depth. is no object"),
        ('{"kind": "none", "truth": [], "noise_um": 1, "declared_eccentricity_um": 3}', "is not a list"),
        ('{"kind": "unknown", "truth": [{"gear": "third"}], "noise_um": 1}', "truth[0].gear is not driving or driven"),
        ('{"kind": "unknown", "truth": [{"tooth": 0.5}], "noise_um": 1}', "truth[0].tooth is not a whole number"),
        ('{"kind": "unknown", "truth": [{"rivals": [{}]}], "noise_um": 1}', "no truth[0].rivals[0].physics"),
        ('{"kind": "unknown", "truth": [{"images_hz": ["a"]}], "noise_um": 1}', "truth[0].images_hz is not a number"),
    ],
)
def test_a_truth_of_another_shape_is_told_by_its_field(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "pair.toml").write_text("[driving]\nteeth = 18\n[driven]\nteeth = 25\n")
    (tmp_path / "x.truth.json").write_text(text)
    with pytest.raises(InputFileError, match=re.escape(says)):
        read_truth(tmp_path / "x.truth.json", pair=tmp_path / "pair.toml")
