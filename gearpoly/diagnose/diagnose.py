"""From a pair file and recordings to the physics that the simulation left out."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.assemble import with_sheets_stated
from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry
from gearpoly.compare.noise import pooled_level
from gearpoly.diagnose.as_recorded import as_recorded
from gearpoly.diagnose.begin import Begun, begin
from gearpoly.diagnose.beyond_grade import beyond_grade
from gearpoly.diagnose.budget import Budget, Reached, Step, Watch
from gearpoly.diagnose.built import built_gears, compliance_scale
from gearpoly.diagnose.causes import PLACES_ASKED_FOR_CAUSES
from gearpoly.diagnose.compare_as_built import held_by_teeth
from gearpoly.diagnose.conditions import elsewhere, held_places
from gearpoly.diagnose.contest import Key
from gearpoly.diagnose.earned import earned
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.fitted import fitted_file
from gearpoly.diagnose.foreign import jumps
from gearpoly.diagnose.forms import ClaimInForm, forms, in_doubt, only_the_least
from gearpoly.diagnose.gathered import gathered
from gearpoly.diagnose.ghosts import left_to_ghosts
from gearpoly.diagnose.heldout import Checked, Rms, cross_validated, foretold_to
from gearpoly.diagnose.imagine import Imagined
from gearpoly.diagnose.judge import Judged
from gearpoly.diagnose.least import brought_to_least
from gearpoly.diagnose.leftovers import (
    FOREMOST,
    each_once,
    each_with_probability,
    located_by_load,
    not_excluded,
    same_place,
    slow_or_sudden,
    taken_back,
    unexplained,
    untold,
    with_causes,
)
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.play import play, with_play
from gearpoly.diagnose.remarks import beyond_laws, of_compliance, of_search, of_the_file, of_untouched
from gearpoly.diagnose.remounted import without_smaller
from gearpoly.diagnose.scaled import scale_finding, with_scale
from gearpoly.diagnose.searched import Searched, searched
from gearpoly.diagnose.separate import would_separate
from gearpoly.diagnose.softness import declared_ratio
from gearpoly.diagnose.tips import as_tips
from gearpoly.diagnose.told import causes_of, encoder_deg, explained, flank_curves, numbered, parameters
from gearpoly.diagnose.tooth_forms import whole_orders, with_forms
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.unseen import LACK_OF_FIT, checked, unseen_of
from gearpoly.diagnose.verdict import Diagnosis, Finding, Rival, Status
from gearpoly.files.models import PairFile
from gearpoly.recording.recording import Recording

TOLD_SIZE = 2.0
"""Standard errors from which on a size is one. Of a tooth with 1.7 mm of its tip missing "6 +- 12 um" of a spall was
named beside the missing tip."""

UNSEEN_LEFT_OVER_NOISE = 2.0
"""Times the noise that unseen samples are left at from which on what was located before is told where a fit tells of
nothing, and not how soft teeth are: one turn of a wheel foretells little of its other half. Of a run-up whose driven
channel was read 60 us late 4.1 times the noise was left, and 0.55 +- 0.02 of the declared compliance. A judgement."""

AT_LEAST = 2.0
"""Standard error of a size of which only the least is known, as a part of it: where every power of ten is as likely as
the next, two of three sizes are less than three times the least."""


def diagnose(
    file: PairFile,
    recordings: Sequence[Recording],
    *,
    path: Path | str,
    step: Step = lambda _: None,
    reached: Reached = lambda done, of: None,
    method: Method | None = None,
    within: float = math.inf,
) -> Diagnosis:
    """Locate where ``recordings`` of one set differ from the pair of ``file`` (read from ``path``), name the physics
    that was left out, and fit it; ``step`` is told what is done next, ``reached`` the stages; ``method`` leaves
    parts of the method out, to show what they are worth. After ``within`` seconds nothing more is looked for: what was
    found till then is held against unseen data and told, with a remark.

    Raises what ``compare`` does: ``InputFileError`` for recordings that are not of this pair, too short, or contradict
    each other; ``GeometryError`` and ``OutOfRangeError`` where the declared pair cannot run under their conditions.
    """
    watch, budget = Watch(step, reached), Budget(seconds=within)
    file = with_sheets_stated(file, path=path)
    start = begin(file, recordings, path=Path(path), method=method or Method(), budget=budget, watch=watch)
    preparing = watch.stage("prepare")
    model = start.model
    if not start.asked:  # elsewhere, and without what was free at ghost orders, forms may tell more
        model = with_forms(model, start.waves, preparing, orders=whole_orders(start.comparison.located.entries))
    found = searched(model, start, watch)
    weighed = _weighed(start, found, several=len(recordings) > 1)
    search, comparison, unseen = weighed.search, weighed.comparison, weighed.unseen
    after = unseen_of(search)
    scaled = scale_finding(comparison, after)
    findings = (*(() if scaled is None else (scaled,)), *_findings(weighed, watch))
    noise = pooled_level(search.noises, [scene.samples.size for scene in search.scenes])
    named = [one.claim for one in findings if one is not scaled]
    played, of_play = play(search, comparison, named, file=start.file)
    watch.stage("leftovers")("looking for what is left")
    lacking = after.unseen > UNSEEN_LEFT_OVER_NOISE * noise
    left_over = _left_over(start, found, weighed, named=bool(findings), lacking=lacking)
    masks = [one.fit for one in search.model.observed]
    left = after.unseen / max(foretold_to(search.linear, masks, noise, hold=held_places(search)), 1e-12)
    sure = left <= LACK_OF_FIT
    # Teeth give way to whatever is not understood, and so does how soft they are.
    scale = compliance_scale(search) if sure and not lacking else None
    built = built_gears(
        search, start.file, left=left, unearned=weighed.unearned, of_this_pair=comparison.another is None
    )
    if not left_over and not findings and beyond_laws(scale):
        # No name says why teeth give so much more or less than declared, but where it shows is known.
        left_over = located_by_load(start.comparison)
    left_over = each_with_probability(each_once(with_play(left_over, played), comparison))
    everything = list(range(found.start.system.size))
    return Diagnosis(
        comparison=comparison,
        status=_status(findings, left_over, comparison),
        findings=findings,
        unexplained=comparison.named(left_over),
        built=built,
        compliance_scale=scale,
        noise=noise,
        noise_by_recording=tuple(noise.level for noise in search.noises),
        before=_declared(comparison, search.model),
        as_built_only=cross_validated(found.start, masks, leave=everything[found.start.layout.foreign]),
        after=after,
        held_out_by=_held_out_by(search, jumped=any(jumps(comparison))),
        left=tuple(search.linear.left()),
        fitted=with_scale(fitted_file(search.model), comparison),
        not_excluded=not_excluded(search, findings),
        remarks=(
            *comparison.remarks,
            *found.assumed,
            *of_untouched(findings),
            *of_play,
            *start.misread,
            *(() if found.anew is None else (found.anew.says,)),
            *weighed.apart,
            *(() if unseen is None else unseen.says),
            *((budget.says,) if weighed.stopped else ()),
            *of_search(search, start.file, built, comparison, sure=sure, stopped=weighed.stopped),
            *of_compliance(scale),
            *of_the_file(weighed.unearned),
        ),
        unseen=unseen,
        stopped=weighed.stopped,
        seconds=watch.seconds(),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Weighed:
    """A ``search`` whose names were held against ``unseen`` data and ``judged`` against all that may stand in their
    place, with the ``comparison`` at the zeros that it ended with, the ``shapes`` that claims may have as well, the
    places that are ``unearned``, and what is said of recordings mounted ``apart``; ``stopped``: time was over first."""

    search: Fit
    comparison: Comparison
    unseen: Checked | None
    judged: Mapping[Key, Judged]
    shapes: Mapping[Key, Sequence[ClaimInForm]]
    unearned: Sequence[Unearned]
    apart: tuple[str, ...]
    stopped: bool


def _weighed(start: Begun, found: Searched, *, several: bool) -> _Weighed:
    """What was ``found``, weighed to its end or till time is over; ``several``: in more than one recording."""
    search, comparison, apart = found.search, found.comparison, tuple[str, ...]()
    search.step("holding the names against unseen data")
    search, unseen = checked(search, found.begun, found.start, comparison, unfinished=found.unfinished, keys=start.keys)
    search = left_to_ghosts(search, comparison)
    if several and search.model.claims:
        search, apart = without_smaller(search, unexplained(search, comparison))
    search, shapes = forms(search)
    search, judged, gone = earned(search, found.refitted)
    unearned = [one for one in gone if not as_tips(search.model, one)]
    stopped = found.stopped or (search.over and any(one.posterior is None for one in unearned))
    search = brought_to_least(search.believing(ratio=declared_ratio(search)))
    return _Weighed(
        search=search, comparison=comparison.refined(search.model.shift, search.shift_std), unseen=unseen,
        judged=judged, shapes=shapes, unearned=unearned, apart=apart, stopped=stopped,
    )  # fmt: skip


def _left_over(start: Begun, found: Searched, weighed: _Weighed, *, named: bool, lacking: bool) -> tuple[Entry, ...]:
    """Where something is that has no name. ``named``: something else has one; ``lacking``: much is left of unseen data.

    What was located before anything was fitted is told where the fit tells of nothing: it found another pair or
    mounting, its names did not stand against unseen data, or time was over.
    """
    comparison = weighed.comparison
    told = (*_places(found, weighed, start.comparison), *start.beyond, *start.contradicted)
    back = () if weighed.unseen is None or told or named else weighed.unseen.taken_back
    aside = found.anew is not None or comparison.another is not None
    if found.stopped and not named:
        told = (*told, *untold(held_by_teeth(weighed.search, comparison), told)[:PLACES_ASKED_FOR_CAUSES])
    if aside or back or (lacking and not told and not named):
        standing = tuple(one for one in comparison.located.entries if one.companion_of is None)
        told = standing[:PLACES_ASKED_FOR_CAUSES] or start.comparison.located.where[:FOREMOST] or told
    if back and not told:
        told = tuple(taken_back(comparison, one, rms) for one, rms in back)
    return told


def _status(findings: Sequence[Finding], left_over: Sequence[Entry], comparison: Comparison) -> Status:
    if findings:
        return "partly_explained" if left_over else "explained"
    return "unexplained" if left_over or comparison.another is not None else "nothing_missing"


def _findings(weighed: _Weighed, watch: Watch) -> tuple[Finding, ...]:
    """What has a name, the largest gain first."""
    search, judged, shapes = weighed.search, weighed.judged, weighed.shapes
    search.step("asking how deep")
    model = search.model
    named = [k for k, one in enumerate(model.claims) if one.key in judged and not _needless(search, k, judged)]
    leasts = {k: only_the_least(search, k, shapes.get(model.claims[k].key, ())) for k in named}
    thought = Imagined(model=model, laws=search.laws)
    each = []
    for k in sorted(named, key=lambda k: -judged[model.claims[k].key].gain):
        key = model.claims[k].key
        one = _finding(search, weighed.comparison, k, judged[key], shapes.get(key, ()), leasts[k], thought, watch)
        each.append((k, one))
    return tuple(gathered(search, each, hold=held_places(search)))


def _places(found: Searched, weighed: _Weighed, before: Comparison) -> tuple[Entry, ...]:
    """What no name explains, with what it could be, and what was located ``before`` anything was fitted and no grade
    lets teeth have."""
    search, comparison, unearned = weighed.search, weighed.comparison, weighed.unearned
    left_over = as_recorded(search, comparison, unexplained(search, comparison))
    left_over = (*left_over, *slow_or_sudden(search, found.looked_at))
    could_be = [() if one.posterior is None else causes_of(search, one.posterior) for one in unearned]
    left_over = with_causes(comparison, left_over, unearned, could_be, flank_curves(search))
    told = tuple(explained(search, comparison, left_over))
    beyond = beyond_grade(search, before, comparison)
    return (*(one for one in beyond if not any(same_place(one, other) for other in told)), *told)


def _finding(
    search: Fit,
    comparison: Comparison,
    k: int,
    judged: Judged,
    shapes: Sequence[ClaimInForm],
    at_least: bool,
    thought: Imagined,
    watch: Watch,
) -> Finding:
    model, linear = search.model, search.linear
    claim = model.claims[k]
    at = linear.layout.claims[k]
    covariance = linear.system.covariance[at, at].copy()
    if at_least:
        covariance[0, 0] += (AT_LEAST * claim.values[0]) ** 2
    masks = [one.fit for one in model.observed]
    mine = linear.layout.places(k) + linear.layout.form_places(model, k)
    hold = held_places(search)
    rivals = tuple(
        Rival(
            claim=one,
            parameters=parameters(model, one, np.zeros((len(one.values),) * 2)),
            probability=chance,
            tooth=numbered(comparison, one),
            encoder_deg=encoder_deg(comparison, one),
        )
        for one, chance in judged.posterior.told
        if one.key != claim.key
    )
    separation = None
    if rivals and not search.over:
        watch.stage("next recording")(f"thinking of recordings that would decide on {claim.physics.name}")
        separation = would_separate(
            model, search.scenes, linear, k, [one.claim for one in rivals], nuisance=search.nuisance, thought=thought
        )
    return Finding(
        claim=claim,
        parameters=in_doubt(
            parameters(model, claim, covariance),
            ((parameters(model, one.claim, np.zeros_like(covariance)), one.chance) for one in shapes),
        ),
        tooth=numbered(comparison, claim),
        encoder_deg=encoder_deg(comparison, claim),
        gain=judged.gain,
        probability=judged.posterior.of(claim),
        unknown_probability=judged.posterior.unknown,
        without=cross_validated(linear, masks, leave=mine, hold=[p for p in hold if p not in mine]),
        with_=cross_validated(linear, masks, hold=hold),
        rivals=rivals,
        separation=separation,
        at_least=at_least,
        foretold=elsewhere(search, k),
    )


def _needless(search: Fit, k: int, judged: Mapping[Key, Judged]) -> bool:
    """Whether a claim about a tooth has a size that may as well be none, where another one about that tooth is named:
    it mends the form of that one."""
    claims, at = search.model.claims, search.linear.layout.claims[k]
    mine = claims[k]
    std = math.sqrt(float(search.linear.system.covariance[at, at][0, 0]))
    if mine.place.tooth is None or abs(mine.values[0]) > TOLD_SIZE * std:
        return False
    there = [one for j, one in enumerate(claims) if j != k and one.key in judged]
    return any((one.place.gear, one.place.tooth) == (mine.place.gear, mine.place.tooth) for one in there)


def _declared(comparison: Comparison, model: Model) -> Rms:
    """Rms in mm of the declared simulation's misfit, about the set's common mean where means compare."""
    left = [one.residual for one in comparison.aligned]
    compared = [one.samples.counted for one in model.observed]
    common = [residual for residual, c in zip(left, compared, strict=True) if c]
    mean = float(np.mean(np.concatenate(common))) if common else 0.0
    about = [r - (mean if c else float(np.mean(r))) for r, c in zip(left, compared, strict=True)]
    rms = float(np.sqrt(np.mean(np.concatenate(about) ** 2)))
    return Rms(seen=rms, unseen=rms)


def _shaped(search: Fit) -> bool:
    return any(one.place.tooth is not None and one.physics.shaped for one in search.model.claims)


def _held_out_by(search: Fit, *, jumped: bool) -> str:
    observed = search.model.observed
    if not all(bool(np.any(~one.fit)) for one in observed):
        return "nothing could be held out"
    if jumped:
        way = "every other block between jumps, and of recordings without any, whole hunting cycles"
    elif search.model.scope.run_ups:
        way = "every other turn of what runs up or down, and of other recordings whole hunting cycles"
    elif all(one.whole for one in observed):
        way = "whole hunting cycles"
    else:
        way = "every other of eight blocks, since a recording holds less than two hunting cycles"
    return way + ("; where a tooth's pit begins and ends is held as all of them have it" if _shaped(search) else "")
