"""Whether teeth of which only the grade is known differ in form, as that lets them: from the evidence."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.entries import Entry
from gearpoly.diagnose.as_built import AsBuilt, GearPrior, make_as_built
from gearpoly.diagnose.both_flanks import SHARED_PART_EVIDENCE
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.linear import Linear, whitened
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.order_waves import STRONGEST, Order, order_waves
from gearpoly.diagnose.shortened import PLACING_SAMPLES, shortened
from gearpoly.diagnose.sparse import Sparse
from gearpoly.diagnose.system import System
from gearpoly.errors import GearpolyError
from gearpoly.mesh.pair import Flank
from gearpoly.scene import Scene
from gearpoly.units import FloatArray, IntArray

HALF_WAVES = 4
"""Half waves of form, from two on, that are fitted of every tooth: as many as gears are drawn with (``gear.draw``)."""

MOST_AS_BUILT_PARAMETERS = 900
"""As-built parameters at most, or fewer half waves are fitted: their products take the square of it in time. Of 520
parameters and three recordings of 5500 samples a fit took 9 s loaded and 17 s unloaded. A judgement."""

COMMON_FORM_STD_RATIO = 100.0
"""Standard deviation of what all teeth have in common meanwhile, over that of a half wave: some 11 times what the grade
allows, more than any wear that teeth outlive. Without it a missing deflection of two torques turned forms on."""

FORM_FIT_ROUNDS = 6
"""Rounds of simulating and fitting before it is asked: as many as a place of the teeth is tried with. A judgement."""

ODD_TEETH_PART = 0.25
"""Part of the teeth of a flank, those that differ most, that are not asked, nor any mesh in which they touch: a damaged
tooth says nothing of how a gear was made, and all teeth of its mate meet it. A judgement."""

MESH_WAVES = 8
"""Harmonics of the mesh that are free in every recording meanwhile: beyond those a hand-over holds little, and at 16
samples per mesh nothing shows. Without them a wear of 32 times what shows turned forms on."""

LEAST_FORM_MEAN_SQUARE, MOST_FORM_MEAN_SQUARE = 0.1, 1.3
"""Mean square of what forms come out as, over what they are beforehand, below and above which they are none. Of
fifteen drawn pairs it was 0.35 to 1.1 (the teeth that differ most are not asked), of recordings of another pair mostly
1.5 to 17; of unloaded teeth of one form that all lean by ten times what shows 0.05, where fits of them leave what they
cannot do."""


def with_forms(
    model: Model, foreign: list[FloatArray], step: Callable[[str], None], *, orders: Sequence[Order] = ()
) -> Model:
    """The model with a form of its own for every tooth whose form nobody measured, if that makes the recordings
    likelier beside the ``foreign`` columns (n_k, q) in mm, and of inspected gears beside waves of these whole
    ``orders``; else as it was. Where gears cannot run so, nothing is asked. For the evidence of a linear model see
    MacKay 1992, Neural Computation 4, 415."""
    told = _open(model.as_built)
    if told is model.as_built or has_forms(model) or model.budget.over:
        return model
    step("asking whether teeth differ in form")
    try:
        fit = Fit.begun(*shortened(_in_common(model), foreign, few=PLACING_SAMPLES[-1]), step, trial=FORM_FIT_ROUNDS)
    except GearpolyError:  # teeth that cannot run so are told where they are to run
        return model
    if all(one.graded for one in told.gears if one.form):
        # Forms make images of the teeth's own waves above half their number. Below it a wave of another part of the
        # drive is smooth: teeth that make up 5 um of one look as if they differed in form.
        orders = tuple((gear, order) for gear, order in orders if order < 0.5 * told.gears[gear].z)
    return replace(model, as_built=told, built=np.zeros(told.size)) if _differ(fit, told, orders) else model


def whole_orders(entries: Sequence[Entry]) -> tuple[Order, ...]:
    """The whole orders of either shaft at which most was located, and those once and twice per turn of both: an
    eccentricity, a ghost order or another part of the drive, which no form makes."""
    found = [
        (0 if one.gear == "driving" else 1, float(one.order))
        for one in entries
        if one.kind == "shaft_order" and one.order is not None and float(one.order).is_integer()
    ]
    return tuple(dict.fromkeys([(0, 1.0), (1, 1.0), (0, 2.0), (1, 2.0), *found[:STRONGEST]]))


def has_forms(model: Model) -> bool:
    """Whether teeth of a ``model`` have forms of their own."""
    return any(one.form for one in model.as_built.gears)


def with_open_forms(model: Model) -> Model:
    """The model with a form of its own for every tooth of graded gears, asked for or not; as it was where all are
    known."""
    told = _open(model.as_built)
    return model if told is model.as_built else replace(model, as_built=told, built=np.zeros(told.size))


def gain_beside_form(model: Model, scenes: list[Scene], linear: Linear, k: int, gain: float) -> float:
    """What of a ``gain`` in misfit of claim ``k`` about one tooth is left where that tooth may have a form of its own
    as its grade lets every tooth: whether they show theirs was asked of all, and few samples do not tell. Of a sound
    gear of grade 8 and module 10, recorded for two turns, a pit of 3.3 um was made."""
    claim = model.claims[k]
    tooth, gear = claim.place.tooth, claim.place.gear or 0
    one = model.as_built.gears[gear]
    if tooth is None or one.wave <= 0.0 or one.form:
        return gain
    gears = [
        replace(each, form=(each.wave,) * HALF_WAVES if j == gear else ())
        for j, each in enumerate(model.as_built.gears)
    ]
    told = make_as_built((gears[0], gears[1]), model.as_built.flanks)
    at = np.concatenate([told.form_at(flank, gear, tooth) for flank in told.flanks])
    forms = [noise.whitened(told.columns(scene).part(at)) for noise, scene in zip(linear.noises, scenes, strict=True)]
    bare = linear.without(linear.layout.places(k) + linear.layout.form_places(model, k)).system
    known = told.precision[np.ix_(at, at)]

    def beside(system: System) -> float:
        wider = system.with_columns(forms)
        return wider.believing(slice(wider.size - at.size, wider.size), known).misfit

    return beside(bare) - beside(bare.with_columns(linear.white_of(k)))


def _asked(one: GearPrior) -> bool:
    """Whether it is asked if a gear's teeth differ in form: nobody measured it."""
    return one.wave > 0.0


def _open(as_built: AsBuilt) -> AsBuilt:
    """The same with the forms of these teeth open; itself where all are known, or where they would be too many."""
    for waves in range(HALF_WAVES, 0, -1):
        gears = [replace(one, form=(one.wave,) * waves if _asked(one) else ()) for one in as_built.gears]
        if (
            any(one.form for one in gears)
            and len(as_built.flanks) * sum(one.size for one in gears) <= MOST_AS_BUILT_PARAMETERS
        ):
            return make_as_built((gears[0], gears[1]), as_built.flanks)
    return as_built


def _in_common(model: Model) -> Model:
    """The model with teeth that may lean and bulge together as far as any wear or relief makes them: what all teeth
    have, unloaded contact shows at some more than at others."""
    gears = [
        replace(one, mean_slope=COMMON_FORM_STD_RATIO * one.wave, crowning=COMMON_FORM_STD_RATIO * one.wave)
        if _asked(one)
        else one
        for one in model.as_built.gears
    ]
    return replace(model, as_built=make_as_built((gears[0], gears[1]), model.as_built.flanks))


def _differ(fit: Fit, told: AsBuilt, orders: Sequence[Order]) -> bool:
    """Whether forms make what a ``fit`` without them leaves likelier beside waves of these ``orders``, where none of
    those teeth touches that differ most."""
    teeth = [
        _Tooth(flank=flank, gear=gear, tooth=tooth, at=told.form_at(flank, gear, tooth))
        for flank in told.flanks
        for gear, one in enumerate(told.gears)
        if one.form
        for tooth in range(one.z)
    ]
    columns = whitened(fit.noises, [told.columns(scene) for scene in fit.scenes])
    every = np.concatenate([one.at for one in teeth])
    system = _beside_every_mesh(fit).with_columns(_of_all_teeth(columns, teeth))
    if orders:
        waves = order_waves([scene.samples for scene in fit.scenes], orders)
        white = [noise.whitened(one) for noise, one in zip(fit.noises, waves, strict=True)]
        system = system.with_columns(white)
    score, information = _scores(system, columns, every, size=told.size)
    found = np.array([_evidence(score, information, told.precision, one.at) for one in teeth])
    asked, masks = [], [np.ones(scene.samples.size, dtype=np.bool_) for scene in fit.scenes]
    for flank in told.flanks:
        for gear in (0, 1):
            mine = [k for k, one in enumerate(teeth) if one.flank == flank and one.gear == gear]
            mine.sort(key=lambda k: float(found[k]))
            most = len(mine) - round(ODD_TEETH_PART * len(mine))
            asked += mine[:most]
            apart = [teeth[k].tooth for k in mine[most:]]
            for mask, scene in zip(masks, fit.scenes, strict=True):
                if scene.samples.flank == flank:
                    mask &= ~np.any(np.isin(scene.teeth(gear), apart) & (scene.weight > 0.0), axis=0)
    every = np.concatenate([teeth[k].at for k in asked])
    clean = [one.rows(mask) for one, mask in zip(columns, masks, strict=True)]
    score, information = _scores(system.at(masks), clean, every, size=told.size)
    if _evidence(score, information, told.precision, every) < SHARED_PART_EVIDENCE:
        return False
    block = np.ix_(every, every)
    known = told.precision[block]
    form = np.linalg.solve(information[block] + known, score[every])
    return LEAST_FORM_MEAN_SQUARE < float(form @ known @ form) / every.size < MOST_FORM_MEAN_SQUARE


def _beside_every_mesh(fit: Fit) -> System:
    """The system of a ``fit`` with free waves that are the same at every mesh of a recording: a load or a wear that
    nobody declared, which no tooth has to itself."""
    columns = []
    for k, (scene, noise) in enumerate(zip(fit.scenes, fit.noises, strict=True)):
        turned = np.outer(scene.gear(1).z * scene.samples.theta_2, np.arange(1, MESH_WAVES + 1))
        waves = noise.whitened(np.concatenate((np.cos(turned), np.sin(turned)), axis=1))
        columns.append(np.zeros((scene.samples.size, 2 * MESH_WAVES * len(fit.scenes))))
        columns[k][:, 2 * MESH_WAVES * k : 2 * MESH_WAVES * (k + 1)] = waves
    return fit.linear.system.with_columns(columns)


def _of_all_teeth(columns: list[Sparse], teeth: Sequence[_Tooth]) -> list[FloatArray]:
    """Columns (n_k, q) of the forms that all teeth of a flank have in common."""
    groups: dict[tuple[Flank, int], list[IntArray]] = {(one.flank, one.gear): [] for one in teeth}
    for one in teeth:
        groups[one.flank, one.gear].append(one.at)
    sums = []
    for at in groups.values():
        every = np.array(at)
        ones = np.zeros((columns[0].shape[1], every.shape[1]))
        ones[every, np.arange(every.shape[1])] = 1.0
        sums.append(ones)
    return [white @ np.concatenate(sums, axis=1) for white in columns]


@dataclass(frozen=True, kw_only=True)
class _Tooth:
    """A tooth of a ``gear`` (0, 1) on a ``flank``, and where its half waves stand ``at`` (k,) among the as-built
    parameters."""

    flank: Flank
    gear: int
    tooth: int
    at: IntArray


def _scores(system: System, columns: list[Sparse], at: IntArray, *, size: int) -> tuple[FloatArray, FloatArray]:
    """Score (m,) and information (m, m) of those whitened ``columns`` (n_k, m) that stand ``at`` (q,), 0 elsewhere, all
    else fitted again beside them."""
    found = system.scores([one.part(at) for one in columns])
    score, information = np.zeros(size), np.zeros((size, size))
    score[at], information[np.ix_(at, at)] = found
    return score, information


def _evidence(score: FloatArray, information: FloatArray, precision: FloatArray, at: IntArray) -> float:
    """Twice by how much the log of the evidence rises with the parameters ``at`` (k,), of which ``precision`` is known
    beforehand, their mean 0."""
    block = np.ix_(at, at)
    whole = information[block] + precision[block]
    gain = float(score[at] @ np.linalg.solve(whole, score[at]))
    return gain - float(np.linalg.slogdet(whole)[1] - np.linalg.slogdet(precision[block])[1])
