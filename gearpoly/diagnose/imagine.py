"""Recordings that are only thought of: under which conditions, simulated with what is believed at present."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from gearpoly.diagnose.model import Model
from gearpoly.diagnose.nuisance import OFFSET, LawModes, law_changes, law_modes
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim
from gearpoly.physics.samples import Samples
from gearpoly.scene import Scene, stage
from gearpoly.units import NM, RPM, FloatArray

IMAGINED_SAMPLES_PER_MESH = 12
"""Samples per mesh of a recording that is only thought of: six mesh orders."""

IMAGINED_HUNTING_CYCLES = 2
"""Hunting cycles of it."""

LIGHT_TORQUE_N_MM = 1.0 * NM
"""Torque that only keeps the flanks together."""

REFITTED = 0.5 * math.pi
"""Rotation in rad by which an encoder is refitted."""


@dataclass(frozen=True, kw_only=True)
class NextRecording:
    """A recording that could be made: ``flank``, ``torque`` in N.mm, ``speed`` in rad/s if it matters, ``refitted`` 0
    or 1: the encoder of that shaft turned on its shaft by a quarter turn, ``reversed``: run backwards."""

    flank: str
    torque: float
    speed: float | None = None
    refitted: int | None = None
    reversed: bool = False

    @property
    def says(self) -> str:
        """What to do, as a sentence."""
        if self.refitted is not None:
            name = ("driving", "driven")[self.refitted]
            return f"Turn the encoder on the {name} shaft by 90 deg on its shaft and record again."
        torque = f"{self.torque / NM:g} N.m"
        if self.reversed:
            return f"Run the pair backwards and record the {self.flank} flank at {torque}."
        speed = "" if self.speed is None else f" and {self.speed / RPM:.0f} rpm"
        return f"Record the {self.flank} flank at {torque}{speed}."

    def to_json(self) -> dict[str, object]:
        """The condition under the keys of a recording."""
        out: dict[str, object] = {"flank": self.flank, "torque_nm": self.torque / NM}
        if self.speed is not None:
            out["speed_rpm"] = self.speed / RPM
        if self.refitted is not None:
            out["refitted_encoder"] = ("driving", "driven")[self.refitted]
        if self.reversed:
            out["reversed"] = True
        return out


def options(model: Model) -> Iterator[NextRecording]:
    """Recordings worth thinking of: nearly no torque and full torque on both flanks, another speed, a refitted encoder,
    reversed rotation."""
    scope = model.scope
    full = max(*scope.torques, scope.file.torque_nm * NM)
    flank = scope.flanks[0]
    other = "coast" if flank == "drive" else "drive"
    made = {(f, round(t, 3)) for f, t in zip(scope.flanks, scope.torques, strict=True)}
    for side in (flank, other):
        for torque in dict.fromkeys(
            (LIGHT_TORQUE_N_MM, full if full > LIGHT_TORQUE_N_MM else 10.0 * LIGHT_TORQUE_N_MM)
        ):
            if (side, round(torque, 3)) not in made:
                yield NextRecording(flank=side, torque=torque)
    speeds = [speed for speed in scope.speeds if speed is not None]
    if speeds:
        yield NextRecording(flank=flank, torque=scope.torques[0], speed=2.0 * max(speeds))
    for shaft in (0, 1):
        if scope.encoders[shaft]:
            yield NextRecording(flank=flank, torque=scope.torques[0], refitted=shaft)
    if full > LIGHT_TORQUE_N_MM and not any(one.samples.backward for one in model.observed):
        yield NextRecording(flank=flank, torque=full, reversed=True)


def imagined(model: Model, made: NextRecording, *, number: int) -> Scene:
    """A whole recording of the present set-up under other conditions, evenly sampled."""
    first = model.observed[0].samples if model.observed else None
    assembled = model.assembled()
    pair = assembled.pair
    size = IMAGINED_HUNTING_CYCLES * pair.meshes_per_cycle * IMAGINED_SAMPLES_PER_MESH
    theta_2 = np.linspace(0.0, IMAGINED_HUNTING_CYCLES * pair.cycle, size, endpoint=False)
    theta_1 = theta_2 / pair.ratio
    speed = made.speed or (first.speed if first is not None else None)
    zero = [0.0, 0.0]
    if first is not None:
        zero = [float(first.reading_1[0] - first.direction_1 * first.theta_1[0])]
        zero.append(float(first.reading_2[0] - first.direction_2 * first.theta_2[0]))
    if made.refitted is not None:
        zero[made.refitted] += REFITTED
    sense = (first.direction_1, first.direction_2) if first is not None else (1, 1)
    samples = Samples(
        number=number,
        flank="coast" if made.flank == "coast" else "drive",
        torque=made.torque,
        speed=speed,
        theta_1=theta_1,
        theta_2=theta_2,
        time=None if speed is None else theta_1 / speed,
        reading_1=zero[0] + sense[0] * theta_1,
        reading_2=zero[1] + sense[1] * theta_2,
        direction_1=sense[0],
        direction_2=sense[1],
        counted=True,
        backward=made.reversed,
        middle=float(np.mean(theta_2)),
    )
    return stage(assembled, samples)


def effects(model: Model, scenes: Sequence[Scene], claim: Claim, *, but: Claim | None = None) -> list[FloatArray]:
    """What a claim does (n_k,) in mm in every scene."""
    return model.change([_as_recorded(model, scene, claim) for scene in scenes], claim, claim.values, but=but)


def _as_recorded(model: Model, scene: Scene, claim: Claim) -> Scene:
    """The scene, but that what every recording showed the next one shows too: where all began cold, it will."""
    every = claim.place.recordings
    if scene.samples.number < model.scope.conditions or len(every) < model.scope.conditions:
        return scene
    return replace(scene, samples=replace(scene.samples, number=every[0]))


@dataclass(kw_only=True, eq=False)
class Imagined:
    """Recordings of the ``model`` that are only thought of, simulated once for all that is asked of them; ``laws`` are
    the ways in which compliance laws differ in the recordings that were made (None: none is loaded)."""

    model: Model
    laws: LawModes | None
    _told: dict[tuple[str, float, bool], tuple[FloatArray, FloatArray]] = field(default_factory=dict)

    @cached_property
    def scenes(self) -> list[tuple[NextRecording, Scene]]:
        """All that the pair can run."""
        out = []
        for made in options(self.model):
            try:
                out.append((made, imagined(self.model, made, number=self.model.scope.conditions)))
            except GearpolyError:
                continue
        return out

    def doubt(self, scene: Scene) -> tuple[FloatArray, FloatArray]:
        """What is doubtful of how soft teeth are in a ``scene``, each a prior standard deviation in mm: the modes of
        the recordings (n, q), and what shows there only (n, p), the load's own share of it included."""
        n = scene.samples.size
        if not scene.bends:
            return np.zeros((n, 0 if self.laws is None else len(self.laws.mix))), np.zeros((n, 0))
        # A refitted encoder or another speed bends no tooth otherwise.
        key = scene.samples.flank, scene.samples.torque, scene.samples.backward
        if key not in self._told:
            self._told[key] = self._doubt(scene)
        return self._told[key]

    def _doubt(self, scene: Scene) -> tuple[FloatArray, FloatArray]:
        shared, own = np.zeros((scene.samples.size, 0)), np.zeros((scene.samples.size, 0))
        if self.laws is not None:
            shared, own = self.laws.under(scene)
        elif (alone := law_modes([scene], law_changes([scene]))) is not None:
            own = alone.parts[0]
        offset = OFFSET * float(np.mean(scene.bending(None) - scene.te))
        return shared, np.column_stack((own, np.full(scene.samples.size, offset)))
