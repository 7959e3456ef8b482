"""Keys of the pair file of which recordings bear out another value: profile shifts, pressure angle, addendum.

Loaded teeth of another shape bend otherwise and hand over elsewhere, at every mesh alike. The pair is simulated with
other values of one key at a time, all that is open fitted beside each; they have to fit where no physics of all teeth
does. Unloaded involutes run alike whatever their shift: only corners tell, and wear of tips does what those do.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.arguments import GEARS
from gearpoly.diagnose.budget import Step
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.placing import TRIAL_ROUNDS, placed
from gearpoly.diagnose.relieved import relieved
from gearpoly.diagnose.scan import Candidate, polished, scan
from gearpoly.diagnose.shortened import PLACING_SAMPLES, shortened
from gearpoly.diagnose.tooth_forms import has_forms, with_forms, with_open_forms
from gearpoly.errors import GearpolyError
from gearpoly.files.models import PairFile
from gearpoly.infer.unknown import mesh_curves
from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.physics.base import Claim, Physics
from gearpoly.physics.place import Place
from gearpoly.units import FloatArray

PROFILE_SHIFTS_TRIED, FINER_PROFILE_SHIFTS, FINEST_PROFILE_SHIFT = (
    (0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
    (0.05, 0.025),
    0.0125,
)
"""Profile shift that the driving gear has more, or less, than the file says, and the driven gear less, or more; then so
much beside the best. At another sum the axes stand apart, which is a physics of its own."""

WORSE_IN_A_ROW = 2
"""Steps in a row, each of which leaves more than the one before, after which no larger shift is tried that way: the
misfit of a pair that lacks a shift falls from both sides towards it. With 16 000 samples all twelve took 20 s of 70."""

WORTH_FINER = 1.0
"""Part of what the stated keys leave that another shift may leave for shifts close by to be tried: the right one lies
within half a step of one that was, and what it leaves falls towards it."""

ANGLES = (14.5, 17.5, 20.0, 22.5, 25.0)
"""Pressure angles in deg that racks have: 20 by ISO 53:1998, the others a judgement."""

ADDENDA = (0.8, 1.0, 1.2)
"""Addenda over the module of stub, standard and long teeth. A judgement."""

AMISS = 0.1
"""Misfit beyond noise over noise's own from which on another value is looked for, and below which a physics does as
well: of pairs with another shift or angle 0.16 to 3.2 was left, of 14 of ordinary ones 0.05 at most. An angle that is
off by 2.5 deg is told from axes that stand 110 to 180 um apart by nothing: it is not taken."""

OF_RIVALS = 0.1
"""Part that the right value may leave of what the best physics of all teeth does: the right shifts left 0.02 to 0.04 of
what the stated ones did, and reliefs two thirds of that or more."""

OTHER_KEYS_LEFT_PART = 0.3
"""Part of what the stated keys leave that others may leave at a first look, and closely, to be asked further: the right
ones of three pairs left 0.02 of it or nothing, the likeliest of pairs with their stated shape 0.5 and more. With a pit
of 16 um, asking on took 50 s of 70 before anything was searched."""

RIVALS = 2
"""Physics of all teeth that are fitted in its place, beside reliefs of both gears."""

OF_MISFIT = 0.3
"""Part of the misfit that curves which are the same at every mesh have to explain, or what is amiss is a matter of
teeth: it was 0.57 to 0.89 in four pairs with another shift, 0.13 in one with a pit."""

Begin = Callable[[PairFile], tuple[Model, list[FloatArray]]]
"""The working state, and the columns of what no pair makes, of a pair that another file declares."""


@dataclass(frozen=True, kw_only=True)
class OtherKeys:
    """A pair ``file`` with other values of one key, and what to tell of that; ``shift``: by how much more the profile
    of the driving gear is shifted, if that is the key."""

    file: PairFile
    says: str
    shift: float | None = None


def misdeclared(
    file: PairFile, begin: Begin, step: Step, *, stated: Begin, formed: bool
) -> tuple[OtherKeys | None, Claim | None]:
    """Other keys of the pair ``file`` that leave hardly anything of what is amiss at every mesh, where no physics does,
    and a physics that does; None where there is none, or time is over. ``stated``: the state of the file as it stands,
    its teeth placed, and ``formed``, whether they were found to differ in form; at a first look no teeth are placed."""
    step("holding the keys of the pair file against every mesh")
    roughly = _fit(begin, file, close=False)
    if roughly is None or roughly.over or _beyond(roughly, by=roughly) < AMISS:
        return None, None
    if not any(scene.bends for scene in roughly.scenes):
        return None, None
    plain = _fit(stated, file, close=True, formed=formed)
    # What a closer fit of the stated keys, or a physics, explains needs no other keys: nothing more is simulated then.
    if plain is None or _beyond(plain, by=plain) < AMISS or _of_every_mesh(plain) < OF_MISFIT:
        return None, None
    likeliest = _likeliest(file, begin, by=roughly)
    if likeliest is None:
        return None, None
    beside: list[Fit | None] = [plain]
    for claims in _rivals(plain):
        fit = _fit(stated, file, close=True, beside=claims, formed=formed)
        beside.append(fit)
        if fit is not None and _beyond(fit, by=fit) < AMISS:
            # To first order another one may seem to gain more, and stand when this one's turn comes.
            return None, fit.model.claims[0] if len(claims) == 1 else None
        if plain.over:
            return None, None
    found = _closely(file, likeliest, begin)
    if (
        found is None
        or plain.over
        or _beyond(found[1], by=found[1]) > OTHER_KEYS_LEFT_PART * _beyond(plain, by=found[1])
    ):
        return None, None
    best, fit = found
    freer = has_forms(fit.model) and not formed
    for claims in ((), *_rivals(plain)) if freer else ():
        # With freedom that the stated keys were not given, others fit better: of a sound pair of grade 10 a profile
        # shift of 0.44 was made so.
        beside.append(one := _fit(stated, file, close=True, beside=claims, formed=True))
        if one is None or plain.over or _beyond(one, by=one) < AMISS:
            return None, None
    for claims in _others(plain):
        # What would change the file has to be better than every physics: 13 um of wear were taken for a profile shift.
        other = _fit(stated, file, close=True, beside=claims, formed=formed or freer)
        beside.append(other)
        if other is not None and _beyond(other, by=other) < AMISS:
            return None, other.model.claims[0]
        if plain.over:
            return None, None
    missing = min(_beyond(one, by=fit) for one in beside if one is not None)
    return (best if _beyond(fit, by=fit) < OF_RIVALS * missing else None), None


def _of_every_mesh(fit: Fit) -> float:
    """Part of the misfit beyond noise that curves over the mesh explain, one for each condition."""
    by_condition = mesh_curves(fit.scenes)[-1].columns
    white = [noise.whitened(one) for noise, one in zip(fit.linear.noises, by_condition, strict=True)]
    score, information = fit.linear.system.scores(white)
    gain = float(score @ np.linalg.lstsq(information, score, rcond=None)[0])
    return gain / max(fit.linear.system.beyond, 1e-300)


def _closely(file: PairFile, likeliest: OtherKeys, begin: Begin) -> tuple[OtherKeys, Fit] | None:
    """The likeliest keys, or those close by that fit better, with their fit; None where they do not run."""
    fit = _fit(begin, likeliest.file, close=True)
    if fit is None:
        return None
    best = likeliest, fit
    for one in _beside(file, likeliest, FINEST_PROFILE_SHIFT):
        other = None if fit.over else _fit(begin, one.file, close=True)
        if other is not None and _beyond(other, by=fit) < _beyond(best[1], by=fit):
            best = one, other
    return best


def _likeliest(file: PairFile, begin: Begin, *, by: Fit) -> OtherKeys | None:
    """The keys that leave least, to a first look; None where none leave ``OTHER_KEYS_LEFT_PART`` of what the stated
    ones do."""
    tried: dict[float, OtherKeys] = {}
    stated = _beyond(by, by=by)
    for way in other_keys(file):
        left, worse = stated, 0
        for one in way:
            before, left = left, _try(tried, one, begin, by=by)
            worse = worse + 1 if left > before else 0
            if one.shift is not None and worse == WORSE_IN_A_ROW:
                break
    for apart in FINER_PROFILE_SHIFTS if tried and min(tried) < WORTH_FINER * stated else ():
        for one in _beside(file, tried[min(tried)], apart):
            _try(tried, one, begin, by=by)
    return tried[min(tried)] if tried and min(tried) < OTHER_KEYS_LEFT_PART * stated else None


def other_keys(file: PairFile) -> list[list[OtherKeys]]:
    """The values that are tried first, one key at a time: profile shifts either way, angles, addenda."""
    shifts = [[_shifted(file, sense * shift) for shift in PROFILE_SHIFTS_TRIED] for sense in (1.0, -1.0)]
    return [*shifts, list(_both(file, "pressure_angle_deg", ANGLES)), list(_both(file, "addendum", ADDENDA))]


def _rivals(stated: Fit) -> Iterator[Sequence[Claim]]:
    """Physics of all teeth that may do what other keys would: reliefs of both gears, and those that gain most."""
    if both := relieved(stated.model):
        yield both
    for one in _of_all_teeth(stated)[:RIVALS]:
        yield [polished(stated.model, stated.scenes, stated.linear, one, roughly=True).claim]


def _others(stated: Fit) -> Iterator[Sequence[Claim]]:
    """All others of them, of either gear; what would have the wrong sign beside the stated keys, where teeth have
    settled for them, at its ordinary size."""
    found = _candidates(stated)
    tried = {one.claim.key for one in _of_all_teeth(stated)[:RIVALS]}
    best = {(one.claim.physics.name, one.claim.place.gear): one for one in reversed(found)}
    for one in sorted(best.values(), key=lambda one: -one.gain):
        if one.claim.key not in tried:
            yield [polished(stated.model, stated.scenes, stated.linear, one, roughly=True).claim]
    for physics, place in reversed(_places(stated)):
        if (physics.name, place.gear) not in best:
            yield [Claim(physics=physics, place=place, values=(*physics.ordinary, *place.shape))]


def _of_all_teeth(stated: Fit) -> list[Candidate]:
    """Of each physics of all teeth the candidate that gains most, the best first."""
    best = {one.claim.physics.name: one for one in reversed(_candidates(stated))}
    return sorted(best.values(), key=lambda one: -one.gain)


def _candidates(stated: Fit) -> list[Candidate]:
    """Candidates of all physics of all teeth, that which gains most first."""
    found, _ = scan(stated.model, stated.scenes, stated.linear, only=_places(stated))
    return found


def _places(stated: Fit) -> list[tuple[Physics, Place]]:
    """All physics of all teeth at all their places."""
    scope = stated.model.scope
    return [
        (physics, place)
        for physics in stated.model.method.physics
        if physics.mean_tooth
        for place in filter(scope.shows, physics.places(scope))
    ]


def _try(tried: dict[float, OtherKeys], one: OtherKeys, begin: Begin, *, by: Fit) -> float:
    """Add what ``one`` leaves under the noise of another fit to what the others left; infinite where it cannot run."""
    fit = None if by.over else _fit(begin, one.file, close=False)
    if fit is None:
        return math.inf
    left = _beyond(fit, by=by)
    tried.setdefault(left, one)
    return left


def _fit(
    begin: Begin, file: PairFile, *, close: bool, beside: Sequence[Claim] = (), formed: bool | None = None
) -> Fit | None:
    """A short fit of the pair of a ``file`` with claims ``beside``, a rough or a ``close`` one, in which teeth have
    forms of their own where that is likelier, or as ``formed`` says where that is known: of a file with 20 deg for 25
    these were all that was left. None where it cannot run."""
    few, rounds = (PLACING_SAMPLES[-1], TRIAL_ROUNDS[-1]) if close else (PLACING_SAMPLES[0], TRIAL_ROUNDS[0])
    try:
        model, columns = shortened(*begin(file), few=few)
        if close:
            if formed is None:
                model = with_forms(model, columns, lambda _: None)
            elif formed and not has_forms(model):
                model = with_open_forms(model)
        model = replace(model, claims=tuple(beside))
        if close and not model.phased and not model.stated:
            model = placed(model, columns, lambda _: None)
        return Fit.begun(model, columns, lambda _: None, trial=rounds)
    except GearpolyError:
        return None


def _beyond(fit: Fit, *, by: Fit) -> float:
    """Misfit beyond noise over noise's own of a ``fit``, under the noise of another one."""
    system = fit.linear.under(by.noises).system
    return (system.misfit - system.samples) / system.samples


def _beside(file: PairFile, best: OtherKeys, apart: float) -> list[OtherKeys]:
    """Profile shifts on either side of the ``best``."""
    return [] if best.shift is None else [_shifted(file, best.shift + by) for by in (-apart, apart)]


def _shifted(file: PairFile, shift: float) -> OtherKeys:
    """The pair with so much more profile shift of the driving gear, and so much less of the driven one."""
    stated = [float(gear_section(file, gear).profile_shift) for gear in (0, 1)]
    now = [stated[0] + shift, stated[1] - shift]
    other = on_gear(on_gear(file, 0, profile_shift=now[0]), 1, profile_shift=now[1])
    return OtherKeys(file=other, says=_says("profile_shift", now, stated), shift=shift)


def _both(file: PairFile, key: str, values: Sequence[float]) -> Iterator[OtherKeys]:
    """The pair with a ``key`` of both gears at each of ``values`` that it does not state."""
    stated = [float(getattr(gear_section(file, gear), key)) for gear in (0, 1)]
    for value in values:
        if any(one != value for one in stated):
            other = on_gear(on_gear(file, 0, **{key: value}), 1, **{key: value})
            yield OtherKeys(file=other, says=_says(key, [value, value], stated))


def _says(key: str, now: Sequence[float], stated: Sequence[float]) -> str:
    """What the engineer should check."""
    now_each, stated_each = (
        f"{one[0]:.4g}" if one[0] == one[1] else " and ".join(f"{v:.3f} ({g})" for v, g in zip(one, GEARS, strict=True))
        for one in (now, stated)
    )
    return (
        f"with {key} {now_each} the recordings fit, and with {stated_each} as in the pair file they do not: it was "
        f"taken so, and no physics is claimed for the difference; check {key} in the drawing"
    )
