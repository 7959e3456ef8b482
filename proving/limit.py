"""How small an effect any method could find: the theoretical limit sigma / ||s_perp||, from this bench's own signals.

What a recording says of an effect is its signal less what the pitch and slope of every tooth, the mean and the scale
of a declared compliance could make of it, each as freely as is known beforehand. White or AR(1) noise is whitened.
Derived here: with noise covariance V, nuisance columns N and their prior covariance P, (size / limit)^2 = s' (V + N P
N')^-1 s."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from proving.chain import Chain, Condition, Motion, te
from proving.contact import SLOTS
from proving.gears import UM, FloatArray
from proving.rig import Rig, mesh

POINTS = 4000
"""Samples of a set of recordings that are looked at; the others are counted as if they said the same."""
LAW = 5
"""Columns for what a compliance law leaves open: its scale, three shapes over the path of contact, a power of the
load."""
LOOSE = 1e-9
"""1/um^2: the prior of what nobody knows; a standard deviation of 30 mm."""


@dataclass(frozen=True, kw_only=True)
class Sight:
    """The samples looked at in one recording: times in s (with the sample before each where the noise has a colour)."""

    condition: Condition
    path: Motion
    time: FloatArray
    before: FloatArray | None
    share: float


def sights(conditions: tuple[Condition, ...], paths: tuple[Motion, ...], chain: Chain) -> tuple[Sight, ...]:
    """Where to look at a set of recordings."""
    total = sum(path.time.size for path in paths)
    stride = max(1, -(-total // POINTS))
    out = []
    for condition, path in zip(conditions, paths, strict=True):
        at = np.arange(1, path.time.size, stride)
        before = path.time[at - 1] if chain.colour else None
        out.append(
            Sight(condition=condition, path=path, time=path.time[at], before=before, share=path.time.size / at.size)
        )
    return tuple(out)


def _whiten(sight: Sight, chain: Chain, now: FloatArray, then: FloatArray | None) -> FloatArray:
    scale = sqrt(sight.share) / (chain.noise_um * sqrt(1 - chain.colour**2))
    return np.asarray(scale * (now if then is None else now - chain.colour * then))


def signal(rig: Rig, look: tuple[Sight, ...], chain: Chain) -> FloatArray:
    """The rig's transmission error in um over all recordings, whitened to unit noise."""
    parts = []
    for sight in look:
        now = te(rig, sight.condition, sight.path, at=sight.time) / UM
        then = None if sight.before is None else te(rig, sight.condition, sight.path, at=sight.before) / UM
        parts.append(_whiten(sight, chain, now, then))
    return np.concatenate(parts)


def _columns(rig: Rig, sight: Sight, time: FloatArray, full_torque: float) -> FloatArray:
    """Nuisance columns in um per um: index of every tooth, slope of every tooth, mean, thickness, compliance."""
    pair = rig.pair
    drive = sight.condition.flank == "drive"
    got = mesh(rig, sight.path.angle(time), torque=sight.condition.torque, flank=sight.condition.flank)
    n, rows = time.size, np.arange(time.size)
    z_1, z_2 = pair.driving.z, pair.driven.z
    out = np.zeros((n, 2 * (z_1 + z_2) + 3 + LAW))
    side = 1.0 if drive else -1.0
    starts = (0, z_1, z_1 + z_2, 2 * z_1 + z_2)
    law = np.zeros((n, LAW))
    full = 1000 * full_torque / pair.driven.r_b
    for slot in range(SLOTS):
        w = got.weights[:, slot]
        for index, tooth, roll in ((1, got.tooth_1, got.roll_1), (2, got.tooth_2, got.roll_2)):
            start = pair.l_start(index)
            u = (roll[:, slot] - start) / (pair.gear(index).l_tip - start)
            out[rows, starts[index - 1] + tooth[:, slot]] += w
            out[rows, starts[index + 1] + tooth[:, slot]] += side * w * (u - 0.5)
            if index == 1:
                sag = side * w * got.deflections[:, slot] / UM
                for k in range(LAW - 1):
                    law[:, k] += sag * (2 * u - 1) ** k
                law[:, -1] += sag * np.log(np.maximum(got.forces[:, slot], 1e-3 * full + 1e-9) / (full + 1e-9))
    mean = 2 * (z_1 + z_2)
    out[:, mean] = 1.0
    if not drive:
        out[:, mean + 1 : mean + 3] = 1.0
    out[:, mean + 3 :] = law
    return out


class Limit:
    """The limit of one set of recordings: build it once, then ask it for each effect.

    index, slope: prior covariances (um^2) of the gears' index deviations and slopes, driving then driven; thickness:
    prior standard deviation (um) of both; compliance: prior standard deviation of a declared compliance's scale, 0
    where none is declared."""

    def __init__(
        self, rig: Rig, look: tuple[Sight, ...], chain: Chain, *, index: tuple[FloatArray, FloatArray],
        slope: tuple[FloatArray, FloatArray], thickness: float, compliance: float,
    ) -> None:  # fmt: skip
        self.look, self.chain, self.base = look, chain, signal(rig, look, chain)
        self.z_1 = rig.pair.driving.z
        self.plain = [te(rig, one.condition, one.path, at=one.time) / UM for one in look]
        parts = []
        top = max(one.condition.torque for one in look)
        for sight in look:
            now = _columns(rig, sight, sight.time, top)
            then = None if sight.before is None else _columns(rig, sight, sight.before, top)
            parts.append(_whiten(sight, chain, now, then))
        self.N = np.concatenate(parts)
        k = self.N.shape[1]
        inverse = np.zeros((k, k))
        place = 0
        for block in (*index, *slope):
            size = block.shape[0]
            inverse[place : place + size, place : place + size] = np.linalg.inv(block + 1e-6 * np.eye(size))
            place += size
        inverse[place, place] = LOOSE
        inverse[place + 1, place + 1] = inverse[place + 2, place + 2] = 1 / thickness**2
        # Where nothing is declared, the columns of compliance are tied to zero, like a prior of a thousandth.
        for j in range(LAW):
            inverse[place + 3 + j, place + 3 + j] = 1 / max(compliance * (1.0 if j == 0 else 0.6), 1e-3) ** 2
        self.factor = cho_factor(self.N.T @ self.N + inverse)

    def perp(self, s: FloatArray) -> FloatArray:
        """A whitened signal less what the nuisances would make of it (in the metric of the limit)."""
        return np.asarray(s - self.N @ cho_solve(self.factor, self.N.T @ s))

    def over(self, rig: Rig) -> float:
        """Size over limit of what a rig has beyond the one the limit was built with."""
        return self.size_of(self.difference(rig))

    def index_signal(self, index: int, dp: FloatArray) -> FloatArray:
        """Whitened signal of a change dp (um) of the index deviations of gear 1 or 2, to first order.

        It is taken as the nuisances take it: which pair leads changes with the size of a pitch error, and that bend
        would count as evidence though a fit of the teeth follows it.
        """
        start = 0 if index == 1 else self.z_1
        return np.asarray(self.N[:, start : start + dp.size] @ dp)

    def size_of(self, s: FloatArray) -> float:
        """Size over limit of a whitened signal."""
        return sqrt(max(float(s @ self.perp(s)), 0.0))

    def rms_um(self, rig: Rig, other: Rig | None = None) -> float:
        """Rms in um about the mean of all recordings of what a rig has beyond another (default: the limit's own)."""
        parts = []
        for one, old in zip(self.look, self.plain, strict=True):
            base = old if other is None else te(other, one.condition, one.path, at=one.time) / UM
            parts.append(te(rig, one.condition, one.path, at=one.time) / UM - base)
        return float(np.concatenate(parts).std())

    def difference(self, rig: Rig) -> FloatArray:
        """Whitened signal of a rig less that of the one the limit was built with."""
        return np.asarray(signal(rig, self.look, self.chain) - self.base)

    def fit(self, s: FloatArray, rivals: list[FloatArray]) -> FloatArray:
        """How much of each rival's signal comes closest to a signal, nuisances taken out of both."""
        R = np.stack(rivals, axis=1)
        R_p = np.stack([self.perp(r) for r in rivals], axis=1)
        gram = R.T @ R_p
        gram += (1e-9 * np.trace(gram) + 1e-12) * np.eye(len(rivals))
        return np.asarray(np.linalg.solve(gram, R_p.T @ s))

    def sine(self, s: FloatArray, rest: FloatArray) -> float:
        """Sine of the angle between a signal and its best rival, rest being what the rival leaves of it."""
        whole = float(s @ self.perp(s))
        left = max(float(rest @ self.perp(rest)), 0.0)
        return min(sqrt(left / whole), 1.0) if whole > 0 else 1.0
