"""What a wave of a pair behind a telescope's worm does on the sky, in arcsec, and how often it comes, in s.

A transmission error x along the line of action is the angle x / r_b2 of the driven gear, which turns the worm. The worm
moves its wheel by one tooth a turn, so the axis is off by x / (r_b2 z_w), z_w being the teeth of the worm wheel, and a
star on the celestial equator with it; at the declination delta it is off by cos(delta) of that. Derived here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.also_turns import SAME_ORDER_SIGMAS, relative_std
from gearpoly.compare.beside import BesideSimulation
from gearpoly.compare.entries import Entry
from gearpoly.keys.also_turns import HALF_A_LINE, LOW_ORDERS_OF_PART, PART_MESH_ORDERS, Part, lines_at
from gearpoly.recording.worm import worm_period
from gearpoly.units import ARCSEC, UM


@dataclass(frozen=True, kw_only=True)
class Sky:
    """A telescope behind the pair: ``arcsec_per_um`` along the line of action, ``seconds`` per turn of the driven gear,
    the teeth ``z`` of both gears, the other ``parts`` of the drive, and the ``turns`` of the driven gear in the longest
    recording."""

    arcsec_per_um: float
    seconds: float
    z: tuple[int, int]
    parts: tuple[Part, ...] = ()
    turns: float = 0.0

    def arcsec(self, um: float) -> float:
        """What ``um`` along the line of action are on the celestial equator."""
        return um * self.arcsec_per_um

    def period(self, *, gear: str | None, order: float) -> float:
        """Seconds per wave of ``order`` per turn of a ``gear``, or per mesh where it is of none."""
        per_driven = {"driven": 1.0, "driving": self.z[1] / self.z[0]}.get(gear or "", float(self.z[1]))
        return self.seconds / (order * per_driven)

    def period_of(self, entry: Entry) -> float | None:
        """Seconds per wave of an ``entry``; ``None`` where it is none."""
        if entry.kind == "time":
            return 1.0 / entry.hz if entry.hz and entry.burst is None else None
        if entry.kind in ("shaft_order", "mesh_order") and entry.order:
            return self.period(gear=entry.gear if entry.kind == "shaft_order" else None, order=entry.order)
        return None

    def names(self, entry: Entry) -> tuple[str, ...]:
        """What of the drive comes as often as the wave of an ``entry``, to half a line of the recording: the mesh, a
        gear's or the worm's turn, and what the pair file states beside them."""
        period = self.period_of(entry)
        if period is None or self.turns <= 0.0:
            return ()
        order = self.seconds / period
        within = max(HALF_A_LINE / self.turns, order * SAME_ORDER_SIGMAS * relative_std(entry))
        found = [
            words if k == 1 else f"order {k} of {gear}" if gear else f"mesh order {k}"
            for words, gear, base, most in (
                ("the mesh", "", float(self.z[1]), PART_MESH_ORDERS),
                ("the driving gear's turn", "the driving gear", self.z[1] / self.z[0], LOW_ORDERS_OF_PART),
                ("the worm's turn", "the worm", 1.0, LOW_ORDERS_OF_PART),
            )
            if 1 <= (k := round(order / base)) <= most and abs(order - k * base) <= within
        ]
        return (*found, *lines_at(self.parts, order, turns=HALF_A_LINE / within))

    def to_json(self, entry: Entry) -> dict[str, object]:
        """The sizes of an ``entry`` in arcsec, its period in s, and what comes as often, beside what the contract
        has."""
        sizes = {"amplitude": entry.amplitude_um, "std": entry.std_um, "rms": entry.rms_um}
        out: dict[str, object] = {f"{name}_arcsec": self.arcsec(um) for name, um in sizes.items() if um is not None}
        period, names = self.period_of(entry), self.names(entry)
        if names:
            out["as_often_as"] = list(names)
        return out if period is None else {**out, "period_s": period}

    def says(self, entry: Entry) -> str:
        """How often an ``entry`` comes and how large it is on the sky, in words."""
        size = entry.rms_um if entry.amplitude_um is None else abs(entry.amplitude_um)
        parts = [] if (period := self.period_of(entry)) is None else [f"every {seconds_words(period)}"]
        names = self.names(entry)
        if names and not (entry.kind == "mesh_order" and len(names) == 1):
            parts.append(f"as often as {' or '.join(names)}")
        if size is not None:
            rms = " rms" if entry.amplitude_um is None else ""
            parts.append(f"{arcsec_words(self.arcsec(size))}{rms} on the sky")
        return ", ".join(parts)


def sky_of(beside: BesideSimulation) -> Sky | None:
    """The sky that recordings were made on; ``None`` where the pair file states no worm."""
    if beside.worm is None:
        return None
    pair = beside.assembled.pair
    seconds = worm_period(beside.worm)
    turns = 0.0
    timed = [one for one in beside.aligned if one.time_s is not None]
    if timed:
        longest = max(timed, key=lambda one: float(np.ptp(one.theta_2)))
        assert longest.time_s is not None
        turns = float(np.ptp(longest.theta_2)) / (2.0 * math.pi)
        seconds = float(np.ptp(longest.time_s)) / turns
    return Sky(
        arcsec_per_um=UM / pair.r_b2 / beside.worm.wheel_teeth / ARCSEC,
        seconds=seconds,
        z=(pair.driving.gear.z, pair.driven.gear.z),
        parts=beside.parts,
        turns=turns,
    )


def seconds_words(seconds: float) -> str:
    """A period to three figures."""
    return f"{seconds:.0f} s" if seconds >= 100.0 else f"{seconds:.3g} s"


def arcsec_words(arcsec: float) -> str:
    """An angle to two figures."""
    return f"{arcsec:.0f} arcsec" if arcsec >= 10.0 else f"{arcsec:.2g} arcsec"
