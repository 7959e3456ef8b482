"""What no claim explains: what stands out of the rest at the end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.compare.beside import Aligned, Comparison
from gearpoly.compare.entries import EVERY_MESH_KINDS, Cause, Curve, Entry
from gearpoly.compare.take import SAME_WAVE_LINES
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.floors import size_of
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.residuals import locate_residuals, residuals_of, stands_out
from gearpoly.diagnose.scan import Candidate
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.unnamed import UNCLAIMED_PROBABILITY
from gearpoly.diagnose.verdict import Finding
from gearpoly.diagnose.weigh import as_sudden, beyond_chance
from gearpoly.infer.chance import probability_by_chance
from gearpoly.infer.load_wave import LOAD_WAVE
from gearpoly.infer.prior import kind_of
from gearpoly.physics.base import Claim
from gearpoly.units import UM


def unexplained(search: Fit, comparison: Comparison) -> tuple[Entry, ...]:
    """What neither the claims nor the as-built teeth explain: foreign waves, and whatever stands out of the rest. Where
    time is over, the strongest of it."""
    found = locate_residuals(search, comparison, residuals_of(search), over=lambda: search.over)
    return tuple(entry for entry in found.entries if stands_out(entry, search) and not _claimed(entry, search.model))


PULSES = "a torque that pulses with that shaft"

BY_TURNING = 0.9
"""Part of the power by which one recording differs from another that turns with shafts and teeth, and that waves and
teeth told of it have, from which on they tell of that difference. A judgement: in three recordings of a torque that
pulses, one wave had been told as two conditions as well."""

FOREMOST = 4
"""Places at a gear that are told where all of its teeth are wrong."""


def located_on(comparison: Comparison, gear: int) -> list[Entry]:
    """The foremost of what ``compare`` located at single teeth and whole orders of a gear (0, 1), before anything was
    fitted."""
    name = ("driving", "driven")[gear]
    mine = [one for one in comparison.located.entries if one.gear == name]
    whole = [one for one in mine if one.tooth is not None or (one.order is not None and float(one.order).is_integer())]
    return whole[:FOREMOST]


def located_at_every_mesh(comparison: Comparison) -> list[Entry]:
    """The foremost of what ``compare`` located at every mesh, before anything was fitted."""
    return [one for one in comparison.located.entries if one.kind in EVERY_MESH_KINDS][:FOREMOST]


def located_by_load(comparison: Comparison) -> tuple[Entry, ...]:
    """The foremost of what ``compare`` located where a load bends teeth otherwise: at every mesh, and between
    recordings."""
    kinds = ("condition", *EVERY_MESH_KINDS)
    return tuple(one for one in comparison.located.where if one.kind in kinds)[:FOREMOST]


def untold(comparison: Comparison, told: Sequence[Entry]) -> tuple[Entry, ...]:
    """Located places that are not ``told`` and that teeth within their grade could not make, those with most of the
    mismatch first. Teeth that nobody inspected take what no claim is made of, so where time was over before one could
    be made, what the teeth took is told as it was located. Bursts they do not take: one that was located beside
    declared teeth, and is gone beside fitted ones, was none."""
    lasting = (one for one in comparison.located.where if one.burst is None)
    places = (one for one in lasting if one.companion_of is None and not one.as_built)
    return tuple(one for one in places if not any(same_place(one, other) for other in told))


def taken_back(comparison: Comparison, claim: Claim, rms: float) -> Entry:
    """Where a claim was that unseen data did not bear out, ``rms`` in mm what it did to all samples: the place alone,
    and no cause. Of a tooth the rms over its own pitch is told, as of teeth that were located."""
    place, physics = claim.place, claim.physics
    recordings = place.recordings or tuple(range(len(comparison.aligned)))
    entry = Entry(kind="mesh_phase", phase=(0.0, 1.0), rms_um=rms / UM, p_value=1.0, recordings=recordings)
    if kind_of(claim) == "means":
        # Means compare with that of the first recording.
        return replace(entry, kind="condition", phase=None, recordings=recordings[1:] or recordings)
    if physics.mean_tooth:
        return entry
    if physics.slow or place.gear is None:
        return replace(entry, kind="drift", phase=None)
    entry = replace(entry, gear="driving" if place.gear == 0 else "driven", phase=None)
    if place.tooth is None:
        return replace(entry, kind="shaft_order", order=float(place.order or 1))
    told, known = place.tooth if comparison.alignment.numbered[place.gear] else None, comparison.gears[place.gear]
    own = math.sqrt(known.z) * rms / UM
    return replace(entry, kind="tooth", tooth=told, encoder_deg=known.encoder_deg(place.tooth), rms_um=own)


def with_causes(
    comparison: Comparison,
    entries: Sequence[Entry],
    unearned: Sequence[Unearned],
    causes: Sequence[tuple[Cause, ...]],
    curves: Sequence[Curve],
) -> tuple[Entry, ...]:
    """The ``entries`` with the ``causes`` of every place that did not earn a name, and the ``curves`` of the flanks
    there; where none of them is at such a place, one more."""
    out, z = list(entries), [gear.z for gear in comparison.gears]
    for one, could_be in zip(unearned, causes, strict=True):
        place = taken_back(comparison, one.claim, one.rms)
        same = [k for k, entry in enumerate(out) if same_place(entry, place) or _of_both_shafts(entry, place, z)]
        if place.kind == "shaft_order":
            # How large a wave is was told before anything was claimed of it.
            place = next((entry for entry in comparison.located.entries if same_place(entry, place)), place)
        there = None if one.posterior is None else 1.0 - one.posterior.nothing
        if not same and (one.seen or (there is not None and there < 1.0 - UNCLAIMED_PROBABILITY)):
            continue
        if not same:
            out.append(place)
        at = same[0] if same else -1
        mine = tuple(c for c in curves if (c.gear, c.tooth) == (one.claim.place.gear, one.claim.place.tooth))
        # What several claims about one tooth could have been stands once.
        before = {(cause.physics, cause.gear) for cause in out[at].could_be}
        more = tuple(cause for cause in could_be if (cause.physics, cause.gear) not in before)
        there = max((chance for chance in (out[at].probability, there) if chance is not None), default=None)
        if one.claim.physics is LOAD_WAVE:
            out[at] = replace(out[at], rivals=(*out[at].rivals, PULSES))
        out[at] = replace(out[at], could_be=(*out[at].could_be, *more), probability=there, curves=mine)
    return tuple(out)


def same_place(one: Entry, other: Entry) -> bool:
    """Whether two entries are about one wave, one tooth, every mesh, or a slow course."""
    if one.kind in EVERY_MESH_KINDS and other.kind in EVERY_MESH_KINDS:
        return True
    if one.kind != other.kind or one.gear != other.gear:
        return False
    if one.kind == "tooth":
        near = one.encoder_deg is not None and one.encoder_deg == other.encoder_deg
        return near or (one.tooth is not None and one.tooth == other.tooth)
    return one.order == other.order and one.hz == other.hz and one.moment is None


def _of_both_shafts(one: Entry, other: Entry, z: Sequence[int]) -> bool:
    """Whether two entries are one wave, told as an order of either shaft: twice per turn of 24 teeth is three times per
    turn of 36."""
    if one.kind != "shaft_order" or other.kind != "shaft_order" or one.order is None or other.order is None:
        return False
    z_one, z_other = (z[0] if entry.gear == "driving" else z[1] for entry in (one, other))
    return math.isclose(one.order * z_other, other.order * z_one, rel_tol=1e-9)


def each_once(entries: Sequence[Entry], comparison: Comparison) -> tuple[Entry, ...]:
    """The ``entries`` of the recordings of a ``comparison``, each wave, tooth and stretch once, as the first that tells
    of it does: what was located before anything was fitted may stand beside what a fit left of it, 4.000 and 4.008 um
    of one belt. Nor is it told once more that recordings differ, where they do by such a wave."""
    out: list[Entry] = []
    for entry in entries:
        if not any(_told_by(one, entry, comparison.aligned[entry.recordings[0]]) for one in out):
            out.append(entry)
    z = [gear.z for gear in comparison.gears]
    return tuple(one for one in out if one.kind != "condition" or not _turns(one, out, z))


def _turns(condition: Entry, told: Sequence[Entry], z: Sequence[int]) -> bool:
    """Whether what is ``told`` of a recording at shafts and teeth makes its difference from another one."""
    power = (condition.rms_um or 0.0) ** 2
    here = [one for one in told if one.gear is not None and set(condition.recordings) <= set(one.recordings)]
    # Where a wave grows, each recording has its own size of it.
    sizes = (max(abs(one.amplitude_um or 0.0), *(one.amplitude_um_by_recording or (0.0,))) for one in here)
    waves = sum(replace(one, amplitude_um=size).mean_square(*z) for one, size in zip(here, sizes, strict=True))
    return min((condition.turning_um or 0.0) ** 2, waves) > BY_TURNING * power


def _told_by(one: Entry, other: Entry, there: Aligned) -> bool:
    """Whether an entry tells of the wave, tooth, or stretch of another one in its recordings, the first of which is
    ``there``."""
    alike = {
        (entry.kind, entry.gear, entry.tooth, entry.encoder_deg, entry.phase, entry.moment, entry.burst, entry.parts)
        for entry in (one, other)
    }
    if len(alike) > 1 or not set(other.recordings) <= set(one.recordings) or other.kind == "condition":
        return False
    angle = there.theta_1 if other.gear == "driving" else there.theta_2
    turns, seconds = (
        float(np.ptp(angle)) / (2.0 * math.pi),
        0.0 if there.time_s is None else float(np.ptp(there.time_s)),
    )
    return _lines_apart(one.order, other.order, turns) + _lines_apart(one.hz, other.hz, seconds) < SAME_WAVE_LINES


def _lines_apart(one: float | None, other: float | None, span: float) -> float:
    """Independent lines between two frequencies over a ``span``; 0 where neither is one, inf where one is none."""
    if one is None or other is None:
        return 0.0 if one is other else math.inf
    return abs(one - other) * span


def each_with_probability(entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """The ``entries``, each with the probability that it is there at all: of those whose causes were not weighed as the
    chance of the search has it."""
    return tuple(
        replace(one, probability=probability_by_chance(one.p_value)) if one.probability is None else one
        for one in entries
    )


def slow_or_sudden(search: Fit, looked_at: Sequence[Candidate]) -> tuple[Entry, ...]:
    """What is too large for chance and slow, of the candidates last ``looked_at``, where a jump explains as much: no
    physics of the catalogue jumps, so it has no name."""
    for one in looked_at:
        if not one.claim.physics.slow or not beyond_chance(search, one) or not as_sudden(search, one):
            continue
        curves = search.model.change(search.scenes, one.claim, one.claim.values)
        amplitude = 0.5 * max(float(np.ptp(curve)) for curve in curves) / UM
        return (
            Entry(
                kind="drift",
                amplitude_um=amplitude,
                std_um=amplitude / math.sqrt(one.gain),
                rms_um=size_of(search, one) / UM,
                recordings=one.claim.place.recordings or tuple(range(len(curves))),
                p_value=math.exp(min(0.0, one.log_chance(tests=search.looked.tests(one.claim)))),
                label="slow",
                rivals=("a jump",),
                gain=one.gain,
            ),
        )
    return ()


def _claimed(entry: Entry, model: Model) -> bool:
    """Whether a claim stands at the same tooth already: what is left of it is form, not something else."""
    for claim in model.claims:
        if entry.kind == "tooth" and entry.gear == claim.place.gear_name and entry.tooth == claim.place.tooth:
            return True
    return False


def not_excluded(search: Fit, findings: tuple[Finding, ...]) -> tuple[str, ...]:
    """What these recordings could not have shown, in words."""
    scope, out = search.model.scope, []
    if len(set(scope.torques)) == 1 and max(scope.torques) == 0.0:
        out.append("anything that needs load (cracks, friction, misalignment, deflection): no recording is loaded")
    elif len(set(scope.torques)) == 1:
        out.append("mean-tooth effects that one torque cannot tell from compliance (crowning, relief, misalignment)")
    if len(set(scope.flanks)) == 1:
        other = "coast" if scope.flanks[0] == "drive" else "drive"
        out.append(f"anything that shows on the {other} flank only (thickness, its pitch)")
    if not scope.several_speeds:
        out.append("resonances: all recordings were made at one speed")
    if not scope.counted or len(scope.torques) == 1:
        out.append("offsets (wind-up, centre distance, wear of all flanks): a single mean compares with nothing")
    return tuple(out)
