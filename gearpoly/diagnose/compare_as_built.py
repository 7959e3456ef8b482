"""Recordings beside teeth that touch as they were built, where ``compare`` takes what they may be to first order.

Which of two unloaded teeth touches depends on both, and no linear model follows that: of a 24/36 of grade 6 that
nobody had inspected, free of any fault, 33 orders, teeth and stretches of every mesh were told. So where teeth are open
the fit of teeth as built is made with exact contact, and what repeats with the teeth is held against it: it stays where
the fit would still pay for it, and what the fit leaves is located anew.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import Step, compare
from gearpoly.compare.describe import ECHO_WAVE
from gearpoly.compare.division import LARGEST_ORDERS_LISTED, LARGEST_ORDERS_SIGMAS, LEAST_MISMATCH_PART, holds
from gearpoly.compare.entries import EVERY_MESH_KINDS, OF_THE_READINGS, Entry, named
from gearpoly.compare.locate import Located
from gearpoly.diagnose.begin import before_claims
from gearpoly.diagnose.budget import Budget
from gearpoly.diagnose.fit import PASSES, Fit
from gearpoly.diagnose.foreign import is_foreign
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.placing import only_teeth_tell, placed
from gearpoly.diagnose.residuals import locate_residuals, residuals_of, sharp, stands_out
from gearpoly.diagnose.shortened import openings, shortened
from gearpoly.diagnose.significance import FitResidual, above_background, fit_residual, is_significant, outlying_teeth
from gearpoly.diagnose.tooth_forms import with_forms
from gearpoly.errors import GearpolyError
from gearpoly.files.models import PairFile
from gearpoly.infer.prior import order_of
from gearpoly.recording.recording import Recording
from gearpoly.units import UM, IntArray

MOST_SAMPLES_FITTED = 30_000
"""Samples of a recording beyond which so many are fitted: of 862 290 samples, fit and search then took 3 s."""

SAME_ENTRY_TOLERANCE = 0.02
"""Part of a frequency or of a moment by which it may come out otherwise beside other teeth. A judgement."""

WITH_TEETH = ("shaft_order", "mesh_order", "mesh_phase", "tooth", "condition")
"""Kinds of entries that teeth as built may make, or change."""


def compare_as_built(
    file: PairFile, recordings: Sequence[Recording], *, path: Path | str, step: Step = lambda _: None
) -> Comparison:
    """``compare``, and where nobody inspected a gear, what it located at its teeth held against teeth that touch as
    they were built. Raises what ``compare`` does."""
    comparison = compare(file, recordings, path=path, step=step)
    if not teeth_are_open(comparison):
        return comparison
    step("letting the teeth touch as they were built")
    model, waves = before_claims(file, comparison, path=Path(path), method=Method(), budget=Budget())
    seen_at = openings(model, few=MOST_SAMPLES_FITTED)
    try:
        if only_teeth_tell(model):
            model = placed(model, waves, step)
            comparison = comparison.moved(model.offset)
        model = with_forms(model, waves, step)
        fit = Fit.begun(*shortened(model, waves, few=MOST_SAMPLES_FITTED), lambda _: None, trial=PASSES)
        return with_teeth_of(fit, comparison, located_beside(fit, comparison), seen_at=seen_at)
    except GearpolyError:  # teeth that cannot run so say nothing about those that do
        return comparison


def teeth_are_open(comparison: Comparison) -> bool:
    """Whether anything was located that teeth which nobody inspected may make."""
    graded = any(one.F_pT is not None for one in comparison.gears)
    return graded and any(map(_with_teeth, comparison.located.entries))


def located_beside(fit: Fit, comparison: Comparison) -> Located:
    """What stands out beside the teeth of a ``fit``, waves that no pair makes with their size."""
    return locate_residuals(fit, comparison, residuals_of(fit))


def with_teeth_of(fit: Fit, comparison: Comparison, left: Located, *, seen_at: Sequence[IntArray]) -> Comparison:
    """The ``comparison`` with what stands out beside the teeth of a ``fit`` in which nothing is claimed yet: of what is
    ``left`` beside them, and of which the recordings have the samples of the numbers ``seen_at`` (n_k,)."""
    first = comparison.located
    whole = all(seen.size == one.theta_2.size for seen, one in zip(seen_at, comparison.aligned, strict=True))
    residual = fit_residual(fit, comparison, residuals_of(fit), [noise.level for noise in left.noises])
    repeats = [one.whole for one in fit.model.observed]
    of_no_pair = _of_no_pair(residual, first, left, all_samples=whole)
    # At a line of another part of the drive what teeth leave is no second line.
    told = {(one.gear, one.order) for one in of_no_pair if one.order is not None}
    of_teeth = [one for one in _of_teeth(residual, first, left) if (one.gear, one.order) not in told]
    entries = [*of_teeth, *of_no_pair]
    entries = sorted(_accompanied(comparison.named(entries)), key=lambda one: -one.gain)
    taken = [
        float(np.std(one.residual[seen] - rest))
        for one, seen, rest in zip(comparison.aligned, seen_at, residual.residuals, strict=True)
    ]
    located = replace(
        first,
        entries=tuple(entries),
        where=_where(comparison, entries, repeats),
        divisions=tuple(replace(one, as_built=rms) for one, rms in zip(left.divisions, taken, strict=True)),
    )
    if whole:
        before = [one.repeatable for one in first.noises]
        noises = tuple(replace(one, repeatable=rms) for one, rms in zip(left.noises, before, strict=True))
        located = replace(located, noises=noises, noise_level=left.noise_level, left=left.left)
    return replace(comparison, located=located)


def held_by_teeth(fit: Fit, comparison: Comparison) -> Comparison:
    """The ``comparison`` with the waves and stretches of all teeth that teeth as built hold in a ``fit``, and nothing
    that is claimed there, where there is no time left to locate anew what that leaves. Of 13 um of wear of printed
    gears twelve waves of their own teeth were told, since a crowning had been claimed when time was over."""
    first, claims = comparison.located, fit.model.claims
    residual = fit_residual(fit, comparison, residuals_of(fit), [noise.level for noise in fit.noises])
    waves = {(one.place.gear_name, order_of(one)) for one in claims}
    of_all = any(one.physics.mean_tooth for one in claims)

    def is_held(one: Entry) -> bool:
        claimed = of_all if one.kind in EVERY_MESH_KINDS else (one.gear, one.order) in waves
        return _of_all_teeth(one) and not claimed and not _stays(one, residual)

    held = {_place(one) for one in first.where if is_held(one)}
    where = tuple(replace(one, as_built=True) if _place(one) in held else one for one in first.where)
    entries = tuple(one for one in first.entries if _place(one) not in held)
    return replace(comparison, located=replace(first, where=where, entries=entries))


def _accompanied(entries: Sequence[Entry]) -> list[Entry]:
    """The ``entries``, alone where what they came with is not told; small whole orders of a shaft with the largest of
    its teeth: what a fit leaves of one tooth's shape is all of them. Of a spall of 28 um a hundred ghost orders of 0.04
    to 0.08 um were listed."""
    told = {named(one) for one in entries} | {OF_THE_READINGS}
    teeth: dict[str | None, Entry] = {}
    for one in sorted((one for one in entries if one.kind == "tooth"), key=_size):
        teeth[one.gear] = one
    return [
        one
        if one.companion_of in told
        else replace(one, companion_of=named(teeth[one.gear]) if _left_of(one, teeth.get(one.gear)) else None)
        for one in entries
    ]


def _left_of(one: Entry, tooth: Entry | None) -> bool:
    """Whether a wave may be left of the shape of a ``tooth`` that is told."""
    whole = one.kind == "shaft_order" and one.order_std is None and not one.parts
    return tooth is not None and whole and _size(one) < ECHO_WAVE * _size(tooth)


def _size(one: Entry) -> float:
    return abs(one.amplitude_um or one.rms_um or 0.0)


def _stays(one: Entry, residual: FitResidual) -> bool:
    """Whether a wave or a stretch of all teeth still stands out where teeth are fitted as they were built."""
    return is_significant(one, residual) and above_background(one, residual)


def _of_teeth(residual: FitResidual, first: Located, left: Located) -> list[Entry]:
    """What stands out at teeth: of the ``first`` look what is significant beside the fit, teeth beyond their grade, and
    what is ``left``."""
    waves = [one for one in first.entries if _of_all_teeth(one) and _stays(one, residual)]
    told = {_place(one) for one in waves}
    anew = [one for one in left.entries if _with_teeth(one) and stands_out(one, residual.fit)]
    outlying = outlying_teeth(residual, waves)
    teeth = {(one.kind, one.gear, one.encoder_deg) for one in outlying}
    anew = [one for one in anew if _place(one) not in told and (one.kind, one.gear, one.encoder_deg) not in teeth]
    further = [*outlying, *anew]
    return [*waves, *(one for one in further if above_background(one, residual))]


def _of_no_pair(residual: FitResidual, first: Located, left: Located, *, all_samples: bool) -> list[Entry]:
    """What no pair makes of the ``first`` look, where it stands out of what is ``left`` too; and all of it of which
    fewer samples, a recording that never repeats itself, or teeth under a line of another part of the drive tell too
    little."""
    whole = [one.whole for one in residual.fit.model.observed]

    def stays(entry: Entry) -> bool:
        if not _passing(entry) or entry.parts:
            return True
        if entry.kind == "shaft_order" and not above_background(entry, residual):
            return False
        told = all_samples and all(whole[k] for k in entry.recordings)
        # Beside other teeth a wave may be told over the other of angle and time.
        return not told or sharp(entry) or any(_alike(entry, other) for other in left.entries)

    return [one for one in first.entries if not _with_teeth(one) and stays(one)]


def _with_teeth(entry: Entry) -> bool:
    """Whether teeth as built may make an entry, or change it."""
    return entry.kind in WITH_TEETH and not is_foreign(entry)


def _of_all_teeth(entry: Entry) -> bool:
    """Whether it is a wave or a stretch of every tooth."""
    return _with_teeth(entry) and entry.kind not in ("tooth", "condition")


def _passing(entry: Entry) -> bool:
    """Whether an entry is of what no pair makes, and no slow drift, which a fit of its own takes."""
    return is_foreign(entry) or entry.burst is not None


def _alike(one: Entry, other: Entry) -> bool:
    """Whether two entries of what no pair makes are of one wave, one burst, or one jump."""
    if one.kind != other.kind or set(one.recordings).isdisjoint(other.recordings) or one.gear != other.gear:
        return False
    lasts = one.during_s or one.during_turns, other.during_s or other.during_turns
    if lasts[0] is not None and lasts[1] is not None:
        return lasts[0][0] < lasts[1][1] and lasts[1][0] < lasts[0][1]
    mine = one.hz, one.order, one.time_s, one.driving_turn
    its = other.hz, other.order, other.time_s, other.driving_turn
    return all(
        a == b or (a is not None and b is not None and abs(a - b) < SAME_ENTRY_TOLERANCE * max(abs(a), abs(b)))
        for a, b in zip(mine, its, strict=True)
    )


def _place(entry: Entry) -> tuple[object, ...]:
    """What tells an entry from others of its kind."""
    when = entry.hz, entry.time_s, entry.driving_turn, entry.during_s, entry.during_turns
    return entry.kind, entry.gear, entry.order, entry.tooth, entry.encoder_deg, entry.phase, when, entry.recordings


def _where(comparison: Comparison, entries: Sequence[Entry], repeats: Sequence[bool]) -> tuple[Entry, ...]:
    """All places at which recordings and simulation differ, that which holds most of the mismatch first: the
    ``entries``, orders as large as the whole mismatch has them, and strong orders that the teeth hold; every order that
    they hold in recordings of which none ``repeats`` itself, where a few samples for each tooth can be held by any."""
    z = comparison.gears[0].z, comparison.gears[1].z
    before = {_place(one): one for one in comparison.located.where}
    out = []
    for one in entries:
        whole = before.pop(_place(one), one)
        out.append(replace(whole, as_built=False, p_value=one.p_value, gain=one.gain, companion_of=one.companion_of))

    def held(entry: Entry) -> float:
        laid = comparison.aligned[entry.recordings[0]]
        return holds(entry, z=z, time_s=laid.time_s, theta_1=laid.theta_1)

    clear = [
        one for one in before.values() if (one.amplitude_um or 0.0) > LARGEST_ORDERS_SIGMAS * (one.std_um or math.inf)
    ]
    foremost = sorted((one for one in clear if one.companion_of is None), key=lambda one: -held(one))[
        :LARGEST_ORDERS_LISTED
    ]
    for one in before.values():
        largest = max((comparison.aligned[k].rms / UM) ** 2 for k in one.recordings)
        strong = (
            not any(repeats[k] for k in one.recordings) or held(one) > LEAST_MISMATCH_PART * largest or one in foremost
        )
        if one.of_the_pair and (one.parts or (strong and one.companion_of is None)):
            out.append(replace(one, as_built=True, companion_of=None))
    return tuple(sorted(out, key=lambda one: -held(one)))
