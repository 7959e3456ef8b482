"""Strong waves that hide in the noise they raise themselves, and the frequencies of waves that are fitted.

A strong wave of a few turns of the record spreads over all lines from which the noise there is estimated, and then
looks like noise that wanders. So the strongest line is weighed against the noise that is left without it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from gearpoly.compare.courses import chances, slow_noise
from gearpoly.compare.families import SHARES, log_false_any
from gearpoly.compare.lines import TIE, likelier, snapped
from gearpoly.compare.model import JointModel, State
from gearpoly.compare.noise import Noise, NoiseEstimator
from gearpoly.compare.peak import Domain, Peak
from gearpoly.compare.pieces import pieces
from gearpoly.compare.regression import Solution
from gearpoly.compare.sampling import SLOWEST, Sampling, sampling_of
from gearpoly.compare.set_up import AlignedResidual
from gearpoly.compare.sinusoids import cosine_and_sine, refined
from gearpoly.compare.slow import slow_curves
from gearpoly.compare.spectrum import placed_to
from gearpoly.units import FloatArray

OF_ITS_OWN = 25.0
"""Gain by which a frequency of its own must fit better than a sum or a difference of two orders: five standard
deviations, since such sums are many. A wave of order 1.7775 of 6.8 turns gained 59 over one of 1.75."""

OF_WHOLE_ORDERS = 0.02
"""Part of its gain by which a wave fixed in time must fit better than the whole order that it falls on, beside chance:
what of other waves is not taken off yet puts either ahead. Three orders of a sensor were so by up to 0.009 and 0.012 of
their gain of 10^5; a wave fixed in time gains as much where the shaft strays by 0.14 rad of it."""

LAW_LINES, PLACES_PER_LINE = 3.5, 2.0
"""Turns of the record below which a wave of no known order is held against the power law of all that is faster, at so
many places for each. Without its line, noise that wanders seemed to have less there: of 30 recordings of a random walk
five had waves of 1.8 to 2.3 turns, at 4e-6 to 4e-5."""

FREQUENCY_BESIDE_LINES = 0.75
"""Lines by which slow curves draw a wave of so few turns: of two turns in a recording a cubic takes a part, and what it
leaves is strongest elsewhere. 10 um of 1.6 and 2.0 turns in 0.1 um of noise were not found without it; of 30 random
walks as many had waves with it as without."""

MOST_FREQUENCY_STEP_LINES, FREQUENCY_STEPS = 0.25, 2
"""Independent lines by which a fitted wave's frequency may move at once, beyond which a straight line is no guide, and
Newton steps: each squares what is left to go, and the first lands within a hundredth of a line."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Masked:
    """A strong wave: its ``peak``, its cosine and sine ``heights`` (2,) in mm, and the ``noise`` without it."""

    peak: Peak
    heights: FloatArray
    noise: Noise

    def at(self, u: FloatArray, time_s: FloatArray | None) -> FloatArray:
        """The wave (n,) in mm at ``u`` (n,) meshes and ``time_s`` (n,) s."""
        x = time_s if self.peak.domain == "time" and time_s is not None else u
        out = np.empty(x.size)
        for here in pieces(x.size):
            angle = (2.0 * np.pi * self.peak.frequency) * x[here]
            out[here] = self.heights[0] * np.cos(angle) + self.heights[1] * np.sin(angle)
        return out


def masked_wave(
    sampling: Sampling, estimator: NoiseEstimator, slow: FloatArray, values: FloatArray, *, recordings: int,
    floor: float,
) -> Masked | None:  # fmt: skip
    """The strongest wave beside the ``slow`` curves (n, q) in ``values`` (n,) in mm of one of ``recordings``, of
    ``floor`` in mm at least, where it is no chance in the noise without it; ``None`` where it may be noise."""
    left = values - slow @ np.linalg.lstsq(slow, values, rcond=None)[0]
    domains: list[Domain] = ["order"] if sampling.time_grid is None else ["order", "time"]
    domain, frequency, _ = max((_strongest(sampling, left, one) for one in domains), key=lambda one: one[2])
    x, _, span, _ = sampling.over(domain)
    whole = snapped(sampling, frequency, SNAPS / span) if domain == "order" else None
    frequency = frequency if whole is None else whole
    if whole is None and frequency * span < LAW_LINES:
        frequency = _beside(slow, x, left, frequency, within=FREQUENCY_BESIDE_LINES / span)
    columns = np.concatenate([slow, _rows(x, frequency)], axis=1)
    beta = np.linalg.lstsq(columns, left, rcond=None)[0]
    if float(np.hypot(*beta[-2:])) < floor:
        return None
    noise = estimator.estimate(left - columns @ beta)
    rest, count = sampling.rest_at(domain, np.array([frequency]), noise)
    white = noise.whitened(np.column_stack([left, columns]))
    with_it, without = (
        float(np.sum((white[:, 0] - design @ np.linalg.lstsq(design, white[:, 0], rcond=None)[0]) ** 2))
        for design in (white[:, 1:], white[:, 1:-2])
    )
    z = np.array([0.5 * (without - with_it)]) / rest
    lines = sampling.nyquist * sampling.span * recordings / SHARES.between
    log_false = float(log_false_any(z, count, lines=lines)[0])
    if log_false >= 0.0:
        return None
    if whole is None and frequency * span < LAW_LINES and _by_law(x, left, columns, beta, frequency * span, noise):
        return None
    gain = 2.0 * float(z[0])
    # As in ``lines``: half a turn of phase over the record costs the line.
    std = 0.0 if whole is not None else 0.551 / span / math.sqrt(gain)
    peak = Peak(domain=domain, frequency=frequency, std=std, gain=gain, log_false=log_false, known=whole is not None)
    return Masked(peak=peak, heights=beta[-2:], noise=noise)


def _beside(slow: FloatArray, x: FloatArray, left: FloatArray, frequency: float, *, within: float) -> float:
    """The frequency, ``within`` so much of one, that leaves least of ``left`` (n,) over ``x`` (n,) beside ``slow``
    curves (n, q)."""
    curves = np.linalg.qr(slow)[0]
    own = left - curves @ (curves.T @ left)

    def misfit(at: float) -> float:
        rows = _rows(x, at)
        rows = rows - curves @ (curves.T @ rows)
        return float(np.sum((own - rows @ np.linalg.lstsq(rows, own, rcond=None)[0]) ** 2))

    best = minimize_scalar(misfit, bounds=(frequency - within, frequency + within), method="bounded")
    return float(best.x)


def _by_law(
    x: FloatArray, left: FloatArray, columns: FloatArray, beta: FloatArray, lines: float, noise: Noise
) -> bool:  # fmt: skip
    """Whether a wave of so few ``lines`` over ``x`` (n,), the last two of ``columns`` (n, q) that are fitted to what is
    ``left`` (n,) with sizes ``beta`` (q,), may be how the recording wanders: by the law of what is faster than it."""
    at: FloatArray = np.array([lines])
    level, doubt = slow_noise(x, left - columns @ beta, at=at, skip=noise.cycles, beside=columns.shape[1])
    power: FloatArray = np.array([0.5 * x.size * float(beta[-2:] @ beta[-2:])])
    chance = float(chances(power, level, doubt, freedoms=2)[0])
    return chance * LAW_LINES * PLACES_PER_LINE >= SHARES.between


def strong_waves(data: AlignedResidual, *, z_1: int, z_2: int, recordings: int, floor: float) -> list[Masked]:
    """The waves of a recording that would hide in the noise they raise, strongest first."""
    sampling = sampling_of(u=data.u, time=data.time_s, z_1=z_1, z_2=z_2, averaged=data.averaged > 0.0)
    estimator = NoiseEstimator(data.u, z_1=z_1, z_2=z_2)
    slow = slow_curves(data.u if data.time_s is None else data.time_s)
    left, out = data.residual, list[Masked]()
    for _ in range(STRONG):
        found = masked_wave(sampling, estimator, slow, left, recordings=recordings, floor=floor)
        if found is None:
            break
        out.append(found)
        left = left - found.at(data.u, data.time_s)
    return out


STRONG = 8
"""Strong waves that are taken off before the noise of all samples of a long record is estimated; weaker ones hardly
raise it."""

SNAPS = 0.1
"""Independent lines by which the strongest line of a whole residual may miss a known order: what other waves and the
slow curves push it by."""


def _strongest(sampling: Sampling, left: FloatArray, domain: Domain) -> tuple[Domain, float, float]:
    """Frequency of the largest line of ``left`` (n,) over angle or time that is no drift, and its power."""
    x, grid, span, _ = sampling.over(domain)
    power = grid.power(left)
    frequency: FloatArray = grid.step * np.arange(power.size, dtype=np.float64)
    power[frequency < SLOWEST / span] = 0.0
    best, more = refined(x, left, float(frequency[np.argmax(power)]), span)
    return domain, best, float(np.max(power)) * max(more, 1.0)


def settle_waves(model: JointModel, solution: Solution) -> bool:
    """Move every fitted wave of no known order to the frequency, over angle or over time, that the fit of everything
    asks for; whether any moved by more than a hundredth of its error.

    A wave was placed while others were not yet taken off, and raised the noise that it was weighed in: it may have been
    taken for a sum or a difference of two orders, and be none.
    """
    moved = False
    for s, left, places in zip(model.states, solution.left, model.places, strict=True):
        slow = np.linalg.qr(s.noise.whitened(s.slow))[0]
        # The fit has them in this order; what moves goes to the end.
        held = {"orders": list(s.orders), "times": list(s.times)}
        for name, j, peak in [(name, j, p) for name, peaks in held.items() for j, p in enumerate(peaks)]:
            if peak.faint or (peak.known and any(_whole(z * peak.frequency) for z in (model.z_1, model.z_2))):
                continue
            ab = solution.beta[places[name][2 * j : 2 * j + 2]]
            values = left + _rows(s.sampling.over(peak.domain)[0], peak.frequency) @ ab
            other: Domain = "order" if peak.domain == "time" else "time"
            settled = _settled(s, values, slow, peak, peak.frequency)
            if peak.known:
                there = _settled(s, values, slow, peak, peak.frequency, steps=0)
                if settled.gain < there.gain + OF_ITS_OWN:
                    continue
                std = placed_to(settled.gain, span=s.sampling.over(peak.domain)[2])
                settled = replace(settled, known=False, std=std)
            free = settled
            if s.sampling.time_grid is not None:
                turned = peak.frequency * s.sampling.over(peak.domain)[3] / s.sampling.over(other)[3]
                as_other = _settled(s, values, slow, replace(peak, domain=other), turned)
                free = settled if settled.domain == "order" else as_other
                settled = likelier(s.sampling, settled, as_other)
            settled = _on_whole_order(s, values, slow, free, settled)
            (s.times if name == "times" else s.orders).remove(peak)
            (s.times if settled.domain == "time" else s.orders).append(settled)
            moved |= settled.domain != peak.domain or abs(settled.frequency - peak.frequency) > 0.01 * peak.std
    return moved


def _on_whole_order(s: State, values: FloatArray, slow: FloatArray, free: Peak, settled: Peak) -> Peak:
    """The whole order of a shaft that a ``settled`` wave falls on, if neither the same wave at a ``free`` order nor in
    time fits clearly better; else the wave. Few waves fixed in time come so near by chance, but the mains' often do."""
    sampling = s.sampling
    timely = settled.gain if settled.domain == "time" else settled.rival
    if free.frequency > sampling.nyquist and settled.domain == "time" and not settled.hum:
        # Beyond what is searched whole orders are not listed.
        near = any(abs(free.frequency - round(free.frequency * z) / z) * sampling.span < SNAPS
                   for z in (sampling.z_1, sampling.z_2))  # fmt: skip
        ahead = timely > free.gain + max(TIE, OF_WHOLE_ORDERS * timely)
        return settled if ahead or not near else replace(free, rival=timely, image=settled.image)
    exact = snapped(sampling, sampling.per_mesh(settled), free.std)
    if exact is None or settled.hum or not any(_whole(z * exact) for z in (sampling.z_1, sampling.z_2)):
        return settled
    if any(p.known and abs(p.frequency - exact) * sampling.span < SNAPS for p in s.orders):
        return settled
    there = _settled(s, values, slow, replace(free, known=True, std=0.0), exact, steps=0)
    if free.gain > there.gain + OF_ITS_OWN or timely > there.gain + max(TIE, OF_WHOLE_ORDERS * timely):
        return settled
    return replace(there, rival=timely, image=settled.image)


def _whole(order: float) -> bool:
    return abs(order - round(order)) < 1e-6


def _rows(x: FloatArray, frequency: float) -> FloatArray:
    """Cosine and sine (n, 2)."""
    return cosine_and_sine(x, np.array([frequency]))


def _settled(
    s: State, values: FloatArray, slow: FloatArray, peak: Peak, frequency: float, *, steps: int = FREQUENCY_STEPS
) -> Peak:
    """The wave that fits ``values`` (n,) in mm best near ``frequency``, beside the curves that span the orthonormal,
    white columns ``slow`` (n, q): to first order a frequency is one more column, x times the wave turned by a
    quarter."""
    x, _, span, _ = s.sampling.over(peak.domain)
    along = 2.0 * np.pi * (x - 0.5 * (x[0] + x[-1]))

    def beside(values: FloatArray) -> FloatArray:
        white = s.noise.whitened(values)
        return np.asarray(white - slow @ (slow.T @ white))

    without = beside(values)
    gain = 0.0
    for step in range(steps + 1):
        waves = _rows(x, frequency)
        columns = beside(waves)
        inverse = np.linalg.pinv(columns.T @ columns, hermitian=True)
        beta = inverse @ (columns.T @ without)
        rest = without - columns @ beta
        gain = float(without @ without - rest @ rest)
        if step == steps:
            break
        turned = beside(along * (beta[1] * waves[:, 0] - beta[0] * waves[:, 1]))
        turned -= columns @ (inverse @ (columns.T @ turned))
        by = float(turned @ rest) / max(float(turned @ turned), 1e-300)
        frequency += float(np.clip(by, -MOST_FREQUENCY_STEP_LINES / span, MOST_FREQUENCY_STEP_LINES / span))
    level = float(s.sampling.rest_at(peak.domain, np.array([frequency]), s.noise)[0][0])
    return replace(peak, frequency=frequency, gain=gain / level)
