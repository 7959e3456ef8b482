"""Waves at ghost orders and drifts: free while teeth are placed; and of a ghost order no name of what makes but a small
part of it.

No pitch of the teeth makes a ghost order, so what was located there is of one cause. Where teeth as built bend a little
to follow it, what they leave looks like a wave of the flanks with an image there, and far smaller.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry
from gearpoly.compare.slow import SLOW_CURVE_TERMS, slow_curves
from gearpoly.diagnose.fit import Fit, joined, number_of, settled
from gearpoly.diagnose.model import Model, Observed
from gearpoly.diagnose.order_waves import STRONGEST, order_waves
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.unnamed import leaving
from gearpoly.errors import GearpolyError
from gearpoly.infer.posterior import Posterior
from gearpoly.infer.prior import kind_of, order_of
from gearpoly.infer.unknown import IMAGES, waves
from gearpoly.physics.base import Claim
from gearpoly.units import UM, FloatArray

GHOST_AMPLITUDE_PART = 0.5
"""Part of the amplitude at a ghost order that a claim has to make there, to be what is there. Lines of an encoder,
0.29 um as they were sampled, had left 0.03 um of an undulation, which was named. A judgement."""


def ghost_waves(comparison: Comparison, observed: Sequence[Observed]) -> list[FloatArray]:
    """Columns (n_k, q) of the waves at ghost orders that ``compare`` located, for each flank of the ``observed``
    recordings its own. No pitch makes them, so nothing but a claim explains them, and until there is one they must not
    move what is open: with 3 um of order 84 left out, teeth of 38 came to rest 0.09 pitches off and 0.4 times as
    soft, and nothing was found in the time given."""
    found = [one for one in comparison.located.entries if _is_ghost(one) and not _is_image(one, comparison)]
    orders = [(0 if one.gear == "driving" else 1, one.order or 0.0) for one in found[:STRONGEST]]
    return order_waves([one.samples for one in observed], orders)


def slow_ghosts(comparison: Comparison, model: Model) -> list[FloatArray]:
    """Columns (n_k, q) of a slow course of each recording in which `compare` located a drift, but where it is free
    anyway. Whether it has a name is asked with all else; until then it must not be made up of teeth: 0.9 um of a shaft
    that turned once in five and a half turns gave 60 teeth forms of their own, and these hid 18 um of a spall."""
    drifts = {k for one in comparison.located.entries if one.drift for k in one.recordings}
    asked = [k in drifts and not wanders for k, wanders in enumerate(model.scope.wanders)]
    many = (SLOW_CURVE_TERMS - 1) * sum(asked)
    out, at = [], 0
    for one, mine in zip(model.observed, asked, strict=True):
        columns = np.zeros((one.samples.size, many))
        if mine:
            columns[:, at : at + SLOW_CURVE_TERMS - 1] = slow_curves(one.samples.along)[:, 1:]
            at += SLOW_CURVE_TERMS - 1
        out.append(columns)
    return out


def _is_ghost(one: Entry) -> bool:
    return (one.label or "").startswith("ghost order") and one.companion_of is None and not one.parts


def _is_image(ghost: Entry, comparison: Comparison) -> bool:
    """Whether something larger was located that makes this order as well: a wave of pitches at the order of which this
    is an image (three waves of 61 um on 13 teeth come with orders 10, 16, 23 and 29), or what one tooth has."""
    z = comparison.gears[0 if ghost.gear == "driving" else 1].z
    apart, size = (ghost.order or 0.0) % z, ghost.amplitude_um or 0.0

    def larger(one: Entry) -> bool:
        of_tooth = one.kind == "tooth" and (one.rms_um or abs(one.amplitude_um or 0.0)) > size
        at_base = one.gear == ghost.gear and one.order == min(apart, z - apart) and (one.amplitude_um or 0.0) > size
        return of_tooth or at_base

    return any(larger(one) for one in (*comparison.located.entries, *comparison.located.where))


def left_to_ghosts(search: Fit, comparison: Comparison) -> Fit:
    """Without claims of waves that make but a part of what was located at a ghost order: a wave of no cause stands at
    that order from then on."""
    for claim in [one for one in search.model.claims if kind_of(one) == "wave" and order_of(one) is not None]:
        entry = next(_remnant_of(search, claim, comparison.located.entries), None)
        if entry is None or search.over:
            continue
        rms = search.model.rms_of(search.scenes, claim)
        place = Unearned(claim=claim, rms=rms, posterior=Posterior(claims=(), unknown=1.0, nothing=0.0), seen=True)
        wave = waves(search.scenes, 0 if entry.gear == "driving" else 1, (entry.order or 0.0,))[0].columns
        try:
            there = leaving(joined(search, [], instead=[number_of(search, claim)]), wave)
            search = settled(there.believing(unnamed=(*search.model.unnamed, place)))
        except GearpolyError:
            continue
    return search


def _remnant_of(search: Fit, claim: Claim, entries: Sequence[Entry]) -> Iterator[Entry]:
    """Ghost orders that are images of the wave of a claim, of whose amplitude it makes less than
    ``GHOST_AMPLITUDE_PART``."""
    z, own = [one.z for one in search.model.scope.gears], claim.place.gear or 0
    effect = search.model.change(search.scenes, claim, claim.values, but=claim)
    per_mesh = (order_of(claim) or 0) / z[own]
    for entry in entries:
        if not _is_ghost(entry):
            continue
        at = (entry.order or 0.0) / z[0 if entry.gear == "driving" else 1]
        if not any(math.isclose(abs(per_mesh + j), at, rel_tol=1e-9) for j in range(-IMAGES, IMAGES + 1)):
            continue
        made = max(
            _amplitude(one, at * scene.samples.theta_2 * z[1]) for scene, one in zip(search.scenes, effect, strict=True)
        )
        if made < GHOST_AMPLITUDE_PART * (entry.amplitude_um or 0.0) * UM:
            yield entry


def _amplitude(effect: FloatArray, angle: FloatArray) -> float:
    """Amplitude in mm of a wave (n,) over an ``angle`` (n,) in rad in an ``effect`` (n,)."""
    columns = np.column_stack((np.cos(angle), np.sin(angle), np.ones_like(angle)))
    return float(np.hypot(*np.linalg.lstsq(columns, effect, rcond=None)[0][:2]))
