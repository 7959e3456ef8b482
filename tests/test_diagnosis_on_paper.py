"""A diagnosis on paper: the PDF report, its pictures, and the page as a browser prints it."""

from __future__ import annotations

import base64
import contextlib
import re
import subprocess
import sys
import zlib
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
from tests.chromium import PATIENCE, Chromium, needed
from tests.made_diagnosis import E_UM, made_comparison, made_diagnosis

pytestmark = pytest.mark.long


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


def colours(data: bytes) -> set[tuple[float, ...]]:
    """Fill colours of a browser's PDF, red, green and blue from 0 to 1."""
    found: set[tuple[float, ...]] = set()
    for packed in re.findall(rb"stream\r?\n(.*?)endstream", data, re.DOTALL):
        with contextlib.suppress(zlib.error):  # a font or a picture
            text = zlib.decompress(packed)
            found |= {tuple(map(float, one)) for one in re.findall(rb"([\d.]+) ([\d.]+) ([\d.]+) rg\b", text)}
    return found


BARS = {"before": (0x9A, 0x6A, 0x00), "after": (0x3F, 0x33, 0xB5)}
"""Colours of the bars in the light look."""


@pytest.mark.parametrize("background", [True, False])
def test_bars_are_printed_without_background_graphics_too(
    browser: Chromium, diagnosis: Diagnosis, tmp_path: Path, background: bool
) -> None:
    """Browsers leave backgrounds out unless asked, and bars are nothing else."""
    target = tmp_path / "page.html"
    target.write_text(page(diagnosis), encoding="utf-8")
    browser.open(target)
    browser.settle()
    browser.run("document.getElementById('plots').remove(); 0")  # its keys are borders of these colours
    printed = colours(base64.b64decode(browser.send("Page.printToPDF", printBackground=background)["data"]))
    for colour in BARS.values():
        wanted = np.array(colour) / 255.0
        assert any(np.allclose(one, wanted, atol=1e-3) for one in printed)  # a PDF has four digits


def test_no_finding_is_torn_over_two_pages(browser: Chromium, diagnosis: Diagnosis, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    target.write_text(page(diagnosis), encoding="utf-8")
    browser.open(target)
    browser.send("Emulation.setEmulatedMedia", media="print")
    kept = "[...document.querySelectorAll('.finding')].map((one) => getComputedStyle(one).breakInside).join()"
    found = browser.run(kept)
    browser.send("Emulation.setEmulatedMedia", media="")
    assert found == ",".join(["avoid"] * len(diagnosis.findings)) and len(diagnosis.findings) > 1


def test_a_browser_that_waits_for_nothing_prints_the_plots(diagnosis: Diagnosis, tmp_path: Path) -> None:
    """``chromium --print-to-pdf`` prints once the page is loaded; data and plots were not there by then. Three curves,
    two maps and two charts of teeth of either gear, twice each."""
    target = tmp_path / "page.html"
    target.write_text(page(diagnosis), encoding="utf-8")
    options = ("--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}")
    pdf = tmp_path / "page.pdf"
    subprocess.run(
        [needed(), *options, f"--print-to-pdf={pdf}", target.as_uri()],
        check=True,
        capture_output=True,
        timeout=PATIENCE,
    )
    assert len(re.findall(rb"/Subtype /Image", pdf.read_bytes())) == 3 + 4 + 4
