"""The present state as one linear system: as-built teeth, nuisance, waves that nobody can name, and the claims."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearpoly.compare.noise import Noise
from gearpoly.diagnose.as_built import AsBuilt
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.nuisance import Nuisance
from gearpoly.diagnose.sparse import Sparse
from gearpoly.diagnose.system import Sums, System
from gearpoly.errors import GearpolyError
from gearpoly.infer.free_form import FREE_FORM
from gearpoly.infer.prior import FORM
from gearpoly.infer.unknown import tooth_hats
from gearpoly.physics.base import Claim, Scope
from gearpoly.physics.place import Values
from gearpoly.scene import Scene
from gearpoly.threads import each
from gearpoly.units import FloatArray, IntArray

SHAPE_PRIOR_STEPS = 20.0
"""Steps of a shape coordinate that are its prior about the present value: far more than data leave, and a bound where
they leave everything."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Layout:
    """Where everything stands among the parameters: ``built`` first, then ``nuisance``, ``foreign`` waves, ``forms`` of
    claimed teeth that their physics leaves open, and the coordinates of each claim."""

    built: slice
    nuisance: slice
    foreign: slice
    forms: slice
    claims: list[slice]

    def places(self, k: int) -> list[int]:
        """Parameters of claim ``k``."""
        return list(range(self.claims[k].start, self.claims[k].stop))

    def form_places(self, model: Model, k: int) -> list[int]:
        """Parameters of the freedom of form of claim ``k``, if it has a tooth."""
        if not _is_loose(model.claims[k]):
            return []
        before = sum(map(_is_loose, model.claims[:k]))
        start = self.forms.start + before * CLAIMED_TOOTH_KNOTS
        return list(range(start, start + CLAIMED_TOOTH_KNOTS))


@dataclass(frozen=True, kw_only=True, eq=False)
class Linear:
    """The system about the present state with its layout; ``columns`` (n_k, m) in mm before whitening."""

    system: System
    layout: Layout
    columns: list[Sparse]
    target: list[FloatArray]
    noises: list[Noise]

    def left(self, system: System | None = None) -> list[FloatArray]:
        """What the solution leaves of every recording, in mm."""
        x = (self.system if system is None else system).solution
        return [y - a @ x for a, y in zip(self.columns, self.target, strict=True)]

    def without(self, leave: list[int]) -> Linear:
        """The same without some parameters."""
        keep = np.setdiff1d(np.arange(self.system.size), np.asarray(leave, dtype=np.int64))
        return Linear(
            system=self.system.without(leave),
            layout=self.layout,
            columns=[c.only(keep) for c in self.columns],
            target=self.target,
            noises=self.noises,
        )

    def under(self, noises: list[Noise], as_built: AsBuilt | None = None) -> Linear:
        """The same whitened by other noise, and with another prior of the teeth as built if one is given."""
        precision = self.system.precision
        if as_built is not None:
            precision = precision.copy()
            precision[self.layout.built, self.layout.built] = as_built.precision
        system = System(
            white=whitened(noises, self.columns),
            target=[noise.whitened(y) for noise, y in zip(noises, self.target, strict=True)],
            precision=precision,
            prior=self.system.prior,
        )
        return Linear(system=system, layout=self.layout, columns=self.columns, target=self.target, noises=noises)

    @cached_property
    def _backward(self) -> list[tuple[FloatArray, Sparse]]:
        """What is left (n_k,) and all columns (n_k, m) whitened twice, forth and back: their products with further
        columns need not have these whitened."""
        return [
            (noise.score(left), white.backward(noise.ar, noise.innovation))
            for noise, left, white in zip(self.noises, self.system.left, self.system.white, strict=True)
        ]

    def gains(self, effects: Sequence[Sequence[FloatArray]]) -> FloatArray:
        """By how much the misfit falls (q,) with each of ``effects``, (n_k,) in mm of every recording, as it is, all
        else fitted again beside it."""
        whites = [np.column_stack([noise.whitened(one[k]) for one in effects]) for k, noise in enumerate(self.noises)]
        score, information = self.system.scores(whites)
        return np.asarray(2.0 * score - np.diag(information))

    def sums(self, k: int, columns: FloatArray, *, where: IntArray | None = None) -> Sums:
        """What recording ``k`` says of further columns (n_k, q) in mm, which are 0 but at the samples ``where``."""
        left, white = self._backward[k]
        if where is None:
            forth = self.noises[k].whitened(columns)
            return Sums(score=columns.T @ left, own=forth.T @ forth, cross=white.T @ columns)
        forth, there = self.noises[k].whitened_at(columns, where), columns[where]
        return Sums(score=there.T @ left[where], own=forth.T @ forth, cross=white.transposed_at(where, there))

    def white_of(self, k: int) -> list[FloatArray]:
        """Whitened columns (n_k, q) of claim ``k``."""
        return [a.part(self.layout.claims[k]) for a in self.system.white]


def whitened(noises: Sequence[Noise], columns: Sequence[Sparse]) -> list[Sparse]:
    """Columns (n_k, m) in mm of every recording with its noise made white."""

    def white(one: tuple[Noise, Sparse]) -> Sparse:
        noise, mine = one
        return mine.forward(noise.ar, noise.innovation)

    return each(white, zip(noises, columns, strict=True))


def derivatives(model: Model, scenes: list[Scene], claim: Claim) -> list[FloatArray]:
    """Derivative (n_k, q) in mm of every recording by the coordinates of a claim, at its values; by its size, per unit
    of the whole where a tooth has left the mesh: how far it stands back, nothing shows, but that it does."""
    out = _derivatives(model, scenes, claim)
    whole = _left_mesh(model, scenes, claim, out)
    for mine, effect in zip(out, whole, strict=True) if whole else ():
        mine[:, 0] = effect / claim.values[0]
    return out


def out_of_mesh(model: Model, scenes: list[Scene], claim: Claim) -> bool:
    """Whether a claimed tooth stands so far back that hardly anything changes if it stands farther back."""
    return bool(_left_mesh(model, scenes, claim, _derivatives(model, scenes, claim)))


def _left_mesh(model: Model, scenes: list[Scene], claim: Claim, columns: list[FloatArray]) -> list[FloatArray]:
    """Effects (n_k,) in mm of a claimed tooth, simulated with it and without, if it has left the mesh, so that its
    ``columns`` (n_k, q) are far from telling them; else nothing."""
    gear, tooth = claim.place.gear or 0, claim.place.tooth
    if tooth is None or claim.physics.amplitudes != 1 or claim.values[0] == 0.0:
        return []
    carrying = [np.bincount(s.teeth(gear)[s.weight > 0.0], minlength=s.gear(gear).z) for s in scenes]
    if all(one[tooth] > CARRIES_SELDOM_PART * np.median(one) for one in carrying):
        return []
    whole = whole_effect(model, scenes, claim)
    told = sum(float(np.sum((claim.values[0] * c[:, 0]) ** 2)) for c in columns)
    return whole if told < OUT_OF_MESH_PART**2 * sum(float(np.sum(effect**2)) for effect in whole) else []


def whole_effect(model: Model, scenes: list[Scene], claim: Claim) -> list[FloatArray]:
    """What a claimed tooth changes (n_k,) in mm of every recording: simulated without it where it may touch, and
    everywhere where what it changes goes on swinging."""
    others, gear, tooth = model.but(claim), claim.place.gear or 0, claim.place.tooth or 0
    swings = scenes[0].assembled.shafts.frequency is not None
    where = [np.arange(s.samples.size) if swings else s.samples.meshing(gear, tooth, z=s.gear(gear).z) for s in scenes]
    asked = [scene.samples.at(mine) for scene, mine in zip(scenes, where, strict=True)]
    out = []
    for here, mine, gone in zip(
        scenes, where, others.method.scenes(others.file(), asked, path=others.path), strict=True
    ):
        effect = np.zeros(here.samples.size)
        effect[mine] = here.te[mine] - gone.te
        out.append(effect)
    return out


def _derivatives(model: Model, scenes: list[Scene], claim: Claim) -> list[FloatArray]:
    base = model.change(scenes, claim, claim.values, but=claim)
    out: list[list[FloatArray]] = [[] for _ in scenes]
    for k, quantity in enumerate(claim.physics.coordinates):
        most = quantity.most(model.scope, claim.place)
        step = quantity.step if claim.values[k] + quantity.step <= most else -quantity.step

        def stepped(k: int, step: float) -> list[FloatArray]:
            values: Values = (*claim.values[:k], claim.values[k] + step, *claim.values[k + 1 :])
            changes = model.change(scenes, claim, values, but=claim)
            return [(there - here) / step for there, here in zip(changes, base, strict=True)]

        try:
            columns = stepped(k, step)
        except GearpolyError:  # one step farther teeth bend too far, or jam
            columns = stepped(k, -step)
        for mine, column in zip(out, columns, strict=True):
            mine.append(column)
    return [np.column_stack(mine) for mine in out]


CLAIMED_TOOTH_KNOTS = 12
"""Places along the contact of a claimed tooth between which its form may differ from what the physics draws."""

CARRIES_SELDOM_PART = 0.9
"""Part of the samples in which a tooth of its gear carries below which one may have left the mesh."""

OUT_OF_MESH_PART = 0.5
"""Part of the effect that a tooth's size must still tell, or the tooth counts as out of the mesh."""

LEAST_FORM = 1e-9
"""mm. The least of the same: far below anything seen."""


def _is_loose(claim: Claim) -> bool:
    """Whether the form of a claimed tooth may differ from what is drawn of it: a curve of its own may not."""
    return claim.place.tooth is not None and claim.physics is not FREE_FORM


def loose_forms(model: Model, scenes: list[Scene]) -> tuple[list[FloatArray], FloatArray]:
    """Columns (n_k, q) in mm per unit of what claimed teeth may deviate by beside their physics, and the standard
    deviation (q,) of each."""
    out: list[list[FloatArray]] = [[np.zeros((scene.samples.size, 0))] for scene in scenes]
    std: list[float] = []
    for claim in model.claims:
        if not _is_loose(claim):
            continue
        changes = model.change(scenes, claim, claim.values, but=claim)
        # A claim whose amplitude the fit has brought to nothing still needs a prior that is no division by zero.
        size = max(FORM * max(float(np.max(np.abs(c))) for c in changes), LEAST_FORM)
        for mine, scene in zip(out, scenes, strict=True):
            mine.append(tooth_hats(scene, claim.place.gear or 0, claim.place.tooth or 0, knots=CLAIMED_TOOTH_KNOTS))
        std += [size] * CLAIMED_TOOTH_KNOTS
    return [np.concatenate(mine, axis=1) for mine in out], np.array(std)


def linearise(
    model: Model,
    scenes: list[Scene],
    noises: list[Noise],
    *,
    nuisance: Nuisance,
    foreign: list[FloatArray],
) -> Linear:
    """The system of the present state; ``foreign`` (n_k, q) are waves that no physics makes."""
    built = each(model.as_built.columns, scenes)
    forms, form_std = loose_forms(model, scenes)
    others = [[c, w, f] for c, w, f in zip(nuisance.columns, foreign, forms, strict=True)]
    m_b, m_n, m_w, m_f = built[0].shape[1], nuisance.std.size, foreign[0].shape[1], form_std.size
    present = np.zeros(m_b + m_n + m_w + m_f)
    present[:m_b] = model.built
    present[m_b + nuisance.shift] = model.shift
    present[m_b + nuisance.rates.start : m_b + nuisance.rates.stop] = nuisance.sigmas(model.rates)
    prior = np.zeros(present.size)
    # The compliance's column is relative to the present scale; the prior is about the declared one.
    if nuisance.scale is not None:
        prior[m_b + nuisance.scale] = 1.0 / model.scale - 1.0
    precision = np.zeros((present.size, present.size))
    precision[:m_b, :m_b] = model.as_built.precision
    precision[range(m_b, m_b + m_n), range(m_b, m_b + m_n)] = nuisance.std**-2.0
    first = m_b + m_n + m_w
    precision[range(first, first + m_f), range(first, first + m_f)] = form_std**-2.0
    slices, at = [], present.size
    for claim in model.claims:
        for mine, columns in zip(others, derivatives(model, scenes, claim), strict=True):
            mine.append(columns)
        q = len(claim.values)
        slices.append(slice(at, at + q))
        at += q
        # Amplitudes count from nothing, shapes from where they are.
        a = claim.physics.amplitudes
        held = np.array([*claim.values[:a], *(0.0,) * (q - a)])
        present = np.concatenate((present, held))
        prior = np.concatenate((prior, held))
        shape = np.zeros(q)
        for k in range(claim.physics.amplitudes, q):
            shape[k] = (SHAPE_PRIOR_STEPS * claim.physics.coordinates[k].step) ** -2.0
        if claim.physics.fixed_amplitudes:
            shape[: claim.physics.amplitudes] = 1e6
        wider = np.zeros((at, at))
        wider[: at - q, : at - q] = precision
        wider[range(at - q, at), range(at - q, at)] = shape
        precision = wider
    columns_all = [mine.beside(np.concatenate(more, axis=1)) for mine, more in zip(built, others, strict=True)]
    target = [r + a @ present for r, a in zip(model.residuals(scenes), columns_all, strict=True)]
    system = System(
        white=whitened(noises, columns_all),
        target=[noise.whitened(y) for noise, y in zip(noises, target, strict=True)],
        precision=precision,
        prior=prior,
    )
    layout = Layout(
        built=slice(0, m_b),
        nuisance=slice(m_b, m_b + m_n),
        foreign=slice(m_b + m_n, first),
        forms=slice(first, first + m_f),
        claims=slices,
    )
    return Linear(system=system, layout=layout, columns=columns_all, target=target, noises=noises)


def within(claim: Claim, values: FloatArray, scope: Scope) -> tuple[float, ...]:
    """Values within their bounds, the shape not moved by more than eight steps at once."""
    out = []
    for k, quantity in enumerate(claim.physics.coordinates):
        value = float(values[k])
        if k >= claim.physics.amplitudes:
            value = float(np.clip(value, claim.values[k] - 8.0 * quantity.step, claim.values[k] + 8.0 * quantity.step))
        elif claim.physics.fixed_amplitudes:
            value = 1.0
        out.append(float(np.clip(value, *quantity.bounds(scope, claim.place))))
    return tuple(out)
