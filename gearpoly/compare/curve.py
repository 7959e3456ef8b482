"""One recording as the alignment sees it: the curve, what may be wrong with the simulation, and what is left.

No simulation is complete, and alignment comes before anyone knows what is missing. An undeclared eccentricity, a
relief, a drift or a wrong compliance must not pull the zero along, so each has columns with a prior size. They take
what they can, at a price: where a shift could be mistaken for one of them, the price is the doubt about the zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearpoly.compare.template import Template
from gearpoly.units import UM, FloatArray, IntArray, read_only

ComplexArray = npt.NDArray[np.complex128]

SHAFT_DOUBT = (6.0 * UM, 4.0 * UM)
"""mm. Undeclared first and second order of either shaft, one sigma: runouts of ordinary couplings and encoders, and
what a declared runout is off by."""

MESH_DOUBT = 2.0 * UM
"""mm. Undeclared first mesh order, one sigma, falling with the order: mean slopes, reliefs, errors of compliance."""

MESH_ORDERS_IN_DOUBT = 6
"""Mesh orders in doubt; from there on the doubt is less than what teeth differ by."""

PITCH_WAVE = 0.25
"""Part of a grade's F_p that the cosine and the sine of the first order of index deviations have, one sigma: at two, a
wave alone takes up all of F_p."""

DRIFT_DOUBT = 10.0 * UM
"""mm. Slow terms (half and whole waves over the recording), one sigma. A ramp is quite free: the ratio may be off."""

FREE_TERM_STD_MM = 1e6
"""mm. Prior of what is free: the mean and the ramp."""

FOLDED = 200_000
"""Places of the hunting cycle into which longer recordings are averaged before they are laid on the simulation."""


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """The hunting cycle of a pair as an even grid of ``per_mesh`` places per pitch; ``r_b2`` in mm. ``pitch_waves`` in
    mm: first order of the index deviations of the driving and the driven gear that nobody inspected, one sigma."""

    z_1: int
    z_2: int
    per_mesh: int
    r_b2: float
    pitch_waves: tuple[float, float] = (0.0, 0.0)

    @property
    def meshes(self) -> int:
        """lcm(z_1, z_2)."""
        return math.lcm(self.z_1, self.z_2)

    @property
    def size(self) -> int:
        """Places in the cycle."""
        return self.meshes * self.per_mesh

    @property
    def pitch(self) -> float:
        """Driven rotation in rad from tooth to tooth."""
        return 2.0 * math.pi / self.z_2

    @property
    def span(self) -> float:
        """The whole cycle as driven rotation in rad."""
        return self.meshes * self.pitch

    @property
    def step(self) -> float:
        """Driven rotation in rad from place to place."""
        return self.pitch / self.per_mesh

    @property
    def ratio(self) -> float:
        """z_1/z_2."""
        return self.z_1 / self.z_2


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedCurve:
    """A recorded curve and the simulated one that it is to be laid on.

    ``theta_2`` (n,) driven rotation in rad by zeros that are still in doubt, ``te`` (n,) in mm by the same zeros,
    ``weight`` (n,) samples behind each. ``turn`` in pitches is what the encoder that says where the teeth are goes
    through per turn. ``counted``: both encoders were recorded, so ``te`` holds the whole turns of both. ``count``:
    curves of one number, from 0, share their count of turns; -1: nobody shares this one's.
    """

    theta_2: FloatArray
    te: FloatArray
    weight: FloatArray
    template: Template
    turn: int
    counted: bool
    count: int = -1

    def __post_init__(self) -> None:
        for name in ("theta_2", "te", "weight"):
            object.__setattr__(self, name, read_only(getattr(self, name)))


def folded(curve: RecordedCurve, cycle: Cycle, *, places: int = FOLDED) -> RecordedCurve:
    """The curve averaged over equal places of the hunting cycle, of which there are at most about ``places``.

    Each place keeps the mean angle of its own samples, so straight stretches stay exact. Curves that would not get
    much shorter are returned as they are. A ramp over time has to be taken off before.
    """
    per_mesh = max(16, 2 ** int(math.log2(max(places / cycle.meshes, 1.0))))
    size = cycle.meshes * per_mesh
    if curve.theta_2.size < 1.5 * size:
        return curve
    width = cycle.span / size
    place = np.floor(curve.theta_2 / width)
    within = curve.theta_2 - place * width
    index = np.mod(place, size).astype(np.int64)
    weight = np.bincount(index, weights=curve.weight, minlength=size).astype(np.float64)
    held = np.flatnonzero(weight)
    sums = [np.bincount(index, weights=curve.weight * x, minlength=size)[held] for x in (within, curve.te)]
    return RecordedCurve(
        theta_2=held * width + sums[0] / weight[held],
        te=sums[1] / weight[held],
        weight=weight[held],
        template=curve.template,
        turn=curve.turn,
        counted=curve.counted,
        count=curve.count,
    )


def without_ramp(theta_2: FloatArray, te: FloatArray) -> tuple[FloatArray, float]:
    """``te`` (n,) in mm with its straight trend over ``theta_2`` (n,) in rad taken off, level at the mean, and the
    trend in mm per rad. First orders of a shaft do not count as trend over whole turns, and hardly over a few."""
    x = theta_2 - np.mean(theta_2)
    power = float(x @ x)
    slope = float(x @ te) / power if power > 0.0 else 0.0
    return te - slope * x, slope


def doubts(
    theta_2: FloatArray, cycle: Cycle, *, in_time: bool, mesh_orders: int = MESH_ORDERS_IN_DOUBT
) -> tuple[FloatArray, FloatArray]:
    """Columns (p, n) of what may be wrong with the simulation at ``theta_2`` (n,) in rad, the mean first, and their
    prior sizes (p,) in mm. ``in_time`` adds slow terms over the recording, for angles in the order of time."""
    span = float(np.ptp(theta_2)) or 1.0
    place = (theta_2 - np.min(theta_2)) / span
    columns, sizes = [np.ones_like(theta_2)], [FREE_TERM_STD_MM]
    first, second = SHAFT_DOUBT
    of_gears = [(math.hypot(first, wave), second) for wave in cycle.pitch_waves]
    for order in (1, 2):
        for wave in (np.cos, np.sin):
            columns += [wave(order * theta_2 / cycle.ratio), wave(order * theta_2)]
            sizes += [of_gear[order - 1] for of_gear in of_gears]
    for order in range(1, mesh_orders + 1):
        for wave in (np.cos, np.sin):
            columns.append(wave(order * cycle.z_2 * theta_2))
            sizes.append(MESH_DOUBT / order)
    if in_time:
        columns.append(place - 0.5)
        sizes.append(FREE_TERM_STD_MM)
        for order in (1, 2, 3):
            columns.append(np.cos(math.pi * order * place))
            sizes.append(DRIFT_DOUBT)
    return np.array(columns), np.array(sizes)


class Misfit:
    """What is left of a curve once the simulation, shifted, and the doubts are taken off; ``sigma`` in mm is what the
    doubts are weighed against (the rms of what cannot be explained)."""

    def __init__(
        self,
        curve: RecordedCurve,
        cycle: Cycle,
        *,
        sigma: float,
        in_time: bool,
        mesh_orders: int = MESH_ORDERS_IN_DOUBT,
    ) -> None:
        self.curve, self.cycle, self.sigma = curve, cycle, sigma
        self.columns, self.sizes = doubts(curve.theta_2, cycle, in_time=in_time, mesh_orders=mesh_orders)
        self.weighted = self.columns * curve.weight
        self.prior = (sigma / self.sizes) ** 2
        self.level = float(np.average(curve.te, weights=curve.weight))
        self.y = curve.te - self.level
        gram = self.weighted @ self.columns.T
        # What is level stays solvable where a short recording cannot tell the columns apart.
        self.inverse = np.linalg.inv(gram + np.diag(self.prior) + 1e-12 * np.trace(gram) * np.eye(len(self.sizes)))
        self.count = float(np.sum(curve.weight))

    def over_all_shifts(self) -> FloatArray:
        """Penalised square misfit (cycle.size,) in mm^2 for the simulation shifted by every place of the grid.

        Exact for incomplete cycles too, since only places that were recorded count: circular correlations of the
        simulation with the recording, with its doubts and with its sampling.
        """
        size, template = self.cycle.size, self.curve.template
        place = np.mod(np.rint(self.curve.theta_2 / self.cycle.step), size).astype(np.int64)
        T = template.even - template.mean

        def summed(values: FloatArray) -> ComplexArray:
            return np.fft.rfft(np.bincount(place, weights=values, minlength=size))

        def shifted(sums: ComplexArray, of: ComplexArray) -> FloatArray:
            return np.fft.irfft(sums * np.conj(of), size)

        spectrum, square = np.fft.rfft(T), np.fft.rfft(T**2)
        weight = self.curve.weight
        out = float(weight @ self.y**2) - 2.0 * shifted(summed(weight * self.y), spectrum)
        out = out + shifted(summed(weight), square)
        product = np.array([float(column @ self.y) - shifted(summed(column), spectrum) for column in self.weighted])
        taken: FloatArray = np.einsum("ih,ih->h", product, self.inverse @ product)
        return np.maximum(out - taken, 0.0)

    def residual(self, shift: float) -> FloatArray:
        """Recorded minus simulated (n,) in mm at ``shift`` in rad, the mean of the recording taken off."""
        return self.y - (self.curve.template.at(self.curve.theta_2 - shift) - self.curve.template.mean)

    def explained(self, values: FloatArray) -> FloatArray:
        """Coefficients (p,) of the doubts in ``values`` (n,)."""
        out: FloatArray = self.inverse @ (self.weighted @ values)
        return out

    def drawn(self, coefficients: FloatArray) -> FloatArray:
        """The doubts' curve (n,) in mm. Not by BLAS, whose threads cost more than they save on so little."""
        out: FloatArray = np.einsum("i,ij->j", coefficients, self.columns)
        return out

    def slope(self, shift: float) -> FloatArray:
        """d(residual)/d(shift) (n,) in mm/rad."""
        return self.curve.template.slope(self.curve.theta_2 - shift)

    def labels(self, shift: float) -> tuple[IntArray, IntArray, IntArray]:
        """Mesh in the cycle, driving and driven tooth (n,) of every sample, by the nearest pitch point."""
        mesh = np.mod(np.rint((self.curve.theta_2 - shift) / self.cycle.pitch), self.cycle.meshes).astype(np.int64)
        return mesh, mesh % self.cycle.z_1, mesh % self.cycle.z_2
