"""What was located at teeth that nobody inspected, held against a fit in which they touch as they were built."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaincc

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry
from gearpoly.compare.families import SHARES
from gearpoly.diagnose.left_beside import beyond_model
from gearpoly.diagnose.search import Search
from gearpoly.diagnose.system import System
from gearpoly.scene import Scene
from gearpoly.units import UM, FloatArray

ABOVE = 3.0
"""Times the rms of all else that the fit leaves by which a tooth has to stand out, every mesh by that of a mean of
teeth: of nine teeth that seemed beyond their grade in six drawn pairs, whose forms scatter within it, seven had less; a
crack that was there has 3.6."""

BESIDE, LOUD = 10, 15.0
"""Orders to either side of one that are looked at, and times their median power that it has to have: of 150 orders of
noise 0.006 have as much (2^-15 each)."""

OUTLIERS = 6
"""Teeth beyond their grade that are told at most: more of them are a wrong grade."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Against:
    """A ``fit`` in which nothing is claimed and the ``comparison`` that it began from; ``rest`` (n_k,) in mm, what it
    leaves of every recording, of which ``repeats`` in mm rms is no noise. Where more is left than noise, errors are as
    much larger (Birge 1932), while what is known of teeth stays: the ``system`` has noise ``wider`` by this factor."""

    fit: Search
    comparison: Comparison
    rest: Sequence[FloatArray]
    repeats: Sequence[float]
    system: System
    wider: float

    def whitened(self, columns: Sequence[FloatArray]) -> list[FloatArray]:
        """Columns (n_k, q) in mm of every recording under the noise of the ``system``."""
        return [noise.whitened(one) / self.wider for noise, one in zip(self.fit.noises, columns, strict=True)]


def against(fit: Search, comparison: Comparison, rest: Sequence[FloatArray], noise: Sequence[float]) -> Against:
    """The same from what is left, and the ``noise`` of every recording in mm."""
    system = fit.linear.system
    wider = math.sqrt(max(1.0, system.whiteness))
    return Against(
        fit=fit,
        comparison=comparison,
        rest=rest,
        repeats=[math.sqrt(max(float(np.var(r)) - n**2, 0.0)) for r, n in zip(rest, noise, strict=True)],
        system=replace(
            system, white=[one / wider for one in system.white], target=[one / wider for one in system.target]
        ),
        wider=wider,
    )


def still_pays(entry: Entry, by: Against) -> bool:
    """Whether the fit gains by what an entry says of all teeth more than chance allows at any such place: what teeth
    hold within their grade costs little, what they cannot hold stays in the misfit."""
    # Lines below the noise were told from its colour before.
    if entry.companion_of is not None or not beyond_model(entry, by.fit):
        return False
    score, information = by.system.scores(by.whitened(_by_recording(entry, by.fit)))
    shown = np.diag(information) > 0.0
    if not np.any(shown):
        return False
    told = np.linalg.lstsq(information[np.ix_(shown, shown)], score[shown], rcond=None)[0]
    gain = max(float(score[shown] @ told), 0.0)
    chance = float(gammaincc(0.5 * float(np.count_nonzero(shown)), 0.5 * gain))
    return sum(by.fit.model.scope.finest) * chance < SHARES.orders


def beyond_grade(by: Against, waves: Sequence[Entry]) -> list[Entry]:
    """Teeth that would stand elsewhere, by pitch and slope, if their grade did not hold them: each for itself, the
    farthest first, with the ``waves`` that are told and with what stands beside it free."""
    fit, linear, system = by.fit, by.fit.linear, by.system
    for one in waves:
        system = system.with_columns(by.whitened(_by_recording(one, fit)))
    scope, built = fit.model.scope, linear.layout.built
    out: list[Entry] = []
    places = [
        (flank, gear, tooth) for flank in fit.model.as_built.flanks for gear in (0, 1) if not scope.inspected[gear]
        for tooth in range(scope.gears[gear].z)
    ]  # fmt: skip
    at = [fit.model.as_built.start(flank, gear) + tooth for flank, gear, tooth in places]
    pairs = [[first, first + scope.gears[gear].z] for first, (_, gear, _) in zip(at, places, strict=True)]
    free = by.whitened([columns[:, built][:, np.array(pairs).ravel()] for columns in linear.columns])
    while len(out) < OUTLIERS:
        score, information = system.scores(free)
        blocks = [information[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] for k in range(len(places))]
        told = [
            np.linalg.lstsq(block, score[2 * k : 2 * k + 2], rcond=None)[0] for k, block in enumerate(blocks)
        ]  # fmt: skip
        gains = [float(score[2 * k : 2 * k + 2] @ one) for k, one in enumerate(told)]
        best = int(np.argmax(gains))
        chance = len(places) * math.exp(-0.5 * max(gains[best], 0.0))
        if chance > SHARES.teeth:
            break
        flank, gear, tooth = places[best]
        known, numbered = by.comparison.gears[gear], by.comparison.alignment.numbered[gear]
        system = system.with_columns([one[:, 2 * best : 2 * best + 2] for one in free])
        stands = [at[best], system.size - 2]  # what its grade makes likely, and what is beyond that
        ahead = float(np.sum(system.solution[stands]))
        out.append(
            Entry(
                kind="tooth",
                gear="driving" if gear == 0 else "driven",
                tooth=tooth if numbered else None,
                encoder_deg=known.encoder_deg(tooth),
                amplitude_um=ahead,
                rms_um=abs(ahead),
                std_um=math.sqrt(float(np.sum(system.covariance[np.ix_(stands, stands)]))),
                recordings=tuple(k for k, one in enumerate(by.comparison.aligned) if one.flank == flank),
                p_value=chance,
                gain=gains[best],
            )
        )
    return out


def above_rest(entry: Entry, by: Against) -> bool:
    """Whether an entry is above what is left of its like: teeth differ in form too, which no fit of pitch and slope
    follows, and then as much is left at every order and every tooth. What never repeats may as well be noise that
    wanders, which was told from it before."""
    if not any(by.fit.model.observed[k].whole for k in entry.recordings):
        return True
    size = UM * abs(entry.amplitude_um if entry.amplitude_um is not None else entry.rms_um or 0.0)
    z_1, z_2 = z = [one.z for one in by.fit.model.scope.gears]
    mine = entry.mean_square(z_1, z_2) * UM**2
    level = math.sqrt(max(max(by.repeats[k] for k in entry.recordings) ** 2 - mine, 0.0))
    if entry.kind in ("tooth", "condition"):
        return size > ABOVE * level
    if entry.kind != "shaft_order" or entry.order is None:
        return size > ABOVE * level * math.sqrt(1.0 / z_1 + 1.0 / z_2)
    gear = 0 if entry.gear == "driving" else 1
    orders = np.arange(max(1.0, entry.order - BESIDE), entry.order + BESIDE + 1.0)
    orders = orders[(orders != entry.order) & (np.mod(orders, z[gear]) != 0.0)]
    power = np.zeros(orders.size)
    for k in entry.recordings:
        samples = by.fit.scenes[k].samples
        theta = samples.theta_1 if gear == 0 else samples.theta_2
        power += np.abs(np.exp(-1j * np.outer(orders, theta)) @ by.rest[k] * (2.0 / theta.size)) ** 2
    return size**2 * len(entry.recordings) > LOUD * float(np.median(power))


def _by_recording(entry: Entry, fit: Search) -> list[FloatArray]:
    """What an entry of every tooth says (n_k, q) in mm, up to its size, which each of its recordings has of its own."""
    shapes = [_shape(entry, fit.scenes[k]) for k in entry.recordings]
    width = shapes[0].shape[1]
    out = [np.zeros((scene.samples.size, width * len(shapes))) for scene in fit.scenes]
    for at, (k, shape) in enumerate(zip(entry.recordings, shapes, strict=True)):
        out[k][:, at * width : (at + 1) * width] = shape
    return out


def _shape(entry: Entry, scene: Scene) -> FloatArray:
    """The same (n, q) of one recording; nothing (n, 1) of a change of condition, which is located anew."""
    theta_2, z_2 = scene.samples.theta_2, scene.gear(1).z
    if entry.kind == "mesh_phase" and entry.phase is not None:
        low, high = entry.phase
        along = np.mod(theta_2 * (z_2 / (2.0 * math.pi)) - low, 1.0)
        return np.asarray(along < high - low, dtype=np.float64)[:, None]
    if entry.order is None:
        return np.zeros((theta_2.size, 1))
    angle = z_2 * theta_2 if entry.kind == "mesh_order" else theta_2
    if entry.kind == "shaft_order" and entry.gear == "driving":
        angle = scene.samples.theta_1
    return np.column_stack((np.cos(entry.order * angle), np.sin(entry.order * angle)))
