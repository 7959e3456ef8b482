"""What a search takes into the fit at once: the strongest waves, or a tooth; and what of it turns out to be an echo."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from gearpoly.compare.fitted import fitted_wave
from gearpoly.compare.model import JointModel
from gearpoly.compare.peak import Peak
from gearpoly.compare.regression import Solution
from gearpoly.compare.teeth import ToothFind

TAKEN_TOGETHER, AS_STRONG = 0.1, 0.5
"""Waves with at least this part of the strongest one's gain are taken in the same round. Those with less than
``AS_STRONG`` of it may be its echo: they stay where the fit of all of them leaves them as much as a find needs."""

SAME_WAVE_LINES = 0.3
"""Independent lines within which two waves are one."""


def take_tooth(search: JointModel, teeth: list[ToothFind]) -> None:
    """Take the first of some teeth, the best, and say of which of the other gear it may be the image."""
    best = teeth[0]
    rival = next((t for t in teeth if t.gear != best.gear and t.gain > 0.9 * best.gain), None)
    if rival is not None:
        best = replace(best, rival=(rival.gear, rival.tooth))
    search.finds.append(best)
    for k, s in enumerate(search.states):
        alike = best.recording is None and s.data.flank == best.flank
        if alike or best.recording == k:
            s.teeth.append(search.new_tooth(s, best))


def take_waves(search: JointModel, waves: list[list[Peak]], best: float, *, likely: Sequence[float] = ()) -> list[Peak]:
    """Take the strongest waves, and those of whole orders that are ``likely`` (cycles per mesh); returns those that may
    be echoes."""
    echoes = list[Peak]()
    for k, peaks in enumerate(waves):
        for peak in peaks:
            if peak.gain < AS_STRONG * best and not peak.faint:
                strong = peak.gain >= TAKEN_TOGETHER * best
                if not peak.known or not (strong or any(abs(peak.frequency - one) < 1e-9 for one in likely)):
                    continue
                echoes.append(peak)
            if peak.domain == "time":
                search.states[k].times.append(peak)
                continue
            # What is fixed to a shaft is there in every recording; how large, each says for itself.
            for j, s in enumerate(search.states) if peak.known else [(k, search.states[k])]:
                here = [abs(p.frequency - peak.frequency) * s.sampling.span for p in s.orders]
                shown = j == k or peak.frequency < s.sampling.nyquist
                if shown and (not here or min(here) > SAME_WAVE_LINES):
                    s.orders.append(peak)
    return echoes


def without_echoes(search: JointModel, solution: Solution, faint: list[Peak]) -> bool:
    """Leave out those of the ``faint`` waves of whole orders, taken beside stronger ones, of which the fit leaves less
    than a find needs; whether there were any."""
    gone = set[int]()
    for peak in faint:
        mine = [k for k, s in enumerate(search.states) if any(peak is one for one in s.orders)]
        left = max((fitted_wave(search, solution, k, peak).square for k in mine), default=math.inf)
        # A line of noise gains so much by a chance of exp(-gain / 2): this is the gain at which one is expected.
        if left < peak.gain + 2.0 * peak.log_false:
            gone.add(id(peak))
    for s in search.states:
        s.orders = [one for one in s.orders if id(one) not in gone]
    return bool(gone)
