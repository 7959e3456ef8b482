"""Refusals of command lines that read files, of mounts, of the environment, and of places to write to."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from gearpoly.files.environment import check_environment
from gearpoly.files.output import check_folder, write_text, written_aside
from gearpoly.files.pairfile import read_pair
from gearpoly.files.samples import copy_samples
from tests.cures.cure import BASE, Cure, command, put
from tests.made_command import PAIR
from tests.test_rexs import OLD

SHEET = Path(__file__).parents[2] / "data" / "sheets" / "driven.csv"

Words = Callable[[Path], tuple[object, ...]]


def words(name: str, says: str, bad: Words, good: Words) -> Cure:
    """A command line that is refused, and one that runs; a pair file, a recording and a design are there."""

    def attempt(folder: Path, make: Words) -> None:
        put(folder, "pair.toml", PAIR)
        put(folder, "rec.csv", BASE)
        put(folder, "a.rexs", OLD)
        command(*make(folder))

    return Cure(
        name=name,
        says=says,
        bad=lambda folder: attempt(folder, bad),
        good=lambda folder, message: attempt(folder, good),
    )


def new(folder: Path, *more: object) -> tuple[object, ...]:
    return ("pair", "--new", folder / "new.toml", *more)


def _unwritable(folder: Path, name: str) -> None:
    """Write where the system does not let us; a folder that vanishes meanwhile stands for all of these."""
    (folder / "away").mkdir(exist_ok=True)
    with written_aside(folder / "away" / name) as aside:
        aside.unlink()


CURES = [
    words("no way", "want one of --new FILE", lambda f: ("pair",), new),
    words("two ways", "want one of --new FILE", lambda f: new(f, "--mount", "EQ6"), new),
    words("as of a new one", "leave it out with --new", lambda f: new(f, "--as", "driving"), new),
    words(
        "sheet of a mount",
        "leave it out with --mount",
        lambda f: ("pair", "--mount", "EQ6", f / "m.toml", "--sheet", f / "s.csv"),
        lambda f: ("pair", "--mount", "EQ6", f / "m.toml"),
    ),
    words("target of a new one", "leave it out with --new", lambda f: (*new(f)[:1], f / "x.toml", *new(f)[1:]), new),
    words(
        "from alone",
        "gearpoly pair --from FILE PAIR",
        lambda f: ("pair", "--from", f / "a.rexs"),
        lambda f: ("pair", "--from", f / "a.rexs", f / "b.toml"),
    ),
    words(
        "mount without a file",
        "want --mount EQ6 PAIR.toml",
        lambda f: ("pair", "--mount", "EQ6"),
        lambda f: ("pair", "--mount", "EQ6", f / "PAIR.toml"),
    ),
    words(
        "mount without a name",
        "want one of",
        lambda f: ("pair", "--mount"),
        lambda f: ("pair", "--mount", "HEQ5", f / "m.toml"),
    ),
    words(
        "unknown mount",
        "the nearest known are",
        lambda f: ("pair", "--mount", "EQ66", f / "m.toml"),
        lambda f: ("pair", "--mount", "EQ6", f / "m.toml"),
    ),
    words("new on standard output", "want the name of a file", lambda f: ("pair", "--new", "-"), new),
    words("new over another", "want a new name", lambda f: ("pair", "--new", f / "pair.toml"), new),
    words("no folder", "make it, or write somewhere else", lambda f: ("pair", "--new", f / "a" / "b.toml"), new),
    words(
        "a folder for a file",
        "want the name of a file",
        lambda f: ("read", f / "rec.csv", "--json", f),
        lambda f: ("read", f / "rec.csv", "--json", f / "a.json"),
    ),
    words(
        "a device",
        "want the name of a file, or -",
        lambda f: ("read", f / "rec.csv", "--json", "/dev/null"),
        lambda f: ("read", f / "rec.csv", "--json", "-"),
    ),
    words(
        "over what is read",
        "write to another file",
        lambda f: ("read", f / "rec.csv", "--json", f / "rec.csv"),
        lambda f: ("read", f / "rec.csv", "--json", f / "a.json"),
    ),
    words(
        "both to one place",
        "give each a place of its own",
        lambda f: ("read", f / "rec.csv", "--json", f / "a", "--write", f / "a"),
        lambda f: ("read", f / "rec.csv", "--json", f / "a.json", "--write", f / "a.toml"),
    ),
    words("a long word", "want at most 4096", lambda f: ("read", "x" * 5000), lambda f: ("read", f / "rec.csv")),
    words(
        "control characters",
        "rename it, or give it a link with another name",
        lambda f: ("read", "a\x1bb"),
        lambda f: ("read", f / "rec.csv"),
    ),
    words(
        "a picture of no kind",
        "want",
        lambda f: ("read", f / "rec.csv", "--plot", f / "a.xyz"),
        lambda f: ("read", f / "rec.csv", "--plot", f / "a.png"),
    ),
    Cure(
        name="environment",
        says="or unset it",
        bad=lambda folder: check_environment({"NUMBA_NUM_THREADS": "x"}),
        good=lambda folder, message: check_environment({}),
    ),
    Cure(
        name="a file for a folder",
        says="want the name of a folder",
        bad=lambda folder: (put(folder, "a", ""), check_folder(folder / "a")),
        good=lambda folder, message: check_folder(folder / "b"),
    ),
    Cure(
        name="samples there",
        says="want the name of a new folder",
        bad=copy_samples,
        good=lambda folder, message: copy_samples(folder / "new"),
    ),
    Cure(
        name="samples nowhere",
        says="make it, or write somewhere else",
        bad=lambda folder: copy_samples(folder / "a" / "b"),
        good=lambda folder, message: ((folder / "a").mkdir(), copy_samples(folder / "a" / "b")),
    ),
    Cure(
        name="what vanishes",
        says="check space and rights",
        bad=lambda folder: _unwritable(folder, "a.txt"),
        good=lambda folder, message: write_text(folder / "away" / "a.txt", ""),
    ),
    Cure(
        name="a name too long",
        says="want a shorter name",
        bad=lambda folder: write_text(folder / ("x" * 300), ""),
        good=lambda folder, message: write_text(folder / ("x" * 30), ""),
    ),
    words(
        "design as a recording",
        "want it given to gearpoly pair --from",
        lambda f: ("read", f / "a.rexs"),
        lambda f: ("pair", "--from", f / "a.rexs", f / "made.toml"),
    ),
    words(
        "sheet drawn over time",
        "leave --plot out",
        lambda f: ("read", SHEET, "--plot", f / "a.png"),
        lambda f: ("read", SHEET),
    ),
    Cure(
        name="own sheet as a recording",
        says='want it named in a pair file: sheet_csv = "own.csv" under [driving.inspection]',
        bad=lambda f: (
            command("pair", "--new", f / "own.toml", "--sheet", f / "own.csv"),
            command("read", f / "own.csv"),
        ),
        good=lambda f, message: read_pair(f / "own.toml"),
    ),
]
