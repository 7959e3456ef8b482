"""One row of the table from its number alone: values, gears, contacts, outputs. This is what workers run.

The contacts are those of the fast exact path (``mesh.radial_search``). Every ``CERTIFY_EVERY``-th row is certified by
the polygon kernel at ``CERTIFY_AT`` positions of each flank; which rows those are depends on their number only.
"""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.assemble import Assembled, assemble
from gearpoly.errors import GearpolyError, InputFileError, JammedError, NoContactError
from gearpoly.files.models import PairFile
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.contact import Closings
from gearpoly.mesh.meshing import Met
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.mesh.radial import closing_rotations_fast
from gearpoly.mesh.transmission import (
    JAM,
    FlankContacts,
    certify_some,
    expected_closing,
    mean_count,
    touching_rows,
)
from gearpoly.positions import cycle_positions
from gearpoly.study.keys import with_values
from gearpoly.study.making import Maker, maker
from gearpoly.study.outputs import Curves, needs_of, output
from gearpoly.study.plan import StudyPlan
from gearpoly.study.read import check_pair
from gearpoly.units import DEG, NM, UM, FloatArray

CERTIFY_EVERY = 64
"""Rows of which one is certified. A fault of the search does not spare every 64th pair; certifying costs 40 ms."""

CERTIFY_AT = 8
"""Positions certified of each flank of a certified row."""

CHANGE_OF_PAIRS_PITCHES, LOADED_CHANGE_OF_PAIRS_PITCHES = 1e-4, 2e-3
"""Pitches. How closely a change of the number of touching pairs is placed, as in ``simulate``: under load it moves by
1e-3 of a pitch when the torque does by 1 %."""

DONE, JAMS, NO_CONTACT, REFUSED = "done", "jams", "no_contact", "refused"
"""What became of a row: outputs; the gears jam; their teeth come out of mesh somewhere; no such pair can be drawn,
mounted or computed. The first three were drawn: the second and third are bad pairs, the fourth is none."""


@dataclass(frozen=True, kw_only=True)
class MadeRow:
    """One row: number, ``values`` of the swept keys, ``seed`` of the draw, ``status`` and its ``reason``, and the
    outputs, nan where there are none."""

    index: int
    combination: int
    draw: int
    values: dict[str, Any]
    seed: int
    status: str
    reason: str
    outputs: tuple[float, ...]


@lru_cache(maxsize=64)
def _pair_file(plan: StudyPlan, combination: int) -> tuple[PairFile, Path]:
    """The checked pair file of one combination and the path that its trace files are relative to."""
    raw = with_values(plan.raw, plan.design.values(combination))
    return check_pair(raw, blame="pair", where=""), _folder(plan) / "pair.toml"


@lru_cache(maxsize=16)
def _maker(plan: StudyPlan, combination: int) -> Maker:
    return maker(*_pair_file(plan, combination))


def _assembled(plan: StudyPlan, combination: int, seed: int) -> Assembled:
    """The pair of one combination and seed. Which way it is made depends on the study alone, since the two ways round
    differently."""
    if plan.design.ranges:  # hardly any combination comes twice
        file, path = _pair_file(plan, combination)
        return assemble(file, path=path, seed=seed)
    return _maker(plan, combination).make(seed)


@lru_cache(maxsize=4)
def _folder(plan: StudyPlan) -> Path:
    """A folder of this process with the measured traces that the pair file names."""
    if not plan.traces:
        return Path()
    _KEPT.append(tempfile.TemporaryDirectory(prefix="gearpoly-"))
    folder = Path(_KEPT[-1].name)
    for name, text in plan.traces.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


_KEPT: list[tempfile.TemporaryDirectory[str]] = []


def make_row(plan: StudyPlan, index: int) -> MadeRow:
    """Row ``index`` of the table of ``plan``: a pure function of both, the same in every process.

    A pair that cannot be drawn, mounted or turned is a row too; only bugs raise.
    """
    design = plan.design
    combination, draw = design.place(index)
    values, seed = design.values(combination), design.seed(index)
    status, reason = DONE, ""
    found: tuple[float, ...] = (math.nan,) * len(plan.file.outputs)
    try:
        file, _ = _pair_file(plan, combination)
        assembled = _assembled(plan, combination, seed)
        curves = run_pair(assembled, file, plan, certify=index % CERTIFY_EVERY == 0)
        found = tuple(output(name).read(curves) for name in plan.file.outputs)
    except JammedError as error:
        status, reason = JAMS, str(error)
    except NoContactError as error:
        status, reason = NO_CONTACT, str(error)
    except InputFileError as error:
        status, reason = REFUSED, ": ".join(part for part in (error.where, error.found, error.wish) if part)
    except GearpolyError as error:
        status, reason = REFUSED, str(error)
    return MadeRow(
        index=index, combination=combination, draw=draw, values=values, seed=seed, status=status, reason=reason,
        outputs=found,
    )  # fmt: skip


def run_pair(assembled: Assembled, file: PairFile, plan: StudyPlan, *, certify: bool) -> Curves:
    """The curves of one pair that the outputs of ``plan`` need. Raises ``JammedError`` and what contacts raise."""
    flank = plan.file.flank
    mesh = assembled.under(Condition(flank=flank, torque=file.torque_nm * NM))
    pair = mesh.pair
    needs = needs_of(plan.file.outputs)
    theta_2 = cycle_positions(pair, turns=plan.file.turns, points_per_mesh=plan.file.positions_per_mesh)
    near, load, ratio = mesh.near, None, None

    def met(theta: FloatArray, *, certify: bool = False) -> Met:
        return mesh.met(_contacts(pair, theta, flank=flank, near=near, certify=certify))

    if mesh.compliance is not None or "count" in needs:
        found = met(theta_2, certify=certify)
        load, unloaded, te = found.load, found.contacts.te, found.te
        if "count" in needs:
            fine = CHANGE_OF_PAIRS_PITCHES if load is None else LOADED_CHANGE_OF_PAIRS_PITCHES
            ratio = mean_count(pair, theta_2, found.pairs, lambda at: met(at).pairs, resolution=fine)
    else:
        unloaded = te = first_touch(pair, theta_2, flank=flank, certify=certify)
    j_bn = None
    if "coast" in needs:
        other: Flank = "coast" if flank == "drive" else "drive"
        back = first_touch(pair, theta_2, flank=other, certify=certify)
        j_bn = (back - unloaded if flank == "drive" else unloaded - back) * pair.r_b2
        worst = int(np.argmin(j_bn))
        if j_bn[worst] < -JAM:
            raise JammedError(
                f"at driven angle {theta_2[worst] / DEG:.3f} deg the teeth overlap by {-j_bn[worst] / UM:.3f} um"
            )
    return Curves(
        pair=pair,
        te=te,
        per_mesh=plan.file.positions_per_mesh,
        editions=(file.driving.grade_edition, file.driven.grade_edition),
        j_bn=j_bn,
        contact_ratio=ratio,
        share=None if load is None else load.share,
        force=None if load is None else load.force,
        stiffness=None if load is None else load.stiffness,
    )


def _closings(
    pair: GearPair, theta_2: FloatArray, *, flank: Flank, near: float, certify: bool
) -> tuple[Closings, float]:
    """Closings of one flank and the rotation (rad) beyond which they count, as ``transmission.contacts`` has them."""
    sense, expected = 1.0 if flank == "drive" else -1.0, expected_closing(pair, flank)
    bodies = pair.driving.body(flank), pair.driven.body(flank)
    poses, guesses = -sense * theta_2, sense * theta_2 / pair.ratio + expected
    found = closing_rotations_fast(*bodies, axis_distance=pair.a, poses=poses, guesses=guesses, near=near / pair.r_b1)
    if certify:
        certify_some(pair, found, flank=flank, poses=poses, guesses=guesses, near=near / pair.r_b1, samples=CERTIFY_AT)
    return found, expected


def first_touch(pair: GearPair, theta_2: FloatArray, *, flank: Flank, certify: bool = False) -> FloatArray:
    """TE (N,) in rad of one flank at driven rotations ``theta_2`` (N,) in rad, and nothing else.

    Raises ``NoContactError`` where no pair touches.
    """
    from gearpoly.mesh.radial_search import search

    sense = 1.0 if flank == "drive" else -1.0
    if certify:
        found, expected = _closings(pair, theta_2, flank=flank, near=0.0, certify=True)
        pose, rotation = found.pose, found.rotation
    else:
        expected = expected_closing(pair, flank)
        bodies = pair.driving.body(flank), pair.driven.body(flank)
        teeth, values, _ = search(
            bodies[0].faces, bodies[1].faces, axis_distance=pair.a, poses=-sense * theta_2,
            guesses=sense * theta_2 / pair.ratio + expected, near=0.0,
        )  # fmt: skip
        pose, rotation = teeth[:, 0], values[:, 0]
    # Rows are sorted by position and closing; ties leave more than one.
    at, first = np.unique(pose, return_index=True)
    _all_touch(at, theta_2, flank)
    te: FloatArray = -pair.ratio * sense * (rotation[first] + expected)
    return te


def _all_touch(at: Any, theta_2: FloatArray, flank: Flank) -> None:
    if at.size != theta_2.size:
        missing = np.setdiff1d(np.arange(theta_2.size), at)[0]
        raise NoContactError(f"no {flank} flanks touch at driven angle {theta_2[missing] / DEG:.4f} deg")


def _contacts(pair: GearPair, theta_2: FloatArray, *, flank: Flank, near: float, certify: bool) -> FlankContacts:
    """As ``transmission.contacts`` with ``fast``, certified only where asked."""
    rows, expected = _closings(pair, theta_2, flank=flank, near=near, certify=certify)
    first = rows.first()
    _all_touch(rows.pose[first], theta_2, flank)
    sense = 1.0 if flank == "drive" else -1.0
    flip = np.array([1.0, sense])
    gap = (rows.rotation - rows.rotation[first][rows.pose]) * pair.r_b1
    touching, pairs = touching_rows(rows, gap, positions=theta_2.size, within=pair.chord_noise)
    return FlankContacts(
        flank=flank, theta_2=theta_2, te=-pair.ratio * sense * (rows.rotation[first] + expected), position=rows.pose,
        driving=rows.turning, driven=rows.fixed, gap=gap, point=rows.point * flip, normal=rows.normal * flip,
        feature=rows.feature, overrun=rows.overrun, touching=touching, pairs=pairs,
        certified=CERTIFY_AT if certify else 0, repaired=0, near=near,
    )  # fmt: skip
