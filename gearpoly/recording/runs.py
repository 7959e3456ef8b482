"""A recording in which the shafts turn forth and back, cut into its runs: each is a recording of its own, with its
sense and its flank.

Derived here. A shaft that turns round takes up the lost motion, and from then on the other flanks carry, unless the
load pulls them back; which it was is told by the torque where its sign was recorded, else by the lost motion itself.
Where readings are missing for longer than their turns can be told, runs are cut too. What turns one way only is left as
it is.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np

from gearpoly.errors import InputFileError, told_beside
from gearpoly.recording.clean import LEAST_DRIVING_TURNS
from gearpoly.recording.lost_motion import LostMotion, between
from gearpoly.recording.map_lines import entry, turned_round
from gearpoly.recording.recording import SHAFTS, Flank, Recording
from gearpoly.recording.reversals import (
    BACKWARD_LIMIT,
    REVERSALS_LIMIT,
    backward_limit,
    reversals,
    runs_on,
    turned_back,
)
from gearpoly.recording.run import Run
from gearpoly.recording.sense import FEWEST_SAMPLES_FOR_RUNS, pauses_between, turns_one_way, without_wraps
from gearpoly.recording.spikes import single_spikes
from gearpoly.units import TURN, BoolArray, FloatArray, IntArray

SHORT_RUN_PART = 0.1
"""Part of the longest run below which one is too short where the driving shaft was not read."""

RUN_FLANKS_WORDS = "flanks of the runs: "
"""How the word begins of what tells them."""

RUNS_NAMED = 4
"""Runs that a message names; the rest is counted."""


class _Stretch(NamedTuple):
    """Samples from ``first`` up to and with ``last``, in a sense of +1 or -1, of one count of turns ``block``."""

    first: int
    last: int
    sense: int
    block: int


@np.errstate(over="ignore", invalid="ignore")  # a damaged file may hold anything
def runs_of(recording: Recording) -> tuple[Recording, ...]:
    """The runs of a recording in their order, those too short to use among them; the recording itself where it turns
    one way only.

    Raises ``InputFileError`` where the torque points backward all along.
    """
    shafts = _shafts(recording)
    if turns_one_way(recording.time_s, *shafts.values()):
        check_torque(recording)
        return (recording,)
    rows = np.flatnonzero(np.logical_and.reduce([np.isfinite(one) for one in shafts.values()]))
    read = {name: one if rows.size == one.size else one[rows] for name, one in shafts.items()}
    first = next(iter(read))
    if rows.size < FEWEST_SAMPLES_FOR_RUNS or runs_on(read[first]):  # never wrapped, and never turned round
        check_torque(recording)
        return (recording,)
    pauses = pauses_between(recording.time_s, rows)
    whole: dict[str, FloatArray] = {}
    cuts = np.zeros(rows.size - 1, dtype=np.bool_)
    for name, reading in read.items():
        angle, unknown = without_wraps(reading, pauses)
        whole[name] = _direction(recording, name) * angle
        cuts |= unknown
        # The commonest case, without a look at the other shaft.
        if name == first and pauses.ordinary.all() and turned_back(angle) <= BACKWARD_LIMIT:
            check_torque(recording)
            return (recording,)
    stretches = _stretches(whole[first], next(reversed(whole.values())), cuts)
    if len({one.sense for one in stretches}) < 2:
        check_torque(recording)
        return (recording,)
    angles: dict[str, FloatArray] = {}
    for name, angle in whole.items():
        angles[name] = np.full(recording.size, np.nan)
        angles[name][rows] = angle * _direction(recording, name)
    pieces = [_piece(recording, angles, rows, one, (k, len(stretches))) for k, one in enumerate(stretches, start=1)]
    if all(_torque(one) < 0.0 for one in pieces):
        check_torque(recording)
    return _with_flanks(recording, pieces)


def is_long(one: Recording, runs: Sequence[Recording]) -> bool:
    """Whether one of several runs holds enough to be compared."""
    if one.run is None:
        return True
    longest = max(other.run.turns for other in runs if other.run is not None)
    return one.run.turns >= (LEAST_DRIVING_TURNS if one.run.shaft == "driving" else SHORT_RUN_PART * longest)


def usable(runs: Sequence[Recording]) -> list[Recording]:
    """The runs of one recording that are long enough to compare; the first has a word of those that are not.

    Raises ``InputFileError`` where none is.
    """
    long = [one for one in runs if is_long(one, runs)]
    short = [says(one) for one in runs if not is_long(one, runs)]
    if not long:
        file, most = next((one.run.file, one.run.turns) for one in _longest_first(runs) if one.run is not None)
        found = (
            f"{len(runs)} runs forth and back, the longest of {told_beside(most, LEAST_DRIVING_TURNS, 2)} driving turns"
        )
        least = f"{LEAST_DRIVING_TURNS:g} driving turn"
        wish = f"want at least {least} one way; gearpoly read tells the lost motion all the same"
        raise InputFileError(file, found=found, wish=wish)
    if not short:
        return long
    said = f"too short to use: {'; '.join(short[:RUNS_NAMED])}" + (
        f"; and {len(short) - RUNS_NAMED} more" * (len(short) > RUNS_NAMED)
    )
    return [replace(long[0], remarks=(*long[0].remarks, said)), *long[1:]]


def _longest_first(runs: Sequence[Recording]) -> list[Recording]:
    return sorted(runs, key=lambda one: -one.run.turns if one.run is not None else 0.0)


def check_torque(recording: Recording) -> None:
    """Refuse a torque that points backward.

    Raises ``InputFileError``.
    """
    torque = recording.torque_samples_nm
    # The middle value, since noise may take single samples of an unloaded pair below zero.
    if torque is None or torque.min() >= 0.0:  # in most recordings; nan where any reading is
        return
    if np.fmin.reduce(torque) < 0.0 and float(np.nanmedian(torque)) < 0.0:
        found = f"a median of {float(np.nanmedian(torque)):g} N.m"
        line = turned_round(recording.entries.get("torque_nm") or entry("torque_nm", "torque_nm", None))
        wish = (
            f"want a torque of 0 or more (the flank says which way it acts); in a map, if it counts backwards: {line}"
        )
        raise InputFileError(recording.source, where="column torque_nm", found=found, wish=wish)


def _shafts(recording: Recording) -> dict[str, FloatArray]:
    """The angles (n,) in rad that were read, the driving one first."""
    held = {name: getattr(recording, f"{name}_angle_rad") for name in SHAFTS}
    return {name: angle for name, angle in held.items() if angle is not None}


def _direction(recording: Recording, shaft: str) -> int:
    return recording.driving_direction if shaft == "driving" else recording.driven_direction


def _stretches(leader: FloatArray, follower: FloatArray, cuts: BoolArray) -> list[_Stretch]:
    """Runs in one direction, by the shaft that turns round first; each begins and ends where the other has turned so
    far that the lost motion is taken up."""
    edges = [0, *(np.flatnonzero(cuts) + 1).tolist(), leader.size]
    if len(edges) == 2 and turned_back(leader) <= BACKWARD_LIMIT:
        return []  # without a look at noise and spikes
    limit, taken = backward_limit(leader), backward_limit(follower)
    out: list[_Stretch] = []
    for block, (begin, end) in enumerate(itertools.pairwise(edges)):
        here = begin + np.flatnonzero(~single_spikes(leader[begin:end], moving=True))
        turned_at = reversals(leader[here], limit)
        # What comes after the last that is looked for is no run of one sense.
        ends = [0, *turned_at, *([here.size - 1] if len(turned_at) < REVERSALS_LIMIT else [])]
        for k, (a, b) in enumerate(itertools.pairwise(ends)):
            moved = float(leader[here[b]] - leader[here[a]])
            if abs(moved) <= limit:
                continue
            sense = 1 if moved > 0.0 else -1
            first, last = int(here[a]), int(here[b])
            turned = sense * follower[first : last + 1]
            if k > 0:  # till the follower has turned from where it stood farthest back
                first += int(np.argmax(turned > float(np.min(turned)) + taken))
            if k < len(turned_at):
                last -= int(np.argmax(turned[::-1] < float(np.max(turned)) - taken))
            if last > first:
                out.append(_Stretch(first, last, sense, block))
    return out


def _piece(
    recording: Recording, angles: dict[str, FloatArray], rows: IntArray, one: _Stretch, number: tuple[int, int]
) -> Recording:
    """The samples of one stretch, of that ``number`` among so many, on the flank that the file states."""
    here = slice(int(rows[one.first]), int(rows[one.last]) + 1)
    changes: dict[str, Any] = {}
    for field in fields(recording):
        value = getattr(recording, field.name)
        if isinstance(value, np.ndarray):
            changes[field.name] = value[here]
    for name, angle in angles.items():
        changes[f"{name}_angle_rad"] = angle[here]
    speed = changes.get("speed_samples_rpm")
    if speed is not None and middle(speed) < 0.0:
        changes["speed_samples_rpm"] = -speed
    shaft, angle = next(iter(angles.items()))
    run = Run(
        file=recording.source,
        number=number[0],
        of=number[1],
        rows=(here.start + 1, here.stop),
        turns=float(np.nanmax(angle[here]) - np.nanmin(angle[here])) / TURN,
        shaft=shaft,
        stretch=one.block,
    )
    source = recording.source.with_name(run.named)
    return replace(recording, **changes, backward=one.sense < 0, run=run, source=source)


def _with_flanks(recording: Recording, pieces: list[Recording]) -> tuple[Recording, ...]:
    """The pieces with their flanks, and what is to be said of them."""
    flanks, why, by_lost_motion = _flanks(recording.flank, pieces)
    out = []
    for k, (piece, flank) in enumerate(zip(pieces, flanks, strict=True)):
        torque = piece.torque_samples_nm
        if torque is not None and _torque(piece) < 0.0:
            torque = -torque
        assert piece.run is not None  # pieces are runs
        run = replace(piece.run, in_file=recording.flank) if by_lost_motion else piece.run
        # Of the file as a whole it is enough to speak once.
        remarks = (_on(piece, flank), *((RUN_FLANKS_WORDS + why, *recording.remarks) * (k == 0)))
        out.append(replace(piece, flank=flank, torque_samples_nm=torque, remarks=remarks, run=run))
    if len(out) >= REVERSALS_LIMIT and out[-1].run is not None:
        said = f"more than {REVERSALS_LIMIT} reversals: nothing after row {out[-1].run.rows[1]} is read"
        out[0] = replace(out[0], remarks=(*out[0].remarks, said))
    return tuple(out)


def carried_by_one(runs: Sequence[Recording], why: str) -> list[Recording]:
    """The runs of one file on the flank that it states for all of them, ``why`` beside it."""
    out = []
    for one in runs:
        assert one.run is not None  # runs of a file have one
        flank = one.run.in_file or one.flank
        remarks = [RUN_FLANKS_WORDS + why if said.startswith(RUN_FLANKS_WORDS) else said for said in one.remarks]
        remarks = [_on(one, flank) if said == _on(one, one.flank) else said for said in remarks]
        out.append(replace(one, flank=flank, remarks=tuple(remarks)))
    return out


def _on(one: Recording, flank: Flank) -> str:
    """What a run is, and on which flank."""
    return f"{says(one)}, {flank} flank"


def _torque(one: Recording) -> float:
    """The middle recorded torque in N.m, 0 where none was."""
    return middle(one.torque_samples_nm)


def middle(values: FloatArray | None) -> float:
    """The middle of what was read (n,), 0 where nothing was."""
    return 0.0 if values is None or not np.isfinite(values).any() else float(np.nanmedian(values))


def says(one: Recording) -> str:
    """What a run is, in words."""
    run = one.run
    assert run is not None  # the runs of a file have one
    return (
        f"run {run.number} of {run.of} in {run.file.name}, rows {run.rows[0]} to {run.rows[1]}, "
        f"{run.turns:.3g} {run.shaft} turns {'back' if one.backward else 'forward'}"
    )


def _flanks(stated: Flank, pieces: list[Recording]) -> tuple[list[Flank], str, bool]:
    """The flank of every piece, how it is known, and whether by a lost motion that only says that they change."""
    senses = [-1 if one.backward else 1 for one in pieces]
    torque = [_torque(one) for one in pieces]
    if min(torque) < 0.0 < max(torque) and len({s * t > 0.0 for s, t in zip(senses, torque, strict=True)}) == 1:
        return ["drive" if t > 0.0 else "coast" for t in torque], "the recorded torque changes its sign", False
    found = sorted((one for _, _, one in lost_motions(pieces)), key=lambda one: one.mean)
    if not found:
        main = 1 if sum(s * one.run.turns for s, one in zip(senses, pieces, strict=True) if one.run) >= 0.0 else -1
        why = "those one way as stated, the others taken to be braked too, since no two runs hold the same angles"
        other: Flank = "coast" if stated == "drive" else "drive"
        return [stated if s == main else other for s in senses], why, False
    one = found[len(found) // 2]
    if not one.seen:
        return [stated] * len(pieces), f"one flank carries both ways, with {one.says} between them", False
    forth: tuple[Flank, Flank] = ("drive", "coast") if one.mean > 0.0 else ("coast", "drive")
    why = f"lost motion of {_size(one).says} between both ways"
    return [forth[0] if s > 0 else forth[1] for s in senses], why, True


def _size(one: LostMotion) -> LostMotion:
    """The same without its sign."""
    return one if one.mean > 0.0 else replace(one, by=-one.by)


def lost_motions(runs: Sequence[Recording]) -> list[tuple[int, int, LostMotion]]:
    """Every two neighbouring runs, forth and back, that hold the same angles of one count of turns: their numbers from
    0, the one forth first, and the lost motion between them."""
    out = []
    for k, (one, other) in enumerate(itertools.pairwise(runs)):
        apart = one.run is None or other.run is None or one.run.stretch != other.run.stretch
        if one.backward == other.backward or apart:
            continue
        forth, back = (k + 1, k) if one.backward else (k, k + 1)
        found = between(runs[forth], runs[back])
        if found is not None:
            out.append((forth, back, found))
    return out
