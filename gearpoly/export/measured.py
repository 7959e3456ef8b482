"""A drawn gear as an inspector would report it: pitch as one number per flank, profiles as traces from the design
profile."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.errors import OutOfRangeError
from gearpoly.export.drawing import Drawing, Placed
from gearpoly.gear.deviations import Index, Relief, Shape, total
from gearpoly.units import FloatArray, read_only

POINTS = 481
"""Points per trace unless asked otherwise: ISO 1328-1:2013 asks for 150 at least, and this resolves a relief's corner
to 0.05 um."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Measured:
    """Index deviations of both sides (z,) and profile traces (z, n) at ``roll_length`` (n,), all in mm, teeth in the
    order of meshing.

    Profiles are deviations from the design profile: a tip relief of the design is not in them, as pair files want it.
    """

    index_drive: FloatArray
    index_coast: FloatArray
    roll_length: FloatArray
    drive: FloatArray
    coast: FloatArray


def measure(gear: Placed, *, points: int = POINTS) -> Measured:
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

    def traces(shapes: tuple[Shape, ...]) -> FloatArray:
        kept = tuple(shape for shape in shapes if not isinstance(shape, Index | Relief))
        return read_only(total(kept, np.broadcast_to(l, (nominal.z, l.size)), z=nominal.z, span=span))

    made = gear.deviations
    return Measured(
        index_drive=index(made.drive),
        index_coast=index(made.coast),
        roll_length=read_only(l),
        drive=traces(made.drive),
        coast=traces(made.coast),
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
