"""What an inspection sheet holds, for the terminal and as JSON."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.table import Table

from gearpoly.errors import shown
from gearpoly.files.inspection.seen import ColumnSeen, Held, SheetSeen
from gearpoly.files.inspection.seen_map import taken_by
from gearpoly.files.traces import shorten
from gearpoly.report.terminal import Terminal


def print_sheet(console: Terminal, seen: SheetSeen) -> None:
    """One sheet: its gear, columns and quantities by flank, and what is in doubt."""
    teeth = "" if seen.gear is None else f", {seen.gear.z} teeth"
    console.print(f"{shown(seen.file.name)}: {seen.format}{teeth}", style="bold", highlight=False)
    if seen.gear is not None:
        sizes = ", ".join(f"{key} = {value:g}" for key, value in seen.gear.geometry.items())
        counted = f", teeth counted {seen.gear.count}" if seen.gear.count else ""
        console.print(f"states {sizes}{counted}", highlight=False, soft_wrap=True)
    if seen.columns:
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for name in ("column", "unit", "taken for"):
            table.add_column(name, overflow="fold")
        for column in seen.columns:
            table.add_row(shorten(column.name), shorten(column.unit) or "-", _taken(column))
        console.print(table)
    if seen.held:
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for name in ("measured", "flank", "teeth", "from um", "to um"):
            table.add_column(name, justify="left" if name in ("measured", "flank") else "right")
        for one in seen.held:
            table.add_row(one.name, one.side or "-", str(one.count), f"{one.low:.4g}", f"{one.high:.4g}")
        console.print(table)
    for says in seen.says:
        console.print(f"note: {says}", style="dim", highlight=False, soft_wrap=True)
    for doubt in seen.doubts:
        console.print(f"in doubt: {doubt.says}", style="yellow", highlight=False, soft_wrap=True)
        for line in doubt.ask:
            console.print(f"    {line}", style="yellow", highlight=False, soft_wrap=True)
    if seen.refusal:
        console.print(f"not to be taken as it is: {seen.refusal}", style="yellow", highlight=False, soft_wrap=True)
    console.print(f"an inspection, no recording; taken by: {taken_by(seen)}", highlight=False, soft_wrap=True)


def sheet_held(seen: SheetSeen) -> dict[str, Any]:
    """One sheet as JSON."""
    return {
        "file": str(seen.file),
        "format": seen.format,
        "gear": None if seen.gear is None else dict(seen.gear.geometry),
        "count": None if seen.gear is None else seen.gear.count,
        "text": dict(seen.layout),
        "columns": [
            {"name": one.name, "unit": one.unit, "taken_for": one.meaning or None, "flank": one.side}
            for one in seen.columns
        ],
        "measured": [_held(one) for one in seen.held],
        "doubts": [{"says": one.says, "map": list(one.ask)} for one in seen.doubts],
        "remarks": list(seen.says),
        "refused": seen.refusal or None,
    }


def _held(one: Held) -> dict[str, Any]:
    return {"name": one.name, "flank": one.side, "count": one.count, "from_um": one.low, "to_um": one.high}


def _taken(one: ColumnSeen) -> str:
    if not one.meaning:
        return "?"
    return one.meaning.replace("_", " ") + (f", {one.side} flank" if one.side else "")
