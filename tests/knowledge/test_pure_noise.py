"""Noise for a transmission error holds nothing of any pair: white or coloured, rounded or wild, it names no physics,
whatever the pair file declares.

``GEARPOLY_NOISE`` says how many are tried; ``make noise`` tries 200.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray
from tests.knowledge.verdicts import verdict
from tests.pair_files import pair_file

pytestmark = pytest.mark.slow

COUNT = int(os.environ.get("GEARPOLY_NOISE", "6"))

Draw = Callable[[np.random.Generator, int], FloatArray]


def _wandering(rng: np.random.Generator, n: int) -> FloatArray:
    out = rng.normal(0.0, 0.2, n)
    return np.asarray(out + np.cumsum(rng.normal(0.0, 5.0 / np.sqrt(n), n)))


def _coloured(rng: np.random.Generator, n: int) -> FloatArray:
    part, out = float(rng.uniform(0.5, 0.99)), rng.normal(0.0, 1.0, n)
    for k in range(1, n):
        out[k] = part * out[k - 1] + np.sqrt(1.0 - part**2) * out[k]
    return np.asarray(out)


def _pink(rng: np.random.Generator, n: int) -> FloatArray:
    frequency = np.maximum(np.arange(n // 2 + 1), 1.0)
    lines = rng.normal(size=frequency.size) + 1j * rng.normal(size=frequency.size)
    out = np.fft.irfft(lines / np.sqrt(frequency), n)
    return np.asarray(out / np.std(out))


KINDS: dict[str, Draw] = {
    "white": lambda rng, n: rng.normal(0.0, 1.0, n),
    "coloured": _coloured,
    "wandering": _wandering,
    "rounded": lambda rng, n: np.round(0.5 * _wandering(rng, n)),
    "pink": _pink,
    "wild": lambda rng, n: rng.standard_t(3.0, n),
}


@pytest.mark.parametrize("number", range(COUNT))
def test_noise_names_nothing(number: int) -> None:
    rng = np.random.default_rng([number, 2026])
    z = int(rng.integers(13, 45)), int(rng.integers(18, 70))
    kind = list(KINDS)[number % len(KINDS)]
    known = ("grade", "nothing", "inspection")[number // len(KINDS) % 3]
    torque = float(rng.choice([0.0, 5.0, 20.0]))
    sections: list[dict[str, object]] = [{"module_mm": 2.0, "face_width_mm": 15.0} for _ in z]
    for section, teeth in zip(sections, z, strict=True):
        if known == "grade":
            section["grade"] = int(rng.integers(4, 9))
        elif known == "inspection":
            pitch = tuple(np.round(rng.normal(0.0, 2.0, teeth), 2).tolist())
            section["inspection"] = {"uncertainty_um": 0.5, "pitch_um": pitch}
    file = pair_file(z, driving=sections[0], driven=sections[1], model={"tooth_deflection": torque > 0.0})
    n, turns, um = int(rng.choice([1500, 4000])), float(rng.uniform(3.0, 12.0)), float(rng.choice([0.3, 1.0, 5.0]))
    theta_2 = np.linspace(0.0, 2.0 * np.pi * turns, n, endpoint=False)
    recording = Recording(
        source=Path("noise.csv"),
        time_s=theta_2 / np.pi if rng.random() < 0.5 else None,
        driven_angle_rad=theta_2,
        te_mm=um * UM * KINDS[kind](rng, n),
        torque_nm=torque,
        speed_rpm=30.0,
    )
    found = verdict(file, [recording])
    assert not found.missing, found.told
