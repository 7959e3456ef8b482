"""A drawn gear as an inspector would report it: pitch as one number per flank, profiles as traces from the design
profile."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.errors import OutOfRangeError
from gearpoly.export.drawing import Drawing, Placed
from gearpoly.gear.deviations import Index, Relief, Shape, total
from gearpoly.mesh.pair import Flank
from gearpoly.units import FloatArray, read_only

TRACE_POINTS = 481
"""Points per trace unless asked otherwise: ISO 1328-1:2013 asks for 150 at least, and this resolves a relief's corner
to 0.05 um."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Measured:
    """Index deviations of both sides (z,) and profile traces (z, n) at ``roll_length`` (n,), all in mm, teeth in the
    order of meshing. ``missing`` has the radial heights in mm of tips that have broken off, by their teeth.

    Profiles are deviations from the design profile: a tip relief of the design is not in them, as pair files want it.
    A probe finds nothing where a tip is missing: such a trace ends there, and is NaN beyond.
    """

    index_drive: FloatArray
    index_coast: FloatArray
    roll_length: FloatArray
    drive: FloatArray
    coast: FloatArray
    missing: Mapping[int, float]

    def trace(self, flank: Flank, tooth: int) -> tuple[list[float], list[float]]:
        """Roll lengths and deviations in mm of one flank, as far as it is there; none where that is but one point."""
        row = (self.drive if flank == "drive" else self.coast)[tooth]
        there = np.isfinite(row)
        if np.count_nonzero(there) < 2:
            return [], []
        return self.roll_length[there].tolist(), row[there].tolist()

    def remarks(self, *, first: int) -> list[str]:
        """What to say of teeth whose traces end early, as numbers from ``first`` on."""
        return [
            f"tooth {tooth + first} ends {height:g} mm below its tip circle, and its traces end there"
            for tooth, height in sorted(self.missing.items())
        ]


def measure(gear: Placed, *, points: int = TRACE_POINTS) -> Measured:
    """What ``gear`` deviates by, at ``points`` roll lengths evenly over the flanks that it has.

    A flank that stands in by d meets the tip circle where its involute is d longer, so that traces go on past the tip.
    """
    nominal, span = gear.mounted.gear, gear.outline.flanks.span
    ends = np.array([gear.outline.flanks.root.l_form, nominal.l_a])
    both = [
        total(shapes, ends[None], z=nominal.z, span=span) for shapes in (gear.deviations.drive, gear.deviations.coast)
    ]
    # 1 % more covers what the deviation changes by on the way.
    low = ends[0] - 1.01 * max(0.0, *(float(np.max(d[:, 0])) for d in both))
    high = ends[1] - 1.01 * min(0.0, *(float(np.min(d[:, 1])) for d in both))
    l = np.linspace(max(0.0, low), high, points)

    def index(shapes: tuple[Shape, ...]) -> FloatArray:
        at = total(tuple(s for s in shapes if isinstance(s, Index)), l[None, :1], z=nominal.z, span=span)
        return read_only(at[:, 0])

    missing = gear.deviations.missing_tips

    def traces(shapes: tuple[Shape, ...]) -> FloatArray:
        every = np.broadcast_to(l, (nominal.z, l.size))
        kept = tuple(shape for shape in shapes if not isinstance(shape, Index | Relief))
        found, off = (total(some, every, z=nominal.z, span=span) for some in (kept, shapes))
        for tooth, height in missing.items():
            # The corner is where the flank, with all that it stands off by, meets the circle that is left.
            corner = math.sqrt((nominal.r_a - height) ** 2 - nominal.r_b**2)
            found[tooth, l + off[tooth] > corner] = np.nan
        return read_only(found)

    made = gear.deviations
    return Measured(
        index_drive=index(made.drive),
        index_coast=index(made.coast),
        roll_length=read_only(l),
        drive=traces(made.drive),
        coast=traces(made.coast),
        missing=missing,
    )


def only_gear(drawing: Drawing, target: Path) -> Placed:
    """The one true gear of ``drawing``, for formats that hold one and have no room for a magnification.

    Raises ``OutOfRangeError`` where there are two, or where its deviations are magnified.
    """
    if len(drawing.gears) != 1:
        raise OutOfRangeError(f"{target.suffix} files hold one gear; say which with --gear driving or --gear driven")
    if drawing.request.magnify != 1.0:
        raise OutOfRangeError(
            f"--magnify {drawing.request.magnify:g}: an inspection file with deviations that no gear has would pass "
            "for a real one; leave --magnify out"
        )
    return drawing.gears[0]
