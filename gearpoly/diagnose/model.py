"""What is believed: the declared pair, what is estimated of it, and the recordings beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.compare.noise import Noise, NoiseEstimator
from gearpoly.diagnose.as_built import AsBuilt
from gearpoly.diagnose.budget import Budget
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.unearned import Unearned
from gearpoly.errors import GearpolyError
from gearpoly.files.models import PairFile
from gearpoly.keys.edit import changed
from gearpoly.physics.base import Claim, Scope
from gearpoly.physics.place import Values
from gearpoly.physics.samples import Samples
from gearpoly.physics.tooth_deflection import PHYSICS as TOOTH_DEFLECTION
from gearpoly.scene import Scene
from gearpoly.threads import each
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Observed:
    """A recording: its ``samples``, the ``recorded`` transmission error (n,) in mm; ``fit`` (n,) marks the samples that
    a cross-validated fit sees (``whole``: whole hunting cycles); ``estimator`` of its noise; ``jumps``: samples at
    which it jumps."""

    samples: Samples
    recorded: FloatArray
    fit: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
    whole: bool
    estimator: NoiseEstimator
    jumps: tuple[int, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class Model:
    """What is believed at present.

    ``declared`` is the pair file with stand-ins for what nobody measured, ``built`` (m,) in um the as-built parameters;
    ``scale`` the compliance over the declared; ``shift`` in rad of driven rotation by which the alignment was late;
    ``rates`` by how much the clock of each recording is off, whose angle was made of time (none: by nothing);
    ``phased``: the alignment placed the teeth within their pitch, ``stated``: it took the zeros that were read;
    ``elsewhere`` in rad of driven rotation is how far on in the hunting cycle it may be as well; ``offset`` how far all
    was moved since.
    ``law`` the compliance laws of tooth and contact that fit best (None: the declared ones), ``ratio`` the factor by
    which the declared ones give as much in the mean;
    ``strangers`` are the waves that the recordings hold and no gear pair makes, each by its foreign columns;
    ``unnamed`` are the places at which an unknown cause was likelier than any physics from the start;
    ``slow_courses`` how many foreign columns, the last ones, are of slow courses without a name;
    ``claims`` the physics accepted so far; ``smoothing`` in mm: how far behind the first touch pairs of unloaded teeth
    count as touching, where a fit begins; ``method`` what of the method is in use; ``budget`` how long may be looked.
    """

    declared: PairFile
    path: Path
    scope: Scope
    as_built: AsBuilt
    observed: tuple[Observed, ...]
    shift_std: float
    built: FloatArray
    scale: float = 1.0
    shift: float = 0.0
    rates: tuple[float, ...] = ()
    law: tuple[str, str] | None = None
    ratio: float = 1.0
    phased: bool = True
    stated: bool = False
    elsewhere: tuple[float, ...] = ()
    turns_of: Literal["driving", "driven"] | None = None
    turned_by: float = 0.0
    offset: float = 0.0
    strangers: tuple[tuple[int, ...], ...] = ()
    unnamed: tuple[Unearned, ...] = ()
    slow_courses: int = 0
    claims: tuple[Claim, ...] = ()
    smoothing: float = 0.0
    method: Method = field(default_factory=Method)
    budget: Budget = field(default_factory=Budget)

    def file(self, *, but: Claim | None = None) -> PairFile:
        """The pair file with everything in it, one claim left out if asked."""
        file = self.as_built.written(self.declared, self.built)
        model = changed(file.model, compliance_scale=file.model.compliance_scale * self.scale)
        if self.law is not None:
            model = changed(model, compliance=self.law[0], contact=self.law[1])
        file = changed(file, model=model)
        for claim in self.claims:
            if claim is not but:
                file = claim.written(file)
        return file

    @property
    def bending(self) -> Claim | None:
        """The claim that teeth bend, where the file says that they do not; None where nobody claims it."""
        return next((one for one in self.claims if one.physics is TOOTH_DEFLECTION), None)

    def softer(self, ratio: float) -> Model:
        """The same with ``ratio`` times the compliance of all pairs, declared or claimed."""
        scale = self.scale * ratio if self.declared.model.tooth_deflection else self.scale
        bends, claims = self.bending, self.claims
        if bends is not None:
            softer = replace(bends, values=(ratio * bends.values[0], *bends.values[1:]))
            claims = tuple(softer if one is bends else one for one in claims)
        return replace(self, scale=scale, claims=claims)

    def moved(self, offset: float) -> Model:
        """The same with all recordings ``offset`` in rad of driven rotation further on, both shafts together; the
        encoders' zeros move with them."""
        observed = tuple(_on(one, offset, self._ratio, read=False) for one in self.observed)
        return replace(self, offset=self.offset + offset, observed=observed)

    def turned(self, turns: int) -> Model:
        """The same with the recordings of the coast flank so many ``turns`` of the only shaft that was read further on;
        its reading stays, the mate's goes on as its teeth do."""
        by = 2.0 * math.pi * turns * (self._ratio if self.turns_of == "driving" else 1.0)
        observed = tuple(
            _on(one, by, self._ratio, read=True) if one.samples.flank == "coast" else one for one in self.observed
        )
        return replace(self, turned_by=self.turned_by + by, observed=observed)

    @property
    def _ratio(self) -> float:
        """Driven over driving rotation."""
        return self.scope.gears[0].z / self.scope.gears[1].z

    def but(self, claim: Claim) -> Model:
        """The same state without a claim."""
        return replace(self, claims=tuple(one for one in self.claims if one is not claim))

    def assembled(self, file: PairFile | None = None) -> Assembled:
        """The pair of ``file``, or of the present state."""
        return self.method.assembled(self.file() if file is None else file, path=self.path)

    def samples(self) -> list[Samples]:
        """The samples of all recordings by the present zeros and rates."""
        rates = self.rates or (0.0,) * len(self.observed)
        return [
            _timed(one.samples, rate=rate, shift=self.shift, ratio=self._ratio)
            for one, rate in zip(self.observed, rates, strict=True)
        ]

    def scenes(self) -> list[Scene]:
        """All recordings simulated with the present state."""
        return self.method.scenes(self.file(), self.samples(), path=self.path, smoothing=self.smoothing)

    def residuals(self, scenes: list[Scene]) -> list[FloatArray]:
        """Recorded minus simulated (n,) in mm of every recording, what the measuring chain adds taken off too."""
        out = []
        for one, scene in zip(self.observed, scenes, strict=True):
            left = one.recorded - scene.te
            for claim in self.claims:
                if claim.physics.measures and claim.physics.effect is not None:
                    left = left - claim.physics.effect(scene, claim.place, claim.values)
            out.append(left)
        return out

    def change(
        self, scenes: list[Scene], claim: Claim, values: Values, *, but: Claim | None = None
    ) -> list[FloatArray]:
        """What a claim with ``values`` changes (n,) in mm in every scene, against the same claim with no amplitude.

        First order where the physics knows it; else the set-up with the claim in it is simulated (``but`` without
        another).
        """
        physics, place = claim.physics, claim.place
        if physics.effect is not None:
            by = physics.effect
            told = each(lambda scene: by(scene, place, values), scenes)
            if physics.measures or physics.reloads:
                return told
            return [scene.swung(one) for scene, one in zip(scenes, told, strict=True)]
        nothing = (*(0.0,) * physics.amplitudes, *values[physics.amplitudes :])
        others = self.file(but=but)
        with_, without = (self.assembled(physics.write(others, place, v)) for v in (values, nothing))
        return each(lambda scene: _again(scene, with_) - _again(scene, without), scenes)

    def changed(self, scenes: list[Scene], claim: Claim) -> list[FloatArray] | None:
        """What a claim that is not believed changes (n,) in mm in every scene; None where gears cannot run with it:
        teeth bend too far, or jam."""
        try:
            return self.change(scenes, claim, claim.values)
        except GearpolyError:
            return None

    def drawn_without(self, claim: Claim, scenes: list[Scene]) -> list[Scene]:
        """``scenes`` without a ``claim``: where a tooth has lost contact over it, nothing else shows that the tooth may
        do."""
        others = self.but(claim)
        return others.method.scenes(others.file(), [scene.samples for scene in scenes], path=self.path)

    def rms_of(self, scenes: list[Scene], claim: Claim) -> float:
        """Rms in mm of what a claim that stands does over all scenes."""
        return float(np.sqrt(np.mean(np.concatenate(self.change(scenes, claim, claim.values, but=claim)) ** 2)))


def _timed(samples: Samples, *, rate: float, shift: float, ratio: float) -> Samples:
    """The samples of a clock whose ``rate`` is off by this part, and of a zero that is off by this ``shift``, in rad of
    driven rotation; ``ratio`` driven over driving rotation."""
    turned = rate * (samples.theta_2 - samples.middle)
    return replace(samples, theta_1=samples.theta_1 + turned / ratio, theta_2=samples.theta_2 + turned + shift)


def _on(one: Observed, by: float, ratio: float, *, read: bool) -> Observed:
    """A recording ``by`` rad of driven rotation further on, and by as much in what was ``read`` if the zeros stay."""
    mine = one.samples
    there = replace(mine, theta_1=mine.theta_1 + by / ratio, theta_2=mine.theta_2 + by, middle=mine.middle + by)
    if read:
        there = replace(
            there,
            reading_1=there.reading_1 + there.direction_1 * by / ratio,
            reading_2=there.reading_2 + there.direction_2 * by,
        )
    return replace(one, samples=there)


def _again(scene: Scene, assembled: Assembled) -> FloatArray:
    """Transmission error (n,) in mm of a set-up whose gears are those of the scene, but not what load and shafts do."""
    return scene.with_load_of(assembled)


def noises(model: Model, left: list[FloatArray]) -> list[Noise]:
    """The noise of every recording, from what is left of it."""
    pairs = list(zip(model.observed, left, strict=True))
    return each(lambda pair: model.method.noise(pair[0].estimator.estimate(pair[1])), pairs)
