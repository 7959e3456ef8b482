"""The main job: one pair over its hunting cycle, or at a recording's own samples, and what an engineer reads off it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.mesh.contact import Feature
from gearpoly.mesh.deflection import PairCompliance, pair_compliance
from gearpoly.mesh.loaded import LoadedContacts, load_reach, loaded
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.mesh.shafts import Shafts, swings_along
from gearpoly.mesh.transmission import (
    NEAR,
    Backlash,
    FlankContacts,
    Progress,
    both_flanks,
    contacts,
    mean_count,
    mean_pairs,
)
from gearpoly.mesh.varied import GENTLE, giving
from gearpoly.units import ARCMIN, DEG, NM, UM, URAD, BoolArray, FloatArray, IntArray, read_only


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulation:
    """One run of one pair: contacts of both flanks at the same driven rotations, seen on ``flank``, and its ``load``
    if any.

    ``contact_ratio`` is the mean number of touching pairs, None where the positions are not evenly spaced. ``further``
    (N,) in rad is what twisting shafts, a resonance and changes of torque add to the transmission error.
    """

    assembled: Assembled
    flank: Flank
    backlash: Backlash
    load: LoadedContacts | None
    further: FloatArray
    torque: float
    contact_ratio: float | None
    seed: int

    @property
    def pair(self) -> GearPair:
        """The simulated pair."""
        return self.assembled.pair

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
    *,
    torque: float,
    flank: Flank,
    seed: int,
    evenly: bool,
    fast: bool = False,
    speed: float | None = None,
    time: FloatArray | None = None,
    off: FloatArray | None = None,
    backward: bool = False,
    progress: Progress,
) -> Simulation:
    """Both flanks of the pair at driven rotations ``theta_2`` (N,) in rad under ``torque`` (N.mm on the driven
    shaft).

    ``speed`` of the driving shaft in rad/s makes a mesh resonance swing, if the pair has one, and over ``time`` (N,) in
    s it follows a run-up; ``off`` (N,) is the part by which the torque is off along a recording; ``backward``: the
    pair runs backwards, ``theta_2`` falling while ``time`` rises. Evenly spaced
    positions (``evenly``) also give the contact ratio. Teeth stay rigid where the pair's file says so.
    Raises ``GeometryError``, ``JammedError`` or ``NotConvergedError`` as the contacts do, ``OutOfRangeError`` for a
    load beyond small deflections.
    """
    pair, bends = assembled.pair, assembled.elasticity
    loaded_teeth = bends is not None and torque > 0.0
    compliance = None
    if bends is not None and loaded_teeth:
        compliance = pair_compliance(pair, bends.running(backward=backward), flank=flank)
    heaviest = torque if off is None else torque * (1.0 + float(np.max(np.abs(off))))
    near = NEAR if compliance is None else NEAR + load_reach(compliance, heaviest)
    backlash = both_flanks(pair, theta_2, near=near, fast=fast, progress=progress)
    found = backlash.drive if flank == "drive" else backlash.coast
    load = None if compliance is None else loaded(found, compliance, torque=torque, sharing=assembled.sharing)
    ratio = None
    if evenly and compliance is None:
        ratio = mean_pairs(pair, found, fast=fast)
    elif evenly and compliance is not None and load is not None:
        bending = compliance

        def carrying(theta: FloatArray) -> IntArray:
            return loaded(
                contacts(pair, theta, flank=flank, near=near, fast=fast),
                bending,
                torque=torque,
                sharing=assembled.sharing,
            ).pairs

        # Teeth in mesh change by 1e-3 of a pitch when the torque does by 1 %; finer says nothing.
        ratio = mean_count(pair, theta_2, load.pairs, carrying, resolution=2e-3)
    # In the order of angles, time counting back.
    order = slice(None, None, -1 if backward else 1)
    ahead = -time[::-1] if backward and time is not None else time
    te = found.te if load is None else load.te
    further = further_te(
        assembled, theta_2[order], te[order], torque=torque, flank=flank, speed=speed, time=ahead, backward=backward
    )[order]
    further = further + varied_te(assembled, found, compliance, load, off, torque=torque)
    return Simulation(
        assembled=assembled,
        flank=flank,
        backlash=backlash,
        load=load,
        further=further,
        torque=torque,
        contact_ratio=ratio,
        seed=seed,
    )


SWINGS_PER_MESH = 128
"""Places per pitch at which a curve is known that makes a resonance swing: of 3 um of rough teeth without load, swings
of 13 um then come out to 7 nm, of 2 um at six times the mesh frequency to 15 nm."""


def further_te(
    assembled: Assembled,
    theta_2: FloatArray,
    te: FloatArray,
    *,
    torque: float,
    flank: Flank,
    speed: float | None,
    time: FloatArray | None = None,
    backward: bool = False,
) -> FloatArray:
    """What shafts and resonance add (N,) in rad to the transmission error ``te`` (N,) in rad of the mesh alone at
    ``theta_2`` (N,) in rad; arguments as for ``simulate``."""
    pair, shafts = assembled.pair, assembled.shafts
    out = np.full(theta_2.size, shafts.twist(torque=torque, coast=flank == "coast"))
    if shafts.frequency is None or speed is None:
        return out
    whole = cycle_te(assembled, torque=torque, flank=flank, backward=backward)
    return out + swings_at(shafts, whole, pair, theta_2, te, speed=speed, time=time, backward=backward)


def varied_te(
    assembled: Assembled,
    rows: FlankContacts,
    by: PairCompliance | None,
    load: LoadedContacts | None,
    off: FloatArray | None,
    *,
    torque: float,
) -> FloatArray | float:
    """What a torque adds to the transmission error (N,) in rad that is off its mean ``torque`` (N.mm) by the part
    ``off`` (N,) of it (None: steady): shafts twist, and teeth give, by the stiffness of ``load`` where that is little,
    else as a parabola through ``rows`` under the mean, the least and the largest torque has it, which second contacts
    and Hertz's law bend."""
    if off is None:
        return 0.0
    coast = rows.flank == "coast"
    twist = off * assembled.shafts.twist(torque=torque, coast=coast)
    if load is None or by is None:
        return twist
    most = float(np.max(np.abs(off)))
    if most < GENTLE:
        return twist + off * ((1.0 if coast else -1.0) * torque / (load.stiffness * assembled.pair.r_b2**2))
    return twist + giving(rows, by, load.te, torque=torque, most=most, sharing=assembled.sharing).by(off)


def swings_at(
    shafts: Shafts,
    te: FloatArray,
    pair: GearPair,
    theta_2: FloatArray,
    here: FloatArray,
    *,
    speed: float | None,
    time: FloatArray | None,
    backward: bool = False,
) -> FloatArray:
    """What a resonance adds (N,) at ``theta_2`` (N,) in rad to the curve ``te`` (m,) of a hunting cycle, which is
    ``here`` (N,) there, in its unit: settled at a driving ``speed`` in rad/s (None: it is not turning), or as it
    follows the speed that ``time`` (N,) in s tells, which near a resonance counts by the thousandth. ``backward``: the
    last comes first, by a ``time`` that counts back from the end."""
    if backward:
        mirrored, ahead = np.roll(te[::-1], 1), None if time is None else time[-1] - time[::-1]
        return swings_at(shafts, mirrored, pair, -theta_2[::-1], here[::-1], speed=speed, time=ahead)[::-1]
    if time is not None and time[-1] > time[0]:
        pitch = pair.cycle / pair.meshes_per_cycle
        return swings_along(shafts, te, cycle=pair.cycle, pitch=pitch, theta_2=theta_2, time=time, here=here)
    if speed is None:
        return np.zeros(theta_2.size)
    period = pair.cycle / (speed * pair.ratio)
    even = np.arange(te.size) * (pair.cycle / te.size)
    added, known = (np.interp(theta_2, even, one, period=pair.cycle) for one in (shafts.swings(te, period=period), te))
    return np.asarray(added + shafts.unmoved(here - known, rate=te.size / period))


@lru_cache(maxsize=8)
def cycle_te(assembled: Assembled, *, torque: float, flank: Flank, backward: bool = False) -> FloatArray:
    """Transmission error of the mesh alone in rad at even places of a hunting cycle, ``SWINGS_PER_MESH`` a pitch."""
    pair = assembled.pair
    size = pair.meshes_per_cycle * SWINGS_PER_MESH
    even = np.arange(size, dtype=np.float64) * (pair.cycle / size)
    bends = assembled.elasticity if torque > 0.0 else None
    compliance = pair_compliance(pair, bends.running(backward=backward), flank=flank) if bends is not None else None
    near = NEAR if compliance is None else NEAR + load_reach(compliance, torque)
    found = contacts(pair, even, flank=flank, near=near, fast=True)
    te = found.te if compliance is None else loaded(found, compliance, torque=torque, sharing=assembled.sharing).te
    return read_only(te)


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
