"""Two drawn gears on their axes: where each tooth stands, and the bodies that the contact kernel turns.

The global frame has the driving axis at the origin and the driven axis at (a, 0). The driving gear turns
counter-clockwise by theta_1, the driven gear clockwise by theta_2; both grow as the pair runs forward. Seen so, the
drive flank is the counter-clockwise side of the tooth on both gears, and the same kernel serves both flanks: for the
coast flank the picture is mirrored in the line of centres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from gearpoly.errors import GeometryError
from gearpoly.gear.flank import Flanks
from gearpoly.gear.gear import Gear, inv, inv_inverse
from gearpoly.gear.modules import module_at
from gearpoly.gear.polygon import rotate
from gearpoly.mesh.bodies import Body
from gearpoly.mesh.contact import mirrored
from gearpoly.units import FloatArray, read_only

Flank = Literal["drive", "coast"]

HUB = 0.85
"""Half teeth are closed at this share of the root radius. Any value below 1 does; it only has to lie inside the
gear's body."""

OVER = 8
"""Chords from the tip corner to the middle of a tip. One alone stands 2 to 20 um off the tip circle (18 teeth of module
2, whole or broken). A corner of the mate that grazes the tip by less would pass behind it, seen by no certificate;
eight leave a sixty-fourth of that."""


def working_pressure_angle(gear_1: Gear, gear_2: Gear) -> float:
    """Pressure angle in rad at the tight-mesh centre distance, inv(alpha_w) = inv(alpha) + 2 tan(alpha) (x_1 +
    x_2)/(z_1 + z_2).

    ISO 21771:2007, 5.4.3. Raises ``GeometryError`` where the sum of profile shifts is so negative that no such angle
    exists.
    """
    alpha = gear_1.alpha
    value = inv(alpha) + 2.0 * math.tan(alpha) * (gear_1.x + gear_2.x) / (gear_1.z + gear_2.z)
    if value <= 0.0:
        raise GeometryError(
            f"profile_shift {gear_1.x:g} and {gear_2.x:g}: their sum is so negative that the gears cannot mesh "
            "without backlash"
        )
    return inv_inverse(value)


def tight_centre_distance(gear_1: Gear, gear_2: Gear) -> float:
    """Centre distance a_w in mm at which the deviation-free gears mesh without backlash (ISO 21771:2007, 5.4.3)."""
    return (gear_1.r_b + gear_2.r_b) / math.cos(working_pressure_angle(gear_1, gear_2))


def active_start(gear: Gear, mate: Gear, *, l_form: float) -> float:
    """Roll length in mm where the mate's tip reaches at the tight centre distance, but not below the true form circle
    ``l_form``."""
    alpha_w = working_pressure_angle(gear, mate)
    path = (gear.r_b + mate.r_b) * math.tan(alpha_w)
    return max(l_form, path - mate.l_a)


@dataclass(frozen=True, kw_only=True, eq=False)
class Mounted:
    """One drawn gear on its axis of rotation.

    ``flanks`` all its flanks; ``sign`` -1 for the driving gear, whose teeth follow one another clockwise, +1 for the
    driven; ``origin`` the direction in rad of the mate from this gear's axis; ``alpha_w`` working pressure angle of
    the deviation-free pair; ``eccentricity`` from the axis to the gear's centre: amplitude in mm and angle in rad
    from tooth 0's pitch point in the order of meshing.
    """

    flanks: Flanks
    sign: int
    origin: float
    alpha_w: float
    eccentricity: tuple[float, float] = (0.0, 0.0)

    @property
    def gear(self) -> Gear:
        """The deviation-free gear."""
        return self.flanks.gear

    @cached_property
    def centre_lines(self) -> FloatArray:
        """Directions (z,) in rad of all teeth at rotation 0, where tooth 0's nominal drive flank meets the working
        pitch point."""
        gear = self.gear
        half = gear.psi(gear.r_b / math.cos(self.alpha_w))
        return read_only(self.origin + self.sign * gear.tau * np.arange(gear.z) - half)

    @cached_property
    def centre(self) -> FloatArray:
        """The gear's own centre (2,) in mm from its axis of rotation, at rotation 0."""
        amplitude, angle = self.eccentricity
        direction = self.origin + self.sign * angle
        return read_only([amplitude * math.cos(direction), amplitude * math.sin(direction)])

    def body(self, flank: Flank) -> Body:
        """What this gear shows to its mate on ``flank``, for the contact kernel (mirrored for the coast flank)."""
        gear, flanks = self.gear, self.flanks
        side = 1.0 if flank == "drive" else -1.0
        hub, half = HUB * gear.r_f, 0.5 * gear.tau
        # A thinned tooth's middle is not its centre line; closed along that, the half tooth would stand out of the
        # thin one.
        tips = flanks.tips
        middle = 0.5 * (tips.drive - tips.coast)
        corner = tips.drive if flank == "drive" else -tips.coast
        over = corner[:, None] + (middle - corner)[:, None] * np.arange(1, OVER + 1) / OVER
        tip = np.stack((tips.r[:, None] * np.cos(over), tips.r[:, None] * np.sin(over)), axis=-1)
        foot = np.array([[hub, 0.0], [hub * math.cos(half), side * hub * math.sin(half)]])
        back = np.concatenate((tip, np.broadcast_to(foot, (gear.z, 2, 2))), axis=1)
        body = Body(
            faces=rotate(flanks.drive if flank == "drive" else flanks.coast, self.centre_lines) + self.centre,
            backs=rotate(back, self.centre_lines) + self.centre,
            working=flanks.root.n - 1,
        )
        return body if flank == "drive" else mirrored(body)


@dataclass(frozen=True, kw_only=True, eq=False)
class GearPair:
    """A driving and a driven gear at centre distance ``a`` (mm).

    Raises ``GeometryError`` where the gears cannot reach each other or a tip would cut into the mate's root.
    """

    driving: Mounted
    driven: Mounted
    a: float

    def __post_init__(self) -> None:
        gear_1, gear_2 = self.driving.gear, self.driven.gear
        reach = gear_1.r_a + gear_2.r_a
        # Both eccentricities at their worst must still leave the tips overlapping.
        if self.a + self.driving.eccentricity[0] + self.driven.eccentricity[0] >= reach:
            raise GeometryError(
                f"centre_distance_mm = {self.a:g}: the gears cannot reach each other; their tip circles end at "
                f"{reach:.3f} mm{self._other_module}"
            )
        for gear, mate, name in ((gear_1, gear_2, "driving"), (gear_2, gear_1, "driven")):
            room = self.a - self.driving.eccentricity[0] - self.driven.eccentricity[0] - gear.r_a - mate.r_f
            if room <= 0.0:
                raise GeometryError(
                    f"centre_distance_mm = {self.a:g}: the {name} gear's tip cuts {-room:.3f} mm into its mate's root; "
                    f"use a larger centre distance, more dedendum or a smaller addendum{self._other_module}"
                )

    @property
    def _other_module(self) -> str:
        """A word of the module whose gears stand so far apart, if that is not the stated one."""
        z = self.driving.gear.z, self.driven.gear.z
        m = module_at(self.a, z=z)
        if m is None or m == self.driving.gear.m:
            return ""
        return f"; {z[0]} and {z[1]} teeth stand so far apart with module_mm = {m:g}: check which is wrong"

    @property
    def ratio(self) -> float:
        """z_1/z_2, driven per driving turn."""
        return self.driving.gear.z / self.driven.gear.z

    @property
    def a_w(self) -> float:
        """Tight-mesh centre distance of the deviation-free gears, mm."""
        return tight_centre_distance(self.driving.gear, self.driven.gear)

    @property
    def alpha_w(self) -> float:
        """Working pressure angle in rad at the actual centre distance; 0 where the base circles overlap it."""
        return math.acos(min(1.0, (self.driving.gear.r_b + self.driven.gear.r_b) / self.a))

    @property
    def r_b1(self) -> float:
        """Driving base radius, mm."""
        return self.driving.gear.r_b

    @property
    def r_b2(self) -> float:
        """Driven base radius, mm."""
        return self.driven.gear.r_b

    @property
    def eps_alpha(self) -> float:
        """Theoretical transverse contact ratio at the actual centre distance (ISO 21771:2007, 5.5.1), form circles
        respected."""
        gear_1, gear_2 = self.driving.gear, self.driven.gear
        path = self.a * math.sin(self.alpha_w)
        entry = max(path - gear_2.l_a, self.driving.flanks.root.l_form)
        end = min(gear_1.l_a, path - self.driven.flanks.root.l_form)
        return max(0.0, end - entry) / gear_1.p_b

    @property
    def common_face_width(self) -> float:
        """The face width in mm that both gears share. Raises ``GeometryError`` where one has none."""
        widths = [mounted.gear.b for mounted in (self.driving, self.driven)]
        for name, width in zip(("driving", "driven"), widths, strict=True):
            if width is None:
                raise GeometryError(f"{name}.face_width_mm is missing; teeth that bend need a face width")
        return min(width for width in widths if width is not None)

    @property
    def meshes_per_cycle(self) -> int:
        """Tooth meshes until the same two teeth meet again, the hunting cycle, lcm(z_1, z_2)."""
        return math.lcm(self.driving.gear.z, self.driven.gear.z)

    @property
    def cycle(self) -> float:
        """The hunting cycle as driven rotation in rad."""
        return self.meshes_per_cycle * self.driven.gear.tau

    @property
    def chord_noise(self) -> float:
        """The most by which chords let the driven gear lag along the line of action, mm: both sagittas."""
        return self.driving.flanks.chord_error + self.driven.flanks.chord_error


def mount(
    flanks_1: Flanks,
    flanks_2: Flanks,
    *,
    a: float | None = None,
    eccentricity_1: tuple[float, float] = (0.0, 0.0),
    eccentricity_2: tuple[float, float] = (0.0, 0.0),
) -> GearPair:
    """Put two drawn gears on their axes at centre distance ``a`` in mm (default: tight mesh); eccentricities as in
    ``Mounted``.

    Raises ``GeometryError`` where they cannot mesh.
    """
    gear_1, gear_2 = flanks_1.gear, flanks_2.gear
    if gear_1.m != gear_2.m or gear_1.alpha != gear_2.alpha:
        raise GeometryError(f"module {gear_1.m:g} and {gear_2.m:g} mm or pressure angles differ; only equal ones mesh")
    alpha_w = working_pressure_angle(gear_1, gear_2)
    return GearPair(
        driving=Mounted(flanks=flanks_1, sign=-1, origin=0.0, alpha_w=alpha_w, eccentricity=eccentricity_1),
        driven=Mounted(flanks=flanks_2, sign=1, origin=math.pi, alpha_w=alpha_w, eccentricity=eccentricity_2),
        a=tight_centre_distance(gear_1, gear_2) if a is None else a,
    )
