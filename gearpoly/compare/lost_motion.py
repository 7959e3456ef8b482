"""The lost motion that recordings of both flanks show, beside the backlash that the simulation predicts there.

On one place of the hunting cycle the transmission error on the coast flanks is higher than on the drive flanks by the
lost motion, (TE_coast - TE_drive) r_b2 along the line of action, and j_bn without load. That asks for one zero of the
transmission error: runs of one file have it, and so have recordings of which both encoders were read.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.beside import Aligned, BesideSimulation
from gearpoly.units import ARCMIN, FloatArray, IntArray

PLACES_PER_PITCH = 8
"""Places per pitch at which both flanks are laid beside each other: hand-overs are a tenth of a pitch wide."""

ALONE_PITCHES = 0.5
"""Pitches between two samples of one flank across which nothing is said of it."""

SAME_TORQUE = 0.1
"""Relative difference of two torques that count as one: teeth give by as much more or less."""

SCATTER_PARTS = 12
"""Parts of the places whose scatter gives the standard error of the mean."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Lost:
    """Lost motion at driven rotations ``place`` (n,) in rad within the hunting cycle, rising: ``measured`` (n,) and
    ``simulated`` (n,) under the recorded load, and the ``backlash`` (n,) simulated without load, all in mm along the
    line of action. ``std`` in mm is the standard error of the mean of measured minus simulated, ``recordings`` the
    numbers of those of the drive and of the coast flank, ``z_2`` the driven teeth, ``cycle`` in rad, base radii in
    mm."""

    place: FloatArray
    measured: FloatArray
    simulated: FloatArray
    backlash: FloatArray
    std: float
    recordings: tuple[tuple[int, ...], tuple[int, ...]]
    z_2: int
    cycle: float
    r_b1: float
    r_b2: float

    def arcmin(self, along: float) -> float:
        """A lost motion in mm along the line of action as rotation of the driving shaft in arcmin."""
        return along / self.r_b1 / ARCMIN

    def driven_arcmin(self, along: float) -> float:
        """The same as rotation of the driven shaft."""
        return along / self.r_b2 / ARCMIN

    @property
    def beyond(self) -> float:
        """Mean of measured minus simulated, mm."""
        return float(np.mean(self.measured - self.simulated))

    def by_tooth(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """Over the driven turn: driven teeth (k,) whose pitch was recorded, and the mean of measured and of simulated
        (k,) in mm over the pitch about each."""
        tooth = np.mod(np.rint(self.place * (self.z_2 / (2.0 * math.pi))), self.z_2).astype(np.int64)
        held = np.bincount(tooth, minlength=self.z_2)
        there = np.flatnonzero(held)
        measured, simulated = (
            np.bincount(tooth, weights=x, minlength=self.z_2)[there] / held[there]
            for x in (self.measured, self.simulated)
        )
        return there, measured, simulated


def lost_motions(beside: BesideSimulation) -> tuple[Lost, ...]:
    """The lost motion of every torque under which both flanks were recorded from one zero; nothing where none was."""
    pair, out = beside.assembled.pair, []
    for drive, coast in _pairs(beside.aligned):
        found = _between(beside.aligned, drive, coast, z_2=pair.driven.gear.z, r_b1=pair.r_b1)
        if found is not None:
            out.append(found)
    return tuple(out)


def _pairs(aligned: Sequence[Aligned]) -> Iterator[tuple[list[int], list[int]]]:
    """Numbers of the recordings of the drive and of the coast flank that share a zero and a torque."""
    groups: list[list[int]] = []
    for k, one in enumerate(aligned):
        for group in groups:
            other = aligned[group[0]]
            if _zero_of(other) == _zero_of(one) and abs(one.torque - other.torque) <= SAME_TORQUE * max(
                one.torque, other.torque
            ):
                group.append(k)
                break
        else:
            groups.append([k])
    for group in groups:
        drive, coast = ([k for k in group if aligned[k].flank == flank] for flank in ("drive", "coast"))
        if drive and coast:
            yield drive, coast


def _zero_of(one: Aligned) -> object:
    """What the mean of a recording's transmission error counts from: the encoders' zeros, or a zero of the rig's that
    runs of one stretch share."""
    recording = one.cleaned.recording
    if not recording.computed:
        return None
    return one if recording.run is None else (recording.run.file, recording.run.stretch)


def _between(aligned: Sequence[Aligned], drive: list[int], coast: list[int], *, z_2: int, r_b1: float) -> Lost | None:
    first, other = aligned[drive[0]], aligned[coast[0]]
    cycle, pitch = first.template.cycle, 2.0 * math.pi / z_2
    x, *of_drive = _curves([aligned[k] for k in drive], cycle, pitch)
    there, *of_coast = _curves([aligned[k] for k in coast], cycle, pitch)
    # The cycle closes upon itself.
    around = np.concatenate((there[-1:] - cycle, there, there[:1] + cycle))
    at = np.searchsorted(around, x, side="right")
    near = np.diff(around)[np.clip(at - 1, 0, around.size - 2)] <= ALONE_PITCHES * pitch
    x = x[near]
    if x.size < PLACES_PER_PITCH:
        return None
    measured, simulated = (
        np.interp(x, around, np.concatenate((far[-1:], far, far[:1]))) - here[near]
        for here, far in zip(of_drive, of_coast, strict=True)
    )
    backlash = simulated
    for sign, one in ((1.0, first), (-1.0, other)):
        bend = one.template.deflection(x)
        backlash = backlash if bend is None else backlash + sign * bend
    parts = [float(np.mean(part)) for part in np.array_split(measured - simulated, SCATTER_PARTS) if part.size]
    return Lost(
        place=x,
        measured=measured,
        simulated=simulated,
        backlash=backlash,
        std=float(np.std(parts)) / math.sqrt(max(len(parts) - 1, 1)),
        recordings=(tuple(drive), tuple(coast)),
        z_2=z_2,
        cycle=cycle,
        r_b1=r_b1,
        r_b2=first.r_b2,
    )


def _curves(these: Sequence[Aligned], cycle: float, pitch: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Places (k,) in rad within the hunting cycle, rising, and the recorded and the simulated transmission error (k,)
    in mm there: means of cells, at the mean place in each, so that both are rounded alike at hand-overs."""
    place = np.concatenate([np.mod(one.theta_2, cycle) for one in these])
    _, cell = np.unique(np.floor(place * (PLACES_PER_PITCH / pitch)), return_inverse=True)
    held = np.bincount(cell)
    recorded, simulated = (
        np.concatenate(each) for each in zip(*((o.recorded, o.simulated) for o in these), strict=True)
    )
    x, te, expected = (np.bincount(cell, weights=values) / held for values in (place, recorded, simulated))
    return x, te, expected
