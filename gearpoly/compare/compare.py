"""Recordings beside the simulation of their pair: aligned, subtracted, weighed against their noise, and located."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from pathlib import Path

import numpy as np

from gearpoly.assemble import stated_limits
from gearpoly.compare.align import lay
from gearpoly.compare.among import means_compare, shared_counts
from gearpoly.compare.beside import Aligned, BesideSimulation, Comparison
from gearpoly.compare.clock import turned
from gearpoly.compare.curve import PITCH_WAVE, Cycle, RecordedCurve
from gearpoly.compare.locate import locate
from gearpoly.compare.mesh_background import mesh_remarks
from gearpoly.compare.on_sky import sky_of
from gearpoly.compare.pieces import pieces
from gearpoly.compare.read_late import on_one_clock
from gearpoly.compare.remarks import apart_remarks, of_other_teeth, remarks, scale_remarks
from gearpoly.compare.same_flank import with_flanks
from gearpoly.compare.scale import put_right
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.compare.stand_in import known_pair
from gearpoly.compare.stated import refuse_apart, refuse_twins
from gearpoly.compare.subtract import curve_of, once_only, subtracted
from gearpoly.compare.template import templates_of
from gearpoly.compare.turned_over import parted
from gearpoly.compare.turns import jam_remarks
from gearpoly.compare.zeros import Alignment, ShaftsRead, base_zeros, settle
from gearpoly.errors import InputFileError
from gearpoly.files.models import GearSection, PairFile
from gearpoly.gear.nominal import nominal_gears
from gearpoly.inspected import thickness_remarks
from gearpoly.keys.also_turns import parts_of
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.pair import GearPair, tight_centre_distance
from gearpoly.mesh.shafts import runs_up
from gearpoly.positions import recorded_torque
from gearpoly.recording.chain import corrected
from gearpoly.recording.clean import Cleaned
from gearpoly.recording.clean_set import clean_set
from gearpoly.recording.load import most_off, relative_load
from gearpoly.recording.recording import Recording
from gearpoly.units import NM, RPM, UM, FloatArray

LEAST_SAMPLES = 64
"""Samples from which a noise spectrum can be estimated at all."""

COMPLIANCE_DOUBT = 0.10
"""Relative one-sigma doubt about a declared compliance: what a beam, a finite-element tooth and ISO 6336 differ by."""

Step = Callable[[str], None]
"""Called with what is done next."""


def _silent(what: str) -> None:
    """Nobody watches."""


def compare(
    file: PairFile, recordings: Sequence[Recording], *, path: Path | str, step: Step = _silent,
    over: Callable[[], bool] = lambda: False,
) -> Comparison:  # fmt: skip
    """Align ``recordings`` of one set with the pair of ``file`` (read from ``path``), subtract, locate what is left:
    only what is strongest where time is ``over``.

    Raises what ``lay_beside`` does.
    """
    beside = lay_beside(file, recordings, path=path, step=step)
    step("weighing the difference against its noise")
    pair = beside.assembled.pair
    located = locate(
        (_residual(one, pair, beside.alignment) for one in beside.aligned),
        recordings=len(beside.aligned),
        gears=beside.gears,
        floor=pair.chord_noise + max(one.template.error + one.doubt for one in beside.aligned),
        numbered=beside.alignment.numbered,
        over=over,
    )
    located = replace(located, entries=beside.named(located.entries), where=beside.named(located.where))
    if (sky := sky_of(beside)) is not None:
        beside = replace(beside, remarks=(*beside.remarks, *mesh_remarks(located, beside.aligned, sky)))
    return Comparison(**{field.name: getattr(beside, field.name) for field in fields(beside)}, located=located)


def lay_beside(
    file: PairFile, recordings: Sequence[Recording], *, path: Path | str, step: Step = _silent
) -> BesideSimulation:
    """Clean and align ``recordings`` of one set with the pair of ``file`` (read from ``path``), and subtract.

    Raises ``InputFileError`` for recordings that are not of this pair, too short, or whose stated zeros contradict one
    another; ``GeometryError`` and ``OutOfRangeError`` where the pair cannot run under their conditions.
    """
    refuse_apart(recordings)
    step("drawing the gears")
    assembled = known_pair(file, path=path)
    pair = assembled.pair
    z_1, z_2 = pair.driving.gear.z, pair.driven.gear.z
    step("cleaning the recordings")
    recordings = [corrected(r, *assembled.encoders, ratio=pair.ratio, r_b2=pair.r_b2) for r in recordings]
    recordings = [turned(one, z_1=z_1, z_2=z_2)[0] for one in with_flanks(recordings, file, pair)]
    recordings, scale = put_right(recordings, pair, assembled.encoders)
    base = base_zeros(recordings, z_1=z_1, z_2=z_2)
    cleaned = _cleaned(recordings, file, pair)
    torques = [recorded_torque(one.recording, default=file.torque_nm) * NM for one in cleaned]
    step("turning the gears through a hunting cycle")
    loads = _loads(cleaned, torques, tau_2=pair.driven.gear.tau)
    templates = templates_of(assembled, _conditions(cleaned, torques, loads, default_speed=file.pair.speed_rpm))
    pitch_waves = _pitch_wave(file.driving, file), _pitch_wave(file.driven, file)
    cycle = Cycle(z_1=z_1, z_2=z_2, per_mesh=templates[0].per_mesh, r_b2=pair.r_b2, pitch_waves=pitch_waves)
    counts = shared_counts([one.recording for one in cleaned])
    drifts = _drifts(file, len(cleaned))
    curves = tuple(curve_of(*each, base, cycle) for each in zip(cleaned, templates, drifts, counts, strict=True))
    # By the stated zeros, which are good enough to lay what is left on the mesh.
    before = [
        once_only(one, c.template, assembled, c.theta_2, load)
        for one, c, load in zip(cleaned, curves, loads, strict=True)
    ]
    curves = tuple(c if more is None else replace(c, te=c.te - more) for c, more in zip(curves, before, strict=True))
    step("laying the recordings on the simulation")
    shafts = _shafts(recordings, cleaned, curves, torques)
    alignment = settle(lay(curves, cycle, stated=base.stated), cycle, base=base, shafts=shafts)
    aligned = tuple(
        subtracted(
            one, curve, alignment, k, torque, assembled, cycle, before[k], loads[k], default_speed=file.pair.speed_rpm
        )
        for k, (one, curve, torque) in enumerate(zip(cleaned, curves, torques, strict=True))
    )
    parts = parts_of(file.also_turns, z_1=z_1, z_2=z_2)
    another = of_other_teeth(aligned, parts, z=(z_1, z_2))
    return BesideSimulation(
        name=file.name,
        assembled=assembled,
        aligned=aligned,
        alignment=alignment,
        gears=(
            _known(file.driving, file, alignment.zeros.driving, shafts.direction_1),
            _known(file.driven, file, alignment.zeros.driven, shafts.direction_2),
        ),
        remarks=(
            *thickness_remarks(file),
            *jam_remarks(pair),
            *scale_remarks(scale, another),
            *apart_remarks(aligned, z_2=z_2),
            *remarks(file, aligned, alignment, base),
        ),
        scale=scale,
        another=another,
        parts=parts,
        worm=file.worm,
    )


def _cleaned(recordings: Sequence[Recording], file: PairFile, pair: GearPair) -> list[Cleaned]:
    """The recordings cleaned, on one clock, and parted where the drive turns over. Raises ``InputFileError``."""
    cleaned = parted(on_one_clock(clean_set(recordings, ratio=pair.ratio, r_b2=pair.r_b2), pair), file, pair)
    for one in cleaned:
        if one.size < LEAST_SAMPLES:
            wish = f"want at least {LEAST_SAMPLES}, to tell noise from anything"
            raise InputFileError(one.recording.source, found=f"{one.size} usable samples", wish=wish)
    refuse_twins(cleaned)
    return cleaned


def _loads(cleaned: Sequence[Cleaned], torques: Sequence[float], *, tau_2: float) -> list[FloatArray | None]:
    """Relative changes (n,) of each recording's torque about ``torques`` in N.mm; ``tau_2`` driven pitch in rad."""
    return [
        relative_load(one.torque_nm, torque / NM, meshes=float(np.ptp(one.theta_2)) / tau_2)
        for one, torque in zip(cleaned, torques, strict=True)
    ]


def _conditions(
    cleaned: Sequence[Cleaned],
    torques: Sequence[float],
    loads: Sequence[FloatArray | None],
    *,
    default_speed: float | None,
) -> list[Condition]:
    """Under what each recording ran: ``torques`` in N.mm, ``loads`` (n,) their relative changes, speeds in rev/min."""
    stated = [one.recording.speed_rpm or default_speed for one in cleaned]
    # What swings in a run-up never comes again, so templates are of the mesh alone.
    speeds = [
        None if rpm is None or runs_up(one.theta_2, one.time_s) else rpm * RPM
        for rpm, one in zip(stated, cleaned, strict=True)
    ]
    return [
        Condition(flank=one.recording.flank, torque=torque, speed=speed, backward=one.backward, varies=most_off(load))
        for one, torque, speed, load in zip(cleaned, torques, speeds, loads, strict=True)
    ]


def _drifts(file: PairFile, recordings: int) -> tuple[tuple[float, ...], ...]:
    """The declared drift (um, Legendre) of each of so many recordings; empty where none is."""
    stated = file.measurement.thermal_drift_um if file.measurement is not None else ()
    return (*stated, *((),) * recordings)[:recordings]


def _shafts(
    recordings: Sequence[Recording],
    cleaned: Sequence[Cleaned],
    curves: Sequence[RecordedCurve],
    torques: Sequence[float],
) -> ShaftsRead:
    """What the zeros of the set are settled by: which shafts were read, how, on which flank and under which torque."""
    return ShaftsRead(
        driving=any(one.recording.driving_angle_rad is not None for one in cleaned),
        driven=any(one.recording.driven_angle_rad is not None for one in cleaned),
        direction_1=recordings[0].driving_direction,
        direction_2=recordings[0].driven_direction,
        counted=tuple(curve.counted for curve in curves),
        compared=means_compare([one.recording for one in cleaned]),
        flank=tuple(one.recording.flank for one in cleaned),
        torque=tuple(torques),
    )


def _residual(one: Aligned, pair: GearPair, alignment: Alignment) -> AlignedResidual:
    """As ``locate`` wants it, with what is not known exactly: the zero, and the compliance."""
    template = one.template
    mean = 0.0
    if template.rigid is not None:
        # Laws differ in how a pair's compliance runs along its path too, so the mean does not follow from the ripple.
        bends = (template.deflection(one.theta_2[here]) for here in pieces(one.theta_2.size))
        mean = sum(float(np.sum(bend)) for bend in bends if bend is not None) / one.theta_2.size

    def changes(theta_2: FloatArray) -> FloatArray:
        columns = []
        if alignment.phased:
            columns.append(template.slope(theta_2) * alignment.std_driven)
        bend = template.deflection(theta_2)
        if bend is not None:
            columns += [(bend - mean) * COMPLIANCE_DOUBT, np.full(bend.size, mean * COMPLIANCE_DOUBT)]
        return np.column_stack(columns)

    theta_1, estimated = one.estimated
    return AlignedResidual(
        theta_1=theta_1,
        theta_2=estimated,
        residual=one.residual,
        z_2=pair.driven.gear.z,
        time_s=one.time_s,
        backward=one.cleaned.backward,
        torque=one.torque,
        speed=one.speed,
        flank=one.flank,
        sharing=one.template.sharing,
        coarse=one.coarse,
        coarse_for_a_while=one.coarse_for_a_while,
        contact=one.template.sharing.contact,
        changes=changes if alignment.phased or template.rigid is not None else None,
        # The length of the path between the base circles is sqrt(a^2 - (r_b1 + r_b2)^2).
        ends_per_mm=1.0 / (math.sin(pair.alpha_w) * pair.driving.gear.p_b),
    )


def _known(section: GearSection, file: PairFile, zero: float | None, direction: int) -> GearKnown:
    """What the file says of one gear beforehand."""
    if section.inspection is not None:
        uncertainty = section.inspection.uncertainty_um * UM
        return GearKnown(z=section.teeth, uncertainty=uncertainty, zero=zero, direction=direction)
    if section.grade is None and section.limits is None:
        return GearKnown(z=section.teeth, zero=zero, direction=direction)
    gears = nominal_gears(file)
    mine = gears[0 if section is file.driving else 1]
    limits = stated_limits(section, mine, a=tight_centre_distance(*gears))
    return GearKnown(
        z=section.teeth, f_pT=limits.f_pT, F_pT=limits.F_pT, f_HalphaT=limits.f_HalphaT, zero=zero, direction=direction
    )


def _pitch_wave(section: GearSection, file: PairFile) -> float:
    """First order of a gear's index deviations that nobody inspected, mm."""
    return PITCH_WAVE * (_known(section, file, None, 1).F_pT or 0.0)
