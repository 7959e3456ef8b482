"""Gears whose teeth are all alike: what one mesh does, every mesh does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearpoly.mesh.pair import GearPair
from gearpoly.mesh.transmission import FlankContacts
from gearpoly.units import FloatArray, IntArray


def alike(pair: GearPair) -> bool:
    """Whether every mesh of a ``pair`` is the same: all teeth of either gear have one outline and stand where they
    should, and neither axis is off."""
    return all(one.flanks.alike and one.eccentricity[0] == 0.0 for one in (pair.driving, pair.driven))


def repeated(one: FlankContacts, pair: GearPair, *, theta_2: FloatArray) -> FlankContacts:
    """The contacts of ``one`` mesh, at the first of driven rotations ``theta_2`` (N,) in rad, as they are at all of
    them: these lie alike in every pitch of a ``pair`` whose meshes are ``alike``. Every mesh takes the next tooth of
    either gear."""
    meshes = theta_2.size // one.theta_2.size
    later = np.repeat(np.arange(meshes), one.position.size)

    def next_teeth(teeth: IntArray, z: int) -> IntArray:
        return np.asarray((np.tile(teeth, meshes) + later) % z)

    return replace(
        one,
        theta_2=theta_2,
        te=np.tile(one.te, meshes),
        position=np.tile(one.position, meshes) + later * one.theta_2.size,
        driving=next_teeth(one.driving, pair.driving.gear.z),
        driven=next_teeth(one.driven, pair.driven.gear.z),
        gap=np.tile(one.gap, meshes),
        point=np.tile(one.point, (meshes, 1)),
        normal=np.tile(one.normal, (meshes, 1)),
        feature=np.tile(one.feature, meshes),
        overrun=np.tile(one.overrun, meshes),
        touching=np.tile(one.touching, meshes),
        pairs=np.tile(one.pairs, meshes),
    )
