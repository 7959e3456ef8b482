"""What a study's page calls outputs and limits: words with units, in lines that fit a picture."""

from __future__ import annotations

import textwrap

from gearpoly.study.models import OutputLimit
from gearpoly.study.outputs import output
from gearpoly.study.yields import Yield

LABEL_LINE_LETTERS, TITLE_LETTERS, UPRIGHT_LABEL_LETTERS, ROW_NAME_LETTERS = 46, 36, 26, 22
"""Letters of one line of a label along an axis of 4.6 inches, over one with names at its left, up one of 2.4, and of
a name left of a row."""


NO_BREAK = "\N{NO-BREAK SPACE}"


def limit_words(limit: OutputLimit) -> str:
    """A limit without its share."""
    one = output(limit.output)
    bound = f"at most {limit.at_most:g}" if limit.at_most is not None else f"at least {limit.at_least:g}"
    return f"{one.says} {bound}{f' {one.unit}' if one.unit else ''}"


def asked_words(found: Yield) -> str:
    """What a yield asks of how many pairs."""
    bounds = " and ".join(limit_words(limit) for limit in found.limits)
    many = len(found.limits)
    together = {1: "", 2: "both limits together: "}.get(many, f"all {many} limits together: ")
    return f"{together}{bounds} in {100.0 * found.share:g} % of pairs"


def axis_label(name: str, *, line: int = LABEL_LINE_LETTERS) -> str:
    """What an output is and its unit, in lines that an axis of a small picture holds."""
    one = output(name)
    return textwrap.fill(f"{one.says} / {one.unit}" if one.unit else one.says, line)


def row_label(name: str, *, line: int = ROW_NAME_LETTERS) -> str:
    """A name in lines for the left of a row: one or more for each swept thing, and a value beside its unit."""
    out = []
    for one in name.split(", "):
        words, equals, value = one.partition(" = ")
        out.append(textwrap.fill(words + equals[:2] + (equals[2:] + value).replace(" ", NO_BREAK), line))
    return "\n".join(out).replace(NO_BREAK, " ")
