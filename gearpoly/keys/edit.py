"""Pair files with other keys: copies, as if what is new had been stated."""

from __future__ import annotations

from typing import Any, get_args

from gearpoly.arguments import GEARS
from gearpoly.keys.sections import GearSection, PairFile, Section


def changed(section: Any, **keys: object) -> Any:
    """A copy of a section of the pair file with other ``keys``, as if they had been stated."""
    assert isinstance(section, Section)
    return section.model_copy(update=keys)


def on_gear(file: PairFile, gear: int | None, **keys: object) -> PairFile:
    """The pair file with other keys of one gear."""
    name = GEARS[gear or 0]
    copy: PairFile = changed(file, **{name: changed(getattr(file, name), **keys)})
    return copy


def on_pair(file: PairFile, **keys: object) -> PairFile:
    """The pair file with other keys of [pair]."""
    copy: PairFile = changed(file, pair=changed(file.pair, **keys))
    return copy


def table(section: Section, key: str) -> Any:
    """The table ``key`` of a section, an empty one where it has none."""
    kinds = (type(section).model_fields[key].annotation,)
    held = getattr(section, key)
    while held is None:
        held = next((one() for one in kinds if isinstance(one, type) and issubclass(one, Section)), None)
        kinds = tuple(part for one in kinds for part in get_args(one))
    return held


def gear_section(file: PairFile, gear: int | None) -> GearSection:
    """The section of gear 0 (driving) or 1."""
    return file.driving if gear in (0, None) else file.driven
