"""What an encoder reads wrong: errors fixed to its own reading, and counts per turn that are set wrong.

Errors are reading minus truth in rad of the shaft; they belong to the measuring chain and to nothing that turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearpoly.physics.parts import EncoderErrors
from gearpoly.recording.by_travel import check_units_by_travel
from gearpoly.recording.recording import Recording
from gearpoly.recording.travel import whole_angles
from gearpoly.units import DEG, FloatArray

ZERO_KEPT = 0.5 * DEG
"""rad per turn by which a scale may be off for a stated zero to stay: it says which reading is zero, but not in which
turn, and half a tooth of a gear with 360 is as much."""


def loses_zero(scale: float) -> bool:
    """Whether a reading ``scale`` times the truth has no zero but in one of its turns."""
    return abs(scale - 1.0) * 2.0 * np.pi > ZERO_KEPT


def with_own_zeros(recordings: Sequence[Recording], shaft: str, *, ratio: float) -> list[Recording]:
    """The recordings without the angle of a ``shaft`` whose counts have no zero in common: their transmission error
    from a zero of its own, which runs of one stretch share, beside the angle of the other shaft. Those of which both
    angles were not read are as they are."""
    begins: dict[object, float] = {}
    out = []
    for k, recording in enumerate(recordings):
        both = whole_angles(recording)
        if both is None:
            out.append(recording)
            continue
        rows, theta_1, theta_2, _ = both
        te = np.full(recording.size, np.nan)
        te[rows] = theta_2 - ratio * theta_1
        run = recording.run
        # The rotation that was not read follows from the error, so that must not hold how far the counts are apart.
        te -= begins.setdefault(k if run is None else (run.file, run.stretch), float(te[rows[0]]))
        changes: dict[str, Any] = {f"{shaft}_angle_rad": None, f"{shaft}_zero_rad": None, f"{shaft}_direction": 1}
        out.append(replace(recording, te_rad=te, own_zero=True, **changes))
    return out


def corrected(
    recording: Recording, driving: EncoderErrors, driven: EncoderErrors, *, ratio: float, r_b2: float
) -> Recording:
    """The recording as true encoders would have made it; ``ratio`` z_1/z_2, ``r_b2`` in mm.

    Where the rig computed the transmission error itself, only the shaft whose angle was recorded can be put right.
    Raises ``InputFileError`` where the travel of both shafts says that one was read in another unit than its own.
    """
    check_units_by_travel(recording, ratio * driven.scale / driving.scale)
    if driving.none and driven.none:
        return recording
    changes: dict[str, Any] = {}
    wrong: dict[str, FloatArray] = {}
    for name, errors, reading, sense in (
        ("driving", driving, recording.driving_angle_rad, recording.driving_direction),
        ("driven", driven, recording.driven_angle_rad, recording.driven_direction),
    ):
        if reading is None or errors.none:
            continue
        whole = reading
        if errors.scale != 1.0:
            # Whole turns count where the scale is off, so wraps are undone first; gaps stay gaps.
            held = np.isfinite(reading)
            whole = reading.copy()
            whole[held] = np.unwrap(reading[held])
            if loses_zero(errors.scale):
                changes[f"{name}_zero_rad"] = None
        true = (whole - errors.at(reading)) / errors.scale
        changes[f"{name}_angle_rad"] = true
        wrong[name] = sense * (whole - true)
    te = wrong.get("driven", 0.0) - ratio * wrong.get("driving", 0.0)
    if recording.te_rad is not None:
        changes["te_rad"] = recording.te_rad - te
    if recording.te_mm is not None:
        changes["te_mm"] = recording.te_mm - te * r_b2
    return replace(recording, **changes)
