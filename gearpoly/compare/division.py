"""How the whole mismatch of a recording divides: into what is listed, what teeth may hold, and noise.

Teeth that nobody inspected may take a first order of tens of microns, the more of it the longer they are watched, and
then it stands out of nothing. Still the recording differs from the declared simulation by it. So the strongest orders
of both shafts are read off the whole mismatch, whatever teeth could take of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from gearpoly.compare.describe import kind_of
from gearpoly.compare.entries import IN_TIME, Entry
from gearpoly.compare.families import SHARES, log_tail_line
from gearpoly.compare.model import JointModel, State
from gearpoly.compare.regression import Solution
from gearpoly.compare.sinusoids import cosine_and_sine
from gearpoly.units import UM, FloatArray

LEAST_MISMATCH_PART = 0.1
"""Part of a recording's mean square mismatch that an order holds to be listed though teeth could take it: what holds
less changes the rms by less than 5 %. Teeth drawn within a grade hold some orders as strong, and these are listed."""

LARGEST_ORDERS_LISTED, LARGEST_ORDERS_SIGMAS = 4, 6.0
"""Orders that are listed though teeth could take them and hold less, the largest, and the standard errors by which
these stand out: who looks at the spectrum sees them. Of another stage's wave of 2.7 um at order 11 of the driven shaft,
beside a runout of 5.7 um, nothing was told. Judgements."""

FEWEST_TURNS_TO_LIST_ORDERS = 2.0
"""Turns of the slower shaft from which on these are listed: of 1.5 turns of a worm that showed nothing an order was.
A judgement."""

DIFFERS = 3.0
"""Standard errors by which the size of an order in the whole mismatch has to differ from that beside the teeth."""


@dataclass(frozen=True, kw_only=True)
class Division:
    """Rms in mm about the mean: ``physics``, what is listed; ``as_built``, the rest of what inspection or grade leave
    open of teeth, zeros and compliance; ``noise``, what is left. Their squares add up but for what they share."""

    physics: float
    as_built: float
    noise: float


@dataclass(frozen=True, kw_only=True)
class _Wave:
    """An order of a shaft in the whole mismatch: cycles per mesh, ``heights`` (2,) in mm with their error ``std``, and
    the log of the chance that noise makes it anywhere."""

    frequency: float
    heights: FloatArray
    std: float
    log_false: float

    @property
    def amplitude(self) -> float:
        return float(np.hypot(*self.heights))


def divide(
    search: JointModel, solution: Solution, entries: list[Entry]
) -> tuple[tuple[Entry, ...], tuple[Division, ...]]:
    """All places at which recordings and simulation differ, that which holds most of the mismatch first, and the
    division of every recording. ``entries`` are what stands out of what teeth may hold; they are listed as large as
    the whole mismatch has them."""
    drifts = {k for e in entries if e.drift for k in e.recordings}
    found: dict[float, dict[int, _Wave]] = {}
    divisions = []
    graded = all(gear.uncertainty is None for gear in search.gears)
    for k, s in enumerate(search.states):
        built, listed, fitted = _parts(search, solution, k, drift=k in drifts)
        waves, curve = _whole_waves(s, built + fitted + solution.left[k], graded=graded)
        for wave in waves:
            found.setdefault(wave.frequency, {})[k] = wave
        rest = s.data.residual - built - listed
        parts = (listed - fitted + curve, built + fitted - curve, rest)
        divisions.append(Division(**{f.name: float(np.std(x)) for f, x in zip(fields(Division), parts, strict=True)}))
    out = []
    for entry in entries:
        z = search.z_2 if entry.gear == "driven" else 1 if entry.kind == "mesh_order" else search.z_1
        waving = entry.kind in ("shaft_order", "mesh_order") and entry.order is not None and entry.order_std is None
        frequency = (entry.order or 0.0) / z
        same = next((f for f in found if abs(f - frequency) < 1e-9), None) if waving else None
        out.append(entry if same is None else _as_large(entry, found.pop(same), search))
    out += [_entry(search, by) for by in found.values()]
    whole = [s.data.residual for s in search.states]
    out = [one for one in out if one.amplitude_um != 0.0 and not beyond_all(one, whole)]

    def held(entry: Entry) -> float:
        data = search.states[entry.recordings[0]].data
        return holds(entry, z=(search.z_1, search.z_2), time_s=data.time_s, theta_1=data.theta_1)

    return tuple(sorted(out, key=lambda e: -held(e))), tuple(divisions)


def holds(entry: Entry, *, z: tuple[int, int], time_s: FloatArray | None, theta_1: FloatArray) -> float:
    """What an entry adds to the mean square in um^2 of a recording of gears of ``z`` teeth, sampled at ``time_s`` (n,)
    and ``theta_1`` (n,) in rad; a burst only while it lasts."""
    lasts = 1.0
    if entry.during_s is not None and time_s is not None:
        lasts = (entry.during_s[1] - entry.during_s[0]) / float(np.ptp(time_s))
    elif entry.during_turns is not None:
        lasts = (entry.during_turns[1] - entry.during_turns[0]) * 2.0 * math.pi / float(np.ptp(theta_1))
    return lasts * entry.mean_square(*z)


def _parts(search: JointModel, solution: Solution, k: int, *, drift: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What the fit gives to teeth, zeros and compliance (n,), to all that is listed (n,), and of that to whole orders
    of the shafts (n,), in mm."""
    s, stack, places = search.states[k], search.stacks[k], search.places[k]
    names = {int(where[0]): name for name, where in places.items() if where.size}
    listed, fitted, others = (np.zeros(s.data.u.size) for _ in range(3))
    # The first part holds the teeth's columns; what they do is not quite linear, and is all that the others leave.
    for part, where in stack.parts[1:]:
        name = names[int(where[0])]
        if name == "nuisance":
            continue
        curve = part.apply(solution.beta[where])
        others += curve
        if name != "slow" or drift or any(peak.few for peak in s.orders):
            listed += curve
        if name == "orders":
            known = np.repeat([peak.known and not peak.few for peak in s.orders], 2)
            fitted += part.apply(np.where(known, solution.beta[where], 0.0))
    return s.data.residual - solution.left[k] - others, listed, fitted


def _rows(s: State, frequencies: list[float]) -> FloatArray:
    return cosine_and_sine(s.data.u, np.array(frequencies))


def _whole_waves(s: State, values: FloatArray, *, graded: bool) -> tuple[list[_Wave], FloatArray]:
    """The orders of the shafts that the fit holds, and those that hold most of what it gives to teeth, as ``values``
    (n,) have them, and their curve (n,) in mm; ``graded``: nobody inspected either gear."""
    orders = s.sampling.orders
    # Of every mesh alike no single tooth holds anything: such orders stand out by themselves, or belong to laws.
    open_ = s.sampling.searched & (orders.place % orders.period != 0)
    open_[orders.whole.size :] = False
    taken = [
        int(np.argmin(np.abs(orders.frequency - peak.frequency))) for peak in s.orders if peak.known and not peak.few
    ]
    fitted = len(taken)
    # What inspected teeth may still have is no news, and of few turns the slow course has a part in every order.
    open_teeth = graded and float(np.ptp(s.data.u)) >= FEWEST_TURNS_TO_LIST_ORDERS * max(s.sampling.z_1, s.sampling.z_2)
    mean = float(np.mean(values))
    rest: FloatArray = values - mean
    heights: FloatArray = np.zeros(0)
    curve: FloatArray = np.zeros(values.size)
    while True:
        if taken:
            columns = _rows(s, orders.frequency[taken].tolist())
            heights = np.asarray(np.linalg.lstsq(columns, values - mean, rcond=None)[0], dtype=np.float64)
            curve = np.asarray(columns @ heights, dtype=np.float64)
            rest = values - mean - curve
        power = np.where(open_, np.abs(s.sampling.order_grid.transform(rest)[s.sampling.known]) ** 2, 0.0)
        best = int(np.argmax(power)) if power.size else 0
        # A wave of amplitude A has the sum n A / 2, and the mean square A^2 / 2.
        if not power.size or best in taken:
            break
        held = 2.0 * power[best] / values.size**2 >= LEAST_MISMATCH_PART * np.var(s.data.residual)
        # Power over that of noise, whose lines have n times its density.
        level = float(np.interp(orders.frequency[best], s.noise.frequency, s.noise.density))
        clear = open_teeth and 2.0 * power[best] >= LARGEST_ORDERS_SIGMAS**2 * level * values.size
        if not held and not (clear and len(taken) - fitted < LARGEST_ORDERS_LISTED):
            break
        taken.append(best)
    waves = []
    for j, at in enumerate(taken):
        frequency = float(orders.frequency[at])
        level = float(np.interp(frequency, s.noise.frequency, s.noise.density))
        mine = heights[2 * j :][:2]
        z = np.array([0.25 * float(mine @ mine) * values.size / level])
        count = s.noise.rest_at(np.array([frequency]))[1]
        log_false = float((math.log(orders.frequency.size / SHARES.orders) + log_tail_line(z, count))[0])
        damped = float(np.sinc(frequency * s.data.averaged))
        std = math.sqrt(2.0 * level / values.size)
        waves.append(_Wave(frequency=frequency, heights=mine / damped, std=std / damped, log_false=log_false))
    return waves, curve


def _as_large(entry: Entry, by: dict[int, _Wave], search: JointModel) -> Entry:
    """An order that stands out of what teeth may hold, as large as the whole mismatch has it where that differs: then
    the fit gave one part of it to teeth and another to a wave. It is nothing where both cancel."""
    best = max(by, key=lambda k: by[k].amplitude / by[k].std)
    size, std = by[best].amplitude / UM, by[best].std / UM
    if entry.amplitude_um is None or abs(size - entry.amplitude_um) < DIFFERS * (entry.std_um or 0.0):
        return entry
    if by[best].log_false >= 0.0:
        return replace(entry, amplitude_um=0.0)
    return replace(entry, amplitude_um=size, std_um=std, amplitude_um_by_recording=_sizes(by))


def beyond_all(entry: Entry, residuals: Sequence[FloatArray]) -> bool:
    """Whether a wave or a drift is larger than all that its recordings differ by, ``residuals`` (n_k,) in mm: then
    others, a fraction of a line beside it, cancel it, and none has that size. Of two driving turns 0.1 um rms were
    listed as waves of 164 and 162 um, of one turn 35 um as a drift of 521."""
    whole = max((float(np.ptp(residuals[k])) for k in entry.recordings), default=math.inf)
    waving = entry.kind in ("shaft_order", "mesh_order", *IN_TIME)
    return waving and abs(entry.amplitude_um or 0.0) * UM > whole


def _sizes(by: dict[int, _Wave]) -> tuple[float, ...] | None:
    return tuple(by[k].amplitude / UM for k in sorted(by)) if len(by) > 1 else None


def _entry(search: JointModel, by: dict[int, _Wave]) -> Entry:
    """An order that teeth could make within what inspection or grade leave open."""
    wave = max(by.values(), key=lambda one: one.amplitude / one.std)
    kind, gear, order, label, rivals = kind_of(search, wave.frequency)
    return Entry(
        kind="mesh_order" if kind == "mesh_order" else "shaft_order",
        gear=gear,
        order=order,
        amplitude_um=wave.amplitude / UM if wave.log_false < 0.0 else 0.0,
        std_um=wave.std / UM,
        amplitude_um_by_recording=_sizes(by),
        phase_deg=math.degrees(math.atan2(wave.heights[1], wave.heights[0])),
        recordings=tuple(sorted(by)),
        p_value=float(SHARES.orders * math.exp(min(0.0, wave.log_false))),
        label=label,
        rivals=rivals,
        gain=(wave.amplitude / wave.std) ** 2,
        as_built=True,
    )
