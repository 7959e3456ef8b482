"""A lead error that opens a gap across the face width."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from gearpoly.keys.edit import on_pair
from gearpoly.keys.kinds import Section, UmSize, field
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import RUN, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_tooth
from gearpoly.physics.parts import Parts
from gearpoly.physics.place import Place, Values
from gearpoly.physics.words import plain
from gearpoly.units import UM

GAPS = (2.0, 6.0, 15.0, 40.0)
"""um at which the effect is looked at: it grows with the root of the gap while the gap is open, then in proportion."""


class PairKeys(Section):
    """What a pair says of it."""

    misalignment_um: UmSize = field("gap in um that a lead error opens across the face width, 0 or more", 0.0)


def _build(file: PairFile, parts: Parts) -> Parts:
    gap = parts.elasticity.misalignment + file.pair.misalignment_um * UM
    return replace(parts, elasticity=replace(parts.elasticity, misalignment=gap))


def _places(scope: Scope) -> Iterable[Place]:
    if scope.loaded:
        for gap in GAPS:
            yield Place(probe=(gap,))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    return on_pair(file, misalignment_um=max(0.0, file.pair.misalignment_um + values[0]))


PHYSICS = Physics(
    name="misalignment",
    rank=RUN + 2,
    source="a line load in proportion to the local approach, derived here",
    stands="pair.misalignment_um",
    parameters=("lead_um",),
    case=(Place(), (12.0,)),
    keys={"pair": PairKeys},
    build=_build,
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
    says=lambda place, v: f"The flanks are out of line by {v[0]:.1f} um across the face width.",
    equation="a pair gives sqrt(2 F g/K) below F = K g/2 and F/K + g/2 above",
)
