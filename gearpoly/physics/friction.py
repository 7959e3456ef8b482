"""Friction between the teeth."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from gearpoly.keys.edit import on_pair
from gearpoly.keys.kinds import Section, field
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import RUN, Physics, Quantity, Scope
from gearpoly.physics.bounds import always
from gearpoly.physics.parts import Parts
from gearpoly.physics.place import Place, Values
from gearpoly.physics.words import plain


class PairKeys(Section):
    """What a pair says of it."""

    friction_coefficient: float = field("coefficient of friction between the teeth, 0 to 1", 0.0, ge=0.0, le=1.0)


def _build(file: PairFile, parts: Parts) -> Parts:
    more = parts.elasticity.friction + file.pair.friction_coefficient
    return replace(parts, elasticity=replace(parts.elasticity, friction=more))


def _places(scope: Scope) -> Iterable[Place]:
    if scope.loaded:
        yield Place(probe=(0.05,))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    return on_pair(file, friction_coefficient=min(1.0, max(0.0, file.pair.friction_coefficient + values[0])))


LAW_DOUBT = 0.08
"""Half the range, in parts, of the coefficients that the laws give for one set of recordings."""

PHYSICS = Physics(
    name="friction",
    rank=RUN + 1,
    source="Coulomb's law at the contact, derived here",
    stands="pair.friction_coefficient",
    parameters=("coefficient",),
    case=(Place(), (0.08,)),
    keys={"pair": PairKeys},
    build=_build,
    coordinates=(
        Quantity(
            name="coefficient",
            unit="1",
            low=0.0,
            most=always(1.0),
            why="metals and plastics rub with less than 1",
            step=0.02,
        ),
    ),
    amplitudes=1,
    ordinary=(0.05,),
    places=_places,
    mean_tooth=True,
    law_doubt=LAW_DOUBT,
    write=_write,
    report=plain("coefficient"),
    says=lambda place, v: f"The teeth rub on each other with a coefficient of friction of {v[0]:.3f}.",
    equation="N = F/(1 -+ mu rho_2/r_b2): more normal force in approach, less in recess",
)
