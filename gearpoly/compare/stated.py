"""What recordings state of themselves, held against their own numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from gearpoly.compare.beside import Aligned
from gearpoly.errors import InputFileError
from gearpoly.recording.clean import Cleaned
from gearpoly.recording.recording import Recording
from gearpoly.units import RPM, FloatArray

STATED_SPEED_OFF_PART = 0.2
"""Part by which a stated speed may miss the one of the angles over their times: speeds are rounded, and wobble."""

SAME_UNIT = 0.1
"""Relative tolerance within which a mistaken unit is recognised."""

MISTAKEN_TIME_UNITS = ((1e-3, "are the times in ms?"), (1e3, "are the times in s?"))
"""The same as below of times, which are asked about where the pair file alone states a speed."""

MISTAKEN_UNIT_FACTORS = (
    (math.pi / 180.0, "are the angles in rad?"), *MISTAKEN_TIME_UNITS,
    (60.0, "is the speed in Hz?"), (30.0 / math.pi, "is the speed in rad/s?"),
)  # fmt: skip
"""Speed by angles and times over the stated one, where a unit is mistaken."""


def refuse_twins(cleaned: Sequence[Cleaned]) -> None:
    """Refuse recordings of which one is another once more: whatever it shows would count twice. Simulated ones of rigid
    teeth are the same under other torques, and say so.

    Raises ``InputFileError``.
    """
    for k, one in enumerate(cleaned):
        same = (o for o in cleaned[:k] if _alike(one.te, o.te) and _alike(one.theta_2, o.theta_2) and _met(one, o))
        twin = next(same, None)
        if twin is not None:
            found = f"the same samples as {twin.recording.source}"
            wish = "want every recording once, or what it shows counts twice"
            raise InputFileError(one.recording.source, found=found, wish=wish)


def refuse_apart(recordings: Sequence[Recording]) -> None:
    """Refuse a guided recording beside others: its angle is the clock's, from a zero of its own, and a mount may slew
    between. Means and teeth of such a set do not compare; a stated zero ties them together.

    Raises ``InputFileError``.
    """
    if len(recordings) < 2:
        return
    for one in recordings:
        for shaft in one.from_time:
            pulses, zero = getattr(one, f"{shaft}_correction_rad"), getattr(one, f"{shaft}_zero_rad")
            if pulses is not None and zero is None:
                found = f"a guided recording beside {len(recordings) - 1} more, whose {shaft} angle is the clock's"
                wish = f"want it alone, since nothing tells how far that shaft turned between them, or {shaft}_zero_deg"
                raise InputFileError(one.source, found=found, wish=wish)


def _met(one: Cleaned, other: Cleaned) -> bool:
    """Whether two recordings state the same conditions."""
    a, b = one.recording, other.recording
    return (a.torque_nm, a.speed_rpm, a.flank) == (b.torque_nm, b.speed_rpm, b.flank)


def _alike(one: FloatArray, other: FloatArray) -> bool:
    return one.size == other.size and np.array_equal(one, other)


def _middle(speed: FloatArray | None) -> float | None:
    """The middle one of recorded speeds (n,) in rpm, where there are any."""
    held = speed[np.isfinite(speed)] if speed is not None else np.empty(0)
    return float(np.median(held)) if held.size else None


def speed_remarks(aligned: Sequence[Aligned], *, of_pair: float | None = None) -> Iterator[str]:
    """Where a stated speed is not that of the angles over their times; the speed ``of_pair`` in rpm, which may be of
    other recordings, only where a mistaken unit explains it."""
    for k, one in enumerate(aligned):
        stated, time = one.cleaned.recording.speed_rpm, one.time_s
        stated = _middle(one.cleaned.speed_rpm) if stated is None else stated
        of_file, stated = stated is None, of_pair if stated is None else stated
        if not stated or stated < 0.0 or time is None or time[-1] <= time[0]:
            continue
        turning = abs(float(one.theta_1[-1] - one.theta_1[0])) / float(time[-1] - time[0]) / RPM
        part = turning / stated
        if abs(part - 1.0) < STATED_SPEED_OFF_PART:
            continue
        units = (*MISTAKEN_UNIT_FACTORS, (1.0 / one.cleaned.ratio, "is it the driven shaft's?"))
        hint = next((asked for unit, asked in units if abs(part / unit - 1.0) < SAME_UNIT), "")
        if of_file and hint not in dict(MISTAKEN_TIME_UNITS).values():
            continue
        says = f"is of a pair stated to turn at {stated:g} rpm" if of_file else f"states {stated:g} rpm"
        yield f"recording {k} {says}, but turns at {turning:.3g} rpm by its angles and times{hint and f': {hint}'}"
