"""``gearpoly read``: what the file of a recording or of an inspection holds, before anything is computed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

ORDER = 15


def read(
    files: Annotated[
        list[Path], typer.Argument(help="Recordings or inspection sheets of any format, as they were written.")
    ],
    write: Annotated[
        Path | None, typer.Option(help="Write the map (TOML; - for standard output) that makes one file certain.")
    ] = None,
    map: Annotated[Path | None, typer.Option(help="Read the files by this map, to see what it makes of them.")] = None,
    json: Annotated[Path | None, typer.Option(help="Write all of it (JSON; - for standard output).")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw every column over time (png, svg or pdf).")] = None,
) -> None:
    """Show what files hold: columns, units, rate, turns, gaps, stops, and what each column was taken for and why; of an
    inspection sheet its gear, flanks, teeth and units."""
    from gearpoly.errors import OutOfRangeError
    from gearpoly.files.inspection.heads_of_sheets import is_sheet
    from gearpoly.files.inspection.seen import check_kind, look_at_sheet
    from gearpoly.files.inspection.seen_map import sheet_map_text
    from gearpoly.files.inspection.sheet_map import read_map as read_sheet_map
    from gearpoly.files.output import check_targets, say_written, write_text
    from gearpoly.recording.map_file import read_map
    from gearpoly.recording.map_text import check_one_file, map_text
    from gearpoly.recording.survey import survey
    from gearpoly.report.reading_report import json_text, print_survey
    from gearpoly.report.sheet_report import print_sheet, sheet_held
    from gearpoly.report.terminal import Terminal

    check_targets([write, json, plot], inputs=[*files, *([map] if map is not None else [])])
    if plot is not None:
        from gearpoly.report.plots import check_format
        from gearpoly.report.reading_plots import plot_surveys

        check_format(plot)
    if write is not None:
        check_one_file(write, files=len(files))
    if write is not None and map is not None:
        raise OutOfRangeError(
            f"--write {write}: the map is there, {map}; leave out --write, or --map to write a new one"
        )
    sheets = [file for file in files if is_sheet(file)]
    for file in files:
        check_kind(file)
    if sheets and plot is not None:
        says = f"{sheets[0].name} is an inspection sheet, which has no course in time"
        raise OutOfRangeError(f"--plot {plot}: {says}; leave --plot out")
    chart = None if map is None or len(sheets) == len(files) else read_map(map)
    looked = [look_at_sheet(file, read_sheet_map(map)) for file in sheets]
    found = [one for file in files if file not in sheets for one in survey(file, chart)]
    if write is not None:
        write_text(write, sheet_map_text(looked[0]) if looked else map_text(found[0]))
    if json is not None:
        write_text(json, json_text(found, [sheet_held(one) for one in looked]))
    if plot is not None:
        plot_surveys(found, target=plot)
    if "-" not in (str(write), str(json)):
        console = Terminal()
        for sheet in looked:
            print_sheet(console, sheet)
        for one in found:
            print_survey(console, one)
    say_written(write, "the map, with what is in doubt behind a #")
    say_written(json, "what the files hold")
    say_written(plot, "every column over time")
