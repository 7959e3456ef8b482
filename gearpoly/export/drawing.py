"""What leaves gearpoly: one or both gears of a pair, placed, at a stated detail and magnification.

A format's writer gets a ``Drawing`` and writes it; nothing in a format decides geometry.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
from shapely import is_valid_reason
from shapely.geometry import Polygon

from gearpoly import __version__, arguments
from gearpoly.arguments import GEARS
from gearpoly.assemble import Assembled
from gearpoly.errors import (
    GearpolyError,
    GeometryError,
    InputFileError,
    JammedError,
    NotConvergedError,
    OutOfRangeError,
    shown,
)
from gearpoly.export.magnify import LARGEST_MAGNIFICATION, magnified, onset
from gearpoly.export.outline import Detail, Outline, OutlinePart, draw_outline
from gearpoly.gear.deviations import Deviations
from gearpoly.gear.flank import Flanks
from gearpoly.gear.polygon import rotate
from gearpoly.gear.tolerances import Limits
from gearpoly.mesh.pair import Flank, GearPair, Mounted, mount
from gearpoly.mesh.transmission import FlankContacts, both_flanks
from gearpoly.units import DEG, UM, FloatArray, read_only

Which = Literal["driving", "driven", "both"]

ONSET_DETAIL = Detail(points=64)
"""Detail at which the onset of crossing teeth is searched: it is wanted to a few parts in a thousand."""

CLEAR_SPACE = 2.0
"""Clear space between the tip circles of gears drawn apart, in modules."""


@dataclass(frozen=True, kw_only=True)
class Request:
    """What a user asked for: ``which`` gears, the driven rotation ``at`` in rad at which ``flank`` touches, or gears
    ``apart`` at rotation 0; ``magnify`` as in ``magnified``; ``detail``.

    Raises ``OutOfRangeError`` for a gear or flank that is none, for a magnification outside 0 to
    ``LARGEST_MAGNIFICATION`` and for an angle that is no number."""

    which: Which = "both"
    at: float = 0.0
    flank: Flank = "drive"
    apart: bool = False
    magnify: float = 1.0
    detail: Detail = field(default_factory=Detail)

    def __post_init__(self) -> None:
        arguments.check_choice("--gear", self.which, (*arguments.GEARS, "both"))
        arguments.check_choice("--flank", self.flank, arguments.FLANKS)
        if not 0.0 <= self.magnify <= LARGEST_MAGNIFICATION:
            raise OutOfRangeError(f"--magnify {self.magnify:g}: want 0 (the ideal gear) to {LARGEST_MAGNIFICATION:g}")
        if not math.isfinite(self.at):
            raise OutOfRangeError(f"--at {self.at:g}: want an angle in deg")
        if self.at and (self.apart or self.which != "both"):
            raise OutOfRangeError("--at turns two gears in mesh; leave it out with --apart or a single --gear")


@dataclass(frozen=True, kw_only=True, eq=False)
class Placed:
    """One gear where it is drawn: ``outline`` turned by ``angle`` (rad, counter-clockwise) about its axis at ``axis``
    (2,) in mm.

    ``name`` is "driving" or "driven"; ``deviations`` as drawn, magnified; ``limits`` that they were drawn within, if
    any.
    """

    name: str
    mounted: Mounted
    outline: Outline
    deviations: Deviations
    limits: Limits | None
    axis: FloatArray
    angle: float

    def at(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) in mm of the gear's own frame where they are drawn."""
        return rotate(np.atleast_2d(points), self.angle) + self.axis

    @cached_property
    def ring(self) -> FloatArray:
        """The outline (N, 2) in mm as drawn, counter-clockwise."""
        return read_only(self.at(self.outline.ring))

    @cached_property
    def bore(self) -> FloatArray:
        """The bore (k, 2) in mm as drawn, counter-clockwise."""
        return read_only(self.at(self.outline.bore))

    @property
    def centre(self) -> FloatArray:
        """The gear's own centre (2,) in mm as drawn; off the axis where it is eccentric."""
        return read_only(self.at(self.outline.centre)[0])

    @cached_property
    def polygon(self) -> Polygon:
        """The gear with its bore as a Shapely polygon in mm."""
        return Polygon(self.ring, [self.bore])

    def parts(self) -> list[OutlinePart]:
        """The outline's parts as drawn."""
        return [replace(part, points=read_only(self.at(part.points))) for part in self.outline.parts]

    def tooth_directions(self) -> FloatArray:
        """Directions (z,) in rad of the teeth's nominal centre lines as drawn, by tooth number."""
        return self.mounted.centre_lines + self.angle


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawing:
    """Gears ready to be written, with all that a file states about itself.

    ``contacts`` at the drawn position, None where gears stand apart or alone; ``theta_1`` the driving rotation in
    rad; ``seed`` as given.
    """

    title: str
    gears: tuple[Placed, ...]
    pair: GearPair
    origin: tuple[str, str]
    request: Request
    seed: int
    theta_1: float
    contacts: FlankContacts | None

    def __repr__(self) -> str:
        gears = " and ".join(gear.name for gear in self.gears)
        return f'<Drawing "{shown(self.title)}": {gears} gear, chord error {rounded_up(self.chord_error / UM):g} um>'

    @property
    def chord_error(self) -> float:
        """The most in mm that the drawn polygons stand off the true outlines, measured."""
        return max(gear.outline.chord_error for gear in self.gears)

    def statement(self, **more: object) -> dict[str, object]:
        """What the file says about itself, in the units of the edge; ``more`` is what a format knows better."""
        request, alone = self.request, len(self.gears) == 1
        out: dict[str, object] = {
            "gearpoly": __version__,
            "pair": self.title,
            "gears": " and ".join(gear.name for gear in self.gears),
            "unit": "mm",
            "magnify": request.magnify,
            "chord_error_um": rounded_up(self.chord_error / UM),
            "flank_chord_error_um": rounded_up(max(gear.outline.flank_error for gear in self.gears) / UM),
            "points_per_flank": max(g.outline.flanks.r.size - g.outline.flanks.root.n + 1 for g in self.gears),
        }
        if request.apart or alone:
            out["placement"] = "alone" if alone else "apart"
        else:
            out |= {
                "placement": f"in mesh, {request.flank} flanks touch",
                "driven_angle_deg": request.at / DEG,
                "driving_angle_deg": self.theta_1 / DEG,
                "centre_distance_mm": self.pair.a,
            }
        if "drawn" in self.origin:
            out["seed"] = self.seed
        return out | more

    def words(self, **more: object) -> str:
        """The statement in one line of ``key = value``, values as in TOML."""
        return "; ".join(
            f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in self.statement(**more).items()
        )


def rounded_up(value: float) -> float:
    """``value`` rounded up to three digits: a stated bound must not be below what was measured."""
    if value <= 0.0:
        return 0.0
    digits = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.ceil(value / digits - 1e-9) * digits:.6g}")


def rounded_down(value: float) -> float:
    """``value`` rounded down to three digits: less than that has been tried and holds."""
    digits = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / digits) * digits:.6g}")


def draw(assembled: Assembled, request: Request, *, title: str, source: str, seed: int = 0) -> Drawing:
    """The gears of ``assembled`` as ``request`` wants them.

    ``title`` names the pair, ``source`` the file that messages speak of. Raises ``InputFileError`` where teeth cross
    or gears jam, saying from which magnification on, ``OutOfRangeError`` where the detail cannot be reached.
    """
    outlines = tuple(_outline(assembled, k, request, source) for k in range(2))
    meet = request.which == "both" and not request.apart
    pair = _mounted(assembled, [outline.flanks for outline in outlines])
    found = _in_mesh(assembled, pair, request, source) if meet else None
    theta_1 = 0.0 if found is None else float((found.theta_2[0] - found.te[0]) / pair.ratio)
    apart = pair.driving.gear.r_a + pair.driven.gear.r_a + CLEAR_SPACE * pair.driving.gear.m
    apart += pair.driving.eccentricity[0] + pair.driven.eccentricity[0]
    place = {"driving": 0.0, "driven": pair.a if meet else apart if request.which == "both" else 0.0}
    turn = {"driving": theta_1, "driven": -request.at if meet else 0.0}
    gears = tuple(
        Placed(
            name=name,
            mounted=mounted,
            outline=outlines[k],
            deviations=magnified(assembled.deviations[k], request.magnify),
            limits=assembled.limits[k],
            axis=read_only([place[name], 0.0]),
            angle=turn[name],
        )
        for k, (name, mounted) in enumerate(zip(GEARS, (pair.driving, pair.driven), strict=True))
        if request.which in (name, "both")
    )
    return Drawing(
        title=title,
        gears=gears,
        pair=pair,
        origin=assembled.origin,
        request=request,
        seed=seed,
        theta_1=theta_1,
        contacts=found,
    )


def _outline(assembled: Assembled, k: int, request: Request, source: str) -> Outline:
    mounted = (assembled.pair.driving, assembled.pair.driven)[k]

    def attempt(K: float, detail: Detail = ONSET_DETAIL) -> Outline:
        outline = draw_outline(
            mounted.gear,
            magnified(assembled.deviations[k], K),
            l_start=mounted.flanks.span.l_start,
            centre_lines=mounted.centre_lines,
            centre=mounted.centre,
            detail=detail,
        )
        polygon = Polygon(outline.ring, [outline.bore])
        if not polygon.is_valid:
            raise GeometryError(f"the outline crosses itself or its bore ({is_valid_reason(polygon)})")
        return outline

    try:
        return attempt(request.magnify, request.detail)
    except (GeometryError, NotConvergedError) as error:
        raise _too_much(source, GEARS[k], "teeth cross", attempt, request.magnify, error) from None


def _in_mesh(assembled: Assembled, pair: GearPair, request: Request, source: str) -> FlankContacts:
    """Contacts of the drawn gears themselves, so that coarse polygons touch too and do not overlap."""

    def attempt(K: float, drawn: GearPair | None = None) -> FlankContacts:
        if drawn is None:
            coarse = Request(magnify=K, detail=ONSET_DETAIL)
            drawn = _mounted(assembled, [_outline(assembled, k, coarse, source).flanks for k in range(2)])
        both = both_flanks(drawn, np.array([request.at]))
        return both.drive if request.flank == "drive" else both.coast

    try:
        return attempt(request.magnify, pair)
    except (GeometryError, JammedError, NotConvergedError) as error:
        what = "gears jam or lose contact (--apart draws them all the same)"
        raise _too_much(source, "driving, driven, pair", what, attempt, request.magnify, error) from None


def _too_much(
    source: str, where: str, what: str, attempt: Callable[[float], object], K: float, error: GearpolyError
) -> InputFileError:
    """The error for gears that cannot be drawn, with the magnification from which on that is so."""
    most = onset(attempt, bad=K) if K > 1.0 else 0.0
    if most < 1.0:
        return InputFileError(source, where=where, wish=str(error))
    return InputFileError(
        source,
        where=where,
        found=f"with --magnify {K:g} the {what}: {error}",
        wish=f"they do so from {rounded_down(most):g} on; want less",
    )


def _mounted(assembled: Assembled, flanks: list[Flanks]) -> GearPair:
    pair = assembled.pair
    return mount(
        flanks[0],
        flanks[1],
        a=pair.a,
        eccentricity_1=pair.driving.eccentricity,
        eccentricity_2=pair.driven.eccentricity,
    )
