"""What one simulation is asked for: even places of whole meshes, or a recording's own samples, and what acts there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearpoly import positions
from gearpoly.assemble import Assembled, root_remarks
from gearpoly.errors import JammedError
from gearpoly.files.models import PairFile
from gearpoly.inspected import thickness_remarks
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.pair import Flank
from gearpoly.mesh.transmission import Progress
from gearpoly.recording.chain import corrected
from gearpoly.recording.load import relative_load
from gearpoly.recording.recording import Recording
from gearpoly.simulate import Simulation, simulate, strength_remarks
from gearpoly.units import NM, RPM, FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Course:
    """Where and under what a pair is simulated: driven angles ``theta_2`` (n,) in rad, ``evenly`` spaced or not, times
    (n,) in s and relative deviations of the torque (n,) where a recording has them, and what had to be assumed."""

    theta_2: FloatArray
    condition: Condition
    evenly: bool
    time: FloatArray | None = None
    off: FloatArray | None = None
    remarks: tuple[str, ...] = ()

    @property
    def steps(self) -> int:
        """Positions to be found, one for each flank, for those who show progress."""
        return 2 * self.theta_2.size


def over_turns(
    assembled: Assembled,
    file: PairFile,
    *,
    flank: Flank | None = None,
    turns: float | None = None,
    points_per_mesh: int | None = None,
    torque_nm: float | None = None,
) -> Course:
    """Even places of whole meshes under what the pair file states, or another torque.

    Raises ``OutOfRangeError`` for turns or points that are none.
    """
    speed = file.pair.speed_rpm
    each = positions.USUAL_POINTS_PER_MESH if points_per_mesh is None else points_per_mesh
    return Course(
        theta_2=positions.cycle_positions(assembled.pair, turns=turns, points_per_mesh=each),
        condition=Condition(
            flank="drive" if flank is None else flank,
            torque=(file.torque_nm if torque_nm is None else torque_nm) * NM,
            speed=None if speed is None else speed * RPM,
        ),
        evenly=True,
    )


def along(assembled: Assembled, file: PairFile, recording: Recording, *, flank: Flank | None = None) -> Course:
    """The samples of a recording under its condition, or on another flank; what it does not state is the pair file's.

    Raises ``OutOfRangeError`` where all samples are drop-outs.
    """
    pair = assembled.pair
    recording = corrected(recording, *assembled.encoders, ratio=pair.ratio, r_b2=pair.r_b2)
    there = positions.recording_positions(pair, recording)
    torque = positions.recorded_torque(recording, default=file.torque_nm)
    turned = float(np.ptp(there.theta_2)) / pair.driven.gear.tau
    speed = recording.speed_rpm if recording.speed_rpm is not None else file.pair.speed_rpm
    return Course(
        theta_2=there.theta_2,
        condition=Condition(
            flank=recording.flank if flank is None else flank,
            torque=torque * NM,
            speed=None if speed is None else speed * RPM,
            backward=recording.backward,
        ),
        evenly=False,
        time=there.time,
        off=relative_load(there.torque, torque, meshes=turned),
        remarks=(*there.remarks, *recording.remarks),
    )


def simulate_course(
    assembled: Assembled, course: Course, file: PairFile, *, seed: int, fast: bool, progress: Progress
) -> Simulation:
    """The pair of a ``file`` on its ``course``; raises as :func:`gearpoly.simulate.simulate` does."""
    try:
        return simulate(
            assembled,
            course.theta_2,
            course.condition,
            seed=seed,
            evenly=course.evenly,
            fast=fast,
            time=course.time,
            off=course.off,
            progress=progress,
        )
    except JammedError as jam:
        # Whoever stated a thickness is not helped by being told to state one.
        raise JammedError("; ".join((str(jam), *thickness_remarks(file)))) from None


def remarks_on(file: PairFile, course: Course, simulation: Simulation) -> tuple[str, ...]:
    """What had to be assumed, and what of the pair or its load is unusual."""
    return (*course.remarks, *thickness_remarks(file), *root_remarks(file), *strength_remarks(simulation))
