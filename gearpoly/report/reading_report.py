"""What a recording's file holds, for the terminal and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from rich import box
from rich.table import Table

from gearpoly import __version__
from gearpoly.errors import shown
from gearpoly.files.traces import shorten
from gearpoly.recording.deeds import so_many
from gearpoly.recording.lost_motion import LostMotion
from gearpoly.recording.quantities import column_unit
from gearpoly.recording.survey import RunSeen, SampleTimes, Seen, Survey
from gearpoly.recording.turning import Turning
from gearpoly.report.terminal import Terminal
from gearpoly.units import ARCMIN, UM

RUN_SHOWN = 240
"""Characters of a run's line; it holds the file's name twice."""

RUNS = 12
"""Runs of a file that are told one by one."""

PLACES_NAMED = 3
"""Places of one kind that are named; the rest is counted."""


def print_survey(console: Terminal, found: Survey) -> None:
    """One recording: what the columns are, how the shafts turn, and what is in doubt."""
    which = f", recording {found.number} of {found.of}" if found.of > 1 else ""
    console.print(
        f"{shown(found.file.name)}{which}: {found.format}, {found.rows} samples", style="bold", highlight=False
    )
    if found.clock is not None:
        console.print(_clock_words(found.clock), highlight=False, soft_wrap=True)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("column", "unit", "from", "to", "missing", "taken for"):
        table.add_column(name, justify="right" if name in ("from", "to", "missing") else "left", overflow="fold")
    for one in found.channels:
        low, high = one.span or (math.nan, math.nan)
        table.add_row(
            shorten(one.name), shorten(one.unit) or "-", f"{low:.6g}", f"{high:.6g}", str(one.missing), _taken(one)
        )
    console.print(table)
    for one in found.channels:
        if one.turning is not None:
            console.print(f"{shorten(one.name)}: {_turning_words(one.turning, one)}", highlight=False, soft_wrap=True)
    for run in found.runs[:RUNS]:
        flank = "too short to use" if run.short else f"{run.flank} flank, alone as {run.run.named}"
        console.print(shown(f"{run.says}, {flank}", width=RUN_SHOWN), highlight=False, soft_wrap=True)
    if more := found.runs[RUNS:]:
        back = sum(run.back for run in more)
        words = f"and {len(more)} more runs, {len(more) - back} forward and {back} back, which --json lists"
        console.print(words, highlight=False, soft_wrap=True)
    for forth, back, lost in found.lost[:PLACES_NAMED]:
        words = f"lost motion from run {forth} to run {back}: {lost.says}"
        console.print(words, style="bold", highlight=False, soft_wrap=True)
    for key, value in found.keys.items():
        console.print(f"states {key} = {value}", highlight=False, soft_wrap=True)
    for one in found.channels:
        if one.column and one.sure:
            console.print(
                f"{shorten(one.name)} is {one.column}: {one.why}", style="dim", highlight=False, soft_wrap=True
            )
    for remark in found.remarks:
        console.print(f"note: {remark}", style="dim", highlight=False, soft_wrap=True)
    for doubt in found.doubts:
        console.print(f"in doubt: {doubt.says}", style="yellow", highlight=False, soft_wrap=True)
        for line in doubt.ask:
            console.print(f"    {line}", style="yellow", highlight=False, soft_wrap=True)
    if found.refusal:
        console.print(f"not to be compared as it is: {found.refusal}", style="yellow", highlight=False, soft_wrap=True)
    else:
        console.print("to be compared as it is", highlight=False)


def _taken(one: Seen) -> str:
    if not one.column:
        return "-"
    return one.column if one.sure else f"{one.column}?"


def _clock_words(clock: SampleTimes) -> str:
    words = [f"{clock.seconds:.6g} s at {clock.rate_hz:.5g} samples per second"]
    if clock.alike > 1:
        words.append(f"of which {clock.alike} share a time")
    if clock.spread > 0.01:
        words.append(f"steps vary by {clock.spread:.0%}")
    words.append(_places("gap", [f"{wide:.4g} s after row {row}" for row, wide in clock.gaps]))
    if clock.backs:
        words.append("time runs back before " + _places("row", [str(row) for row in clock.backs]))
    return ", ".join(words)


def _turning_words(turning: Turning, one: Seen) -> str:
    words = [f"{turning.turns:.4g} turns"]
    if turning.wraps:
        at = "" if turning.modulus is None else f" at about {turning.modulus:.4g} {shorten(one.unit)}".rstrip()
        words.append(f"begins again {so_many(turning.wraps, 'times')}{at}")
    words.append(_places("stop", [f"rows {first} to {last}" for first, last in turning.stops]))
    words.append(_places("reversal", [f"at row {row}" for row in turning.reversals]))
    words.append(f"{turning.repeats or 'no'} readings repeat the one before")
    words.append(f"{turning.spikes or 'no'} spike{'s' * (turning.spikes != 1)}")
    return ", ".join(words)


def _places(what: str, places: Sequence[str]) -> str:
    if not places:
        return f"no {what}"
    more = "" if len(places) <= PLACES_NAMED else f" and {len(places) - PLACES_NAMED} more"
    return f"{len(places)} {what}{'s' * (len(places) > 1)} ({', '.join(places[:PLACES_NAMED])}{more})"


def json_text(surveys: Sequence[Survey], inspections: Sequence[dict[str, Any]] = ()) -> str:
    """All recordings as JSON, and inspection sheets beside them."""
    beside = {"inspections": list(inspections)} if inspections else {}
    return json.dumps(surveys_json(surveys) | beside, indent=2) + "\n"


def surveys_json(surveys: Sequence[Survey]) -> dict[str, Any]:
    """All that is seen of the recordings; what is no number is None."""
    return {"gearpoly": __version__, "recordings": [_held(one) for one in surveys]}


def _held(found: Survey) -> dict[str, Any]:
    return {
        "file": str(found.file),
        "section": found.number,
        "sections": found.of,
        "format": found.format,
        "samples": found.rows,
        "text": dict(found.layout),
        "keys": dict(found.keys),
        "clock": None if found.clock is None else _clock_held(found.clock),
        "columns": [_seen_held(one) for one in found.channels],
        **({"runs": [_run_held(one) for one in found.runs]} if found.runs else {}),
        **({"lost_motion": [_lost_held(*one) for one in found.lost]} if found.lost else {}),
        "doubts": [{"says": one.says, "map": list(one.ask)} for one in found.doubts],
        "remarks": list(found.remarks),
        "refused": found.refusal or None,
    }


def _run_held(one: RunSeen) -> dict[str, Any]:
    return {
        "number": one.run.number,
        "rows": list(one.run.rows),
        "turns": one.run.turns,
        "shaft": one.run.shaft,
        "direction": "back" if one.back else "forward",
        "flank": one.flank,
        "too_short": one.short,
    }


def _lost_held(forth: int, back: int, one: LostMotion) -> dict[str, Any]:
    unit, name = (UM, "um") if one.along else (ARCMIN, f"{one.side}_arcmin")
    sizes = {"mean": one.mean, "least": float(np.min(one.by)), "most": float(np.max(one.by))}
    return {"runs": [forth, back], **{f"{what}_{name}": size / unit for what, size in sizes.items()}}


def _clock_held(clock: SampleTimes) -> dict[str, Any]:
    return {
        "rate_hz": _number(clock.rate_hz),
        "spread": _number(clock.spread),
        "seconds": _number(clock.seconds),
        "gaps": [{"after_row": row, "seconds": wide} for row, wide in clock.gaps],
        "runs_back_before_row": list(clock.backs),
    }


def _seen_held(one: Seen) -> dict[str, Any]:
    low, high = one.span or (math.nan, math.nan)
    out: dict[str, Any] = {
        "name": one.name,
        "unit": one.unit,
        "taken_for": one.column or None,
        "in": column_unit(one.column).name if one.column else None,
        "sure": one.sure,
        "why": one.why,
        "from": _number(low),
        "to": _number(high),
        "missing": one.missing,
    }
    if one.turning is not None:
        turning = one.turning
        out["turning"] = {
            "turns": _number(turning.turns),
            "wraps": turning.wraps,
            "wraps_at": None if turning.modulus is None else _number(turning.modulus),
            "stops": [list(rows) for rows in turning.stops],
            "reversals": list(turning.reversals),
            "repeats": turning.repeats,
            "spikes": turning.spikes,
        }
    return out


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
