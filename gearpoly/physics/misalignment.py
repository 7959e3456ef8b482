"""A lead error that opens a gap across the face width."""

from __future__ import annotations

from collections.abc import Iterable

from gearpoly.files.models import PairFile
from gearpoly.physics.base import Physics, Place, Quantity, Scope, Values, on_pair, plain
from gearpoly.physics.bounds import half_tooth

GAPS = (2.0, 6.0, 15.0, 40.0)
"""um at which the effect is looked at: it grows with the root of the gap while the gap is open, then in proportion."""


def _places(scope: Scope) -> Iterable[Place]:
    if scope.loaded:
        for gap in GAPS:
            yield Place(probe=(gap,))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    return on_pair(file, misalignment_um=max(0.0, file.pair.misalignment_um + values[0]))


PHYSICS = Physics(
    name="misalignment",
    coordinates=(
        Quantity(
            name="lead_um",
            unit="um",
            low=0.0,
            most=half_tooth,
            why="a gap across the face wider than half a tooth is no contact",
            step=0.5,
        ),
    ),
    amplitudes=1,
    ordinary=(10.0,),
    places=_places,
    mean_tooth=True,
    law_doubt=0.05,
    write=_write,
    report=plain("lead_um"),
    reloads=True,
    says=lambda place, v: f"The flanks are out of line by {v[0]:.1f} um across the face width.",
    equation="a pair gives sqrt(2 F g/K) below F = K g/2 and F/K + g/2 above",
)
