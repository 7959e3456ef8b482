"""Figures of a diagnosis as a reader sees them: as many digits as their error allows, with units."""

from __future__ import annotations

import math

from gearpoly.report.diagnosis_report import LEAST_STD_SHARE, WHOLE_NUMBERS

UNIT_ENDINGS = {
    "_um_per_n": "µm/N",
    "_urad_per_nm": "µrad/(N·m)",
    "_urad": "µrad",
    "_um": "µm",
    "_deg": "°",
    "_mm": "mm",
    "_hz": "Hz",
}
"""What the ends of the contract's parameter names stand for, longer ends first."""

MINUS = "\u2212"
"""The minus sign of print, as wide as a plus."""

NARROW_SPACE = "\u202f"
"""The narrow space, at which no line ends, between groups of three figures."""

NONE = "\u2013"
"""Stands where there is no value."""

LEAST_CHANCE = 1e-300
"""Below this a chance is given as a bound: floating point ends there."""

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float | None, digits: int) -> str:
    """``value`` with that many decimals and a true minus sign; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return NONE
    text = f"{abs(value):.{digits}f}"
    return (MINUS if value < 0.0 and float(text) != 0.0 else "") + text


def large(value: float) -> str:
    """``value`` with one decimal below 100, and from there on whole, in groups of three with narrow spaces."""
    if abs(value) < 100.0:
        return number(value, 1)
    return (MINUS if value < 0.0 else "") + f"{abs(value):,.0f}".replace(",", NARROW_SPACE)


def measured(value: float, std: float) -> str:
    """Value and standard error, both to two figures of the error; without one, to four figures of the value."""
    if not math.isfinite(std) or std <= LEAST_STD_SHARE * abs(value):
        digits = 3 if value == 0.0 else max(0, min(9, 3 - math.floor(math.log10(abs(value)))))
        return number(value, digits)
    digits = max(0, min(9, 1 - math.floor(math.log10(std))))
    return f"{number(value, digits)} ± {number(std, digits)}"


def parameter(name: str, value: float, std: float) -> tuple[str, str]:
    """The contract's parameter as a plain name and as its value with error and unit."""
    if name in WHOLE_NUMBERS:
        return name, number(value, 0)
    for end, unit in UNIT_ENDINGS.items():
        if name.endswith(end):
            gap = "" if unit == "°" else " "
            shown = measured(value, std)
            if "±" in shown:
                shown = f"({shown})"
            return name[: -len(end)].replace("_", " "), f"{shown}{gap}{unit}"
    return name.replace("_", " "), measured(value, std)


def chance(p: float) -> str:
    """A probability: plain where a reader can picture it, else as a power of ten."""
    if p < LEAST_CHANCE:
        return f"below {_power(math.log10(LEAST_CHANCE))}"
    if p >= 1e-3:
        return f"{p:.2g}"
    power = math.floor(math.log10(p))
    front = round(p * 10.0**-power)
    # 9.7e-5 is rounded to one figure, 10, which is one of the next power.
    if front == 10:
        front, power = 1, power + 1
    return f"{front}·{_power(power)}"


def _power(exponent: float) -> str:
    return "10" + str(round(exponent)).translate(_RAISED)


def capital(text: str) -> str:
    """``text`` with a capital first letter."""
    return text[:1].upper() + text[1:]


def physics_words(name: str) -> str:
    """A physics' name as words."""
    return name.replace("_", " ")
