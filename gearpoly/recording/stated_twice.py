"""Columns of a recording that follow from others once the pair is known: they must agree to their rounding."""

from __future__ import annotations

import numpy as np

from gearpoly.recording.agreement import check_agreement
from gearpoly.recording.recording import ANGLE_COLUMNS, TE_COLUMNS, Recording
from gearpoly.units import UM, URAD, FloatArray, IntArray


def check_errors(recording: Recording, r_b2: float) -> None:
    """Raise ``InputFileError`` with the row where the transmission error in um is not its angle times ``r_b2`` (mm)."""
    places = recording.last_places
    if recording.te_rad is None or recording.te_mm is None or "te_um" not in places:
        return
    angle = next(name for name in TE_COLUMNS if name in places and name != "te_um")
    tolerance = np.full(recording.size, places["te_um"] + r_b2 * places[angle])
    names = ("te_um", f"{angle} times the driven base radius {r_b2:.6g} mm")
    first, second = recording.te_mm / UM, recording.te_rad * (r_b2 / UM)
    check_agreement(recording.source, names, first, second, tolerance / UM, unit="um", any_zero=False)


def check_error(
    recording: Recording,
    te: FloatArray,
    thetas: tuple[FloatArray, FloatArray],
    keep: IntArray,
    *,
    ratio: float,
    r_b2: float | None,
) -> None:
    """Raise ``InputFileError`` with the row where the stated transmission error ``te`` (m,) in rad is not that of the
    encoders' rotations ``thetas`` (m,): they have zeros of their own, and differ by a constant.

    ``keep`` (m,) are the samples' numbers, ``ratio`` is z_1/z_2, ``r_b2`` the driven base radius in mm.
    """
    places = recording.last_places
    if not places:
        return
    driving, driven = (places[name] for name in ANGLE_COLUMNS)
    name = next(name for name in TE_COLUMNS[::-1] if name in places)  # te_um last: te is it only where it stands alone
    stated = places[name] / (r_b2 or 1.0) if name == "te_um" else places[name]
    theta_1, theta_2 = thetas
    read = theta_2 - ratio * theta_1
    # Angles count on over all turns, and their product with the ratio is rounded at that size.
    counted = 4.0 * np.finfo(np.float64).eps * np.abs(theta_2)
    tolerance = stated + driven + ratio * driving + counted
    both = f"{ANGLE_COLUMNS[1]} - z_1/z_2 {ANGLE_COLUMNS[0]}"
    check_agreement(
        recording.source, (name, both), te / URAD, read / URAD, tolerance / URAD, row=keep, unit="urad", any_zero=True
    )  # fmt: skip
