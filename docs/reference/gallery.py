"""The pictures of the gallery, left by the examples themselves.

``python -m docs.reference.gallery [NAME...]``, from the repository.
"""

from __future__ import annotations

import contextlib
import runpy
import sys
import tempfile
from pathlib import Path

from PIL import Image

import gearpoly

ROOT = Path(__file__).resolve().parents[2]
FIGURES = Path(__file__).with_name("figures")
WIDTH = 1000
"""Pixels: sharp on the site, whose column is half as wide in dots of a laptop."""


def main(*names: str) -> None:
    """Run the examples of those names, or all that leave a picture, and draw the ``plan`` of a pair."""
    FIGURES.mkdir(exist_ok=True)
    for example in sorted((ROOT / "examples").glob("*.py")):
        if example.stem == "first_run" or (names and example.stem not in names):
            continue
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            runpy.run_path(str(example), run_name="__main__")
            _keep(f"{example.stem}.png")
    if not names or "plan" in names:
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            gearpoly.load(gearpoly.samples() / "pairs" / "graded_18_25.toml").plan().plot("plan.png")
            _keep("plan.png")


def _keep(name: str) -> None:
    """A picture of the working folder among those of the docs, in a third of its room: 128 colours are more than it
    has."""
    with Image.open(name) as picture:
        picture.thumbnail((WIDTH, 2 * WIDTH))
        picture.convert("RGB").quantize(128, Image.Quantize.MAXCOVERAGE).save(FIGURES / name, optimize=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
