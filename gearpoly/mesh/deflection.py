"""How far the teeth of one pair give: each tooth's compliance over its flank, tabulated from its actual outline.

The law is chosen by name (``compliance``). A tooth of an error gear has its own table, so a thin or undercut tooth is
softer.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from gearpoly.mesh.compliance import (
    ContactPair,
    Flattening,
    Mate,
    find_flattening,
    find_law,
    tooth_compliance,
    tooth_section,
)
from gearpoly.mesh.pair import Flank, GearPair, Mounted
from gearpoly.units import FloatArray, IntArray, read_only

RADII = 64
"""Places per flank at which compliance is tabulated. Straight lines between so many follow every law to 1e-4 of itself,
a hundredth of what the laws differ by."""

LEAST_LOAD = 1e-9
"""Share of the whole force below which a contact's stiffness is taken at this load: Palmgren's law has none at load
0."""


@dataclass(frozen=True, kw_only=True)
class Elasticity:
    """What load does: Young's modulus ``E`` in MPa and Poisson's ratio ``nu`` of both gears, and the laws by name.

    ``scale`` multiplies the compliance of every pair, contact included. ``cracks`` (gear 0 or 1, tooth, factor) soften
    single teeth whose drive flank is loaded. ``friction`` is the coefficient between the teeth, ``misalignment`` the
    gap in mm that a lead error opens across the face width.
    """

    E: float = 206_000.0
    nu: float = 0.3
    law: str = "cantilever"
    contact: str = "palmgren"
    scale: float = 1.0
    cracks: tuple[tuple[int, int, float], ...] = ()
    friction: float = 0.0
    misalignment: float = 0.0

    def running(self, *, backward: bool) -> Elasticity:
        """The same in a pair that runs on, or ``backward``: flanks then slide the other way, and the coefficient of
        friction counts below zero."""
        return replace(self, friction=(-1.0 if backward else 1.0) * abs(self.friction))


@dataclass(frozen=True, kw_only=True, eq=False)
class ToothTable:
    """Compliance ``c`` (z, k) in mm/N along the line of action of all teeth at radii ``r`` (k,) in mm, evenly
    spaced."""

    r: FloatArray
    c: FloatArray

    def at(self, tooth: IntArray, r: FloatArray) -> FloatArray:
        """Compliance (rows,) in mm/N of ``tooth`` (rows,) loaded at radius ``r`` (rows,) in mm; level beyond the
        table's ends."""
        place = np.clip((r - self.r[0]) / (self.r[1] - self.r[0]), 0.0, self.r.size - 1.0)
        low = np.minimum(place.astype(np.int64), self.r.size - 2)
        share = place - low
        c: FloatArray = (1.0 - share) * self.c[tooth, low] + share * self.c[tooth, low + 1]
        return c


@dataclass(frozen=True, kw_only=True, eq=False)
class PairCompliance:
    """Compliance of every tooth of a pair on one flank and the law of its contacts, over the common face width ``b``
    in mm."""

    pair: GearPair
    elasticity: Elasticity
    b: float
    driving: ToothTable
    driven: ToothTable

    def teeth(self, driving: IntArray, driven: IntArray, point: FloatArray) -> FloatArray:
        """Compliance (rows,) in mm/N of both teeth of each contact at ``point`` (rows, 2) in mm, contact not
        included."""
        r_1, r_2 = self._radii(point)
        return self.driving.at(driving, r_1) + self.driven.at(driven, r_2)

    def softest(self) -> float:
        """The largest compliance in mm/N that any two teeth can have together."""
        return float(np.max(self.driving.c)) + float(np.max(self.driven.c))

    def contact(self, force: FloatArray, point: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Flattening in mm and its slope in mm/N under ``force`` (...) in N of contacts at ``point`` (..., 2) in mm."""
        return self.flattening(point).under(force)

    def secant(self, force: FloatArray, teeth: FloatArray, point: FloatArray) -> FloatArray:
        """How far pairs give per unit of their ``force`` (...), mm/N; ``teeth`` (...) as ``teeth`` gives it.

        A gap g across the face width closes while the load grows: a pair of stiffness K carries sqrt(2 F g/K) below
        F = K g/2 and F/K + g/2 above (line load in proportion to the local approach; derived here).
        """
        flattening, _ = self.contact(force, point)
        c = teeth + flattening / force
        g = self.elasticity.misalignment
        if g == 0.0:
            return c
        return np.where(force * c < 0.5 * g, np.sqrt(2.0 * g * c / force), c + 0.5 * g / force)

    def tangent(self, force: FloatArray, teeth: FloatArray, point: FloatArray) -> FloatArray:
        """How far pairs give per unit of further force, mm/N; arguments as for ``secant``."""
        flattening, slope = self.contact(force, point)
        c, g = teeth + slope, self.elasticity.misalignment
        if g == 0.0:
            return c
        # The slope of sqrt(2 g v) is sqrt(g/(2 v)) that of v, what the pair would give with straight flanks.
        straight = np.maximum(force * teeth + flattening, 1e-300)
        return np.where(straight < 0.5 * g, c * np.sqrt(0.5 * g / straight), c)

    def flattening(self, point: FloatArray) -> Flattening:
        """How the flanks flatten at ``point`` (..., 2) in mm, whatever the load."""
        made, scale = self._unscaled(point), self.elasticity.scale
        return Flattening(level=scale * made.level, power=scale * made.power, logarithm=scale * made.logarithm)

    def _unscaled(self, point: FloatArray) -> Flattening:
        if find_law(self.elasticity.law).includes_contact:
            return Flattening(level=np.zeros(()))
        E, nu = self.elasticity.E, self.elasticity.nu
        if self.elasticity.contact != "weber_banaschek":
            flat = ContactPair(b=self.b, E_1=E, E_2=E, nu_1=nu, nu_2=nu)
            return find_flattening(flat, law=self.elasticity.contact)
        radii = self._radii(point)
        gears = self.pair.driving.gear, self.pair.driven.gear
        # A contact inside the base circle has no involute; the curvature of its first 5 per cent of roll stands in
        # for it.
        rho = [np.sqrt(np.maximum(r**2 - g.r_b**2, (0.05 * g.l_a) ** 2)) for g, r in zip(gears, radii, strict=True)]
        # Half the tooth's thickness there, which is where the load meets its centre line.
        depth = [
            r * np.interp(r, m.flanks.r, 0.5 * np.mean(m.flanks.psi_drive + m.flanks.psi_coast, axis=0))
            for m, r in zip((self.pair.driving, self.pair.driven), radii, strict=True)
        ]
        both = ContactPair(
            b=self.b, E_1=E, E_2=E, nu_1=nu, nu_2=nu, rho_1=rho[0], rho_2=rho[1], depth_1=depth[0], depth_2=depth[1]
        )
        return find_flattening(both, law="weber_banaschek")

    def _radii(self, point: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Distances of ``point`` from both axes. Eccentricity moves them by microns, compliance by 1e-5 of itself."""
        x, y = point[..., 0], point[..., 1]
        return np.hypot(x, y), np.hypot(x - self.pair.a, y)


def pair_compliance(pair: GearPair, elasticity: Elasticity, *, flank: Flank = "drive") -> PairCompliance:
    """Tabulate how far the teeth of ``pair`` give when ``flank`` carries.

    Raises ``GeometryError`` where a gear has no face width, ``OutOfRangeError`` for a material or law that is none.
    """
    b = pair.common_face_width
    tables = []
    for which, (mounted, other) in enumerate(((pair.driving, pair.driven), (pair.driven, pair.driving))):
        numbers = other.gear
        mate = Mate(teeth=numbers.z, profile_shift=numbers.x, dedendum=numbers.rack.h_fP)
        table = _tooth_table(mounted, mate, elasticity.law, elasticity.E, elasticity.nu, b, flank)
        factor = np.full(mounted.gear.z, elasticity.scale)
        for gear, tooth, more in elasticity.cracks:
            # A crack at the root of the drive flank opens under drive load and closes under coast load.
            if gear == which and flank == "drive":
                factor[tooth] *= more
        tables.append(ToothTable(r=table.r, c=read_only(table.c * factor[:, None])))
    return PairCompliance(pair=pair, elasticity=elasticity, b=b, driving=tables[0], driven=tables[1])


@lru_cache(maxsize=64)
def _tooth_table(mounted: Mounted, mate: Mate, law: str, E: float, nu: float, b: float, flank: Flank) -> ToothTable:
    """Compliance of sound teeth; what load and contact do to them is not in it, so a fit asks for the same again."""
    flanks, gear = mounted.flanks, mounted.gear
    of = slice(1 if flanks.alike else gear.z)
    section = tooth_section(
        radius=flanks.r,
        drive=flanks.psi_drive[of],
        coast=-flanks.psi_coast[of],
        base_radius=gear.r_b,
        reference_radius=gear.r,
        bore_radius=0.5 * (gear.r_f if gear.d_bore is None else gear.d_bore),
        teeth=gear.z,
        profile_shift=gear.x,
        mate=mate,
    )
    lowest = max(gear.r_b, float(np.hypot(gear.r_b, flanks.root.l_form)))
    r = np.linspace(lowest, gear.r_a, RADII)
    c = tooth_compliance(
        section,
        radius=r,
        face_width=b,
        youngs_modulus=E,
        poisson_ratio=nu,
        law=law,
        flank=flank,
    )
    return ToothTable(r=read_only(r), c=read_only(np.broadcast_to(c, (gear.z, r.size))))
