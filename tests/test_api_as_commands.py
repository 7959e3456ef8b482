"""Python does all that the command line does: every option has its argument or method, and files are equal to a
byte."""

from __future__ import annotations

import inspect
import pkgutil
from collections.abc import Callable
from importlib import import_module
from math import radians
from pathlib import Path

import pytest

import gearpoly
from gearpoly import commands
from tests.made_command import Command
from tests.test_house import ROOT

DATA = ROOT / "data"
SAMPLE = DATA / "recordings" / "encoder_off_centre"
PAIR, RECORDING = SAMPLE / "pair.toml", SAMPLE / "rec_0.csv"
GRADED = DATA / "pairs" / "graded_18_25.toml"

# What offers each parameter of a command: an argument of a function, or a method of a result.
OFFERED: dict[str, dict[str, str]] = {
    "compare": {
        "pair": "load(path)", "recordings": "Pair.compare(recordings)", "map": "Pair.compare(map)",
        "json": "Compared.to_json(target)", "plot": "Compared.plot(target)",
    },
    "diagnose": {
        "pair": "load(path)", "recordings": "Pair.diagnose(recordings)", "map": "Pair.diagnose(map)",
        "json": "Diagnosed.to_json(target)", "html": "Diagnosed.to_html(target)", "pdf": "Diagnosed.to_pdf(target)",
        "figures": "Diagnosed.to_figures(folder)", "fitted": "Diagnosed.to_fitted(target)",
        "within": "Pair.diagnose(within)",
    },
    "examples": {"folder": "copy_samples(target)"},
    "export": {
        "pair": "load(path)", "to": "Pair.export(target)", "gear": "Pair.export(which)", "at": "Pair.export(theta_2)",
        "flank": "Pair.export(flank)", "apart": "Pair.export(apart)", "magnify": "Pair.export(magnify)",
        "points": "Pair.export(points)", "chord_um": "Pair.export(chord)", "curves": "Pair.export(curves)",
        "seed": "load(seed)",
    },
    "pair": {
        "target": "pair_from(target)", "new": "new_pair(target)", "sheet": "new_pair(sheet)",
        "mount": "pair_of_mount(name)", "source": "pair_from(source)", "which": "pair_from(which)",
        "flank": "pair_from(flank)", "count": "pair_from(count)", "layout": "pair_from(map)",
        "stage": "pair_from(stage)",
    },
    "plan": {"pair": "load(path)", "json": "Planned.to_json(target)", "plot": "Planned.plot(target)"},
    "plot": {
        "pair": "load(path)", "to": "Pair.plot(target)", "what": "Pair.plot(what)", "at": "Pair.plot(theta_2)",
        "flank": "Pair.plot(flank)", "seed": "load(seed)",
    },
    "read": {
        "files": "survey(files)", "write": "Surveyed.to_map(target)", "map": "survey(map)",
        "json": "Surveyed.to_json(target)", "plot": "Surveyed.plot(target)",
    },
    "simulate": {
        "pair": "load(path)", "csv": "Simulated.to_csv(target)", "json": "Simulated.to_json(target)",
        "plot": "Simulated.plot(target)", "flank": "Pair.simulate(flank)", "turns": "Pair.simulate(turns)",
        "points_per_mesh": "Pair.simulate(points_per_mesh)", "at": "Pair.simulate_at(recording)",
        "map": "Pair.simulate_at(map)", "fast": "Pair.simulate(fast)", "seed": "load(seed)",
        "every_default": "Simulated(defaults)",
    },
    "study": {
        "study": "run_study(path)", "out": "run_study(folder)", "workers": "run_study(workers)",
        "scheduler": "run_study(scheduler)", "csv": "Studied.to_csv(target)",
    },
    "study_report": {
        "folder": "open_study(folder)", "html": "Studied.to_html(target)", "json": "Studied.to_json(target)",
        "limit": "open_study(limits)", "share": "open_study(share)", "confidence": "open_study(confidence)",
    },
    "view": {
        "pair": "load(path)", "html": "Viewed.to_html(target)", "at": "Pair.view(theta_2)",
        "recording": "Pair.view(recording)", "map": "Pair.view(map)", "flank": "Pair.view(flank)", "seed": "load(seed)",
    },
}  # fmt: skip

SCORES_GEARPOLY = {"prove"}
"""The proof is of gearpoly itself and runs for hours; a program that wants it starts the command."""


def test_every_option_has_an_argument_or_a_method() -> None:
    there = {one.name for one in pkgutil.iter_modules(commands.__path__)}
    assert there == OFFERED.keys() | SCORES_GEARPOLY
    for name, offered in OFFERED.items():
        command = getattr(import_module(f"gearpoly.commands.{name}"), name)
        assert offered.keys() == inspect.signature(command).parameters.keys(), name
        for call in offered.values():
            path, _, argument = call.rstrip(")").partition("(")
            one = gearpoly
            for part in path.split("."):
                one = getattr(one, part)
            assert argument in inspect.signature(one).parameters, call  # type: ignore[arg-type]


def run_of_four(folder: Path) -> gearpoly.Studied:
    """A study of four pairs in ``folder``, made on the first call and read on the next."""
    file = folder / "study.toml"
    if not file.exists():
        text = f'name = "four"\npair = "{GRADED}"\npairs = 4\npositions_per_mesh = 4\nturns = 0.1\n'
        file.write_text(text + 'outputs = ["te_pp_um"]\n[set]\n"pair.torque_nm" = 0.0\n', encoding="utf-8")
    return gearpoly.run_study(file, folder / "rows")


def sheet(target: Path) -> None:
    gearpoly.pair_from(DATA / "sheets" / "driving.mka", target, which="driving", flank="right")


# A call from Python and the options of the command that write the same file.
ALIKE: dict[str, tuple[str, Callable[[Path], object], list[str]]] = {
    "a run": (
        "run.json", lambda to: gearpoly.load(GRADED, seed=2).simulate(turns=0.1, fast=True).to_json(to),
        ["simulate", str(GRADED), "--seed", "2", "--turns", "0.1", "--fast", "--json", "TO"],
    ),
    "the coast flank": (
        "run.csv",
        lambda to: gearpoly.load(GRADED).simulate(turns=0.1, points_per_mesh=8, flank="coast", fast=True).to_csv(to),
        ["simulate", str(GRADED), "--turns", "0.1", "--points-per-mesh", "8", "--flank", "coast", "--fast", "--csv",
         "TO"],
    ),
    "a run at a recording": (
        "run.json", lambda to: gearpoly.load(PAIR).simulate_at(RECORDING, fast=True).to_json(to),
        ["simulate", str(PAIR), "--at", str(RECORDING), "--fast", "--json", "TO"],
    ),
    "a run at a recording on the other flank": (
        "run.csv", lambda to: gearpoly.load(PAIR).simulate_at(gearpoly.read(RECORDING)[0], flank="coast", fast=True)
        .to_csv(to),
        ["simulate", str(PAIR), "--at", str(RECORDING), "--flank", "coast", "--fast", "--csv", "TO"],
    ),
    "a page": (
        "page.html", lambda to: gearpoly.load(PAIR, seed=3).view(theta_2=radians(12.5), flank="coast").to_html(to),
        ["view", str(PAIR), "--at", "12.5", "--flank", "coast", "--seed", "3", "--html", "TO"],
    ),
    "a page beside a recording": (
        "page.html", lambda to: gearpoly.load(PAIR).view(recording=RECORDING).to_html(to),
        ["view", str(PAIR), "--recording", str(RECORDING), "--html", "TO"],
    ),
    "a picture": (
        "gaps.png", lambda to: gearpoly.load(PAIR, seed=3).plot(to, what="gaps", theta_2=radians(20.0), flank="coast"),
        ["plot", str(PAIR), "--what", "gaps", "--at", "20", "--flank", "coast", "--seed", "3", "--to", "TO"],
    ),
    "what a file holds": (
        "holds.json", lambda to: gearpoly.survey(RECORDING).to_json(to), ["read", str(RECORDING), "--json", "TO"]
    ),
    "what two files hold": (
        "holds.json", lambda to: gearpoly.survey([RECORDING, str(SAMPLE / "rec_1.csv")]).to_json(to),
        ["read", str(RECORDING), str(SAMPLE / "rec_1.csv"), "--json", "TO"],
    ),
    "a map": ("map.toml", lambda to: gearpoly.survey(RECORDING).to_map(to), ["read", str(RECORDING), "--write", "TO"]),
    "columns": ("map.png", lambda to: gearpoly.survey(RECORDING).plot(to), ["read", str(RECORDING), "--plot", "TO"]),
    "a new pair": ("pair.toml", gearpoly.new_pair, ["pair", "--new", "TO"]),
    "a mount": ("eq6.toml", lambda to: gearpoly.pair_of_mount("eq 6", to), ["pair", "--mount", "EQ6", "TO"]),
    "a sheet": (
        "pair.toml", sheet,
        ["pair", "--from", str(DATA / "sheets" / "driving.mka"), "--as", "driving", "--flank", "right", "TO"],
    ),
    "a table with a map": (
        "pair.toml",
        lambda to: gearpoly.pair_from(
            DATA / "sheets" / "driven.csv", to, which="driven", flank="left", count="clockwise",
            map=DATA / "sheets" / "driven_map.toml",
        ),
        ["pair", "--from", str(DATA / "sheets" / "driven.csv"), "--as", "driven", "--flank", "left", "--count",
         "clockwise", "--map", str(DATA / "sheets" / "driven_map.toml"), "TO"],
    ),
    "a design": (
        "pair.toml", lambda to: gearpoly.pair_from(DATA / "sheets" / "design.rexs", to),
        ["pair", "--from", str(DATA / "sheets" / "design.rexs"), "TO"],
    ),
}  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("what", ALIKE)
def test_files_are_the_commands_to_a_byte(what: str, tmp_path: Path, gearpoly_command: Command) -> None:
    name, call, options = ALIKE[what]
    ours, theirs = tmp_path / "python" / name, tmp_path / "command" / name
    ours.parent.mkdir()
    theirs.parent.mkdir()
    call(ours)
    ran = gearpoly_command(*(str(theirs) if one == "TO" else one for one in options))
    assert ran.code == 0, ran.err
    assert ours.read_bytes() == theirs.read_bytes() and ours.stat().st_size > 100


@pytest.mark.long
def test_a_new_pair_reads_its_sheet(tmp_path: Path, gearpoly_command: Command) -> None:
    made = gearpoly.new_pair(tmp_path / "pair.toml", sheet=tmp_path / "sheet.csv")
    assert [one.name for one, _ in made.files] == ["sheet.csv", "pair.toml"]
    assert gearpoly.load(tmp_path / "pair.toml").simulate(turns=0.1, fast=True).te_pp_um >= 0.0
    (tmp_path / "theirs").mkdir()
    theirs = [tmp_path / "theirs" / name for name in ("pair.toml", "sheet.csv")]
    assert gearpoly_command("pair", "--new", str(theirs[0]), "--sheet", str(theirs[1])).code == 0
    for one in theirs:
        assert one.read_bytes() == (tmp_path / one.name).read_bytes()
    with pytest.raises(gearpoly.InputFileError, match="this file exists; want a new name"):
        gearpoly.new_pair(tmp_path / "pair.toml")


@pytest.mark.long
def test_a_study_writes_what_its_commands_write(tmp_path: Path, gearpoly_command: Command) -> None:
    study = run_of_four(tmp_path)
    study.to_csv(tmp_path / "mine.csv")
    options = ("--out", str(tmp_path / "rows"), "--workers", "1", "--csv", str(tmp_path / "theirs.csv"))
    assert gearpoly_command("study", str(tmp_path / "study.toml"), *options).code == 0
    assert (tmp_path / "mine.csv").read_bytes() == (tmp_path / "theirs.csv").read_bytes()
    assert (tmp_path / "mine.csv").read_text().count("\n") == 5  # a head and four pairs
    limit = f"te_pp_um<={study.to_pandas().te_pp_um.median()}"
    judged = gearpoly.open_study(tmp_path / "rows", limits=[limit], share=0.4, confidence=0.9)
    judged.to_json(tmp_path / "mine.json")
    options = ("--limit", limit, "--share", "0.4", "--confidence", "0.9", "--json", str(tmp_path / "theirs.json"))
    assert gearpoly_command("study-report", str(tmp_path / "rows"), *options).code == 0
    assert (tmp_path / "mine.json").read_bytes() == (tmp_path / "theirs.json").read_bytes()
    assert judged.to_dict()["yields"][0]["groups"][0]["share"]["value"] == 0.5  # half lie up to the median


@pytest.mark.long
def test_a_survey_says_what_columns_were_taken_for(tmp_path: Path) -> None:
    found = gearpoly.survey(RECORDING)
    assert found.columns[0]["driven_angle_deg"] == "driven_angle_deg" and not found.refused and not found.doubts
    assert repr(found) == "<Surveyed rec_0.csv: CSV, 4608 samples, 0 doubts, to be compared as it is>"
    text = RECORDING.read_text().replace("driven_angle_deg", "Kanal 7")
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    odd = gearpoly.survey(tmp_path / "log.csv")
    assert odd.refused and "not to be compared" in repr(odd)
    assert odd.columns[0]["Kanal 7"] != "driven_angle_deg"  # as a name it says nothing; in doubt it ends in ?


@pytest.mark.long
def test_a_map_for_each_recording_is_taken(tmp_path: Path) -> None:
    """As the command's repeated --map; also beside recordings that are read already, which need none."""
    pair = gearpoly.load(PAIR)
    gearpoly.survey(RECORDING).to_map(tmp_path / "map.toml")
    files = [RECORDING, SAMPLE / "rec_1.csv"]
    read = [gearpoly.read(RECORDING)[0], files[1]]
    plain, both = pair.compare(files), pair.compare(files, map=[tmp_path / "map.toml"] * 2)
    told = [one.partition('"')[0] for one in pair.compare(read, map=tmp_path / "map.toml").comparison.remarks]
    assert both.residual_rms_um == plain.residual_rms_um and not plain.comparison.remarks
    assert len(both.comparison.remarks) == 6 and told == ["recording 1: "] * 3  # three columns of each by the map
    for given in (files, read):
        with pytest.raises(gearpoly.OutOfRangeError, match=r"^map: 3 maps for 2 recordings; want one for all of them"):
            pair.compare(given, map=[tmp_path / "map.toml"] * 3)


def test_mounts_are_listed() -> None:
    assert "EQ6" in gearpoly.mounts() and len(set(gearpoly.mounts())) == len(gearpoly.mounts()) > 10
