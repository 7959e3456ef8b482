"""The scoreboard on the terminal."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from gearpoly.prove.expert import FAILURES
from gearpoly.prove.real import RealScore, real_json
from gearpoly.prove.reliability import NAME, PLACE
from gearpoly.prove.words import EXPERT, UNLISTED, missing_unknown, number, percent, short_percent, value
from gearpoly.proving.ground import CLASS_WORDS

TERMINAL_MARKS: dict[bool | None, Text] = {
    True: Text("reached", style="green"), False: Text("missed", style="red"), None: Text(""),
}  # fmt: skip


def print_board(console: Console, board: dict[str, Any]) -> None:
    """Print goals and figures, size against detection, controls, and the cases that failed."""
    table = _table("goals", ("figure", "found (95 % interval)", "goal", ""))
    for row in board["rows"]:
        note = f" ({row['note']})" if row["note"] else ""
        table.add_row(
            Text.assemble(row["text"], (note, "dim")), value(row), row["goal"], TERMINAL_MARKS[row["reached"]]
        )
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
    groups = [*board["by_expert"].items(), *board["by_length"].items()]
    for name, one in groups:
        shares = [f"{one[key]['hits']} of {one[key]['of']}" if one[key]["of"] else "" for key in EXPERT]
        known.add_row(CLASS_WORDS.get(name, name), str(one["cases"]), *shares, *(str(one[key]) for key in FAILURES))
    console.print(known)
    if board["without_unknown"]:
        console.print(missing_unknown(board["without_unknown"]), highlight=False)
    _print_measures(console, groups, board["seconds"].get("by_group", {}))
    print_chances(console, board["by_expert"]["all"]["reliability"])
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


def _print_measures(
    console: Console, groups: list[tuple[str, dict[str, Any]]], seconds: dict[str, dict[str, float]]
) -> None:
    """How sure, how well and how fast, group by group."""
    heads = ("class", "log score", "entries", "unseen, after over before", "95th percentile", "rises", "seconds",
             "95th percentile", "all")  # fmt: skip
    measures = _table("chances stated, unseen data, and processor seconds per case", heads)
    for name, one in groups:
        stated, unseen, spent = one["reliability"], one["unseen_ratio"], seconds.get(name, {})
        measures.add_row(
            CLASS_WORDS.get(name, name), number(stated["log_score"]), str(stated["entries"]), number(unseen["median"]),
            number(unseen["q95"]),
            short_percent(one["unseen_rises"]), *(number(spent.get(key)) for key in ("median", "q95", "all")),
        )  # fmt: skip
    console.print(measures)


def print_chances(console: Console, stated: dict[str, Any]) -> None:
    """Print how often stated chances were right, and their log score; nothing where none was stated."""
    if not stated["entries"]:
        return
    kinds = {NAME: "of a name", PLACE: "that something is there"}
    here = [kind for kind in kinds if kind in stated]
    table = _table("chances stated, and how often they were right", ("chance", *(kinds[kind] for kind in here)))
    for found in zip(*(stated[kind] for kind in here), strict=True):
        low, high = found[0]["chance"]
        cells = [f"{one['stated']:.2f}: {percent(one['right'])}" if one["right"]["of"] else "" for one in found]
        table.add_row(f"{low:g} to {high:g}", *cells)
    console.print(table)
    score, std = stated["log_score"], number(stated["log_score_std"])
    spread = f" +- {std}" if std else ""
    console.print(f"log score {number(score)}{spread} over {stated['entries']} entries; 0 is best", highlight=False)


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
    unseen, spent = found["unseen_ratio"], found["seconds"]
    console.print(
        f"unseen rms, after over before: median {number(unseen['median'])}, 95th percentile {number(unseen['q95'])}; "
        f"processor seconds: median {number(spent['median'])}, 95th percentile {number(spent['q95'])}, all "
        f"{number(spent['all'])}",
        highlight=False,
    )
    print_chances(console, found["reliability"])


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
