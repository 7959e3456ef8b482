"""A study in a few lines: how far it is and how fast it ran, and what its table answers."""

from __future__ import annotations

import math
import re
from pathlib import Path

from pydantic import ValidationError
from rich.console import Console
from rich.table import Table
from rich.text import Text

from gearpoly.errors import OutOfRangeError
from gearpoly.files.traces import nearest
from gearpoly.study.answers import Answers, words
from gearpoly.study.models import Limit
from gearpoly.study.run import Outcome
from gearpoly.study.statistics import Interval
from gearpoly.study.store import read_store

PRINTED = 24
"""Combinations that a terminal shows; the page has more."""

_LIMIT = re.compile(r"^\s*(\w+)\s*(<=|>=)\s*(\S+)\s*$")


def print_outcome(console: Console, outcome: Outcome) -> None:
    """Print what was made, at which rate, and how many pairs jam or cannot be made."""
    store, file = outcome.store, outcome.store.plan.file
    status = store.column("status")
    count = {name: int((status == name).sum()) for name in ("done", "jams", "refused")}
    console.print(file.name, style="bold", highlight=False)
    console.print(
        f"{outcome.rows} pairs ({_counted(store.plan.design.combinations)}), {outcome.made} of them made now"
        + (f" in {outcome.seconds:.1f} s, {outcome.made / outcome.seconds:.2f} pairs/s" if outcome.made else "")
        + (f"; stopped: {outcome.why}" if outcome.why != "all rows" else ""),
        highlight=False,
    )
    if count["jams"] or count["refused"]:
        console.print(
            f"{count['jams']} pairs jam, {count['refused']} cannot be made or run (column reason)",
            style="yellow",
            highlight=False,
        )
    console.print(f"answers: gearpoly study-report {store.folder}", highlight=False)


def _counted(combinations: int) -> str:
    return "1 combination" if combinations == 1 else f"{combinations} combinations"


def parse_limits(texts: list[str] | None, *, share: float, folder: Path) -> list[Limit] | None:
    """Limits of the command line, or None where there are none. Raises ``OutOfRangeError`` for one that is none."""
    if not texts:
        return None
    known = read_store(folder)[0].plan.file.outputs
    out = []
    for text in texts:
        match = _LIMIT.match(text)
        if match is None:
            raise OutOfRangeError(f'--limit "{text}"; want "output<=number" or "output>=number"')
        if match[1] not in known:
            raise OutOfRangeError(
                f'--limit "{text}": the study kept no "{match[1]}"; the nearest is "{nearest(match[1], known)}"'
            )
        try:
            bound = float(match[3])
            keys = {"at_most" if match[2] == "<=" else "at_least": bound}
            out.append(Limit(output=match[1], share=share, **keys))
        except ValidationError:
            raise OutOfRangeError(f"--share {share:g}: want a share above 0 and below 1") from None
        except ValueError:
            raise OutOfRangeError(f'--limit "{text}": "{match[3]}" is no number') from None
    return out


def _short(one: Interval) -> str:
    low, high = (f"{end:.3g}" if math.isfinite(end) else "open" for end in (one.low, one.high))
    return f"{one.value:.3g} [{low}, {high}]" if math.isfinite(one.value) else ""


def print_answers(console: Console, answers: Answers) -> None:
    """Print percentiles of every output, yields, and the cheapest grade."""
    console.print(answers.name, style="bold", highlight=False)
    for remark in answers.remarks:
        console.print(f"note: {remark}", style="yellow", highlight=False)
    table = Table(box=None, pad_edge=False)
    table.add_column("output", no_wrap=True)
    for name in ("pairs", "median", "95 %", "99 %"):
        table.add_column(name, justify="right", no_wrap=True)
    for output in answers.store.plan.file.outputs:
        if len(answers.groups) > 1:
            table.add_row(Text(output, style="bold"))
        for group in answers.groups[:PRINTED]:
            sample = group.sample(output)
            found = dict(sample.percentiles)
            label = f"  {group.label}" if len(answers.groups) > 1 else output
            table.add_row(label, str(sample.values.size), *(_short(found[p]) for p in (50.0, 95.0, 99.0)))
    console.print(table)
    if len(answers.groups) > PRINTED:
        console.print(f"{len(answers.groups) - PRINTED} more combinations are on the page", highlight=False)
    for one in answers.yields:
        console.print(f"\n{words(one.limit)}", style="bold", highlight=False)
        for group, kept, verdict in list(zip(answers.groups, one.shares, one.verdicts, strict=True))[:PRINTED]:
            share = f"{100.0 * kept.value:.4g} % ({100.0 * kept.low:.4g} to {100.0 * kept.high:.4g} %)"
            console.print(f"  {group.label}: {share}, {verdict}", highlight=False)
    for cheapest in answers.cheapest:
        for line in cheapest.says:
            console.print(f"  {line}", style="green", highlight=False)
