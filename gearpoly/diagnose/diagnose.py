"""From a pair file and recordings to the physics that the simulation left out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.stats import chi2

from gearpoly.assemble import assemble
from gearpoly.compare.compare import Comparison, compare
from gearpoly.compare.entries import Entry
from gearpoly.compare.locate import locate
from gearpoly.compare.noise import Noise
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.diagnose.built import built_gears, compliance_scale, contradicted
from gearpoly.diagnose.fitted import fitted_file
from gearpoly.diagnose.heldout import Rms, cross_validated
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.rivals import Judged, judge
from gearpoly.diagnose.search import Search
from gearpoly.diagnose.separate import would_separate
from gearpoly.diagnose.verdict import BuiltGear, Diagnosis, Finding, Rival, Status
from gearpoly.errors import GearpolyError
from gearpoly.files.models import PairFile
from gearpoly.mesh.deflection import pair_compliance
from gearpoly.physics.base import Claim, Reported, changed
from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray

SHAPE_DOUBT = 4.0
"""Steps of a shape coordinate by which a fitted edge or length is doubted beside its noise: flanks are not made of
formulas, and another shape would put its edge elsewhere."""

Step = Callable[[str], None]

BY_LAWS = {"mesh_order": 0.01, "condition": 0.01, "mesh_phase": 0.03}
"""Parts of the mean deflection below which what is left at every mesh is no news, since no law of compliance is truer:
waves and means, and short stretches about the corners."""

OTHERS_BY_LAWS = 0.006
"""The same for single teeth and other waves, whose sharing follows the law."""


def diagnose(
    file: PairFile,
    recordings: Sequence[Recording],
    *,
    path: Path | str,
    step: Step = lambda _: None,
    method: Method | None = None,
) -> Diagnosis:
    """Locate where ``recordings`` of one set differ from the pair of ``file`` (read from ``path``), name the physics
    that was left out, and fit it; ``method`` leaves parts of the method out, to show what they are worth.

    Raises what ``compare`` does: ``InputFileError`` for recordings that are not of this pair, too short, or contradict
    each other; ``GeometryError`` and ``OutOfRangeError`` where the declared pair cannot run under their conditions.
    """
    watch = _Watch(step)
    comparison = compare(file, recordings, path=path, step=watch.stage("compare"))
    model = replace(prepare(file, comparison, path=Path(path)), method=method or Method())
    search = Search.begin(model, foreign_waves(comparison), watch.stage("prepare"))
    search.step = watch.stage("search")
    start_linear = search.linear
    search.run()
    watch.stage("rivals")("weighing rivals")
    judged = [judge(model, search.scenes, search.linear, k) for k in range(len(model.claims))]
    order = sorted(range(len(judged)), key=lambda k: -judged[k].gain)
    findings = tuple(_finding(search, comparison, k, judged[k], watch) for k in order)
    watch.stage("leftovers")("looking for what is left")
    unexplained = _unexplained(search, comparison)
    masks = [one.fit for one in model.observed]
    scale = compliance_scale(search)
    status: Status = "nothing_missing"
    if findings:
        status = "partly_explained" if unexplained else "explained"
    elif unexplained:
        status = "unexplained"
    built = built_gears(search, file)
    everything = list(range(start_linear.system.size))
    return Diagnosis(
        comparison=comparison,
        status=status,
        findings=findings,
        unexplained=unexplained,
        built=built,
        compliance_scale=scale,
        noise=math.sqrt(float(np.mean([noise.level**2 for noise in search.noises]))),
        noise_by_recording=tuple(noise.level for noise in search.noises),
        before=_declared(comparison),
        as_built_only=cross_validated(start_linear, masks, leave=everything[start_linear.layout.foreign]),
        after=cross_validated(search.linear, masks, hold=slow_places(search)),
        held_out_by=_held_out_by(model),
        left=tuple(search.linear.left()),
        fitted=fitted_file(model),
        not_excluded=_not_excluded(search, findings),
        remarks=(*comparison.remarks, *_remarks(search, file, built)),
        seconds=watch.seconds(),
    )


class _Watch:
    """Tells the user what is done, and remembers how long each stage took."""

    def __init__(self, step: Step) -> None:
        self._step, self._stage, self._since = step, "", time.perf_counter()
        self._spent: dict[str, float] = {}

    def stage(self, name: str) -> Step:
        """A step function for the stage ``name``, which begins now."""
        self._close()
        self._stage = name
        return self._step

    def _close(self) -> None:
        now = time.perf_counter()
        if self._stage:
            self._spent[self._stage] = self._spent.get(self._stage, 0.0) + now - self._since
        self._since = now

    def seconds(self) -> tuple[tuple[str, float], ...]:
        """Seconds spent in every stage."""
        self._close()
        return tuple(self._spent.items())


def foreign_waves(comparison: Comparison) -> list[FloatArray]:
    """Waves (n_k, q) of unit size that no gear pair and no encoder makes: fixed in time, or no integer order.

    They are fitted beside everything, so that nothing is claimed in their place; what they are is not asked.
    """
    out: list[list[FloatArray]] = [[np.zeros((one.theta_2.size, 0))] for one in comparison.aligned]
    for entry in comparison.located.entries:
        if not _is_foreign(entry):
            continue
        for k, one in enumerate(comparison.aligned):
            if k not in entry.recordings and entry.kind == "time":
                continue
            if entry.kind == "time" and one.time_s is not None and entry.hz is not None:
                angle = 2.0 * math.pi * entry.hz * one.time_s
            else:
                angle = (entry.order or 0.0) * (one.theta_1 if entry.gear == "driving" else one.theta_2)
            for j, mine in enumerate(out):
                waves = np.column_stack((np.cos(angle), np.sin(angle))) if j == k else np.zeros((mine[0].shape[0], 2))
                mine.append(waves)
    return [np.concatenate(mine, axis=1) for mine in out]


def _is_foreign(entry: Entry) -> bool:
    if entry.companion_of is not None:
        return False
    if entry.kind == "time":
        return bool(entry.hz)
    return entry.kind == "shaft_order" and entry.order is not None and not float(entry.order).is_integer()


def slow_places(search: Search) -> list[int]:
    """Parameters of claims that go on over a whole recording and never repeat."""
    layout, claims = search.linear.layout, search.model.claims
    return [p for k, claim in enumerate(claims) if claim.physics.slow for p in layout.places(k)]


def _finding(search: Search, comparison: Comparison, k: int, judged: Judged, watch: _Watch) -> Finding:
    model, linear = search.model, search.linear
    claim = model.claims[k]
    at = linear.layout.claims[k]
    covariance = linear.system.covariance[at, at]
    masks = [one.fit for one in model.observed]
    mine = linear.layout.places(k) + linear.layout.form_places(model, k)
    slow = slow_places(search)
    rivals = tuple(
        Rival(claim=one.claim, parameters=parameters(model, one.claim, np.zeros((len(one.claim.values),) * 2)))
        for one in judged.rivals
    )
    separation = None
    if rivals:
        watch.stage("next recording")(f"thinking of recordings that would decide on {claim.physics.name}")
        try:
            separation = would_separate(model, search.scenes, linear, k, [one.claim for one in rivals])
        except GearpolyError:
            separation = None  # the pair cannot run under any other condition
    chance = math.log(max(search.tests, 1)) + _log_tail(judged.gain, len(claim.values))
    return Finding(
        claim=claim,
        parameters=parameters(model, claim, covariance),
        tooth=claim.place.tooth if comparison.alignment.numbered else None,
        encoder_deg=encoder_deg(comparison, claim, model.offset),
        gain=judged.gain,
        p_value=float(min(1.0, math.exp(max(chance, -700.0)))),
        without=cross_validated(linear, masks, leave=mine, hold=[p for p in slow if p not in mine]),
        with_=cross_validated(linear, masks, hold=slow),
        rivals=rivals,
        separation=separation,
    )


def _log_tail(gain: float, freedoms: int) -> float:
    return float(chi2.logsf(max(gain, 0.0), freedoms))


def parameters(model: Model, claim: Claim, covariance: FloatArray) -> Reported:
    """The contract's parameters of a claim, each with its standard error."""
    a = claim.physics.amplitudes
    covariance = covariance.copy()
    # What laws differ by is no noise: it does not shrink with more data.
    covariance[range(a), range(a)] += (claim.physics.law_doubt * np.array(claim.values[:a])) ** 2
    for k in range(a, len(claim.values)):
        covariance[k, k] += (SHAPE_DOUBT * claim.physics.coordinates[k].step) ** 2
    found = claim.physics.report(claim.place, np.array(claim.values), covariance)
    scale = found.pop("compliance_scale", None)
    if scale is not None:
        unit = pitch_point_compliance(model)
        found = {"compliance_um_per_n": (scale[0] * unit, scale[1] * unit), "compliance_scale": scale, **found}
    return found


def pitch_point_compliance(model: Model) -> float:
    """Compliance in um/N of one pair at the pitch point by the declared law, contact included."""
    file = changed(model.declared, model=changed(model.declared.model, tooth_deflection=True, compliance_scale=1.0))
    assembled = assemble(file, path=model.path, seed=0)
    assert assembled.elasticity is not None
    by = pair_compliance(assembled.pair, assembled.elasticity)
    point = np.array([[assembled.pair.r_b1 / math.cos(assembled.pair.alpha_w), 0.0]])
    zero = np.zeros(1, dtype=np.int64)
    force = np.array([max(max(model.scope.torques), 1.0) / assembled.pair.r_b2])
    return float(by.secant(force, by.teeth(zero, zero, point), point)[0]) / UM


def encoder_deg(comparison: Comparison, claim: Claim, offset: float = 0.0) -> float | None:
    """Reading of its shaft's encoder at which a claimed tooth's pitch point passes the line of centres; ``offset`` in
    rad of driven rotation by which the search moved the zeros."""
    if claim.place.tooth is None or claim.place.gear is None:
        return None
    known = comparison.gears[claim.place.gear]
    if known.zero is None:
        return None
    ratio = comparison.gears[0].z / comparison.gears[1].z
    turned = claim.place.tooth * 2.0 * math.pi / known.z - (offset / ratio if claim.place.gear == 0 else offset)
    return math.degrees(known.zero + known.direction * turned) % 360.0


def _declared(comparison: Comparison) -> Rms:
    """Rms in mm of the declared simulation's misfit about the set's common mean."""
    counted = [one.residual for one in comparison.aligned]
    whole = np.concatenate([left - _mean_of(comparison, k) for k, left in enumerate(counted)])
    rms = float(np.sqrt(np.mean(whole**2)))
    return Rms(seen=rms, unseen=rms)


def _mean_of(comparison: Comparison, k: int) -> float:
    """Mean in mm that a recording's misfit is taken about: the set's common one where both encoders were read."""
    recordings = [one.cleaned.recording for one in comparison.aligned]
    counted = [r.te_rad is None and r.te_mm is None for r in recordings]
    if not counted[k]:
        return comparison.aligned[k].mean
    return float(
        np.mean(np.concatenate([one.residual for one, c in zip(comparison.aligned, counted, strict=True) if c]))
    )


def _held_out_by(model: Model) -> str:
    if not all(bool(np.any(~one.fit)) for one in model.observed):
        return "nothing could be held out"
    if all(one.whole for one in model.observed):
        return "whole hunting cycles"
    return "every other of eight blocks, since a recording holds less than two hunting cycles"


def _unexplained(search: Search, comparison: Comparison) -> tuple[Entry, ...]:
    """What neither the claims nor the as-built teeth explain: foreign waves, and whatever stands out of the rest."""
    model, linear, layout = search.model, search.linear, search.linear.layout
    gears = tuple(
        GearKnown(z=known.z, uncertainty=1e-4, zero=known.zero, direction=known.direction) for known in comparison.gears
    )
    # The foreign waves are put back: they are to be found again, with their size.
    x = linear.system.solution.copy()
    x[layout.foreign] = 0.0
    residuals = []
    left = [target - columns @ x for columns, target in zip(linear.columns, linear.target, strict=True)]
    for one, scene, rest in zip(comparison.aligned, search.scenes, left, strict=True):
        residuals.append(
            AlignedResidual(
                theta_1=scene.samples.theta_1,
                theta_2=scene.samples.theta_2,
                residual=rest,
                z_2=comparison.gears[1].z,
                time_s=one.time_s,
                torque=one.torque,
                speed=one.speed,
                flank=one.flank,
                sharing=one.template.sharing,
                contact=one.template.sharing.contact,
            )
        )
    pair = comparison.assembled.pair
    found = locate(
        residuals,
        gears=(gears[0], gears[1]),
        floor=pair.chord_noise + max(one.template.error for one in comparison.aligned),
        numbered=comparison.alignment.numbered,
    )
    doubt = search.deflection / UM
    return tuple(
        entry
        for entry in found.entries
        if entry.companion_of is None
        and not _claimed(entry, model)
        and not _by_law(entry, doubt)
        and not _by_grade(entry, max(model.scope.form))
        and not _by_colour(entry, model, search.noises)
    )


def _by_colour(entry: Entry, model: Model, levels: list[Noise]) -> bool:
    """Whether an entry may be coloured noise: a line below the noise in recordings that never repeat themselves."""
    if any(model.observed[k].whole for k in entry.recordings) or entry.kind not in ("shaft_order", "time"):
        return False
    if entry.order is not None and float(entry.order).is_integer():
        return False
    return abs(entry.amplitude_um or 0.0) < min(levels[k].level for k in entry.recordings) / UM


def _by_law(entry: Entry, deflection: float) -> bool:
    """Whether an entry is below what compliance laws and corner contact differ by, ``deflection`` in um being bent."""
    size = abs((entry.amplitude_um if entry.amplitude_um is not None else entry.rms_um) or 0.0)
    return size < BY_LAWS.get(entry.kind, OTHERS_BY_LAWS) * deflection


def _by_grade(entry: Entry, form: float) -> bool:
    """Whether an entry is the same at every mesh and below the ``form`` in um that a grade leaves open."""
    size = entry.amplitude_um if entry.amplitude_um is not None else entry.rms_um
    return entry.kind in ("mesh_order", "mesh_phase") and abs(size or 0.0) < form


def _claimed(entry: Entry, model: Model) -> bool:
    """Whether a claim stands at the same tooth already: what is left of it is form, not something else."""
    for claim in model.claims:
        if entry.kind == "tooth" and entry.gear == claim.place.gear_name and entry.tooth == claim.place.tooth:
            return True
    return False


def _not_excluded(search: Search, findings: tuple[Finding, ...]) -> tuple[str, ...]:
    """What these recordings could not have shown, in words."""
    scope, out = search.model.scope, []
    if len(set(scope.torques)) == 1 and max(scope.torques) == 0.0:
        out.append("anything that needs load (cracks, friction, misalignment, deflection): no recording is loaded")
    elif len(set(scope.torques)) == 1:
        out.append("mean-tooth effects that one torque cannot tell from compliance (crowning, relief, misalignment)")
    if len(set(scope.flanks)) == 1:
        other = "coast" if scope.flanks[0] == "drive" else "drive"
        out.append(f"anything that shows on the {other} flank only (thickness, its pitch)")
    if len({round(s, 3) for s in scope.speeds if s is not None}) < 2:
        out.append("resonances: all recordings were made at one speed")
    if not scope.counted or len(scope.torques) == 1:
        out.append("offsets (wind-up, centre distance, wear of all flanks): a single mean compares with nothing")
    return tuple(out)


def _remarks(search: Search, file: PairFile, built: tuple[BuiltGear, BuiltGear]) -> tuple[str, ...]:
    out = contradicted(search)
    for name, section, gear in (("driving", file.driving, 0), ("driven", file.driven, 1)):
        needed = built[gear].grade_needed
        if section.inspection is None and section.grade is not None and (needed is None or needed > section.grade):
            shown = "no grade" if needed is None else f"grade {needed}"
            out.append(f"the {name} gear as it runs fits {shown}, not its declared grade {section.grade}")
    return tuple(out)
