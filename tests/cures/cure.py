"""A refusal and its cure, tried one after the other; and where in the code the refusal was raised."""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gearpoly.errors import InputFileError
from gearpoly.keys.sections import WormSection
from gearpoly.recording.clean import clean
from gearpoly.recording.read import read_set
from tests.made_command import commands
from tests.made_texts import own, run, table

PACKAGE = Path(__file__).parents[2] / "gearpoly"

RUN = run(700)
"""Three and a half driving turns."""

BASE = own(RUN)
HEAD, *ROWS = BASE.splitlines()
RATIO = 18.0 / 25.0

Attempt = Callable[[Path], object]


@dataclass(frozen=True, kw_only=True)
class Cure:
    """One refusal: its ``name``, a part of the message that names the cure (``says``), the ``bad`` attempt in a folder,
    and the ``good`` one in the same folder, which gets the message too."""

    name: str
    says: str
    bad: Attempt
    good: Callable[[Path, str], object]


def site(error: BaseException) -> tuple[str, int]:
    """The file within the package and the line of the statement that raised ``error``."""
    frames = [one for one in traceback.extract_tb(error.__traceback__) if Path(one.filename).is_relative_to(PACKAGE)]
    return Path(frames[-1].filename).relative_to(PACKAGE).as_posix(), frames[-1].lineno or 0


def read(
    folder: Path, name: str = "rec.csv", *, maps: bool = False, worm: WormSection | None = None, ratio: float = 0.0
) -> object:
    """What compare and diagnose do with a recording: it is read, and made ready where a ``ratio`` is given."""
    found = read_set([folder / name], [folder / "map.toml"] if maps else None, worm=worm)
    return [clean(one, ratio=ratio) if ratio else one for one in found]


def put(folder: Path, name: str, content: str | bytes) -> None:
    (folder / name.partition("#")[0]).write_bytes(content if isinstance(content, bytes) else content.encode())


def text(
    name: str,
    says: str,
    bad: str | bytes,
    good: str | bytes | None = None,
    *,
    file: str = "rec.csv",
    to: str = "",
    chart: str | None = None,
    cured: str | None = None,
    worm: WormSection | None = None,
    good_worm: WormSection | None = None,
    ratio: float = 0.0,
) -> Cure:
    """A text (and a map ``chart``) that is refused and, put right, renamed ``to`` another name, or with a ``cured``
    map, read."""

    def attempt(folder: Path, content: str | bytes, name: str, lines: str | None, worm: WormSection | None) -> object:
        put(folder, name, content)
        if lines is not None:
            put(folder, "map.toml", lines)
        return read(folder, name, maps=lines is not None, worm=worm, ratio=ratio)

    return Cure(
        name=name,
        says=says,
        bad=lambda folder: attempt(folder, bad, file, chart, worm),
        good=lambda folder, message: attempt(
            folder,
            bad if good is None else good,
            to or file,
            chart if cured is None else cured or None,
            good_worm or worm,
        ),
    )


def by_its_lines(name: str, says: str, content: str, *, file: str = "log.txt") -> Cure:
    """A text that wants a map: the lines that the messages name, one after the other, are that map."""

    def good(folder: Path, message: str) -> None:
        lines: list[str] = []
        while message:
            found = re.search(r"(columns\.\S+ = \{[^}]*\}|text\.\S+ = \"[^\"]*\")", message)
            assert found is not None and found[0] not in lines, message
            lines.append(found[0])
            put(folder, "map.toml", "\n".join(lines))
            try:
                read(folder, file, maps=True)
                message = ""
            except InputFileError as error:
                message = str(error)

    return Cure(name=name, says=says, bad=lambda folder: (put(folder, file, content), read(folder, file)), good=good)


def rows(*lines: str, head: str = HEAD) -> str:
    """A CSV with a header."""
    return "\n".join([head, *lines]) + "\n"


def with_columns(**columns: Any) -> str:
    """The usual run with columns changed, added, or taken out where they are None."""
    held: Mapping[str, Any] = {**RUN, **columns}
    return own({name: values for name, values in held.items() if values is not None})


def foreign(names: tuple[str, ...], *, decimal: str = ",", **how: Any) -> str:
    """The usual run under other names."""
    return table(list(RUN.values())[: len(names)], names, decimal=decimal, **how)


def command(*words: object) -> None:
    """The command line, in this process; what it refuses is raised."""
    from gearpoly.files.environment import check_arguments

    check_arguments([str(one) for one in words])
    commands()([str(one) for one in words], standalone_mode=False)


def own_run(**how: Any) -> str:
    """The contract's CSV of another run."""
    return own(run(**how))


def one_of_two(name: str, column: str, numbers: tuple[int, int], write: Callable[[Path], object], file: str) -> Cure:
    """A file that has a ``column`` twice, as its columns of these ``numbers``: the line that the message names takes
    one of them, by its full name and by its number."""

    def bad(folder: Path) -> None:
        write(folder / file)
        read(folder, file)

    def good(folder: Path, message: str) -> None:
        found = re.search(r"columns\.\S+ = \{[^}]*\}", message)
        assert found is not None and f'"{column} (column {numbers[0]})"' in found[0], message
        put(folder, "map.toml", found[0])
        read(folder, file, maps=True)
        for number in numbers:
            put(folder, "map.toml", found[0].replace(f"{column} (column {numbers[0]})", f"column {number}"))
            read(folder, file, maps=True)
        put(folder, "map.toml", f'leave_out = ["column {numbers[0]}"]')
        read(folder, file, maps=True)

    says = f'"{column}" is the name of columns {numbers[0]} and {numbers[1]}'
    return Cure(name=f"column twice, {name}", says=says, bad=bad, good=good)
