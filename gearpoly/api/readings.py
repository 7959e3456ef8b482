"""Recordings from Python: read to be compared, or surveyed before anything is computed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearpoly import arguments
from gearpoly.api.given import Recorded, each_of
from gearpoly.api.words import told_in_python
from gearpoly.errors import InputFileError, OutOfRangeError, shown, shown_value
from gearpoly.files.inspection.heads_of_sheets import is_sheet
from gearpoly.files.output import check_target, write_text
from gearpoly.keys.sections import WormSection
from gearpoly.recording.map_file import read_map
from gearpoly.recording.map_text import check_one_file, map_text
from gearpoly.recording.read import read_recording, read_set
from gearpoly.recording.recording import Recording
from gearpoly.recording.survey import Survey
from gearpoly.recording.survey import survey as survey_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Maps = Path | str | Sequence[Path | str] | None
"""How columns are to be read: a map for all recordings, or one for each in order."""


@told_in_python()
def read(path: Path | str, *, map: Path | str | None = None, worm: WormSection | None = None) -> list[Recording]:
    """All recordings of one file, in any format that ``gearpoly read`` knows; ``map`` says what its columns are, and
    ``worm`` turns the error of a telescope's axis into the pair's. Raises ``InputFileError``."""
    arguments.check_file("path", path)
    if map is not None:
        arguments.check_file("map", map)
    return read_set([Path(path)], None if map is None else [Path(map)], worm=worm)


def read_each(recordings: Recorded, *, map: Maps, worm: WormSection | None) -> list[Recording]:
    """The ``recordings`` that a caller gave, files read by the ``map`` of all or each.

    Raises ``InputFileError`` as the command does, ``OutOfRangeError`` where numbers of maps and recordings differ.
    """
    given = each_of(recordings)
    maps = _paths("map", [] if map is None else map)
    files = [Path(one) for one in given if not isinstance(one, Recording)]
    if len(files) == len(given):
        return read_set(files, maps, worm=worm)
    if len(maps) not in (0, 1, len(given)):
        wish = "want one for all of them, or one for each in order"
        raise OutOfRangeError(f"map: {len(maps)} maps for {len(given)} recordings; {wish}")
    each = maps if len(maps) == len(given) else [*maps, None][:1] * len(given)
    out: list[Recording] = []
    for one, chart in zip(given, each, strict=True):
        out += [one] if isinstance(one, Recording) else read(one, map=chart, worm=worm)
    return out


def read_one(recording: object, *, map: Path | str | None, worm: WormSection | None) -> Recording:
    """The one ``recording`` that a caller gave, a file read by its ``map``. Raises ``InputFileError`` where it holds
    several."""
    if isinstance(recording, Recording):
        return recording
    arguments.check_file("recording", recording)
    if map is not None:
        arguments.check_file("map", map)
    return read_recording(Path(str(recording)), worm=worm, chart=None if map is None else read_map(Path(map)))


def _paths(name: str, given: object) -> list[Path]:
    """One path or several as a list; raises ``OutOfRangeError`` for what is none."""
    if isinstance(given, str | Path) or not isinstance(given, Iterable):
        given = [given]
    paths = list(given)
    for one in paths:
        arguments.check_file(name, one)
    return [Path(one) for one in paths]


@dataclass(frozen=True, kw_only=True, eq=False)
class Surveyed:
    """What recordings' files hold and what each column was taken for: what ``gearpoly read`` shows. ``surveys`` has the
    rest, one of each recording."""

    surveys: tuple[Survey, ...]

    def __repr__(self) -> str:
        first = self.surveys[0]
        more = "" if len(self.surveys) == 1 else f" and {len(self.surveys) - 1} more"
        fit = "to be compared as it is" if not self.refused else "not to be compared as it is"
        return (
            f"<Surveyed {shown(first.file.name)}{more}: {first.format}, {first.rows} samples, "
            f"{len(self.doubts)} doubts, {fit}>"
        )

    @property
    def columns(self) -> tuple[Mapping[str, str], ...]:
        """Of each recording the names in its file with the column that each was taken for; in doubt ends in ``?``."""
        return tuple(
            {one.name: one.column if one.sure or not one.column else f"{one.column}?" for one in found.channels}
            for found in self.surveys
        )

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is in doubt, in words."""
        return tuple(doubt.says for found in self.surveys for doubt in found.doubts)

    @property
    def refused(self) -> tuple[str, ...]:
        """What a comparison would say of recordings that it does not take; empty where it takes all."""
        return tuple(found.refusal for found in self.surveys if found.refusal)

    def plot(self, target: Path | str | None = None) -> Figure:
        """Every column over time, gaps, stops and turns marked; written to ``target`` if given."""
        from gearpoly.report.plots import saved
        from gearpoly.report.reading_plots import surveys_figure

        return saved(surveys_figure(self.surveys), target)

    def to_dict(self) -> dict[str, Any]:
        """What ``gearpoly read --json`` writes."""
        from gearpoly.report.reading_report import surveys_json

        return surveys_json(self.surveys)

    def to_json(self, target: Path | str) -> None:
        """Write the same."""
        from gearpoly.report.reading_report import json_text

        write_text(target, json_text(self.surveys))

    @told_in_python()
    def to_map(self, target: Path | str) -> None:
        """Write the map that makes one file certain, what is in doubt behind a #. Raises ``OutOfRangeError`` for
        several files."""
        arguments.check_file("target", target)
        check_one_file(target, files=len({found.file for found in self.surveys}))
        check_target(Path(target))
        write_text(target, map_text(self.surveys[0]))


@told_in_python()
def survey(files: Path | str | Sequence[Path | str], *, map: Path | str | None = None) -> Surveyed:
    """What files hold, as ``gearpoly read`` shows it; read by a ``map`` to see what that makes of them.

    Raises ``InputFileError`` only where a file cannot be read at all, or is an inspection sheet.
    """
    paths = _paths("files", files)
    if not paths:
        raise OutOfRangeError(f"files {shown_value(files)}: want the path of a recording, or a list of them")
    for path in paths:
        if is_sheet(path):
            raise InputFileError(path, wish="an inspection sheet, no recording; pair_from(source) reads it")
    if map is not None:
        arguments.check_file("map", map)
    chart = None if map is None else read_map(Path(map))
    return Surveyed(surveys=tuple(one for path in paths for one in survey_file(path, chart)))
