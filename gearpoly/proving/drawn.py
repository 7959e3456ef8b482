"""Pairs of the proving ground, and gears drawn within a grade: the deviations, and what is known of them beforehand.

Limits: ISO 1328-1:2013, unrounded, as the project's contract and paper notes give them.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sqrt

import numpy as np

from gearpoly.proving.flanks import ToothDeviations
from gearpoly.proving.gears import FloatArray, IdealGear, IdealPair

BENCH_PAIRS: dict[str, tuple[int, int, float, float, float, float, float]] = {
    # name: z_1, z_2, m, alpha_deg, x_1, x_2, b
    "18/25 m2": (18, 25, 2.0, 20.0, 0.0, 0.0, 20.0),
    "24/36 m1": (24, 36, 1.0, 20.0, 0.0, 0.0, 10.0),
    "20/30 m6": (20, 30, 6.0, 20.0, 0.0, 0.0, 40.0),
    "19/24 m3 25deg": (19, 24, 3.0, 25.0, 0.0, 0.0, 25.0),
    "15/28 m1.5 shifted": (15, 28, 1.5, 20.0, 0.35, -0.1, 12.0),
    "30/45 m0.5": (30, 45, 0.5, 20.0, 0.0, 0.0, 5.0),
    "17/22 m4 22.5deg": (17, 22, 4.0, 22.5, 0.25, 0.2, 30.0),
}
"""Teeth with and without a common factor, modules 0.5 to 6, three pressure angles, with and without profile shift."""
FURTHER_PAIRS: dict[str, tuple[int, int, float, float, float, float, float]] = {
    "12/47 m0.5 shifted": (12, 47, 0.5, 20.0, 0.3, -0.3, 5.0),
    "13/40 m1": (13, 40, 1.0, 20.0, 0.3, -0.1, 10.0),
    "13/18": (13, 18, 2.774194, 20.0, 0.3, -0.3, 20.0),
    "21/29": (21, 29, 1.72, 20.0, 0.0, 0.0, 20.0),
    "23/32": (23, 32, 1.563636, 20.0, 0.0, 0.0, 20.0),
    "28/39": (28, 39, 1.283582, 20.0, 0.0, 0.0, 20.0),
}
"""What drives and mounts have beside: a large ratio, small modules; and pairs of the centre distance of 18/25 m2 whose
ratio is that to less than a hundredth."""


def make_pair(name: str, offset: float = 0.0) -> IdealPair:
    """A pair of `BENCH_PAIRS` or `FURTHER_PAIRS`; offset in mm is added to the centre distance."""
    z_1, z_2, m, alpha, x_1, x_2, b = (BENCH_PAIRS | FURTHER_PAIRS)[name]
    # At 25 deg the standard root radius does not fit between the rack's teeth.
    rho_f = 0.38 if alpha < 24 else 0.3
    gears = [
        IdealGear(z=z, m=m, alpha_deg=alpha, x=x, rho_f=rho_f, b=b, bore=round(0.56 * z * m, 2))
        for z, x in ((z_1, x_1), (z_2, x_2))
    ]
    return IdealPair(driving=gears[0], driven=gears[1], offset=offset)


@dataclass(frozen=True, kw_only=True)
class GradeLimits:
    """Limits in um of one gear at one grade: single pitch, total cumulative pitch, profile slope, profile form."""

    f_p: float
    F_p: float
    f_H: float
    f_f: float


def limits(gear: IdealGear, grade: int) -> GradeLimits:
    """ISO 1328-1:2013 flank tolerance class to limits in um."""
    d, m, step = 2 * gear.r, gear.m, sqrt(2) ** (grade - 5)
    return GradeLimits(
        f_p=(0.001 * d + 0.4 * m + 5) * step,
        F_p=(0.002 * d + 0.55 * sqrt(d) + 0.7 * m + 12) * step,
        f_H=(0.4 * m + 0.001 * d + 4) * step,
        f_f=(0.55 * m + 5) * step,
    )


def index_covariance(gear: IdealGear, grade: int) -> FloatArray:
    """Covariance (um^2) of the index deviations that `draw` draws from: waves of order 1 to 3 and single teeth."""
    limit = limits(gear, grade)
    apart = 2 * pi * (np.arange(gear.z)[:, None] - np.arange(gear.z)[None, :]) / gear.z
    out = (0.18 * limit.f_p) ** 2 * np.eye(gear.z)
    for order, part in ((1, 0.13), (2, 0.05), (3, 0.03)):
        out += (part * limit.F_p) ** 2 * np.cos(order * apart)
    return np.asarray(out)


def slope_covariance(gear: IdealGear, grade: int) -> FloatArray:
    """Covariance (um^2) of the profile slopes that `draw` draws from: one for all teeth and one for each."""
    limit = limits(gear, grade)
    return np.asarray((0.25 * limit.f_H) ** 2 + (0.10 * limit.f_H) ** 2 * np.eye(gear.z))


def form_deviation(gear: IdealGear, grade: int) -> float:
    """Standard deviation (um) of the crowning that all teeth of a graded gear have, as of its mean slope."""
    return 0.25 * limits(gear, grade).f_f


def draw(gear: IdealGear, grade: int, E_s: float, rng: np.random.Generator, form: float = 0.0) -> ToothDeviations:
    """A gear as built within its grade; E_s in um, the same for all teeth, form in um the standard deviation of a
    crowning of all. Drawn again until no limit is broken."""
    limit = limits(gear, grade)
    index = np.linalg.cholesky(index_covariance(gear, grade) + 1e-9 * np.eye(gear.z))
    slopes = np.linalg.cholesky(slope_covariance(gear, grade))
    for _ in range(1000):
        p = index @ rng.standard_normal(gear.z)
        p -= p.mean()
        slope = slopes @ rng.standard_normal(gear.z)
        arc = p / cos(gear.alpha)
        single = np.abs(np.diff(np.append(arc, arc[0]))).max()
        crowning = form * rng.standard_normal() if form > 0.0 else 0.0
        if single <= limit.f_p and np.ptp(arc) <= limit.F_p and np.abs(slope).max() <= limit.f_H:
            crown = np.full(gear.z, np.clip(crowning, -limit.f_f, limit.f_f))
            return ToothDeviations(p=p, slope=slope, crowning=crown, E_s=np.full(gear.z, E_s), own=np.ones(gear.z))
    raise RuntimeError(f"no gear with {gear.z} teeth fits grade {grade} in 1000 draws")


@dataclass(frozen=True, kw_only=True)
class GearAsStated:
    """What the engineer states of one gear.

    inspected: whether an inspection is stated, with gauge standard uncertainty (um); grade; relief as (um, mm, power)
    and eccentricity as (um, deg) are stated where they are not None; E_s (um).
    """

    grade: int
    inspected: bool
    uncertainty: float = 0.2
    relief: tuple[float, float, float] | None = None
    eccentricity: tuple[float, float] | None = None
    E_s: float = -60.0


def pair_file(
    pair: IdealPair, built: tuple[ToothDeviations, ToothDeviations], known: tuple[GearAsStated, GearAsStated], *,
    torque: float, speed: float, deflect: bool, rng: np.random.Generator, name: str = "proving ground",
) -> str:  # fmt: skip
    """The text of pair.toml: what an engineer would declare, inspections read by a gauge with noise."""
    lines = [f'name = "{name}"', "", "[pair]"]
    lines += [f"torque_nm = {torque:g}", f"speed_rpm = {speed:g}", "", "[model]"]
    lines += [f"tooth_deflection = {'true' if deflect else 'false'}", ""]
    for which, gear, teeth, said in zip(("driving", "driven"), (pair.driving, pair.driven), built, known, strict=True):
        lines += [
            f"[{which}]",
            f"teeth = {gear.z}",
            f"module_mm = {gear.m:g}",
            f"pressure_angle_deg = {gear.alpha_deg:g}",
        ]
        lines += [
            f"profile_shift = {gear.x:g}",
            f"face_width_mm = {gear.b:g}",
            f"bore_mm = {gear.bore:g}",
            f"root_radius = {gear.rho_f:g}",
        ]
        lines += [f"grade = {said.grade}", ""]
        if said.inspected:
            reads = [v + rng.normal(0, said.uncertainty, gear.z) for v in (teeth.p, teeth.slope)]
            lines.append(f"[{which}.inspection]")
            for key, values in zip(("pitch_um", "profile_slope_um"), reads, strict=True):
                lines.append(f"{key} = [{', '.join(f'{v:.2f}' for v in values)}]")
            lines += [f"tooth_thickness_um = {said.E_s:g}", f"uncertainty_um = {said.uncertainty:g}", ""]
        else:
            lines += [f"[{which}.limits]", f"E_sns_um = {said.E_s + 10:g}", f"E_sni_um = {said.E_s - 10:g}", ""]
        if said.relief is not None:
            amount, length, power = said.relief
            shape = "linear" if power == 1 else "parabolic"
            lines += [
                f"[{which}.tip_relief]",
                f"amount_um = {amount:g}",
                f"length_mm = {length:g}",
                f'shape = "{shape}"',
                "",
            ]
        if said.eccentricity is not None:
            amplitude, angle = said.eccentricity
            lines += [f"[{which}.eccentricity]", f"amplitude_um = {amplitude:.2f}", f"angle_deg = {angle:.2f}", ""]
    return "\n".join(lines)
