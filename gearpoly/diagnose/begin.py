"""From a pair file and recordings to the state that the search begins with. What the recordings contradict of the file
is put right first: inspection sheets, the sign of a transmission error, keys of the gears' shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearpoly.assemble import assemble
from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import compare
from gearpoly.compare.entries import Entry
from gearpoly.compare.slow import SLOW_CURVE_TERMS
from gearpoly.compare.stand_in import known_file
from gearpoly.diagnose.budget import Budget, Watch
from gearpoly.diagnose.fitted_part import fitted_part
from gearpoly.diagnose.foreign import foreign, foreign_entries, jumps, smooth_orders, strangers
from gearpoly.diagnose.ghosts import ghost_waves, slow_ghosts
from gearpoly.diagnose.heldout import beside_jumps
from gearpoly.diagnose.leftovers import located_at_every_mesh, located_on
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.misdeclared import misdeclared
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.placing import only_teeth_tell, placed
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.sheets import OPPOSITE, as_read, opposite, placed_by_sheets, reread, sign_may_be_wrong
from gearpoly.diagnose.tooth_forms import has_forms, whole_orders, with_forms
from gearpoly.diagnose.unstated import as_seen
from gearpoly.files.models import PairFile
from gearpoly.keys.also_turns import parts_of
from gearpoly.physics.base import Claim
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Begun:
    """The pair ``file`` and the recordings as they bear each other out: their ``comparison``, the working ``model``
    before any physics is claimed, and ``waves``, the columns (n, q) of each recording that no pair makes; ``ghosts``
    are those of ghost orders and drifts, which are free until something is looked for. ``assumed``: what to tell of
    gears of no stated grade; ``misread``: what was put right; ``contradicted``: where ``compare`` located what that
    explains; ``likely``: a physics of all teeth beside which hardly anything was left; ``beyond``: what it located
    where long recordings are not fitted; ``keys``: whether a key of the gears' shape was put right; ``asked``: whether
    its teeth were asked for forms of their own where they stand, beside nothing that is free for a while."""

    file: PairFile
    recordings: Sequence[Recording]
    comparison: Comparison
    model: Model
    waves: list[FloatArray]
    ghosts: list[FloatArray]
    assumed: tuple[str, ...] = ()
    misread: tuple[str, ...] = ()
    contradicted: tuple[Entry, ...] = ()
    likely: Claim | None = None
    beyond: tuple[Entry, ...] = ()
    keys: bool = False
    asked: bool = False

    @property
    def all_waves(self) -> list[FloatArray]:
        """The columns of each recording that are free until something is looked for."""
        return _beside(self.waves, self.ghosts)


def begin(
    file: PairFile, recordings: Sequence[Recording], *, path: Path, method: Method, budget: Budget, watch: Watch
) -> Begun:
    """The state to begin with, its teeth placed. Raises what ``compare`` does, and ``placed``."""

    def beside(file: PairFile, recordings: Sequence[Recording]) -> Begun:
        comparison = compare(file, recordings, path=path, step=watch.stage("compare"), over=lambda: budget.over)
        part = fitted_part(comparison)
        model, waves = before_claims(file, part.comparison, path=path, method=method, budget=budget)
        return Begun(
            file=file, recordings=recordings, comparison=part.comparison, model=model, waves=waves,
            ghosts=_beside(ghost_waves(part.comparison, model.observed), slow_ghosts(part.comparison, model)),
            beyond=part.beyond,
        )  # fmt: skip

    def seen(now: Begun) -> Begun:
        model, assumed = as_seen(now.model, now.waves, watch.stage("prepare"))
        return replace(now, model=model, assumed=assumed)

    def stood(now: Begun) -> Begun:
        preparing, model = watch.stage("prepare"), now.model
        orders = whole_orders(now.comparison.located.entries)
        # Unloaded teeth that stand wrongly leave so much that they seem to differ in form: of seven pairs of grade 6
        # four did. Where they stand rightly two of these do.
        first = only_teeth_tell(model)
        if first:
            model = placed(model, now.all_waves, preparing)
        asked = with_forms(model, now.all_waves, preparing, orders=orders)
        # Teeth of one form are placed wrongly where they have many: a sound gear of grade 10 needed another shape then.
        there = asked if first and asked is model else placed(asked, now.all_waves, preparing)
        moved = there.offset != asked.offset or there.turned_by != asked.turned_by
        return replace(now, model=there, asked=not moved and not now.ghosts[0].shape[1])

    now = beside(file, recordings)
    if now.comparison.another is not None:
        return stood(now)  # nothing of the file can be put right by what another pair shows
    wrong = reread(now.model, now.waves, watch.stage("prepare")) or []
    if sign_may_be_wrong(file, recordings, wrong):
        # Teeth hand over where either is ahead of the other: of the other sign no teeth fit, and no order of theirs.
        other = beside(file, opposite(recordings))
        if reread(other.model, other.waves, watch.stage("prepare")) == []:
            now, wrong = replace(other, misread=(OPPOSITE,)), []
    if any(one.inspection is None for one in wrong):
        moved = placed_by_sheets(now.model, now.waves, watch.stage("prepare"))
        if moved is not None:
            now, wrong = replace(now, model=moved), reread(moved, now.waves, watch.stage("prepare")) or []
    if wrong:
        sheets = [one for one in wrong if not one.opposite]
        contradicted = tuple(entry for one in sheets for entry in located_on(now.comparison, one.gear))
        file, misread = as_read(file, wrong)
        now = replace(beside(file, now.recordings), misread=misread, contradicted=contradicted)
    now = seen(now)
    there = stood(now)
    if not (at_every_mesh := located_at_every_mesh(now.comparison)):
        return there

    def declared(other: PairFile) -> tuple[Model, list[FloatArray]]:
        return _of_other_keys(now, other)

    def standing(file: PairFile) -> tuple[Model, list[FloatArray]]:
        # Where curves or zeros place teeth, all keys are held against each other there: elsewhere in the pitch a relief
        # of 14 um did what a profile shift does. Else the teeth of the file are placed already, and others have to be.
        if now.model.phased or now.model.stated:
            return declared(file)
        model = replace(there.model, phased=True, built=np.zeros_like(there.model.built), shift=0.0)
        return model, there.all_waves

    formed = has_forms(there.model)
    keys, likely = misdeclared(now.file, declared, watch.stage("prepare"), stated=standing, formed=formed)
    if keys is None:
        return replace(there, likely=likely)
    return replace(
        stood(seen(beside(keys.file, now.recordings))),
        misread=(*now.misread, keys.says),
        keys=True,
        contradicted=(*now.contradicted, *at_every_mesh),
    )


def before_claims(
    file: PairFile, comparison: Comparison, *, path: Path, method: Method, budget: Budget
) -> tuple[Model, list[FloatArray]]:
    """The working state before any physics is claimed, and the columns of what no pair makes."""
    z_1, z_2 = (gear.z for gear in comparison.gears)
    entries = foreign_entries(comparison, parts_of(file.also_turns, z_1=z_1, z_2=z_2))
    drawn = method.for_noise(comparison.located.noises)
    model = replace(prepare(file, comparison, path=path), method=drawn, strangers=strangers(entries), budget=budget)
    bent = [terms - 1 if terms > SLOW_CURVE_TERMS else 0 for terms in comparison.located.slow_terms]
    scope = replace(
        model.scope,
        smooth=smooth_orders(entries, z=(z_1, z_2)),
        wanders=tuple(max(both) for both in zip(model.scope.wanders, bent, strict=True)),
    )
    model = replace(model, scope=scope, observed=beside_jumps(model.observed, jumps(comparison)))
    return model, foreign(comparison, model, entries)


def _of_other_keys(now: Begun, file: PairFile) -> tuple[Model, list[FloatArray]]:
    """The same of the pair of another ``file`` beside the same recordings, its teeth as well known."""
    model = now.model
    comparison = replace(now.comparison, assembled=assemble(known_file(file), path=model.path, seed=0))
    other, waves = before_claims(file, comparison, path=model.path, method=model.method, budget=model.budget)
    scope = replace(other.scope, inspected=model.scope.inspected, form=model.scope.form)
    return replace(other, as_built=model.as_built, scope=scope), _beside(waves, now.ghosts)


def _beside(waves: list[FloatArray], ghosts: list[FloatArray]) -> list[FloatArray]:
    return [np.concatenate(one, axis=1) for one in zip(waves, ghosts, strict=True)]
