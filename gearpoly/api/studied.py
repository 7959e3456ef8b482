"""Studies of many pairs from Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearpoly import arguments
from gearpoly.api.tables import data_frame
from gearpoly.api.words import told_in_python
from gearpoly.errors import OutOfRangeError, shown_value
from gearpoly.files.output import write_text
from gearpoly.study.answers import Answers, answer
from gearpoly.study.answers_json import answers_json, json_text
from gearpoly.study.limits import parse_limits
from gearpoly.study.models import OutputLimit

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame


@dataclass(frozen=True, kw_only=True, eq=False)
class Studied:
    """The table of a study in ``folder`` and what it answers; ``limits`` instead of the study's own."""

    folder: Path
    limits: tuple[OutputLimit, ...] | None = None
    confidence: float = 0.95

    @cached_property
    def answers(self) -> Answers:
        """Percentiles with intervals, yields, sensitivity."""
        return answer(self.folder, limits=self.limits, confidence=self.confidence)

    @property
    def pairs(self) -> int:
        """Number of pairs in the table."""
        return self.answers.pairs

    def to_dict(self) -> Mapping[str, Any]:
        """What ``gearpoly study-report --json`` writes."""
        return answers_json(self.answers)

    def to_json(self, target: Path | str) -> None:
        """Write the same."""
        write_text(target, json_text(self.answers))

    def to_csv(self, target: Path | str) -> None:
        """Write the whole table, as ``gearpoly study --csv`` does."""
        arguments.check_file("target", target)
        self.answers.store.to_csv(Path(target))

    def to_html(self, target: Path | str) -> None:
        """Write the answers as one page."""
        from gearpoly.study.page import write_page

        write_page(self.answers, Path(target))

    def plot(self, target: Path | str | None = None, *, what: str = "outputs_1") -> Figure:
        """One picture of the report, written to ``target`` if given: ``outputs_1``, distributions of the first six
        outputs (``outputs_2`` of the next), ``yield``, ``sensitivity`` or ``points``.

        Raises ``OutOfRangeError`` for one that this study has not.
        """
        from gearpoly.report.plots import saved
        from gearpoly.study.pictures import pictures

        found = {one.name: one.figure() for one in pictures(self.answers)}
        if what not in tuple(found):
            raise OutOfRangeError(f"no picture {shown_value(what)}; want one of {', '.join(found) or 'none yet'}")
        return saved(found[what], target)

    def to_pandas(self) -> DataFrame:
        """A row per pair: its number, seed, status, swept keys and outputs."""
        store = self.answers.store
        return data_frame(store.columns(store.schema.names))


@told_in_python()
def run_study(path: Path | str, folder: Path | str, *, workers: int = 1, scheduler: str | None = None) -> Studied:
    """Draw and sweep the pairs of a study file into ``folder``, as ``gearpoly study`` does; what is there already is
    gone on with. ``scheduler`` is the address of a Dask cluster. Raises ``InputFileError`` as the command does."""
    arguments.check_file("path", path)
    arguments.check_file("folder", folder)
    arguments.WORKERS.check("workers", workers)
    if scheduler is not None and workers != 1:
        raise OutOfRangeError(f"workers {workers}: the scheduler brings its own workers; leave workers out")
    from gearpoly.study.read import read_study
    from gearpoly.study.run import run_study as run

    run(read_study(path), out=Path(folder), workers=workers, scheduler=scheduler)
    return Studied(folder=Path(folder))


@told_in_python()
def open_study(
    folder: Path | str, *, limits: Sequence[str] = (), share: float = 0.99, confidence: float = 0.95
) -> Studied:
    """The table that a study left in ``folder``, finished or not, read as ``gearpoly study-report`` reads it.

    ``limits`` such as ``"te_pp_um<=12"`` stand instead of the study's own, each to be kept by a ``share`` of the pairs;
    ``confidence`` is that of all intervals. Raises ``OutOfRangeError`` for a limit that is none.
    """
    arguments.check_file("folder", folder)
    arguments.SHARE_OF_PAIRS.check("share", share)
    arguments.CONFIDENCE.check("confidence", confidence)
    texts = [limits] if isinstance(limits, str) else list(limits)
    found = parse_limits(texts, share=share, folder=Path(folder))
    return Studied(folder=Path(folder), limits=None if found is None else tuple(found), confidence=confidence)
