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
least 12, 16, 24 and 32; those of a pair of 11 500 samples of one form 5.4, 5.6 and 6.6 s with 32, 64 and 128, while all
loops were compiled."""


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
    blocks = starts.size - 1
    first, total = np.zeros(blocks + 1, dtype=np.int64), 0
    local_1, local_2 = np.zeros(z_1, dtype=np.int64), np.zeros(z_2, dtype=np.int64)
    for b in range(blocks):
        count_1 = _numbered(starts[b], starts[b + 1], weight, teeth_1, local_1)
        count_2 = _numbered(starts[b], starts[b + 1], weight, teeth_2, local_2)
        c = 2 + count_1 * (2 + waves_1) + count_2 * (2 + waves_2)
        first[b + 1] = first[b] + c
        total += c * (starts[b + 1] - starts[b])
    at, values = np.empty(first[blocks], dtype=np.int64), np.zeros(total)
    begin = 0
    for b in range(blocks):
        c = first[b + 1] - first[b]
        count_1 = _numbered(starts[b], starts[b + 1], weight, teeth_1, local_1)
        count_2 = _numbered(starts[b], starts[b + 1], weight, teeth_2, local_2)
        own = count_1 * (2 + waves_1) + 1
        _named(at, first[b], local_1, count_1, at_1, waves_1)
        _named(at, first[b] + own, local_2, count_2, at_2, waves_2)
        _fill(values, begin, c, local_1, count_1, starts[b], starts[b + 1], teeth_1, weight, u_1, waves_1)
        _fill(values, begin + own, c, local_2, count_2, starts[b], starts[b + 1], teeth_2, weight, u_2, waves_2)
        begin += c * (starts[b + 1] - starts[b])
    return first, at, values


@compiled
def _numbered(start: int, end: int, weight: FloatArray, teeth: IntArray, local: IntArray) -> int:
    """Number the ``teeth`` (p, n) that carry from sample ``start`` to ``end`` in ``local`` (z,), -1 the others; how
    many they are."""
    for tooth in range(local.size):
        local[tooth] = -1
    for p in range(teeth.shape[0]):
        for i in range(start, end):
            if weight[p, i] != 0.0:
                local[teeth[p, i]] = 0
    count = 0
    for tooth in range(local.size):
        if local[tooth] == 0:
            local[tooth] = count
            count += 1
    return count


@compiled
def _named(at: IntArray, first: int, local: IntArray, count: int, start: int, waves: int) -> None:
    """Write which parameters the columns of ``count`` teeth are, from place ``first`` of ``at`` on: those of the gear
    stand from ``start`` on."""
    z = local.size
    at[first + 2 * count] = start + 2 * z
    for tooth in range(z):
        k = local[tooth]
        if k >= 0:
            at[first + k], at[first + count + k] = start + tooth, start + z + tooth
            for wave in range(waves):
                at[first + 2 * count + 1 + wave * count + k] = start + 2 * z + 1 + wave * z + tooth


@compiled
def _fill(
    values: FloatArray, begin: int, c: int, local: IntArray, count: int, start: int, end: int, teeth: IntArray,
    weight: FloatArray, u: FloatArray, waves: int,
) -> None:  # fmt: skip
    """Add what each pair of ``teeth`` (p, n) does from sample ``start`` to ``end`` to the columns of ``count`` teeth,
    which stand in the order of ``local`` (z,), ``c`` numbers a row, from ``begin`` of ``values`` on."""
    for p in range(teeth.shape[0]):
        for i in range(start, end):
            w = weight[p, i]
            if w == 0.0:
                continue
            row, tooth, along = begin + (i - start) * c, local[teeth[p, i]], u[p, i]
            values[row + tooth] += w
            values[row + count + tooth] += w * (along - 0.5)
            values[row + 2 * count] -= w * (2.0 * along - 1.0) ** 2
            # Half waves from two on, each from the two before it.
            double = 2.0 * math.cos(math.pi * min(max(along, 0.0), 1.0))
            before, wave = 0.5 * double, 0.5 * double**2 - 1.0
            for k in range(waves):
                values[row + 2 * count + 1 + k * count + tooth] += w * wave
                before, wave = wave, double * wave - before


def _starts(scene: Scene) -> IntArray:
    """Where blocks of samples begin (b + 1,), the end added."""
    n = scene.samples.size
    meshes = float(np.ptp(scene.samples.theta_2)) / scene.gear(1).tau if n else 0.0
    rows = int(np.clip(n / max(meshes, 1.0), *BLOCK_SAMPLES))
    return np.append(np.arange(0, max(n, 1), rows), n)
