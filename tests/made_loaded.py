"""Pairs under torque, and what a loaded mesh is asked, for the tests of load sharing."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from gearpoly.gear.deviations import Deviations, pitch_and_thickness
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.mesh.deflection import Elasticity, PairCompliance, ToothTable, pair_compliance
from gearpoly.mesh.loaded import LoadedContacts, Sharing, load_reach, loaded
from gearpoly.mesh.pair import Flank, GearPair, active_start, mount
from gearpoly.mesh.transmission import NEAR_PAIR_MM, FlankContacts, contacts
from gearpoly.units import NM, UM, FloatArray, read_only
from tests.oracles.load_sharing import Spring

LINEAR = Elasticity(contact="linear")
PALMGREN = Elasticity()

# Of the torque. The forces settle to 1e-12 of it; a lever of a corner contact may be a tenth of r_b, and both root
# searches round at 1e-14.
BALANCE = 1e-9


def make(
    z: tuple[int, int] = (18, 25),
    *,
    b: float = 20.0,
    deviations: tuple[Deviations | None, Deviations | None] = (None, None),
    points: int = 600,
    a: float | None = None,
    eccentricity: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 0.0), (0.0, 0.0)),
) -> GearPair:
    gears = [Gear(z=z[k], m=2.0, b=b) for k in range(2)]
    flanks = [
        draw_flanks(gears[k], deviations[k], l_start=active_start(gears[k], gears[1 - k], l_form=0.0), points=points)
        for k in range(2)
    ]
    return mount(flanks[0], flanks[1], a=a, eccentricity_1=eccentricity[0], eccentricity_2=eccentricity[1])


@cache
def perfect(b: float = 20.0) -> GearPair:
    return make(b=b)


@cache
def wrong() -> GearPair:
    """Pitch and thickness as rough gears have them, both gears off their axes."""
    rng = np.random.default_rng(7)
    deviations = [
        pitch_and_thickness(
            Gear(z=z, m=2.0),
            index=read_only(rng.uniform(-6.0, 6.0, z) * UM),
            E_s=read_only(rng.uniform(-90.0, -50.0, z) * UM),
        )
        for z in (18, 25)
    ]
    return make(deviations=(deviations[0], deviations[1]), a=43.02, eccentricity=((15.0 * UM, 0.7), (10.0 * UM, 2.0)))


def one_pitch(pair: GearPair, count: int = 160) -> FloatArray:
    # A start off every mark, so that no position falls on the end of a path.
    return (0.0037 + np.arange(count) / count) * pair.driven.gear.tau


_FOUND: dict[tuple[int, Flank, int], tuple[GearPair, FlankContacts]] = {}


def near_contacts(pair: GearPair, flank: Flank = "drive", meshes: int = 1, count: int = 160) -> FlankContacts:
    """Contacts that suffice for the greatest torque used here, found once for each pair."""
    key = (id(pair), flank, meshes)
    if key not in _FOUND:
        # The pair is kept too, so that no other takes its id.
        _FOUND[key] = (pair, _near_contacts(pair, flank, meshes, count))
    return _FOUND[key][1]


def _near_contacts(pair: GearPair, flank: Flank, meshes: int, count: int) -> FlankContacts:
    reach = max(
        load_reach(pair_compliance(pair, Elasticity(contact=law), flank=flank), 250.0 * NM)
        for law in ("palmgren", "weber_banaschek")
    )
    theta_2 = one_pitch(pair, count) if meshes == 1 else np.arange(count) * (meshes * pair.driven.gear.tau / count)
    return contacts(pair, theta_2, flank=flank, near=NEAR_PAIR_MM + reach)


def under(
    pair: GearPair,
    torque_nm: float,
    elasticity: Elasticity = PALMGREN,
    *,
    flank: Flank = "drive",
    sharing: Sharing = "equilibrium",
    meshes: int = 1,
) -> LoadedContacts:
    compliance = pair_compliance(pair, elasticity, flank=flank)
    return loaded(near_contacts(pair, flank, meshes), compliance, torque=torque_nm * NM, sharing=sharing)


def levers(pair: GearPair, found: FlankContacts) -> tuple[FloatArray, FloatArray]:
    """Distances of each line of action from both axes, mm."""
    (x, y), (nx, ny) = found.point.T, found.normal.T
    return np.abs(x * ny - y * nx), np.abs((x - pair.a) * ny - y * nx)


def per_position(result: LoadedContacts, rows: FloatArray) -> FloatArray:
    return np.bincount(result.contacts.position, weights=rows, minlength=result.te.size)


def same_set(*results: LoadedContacts) -> FloatArray:
    """Positions at which the same pairs carry in all ``results``."""
    first = results[0].force > 0.0
    differ = np.zeros(results[0].te.size)
    for result in results[1:]:
        differ += per_position(result, ((result.force > 0.0) != first).astype(float))
    return differ == 0.0


def tables(pair: GearPair, rng: np.random.Generator) -> list[ToothTable]:
    """Tooth compliances of no gear, from 1e-6 to 1e-5 mm/N, rising and falling anyhow."""
    return [
        ToothTable(
            r=read_only(np.linspace(gear.r_b, gear.r_a, 9)), c=read_only(10.0 ** rng.uniform(-6.0, -5.0, (gear.z, 9)))
        )
        for gear in (pair.driving.gear, pair.driven.gear)
    ]


def random_contacts(pair: GearPair, rng: np.random.Generator, *, positions: int, spread: float) -> FlankContacts:
    """Contacts of no gears: up to 5 near pairs whose gaps (mm, up to ``spread``), places and normals are random."""
    count = rng.integers(1, 6, positions)
    position = np.repeat(np.arange(positions), count)
    gap = np.concatenate([np.concatenate(([0.0], np.sort(rng.uniform(0.0, spread, n - 1)))) for n in count])
    angle = np.deg2rad(rng.uniform(60.0, 80.0, position.size))
    return FlankContacts(
        flank="drive",
        theta_2=np.arange(positions) * 0.01,
        te=np.zeros(positions),
        position=position,
        driving=rng.integers(0, 18, position.size),
        driven=rng.integers(0, 25, position.size),
        gap=gap,
        point=np.column_stack((18.0 + rng.uniform(-1.5, 1.5, gap.size), rng.uniform(-4.0, 4.0, gap.size))),
        normal=np.column_stack((np.cos(angle), np.sin(angle))),
        feature=np.zeros(gap.size, dtype=np.int64),
        overrun=np.zeros(gap.size),
        touching=gap == 0.0,
        pairs=np.bincount(position[gap == 0.0], minlength=positions),
        certified=0,
        repaired=0,
    )


def springs(compliance: PairCompliance, found: FlankContacts) -> Iterator[list[Spring]]:
    """The oracle's problem at each position, read from the tables without the code's own reading of them."""
    pair, E, nu, b = compliance.pair, compliance.elasticity.E, compliance.elasticity.nu, compliance.b
    A, p = {
        "palmgren": (1.275 / (E**0.9 * b**0.8), 0.9),
        "linear": (4.0 * (1.0 - nu**2) / (np.pi * E * b), 1.0),
    }[compliance.elasticity.contact]
    lever_1, lever_2 = levers(pair, found)
    for n in range(found.theta_2.size):
        out = []
        for i in np.flatnonzero(found.position == n):
            c = 0.0
            for table, tooth, x in (
                (compliance.driving, found.driving[i], found.point[i, 0]),
                (compliance.driven, found.driven[i], found.point[i, 0] - pair.a),
            ):
                c += float(np.interp(np.hypot(x, found.point[i, 1]), table.r, table.c[tooth]))
            out.append(Spring(found.gap[i] / pair.r_b1, lever_1[i], lever_2[i], c, A, p))
        yield out
