"""What an encoder reads wrong: errors fixed to its own reading, and counts per turn that are set wrong.

Errors are reading minus truth in rad of the shaft; they belong to the measuring chain and to nothing that turns.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearpoly.files.models import Encoder
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, URAD, FloatArray


@dataclass(frozen=True, kw_only=True)
class EncoderErrors:
    """Errors of one encoder: ``waves`` of (order per turn, amplitude in rad, phase in rad), error = amplitude
    cos(order reading + phase); ``scale`` is reading over truth."""

    waves: tuple[tuple[int, float, float], ...] = ()
    scale: float = 1.0

    @property
    def none(self) -> bool:
        """Whether the encoder reads true."""
        return not self.waves and self.scale == 1.0

    def at(self, reading: FloatArray) -> FloatArray:
        """Error (n,) in rad at encoder ``reading`` (n,) in rad, the scale apart."""
        out = np.zeros(reading.shape)
        for order, amplitude, phase in self.waves:
            out += amplitude * np.cos(order * reading + phase)
        return out


def encoder_errors(section: Encoder | None) -> EncoderErrors:
    """The errors that a pair file states of one encoder."""
    if section is None:
        return EncoderErrors()
    waves = [(one.order, one.amplitude_urad * URAD, one.angle_deg * DEG) for one in section.interpolation]
    if section.eccentricity_urad:
        waves.insert(0, (1, section.eccentricity_urad * URAD, -section.eccentricity_deg * DEG))
    return EncoderErrors(waves=tuple(waves), scale=section.scale)


def corrected(
    recording: Recording, driving: EncoderErrors, driven: EncoderErrors, *, ratio: float, r_b2: float
) -> Recording:
    """The recording as true encoders would have made it; ``ratio`` z_1/z_2, ``r_b2`` in mm.

    Where the rig computed the transmission error itself, only the shaft whose angle was recorded can be put right.
    """
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
        true = (whole - errors.at(reading)) / errors.scale
        changes[f"{name}_angle_rad"] = true
        wrong[name] = sense * (whole - true)
    te = wrong.get("driven", 0.0) - ratio * wrong.get("driving", 0.0)
    if recording.te_rad is not None:
        changes["te_rad"] = recording.te_rad - te
    if recording.te_mm is not None:
        changes["te_mm"] = recording.te_mm - te * r_b2
    return replace(recording, **changes)
