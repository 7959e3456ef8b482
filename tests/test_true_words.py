"""Words say no more than the data: where teeth come from, which order a wave is, what changed, what drifts, bursts and
jumps."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from gearpoly.compare.bursts import burst_entries
from gearpoly.compare.compare import compare
from gearpoly.compare.describe import label_of
from gearpoly.compare.describe_jumps import _comes_round
from gearpoly.compare.entries import Entry
from gearpoly.compare.locate import locate
from gearpoly.compare.noise import estimate_noise
from gearpoly.compare.set_up import GearKnown
from gearpoly.diagnose.heldout import Rms
from gearpoly.diagnose.limits import Exceeded, Limit
from gearpoly.diagnose.verdict import BuiltGear, Status
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.deeds import Deed, note
from gearpoly.recording.recording import Recording
from gearpoly.report.compare_report import print_comparison
from gearpoly.report.diagnosis_report import grade_words, print_diagnosis, sentence, verdict_json
from gearpoly.units import DEG, UM
from tests.made_diagnosis import made_comparison, made_diagnosis
from tests.residuals import noise, residual, samples, tooth_signal

INSPECTED = (GearKnown(z=18, uncertainty=0.2 * UM), GearKnown(z=25, uncertainty=0.2 * UM))
GRADED = tuple(GearKnown(z=z, f_pT=8 * UM, F_pT=30 * UM, f_HalphaT=7 * UM) for z in (18, 25))


@pytest.mark.long
def test_gears_that_nobody_inspected_are_not_told_inspected(tmp_path: Path) -> None:
    path = tmp_path / "pair.toml"
    path.write_text(
        "[driving]\nteeth = 12\nmodule_mm = 2.0\ngrade = 6\nface_width_mm = 20.0\n"
        "[driven]\nteeth = 16\nmodule_mm = 2.0\n[driven.inspection]\npitch_um = 0.0\nuncertainty_um = 0.2\n",
        encoding="utf-8",
    )
    driving = np.cumsum(np.random.default_rng(1).uniform(1.0, 2.0, 1500)) * DEG
    te = 1e-6 * np.random.default_rng(2).normal(size=driving.size)
    recording = Recording(source=Path("a.csv"), driving_angle_rad=driving, driven_angle_rad=0.75 * driving + te)
    out = io.StringIO()
    print_comparison(Console(file=out, width=200), compare(read_pair(path), [recording], path=path))
    assert "12 teeth (limits only, not inspected) on 16 teeth (inspected)" in out.getvalue()


def built(grade: int | None, *, kept: int | None = None, estimated: bool = True) -> BuiltGear:
    return BuiltGear(
        flanks=(), thickness=None, grade_needed=grade, grade_edition=2013, grade_kept=kept, exceeded=(),
        estimated=estimated,
    )  # fmt: skip


def test_a_grade_is_told_of_what_it_was_judged_by_and_of_no_gear_whose_teeth_were_not_estimated() -> None:
    words = grade_words(built(1, kept=1))
    assert "fits ISO 1328-1 grade 1 (2013) by single pitch, cumulative pitch and profile slope" in words
    assert "profile form is not judged" in words
    assert "no ISO 1328-1 grade (2013)" in grade_words(built(None))
    assert "grade 1" not in grade_words(built(1, estimated=False))


def test_the_json_tells_no_grade_of_teeth_that_were_not_estimated() -> None:
    """Ideal gears of a guide log had grade 1, and kept it, while the terminal told none."""
    made = made_diagnosis(*made_comparison())
    first, _ = made.built
    assert first.grade_needed is not None
    told = verdict_json(replace(made, built=(replace(first, estimated=False), first)))["as_built"]
    assert told["driving"]["grade_needed"] is told["driving"]["grade_kept"] is None
    assert "declared without deviations" in told["driving"]["ungraded"]
    assert told["driven"]["grade_needed"] == first.grade_needed and "ungraded" not in told["driven"]


def test_a_grade_that_errors_leave_open_is_not_said_to_fit() -> None:
    """Of two gears whose steps need grades 3 to 5 it was said that they fit grade 1, which was not surely exceeded."""
    words = grade_words(built(1, kept=5))
    assert "fits" not in words
    assert "needs ISO 1328-1 grade 1 (2013) or a coarser one, and surely keeps grade 5" in words
    assert "keeps" not in grade_words(built(9))


@pytest.mark.parametrize(("count", "words"), [(1, "1 sample of a stop left out"), (2, "2 samples of a stop left out")])
def test_one_is_told_in_the_singular(count: int, words: str) -> None:
    done: list[Deed] = []
    note(done, "stops", count, "samples of a stop left out")
    assert done[0].says == words


def test_a_value_that_is_exact_is_told_without_an_error() -> None:
    """The exponent of a relief that was surely a line was told as "1.000000000 +- 0.000000000"."""
    made = made_diagnosis(*made_comparison())
    finding = replace(made.findings[0], parameters={"exponent": (1.0, 7.6e-133), "amount_um": (3.86, 0.2)})
    out = io.StringIO()
    print_diagnosis(Console(file=out, width=200), replace(made, findings=(finding,)))
    assert "   values: exponent 1, amount_um 3.86 +- 0.20\n" in out.getvalue()


@pytest.mark.parametrize("status", ["nothing_missing", "explained", "partly_explained", "unexplained"])
def test_a_search_that_time_stopped_says_nothing_of_what_it_did_not_ask(status: Status) -> None:
    whole, stopped = (
        sentence(replace(made_diagnosis(*made_comparison()), status=status, stopped=after)) for after in (False, True)
    )
    assert "time given" in stopped
    assert "time" not in whole
    for never_asked in ("Nothing is missing", "no sure cause", "agree"):
        assert never_asked not in stopped


@pytest.mark.parametrize(
    ("order", "said"),
    [
        (71.99, "within half a line of order 72 of the driving shaft"),
        (71.97, "no integer of either shaft"),
        (43.99 * 18 / 25, "within half a line of order 44 of the driven shaft"),
        (0.3, "no integer of either shaft"),
    ],
)
def test_half_a_line_from_a_whole_order_is_not_told_from_it(order: float, said: str) -> None:
    """25 turns: half a line is 0.02 orders of the driving shaft."""
    assert label_of(order / 18, z=(18, 25), span=25.0 * 18) == said


@pytest.mark.long
@pytest.mark.parametrize(("speed", "changed"), [(18.01, False), (19.0, True)])
def test_a_speed_that_differs_by_a_part_in_a_thousand_did_not_change(speed: float, changed: bool) -> None:
    rng = np.random.default_rng(13)
    sets = []
    for rpm, extra in ((18.0, 0.0), (speed, 0.5 * UM)):
        u, t = samples(rng, z_1=18, z_2=18, cycles=10, per_mesh=10)
        data = residual(u, t, noise(rng, u.size, "white", 0.3 * UM) + extra, z_1=18, z_2=18)
        sets.append(replace(data, speed=rpm, torque=1.0))
    gears = (replace(INSPECTED[0], z=18), replace(INSPECTED[1], z=18))
    (entry,) = [e for e in locate(sets, gears=gears).entries if e.kind == "condition"]
    assert ("speed changed" in entry.label) == changed
    assert "torque" not in entry.label


def test_nothing_drifts_farther_than_its_record_ranges() -> None:
    """Slow wandering of a fifth of a millimetre over three turns: curves and waves beside it may cancel."""
    rng = np.random.default_rng(3)
    u, t = samples(rng, z_1=12, z_2=47, cycles=0.29, per_mesh=6)
    walk = np.cumsum(rng.normal(size=u.size))
    values = 150.0 * UM * (walk - np.mean(walk)) / np.std(walk) + 30.0 * UM * np.cos(2.0 * math.pi * u / 12)
    found = locate([residual(u, t, values, z_1=12, z_2=47)], gears=(GearKnown(z=12), GearKnown(z=47)))
    for entry in found.where:
        if entry.drift:
            assert abs(entry.amplitude_um or 0.0) <= 0.5 * float(np.ptp(values)) / UM


def test_a_burst_is_larger_than_its_error() -> None:
    """In noise whose model is a hundred times too quiet where it is white, every stretch is loud, and none is more than
    the noise."""
    rng = np.random.default_rng(4)
    u, t = samples(rng, z_1=18, z_2=25, cycles=2, per_mesh=10)
    values = noise(rng, u.size, "ar")
    here = slice(2000, 2128)
    values[here] = 0.9e-3 * (-1.0) ** np.arange(128)  # quieter than the noise, but the sharpest that it could be
    data = residual(u, t, values, z_1=18, z_2=25)
    model = estimate_noise(u, values, z_1=18, z_2=25)
    assert not burst_entries(0, data, values, model, period=450.0)


def moments(entries: tuple[Entry, ...]) -> list[Entry]:
    return [e for e in entries if e.moment is not None]


@pytest.mark.long
def test_a_tooth_that_comes_round_is_no_jump() -> None:
    """Three turns in which one tooth in every turn and its neighbours stand 12 um off: what steps there steps again."""
    for seed in range(3):
        rng = np.random.default_rng(seed)
        u, t = samples(rng, z_1=18, z_2=25, cycles=0.14)
        pitch = 4.0 * UM * rng.normal(size=18)
        pitch[5:12] -= 12.0 * UM
        values = tooth_signal(u, z=18, pitch=pitch, slope=np.zeros(18), low=-0.8, high=0.8)
        values = values + noise(rng, u.size, "white", 0.3 * UM)
        assert not moments(locate([residual(u, t, values, z_1=18, z_2=25)], gears=(GRADED[0], GRADED[1])).where)


@pytest.mark.parametrize(("z", "comes_round"), [(18, True), (25, True), (21, False)])
def test_a_step_that_comes_again_with_a_shaft_is_told_from_a_jump(z: int, comes_round: bool) -> None:
    """A stretch of teeth 5 um low in every turn of 18 or 25 teeth steps at each turn alike, a period of no shaft does
    not; nor does one step that stays, whatever the shafts."""
    u = np.linspace(0.0, 90.0, 1800, endpoint=False)
    at = int(np.searchsorted(u, 45.0))
    again = np.where((u - 45.0) % z < 6.0, -5.0 * UM, 0.0)
    stays = np.where(u >= 45.0, -5.0 * UM, 0.0)
    for values, expected in ((again, comes_round), (stays, False)):
        data = SimpleNamespace(u=u, residual=values)
        white = SimpleNamespace(frequency=np.array([0.0, 10.0]), density=np.full(2, UM**2))
        state = SimpleNamespace(data=data, slow=np.zeros((u.size, 1)), noise=white)
        search: Any = SimpleNamespace(states=[state], places=[{"slow": slice(0, 1)}], z_1=18, z_2=25)
        solution: Any = SimpleNamespace(beta=np.zeros(1))
        assert _comes_round(search, solution, 0, at, -5.0 * UM) == expected


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, pytest.param(4, marks=pytest.mark.slow)])
def test_no_jump_is_larger_than_all_that_was_recorded(seed: int) -> None:
    """Three turns of an eccentric gear of a grade: each tooth comes thrice, and jumps of millimetres would fit."""
    rng = np.random.default_rng(seed)
    u, t = samples(rng, z_1=18, z_2=25, cycles=0.12)
    mesh, pitch = np.floor(u).astype(int), 3.0 * UM * rng.normal(size=18)
    mate = 3.0 * UM * rng.normal(size=25)
    values = 20.0 * UM * np.cos(2.0 * math.pi * u / 18 + 1.0) + pitch[mesh % 18] - mate[mesh % 25]
    values = values + 0.3 * UM * rng.normal(size=u.size)
    for jump in moments(locate([residual(u, t, values, z_1=18, z_2=25)], gears=(GRADED[0], GRADED[1])).where):
        assert abs(jump.amplitude_um or 0.0) <= float(np.ptp(values)) / UM


@pytest.mark.long
def test_a_jump_that_stays_is_one() -> None:
    rng = np.random.default_rng(7)
    u, t = samples(rng, z_1=18, z_2=25, cycles=0.3)
    values = noise(rng, u.size, "white", 0.3 * UM) + np.where(u > u[u.size // 2], 5.0 * UM, 0.0)
    (jump,) = moments(locate([residual(u, t, values, z_1=18, z_2=25)], gears=INSPECTED).where)
    assert jump.amplitude_um == pytest.approx(5.0, abs=0.2)


def test_a_gear_that_breaks_its_limits_does_not_agree() -> None:
    """Nothing was left out, but the teeth that make the mismatch are no good ones."""
    diagnosis = replace(made_diagnosis(*made_comparison()), status="nothing_missing", findings=(), unexplained=())
    whole = tuple(replace(gear, exceeded=()) for gear in diagnosis.built)
    assert "agree to the noise" in sentence(
        replace(diagnosis, built=whole, before=Rms(seen=0.31 * UM, unseen=0.32 * UM))
    )
    assert "as they were built" in sentence(replace(diagnosis, built=whole))
    # Of a guide log of two worm turns, whose teeth nobody estimated, 1.25 times the noise was left.
    for none in (
        replace(diagnosis, built=tuple(replace(gear, estimated=False) for gear in whole)),
        replace(diagnosis, built=whole, after=diagnosis.before),
    ):
        assert "as they were built" not in sentence(none)
        assert "Nothing stands out of the noise" in sentence(none)
    limit = Limit(kind="single pitch", low=-8.0, high=8.0, grade=6)
    broken = Exceeded(limit=limit, value=15.8, std=0.9, by=7.8, teeth=(7, 8), flank="drive")
    said = sentence(replace(diagnosis, built=(replace(whole[0], exceeded=(broken,)), whole[1])))
    assert "limits" in said
    assert "agree" not in said


def test_the_terminal_tells_where_the_whole_mismatch_lies_unless_it_is_explained() -> None:
    """What teeth as built take is in no list of what is left, and was the largest line of a plastic pair."""
    diagnosis = made_diagnosis(*made_comparison())
    for status, shown in (("unexplained", True), ("explained", False)):
        out = io.StringIO()
        print_diagnosis(Console(file=out, width=200), replace(diagnosis, status=status))
        assert ("most of it first:" in out.getvalue()) is shown
