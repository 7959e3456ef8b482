"""What diagnoses and plans give from Python."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearpoly import arguments
from gearpoly.api.results import samples_of
from gearpoly.api.tables import data_frame
from gearpoly.diagnose.plan import Plan
from gearpoly.diagnose.verdict import Diagnosis, Finding, Status
from gearpoly.errors import shown
from gearpoly.files.output import write_text
from gearpoly.files.pairfile import dump_pair, moved
from gearpoly.units import UM

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame


@dataclass(frozen=True, kw_only=True, eq=False)
class Diagnosed:
    """What ``gearpoly diagnose`` finds in recordings of the pair file ``source``. ``diagnosis`` has the rest, in mm and
    rad."""

    source: str
    diagnosis: Diagnosis

    def __repr__(self) -> str:
        named = ", ".join(one.claim.physics.name for one in self.missing) or "nothing named"
        figures = f"unseen {self.before_um:.3g} um rms before, {self.after_um:.3g} um after"
        return f"<Diagnosed {shown(self.source)}: {self.status}, {named}, {figures}, noise {self.noise_um:.3g} um>"

    @property
    def status(self) -> Status:
        """``"nothing_missing"``, ``"explained"``, ``"partly_explained"`` or ``"unexplained"``."""
        return self.diagnosis.status

    @property
    def missing(self) -> tuple[Finding, ...]:
        """The physics that the simulation left out, most important first; each has ``says``, ``probability`` and
        ``parameters`` (value and standard error by name)."""
        return self.diagnosis.findings

    @property
    def says(self) -> tuple[str, ...]:
        """One sentence for each of them."""
        return tuple(one.says for one in self.missing)

    @property
    def noise_um(self) -> float:
        """Rms in um of what does not repeat."""
        return self.diagnosis.noise / UM

    @property
    def before_um(self) -> float:
        """Rms in um that the declared simulation leaves of data that the fit did not see."""
        return self.diagnosis.before.unseen / UM

    @property
    def after_um(self) -> float:
        """The same with everything that was named."""
        return self.diagnosis.after.unseen / UM

    @cached_property
    def verdict(self) -> Mapping[str, Any]:
        """The verdict with the keys of its JSON."""
        return self.to_dict()

    def plot(self, target: Path | str | None = None, *, recording: int = 0) -> Figure:
        """Transmission error recorded and simulated, before and after, of one ``recording``; written to ``target`` if
        given. Raises ``OutOfRangeError`` for the number of no recording; they count from 0."""
        arguments.Count(least=0, most=len(self.diagnosis.comparison.aligned) - 1).check("recording", recording)
        from gearpoly.report.diagnosis_data import recording_label
        from gearpoly.report.diagnosis_figures import curves_figure
        from gearpoly.report.plots import saved

        one = self.diagnosis.comparison.aligned[recording]
        return saved(curves_figure(one, self.diagnosis.left[recording], title=recording_label(recording, one)), target)

    def to_dict(self) -> dict[str, Any]:
        """What ``gearpoly diagnose --json`` writes."""
        from gearpoly.report.diagnosis_report import verdict_json

        return verdict_json(self.diagnosis)

    def to_json(self, target: Path | str) -> None:
        """Write the verdict."""
        from gearpoly.report.diagnosis_report import json_text

        write_text(target, json_text(self.diagnosis))

    def to_html(self, target: Path | str) -> None:
        """Write the page that opens without a network."""
        from gearpoly.report.diagnosis_page import page

        write_text(target, page(self.diagnosis))

    def to_pdf(self, target: Path | str) -> None:
        """Write the report for paper, A4. Raises ``MissingExtraError`` where reportlab is not installed."""
        from gearpoly.report.diagnosis_pdf import write_pdf

        write_pdf(self.diagnosis, Path(target))

    def to_figures(self, folder: Path | str, *, ending: str = ".svg") -> list[Path]:
        """Write every picture into ``folder`` as .svg, .png or .pdf; returns the files."""
        from gearpoly.report.diagnosis_figures import write_figures
        from gearpoly.report.plots import FORMATS

        arguments.check_choice("ending", ending, FORMATS)
        return write_figures(self.diagnosis, Path(folder), ending=ending)

    def to_fitted(self, target: Path | str) -> None:
        """Write the pair file with what was missing in it."""
        write_text(target, dump_pair(moved(self.diagnosis.fitted, source=Path(self.source), target=Path(target))))

    def to_pandas(self) -> DataFrame:
        """A row per sample, as :meth:`Compared.to_pandas` has it, with what everything named leaves as residual."""
        return samples_of(self.diagnosis.comparison, self.diagnosis.left)


@dataclass(frozen=True, kw_only=True, eq=False)
class Planned:
    """Which recordings would tell the look-alikes of a pair apart: what ``gearpoly plan`` finds."""

    plan: Plan

    def __repr__(self) -> str:
        more = f"{len(self.plan.further)} more recordings, {len(self.plan.look_alikes)} look-alikes"
        return f"<Planned: {self.says[0].rstrip('.')}; {more}>"

    @property
    def says(self) -> tuple[str, ...]:
        """What to record, the most useful first."""
        return tuple(one.says for one in (self.plan.first, *self.plan.further))

    def plot(self, target: Path | str | None = None) -> Figure:
        """What each recording tells apart and shows; written to ``target`` if given."""
        from gearpoly.report.plan_plots import plan_figure
        from gearpoly.report.plots import saved

        return saved(plan_figure(self.plan), target)

    def to_dict(self) -> dict[str, Any]:
        """What ``gearpoly plan --json`` writes."""
        from gearpoly.report.plan_report import json_text

        document: dict[str, Any] = json.loads(json_text(self.plan))
        return document

    def to_json(self, target: Path | str) -> None:
        """Write the same."""
        from gearpoly.report.plan_report import json_text

        write_text(target, json_text(self.plan))

    def to_pandas(self) -> DataFrame:
        """A row per two physics, a column per number of recordings: the sine of the angle between them, none as long as
        either is not seen."""
        alikes = self.plan.look_alikes
        sines = [(one.first, *one.after) for one in alikes]
        columns: dict[str, Any] = {"one": [one.one for one in alikes], "other": [one.other for one in alikes]}
        for k in range(1 + len(self.plan.further)):
            columns[f"with_{k + 1}"] = [row[k] for row in sines]
        return data_frame(columns)
