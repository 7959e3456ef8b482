"""A condition as an object, and the pair as it meshes under it."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.deflection import pair_compliance
from gearpoly.mesh.loaded import load_reach, loaded
from gearpoly.mesh.pair import Flank
from gearpoly.mesh.transmission import NEAR_PAIR_MM, contacts
from gearpoly.units import NM
from tests.pair_files import made, one_pitch, pair_file

FLANKS: tuple[Flank, Flank] = ("drive", "coast")


def test_a_condition_is_frozen_and_known_by_its_values() -> None:
    one = Condition(flank="coast", torque=8.0 * NM, speed=3.0)
    with pytest.raises(FrozenInstanceError):
        one.torque = 1.0  # type: ignore[misc]
    assert one == replace(one) and hash(one) == hash(replace(one))
    assert one != replace(one, speed=None)
    assert one.coast and one.heaviest == one.torque
    assert replace(one, varies=0.25).heaviest == 1.25 * one.torque


@pytest.mark.parametrize("torque_nm", [-1.0, float("nan"), float("inf")])
@pytest.mark.parametrize("bends", [True, False])
def test_a_torque_that_is_none_is_refused(torque_nm: float, bends: bool) -> None:
    """With the words of the load itself, whether or not teeth bend."""
    assembled = made(pair_file(model={"tooth_deflection": bends}, points=100))
    with pytest.raises(OutOfRangeError) as refused:
        assembled.under(Condition(flank="drive", torque=torque_nm * NM))
    assert str(refused.value) == (
        f"torque {torque_nm:g} N.m: a torque is a finite magnitude, 0 or more; the flank says which way"
    )


@pytest.mark.parametrize("flank", FLANKS)
def test_the_mesh_under_a_condition_is_what_its_steps_give(flank: Flank) -> None:
    """Contacts, compliance and sharing taken one by one, to the last bit."""
    assembled = made(pair_file(points=300))
    theta_2 = one_pitch(assembled, 24)
    assert assembled.elasticity is not None
    by = pair_compliance(assembled.pair, assembled.elasticity, flank=flank)
    near = NEAR_PAIR_MM + load_reach(by, 20.0 * NM)
    steps = loaded(contacts(assembled.pair, theta_2, flank=flank, near=near, fast=True), by, torque=20.0 * NM)
    met = assembled.under(Condition(flank=flank, torque=20.0 * NM)).at(theta_2, fast=True)
    np.testing.assert_array_equal(met.te, steps.te)
    np.testing.assert_array_equal(met.pairs, steps.pairs)
    np.testing.assert_array_equal(met.contacts.te, steps.contacts.te)


@pytest.mark.parametrize("flank", FLANKS)
def test_without_torque_nothing_bends_and_nothing_twists(flank: Flank) -> None:
    assembled = made(pair_file(points=100, pair={"windup_urad_per_nm": 3.0}))
    mesh = assembled.under(Condition(flank=flank, torque=0.0))
    met = mesh.at(one_pitch(assembled, 8), fast=True)
    assert mesh.compliance is None and met.load is None
    assert mesh.twist == 0.0 and mesh.near == NEAR_PAIR_MM
    np.testing.assert_array_equal(met.te, met.contacts.te)


def test_conditions_that_teeth_do_not_tell_apart_share_their_compliance() -> None:
    """Recordings of several speeds and torques of one flank ask for it once."""
    assembled = made(pair_file(points=100))
    one = Condition(flank="drive", torque=5.0 * NM)
    first = assembled.under(one).compliance
    assert first is not None
    assert assembled.under(replace(one, torque=9.0 * NM, speed=3.0)).compliance is first
    assert assembled.under(replace(one, flank="coast")).compliance is not first


@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("varies", [0.0, 0.5])
def test_pairs_that_a_load_reaches_are_found_however_near_they_were_looked_for(flank: Flank, varies: float) -> None:
    """A tooth that is alone in mesh with a corner has less lever than any on the line of action, and gives more than
    the pair was thought to reach: the contacts are then found anew. Looked for within 0.1 um they end as within the
    whole reach, to the certified rotation (2.5e-13 rad) times what a load makes of it."""
    assembled = made(pair_file(points=300))
    theta_2 = one_pitch(assembled, 24)
    mesh = assembled.under(Condition(flank=flank, torque=20.0 * NM, varies=varies))
    wide, narrow = mesh.at(theta_2, fast=True), mesh.at(theta_2, near=1e-4, fast=True)
    assert narrow.load is not None and wide.load is not None
    assert narrow.contacts.near >= (1.0 + varies) * np.max(narrow.load.approach)
    np.testing.assert_allclose(narrow.te, wide.te, rtol=0.0, atol=1e-11)
    np.testing.assert_array_equal(narrow.pairs, wide.pairs)
