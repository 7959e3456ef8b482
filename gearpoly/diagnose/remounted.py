"""Recordings of one set between which a gear, a coupling or an encoder was mounted anew: what turns once with a shaft
then differs from one to the other, and so does where the shafts' zeros are. No physics of one set-up does that."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.arguments import GEARS
from gearpoly.compare.entries import Entry
from gearpoly.diagnose.fit import Fit, better_of, settled
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.system import gain_of
from gearpoly.physics.samples import Samples
from gearpoly.units import UM, FloatArray

SURE = 100.0
"""Gain in misfit by which waves must differ between recordings of one flank: ten standard deviations."""

REMOUNTED_PART_OF_WAVE, REMOUNTED_PART_OF_DEFLECTION, REMOUNTED_PART_OF_LEFT = 0.2, 0.5, 0.5
"""Parts of the larger of both waves, of the mean deflection, and of the mean square of all that is left of either
recording, that the difference must have. A judgement, held by tests: an eccentric gear under two torques, a torque that
pulses by a tenth, and teeth of which nobody said that they bend stay one mounting. Four made mountings had 10.9 to 16.7
um."""


@dataclass(frozen=True, kw_only=True)
class Remounted:
    """Recordings ``first`` and ``other`` between which something on the shaft of a ``gear`` (0, 1) was mounted anew:
    once per turn they differ by ``wave`` in mm."""

    first: int
    other: int
    gear: int
    wave: float

    @property
    def says(self) -> str:
        """What the engineer should know."""
        return (
            f"recordings {self.first} and {self.other} are of the same flank, and differ by a wave of "
            f"{self.wave / UM:.3g} um once per turn of the {GEARS[self.gear]} shaft: no one mounting does that. A "
            "gear, a coupling or an encoder may have been mounted anew between them, a counter may have begun anew, or "
            'one ran on the other flank (flank = "coast" says so); no physics is named of such a set; record it '
            "without taking anything apart, or diagnose each recording alone"
        )


def remounted(model: Model, linear: Linear, *, deflection: float) -> Remounted | None:
    """Whether recordings of one flank show waves once per turn that differ as no one mounting does; ``deflection`` in
    mm, the mean of the loaded teeth. The largest difference."""
    return max(_differences(model, linear, deflection), key=lambda one: one.wave, default=None)


def without_smaller(search: Fit, entries: Sequence[Entry]) -> tuple[Fit, tuple[str, ...]]:
    """Without every claim that does less than what recordings still differ by beside all of them, ``entries`` of what
    is left, and a word about it: what nobody can explain between two recordings may have made it. Of two mountings
    under two torques, 7.7 um apart, 4 mrad of a misalignment were named; of 53 made sets of one mounting whose physics
    was named none was left apart."""
    # Means differ by zeros and by friction as well.
    sets = [one for one in entries if one.kind == "condition"]
    apart = max(sets, key=lambda one: one.turning_um or 0.0, default=None)
    model = search.model
    if apart is None or not model.claims:
        return search, ()
    size = (apart.turning_um or 0.0) * UM
    stay = tuple(one for one in model.claims if model.rms_of(search.scenes, one) > size)
    if len(stay) == len(model.claims):
        return search, ()
    where = " and ".join(str(k) for k in apart.recordings)
    return better_of(search, lambda one: settled(one.believing(claims=stay)), better=-math.inf), (
        f"recording {where} differs from the others by {size / UM:.2g} um rms, which nothing explains, so that no "
        "smaller physics is named: something may have been mounted anew in between, or a zero moved; record the set "
        "without taking anything apart, or diagnose each recording alone",
    )


def _differences(model: Model, linear: Linear, deflection: float) -> Iterator[Remounted]:
    samples = [one.samples for one in model.observed]
    # A foreign wave that lies near once per turn would hold what is looked for here.
    waves = [linear.layout.foreign.start + column for wave in model.strangers for column in wave]
    linear = linear.without(waves)
    for flank in ("drive", "coast"):
        mine = [k for k, one in enumerate(samples) if one.flank == flank]
        if len(mine) < 2:
            continue
        system = linear.system.with_columns(_white(linear, samples, mine))
        for other in mine[1:]:
            gain, sizes = gain_of(*system.scores(_white(linear, samples, [other])), np.array([[0, 1], [2, 3]]))
            gear = int(np.argmax(gain))
            wave = float(np.hypot(*sizes[gear]))
            whole = max(_size(linear, samples, k, gear) for k in (mine[0], other))
            left = max(float(np.var(linear.left()[k])) for k in (mine[0], other))
            most = max(
                REMOUNTED_PART_OF_WAVE * whole,
                REMOUNTED_PART_OF_DEFLECTION * deflection,
                math.sqrt(2.0 * REMOUNTED_PART_OF_LEFT * left),
            )
            if gain[gear] > SURE and wave > most:
                yield Remounted(first=mine[0], other=other, gear=gear, wave=wave)


def _white(linear: Linear, samples: Sequence[Samples], where: Sequence[int]) -> list[FloatArray]:
    """White waves (n_k, 4) of one turn of either shaft in some of the recordings, the same in all of these."""
    waves = [_once(one) if k in where else np.zeros((one.size, 4)) for k, one in enumerate(samples)]
    return [noise.whitened(one) for noise, one in zip(linear.noises, waves, strict=True)]


def _once(one: Samples) -> FloatArray:
    """Cosine and sine (n, 4) of one turn of either shaft."""
    return np.column_stack([wave(angle) for angle in (one.theta_1, one.theta_2) for wave in (np.cos, np.sin)])


def _size(linear: Linear, samples: Sequence[Samples], k: int, gear: int) -> float:
    """Amplitude in mm of what turns once with the shaft of a gear in what the fit leaves of a recording."""
    columns = np.column_stack((_once(samples[k]), np.ones(samples[k].size)))
    sizes = np.linalg.lstsq(columns, linear.left()[k])[0]
    return math.hypot(*sizes[2 * gear : 2 * gear + 2])
