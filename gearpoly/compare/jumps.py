"""Jumps: the transmission error steps at one moment and stays there, by a slipped coupling or a knocked reader.

A step that begins at sample j is 0 before and 1 from there on, so its product with anything is a sum from j to the end,
and one sum run backward weighs all places at once. Whatever is fitted beside it (slow curves, means, teeth) explains a
part of the step; only the rest counts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.families import SHARES, log_tail_line
from gearpoly.compare.noise import Noise
from gearpoly.compare.noise_spectrum import AR_ORDER
from gearpoly.units import BoolArray, FloatArray, IntArray

CLIP = 4.5
"""Standard deviations at which a sample's innovation is cut before steps are weighed, so that a short burst is no step;
one honest sample in 150 000 is larger."""

SIZE_ROUNDS = 8
"""Rounds in which a step's size comes to rest beside innovations that are cut about it: with one in a hundred cut each
leaves a hundredth of the way. A judgement."""

INFORMATION_LEFT = 1e-3
"""Part of a step's information that must be left beside everything else, or it is told from nothing."""

EXPLAINED_PLACES = 2048
"""Places at which the part that all else explains is worked out. It bends with teeth at the most: drawn straight in
between it is good enough to find a jump, and about the jump itself every sample is such a place."""

LONGEST_RISE = 0.25
"""Part of the record up to which a rise that takes its time is tried in the place of a jump; slower ones are the slow
curves' matter."""

SHORTEST_BUMP = 8
"""Samples from which on a bump is one; fewer outliers are cut off before anything is weighed."""

WANDERING_NOISE_RATIO = 2.0
"""Noise on slow lines over what the model has from which on it wanders: twelve lines of honest noise make as much once
in some hundred times. Then a jump has to be sharp, since what wanders is up here and down there too."""

WANDERING = (4, 16)
"""Turns of the record from which that is read: none that slow curves took a part of."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Left:
    """One recording as the joint fit leaves it: the whitened columns of the fit in parts (n, m_k) side by side,
    ``whites``, which are large and never copied; ``beta`` (m,) in mm with its ``covariance`` (m, m), ``rest`` (n,)
    whitened samples that are left, and the ``noise`` that whitened both."""

    whites: tuple[FloatArray, ...]
    beta: FloatArray
    covariance: FloatArray
    rest: FloatArray
    noise: Noise

    def apply(self, beta: FloatArray) -> FloatArray:
        """The product (n,) of the whitened columns with ``beta`` (m,)."""
        ends = np.cumsum([white.shape[1] for white in self.whites])[:-1]
        parts = zip(self.whites, np.split(beta, ends), strict=True)
        return np.asarray(sum((white @ mine for white, mine in parts), np.zeros(self.rest.size)))

    def adjoint(self, values: FloatArray) -> FloatArray:
        """The products (m,) or (m, q) of the whitened columns with ``values`` (n,) or (n, q)."""
        return np.concatenate([white.T @ values for white in self.whites])

    def beside_steps(self, at: IntArray) -> FloatArray:
        """The products (q, m) of the whitened columns with whitened steps of 1 mm at the samples ``at`` (q,), in
        ascending order: a step's whitening stays at its last value from where its beginning is forgotten."""
        response = _response(self.noise)
        out = []
        for white in self.whites:
            after = np.cumsum(np.add.reduceat(white, at, axis=0)[::-1], axis=0)[::-1] * response[-1]
            for k, more in enumerate(response[:-1] - response[-1]):
                inside = at + k < white.shape[0]
                after[inside] += more * white[at[inside] + k]
            out.append(after)
        return np.concatenate(out, axis=1)

    def without(self, places: IntArray) -> Left:
        """The same with parameters at ``places`` (k,) held at nothing, and all others fitted again."""
        if not places.size:
            return self
        toward = self.covariance[:, places] @ np.linalg.inv(self.covariance[np.ix_(places, places)])
        moved = toward @ self.beta[places]
        return replace(
            self,
            beta=self.beta - moved,
            covariance=self.covariance - toward @ self.covariance[places],
            rest=self.rest + self.apply(moved),
        )

    def beside(self, columns: FloatArray) -> Left:
        """The same with further free whitened ``columns`` (n, q) fitted."""
        cross = self.adjoint(columns)
        toward = self.covariance @ cross
        own = np.linalg.inv(columns.T @ columns - cross.T @ toward)
        b = own @ (columns.T @ self.rest)
        mixed = -toward @ own
        return Left(
            whites=(*self.whites, columns),
            beta=np.concatenate((self.beta - toward @ b, b)),
            covariance=np.block([[self.covariance + toward @ own @ toward.T, mixed], [mixed.T, own]]),
            rest=self.rest - columns @ b + self.apply(toward @ b),
            noise=self.noise,
        )

    def explained(self, places: IntArray) -> float:
        """Gain in misfit of the parameters at ``places``, all others fitted again without them."""
        b = self.beta[places]
        return float(b @ np.linalg.solve(self.covariance[np.ix_(places, places)], b))

    def gains(self, columns: FloatArray) -> FloatArray:
        """Gain in misfit (q,) of each of further whitened ``columns`` (n, q), all else fitted again beside it."""
        cross = self.adjoint(columns)
        own = np.sum(columns**2, axis=0)
        information = own - np.sum(cross * (self.covariance @ cross), axis=0)
        told = information > INFORMATION_LEFT * own
        return np.where(told, (columns.T @ self.rest) ** 2 / np.where(told, information, 1.0), 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Steps:
    """A step at each of the samples ``first``, ``first`` + 1, ...: its ``score`` (q,) in 1/mm and ``information`` (q,)
    in 1/mm^2 beside all that is fitted. ``tests`` is the sum of the rates at which their correlation falls."""

    first: int
    score: FloatArray
    information: FloatArray
    tests: float

    @property
    def gain(self) -> FloatArray:
        """Gain in misfit (q,) of a step at each place."""
        return self.score**2 / self.information

    @property
    def best(self) -> int:
        """The sample at which a step gains most."""
        return self.first + int(np.argmax(self.gain))

    def at(self, j: int) -> tuple[float, float, float]:
        """Gain of a step at sample ``j``, its amplitude and standard error in mm in noise as the model has it."""
        score, information = float(self.score[j - self.first]), float(self.information[j - self.first])
        return score**2 / information, score / information, 1.0 / math.sqrt(information)

    def moment(self, x: FloatArray, *, level: float, about: int, within: int) -> tuple[float, float]:
        """Mean and standard error of ``x`` (n,) at the jump at sample ``about``, each place ``within`` so many samples
        as likely as it fits in noise of ``level`` times the model's power: farther off, it is another jump's. What
        happens between two samples happens anywhere between them."""
        at = np.arange(self.first, self.first + self.score.size)
        near = np.abs(at - about) <= within
        likely = np.where(near, np.exp(0.5 * (self.gain - np.max(self.gain[near])) / level), 0.0)
        likely /= np.sum(likely)
        middle, width = 0.5 * (x[at] + x[at - 1]), x[at] - x[at - 1]
        mean = float(likely @ middle)
        return mean, math.sqrt(float(likely @ ((middle - mean) ** 2 + width**2 / 12.0)))

    def log_false(self, gain: float, *, colour: tuple[float, float], recordings: int) -> float:
        """Log of the expected number of steps in noise that gain as much anywhere in ``recordings`` such recordings,
        over the search's share of chance.

        Neighbouring steps share all samples but one, so scores run like a Brownian path: where their correlation falls
        by c per step, either sign exceeds b at a rate of 2 c b phi(b) (Pickands 1969). Of white noise over a record c
        adds up to its log length. ``colour``: the noise that a step meets over what the model has, and the number of
        lines that is known from.
        """
        level, count = colour
        z = 0.5 * gain / level
        tail = float(log_tail_line(np.array(z), np.array(count)))
        return math.log(self.tests * recordings / SHARES.jump) + 0.5 * math.log(max(z, 1.0) / math.pi) + tail


def _response(noise: Noise) -> FloatArray:
    """What the whitening makes of a step of 1 mm, from its first sample on (p + 1,); it stays at the last value."""
    return np.asarray((1.0 - np.concatenate([[0.0], np.cumsum(noise.ar)])) / noise.innovation)


def rise(n: int, begin: int, *, width: int, noise: Noise) -> FloatArray:
    """Whitened rise (n,) by 1 mm, straight over ``width`` samples from ``begin`` on (1: a jump there)."""
    return noise.whitened(np.clip((np.arange(n) - (begin - 1)) / width, 0.0, 1.0))


def _from_here(values: FloatArray) -> FloatArray:
    """Sums of ``values`` (n,) from each place to the end."""
    return np.cumsum(values[::-1])[::-1]


def weigh_steps(left: Left, *, low: int, high: int, barred: BoolArray) -> Steps:
    """Steps at samples ``low`` to ``high`` - 1, all in one pass; at those that are ``barred`` (n,) none is looked for.

    The fall of correlation is taken over as many samples as the noise may remember.
    """
    noise, n = left.noise, left.rest.size
    scale = max(1.0, 1.4826 * float(np.median(np.abs(left.rest))))
    cut = np.clip(left.rest, -CLIP * scale, CLIP * scale)
    score = _from_here(noise.score(cut))
    off = cut - left.rest
    if off.any():
        # What was cut off would have been fitted by the slow curves too: they follow.
        score = score - _from_here(noise.score(left.apply(left.covariance @ left.adjoint(off))))
    response = _response(noise)
    squares = np.cumsum(response**2)
    length = n - np.arange(low, high)
    own = squares[np.minimum(length, response.size) - 1]
    own = own + np.maximum(length - response.size, 0) * response[-1] ** 2
    information = own - _explained(left, low=low, high=high)
    safe = np.maximum(information, INFORMATION_LEFT * own)
    score = np.where((information > INFORMATION_LEFT * own) & ~barred[low:high], score[low:high], 0.0)
    falls = np.minimum(0.5 * _bump(noise, AR_ORDER) / safe, 1.0) / AR_ORDER
    return Steps(first=low, score=score, information=safe, tests=float(2.0 * np.sum(falls)))


def size_of(left: Left, j: int, *, width: int = 1) -> tuple[float, float]:
    """Size of a step at sample ``j`` in mm that took ``width`` samples, and its standard error in mm.

    A sharp step is known by its first innovation, which is cut as a burst's would be while steps are looked for: steps
    of nine standard deviations came out a fifth too small. So innovations are cut about the step itself (Huber 1964),
    from that of least squares on: however large a step is, it is then not cut.
    """
    column = rise(left.rest.size, j - width // 2, width=width, noise=left.noise)
    column = column - left.apply(left.covariance @ left.adjoint(column))
    information = float(column @ column)
    scale = max(1.0, 1.4826 * float(np.median(np.abs(left.rest))))
    amplitude = float(column @ left.rest) / information
    for _ in range(SIZE_ROUNDS):
        off = left.rest - amplitude * column
        amplitude += float(column @ np.clip(off, -CLIP * scale, CLIP * scale)) / information
    return amplitude, 1.0 / math.sqrt(information)


def sharpened(left: Left, steps: Steps, *, barred: BoolArray) -> Steps:
    """The same with every sample about the best one worked out."""
    low = max(steps.first, steps.best - EXPLAINED_PLACES // 2)
    high = min(steps.first + steps.score.size, low + EXPLAINED_PLACES)
    near = weigh_steps(left, low=low, high=high, barred=barred)
    information = steps.information.copy()
    information[low - steps.first : high - steps.first] = near.information
    return replace(steps, information=information)


def _explained(left: Left, *, low: int, high: int) -> FloatArray:
    """Information (high - low,) of steps that the fitted columns share."""
    at = np.unique(np.linspace(low, high - 1, min(EXPLAINED_PLACES, high - low)).astype(np.int64))
    cross = left.beside_steps(at)
    shared = np.einsum("qm,qm->q", cross @ left.covariance, cross)
    return np.asarray(np.interp(np.arange(low, high), at, shared))


def colour_of(left: Left, j: int, *, beside: FloatArray, spacing: float) -> tuple[float, float]:
    """Noise that a step at sample ``j`` meets over what the model has of it, and the number of lines that is known
    from: a step less what curves ``beside`` (n, k) take of it lives on the slowest lines, where noise may wander.
    ``spacing`` meshes from sample to sample."""
    step = rise(left.rest.size, j, width=1, noise=left.noise)
    curves = left.noise.whitened(beside)
    step = step - curves @ np.linalg.lstsq(curves, step, rcond=None)[0]
    power = np.abs(np.fft.rfft(step)) ** 2
    frequency = np.arange(power.size) / (step.size * spacing)
    rest, count = left.noise.rest_at(np.asarray(frequency, dtype=np.float64))
    weight = power * rest
    return max(1.0, float(np.sum(weight) / np.sum(power))), float(weight @ count / np.sum(weight))


def wanders(noise: Noise, *, span: float) -> bool:
    """Whether noise is slower than its model has it, in a recording ``span`` meshes long."""
    rest, _ = noise.rest_at(np.arange(*WANDERING, dtype=np.float64) / span)
    return float(np.mean(rest)) > WANDERING_NOISE_RATIO


def sharpness(left: Left, j: int, *, turn: int) -> float:
    """Gain by which a jump at sample ``j`` explains more than any rise thereabouts that takes a ``turn`` (in samples)
    or longer, as what warms up or wanders does, and than any bump that is over within a turn, wherever it is."""
    n = left.rest.size
    rises = [(j, 1)]
    width = turn
    while width <= LONGEST_RISE * n:
        rises += [(j - quarter * width // 4, width) for quarter in range(5)]
        width *= 2
    gains = left.gains(np.stack([rise(n, begin, width=w, noise=left.noise) for begin, w in rises], axis=1))
    return float(gains[0] - max(_largest_bump(left, j, turn=turn), np.max(gains[1:], initial=0.0)))


def _largest_bump(left: Left, j: int, *, turn: int) -> float:
    """Gain of the bump that explains most: of any length up to a ``turn`` (in samples) from sample ``j`` on or up to
    there, and of some lengths anywhere. A bump is a step up and a step down, so the difference of two scores."""
    n = left.rest.size
    score = np.append(_from_here(left.noise.score(left.rest)), 0.0)
    length = np.arange(SHORTEST_BUMP, max(turn, SHORTEST_BUMP) + 1)
    # Beyond what the whitening remembers every further sample adds the same.
    information = _bump(left.noise, turn) - (turn - length) * _response(left.noise)[-1] ** 2
    information = np.maximum(information, _bump(left.noise, SHORTEST_BUMP))
    best = 0.0
    for here in (np.minimum(j + length, n), np.maximum(j - length, 0)):
        best = max(best, float(np.max((score[here] - score[j]) ** 2 / information)))
    for some in (turn, turn // 2, turn // 4):
        best = max(best, float(np.max((score[:-some] - score[some:]) ** 2)) / _bump(left.noise, some))
    return best


def _bump(noise: Noise, length: int) -> float:
    """Information in 1/mm^2 of a bump of so many samples."""
    white = noise.whitened(np.pad(np.ones(length), AR_ORDER))
    return float(white @ white)


@dataclass(eq=False)
class Jump:
    """A jump that was found in one recording: 0 before sample ``at``, 1 from there on, or straight over ``width``
    samples about it where it takes as long. Two that have moved to the same sample stay two, and are told apart as
    such."""

    at: int
    width: int = 1

    def column(self, n: int) -> FloatArray:
        """The step (n,)."""
        return np.clip((np.arange(n) - self.at + 0.5 * (self.width + 1)) / self.width, 0.0, 1.0)
