"""What the report says of a table: counted by hand where it can be, and a page that needs nothing else."""

from __future__ import annotations

import itertools
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from typer.testing import CliRunner

from gearpoly.cli import app
from gearpoly.errors import InputFileError, OutOfRangeError
from gearpoly.study.answers import Answers, answer
from gearpoly.study.keys import known_keys
from gearpoly.study.labels import asked_words, row_label
from gearpoly.study.models import OutputLimit, Sweep
from gearpoly.study.pictures import pictures
from gearpoly.study.read import read_study
from gearpoly.study.run import run_study
from gearpoly.study.statistics import share
from gearpoly.study.words import key_words, sweep_words
from gearpoly.study.yields import cheapest, yields
from tests.study_files import GRADES, THICKNESS, write_study

pytestmark = pytest.mark.long


pytest.importorskip("pyarrow")

OUTPUTS = 'outputs = ["te_pp_um", "backlash_least_um"]\n'


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    torque = '[[sweep]]\nkey = "driving.bore_mm"\nmethod = "grid"\nfrom = 6.0\nto = 8.0\nsteps = 2\n'
    run_study(read_study(write_study(folder, OUTPUTS + GRADES + torque, pairs=12)), out=folder / "out")
    return folder / "out"


@pytest.fixture(scope="module")
def plain(table: Path) -> Answers:
    return answer(table)


def test_groups_hold_the_rows_of_their_combination(plain: Answers) -> None:
    answers = plain
    found = answers.store.columns(["driving.grade", "driving.bore_mm", "te_pp_um"])
    assert [group.label for group in answers.groups][:2] == [
        "grade = 5, driving.bore_mm = 6",
        "grade = 5, driving.bore_mm = 8",
    ]
    for group in answers.groups:
        mine = (found["driving.grade"] == group.values["driving.grade"]) & (
            found["driving.bore_mm"] == group.values["driving.bore_mm"]
        )
        np.testing.assert_array_equal(group.sample("te_pp_um").values, np.sort(found["te_pp_um"][mine]))
        assert (group.pairs, group.done, group.jams, group.refused) == (12, 12, 0, 0)


def test_the_cheapest_grade_is_the_coarsest_that_surely_keeps_the_limit(plain: Answers) -> None:
    worst = [
        max(g.sample("te_pp_um").values[-1] for g in plain.groups if g.values["driving.grade"] == n) for n in (5, 6, 7)
    ]
    limit = OutputLimit(output="te_pp_um", at_most=0.5 * (worst[1] + worst[2]), share=0.7)
    groups, design = plain.groups, plain.store.plan.design

    def asked(limit: OutputLimit) -> tuple[tuple[str, ...], tuple[str, ...]]:
        (found,) = yields((limit,), groups, confidence=0.95)
        grade = cheapest(found, groups, design)
        assert grade is not None
        return found.verdicts, grade.says

    verdicts, says = asked(limit)
    # 12 of 12 leave 0.735 as the lower end: enough for a share of 0.7, not for one of 0.9.
    assert [v for v, g in zip(verdicts, groups, strict=True) if g.values["driving.grade"] < 7] == ["keeps it"] * 4
    assert len(says) == 2  # one for each bore
    if verdicts[-1] != "keeps it":
        assert "grade 6" in says[0]
    assert "which so few pairs do not settle" in asked(limit.model_copy(update={"share": 0.9}))[1][0]
    assert asked(OutputLimit(output="te_pp_um", at_most=0.01))[1][0].endswith("none of the grades keeps it")


def test_the_bore_drives_nothing_and_the_grade_much(plain: Answers) -> None:
    indices = {one.factor: one for one in dict(plain.sensitivity)["te_pp_um"]}
    assert indices["driving.bore_mm"].total.value == pytest.approx(0.0, abs=1e-12)  # unloaded: no tooth bends
    assert indices["grade"].first.value > 0.1  # steps of 41 % in all deviations
    assert indices["grade"].first.value + indices["chance"].first.value <= 1.0 + 1e-9


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four combinations of five pairs: all run, all refused, all refused, all jam."""
    folder = tmp_path_factory.mktemp("mixed")
    run_study(read_study(write_study(folder, THICKNESS, pairs=5)), out=folder / "out")
    return folder / "out"


def _limit(output: str = "te_pp_um", **bound: float) -> OutputLimit:
    return OutputLimit(output=output, share=0.5, **bound)


def test_refused_pairs_are_in_no_yield_and_pairs_that_jam_are_bad(mixed: Path) -> None:
    answers = answer(mixed, limits=[_limit(at_most=1e6)])
    assert [(g.pairs, g.done, g.jams, g.refused) for g in answers.groups] == [
        (5, 5, 0, 0), (5, 0, 0, 5), (5, 0, 0, 5), (5, 0, 5, 0),
    ]  # fmt: skip
    (found,) = answers.yields
    assert found.judged == (5, 0, 0, 5)
    assert found.shares[0] == share(5, 5)
    assert found.shares[3] == share(0, 5)
    assert found.verdicts == (
        "probably keeps it",
        "no pair could be drawn",
        "no pair could be drawn",
        "probably does not",
    )
    half = float(np.median(answers.groups[0].sample("te_pp_um").values))
    assert answer(mixed, limits=[_limit(at_most=half)]).yields[0].shares[0] == share(3, 5)


def test_pairs_that_come_out_of_mesh_are_bad_ones(plain: Answers) -> None:
    apart = replace(plain.groups[0], pairs=15, no_contact=3)
    (found,) = yields((_limit(at_most=1e6),), (apart,), confidence=0.95)
    assert found.judged == (15,)
    assert found.shares == (share(12, 15),)


def test_reasons_that_differ_in_numbers_alone_are_one_cause(mixed: Path) -> None:
    refused, jams = answer(mixed).causes
    assert (refused.status, refused.pairs, refused.index) == ("refused", 10, 1)
    assert refused.values["driven.limits.E_sns_um"] == -60.0
    assert "no gear passes: E_s from -90.00 to -60.00 um" in refused.reason
    assert (jams.status, jams.pairs, jams.index) == ("jams", 5, 3)
    assert jams.seed == refused.seed  # draws are shared, so both are draw 0


def test_the_report_begins_with_what_was_refused_and_why(mixed: Path, tmp_path: Path) -> None:
    page, out = tmp_path / "page.html", tmp_path / "all.json"
    arguments = [str(mixed), "--html", str(page), "--json", str(out), "--limit", "te_pp_um<=60"]
    ran = CliRunner().invoke(app, ["study-report", *arguments])
    assert ran.exit_code == 0, ran.output
    said = " ".join(ran.output.split())
    text = page.read_text(encoding="utf-8")
    for shown, first_number in ((said, "median"), (text, "<h2>Yield")):
        at = [shown.index(part) for part in ("10 of 20 pairs are refused", "5 of 20 pairs were drawn", "no gear passes",
              "row 1 (driven.limits.E_sns_um = -60, ", "overlap", first_number)]  # fmt: skip
        assert at[:3] == sorted(at[:3])
        assert max(at[:-1]) < at[-1]
        assert "0 of 5 pairs judged; 5 refused" in shown
    found = json.loads(out.read_text(encoding="utf-8"))
    assert list(found).index("failures") < list(found).index("groups")
    assert [(one["status"], one["pairs"], one["example"]["index"]) for one in found["failures"]] == [
        ("refused", 10, 1), ("jams", 5, 3),
    ]  # fmt: skip
    assert [one["judged"] for one in found["yields"][0]["groups"]] == [5, 0, 0, 5]
    assert found["yields"][0]["groups"][1]["share"]["value"] is None


def test_an_output_that_no_pair_has_judges_none(mixed: Path) -> None:
    """Without a torque there is no load to share; that makes no gear a bad one."""
    answers = answer(mixed, limits=[_limit("load_share_peak", at_most=0.9)])
    assert answers.yields[0].judged[0] == 0
    assert answers.yields[0].verdicts[0] == "no pair has this output"


def test_sensitivity_says_on_how_much_it_rests(mixed: Path) -> None:
    answers = answer(mixed)
    assert "no sensitivity: none of 5 draws has a result in every combination" in answers.remarks
    assert not any(indices for _, indices in answers.sensitivity)


def test_limits_together_are_counted_pair_by_pair(table: Path, plain: Answers) -> None:
    found = plain.store.columns(["driving.grade", "driving.bore_mm", "te_pp_um", "backlash_least_um"])
    te, gap = (float(np.median(found[name])) for name in ("te_pp_um", "backlash_least_um"))
    limits = [
        OutputLimit(output="te_pp_um", at_most=te, share=0.9),
        OutputLimit(output="backlash_least_um", at_least=gap, share=0.2),
    ]
    answers = answer(table, limits=limits)
    assert [len(one.limits) for one in answers.yields] == [1, 1, 2]
    together = answers.yields[2]
    assert together.share == 0.2  # no more pairs keep both than keep the one of which least is asked
    assert together.words.startswith("all 2 limits together: te_pp_um at most")
    assert asked_words(together).startswith("both limits together: peak-to-peak TE")
    for group, kept in zip(answers.groups, together.shares, strict=True):
        mine = (found["driving.grade"] == group.values["driving.grade"]) & (
            found["driving.bore_mm"] == group.values["driving.bore_mm"]
        )
        good = int(np.sum((found["te_pp_um"][mine] <= te) & (found["backlash_least_um"][mine] >= gap)))
        assert kept == share(good, 12)
    # Shares on their own do not say it: in some group they cannot both be of the same pairs.
    assert any(
        both.value < min(one.value, two.value)
        for one, two, both in zip(*(y.shares for y in answers.yields), strict=True)
    )
    assert len(answers.cheapest) == 3
    assert [len(one.limits) for one in yields((limits[0],), plain.groups, confidence=0.95)] == [1]


def test_sobol_points_with_sensitivity(tmp_path: Path) -> None:
    text = (
        "samples = 16\nsensitivity = true\n" + OUTPUTS
        + '[[sweep]]\nkey = "pair.centre_distance_mm"\nmethod = "sobol"\nfrom = 24.95\nto = 25.25\n'
        + '[[sweep]]\nkey = "driving.bore_mm"\nmethod = "sobol"\nfrom = 5.0\nto = 9.0\n'
    )  # fmt: skip
    run_study(read_study(write_study(tmp_path, text, pairs=1)), out=tmp_path / "out")
    answers = answer(tmp_path / "out")
    assert answers.groups[0].pairs == 32  # A and B
    indices = {one.factor: one for one in dict(answers.sensitivity)["backlash_least_um"]}
    assert list(indices) == ["pair.centre_distance_mm", "driving.bore_mm", "chance"]
    # Backlash is 2 tan(alpha_w) times the distance, 0.24 mm over the range, against some 20 um of chance.
    assert indices["pair.centre_distance_mm"].total.value > 0.8
    assert indices["driving.bore_mm"].total.value == pytest.approx(0.0, abs=1e-12)


def test_no_label_of_a_picture_lies_on_another_or_is_cut_off(plain: Answers) -> None:
    """Long names of combinations once ran into one another along an axis."""
    limits = tuple(OutputLimit(output=name, at_most=50.0, share=0.9) for name in ("te_pp_um", "backlash_least_um"))
    answers = answer(plain.store.folder, limits=list(limits))
    longer = tuple(
        replace(one, words=f"{one.words}, inspection tooth thickness of the driven gear = -60 um")
        for one in answers.groups
    )
    # Once as curves, and once with more combinations than curves have colours.
    for groups in (longer, longer * 3):
        yields_ = yields(limits, groups, confidence=0.95)
        for picture in pictures(replace(answers, groups=groups, yields=yields_)):
            for figure in (picture.drawn()[0], picture.figure()):
                FigureCanvasAgg(figure)
                figure.draw_without_rendering()
                width, height = figure.bbox.size
                for axis in figure.axes:
                    for labels in (axis.get_xticklabels(), axis.get_yticklabels()):
                        boxes = [one.get_window_extent() for one in labels if one.get_text()]
                        assert not any(a.overlaps(b) for a, b in itertools.pairwise(boxes)), picture.name
                    inside = axis.get_tightbbox()
                    assert min(inside.x0, inside.y0) > -1.0 and inside.x1 < width + 1.0 and inside.y1 < height + 1.0


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("grade = 5", ["grade = 5"]),
        ("grade = 5, teeth = 25", ["grade = 5", "teeth = 25"]),
        ("bore of the driving gear = 6.25 mm", ["bore of the driving", "gear = 6.25 mm"]),
        ("grade of all 22 teeth = 4 um", ["grade of all 22 teeth", "= 4 um"]),
    ],
)
def test_names_of_rows_are_parted_at_what_is_swept_and_between_words(name: str, lines: list[str]) -> None:
    assert row_label(name).split("\n") == lines


def test_page_needs_no_network_and_no_script(table: Path, tmp_path: Path) -> None:
    page, out = tmp_path / "page.html", tmp_path / "all.json"
    ran = CliRunner().invoke(
        app,
        [
            "study-report",
            str(table),
            "--html",
            str(page),
            "--json",
            str(out),
            "--limit",
            "te_pp_um<=60",
            "--share",
            "0.9",
        ],
    )
    assert ran.exit_code == 0, ran.output
    assert "grade" in ran.output
    text = page.read_text(encoding="utf-8")
    assert "<script" not in text
    assert not re.findall(r'(?:src|href)="(?!data:|#)', text)
    assert "@import" not in text
    assert "url(" not in text
    assert text.count("<figure>") >= 3
    found = json.loads(out.read_text(encoding="utf-8"))
    assert found["groups"][0]["outputs"]["te_pp_um"]["percentiles"]["50"]["value"] > 0.0
    assert found["groups"][0]["outputs"]["te_pp_um"]["percentiles"]["99"]["high"] is None  # 12 pairs do not place it
    assert found["yields"][0]["limit"] == "te_pp_um at most 60 in 90 % of pairs"
    # Words with units where people read; keys for programs, and small beside them.
    assert "<p>Peak-to-peak TE along the line of action at most 60 um in 90 % of pairs<br>" in text
    assert "<h3>Least normal backlash / um</h3><p><small><code>backlash_least_um</code></small></p>" in text
    assert "grade = 5, bore of the driving gear = 6 mm" in text
    assert not re.search(r">[^<]*\b(te_pp_um|driving\.)[^<]*</(h2|h3|td|th|figcaption|li|b)>", text)


def test_keys_of_a_pair_file_in_words() -> None:
    words = {
        "driving.tip_relief.amount_um": ("tip relief amount of the driving gear", "um"),
        "driven.limits.E_sns_um": ("E_sns of the driven gear", "um"),
        "pair.centre_distance_mm": ("centre distance", "mm"),
        "pair.windup_urad_per_nm": ("windup", "urad/(N.m)"),
        "material.youngs_modulus_gpa": ("material youngs modulus", "GPa"),
        "driving.points_per_flank": ("points per flank of the driving gear", ""),
    }
    assert {key: key_words(key) for key in words} == words
    # No unit of any key is taken for a word.
    left = {key_words(key)[0].partition(" of the ")[0].rpartition(" ")[2] for key in known_keys()}
    assert not left & {"um", "mm", "deg", "nm", "urad", "hz", "rpm", "gpa", "n", "kg"}

    def both(*keys: str, **further: str) -> tuple[str, str]:
        return sweep_words(Sweep.model_validate({"keys": keys, "method": "list", "values": [1.0], **further}))

    assert both("driving.bore_mm", "driven.bore_mm") == ("bore of both gears", "mm")
    assert both("driving.bore_mm", "driven.tip_relief.amount_um") == ("bore of the driving gear and 1 more", "mm")
    assert both("driving.bore_mm", "driven.bore_mm", name="bore") == ("bore", "mm")


def test_commands_from_end_to_end(tmp_path: Path) -> None:
    study, out, csv = write_study(tmp_path, OUTPUTS, pairs=2), tmp_path / "out", tmp_path / "t.csv"
    ran = CliRunner().invoke(app, ["study", str(study), "--out", str(out), "--workers", "1", "--csv", str(csv)])
    assert ran.exit_code == 0, ran.output
    assert "2 pairs (1 combination), 2 of them made now" in ran.output
    assert ran.stderr.splitlines() == [f"wrote {out}: the table, in rows/", f"wrote {csv}: the table as CSV"]
    lines = csv.read_text().splitlines()
    assert lines[0] == "index,combination,draw,seed,status,reason,te_pp_um,backlash_least_um"
    assert len(lines) == 3
    ran = CliRunner().invoke(
        app, ["study", str(study), "--out", str(out), "--scheduler", "tcp://x:1", "--workers", "2"]
    )
    assert isinstance(ran.exception, OutOfRangeError)


def test_a_folder_without_a_table(tmp_path: Path, table: Path) -> None:
    with pytest.raises(InputFileError, match=r"study\.json"):
        answer(tmp_path)
    for wrong, says in (("te_pp_um", "want"), ("te_ppum<=3", "nearest"), ("te_pp_um<=x", "no number")):
        ran = CliRunner().invoke(app, ["study-report", str(table), "--limit", wrong])
        assert isinstance(ran.exception, OutOfRangeError)
        assert says in str(ran.exception)


def test_an_unfinished_study_says_so(tmp_path: Path) -> None:
    run_study(read_study(write_study(tmp_path, OUTPUTS, pairs=3)), out=tmp_path / "out")
    manifest = tmp_path / "out" / "study.json"
    document = json.loads(manifest.read_text()) | {"finished": False, "rows": 9}
    manifest.write_text(json.dumps(document))
    assert "3 of 9 pairs are there" in answer(tmp_path / "out").remarks[0]


@pytest.mark.slow
def test_a_robot_joint_of_6_arcmin_at_the_output_wants_grade_4(tmp_path: Path) -> None:
    """What the page on studies says of data/studies/robot_joint.toml, from the first 20 of its 100 pairs a grade."""
    data = Path(__file__).parents[1] / "data"
    text = (data / "studies" / "robot_joint.toml").read_text(encoding="utf-8").replace("pairs = 100", "pairs = 20")
    (tmp_path / "study.toml").write_text(text.replace("../pairs", str(data / "pairs")), encoding="utf-8")
    run_study(read_study(tmp_path / "study.toml"), out=tmp_path / "out")
    answers = answer(tmp_path / "out")
    medians = [dict(g.sample("lost_motion_most_driven_arcmin").percentiles)[50.0] for g in answers.groups]
    for found, stated in zip(medians, (3.88, 4.57, 5.94, 7.57, 9.95), strict=True):
        assert found.low <= stated <= found.high
    for group in answers.groups:  # 20 and 100 teeth: five times the angle on the input
        on_input, on_output = (group.ran[f"lost_motion_most_{shaft}_arcmin"] for shaft in ("driving", "driven"))
        np.testing.assert_allclose(on_input, 5.0 * on_output, rtol=1e-12)  # rounding
    assert "grade 4" in answers.cheapest[-1].says[0]
