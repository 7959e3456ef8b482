"""What is open without being physics: the zeros, the mean, the rate of a clock, and how soft teeth truly are.

No two compliance laws agree, and a fit with the wrong one finds reliefs where there are none. So the compliance may be
scaled, and its shape may vary as a beam, ISO 6336, the potential-energy method and Weber and Banaschek differ.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import numpy as np

from gearpoly.compare.clock import RATE_STD
from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.compliance import law_names
from gearpoly.scene import Scene
from gearpoly.threads import each
from gearpoly.units import UM, FloatArray

SCALE_STD = 0.15
"""Relative doubt about a declared compliance: what the laws' means differ by."""

SCALE_STEP = 0.02
"""Relative step by which the compliance is varied for its derivative."""

MODES = 8
"""Ways in which laws differ that are kept; the rest is below ``LEAST_LAW_DIFFERENCE_MM``."""

LEAST_LAW_DIFFERENCE_MM = 0.002 * UM
"""mm rms. Differences of laws below this are not worth a column."""

OFFSET = 0.01
"""Part of a mean deflection by which the load's own share of it may be misjudged: laws differ in how the contact
hardens, shafts and bearings give a little. In 24 healthy pairs of a bench with three other laws it was up to 0.018, so
a wind-up that gives less than 3 % of what the teeth give is not told from a law."""

ONCE_PER_TURN_LAW_PART = 1.0
"""Part of the mean deflection, per base pitch of eccentricity, by which laws differ once per turn: eccentric gears
touch elsewhere on their teeth. 60 um and 33 um in a pair of module 2 left 0.08 and 0.06 um beside all laws."""

DISCREPANCY, DISCREPANCY_HARMONICS = 0.03, 8
"""Model discrepancy (Kennedy and O'Hagan 2001): part of the mean deflection, one standard deviation, that no law of
compliance has right, as a curve of so many harmonics of the mesh. On a bench with a law 4 % off all of them 0.010 of it
was left at every mesh, and 0.0013 beside such a curve; another simulator left 0.024 to 0.033."""

LAW_SPREAD_FACTOR = 1.5
"""Truth may lie outside what the laws span, by half of their spread."""

CONTACTS = ("linear", "palmgren")


@dataclass(frozen=True, kw_only=True, eq=False)
class Nuisance:
    """Columns (n_k, q) per recording, in mm per unit, and the prior standard deviation (q,) of each; ``scale`` is the
    place of the compliance's scale among them, if any, ``shift`` that of the zero, ``rates`` those of each recording's
    clock, if any angle was made of time, ``discrepancy`` those of the model discrepancy over the mesh."""

    columns: list[FloatArray]
    std: FloatArray
    shift: int
    scale: int | None
    rates: slice
    discrepancy: slice

    def sigmas(self, rates: Sequence[float]) -> FloatArray:
        """By how many standard deviations (k,) the clocks are off whose ``rates`` are off by these parts; none stated
        means none."""
        many = self.rates.stop - self.rates.start
        return np.asarray(rates, dtype=np.float64) / RATE_STD if rates else np.zeros(many)

    def sloping(self, scenes: list[Scene]) -> Nuisance:
        """The same with the slopes of the ``scenes`` as they are now, where a zero is late or a clock's rate is off."""
        columns = [one.copy() for one in self.columns]
        timed = self.rates.stop > self.rates.start
        for k, (mine, scene) in enumerate(zip(columns, scenes, strict=True)):
            mine[:, self.shift] = slope_of(scene)
            if timed:
                mine[:, self.rates.start + k] = late_of(scene, mine[:, self.shift])
        return replace(self, columns=columns)


def make_nuisance(
    scenes: list[Scene],
    *,
    shift_std: float,
    laws: list[FloatArray] | None,
    scaled: bool,
    timed: bool = False,
    apart: float = 0.0,
) -> Nuisance:
    """The nuisance of all scenes; ``shift_std`` in rad the doubt about the driven zero, ``laws`` the modes (n_k, q) in
    mm in which compliance laws differ; ``scaled``: the compliance is declared, so its scale is open (else it is
    claimed, and no nuisance); ``timed``: an angle was made of time, so its rate is open; ``apart`` in mm, one sigma,
    how far the means of recordings may be apart.
    """
    sizes = [scene.samples.size for scene in scenes]
    counted = [scene.samples.counted for scene in scenes]
    # One true zero for all recordings whose encoders were read; a transmission error that the rig computed has its own.
    means = [np.array([1.0 if c else 0.0 for c in counted])] if any(counted) else []
    means += [np.eye(len(scenes))[k] for k, c in enumerate(counted) if not c]
    columns = [[np.full(size, mean[k]) for mean in means] for k, size in enumerate(sizes)]
    std = [1e3] * len(means)
    if apart > 0.0 and sum(counted) > 1:
        for k in (k for k, c in enumerate(counted) if c):
            for j, mine in enumerate(columns):
                mine.append(np.full(sizes[j], 1.0 if j == k else 0.0))
            std.append(apart)
    at_shift = len(std)
    for mine, scene in zip(columns, scenes, strict=True):
        mine.append(slope_of(scene))
    std.append(shift_std)
    rates = slice(len(std), len(std) + (len(scenes) if timed else 0))
    for k, mine in enumerate(columns[: len(scenes) if timed else 0]):
        late = late_of(scenes[k], mine[at_shift])
        for j, each_one in enumerate(columns):
            each_one.append(late if j == k else np.zeros(sizes[j]))
        std.append(1.0)
    at_scale = None
    if scaled and any(scene.bends for scene in scenes):
        at_scale = len(std)
        for mine, scene in zip(columns, scenes, strict=True):
            mine.append(softened(scene))
        std.append(SCALE_STD)
    for k, scene in enumerate(scenes):
        if scene.bends:
            for j, mine in enumerate(columns):
                mine.append(np.full(sizes[j], 1.0 if j == k else 0.0))
            std.append(OFFSET * abs(float(np.mean(scene.bending(None) - scene.te))))
    for turning in _turned(scenes):
        for mine, one in zip(columns, turning, strict=True):
            mine.append(one)
        std.append(1.0)
    start = len(std)
    for curves in _discrepancies(scenes):
        for mine, one in zip(columns, curves, strict=True):
            mine.append(one)
        std.append(1.0)
    discrepancy = slice(start, len(std))
    out = [np.column_stack(mine) for mine in columns]
    if laws is not None:
        out = [np.concatenate((mine, law), axis=1) for mine, law in zip(out, laws, strict=True)]
        std += [1.0] * laws[0].shape[1]
    return Nuisance(
        columns=out, std=np.array(std), shift=at_shift, scale=at_scale, rates=rates, discrepancy=discrepancy
    )


def _turned(scenes: list[Scene]) -> list[list[FloatArray]]:
    """Ways (n_k,) in mm in which the deflection of all scenes may vary with the turns of eccentric gears, each a prior
    standard deviation: cosine and sine of every such gear on either flank."""
    out = []
    for flank in dict.fromkeys(scene.samples.flank for scene in scenes if scene.bends):
        for gear in (0, 1):
            pair = scenes[0].pair
            off = (pair.driving, pair.driven)[gear].eccentricity[0] / pair.driving.gear.p_b
            if off == 0.0:
                continue
            for wave in (np.cos, np.sin):
                out.append(
                    [
                        ONCE_PER_TURN_LAW_PART
                        * off
                        * float(np.mean(scene.bending(None) - scene.te))
                        * wave(_turn(scene, gear))
                        if scene.bends and scene.samples.flank == flank
                        else np.zeros(scene.samples.size)
                        for scene in scenes
                    ]
                )
    return out


def _discrepancies(scenes: list[Scene]) -> list[list[FloatArray]]:
    """Ways (n_k,) in mm in which the deflection of all scenes may vary over the mesh by model discrepancy, each a prior
    standard deviation: cosines and sines of its harmonics on either flank, falling off as 1/h, the more the more teeth
    give."""
    out = []
    norm = math.sqrt(sum(1.0 / h**2 for h in range(1, DISCREPANCY_HARMONICS + 1)))
    for flank in dict.fromkeys(scene.samples.flank for scene in scenes if scene.bends):
        for h in range(1, DISCREPANCY_HARMONICS + 1):
            for wave in (np.cos, np.sin):
                curves = []
                for scene in scenes:
                    if not scene.bends or scene.samples.flank != flank:
                        curves.append(np.zeros(scene.samples.size))
                        continue
                    size = DISCREPANCY / (norm * h) * abs(float(np.mean(scene.bending(None) - scene.te)))
                    curves.append(size * scene.swung(wave(h * scene.gear(1).z * scene.samples.theta_2)))
                out.append(curves)
    return out


def _turn(scene: Scene, gear: int) -> FloatArray:
    return scene.samples.theta_1 if gear == 0 else scene.samples.theta_2


def slope_of(scene: Scene) -> FloatArray:
    """Change (n,) in mm/rad of the simulated transmission error over driven rotation, both shafts together, over 1/32
    of a pitch or from sample to sample of the whole hunting cycle, whichever is longer."""
    period = scene.pair.cycle
    place, unique = np.unique(np.mod(scene.samples.theta_2, period), return_index=True)
    h = max(scene.gear(1).tau / 64.0, float(np.median(np.diff(place))))
    at, te = scene.samples.theta_2, scene.mesh_te[unique]
    there, here = (np.interp(at + by, place, te, period=period) for by in (h, -h))
    return scene.swung((there - here) / (2.0 * h))


def late_of(scene: Scene, slope: FloatArray) -> FloatArray:
    """What a clock whose rate is off by one standard deviation adds (n,) in mm, by the ``slope`` (n,) in mm/rad of the
    simulated curve: teeth take over later and later, from the middle of the recording on."""
    return RATE_STD * (scene.samples.theta_2 - scene.samples.middle) * slope


def softened(scene: Scene) -> FloatArray:
    """Change (n,) in mm of the transmission error per relative change of the compliance."""
    elasticity = scene.assembled.elasticity
    if elasticity is None or not scene.bends:
        return np.zeros(scene.samples.size)
    softer = replace(elasticity, scale=elasticity.scale * (1.0 + SCALE_STEP))
    return (scene.bending(softer) - scene.te) / SCALE_STEP


Law = tuple[str, str]
"""Names of the tooth's and the contact's compliance law."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LawChange:
    """What another pair of laws changes: ``parts`` (n_k,) in mm of all scenes, where its compliance is multiplied by
    ``ratio`` so that teeth give as much as before in the mean."""

    ratio: float
    parts: list[FloatArray]


STIFFER = 0.25
"""Part of its compliance by which a law is tried that bends teeth too far: the laws differ by less than four times."""


def law_changes(scenes: list[Scene], *, only: Law | None = None) -> dict[Law, LawChange]:
    """What every other pair of laws, or ``only`` one, changes in all scenes; empty where nothing bends."""
    out: dict[Law, LawChange] = {}
    loaded = [scene for scene in scenes if scene.bends]
    if not loaded:
        return out
    rigid = [scene.bending(None) for scene in loaded]
    # Load holds the driven gear back on the drive flank and pushes it ahead on the coast flank: both give alike.
    senses = [scene.samples.sense for scene in loaded]
    bent = _given(senses, [scene.te for scene in loaded], rigid)
    asked = product(law_names(), CONTACTS) if only is None else [only]
    for law, contact in asked:
        if (law, contact) == _law_of(loaded[0]):
            continue
        under = partial(_under, law=law, contact=contact)
        try:
            try:
                ratio, there = 1.0, each(partial(under, ratio=1.0), loaded)
            except OutOfRangeError:
                ratio, there = STIFFER, each(partial(under, ratio=STIFFER), loaded)
            ratio *= bent / _given(senses, there, rigid)
            there = each(partial(under, ratio=ratio), scenes)
        except OutOfRangeError:
            # Teeth that are bent nearly too far by the present law may be so somewhere by one as soft in the mean.
            continue
        parts = [x - scene.te for x, scene in zip(there, scenes, strict=True)]
        out[law, contact] = LawChange(ratio=ratio, parts=parts)
    return out


def _given(senses: Sequence[float], te: Sequence[FloatArray], rigid: Sequence[FloatArray]) -> float:
    """By how much teeth give in the mean, in mm, below 0, summed over scenes of both flanks by their ``senses``."""
    return sum(sense * float(np.mean(x - stiff)) for sense, x, stiff in zip(senses, te, rigid, strict=True))


def _law_of(scene: Scene) -> Law:
    elasticity = scene.assembled.elasticity
    assert elasticity is not None
    return elasticity.law, elasticity.contact


def _under(scene: Scene, *, law: str, contact: str, ratio: float) -> FloatArray:
    """Transmission error (n,) in mm by other laws, all compliance multiplied by ``ratio``."""
    elasticity = scene.assembled.elasticity
    if elasticity is None or not scene.bends:
        return scene.te
    return scene.bending(replace(elasticity, law=law, contact=contact, scale=elasticity.scale * ratio))


@dataclass(frozen=True, kw_only=True, eq=False)
class LawModes:
    """The main ways ``parts`` (n_k, q) in mm in which the transmission error differs from law to law, their means
    being equal; each a prior standard deviation.

    ``ratios`` of the compliance of every law; ``softer`` (L,) the part of each that is a softer law as a whole;
    ``mix`` (q, L) the part of each in every mode, ``rest`` (r, L) the same of modes that hardly show here.
    """

    parts: list[FloatArray]
    ratios: dict[Law, float]
    softer: FloatArray
    mix: FloatArray
    rest: FloatArray

    def widened(self, by: float) -> LawModes:
        """The same with ``by`` times the doubt."""
        parts = [by * part for part in self.parts]
        return replace(self, parts=parts, mix=by * self.mix, rest=by * self.rest)

    def under(self, scene: Scene) -> tuple[FloatArray, FloatArray]:
        """The same modes (n, q) in mm in a further ``scene``, and what else laws differ by there (n, p)."""
        table = np.array([_changed(scene, law, ratio) for law, ratio in self.ratios.items()])
        table -= np.outer(self.softer, softened(scene))
        _, s, v = np.linalg.svd(self.rest @ table, full_matrices=False)
        shown = s > LEAST_LAW_DIFFERENCE_MM * math.sqrt(scene.samples.size)
        return np.asarray((self.mix @ table).T), np.asarray((s[shown, None] * v[shown]).T)


def _changed(scene: Scene, law: Law, ratio: float) -> FloatArray:
    """What a law changes (n,) in mm; nothing where it would bend the teeth too far."""
    try:
        return np.asarray(_under(scene, law=law[0], contact=law[1], ratio=ratio) - scene.te)
    except OutOfRangeError:
        return np.zeros(scene.samples.size)


def law_modes(scenes: list[Scene], changes: dict[Law, LawChange]) -> LawModes | None:
    """The main ways in which the transmission error differs from law to law. None where nothing bends enough."""
    if not changes:
        return None
    scale = np.concatenate([softened(scene) for scene in scenes])
    table = np.array([np.concatenate(change.parts) for change in changes.values()])
    # A softer law as a whole is the scale's matter; how the softness varies along the path is the modes'.
    softer = table @ scale / float(scale @ scale)
    table -= np.outer(softer, scale)
    u, s, v = np.linalg.svd(table, full_matrices=False)
    each_law = LAW_SPREAD_FACTOR / math.sqrt(table.shape[0])
    shown = s / math.sqrt(table.size) > LEAST_LAW_DIFFERENCE_MM
    shown[MODES:] = False
    if not shown.any():
        return None
    modes = each_law * s[shown, None] * v[shown]
    edges = np.cumsum([scene.samples.size for scene in scenes])[:-1]
    return LawModes(
        parts=[np.asarray(part.T) for part in np.split(modes, edges, axis=1)],
        ratios={law: change.ratio for law, change in changes.items()},
        softer=softer,
        mix=each_law * u.T[shown],
        rest=each_law * u.T[~shown],
    )
