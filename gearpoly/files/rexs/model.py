"""A REXS model as it stands in any of its files: components with attributes, and relations between them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from gearpoly.errors import InputFileError, shown

Value = str | float | bool
"""An attribute's value: a number, a text or an enumeration's word, a truth."""

REXS_UNITS = {
    "mm": {"mm": 1.0, "mum": 1e-3, "um": 1e-3, "µm": 1e-3, "m": 1e3, "cm": 10.0, "in": 25.4},
    "mum": {"mum": 1.0, "um": 1.0, "µm": 1.0, "mm": 1e3},
    "deg": {"deg": 1.0, "°": 1.0, "rad": 180.0 / math.pi},
    "N m": {"N m": 1.0, "Nm": 1.0, "N mm": 1e-3, "kN m": 1e3},
    "1 / min": {"1 / min": 1.0, "1/min": 1.0},
    "none": {"none": 1.0, "": 1.0, "-": 1.0},
}
"""Units that an attribute may have, by the one that is wanted, and their size in it."""


@dataclass(frozen=True, kw_only=True)
class Attribute:
    """One value with its unit as the file states it."""

    value: Value
    unit: str = "none"


@dataclass(frozen=True, kw_only=True)
class Component:
    """A gear, a stage, a flank, a tool, ... with its attributes by id; lists and matrices are not kept."""

    id: int
    type: str
    name: str = ""
    attributes: Mapping[str, Attribute] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Relation:
    """Which components have to do with one another: their ids by role, in the file's order."""

    id: int
    type: str
    refs: tuple[tuple[str, int], ...]
    order: int | None = None

    def role(self, name: str) -> int | None:
        """The component in the role ``name``."""
        return next((one for role, one in self.refs if role == name), None)


@dataclass(frozen=True, kw_only=True)
class RexsModel:
    """All of a design. ``load_cases`` is how many load cases stand beside it; they are not kept."""

    file: Path
    version: str
    components: Mapping[int, Component]
    relations: tuple[Relation, ...]
    load_cases: int = 0

    def related(self, component: int, types: tuple[str, ...], kind: str) -> list[Component]:
        """Components of one ``kind`` that stand in a relation of ``types`` with ``component``, by the relations'
        order."""
        found: list[Component] = []
        for relation in sorted((one for one in self.relations if one.type in types), key=lambda one: one.order or 0):
            ids = [one for _, one in relation.refs]
            if component in ids:
                found += [self.components[one] for one in ids if self.components[one].type == kind]
        return found

    def number(self, component: Component, name: str, unit: str) -> float | None:
        """An attribute in ``unit``, or None. Raises ``InputFileError`` for another unit and for what is no number."""
        attribute = component.attributes.get(name)
        if attribute is None:
            return None
        size = REXS_UNITS[unit].get(attribute.unit)
        if size is None:
            raise self.fault(
                component,
                name,
                f'unit "{shown(attribute.unit)}"',
                f"want {' or '.join(filter(None, REXS_UNITS[unit]))}",
            )
        value = attribute.value
        if isinstance(value, str):
            text = value
            try:
                value = float(text)
            except ValueError:
                raise self.fault(component, name, f'"{shown(text)}"', "want a number") from None
        if isinstance(value, bool) or not math.isfinite(value):
            raise self.fault(component, name, shown(str(value)), "want a number")
        return size * value

    def truth(self, component: Component, name: str) -> bool | None:
        """An attribute that is true or false, or None."""
        attribute = component.attributes.get(name)
        if attribute is None:
            return None
        words: dict[object, bool] = {"true": True, "1": True, True: True, "false": False, "0": False, False: False}
        key = attribute.value.strip().lower() if isinstance(attribute.value, str) else attribute.value
        if key not in words:
            raise self.fault(component, name, f'"{shown(str(attribute.value))}"', "want true or false")
        return words[key]

    def fault(self, component: Component, name: str, found: str, wish: str) -> InputFileError:
        """The error for one attribute of a component."""
        return InputFileError(self.file, where=f"{called(component)}, {name}", found=found, wish=wish)


def called(component: Component) -> str:
    """A component as messages name it."""
    return f"{component.type} {component.id}" + (f' "{shown(component.name, width=40)}"' if component.name else "")
