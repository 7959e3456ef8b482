"""The main job: one pair over its hunting cycle, or at a recording's own samples, and what an engineer reads off it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.contact import Feature
from gearpoly.mesh.loaded import LoadedContacts
from gearpoly.mesh.meshing import Meshing
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.mesh.transmission import (
    Backlash,
    FlankContacts,
    Progress,
    both_flanks,
    mean_count,
    mean_pairs,
)
from gearpoly.units import ARCMIN, DEG, NM, UM, URAD, BoolArray, FloatArray, IntArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulation:
    """One run of one pair: contacts of both flanks at the same driven rotations, seen on the flank of the condition
    that ``mesh`` runs under, and its ``load`` if any.

    ``contact_ratio`` is the mean number of touching pairs, None where the positions are not evenly spaced. ``further``
    (N,) in rad is what twisting shafts, a resonance and changes of torque add to the transmission error.
    """

    assembled: Assembled
    mesh: Meshing
    backlash: Backlash
    load: LoadedContacts | None
    further: FloatArray
    contact_ratio: float | None
    seed: int

    @property
    def pair(self) -> GearPair:
        """The simulated pair."""
        return self.mesh.pair

    @property
    def flank(self) -> Flank:
        """The flank that carries."""
        return self.mesh.condition.flank

    @property
    def torque(self) -> float:
        """Torque in N.mm on the driven shaft."""
        return self.mesh.condition.torque

    @property
    def contacts(self) -> FlankContacts:
        """Contacts of the flank asked for."""
        return self.backlash.drive if self.flank == "drive" else self.backlash.coast

    @property
    def te(self) -> FloatArray:
        """Transmission error (N,) in rad, loaded where there is load."""
        return (self.contacts.te if self.load is None else self.load.te) + self.further

    @property
    def touches(self) -> BoolArray:
        """Which contact rows touch, or carry where there is load."""
        return self.contacts.touching if self.load is None else self.load.force > 0.0

    @property
    def pairs(self) -> IntArray:
        """Number of touching pairs (N,), of carrying ones where there is load."""
        return self.contacts.pairs if self.load is None else self.load.pairs

    @property
    def te_um(self) -> FloatArray:
        """Transmission error (N,) along the line of action, um."""
        return self.te * self.pair.r_b2 / UM

    @property
    def theta_1(self) -> FloatArray:
        """Driving rotation (N,) in rad at which the flank touches, (theta_2 - TE) z_2/z_1."""
        return (self.contacts.theta_2 - self.te) / self.pair.ratio

    def table(self) -> FloatArray:
        """Columns (N, 6): driven and driving angle in deg, transmission error in urad and um, backlash in um, pairs."""
        return np.column_stack(
            (
                self.contacts.theta_2 / DEG,
                self.theta_1 / DEG,
                self.te / URAD,
                self.te_um,
                self.backlash.j_bn / UM,
                self.pairs,
            )
        )

    def summary(self) -> dict[str, Any]:
        """Key figures in the units of the edge; angles of TE on the driven shaft, of lost motion on the driving
        shaft."""
        te, pair, found = self.te, self.pair, self.contacts
        te_pp = float(np.ptp(te))
        j_bn = self.backlash.j_bn
        corners = self.touches & (found.feature != int(Feature.FLANK))
        return {
            "positions": int(te.size),
            "te_pp_um": te_pp * pair.r_b2 / UM,
            "te_pp_urad": te_pp / URAD,
            "te_pp_arcmin": te_pp / ARCMIN,
            "te_mean_um": float(np.mean(te)) * pair.r_b2 / UM,
            "backlash_mean_um": float(np.mean(j_bn)) / UM,
            "backlash_least_um": float(np.min(j_bn)) / UM,
            "lost_motion_mean_arcmin": float(np.mean(j_bn)) / pair.r_b1 / ARCMIN,
            "contact_ratio": self.contact_ratio,
            "contact_ratio_theoretical": pair.eps_alpha,
            "corner_contacts": int(np.count_nonzero(corners)),
            "chord_noise_um": pair.chord_noise / UM,
            "certified": self.backlash.drive.certified + self.backlash.coast.certified,
            "repaired": self.backlash.drive.repaired + self.backlash.coast.repaired,
        } | self._load_summary()

    def _load_summary(self) -> dict[str, Any]:
        load = self.load
        if load is None:
            return {"torque_nm": self.torque / NM}
        b = self.pair.common_face_width
        return {
            "torque_nm": self.torque / NM,
            "mesh_stiffness_mean_n_per_um": float(np.mean(load.stiffness)) * UM,
            "mesh_stiffness_per_width_n_per_mm_um": float(np.mean(load.stiffness)) * UM / b,
            "deflection_mean_um": float(np.mean(load.approach)) / UM,
            "share_largest": float(np.max(load.share)),
            "force_largest_n": float(np.max(load.force)),
        }


def simulate(
    assembled: Assembled,
    theta_2: FloatArray,
    condition: Condition,
    *,
    seed: int,
    evenly: bool,
    fast: bool = False,
    time: FloatArray | None = None,
    off: FloatArray | None = None,
    progress: Progress,
) -> Simulation:
    """Both flanks of the pair at driven rotations ``theta_2`` (N,) in rad under ``condition``.

    A speed makes a mesh resonance swing, if the pair has one, and over ``time`` (N,) in s it follows a run-up; ``off``
    (N,) is the part by which the torque is off along a recording. A pair that runs backwards has ``theta_2`` falling
    while ``time`` rises. Evenly spaced positions (``evenly``) also give the contact ratio. Teeth stay rigid where the
    pair's file says so.
    Raises ``GeometryError``, ``JammedError`` or ``NotConvergedError`` as the contacts do, ``OutOfRangeError`` for a
    load beyond small deflections.
    """
    mesh = assembled.under(condition if off is None else replace(condition, varies=float(np.max(np.abs(off)))))
    backlash = both_flanks(mesh.pair, theta_2, near=mesh.near, fast=fast, progress=progress)
    met = mesh.met(backlash.coast if condition.coast else backlash.drive, fast=fast)
    ratio = None
    if evenly and met.load is None:
        ratio = mean_pairs(mesh.pair, met.contacts, fast=fast)
    elif evenly:
        # Teeth in mesh change by 1e-3 of a pitch when the torque does by 1 %; finer says nothing.
        ratio = mean_count(
            mesh.pair, theta_2, met.pairs, lambda theta: mesh.at(theta, fast=fast).pairs, resolution=2e-3
        )
    # In the order of angles, time counting back.
    backward = condition.backward
    order = slice(None, None, -1 if backward else 1)
    ahead = -time[::-1] if backward and time is not None else time
    further = mesh.further_te(theta_2[order], met.te[order], time=ahead)[order]
    further = further + mesh.varied_te(met, off)
    return Simulation(
        assembled=assembled,
        mesh=mesh,
        backlash=backlash,
        load=met.load,
        further=further,
        contact_ratio=ratio,
        seed=seed,
    )


YIELD = 700.0
"""MPa. Nominal stress in the tooth root above which most heat-treated gear steels would yield; only a remark hangs on
it."""


def strength_remarks(simulation: Simulation) -> list[str]:
    """A warning where the nominal bending stress at a tooth root says that the torque would make teeth yield.

    Stress of a beam, 6 F h / (b s^2), for the largest force at the tip and the thinnest root section (Lewis 1892), no
    factors.
    """
    load = simulation.load
    if load is None:
        return []
    force, pair = float(np.max(load.force)), simulation.pair
    worst, gear = max(
        (force / pair.common_face_width * mounted.flanks.root_leverage(), name)
        for name, mounted in (("driving", pair.driving), ("driven", pair.driven))
    )
    if worst <= YIELD:
        return []
    return [
        f"the nominal bending stress in the {gear} gear's tooth root is {worst:.0f} MPa, above {YIELD:.0f} "
        "MPa: teeth of most "
        "steels would yield under this torque; lower torque_nm or widen the faces"
    ]
