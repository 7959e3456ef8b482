"""Tooth numbers are known gear by gear: one zero that is stated tells its own gear's."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.arguments import GEARS
from gearpoly.compare.compare import compare, lay_beside
from gearpoly.compare.zeros import Alignment, Zeros
from gearpoly.diagnose.told import numbered
from gearpoly.files.models import PairFile
from gearpoly.keys.edit import changed, on_gear
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.recording.recording import Recording
from gearpoly.report.compare_report import alignment_json
from gearpoly.units import DEG
from tests.made_recordings import Rig, record
from tests.pair_files import made, pair_file

Z = 11, 13
TEETH = 4, 7
RIG = Rig(zero_1=1.0, zero_2=2.0, noise=0.3)


def pair() -> tuple[PairFile, PairFile]:
    """Two gears of which all teeth are alike, and the true ones: one tooth of each stands 6 um off."""
    plain = pair_file(Z, points=120)
    true = plain
    for gear, z in enumerate(Z):
        sheet = (plain.driving, plain.driven)[gear].inspection
        off = tuple(6.0 * (k == TEETH[gear]) for k in range(z))
        true = on_gear(true, gear, inspection=changed(sheet, pitch_um=off))
    return plain, true


def recorded(true: PairFile, stated: tuple[bool, bool]) -> Recording:
    zeros = (RIG.zero_1 if stated[0] else None, RIG.zero_2 if stated[1] else None)
    return record(made(true), RIG, np.random.default_rng(4), per_mesh=8, stated=zeros)


@pytest.mark.long
@pytest.mark.parametrize("stated", [(True, True), (True, False), (False, True), (False, False)])
def test_a_zero_that_is_stated_numbers_the_teeth_of_its_gear(stated: tuple[bool, bool]) -> None:
    plain, true = pair()
    assert lay_beside(plain, [recorded(true, stated)], path="pair.toml").alignment.numbered == stated


@pytest.mark.long
def test_only_the_teeth_of_that_gear_are_told_by_their_numbers() -> None:
    """In the alignment's JSON, where recording and simulation differ, and in what a claim says of a tooth."""
    plain, true = pair()
    found = compare(plain, [recorded(true, (True, False))], path="pair.toml")
    told = alignment_json(found)
    assert not told["numbered"] and told["numbered_gears"] == ["driving"]
    teeth = {gear: [e.tooth for e in found.located.entries if e.kind == "tooth" and e.gear == gear] for gear in GEARS}
    # Its neighbours may be its echo.
    assert TEETH[0] in teeth["driving"] and None not in teeth["driving"]
    assert teeth["driven"] and set(teeth["driven"]) == {None}
    pitch = catalogue()["tooth_pitch"]
    for gear, number in ((0, 3), (1, None)):
        claim = Claim(physics=pitch, place=Place(gear=gear, tooth=3, flank="drive"), values=(1.0,))
        assert numbered(found, claim) == number


def test_a_gear_that_moves_on_by_a_tooth_was_not_numbered() -> None:
    """One driving turn is 11 pitches: the driving gear stands as before, the driven one at another tooth."""
    zeros = Zeros(driving=1.0, driven=2.0, rms=0.0)
    one = Alignment(
        zeros=zeros, std_driving=0.01, std_driven=0.01, rivals=(), contradicted=None, phased=True, rough=True,
        numbering="open", numbered=(True, True), shift=np.zeros(1), offset=np.zeros(1),
    )  # fmt: skip
    moved = one.moved(2.0 * np.pi * Z[0] / Z[1], ratio=Z[0] / Z[1], directions=(1, 1), z=Z)
    assert moved.numbered == (True, False)
    assert moved.zeros.driving == pytest.approx(1.0, abs=1e-9 * DEG)
