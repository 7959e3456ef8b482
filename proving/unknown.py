"""The rival without a cause: a free wave of a shaft, a free curve of one tooth or of every mesh, a free slow course.

It can always come as near as it likes, so what tells it from a physics is how little the physics needs for that.
Derived here, Laplace about a linear Gaussian model: with a whitened signal s left after the nuisances and columns C
whose amplitudes have prior standard deviation 1, the log evidence over nothing is
1/2 b' (I + G)^-1 b - 1/2 log|I + G| with b = C' s, G = C' C. The physics has one column of the effect's own signal and
pays the same price for each of its freedoms; the unknown's columns are scaled to the effect's rms."""

from __future__ import annotations

from math import log, pi, sqrt
from typing import Any

import numpy as np

from proving.effects import Effect, apply
from proving.gears import FloatArray
from proving.limit import Limit, Sight
from proving.physics import PHYSICS
from proving.rig import Rig
from proving.rivals import whitened

HATS = 12
"""Hat functions over the two pitches in which one tooth can touch: a pit of a sixth of the flank is wider than one."""
HARMONICS = 6
"""Mesh harmonics of a free mesh curve; the steps between one and two pairs have a tenth of their size beyond."""
POWERS = 3
"""Powers of the time of a free slow course."""
FREEDOMS = {"wave": 2, "tooth": 1, "mesh": 1, "course": 1}
"""Freedoms of a physics at each kind of place: amplitude and phase, or a size."""


def _columns(rig: Rig, look: tuple[Sight, ...], effect: Effect) -> list[FloatArray]:
    """Columns (n, k) in each recording of what has no cause at the effect's place."""
    place, pair, out = PHYSICS[effect.physics].place, rig.pair, []
    gear = effect.gear or 2
    z = pair.gear(gear).z
    for number, one in enumerate(look):
        theta_2 = one.path.angle(one.time)
        theta = theta_2 if gear == 2 else theta_2 * pair.driven.z / pair.driving.z
        mesh = theta_2 * pair.driven.z / (2 * pi)
        if place == "wave":
            angle = effect.more.get("order", 1) * theta
            out.append(np.stack([np.cos(angle), np.sin(angle)], axis=1))
            continue
        if place == "tooth":
            away = (mesh - effect.more["tooth"] + z / 2) % z - z / 2
            at = np.linspace(-1.0, 1.0, HATS)
            free = np.maximum(0.0, 1.0 - np.abs(away[:, None] - at) / (at[1] - at[0]))
            out.append(free)
            continue
        if place == "mesh":
            turns = 2 * pi * mesh[:, None] * np.arange(1, HARMONICS + 1)
            free = np.hstack([np.cos(turns), np.sin(turns)])
        else:
            gone = (one.time - one.path.span[0]) / (one.path.span[1] - one.path.span[0])
            free = np.hstack([np.ones((gone.size, 1)), gone[:, None] ** np.arange(1, POWERS + 1)])
        # Curves and offsets of every condition of their own: who knows no cause cannot foretell one from another.
        own = np.zeros((free.shape[0], free.shape[1] * len(look)))
        own[:, number * free.shape[1] : (number + 1) * free.shape[1]] = free
        out.append(own)
    return out


def log_evidence(s: FloatArray, perp: FloatArray, columns: FloatArray, taken: FloatArray) -> float:
    """Log evidence over nothing of columns (n, k) with amplitudes of 1 for a whitened signal s; ``perp`` and ``taken``:
    signal and columns less what the nuisances take."""
    b, gram = columns.T @ perp, columns.T @ taken
    whole = np.eye(b.size) + 0.5 * (gram + gram.T)
    return float(0.5 * b @ np.linalg.solve(whole, b) - 0.5 * np.linalg.slogdet(whole)[1])


def unknown(rig: Rig, limit: Limit, effect: Effect) -> dict[str, Any]:
    """The unknown at the effect's place as truths tell of a rival.

    Its separability times the effect's size over the limit is the number of standard deviations that correspond to the
    log odds of the physics over it; ``log_odds`` has those themselves, before any prior."""
    s = whitened(rig, limit, effect)
    q = limit.size_of(s) ** 2
    free = np.concatenate([limit.whiten(a, limit.chain, c) for a, c in zip(
        limit.look, _columns(rig, limit.look, effect), strict=True)])  # fmt: skip
    norm = np.sqrt(np.einsum("ij,ij->j", free, free))
    free = free[:, norm > 1e-9 * norm.max()]
    size = float(s @ s) / max(float(np.einsum("ij,ij->", free, free)), 1e-300)
    free = sqrt(size) * free
    taken = np.stack([limit.perp(column) for column in free.T], axis=1)
    k = FREEDOMS[PHYSICS[effect.physics].place]
    named = 0.5 * q * q / (k + q) - 0.5 * k * log(1.0 + q / k)
    odds = named - log_evidence(s, limit.perp(s), free, taken)
    sigmas = sqrt(2.0 * max(odds, 0.0))
    over = sqrt(q)
    return {
        "physics": "unknown", "place": PHYSICS[effect.physics].place, "log_odds": round(odds, 2),
        "separability": round(min(sigmas / over, 1.0), 4) if over > 0.0 else 0.0,
    }  # fmt: skip


def missed(rig: Rig, limit: Limit, effect: Effect) -> float:
    """Part of the effect's signal (rms) that the unknown cannot make, whatever its size: 0 where it can make all."""
    s = limit.difference(apply(rig, effect))
    free = np.concatenate([limit.whiten(a, limit.chain, c) for a, c in zip(
        limit.look, _columns(rig, limit.look, effect), strict=True)])  # fmt: skip
    rest = s - free @ np.linalg.lstsq(free, s, rcond=None)[0]
    return float(np.linalg.norm(rest) / np.linalg.norm(s))
