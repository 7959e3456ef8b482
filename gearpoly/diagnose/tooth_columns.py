"""What deviations of single teeth do to a recording, in blocks of samples: each about as long as a mesh, so that few
teeth touch in it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearpoly.diagnose.sparse import Sparse
from gearpoly.mesh.radial_search import compiled
from gearpoly.scene import Scene
from gearpoly.units import UM, FloatArray, IntArray

BLOCK_SAMPLES = 24, 512
"""Samples of a block of columns at least and at most: shorter ones cost more calls than products, longer ones hold more
zeros. All products of a 20/41 of 5510 samples whose teeth have a form each took 13.6, 13.2, 14.0 and 15.7 s with at
least 12, 16, 24 and 32; those of a pair of 11 500 samples of one form 5.4, 5.6 and 6.6 s with 32, 64 and 128."""


def tooth_columns(scene: Scene, *, at: tuple[int, int], size: int, waves: Sequence[int]) -> Sparse:
    """Effects (n, ``size``) in mm of one um of each parameter of the teeth of both gears, which stand from ``at`` on:
    index deviation and slope of every tooth, the bulge of all, and so many half ``waves`` of every tooth's form."""
    starts = _starts(scene)
    touching = []
    for gear in (0, 1):
        teeth = np.ascontiguousarray(scene.teeth(gear), dtype=np.int64)
        touching.append((teeth, np.ascontiguousarray(scene.spans[gear].u(scene.roll(gear)))))
    (teeth_1, u_1), (teeth_2, u_2) = touching
    weight = np.ascontiguousarray(scene.samples.sense * scene.weight * UM)
    z_1, z_2 = (scene.gear(gear).z for gear in (0, 1))
    first, columns, values = _laid(
        starts, weight, teeth_1, u_1, z_1, at[0], waves[0], teeth_2, u_2, z_2, at[1], waves[1]
    )
    return Sparse(shape=(scene.samples.size, size), starts=starts, first=first, at=columns, values=values)


@compiled
def _laid(
    starts: IntArray, weight: FloatArray, teeth_1: IntArray, u_1: FloatArray, z_1: int, at_1: int, waves_1: int,
    teeth_2: IntArray, u_2: FloatArray, z_2: int, at_2: int, waves_2: int,
) -> tuple[IntArray, IntArray, FloatArray]:  # fmt: skip
    """``first``, ``at`` and ``values`` of the columns of those teeth of both gears that carry, by their ``weight`` (p,
    n), in each block."""
    blocks, pairs = starts.size - 1, weight.shape[0]
    seen = np.zeros((2, blocks, max(z_1, z_2)), dtype=np.bool_)
    first, total = np.zeros(blocks + 1, dtype=np.int64), 0
    for b in range(blocks):
        for p in range(pairs):
            for i in range(starts[b], starts[b + 1]):
                if weight[p, i] != 0.0:
                    seen[0, b, teeth_1[p, i]] = True
                    seen[1, b, teeth_2[p, i]] = True
        c = 2 + np.count_nonzero(seen[0, b]) * (2 + waves_1) + np.count_nonzero(seen[1, b]) * (2 + waves_2)
        first[b + 1] = first[b] + c
        total += c * (starts[b + 1] - starts[b])
    at, values = np.empty(first[blocks], dtype=np.int64), np.zeros(total)
    begin = 0
    for b in range(blocks):
        c, n = first[b + 1] - first[b], starts[b + 1] - starts[b]
        block = values[begin : begin + c * n].reshape(n, c)
        begin += c * n
        size = 0
        for gear in range(2):
            z, start, waves = (z_1, at_1, waves_1) if gear == 0 else (z_2, at_2, waves_2)
            teeth, u = (teeth_1, u_1) if gear == 0 else (teeth_2, u_2)
            local = np.cumsum(seen[gear, b]) - 1
            count = int(np.count_nonzero(seen[gear, b]))
            here = at[first[b] + size : first[b] + size + count * (2 + waves) + 1]
            here[2 * count] = start + 2 * z
            for tooth in range(z):
                if seen[gear, b, tooth]:
                    k = local[tooth]
                    here[k], here[count + k] = start + tooth, start + z + tooth
                    for wave in range(waves):
                        here[2 * count + 1 + wave * count + k] = start + 2 * z + 1 + wave * z + tooth
            _fill(block[:, size : size + here.size], local, count, starts[b], teeth, weight, u, waves)
            size += here.size
    return first, at, values


@compiled
def _fill(
    out: FloatArray, local: IntArray, count: int, start: int, teeth: IntArray, weight: FloatArray, u: FloatArray,
    waves: int,
) -> None:  # fmt: skip
    """Add what each pair of ``teeth`` (p, n) does, from sample ``start`` on, to the columns ``out`` (k, c) of ``count``
    teeth, which stand in the order of ``local`` (z,)."""
    for p in range(teeth.shape[0]):
        for i in range(out.shape[0]):
            w = weight[p, start + i]
            if w == 0.0:
                continue
            tooth, along = local[teeth[p, start + i]], u[p, start + i]
            out[i, tooth] += w
            out[i, count + tooth] += w * (along - 0.5)
            out[i, 2 * count] -= w * (2.0 * along - 1.0) ** 2
            # Half waves from two on, each from the two before it.
            double = 2.0 * math.cos(math.pi * min(max(along, 0.0), 1.0))
            before, wave = 0.5 * double, 0.5 * double**2 - 1.0
            for k in range(waves):
                out[i, 2 * count + 1 + k * count + tooth] += w * wave
                before, wave = wave, double * wave - before


def _starts(scene: Scene) -> IntArray:
    """Where blocks of samples begin (b + 1,), the end added."""
    n = scene.samples.size
    meshes = float(np.ptp(scene.samples.theta_2)) / scene.gear(1).tau if n else 0.0
    rows = int(np.clip(n / max(meshes, 1.0), *BLOCK_SAMPLES))
    return np.append(np.arange(0, max(n, 1), rows), n)
