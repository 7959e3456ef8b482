"""``gearpoly diagnose``: which physics the simulation left out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gearpoly.arguments import SECONDS_OF_WORK
from gearpoly.diagnose.budget import USUAL_WORK_S
from gearpoly.options import MapsOption, PairArgument, RecordingsArgument

ORDER = 30


def diagnose(
    pair: PairArgument,
    recordings: RecordingsArgument,
    map: MapsOption = None,
    json: Annotated[Path | None, typer.Option(help="Write the verdict (JSON; - for standard output).")] = None,
    html: Annotated[
        Path | None, typer.Option(help="Write one page with zoomable plots that opens without a network (- likewise).")
    ] = None,
    pdf: Annotated[Path | None, typer.Option(help="Write the report for paper (A4; needs the extra pdf).")] = None,
    figures: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write every picture (svg) into this folder.")
    ] = None,
    fitted: Annotated[
        Path | None, typer.Option(help="Write the pair file (TOML) with what was missing in it (- likewise).")
    ] = None,
    within: Annotated[
        float,
        typer.Option(min=SECONDS_OF_WORK.least, metavar="SECONDS", help="Look no longer than so many seconds of work."),
    ] = USUAL_WORK_S,
) -> None:
    """Name the physics that the simulation left out, model it, and show the fit improve."""
    from gearpoly.diagnose.diagnose import diagnose as run
    from gearpoly.errors import blamed
    from gearpoly.files.output import check_folder, check_targets, say_written, write_text
    from gearpoly.files.pairfile import dump_pair, moved, read_pair
    from gearpoly.recording.read import read_set
    from gearpoly.report.diagnosis_page import page
    from gearpoly.report.diagnosis_report import json_text, print_diagnosis
    from gearpoly.report.progress import steps
    from gearpoly.report.terminal import Terminal

    check_targets([json, html, pdf, fitted], inputs=[pair, *recordings, *(map or [])])
    if figures is not None:
        check_folder(figures)
    if pdf is not None:
        from gearpoly.report.diagnosis_pdf import check_extra

        check_extra()
    file = read_pair(pair)
    with steps() as step, blamed(pair, "driving, driven, pair"):
        step("reading")
        read = read_set(recordings, map, worm=file.worm)
        diagnosis = run(file, read, path=pair, step=step, reached=step.reached, within=within)
    # All are made before any is written.
    made: list[tuple[Path, str, str]] = []
    if fitted is not None:
        text = dump_pair(moved(diagnosis.fitted, source=pair, target=fitted))
        made.append((fitted, text, "the pair file with what was missing in it"))
    if json is not None:
        made.append((json, json_text(diagnosis), "the verdict"))
    if html is not None:
        made.append((html, page(diagnosis), "the verdict as a page, open it in a browser"))
    for target, text, _ in made:
        write_text(target, text)
    if pdf is not None:
        from gearpoly.report.diagnosis_pdf import write_pdf

        write_pdf(diagnosis, pdf)
    if figures is not None:
        from gearpoly.report.diagnosis_figures import write_figures

        write_figures(diagnosis, figures)
    if all(str(target) != "-" for target, _, _ in made):
        print_diagnosis(Terminal(), diagnosis)
    for target, _, what in made:
        say_written(target, what)
    say_written(pdf, "the report for paper")
    say_written(figures, "every picture")
