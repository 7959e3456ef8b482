"""What any inspection sheet says of one gear, and what that is in a pair file: numbering, flanks and signs.

Left and right are those of ISO 1328-1: seen on the datum face, the tooth pointing up. Seen so, teeth are counted
clockwise or counter-clockwise, and teeth come into mesh clockwise where the gear turns counter-clockwise.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.gde import Profile, Side, Turn
from gearpoly.files.traces import Flank

Which = Literal["driving", "driven"]

SIDES: tuple[Side, Side] = ("left", "right")

DEVIATION_DECIMALS = 4
"""Decimals of a written deviation in um; machines resolve 1e-2 um."""


@dataclass(frozen=True, kw_only=True)
class MeasuredGear:
    """One gear as its sheet ``file`` has it; teeth in the sheet's order, tooth 1 first.

    ``geometry`` holds keys of a pair file (teeth, module_mm, ...) as far as the sheet states them. ``arcs`` (z,) say by
    side where each flank stands along the reference circle, in um, positive in the direction of counting (the F_p
    curve). ``material`` (z,) are index deviations in um, normal, positive = more material. ``profiles`` have teeth
    from 1. ``thickness`` is E_s in um. ``shapes`` are profile slopes and crownings in um by key and side, ``sizes``
    keys of an inspection that hold for the whole gear. ``count`` is None where the sheet does not say it. ``says``:
    what was taken for what, a sentence each.
    """

    file: Path
    name: str
    geometry: Mapping[str, float]
    count: Turn | None = None
    arcs: Mapping[Side, tuple[float, ...]] = field(default_factory=dict)
    material: Mapping[Side, tuple[float, ...]] = field(default_factory=dict)
    profiles: tuple[Profile, ...] = ()
    thickness: tuple[float, ...] | None = None
    shapes: Mapping[str, Mapping[Side, tuple[float, ...] | float]] = field(default_factory=dict)
    sizes: Mapping[str, float] = field(default_factory=dict)
    says: tuple[str, ...] = ()

    @property
    def z(self) -> int:
        """Number of teeth."""
        return int(self.geometry["teeth"])


@dataclass(frozen=True, kw_only=True)
class OwnTrace:
    """One measured profile in gearpoly's numbering: tooth from 0 in the order of meshing, mm and um."""

    tooth: int
    flank: Flank
    roll_length: tuple[float, ...]
    deviation: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Translated:
    """Keys of ``[driving.inspection]``, traces for its ``profile_csv``, and what was taken for what."""

    keys: dict[str, object]
    traces: tuple[OwnTrace, ...]
    says: tuple[str, ...]


def translated(sheet: MeasuredGear, *, which: Which, drive: Side) -> Translated:
    """``sheet`` as the inspection of the ``which`` gear, whose ``drive`` side is the drive flank.

    Raises ``InputFileError`` asking for the direction of counting where it matters and nobody stated it.
    """
    by_tooth = [sheet.arcs, sheet.material, sheet.profiles, sheet.thickness]
    listed = any(isinstance(value, tuple) for sides in sheet.shapes.values() for value in sides.values())
    order, sense = list(range(sheet.z)), 1.0
    if any(by_tooth) or listed:
        order, sense = _order(sheet, which, drive)
    keys: dict[str, object] = {}
    flanks: dict[Side, str] = {side: "" if side == drive else "_coast" for side in SIDES}
    for side in (drive, *(one for one in SIDES if one != drive)):
        if side in sheet.arcs:
            places = sense * np.asarray(sheet.arcs[side], dtype=np.float64)[order]
            keys[f"single_pitch{flanks[side]}_um"] = _row(places - np.roll(places, 1))
        if side in sheet.material:
            keys[f"pitch{flanks[side]}_um"] = _row(np.asarray(sheet.material[side], dtype=np.float64)[order])
    says: list[str] = []
    if drive not in sheet.arcs and drive not in sheet.material and (sheet.arcs or sheet.material):
        says.append(f"the {drive} flank, which drives, has no pitch in the file; only the coast flank's is taken")
    if sheet.thickness is not None:
        keys["tooth_thickness_um"] = _row(np.asarray(sheet.thickness, dtype=np.float64)[order])
    place = {index: k for k, index in enumerate(order)}
    traces = tuple(
        sorted(
            (
                OwnTrace(
                    tooth=place[one.tooth - 1],
                    flank="drive" if one.flank == drive else "coast",
                    roll_length=one.roll_length,
                    deviation=one.deviation,
                )
                for one in sheet.profiles
            ),
            key=lambda trace: (trace.tooth, trace.flank != "drive"),
        )
    )
    for side in SIDES:
        for key, sides in sheet.shapes.items():
            if side in sides:
                value = sides[side]
                listed_value = (
                    _row(np.asarray(value)[order]) if isinstance(value, tuple) else round(value, DEVIATION_DECIMALS)
                )
                keys[key.replace("_um", f"{flanks[side]}_um")] = listed_value
    says += _others(keys, traces, sheet.z)
    if sheet.thickness is None and not sheet.sizes and not sheet.material:
        says.append(
            "it states no tooth thickness: the nominal one is taken; state span_mm, over_pins_mm or tooth_thickness_um"
        )
    return Translated(keys=keys | dict(sheet.sizes), traces=traces, says=(*sheet.says, *says))


def _order(sheet: MeasuredGear, which: Which, drive: Side) -> tuple[list[int], float]:
    """For each tooth in the order of meshing its index in the sheet, and whether both orders run alike (1 or -1).

    The driving gear pushes with its drive flank: with the left one it turns counter-clockwise seen on the datum face,
    so its teeth come clockwise. The driven gear is pushed on its left flank clockwise, and its teeth come the other
    way (derived here).
    """
    if sheet.count is None:
        raise InputFileError(
            sheet.file,
            found="it does not say in which direction teeth are counted",
            wish="say --count clockwise or counterclockwise, seen on the datum face; ISO 1328-1 counts clockwise",
        )
    meshing = "clockwise" if (which == "driving") == (drive == "left") else "counterclockwise"
    sense = 1 if sheet.count == meshing else -1
    return [(sense * k) % sheet.z for k in range(sheet.z)], float(sense)


def _row(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> tuple[float, ...]:
    return tuple(round(float(value), DEVIATION_DECIMALS) + 0.0 for value in values)


def _others(keys: dict[str, object], traces: Sequence[OwnTrace], z: int) -> list[str]:
    """Give the teeth without a trace the mean slope and crowning of those with one; in words."""
    says = []
    for flank, mark in (("drive", ""), ("coast", "_coast")):
        mine = [trace for trace in traces if trace.flank == flank]
        if not mine or len(mine) == z or f"profile_slope{mark}_um" in keys:
            continue
        fits = np.array([slope_and_crowning(trace.roll_length, trace.deviation) for trace in mine])
        slope, crowning = (round(float(value), DEVIATION_DECIMALS) for value in fits.mean(axis=0))
        keys[f"profile_slope{mark}_um"], keys[f"profile_crowning{mark}_um"] = slope, crowning
        says.append(
            f"{len(mine)} of {z} {flank} flanks have a profile; the others take their mean slope {slope:.2f} um and "
            f"crowning {crowning:.2f} um"
        )
    return says


def slope_and_crowning(roll_length: Sequence[float], deviation: Sequence[float]) -> tuple[float, float]:
    """Slope s and crowning c in um of one trace: least squares of s (u - 1/2) - c (2u - 1)^2 and a level, u from 0 to 1
    over the trace, weighted by the roll length that each point stands for."""
    l, d = np.asarray(roll_length, dtype=np.float64), np.asarray(deviation, dtype=np.float64)
    u = (l - l[0]) / (l[-1] - l[0])
    share = np.sqrt(0.5 * (np.concatenate(([0.0], np.diff(u))) + np.concatenate((np.diff(u), [0.0]))))
    shapes = np.stack((np.ones_like(u), u - 0.5, -((2.0 * u - 1.0) ** 2)), axis=1)[:, : min(3, l.size)]
    found = np.linalg.lstsq(shapes * share[:, None], d * share, rcond=None)[0]
    return float(found[1]), float(found[2]) if l.size > 2 else 0.0


def closed(file: Path, where: str, single: Sequence[float], *, digit: float) -> tuple[float, ...]:
    """Places (z,) in um along the circle of single pitch deviations in um, printed in steps of ``digit`` um.

    Raises ``InputFileError`` where they do not add up to 0 round the gear but for rounding.
    """
    sum_ = sum(single)
    if abs(sum_) > len(single) * max(0.5 * digit, 0.05):
        found = f"single pitches f_p that add up to {sum_:.3g} um"
        wish = "want deviations from the mean pitch, which add up to 0 round the gear; was every tooth measured?"
        raise InputFileError(file, where=where, found=found, wish=wish)
    return tuple(itertools.accumulate(single))
