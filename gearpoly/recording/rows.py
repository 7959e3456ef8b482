"""Rows of a recording's file for messages, and the order of their times."""

from __future__ import annotations

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.clock_set import JUMPS_OUT
from gearpoly.recording.deeds import in_full
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray, IntArray


def row_of(recording: Recording, sample: int) -> str:
    """A sample's place for a message: its row of the file from 1, and its time."""
    at = "" if recording.time_s is None else f" (time_s {recording.time_s[sample]:.6g})"
    return f"row {sample + first_row(recording)}{at}"


def first_row(recording: Recording) -> int:
    """The row of the file, from 1, that holds the first sample."""
    return recording.run.rows[0] if recording.run is not None else 1


def check_time(recording: Recording, keep: IntArray, position: FloatArray) -> None:
    """Time must not run back: files that were strung together, or a clock that was set."""
    back = np.flatnonzero(np.diff(position) < 0.0)
    if 2 * back.size > position.size:
        found = f"a time that falls from row to row, from {in_full(position[0])} to {in_full(position[-1])} s"
        wish = "want the oldest row first: sort the rows by their times"
        raise InputFileError(recording.source, where="column time_s", found=found, wish=wish)
    if back.size:
        sample = int(keep[back[0] + 1])
        found = f"a time {position[back[0]] - position[back[0] + 1]:.9g} s before the row above"
        wish = "want one recording in the order of time; cut it there"
        wish += next((f", or: {said}" for said in recording.remarks if JUMPS_OUT in said), "")
        raise InputFileError(recording.source, where=f"{row_of(recording, sample)}", found=found, wish=wish)
