"""Every command of the docs runs as it stands, and says which files it wrote; those of one block run in order."""

from __future__ import annotations

import glob
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer.main

from gearpoly.cli import app
from tests.made_command import Command

ROOT = Path(__file__).resolve().parents[1]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "data").rglob("README.md")),
]

PARSED = {
    "gearpoly prove": "a proving ground takes minutes to hours; tests of its own run small ones",
    "gearpoly study data/studies/grades.toml": "1500 pairs; tests of studies run small ones",
    "gearpoly study-report out/grades": "reads what the study above has made",
    "gearpoly study data/studies/tolerance.toml": "wants a cluster; tests of studies start one",
    "gearpoly examples": "the data are here; tests of their own copy them",
    "python -m benchmarks": "minutes of measuring",
    "python -m gearpoly.prove.page": "wants scoreboards of finished runs; tests of the page make some",
    "python -m gearpoly.studies.paper": "ten minutes; its questions have tests of their own",
    "python -m tests.oracles.fem_tooth": "minutes of finite elements; the oracle is run by tests of its own",
    "python -m gearpoly.proving.samples": "tests of the samples make them again",
    "python examples/": "tests of the examples and of the stories run them",
    "make": "this suite and set-ups",
    "pip install": "changes the environment",
    "pytest": "tests are run by themselves",
    "python -m gearpoly.physics.page": "writes into the docs; a test compares",
}
"""Commands, by how they begin, of which only the words are checked, and why."""

SLOW = (
    "gearpoly diagnose",
    "gearpoly plan",
    "gearpoly pair --new",
    "gearpoly view data/recordings",
    "gearpoly study data/studies/robot_joint.toml",
    "gearpoly simulate data/recordings",
    "gearpoly compare data/recordings/unknown",
    "gearpoly compare data/recordings/eccentric_low_tooth",
    "gearpoly export data/pairs/graded_18_25.toml --to pair.svg",
)
"""Commands, by how they begin, that take longer than a few seconds, and others of their blocks: their words are checked
at once."""

BEGINS = re.compile(r"(gearpoly|python|make|pip|pytest) [\w.-]")


def code(page: Path) -> list[tuple[str, list[str]]]:
    """All fenced and indented blocks of a page: language, lines."""
    blocks: list[tuple[str, list[str]]] = []
    fence: str | None = None
    indented = False
    for line in page.read_text(encoding="utf-8").splitlines():
        if line.strip().startswith("```"):  # in a list it stands further in
            fence = line.strip()[3:].strip() if fence is None else None
            if fence is not None:
                blocks.append((fence, []))
        elif fence is not None:
            blocks[-1][1].append(line)
        elif line.startswith("    "):
            if not indented:
                blocks.append(("", []))
            blocks[-1][1].append(line[4:])
        indented = fence is None and line.startswith("    ")
    return blocks


def blocks() -> list[list[str]]:
    """Commands without comments, in groups that run in order: those of a block of code, each one of a text."""
    found = []
    for page in PAGES:
        for language, lines in code(page):
            if language in ("", "sh", "console"):
                found.append([line.partition(" #")[0].strip() for line in lines if BEGINS.match(line.strip())])
        # In a line of text, those that name a file of this repository or a module.
        text = page.read_text(encoding="utf-8")
        loose = re.findall(
            r"`((?:gearpoly \S+ data/|python -m |python examples/|pip install (?:-e |\")|pytest )[^`\n]*)`", text
        )
        found += [[one] for one in loose]
    return [list(block) for block in dict.fromkeys(map(tuple, found)) if block]


def commands() -> list[str]:
    """Every command once."""
    return list(dict.fromkeys(one for block in blocks() for one in block))


def begins(command: str, heads: object) -> bool:
    return any(command.startswith(str(head)) for head in heads)  # type: ignore[attr-defined]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which paths of the documentation lead where they do in the repository, and results stay apart."""
    for name in ("data", "examples"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def words(command: str) -> list[str]:
    """A command's words as a shell would hand them over."""
    return [one for word in shlex.split(command) for one in (sorted(glob.glob(word)) if "*" in word else [word])]


def files(folder: Path) -> set[Path]:
    return {path.relative_to(folder) for path in folder.rglob("*") if path.is_file()}


def runs(command: str) -> bool:
    return command.startswith("gearpoly ") and not begins(command, PARSED)


RUN = [block for block in ([one for one in block if runs(one)] for block in blocks()) if block]


@pytest.mark.long
@pytest.mark.parametrize(
    "block",
    [
        pytest.param(one, marks=pytest.mark.slow if any(begins(part, SLOW) for part in one) else (), id="; ".join(one))
        for one in RUN
    ],
)
def test_documented_commands_run_and_say_what_they_wrote(
    block: list[str], here: Path, gearpoly_command: Command
) -> None:
    told: set[Path] = set()
    for command in block:
        ran = gearpoly_command(*words(command)[1:])
        assert ran.code == 0, f"{command}: {ran.err}"
        written = [line for line in ran.err.splitlines() if line.startswith("wrote ")]
        told |= {Path(line.removeprefix("wrote ").partition(": ")[0]) for line in written}
        there = files(here)
        # A folder is told once, whatever is in it.
        assert {one for one in told if not (here / one).is_dir()} <= there, command
        assert all(one in told or told & set(one.parents) for one in there), command


@pytest.mark.parametrize("command", [one for one in commands() if not runs(one) or begins(one, SLOW)])
def test_a_documented_command_that_is_long_has_the_right_words(command: str, here: Path) -> None:
    given = words(command)
    if given[0] == "gearpoly":
        group = typer.main.get_command(app)
        group.commands[given[1]].make_context(given[1], given[2:])  # type: ignore[attr-defined]
    elif given[0] == "make":
        targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
        assert given[1] in targets
    elif given[:2] == ["python", "-m"]:
        if given[2] == "gearpoly":
            return  # below
        path = ROOT.joinpath(*given[2].split("."))
        assert path.with_suffix(".py").is_file() or (path / "__main__.py").is_file()
    elif given[0] == "python":
        assert (ROOT / given[1]).is_file()
    elif given[0] == "pytest":
        named = [one for one in given[1:] if one.endswith(".py")]
        assert named and all((ROOT / one).is_file() for one in named)
    else:
        assert given[:2] == ["pip", "install"]
        of_a_clone = given[2] == "-e"
        what, _, extra = given[3 if of_a_clone else 2].rstrip("]").partition("[")
        assert what == ("." if of_a_clone else "gearpoly")
        assert re.search(rf"^{extra} = \[", (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)


@pytest.mark.long
def test_how_tos_run_one_after_another_in_the_same_folder(here: Path, gearpoly_command: Command) -> None:
    """A pair file that another how-to wrote is refused or added to. What takes long is of no pair file of its own."""
    for page in sorted((ROOT / "docs" / "howto").glob("*.md")):
        made = [line.partition(" #")[0].strip() for _, lines in code(page) for line in lines]
        for command in made:
            if re.match(r"gearpoly (pair|read|simulate [a-z]+\.toml)", command):
                ran = gearpoly_command(*words(command)[1:])
                assert ran.code == 0, f"{page.name}: {command}: {ran.err}"
    assert len(list(here.glob("*.toml"))) > 3  # they were run


def test_no_documented_command_has_a_placeholder() -> None:
    for command in commands():
        assert not re.search(r"\b[A-Z]{3,}\b|\[-|\.\.\.", command), command


def test_every_reason_for_not_running_is_still_needed() -> None:
    for head in PARSED:
        assert any(command.startswith(head) for command in commands()), head


def test_the_module_is_the_command() -> None:
    ran = subprocess.run(
        [sys.executable, "-m", "gearpoly", "--version"], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert ran.returncode == 0 and ran.stdout.startswith("gearpoly ")


PYTHON = [(page, "\n".join(lines)) for page in PAGES for language, lines in code(page) if language == "python"]


@pytest.mark.long
@pytest.mark.parametrize(("page", "text"), PYTHON, ids=[page.name for page, _ in PYTHON])
def test_documented_python_runs(page: Path, text: str, here: Path) -> None:
    exec(compile(text, str(page), "exec"), {})


def test_what_make_run_shows_is_in_the_readme(here: Path) -> None:
    """The end of `make run` reads the verdict's JSON: names, unseen data before and after."""
    verdict = here / "verdict.json"
    verdict.write_text(
        '{"missing": [{"says": "The driven gear runs 9.0 um off its axis."}], "noise_um": 0.301,'
        ' "fit": {"heldout_rms_um": {"before": 6.7024, "after": 0.3032}}}',
        encoding="utf-8",
    )
    ran = subprocess.run(
        [sys.executable, str(ROOT / "examples" / "first_run.py"), str(verdict), "out/page.html"],
        capture_output=True, text=True, check=False, env=os.environ | {"PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    *told, look, page = ran.stdout.splitlines()
    assert all(line in readme for line in told)
    assert (look, page.strip()) == ("Look at:", "out/page.html")
