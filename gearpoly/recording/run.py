"""Which part of its file a recording is, where the shafts turned forth and back in one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class Run:
    """One run in one direction: its ``number`` from 1 among ``of`` in the ``file``, its ``rows`` (first, last, from 1),
    and the ``turns`` of the ``shaft`` that was read. Runs of one ``stretch`` share their count of turns, so that their
    angles compare; between stretches readings are missing. ``in_file`` is the flank that the file states for all its
    runs, where the lost motion alone told theirs."""

    file: Path
    number: int
    of: int
    rows: tuple[int, int]
    turns: float
    shaft: str
    stretch: int
    in_file: Literal["drive", "coast"] | None = None

    @property
    def named(self) -> str:
        """How the run is asked for: ``log.csv#2``."""
        return f"{self.file.name}#{self.number}"
