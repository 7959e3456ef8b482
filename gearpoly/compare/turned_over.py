"""A load that turns over while the shafts turn on: from there the other flanks carry, till it turns over again.

Derived here. A robot's arm hangs on one flank in one half of its turn and on the other in the other half. Between both
lies the backlash: the transmission error steps up to the coast flanks and down to the drive flanks, each time by as
much. Left in one piece such steps were taken for teeth of which three broke their limits. So the recording is parted:
what was recorded on either flank is a recording of its own, and the zero of both is one.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np

from gearpoly.errors import OutOfRangeError
from gearpoly.files.models import PairFile
from gearpoly.gear.tolerances import tolerances
from gearpoly.mesh.pair import GearPair
from gearpoly.recording.clean import Cleaned
from gearpoly.recording.recording import Flank, Recording
from gearpoly.recording.runs import middle
from gearpoly.units import ARCMIN, UM, BoolArray, FloatArray, IntArray

MEANS_PER_MESH = 8
"""Means per mesh that stand for the samples where changes are looked for."""

MESHES_BESIDE = 2
"""Meshes on either side whose means are compared, whole ones, so that the mesh's own waves do not count. Changes within
twice as many are one: a single tooth that stands out carries for one mesh or two, and is none."""

CHANGE_WITHIN_MESHES, CHANGE_LEFT_OUT_MESHES = 0.25, 0.5
"""Meshes on either side of a change within which it is taken to happen, and that are left out: a load of 6 N.m that
turns over once per turn of 61 teeth lets the flanks change within a fifth of a mesh, and is a part of a percent of the
backlash off at a half."""

STANDS_OUT = 8.0
"""Middle steps of the rest of a recording (times 1.48) from which on one is a change: teeth of a grade 7 that run off
their axis by 40 um have steps of 4 at most. A judgement between these and a backlash of 20."""

HEIGHT_SCATTER = 0.2
"""Part of the middle height by which the heights of changes may scatter (rms): backlash changes over the turns of both
gears by as much as they run off their axes."""

FEWEST_CHANGES = 3
"""Changes from which on they come again: two could be a knock and its repair."""

OF_TEETH = 3.0
"""Limits of single pitch that a change is more than: teeth do not step by as much, and they are asked first."""

COARSE_GRADE = 8
"""The grade that bounds such steps where none is stated."""

LARGEST_BACKLASH = 0.25
"""Part of the base pitch that no backlash reaches: beyond, teeth would be half as thick as their spaces."""


class _Change(NamedTuple):
    """Flanks change at ``u`` meshes, by ``height`` in mm: up to the coast flanks, down to the drive flanks."""

    u: float
    height: float


def parted(cleaned: Sequence[Cleaned], file: PairFile, pair: GearPair) -> list[Cleaned]:
    """The recordings, each in which the load turns over as two: what the drive and what the coast flanks carried."""
    return [part for one in cleaned for part in _parts(one, file, pair)]


def _parts(one: Cleaned, file: PairFile, pair: GearPair) -> list[Cleaned]:
    if file.worm is not None or one.recording.from_time:
        return [one]
    u = one.theta_2 / pair.driven.gear.tau
    found = _changes(u, one.te * pair.r_b2)
    least = OF_TEETH * _single_pitch(file, pair)
    if not _turns_over(found, least=least, most=LARGEST_BACKLASH * pair.driving.gear.p_b):
        return [one]
    at = np.array([change.u for change in found])
    state = np.searchsorted(at, u)
    up = np.array([found[0].height < 0.0, *(change.height > 0.0 for change in found)])[state]
    near = (
        np.abs(u - at[np.clip(np.searchsorted(0.5 * (at[1:] + at[:-1]), u), 0, at.size - 1)]) < CHANGE_LEFT_OUT_MESHES
    )
    height = float(np.mean([abs(change.height) for change in found]))
    spread = float(np.std([abs(change.height) for change in found]))
    said = (
        f"the load turns over {len(found)} times: the transmission error steps up and down by "
        f"{height / UM:.3g} +- {max(spread, 0.05 * UM) / UM:.2g} um along the line of action "
        f"({height / pair.r_b2 / ARCMIN:.3g} arcmin of the driven shaft) as flanks change, which is the backlash; what "
        "either flank carried is taken as a recording of its own"
    )
    out = [_of_flank(one, ~up & ~near, "drive", (said,)), _of_flank(one, up & ~near, "coast", ())]
    return [part for part in out if part.size >= one.size / 10] or [one]


def _changes(u: FloatArray, te: FloatArray) -> list[_Change]:
    """Where the transmission error ``te`` (n,) in mm at ``u`` (n,) meshes steps as nowhere else."""
    begin = float(np.min(u))  # a reading that jitters may come back behind the first
    cell = np.floor((u - begin) * MEANS_PER_MESH).astype(np.int64)
    held = np.bincount(cell)
    there = np.flatnonzero(held)
    if there.size < 4 * MESHES_BESIDE * MEANS_PER_MESH + 4:
        return []
    mean = np.interp(np.arange(held.size), there, np.bincount(cell, weights=te)[there] / held[there])
    sums = np.concatenate(([0.0], np.cumsum(mean)))
    width, gap = MESHES_BESIDE * MEANS_PER_MESH, max(1, round(CHANGE_WITHIN_MESHES * MEANS_PER_MESH))
    at = np.arange(2 * width + gap, mean.size - 2 * width - gap)

    def over(first: IntArray) -> FloatArray:
        return np.asarray((sums[first + width] - sums[first]) / width)

    before, after = over(at - gap - width), over(at + gap)
    # What changes smoothly changes on either side too.
    slope = 0.5 * ((before - over(at - gap - 2 * width)) + (over(at + gap + width) - after)) / width
    step = after - before - slope * (width + 2 * gap)
    size = np.abs(step)
    out: list[_Change] = []
    rest: BoolArray = np.ones(size.size, dtype=np.bool_)
    while size.size:
        best = int(np.argmax(np.where(rest, size, 0.0)))
        if not rest[best] or (out and size[best] < 0.5 * abs(out[0].height)):
            break
        out.append(_Change(u=begin + float(at[best]) / MEANS_PER_MESH, height=float(step[best])))
        # Within so much of a step the slopes beside it hold the step itself.
        rest[max(0, best - 2 * (width + gap)) : best + 2 * (width + gap) + 1] = False
    if not np.any(rest) or abs(out[0].height) < STANDS_OUT * 1.4826 * float(np.median(size[rest])):
        return []
    out.sort()
    edge = 2 * width + gap
    first, last = (round((one.u - begin) * MEANS_PER_MESH) for one in (out[0], out[-1]))
    at_begin = _in_end(mean, edge=edge, change=first, gap=gap, height=out[0].height)
    at_end = _in_end(mean[::-1], edge=edge, change=mean.size - last, gap=gap, height=-out[-1].height)
    if at_begin is not None:
        out.insert(0, _Change(u=begin + at_begin / MEANS_PER_MESH, height=-out[0].height))
    if at_end is not None:
        out.append(_Change(u=begin + (mean.size - at_end) / MEANS_PER_MESH, height=-out[-1].height))
    return out


def _in_end(mean: FloatArray, *, edge: int, change: int, gap: int, height: float) -> int | None:
    """The cell at which flanks change in the first ``edge`` cells of ``mean`` (m,), too near the end for a step to be
    weighed, where the next ``change`` is one by ``height``; None where they do not."""
    inner = slice(edge, min(2 * edge, change - gap)) if change - gap > edge + gap else slice(gap, change - gap)
    before = mean[: inner.start if inner.start > gap else max(0, change - edge // 2)]
    other = np.sign(height) * (before - float(np.median(mean[inner]))) > 0.5 * abs(height)
    if not other.size or not other[0]:
        return None
    return int(np.argmin(other)) if not other.all() else int(other.size)


def _turns_over(found: Sequence[_Change], *, least: float, most: float) -> bool:
    """Whether steps are changes of flank: up and down in turn, by as much, and by what is a backlash (between ``least``
    and ``most``, mm)."""
    if len(found) < FEWEST_CHANGES:
        return False
    height = np.array([abs(change.height) for change in found])
    in_turn = all(a.height * b.height < 0.0 for a, b in itertools.pairwise(found))
    alike = float(np.std(height)) < HEIGHT_SCATTER * float(np.median(height))
    return in_turn and alike and least < float(np.median(height)) < most


def _single_pitch(file: PairFile, pair: GearPair) -> float:
    """The larger limit of single pitch of both gears in mm, of grade ``COARSE_GRADE`` where no coarser one is stated;
    without end where the standard has none for such gears."""
    out = []
    for section, gear in ((file.driving, pair.driving.gear), (file.driven, pair.driven.gear)):
        grade = max(COARSE_GRADE, section.grade or 0)
        try:
            limits = tolerances(d=2.0 * gear.r, m=gear.m, b=gear.b, grade=grade, edition=section.grade_edition)
        except OutOfRangeError:
            return math.inf
        out.append(limits.f_pT)
    return max(out)


def _of_flank(one: Cleaned, here: BoolArray, flank: Flank, said: tuple[str, ...]) -> Cleaned:
    """The samples ``here`` (n,) of a recording, which this ``flank`` carried."""
    where = one.keep[here]
    recording = one.recording
    changes: dict[str, Any] = {}
    for field in fields(Recording):
        value = getattr(recording, field.name)
        if isinstance(value, np.ndarray):
            changes[field.name] = value[where]
    braked = -1.0 if middle(changes.get("torque_samples_nm")) < 0.0 else 1.0
    if "torque_samples_nm" in changes:
        changes["torque_samples_nm"] = braked * changes["torque_samples_nm"]
    source = recording.source.with_name(f"{recording.source.name}, {flank} flank")
    held: dict[str, Any] = {
        name: value[here] if (value := getattr(one, name)) is not None else None
        for name in ("theta_1", "theta_2", "te", "time_s", "torque_nm", "speed_rpm")
    }
    if held["torque_nm"] is not None:
        held["torque_nm"] = braked * held["torque_nm"]
    part = replace(
        recording, **changes, flank=flank, source=source, remarks=(*said, *(recording.remarks if said else ()))
    )
    return replace(one, recording=part, **held, keep=np.arange(where.size))
