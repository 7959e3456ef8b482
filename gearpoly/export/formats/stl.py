"""STL: triangles in single precision, the least that every printer reads. It knows no units; these are mm."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from gearpoly import __version__
from gearpoly.export.drawing import Drawing, rounded_up
from gearpoly.units import UM

ENDINGS = (".stl",)
CURVES = ("lines",)

STL_HEADER_BYTES = 80
"""Bytes at the start of a binary STL that are anyone's to fill."""


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """``drawing`` as binary STL, both gears in one file; K and chord error stand in its header of 80 bytes.

    The stated chord error includes rounding to single precision.
    """
    import trimesh

    from gearpoly.export.solid import solids

    error = drawing.chord_error + rounding(drawing)
    header = (
        f"gearpoly {__version__} unit=mm magnify={drawing.request.magnify:g} chord_error_um={rounded_up(error / UM):g}"
    )
    triangles = trimesh.exchange.stl.export_stl(trimesh.util.concatenate(solids(drawing, single=True)))
    # A binary STL must not begin with "solid", and this does not.
    target.write_bytes(
        header.encode("ascii")[:STL_HEADER_BYTES].ljust(STL_HEADER_BYTES, b" ") + triangles[STL_HEADER_BYTES:]
    )
    return error


def rounding(drawing: Drawing) -> float:
    """The most in mm by which single precision moves a vertex: half a unit in the last place, along both axes."""
    largest = max(float(np.max(np.abs(gear.ring))) for gear in drawing.gears)
    return float(np.spacing(np.float32(largest))) / math.sqrt(2.0)
