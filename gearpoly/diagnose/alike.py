"""How much alike faults are in recordings that are only thought of: angles beside everything that is open."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np

from gearpoly.diagnose.imagine import effects
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.nuisance import SCALE_STD, law_changes, law_modes, softened
from gearpoly.diagnose.system import scales_of
from gearpoly.physics.base import Claim
from gearpoly.scene import Scene
from gearpoly.units import UM, FloatArray

ORDINARY_NOISE_MM = 0.5 * UM
"""mm per sample that is assumed: an ordinary rig."""

SHOWS = 2.0
"""Standard deviations by which an ordinary fault has to show at least: what shows less is told from nothing, look-alike
or not, and an angle between two such means nothing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FaultsShown:
    """Faults as some recordings show them together: each in standard deviations ``shown`` (c,) at the phase at which it
    shows least, and the ``sines`` (c, c) of the angles between what two of them can make, at the phases at which they
    are most alike; 0 where either does not show."""

    shown: FloatArray
    sines: FloatArray

    @property
    def visible(self) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        """Which of the faults (c,) show."""
        return self.shown >= SHOWS


@dataclass(frozen=True, kw_only=True, eq=False)
class Products:
    """Products of one recording's columns, in sigmas of its noise: of what is open (m, m), of that with the effects
    (m, q), of these (q, q)."""

    open: FloatArray
    cross: FloatArray
    own: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Alike:
    """The faults of ``claims`` in every recording thought of, and the ``precision`` (m, m) of what is open."""

    claims: Sequence[Claim]
    recordings: list[Products]
    precision: FloatArray

    def weighed(self, chosen: Sequence[int]) -> FaultsShown:
        """The faults as the ``chosen`` recordings show them together."""
        held = [self.recordings[k] for k in chosen]
        normal = self.precision + sum((one.open for one in held), np.zeros_like(self.precision))
        cross = sum((one.cross for one in held), np.zeros_like(held[0].cross))
        own = sum((one.own for one in held), np.zeros_like(held[0].own))
        scale = scales_of(normal)
        crossed = cross / scale[:, None]
        solved = np.linalg.solve(normal / np.outer(scale, scale) + 1e-9 * np.eye(scale.size), crossed)
        return self._angles(own - crossed.T @ solved)

    def _angles(self, left: FloatArray) -> FaultsShown:
        edges = np.cumsum([0, *(one.physics.amplitudes for one in self.claims)])
        parts = [slice(a, b) for a, b in pairwise(edges.tolist())]
        shown, roots = np.zeros(len(parts)), []
        for k, part in enumerate(parts):
            values, vectors = np.linalg.eigh(left[part, part])
            shown[k] = math.sqrt(max(float(values[0]), 0.0))
            roots.append(vectors / np.sqrt(np.maximum(values, 1e-12 * max(float(values[-1]), 1e-300))))
        sines = np.zeros((len(parts), len(parts)))
        for i, j in combinations(np.flatnonzero(shown >= SHOWS).tolist(), 2):
            # The largest of the cosines between both planes: the phases at which one makes the other best.
            cosine = float(np.linalg.norm(roots[i].T @ left[parts[i], parts[j]] @ roots[j], 2))
            sines[i, j] = sines[j, i] = math.sqrt(max(0.0, 1.0 - cosine**2))
        return FaultsShown(shown=shown, sines=sines)


def alike(model: Model, scenes: list[Scene], claims: Sequence[Claim]) -> Alike:
    """Lay the faults of ``claims`` side by side in all ``scenes``: every amplitude of each as large as all of them,
    beside teeth as built, a common mean, the compliance's scale, and the ways in which its laws differ."""
    signals: list[list[FloatArray]] = [[] for _ in scenes]
    for claim in claims:
        a = claim.physics.amplitudes
        size = float(np.linalg.norm(claim.values[:a]))
        for unit in np.eye(a) * size:
            one = replace(claim, values=(*unit.tolist(), *claim.place.shape))
            for mine, change in zip(signals, effects(model, scenes, one), strict=True):
                mine.append(change)
    laws = law_modes(scenes, law_changes(scenes))
    recordings = []
    for k, scene in enumerate(scenes):
        parts = [model.as_built.columns(scene).dense(), np.ones((scene.samples.size, 1)), softened(scene)[:, None]]
        opened = np.concatenate(parts if laws is None else [*parts, laws.parts[k]], axis=1) / ORDINARY_NOISE_MM
        effect = np.column_stack(signals[k]) / ORDINARY_NOISE_MM
        recordings.append(Products(open=opened.T @ opened, cross=opened.T @ effect, own=effect.T @ effect))
    built, m = model.as_built.size, len(recordings[0].open)
    precision = np.diag([*np.zeros(built), 1e-6, SCALE_STD**-2.0, *np.ones(m - built - 2)])
    precision[:built, :built] = model.as_built.precision
    return Alike(claims=claims, recordings=recordings, precision=precision)
