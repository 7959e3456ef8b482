"""A plan of recordings in words and as JSON."""

from __future__ import annotations

import json

from rich.console import Console
from rich.table import Table

from gearpoly import __version__
from gearpoly.diagnose.plan import TOLD, Plan


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
        "told_apart_from": TOLD,
    }
    return json.dumps(document, allow_nan=False, indent=1)


def print_plan(console: Console, plan: Plan) -> None:
    """Print what to record, and what that leaves alike."""
    console.print(plan.name, style="bold", highlight=False)
    for number, one in enumerate((plan.first, *plan.further), 1):
        console.print(f"{number}. {one.says}", highlight=False, soft_wrap=True)
    if not plan.look_alikes:
        console.print("The first recording tells everything apart.", highlight=False)
        return
    table = Table(
        title=f"\nsine of the angle between two physics, told apart from {TOLD}",
        title_justify="left",
        box=None,
        pad_edge=False,
    )
    table.add_column("these two")
    table.add_column("with 1", justify="right")
    for number in range(len(plan.further)):
        table.add_column(f"to {number + 2}", justify="right")
    for alike in plan.look_alikes:
        words = f"{alike.one} and {alike.other}".replace("_", " ")
        table.add_row(words, f"{alike.first:.2f}", *(f"{sine:.2f}" for sine in alike.after))
    console.print(table)
    left = [one for one in plan.look_alikes if (one.after or (one.first,))[-1] < TOLD]
    if left:
        words = "; ".join(f"{one.one} and {one.other}".replace("_", " ") for one in left)
        console.print(
            f"No recording of this pair tells these apart (another mating gear, an inspection or a re-mounting might): "
            f"{words}.",
            highlight=False,
            soft_wrap=True,
        )
