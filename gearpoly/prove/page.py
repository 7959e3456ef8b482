"""Scoreboards as a page: ``python -m gearpoly.prove.page A.json B.json ... docs/proof.md`` draws its figures, too."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gearpoly.errors import GearpolyError, InputFileError
from gearpoly.files.output import write_text
from gearpoly.files.traces import read_text
from gearpoly.prove.drawn import draw_reliability, draw_sizes
from gearpoly.prove.run_page import run_section
from gearpoly.prove.side import chances, goals, halves, label, times

NEEDED = ("rows", "by_expert", "by_length", "seconds", "by_size", "failures", "truths_sha256", "without_unknown")
"""Keys of a scoreboard that the page is made of."""

RELIABILITY = "reliability.png"


def board_text(board: dict[str, Any]) -> str:
    """The scoreboard as JSON; nothing in it is infinite or no number."""
    return json.dumps(board, allow_nan=False, indent=1) + "\n"


def read_board(path: Path) -> dict[str, Any]:
    """A scoreboard that ``gearpoly prove --json`` wrote. Raises ``InputFileError`` for anything else."""
    try:
        board = json.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        raise InputFileError(path, found=f"no JSON ({error})", wish="want what prove --json wrote") from None
    lacks = [key for key in NEEDED if key not in board] if isinstance(board, dict) else list(NEEDED)
    if lacks:
        wish = "run gearpoly prove again with the same --out: cases and verdicts that are there are kept"
        raise InputFileError(path, found=f"a scoreboard without {', '.join(lacks)}", wish=wish)
    return dict(board)


def page(boards: Sequence[dict[str, Any]], *, figures: Sequence[str] = (), reliability: str | None = None) -> str:
    """The page, from scoreboards alone. ``figures``: of size against detection, one a run; ``reliability``: of stated
    chances."""
    labels = [label(board) for board in boards]
    cases = ", ".join(f"{board['cases']} cases of the {board['of']}" for board in boards)
    versions = ", ".join(dict.fromkeys(board["gearpoly"] for board in boards))
    out = [
        "# The proof",
        "",
        f"Made from scoreboards alone: {cases}; gearpoly {versions}. Nothing on this page is written by hand.",
        "",
        "A bench of its own (`gearpoly/proving/`) makes recordings of pairs in which something is concealed; it shares "
        "no code with the simulator. Truths are written apart, hashed before anything is scored, and opened by the "
        "scorer only. What counts as right stands in `gearpoly/proving/thresholds.toml`. "
        "[What each row means](explanation/prove.md#what-is-counted).",
        "",
        "## Goals and figures",
        "",
        "Missed goals are bold. Intervals of every figure stand in the scoreboard.",
        "",
        *goals(boards, labels),
        "",
        *times(boards, labels),
        "",
        "## Short recordings and long ones",
        "",
        "Short: at most two hunting cycles.",
        "",
        *halves(boards, labels),
        "",
        "## Stated chances",
        "",
    ]
    if reliability:
        out += [f"![how often a stated chance is right]({reliability})", ""]
    out += chances(boards, labels)
    for k, (board, name) in enumerate(zip(boards, labels, strict=True)):
        out += ["", *run_section(board, name, figure=figures[k] if k < len(figures) else None)]
    return "\n".join(out) + "\n"


def main(sources: Sequence[Path], target: Path) -> None:
    """Write the page and its figures beside it, under ``figures/``."""
    boards = [read_board(source) for source in sources]
    folder = target.parent / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    names = [f"proof_size{'' if k == 0 else f'_{k + 1}'}.png" for k in range(len(boards))]
    for board, name in zip(boards, names, strict=True):
        draw_sizes(board, folder / name)
    draw_reliability(boards, [label(board) for board in boards], folder / RELIABILITY)
    text = page(boards, figures=[f"figures/{name}" for name in names], reliability=f"figures/{RELIABILITY}")
    write_text(target, text)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit("want SCOREBOARD.json ... PAGE.md")
    try:
        main([Path(one) for one in sys.argv[1:-1]], Path(sys.argv[-1]))
    except GearpolyError as error:
        sys.exit(str(error))
