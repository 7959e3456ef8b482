"""A diagnosis on paper: the PDF report, its pictures, and the page as a browser prints it."""

from __future__ import annotations

import base64
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.errors import MissingExtraError
from gearpoly.report import diagnosis_pdf
from gearpoly.report.diagnosis_data import order_spectra
from gearpoly.report.diagnosis_figures import curves_figure, fit_figure, write_figures
from gearpoly.report.diagnosis_page import page
from gearpoly.units import UM
from tests.chromium import Chromium
from tests.made_diagnosis import E_UM, made_comparison, made_diagnosis

A4 = (595.3, 841.9)
"""Points."""


@pytest.fixture(scope="module")
def diagnosis() -> Diagnosis:
    return made_diagnosis(*made_comparison())


def boxes(data: bytes) -> list[tuple[float, float]]:
    """Sizes of the pages of a PDF whose page objects are not packed."""
    found = re.findall(rb"/MediaBox\s*\[\s*0 0 ([\d.]+) ([\d.]+)", data)
    return [(float(w), float(h)) for w, h in found]


@pytest.fixture(scope="module")
def pdf(diagnosis: Diagnosis, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of it."""
    pytest.importorskip("reportlab")
    target = tmp_path_factory.mktemp("report") / "one.pdf"
    diagnosis_pdf.write_pdf(diagnosis, target)
    return target


@pytest.mark.slow
def test_the_report_is_the_same_twice(diagnosis: Diagnosis, pdf: Path, tmp_path: Path) -> None:
    diagnosis_pdf.write_pdf(diagnosis, tmp_path / "two.pdf")
    assert pdf.read_bytes() == (tmp_path / "two.pdf").read_bytes()


def test_the_report_is_a4(pdf: Path) -> None:
    data = pdf.read_bytes()
    assert data.startswith(b"%PDF") and data.rstrip().endswith(b"%%EOF")
    sizes = boxes(data)
    # Words on a page or two; seven pictures, two or three a page.
    assert 4 <= len(sizes) <= 7
    assert all(size == pytest.approx(A4, abs=0.1) for size in sizes)
    assert [one.name for one in pdf.parent.iterdir()] == ["one.pdf"]


def test_names_that_look_like_markup_are_words(diagnosis: Diagnosis, pdf: Path) -> None:
    """The pair's name and its recordings hold tags; a report that took them for its own would fail."""
    pypdf = pytest.importorskip("pypdf")
    words = " ".join(one.extract_text() for one in pypdf.PdfReader(pdf).pages)
    assert '<b>bench & "pair"</b>' in words and "<img src=x>" in words
    for one in diagnosis.findings:
        assert one.claim.physics.equation.split(" = ")[0] in words


def test_without_reportlab_it_is_asked_for_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "reportlab", None)
    monkeypatch.setitem(sys.modules, "reportlab.platypus", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'gearpoly\[pdf\]'"):
        diagnosis_pdf.check_extra()


def test_pictures_are_of_the_diagnosis(diagnosis: Diagnosis, tmp_path: Path) -> None:
    written = write_figures(diagnosis, tmp_path / "figures")
    names = [f"{what}_{k}.svg" for k in (0, 1) for what in ("curves", "orders", "teeth")]
    assert [one.name for one in written] == ["fit.svg", *names, "built.svg"]
    assert all(one.stat().st_size > 5000 for one in written)  # an empty canvas has less
    one, left = diagnosis.comparison.aligned[0], diagnosis.left[0]
    curves = curves_figure(one, left, title="").axes[1].lines
    assert [np.ptp(line.get_ydata()) for line in curves] == pytest.approx(
        [np.ptp(one.residual) / UM, np.ptp(left) / UM]
    )
    bars = [bar.get_width() for bar in fit_figure(diagnosis).axes[0].patches]
    assert bars[0] > bars[2]  # less is left with what was missing


def test_the_spectrum_has_the_wave_that_was_hidden(diagnosis: Diagnosis) -> None:
    """An axis ``E_UM`` off makes that amplitude at order 1, less the share of it that teeth within a turn mean out."""
    noise = diagnosis.comparison.located.noises[0]
    orders, before, after, _ = order_spectra(diagnosis.comparison.aligned[0], diagnosis.left[0], noise, z=(11, 13))
    at = int(np.argmin(np.abs(orders - 1.0)))
    assert before[at] / UM == pytest.approx(E_UM, rel=0.05)  # noise of 0.3 um and the staircase of eleven teeth
    assert after[at] < 0.05 * before[at]


def test_the_page_prints_on_a4_in_the_light_look(browser: Chromium, diagnosis: Diagnosis, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    target.write_text(page(diagnosis), encoding="utf-8")
    browser.size(1280, 900)
    browser.dark(True)
    browser.open(target)
    browser.settle()
    printed = browser.send("Page.printToPDF", preferCSSPageSize=True, printBackground=True)["data"]
    sizes = boxes(base64.b64decode(printed))
    assert 3 <= len(sizes) <= 8  # it was ten and more while every map had a row of its own
    assert all(size == pytest.approx(A4, abs=1.0) for size in sizes)
    browser.run("window.dispatchEvent(new Event('beforeprint')); 0")
    assert browser.run("getComputedStyle(document.body).getPropertyValue('--ink')").strip() == "#16191d"
    assert browser.run("document.documentElement.dataset.theme") == "light"
    browser.run("window.dispatchEvent(new Event('afterprint')); 0")
    assert browser.run("document.documentElement.dataset.theme ?? 'none'") == "none"
