"""Labels of pictures of a study, in lines that fit."""

from __future__ import annotations

import re
import textwrap

from gearpoly.study.outputs import output

LINE, TITLE, UPRIGHT, BESIDE = 46, 36, 26, 22
"""Letters of one line of a label along an axis of 4.6 inches, over one with names at its left, up one of 2.4, and of
a name left of a row."""


def axis_label(name: str, *, line: int = LINE) -> str:
    """What an output is and its unit, in lines that an axis of a small picture holds."""
    one = output(name)
    return textwrap.fill(f"{one.says} / {one.unit}" if one.unit else one.says, line)


def row_label(name: str, *, line: int = BESIDE) -> str:
    """A name in lines for the left of a row: one for each swept thing, and long keys parted at their dots."""
    out = []
    for one in name.split(", "):
        out.append("")
        for part in re.split(r"(?<=\.)(?=[a-z])|(?<= )", one):
            if out[-1] and len(out[-1]) + len(part.rstrip()) > line:
                out.append("")
            out[-1] += part
    return "\n".join(one.rstrip() for one in out)
