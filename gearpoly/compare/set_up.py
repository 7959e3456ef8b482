"""What ``locate`` is given: aligned residuals, and what is known of each gear beforehand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from gearpoly.compare.even import Even
from gearpoly.compare.sharing import Carried, Flank, Sharing, nominal_carried
from gearpoly.units import FloatArray

IDEAL_GEAR_STD_MM = 1e-7
"""mm. Prior standard deviation of pitch and slope where the file declares an ideal gear: hardly any."""

LIMIT_SIGMAS = 2.0
"""Standard deviations at which a gear that passed its grade reaches a limit of slope; with 3 some in a thousand gears
would be scrap, with 1 a third."""


@dataclass(frozen=True, kw_only=True)
class GearKnown:
    """What is known of one gear: ``z`` teeth; ``uncertainty`` in mm of an inspection, or ``None``; limits of the
    grade in mm where nobody inspected: ``f_pT`` single pitch, ``F_pT`` cumulative, ``f_HalphaT`` slope. ``zero``
    encoder reading in rad at the contract's angle zero and ``direction`` of its count; ``None``: no encoder to point
    at."""

    z: int
    uncertainty: float | None = None
    f_pT: float | None = None
    F_pT: float | None = None
    f_HalphaT: float | None = None
    zero: float | None = None
    direction: int = 1

    @property
    def ideal(self) -> bool:
        """Whether the file declares a gear without deviations."""
        return self.uncertainty is None and self.F_pT is None

    @property
    def known_by(self) -> str:
        """Where what is known of its teeth comes from, in a word or two."""
        if self.uncertainty is not None:
            return "inspected"
        return "ideal" if self.ideal else "limits only, not inspected"

    @property
    def prior_std(self) -> tuple[float, float]:
        """Standard deviation in mm of a tooth's pitch (index) and slope about what was simulated.

        An inspection's uncertainty, else half the range that the grade allows: index deviations range over F_p.
        """
        if self.uncertainty is not None:
            std = max(self.uncertainty, IDEAL_GEAR_STD_MM)
            return std, std
        pitch = IDEAL_GEAR_STD_MM if self.F_pT is None else 0.5 * self.F_pT
        slope = IDEAL_GEAR_STD_MM if self.f_HalphaT is None else self.f_HalphaT / LIMIT_SIGMAS
        return max(pitch, IDEAL_GEAR_STD_MM), max(slope, IDEAL_GEAR_STD_MM)

    def encoder_deg(self, tooth: int) -> float | None:
        """Encoder reading in deg, 0 to 360, at which the pitch point of ``tooth`` passes the line of centres."""
        if self.zero is None:
            return None
        return float(np.degrees(self.zero) + self.direction * 360.0 * tooth / self.z) % 360.0

    def tooth_at(self, reading_deg: float | None) -> int | None:
        """The tooth whose pitch point passes the line of centres nearest to an encoder reading in deg; None where the
        zero is not known, or no reading is given."""
        if self.zero is None or reading_deg is None:
            return None
        turned = self.direction * (reading_deg - float(np.degrees(self.zero))) / 360.0
        return round(turned * self.z) % self.z


@dataclass(frozen=True, kw_only=True, eq=False)
class AlignedResidual:
    """One recording minus its simulation. ``theta_1``, ``theta_2`` (n,) in rad, continuous, increasing, 0 at the
    contract's zero; ``residual`` (n,) in mm along the line of action; ``time_s`` (n,), rising, or ``None``;
    ``backward``: the pair ran backwards, so time counts back from 0 and samples come in the order of angles; ``torque``
    in N.mm, ``speed`` in rad/s, ``flank`` the condition. ``sharing`` from the simulation; without it each pair counts
    alike over ``contact`` (begin, end in pitches about the pitch point). ``changes``: how the simulation changes at
    ``theta_2`` (k,) with what is not known exactly (zeros, compliance), (k, m) in mm per standard deviation;
    ``nuisance`` (n, m) the same at every sample, once a record is short enough to hold it. ``averaged`` meshes over
    which each sample is a mean already (0: it is none), ``even`` how evenly those came that it is a mean of.
    ``ends_per_mm`` pitches by which the ends of contact move when an axis moves by 1 mm. ``coarse`` in mm, the largest
    wave that the rounding of readings makes in samples that come evenly (0: rounding makes noise), and
    ``coarse_for_a_while`` the same where a shaft turns evenly for a while only.
    """

    theta_1: FloatArray
    theta_2: FloatArray
    residual: FloatArray
    z_2: int
    time_s: FloatArray | None = None
    backward: bool = False
    torque: float | None = None
    speed: float | None = None
    flank: Flank = "drive"
    sharing: Sharing | None = None
    contact: tuple[float, float] = (-0.8, 0.8)
    changes: Callable[[FloatArray], FloatArray] | None = None
    nuisance: FloatArray | None = None
    averaged: float = 0.0
    even: Even = field(default_factory=Even)
    ends_per_mm: float = 0.0
    coarse: float = 0.0
    coarse_for_a_while: float = 0.0

    def __post_init__(self) -> None:
        sizes = {self.theta_1.size, self.theta_2.size, self.residual.size}
        if self.time_s is not None:
            sizes.add(self.time_s.size)
        if len(sizes) != 1:
            raise ValueError(f"the arrays of a residual share one length, not {sorted(sizes)}")
        if not np.isfinite(self.residual).all():
            raise ValueError("a residual has no gaps: leave drop-outs out of all arrays")

    @cached_property
    def u(self) -> FloatArray:
        """Meshes (n,) since the contract's zero."""
        u = self.theta_2 * (self.z_2 / (2.0 * np.pi))
        u.setflags(write=False)
        return u

    def carried(self, z_1: int, z_2: int) -> Carried:
        """The pairs at every sample."""
        if self.sharing is not None:
            return self.sharing.at(self.u)
        return nominal_carried(self.u, z_1=z_1, z_2=z_2, contact=self.contact, flank=self.flank)
