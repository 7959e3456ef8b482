"""The zeros of both encoders: what the recordings state, what a place on the hunting cycle makes of it, as readings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gearpoly.compare.align import Laid, StatedZeros
from gearpoly.compare.curve import Cycle
from gearpoly.compare.place import Laying
from gearpoly.errors import InputFileError, told_beside
from gearpoly.mesh.pair import Flank
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, TURN, FloatArray

UNIFORM_STD = 1.0 / math.sqrt(12.0)
"""Standard deviation of what lies anywhere within 1."""

ROUGH = 0.5 * UNIFORM_STD * TURN
"""rad. A turn that the curves know to half of what anywhere would be is worth more than none."""

Numbering = Literal["curves", "stated", "open"]


@dataclass(frozen=True, kw_only=True)
class Base:
    """The zero readings in rad from which an alignment starts, one per shaft for the whole set; ``None`` where no
    recording states one."""

    driving: float | None
    driven: float | None

    @property
    def stated(self) -> StatedZeros:
        """Which of both are stated."""
        return StatedZeros(driving=self.driving is not None, driven=self.driven is not None)


@dataclass(frozen=True, kw_only=True)
class Zeros:
    """Readings in rad, 0 to 2 pi, of both encoders at the contract's angle zero, ``None`` where a shaft has no encoder;
    ``rms`` in mm that is left with them."""

    driving: float | None
    driven: float | None
    rms: float

    def moved(self, offset: float, *, ratio: float, directions: tuple[int, int]) -> Zeros:
        """The same where all turn by ``offset`` in rad of driven rotation more, ``ratio`` of the driving one."""
        held, by = (self.driving, self.driven), (offset / ratio, offset)
        there = [None if z is None else (z - way * b) % TURN for z, way, b in zip(held, directions, by, strict=True)]
        return replace(self, driving=there[0], driven=there[1])

    def near(self, other: Zeros) -> bool:
        """Whether both are the same to a degree."""
        pairs = ((self.driving, other.driving), (self.driven, other.driven))
        return all(a is None or b is None or abs(math.remainder(a - b, TURN)) < DEG for a, b in pairs)


@dataclass(frozen=True, kw_only=True, eq=False)
class Alignment:
    """Where the encoders of a set of recordings stand on the teeth.

    ``zeros`` with standard errors ``std_driving`` and ``std_driven`` in rad; ``rivals`` fit nearly as well, best first
    (and more than a handful stand for all); ``contradicted`` fits much better than what the stated zeros allow.
    ``phased``: the place within a pitch comes from the curves; else they tell at least the place in the turn
    (``rough``), or what was stated stands. ``numbering`` says what fixes the tooth numbers of both gears, if anything;
    ``numbered`` (driving, driven) whether those of each mean anything: one zero that is stated tells its own gear's.

    Per recording: ``shift`` in rad by which its driven rotation (by the base zero) is too large, ``offset`` in mm by
    which its transmission error is. ``further`` in rad is how far on in the hunting cycle each rival has the first.
    """

    zeros: Zeros
    std_driving: float
    std_driven: float
    rivals: tuple[Zeros, ...]
    contradicted: Zeros | None
    phased: bool
    rough: bool
    numbering: Numbering
    numbered: tuple[bool, bool]
    shift: FloatArray
    offset: FloatArray
    further: tuple[float, ...] = ()

    def moved(self, offset: float, *, ratio: float, directions: tuple[int, int], z: tuple[int, int]) -> Alignment:
        """The same where all turn by ``offset`` in rad of driven rotation more, both shafts together; ``ratio`` is that
        of the driven over the driving rotation, ``z`` teeth. What was found first becomes the first rival. A gear that
        then stands at another tooth was not numbered."""
        zeros = self.zeros.moved(offset, ratio=ratio, directions=directions)
        rivals = (self.zeros, *(one for one in self.rivals if not one.near(zeros)))
        stays = [
            abs(math.remainder(by, TURN)) < 0.5 * TURN / n for by, n in zip((offset / ratio, offset), z, strict=True)
        ]
        numbered = (self.numbered[0] and stays[0], self.numbered[1] and stays[1])
        return replace(self, zeros=zeros, shift=self.shift - offset, rivals=rivals, further=(), numbered=numbered)

    def refined(self, shift: float, std: float, *, ratio: float, directions: tuple[int, int]) -> Alignment:
        """The same with zeros that a fit of everything moved by ``shift`` in rad of driven rotation, to ``std``, where
        the curves had placed the teeth at all."""
        zeros = self.zeros.moved(shift, ratio=ratio, directions=directions)
        known = (std / ratio, std) if self.phased else (self.std_driving, self.std_driven)
        return replace(self, zeros=zeros, std_driving=known[0], std_driven=known[1])

    @property
    def std(self) -> float:
        """The larger standard error of both zeros, rad."""
        known = [
            std
            for std, zero in ((self.std_driving, self.zeros.driving), (self.std_driven, self.zeros.driven))
            if zero is not None
        ]
        return max(known)


def base_zeros(recordings: Sequence[Recording], *, z_1: int, z_2: int) -> Base:
    """The middle of all stated zeros, per shaft.

    Raises ``InputFileError`` where two of them differ by more than half a tooth, or an encoder counts both ways.
    """
    for shaft in ("driving", "driven"):
        read = [r for r in recordings if getattr(r, f"{shaft}_angle_rad") is not None]
        ways = [int(getattr(r, f"{shaft}_direction")) for r in read]
        for other, way in zip(read, ways, strict=True):
            if way != ways[0]:
                raise InputFileError(
                    other.source,
                    where=f"{shaft}_direction",
                    found=f"{way}, but {ways[0]} in {read[0].source}",
                    wish="want one direction per encoder, since recordings of one set share it; or compare one by one",
                )
    return Base(driving=_base(recordings, "driving", z_1), driven=_base(recordings, "driven", z_2))


def _base(recordings: Sequence[Recording], shaft: Literal["driving", "driven"], z: int) -> float | None:
    held = [
        (r, zero)
        for r in recordings
        if (zero := r.driving_zero_rad if shaft == "driving" else r.driven_zero_rad) is not None
    ]
    if not held:
        return None
    origin, first = held[0]
    apart = [math.remainder(zero - first, TURN) for _, zero in held]
    low, high = int(np.argmin(apart)), int(np.argmax(apart))
    if apart[high] - apart[low] > math.pi / z:
        later = max(low, high)
        other = held[min(low, high)][0] if min(low, high) else origin
        off = told_beside((apart[high] - apart[low]) / DEG, 180.0 / z, 3)
        found = f"{held[later][1] / DEG:.3f}, {off} deg from that of {other.source}"
        wish = (
            f"want readings of one zero, to half a tooth ({180.0 / z:.3f} deg), since recordings of one set share it; "
            "or compare them one by one"
        )
        raise InputFileError(held[later][0].source, where=f"{shaft}_zero_deg", found=found, wish=wish)
    return first + sum(apart) / len(apart)


@dataclass(frozen=True, kw_only=True)
class ShaftsRead:
    """What the recordings hold of both shafts: whether each has an encoder, which way it counts, and per recording
    whether both were read (``counted``), whether its mean compares with those of the others (``compared``), and the
    flank and torque (N.mm) it was made on."""

    driving: bool
    driven: bool
    direction_1: int
    direction_2: int
    counted: tuple[bool, ...]
    compared: tuple[bool, ...]
    flank: tuple[Flank, ...]
    torque: tuple[float, ...]


def settle(laid: Laid, cycle: Cycle, *, base: Base, shafts: ShaftsRead) -> Alignment:
    """Make zeros of a place on the cycle, or keep what is stated where the curves have nothing to say."""
    anchor = _anchor(shafts)
    both = shafts.driving and shafts.driven
    # Two counted turns leave nothing open but the place within half a tooth, of which a flat curve knows less.
    whole = shafts.counted[anchor] and base.driving is not None and base.driven is not None

    def placed(one: Laying) -> Laying:
        if laid.phased:
            return one
        return _kept(one, cycle, anchor) if whole else _held(one, cycle, base, shafts, anchor)

    best = placed(laid.best)
    rate = cycle.pitch * cycle.r_b2
    offset = np.empty(best.offset.size)
    for k, (counted, compared) in enumerate(zip(shafts.counted, shafts.compared, strict=True)):
        if not compared:
            offset[k] = best.offset[k]
            continue
        # A transmission error that the rig computed has its own zero, which is not that of the encoders.
        origin = anchor if counted else shafts.counted.index(False)
        offset[k] = best.offset[origin] + round((best.offset[k] - best.offset[origin]) / rate) * rate
    if laid.phased:
        std_2 = laid.std
        std_1 = math.hypot(laid.std, laid.offset_std / cycle.r_b2 if both else 0.0) / cycle.ratio
    else:
        std_1 = laid.spread[0] if base.driving is None else UNIFORM_STD * TURN / cycle.z_1
        std_2 = laid.spread[1] if base.driven is None else UNIFORM_STD * TURN / cycle.z_2
    stated = base.driving is not None if not shafts.driven else base.driven is not None
    if both:
        stated = stated and base.driving is not None
    rough = laid.phased or (not whole and min(laid.spread) < ROUGH)
    numbering: Numbering = "open"
    if laid.certain or (laid.numbered and not stated):
        numbering = "curves"
    elif stated and ((whole and not laid.phased) or not laid.rivals):
        numbering = "stated"
    rivals = [placed(one) for one in laid.rivals] if rough else []
    zeros = _zeros(best, cycle, base, shafts, anchor)
    others = tuple(_zeros(one, cycle, base, shafts, anchor) for one in rivals)
    told = numbering != "open"
    return Alignment(
        zeros=zeros,
        std_driving=std_1,
        std_driven=std_2,
        rivals=others,
        contradicted=None if laid.contradicted is None else _zeros(laid.contradicted, cycle, base, shafts, anchor),
        phased=laid.phased,
        rough=rough,
        numbering=numbering,
        numbered=(
            told or _kept_tooth(base.driving, [one.driving for one in (zeros, *others)], cycle.z_1),
            told or _kept_tooth(base.driven, [one.driven for one in (zeros, *others)], cycle.z_2),
        ),
        shift=best.shifts,
        offset=offset,
        further=tuple(one.shift - best.shift for one in rivals),
    )


def _kept_tooth(stated: float | None, zeros: list[float | None], z: int) -> bool:
    """Whether the place found and all its rivals, with these ``zeros`` of one gear, have the tooth there that its
    ``stated`` zero has, to the half tooth by which that may be wrong."""
    if stated is None or None in zeros:
        return False
    return all(abs(math.remainder((one or 0.0) - stated, TURN)) < 0.5 * TURN / z for one in zeros)


def _anchor(shafts: ShaftsRead) -> int:
    """The recording whose mean TE fixes the driving zero: on the drive flank, since thickness moves the coast flank,
    and under the least torque, since compliance is uncertain."""
    order = sorted(
        range(len(shafts.counted)),
        key=lambda k: (not shafts.counted[k], shafts.flank[k] == "coast", shafts.torque[k], k),
    )
    return order[0]


def _held(one: Laying, cycle: Cycle, base: Base, shafts: ShaftsRead, anchor: int) -> Laying:
    """A place that the curves know to a few degrees only, moved to where the one zero that is stated has it."""
    driving, driven = _late(one, cycle, shafts, anchor)
    by = 0.0
    if base.driven is not None:
        by = -math.remainder(driven, TURN)
    elif base.driving is not None:
        by = -math.remainder(driving, TURN) * cycle.ratio
    return Laying(shift=one.shift + by, shifts=one.shifts + by, offset=one.offset, rms=one.rms)


def _kept(best: Laying, cycle: Cycle, anchor: int) -> Laying:
    """The place that two stated zeros give where the curve is too flat to say: driven rotation as stated, and what the
    mean transmission error adds to it."""
    total = float(best.offset[anchor]) / cycle.r_b2
    g = math.gcd(cycle.z_1, cycle.z_2)
    pitches = g * round(total / (g * cycle.pitch))
    # What is left is late_2 - ratio late_1. Both zeros are rough alike, so the doubt is shared by least squares.
    late = (total - pitches * cycle.pitch) / (1.0 + cycle.ratio**2)
    period = cycle.z_1 // g
    inverse = pow(cycle.z_2 // g, -1, period) if period > 1 else 0
    shift = late + (pitches // g * inverse % period) * TURN
    moved = (shift - float(best.shifts[anchor])) % cycle.span
    return Laying(shift=best.shift + moved, shifts=best.shifts + moved, offset=best.offset, rms=best.rms)


def _late(place: Laying, cycle: Cycle, shafts: ShaftsRead, anchor: int) -> tuple[float, float]:
    """By how much the present zeros of the driving and the driven shaft are late, rad."""
    driven = float(place.shifts[anchor])
    mean = float(place.offset[anchor]) / cycle.r_b2 if shafts.counted[anchor] else 0.0
    return (driven - mean) / cycle.ratio, driven


def _zeros(place: Laying, cycle: Cycle, base: Base, shafts: ShaftsRead, anchor: int) -> Zeros:
    """The readings that a place means."""
    late_1, late_2 = _late(place, cycle, shafts, anchor)
    driving = ((base.driving or 0.0) + shafts.direction_1 * late_1) % TURN
    driven = ((base.driven or 0.0) + shafts.direction_2 * late_2) % TURN
    return Zeros(driving=driving if shafts.driving else None, driven=driven if shafts.driven else None, rms=place.rms)
