"""Many whole orders of one shaft that add up at one angle of it: the sharp shape of one tooth, not as many waves.

An edge of a spall or of a broken corner that teeth as built have otherwise taken up is left as a comb of orders, each
small. Waves of no common cause have phases at random; those of one tooth have them such that nearly all lies within its
pitch. Against the first the phases are drawn at random (Theiler et al. 1992, Physica D 58, 77).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from gearpoly.arguments import GEARS
from gearpoly.compare.entries import Entry, named
from gearpoly.units import FloatArray

FEWEST_ORDERS = 8
"""Orders that a comb has at least: fewer hardly make anything as narrow as a tooth."""

DRAWS = 999
"""Draws of phases at random, of which none may come together as closely: a chance of one in a thousand."""

NARROW_POWER_PART = 0.2
"""Part of their power that orders must have within one pitch: those of a spall of which teeth as built had taken up the
most had 0.33. A judgement."""

PER_ORDER = 8
"""Places for each wave of the highest order, and for each tooth at least."""

Encoder = Callable[[int, int], float | None]
"""Encoder reading in deg at which a tooth of gear 0 or 1 passes the line of centres."""


def of_one_tooth(
    entries: Sequence[Entry], *, z: tuple[int, int], numbered: tuple[bool, bool], encoder_deg: Encoder
) -> list[Entry]:
    """The ``entries`` with the orders of a shaft that make a comb in the company of the tooth whose shape they are,
    told with them where it was not."""
    out = list(entries)
    for gear, name in enumerate(GEARS):
        lines = [k for k, one in enumerate(out) if one.gear == name and _is_line(one)]
        if len(lines) < FEWEST_ORDERS:
            continue
        found = _place([out[k] for k in lines], z=z[gear])
        if found is None:
            continue
        tooth, rms = found
        reading = encoder_deg(gear, tooth)
        told = [one for one in out if one.kind == "tooth" and one.gear == name and one.encoder_deg == reading]
        strongest = max((out[k] for k in lines), key=lambda one: one.gain)
        mine = told[0] if told else Entry(
            kind="tooth", gear=name, tooth=tooth if numbered[gear] else None, encoder_deg=reading, rms_um=rms,
            recordings=strongest.recordings, p_value=strongest.p_value, gain=sum(out[k].gain for k in lines),
            label=f"sharp: {len(lines)} orders of its shaft meet there",
        )  # fmt: skip
        for k in lines:
            out[k] = replace(out[k], companion_of=named(mine))
        if not told:
            out.insert(0, mine)
    return out


def told_so(where: Sequence[Entry], told: Sequence[Entry]) -> list[Entry]:
    """The entries of ``where`` with the orders that ``told`` has in the company of a tooth in that company too, and
    the teeth that only the second has."""
    company = {(one.gear, one.order): one.companion_of for one in told if one.kind == "shaft_order"}
    out = [
        replace(one, companion_of=company.get((one.gear, one.order), one.companion_of)) if _is_line(one) else one
        for one in where
    ]
    places = {(one.gear, one.encoder_deg) for one in where if one.kind == "tooth"}
    return [*out, *(one for one in told if one.kind == "tooth" and (one.gear, one.encoder_deg) not in places)]


def _is_line(one: Entry) -> bool:
    """Whether an entry is a whole order that belongs to nothing yet."""
    whole = one.kind == "shaft_order" and one.order_std is None and float(one.order or 0.5).is_integer()
    return whole and one.companion_of is None and not one.parts and one.phase_deg is not None


def _place(lines: Sequence[Entry], *, z: int) -> tuple[int, float] | None:
    """The tooth in whose pitch orders of its shaft come together, and their rms in um over that pitch; None where
    waves of any phases would."""
    orders = np.array([round(one.order or 0.0) for one in lines])
    waves = np.array([one.amplitude_um or 0.0 for one in lines]) * np.exp(
        -1j * np.radians([one.phase_deg or 0.0 for one in lines])
    )
    places = z * max(PER_ORDER, math.ceil(PER_ORDER * int(np.max(orders)) / z))

    def within(waves: FloatArray) -> FloatArray:
        """Part of the power within a pitch that is centred at every place."""
        spectrum = np.zeros(places, dtype=np.complex128)
        np.add.at(spectrum, orders, waves)
        power = np.real(np.fft.ifft(spectrum) * places) ** 2
        half = places // z // 2
        total = np.concatenate(([0.0], np.cumsum(np.concatenate((power[-half:], power, power[:half])))))
        return np.asarray((total[2 * half :] - total[: -2 * half])[:places] / np.sum(power))

    narrow = within(waves)
    at = int(np.argmax(narrow))
    if narrow[at] < NARROW_POWER_PART:
        return None
    rng = np.random.default_rng(0)
    for _ in range(DRAWS):
        if np.max(within(np.abs(waves) * np.exp(2j * np.pi * rng.random(waves.size)))) >= narrow[at]:
            return None
    rms = math.sqrt(0.5 * float(np.sum(np.abs(waves) ** 2)) * narrow[at] * z)
    return round(at * z / places) % z, rms
