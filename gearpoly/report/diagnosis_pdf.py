"""A diagnosis as a report for paper: A4, words and tables first, then the pictures; one file to hand on."""

from __future__ import annotations

import io
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from gearpoly import __version__
from gearpoly.compare.entries import Entry
from gearpoly.compare.on_sky import Sky, sky_of
from gearpoly.diagnose.heldout import Rms, repeatable
from gearpoly.diagnose.verdict import Diagnosis, Finding
from gearpoly.errors import MissingExtraError
from gearpoly.files.output import written_aside
from gearpoly.page.typeset import typeset
from gearpoly.report.alike import together
from gearpoly.report.compare_report import entry_words
from gearpoly.report.diagnosis_figures import PAPER_WIDTH, figures
from gearpoly.report.diagnosis_report import grade_words, how_sure, sentence
from gearpoly.report.diagnosis_tables import parted
from gearpoly.report.diagnosis_words import capital, number, parameter
from gearpoly.units import NM, RPM, UM

MARGIN = 16.0
"""mm on each side."""

DOTS = 150
"""Dots per inch of the pictures: lines are sharp at arm's length, at 0.2 MB a page."""

FONT = "DejaVu"
"""Drawn from the fonts that matplotlib brings: it has the minus sign, mu, and the letters of most names."""


def check_extra() -> None:
    """Raise ``MissingExtraError`` where reportlab is not installed, before long work is done for a report."""
    _lab("platypus")


def write_pdf(diagnosis: Diagnosis, target: Path) -> None:
    """Write the report to ``target``, whole or not at all.

    Raises ``MissingExtraError`` where reportlab is not installed, and ``InputFileError`` where it cannot be written.
    """
    platypus = _lab("platypus")
    mm = _lab("lib.units").mm
    page = _lab("lib.pagesizes").A4
    with written_aside(target) as aside:
        document = platypus.SimpleDocTemplate(
            str(aside), pagesize=page, leftMargin=MARGIN * mm, rightMargin=MARGIN * mm, topMargin=MARGIN * mm,
            bottomMargin=1.2 * MARGIN * mm, title=f"{diagnosis.comparison.name}: diagnosis", author="gearpoly",
            invariant=1,
        )  # fmt: skip
        foot = f"{diagnosis.comparison.name}    gearpoly {__version__}"

        def number_page(canvas: Any, made: Any) -> None:
            canvas.setFont(FONT, 7.5)
            canvas.drawString(MARGIN * mm, 0.6 * MARGIN * mm, foot[:110])
            canvas.drawRightString(page[0] - MARGIN * mm, 0.6 * MARGIN * mm, f"page {made.page}")

        document.build(_Report(diagnosis).story(), onFirstPage=number_page, onLaterPages=number_page)


def _lab(module: str) -> Any:
    try:
        return import_module(f"reportlab.{module}")
    except ImportError:
        raise MissingExtraError("a report as PDF needs reportlab: pip install 'gearpoly[pdf]'") from None


class _Report:
    """The parts of the report in their order, in one set of styles."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        self.diagnosis = diagnosis
        self.platypus = _lab("platypus")
        self.colors = _lab("lib.colors")
        style = _lab("lib.styles").ParagraphStyle
        _fonts()
        self.text = style("text", fontName=FONT, fontSize=9, leading=12.5, spaceAfter=3)
        self.small = style(
            "small", parent=self.text, fontSize=7.5, leading=10, textColor=self.colors.HexColor("#444444")
        )
        self.head = style("head", parent=self.text, fontName=f"{FONT}-Bold", fontSize=11.5, leading=15, spaceBefore=9)
        self.title = style("title", parent=self.head, fontSize=16, leading=20, spaceBefore=0)

    def story(self) -> list[Any]:
        """Everything, from the verdict to the last picture."""
        return [
            *self._verdict(),
            *self._findings(),
            *self._places(),
            *self._gears(),
            *self._limits(),
            *self._pictures(),
        ]

    def _said(self, words: str, style: Any = None) -> Any:
        return self.platypus.Paragraph(escape(typeset(words)), style or self.text)

    def _table(self, rows: Sequence[Sequence[str]], widths: Sequence[float] | None = None) -> Any:
        mm = _lab("lib.units").mm
        cells = [[self._said(cell, self.small if k else self.text) for cell in row] for k, row in enumerate(rows)]
        table = self.platypus.Table(
            cells, hAlign="LEFT", repeatRows=1, colWidths=None if widths is None else [one * mm for one in widths]
        )
        line = self.colors.HexColor("#bbbbbb")
        table.setStyle([("LINEBELOW", (0, 0), (-1, -1), 0.4, line), ("VALIGN", (0, 0), (-1, -1), "TOP")])
        return table

    def _verdict(self) -> list[Any]:
        diagnosis = self.diagnosis
        pair = diagnosis.comparison.assembled.pair
        z_1, z_2 = pair.driving.gear.z, pair.driven.gear.z
        out = [
            self._said(diagnosis.comparison.name, self.title),
            self._said(f"{z_1} teeth drive {z_2}, module {pair.driving.gear.m:g} mm"),
            self._said(sentence(diagnosis), self.head),
        ]
        out += [self._said(f"{k}. {one.says}") for k, one in enumerate(diagnosis.findings, 1)]
        rows = [("on data that the fit never saw", "rms µm", "repeatable µm", "rms / noise")]
        for words, rms in (
            ("declared simulation", diagnosis.before),
            ("with as-built teeth", diagnosis.as_built_only),
            ("with what was missing", diagnosis.after),
        ):
            rows.append((words, *self._rms(rms)))
        out += [self.platypus.Spacer(1, 6), self._table(rows, (70, 30, 35, 40))]
        noise = number(diagnosis.noise / UM, 3)
        out.append(self._said(f"Noise {noise} um rms. Unseen by the fit: {diagnosis.held_out_by}.", self.small))
        return out

    def _rms(self, rms: Rms) -> tuple[str, str, str]:
        noise = self.diagnosis.noise
        rest = repeatable(rms.unseen, noise)
        return number(rms.unseen / UM, 3), number(rest / UM, 3), number(rms.unseen / noise if noise else None, 2)

    def _findings(self) -> list[Any]:
        out = []
        for k, one in enumerate(self.diagnosis.findings, 1):
            part = [self._said(f"{k}. {one.says}", self.head), *self._finding(one)]
            out.append(self.platypus.KeepTogether(part))
        return out

    def _finding(self, one: Finding) -> list[Any]:
        values = [parameter(name, *pair) for name, pair in one.parameters.items()]
        rows = [("value", "with its standard error"), *values]
        out = [self._said(f"Model: {one.claim.physics.equation}"), self._table(rows, (50, 60))]
        out.append(self._said(f"How sure: {how_sure(one)}."))
        before, after = (self._rms(rms)[1] for rms in (one.without, one.with_))
        out.append(self._said(f"Repeatable mismatch on unseen data: {before} um without it, {after} um with it."))
        out += [self._said(f"Or else: {rival.says}") for rival in one.rivals]
        if one.separation is not None:
            out.append(self._said(f"To decide: {one.separation.recording.says}"))
        return out

    def _places(self) -> list[Any]:
        comparison = self.diagnosis.comparison
        sky = sky_of(comparison)
        out = [self._said("Where recordings and declared simulation differ", self.head)]
        entries = comparison.located.where
        out += self._listed(entries, sky) or [
            self._said("Nothing beyond noise, and beyond what inspection or grade leave open of each tooth.")
        ]
        if self.diagnosis.unexplained:
            out.append(self._said("Located, and not explained", self.head))
            out += self._listed(self.diagnosis.unexplained, sky)
        return out

    def _listed(self, entries: Sequence[Entry], sky: Sky | None) -> list[Any]:
        shown, folded = parted(entries)
        out = [self._said(f"• {capital(entry_words(entry, sky))}") for entry in shown]
        if folded:
            out.append(self._said(f"And {len(folded)} more, which are weaker or come along with these.", self.small))
        return out

    def _gears(self) -> list[Any]:
        comparison = self.diagnosis.comparison
        out = [self._said("Gears and recordings", self.head)]
        for name, gear in zip(("driving", "driven"), self.diagnosis.built, strict=True):
            out.append(self._said(f"The {name} gear {grade_words(gear)}."))
        rows = [("recording", "flank", "torque N·m", "speed rpm", "samples", "noise µm")]
        for k, (one, noise) in enumerate(zip(comparison.aligned, self.diagnosis.noise_by_recording, strict=True)):
            speed = None if one.speed is None else one.speed / RPM
            rows.append(
                (f"{k}: {one.cleaned.recording.source.name}", one.flank, f"{one.torque / NM:g}", number(speed, 1),
                 str(one.cleaned.size), number(noise / UM, 3))
            )  # fmt: skip
        return [*out, self._table(rows, (60, 22, 26, 24, 22, 22))]

    def _limits(self) -> list[Any]:
        out = [self._said("What could not be excluded", self.head)]
        out += [self._said(f"• {words}") for words in self.diagnosis.not_excluded] or [
            self._said("These recordings could have shown all of the catalogue.")
        ]
        if self.diagnosis.remarks:
            out.append(self._said("Remarks", self.head))
            out += [self._said(f"• {words}", self.small) for words in together(self.diagnosis.remarks)]
        return out

    def _pictures(self) -> list[Any]:
        inch = _lab("lib.units").inch
        # A head stands on the page of what it is over.
        out = [self.platypus.CondPageBreak(4.0 * inch), self._said("Pictures", self.head)]
        for _, figure, caption in figures(self.diagnosis):
            data = io.BytesIO()
            figure.savefig(data, format="png", dpi=DOTS)
            data.seek(0)
            width, height = (float(one) for one in figure.get_size_inches())
            picture = self.platypus.Image(data, width=PAPER_WIDTH * inch, height=PAPER_WIDTH * inch * height / width)
            out.append(
                self.platypus.KeepTogether([picture, self._said(caption, self.small), self.platypus.Spacer(1, 8)])
            )
        return out


def _fonts() -> None:
    import matplotlib

    metrics, fonts = _lab("pdfbase.pdfmetrics"), _lab("pdfbase.ttfonts")
    folder = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    for name, file in ((FONT, "DejaVuSans.ttf"), (f"{FONT}-Bold", "DejaVuSans-Bold.ttf")):
        metrics.registerFont(fonts.TTFont(name, str(folder / file)))
