"""Physics of other installed packages, taken into the catalogue once they are seen to be whole."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from gearpoly.gear.deviations import Deviations
from gearpoly.keys import sections
from gearpoly.keys.kinds import Section
from gearpoly.physics.base import Physics, Quantity
from gearpoly.physics.parts import Parts
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.plugins import PHYSICS_GROUP, Plugin, plugins
from gearpoly.units import FloatArray

TABLES: dict[str, type[Section]] = {
    "pair": sections.PairSection,
    "gear": sections.GearSection,
    "encoder": sections.Encoder,
    "measurement": sections.Measurement,
}
"""The tables of a pair file to which a physics may add keys."""

FUNCTION_RETURNS: dict[str, type] = {
    "shapes": Deviations,
    "build": Parts,
    "write": Section,
    "report": dict,
    "says": str,
    "places": Iterable,
    "instead": Iterable,
    "otherwise": Iterable,
}
"""What the functions of a physics give, where it is one thing."""


def brought(own: Mapping[str, Physics]) -> dict[str, Physics]:
    """The physics of installed packages by name, beside gearpoly's ``own``.

    Raises ``PluginError`` where one does not load, lacks a part, or has a name or key that another has.
    """
    found: dict[str, Physics] = {}
    for plugin in plugins(PHYSICS_GROUP):
        physics = plugin.load()
        if not isinstance(physics, Physics):
            raise plugin.fault(f"{type(physics).__name__}, not a gearpoly.physics.base.Physics")
        fault = plugin.call("it is not whole", _fault, physics) or _clash(physics, [*own.values(), *found.values()])
        if fault:
            raise plugin.fault(fault)
        found[physics.name] = _told(plugin, physics)
    return found


def _fault(physics: Physics) -> str:
    """What is wrong with a physics by itself, in words; empty where nothing is."""
    if not (isinstance(physics.name, str) and re.fullmatch(r"[a-z][a-z0-9_]*", physics.name)):
        return f'its name is "{physics.name}"; want small letters, digits and _'
    if not isinstance(physics.rank, int):
        return "its rank is no whole number"
    sizes = len(physics.coordinates)
    if not sizes or not all(isinstance(one, Quantity) for one in physics.coordinates):
        return "its coordinates are no Quantity each"
    if not 1 <= physics.amplitudes <= sizes or len(physics.ordinary) != physics.amplitudes:
        return f"of {sizes} coordinates {physics.amplitudes} are amplitudes, and its ordinary fault has " \
               f"{len(physics.ordinary)}"  # fmt: skip
    place, values = physics.case
    if not isinstance(place, Place) or len(values) != sizes:
        return f"its case is no Place with {sizes} values"
    if physics.effect is None and not physics.reloads:
        return "it has no effect; only what load and shafts do is simulated again for every place"
    if not physics.parameters:
        return "it has no parameters"
    for where, keys in physics.keys.items():
        if where not in TABLES:
            return f'it adds keys to "{where}"; want one of {", ".join(TABLES)}'
        if not (isinstance(keys, type) and issubclass(keys, Section)):
            return f'its keys of "{where}" are no gearpoly.keys.kinds.Section'
        required = [key for key, field in keys.model_fields.items() if field.is_required()]
        if required:
            return f"its key {required[0]} has no default, and no pair file without it would be read"
    return ""


def _clash(physics: Physics, others: Iterable[Physics]) -> str:
    """What of a physics is another's already, in words; empty where nothing is."""
    others = list(others)
    if physics.name in {one.name for one in others}:
        return f"there is a physics named {physics.name} already"
    for where, keys in physics.keys.items():
        taken = set(TABLES[where].model_fields)
        taken |= {key for one in others if where in one.keys for key in one.keys[where].model_fields}
        both = sorted(taken & set(keys.model_fields))
        if both:
            return f"the table of a {where} has a key {both[0]} already"
    return ""


def _told(plugin: Plugin, physics: Physics) -> Physics:
    """The physics, with whatever its functions get wrong told as a fault of its package."""
    held = {one.name: getattr(physics, one.name) for one in fields(physics)}
    functions: dict[str, Any] = {
        name: plugin.guarded(name, value, FUNCTION_RETURNS.get(name, object))
        for name, value in held.items()
        if callable(value)
    }
    if physics.effect is not None:
        functions["effect"] = _numbers(plugin, functions["effect"])
    return replace(
        physics,
        coordinates=tuple(
            replace(one, most=plugin.guarded(f"largest {one.name}", one.most)) for one in physics.coordinates
        ),
        **functions,
    )


def _numbers(plugin: Plugin, effect: Callable[..., Any]) -> Callable[[ContactsAtSamples, Place, Values], FloatArray]:
    """An ``effect`` that is one finite number for every sample."""

    def told(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
        made = plugin.call("its effect is no numbers", np.asarray, effect(scene, place, values), dtype=float)
        if made.shape != (scene.samples.size,) or not np.all(np.isfinite(made)):
            found = f"shape {made.shape}" if made.shape != (scene.samples.size,) else "numbers that are not finite"
            raise plugin.fault(f"its effect gave {found}; want {scene.samples.size} finite numbers")
        return np.asarray(made)

    return told
