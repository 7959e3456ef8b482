"""How large the contact debugger's page is and how many frames a second it draws: python -m benchmarks.viewing

A headless Chromium draws in software on the processor's own cores; a screen with a graphics card is faster. Each line
is the mean of three seconds in which the gears turn a hundredth of a pitch per frame, everything drawn.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from gearpoly.assemble import assemble
from gearpoly.files.pairfile import read_pair
from gearpoly.mesh.condition import Condition
from gearpoly.units import NM
from gearpoly.view.document import document
from gearpoly.view.html import page_text
from gearpoly.view.scene import scene_of
from tests.chromium import Chromium

PAIRS = Path(__file__).parents[1] / "data" / "pairs"
VIEWS = (("whole gears", "0"), ("mesh", "2"), ("contact", "3"), ("10 um", "4"), ("10 nm", "5"))


def main() -> None:
    """Print one line per page and view."""
    with tempfile.TemporaryDirectory() as folder, Chromium(width=1440, height=900) as browser:
        for path in (PAIRS / "paper_18_25.toml", PAIRS / "graded_18_25.toml"):
            start = time.perf_counter()
            file = read_pair(path)
            scene = scene_of(
                assemble(file, path=path, seed=0),
                name=file.name,
                path=path,
                condition=Condition(flank="drive", torque=file.torque_nm * NM),
                progress=lambda done: None,
            )
            page = Path(folder) / f"{path.stem}.html"
            page.write_text(page_text(document(scene)), encoding="utf-8")
            made = time.perf_counter() - start
            start = time.perf_counter()
            browser.open(page)
            opened = time.perf_counter() - start
            points = scene.simulation.pair.driving.flanks.r.size
            size = page.stat().st_size / 1e6
            print(
                f"{path.stem}: {points} points a flank, {size:.2f} MB, made in {made:.1f} s, opened in {opened:.1f} s"
            )
            print(f"  kernel of the page against simulate: {browser.run('gearpoly.checked')}")
            browser.run("gearpoly.measure(1)")  # the browser compiles the page's script meanwhile
            for view, key in VIEWS:
                browser.key(key, text=key)
                seen = browser.run("gearpoly.measure(3)")
                print(
                    f"  {view:12s} {seen['fps']:5.1f} frames/s, {seen['work_ms']:.1f} ms of script a frame, "
                    f"95 % of frames within {seen['p95_ms']:.0f} ms"
                )
            print(f"  console: {browser.console or 'nothing'}")


if __name__ == "__main__":
    main()
