"""Whether a verdict says what is true: physics, gear, order, tooth, and the place of what has no name."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from gearpoly.prove.thresholds import Thresholds
from gearpoly.prove.truth import Item, Truth

Entry = dict[str, Any]


def order_of(entry: Entry) -> float | None:
    """The order that an entry of a verdict states, if any."""
    stated = entry.get("parameters", {}).get("order", entry.get("order"))
    if isinstance(stated, dict):
        stated = stated.get("value")
    return None if stated is None else float(stated)


def names(entry: Entry, item: Item) -> bool:
    """Whether an entry of ``missing``, or a rival of one, has the true physics, gear and order, or one of the orders at
    which the samples show it alike."""
    if entry["physics"] != item.physics:
        return False
    if item.gear is not None and entry.get("gear") != item.gear:
        return False
    order = order_of(entry)
    return item.order is None or order is None or order in (item.order, *item.aliases)


def on_tooth(entry: Entry, item: Item, limits: Thresholds, *, claim: Entry) -> bool:
    """Whether an entry stands at the true tooth; true where there is none to find.

    The encoder reading decides. A rival without one is read by its number, as far as the verdict's ``claim``, whose
    rival it is, has one; a rival on the claim's own tooth stands where the claim does.
    """
    if item.tooth is None:
        return True
    reading = entry.get("encoder_deg")
    if reading is None and entry is not claim and entry.get("gear") == claim.get("gear"):
        same = entry.get("tooth") is None or claim.get("tooth") is None or entry["tooth"] == claim["tooth"]
        reading = claim.get("encoder_deg") if same else None
    if reading is not None and item.encoder_deg is not None and item.teeth:
        off = (reading - item.encoder_deg + 180.0) % 360.0 - 180.0
        return bool(abs(off) < limits.tooth * 360.0 / item.teeth)
    return entry.get("tooth") == item.tooth


def reported_set(claim: Entry) -> list[Entry]:
    """The claim and everything that it says it may be instead."""
    return [claim, *claim.get("indistinguishable_from", ())]


def acceptable(claim: Entry, item: Item, limits: Thresholds) -> bool:
    """Whether a claim is a rival within the evidence of the item, at its place."""
    for rival in item.acceptable(limits):
        if claim["physics"] != rival.physics or (rival.gear is not None and claim.get("gear") != rival.gear):
            continue
        if claim.get("gear") != item.gear or on_tooth(claim, item, limits, claim=claim):
            return True
    return False


def located(verdict: Entry, item: Item, truth: Truth, limits: Thresholds) -> bool:
    """Whether something from outside the catalogue is among what the verdict leaves unexplained, where it is."""
    return any(stands_at(entry, item, truth, limits) for entry in verdict.get("unexplained", ()))


def stands_at(entry: Entry, item: Item, truth: Truth, limits: Thresholds) -> bool:
    """Whether an entry of what the verdict leaves unexplained is where something from outside the catalogue is.

    An order is where it is within half a line of the recording's spectrum. Of a wave that a recording holds less of
    than one, nobody can tell the order: that something is slow there is all.
    """
    if item.shape == "jump" or (item.order is None and item.hz is None):
        return True
    if item.hz is not None:
        heard, told = (item.hz, *item.images_hz), [float(one) for one in TOLD_HZ.findall(_rivals(entry))]
        told += [entry.get("hz", 0.0)] if entry["kind"] in TIME_KINDS else []
        return any(abs(one - hz) < limits.hz for one in told for hz in heard)
    assert item.order is not None
    most = 1 if item.shape == "line" else limits.harmonics
    line = _line(item, truth)
    if item.order < line and entry["kind"] == "drift":
        return True
    within = max(limits.order, 0.5 * line)
    for gear, order in _orders(entry, truth):
        if gear == (item.gear or "driving"):
            places = [*(k * item.order for k in range(1, most + 1)), *item.aliases]
            if any(abs(order - place) < within for place in places):
                return True
    return False


def _line(item: Item, truth: Truth) -> float:
    """A line of the longest recording's spectrum, in orders of the shaft that the item counts by: one over its turns;
    0 where the truth does not say how long it is."""
    if not truth.hunting_cycles:
        return 0.0
    own = truth.z[1] if item.gear == "driven" else truth.z[0]
    return own / (truth.hunting_cycles * math.lcm(*truth.z))


TIME_KINDS = ("time", "tone")
MESH = ("mesh_order", "mesh_phase", "mesh_curve")
TOOTH = ("tooth", "tooth_curve")


def at_place(verdict: Entry, place: Item, truth: Truth, limits: Thresholds) -> bool:
    """Whether a verdict says that something is at a place, with a name or without."""
    entries = (*verdict.get("where", ()), *verdict.get("unexplained", ()))
    claims = verdict.get("missing", ())
    if place.kind == "any":
        return bool(entries or claims)
    if place.kind == "mesh_order":
        of_all = [one for one in claims if one.get("gear") and order_of(one) is None and "tooth" not in one]
        return bool(of_all) or any(one["kind"] in MESH for one in entries)
    if place.kind == "tooth":
        there = [one for one in entries if one["kind"] in TOOTH and one.get("gear", place.gear) == place.gear]
        there += [one for one in claims if "encoder_deg" in one and one.get("gear") == place.gear]
        return any(on_tooth(one, place, limits, claim=one) for one in there)
    waves = [{"kind": "shaft_order", "gear": one.get("gear"), "order": order_of(one) or 1.0} for one in claims
             if place.kind == "shaft_order"]  # fmt: skip
    line = replace(place, shape=place.shape or "line")  # a pulse has harmonics, a physics has its order
    return any(stands_at(one, line, truth, limits) for one in (*entries, *waves))


TOLD_HZ = re.compile(r"([\d.e+-]+) Hz")
TOLD_ORDER = re.compile(r"order ([\d.e+-]+) of the (driving|driven) shaft")
"""How an entry tells in words what it may be as well: at steady speed a wave over time is one over an angle."""


def _rivals(entry: Entry) -> str:
    """What an entry may be as well, in words; rivals of a claim are no words."""
    return "; ".join(one for one in entry.get("rivals", ()) if isinstance(one, str))


def _orders(entry: Entry, truth: Truth) -> Iterator[tuple[str, float]]:
    """The orders that an entry tells, as either shaft counts them."""
    told = [(float(order), gear) for order, gear in TOLD_ORDER.findall(_rivals(entry))]
    if entry["kind"] in ("shaft_order", "tone") and entry.get("order") is not None:
        told.insert(0, (float(entry["order"]), "driving" if entry.get("gear") == "driving" else "driven"))
    z_1, z_2 = truth.z
    for order, gear in told:
        if gear == "driving":
            yield from (("driving", order), ("driven", order * z_2 / z_1))
        else:
            yield from (("driving", order * z_1 / z_2), ("driven", order))
