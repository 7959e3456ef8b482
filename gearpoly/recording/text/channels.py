"""Rows of a time and the name of a channel, as counters of pulses write them: the two names are made numbers."""

from __future__ import annotations

import re

from gearpoly.recording.text.lines import TextLines

SAMPLE = 400
"""Lines that are looked at first."""

LEAST_ROWS_OF_CHANNELS = 50
"""Rows from which two words that come by turns are channels."""

_ROW = re.compile(
    r"(\s*\"?[-+]?\d[\d.,]*(?:[eE][-+]?\d+)?\"?\s*[,;\t| ]\s*\"?)([A-Za-z][A-Za-z_ -]{0,11}\d{0,2})(\"?\s*)"
)


def numbered_channels(lines: TextLines) -> tuple[TextLines, str]:
    """The ``lines`` with 1 and 2 in the place of the two words behind their times, and a remark that says so; as they
    are, without a remark, where most lines are of another kind."""
    sample = lines[:SAMPLE]
    found = [one for one in map(_ROW.fullmatch, sample) if one is not None]
    words = sorted({one[2].strip() for one in found[1:]})  # the first may be the head
    if len(words) != 2 or len(found) < max(LEAST_ROWS_OF_CHANNELS, len(sample) - SAMPLE // 10):
        return lines, ""
    number = {word: str(k) for k, word in enumerate(words, start=1)}
    out = []
    for line in lines:
        row = _ROW.fullmatch(line)
        known = row is not None and row[2].strip() in number
        out.append(f"{row[1]}{number[row[2].strip()]}{row[3]}" if known and row is not None else line)
    said = f'the channels "{words[0]}" and "{words[1]}" are numbered 1 and 2'
    return TextLines("\n".join(out).encode("utf-8"), "utf-8"), said
