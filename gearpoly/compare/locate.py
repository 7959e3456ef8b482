"""Where recordings and simulation differ: waves, single teeth, mesh phases, times, jumps and conditions, in the noise.

What an inspection or a grade leaves open of each tooth (pitch and slope) is fitted first, with its prior, together with
slow curves and whatever the caller knows to be uncertain (zeros, compliance). Then the strongest find of all searches
is taken into the fit, everything is fitted again, and so on until nothing exceeds what noise would do anywhere in the
search.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.bursts import burst_entries
from gearpoly.compare.comb import of_one_tooth, told_so
from gearpoly.compare.comes_again import come_again
from gearpoly.compare.describe import drift_entry, wave_entry, with_companions
from gearpoly.compare.describe_jumps import jump_entries
from gearpoly.compare.describe_places import condition_entries, phase_entries, tooth_entries
from gearpoly.compare.division import Division, divide
from gearpoly.compare.entries import Entry
from gearpoly.compare.even import even_in
from gearpoly.compare.fast import without_fast_waves
from gearpoly.compare.few_turns import first_order, without_first
from gearpoly.compare.long_jumps import without_jumps
from gearpoly.compare.maps import Maps, tooth_maps
from gearpoly.compare.masked import strong_waves
from gearpoly.compare.model import JointModel
from gearpoly.compare.noise import Noise, estimate_noise, pooled_level
from gearpoly.compare.reduce import shortening
from gearpoly.compare.regression import Solution
from gearpoly.compare.sampling import sampling_of
from gearpoly.compare.search import run_search
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.units import UM, FloatArray, read_only


@dataclass(frozen=True, kw_only=True, eq=False)
class Located:
    """What ``locate`` found. ``entries`` what stands out of what teeth may hold, surest first; ``where`` the same and
    the strongest orders that teeth could make, as large as the whole mismatch has them, that which holds most of it
    first; ``divisions`` of each recording's mismatch; ``noises`` one per recording, ``noise_level`` pooled, in mm;
    ``maps`` per recording of the residual without its slow curve; ``as_built`` (2 z_1 + 2 z_2,) in mm on the drive
    flank (driving pitch, driving slope, driven pitch, driven slope) and its ``as_built_std``; ``left`` what nothing
    explains, in mm; ``residual_rms`` and ``repeatable_rms`` (``None`` without whole cycles) in mm of the residuals as
    given. ``slow_terms`` of each recording's slow curve; ``orders`` in cycles per mesh, the whole ones of the fit."""

    entries: tuple[Entry, ...]
    where: tuple[Entry, ...]
    divisions: tuple[Division, ...]
    noises: tuple[Noise, ...]
    noise_level: float
    maps: tuple[Maps, ...]
    as_built: FloatArray
    as_built_std: FloatArray
    left: tuple[FloatArray, ...]
    residual_rms: float
    repeatable_rms: float | None
    slow_terms: tuple[int, ...]
    orders: tuple[float, ...] = ()

    @property
    def division(self) -> Division:
        """How the mismatch of all samples divides."""
        sizes = np.array([left.size for left in self.left], dtype=np.float64)
        rows = np.array([(one.physics, one.as_built, one.noise) for one in self.divisions])
        physics, as_built, noise = np.sqrt(sizes @ rows**2 / np.sum(sizes)).tolist()
        return Division(physics=physics, as_built=as_built, noise=noise)


def locate(
    residuals: Iterable[AlignedResidual],
    *,
    gears: tuple[GearKnown, GearKnown],
    recordings: int | None = None,
    floor: float = 0.0,
    numbered: tuple[bool, bool] = (True, True),
    likely: Sequence[float] = (),
    over: Callable[[], bool] = lambda: False,
) -> Located:
    """Where the ``residuals`` of one set (recorded minus simulated) are not what ``gears`` and their noise explain.

    ``gears`` driving and driven; ``recordings`` how many they are, where they are made one by one; ``floor`` in mm,
    below which the simulation itself is not true (chords, interpolation): smaller finds are left out; ``numbered``:
    whether zeros or inspection fix the tooth numbering of either gear; ``likely``: whole orders in cycles per mesh
    that somebody found before; ``over``: whether time is, so that only the strongest finds are taken. The result does
    not depend on any random number.
    Raises ``ValueError`` where a residual is too short for a noise estimate.
    """
    z_1, z_2 = gears[0].z, gears[1].z
    if recordings is None:
        residuals = list(residuals)
        recordings = len(residuals)
    sizes: list[int] = []
    squares: list[float] = []
    turns: list[float] = []
    parts: list[_Searched] = []
    for k, r in enumerate(residuals):
        sizes.append(r.residual.size)
        squares.append(float(np.var(r.residual)) * r.residual.size)
        turns.append(float(np.ptp(r.theta_1)) / (2.0 * math.pi))
        parts.append(_to_search(r, k=k, gears=gears, recordings=recordings, floor=floor))
        del r  # a long one is let go before the next is laid out
    short = [one.data for one in parts]
    search = JointModel(short, gears, floor)
    solution = run_search(search, over, likely=likely)
    entries = _entries([entry for one in parts for entry in one.entries], search, solution, numbered=numbered)
    where, divisions = divide(search, solution, entries)
    told = of_one_tooth(
        _as_recorded(entries, short, turns), z=(z_1, z_2), numbered=numbered,
        encoder_deg=lambda gear, tooth: gears[gear].encoder_deg(tooth),
    )  # fmt: skip
    # Of a shortened record every sample counts again for the level; of a whole one, what the fit left shows it best.
    noises = tuple(
        replace(one.noise or s.noise, repeatable=s.estimator.estimate(s.data.residual).repeatable)
        for one, s in zip(parts, search.states, strict=True)
    )
    std = np.sqrt(np.maximum(np.diag(solution.covariance), 0.0))
    return Located(
        entries=tuple(told),
        where=tuple(told_so(_as_recorded(where, short, turns), told)),
        divisions=divisions,
        noises=noises,
        noise_level=pooled_level(list(noises), sizes),
        maps=_maps(search, solution),
        as_built=read_only(solution.beta[: search.tooth_parameters]),
        as_built_std=read_only(std[: search.tooth_parameters]),
        left=tuple(read_only(left) for left in solution.left),
        residual_rms=math.sqrt(sum(squares) / sum(sizes)),
        repeatable_rms=_repeatable_rms(noises),
        slow_terms=tuple(s.slow.shape[1] for s in search.states),
        orders=tuple(sorted({one.frequency for s in search.states for one in s.orders if one.known and not one.few})),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Searched:
    """A residual as it is searched, ``data``, with the ``entries`` that were taken out of it before; ``noise`` of all
    its samples where it was shortened."""

    data: AlignedResidual
    entries: list[Entry]
    noise: Noise | None = None


def _to_search(
    r: AlignedResidual, *, k: int, gears: tuple[GearKnown, GearKnown], recordings: int, floor: float
) -> _Searched:
    """The residual of recording ``k`` without its jumps, a long one shortened, fast waves located before."""
    z_1, z_2 = gears[0].z, gears[1].z
    r, entries = without_jumps(r, k=k, gears=gears, floor=floor)
    u, time_s, residual = r.u, r.time_s, r.residual
    cut = shortening(u, z_1=z_1, z_2=z_2)
    even = even_in(r.theta_1, r.theta_2, r.time_s)
    one = replace(cut.of(r), even=even)
    if cut.size == u.size and cut.group == 1:
        return _Searched(data=one, entries=entries)
    strong = strong_waves(one, z_1=z_1, z_2=z_2, recordings=recordings, floor=floor)
    waves = sum((wave.at(u, time_s) for wave in strong), np.zeros(u.size))
    first = first_order(sampling_of(u=one.u, time=None, z_1=z_1, z_2=z_2))
    waves = residual - without_first(u, residual - waves, first)
    residual = residual - waves
    if cut.group == 1:
        return _Searched(data=one, entries=entries, noise=estimate_noise(u, residual, z_1=z_1, z_2=z_2).thinned())
    fast = without_fast_waves(
        u,
        time_s,
        residual,
        k=k,
        spacing=cut.group * cut.spacing,
        z_1=z_1,
        z_2=z_2,
        recordings=recordings,
        floor=floor,
        even=even,
    )
    data = replace(one, residual=cut.means(fast.residual + waves))
    return _Searched(data=data, entries=[*entries, *fast.entries], noise=fast.noise.thinned())


def _as_recorded(entries: Sequence[Entry], data: Sequence[AlignedResidual], turns: Sequence[float]) -> list[Entry]:
    """Entries as their first recording ran, backward too; ``turns`` of the driving gear in each."""
    firsts = [(e, e.recordings[0]) for e in entries]
    return [e.turned_round(turns[first]) if data[first].backward else e for e, first in firsts]


def _repeatable_rms(noises: Sequence[Noise]) -> float | None:
    """Rms in mm of what repeats in all recordings; ``None`` where one has no whole cycles."""
    repeats = [one.repeatable for one in noises if one.repeatable is not None]
    return math.sqrt(float(np.mean(np.square(repeats)))) if len(repeats) == len(noises) else None


def _entries(
    before: list[Entry], search: JointModel, solution: Solution, *, numbered: tuple[bool, bool]
) -> list[Entry]:
    """All that stands out, surest first: ``before`` the search, of each recording, and of all together."""
    entries = [*before, *_of_each(search, solution)]
    entries = come_again(entries, search, solution, numbered=numbered)
    entries += tooth_entries(search, solution, numbered=numbered)
    entries += phase_entries(search, solution)
    entries += condition_entries(search, solution)
    entries.sort(key=lambda e: -e.gain)
    coarse = [(s.data.coarse / UM, s.data.coarse_for_a_while / UM) for s in search.states]
    return with_companions(entries, z_1=search.z_1, z_2=search.z_2, coarse=coarse)


def _maps(search: JointModel, solution: Solution) -> tuple[Maps, ...]:
    """Each residual by tooth and mesh phase, its slow curve taken off."""
    maps = []
    for s, places in zip(search.states, search.places, strict=True):
        plain = s.data.residual - s.slow @ solution.beta[places["slow"]]
        maps.append(tooth_maps(s.data.u, plain, z_1=search.z_1, z_2=search.z_2, noise=s.noise))
    return tuple(maps)


def _of_each(search: JointModel, solution: Solution) -> list[Entry]:
    """Waves, jumps, bursts and drifts of each recording; waves that several share once."""
    entries: list[Entry] = []
    seen: set[int] = set()
    for k, s in enumerate(search.states):
        for peak in [*s.orders, *s.times]:
            if id(peak) in seen:
                continue
            seen.add(id(peak))
            entry = wave_entry(search, solution, k, peak)
            if entry is not None:
                entries.append(entry)
        entries += jump_entries(search, solution, k)
        entries += burst_entries(k, s.data, solution.left[k], s.noise, period=s.sampling.period)
        drift = drift_entry(search, solution, k)
        if drift is not None:
            entries.append(drift)
    return entries
