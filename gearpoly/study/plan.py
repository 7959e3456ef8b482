"""What is to be computed, as every worker gets it: the study without its questions, as text, and cut into chunks."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

from gearpoly.study.design import Design
from gearpoly.study.models import StudyFile
from gearpoly.study.read import Study

CHUNKS = 400
"""Chunks into which a study is cut at first: row s starts a chunk of 1 + s // CHUNKS rows. So small studies share out
evenly, large ones make few files, and more pairs later change nothing in front. A stop loses at most the chunks that
are under way."""

LARGEST_CHUNK = 250
"""Rows of the largest chunk: about a minute's work, which is the most that a lost worker costs."""

_ASKED = {"name", "limit", "until", "pairs"}
"""Keys that change no row: names, questions, and how many rows there are."""


@dataclass(frozen=True)
class StudyPlan:
    """A study as ``text`` (JSON): equal plans make equal rows."""

    text: str

    @cached_property
    def _document(self) -> dict[str, Any]:
        document: dict[str, Any] = json.loads(self.text)
        return document

    @cached_property
    def file(self) -> StudyFile:
        """The study file."""
        return StudyFile.model_validate(self._document["study"])

    @property
    def raw(self) -> dict[str, Any]:
        """The tables of the pair file."""
        raw: dict[str, Any] = self._document["pair"]
        return raw

    @property
    def traces(self) -> dict[str, str]:
        """Measured traces that the pair file names, text by file name."""
        traces: dict[str, str] = self._document["traces"]
        return traces

    @cached_property
    def design(self) -> Design:
        """Which row is what."""
        return Design(file=self.file)

    @property
    def what(self) -> dict[str, Any]:
        """What the rows depend on, flat by dotted key: two runs may be mixed where these agree."""
        study = {key: value for key, value in self._document["study"].items() if key not in _ASKED | {"pair"}}
        # A sweep may be called something else.
        study["sweep"] = [{k: v for k, v in sweep.items() if k != "name"} for sweep in study.get("sweep", [])]
        traces = {name: hashlib.sha256(text.encode()).hexdigest()[:16] for name, text in self.traces.items()}
        return dict(
            _flat({"study": study, "pair": self.raw, "traces": traces, "versions": self._document["versions"]}, "")
        )

    @property
    def versions(self) -> dict[str, str]:
        """Versions that a row depends on."""
        versions: dict[str, str] = self._document["versions"]
        return versions

    def chunks(self, *, rows: int, done: list[tuple[int, int]], cuts: list[int]) -> Iterator[tuple[int, int]]:
        """Chunks (start, stop) that cover rows 0 to ``rows`` but for those ``done`` (sorted, apart), none across one of
        the ``cuts``."""
        edges = sorted({cut for cut in cuts if 0 < cut < rows} | {rows})
        start = 0
        for low, high in [*done, (rows, rows)]:
            while start < min(low, rows):
                stop = min(start + size_at(start), low, rows, next(edge for edge in edges if edge > start))
                yield start, stop
                start = stop
            start = max(start, high)


def size_at(start: int) -> int:
    """Rows of the chunk that starts at row ``start``."""
    return min(1 + start // CHUNKS, LARGEST_CHUNK)


def versions() -> dict[str, str]:
    """Versions of what a row's bits depend on."""
    import numpy
    import scipy

    from gearpoly import __version__
    from gearpoly.plugins import PHYSICS_GROUP, plugins

    return {"gearpoly": __version__, "numpy": numpy.__version__, "scipy": scipy.__version__,
            "python": ".".join(str(part) for part in sys.version_info[:2]),
            **{one.package: one.version for one in plugins(PHYSICS_GROUP)}}  # fmt: skip


def plan_of(study: Study) -> StudyPlan:
    """The plan of a checked study."""
    document = {
        "study": study.file.model_dump(by_alias=True, mode="json", exclude_none=True),
        "pair": study.raw,
        "traces": study.traces,
        "versions": versions(),
    }
    return StudyPlan(json.dumps(document, sort_keys=True))


@lru_cache(maxsize=4)
def plan_from(text: str) -> StudyPlan:
    """The plan of this text, read once per process."""
    return StudyPlan(text)


def differences(then: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """What changed between two ``Plan.what``, in words."""
    out = []
    for key in sorted(then.keys() | now.keys()):
        before, after = then.get(key, "absent"), now.get(key, "absent")
        if before != after:
            out.append(f"{key} was {_short(before)}, now {_short(after)}")
    return out


def _short(value: object) -> str:
    text = json.dumps(value) if not isinstance(value, str) else value
    return text if len(text) <= 60 else text[:57] + "..."


def _flat(value: object, prefix: str) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from _flat(inner, f"{prefix}.{key}" if prefix else str(key))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for k, inner in enumerate(value):
            yield from _flat(inner, f"{prefix}[{k}]")
    else:
        yield prefix, value
