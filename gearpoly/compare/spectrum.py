"""Sums of exp(-2 pi i f x) over unevenly spaced samples, for a whole grid of frequencies at once.

Encoders do not sample in step with the teeth, and interpolating noise to an even grid would make it quieter. So each
sample is spread over a few places of a fine grid by a narrow bell, the grid is transformed by FFT, and the bell's own
transform is divided out (Dutt and Rokhlin 1993; the bell is the one of Barnett, Magland and af Klinteberg 2019).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt
from scipy.fft import irfft, next_fast_len, rfft
from scipy.interpolate import CubicSpline
from scipy.sparse import csr_array

from gearpoly.units import FloatArray

ComplexArray = npt.NDArray[np.complex128]

WIDTH = 7
"""Grid places under the bell: relative error a few millionths, so a 10 um line leaves less than 0.1 nm."""

KEEP = 100_000
"""Samples up to which the bells are kept for further transforms; of longer records they would fill the memory."""

_BETA = 2.30 * WIDTH
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


def _bell(z: FloatArray) -> FloatArray:
    """The bell at ``z`` in [-1, 1]."""
    return np.exp(_BETA * (np.sqrt(np.maximum(0.0, 1.0 - z * z)) - 1.0))


def _bell_transform(count: int, size: int) -> FloatArray:
    """Transform of the bell at frequencies 0 ... count - 1 of a grid of ``size`` places (it is even, hence real)."""
    half = 0.5 * WIDTH
    # Smooth and of one bend, so a thousand places of it make a spline good to 1e-12.
    k = np.linspace(0.0, count - 1.0, min(count, 1025)) if count > 1 else np.zeros(1)
    total = np.zeros(k.size)
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        total += weight * float(_bell(np.asarray(node))) * np.cos(2.0 * np.pi * k * half * node / size)
    if k.size < count:
        total = np.asarray(CubicSpline(k, total)(np.arange(count)))
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
        self._spreader: csr_array | None = None
        self._kept = [self._place(j) for j in range(WIDTH)] if x.size <= KEEP else None

    def _place(self, j: int) -> tuple[npt.NDArray[np.int64], FloatArray]:
        return np.mod(self._first + j, self._size), _bell((self._offset + j) * (2.0 / WIDTH))

    def _spread(self) -> Iterable[tuple[npt.NDArray[np.int64], FloatArray]]:
        return self._kept if self._kept is not None else (self._place(j) for j in range(WIDTH))

    def transform(self, values: FloatArray) -> ComplexArray:
        """Sums (count,) over the samples of values exp(-2 pi i f x)."""
        grid = np.zeros(self._size)
        for place, weight in self._spread():
            grid += np.bincount(place, weights=weight * values, minlength=self._size)
        out: ComplexArray = rfft(grid)[: self.count] / self._gain
        return out

    def transforms(self, columns: FloatArray) -> ComplexArray:
        """The same (count, m) for ``columns`` (n, m), at once."""
        n = self._first.size
        if self._spreader is None:
            rows, weights = zip(*self._spread(), strict=True)
            samples = np.tile(np.arange(n), len(rows))
            entries = (np.concatenate(weights), (np.concatenate(rows), samples))
            self._spreader = csr_array(entries, shape=(self._size, n))
        grid = np.asarray(self._spreader @ columns)
        turned = np.asarray(rfft(grid, axis=0), dtype=np.complex128)
        return turned[: self.count] / self._gain[:, None]

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


class Repeating:
    """Least squares of ``count`` harmonics of a ``period`` (in units of ``x``) over samples at ``x`` (n,).

    Conjugate gradients on the normal equations, whose matrix depends on differences of frequencies only and so acts
    by FFT. Twelve rounds bring evenly sampled records to rounding error; where gaps make the equations ill
    conditioned, stopping there leaves what the data do not fix at zero. Derived here.
    """

    def __init__(self, x: FloatArray, *, period: float, count: int, rounds: int = 12) -> None:
        self._grid = Grid(x, step=1.0 / period, count=count)
        self._count, self._rounds = count, rounds
        kernel = Grid(x, step=1.0 / period, count=2 * count - 1).transform(np.ones(x.size))
        self._size = next_fast_len(4 * count)
        row = np.zeros(self._size, dtype=np.complex128)
        row[: 2 * count - 1] = kernel
        row[self._size - (2 * count - 2) :] = np.conj(kernel[:0:-1])
        self._gain = np.fft.fft(row)

    def _apply(self, c: ComplexArray) -> ComplexArray:
        padded = np.zeros(self._size, dtype=np.complex128)
        padded[: c.size] = c
        return np.fft.ifft(np.fft.fft(padded) * self._gain)[: c.size]

    def part(self, values: FloatArray) -> FloatArray:
        """What of ``values`` (n,) repeats, (n,)."""
        positive = self._grid.transform(values)
        b = np.concatenate([np.conj(positive[:0:-1]), positive])
        c = np.zeros_like(b)
        r = b.copy()
        p = r.copy()
        power = float(np.vdot(r, r).real)
        start = power
        for _ in range(self._rounds):
            # 1e-14 in power: a ten millionth of the content, far below any noise.
            if power <= 1e-14 * start or power == 0.0:
                break
            q = self._apply(p)
            alpha = power / float(np.vdot(p, q).real)
            c += alpha * p
            r -= alpha * q
            new = float(np.vdot(r, r).real)
            p = r + (new / power) * p
            power = new
        amplitudes: ComplexArray = np.asarray(2.0 * c[self._count - 1 :], dtype=np.complex128)
        amplitudes[0] *= 0.5
        return self._grid.wave(amplitudes)
