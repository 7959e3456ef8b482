"""One cleaned recording as a curve, and minus the simulation it is laid on: what both gears and the rig leave."""

from __future__ import annotations

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.compare.angles import driven_share
from gearpoly.compare.beside import Aligned
from gearpoly.compare.curve import Cycle, RecordedCurve
from gearpoly.compare.pieces import pieces
from gearpoly.compare.slow import slow_curves
from gearpoly.compare.template import Template
from gearpoly.compare.zeros import Alignment, Base
from gearpoly.mesh.shafts import runs_up
from gearpoly.mesh.swings import SWINGS_PER_MESH, swings_at
from gearpoly.recording.clean import Cleaned
from gearpoly.recording.rounding import reading_step
from gearpoly.units import RPM, UM, FloatArray


def curve_of(
    one: Cleaned, template: Template, drift: tuple[float, ...], count: int, base: Base, cycle: Cycle
) -> RecordedCurve:
    """The recording by the set's base zeros instead of its own, a known ``drift`` (um, Legendre) taken off."""
    recording = one.recording
    further_1 = recording.driving_direction * ((recording.driving_zero_rad or 0.0) - (base.driving or 0.0))
    further_2 = recording.driven_direction * ((recording.driven_zero_rad or 0.0) - (base.driven or 0.0))
    counted = not recording.computed
    driven = recording.driven_angle_rad is not None
    theta_2 = one.theta_2 + (further_2 if driven else cycle.ratio * further_1)
    te = one.te + (further_2 - cycle.ratio * further_1 if counted else 0.0)
    if drift:
        x = one.theta_2 if one.time_s is None else one.time_s
        x = -x if one.backward else x
        te = te - slow_curves(x, len(drift) + 1)[:, 1:] @ np.array(drift) * (UM / cycle.r_b2)
    return RecordedCurve(
        theta_2=theta_2,
        te=te * cycle.r_b2,
        weight=np.ones(one.size),
        template=template,
        turn=cycle.z_2 if driven else cycle.z_1,
        counted=counted,
        count=count,
    )


def _swings(one: Cleaned, template: Template, assembled: Assembled, theta_2: FloatArray) -> FloatArray | None:
    """What a declared resonance adds (n,) in mm in a run-up; ``None`` where there is neither."""
    if assembled.shafts.frequency is None or one.time_s is None or runs_up(theta_2, one.time_s) is None:
        return None
    pair, cycle = assembled.pair, template.cycle
    te = template.at(np.linspace(0.0, cycle, pair.meshes_per_cycle * SWINGS_PER_MESH, endpoint=False))
    here = template.at(theta_2)
    return swings_at(assembled.shafts, te, pair, theta_2, here, speed=None, time=one.time_s, backward=one.backward)


def once_only(
    one: Cleaned, template: Template, assembled: Assembled, theta_2: FloatArray, load: FloatArray | None
) -> FloatArray | None:
    """What never comes again in a recording (n,) in mm: a run-up through a resonance, changes of torque; ``None`` where
    there is neither."""
    swings = _swings(one, template, assembled, theta_2)
    if load is None:
        return swings
    varied = template.varied(theta_2, load)
    return varied if swings is None else swings + varied


def subtracted(
    one: Cleaned,
    curve: RecordedCurve,
    alignment: Alignment,
    k: int,
    torque: float,
    assembled: Assembled,
    cycle: Cycle,
    before: FloatArray | None,
    load: FloatArray | None,
    *,
    default_speed: float | None,
) -> Aligned:
    """Recording ``k`` of the set on its simulation, and minus it: ``torque`` in N.mm, ``before`` (n,) in mm what never
    comes again and was taken off its ``curve``, ``load`` (n,) relative changes of the torque, speed in rev/min."""
    theta_2 = curve.theta_2 - alignment.shift[k]
    recorded = curve.te - alignment.offset[k]
    swings = _swings(one, curve.template, assembled, theta_2)
    if before is not None:
        recorded = recorded + before
    residual = np.empty(theta_2.size)
    for here in pieces(theta_2.size):
        residual[here] = recorded[here] - curve.template.at(theta_2[here])
    if swings is not None:
        residual -= swings
        swings.setflags(write=False)
    if load is not None:
        residual -= curve.template.varied(theta_2, load)
        load.setflags(write=False)
    speed = one.recording.speed_rpm
    if speed is not None:
        speed *= RPM
    elif one.speed_rpm is not None and np.isfinite(one.speed_rpm).any():
        speed = float(np.nanmean(one.speed_rpm)) * RPM
    elif one.time_s is not None and one.time_s[-1] > one.time_s[0]:
        travel = (theta_2[-1] - theta_2[0]) - (recorded[-1] - recorded[0]) / cycle.r_b2
        speed = float(travel / cycle.ratio / (one.time_s[-1] - one.time_s[0]))
    elif default_speed is not None:
        speed = default_speed * RPM
    return Aligned(
        cleaned=one,
        theta_2=theta_2,
        recorded=recorded,
        residual=residual,
        r_b2=cycle.r_b2,
        flank=one.recording.flank,
        torque=torque,
        speed=speed,
        template=curve.template,
        swings=swings,
        load=load,
        steps=_steps(one),
        driven_share=_driven_share(one),
    )


def _driven_share(one: Cleaned) -> float:
    """Part of the noise of single samples that the driven angle has; a transmission error that the rig computed brings
    its noise to the shaft that was not read."""
    if one.recording.computed:
        return float(one.recording.driven_angle_rad is None)
    return driven_share(one.theta_1, one.theta_2, ratio=one.ratio)


def _steps(one: Cleaned) -> tuple[float | None, float | None]:
    """The steps in rad of both shafts' readings, where they show."""
    read = one.recording.driving_angle_rad is not None, one.recording.driven_angle_rad is not None
    first, second = (
        reading_step(angle) if there else None for angle, there in zip((one.theta_1, one.theta_2), read, strict=True)
    )
    return first, second
