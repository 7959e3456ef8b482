"""An expert's judgement of real recordings: what may be named, and what has to be located."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

from gearpoly.errors import InputFileError, shown
from gearpoly.files.paths import is_file, parted
from gearpoly.files.traces import read_text
from gearpoly.physics import catalogue
from gearpoly.prove.cases import CaseFiles
from gearpoly.prove.fields import Fields

ENDING = ".judgement.json"

JUDGED_KINDS = ("shaft_order", "mesh_order", "tone", "time")
"""Kinds of places that a judgement may want located."""

TOLERANCE = 0.2
"""Part of its amplitude by which a line may be off, where the judgement does not say: two analyses of one guide log
differ by a tenth."""


@dataclass(frozen=True, kw_only=True)
class PlaceWanted:
    """A line that has to be located: its ``kind``, ``gear`` (of a shaft's order), ``order`` or ``hz``, amplitude in um
    and the part of that by which it may be off."""

    kind: str
    gear: str | None
    order: float | None
    hz: float | None
    amplitude_um: float | None
    tolerance: float

    @property
    def label(self) -> str:
        """Where and how large in a few words."""
        where = f"{self.hz:g} Hz" if self.order is None else f"{self.gear or 'mesh'} order {self.order:g}"
        return where if self.amplitude_um is None else f"{where}, {self.amplitude_um:g} um"


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """What may be said of some recordings: whether they are a ``control`` (another machine's, of which nothing may be
    named), the physics and gear that ``may_name`` holds (gear None: either), and the places that have to be located."""

    case: CaseFiles
    control: bool
    may_name: tuple[tuple[str, str | None], ...]
    must_locate: tuple[PlaceWanted, ...]


def read_judgement(path: Path) -> Judgement:
    """The judgement at ``path``, its pair file and recordings named from its folder. Raises ``InputFileError`` where a
    file is missing, or a physics, a gear or a place is none."""
    try:
        raw = Fields(json.loads(read_text(path)))
        pair = path.parent / raw.word("pair")
        names = [Fields({"recordings": one}).word("recordings") for one in raw.values("recordings")]
        recordings = tuple(path.parent / one for one in names)
        control = raw.raw.get("control", False)
        if not isinstance(control, bool):
            raise ValueError("control is not true or false")
        may_name = tuple((one.word("physics"), one.gear()) for one in raw.entries("may_name"))
        places = tuple(_place(one) for one in raw.entries("must_locate"))
    except (ValueError, RecursionError) as error:
        wish = "want a judgement with pair, recordings, control, may_name and must_locate"
        raise InputFileError(path, found=f"no judgement ({error})", wish=wish) from None
    known = catalogue()
    for physics, _ in may_name:
        if physics not in known:
            wish = f"want one of {', '.join(known)}"
            raise InputFileError(path, where="may_name.physics", found=shown(physics), wish=wish)
    if control and may_name:
        raise InputFileError(path, where="may_name", found="names of a control", wish="want none, or control = false")
    if not recordings:
        raise InputFileError(path, where="recordings", found="none", wish='want names of files, as ["log.txt"]')
    for one in (pair, *recordings):
        if not is_file(parted(one)[0]):
            raise InputFileError(one, found="there is no such file", wish=f"named in {path.name}; put it there")
    name = path.name.removesuffix(ENDING)
    case = CaseFiles(name=name, pair=pair, recordings=recordings, truth=path)
    return Judgement(case=case, control=control, may_name=may_name, must_locate=places)


def _place(raw: Fields) -> PlaceWanted:
    kind, gear = raw.word("kind"), raw.gear()
    order, hz = raw.number("order"), raw.number("hz")
    if kind not in JUDGED_KINDS:
        raise ValueError(f"{raw.where}kind is none of {', '.join(JUDGED_KINDS)}")
    given = [one for one in (order, hz) if one is not None]
    if len(given) != 1 or not 0.0 < given[0] < math.inf:
        raise ValueError(f"{raw.where}order or hz is no number above 0, or both are there")
    if kind == "shaft_order" and gear is None:
        raise ValueError(f"no {raw.where}gear of a shaft's order")
    tolerance = raw.number("tolerance")
    return PlaceWanted(
        kind=kind, gear=gear, order=order, hz=hz, amplitude_um=raw.number("amplitude_um"),
        tolerance=TOLERANCE if tolerance is None else tolerance,
    )  # fmt: skip
