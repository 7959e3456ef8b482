"""Sums of exp(-2 pi i f x) over unevenly spaced samples, for a whole grid of frequencies at once.

Encoders do not sample in step with the teeth, and interpolating noise to an even grid would make it quieter. So each
sample is spread over a few places of a fine grid by a narrow bell, the grid is transformed by FFT, and the bell's own
transform is divided out (Dutt and Rokhlin 1993; the bell is the one of Barnett, Magland and af Klinteberg 2019).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.fft import irfft, next_fast_len, rfft

from gearpoly.units import FloatArray

ComplexArray = npt.NDArray[np.complex128]

WIDTH = 7
"""Grid places under the bell: relative error a few millionths, so a 10 um line leaves less than 0.1 nm."""

_BETA = 2.30 * WIDTH
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


def _bell(z: FloatArray) -> FloatArray:
    """The bell at ``z`` in [-1, 1]."""
    return np.exp(_BETA * (np.sqrt(np.maximum(0.0, 1.0 - z * z)) - 1.0))


def _bell_transform(count: int, size: int) -> FloatArray:
    """Transform of the bell at frequencies 0 ... count - 1 of a grid of ``size`` places (it is even, hence real)."""
    half = 0.5 * WIDTH
    k = np.arange(count)
    total = np.zeros(count)
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        total += weight * float(_bell(np.asarray(node))) * np.cos(2.0 * np.pi * k * half * node / size)
    return total * half


class Grid:
    """Frequencies k ``step``, k = 0 ... ``count`` - 1, over samples at ``x`` (n,), ready for many transforms.

    ``step`` in cycles per unit of ``x``.
    """

    def __init__(self, x: FloatArray, *, step: float, count: int) -> None:
        self.step = step
        self.count = count
        # Twice the places that the highest frequency needs: the bell's transform stays far from zero.
        self._size = next_fast_len(max(4 * count, 4 * WIDTH), real=True)
        place = np.mod(x * step, 1.0) * self._size
        self._first = np.ceil(place - 0.5 * WIDTH).astype(np.int64)
        self._offset = self._first - place
        self._gain = _bell_transform(count, self._size)

    def _spread(self) -> list[tuple[npt.NDArray[np.int64], FloatArray]]:
        return [(np.mod(self._first + j, self._size), _bell((self._offset + j) * (2.0 / WIDTH))) for j in range(WIDTH)]

    def transform(self, values: FloatArray) -> ComplexArray:
        """Sums (count,) over the samples of values exp(-2 pi i f x)."""
        grid = np.zeros(self._size)
        for place, weight in self._spread():
            grid += np.bincount(place, weights=weight * values, minlength=self._size)
        out: ComplexArray = rfft(grid)[: self.count] / self._gain
        return out

    def wave(self, amplitudes: ComplexArray) -> FloatArray:
        """Real wave (n,) at the samples, Re sum of amplitudes exp(2 pi i f x) over the frequencies."""
        half = np.zeros(self._size // 2 + 1, dtype=np.complex128)
        half[: self.count] = amplitudes / self._gain
        # irfft counts each frequency above zero twice, once for its mirror image.
        half[1:] *= 0.5
        grid = irfft(half, self._size) * self._size
        out = np.zeros(self._first.size)
        for place, weight in self._spread():
            out += weight * grid[place]
        return out


def repeating_part(x: FloatArray, values: FloatArray, *, period: float, count: int, rounds: int = 12) -> FloatArray:
    """What of ``values`` (n,) repeats with ``period`` (in units of ``x``): least squares over ``count`` harmonics.

    Conjugate gradients on the normal equations, whose matrix depends on differences of frequencies only and so acts
    by FFT. Twelve rounds bring evenly sampled records to rounding error; where gaps make the equations ill
    conditioned, stopping there leaves what the data do not fix at zero. Derived here.
    """
    grid = Grid(x, step=1.0 / period, count=count)
    wide = Grid(x, step=1.0 / period, count=2 * count - 1)
    kernel = wide.transform(np.ones(x.size))
    size = next_fast_len(4 * count)
    row = np.zeros(size, dtype=np.complex128)
    row[: 2 * count - 1] = kernel
    row[size - (2 * count - 2) :] = np.conj(kernel[:0:-1])
    gain = np.fft.fft(row)

    def apply(c: ComplexArray) -> ComplexArray:
        padded = np.zeros(size, dtype=np.complex128)
        padded[: 2 * count - 1] = c
        return np.fft.ifft(np.fft.fft(padded) * gain)[: 2 * count - 1]

    positive = grid.transform(values)
    b = np.concatenate([np.conj(positive[:0:-1]), positive])
    c = np.zeros_like(b)
    r = b.copy()
    p = r.copy()
    power = float(np.vdot(r, r).real)
    start = power
    for _ in range(rounds):
        # 1e-14 in power: a ten millionth of the content, far below any noise.
        if power <= 1e-14 * start or power == 0.0:
            break
        q = apply(p)
        alpha = power / float(np.vdot(p, q).real)
        c += alpha * p
        r -= alpha * q
        new = float(np.vdot(r, r).real)
        p = r + (new / power) * p
        power = new
    amplitudes: ComplexArray = np.asarray(2.0 * c[count - 1 :], dtype=np.complex128)
    amplitudes[0] *= 0.5
    return grid.wave(amplitudes)
