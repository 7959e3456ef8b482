"""The fields of a truth file, each of its kind or refused: others write these files too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

GEAR_OF_NUMBER_OR_NAME = {1: "driving", 2: "driven", "driving": "driving", "driven": "driven"}

LONGEST_LIST = 10_000
"""Entries of a list. A case conceals a handful of effects; without a bound a file of 10 MB would have a million."""


@dataclass(frozen=True)
class Fields:
    """One object of a JSON or TOML file. Every method raises ``ValueError`` that names the field of another kind."""

    raw: dict[str, Any]
    where: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.raw, dict):
            raise ValueError(f"{self.where or 'the whole'} is no object")

    def _wrong(self, name: str, wish: str) -> ValueError:
        return ValueError(f"{self.where}{name} is not {wish}" if name in self.raw else f"no {self.where}{name}")

    def word(self, name: str, default: str | None = None) -> str:
        """A text."""
        value = self.raw.get(name, default)
        if not isinstance(value, str):
            raise self._wrong(name, "a text")
        return value

    def number(self, name: str) -> float | None:
        """A number (infinite too), or None where there is none."""
        value = self.raw.get(name)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, int | float) or value != value:
            raise self._wrong(name, "a number")
        try:
            return float(value)
        except OverflowError:
            raise self._wrong(name, "a number of ordinary size") from None

    def needed(self, name: str) -> float:
        """A number that has to be there."""
        value = self.number(name)
        if value is None:
            raise self._wrong(name, "a number")
        return value

    def whole(self, name: str) -> int | None:
        """A whole number from 0, or None where there is none."""
        value = self.number(name)
        if value is not None and not (value >= 0.0 and value.is_integer()):
            raise self._wrong(name, "a whole number")
        return None if value is None else int(value)

    def gear(self) -> str | None:
        """``driving`` or ``driven``, also where the file says 1 or 2; None where it names no gear."""
        value = self.raw.get("gear")
        if not value:
            return None
        if isinstance(value, str | int) and value in GEAR_OF_NUMBER_OR_NAME:
            return GEAR_OF_NUMBER_OR_NAME[value]
        raise self._wrong("gear", "driving or driven")

    def values(self, name: str) -> list[Any]:
        """A list; empty where there is none."""
        value = self.raw.get(name, [])
        if not isinstance(value, list) or len(value) > LONGEST_LIST:
            raise self._wrong(name, f"a list of at most {LONGEST_LIST} entries")
        return value

    def numbers(self, name: str) -> tuple[float, ...]:
        """A list of numbers."""
        return tuple(Fields({name: one}, self.where).needed(name) for one in self.values(name))

    def entries(self, name: str, *, needed: bool = False) -> Iterator[Fields]:
        """A list of objects, which may be empty; where it is ``needed`` it has to be there."""
        if needed and name not in self.raw:
            raise self._wrong(name, f"a list of at most {LONGEST_LIST} entries")
        for k, one in enumerate(self.values(name)):
            yield Fields(one, f"{self.where}{name}[{k}].")

    def inner(self, name: str) -> Fields:
        """An object; empty where there is none."""
        return Fields(self.raw.get(name, {}), f"{self.where}{name}.")
