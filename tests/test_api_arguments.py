"""Python refuses what the command line refuses, and names its own argument, the value and what would do."""

from __future__ import annotations

import ast
import inspect
import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearpoly
from gearpoly.api.words import in_words_of_python
from gearpoly.recording.recording import Recording
from tests.made_command import Command
from tests.test_house import PACKAGE, ROOT

GRADED = ROOT / "data" / "pairs" / "graded_18_25.toml"
RECORDING = "want the path of a recording, what gearpoly.read gives, or a list of these"
FLANKS = 'want "drive" or "coast"'


@cache
def pair() -> Any:
    """Any, since what is given here is what the types forbid."""
    return gearpoly.load(GRADED)


@cache
def run() -> gearpoly.Simulated:
    return gearpoly.load(GRADED).simulate(turns=0.1, fast=True)


RECORDED = Recording(source=Path("r.csv"), te_mm=np.zeros(9), driven_angle_rad=np.zeros(9))

SHEET = ROOT / "data" / "sheets" / "driving.mka"
LOG, BOTH = (ROOT / "data" / "recordings" / "encoder_off_centre" / f"rec_{k}.csv" for k in (0, 1))

REFUSED: dict[str, tuple[Callable[[], object], str]] = {
    "a flank": (lambda: pair().simulate(flank="left"), f'flank "left": {FLANKS}'),
    "no flank": (lambda: pair().simulate(flank=None), f"flank None: {FLANKS}"),
    "turns below 0": (lambda: pair().simulate(turns=-1), "turns -1: want a finite number, 0 or more"),
    "endless turns": (lambda: pair().simulate(turns=math.inf), "turns inf: want a finite number, 0 or more"),
    "turns that are none": (lambda: pair().simulate(turns=math.nan), "turns nan: want a finite number, 0 or more"),
    "turns in words": (lambda: pair().simulate(turns="1"), 'turns "1": want a finite number, 0 or more'),
    "no points": (lambda: pair().simulate(points_per_mesh=0), "points_per_mesh 0: want a whole number, 1 or more"),
    "half a point": (
        lambda: pair().simulate(points_per_mesh=2.5), "points_per_mesh 2.5: want a whole number, 1 or more"
    ),
    "a truth": (lambda: pair().simulate(points_per_mesh=True), "points_per_mesh true: want a whole number, 1 or more"),
    "a torque": (lambda: pair().simulate(torque_nm=-3), "torque_nm -3: want a finite number in N.m, 0 or more"),
    "within": (lambda: pair().diagnose("rec.csv", within=-1), "within -1: want a number in s, 1 or more"),
    "within nothing": (
        lambda: pair().diagnose("rec.csv", within=math.nan), "within nan: want a number in s, 1 or more"
    ),
    "nothing to compare": (lambda: pair().compare([]), f"recordings []: {RECORDING}"),
    "nothing to diagnose": (lambda: pair().diagnose([]), f"recordings []: {RECORDING}"),
    "a number compared": (lambda: pair().compare(7), f"recordings 7: {RECORDING}"),
    "a number among others": (lambda: pair().compare(["rec.csv", 7]), f"recordings 7: {RECORDING}"),
    "a flank of a recording": (
        lambda: pair().compare(replace(RECORDED, flank="left")),  # type: ignore[arg-type]
        f'r.csv: flank "left": {FLANKS}',
    ),
    "a map": (
        lambda: gearpoly.read("rec.csv", map=7),  # type: ignore[arg-type]
        'map 7: want a path, such as "pair.toml" or a pathlib.Path',
    ),
    "angles": (lambda: pair().contacts([]), "theta_2 []: want one finite angle in rad or a list of them"),
    "an angle in words": (
        lambda: pair().transmission_error("x"), 'theta_2 "x": want one finite angle in rad or a list of them'
    ),
    "contacts of a flank": (lambda: pair().contacts(0.0, flank="left"), f'flank "left": {FLANKS}'),
    "error of a flank": (lambda: pair().transmission_error(0.0, flank="left"), f'flank "left": {FLANKS}'),
    "near": (lambda: pair().contacts(0.0, near=-1.0), "near -1.0: want a number in mm, 0 or more"),
    "deviation of a flank": (lambda: pair().driving.deviation([1.0], flank="left"), f'flank "left": {FLANKS}'),
    "a roll length": (
        lambda: pair().driving.deviation([-1.0]),
        "roll_length [-1.0]: want one finite length in mm, 0 or more, or a list of them",
    ),
    "a seed": (lambda: gearpoly.load(GRADED, seed=-1), "seed -1: want a whole number, 0 or more"),
    "a seed of a dictionary": (lambda: gearpoly.Pair.of({}, seed=-1), "seed -1: want a whole number, 0 or more"),
    "keys": (
        lambda: gearpoly.Pair.of("pair.toml"),  # type: ignore[arg-type]
        'known "pair.toml": want a dictionary with the keys of a pair file',
    ),
    "a path": (
        lambda: gearpoly.load(7),  # type: ignore[arg-type]
        'path 7: want a path, such as "pair.toml" or a pathlib.Path',
    ),
    "a gear": (
        lambda: gearpoly.api.PairGear(pair=pair(), which="both"),  # type: ignore[arg-type]
        'which "both": want "driving" or "driven"',
    ),
    "a gear to export": (lambda: pair().export("a.svg", which="x"), 'which "x": want "driving", "driven" or "both"'),
    "a flank to export": (lambda: pair().export("a.svg", flank="left"), f'flank "left": {FLANKS}'),
    "where to stand": (lambda: pair().export("a.svg", theta_2=math.nan), "theta_2 nan: want a finite number in rad"),
    "alone and in mesh": (
        lambda: pair().export("a.svg", which="driven", theta_2=1.0),
        "theta_2 turns two gears in mesh; leave it out with apart or a single gear (which)",
    ),
    "magnify": (lambda: pair().export("a.svg", magnify=-1), "magnify -1: want a number from 0 to 1e+06"),
    "points": (lambda: pair().export("a.svg", points=3), "points 3: want a whole number from 8 to 20000"),
    "a chord": (lambda: pair().export("a.svg", chord=5.0), "chord 5 mm: want 0.0001 to 100 um"),
    "points and a chord": (
        lambda: pair().export("a.svg", points=50, chord=0.001),
        "points and chord both set the detail; want one of the two",
    ),
    "curves": (lambda: pair().export("a.dxf", curves="x"), 'curves "x": want "lines", "arcs" or "splines"'),
    "curves of a format": (lambda: pair().export("a.svg", curves="arcs"), "curves arcs: .svg files hold lines"),
    "curves of a design": (
        lambda: pair().export("a.rexs", curves="arcs"), "curves arcs: .rexs files hold no curves; leave it out"
    ),
    "both gears in one": (
        lambda: pair().export("a.gde"), '.gde files hold one gear; say which with which="driving" or which="driven"'
    ),
    "a magnified inspection": (
        lambda: pair().driving.export("a.gde", magnify=9.0),
        "magnify 9: an inspection file with deviations that no gear has would pass for a real one; leave magnify out",
    ),
    "a magnified design": (
        lambda: pair().export("a.rexs", magnify=2.0),
        ".rexs files hold the design of both gears; leave out which, theta_2, flank, apart, magnify, points and chord",
    ),
    "workers": (
        lambda: gearpoly.run_study("study.toml", "out", workers=0), "workers 0: want a whole number, 1 or more"
    ),
    "workers twice": (
        lambda: gearpoly.run_study("study.toml", "out", workers=2, scheduler="tcp://host:8786"),
        "workers 2: the scheduler brings its own workers; leave workers out",
    ),
    "a folder": (
        lambda: gearpoly.open_study(7),  # type: ignore[arg-type]
        'folder 7: want a path, such as "pair.toml" or a pathlib.Path',
    ),
    "a recording to simulate at": (
        lambda: pair().simulate_at(7), 'recording 7: want a path, such as "pair.toml" or a pathlib.Path'
    ),
    "a flank to simulate at": (lambda: pair().simulate_at(RECORDED, flank="left"), f'flank "left": {FLANKS}'),
    "a picture of nothing": (
        lambda: pair().plot("a.png", what="bear"), 'what "bear": want "mesh", "deviations" or "gaps"'
    ),
    "a picture at no angle": (
        lambda: pair().plot("a.png", theta_2=math.inf), "theta_2 inf: want a finite number in rad"
    ),
    "a view at no angle": (lambda: pair().view(theta_2=math.nan), "theta_2 nan: want a finite number in rad"),
    "a view by a map": (
        lambda: pair().view(map="map.toml"), 'map "map.toml": a map is of a recording; want recording beside it'
    ),
    "a view of a flank": (lambda: pair().view(flank="left"), f'flank "left": {FLANKS}'),
    "a flank beside a recording": (
        lambda: pair().view(recording=RECORDED, flank="coast"),
        'flank "coast": the recording brings its flank; leave flank out',
    ),
    "no files": (
        lambda: gearpoly.survey([]), "files []: want the path of a recording, or a list of them"
    ),
    "a number to survey": (
        lambda: gearpoly.survey([7]),  # type: ignore[list-item]
        'files 7: want a path, such as "pair.toml" or a pathlib.Path',
    ),
    "a map of a number": (
        lambda: pair().compare("rec.csv", map=[7]), 'map 7: want a path, such as "pair.toml" or a pathlib.Path'
    ),
    "a map of two": (
        lambda: gearpoly.survey([LOG, BOTH]).to_map("map.toml"),
        "target map.toml: a map is of one file, and 2 are given; want one of them",
    ),
    "a mount without a name": (
        lambda: gearpoly.pair_of_mount(6, "pair.toml"),  # type: ignore[arg-type]
        'name 6: want the name of a mount, such as "EQ6"',
    ),
    "a gear of a sheet": (
        lambda: gearpoly.pair_from(SHEET, "pair.toml", which="both"),  # type: ignore[arg-type]
        'which "both": want "driving" or "driven"',
    ),
    "a flank of a sheet": (
        lambda: gearpoly.pair_from(SHEET, "pair.toml", flank="drive"),  # type: ignore[arg-type]
        'flank "drive": want "left" or "right"',
    ),
    "a direction of counting": (
        lambda: gearpoly.pair_from(SHEET, "pair.toml", count="up"),  # type: ignore[arg-type]
        'count "up": want "clockwise" or "counterclockwise"',
    ),
    "a stage": (
        lambda: gearpoly.pair_from(SHEET, "pair.toml", stage="one"),  # type: ignore[arg-type]
        'stage "one": want a whole number, 0 or more',
    ),
    "a share": (
        lambda: gearpoly.open_study("out", share=1.5), "share 1.5: want a number from 0 to 1"
    ),
    "a confidence": (
        lambda: gearpoly.open_study("out", confidence=0.2), "confidence 0.2: want a number from 0.5 to 0.9999"
    ),
    "samples": (
        lambda: gearpoly.copy_samples(7),  # type: ignore[arg-type]
        'target 7: want a path, such as "pair.toml" or a pathlib.Path',
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_refused_is_named_with_a_cure(what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    call, message = REFUSED[what]
    with pytest.raises(gearpoly.OutOfRangeError) as caught:
        call()
    assert str(caught.value) == message
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--turns", "inf"], "gearpoly: --turns inf: want a finite number, 0 or more"),
        (["--turns", "-1"], "'--turns'"),
        (["--points-per-mesh", "0"], "'--points-per-mesh'"),
        (["--flank", "left"], "'--flank'"),
    ],
)
def test_the_command_refuses_the_same(options: list[str], message: str, gearpoly_command: Command) -> None:
    ran = gearpoly_command("simulate", str(GRADED), *options)
    assert ran.code == 2 and message in ran.err


@pytest.mark.long
@pytest.mark.parametrize("turns", [0, 0.0, np.float64(0.1), np.int64(1)])
def test_numbers_of_numpy_are_numbers(turns: float) -> None:
    """No turn is one mesh: the mesh that is begun is gone through."""
    found = gearpoly.load(GRADED).simulate(turns=turns, points_per_mesh=np.int64(2), fast=True)  # type: ignore[arg-type]
    assert found.te_um.size == 2 * max(1, math.ceil(25 * float(turns)))


def test_samples_are_copied_to_a_path_or_its_text(tmp_path: Path) -> None:
    assert (gearpoly.copy_samples(str(tmp_path / "x")) / "pairs").is_dir()  # type: ignore[arg-type]
    assert (tmp_path / "x" / "pairs" / GRADED.name).is_file()


@pytest.mark.long
def test_a_magnified_gear_that_crosses_itself_is_told_in_python(tmp_path: Path) -> None:
    with pytest.raises(gearpoly.InputFileError) as caught:
        pair().export(tmp_path / "a.svg", magnify=5000.0)
    assert caught.value.found.startswith("with magnify 5000 the ") and "--" not in str(caught.value)
    assert f"{caught.value.found}; {caught.value.wish}" in str(caught.value)


OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")

OF_A_COMMAND = re.compile(r"(?:pip install|gearpoly (?:read|pair|simulate|compare|diagnose))\b[^,;.]*")
"""A command that a message names with its options; it stays one."""

REACHED = (
    "positions",
    "simulate",
    "course",
    "assemble",
    "mesh",
    "gear",
    "export",
    "files",
    "recording",
    "view",
    "study",
)
"""Parts whose messages reach a caller from Python by a call that has arguments of those names."""

OF_THE_COMMAND_ALONE = {"files/reference.py": "the page of the pair file"}


def said(file: Path) -> list[str]:
    """Text in the code of a module that is no docstring."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    loose = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in loose
    ]


@pytest.mark.long
def test_no_message_that_python_hears_speaks_of_an_option() -> None:
    files = [file for part in REACHED for file in [PACKAGE / f"{part}.py", *(PACKAGE / part).rglob("*.py")]]
    found = 0
    for file in files:
        if not file.is_file() or str(file.relative_to(PACKAGE)) in OF_THE_COMMAND_ALONE:
            continue
        for text in said(file):
            if text.strip() == "--":  # a dashed line
                continue
            found += bool(OPTION.search(text))
            left = OF_A_COMMAND.sub("", in_words_of_python(text))
            assert not OPTION.search(left), f"{file.name}: {left}"
    assert found > 15  # the test sees them


def test_what_is_asked_of_a_sheet_is_asked_in_python(tmp_path: Path) -> None:
    """Which gear, then which flank; what the file states already is no argument."""
    asked = [
        ({}, 'the inspection of one gear; say which: which="driving" or which="driven"'),
        ({"which": "driving"}, 'it does not say which flank drives; say flank="left" or flank="right": seen on'),
        ({"which": "driving", "flank": "left", "stage": 3}, "no REXS design, and stage; leave stage out"),
    ]
    for given, message in asked:
        with pytest.raises(gearpoly.InputFileError) as caught:
            gearpoly.pair_from(SHEET, tmp_path / "pair.toml", **given)  # type: ignore[arg-type]
        assert str(caught.value).startswith(f"{SHEET}: {message}")
    with pytest.raises(gearpoly.InputFileError, match=r'^name: no mount "EQ66"; the nearest known are ') as wrong:
        gearpoly.pair_of_mount("EQ66", tmp_path / "pair.toml")
    assert wrong.value.file == "name" and str(wrong.value).endswith("(gearpoly pair --new)")
    assert not list(tmp_path.iterdir())


def test_a_limit_is_told_in_python(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(
        f'name = "one"\npair = "{GRADED}"\npairs = 1\npositions_per_mesh = 4\nturns = 0.1\noutputs = ["te_pp_um"]\n'
        '[set]\n"pair.torque_nm" = 0.0\n',
        encoding="utf-8",
    )
    folder = gearpoly.run_study(tmp_path / "study.toml", tmp_path / "rows").folder
    told = {
        ("te_pp_um=12", 0.9): 'limits "te_pp_um=12"; want "output<=number" or "output>=number"',
        (7, 0.9): 'limits 7; want "output<=number" or "output>=number"',
        ("te_um<=12", 0.9): 'limits "te_um<=12": the study kept no "te_um"; the nearest is "te_pp_um"',
        ("te_pp_um<=x", 0.9): 'limits "te_pp_um<=x": "x" is no number',
        ("te_pp_um<=12", 1.0): "share 1: want a share above 0 and below 1",
    }
    for (limit, share), message in told.items():
        with pytest.raises(gearpoly.OutOfRangeError) as caught:
            gearpoly.open_study(folder, limits=[limit], share=share)  # type: ignore[list-item]
        assert str(caught.value) == message


def test_other_commands_keep_their_options() -> None:
    text = "gearpoly read FILE --write map.toml writes them, --map map.toml takes them"
    assert in_words_of_python(text) == 'gearpoly read FILE --write map.toml writes them, map="map.toml" takes them'
    assert in_words_of_python("--chord-um 0.5 cannot be reached") == "chord 0.0005 mm cannot be reached"


@pytest.mark.long
def test_a_pair_and_a_run_are_one_line() -> None:
    assert repr(pair()) == '<Pair "18/25 pair of grade 5 under load": 18/25 teeth, seed 0>'
    assert repr(pair().driven) == "<PairGear: the driven gear, 25 teeth of module 2 mm>"
    text = repr(run())
    assert text.startswith('<Simulated "18/25 pair of grade 5 under load": 120 positions, drive flank, ')
    assert f"{run().te_pp_um:.3g} um peak to peak" in text and len(text) < 200
    drawn = pair().drawing()
    assert repr(drawn).startswith('<Drawing "18/25 pair of grade 5 under load": driving and driven gear, chord error ')


SMALL = {"MadeFiles", "Studied"}
"""What holds names of files alone."""


@pytest.mark.parametrize("name", sorted(set(gearpoly.__all__) - {"__version__", "Recording"}))
def test_what_is_shown_of_an_object_is_its_own(name: str) -> None:
    """A dataclass would show all arrays that it holds."""
    one = getattr(gearpoly, name)
    if inspect.isclass(one) and not issubclass(one, Exception) and name not in SMALL:
        assert "__repr__" in vars(one) and one.__repr__.__code__.co_name == "__repr__"  # a dataclass wraps its own


def test_a_design_is_the_commands(tmp_path: Path, gearpoly_command: Command) -> None:
    written = pair().export(tmp_path / "mine.rexs")
    ran = gearpoly_command("export", str(GRADED), "--to", str(tmp_path / "theirs.rexs"))
    assert ran.code == 0, ran.err
    assert (tmp_path / "mine.rexs").read_bytes() == (tmp_path / "theirs.rexs").read_bytes()
    assert f": {written.says}" in ran.err and all(one in ran.err for one in written.remarks)


SWINGING = """
[pair]
torque_nm = 10.0
speed_rpm = 900.0
[pair.resonance]
frequency_hz = 300.0
damping_ratio = 0.05
[driving]
teeth = 18
module_mm = 2.0
face_width_mm = 20.0
dedendum = 1.157
[driven]
teeth = 25
module_mm = 2.0
face_width_mm = 20.0
dedendum = 1.157
"""
"""Full depth teeth, whose roots are less round than usual; 900 rpm of 18 teeth is 270 Hz, which a resonance at 300 Hz
magnifies."""


@pytest.mark.long
def test_a_run_at_a_speed_swings_and_says_what_the_command_says(tmp_path: Path, gearpoly_command: Command) -> None:
    """At the speed that the pair file states, as the command takes it."""
    (tmp_path / "pair.toml").write_text(SWINGING, encoding="utf-8")
    options = ("--turns", "0.2", "--fast", "--json", "-", "--csv", str(tmp_path / "te.csv"))
    ran = gearpoly_command("simulate", str(tmp_path / "pair.toml"), *options)
    assert ran.code == 0, ran.err
    found = gearpoly.load(tmp_path / "pair.toml").simulate(turns=0.2, fast=True)
    found.to_csv(tmp_path / "mine.csv")
    assert (tmp_path / "mine.csv").read_text() == (tmp_path / "te.csv").read_text()
    assert list(found.remarks) == json.loads(ran.out)["remarks"] and "root_radius is" in found.remarks[0]
    still = gearpoly.load(tmp_path / "pair.toml")
    keys = still.file.model_copy(update={"pair": still.file.pair.model_copy(update={"speed_rpm": None})})
    slow = replace(still, file=keys).simulate(turns=0.2, fast=True)
    assert abs(found.te_pp_um - slow.te_pp_um) > 0.1  # um, far above rounding: the speed matters here
