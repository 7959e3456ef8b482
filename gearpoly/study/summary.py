"""A study in a few lines: how far it is and how fast it ran, and what its table answers."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rich.console import Console
from rich.table import Table
from rich.text import Text

from gearpoly.study.answers import Answers
from gearpoly.study.causes import FailureCause, causes, count_words
from gearpoly.study.groups import GroupSample, counted
from gearpoly.study.labels import asked_words
from gearpoly.study.outputs import describe
from gearpoly.study.run import Outcome
from gearpoly.study.statistics import Interval
from gearpoly.study.yields import yield_words

PRINTED = 24
"""Combinations that a terminal shows; the page has more."""

CAUSES = 8
"""Causes that a terminal shows; the page has all."""


def print_outcome(console: Console, outcome: Outcome) -> None:
    """Print what was made, at which rate, and why pairs have no result."""
    store, file = outcome.store, outcome.store.plan.file
    console.print(file.name, style="bold", highlight=False)
    console.print(
        f"{outcome.rows} pairs ({counted(store.plan.design.combinations)}), {outcome.made} of them made now"
        + (f" in {outcome.seconds:.1f} s, {outcome.made / outcome.seconds:.2f} pairs/s" if outcome.made else "")
        + (f"; stopped: {outcome.why}" if outcome.why != "all rows" else ""),
        highlight=False,
    )
    _print_causes(console, causes(store), pairs=outcome.rows)
    console.print(f"answers: gearpoly study-report {store.folder}", highlight=False)


def _print_causes(console: Console, found: tuple[FailureCause, ...], *, pairs: int) -> None:
    """Print how many of all ``pairs`` have no result and why, one cause a line with one row as an example."""
    for line in count_words(found, pairs=pairs):
        console.print(line, style="bold yellow", highlight=False)
    for one in found[:CAUSES]:
        console.print(f"  {one.says}; for example {one.example}", style="yellow", highlight=False)
    if len(found) > CAUSES:
        console.print(f"  {len(found) - CAUSES} more causes are in the column reason", style="yellow", highlight=False)


def _short(one: Interval) -> str:
    low, high = (f"{end:.3g}" if math.isfinite(end) else "open" for end in (one.low, one.high))
    return f"{one.value:.3g} [{low}, {high}]" if math.isfinite(one.value) else ""


def _tables(answers: Answers) -> Iterator[tuple[str, Table]]:
    """Percentiles: one table of all outputs where there is one combination, else one table per output."""
    outputs = answers.store.plan.file.outputs
    if len(answers.groups) == 1:
        rows = [(name, answers.groups[0].sample(name), describe(name)) for name in outputs]
        yield "", _table("output", rows, says=True)
        return
    for name in outputs:
        rows = [(group.words, group.sample(name), "") for group in answers.groups[:PRINTED]]
        yield f"{name}: {describe(name)}", _table("combination", rows)


def _table(head: str, rows: list[tuple[str, GroupSample, str]], *, says: bool = False) -> Table:
    table = Table(box=None, pad_edge=False)
    table.add_column(head, no_wrap=says, overflow="fold")
    for name in ("pairs", "median", "95 %", "99 %"):
        table.add_column(name, justify="right", no_wrap=True)
    if says:
        table.add_column("what it is")
    for label, sample, what in rows:
        found = dict(sample.percentiles)
        numbers = [str(sample.values.size), *(_short(found[p]) for p in (50.0, 95.0, 99.0))]
        table.add_row(Text(label), *numbers, *([Text(what)] if says else []))
    return table


def print_answers(console: Console, answers: Answers) -> None:
    """Print why pairs have no result, percentiles of every output, yields, and the cheapest grade."""
    console.print(answers.name, style="bold", highlight=False)
    _print_causes(console, answers.causes, pairs=answers.pairs)
    for remark in answers.remarks:
        console.print(f"note: {remark}", style="yellow", highlight=False)
    for title, table in _tables(answers):
        if title:
            console.print(f"\n{title}", style="bold", highlight=False)
        console.print(table)
    if len(answers.groups) > PRINTED:
        console.print(f"{len(answers.groups) - PRINTED} more combinations are on the page", highlight=False)
    graded = {one.found: one for one in answers.cheapest}
    for found in answers.yields:
        console.print(f"\n{asked_words(found)}", style="bold", highlight=False)
        for k, group in enumerate(answers.groups[:PRINTED]):
            share = yield_words(found, answers.groups, k)
            console.print(f"  {group.words}: {share}; {found.verdicts[k]}", highlight=False)
        for line in graded[found].says if found in graded else ():
            console.print(f"  {line}", style="green", highlight=False)
