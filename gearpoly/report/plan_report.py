"""A plan of recordings in words and as JSON."""

from __future__ import annotations

import json

from rich.console import Console
from rich.table import Table

from gearpoly import __version__
from gearpoly.diagnose.alike import SHOWS
from gearpoly.diagnose.plan import TOLD_APART_SINE, Plan


def json_text(plan: Plan) -> str:
    """The plan as JSON: recordings under the keys of a recording, sines of the angles between look-alikes."""
    document = {
        "gearpoly": __version__,
        "pair": plan.name,
        "first": plan.first.to_json() | {"says": plan.first.says},
        "further": [one.to_json() | {"says": one.says} for one in plan.further],
        "look_alikes": [
            {"one": one.one, "other": one.other, "separability": one.first, "after": list(one.after)}
            for one in plan.look_alikes
        ],
        "hidden": [
            {"physics": one.physics, "standard_deviations": one.first, "after": list(one.after)} for one in plan.hidden
        ],
        "not_asked": list(plan.not_asked),
        "told_apart_from": TOLD_APART_SINE,
    }
    return json.dumps(document, allow_nan=False, indent=1)


def print_plan(console: Console, plan: Plan) -> None:
    """Print what to record, and what that leaves alike."""
    console.print(plan.name, style="bold", highlight=False)
    for number, one in enumerate((plan.first, *plan.further), 1):
        console.print(f"{number}. {one.says}", highlight=False, soft_wrap=True)
    if not plan.look_alikes and not plan.hidden:
        console.print("The first recording shows everything, and tells it apart.", highlight=False)
    if plan.look_alikes:
        table = _table(f"sine of the angle between two physics, told apart from {TOLD_APART_SINE}", "these two", plan)
        for alike in plan.look_alikes:
            sines = ("-" if sine is None else f"{sine:.2f}" for sine in (alike.first, *alike.after))
            table.add_row(words(f"{alike.one} and {alike.other}"), *sines)
        console.print(table)
    if plan.hidden:
        table = _table(f"standard deviations of an ordinary fault, shown from {SHOWS:g}", "hidden at first", plan)
        for hidden in plan.hidden:
            table.add_row(words(hidden.physics), *(f"{shown:.1f}" for shown in (hidden.first, *hidden.after)))
        console.print(table)
    left = [f"{a.one} and {a.other}" for a in plan.look_alikes if a.last is not None and a.last < TOLD_APART_SINE]
    if left:
        _print(
            console,
            "No recording of this pair tells these apart (another mating gear, an inspection or a re-mounting might): "
            f"{words('; '.join(left))}.",
        )
    unseen = [hidden.physics for hidden in plan.hidden if (hidden.first, *hidden.after)[-1] < SHOWS]
    if unseen:
        _print(
            console,
            f"No recording of this pair shows an ordinary {words(', '.join(unseen))}: teeth as they may be built hide "
            "it, or noise does.",
        )
    if plan.not_asked:
        _print(
            console,
            f"Left out, since it is declared, needs what the pair file does not state, or shows in no recording: "
            f"{words(', '.join(plan.not_asked))}.",
        )


def words(names: str) -> str:
    """Names of physics as a reader writes them."""
    return names.replace("_", " ")


def _print(console: Console, text: str) -> None:
    console.print(f"\n{text}", highlight=False, soft_wrap=True)


def _table(title: str, first: str, plan: Plan) -> Table:
    table = Table(title=f"\n{title}", title_justify="left", box=None, pad_edge=False)
    table.add_column(first)
    table.add_column("with 1", justify="right")
    for number in range(len(plan.further)):
        table.add_column(f"to {number + 2}", justify="right")
    return table
