"""What a fit leaves of recordings, located anew beside its teeth as they touch."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry
from gearpoly.compare.locate import Located, locate
from gearpoly.compare.noise import Noise
from gearpoly.compare.peak import is_hum
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.compare.template import ERROR, sharings_of
from gearpoly.diagnose.fidelity import BY_LAWS, CORNER, OTHERS_BY_LAWS
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.floors import magnified
from gearpoly.diagnose.foreign import found_alone, is_foreign, stands
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.nuisance import DISCREPANCY
from gearpoly.errors import GearpolyError
from gearpoly.units import UM, FloatArray

DISCREPANCY_SIGMAS_TOLD = 2.0
"""Standard deviations of the model discrepancy from which on a curve at every mesh under load is told as one without a
cause. A judgement: nineteen of twenty gears lie within two."""

FITTED_TEETH_OPEN_MM = 1e-4
"""mm. What is left open of teeth that were fitted."""

SHARP_LINE_SIGMAS = 12.0
"""Standard errors by which a line is above the noise about it whatever colour that has: its power is seventy times what
was read off the lines beside it. At 15 a line of 14 on a real guide log was left out (chance 1e-11); at 12 ten
recordings in noise that wanders, or of coarse encoders, told no further line."""


def residuals_of(fit: Fit) -> list[FloatArray]:
    """What the ``fit`` leaves (n_k,) in mm of every recording, with the waves that no pair makes put back: they are to
    be found again, with their size. Not those which turned out to be teeth as they were built: their size is whatever
    the teeth leave open."""
    linear = fit.linear
    x = linear.system.solution.copy()
    for places in found_alone(fit.model.strangers, linear.layout.foreign):
        if stands(linear.system, places):
            x[places] = 0.0
    discrepancy = range(*fit.nuisance.discrepancy.indices(x.size))
    places = [linear.layout.nuisance.start + place for place in discrepancy]
    if places and discrepancy_part(fit) > DISCREPANCY_SIGMAS_TOLD:
        x[places] = 0.0
    return _left(linear, x)


def discrepancy_part(fit: Fit) -> float:
    """Rms of the fitted model discrepancy over its prior standard deviation, in the recording where that is largest; 0
    where nothing bends."""
    at, parts = fit.nuisance.discrepancy, []
    found = fit.linear.system.solution[fit.linear.layout.nuisance][at]
    for columns, bent in zip(fit.nuisance.columns, fit.deflections, strict=True):
        if bent > 0.0 and found.size:
            parts.append(float(np.std(columns[:, at] @ found)) / (DISCREPANCY * bent))
    return max(parts, default=0.0)


def left_of(fit: Fit) -> list[FloatArray]:
    """What the ``fit`` leaves (n_k,) in mm of every recording."""
    return _left(fit.linear, fit.linear.system.solution)


def _left(linear: Linear, x: FloatArray) -> list[FloatArray]:
    return [target - columns @ x for columns, target in zip(linear.columns, linear.target, strict=True)]


def locate_residuals(
    fit: Fit, comparison: Comparison, left: list[FloatArray], *, likely: Sequence[float] = (),
    over: Callable[[], bool] = lambda: False,
) -> Located:  # fmt: skip
    """Where recordings differ from what a ``fit`` makes of them: what it leaves of them is ``left`` (n_k,) in mm, and
    ``comparison`` says how they were laid; ``likely`` as in ``locate``; only what is strongest where time is
    ``over``."""
    # What is left of teeth that were fitted is little, of teeth that were declared ideal nothing.
    gears = tuple(
        GearKnown(
            z=known.z,
            uncertainty=None if known.ideal else FITTED_TEETH_OPEN_MM,
            zero=known.zero,
            direction=known.direction,
        )
        for known in comparison.gears
    )
    # Pairs are taken to share as the fitted ones do: without load that is another matter than for declared teeth, which
    # touch all at once.
    conditions = [replace(scene.samples.condition, varies=0.0) for scene in fit.scenes]
    try:
        fitted = sharings_of(fit.model.assembled(), conditions)
    except GearpolyError:
        # At the samples the fitted gears run; between them an edge may carry alone, which no law of compliance holds.
        fitted = sharings_of(fit.model.assembled(fit.model.declared), conditions)
    residuals = [
        AlignedResidual(
            theta_1=scene.samples.theta_1,
            theta_2=scene.samples.theta_2,
            residual=rest,
            z_2=comparison.gears[1].z,
            time_s=scene.samples.time,
            backward=one.cleaned.backward,
            torque=one.torque,
            speed=one.speed,
            flank=one.flank,
            sharing=sharing,
            coarse=one.coarse,
            coarse_for_a_while=one.coarse_for_a_while,
            averaged=one.averaged,
            contact=sharing.contact,
        )
        for one, scene, rest, sharing in zip(comparison.aligned, fit.scenes, left, fitted, strict=True)
    ]
    pair = comparison.assembled.pair
    return locate(
        residuals,
        gears=(gears[0], gears[1]),
        floor=pair.chord_noise + ERROR + max(one.doubt for one in comparison.aligned),
        numbered=comparison.alignment.numbered,
        likely=likely or comparison.located.orders,
        over=over,
    )


def stands_out(entry: Entry, fit: Fit) -> bool:
    """Whether an entry is beyond what the simulation cannot do, a grade leaves open, or the noise may be coloured by,
    and is none of another one's company."""
    return entry.companion_of is None and beyond_model(entry, fit) and not _by_colour(entry, fit.model, fit.noises)


def beyond_model(entry: Entry, fit: Fit) -> bool:
    """Whether an entry is beyond what the simulation cannot do, and a grade leaves open."""
    return not _by_law(entry, fit) and not _by_grade(entry, max(fit.model.scope.form))


def _by_law(entry: Entry, fit: Fit) -> bool:
    """Whether an entry is below what compliance laws and corner contact differ by, magnified by a resonance if there is
    one: that repeats with the pair."""
    if is_foreign(entry) or entry.burst is not None:
        return False
    size = abs((entry.amplitude_um if entry.amplitude_um is not None else entry.rms_um) or 0.0)
    part = BY_LAWS.get(entry.kind, OTHERS_BY_LAWS)
    if entry.kind == "tooth" and entry.phase is not None and entry.phase[1] - entry.phase[0] < CORNER:
        part = BY_LAWS["mesh_phase"]
    swings = 1.0 if entry.order is None else magnified(fit, entry.order, entry.gear, entry.recordings)
    return size < part * swings * fit.deflection / UM


def sharp(entry: Entry) -> bool:
    """Whether an entry is a line above the noise about it whatever colour that has."""
    return abs(entry.amplitude_um or 0.0) > SHARP_LINE_SIGMAS * (entry.std_um or math.inf)


def _by_colour(entry: Entry, model: Model, levels: list[Noise]) -> bool:
    """Whether an entry may be coloured noise: a line below the noise in recordings that never repeat themselves, if not
    so sharp that no colour would be, nor at the mains, where one is known to be. 0.068 um of hum at 50.000 Hz, ten
    standard errors and found in two recordings, had been dropped."""
    if any(model.observed[k].whole for k in entry.recordings) or entry.kind not in ("shaft_order", "time"):
        return False
    if entry.moment is not None or entry.burst is not None:
        return False
    if entry.order is not None and float(entry.order).is_integer():
        return False
    alike = () if entry.hz is None else (entry.hz, *entry.aliases)
    if sharp(entry) or any(is_hum(one, std=entry.hz_std or 0.0) for one in alike):
        return False
    return abs(entry.amplitude_um or 0.0) < min(levels[k].level for k in entry.recordings) / UM


def _by_grade(entry: Entry, form: float) -> bool:
    """Whether an entry is the same at every mesh and below the ``form`` in um that a grade leaves open."""
    size = entry.amplitude_um if entry.amplitude_um is not None else entry.rms_um
    return entry.kind in ("mesh_order", "mesh_phase") and abs(size or 0.0) < form
