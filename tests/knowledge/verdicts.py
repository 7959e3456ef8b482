"""A verdict as its reader has it: what is named, what else that may be, and what has a place and no name."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.files.models import PairFile
from gearpoly.recording.recording import Recording
from gearpoly.report.diagnosis_report import verdict_json

Entry = dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Cause:
    """A physics of a ``gear`` ("driving" or "driven") and of one ``tooth`` of it; None: of none, or of any."""

    physics: str
    gear: str | None = None
    tooth: int | None = None

    def meets(self, entry: Entry) -> bool:
        """Whether an entry of a verdict, or one of its look-alikes, is this."""
        asked = {"gear": self.gear, "tooth": self.tooth}
        return entry["physics"] == self.physics and all(entry.get(k) == v for k, v in asked.items() if v is not None)


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """The contract's JSON. A name counts where it heads an entry or stands among its look-alikes."""

    json: Entry

    @property
    def missing(self) -> list[Entry]:
        """What is named."""
        return list(self.json["missing"])

    def named(self, cause: Cause) -> Entry | None:
        """The entry, or the look-alike in one, that is this cause; None where nobody names it."""
        members = (one for entry in self.missing for one in _members(entry))
        return next((one for one in members if cause.meets(one)), None)

    def size(self, cause: Cause, name: str) -> float:
        """A parameter of a cause that is named."""
        found = self.named(cause)
        assert found is not None, self.told
        return float(found["parameters"][name]["value"])

    def misnamed(self, *causes: Cause) -> list[str]:
        """Names of entries in which none of the ``causes`` stands."""
        return [
            entry["physics"]
            for entry in self.missing
            if not any(cause.meets(one) for cause in causes for one in _members(entry))
        ]

    def located(self, kinds: Sequence[str], **where: Any) -> list[Entry]:
        """Entries without a name, of some ``kinds``, that have these values."""
        entries = self.json["unexplained"]
        return [one for one in entries if one["kind"] in kinds and all(one.get(k) == v for k, v in where.items())]

    @property
    def told(self) -> str:
        """The whole in a line, for a test that fails."""
        named = [" or ".join(_label(one) for one in _members(entry)) for entry in self.missing]
        placed = [f"{one['kind']} {one.get('gear', '')} {one.get('order', '')}" for one in self.json["unexplained"]]
        return f"named {named}; located {placed}"


def _members(entry: Entry) -> Iterator[Entry]:
    yield entry
    yield from entry.get("indistinguishable_from", [])


def _label(entry: Entry) -> str:
    return " ".join(str(entry[key]) for key in ("physics", "gear", "tooth") if entry.get(key) is not None)


def verdict(known: PairFile, recordings: Sequence[Recording], *, within: float = math.inf) -> Verdict:
    """What ``gearpoly diagnose --json`` writes of recordings beside what is known of their pair, within so many s."""
    found = verdict_json(diagnose(known, recordings, path=Path("pair.toml"), within=within))
    return Verdict(json=json.loads(json.dumps(found, allow_nan=False)))
