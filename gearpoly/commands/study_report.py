"""``gearpoly study-report``: what a study's table answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

ORDER = 61


def study_report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that gearpoly study --out has filled.")],
    html: Annotated[Path | None, typer.Option(help="Page to write; default: report.html in DIR.")] = None,
    json: Annotated[Path | None, typer.Option(help="Write all answers (JSON; - for standard output).")] = None,
    limit: Annotated[
        list[str] | None, typer.Option(help='Instead of the study\'s own limits: "te_pp_um<=12" or ">=", repeatable.')
    ] = None,
    share: Annotated[float, typer.Option(help="Share of pairs that shall keep each --limit.", min=0.0, max=1.0)] = 0.99,
    confidence: Annotated[float, typer.Option(help="Confidence of all intervals.", min=0.5, max=0.9999)] = 0.95,
) -> None:
    """Percentiles with their intervals, yield, cheapest grade, sensitivity; as text, page and JSON."""
    from gearpoly.files.output import check_target, say_written, write_text
    from gearpoly.report.terminal import Terminal
    from gearpoly.study.answers import answer
    from gearpoly.study.answers_json import json_text
    from gearpoly.study.limits import parse_limits
    from gearpoly.study.page import write_page
    from gearpoly.study.summary import print_answers

    for target in (html, json):
        if target is not None:
            check_target(target)
    answers = answer(folder, limits=parse_limits(limit, share=share, folder=folder), confidence=confidence)
    page = html if html is not None else folder / "report.html"
    write_page(answers, page)
    if json is not None:
        write_text(json, json_text(answers))
    if str(json) != "-":
        console = Terminal()
        # Tables of intervals are wider than the 80 columns that a pipe is taken for.
        print_answers(console if console.is_terminal else Terminal(width=120), answers)
    say_written(page, "the answers as a page, open it in a browser")
    say_written(json, "the answers")
