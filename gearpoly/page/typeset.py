"""Sentences of the terminal as a page prints them."""

from __future__ import annotations

import re


def typeset(text: str) -> str:
    """A sentence with its units and signs as print has them, not as a terminal does."""
    text = re.sub(r"(?<=\d )u(?=m\b|rad\b)", "µ", text)
    return re.sub(r"(?<=\d )N\.m\b", "N·m", text).replace(" +- ", " ± ")
