"""The virtual bench: a pair with everything that can be wrong with it, and its transmission error at given
positions."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from gearpoly.proving.compliance import Compliance, compliance
from gearpoly.proving.contacts import FlankRows, Mesh, Positions, contacts, error
from gearpoly.proving.flanks import ToothDeviations, table
from gearpoly.proving.gears import MM_PER_UM, RAD_PER_DEG, FloatArray, IdealPair


class BenchError(RuntimeError):
    """The bench found no contact where there must be one: its own fault, not that of a file."""


@dataclass(frozen=True, kw_only=True)
class EncoderDeviation:
    """What one encoder adds to the angle of its shaft.

    eccentricity_urad and its angle_deg; interp_urad at interp_order per turn (a multiple of the line count) with its
    phase; ratio: counts per turn set wrongly, or a slipping coupling."""

    eccentricity_urad: float = 0.0
    angle_deg: float = 0.0
    interp_order: int = 0
    interp_urad: float = 0.0
    interp_phase: float = 0.0
    ratio: float = 1.0

    def error(self, theta: FloatArray) -> FloatArray:
        """Reading less truth in rad, without the counts, at shaft angles in rad."""
        out = self.eccentricity_urad * 1e-6 * np.sin(theta - self.angle_deg * RAD_PER_DEG)
        out += self.interp_urad * 1e-6 * np.cos(self.interp_order * theta + self.interp_phase)
        return np.asarray(out + (self.ratio - 1.0) * theta, dtype=np.float64)


class Extra:
    """What a physics does to a rig beyond the rig's own fields. Each way of changing it is one method, and does nothing
    unless a physics says so."""

    teeth = False
    """Whether it changes what the teeth do; else it changes the readings only."""

    def x(self, time: FloatArray, theta_1: FloatArray, theta_2: FloatArray, span: tuple[float, float]) -> FloatArray:
        """Its share of the transmission error in mm, at times in s; span: start and end of the recording in s."""
        return np.zeros_like(time)

    def under(self, rig: Rig, torque: float) -> Rig:
        """The rig as it is under a driven torque in N.m."""
        return rig

    def ends(self, pair: IdealPair, index: int, ends: FloatArray) -> FloatArray:
        """Roll lengths (mm) at which the flanks of the teeth of gear 1 or 2 end, one per tooth."""
        return ends

    def torque(self, theta_2: FloatArray, span: tuple[float, float]) -> FloatArray:
        """Factor on the torque at driven angles in rad; span: those of start and end of the recording."""
        return np.ones_like(theta_2)

    def softness(self, theta_2: FloatArray, span: tuple[float, float]) -> FloatArray:
        """Factor on the compliance of all teeth, contact left out."""
        return np.ones_like(theta_2)


@dataclass(frozen=True, kw_only=True)
class Rig:
    """Everything that is true of one set-up. Lengths of errors in um, angles in deg, torques in N.m, frequencies in Hz.

    eccentric_1, eccentric_2: amplitude and angle of the gear's own centre off its axis, as the contract counts it.
    lead: gap across the face width. drift: rise from start to end of each recording, drift_bend of which time constants
    of warming up fit into it.
    """

    pair: IdealPair
    teeth_1: ToothDeviations
    teeth_2: ToothDeviations
    eccentric_1: tuple[float, float] = (0.0, 0.0)
    eccentric_2: tuple[float, float] = (0.0, 0.0)
    deflect: bool = False
    law: str = "sainsot"
    scale: float = 1.0
    youngs_mpa: float = 206000.0
    friction: float = 0.0
    lead: float = 0.0
    windup: float = 0.0
    resonance: tuple[float, float] | None = None
    drift: float = 0.0
    drift_bend: float = 2.5
    encoder_1: EncoderDeviation = field(default_factory=EncoderDeviation)
    encoder_2: EncoderDeviation = field(default_factory=EncoderDeviation)
    extras: tuple[Extra, ...] = ()

    def teeth(self, index: int) -> ToothDeviations:
        """Teeth of gear 1 or 2."""
        return self.teeth_1 if index == 1 else self.teeth_2

    def encoder(self, index: int) -> EncoderDeviation:
        """Encoder of shaft 1 or 2."""
        return self.encoder_1 if index == 1 else self.encoder_2

    def with_teeth(self, index: int, teeth: ToothDeviations) -> Rig:
        """The same rig with other teeth on gear 1 or 2."""
        return replace(self, teeth_1=teeth) if index == 1 else replace(self, teeth_2=teeth)

    def with_encoder(self, index: int, encoder: EncoderDeviation) -> Rig:
        """The same rig with another encoder on shaft 1 or 2."""
        return replace(self, encoder_1=encoder) if index == 1 else replace(self, encoder_2=encoder)


@lru_cache(maxsize=32)
def _law(pair: IdealPair, law: str, scale: float, youngs_mpa: float) -> Compliance:
    return compliance(pair, law=law, scale=scale, E=youngs_mpa)


def mesh(
    rig: Rig, theta_2: FloatArray, *, torque: float, flank: str = "drive", span: tuple[float, float] = (0.0, 1.0)
) -> Mesh:
    """Quasi-static contact of the pair at driven angles theta_2 (rad), torque in N.m; wind-up included, no encoders.

    span: driven angles at which the recording starts and ends, for what changes from one to the other."""
    at, of, twist = _posed(rig, theta_2, torque, flank, span)
    got, failed = contacts(at, of)
    _found(failed, theta_2.size)
    return got if twist is None else replace(got, x=got.x + twist)


def meshing(
    rig: Rig, theta_2: FloatArray, *, torque: float, flank: str = "drive", span: tuple[float, float] = (0.0, 1.0)
) -> FloatArray:
    """Transmission error (mm) of the same contact alone, at less cost."""
    at, of, twist = _posed(rig, theta_2, torque, flank, span)
    x, failed = error(at, of)
    _found(failed, theta_2.size)
    return x if twist is None else x + twist


def _found(failed: int, n: int) -> None:
    if failed:
        raise BenchError(f"no equilibrium at {failed} of {n} positions")


def _posed(
    rig: Rig, theta_2: FloatArray, torque: float, flank: str, span: tuple[float, float]
) -> tuple[Positions, FlankRows, FloatArray | None]:
    """Positions and flanks as the contact is asked for them, and what the wind-up of the shafts adds (mm)."""
    for extra in rig.extras:
        rig = extra.under(rig, torque)
    pair = rig.pair
    n = theta_2.size
    load, soft = np.full(n, torque), np.ones(n)
    ends = [np.full(pair.gear(index).z, pair.gear(index).l_tip) for index in (1, 2)]
    for extra in rig.extras:
        load *= extra.torque(theta_2, span)
        soft *= extra.softness(theta_2, span)
        ends = [extra.ends(pair, index, ends[index - 1]) for index in (1, 2)]
    law = _law(pair, rig.law, rig.scale, rig.youngs_mpa)
    (e1, a1), (e2, a2) = rig.eccentric_1, rig.eccentric_2
    at = Positions(
        theta_2=np.ascontiguousarray(theta_2, dtype=np.float64), moments=1000 * load, soft=soft,
        side=1.0 if flank == "drive" else -1.0, z=np.array([pair.driving.z, pair.driven.z]), geo=_geometry(pair),
        ecc=np.array([MM_PER_UM * e1, a1 * RAD_PER_DEG, MM_PER_UM * e2, a2 * RAD_PER_DEG]),
        nodes=np.array([law.l_1, law.c_1, law.l_2, law.c_2]),
        contact=np.array([law.h_0, law.q, law.h_1, law.h_2]), deflect=rig.deflect, friction=rig.friction,
        lead=MM_PER_UM * rig.lead,
    )  # fmt: skip
    of = FlankRows(
        rows_1=table(pair, 1, rig.teeth_1, flank, ends[0]), rows_2=table(pair, 2, rig.teeth_2, flank, ends[1]),
        own_1=rig.teeth_1.own, own_2=rig.teeth_2.own,
    )  # fmt: skip
    if not rig.windup:
        return at, of, None
    sign = -1.0 if flank == "drive" else 1.0
    return at, of, sign * pair.driven.r_b * rig.windup * 1e-6 * load


@lru_cache(maxsize=256)
def _geometry(pair: IdealPair) -> FloatArray:
    """Lengths (mm) and angles (rad) of a pair as `solve` takes them."""
    g, h = pair.driving, pair.driven
    return np.array(
        [
            g.r_b, h.r_b, pair.a, pair.alpha_w, pair.l_work(1), pair.l_work(2), g.l_tip, h.l_tip,
            max(g.l_form, 0.05 * g.l_tip), pair.thickness_angle(1), pair.thickness_angle(2),
        ]
    )  # fmt: skip


def ideal(pair: IdealPair, E_s: float = 0.0) -> Rig:
    """A rig whose gears have no deviation but a tooth thickness deviation E_s in um on both."""
    return Rig(
        pair=pair, teeth_1=ToothDeviations.ideal(pair.driving.z, E_s), teeth_2=ToothDeviations.ideal(pair.driven.z, E_s)
    )
