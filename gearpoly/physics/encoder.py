"""What a wrong reading of a shaft does to the recorded transmission error, and what a pair file says of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gearpoly.keys.sections import Encoder, PairFile
from gearpoly.physics.parts import EncoderErrors, Parts
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.units import URAD, FloatArray


def misread(scene: ContactsAtSamples, gear: int | None, order: int, values: tuple[float, ...]) -> FloatArray:
    """Change (n,) in mm of the recorded transmission error where an encoder reads ``values`` (cosine and sine, urad)
    too much, ``order`` times per turn."""
    driving = gear in (0, None)
    reading = scene.samples.reading_1 if driving else scene.samples.reading_2
    sense = scene.samples.direction_1 if driving else scene.samples.direction_2
    error = values[0] * np.cos(order * reading) + values[1] * np.sin(order * reading)
    # TE = theta_2 - (z_1/z_2) theta_1.
    part = -scene.pair.ratio if driving else 1.0
    return np.asarray(part * sense * error * URAD * scene.pair.r_b2)


def misreading(errors: Callable[[Encoder, EncoderErrors], EncoderErrors]) -> Callable[[PairFile, Parts], Parts]:
    """What a physics of encoders changes of the parts: ``errors`` takes what one encoder states, and its errors so
    far."""

    def build(file: PairFile, parts: Parts) -> Parts:
        stated = file.driving.encoder, file.driven.encoder
        both = [held if one is None else errors(one, held) for one, held in zip(stated, parts.encoders, strict=True)]
        return replace(parts, encoders=(both[0], both[1]))

    return build
