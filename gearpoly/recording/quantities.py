"""Units as owners write them: the dimension that each has, and its size in the unit that recordings are kept in.

Sizes: SI Brochure (2019) and its list of accepted units; kgf = 9.80665 N (CGPM 1901), lbf = 4.4482216152605 N and
inch = 25.4 mm (international yard and pound, 1959); gon = turn/400 (ISO 80000-3).
"""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import dataclass

ANGLE, TIME, TORQUE, SPEED, LENGTH, COUNT = "angle", "time", "torque", "speed", "length", "count"

UNIT_OF_DIMENSION = {ANGLE: "deg", TIME: "s", TORQUE: "N.m", SPEED: "rpm", LENGTH: "um", COUNT: "1"}
"""The unit of each dimension in which sizes are given below."""

_LBF, _KGF, _INCH = 4.4482216152605, 9.80665, 0.0254

_TABLE: dict[str, dict[str, tuple[float, str]]] = {
    ANGLE: {
        "deg": (1.0, "degree degrees ° º degre degres grado grados gradi"),
        "arcmin": (1.0 / 60.0, "arcmins arcminute arcminutes ' \u2032 moa"),
        "arcsec": (1.0 / 3600.0, 'arcsecs arcsecond arcseconds arc-sec " ″ asec'),
        "rad": (180.0 / math.pi, "radian radians radiant"),
        "mrad": (0.18 / math.pi, "milliradian milliradians"),
        "urad": (0.18e-3 / math.pi, "µrad microradian microradians"),
        "mdeg": (1e-3, "millidegree millidegrees m°"),
        "rev": (360.0, "revs turn turns revolution revolutions umdr umdrehung umdrehungen tour tours giro giri"),
        "gon": (0.9, "gons"),
        "mgon": (0.9e-3, ""),
    },
    TIME: {
        "s": (1.0, "sec secs second seconds sek sekunde sekunden seconde secondes segundo segundos secondo secondi"),
        "ms": (1e-3, "msec millisecond milliseconds"),
        "us": (1e-6, "µs usec microsecond microseconds"),
        "ns": (1e-9, "nanosecond nanoseconds"),
        "min": (60.0, "minute minutes minuten"),
        "h": (3600.0, "hour hours hr std stunden"),
        "d": (86400.0, "day days tag tage jour jours"),
    },
    TORQUE: {
        "N.m": (1.0, "nm n-m newton.metre newton.metres newton.meter newton.meters"),
        "N.mm": (1e-3, "nmm n-mm"),
        "N.cm": (1e-2, "ncm n-cm"),
        "kN.m": (1e3, "knm kn-m"),
        "mN.m": (1e-3, "mnm mn-m"),
        "kgf.m": (_KGF, "kgfm kp.m kpm m.kgf kgf-m"),
        "kgf.cm": (0.01 * _KGF, "kgfcm kp.cm kpcm kgf-cm"),
        "lbf.ft": (12.0 * _INCH * _LBF, "ft.lbf lb.ft ft.lb ft-lb ft-lbf lb-ft lbf-ft lbft ftlb ft.lbs ft-lbs"),
        "in.lbf": (_INCH * _LBF, "lbf.in lb.in in.lb in-lb in-lbf lb-in lbf-in lbin inlb in.lbs in-lbs"),
        "in.ozf": (_INCH * _LBF / 16.0, "ozf.in oz.in in.oz in-oz oz-in ozin"),
    },
    SPEED: {
        "rpm": (
            1.0,
            "1/min r/min rev/min min-1 min^-1 min⁻¹ u/min umdr/min umdr./min tr/min tours/min giri/min"
            " upm revmin vueltas/min",
        ),
        "rev/s": (60.0, "rps 1/s s-1 s^-1 s⁻¹ u/s r/s hz tr/s giri/s"),
        "rad/s": (30.0 / math.pi, "rad.s-1 rad/sec"),
        "deg/s": (1.0 / 6.0, "°/s deg/sec degree/s"),
    },
    LENGTH: {
        "um": (1.0, "µm micrometre micrometres micrometer micrometers micron microns mikrometer"),
        "mm": (1e3, "millimetre millimetres millimeter"),
        "nm": (1e-3, "nanometre nanometres nanometer"),
        "m": (1e6, "metre meter"),
        "in": (25400.0, "inch inches zoll"),
        "mil": (25.4, "thou mils"),
    },
    COUNT: {"1": (1.0, "count counts inc incs inkremente impulse pulses ticks cts bit volt v level")},
}


@dataclass(frozen=True, kw_only=True)
class Unit:
    """One unit: its ``name``, its ``dimension``, and its ``size`` in the unit of ``UNIT_OF_DIMENSION`` for that
    dimension."""

    name: str
    dimension: str
    size: float


UNITS = {
    dimension: {name: Unit(name=name, dimension=dimension, size=size) for name, (size, _) in rows.items()}
    for dimension, rows in _TABLE.items()
}
"""Every unit by dimension and name."""

UNSTATED = ("", "none", "-", "--", "n/a", "unknown", "[]", "()")
"""What stands in the place of a unit where none is stated."""

DOUBTFUL = {"grad": ("deg", "gon")}
"""Spellings of two meanings: Grad is a degree in German, grad a gon in English."""

_MILLI = ("mrad", "mdeg", "mgon", "ms", "mN.m", "mm")


def _plain(text: str) -> str:
    """A spelling without blanks, with one sign for the micro and the product."""
    text = unicodedata.normalize("NFC", text.strip()).replace("μ", "µ")
    text = re.sub(r"\s*[·⋅*\u00d7∙]\s*|(?<=[A-Za-z])\s+(?=[A-Za-z])", ".", text)
    return re.sub(r"\s+", "", text)


_BY_SPELLING: dict[str, dict[str, Unit]] = {
    dimension: {
        spelling.lower(): UNITS[dimension][name]
        for name, (_, others) in rows.items()
        for spelling in (name, *others.split())
    }
    for dimension, rows in _TABLE.items()
}


_MULTIPLE = re.compile(r"(1/)?(\d{1,6}(?:[.,]\d{1,9})?(?:[eE][+-]?\d{1,2})?)[.*x\u00d7\u00b7]?([^\d.,/+-].*)")
"""A number before a unit: 0.01 deg, 1/10 deg, 1e-3 rad."""

_OF_A_RANGE = (TORQUE, SPEED)
"""Dimensions of which a number above 1 before a unit is what a sensor reaches, as of one that is called T12/100Nm."""


def units_written(text: str) -> tuple[Unit, ...]:
    """Every unit that ``text`` may mean, one a dimension (``nm`` is a torque or a length); none where it is not known.
    A number before a unit makes a multiple of it (0.01 deg).

    Case says nothing, but for an M before small letters, which is no milli.
    """
    plain = _plain(text)
    found = (spellings.get(plain.lower()) for spellings in _BY_SPELLING.values())
    mega = plain[:1] == "M" and plain != plain.upper()
    units = tuple(one for one in found if one is not None and not (mega and one.name in _MILLI))
    many = _MULTIPLE.fullmatch(plain) if not units else None
    if many is None:
        return units
    number = float(many[2].replace(",", "."))
    if number == 0.0:
        return ()
    factor = 1.0 / number if many[1] else number
    called = f"{factor:.9g}"
    if float(called) != factor:  # a map states the unit again: 1/3600 deg is no decimal number
        called = f"{many[1] or ''}{number:.15g}"
    return tuple(
        Unit(name=f"{called} {one.name}", dimension=one.dimension, size=factor * one.size)
        for one in units_written(many[3])
        if one.dimension != COUNT and not one.name[:1].isdigit()
        if factor <= 1.0 or one.dimension not in _OF_A_RANGE
    )


def unit_written(text: str, dimension: str) -> Unit | None:
    """The unit of ``dimension`` that ``text`` means, or ``None``."""
    return next((one for one in units_written(text) if one.dimension == dimension), None)


def is_per_second(text: str) -> bool:
    """Whether ``text`` is 1/s, which says of a speed whether turns or radians are meant as little as s^-1 does."""
    return _plain(text).lower() in ("1/s", "s-1", "s^-1", "s\u207b\u00b9")


def known_units(dimension: str) -> str:
    """The names of the units of a dimension, for a message."""
    return ", ".join(UNITS[dimension])


DIMENSIONS = {"deg": ANGLE, "arcsec": ANGLE, "urad": ANGLE, "s": TIME, "nm": TORQUE, "rpm": SPEED, "um": LENGTH}
"""Dimension by the ending of a column's name; other columns are counts and levels."""


def column_unit(column: str) -> Unit:
    """The unit in which recordings keep ``column``: that of its name's ending, or a plain number."""
    ending = column.rpartition("_")[2]
    if ending not in DIMENSIONS:
        return UNITS[COUNT]["1"]
    return UNITS[DIMENSIONS[ending]]["N.m" if ending == "nm" else ending]


def in_another_unit(stated: str, column: str) -> bool:
    """Whether ``stated`` is a unit of what ``column`` holds, and another one than recordings keep it in."""
    wanted = column_unit(column)
    unit = unit_written(stated, wanted.dimension) if stated and wanted.dimension != COUNT else None
    return unit is not None and unit != wanted
