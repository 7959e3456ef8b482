"""From a pair file and recordings to the working state of a diagnosis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from gearpoly.assemble import stated_limits
from gearpoly.compare.among import means_compare
from gearpoly.compare.beside import Aligned, BesideSimulation
from gearpoly.compare.noise import NoiseEstimator, whole_cycles
from gearpoly.compare.slow import SLOW_CURVE_TERMS
from gearpoly.compare.stand_in import known_file
from gearpoly.diagnose.as_built import (
    GRADE_LIMIT_SIGMAS,
    IDEAL_TEETH_STD_UM,
    GearPrior,
    chain,
    make_as_built,
    on_its_own,
)
from gearpoly.diagnose.lines_told import NONE_TOLD, lines_told
from gearpoly.diagnose.model import Model, Observed
from gearpoly.files.models import GearSection, Inspection, PairFile
from gearpoly.gear.gear import Gear
from gearpoly.gear.nominal import nominal_gears
from gearpoly.keys.edit import changed
from gearpoly.mesh.pair import GearPair, active_start, tight_centre_distance
from gearpoly.mesh.shafts import runs_up
from gearpoly.physics.base import Scope
from gearpoly.physics.samples import Samples
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, UM

LEAST_SHIFT = 0.002 * DEG
"""rad. No zero is known better than this before the fit, whatever the alignment says of itself."""

ZERO_MOST_SHIFT_PITCHES = 0.06
"""Pitches. Farther a zero is not moved: where the curves do not place the teeth, places an eighth of a pitch apart were
tried, and any is as good."""

COAST = 0.05
"""Part of an inspection's variance by which a coast flank that nobody measured may differ from what follows of the
drive flank: little, since the pair file says that it follows."""

HALF_WAVE = 0.113
"""Standard deviation of each half wave of a tooth's form over the limit of its range, f_falpha: 0.10 to 0.12 on gears
of 11 to 61 teeth drawn within grades 4 to 8."""

MEAN_SLOPE_PART = 0.25
"""Standard deviation of a gear's mean profile slope over the limit f_Halpha that its teeth keep: of drawn gears whose
means and teeth scatter alike, by 0.354 of the limit, those that pass have 0.25 of it (12 teeth) to 0.17 (45)."""

LIMITS_APART_SIGMAS = 6.0
"""Standard deviations between both limits of a tooth thickness: gears that passed lie within them, nearly all."""

BASE = 5
"""Grade from which all others follow: each is coarser by the square root of 2 (ISO 1328-1:2013, 5.2)."""

BLOCKS = 8
"""Contiguous blocks of a recording shorter than two hunting cycles; a cross-validated fit learns from every other
one."""


def prepare(file: PairFile, beside: BesideSimulation, *, path: Path) -> Model:
    """The working state before any physics is claimed."""
    declared = known_file(file)
    pair = beside.assembled.pair
    recordings = [one.cleaned.recording for one in beside.aligned]
    compared = means_compare(recordings)
    observed = tuple(_observed(one, k, beside, counted=compared[k]) for k, one in enumerate(beside.aligned))
    gears, priors = gear_priors(file)
    as_built = make_as_built(priors, [one.samples.flank for one in observed])
    computed = any(r.computed for r in recordings)
    averaged = any(one.averaged for one in beside.aligned)
    finest = _finest(observed, averaged=averaged)
    samples = [one.samples for one in observed]
    scope = Scope(
        file=declared,
        gears=gears,
        flanks=tuple(one.samples.flank for one in observed),
        torques=tuple(one.samples.torque for one in observed),
        speeds=tuple(one.samples.speed for one in observed),
        run_ups=tuple(ends for one in observed if (ends := runs_up(one.samples.theta_1, one.samples.time)) is not None),
        # A rig that computed the transmission error itself had a sensor on either shaft too.
        encoders=(
            any(r.driving_angle_rad is not None for r in recordings) or computed,
            any(r.driven_angle_rad is not None for r in recordings) or computed,
        ),
        from_time=(
            any("driving" in r.from_time for r in recordings),
            any("driven" in r.from_time for r in recordings),
        ),
        timed=all(one.samples.time is not None for one in observed),
        varied=any(one.samples.load is not None for one in observed),
        counted=all(compared),
        span=max(float(np.ptp(one.samples.theta_1)) for one in observed) / (2.0 * math.pi),
        inspected=(not priors[0].graded, not priors[1].graded),
        reach=reaches(pair),
        form=(form_of(priors[0]), form_of(priors[1])),
        finest=finest,
        # Means over neighbours hold nothing so fine.
        lines=NONE_TOLD
        if averaged
        else (lines_told(samples, 0, finest=finest[0]), lines_told(samples, 1, finest=finest[1])),
        stepped=any(one.coarse_for_a_while > 0.0 for one in beside.aligned),
        ranges=tuple(float(np.ptp(one.recorded)) / UM for one in observed),
        wanders=tuple(
            SLOW_CURVE_TERMS - 1 if r.computed and not one.whole else 0
            for r, one in zip(recordings, observed, strict=True)
        ),
    )
    return Model(
        declared=declared,
        path=path,
        scope=scope,
        as_built=as_built,
        observed=observed,
        shift_std=min(max(beside.alignment.std_driven, LEAST_SHIFT), ZERO_MOST_SHIFT_PITCHES * pair.driven.gear.tau),
        built=np.zeros(as_built.size),
        phased=beside.alignment.phased,
        stated=beside.alignment.numbering == "stated",
        elsewhere=beside.alignment.further if beside.alignment.numbering == "open" else (),
        turns_of=only_shaft_read(recordings),
    )


def _finest(observed: Sequence[Observed], *, averaged: bool) -> tuple[float, float]:
    """Half the samples per turn of the driving and of the driven shaft, at least; a quarter of those that are means,
    which make a wave of that order a tenth smaller."""
    turns = [
        [one.samples.size / max(float(np.ptp(angle)), 1e-300) for angle in (one.samples.theta_1, one.samples.theta_2)]
        for one in observed
    ]
    first, second = (math.pi * min(per_rad) for per_rad in zip(*turns, strict=True))
    return (0.5 * first, 0.5 * second) if averaged else (first, second)


def only_shaft_read(recordings: Sequence[Recording]) -> Literal["driving", "driven"] | None:
    """The shaft that alone was read, the same in all ``recordings``; None where any counts the turns of both."""
    if all(r.driven_angle_rad is not None and r.driving_angle_rad is None for r in recordings):
        return "driven"
    return "driving" if all(r.driven_angle_rad is None for r in recordings) else None


def form_of(prior: GearPrior) -> float:
    """Half the standard deviation of the form of a gear whose form nobody measured: what is smaller on all its teeth is
    as it was built."""
    return 0.5 * (prior.crowning if prior.graded else prior.bulge)


def reaches(pair: GearPair) -> tuple[tuple[float, float], tuple[float, float]]:
    """Roll lengths in mm between which the flanks of both gears work."""
    gears = pair.driving.gear, pair.driven.gear
    starts = [
        active_start(gear, mate, l_form=mounted.flanks.root.l_form)
        for gear, mate, mounted in zip(gears, gears[::-1], (pair.driving, pair.driven), strict=True)
    ]
    return (starts[0], gears[0].l_a), (starts[1], gears[1].l_a)


def gear_priors(file: PairFile) -> tuple[tuple[Gear, Gear], tuple[GearPrior, GearPrior]]:
    """Both deviation-free gears, and what the file says of their teeth beforehand."""
    gears = nominal_gears(file)
    return gears, (_prior(file.driving, gears, 0), _prior(file.driven, gears, 1))


def _prior(section: GearSection, gears: tuple[Gear, Gear], which: int) -> GearPrior:
    """What the file says of one gear beforehand."""
    z = section.teeth
    if section.inspection is not None:
        each = max(section.inspection.uncertainty_um, IDEAL_TEETH_STD_UM)
        # The coast flank has what was read of the drive flank, errors of the reading and all, if nobody measured it.
        alone = section.inspection.pitch_coast_um is not None
        known = _known(z, each, shared=0.0 if alone else 1.0, own=(0.0, 0.0) if alone else (COAST, COAST))
        return _unmeasured(known, section, gears, which)
    if section.grade is None and section.limits is None:
        return _known(z, IDEAL_TEETH_STD_UM, shared=0.0, own=(0.0, 0.0))
    return graded_prior(section, gears, which)


def _unmeasured(known: GearPrior, section: GearSection, gears: tuple[Gear, Gear], which: int) -> GearPrior:
    """An inspected gear with what its inspection does not hold as gears of its grade have it: slopes, a common bulge,
    and the forms of its teeth. Traces hold all of these."""
    sheet = section.inspection
    if sheet is None or sheet.profile_csv is not None or sheet.gde is not None:
        return known
    like = _like_its_sheet(section, sheet, gears, which)
    if like is None:
        return known
    if sheet.profile_slope_um is None:
        known = replace(known, slope=like.slope, mean_slope=like.mean_slope, slope_measured=False)
    if sheet.profile_crowning_um is None:
        known = replace(known, bulge=like.crowning)
    return known if sheet.profile_form_um is not None else replace(known, wave=like.wave)


def _like_its_sheet(section: GearSection, sheet: Inspection, gears: tuple[Gear, Gear], which: int) -> GearPrior | None:
    """A gear of the grade or the limits that a section states beside its ``sheet``, or else of the grade that the
    measured slopes are of, or where none were measured the steps of the pitches; None where nothing tells."""
    if section.grade is not None or section.limits is not None:
        return graded_prior(section, gears, which)
    base = base_prior(section, gears, which)
    if sheet.profile_slope_um is not None:
        scatter, usual = np.var(np.atleast_1d(sheet.profile_slope_um)), base.slope
        doubt = sheet.uncertainty_um**2
    else:
        pitch = np.atleast_1d(0.0 if sheet.pitch_um is None else np.asarray(sheet.pitch_um, dtype=np.float64))
        # Single pitches lie evenly within their limit.
        scatter, usual = np.mean(np.square(pitch - np.roll(pitch, 1))), base.single / math.sqrt(3.0)
        doubt = 2.0 * sheet.uncertainty_um**2
    variance = float(scatter) - doubt
    return base_prior(section, gears, which, by=math.sqrt(variance) / usual) if variance > 0.0 else None


def base_prior(
    section: GearSection, gears: tuple[Gear, Gear], which: int, *, by: float = 1.0, others: float = 1.0
) -> GearPrior:
    """The same of a gear of which nobody stated a grade, as ``BASE`` has it; one of a size that the standard does not
    hold is as the nearest that it holds."""
    section = changed(section, grade=BASE)
    return graded_prior(section, gears, which, by=by, others=others, nearest=True)


def graded_prior(
    section: GearSection,
    gears: tuple[Gear, Gear],
    which: int,
    *,
    by: float = 1.0,
    others: float = 1.0,
    nearest: bool = False,
) -> GearPrior:
    """What a gear is like that keeps to its limits, or to so many times these, ``others`` than that of single pitches
    to as many times that again."""
    mine, mate = gears[which], gears[1 - which]
    limits = stated_limits(section, mine, a=tight_centre_distance(mine, mate), nearest=nearest)
    rest = by * others
    # Of what every tooth's slope and form range over, half the variance is its own.
    half = rest / GRADE_LIMIT_SIGMAS / math.sqrt(2.0) / UM
    cosine = math.cos(mine.alpha)  # from the reference circle to the line of action
    return GearPrior(
        z=section.teeth,
        pitch=chain(section.teeth, single=by * cosine * limits.f_pT / UM, cumulative=rest * cosine * limits.F_pT / UM),
        slope=max(half * limits.f_HalphaT, IDEAL_TEETH_STD_UM),
        mean_slope=max(MEAN_SLOPE_PART * rest * limits.f_HalphaT / UM, IDEAL_TEETH_STD_UM),
        crowning=max(half * limits.f_falphaT, IDEAL_TEETH_STD_UM),
        # A gear that passed lies within its limits, all of them.
        thickness=max(rest * (limits.E_sns - limits.E_sni) / (LIMITS_APART_SIGMAS * UM), IDEAL_TEETH_STD_UM),
        # Some errors move whole teeth, others one flank: half and half until the recordings have told.
        shared=(0.5, 0.5),
        own=(0.0, 0.0),
        graded=True,
        single=by * cosine * limits.f_pT / UM,
        wave=HALF_WAVE * rest * limits.f_falphaT / UM,
    )


def _known(z: int, each: float, *, shared: float, own: tuple[float, float]) -> GearPrior:
    """A gear whose teeth are known to ``each`` um."""
    return GearPrior(
        z=z,
        pitch=on_its_own(z, each),
        slope=each,
        mean_slope=0.0,
        crowning=IDEAL_TEETH_STD_UM,
        thickness=each,
        shared=(shared, shared),
        own=own,
        graded=False,
    )


def _observed(one: Aligned, number: int, beside: BesideSimulation, *, counted: bool) -> Observed:
    zeros, recording = beside.alignment.zeros, one.cleaned.recording
    pair = beside.assembled.pair
    read_1, read_2 = one.estimated
    u = one.theta_2 * (pair.driven.gear.z / (2.0 * math.pi))
    samples = Samples(
        number=number,
        flank=one.flank,
        torque=one.torque,
        speed=one.speed if one.speed is None else float(one.speed),
        theta_1=one.theta_1,
        theta_2=one.theta_2,
        time=one.time_s,
        reading_1=(zeros.driving or 0.0) + recording.driving_direction * read_1,
        reading_2=(zeros.driven or 0.0) + recording.driven_direction * read_2,
        direction_1=recording.driving_direction,
        direction_2=recording.driven_direction,
        counted=counted,
        backward=one.cleaned.backward,
        load=one.load,
        middle=float(np.mean(one.theta_2)),
    )
    estimator = NoiseEstimator(u, z_1=pair.driving.gear.z, z_2=pair.driven.gear.z)
    period = float(pair.meshes_per_cycle)
    cycles = whole_cycles(u, period)
    along = u - u[0]
    # A run-up meets a speed once: every other turn of it tells what lies between them, one half nothing of the other.
    running = runs_up(one.theta_1, one.time_s) is not None
    parts = max(BLOCKS, int(along[-1] / pair.driving.gear.z)) if running else BLOCKS
    blocks = np.floor(along * (parts / along[-1])) % 2 == 0
    fit = along < period * ((cycles + 1) // 2) if cycles >= 2 and not running else blocks
    return Observed(samples=samples, recorded=one.recorded, fit=fit, whole=cycles >= 2, estimator=estimator)
