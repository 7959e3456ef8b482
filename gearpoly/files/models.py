"""The models of a pair file: its tables with the keys that each physics brings.

What is said of any pair stands in ``keys.sections``; what a physics adds stands in that physics' own file. The models
hold the file's own keys in the file's own units (um, deg, N.m); geometry converts them.
"""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from typing import TYPE_CHECKING, Any

from pydantic import create_model
from pydantic.fields import FieldInfo

from gearpoly.keys import sections
from gearpoly.keys.kinds import Section as Section
from gearpoly.keys.kinds import field
from gearpoly.physics import catalogue, in_order
from gearpoly.physics.base import Physics

if TYPE_CHECKING:  # keys that physics bring are known at run time only; ``sections.Open`` takes any
    from gearpoly.keys.sections import Encoder as Encoder
    from gearpoly.keys.sections import GearSection as GearSection
    from gearpoly.keys.sections import Inspection as Inspection
    from gearpoly.keys.sections import Measurement as Measurement
    from gearpoly.keys.sections import PairFile as PairFile
    from gearpoly.keys.sections import PairSection as PairSection


def _with(plain: FieldInfo, annotation: Any, **changes: Any) -> tuple[Any, FieldInfo]:
    """A key of a table as it was, of another kind."""
    key = copy(plain)
    key.annotation = annotation
    for name, value in changes.items():
        setattr(key, name, value)
    return annotation, key


def completed(known: Iterable[Physics]) -> dict[str, type[Section]]:
    """The tables of a pair file with the keys of these physics, in their order, by the names of their classes."""
    known = in_order(known)

    def whole(table: str, plain: type[Section], **fields: Any) -> Any:
        brought = [one.keys[table] for one in known if table in one.keys]
        # Pydantic takes the keys of the last base first.
        bases = (*reversed(brought), plain)
        return create_model(plain.__name__, __base__=bases, __module__=__name__, __doc__=plain.__doc__, **fields)

    pair = whole("pair", sections.PairSection)
    encoder = whole("encoder", sections.Encoder)
    measurement = whole("measurement", sections.Measurement)
    about = "what this shaft's encoder reads wrong, a table"
    gear = whole("gear", sections.GearSection, encoder=(encoder | None, field(about)))
    top = sections.PairFile.model_fields
    file = whole(
        "file", sections.PairFile, pair=_with(top["pair"], pair, default=pair()), driving=_with(top["driving"], gear),
        driven=_with(top["driven"], gear), measurement=_with(top["measurement"], measurement | None),
    )  # fmt: skip
    return {one.__name__: one for one in (pair, encoder, measurement, gear, file)}


if not TYPE_CHECKING:
    Inspection = sections.Inspection
    globals().update(completed(catalogue().values()))
