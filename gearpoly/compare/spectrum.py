"""Sums of exp(-2 pi i f x) over unevenly spaced samples, for a whole grid of frequencies at once.

Encoders do not sample in step with the teeth, and interpolating noise to an even grid would make it quieter. So each
sample is spread over a few places of a fine grid by a narrow bell, the grid is transformed by FFT, and the bell's own
transform is divided out (Dutt and Rokhlin 1993; the bell is the one of Barnett, Magland and af Klinteberg 2019).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.fft import hfft, ihfft, irfft, next_fast_len, rfft
from scipy.ndimage import map_coordinates, spline_filter1d
from scipy.sparse import csr_array

from gearpoly.compare.pieces import SAMPLES_PER_PIECE, pieces
from gearpoly.units import FloatArray, IntArray

ComplexArray = npt.NDArray[np.complex128]

BELL_PLACES = 7
"""Grid places under the bell: relative error a few millionths, so a 10 um line leaves less than 0.1 nm."""

BELL_TABLE, BEYOND_TABLE = 1024, 20
"""Places of the bell's transform that a spline goes through, and further ones: it is smooth and of one bend, and even,
so that the spline is its own mirror image at the beginning; what it is not at the end, a place on takes a quarter of.
Good to 1e-13. scipy.ndimage and not scipy.interpolate, which takes a second to import."""

KEEP = 100_000
"""Samples up to which the bells are kept for further transforms; of longer records they would fill the memory."""

WHOLE_PLACES = 1 << 18
"""Places up to which a grid is transformed at once; of a larger one an FFT would ask for three times its memory."""

STRANDS = 8
"""Equal parts in which a larger grid is held and transformed: every eighth place."""

MOST_GRID_LENGTHS_PER_PIECE = 4
"""Lengths of the grid that a piece of the samples may cover before they are folded into it one by one."""

GRID_LEAST_LOAD = 8
"""Samples times frequencies over the size of the grid below which columns are summed one by one: of 280 columns the
grid takes 5.6 ns per place and column, the sum 0.2 ns per term and column and 20 ns per term, so both would take as
long at 20."""

SPECTRUM_PLACES_PER_LINE = 2
"""Places per independent line of a spectrum that is shown: peaks are then at most 4 % low under a Hann window."""

COLUMNS_TRANSFORMED_AT_ONCE = 16
"""Columns that are transformed at a time: a few MB."""

_BETA = 2.30 * BELL_PLACES
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


def placed_to(gain: float, *, span: float) -> float:
    """Standard error of the frequency of a wave that gains so much, in cycles per unit of the record's ``span``: half a
    turn of phase over the record costs the line, so sqrt(12) / (2 pi sqrt(gain)) of a line."""
    return math.sqrt(12.0) / (2.0 * math.pi * span * math.sqrt(gain))


def _bell(z: FloatArray) -> FloatArray:
    """The bell at ``z`` in [-1, 1]."""
    out = 1.0 - z * z
    np.maximum(out, 0.0, out=out)
    np.sqrt(out, out=out)
    out -= 1.0
    out *= _BETA
    return np.exp(out, out=out)


def _bell_transform(k: FloatArray, size: int) -> FloatArray:
    """Transform of the bell at frequencies ``k`` of a grid of ``size`` places (it is even, hence real)."""
    half = 0.5 * BELL_PLACES
    total = np.zeros(k.size)
    for node, weight in zip(_NODES, _WEIGHTS * _bell(_NODES), strict=True):
        total += weight * np.cos(2.0 * np.pi * k * half * node / size)
    return total * half


@dataclass(frozen=True, eq=False)
class _Spread:
    """Samples ``here`` under the bell: ``first`` (m,) of the grid's places for each, counted from ``low`` on, and
    ``weights`` (``BELL_PLACES``, m) at that and the following ones; ``reach`` places from ``low`` on hold all of
    them."""

    here: slice
    low: int
    reach: int
    first: IntArray
    weights: FloatArray

    def onto(self, strands: list[FloatArray], values: FloatArray) -> None:
        """Add the samples' ``values`` (m,) to a periodic grid, whose places stand in ``strands`` by turns."""
        local = np.zeros(self.reach)
        for j, weight in enumerate(self.weights):
            local[j:] += np.bincount(self.first, weight * values, self.reach - j)
        many = len(strands)
        for there, part in self._turns(many * strands[0].size):
            for j, strand in enumerate(strands):
                late = (j - there.start) % many
                mine = local[part][late::many]
                begin = (there.start + late) // many
                strand[begin : begin + mine.size] += mine

    def taken(self, grid: FloatArray) -> FloatArray:
        """What the bells (m,) see of the periodic ``grid``."""
        local = np.concatenate([grid[there] for there, _ in self._turns(grid.size)])
        out = np.zeros(self.first.size)
        for j, weight in enumerate(self.weights):
            out += weight * local[j:][self.first]
        return out

    def _turns(self, size: int) -> Iterator[tuple[slice, slice]]:
        """Where on a grid of ``size`` places the stretch from ``low`` on lies, and which part of it that is."""
        done = 0
        while done < self.reach:
            at = (self.low + done) % size
            step = min(self.reach - done, size - at)
            yield slice(at, at + step), slice(done, done + step)
            done += step


class FrequencyGrid:
    """Frequencies k ``step``, k = 0 ... ``count`` - 1, over samples at ``x`` (n,), ready for many transforms.

    ``step`` in cycles per unit of ``x``.
    """

    def __init__(self, x: FloatArray, *, step: float, count: int) -> None:
        self.step = step
        self.count = count
        self._x = x
        # Twice the places that the highest frequency needs: the bell's transform stays far from zero.
        size = max(4 * count, 4 * BELL_PLACES)
        self._strands = 1 if size <= WHOLE_PLACES else STRANDS
        self._size = 2 * self._strands * next_fast_len(math.ceil(0.5 * size / self._strands), real=True)
        self._spacing = max(count - 1.0, 1.0) / BELL_TABLE
        places = np.asarray(self._spacing * np.arange(BELL_TABLE + BEYOND_TABLE), dtype=np.float64)
        bell = _bell_transform(places, self._size)
        self._table: FloatArray = spline_filter1d(bell, mode="mirror")  # cubic
        self._spreader: csr_array | None = None
        self._kept = list(self._spreads()) if x.size <= KEEP else None

    def _gain(self, k: FloatArray | IntArray) -> FloatArray:
        """The bell's transform at frequencies of these numbers ``k``."""
        places = np.asarray(k / self._spacing)[None]
        return np.asarray(map_coordinates(self._table, places, order=3, mode="mirror", prefilter=False))

    def _spreads(self) -> Iterator[_Spread]:
        turns = math.floor(self._x[0] * self.step) if self._x.size else 0
        for here in pieces(self._x.size):
            place = (self._x[here] * self.step - turns) * self._size
            first = np.ceil(place - 0.5 * BELL_PLACES)
            place -= first
            weights = np.stack([_bell((j - place) * (2.0 / BELL_PLACES)) for j in range(BELL_PLACES)])
            low = int(np.min(first))
            if np.max(first) - low > MOST_GRID_LENGTHS_PER_PIECE * self._size:
                first, low = np.mod(first, self._size), 0
            first = first.astype(np.int64) - low
            yield _Spread(here, low, int(np.max(first)) + BELL_PLACES, first, weights)

    def _spread(self) -> Iterator[_Spread]:
        return iter(self._kept) if self._kept is not None else self._spreads()

    def _sums(self, values: FloatArray) -> Iterator[tuple[slice, ComplexArray]]:
        """Stretches of the frequencies with their sums over the samples."""
        for here, sums in self._transformed(values):
            yield here, sums / self._gain(np.arange(here.start, here.stop))

    def _transformed(self, values: FloatArray) -> Iterator[tuple[slice, ComplexArray]]:
        """The same with the bell's transform still in them."""
        strands = [np.zeros(self._size // self._strands) for _ in range(self._strands)]
        for spread in self._spread():
            spread.onto(strands, values[spread.here])
        if self._strands == 1:
            yield slice(0, self.count), np.asarray(rfft(strands[0]))[: self.count]
            return
        # Each strand makes a small transform, and each frequency is the sum of these, turned (decimation in time,
        # Cooley and Tukey 1965). It is kept where its strand stood; its first and last sums are real and share a place.
        half = strands[0].size // 2
        turns = np.exp((-2j * np.pi / self._size) * np.arange(min(half, SAMPLES_PER_PIECE)))
        packed = [strand.reshape(half, 2) for strand in strands]
        for strand in packed:
            small = np.asarray(rfft(strand.ravel()))
            strand[:, 0], strand[:, 1] = small[:-1].real, small[:-1].imag
            strand[0, 1] = small[-1].real
        for begin in range(0, self.count, half):
            # A small transform goes back over itself, conjugate, from its middle on.
            back = begin // half % 2
            for here in pieces(min(half, self.count - begin)):
                k = np.arange(here.start, here.stop)
                rows = (half - k) % half if back else k
                turn = turns[: k.size] * np.exp((-2j * np.pi / self._size) * (begin + here.start))
                total: ComplexArray = np.zeros(k.size, dtype=np.complex128)
                for strand in reversed(packed):
                    real, imag = strand[rows].T
                    if here.start == 0:
                        real[0], imag[0] = strand[0, back], 0.0
                    total *= turn
                    total.real += real
                    total.imag += -imag if back else imag
                yield slice(begin + here.start, begin + here.stop), total

    def transform(self, values: FloatArray) -> ComplexArray:
        """Sums (count,) over the samples of values exp(-2 pi i f x)."""
        out = np.empty(self.count, dtype=np.complex128)
        for here, sums in self._sums(values):
            out[here] = sums
        return out

    def power(self, values: FloatArray) -> FloatArray:
        """Squares (count,) of the sums' sizes."""
        out = np.empty(self.count)
        for here, sums in self._sums(values):
            out[here] = sums.real**2 + sums.imag**2
        return out

    def transforms(self, columns: FloatArray, *, at: IntArray) -> ComplexArray:
        """The sums (k, m) for ``columns`` (n, m) at the frequencies ``at`` (k,)."""
        if self._x.size * at.size < GRID_LEAST_LOAD * self._size:
            phase = np.multiply.outer(self._x, (-2.0 * np.pi * self.step) * at)
            return np.asarray(np.cos(phase).T @ columns + 1j * (np.sin(phase).T @ columns))
        if self._spreader is None:
            self._spreader = self._matrix()
        out = np.empty((at.size, columns.shape[1]), dtype=np.complex128)
        gain = self._gain(at)
        for here in pieces(columns.shape[1], size=COLUMNS_TRANSFORMED_AT_ONCE):
            grid = np.asarray(self._spreader @ columns[:, here])
            out[:, here] = np.asarray(rfft(grid, axis=0))[at] / gain[:, None]
        return out

    def _matrix(self) -> csr_array:
        """The bells as a sparse matrix (size, n)."""
        n = self._x.size
        rows, weights = np.empty((BELL_PLACES, n), dtype=np.int32), np.empty((BELL_PLACES, n))
        for spread in self._spread():
            weights[:, spread.here] = spread.weights
            for j in range(BELL_PLACES):
                rows[j, spread.here] = (spread.first + (spread.low + j)) % self._size
        samples = np.tile(np.arange(n, dtype=np.int32), BELL_PLACES)
        return csr_array((weights.ravel(), (rows.ravel(), samples)), shape=(self._size, n))

    def wave(self, amplitudes: ComplexArray) -> FloatArray:
        """Real wave (n,) at the samples, Re sum of amplitudes exp(2 pi i f x) over the frequencies."""
        half = np.zeros(self._size // 2 + 1, dtype=np.complex128)
        half[: self.count] = amplitudes / self._gain(np.arange(self.count))
        # irfft counts each frequency above zero twice, once for its mirror image.
        half[1:] *= 0.5
        grid = irfft(half, self._size) * self._size
        out = np.empty(self._x.size)
        for spread in self._spread():
            out[spread.here] = spread.taken(grid)
        return out


class Repeating:
    """Least squares of ``count`` harmonics of a ``period`` (in units of ``x``) over samples at ``x`` (n,).

    Conjugate gradients on the normal equations, whose matrix depends on differences of frequencies only and so acts
    by FFT. Twelve rounds bring evenly sampled records to rounding error; where gaps make the equations ill
    conditioned, stopping there leaves what the data do not fix at zero. Derived here.
    """

    def __init__(self, x: FloatArray, *, period: float, count: int, rounds: int = 12) -> None:
        self.grid = FrequencyGrid(x, step=1.0 / period, count=count)
        self._rounds = rounds
        kernel = FrequencyGrid(x, step=1.0 / period, count=2 * count - 1).transform(np.ones(x.size))
        # Coefficients of real waves are conjugate on both sides of zero: half of them do, and transforms are real.
        self._size = next_fast_len(4 * count, real=True)
        self._gain = np.asarray(hfft(kernel, self._size))

    def _apply(self, c: ComplexArray) -> ComplexArray:
        product: ComplexArray = ihfft(hfft(c, self._size) * self._gain)[: c.size]
        return product

    def part(self, values: FloatArray) -> FloatArray:
        """What of ``values`` (n,) repeats, (n,)."""
        return self.grid.wave(self.fitted(self.grid.transform(values)))

    def fitted(self, sums: ComplexArray) -> ComplexArray:
        """Amplitudes (count,) of the harmonics, for ``grid.wave``, from the values' ``sums`` (count,) over the
        samples."""
        c = np.zeros_like(sums)
        r = sums.copy()
        p = r.copy()
        power = _product(r, r)
        start = power
        for _ in range(self._rounds):
            # 1e-14 in power: a ten millionth of the content, far below any noise.
            if power <= 1e-14 * start or power == 0.0:
                break
            q = self._apply(p)
            alpha = power / _product(p, q)
            c += alpha * p
            r -= alpha * q
            new = _product(r, r)
            p = r + (new / power) * p
            power = new
        c[1:] *= 2.0
        return c


def _product(a: ComplexArray, b: ComplexArray) -> float:
    """Inner product of coefficients on both sides of zero, of which ``a`` and ``b`` (k,) are one."""
    return float(2.0 * np.vdot(a, b).real - (np.conj(a[0]) * b[0]).real)


ACROSS = 3.0
"""Middle steps that a sample stands for at the most: one beside a gap says nothing of the gap. Weighed by half of gaps
of 30 meshes, a dozen samples raised a spectrum of 0.03 um to 0.5."""


def sample_weights(x: FloatArray) -> FloatArray:
    """The stretch (n,) of ``x`` (n,), which does not fall, that each sample stands for."""
    step = np.gradient(x)
    return np.asarray(np.minimum(step, ACROSS * float(np.median(step))))
