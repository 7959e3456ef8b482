"""Whether the teeth of a graded gear differ in form, which grades allow and the recordings tell: from the evidence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.as_built import AsBuilt, GearPrior, make_as_built
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.placing import FEW, shortened
from gearpoly.diagnose.system import System
from gearpoly.errors import GearpolyError
from gearpoly.mesh.pair import Flank
from gearpoly.units import FloatArray, IntArray

HALF_WAVES = 4
"""Half waves of form, from two on, that are fitted of every tooth: as many as gears are drawn with (``gear.draw``)."""

EACH = 0.32
"""Standard deviation of each over that of the crowning that all teeth have in common: 0.29 to 0.35 on gears of 11 to
61 teeth drawn within grades 4 to 8."""

MOST = 900
"""As-built parameters at most, or fewer half waves are fitted: a fit of three recordings of 18 000 samples then takes
{MOST_COSTS}."""

ROUNDS = 6
"""Rounds of simulating and fitting before it is asked."""

APART = 0.25
"""Part of the teeth of a flank, those that differ most, that are not asked, nor any mesh in which they touch: a damaged
tooth says nothing of how a gear was made, and all teeth of its mate meet it. A judgement."""

CLEARLY = 10.0
"""Fall of twice the negative log of the evidence for it to be believed: likelier by a factor of 150."""


def with_forms(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> Model:
    """The model with a form of its own for every tooth of graded gears, if that makes the recordings likelier; else as
    it was."""
    told = _open(model.as_built)
    if told is model.as_built or model.budget.over:
        return model
    step("asking whether teeth differ in form")
    try:
        fit = Fit.begun(*shortened(model, foreign, few=FEW[-1]), step, trial=ROUNDS)
    except GearpolyError:  # teeth that cannot run so are told where they are to run
        return model
    return replace(model, as_built=told, built=np.zeros(told.size)) if _differ(fit, told) else model


def _open(as_built: AsBuilt) -> AsBuilt:
    """The same with the forms of graded teeth open; itself where none are, or where they would be too many."""
    for waves in range(HALF_WAVES, 0, -1):
        gears = [_formed(one, waves) if one.graded else one for one in as_built.gears]
        if any(one.form for one in gears) and len(as_built.flanks) * sum(one.size for one in gears) <= MOST:
            return make_as_built((gears[0], gears[1]), as_built.flanks)
    return as_built


def _formed(gear: GearPrior, waves: int) -> GearPrior:
    return replace(gear, form=(EACH * gear.crowning,) * waves)


def _differ(fit: Fit, told: AsBuilt) -> bool:
    """Whether forms make what a ``fit`` without them leaves likelier where none of those teeth touches that differ
    most."""
    teeth = [
        _Tooth(flank=flank, gear=gear, tooth=tooth, at=told.start(flank, gear) + 2 * one.z + 1 + tooth + waves * one.z)
        for flank in told.flanks
        for gear, one in enumerate(told.gears)
        for waves in [np.arange(len(one.form))]
        if one.form
        for tooth in range(one.z)
    ]
    columns = [noise.whitened(told.columns(scene)) for noise, scene in zip(fit.noises, fit.scenes, strict=True)]
    every = np.concatenate([one.at for one in teeth])
    score, information = _scores(fit.linear.system, columns, every, size=told.size)
    found = np.array([_evidence(score, information, told.precision, one.at) for one in teeth])
    asked, masks = [], [np.ones(scene.samples.size, dtype=np.bool_) for scene in fit.scenes]
    for flank in told.flanks:
        for gear in (0, 1):
            mine = [k for k, one in enumerate(teeth) if one.flank == flank and one.gear == gear]
            mine.sort(key=lambda k: float(found[k]))
            most = len(mine) - round(APART * len(mine))
            asked += mine[:most]
            apart = [teeth[k].tooth for k in mine[most:]]
            for mask, scene in zip(masks, fit.scenes, strict=True):
                if scene.samples.flank == flank:
                    mask &= ~np.any(np.isin(scene.teeth(gear), apart) & (scene.weight > 0.0), axis=0)
    every = np.concatenate([teeth[k].at for k in asked])
    clean = [one[mask] for one, mask in zip(columns, masks, strict=True)]
    score, information = _scores(fit.linear.system.at(masks), clean, every, size=told.size)
    return _evidence(score, information, told.precision, every) > CLEARLY


@dataclass(frozen=True, kw_only=True)
class _Tooth:
    """A tooth of a ``gear`` (0, 1) on a ``flank``, and where its half waves stand ``at`` (k,) among the as-built
    parameters."""

    flank: Flank
    gear: int
    tooth: int
    at: IntArray


def _scores(system: System, columns: list[FloatArray], at: IntArray, *, size: int) -> tuple[FloatArray, FloatArray]:
    """Score (m,) and information (m, m) of those whitened ``columns`` (n_k, m) that stand ``at`` (q,), 0 elsewhere, all
    else fitted again beside them."""
    found = system.scores([one[:, at] for one in columns])
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
