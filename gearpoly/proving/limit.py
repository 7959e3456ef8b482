"""How small an effect any method could find: the theoretical limit sigma / ||s_perp||, from this bench's own signals.

What a recording says of an effect is its signal less what the pitch and slope of every tooth, the mean, the angle zeros
and the scale of a declared compliance could make of it, each as freely as is known beforehand. White or AR(1) noise is
whitened. Amplitude and phase of every wave of an undeclared background are as open as the mean; its frequency counts
as known, which costs nothing unless the effect overlaps it.
Derived here: with noise covariance V, nuisance columns N and their prior covariance P, (size / limit)^2 = s' (V + N P
N')^-1 s."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import Any

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_triangular
from scipy.optimize import lsq_linear

from gearpoly.proving.chain import Chain, Motion, RecordedCondition, te
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.equilibrium import SLOTS
from gearpoly.proving.gears import MM_PER_UM, RAD_PER_DEG, FloatArray
from gearpoly.proving.rig import BenchError, EncoderDeviation, Rig, mesh

SAMPLES_LOOKED_AT = 4000
"""Samples of a set of recordings that are looked at; the others are counted as if they said the same."""
SAMPLES_IN_A_ROW = 9
"""Samples in a row that are looked at where the noise has a colour: all but the first say something of their own."""
LOOKED_AT_SEED = 7
"""Seed of where in each stretch of samples is looked."""
ZERO_COLUMNS = 1
"""Columns for where the teeth are: the driven zero. The driving one then follows from contact but for the mean."""
DRIVEN_TURN_STEP_DEG = 0.01
"""Turn in deg of the driven gear by which that column is drawn."""
FORMS = 2
"""Columns for the mean form of graded gears: a crowning of either gear."""
LAW_COLUMNS = 5
"""Columns for what a compliance law leaves open: its scale, three shapes over the path of contact, a power of the
load."""
LOOSE_PRIOR_INFORMATION = 1e-9
"""1/um^2: the prior of what nobody knows; a standard deviation of 30 mm."""


@dataclass(frozen=True, kw_only=True)
class Sight:
    """The samples looked at in one recording: times in s (n,), in runs of ``run`` samples one after the other; where
    the noise has a colour the first of a run only tells what the noise of the second goes on from."""

    condition: RecordedCondition
    path: Motion
    time: FloatArray
    run: int
    share: float


def sights(conditions: tuple[RecordedCondition, ...], paths: tuple[Motion, ...], chain: Chain) -> tuple[Sight, ...]:
    """Where to look at a set of recordings."""
    total = sum(path.time.size for path in paths)
    run, told = (SAMPLES_IN_A_ROW, SAMPLES_IN_A_ROW - 1) if chain.colour else (1, 1)
    stride = max(run, -(-total * told // SAMPLES_LOOKED_AT))
    out = []
    for condition, path in zip(conditions, paths, strict=True):
        # Drawn within each stretch: evenly spaced looks would see but one phase of the mesh where a stretch is a mesh.
        start = np.arange(0, path.time.size - stride + 1, stride)
        first = start + np.random.default_rng(LOOKED_AT_SEED).integers(0, stride - run + 1, start.size)
        at = (first[:, None] + np.arange(run)).ravel()
        share = path.time.size / (first.size * told)
        out.append(Sight(condition=condition, path=path, time=path.time[at], run=run, share=share))
    return tuple(out)


def _whiten(sight: Sight, chain: Chain, values: FloatArray) -> FloatArray:
    """Values (n, ...) at a sight's samples in units of the noise, of which every one is then new."""
    scale = sqrt(sight.share) / (chain.noise_um * sqrt(1 - chain.colour**2))
    if sight.run == 1:
        return np.asarray(scale * values)
    runs = values.reshape(-1, sight.run, *values.shape[1:])
    fresh = runs[:, 1:] - chain.colour * runs[:, :-1]
    return np.asarray(scale * fresh.reshape(-1, *values.shape[1:]))


Whiten = Callable[[Sight, Chain, FloatArray], FloatArray]
"""Values (n, ...) at a sight's samples in units of independent noise."""


def signal(rig: Rig, look: tuple[Sight, ...], chain: Chain, whiten: Whiten = _whiten) -> FloatArray:
    """The rig's transmission error in um over all recordings, whitened to unit noise."""
    return np.concatenate(
        [whiten(one, chain, te(rig, one.condition, one.path, at=one.time) / MM_PER_UM) for one in look]
    )


def _displaced(rig: Rig, sight: Sight) -> FloatArray:
    """What a driven zero off by one um along the line of action changes in um, but for the mean: encoders and all that
    is no matter of the teeth stay where they are."""
    of_teeth = tuple(extra for extra in rig.extras if extra.teeth)
    bare = replace(rig, encoder_1=EncoderDeviation(), encoder_2=EncoderDeviation(), extras=of_teeth, drift=0.0)
    there = replace(sight.path, start=sight.path.start + DRIVEN_TURN_STEP_DEG * RAD_PER_DEG)
    here, gone = (te(bare, sight.condition, path, at=sight.time) for path in (sight.path, there))
    return np.asarray((gone - here) / (rig.pair.driven.r_b * DRIVEN_TURN_STEP_DEG * RAD_PER_DEG))


def _quadratures(rig: Rig, sight: Sight, waves: tuple[Disturbance, ...]) -> FloatArray:
    """Cosine and sine (n, 2 per wave) in um per um of the waves beside the gears."""
    theta_2 = sight.path.angle(sight.time)
    theta_1 = theta_2 * rig.pair.driven.z / rig.pair.driving.z
    out = np.empty((sight.time.size, 2 * len(waves)))
    for k, wave in enumerate(waves):
        for j, phase in enumerate((0.0, -0.5 * pi)):
            one = replace(wave, amplitude=1.0, phase=phase)
            out[:, 2 * k + j] = one.x(sight.time, theta_1, theta_2, sight.path.span) / MM_PER_UM
    return out


def _columns(rig: Rig, sight: Sight, full_torque: float) -> FloatArray:
    """Nuisance columns in um per um: index and slope of every tooth's flanks, mean, thickness, compliance, zero,
    form."""
    pair = rig.pair
    drive = sight.condition.flank == "drive"
    got = mesh(
        rig,
        sight.path.angle(sight.time),
        torque=sight.condition.torque,
        flank=sight.condition.flank,
        span=sight.path.angles,
    )
    n = sight.time.size
    rows = np.arange(n)
    z_1, z_2 = pair.driving.z, pair.driven.z
    both = 2 * (z_1 + z_2)
    out = np.zeros((n, both + 3 + LAW_COLUMNS + ZERO_COLUMNS + FORMS))
    side = 1.0 if drive else -1.0
    # What is known of a tooth is known of both its flanks: one set of columns for both.
    starts = (0, z_1, z_1 + z_2, 2 * z_1 + z_2)
    law = np.zeros((n, LAW_COLUMNS))
    full = 1000 * full_torque / pair.driven.r_b
    for slot in range(SLOTS):
        w = got.weights[:, slot]
        for index, tooth, roll in ((1, got.tooth_1, got.roll_1), (2, got.tooth_2, got.roll_2)):
            start = pair.l_start(index)
            u = (roll[:, slot] - start) / (pair.gear(index).l_tip - start)
            out[rows, starts[index - 1] + tooth[:, slot]] += w
            out[rows, starts[index + 1] + tooth[:, slot]] += side * w * (u - 0.5)
            out[:, index - 1 - FORMS] -= side * w * (2 * u - 1) ** 2
            if index == 1:
                sag = side * w * got.deflections[:, slot] / MM_PER_UM
                for k in range(LAW_COLUMNS - 1):
                    law[:, k] += sag * (2 * u - 1) ** k
                law[:, -1] += sag * np.log(np.maximum(got.forces[:, slot], 1e-3 * full + 1e-9) / (full + 1e-9))
    mean = both
    out[:, mean] = 1.0
    if not drive:
        out[:, mean + 1 : mean + 3] = 1.0
    out[:, mean + 3 : mean + 3 + LAW_COLUMNS] = law
    out[:, mean + 3 + LAW_COLUMNS] = _displaced(rig, sight)
    return out


def _root(gram: FloatArray) -> FloatArray:
    """Cholesky factor of a scaled Gram matrix. Even samples can make two columns one (a wave at half their rate), and
    rounding then leaves it short of positive: so much is added as that takes."""
    for ridge in (0.0, 1e-8, 1e-6, 1e-4):
        try:
            return np.asarray(np.linalg.cholesky(gram + ridge * np.eye(gram.shape[0])))
        except np.linalg.LinAlgError:
            continue
    raise BenchError("columns of a rival that no ridge makes independent")


class DetectionLimit:
    """The limit of one set of recordings: build it once, then ask it for each effect.

    index, slope: prior covariances (um^2) of the gears' index deviations and slopes, driving then driven; thickness:
    prior standard deviation (um) of both; zero: that of the driven zero, along the line of action; compliance: that of
    a declared compliance's scale, 0 where none is declared; form: those of a crowning of all teeth of either gear, 0
    where somebody looked; waves: those of a background, whose amplitudes and phases are open; whiten: the noise, if it
    is not the chain's."""

    def __init__(
        self, rig: Rig, look: tuple[Sight, ...], chain: Chain, *, index: tuple[FloatArray, FloatArray],
        slope: tuple[FloatArray, FloatArray], thickness: float, compliance: float,
        zero: float, form: tuple[float, float] = (0.0, 0.0), waves: tuple[Disturbance, ...] = (),
        whiten: Whiten = _whiten,
    ) -> None:  # fmt: skip
        self.rig, self.look, self.chain, self.whiten = rig, look, chain, whiten
        self.base = signal(rig, look, chain, whiten)
        self._known: dict[str, Any] = {
            "index": index,
            "slope": slope,
            "thickness": thickness,
            "compliance": compliance,
            "zero": zero,
            "form": form,
            "waves": waves,
            "whiten": whiten,
        }
        self.z_1 = rig.pair.driving.z
        self.slopes = self.z_1 + rig.pair.driven.z
        self.plain = self.seen(rig)
        top = max(one.condition.torque for one in look)
        columns = [np.hstack([_columns(rig, one, top), _quadratures(rig, one, waves)]) for one in look]
        self.N = np.concatenate([whiten(one, chain, free) for one, free in zip(look, columns, strict=True)])
        self.forms = self.N.shape[1] - 2 * len(waves) - FORMS
        k = self.N.shape[1]
        inverse = np.zeros((k, k))
        place = 0
        for block in (*index, *slope):
            size = block.shape[0]
            inverse[place : place + size, place : place + size] = np.linalg.inv(block + 1e-6 * np.eye(size))
            place += size
        inverse[place, place] = LOOSE_PRIOR_INFORMATION
        inverse[place + 1, place + 1] = inverse[place + 2, place + 2] = 1 / thickness**2
        # Where nothing is declared, the columns of compliance are tied to zero, like a prior of a thousandth.
        for j in range(LAW_COLUMNS):
            inverse[place + 3 + j, place + 3 + j] = 1 / max(compliance * (1.0 if j == 0 else 0.6), 1e-3) ** 2
        place += 3 + LAW_COLUMNS
        inverse[place, place] = 1 / zero**2
        for j in range(place + ZERO_COLUMNS, place + ZERO_COLUMNS + FORMS):
            inverse[j, j] = 1 / max(form[j - place - ZERO_COLUMNS], 1e-3) ** 2
        for j in range(place + ZERO_COLUMNS + FORMS, k):
            inverse[j, j] = LOOSE_PRIOR_INFORMATION
        self.factor = cho_factor(self.N.T @ self.N + inverse)

    def perp(self, s: FloatArray) -> FloatArray:
        """A whitened signal less what the nuisances would make of it (in the metric of the limit)."""
        return np.asarray(s - self.N @ cho_solve(self.factor, self.N.T @ s))

    def around(self, rig: Rig) -> DetectionLimit:
        """The limit of the same recordings about another rig: there, other pairs lead."""
        return DetectionLimit(rig, self.look, self.chain, **self._known)

    def seen_with(self, look: tuple[Sight, ...], whiten: Whiten) -> DetectionLimit:
        """The same knowledge of the gears, looked at in other samples and in other noise."""
        return DetectionLimit(self.rig, look, self.chain, **(self._known | {"whiten": whiten}))

    def over(self, rig: Rig) -> float:
        """Size over limit of what a rig has beyond the one the limit was built with."""
        return self.size_of(self.difference(rig))

    def index_signal(self, index: int, dp: FloatArray) -> FloatArray:
        """Whitened signal of a change dp (um) of the index deviations of gear 1 or 2, to first order.

        It is taken as the nuisances take it: which pair leads changes with the size of a pitch error, and that bend
        would count as evidence though a fit of the teeth follows it.
        """
        return self._taken(0 if index == 1 else self.z_1, dp)

    def slope_signal(self, index: int, ds: FloatArray) -> FloatArray:
        """The same of a change ds (um) of the profile slopes of gear 1 or 2."""
        return self._taken(self.slopes + (0 if index == 1 else self.z_1), ds)

    def form_signal(self, index: int, crowning: float) -> FloatArray:
        """The same of more crowning (um) of all teeth of gear 1 or 2."""
        return self._taken(self.forms + index - 1, np.array([crowning]))

    def _taken(self, start: int, values: FloatArray) -> FloatArray:
        """Whitened signal of nuisances from a place on."""
        return np.asarray(self.N[:, start : start + values.size] @ values)

    def size_of(self, s: FloatArray) -> float:
        """Size over limit of a whitened signal."""
        return sqrt(max(float(s @ self.perp(s)), 0.0))

    def seen(self, rig: Rig) -> FloatArray:
        """A rig's transmission error in um at all samples that are looked at."""
        return np.concatenate([te(rig, one.condition, one.path, at=one.time) / MM_PER_UM for one in self.look])

    def rms_um(self, rig: Rig) -> float:
        """Rms in um about the mean of all recordings of what a rig has beyond the one the limit was built with."""
        return float((self.seen(rig) - self.plain).std())

    def difference(self, rig: Rig) -> FloatArray:
        """Whitened signal of a rig less that of the one the limit was built with."""
        return np.asarray(signal(rig, self.look, self.chain, self.whiten) - self.base)

    def fit(self, s: FloatArray, columns: FloatArray, *, low: FloatArray, high: FloatArray) -> FloatArray:
        """How much of each column (n, k), between low and high (k,), comes closest to a signal, nuisances taken out of
        both."""
        gram = columns.T @ np.stack([self.perp(column) for column in columns.T], axis=1)
        gram += (1e-9 * np.diag(np.diag(gram))) + 1e-30 * np.eye(low.size)
        # Of columns that nuisances take whole only rounding is left, of either sign.
        rounding = 1e-11 * np.einsum("nk,nk->k", columns, columns) + 1e-30
        np.fill_diagonal(gram, np.maximum(np.diag(gram), rounding))
        scale = 1 / np.sqrt(np.diag(gram))
        root = _root(gram * np.outer(scale, scale))
        wanted = solve_triangular(root, scale * (columns.T @ self.perp(s)), lower=True)
        return np.asarray(scale * lsq_linear(root.T, wanted, bounds=(low / scale, high / scale), method="bvls").x)
