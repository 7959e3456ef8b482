"""What recordings of one set show at the same place of the pair: it comes with the shafts, not with a moment.

Runs forth and back over one arc, or of one turn each, hold nothing that comes again within themselves. What shakes one
of them for a moment is a burst; what shakes several while the same teeth meet is those teeth, or the place of an
encoder. So it is with a slow course: one that every run shows alike is no drift of time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.bursts import LOUDER, MEDIAN_OF_SQUARE
from gearpoly.compare.entries import Entry, Gear
from gearpoly.compare.model import JointModel, State
from gearpoly.compare.regression import Solution
from gearpoly.units import FloatArray

Encoder = Callable[[int, int], float | None]
"""Encoder reading in deg at which tooth ``tooth`` of gear 1 or 2 passes the line of centres."""

OVERLAP = 0.9
"""Part of the longer of two recordings that both have to hold for their slow courses to be one: ends of runs, where
speeds change, are cut by a few hundredths."""

SAME_COURSE = 0.9
"""Correlation from which two slow courses are one; two drifts of three terms each reach it by chance one time in
ten, and every further run has to reach it too."""

COURSE = 200
"""Places at which slow courses are compared: they bend three times."""


@dataclass(frozen=True, kw_only=True)
class _Place:
    """A burst of recording ``k`` from ``low`` to ``high``, in meshes."""

    entry: Entry
    k: int
    low: float
    high: float

    @property
    def middle(self) -> float:
        return 0.5 * (self.low + self.high)


def come_again(
    entries: Sequence[Entry], search: JointModel, solution: Solution, *, numbered: tuple[bool, bool]
) -> list[Entry]:
    """The ``entries`` with bursts and slow courses that several recordings show alike as one place of the pair."""
    slow = [solution.beta[places["slow"][1:]] for places in search.places]
    courses = [s.slow[:, 1:] @ beta for s, beta in zip(search.states, slow, strict=True)]
    entries = of_the_teeth(
        entries, search.states, solution, numbered=numbered,
        encoder_deg=lambda gear, tooth: search.gears[gear - 1].encoder_deg(tooth),
    )  # fmt: skip
    return of_the_angle(entries, search.states, courses)


def of_the_teeth(
    entries: Sequence[Entry], states: Sequence[State], solution: Solution, *, numbered: tuple[bool, bool],
    encoder_deg: Encoder,
) -> list[Entry]:  # fmt: skip
    """The ``entries`` with bursts that several recordings show while the same teeth meet as one place of these."""
    bursts: list[Entry] = []
    others: list[Entry] = []
    for e in entries:
        (bursts if e.burst is not None else others).append(e)
    places = [_placed(e, states[e.recordings[0]]) for e in bursts]
    loud = [_Loud(s, s.noise.whitened(left)) for s, left in zip(states, solution.left, strict=True)]
    while places:
        first = max(places, key=lambda p: p.entry.gain)
        sampling = states[first.k].sampling
        same = [p for p in places if _meets(first, p, again=sampling.period)]
        if len({p.k for p in same}) < 2:
            others.append(first.entry)
            places.remove(first)
            continue
        met = {gear: _met(z, same, loud) for gear, z in ((1, sampling.z_1), (2, sampling.z_2))}
        # The gear whose tooth shook at most other meetings; else the driven one, whose teeth meet less often.
        own = 1 if _rank(met[1]) > _rank(met[2]) else 2
        if met[own]:
            z = sampling.z_1 if own == 1 else sampling.z_2
            same = [p for p in places if _meets(first, p, again=z)]
        places = [p for p in places if p not in same]
        others.append(_tooth(same, states, met, own=own, numbered=numbered, encoder_deg=encoder_deg))
    return others


def _placed(entry: Entry, s: State) -> _Place:
    """Where in the pair's course a burst lies."""
    along = s.data.time_s if entry.during_s is not None else (s.data.theta_1 - s.data.theta_1[0]) / (2.0 * math.pi)
    ends = entry.during_s or entry.during_turns
    assert along is not None  # a burst lasts over one of both
    assert ends is not None
    low, high = np.interp(ends, along, s.data.u).tolist()
    return _Place(entry=entry, k=entry.recordings[0], low=low, high=high)


def _meets(one: _Place, other: _Place, *, again: float) -> bool:
    """Whether what meets every ``again`` meshes meets in the middle of both bursts, to half the longer of both."""
    apart = (one.middle - other.middle + 0.5 * again) % again - 0.5 * again
    return abs(apart) < 0.5 * max(one.high - one.low, other.high - other.low)


class _Loud:
    """Whether a recording is loud at a place, whitened as ``white`` (n,)."""

    def __init__(self, s: State, white: FloatArray) -> None:
        self.u, self.square = s.data.u, white**2
        self.usual = float(np.median(self.square)) / MEDIAN_OF_SQUARE

    def at(self, low: float, high: float) -> bool | None:
        """Whether it is from ``low`` to ``high`` in meshes; ``None`` where it was not recorded."""
        first, last = np.searchsorted(self.u, (low, high))
        if last - first < 2:
            return None
        return float(np.mean(self.square[first:last])) > LOUDER * self.usual


def _met(z: int, places: list[_Place], loud: Sequence[_Loud]) -> int | None:
    """How many other meetings of the same tooth of a gear of ``z`` teeth were recorded; ``None`` where one of them was
    not loud."""
    others = 0
    for place in places:
        here = loud[place.k]
        most = int((here.u[-1] - here.u[0]) / z) + 1
        for turn in range(-most, most + 1):
            again = here.at(place.low + turn * z, place.high + turn * z) if turn else None
            if again is False:
                return None
            others += again is True
    return others


def _rank(met: int | None) -> int:
    return -1 if met is None else met


def _tooth(
    places: list[_Place], states: Sequence[State], met: dict[int, int | None], *, own: int,
    numbered: tuple[bool, bool], encoder_deg: Encoder,
) -> Entry:  # fmt: skip
    """What bursts are that come with a tooth of gear ``own``, its mate there as rival where that may be it as well."""
    strongest = max(places, key=lambda p: p.entry.gain)
    state = states[strongest.k]
    # On the coast flank driving tooth n meets driven tooth n + 1.
    mesh, late = round(strongest.middle), int(state.data.flank == "coast")
    teeth = {1: mesh % state.sampling.z_1, 2: (mesh + late) % state.sampling.z_2}
    names: dict[int, Gear] = {1: "driving", 2: "driven"}
    mate = 3 - own
    called = f"{names[mate]} tooth {teeth[mate]}" if numbered[mate - 1] else f"a tooth of the {names[mate]} gear"
    rivals = ["its encoder there"]
    if met[1] == met[2] == 0:
        rivals.insert(0, f"{called}, which meets it there")
    elif met[own] is None:
        rivals.insert(0, f"{called}, at that one meeting of both")
    recordings = tuple(sorted({p.k for p in places}))
    return Entry(
        kind="tooth",
        gear=names[own],
        tooth=teeth[own] if numbered[own - 1] else None,
        encoder_deg=encoder_deg(own, teeth[own]),
        rms_um=math.sqrt(sum((p.entry.rms_um or 0.0) ** 2 for p in places) / len(places)),
        recordings=recordings,
        p_value=min(p.entry.p_value for p in places),
        rivals=tuple(rivals),
        label=f"the same in {len(recordings)} recordings",
        gain=sum(p.entry.gain for p in places),
    )


def of_the_angle(entries: Sequence[Entry], states: Sequence[State], courses: Sequence[FloatArray]) -> list[Entry]:
    """The ``entries`` with slow ``courses`` (n,) that recordings over one arc show alike as one that comes with the
    angle."""
    drifts: list[Entry] = []
    out: list[Entry] = []
    for e in entries:
        (drifts if e.drift else out).append(e)
    drifts.sort(key=lambda e: -e.gain)
    while drifts:
        first, drifts = drifts[0], drifts[1:]
        k = first.recordings[0]
        same = [e for e in drifts if _one_course(k, e.recordings[0], states, courses)]
        drifts = [e for e in drifts if e not in same]
        out.append(_joined([first, *same]))
    return out


def _one_course(k: int, j: int, states: Sequence[State], courses: Sequence[FloatArray]) -> bool:
    """Whether recordings ``k`` and ``j`` hold the same arc on the same flank, and the same slow course over it."""
    a, b = states[k].data, states[j].data
    period = states[k].sampling.period
    shift = round((a.u[0] - b.u[0]) / period) * period
    low, high = max(a.u[0], b.u[0] + shift), min(a.u[-1], b.u[-1] + shift)
    longer = max(a.u[-1] - a.u[0], b.u[-1] - b.u[0])
    if a.flank != b.flank or high - low < OVERLAP * longer:
        return False
    at = np.linspace(low, high, COURSE)
    one, other = np.interp(at, a.u, courses[k]), np.interp(at - shift, b.u, courses[j])
    return float(np.corrcoef(one, other)[0, 1]) > SAME_COURSE


def _joined(same: list[Entry]) -> Entry:
    if len(same) == 1:
        return same[0]
    return replace(
        same[0],
        recordings=tuple(sorted(k for e in same for k in e.recordings)),
        amplitude_um=float(np.mean([e.amplitude_um for e in same if e.amplitude_um is not None])),
        rms_um=math.sqrt(float(np.mean([(e.rms_um or 0.0) ** 2 for e in same]))),
        p_value=min(e.p_value for e in same),
        label="low orders of a shaft, or a drift that each run repeats",
        gain=sum(e.gain for e in same),
    )
