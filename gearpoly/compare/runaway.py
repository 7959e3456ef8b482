"""Transmission errors that the rig computed and that run away by more than teeth in mesh can.

Teeth in mesh do not slip. A transmission error that grows by pitches along a recording is a motor's rate, a wrong count
or an axis that wanders; of the shaft whose angle follows from it nothing is then at its order. So what is slow of it is
taken out, as the curve that the noise's own fit allows for anyway, and told.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearpoly.compare.slow import slow_curves
from gearpoly.errors import InputFileError, told_beside
from gearpoly.mesh.pair import GearPair
from gearpoly.recording.clean import RATIO_LIMIT
from gearpoly.recording.recording import SHAFTS, Recording
from gearpoly.recording.spikes import single_spikes
from gearpoly.recording.travel import FEWEST_SAMPLES_FOR_RATIO, HOLDS
from gearpoly.recording.unwrapping import continuous, only_goes_on
from gearpoly.units import UM, BoolArray, FloatArray

MATTERS = 0.25
"""Pitches along a whole recording from which teeth stand at other angles than the readings say: of less a slope of the
transmission error tells all that there is. A line of the order of the teeth, whose phase runs over a quarter of a turn,
loses a fifth of its power (sinc 0.25)^2."""

NO_ERROR = 0.2
"""Part of what a shaft turns from which the column is no transmission error: an angle, or another unit. Of rigs that
wander by pitches the worst run away by 0.06."""


def without_course(recording: Recording, pair: GearPair) -> Recording:
    """The recording without the slow course (mean left, ramp, bow and S taken) of a transmission error that runs away;
    as it is where both angles were read, or where the course is within ``MATTERS``. Beside an encoder's angle a ramp up
    to ``RATIO_LIMIT`` may be its scale, which the diagnosis asks for.

    Raises ``InputFileError`` where the column cannot be a transmission error.
    """
    te = recording.te_in_rad(pair.r_b2)
    shafts = [name for name in SHAFTS if getattr(recording, f"{name}_angle_rad") is not None]
    if te is None or len(shafts) != 1:
        return recording
    shaft, angle = shafts[0], getattr(recording, f"{shafts[0]}_angle_rad")
    good = np.isfinite(te) & np.isfinite(angle)
    if np.count_nonzero(good) < FEWEST_SAMPLES_FOR_RATIO:
        return recording
    turned = _whole(recording, angle, good) * (pair.ratio if shaft == "driving" else 1.0)
    # A word for no reading, such as 99999, is left out later on, and would bend the course of all others.
    spikes = single_spikes(te[good], turned / pair.ratio, turned)
    course = _course(te[good], turned, ~spikes, ratio=pair.ratio)
    runs, travel = float(np.ptp(course)), float(np.ptp(turned))
    least = MATTERS * pair.driven.gear.tau if shaft in recording.from_time else RATIO_LIMIT * travel
    if runs <= least:
        return recording
    far = f"{runs / pair.driven.gear.tau:.2g} pitches"
    if runs > NO_ERROR * travel:
        share = told_beside(100.0 * runs / travel, 100.0 * NO_ERROR, 0)
        found = f"a transmission error that runs {share}% of what the shafts turn, {far}: no teeth slip so"
        wish = "want theta_2 - z_1/z_2 theta_1 in its unit: te_um (along the line of action), te_urad or te_arcsec"
        raise InputFileError(recording.source, found=found, wish=wish)
    says = (
        f"the transmission error runs away by {runs * pair.r_b2 / UM:.4g} um, {far}, along the recording: more than "
        "teeth in mesh can; its slow course (ramp, bow and S) is taken out"
    )
    there = np.full(te.size, math.nan)
    there[good] = te[good] - course
    changes = {"te_rad": there} if recording.te_rad is not None else {"te_mm": there * pair.r_b2}
    return replace(recording, **changes, remarks=(*recording.remarks, says))


def _whole(recording: Recording, angle: FloatArray, good: BoolArray) -> FloatArray:
    """The ``good`` readings (m,) of an angle (n,) in rad without wraps, across gaps by the usual speed."""
    if only_goes_on(angle[good]):
        return np.asarray(angle[good])
    rows = np.flatnonzero(good)
    position = rows.astype(np.float64)
    if recording.time_s is not None and np.all(np.diff(recording.time_s[rows]) >= 0.0):
        position = recording.time_s[rows]
    return continuous(angle[rows], position, rows).angle


def _course(te: FloatArray, turned: FloatArray, held: BoolArray, *, ratio: float) -> FloatArray:
    """The slow course (n,) of ``te`` over the driven rotation, about its mean, fitted to the samples ``held`` (n,)
    beside both shafts' first two orders where the recording holds turns enough to part them."""
    slow = slow_curves(turned)
    waves = [
        wave(order * angle)
        for angle in (turned / ratio, turned)
        if float(np.ptp(angle)) > HOLDS * 2.0 * math.pi
        for order in (1, 2)
        for wave in (np.cos, np.sin)
    ]
    fitted = np.linalg.lstsq(np.column_stack([slow, *waves])[held], te[held], rcond=None)[0]
    return np.asarray(slow[:, 1:] @ fitted[1 : slow.shape[1]])
