"""Keys of the pair file of which recordings bear out another value: profile shifts, pressure angle, addendum.

Loaded teeth of another shape bend otherwise and hand over elsewhere, at every mesh alike. The pair is simulated with
other values of one key at a time, all that is open fitted beside each; they have to fit where no physics of all teeth
does. Unloaded involutes run alike whatever their shift: only corners tell, and wear of tips does what those do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import EVERY_MESH, Entry
from gearpoly.diagnose.budget import Step
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.placing import FEW, TRIALS, shortened
from gearpoly.diagnose.relieved import relieved
from gearpoly.diagnose.scan import polished, scan
from gearpoly.errors import GearpolyError
from gearpoly.files.models import PairFile
from gearpoly.keys.edit import GEARS, gear_section, on_gear
from gearpoly.physics.base import Claim
from gearpoly.units import FloatArray

SHIFTS, FINER, FINEST = tuple(0.1 * k for k in range(-6, 7) if k), (0.05, 0.025), 0.0125
"""Profile shift that the driving gear has more than the file says, and the driven gear less: from -0.6 to 0.6, then so
much beside the best. At another sum the axes stand apart, which is a physics of its own."""

ANGLES = (14.5, 17.5, 20.0, 22.5, 25.0)
"""Pressure angles in deg of racks on sale (ISO 53, AGMA, older American and aviation practice)."""

ADDENDA = (0.8, 1.0, 1.2)
"""Addenda of stub, standard and long teeth over the module."""

DOUBTED = 0.1
"""Misfit beyond noise over noise's own from which on another value is looked for, and below which a physics does as
well: of pairs with another shift or angle 0.16 to 3.2 was left, of 14 of ordinary ones 0.05 at most. An angle that is
off by 2.5 deg is told from axes that stand 110 to 180 um apart by nothing: it is not taken."""

OF_RIVALS = 0.1
"""Part that the right value may leave of what the best physics of all teeth does: the right shifts left 0.02 to 0.04 of
what the stated ones did, and reliefs two thirds of that or more."""

RIVALS = 2
"""Physics of all teeth that are fitted in its place, beside reliefs of both gears."""

HARMONICS, MOSTLY = 8, 0.3
"""Harmonics of the mesh of a curve that is the same at every mesh, and the part of the misfit that such curves have to
explain: what is not amiss at every mesh alike is a matter of teeth."""

FOREMOST = 2
"""Places at every mesh that are told where another key explains them."""

Begin = Callable[[PairFile], tuple[Model, list[FloatArray]]]
"""The working state, and the columns of what no pair makes, of a pair that another file declares."""


@dataclass(frozen=True, kw_only=True)
class OtherKeys:
    """A pair ``file`` with other values of one key, and what to tell of that; ``shift``: by how much more the profile
    of the driving gear is shifted, if that is the key."""

    file: PairFile
    says: str
    shift: float | None = None


def every_mesh(comparison: Comparison) -> list[Entry]:
    """Where the recordings differ from the stated pair at every mesh, the foremost first."""
    return [one for one in comparison.located.entries if one.kind in EVERY_MESH][:FOREMOST]


def misdeclared(file: PairFile, begin: Begin, step: Step) -> OtherKeys | None:
    """Other keys of the pair ``file`` that leave hardly anything of what is amiss at every mesh, where no physics does;
    None where there are none. Raises what ``begin`` does for the file itself."""
    step("holding the keys of the pair file against every mesh")
    roughly = _fit(begin, file, close=False)
    if roughly is None or roughly.over or _beyond(roughly, by=roughly) < DOUBTED:
        return None
    if not any(scene.bends for scene in roughly.scenes):
        return None
    stated = _fit(begin, file, close=True)
    if stated is None or _of_every_mesh(stated) < MOSTLY:
        return None
    beside = [stated, *(_fit(begin, file, close=True, beside=claims) for claims in _rivals(stated))]
    if any(one is not None and _beyond(one, by=one) < DOUBTED for one in beside):
        return None
    found = _closely(file, _likeliest(file, begin, by=roughly), begin)
    if found is None or stated.over:
        return None
    best, fit = found
    missing = min(_beyond(one, by=fit) for one in beside if one is not None)
    return best if _beyond(fit, by=fit) < OF_RIVALS * missing else None


def _of_every_mesh(fit: Fit) -> float:
    """Part of the misfit beyond noise that curves over the mesh explain, one for each recording."""
    white = []
    for k, (scene, noise) in enumerate(zip(fit.scenes, fit.linear.noises, strict=True)):
        meshes = scene.samples.theta_2 / fit.model.scope.gears[1].tau
        angle = 2.0 * np.pi * np.outer(meshes, np.arange(1, HARMONICS + 1))
        curves = np.zeros((meshes.size, len(fit.scenes), 2 * HARMONICS))
        curves[:, k] = np.concatenate((np.cos(angle), np.sin(angle)), axis=1)
        white.append(noise.whitened(curves.reshape(meshes.size, -1)))
    score, information = fit.linear.system.scores(white)
    gain = float(score @ np.linalg.lstsq(information, score, rcond=None)[0])
    return gain / max(fit.linear.system.beyond, 1e-300)


def _closely(file: PairFile, likeliest: OtherKeys | None, begin: Begin) -> tuple[OtherKeys, Fit] | None:
    """The likeliest keys, or those close by that fit better, with their fit; None where they do not run."""
    fit = None if likeliest is None else _fit(begin, likeliest.file, close=True)
    if likeliest is None or fit is None:
        return None
    best = likeliest, fit
    for one in _beside(file, likeliest, FINEST):
        other = None if fit.over else _fit(begin, one.file, close=True)
        if other is not None and _beyond(other, by=fit) < _beyond(best[1], by=fit):
            best = one, other
    return best


def _likeliest(file: PairFile, begin: Begin, *, by: Fit) -> OtherKeys | None:
    """The keys that leave least, to a first look; None where no others run."""
    tried: dict[float, OtherKeys] = {}
    for one in other_keys(file):
        _try(tried, one, begin, by=by)
    for apart in FINER if tried else ():
        for one in _beside(file, tried[min(tried)], apart):
            _try(tried, one, begin, by=by)
    return tried[min(tried)] if tried else None


def other_keys(file: PairFile) -> list[OtherKeys]:
    """The values that are tried first, one key at a time."""
    shifts = map(_shifted(file), SHIFTS)
    return [*shifts, *_both(file, "pressure_angle_deg", ANGLES), *_both(file, "addendum", ADDENDA)]


def _rivals(stated: Fit) -> Iterator[Sequence[Claim]]:
    """Physics of all teeth that may do what other keys would: reliefs of both gears, and those that gain most."""
    model = stated.model
    yield relieved(model)
    places = [
        (physics, place)
        for physics in model.method.physics
        if physics.mean_tooth
        for place in filter(model.scope.shows, physics.places(model.scope))
    ]
    found, _ = scan(model, stated.scenes, stated.linear, only=places)
    seen: set[str] = set()
    for one in found:
        if one.claim.physics.name not in seen and len(seen) < RIVALS:
            seen.add(one.claim.physics.name)
            yield [polished(model, stated.scenes, stated.linear, one, roughly=True).claim]


def _try(tried: dict[float, OtherKeys], one: OtherKeys, begin: Begin, *, by: Fit) -> None:
    """Add what ``one`` leaves under the noise of another fit to what the others left, unless it cannot run."""
    fit = None if by.over else _fit(begin, one.file, close=False)
    if fit is not None:
        tried.setdefault(_beyond(fit, by=by), one)


def _fit(begin: Begin, file: PairFile, *, close: bool, beside: Sequence[Claim] = ()) -> Fit | None:
    """A short fit of the pair of a ``file`` with claims ``beside``; None where it cannot run."""
    try:
        model, columns = shortened(*begin(file), few=FEW[close])
        model.claims = list(beside)
        return Fit.begun(model, columns, lambda _: None, trial=TRIALS[close])
    except GearpolyError:
        return None


def _beyond(fit: Fit, *, by: Fit) -> float:
    """Misfit beyond noise over noise's own of a ``fit``, under the noise of another one."""
    system = fit.linear.under(by.noises).system
    return (system.misfit - system.samples) / system.samples


def _beside(file: PairFile, best: OtherKeys, apart: float) -> list[OtherKeys]:
    """Profile shifts on either side of the ``best``."""
    return [] if best.shift is None else [_shifted(file)(best.shift + by) for by in (-apart, apart)]


def _shifted(file: PairFile) -> Callable[[float], OtherKeys]:
    """What makes the pair with so much more profile shift of the driving gear, and so much less of the driven one."""

    def by(shift: float) -> OtherKeys:
        stated = [float(gear_section(file, gear).profile_shift) for gear in (0, 1)]
        now = [stated[0] + shift, stated[1] - shift]
        other = file
        for gear in (0, 1):
            other = on_gear(other, gear, profile_shift=now[gear])
        return OtherKeys(file=other, says=_says("profile_shift", now, stated), shift=shift)

    return by


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
