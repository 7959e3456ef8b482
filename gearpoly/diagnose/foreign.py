"""Waves that no gear pair and no encoder makes: fitted beside everything, so that nothing is claimed in their place."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import gammaincc

from gearpoly.compare.beside import Aligned, Comparison
from gearpoly.compare.entries import IN_TIME, Entry
from gearpoly.compare.long_jumps import sample_of
from gearpoly.compare.slow import course_curves
from gearpoly.compare.spectrum import FrequencyGrid
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.system import System
from gearpoly.infer.prior import LINE_COUNTS
from gearpoly.keys.also_turns import Part
from gearpoly.mesh.shafts import runs_up as speeds_of
from gearpoly.physics.encoder_interpolation import HIGHEST_ERRORS_PER_TURN
from gearpoly.units import FloatArray

STANDS = 3.5
"""Standard errors by which a foreign wave stands out beside everything else, to be looked for again; most are located
at more only."""

ONE_WAVE_LINES = 0.5
"""Independent lines within which waves of two recordings are one."""

LARGER, LITTLE = 1.5, 0.25
"""How much more an order above half the sampling rate must explain than any wave, for waves to be its images; and the
part of a wave's power that may be left of an image without it."""

RUN_UP_SPREAD_ORDERS = 0.5
"""Orders of a shaft beside the mesh's within which a run-up spreads what it takes through a resonance: a swing that
lasts two turns or more."""

WHOLE_ORDER_ROUNDING = 1e-9
"""Orders by which a whole one may be off by rounding."""

FADED_WAVES_MISFIT = 10.0
"""Misfit that waves may cost together, beyond that of their freedoms, to be let go of: three standard deviations."""


Found = list[tuple[int, Entry]]
"""Recordings and what is fitted in each."""


def foreign(comparison: Comparison, model: Model, entries: Found) -> list[FloatArray]:
    """Columns (n_k, q) of unit size that no gear pair and no encoder makes: the ``entries``, how far recordings stand
    apart that came back on the same flank, then the wandering of those of which nobody knows better."""
    waves = [
        np.concatenate(each, axis=1) for each in zip(foreign_waves(comparison, entries), _come_back(model), strict=True)
    ]
    slow = [
        course_curves(one.samples.along, terms + 1)[:, 1:]
        for one, terms in zip(model.observed, model.scope.wanders, strict=True)
    ]
    columns = sum(one.shape[1] for one in slow)
    out, at = [], 0
    for wave, own in zip(waves, slow, strict=True):
        mine = np.zeros((wave.shape[0], columns))
        mine[:, at : at + own.shape[1]] = own
        at += own.shape[1]
        out.append(np.concatenate((wave, mine), axis=1))
    return out


def _come_back(model: Model) -> list[FloatArray]:
    """Steps (n_k, 1) of unit size between runs forth and back that one flank carries: encoders read another angle
    coming back, and what hangs on the shafts does, so that means of both senses do not compare; (n_k, 0) where no
    flank ran both ways."""
    runs = [one.samples for one in model.observed]
    both = {(one.flank, one.backward) for one in runs if one.counted}
    if not any((flank, False) in both and (flank, True) in both for flank in ("drive", "coast")):
        return [np.zeros((one.size, 0)) for one in runs]
    return [np.full((one.size, 1), 1.0 if one.backward and one.counted else 0.0) for one in runs]


def foreign_waves(comparison: Comparison, entries: Found) -> list[FloatArray]:
    """Waves (n_k, q) of unit size that no gear pair and no encoder makes: fixed in time, no integer order, or jumps.

    They are fitted beside everything, so that nothing is claimed in their place; what they are is not asked.
    """
    out: list[list[FloatArray]] = [[np.zeros((one.theta_2.size, 0))] for one in comparison.aligned]
    for k, entry in entries:
        for j, mine in enumerate(out):
            size = mine[0].shape[0]
            mine.append(columns_of(entry, comparison.aligned[k]) if j == k else np.zeros((size, _width(entry))))
    return [np.concatenate(mine, axis=1) for mine in out]


def wave_in_each(entry: Entry, comparison: Comparison) -> list[FloatArray]:
    """The wave (n_k, q) of an ``entry`` in each recording, of a size of its own."""
    return foreign_waves(comparison, [(k, entry) for k in range(len(comparison.aligned))])


def foreign_entries(comparison: Comparison, parts: Sequence[Part] = ()) -> Found:
    """Recordings and what is fitted in each: hum and jumps where they were found, waves over angle in all, once, and
    the meshes of other ``parts`` of the drive that the pair file states."""
    entries = _all_foreign(comparison)
    images = _images(comparison, entries)
    found = [(k, entry) for k, entry in entries if id(entry) not in images]
    return [*found, *_meshes(comparison, parts, found)]


def _meshes(comparison: Comparison, parts: Sequence[Part], found: Found) -> Found:
    """Waves at the mesh of other parts that were not located: nothing is claimed at their place, and left out of the
    fit they would be made up of teeth. Of 0.12 um at order 16, beside 17 teeth, three spalls of 0.5 um were named."""
    z_1, z_2 = (gear.z for gear in comparison.gears)
    shortest = min(float(np.ptp(one.theta_2)) for one in comparison.aligned) / (2.0 * math.pi)
    finest = min(0.5 * one.theta_2.size / float(np.ptp(one.theta_2)) for one in comparison.aligned) * 2.0 * math.pi
    taken = [(one.order or 0.0) * (z_2 / z_1 if one.gear == "driving" else 1.0) for _, one in found if not one.hz]
    out: Found = []
    for order in (order for part in parts for order in part.meshes()):
        own = round(order / z_2) * z_2
        if order < finest and all(abs(order - one) * shortest >= ONE_WAVE_LINES for one in (own, *taken)):
            taken.append(order)
            wave = Entry(kind="shaft_order", gear="driven", order=order, p_value=1.0, recordings=())
            out += [(k, wave) for k in range(len(comparison.aligned))]
    return out


def _images(comparison: Comparison, entries: Found) -> set[int]:
    """The waves, by `id`, that are an encoder's lines above half the sampling rate, or an image of them.

    Samples that come unevenly smear the image of an encoder's lines over many orders, of which none is as large as the
    lines are at their own order: a single wave would be larger than any image of itself. As many waves per turn as no
    encoder on sale has lines are of no known cause, and stay.
    """
    left = [one.residual - float(np.mean(one.residual)) for one in comparison.aligned]
    waves = [(k, entry) for k, entry in entries if entry.moment is None]
    gone: set[int] = set()
    while stay := [(k, entry) for k, entry in waves if id(entry) not in gone]:
        before = _powers(comparison, stay, left)
        images = [before[id(entry)] for k, entry in stay if not _above(comparison.aligned[k], entry)]
        gains = [_orders_above(comparison, left, gear) for gear in (0, 1)]
        gear = int(np.argmax([np.max(one) for one in gains]))
        if not np.max(gains[gear]) > LARGER * max(images, default=0.0):
            break
        order = int(np.argmax(gains[gear]))
        for k, one in enumerate(comparison.aligned):
            angle = order * one.estimated[gear]
            columns = np.column_stack((np.cos(angle), np.sin(angle)))
            left[k] = left[k] - columns @ np.linalg.lstsq(columns, left[k])[0]
        after = _powers(comparison, stay, left)
        made = {which for which, power in before.items() if after[which] < LITTLE * power}
        if not made:
            break
        gone |= made
    return gone


def _above(one: Aligned, entry: Entry) -> bool:
    """Whether a wave that was found in a recording is above half its sampling rate."""
    turns = float(np.ptp(one.theta_1 if entry.gear != "driven" else one.theta_2)) / (2.0 * math.pi)
    if entry.hz is not None and one.time_s is not None:
        return entry.hz * float(np.ptp(one.time_s)) > 0.5 * one.theta_2.size
    return (entry.order or 0.0) * turns > 0.5 * one.theta_2.size


def _powers(comparison: Comparison, waves: Found, left: list[FloatArray]) -> dict[int, float]:
    """What waves, by `id`, explain of what is ``left`` (n_k,) of all recordings, in its unit squared."""
    out: dict[int, float] = {}
    for k, entry in waves:
        told = columns_of(entry, comparison.aligned[k]).T @ left[k]
        out[id(entry)] = out.get(id(entry), 0.0) + 2.0 * float(told @ told) / left[k].size
    return out


def _orders_above(comparison: Comparison, left: list[FloatArray], gear: int) -> FloatArray:
    """The same (``HIGHEST_ERRORS_PER_TURN`` + 1,) of as many waves per turn of a shaft as encoders have lines, above
    half the sampling rate of any recording; of other orders 0."""
    out = np.zeros(HIGHEST_ERRORS_PER_TURN + 1)
    slowest = 0.0
    for one, rest in zip(comparison.aligned, left, strict=True):
        turns = one.estimated[gear] / (2.0 * math.pi)
        out += (
            2.0
            * np.abs(FrequencyGrid(turns, step=1.0, count=HIGHEST_ERRORS_PER_TURN + 1).transform(rest)) ** 2
            / rest.size
        )
        slowest = max(slowest, 0.5 * rest.size / float(np.ptp(turns)))
    out[: math.ceil(slowest)] = 0.0
    out[[order for order in range(out.size) if order not in LINE_COUNTS]] = 0.0
    return out


def _all_foreign(comparison: Comparison) -> Found:
    out: Found = []
    orders: list[float] = []
    z_1, z_2 = (gear.z for gear in comparison.gears)
    turns = min(float(np.ptp(one.theta_1)) for one in comparison.aligned) / (2.0 * math.pi)
    runs_up = any(speeds_of(one.theta_1, one.time_s) is not None for one in comparison.aligned)
    for entry in comparison.located.entries:
        # Above half the sampling rate a search asks after lines of encoders only.
        above = entry.kind == "shaft_order" and any(_above(comparison.aligned[k], entry) for k in entry.recordings)
        if not (is_foreign(entry) or above) or (runs_up and swells_by(entry, z_1, z_2)):
            continue
        if entry.kind in IN_TIME:
            out += [(k, entry) for k in entry.recordings]
            continue
        driving = (entry.order or 0.0) * (1.0 if entry.gear == "driving" else z_1 / z_2)
        if all(abs(driving - other) * turns >= ONE_WAVE_LINES for other in orders):
            orders.append(driving)
            out += [(k, entry) for k in range(len(comparison.aligned))]
    return out


def smooth_orders(entries: Found, *, z: tuple[int, int]) -> frozenset[tuple[int, int]]:
    """Gears and whole orders of their shafts at which a wave is fitted; of both where it is a whole order of both:
    order 2 of 24 teeth is order 3 of 36, and either gear may have made it."""
    out = set()
    for _, one in entries:
        if one.order is None:
            continue
        gear, order = 0 if one.gear == "driving" else 1, one.order
        for which, own in ((gear, order), (1 - gear, order * z[1 - gear] / z[gear])):
            if abs(own - round(own)) < WHOLE_ORDER_ROUNDING:
                out.add((which, round(own)))
    return frozenset(out)


def by_wave(entries: Found) -> list[Found]:
    """The entries of each wave, in one recording or in several; those of one train are one."""
    each: dict[int, Found] = {}
    for one in entries:
        each.setdefault(_wave(one[1]), []).append(one)
    return list(each.values())


def _wave(entry: Entry) -> int:
    """Which wave an entry is of."""
    return -1 if entry.together else id(entry)


def strangers(entries: Found) -> tuple[tuple[int, ...], ...]:
    """The columns of `foreign_waves` of each wave that no gear pair and no encoder makes, a cosine and a sine for every
    recording; those of one train are one."""
    found: dict[int, list[int]] = {}
    at = 0
    for _, entry in entries:
        if entry.moment is None:
            found.setdefault(_wave(entry), []).extend((at, at + 1))
        at += _width(entry)
    return tuple(tuple(one) for one in found.values())


def swells_by(entry: Entry, z_1: int, z_2: int) -> bool:
    """Whether a wave is what the mesh has beside one of its orders where it swells and fades again: a run-up takes it
    through a resonance, and the pair makes it all the same."""
    if entry.kind != "shaft_order" or entry.order is None:
        return False
    z = z_1 if entry.gear == "driving" else z_2
    return entry.order > RUN_UP_SPREAD_ORDERS and abs(math.remainder(entry.order, z)) < RUN_UP_SPREAD_ORDERS


def _width(entry: Entry) -> int:
    """Columns of a foreign entry: a step, or cosine and sine."""
    return 1 if entry.moment is not None else 2


def columns_of(entry: Entry, one: Aligned) -> FloatArray:
    """Step (n, 1) or cosine and sine (n, 2) of unit size in a recording, as means over samples show them."""
    if entry.moment is not None:
        now = one.turned_round(entry)
        if now.rise:
            timed = now.time_s is not None and one.time_s is not None
            along = one.time_s if timed else (one.theta_1 - one.theta_1[0]) / (2.0 * math.pi)
            middle = (now.time_s if timed else now.driving_turn) or 0.0
            return np.clip((np.asarray(along) - middle) / now.rise + 0.5, 0.0, 1.0)[:, None]
        at = sample_of(now, time_s=one.time_s, theta_1=one.theta_1)
        return (np.arange(one.theta_2.size) >= at).astype(np.float64)[:, None]
    if entry.kind == "time" and one.time_s is not None and entry.hz is not None:
        angle = 2.0 * math.pi * entry.hz * one.time_s
    else:
        angle = (entry.order or 0.0) * one.estimated[0 if entry.gear == "driving" else 1]
    waves = np.column_stack((np.cos(angle), np.sin(angle)))
    if one.averaged:
        # Means from sample to sample make a wave smaller by sin(x)/x.
        waves *= np.sinc(float(angle[-1] - angle[0]) / (2.0 * math.pi * (angle.size - 1)))
    return waves


def jumps(comparison: Comparison) -> list[list[int]]:
    """Samples at which every recording jumps."""
    return [
        [
            sample_of(one.turned_round(entry), time_s=one.time_s, theta_1=one.theta_1)
            for entry in comparison.located.entries
            if entry.moment and k in entry.recordings
        ]
        for k, one in enumerate(comparison.aligned)
    ]


def is_foreign(entry: Entry) -> bool:
    """Whether an entry is a wave that no gear pair and no encoder makes, or a jump; or one at a whole order where
    another part of the drive has a line too: left to the pair alone it would be made up of teeth and reliefs, even
    where it looks like what something larger brings along. Of 1.22 um of order 29 that a tooth 36 um proud was taken to
    bring, 19 teeth left 0.97 um of order 47 = 4 * 19 - 29, which was named an undulation."""
    if entry.burst is not None:
        return False
    if entry.companion_of is not None and not entry.parts:
        return False
    if entry.kind in IN_TIME:
        return not entry.drift
    if entry.kind != "shaft_order" or entry.order is None:
        return False
    return not float(entry.order).is_integer() or bool(entry.parts)


def found_alone(waves: Sequence[Sequence[int]], foreign: slice) -> list[list[int]]:
    """Parameters of the ``foreign`` columns by what was found of itself: one wave each, and all that is no wave."""
    known = {column for wave in waves for column in wave}
    rest = [[place] for place in range(foreign.start, foreign.stop) if place - foreign.start not in known]
    return [*([foreign.start + column for column in wave] for wave in waves), *rest]


def stands(system: System, places: list[int]) -> bool:
    """Whether parameters stand out together."""
    x = system.solution[places]
    return large(float(x @ np.linalg.solve(system.covariance[np.ix_(places, places)], x)), len(places))


def large(square: float, count: int) -> bool:
    """Whether ``count`` columns stand out whose sizes have this ``square`` over their covariance, with the chance of a
    single wave beyond ``STANDS``."""
    if count <= 2:
        return square > STANDS**2
    return bool(gammaincc(0.5 * count, 0.5 * square) < math.exp(-0.5 * STANDS**2))


def faded(system: System, waves: Sequence[Sequence[int]], foreign: slice) -> list[int]:
    """Those of ``waves`` that no longer stand out beside all that is believed, and whose loss costs next to nothing:
    what is now claimed had made them."""
    weak = [k for k, wave in enumerate(waves) if not stands(system, [foreign.start + column for column in wave])]
    while weak:
        gone = [foreign.start + column for k in weak for column in waves[k]]
        if system.without(gone).misfit - system.misfit < 2.0 * len(gone) + FADED_WAVES_MISFIT:
            return weak
        # Waves so near each other that either could go are weak one by one, and not together.
        weak = weak[: len(weak) // 2]
    return []
