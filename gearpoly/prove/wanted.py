"""What a careful expert could say of a case: what is to be named, and what is to be located and no more."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.prove.thresholds import Thresholds
from gearpoly.prove.truth import WRONG_FILE, Item, Truth
from gearpoly.proving.physics import PHYSICS_BY_NAME

ANY = "any"


def to_be_named(truth: Truth, limits: Thresholds) -> tuple[Item, ...]:
    """Effects that the recordings tell from every rival, and from an unknown at their place."""
    if truth.must_name is not None:
        return truth.must_name
    if truth.kind == WRONG_FILE:
        return ()
    return tuple(item for item in truth.items if item.physics and item.earned(limits))


def to_be_located(truth: Truth, limits: Thresholds) -> tuple[Item, ...]:
    """Places of whatever else is large enough to be detected: effects that are not told from all else, what is outside
    the catalogue, and waves of a background."""
    if truth.must_locate is not None:
        return truth.must_locate
    if truth.kind == WRONG_FILE:
        return ()
    named = to_be_named(truth, limits)
    every = (*(item for item in truth.items if item not in named), *truth.background)
    return tuple(place_of(item) for item in every if item.over_limit >= limits.detected_from)


def unsaid(truth: Truth) -> int:
    """Effects of which the truth does not say how near an unknown comes; none is to be named."""
    return sum(bool(item.physics) and item.unknown is None for item in truth.items)


def place_of(item: Item) -> Item:
    """Where an effect is, as a verdict's entry would say: its ``kind``."""
    place = PHYSICS_BY_NAME[item.physics].place if item.physics in PHYSICS_BY_NAME else ""
    if item.hz is not None:
        return replace(item, kind="time")
    if item.tooth is not None or place == "tooth":
        return replace(item, kind="tooth")
    if item.order is not None or place == "wave":
        return replace(item, kind="shaft_order", order=item.order or 1.0)
    if place == "mesh" and item.gear is not None:
        return replace(item, kind="mesh_order", order=1.0)
    return replace(item, kind=ANY)
