"""The one printer of results: what files hold never acts on the terminal."""

from __future__ import annotations

from typing import IO, Any

from rich.console import Console
from rich.text import Text

from gearpoly.errors import escaped


class Terminal(Console):
    """A console on which a text is that text: no markup, no emoji codes, and control characters as their escapes, but
    for the line ends of our own layout (names and values from files are one line by the time they come here)."""

    def __init__(self, *, stderr: bool = False, file: IO[str] | None = None, width: int | None = None) -> None:
        super().__init__(stderr=stderr, file=file, width=width, markup=False, emoji=False)

    def render_str(self, text: str, **how: Any) -> Text:
        """``text`` as rich draws it."""
        return super().render_str("\n".join(map(escaped, text.split("\n"))), **how)
