"""The pictures of the tutorial, from its own commands: ``python -m docs.tutorial.pictures`` (from the repository)."""

from __future__ import annotations

import tempfile
from pathlib import Path

from PIL import Image

from gearpoly.compare.compare import compare
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.read import read_set
from gearpoly.report.compare_plots import plot_comparison
from gearpoly.report.diagnosis_page import page
from tests.chromium import Chromium

ROOT = Path(__file__).resolve().parents[2]
CASE = ROOT / "data" / "recordings" / "eccentric_low_tooth"
FIGURES = Path(__file__).with_name("figures")
PARTS = {"verdict": "header", "curves": "#plots"}


def main() -> None:
    """Compare one recording, diagnose both, and take the page's top and its plots."""
    pair, recordings = CASE / "pair.toml", sorted(CASE.glob("rec_*.csv"))
    file = read_pair(pair)
    plot_comparison(compare(file, read_set(recordings[:1], None), path=pair), target=FIGURES / "compared.png")
    diagnosis = diagnose(file, read_set(recordings, None), path=pair)
    with tempfile.TemporaryDirectory() as folder, Chromium(width=1200, height=820) as browser:
        written = Path(folder) / "page.html"
        written.write_text(page(diagnosis), encoding="utf-8")
        browser.open(written)
        for name, selector in PARTS.items():
            browser.run(f"document.querySelector({selector!r}).scrollIntoView()")
            browser.screenshot(FIGURES / f"{name}.png")
    for name in ("compared", *PARTS):
        with Image.open(FIGURES / f"{name}.png") as picture:
            picture.thumbnail((1300, 1300))
            # 128 colours are more than such a picture has; it takes a third of the room.
            picture.convert("RGB").quantize(128).save(FIGURES / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
