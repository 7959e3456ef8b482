"""The site of the docs, opened from disk: a search finds pages, and shows where in them, without a server."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.chromium import Chromium, needed
from tests.test_house import ROOT

PAGES = {
    "index.md": "# Front\n\nWords of the front.\n\n```{toctree}\nreference/gears\n```\n",
    "reference/gears.md": (
        '# Gears\n\nFirst words.\n\n## Slewing rings\n\nA "quoted" slewing ring of <12> teeth & more, $x^2$ wide.\n'
    ),
}
"""A site of two pages, one of them in a folder, with characters that HTML and scripts read as their own."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pages, built as ``make docs`` builds its own."""
    pytest.importorskip("sphinx", reason="wants the extra docs")
    needed()
    folder = tmp_path_factory.mktemp("docs")
    shutil.copy(ROOT / "docs" / "conf.py", folder)
    shutil.copytree(ROOT / "docs" / "static", folder / "static")
    for name, text in PAGES.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    build = [sys.executable, "-m", "sphinx", "--quiet", "--fail-on-warning", "--builder", "html"]
    ran = subprocess.run(
        [*build, str(folder), str(folder / "site")], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert ran.returncode == 0, ran.stderr
    return folder / "site"


@pytest.fixture(scope="module")
def browser() -> Iterator[Chromium]:
    with Chromium(width=1000, height=800) as one:
        yield one


def found(browser: Chromium, site: Path, words: str) -> list[str]:
    """The excerpts under the results of a search."""
    browser.send("Page.navigate", url=f"{(site / 'search.html').as_uri()}?q={words}")
    shown = "[...document.querySelectorAll('#search-results li')].map((one) => one.innerText)"
    done = "document.readyState === 'complete' && document.querySelector('.search-summary')?.innerText"
    for _ in range(200):  # 10 s on a crowded machine
        if browser.run(done) and all("\n" in one for one in browser.run(shown)):
            break
        time.sleep(0.05)
    return list(browser.run(shown))


@pytest.mark.long
def test_results_show_where_the_words_stand(site: Path, browser: Chromium) -> None:
    results = found(browser, site, "slewing")
    excerpts = dict(one.split("\n\n") for one in results if "Front" not in one)
    ring = "Slewing rings A “quoted” slewing ring of <12> teeth & more, wide."
    # The page, and of its heading the section alone.
    assert excerpts == {"Gears": f"Gears First words. {ring}", "Gears > Slewing rings": ring}
    assert not browser.console


def test_other_pages_fetch_as_ever(site: Path) -> None:
    """Nothing but the page of the search loads what makes its excerpts."""
    assert "search_texts.js" in (site / "search.html").read_text(encoding="utf-8")
    assert "search_texts.js" not in (site / "reference" / "gears.html").read_text(encoding="utf-8")
