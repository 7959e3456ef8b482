"""Waves that no gear pair makes and that nobody saw beneath what teeth do: located again in what a fit leaves, and
fitted beside everything from then on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry
from gearpoly.compare.locate import Located
from gearpoly.diagnose.fit import Fit, settled
from gearpoly.diagnose.foreign import by_wave, foreign_entries, foreign_waves, smooth_orders, wave_in_each
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.relaxed import Few, few_of
from gearpoly.diagnose.residuals import left_of, locate_residuals, residuals_of, stands_out
from gearpoly.diagnose.unnamed import leaving
from gearpoly.errors import GearpolyError
from gearpoly.infer.prior import LINE_COUNTS, LOW_ORDERS_PER_TOOTH
from gearpoly.units import UM, FloatArray

SMOOTH_WAVES_TRIED, LEAST_SMOOTH_WAVE_GAIN = 4, 40.0
"""Waves that are tried as smooth ones, the strongest first, each for as long as the teeth take to settle; and the
misfit that one has to gain: six standard deviations."""

SMOOTH_WAVE_GAIN_PART = 0.1
"""Part of the misfit beyond noise that it has to gain as well: beside a pit that nobody had claimed yet three waves of
a printed pair's teeth gained 20 to 76 of 6560, smooth ones of five other recordings 0.57 of it and more."""

MOST_OF_LOCATED = 2.0
"""Times its located size that a wave may have: teeth of a grade hide more than half of one by chance only. Of three
torques that nobody had declared to bend teeth 0.2 um at eleven orders were asked one by one, 53 s long, though none of
them could gain a hundredth of what was missing."""

GAIN_PART_OF_FEW_SAMPLES = 0.5
"""Part of that which a few samples have to show before all are asked: they tell a misfit to a fiftieth. Five waves of
99 600 samples took 40 s of 70, and none was smooth."""

FEWEST_CYCLES_OF_A_WAVE = 1.5
"""Cycles per recording from which on something slow is a wave: what is slower may be a drift, which has a name."""

LOOKS, EARLY = 3, 0.5
"""Looks at what is left, since a wave hides others that are smaller; and the part of the time after which one has to
do: each takes as long as ``compare`` does, and with three of them nothing was searched of 52 000 samples."""

FITTED_WAVE_POWER_PART = 0.5
"""Part of the power of a wave that waves which are fitted already may hold of it, for it to be another one."""


def waves_beneath(search: Fit, comparison: Comparison, located: Located | None = None) -> Fit:
    """With the waves fitted beside all else that stand out of what a fit leaves, each located where ``comparison`` says
    how the recordings were laid; the same ``search`` where there are none. ``located``: what stands out beside the
    teeth, where somebody has looked.

    Teeth of a grade hide what is as small as their limits until they are fitted. What is left out then speaks against
    every claim: beside two waves of 0.2 um of another wheel an eccentricity of 28 um was said to swell.
    """
    there, orders = search, comparison.located.orders
    for look in range(LOOKS):
        if look and search.model.budget.past(EARLY):
            break
        left = left_of(there) if look or located is None else residuals_of(there)
        if look or located is None:
            located = locate_residuals(there, comparison, left, likely=orders, over=lambda: search.over)
        before, there, orders = there, _with_waves(there, comparison, left, located), located.orders
        if there is before:
            break
    if there is search:
        return search
    try:
        return settled(there)
    except GearpolyError:
        return search  # gears jam where the fit would have them


def _with_waves(fit: Fit, comparison: Comparison, left: list[FloatArray], located: Located) -> Fit:
    """With the waves that were ``located`` in what is ``left`` (n_k,) in mm; the same ``fit`` where there are none."""
    aligned = tuple(replace(one, residual=rest) for one, rest in zip(comparison.aligned, left, strict=True))
    for wave in by_wave(foreign_entries(replace(comparison, aligned=aligned, located=located))):
        entries = [entry for _, entry in wave]
        waves = all(entry.moment is None for entry in entries)
        if fit.over or not waves or not any(stands_out(entry, fit) for entry in entries):
            continue
        columns = foreign_waves(comparison, wave)
        if not _slow(columns) and not _known(fit, columns):
            fit = leaving(fit, columns)
    return fit


def smooth_waves(search: Fit, comparison: Comparison, *, least: float = LEAST_SMOOTH_WAVE_GAIN) -> Fit:
    """With the strongest waves of whole orders that ``comparison`` located fitted as smooth ones of no cause, where
    that fits better than teeth which make them; the same ``search`` where there are none. Asked where at ``least`` so
    much is left beyond noise.

    Teeth hand over from pair to pair, so what they have comes with side bands of the mesh, and about teeth that have
    settled for a wave no straight line leads back. Of 10 um of another wheel, twice per turn, pits of two teeth were
    made. Once per turn a gear or an encoder that is off its axis is simulated, and at an encoder's lines its error is.
    """
    located = comparison.located
    ones: dict[tuple[str | None, float | None], Entry] = {}
    if search.linear.system.beyond < least:
        return search
    # First what teeth of the grade cannot hold, then what they could.
    for one in (*located.entries, *located.where):
        lines = any(image.order in LINE_COUNTS for image in _images(one, search, comparison))
        once = _of_once_per_turn(one, search, comparison)
        if _either(one, search) and not lines and not once and not _known(search, wave_in_each(one, comparison)):
            ones.setdefault((one.gear, one.order), one)
    asked_for = max(LEAST_SMOOTH_WAVE_GAIN, SMOOTH_WAVE_GAIN_PART * search.linear.system.beyond)
    strongest = [one for one in ones.values() if _most_gain(one, search) > asked_for][:SMOOTH_WAVES_TRIED]
    few = few_of(search) if strongest else None
    for one in strongest:
        there = _smooth(search, comparison, (one, *_images(one, search, comparison)), few)
        if there is not search:
            search, few = there, few_of(there)
    return search


def _most_gain(entry: Entry, fit: Fit) -> float:
    """The most misfit that a wave as large as ``MOST_OF_LOCATED`` times an ``entry`` takes off the recordings."""
    size = MOST_OF_LOCATED * (entry.amplitude_um or 0.0) * UM
    frequency = (entry.order or 0.0) / fit.model.scope.gears[0 if entry.gear == "driving" else 1].z
    each = zip(fit.scenes, fit.noises, strict=True)
    return sum(
        0.5 * scene.samples.size * size**2 / float(np.interp(frequency, noise.frequency, noise.density))
        for scene, noise in each
    )


def _either(entry: Entry, fit: Fit) -> bool:
    """Whether an entry is a wave that teeth may make and others as well."""
    order, gear = entry.order, 0 if entry.gear == "driving" else 1
    if entry.kind != "shaft_order" or order is None or entry.companion_of is not None:
        return False
    z = fit.model.scope.gears[gear].z
    return (
        2 <= order <= LOW_ORDERS_PER_TOOTH * z
        and order % z != 0
        and float(order).is_integer()
        and order not in LINE_COUNTS
    )


def _images(entry: Entry, fit: Fit, comparison: Comparison) -> list[Entry]:
    """Waves that were located an order of the mesh beside one: teeth that meet once per wave of the mesh show either as
    the other. Of a line of an encoder 20 times per turn, beside 24 teeth, spalls of five were made."""
    z = fit.model.scope.gears[0 if entry.gear == "driving" else 1].z
    order = entry.order or 0.0
    ones = [one for one in comparison.located.entries if one.kind == "shaft_order" and one.gear == entry.gear]
    return [one for one in ones if one.order in (z - order, z + order)]


def _of_once_per_turn(entry: Entry, fit: Fit, comparison: Comparison) -> bool:
    """Whether a wave lies one order beside the mesh's of a gear that has a larger one once per turn: an image of what
    a gear or an encoder off its axis does, which is simulated."""
    z = fit.model.scope.gears[0 if entry.gear == "driving" else 1].z
    if entry.order not in (z - 1, z + 1):
        return False
    every = (*comparison.located.entries, *comparison.located.where)
    ones = [one for one in every if one.kind == "shaft_order" and (one.gear, one.order) == (entry.gear, 1.0)]
    return any((one.amplitude_um or 0.0) > (entry.amplitude_um or 0.0) for one in ones)


def _smooth(search: Fit, comparison: Comparison, ones: Sequence[Entry], few: Few | None) -> Fit:
    """With one of some waves that teeth show alike fitted as a smooth one, the best of them; the same ``search`` where
    none fits better. Asked of a ``few`` samples first."""
    gain = max(LEAST_SMOOTH_WAVE_GAIN, SMOOTH_WAVE_GAIN_PART * search.linear.system.beyond)
    best, smooth, least = search, None, _of_data(search.linear) - gain
    for entry in ones:
        columns = wave_in_each(entry, comparison)
        if search.over or _known(search, columns):
            continue
        if few is not None and _gained(few, columns) < GAIN_PART_OF_FEW_SAMPLES * few.part * gain:
            continue
        search.step(f"asking whether teeth make order {entry.order:g} of the {entry.gear} shaft")
        try:
            there = settled(leaving(search, columns), below=search.linear.system.misfit - LEAST_SMOOTH_WAVE_GAIN)
        except GearpolyError:
            continue
        left = _of_data(there.linear.under(search.noises))
        if left < least:
            best, smooth, least = there, entry, left
    if smooth is None or smooth.order == 1.0:
        return search  # what comes once per turn, and has an image beside the mesh, is told by a gear or an encoder
    z_1, z_2 = (gear.z for gear in comparison.gears)
    scope = best.model.scope
    return best.believing(scope=replace(scope, smooth=scope.smooth | smooth_orders([(0, smooth)], z=(z_1, z_2))))


def _gained(few: Few, columns: Sequence[FloatArray]) -> float:
    """By how much less a few samples misfit with the waves ``columns`` (n_k, q), teeth settled beside them."""
    fit = few.fit
    try:
        there = settled(leaving(fit, [one[where] for one, where in zip(columns, few.where, strict=True)]))
    except GearpolyError:
        return 0.0
    return _of_data(fit.linear) - _of_data(there.linear.under(fit.noises))


def _of_data(linear: Linear) -> float:
    """Misfit of the samples alone: what a grade says of teeth is no word against the teeth of a gear that it is not
    of."""
    return linear.system.misfit - linear.system.strain


def _slow(columns: list[FloatArray]) -> bool:
    """Whether the waves (n_k, 2 q) turn less than ``FEWEST_CYCLES_OF_A_WAVE`` in the recording in which they turn
    most."""
    cycles = [
        np.ptp(np.unwrap(np.arctan2(one[:, at + 1], one[:, at]))) / (2.0 * np.pi)
        for one in columns
        for at in range(0, one.shape[1], 2)
        if np.any(one[:, at])
    ]
    return not cycles or max(cycles) < FEWEST_CYCLES_OF_A_WAVE


def _known(fit: Fit, columns: list[FloatArray]) -> bool:
    """Whether waves that are fitted already can make ``columns`` (n_k, q) up."""
    new, old = np.concatenate(columns), np.concatenate(fit.foreign)
    if not old.size:
        return False
    rest = new - old @ np.linalg.lstsq(old, new)[0]
    return bool(np.sum(rest**2) < (1.0 - FITTED_WAVE_POWER_PART) * np.sum(new**2))
