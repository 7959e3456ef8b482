"""Cosines and sines of waves of any frequency, sums of values times them, and where such a sum is largest, compiled;
importing this imports numba.

Angles are told in turns, whose whole part is left out exactly; within an eighth of a turn both are sums of eight
and nine terms of their series, whose rest is below 1e-16."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.mesh.radial_search import compiled, inlined
from gearpoly.units import FloatArray

PLACING_STRETCHES = 2048
"""Stretches of a record whose sums and moments stand for it where a wave is placed: over half of one a wave that is a
line off turns by 0.0015 rad, whose third power is left out."""

QUARTER_LINE, MOST_LINES, CLIMBING_STEPS = 0.25, 0.75, 4
"""Independent lines by which a frequency moves at most in one step, since beyond these the parabola is no guide, and in
all: further off stands another line. Steps, after which a peak in noise of a third of it stands to a thousandth of a
line (tests/test_sinusoids.py)."""

BLOCK = 256
"""Samples whose cosines and sines are made at once: two arrays of them lie in the innermost cache. It decides
nothing but speed."""


@inlined
def _wave(
    x: FloatArray, begin: int, end: int, middle: float, frequency: float, c_of: FloatArray, s_of: FloatArray
) -> None:
    """Cosine and sine of 2 pi ``frequency`` (x - middle) at samples ``begin`` to ``end``, into ``c_of`` and ``s_of``.

    Without a branch, so that the compiler takes several samples at once.
    """
    for k in range(end - begin):
        turns = frequency * (x[begin + k] - middle)
        quarter = math.floor(4.0 * turns + 0.5)
        r = (turns - 0.25 * quarter) * (2.0 * math.pi)
        q = r * r
        c = -1.0 / 87178291200.0 + q * (1.0 / 20922789888000.0)
        c = 1.0 / 479001600.0 + q * c
        c = -1.0 / 3628800.0 + q * c
        c = 1.0 / 40320.0 + q * c
        c = -1.0 / 720.0 + q * c
        c = 1.0 / 24.0 + q * c
        c = 1.0 + q * (-0.5 + q * c)
        s = 1.0 / 6227020800.0 + q * (-1.0 / 1307674368000.0)
        s = -1.0 / 39916800.0 + q * s
        s = 1.0 / 362880.0 + q * s
        s = -1.0 / 5040.0 + q * s
        s = 1.0 / 120.0 + q * s
        s = r + r * q * (-1.0 / 6.0 + q * s)
        # Quarter turns: odd ones change places, the second half of a turn changes signs.
        half = math.floor(0.5 * quarter)
        odd = quarter - 2.0 * half
        sign = 1.0 - 2.0 * (half - 2.0 * math.floor(0.5 * half))
        c_of[k] = sign * (c - odd * (c + s))
        s_of[k] = sign * (s - odd * (s - c))


@compiled
def _columns(x: FloatArray, frequency: FloatArray) -> FloatArray:
    out = np.empty((x.size, 2 * frequency.size))
    c, s = np.empty(BLOCK), np.empty(BLOCK)
    for begin in range(0, x.size, BLOCK):
        end = min(x.size, begin + BLOCK)
        for j in range(frequency.size):
            _wave(x, begin, end, 0.0, frequency[j], c, s)
            for k in range(end - begin):
                out[begin + k, 2 * j], out[begin + k, 2 * j + 1] = c[k], s[k]
    return out


def cosine_and_sine(x: FloatArray, frequency: FloatArray) -> FloatArray:
    """cos and sin of 2 pi f x side by side for each of ``frequency`` (k,) in cycles per unit of ``x`` (n,): (n, 2k)."""
    return _columns(np.ascontiguousarray(x, dtype=np.float64), np.asarray(frequency, dtype=np.float64))


@compiled
def line_power(x: FloatArray, values: FloatArray, frequency: float) -> float:
    """Squared size of the sum of ``values`` (n,) times exp(-2 pi i f x) at ``x`` (n,)."""
    c, s = np.empty(BLOCK), np.empty(BLOCK)
    real, imag = 0.0, 0.0
    for begin in range(0, x.size, BLOCK):
        end = min(x.size, begin + BLOCK)
        _wave(x, begin, end, 0.0, frequency, c, s)
        for k in range(end - begin):
            real += values[begin + k] * c[k]
            imag += values[begin + k] * s[k]
    return real * real + imag * imag


def refined(x: FloatArray, values: FloatArray, frequency: float, span: float) -> tuple[float, float]:
    """Frequency near ``frequency`` at which the sum of ``values`` (n,) times a wave over ``x`` (n,) is largest, and how
    much larger (in power) than at the start; lines are 1 / ``span`` wide.

    Newton on the power; the middle of the record as origin keeps the steps small. The frequency moves by less than a
    line, so neighbours stay nearly in step: sums over stretches and their first moments stand for them.
    """
    group = max(1, x.size // PLACING_STRETCHES)
    sums = _stretches(x, values, frequency, 0.5 * (float(x[0]) + float(x[-1])), group)
    off, more = _climbed(sums, span)
    if abs(off) > MOST_LINES / span:
        return frequency, 1.0
    return frequency + off, more


@compiled
def _stretches(x: FloatArray, values: FloatArray, frequency: float, middle: float, group: int) -> FloatArray:
    """Rows (m, 7) of stretches of ``group`` samples: their mean place about ``middle``, then the real and imaginary
    sums of the wave there, of it times the distance from the mean, and times the square of that."""
    n, block = x.size, group * max(1, BLOCK // group)
    out = np.zeros(((n + group - 1) // group, 7))
    c, s = np.empty(block), np.empty(block)
    for low in range(0, n, block):
        high = min(n, low + block)
        _wave(x, low, high, middle, frequency, c, s)
        for begin in range(low, high, group):
            end = min(high, begin + group)
            row = out[begin // group]
            for k in range(begin, end):
                row[0] += (x[k] - middle) / (end - begin)
            for k in range(begin, end):
                y = x[k] - middle - row[0]
                real, imag = values[k] * c[k - low], -values[k] * s[k - low]
                row[1] += real
                row[2] += imag
                row[3] += real * y
                row[4] += imag * y
                row[5] += real * y * y
                row[6] += imag * y * y
    return out


@compiled
def _climbed(rows: FloatArray, span: float) -> tuple[float, float]:
    """How far the frequency moves, and how much larger the power is there, for rows of ``_stretches``."""
    off, start, power = 0.0, 0.0, 0.0
    for step in range(CLIMBING_STEPS):
        turn = -2.0 * math.pi * off
        # Of the sum and its first and second derivative by the frequency, over -2 pi i.
        t0, t1, f0, f1, s0, s1 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for g in range(rows.shape[0]):
            along = rows[g, 0]
            c, s = math.cos(turn * along), math.sin(turn * along)
            # exp(i turn along) times sums, moments and squares.
            a, b = c * rows[g, 1] - s * rows[g, 2], c * rows[g, 2] + s * rows[g, 1]
            ma, mb = c * rows[g, 3] - s * rows[g, 4], c * rows[g, 4] + s * rows[g, 3]
            qa, qb = c * rows[g, 5] - s * rows[g, 6], c * rows[g, 6] + s * rows[g, 5]
            # Within a stretch the wave turns by i turn y, to second order.
            wa, wb = a - turn * (mb + 0.5 * turn * qa), b + turn * (ma - 0.5 * turn * qb)
            ba, bb = ma - turn * qb, mb + turn * qa
            t0 += wa
            t1 += wb
            f0 += along * wa + ba
            f1 += along * wb + bb
            s0 += along * (along * wa + 2.0 * ba) + qa
            s1 += along * (along * wb + 2.0 * bb) + qb
        power = t0 * t0 + t1 * t1
        if step == 0:
            start = power
        # d/df = -2 pi i: the conjugate of the sum times i w (f0 + i f1), with w = -2 pi.
        w = -2.0 * math.pi
        slope = 2.0 * w * (t1 * f0 - t0 * f1)
        bend = 2.0 * w * w * (f0 * f0 + f1 * f1 - (t0 * s0 + t1 * s1))
        if bend >= 0.0:
            break
        most = QUARTER_LINE / span
        off += min(max(-slope / bend, -most), most)
    return off, power / start if start > 0.0 else 1.0
