"""What the bench spares itself in the contact of a recording changes no bit of the transmission error.

`mesh` looks at every pair in every trial and begins at nothing; `meshing` leaves out pairs that stay open and positions
that a changed tooth does not reach. Equality is exact: truths and recordings hang on the last digit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearpoly.proving import contacts
from gearpoly.proving.contacts import FlankRows
from gearpoly.proving.drawn import BENCH_PAIRS, draw, make_pair
from gearpoly.proving.effects import apply, instance
from gearpoly.proving.memo import Memo, digest
from gearpoly.proving.physics import PHYSICS_BY_NAME
from gearpoly.proving.rig import BenchError, Rig, mesh, meshing
from gearpoly.proving.scenes import campaign, design_torque

N = 400
"""Positions, in 30 turns of the driven gear: each tooth of 25 is met about 40 times."""
LARGE = 3.0
"""Size of an example times this, held beneath what a rig can have: deviations beyond those of graded gears."""


def rig(name: str, *, deflect: bool, grade: int = 8, law: str = "palmgren") -> Rig:
    """Gears of a poor grade on axes that are not theirs, so that which pair carries changes often."""
    pair, rng = make_pair(name), np.random.default_rng(11)
    one, two = (draw(pair.gear(index), grade, -150.0, rng, form=1.0) for index in (1, 2))
    return Rig(pair=pair, teeth_1=one, teeth_2=two, eccentric_1=(20.0, 70.0), deflect=deflect, law=law)


def angles() -> np.ndarray:
    """Half of the positions anywhere, half in a row."""
    rng = np.random.default_rng(5)
    return np.concatenate([rng.uniform(0.0, 188.0, N // 2), np.linspace(0.0, 188.0, N // 2)])


def alike(one: Rig, torque: float, flank: str = "drive") -> None:
    """The two ways have the same bits, or both find no contact."""
    try:
        whole = mesh(one, angles(), torque=torque, flank=flank, span=(0.0, 188.0)).x
    except BenchError:
        with pytest.raises(BenchError):
            meshing(one, angles(), torque=torque, flank=flank, span=(0.0, 188.0))
        return
    np.testing.assert_array_equal(meshing(one, angles(), torque=torque, flank=flank, span=(0.0, 188.0)), whole)


@pytest.mark.parametrize("physics", PHYSICS_BY_NAME)
@pytest.mark.parametrize("part", [0.0, 1.0])
def test_every_physics_has_the_same_bits_as_without_what_is_spared(physics: str, part: float) -> None:
    plain = rig("18/25 m2", deflect=part > 0.0 and physics != "tooth_deflection")
    pair, rng = plain.pair, np.random.default_rng(3)
    effect = instance(physics, pair, campaign("all", pair, rng, cycles=1.0), rng)
    torque = part * design_torque(pair)
    alike(plain, torque)
    for size in (abs(effect.size), min(LARGE * abs(effect.size), PHYSICS_BY_NAME[physics].cap)):
        alike(apply(plain, effect.scaled(size)), torque)


@pytest.mark.parametrize("name", BENCH_PAIRS)
@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_every_pair_has(name: str, flank: str) -> None:
    plain = rig(name, deflect=True, law="weber")
    for part in (0.0, 0.02, 1.0):
        alike(plain, part * design_torque(plain.pair), flank)


def test_a_few_teeth_that_differ_begin_at_what_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = rig("18/25 m2", deflect=True, grade=5)
    begun = []
    solve = contacts._solve

    def watched(at, of, known, *rest, **further):  # type: ignore[no-untyped-def]
        begun.append(known.x.size)
        return solve(at, of, known, *rest, **further)

    monkeypatch.setattr(contacts, "_solve", watched)
    theta_2 = angles() + 0.125  # of no other test
    first = meshing(plain, theta_2, torque=40.0)
    low = replace(plain, teeth_1=plain.teeth_1.index_plus(7, 6.0))
    moved = meshing(low, theta_2, torque=40.0)
    soft = replace(plain, teeth_2=plain.teeth_2.softer(3, 1.4))
    cracked = meshing(soft, theta_2, torque=40.0)
    assert begun == [0, N, N]
    np.testing.assert_array_equal(moved, mesh(low, theta_2, torque=40.0).x)
    np.testing.assert_array_equal(cracked, mesh(soft, theta_2, torque=40.0).x)
    assert 0.05 < np.mean(moved != first) < 0.6  # a tooth of 18 is in reach in 2.4 of 18 meshes, and some after
    assert 0.02 < np.mean(cracked != first) < 0.6
    begun.clear()
    meshing(low, theta_2, torque=40.0)
    assert begun == []  # asked for again, nothing is solved


def test_which_teeth_have_moved_is_told_by_flank_and_by_compliance() -> None:
    rows, own = np.zeros((5, 21)), np.ones(5)
    one = FlankRows(rows_1=rows, rows_2=rows, own_1=own, own_2=own)
    bent, other = own.copy(), rows.copy()
    bent[2], other[4, 3] = 1.1, 1e-9
    two = FlankRows(rows_1=rows, rows_2=other, own_1=bent, own_2=own)
    assert [np.flatnonzero(m).tolist() for m in two.moved(one, loaded=True)] == [[2], [4]]
    assert [np.flatnonzero(m).tolist() for m in two.moved(one, loaded=False)] == [[], [4]]
    assert two.key(True) != one.key(True)
    assert replace(two, rows_2=rows).key(False) == one.key(False)


def test_memory_is_bounded_and_the_latest_stay() -> None:
    memo: Memo[str] = Memo(30)
    for name in "abcd":
        memo.put(name, name.upper(), 10)
        memo.get("a")
    assert [memo.get(name) for name in "abcd"] == ["A", None, "C", "D"]
    memo.put("a", "again", 20)
    assert memo.get("a") == "again"
    assert memo.held == 30


def test_a_key_tells_every_bit_and_every_shape() -> None:
    a = np.arange(6.0)
    assert digest(a, 1.0) == digest(a.copy(), 1.0)
    assert digest(a) != digest(np.nextafter(a, 9.0))
    assert digest(a) != digest(a.reshape(2, 3))
    assert digest(a[:3], a[3:]) != digest(a[:4], a[4:])
    assert digest(0.0) != digest(-0.0)
