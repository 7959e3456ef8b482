"""Whether two columns that state one thing agree to the rounding with which they were written.

Derived here. Nobody says how a column was rounded, so the digits say it: to decimals, to significant digits, to single
precision, or to the steps of a counter. Where several would do, the coarsest counts, since a column that is taken for
finer than it is would be refused without a fault.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError, told_at_most, told_beside
from gearpoly.units import FloatArray, IntArray

VALUES_FOR_ROUNDING = 4096
"""Values, spread over the column, whose digits are looked at; a finer rounding hardly hides in all of them."""

MOST_DIGITS = 12
"""Most decimals and significant digits that are looked for; beyond them double precision cannot tell rounding."""

ROUNDED_PLACES_OFF = 1e-6
"""Distance from a whole number of last places, in last places, that counts as rounded to it: the product of a value and
a power of ten is that exact where it has twelve digits."""

PRECISION = 4.0 * float(np.finfo(np.float64).eps)
"""Relative error of double precision after a change of unit and back."""


def rounding(values: FloatArray) -> FloatArray:
    """Half of the last place (n,) to which each of the ``values`` (n,) was written; at least double precision."""
    size = np.abs(values)
    half = PRECISION * size
    finite = np.flatnonzero(np.isfinite(values))
    if not finite.size:
        return half
    some = values[finite[np.unique(np.linspace(0, finite.size - 1, VALUES_FOR_ROUNDING).astype(np.int64))]]
    some = some[some != 0.0]
    if not some.size:
        return half
    with np.errstate(all="ignore"):  # absurd sizes are told by whoever reads on
        if (np.abs(some - some.astype(np.float32)) <= PRECISION * np.abs(some)).all():
            half = np.maximum(half, 2.0**-24 * size)
        places = (10.0**d for d in range(MOST_DIGITS + 1))
        if (place := next((p for p in places if _whole(some * p)), None)) is not None:
            half = np.maximum(half, 0.5 / place)
        exponent = np.floor(np.log10(np.abs(some)))
        count = next((n for n in range(1, MOST_DIGITS + 1) if _whole(some * 10.0 ** (n - 1 - exponent))), None)
        if count is not None:
            whole = np.floor(np.log10(np.where(size > 0.0, size, 1.0)))
            half = np.maximum(half, np.where(size > 0.0, 0.5 * 10.0 ** (whole - count + 1), 0.0))
        steps = np.diff(np.unique(some))
        # Samples taken at even angles lie on a grid too, but the next one is always as far away.
        moves = np.diff(values[finite[:VALUES_FOR_ROUNDING]])
        if steps.size > 1 and _whole(steps / steps.min()) and np.unique(np.rint(moves / steps.min())).size > 2:
            half = np.maximum(half, 0.5 * steps.min())
    return half


def _whole(values: FloatArray) -> bool:
    """Whether all values are whole numbers, and small enough that this means something."""
    return bool(
        np.all(np.abs(values) < 10.0**MOST_DIGITS) and np.all(np.abs(values - np.rint(values)) <= ROUNDED_PLACES_OFF)
    )


def _decimals(value: float, digits: int) -> int:
    """Decimals by which a ``value`` has so many digits that count."""
    return max(0, digits - 1 - math.floor(math.log10(value))) if value > 0.0 else 0


def check_agreement(
    file: Path,
    names: tuple[str, str],
    first: FloatArray,
    second: FloatArray,
    tolerance: FloatArray,
    *,
    row: IntArray | None = None,
    unit: str,
    any_zero: bool,
) -> None:
    """Raise ``InputFileError`` with the row where two columns that state one thing say different things.

    ``first``, ``second`` and ``tolerance`` (n,) in ``unit``, samples without a reading are ``nan``; ``row`` (n,) are
    the samples' numbers from 0. ``any_zero``: each has a zero of its own, so that their difference may be any constant.
    """
    apart = first - second
    held = np.isfinite(apart)
    if not held.any():
        return
    bound = tolerance
    if any_zero:
        # The middle difference is itself known to the rounding only.
        apart = apart - np.median(apart[held])
        bound = tolerance + np.max(tolerance[held])
    beyond = np.where(held, np.abs(apart) - bound, -np.inf)
    worst = int(np.argmax(beyond))
    if beyond[worst] <= 0.0:
        return
    at = worst if row is None else int(row[worst])
    off, most = abs(float(apart[worst])), float(bound[worst])
    differ = told_beside(off, most, _decimals(off, 3))
    rounded = told_at_most(most, _decimals(most, 2))
    found = f"{' and '.join(names)} differ by {differ} {unit}, where rounding makes {rounded}"
    wish = "want columns that agree where they state one thing; leave one of them out"
    raise InputFileError(file, where=f"row {at + 1}", found=found, wish=wish)
