"""Keys of the pair file in words with units, as the page of a study has them."""

from __future__ import annotations

import re
from collections.abc import Iterable

from gearpoly.arguments import GEARS
from gearpoly.study.models import Sweep

KEY_UNITS = {
    "um_per_nm": "um/(N.m)",
    "urad_per_nm": "urad/(N.m)",
    "urad": "urad",
    "um": "um",
    "mm": "mm",
    "deg": "deg",
    "nm": "N.m",
    "gpa": "GPa",
    "hz": "Hz",
    "rpm": "rpm",
    "s": "s",
}
"""Ends of keys that are units, longer ones first."""


def key_words(key: str) -> tuple[str, str]:
    """A dotted key of the pair file in words, and its unit (empty where it has none): ``driving.tip_relief.amount_um``
    is the tip relief amount of the driving gear, in um."""
    *path, last = key.split(".")
    unit = next((end for end in KEY_UNITS if last.endswith(f"_{end}")), "")
    gear = path.pop(0) if path and path[0] in GEARS else ""
    above = [part for part in path if part not in ("pair", "model", "limits")]
    name = " ".join(_spaced(part) for part in (*above, last.removesuffix(f"_{unit}")))
    return f"{name} of the {gear} gear" if gear else name, KEY_UNITS.get(unit, "")


def _spaced(part: str) -> str:
    """A part of a key in words; symbols of the standards keep their form: ``E_sns``."""
    return part if re.match(r"[A-Za-z]_", part) else part.replace("_", " ")


def sweep_name(sweep: Sweep) -> str:
    """A short name of what a sweep varies: common parts of its keys once."""
    keys = sweep.all_keys
    if sweep.name is not None:
        return sweep.name
    if len(keys) == 1:
        return keys[0]
    first = keys[0].split(".")[-1]
    return first if len(keys) == 2 and keys[1].endswith("." + first) else f"{first} and {len(keys) - 1} more"


def sweep_words(sweep: Sweep) -> tuple[str, str]:
    """What a sweep varies, by the name that its file gives it or by its keys, and the unit of its values."""
    words, unit = key_words(sweep.all_keys[0])
    if sweep.name is not None:
        return sweep.name, unit
    bare = {key.removeprefix("driving.").removeprefix("driven.") for key in sweep.all_keys}
    if len(sweep.all_keys) == 2 and len(bare) == 1:
        return f"{words.partition(' of the ')[0]} of both gears", unit
    return words if len(sweep.all_keys) == 1 else f"{words} and {len(sweep.all_keys) - 1} more", unit


def with_unit(sweep: Sweep) -> str:
    """The same for an axis."""
    words, unit = sweep_words(sweep)
    return f"{words} / {unit}" if unit else words


def factor_words(sweeps: Iterable[Sweep]) -> dict[str, str]:
    """The words of every factor by the name that tables and the JSON have for it."""
    return {sweep_name(sweep): sweep_words(sweep)[0] for sweep in sweeps}
