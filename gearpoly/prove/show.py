"""The scoreboard on the terminal."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from gearpoly.prove.expert import FAILURES
from gearpoly.prove.real import RealScore, real_json

UNLISTED = ("coverage_1", "false_alarms_60um", "false_names", "relief_found")
"""Rows that a case misses by design, or along with another that says the same."""

MARKS: dict[bool | None, Text] = {
    True: Text("reached", style="green"), False: Text("missed", style="red"), None: Text(""),
}  # fmt: skip


EXPERT = {
    "false_names": "with a false name", "named": "named, tooth included", "located": "located",
    "silent": "silent where something could be known", "said": "wrong file: said so",
}  # fmt: skip
"""Shares of the table by class, and what they are called."""


def percent(found: dict[str, Any]) -> str:
    """A share with its counts and its interval."""
    if not found["of"]:
        return "no case"
    low, high = found["interval_95"]
    return f"{100 * found['rate']:.1f} % ({found['hits']} of {found['of']}; {100 * low:.1f} to {100 * high:.1f})"


def value(row: dict[str, Any]) -> str:
    """The figure of a row in words."""
    if "of" in row:
        return percent(row)
    if row["value"] is None:
        return "no case"
    return f"{row['value']:.3g} {row['unit']}".strip()


def print_board(console: Console, board: dict[str, Any]) -> None:
    """Print goals and figures, size against detection, controls, and the cases that failed."""
    table = _table("goals", ("figure", "found (95 % interval)", "goal", ""))
    for row in board["rows"]:
        note = f" ({row['note']})" if row["note"] else ""
        table.add_row(Text.assemble(row["text"], (note, "dim")), value(row), row["goal"], MARKS[row["reached"]])
    console.print(table)
    sizes = _table("single effects by size over the theoretical limit", ("size", "reported", "named", "in the set"))
    for one in board["by_size"]:
        low, high = one["over_limit"]
        if one["cases"]:
            text = f"from {low:g}" if high is None else f"{low:g} to {high:g}"
            sizes.add_row(text, percent(one["reported"]), percent(one["named"]), percent(one["in_set"]))
    if sizes.row_count:
        console.print(sizes)
    known = _table("beside what a careful expert could know", ("class", "cases", *EXPERT.values(), *FAILURES.values()))
    for name, one in board["by_expert"].items():
        shares = [f"{one[key]['hits']} of {one[key]['of']}" if one[key]["of"] else "" for key in EXPERT]
        known.add_row(name, str(one["cases"]), *shares, *(str(one[key]) for key in FAILURES))
    console.print(known)
    _print_controls(console, board["controls"])
    spent = board["seconds"]
    if spent.get("seconds") is not None:
        console.print(
            f"\nprocessor seconds per case: median {spent['seconds']:.1f}, 95th percentile {spent['seconds_95']:.1f}"
        )
    misses = _table("cases that miss a row", ("case", "concealed", "said", "misses"))
    for one in board["failures"]:
        said = one["error"] or "; ".join(one["said"]) or ("located, not named" if one["unexplained"] else "nothing")
        wrong = [key for key in one["misses"] if key not in UNLISTED]
        if wrong:
            misses.add_row(one["case"], "; ".join(one["truth"]) or "nothing", said, ", ".join(wrong))
    if misses.row_count:
        console.print(misses)


def print_real(console: Console, scores: tuple[RealScore, ...]) -> None:
    """Print what was said of every judged recording, and what of it may not be said."""
    table = _table(
        "real recordings", ("recording", "named", "may not be named", "located", "not located", "unseen, um")
    )
    for one in scores:
        unseen = "" if one.unseen_um is None else f"{one.unseen_um[0]:.3g} to {one.unseen_um[1]:.3g}"
        table.add_row(
            f"{one.name}{' (control)' if one.control else ''}",
            one.error or "; ".join(one.named) or "nothing",
            Text("; ".join(one.false), style="red"),
            "; ".join(one.located),
            Text("; ".join(one.lost), style="red"),
            Text(unseen, style="red" if one.rises else ""),
        )
    console.print(table)
    found = real_json(scores)
    console.print(
        f"false names {found['false_names']}; controls named {found['controls_named']} of {found['controls']}; located "
        f"{found['located']} of {found['to_be_located']}; no verdict {found['no_verdict']} of {len(scores)}; "
        f"unseen rms rises in {found['unseen_rises']}",
        highlight=False,
    )


def _print_controls(console: Console, controls: dict[str, Any]) -> None:
    names = {
        "false_alarms": "false alarms",
        "healthy_named_otherwise": "healthy, named what is not wrong",
        "reported": "reported",
        "named": "named rightly",
        "in_set": "in the reported set",
        "false_names": "named something false",
        "look_alike_named": "look-alike named",
    }
    table = _table("controls and ablations", ("", "figure", "so", "whole method"))
    for one in controls.values():
        if "arm" not in one:
            if one["right_tooth"]["of"]:
                expected = f"chance: {100 * one['expected']:.1f} %"
                table.add_row(one["text"], "right tooth", percent(one["right_tooth"]), expected)
            continue
        first = f"{one['text']}, {one['cases']} cases"
        for key, text in names.items():
            if one["arm"][key]["of"]:
                table.add_row(first, text, percent(one["arm"][key]), percent(one["plain"][key]))
                first = ""
    if table.row_count:
        console.print(table)


def _table(title: str, columns: tuple[str, ...]) -> Table:
    table = Table(title=f"\n{title}", title_justify="left", box=None, pad_edge=False, title_style="bold")
    for name in columns:
        table.add_column(name, overflow="fold")
    return table
