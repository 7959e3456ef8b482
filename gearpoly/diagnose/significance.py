"""What was located at teeth that nobody inspected, held against a fit in which they touch as they were built."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import gammaincc

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry
from gearpoly.compare.families import SHARES
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.residuals import beyond_model
from gearpoly.diagnose.system import System, gain_of
from gearpoly.scene import Scene
from gearpoly.units import UM, FloatArray

ABOVE = 5.0
"""Times the rms of all else that the fit leaves by which a tooth has to stand out, every mesh by that of a mean of
teeth. Of 13 teeth that only seemed beyond their grade (of six drawn pairs whose forms scatter within it, and of a
healthy one whose zeros nothing tells) twelve had 3.7 or less, one 8.9; a cracked tooth had 7.2."""

ORDERS_BESIDE_LOUD_ONE, LOUD_ORDER_POWER = 10, 15.0
"""Orders to either side of one that are looked at, and times their median power that it has to have: of 150 orders of
noise 0.005 have as much (2^-15 each)."""

OUTLIERS = 6
"""Teeth beyond their grade that are told at most: more of them are a wrong grade. A judgement."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FitResidual:
    """A ``fit`` in which nothing is claimed, begun from ``comparison``: ``residuals`` (n_k,) in mm that it leaves of
    every recording, of which ``repeats`` in mm rms is no noise. Where more is left than noise, errors are as much
    larger (Birge 1932, Phys. Rev. 40, 207), while what is known of teeth stays: the ``system`` has noise ``wider`` by
    this factor, in units of the present one."""

    fit: Fit
    comparison: Comparison
    residuals: Sequence[FloatArray]
    repeats: Sequence[float]
    system: System
    wider: float

    def gains(self, score: FloatArray, information: FloatArray, columns: int) -> FloatArray:
        """What every group of so many ``columns``, one after the other, gains (g,) in sigmas squared of the wider
        noise."""
        groups = np.arange(score.size).reshape(-1, columns)
        return gain_of(score, information, groups)[0] / self.wider**2


def fit_residual(
    fit: Fit, comparison: Comparison, residuals: Sequence[FloatArray], noise: Sequence[float]
) -> FitResidual:
    """The same from the ``residuals`` (n_k,) and the ``noise`` of every recording, in mm."""
    wider = math.sqrt(max(1.0, fit.linear.system.whiteness))
    return FitResidual(
        fit=fit,
        comparison=comparison,
        residuals=residuals,
        repeats=[math.sqrt(max(float(np.var(r)) - n**2, 0.0)) for r, n in zip(residuals, noise, strict=True)],
        system=fit.linear.system.noisier(wider),
        wider=wider,
    )


def is_significant(entry: Entry, of: FitResidual) -> bool:
    """Whether the fit gains by what an entry says of all teeth more than chance allows at any such place: what teeth
    hold within their grade costs little, what they cannot hold stays in the misfit."""
    # Lines below the noise were told from its colour before.
    if not beyond_model(entry, of.fit):
        return False
    columns = _white_columns([entry], of)
    freedoms = columns[0].shape[1]
    gain = float(of.gains(*of.system.scores(columns), freedoms)[0])
    chance = float(gammaincc(0.5 * freedoms, 0.5 * max(gain, 0.0)))
    return sum(of.fit.model.scope.finest) * chance < SHARES.orders


def outlying_teeth(of: FitResidual, waves: Sequence[Entry]) -> list[Entry]:
    """Teeth that would stand elsewhere, by pitch and slope, if their grade did not hold them, the farthest first; each
    beside those before it and beside the ``waves`` that are told."""
    fit, built = of.fit, of.fit.linear.layout.built
    as_built, scope = fit.model.as_built, fit.model.scope
    places = [
        (flank, gear, tooth) for flank in as_built.flanks for gear in (0, 1) for tooth in range(scope.gears[gear].z)
    ]
    pitch = np.array([built.start + as_built.start(flank, gear) + tooth for flank, gear, tooth in places])
    slope = pitch + np.array([scope.gears[gear].z for _, gear, _ in places])
    both = np.column_stack((pitch, slope)).ravel()
    free = [white.part(both) for white in of.system.white]
    system = of.system.with_columns(_white_columns(waves, of)) if waves else of.system
    score, information = system.scores(free)
    found: list[tuple[int, float, float]] = []
    while len(found) < OUTLIERS:
        gains = of.gains(score, information, 2)
        best = int(np.argmax(gains))
        chance = len(places) * math.exp(-0.5 * max(float(gains[best]), 0.0))
        if chance > SHARES.teeth:
            break
        found.append((best, float(gains[best]), chance))
        mine = slice(2 * best, 2 * best + 2)
        taken = information[:, mine] @ np.linalg.pinv(information[mine, mine])
        score, information = score - taken @ score[mine], information - taken @ information[mine]
        score[mine] = 0.0  # but for rounding
    if not found:
        return []
    freed = np.concatenate([[2 * best, 2 * best + 1] for best, *_ in found])
    system = system.with_columns([one[:, freed] for one in free])
    out = []
    for k, (best, gain, chance) in enumerate(found):
        flank, gear, tooth = places[best]
        known, numbered = of.comparison.gears[gear], of.comparison.alignment.numbered[gear]
        stands = [pitch[best], system.size - freed.size + 2 * k]  # what its grade makes likely, and what is beyond that
        ahead = float(np.sum(system.solution[stands]))
        out.append(
            Entry(
                kind="tooth",
                gear="driving" if gear == 0 else "driven",
                tooth=tooth if numbered else None,
                encoder_deg=known.encoder_deg(tooth),
                amplitude_um=ahead,
                rms_um=abs(ahead),
                std_um=of.wider * math.sqrt(float(np.sum(system.covariance[np.ix_(stands, stands)]))),
                recordings=tuple(j for j, one in enumerate(of.comparison.aligned) if one.flank == flank),
                p_value=chance,
                gain=gain,
            )
        )
    return out


def above_background(entry: Entry, of: FitResidual) -> bool:
    """Whether an entry is above what is left of its like: teeth differ in form too, which no fit of pitch and slope
    follows, and then as much is left at every order and every tooth. A wave that never repeats may as well stand in
    noise that wanders, which was told from it before."""
    alone = entry.kind in ("tooth", "condition")
    if not alone and not any(of.fit.model.observed[k].whole for k in entry.recordings):
        return True
    size = UM * abs(entry.amplitude_um if entry.amplitude_um is not None else entry.rms_um or 0.0)
    if entry.kind == "shaft_order" and entry.order is not None:
        return size**2 * len(entry.recordings) > LOUD_ORDER_POWER * _power_beside(entry, entry.order, of)
    z_1, z_2 = (one.z for one in of.fit.model.scope.gears)
    mine = entry.mean_square(z_1, z_2) * UM**2
    level = math.sqrt(max(max(of.repeats[k] for k in entry.recordings) ** 2 - mine, 0.0))
    return size > ABOVE * level * (1.0 if alone else math.sqrt(1.0 / z_1 + 1.0 / z_2))


def _power_beside(entry: Entry, order: float, of: FitResidual) -> float:
    """Median over the whole orders beside one of a shaft of their power in mm^2, summed over the entry's recordings;
    without those of the mesh."""
    gear = 0 if entry.gear == "driving" else 1
    orders = np.arange(max(1.0, order - ORDERS_BESIDE_LOUD_ONE), order + ORDERS_BESIDE_LOUD_ONE + 1.0)
    orders = orders[(orders != order) & (np.mod(orders, of.fit.model.scope.gears[gear].z) != 0.0)]
    power = np.zeros(orders.size)
    for k in entry.recordings:
        samples = of.fit.scenes[k].samples
        theta = samples.theta_1 if gear == 0 else samples.theta_2
        power += np.abs(np.exp(-1j * np.outer(orders, theta)) @ of.residuals[k] * (2.0 / theta.size)) ** 2
    return float(np.median(power))


def _white_columns(entries: Sequence[Entry], of: FitResidual) -> list[FloatArray]:
    """What ``entries`` of all teeth say (n_k, q) of every recording, up to their sizes, which each of their recordings
    has of its own; whitened."""
    scenes = of.fit.scenes
    shapes = [(k, _shape(entry, scenes[k])) for entry in entries for k in entry.recordings]
    columns = [
        np.concatenate([shape if j == k else np.zeros((scene.samples.size, shape.shape[1])) for j, shape in shapes], 1)
        for k, scene in enumerate(scenes)
    ]
    return [noise.whitened(one) for noise, one in zip(of.fit.noises, columns, strict=True)]


def _shape(entry: Entry, scene: Scene) -> FloatArray:
    """A stretch of every mesh (n, 1), or the cosine and the sine (n, 2) of an order, at the samples of a recording."""
    samples, z_2 = scene.samples, scene.gear(1).z
    if entry.kind == "mesh_phase":
        low, high = entry.phase or (0.0, 1.0)
        along = np.mod(samples.theta_2 * (z_2 / (2.0 * math.pi)) - low, 1.0)
        return np.asarray(along < high - low, dtype=np.float64)[:, None]
    angle = samples.theta_1 if entry.gear == "driving" else samples.theta_2
    turned = (entry.order or 0.0) * (z_2 * samples.theta_2 if entry.kind == "mesh_order" else angle)
    return np.column_stack((np.cos(turned), np.sin(turned)))
