"""What no claim explains: what stands out of the rest at the end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import EVERY_MESH, Cause, Curve, Entry
from gearpoly.compare.locate import locate
from gearpoly.compare.noise import Noise
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.compare.template import templates_of
from gearpoly.diagnose.fidelity import BY_LAWS, CORNER, OTHERS_BY_LAWS
from gearpoly.diagnose.foreign import found_alone, is_foreign, stands
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.scan import Candidate
from gearpoly.diagnose.search import Search
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.unnamed import EVEN
from gearpoly.diagnose.verdict import Finding
from gearpoly.infer.load_wave import LOAD_WAVE
from gearpoly.infer.prior import kind_of
from gearpoly.physics.base import Claim
from gearpoly.units import UM


def unexplained(search: Search, comparison: Comparison) -> tuple[Entry, ...]:
    """What neither the claims nor the as-built teeth explain: foreign waves, and whatever stands out of the rest."""
    model, linear, layout = search.model, search.linear, search.linear.layout
    # What is left of teeth that were fitted is little, of teeth that were declared ideal nothing.
    gears = tuple(
        GearKnown(z=known.z, uncertainty=None if known.ideal else 1e-4, zero=known.zero, direction=known.direction)
        for known in comparison.gears
    )
    # The foreign waves are put back: they are to be found again, with their size. Not those which turned out to be
    # teeth as they were built: their size is whatever the teeth leave open.
    x = linear.system.solution.copy()
    for places in found_alone(model.strangers, layout.foreign):
        if stands(linear.system, places):
            x[places] = 0.0
    residuals = []
    # Pairs are taken to share as the fitted ones do: without load that is another matter than for declared teeth, which
    # touch all at once.
    fitted = templates_of(
        model.assembled(),
        [replace(scene.samples.condition, varies=0.0) for scene in search.scenes],
    )
    left = [target - columns @ x for columns, target in zip(linear.columns, linear.target, strict=True)]
    for one, scene, rest, template in zip(comparison.aligned, search.scenes, left, fitted, strict=True):
        residuals.append(
            AlignedResidual(
                theta_1=scene.samples.theta_1,
                theta_2=scene.samples.theta_2,
                residual=rest,
                z_2=comparison.gears[1].z,
                time_s=one.time_s,
                backward=one.cleaned.backward,
                torque=one.torque,
                speed=one.speed,
                flank=one.flank,
                sharing=template.sharing,
                coarse=one.coarse,
                contact=template.sharing.contact,
            )
        )
    pair = comparison.assembled.pair
    found = locate(
        residuals,
        gears=(gears[0], gears[1]),
        floor=pair.chord_noise + max(template.error for template in fitted),
        numbered=comparison.alignment.numbered,
    )
    return tuple(
        entry
        for entry in found.entries
        if entry.companion_of is None
        and not _claimed(entry, model)
        and not _by_law(entry, search)
        and not _by_grade(entry, max(model.scope.form))
        and not _by_colour(entry, model, search.noises)
    )


PULSES = "a torque that pulses with that shaft"

FOREMOST = 4
"""Places at a gear that are told where all of its teeth are wrong."""


SHARP = 15.0
"""Standard errors by which a line is above the noise about it whatever colour that has: its power is a hundred times
what was read off the lines beside it."""


def located_on(comparison: Comparison, gear: int) -> list[Entry]:
    """The foremost of what ``compare`` located at single teeth and whole orders of a gear (0, 1), before anything was
    fitted."""
    name = ("driving", "driven")[gear]
    mine = [one for one in comparison.located.entries if one.gear == name]
    whole = [one for one in mine if one.tooth is not None or (one.order is not None and float(one.order).is_integer())]
    return whole[:FOREMOST]


def located_at_every_mesh(comparison: Comparison) -> list[Entry]:
    """The foremost of what ``compare`` located at every mesh, before anything was fitted."""
    return [one for one in comparison.located.entries if one.kind in EVERY_MESH][:FOREMOST]


def taken_back(comparison: Comparison, claim: Claim, rms: float) -> Entry:
    """Where a claim was that unseen data did not bear out, ``rms`` in mm what it did: the place alone, and no cause."""
    place, physics = claim.place, claim.physics
    recordings = place.recordings or tuple(range(len(comparison.aligned)))
    entry = Entry(kind="mesh_phase", phase=(0.0, 1.0), rms_um=rms / UM, p_value=1.0, recordings=recordings)
    if kind_of(claim) == "means":
        # Means compare with that of the first recording.
        return replace(entry, kind="condition", phase=None, recordings=recordings[1:] or recordings)
    if physics.mean_tooth:
        return entry
    if physics.slow or place.gear is None:
        return replace(entry, kind="time", phase=None, hz=0.0)
    entry = replace(entry, gear="driving" if place.gear == 0 else "driven", phase=None)
    if place.tooth is None:
        return replace(entry, kind="shaft_order", order=float(place.order or 1))
    told = place.tooth if comparison.alignment.numbered[place.gear] else None
    return replace(entry, kind="tooth", tooth=told, encoder_deg=comparison.gears[place.gear].encoder_deg(place.tooth))


def with_causes(
    comparison: Comparison,
    entries: Sequence[Entry],
    unearned: Sequence[Unearned],
    causes: Sequence[tuple[Cause, ...]],
    curves: Sequence[Curve],
) -> tuple[Entry, ...]:
    """The ``entries`` with the ``causes`` of every place that did not earn a name, and the ``curves`` of the flanks
    there; where none of them is at such a place, one more."""
    out = list(entries)
    for one, could_be in zip(unearned, causes, strict=True):
        place = taken_back(comparison, one.claim, one.rms)
        same = [k for k, entry in enumerate(out) if _same_place(entry, place)]
        there = None if one.posterior is None else 1.0 - one.posterior.nothing
        if not same and (one.seen or (there is not None and there < 1.0 - EVEN)):
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


def _same_place(one: Entry, other: Entry) -> bool:
    """Whether two entries are about one wave, one tooth, every mesh, or a slow course."""
    if one.kind in EVERY_MESH and other.kind in EVERY_MESH:
        return True
    if one.kind != other.kind or one.gear != other.gear:
        return False
    if one.kind == "tooth":
        near = one.encoder_deg is not None and one.encoder_deg == other.encoder_deg
        return near or (one.tooth is not None and one.tooth == other.tooth)
    return one.order == other.order and one.hz == other.hz and one.moment is None


def slow_or_sudden(search: Search, looked_at: Sequence[Candidate]) -> tuple[Entry, ...]:
    """What is too large for chance and slow, of the candidates last ``looked_at``, where a jump explains as much: no
    physics of the catalogue jumps, so it has no name."""
    for one in looked_at:
        if not one.claim.physics.slow or not search.beyond_chance(one) or not search.sudden(one):
            continue
        curves = search.model.change(search.scenes, one.claim, one.claim.values)
        amplitude = 0.5 * max(float(np.ptp(curve)) for curve in curves) / UM
        return (
            Entry(
                kind="time",
                hz=0.0,
                amplitude_um=amplitude,
                std_um=amplitude / math.sqrt(one.gain),
                rms_um=search.size(one) / UM,
                recordings=one.claim.place.recordings or tuple(range(len(curves))),
                p_value=math.exp(min(0.0, one.log_chance(tests=search.looked.tests(one.claim)))),
                label="slow",
                rivals=("a jump",),
                gain=one.gain,
            ),
        )
    return ()


def _by_law(entry: Entry, search: Search) -> bool:
    """Whether an entry is below what compliance laws and corner contact differ by, magnified by a resonance if there is
    one: that repeats with the pair."""
    if is_foreign(entry) or entry.burst is not None:
        return False
    size = abs((entry.amplitude_um if entry.amplitude_um is not None else entry.rms_um) or 0.0)
    part = BY_LAWS.get(entry.kind, OTHERS_BY_LAWS)
    if entry.kind == "tooth" and entry.phase is not None and entry.phase[1] - entry.phase[0] < CORNER:
        part = BY_LAWS["mesh_phase"]
    swings = 1.0 if entry.order is None else search.magnified(entry.order, entry.gear, entry.recordings)
    return size < part * swings * search.deflection / UM


def _by_colour(entry: Entry, model: Model, levels: list[Noise]) -> bool:
    """Whether an entry may be coloured noise: a line below the noise in recordings that never repeat themselves, if not
    so sharp that no colour would be."""
    if any(model.observed[k].whole for k in entry.recordings) or entry.kind not in ("shaft_order", "time"):
        return False
    if entry.moment is not None or entry.burst is not None:
        return False
    if entry.order is not None and float(entry.order).is_integer():
        return False
    if abs(entry.amplitude_um or 0.0) > SHARP * (entry.std_um or math.inf):
        return False
    return abs(entry.amplitude_um or 0.0) < min(levels[k].level for k in entry.recordings) / UM


def _by_grade(entry: Entry, form: float) -> bool:
    """Whether an entry is the same at every mesh and below the ``form`` in um that a grade leaves open."""
    size = entry.amplitude_um if entry.amplitude_um is not None else entry.rms_um
    return entry.kind in ("mesh_order", "mesh_phase") and abs(size or 0.0) < form


def _claimed(entry: Entry, model: Model) -> bool:
    """Whether a claim stands at the same tooth already: what is left of it is form, not something else."""
    for claim in model.claims:
        if entry.kind == "tooth" and entry.gear == claim.place.gear_name and entry.tooth == claim.place.tooth:
            return True
    return False


def not_excluded(search: Search, findings: tuple[Finding, ...]) -> tuple[str, ...]:
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
