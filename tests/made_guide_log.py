"""Guide logs made from a known error of a telescope's axis, as PHD2 writes them."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

from gearpoly.keys.sections import WormSection
from gearpoly.units import FloatArray

EQ6 = WormSection(wheel_teeth=180)
PERIOD = 86164.0905 / 180
SCALE, RATE, ANGLE, DECLINATION = 3.2, 2.4, 174.5, 12.0

HEADER = f"""Guiding Begins at 2026-03-10 20:22:52
Pixel scale = {SCALE} arc-sec/px, Binning = 1, Focal length = 240 mm
Exposure = 2000 ms
Mount = EQMOD HEQ5/6,  connected, guiding enabled, xAngle = {ANGLE}, xRate = {RATE}, yAngle = 90.8, yRate = 2.2
RA Guide Speed = 7.5 a-s/s, Dec Guide Speed = 7.5 a-s/s, Cal Dec = 9.6, Last Cal Issue = None
RA = 3.20 hr, Dec = {DECLINATION} deg, Hour angle = -0.43 hr, Pier side = West, Rotator pos = N/A
Lock position = 600.000, 500.000, Star position = 600.000, 500.000, HFD = 2.92 px
Frame,Time,mount,dx,dy,RARawDistance,DECRawDistance,RAGuideDistance,DECGuideDistance,RADuration,RADirection,DECDuration
"""
"""A section's header. Its columns end early, as those of a log that another program shortened."""


def axis_error(time: FloatArray) -> FloatArray:
    """An error in arcsec of the axis, positive where it is ahead: a drift, the worm's turn and a mesh of 47."""
    turn = 2.0 * math.pi * time / PERIOD
    return 0.01 * time + 5.0 * np.cos(turn) + 0.4 * np.cos(47.0 * turn + 1.0)


def made_log(
    *,
    frames: int = 400,
    dithered: tuple[int, float] = (150, 4.0),
    lost: int = 90,
    per_ms: bool = False,
    air: float = 0.0,
) -> tuple[str, FloatArray, FloatArray]:
    """A guide log of a guider that halves what it sees, made from the error of the axis; time in s and that error.

    The axis stands at tracking + error + pulses; the star's offset is what a pulse to the west would mend. The
    ``air`` moves the star by so many arcsec rms from frame to frame.
    """
    time = 2.0 + 2.1 * np.arange(frames)
    error = axis_error(time)
    moved = air * np.random.default_rng(1).standard_normal(frames)
    arcsec = SCALE / math.cos(math.radians(DECLINATION))
    lines, sent, lock = [], 0.0, 0.0
    for k in range(frames):
        if k == dithered[0]:
            lock = dithered[1]
            x = 600.0 + lock * math.cos(math.radians(ANGLE))
            y = 500.0 + lock * math.sin(math.radians(ANGLE))
            lines.append(f"INFO: DITHER by {lock:.3f}, 0.000, new lock pos = {x:.3f}, {y:.3f}")
        offset = -(error[k] + moved[k]) / arcsec - sent - lock
        if k == lost:
            lines.append(f'{k + 1},{time[k]:.3f},"DROP",,,,,,,,,,,,,0,0.00,3,"Star lost - low mass, twice"')
            continue
        cosine, sine, drift = math.cos(math.radians(ANGLE)), math.sin(math.radians(ANGLE)), 0.3 * math.sin(0.1 * k)
        x, y = offset * cosine - drift * sine, offset * sine + drift * cosine
        ms = round(abs(0.5 * offset) / RATE * 1000.0)
        direction = "W" if offset > 0.0 else "E"
        lines.append(
            f'{k + 1},{time[k]:.3f},"Mount",{x:.4f},{y:.4f},{offset:.4f},{drift:.4f},0.1,0.0,{ms},{direction},0'
        )
        sent += math.copysign(ms, offset) / 1000.0 * RATE
    header = HEADER.replace(f"xRate = {RATE}", f"xRate = {RATE / 1000.0}") if per_ms else HEADER
    return header + "\n".join(lines) + "\nGuiding Ends at 2026-03-10 20:50:29\n", time, error


def sample() -> str:
    """The log in data/guide_log: half an hour in air that moves the star by half a second of arc."""
    return made_log(frames=900, air=0.5)[0]


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(sample(), encoding="utf-8")
