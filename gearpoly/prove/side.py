"""Tables of a page that lay finished runs side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gearpoly.prove.reliability import NAME, PLACE
from gearpoly.prove.words import number, short_percent

Board = dict[str, Any]


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A table in Markdown."""
    out = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    return out + ["| " + " | ".join(row) + " |" for row in rows]


def label(board: Board) -> str:
    """A run in a few words: its ground and its seed, or its folder."""
    if board["seed"] is None:
        return str(board["of"])
    return f"{board['ground'] or 'bench'} {board['seed']}{', quick' if board['quick'] else ''}"


def goals(boards: Sequence[Board], labels: Sequence[str]) -> list[str]:
    """Every row of every run; one that has a case in no run is left out."""
    keys: dict[str, Board] = {}
    for board in boards:
        for row in board["rows"]:
            keys.setdefault(row["key"], row)
    out = []
    for key, first in keys.items():
        found = [next((row for row in board["rows"] if row["key"] == key), None) for board in boards]
        cells = ["" if row is None else _cell(row) for row in found]
        if any(cells):
            note = f" ({first['note']})" if first["note"] and len(boards) == 1 else ""
            out.append([first["text"] + note, *cells, first["goal"]])
    return table(["figure", *labels, "goal"], out)


def _cell(row: Board) -> str:
    text = short_percent(row) if "of" in row else number(row["value"], row["unit"])
    return f"**{text}**" if text and row["reached"] is False else text


def times(boards: Sequence[Board], labels: Sequence[str]) -> list[str]:
    """Processor seconds of every run."""
    rows = [
        [name, *(number(board["seconds"].get(key)) for key in ("seconds", "seconds_95", "seconds_all"))]
        for name, board in zip(labels, boards, strict=True)
    ]
    return table(["processor seconds per case", "median", "95th percentile", "all cases"], rows)


def halves(boards: Sequence[Board], labels: Sequence[str]) -> list[str]:
    """What became of short recordings and of long ones."""
    every = [
        (f"{name}, {half}", board["by_length"][half], board["seconds"].get("by_group", {}).get(half, {}))
        for name, board in zip(labels, boards, strict=True)
        for half in ("short", "long")
        if half in board["by_length"]
    ]
    return known(every, "run") if every else ["No truth says how long its recordings are."]


def known(every: Sequence[tuple[str, Board, Board]], head: str) -> list[str]:
    """Two tables of the same groups: what was said, and how sure, how well and how fast."""
    shares = ("false_names", "named", "located", "silent", "said")
    heads = ["false name", "named", "located", "nothing said", "wrong file said"]
    said = [
        [
            name, str(one["cases"]), *(short_percent(one[key]) for key in shares),
            f"{one['refused']}, {one['traceback']}, {one['time_out']}",
        ]
        for name, one, _ in every
    ]  # fmt: skip
    so = []
    for name, one, spent in every:
        stated, unseen = one["reliability"], one["unseen_ratio"]
        so.append(
            [
                name, number(stated["log_score"]), str(stated["entries"]), number(unseen["median"]),
                number(unseen["q95"]), short_percent(one["unseen_rises"]),
                *(number(spent.get(key)) for key in ("median", "q95", "all")),
            ]
        )  # fmt: skip
    return [
        *table([head, "cases", *heads, "refused, traceback, time-out"], said),
        "",
        *table(
            [head, "log score", "entries", "unseen, after over before", "95th", "rises", "seconds", "95th", "all"], so
        ),
    ]


def chances(boards: Sequence[Board], labels: Sequence[str]) -> list[str]:
    """Bins of stated chances: their mean, and how often they were right."""
    found = [board["by_expert"]["all"]["reliability"] for board in boards]
    texts = {
        NAME: "Of a name, its look-alikes and the unknown: mean of the chances stated, and how often right.",
        PLACE: "That something is there, without a name:",
    }
    out: list[str] = []
    for kind, text in texts.items():
        rows = []
        for k, one in enumerate(found[0][kind]):
            low, high = one["chance"]
            rows.append([f"{low:g} to {high:g}", *(_bin(stated[kind][k]) for stated in found)])
        out += [text, "", *table(["chance stated", *labels], rows), ""]
    logs = [
        [name, number(one["log_score"]), number(one["log_score_std"]), str(one["entries"])]
        for name, one in zip(labels, found, strict=True)
    ]
    return [*out, *table(["log score", "mean log probability of what was true", "standard error", "entries"], logs)]


def _bin(one: Board) -> str:
    return f"{one['stated']:.2f}: {short_percent(one['right'])}" if one["right"]["of"] else ""
