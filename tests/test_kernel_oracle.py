"""The certified kernel against an oracle that shares no code with it: the radial gap of the same polylines.

The oracle gets each tooth's drawn flank and places it by the contract alone: tooth n of the driving gear at -n tau_1,
of the driven one at pi + n tau_2, half a tooth back from the pitch point, the centre at its eccentricity's angle.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from gearpoly.assemble import assemble
from gearpoly.files.pairfile import read_pair
from gearpoly.gear.flank import Flanks
from gearpoly.mesh import bodies, certificate, contact
from gearpoly.mesh.bodies import Jobs, Meeting
from gearpoly.mesh.contact import Feature
from gearpoly.mesh.pair import GearPair
from gearpoly.mesh.transmission import contacts
from gearpoly.units import DEG, UM, BoolArray, FloatArray, IntArray
from tests.oracles.radial_gap import closing_rotations

Side = Literal["drive", "coast"]

# rad: the figure promised. The bracket is 2.5e-13 wide on either side, the oracle exact to 1e-15.
PROMISED = 1e-12

# um and deg, stated here once more for the oracle's own placing.
ECCENTRICITY = ((20.0, 40.0), (30.0, 250.0))


def grade_8(
    folder: Path,
    teeth: tuple[int, int] = (18, 25),
    *,
    points: int = 1000,
    seed: int = 0,
    wider: float = 0.06,
    E_sni: float = -200.0,
) -> GearPair:
    """Grade 8 errors, relief of both shapes, both eccentricities and a displaced centre (mm): everything at once."""
    sections = []
    for k, (name, shape) in enumerate((("driving", "linear"), ("driven", "parabolic"))):
        sections.append(
            f"""
[{name}]
teeth = {teeth[k]}
module_mm = 2.0
grade = 8
points_per_flank = {points}
[{name}.limits]
E_sns_um = -60.0
E_sni_um = {E_sni}
[{name}.tip_relief]
amount_um = 8.0
length_mm = 0.7
shape = "{shape}"
[{name}.eccentricity]
amplitude_um = {ECCENTRICITY[k][0]}
angle_deg = {ECCENTRICITY[k][1]}
"""
        )
    file = folder / f"pair_{teeth[0]}_{teeth[1]}_{seed}.toml"
    file.write_text(f"[pair]\ncentre_distance_mm = {sum(teeth) + wider}\n" + "".join(sections), encoding="utf-8")
    return assemble(read_pair(file), path=file, seed=seed).pair


def placed(flanks: Flanks, which: int, side: Side) -> FloatArray:
    """All flanks of one side (z, n, 2) about their axis of rotation at rotation 0, by the contract; x = 0."""
    z = flanks.gear.z
    order = np.arange(z) * 2.0 * math.pi / z
    middle = (-order if which == 0 else math.pi + order) - math.pi / (2.0 * z)
    angle = middle[:, None] + (flanks.psi_drive if side == "drive" else -flanks.psi_coast)
    amplitude, turn = ECCENTRICITY[which]
    direction = -turn * DEG if which == 0 else math.pi + turn * DEG
    centre = amplitude * UM * np.array([math.cos(direction), math.sin(direction)])
    return np.stack((flanks.r * np.cos(angle), flanks.r * np.sin(angle)), axis=-1) + centre


def compare(pair: GearPair, theta_2: FloatArray, side: Side) -> tuple[FloatArray, IntArray]:
    """Difference of closing rotations (N,) in rad between kernel and oracle, and what touches (N,)."""
    guesses = theta_2 * pair.driven.gear.z / pair.driving.gear.z
    found = contacts(pair, theta_2, flank=side)
    exact = closing_rotations(
        placed(pair.driving.flanks, 0, side),
        placed(pair.driven.flanks, 1, side),
        axis_distance=pair.a,
        poses=-theta_2,
        guesses=guesses,
        sense=1 if side == "drive" else -1,
    )
    first = np.flatnonzero(np.diff(found.position, prepend=-1))
    same = (found.driving[first] == exact.pair[:, 0]) & (found.driven[first] == exact.pair[:, 1])
    mine = -found.te * pair.driven.gear.z / pair.driving.gear.z
    error = np.abs(mine - exact.offset)
    # Two pairs within the bracket of one another may swap; else the same teeth touch.
    assert np.all(same | (error < PROMISED))
    assert not np.any(np.isnan(error))
    return error, found.feature[first]


def positions(pair: GearPair, count: int, seed: int) -> FloatArray:
    return np.random.default_rng(seed).uniform(0.0, pair.cycle, count)


@pytest.mark.long
@pytest.mark.parametrize("side", ["drive", "coast"])
def test_kernel_is_the_radial_gap_at_grade_8(tmp_path: Path, side: Side) -> None:
    pair = grade_8(tmp_path)
    error, feature = compare(pair, positions(pair, 1500, 1), side)
    assert np.max(error) <= PROMISED
    # The hard cases are among them: corners of both gears.
    assert np.count_nonzero(feature == Feature.TURNING_CORNER) > 10
    assert np.count_nonzero(feature == Feature.FIXED_CORNER) > 10


@pytest.mark.long
@pytest.mark.parametrize("side", ["drive", "coast"])
@pytest.mark.parametrize("teeth", [(8, 60), (60, 8), (8, 9), (17, 200)])
def test_kernel_is_the_radial_gap_on_undercut_and_on_large_gears(
    tmp_path: Path, teeth: tuple[int, int], side: Side
) -> None:
    pair = grade_8(tmp_path, teeth, points=500)
    assert pair.driving.flanks.root.undercut == (teeth[0] < 18)
    error, _ = compare(pair, positions(pair, 300, 2), side)
    assert np.max(error) <= PROMISED


@pytest.mark.long
@pytest.mark.parametrize("side", ["drive", "coast"])
@pytest.mark.parametrize("wider", [0.8, *(pytest.param(one, marks=pytest.mark.slow) for one in (1.2, 1.6))])
def test_wide_backlash_hides_no_tooth(tmp_path: Path, wider: float, side: Side) -> None:
    """At a centre distance 0.8 m too wide the coast flanks meet a millimetre from where thin backlash has them."""
    pair = grade_8(tmp_path, points=150, wider=wider)
    error, _ = compare(pair, positions(pair, 1500, 3), side)
    assert np.max(error) <= PROMISED


@pytest.mark.long
@pytest.mark.parametrize("side", ["drive", pytest.param("coast", marks=pytest.mark.slow)])
def test_narrow_teeth_are_not_mistaken_for_one_another(tmp_path: Path, side: Side) -> None:
    """Of 700 teeth the pitch is 9 mrad: a search may not start further back than that, or it finds the tooth before."""
    pair = grade_8(tmp_path, (700, 20), points=60, wider=0.12, E_sni=-300.0)
    error, _ = compare(pair, np.random.default_rng(4).uniform(0.0, 30.0, 200), side)
    assert np.max(error) <= PROMISED


@pytest.mark.slow
@pytest.mark.parametrize("side", ["drive", "coast"])
def test_kernel_is_the_radial_gap_at_36_000_positions(tmp_path: Path, side: Side) -> None:
    pair = grade_8(tmp_path, points=2000, seed=5)
    # Two in a step, so that no position falls where another did: 18 turns in 36 000 places.
    theta_2 = (np.arange(36_000) + 0.37) / 36_000 * pair.cycle
    error, feature = compare(pair, theta_2, side)
    assert np.max(error) <= PROMISED
    assert np.all(np.bincount(feature, minlength=3) > 100)


# Planted faults.


def trusting(m: Meeting, jobs: Jobs) -> BoolArray:
    return np.zeros(len(jobs), dtype=bool)


@pytest.mark.long
def test_planted_faults_turn_the_oracle_red(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pair = grade_8(tmp_path, points=500)
    theta_2 = positions(pair, 400, 6)

    def worst() -> float:
        return float(np.max(compare_loosely(pair, theta_2)))

    assert worst() <= PROMISED
    with monkeypatch.context() as patch:
        # Windows of 3 vertices miss; certificates repair it.
        patch.setattr(bodies, "WINDOW_VERTICES", 3)
        assert worst() <= PROMISED
        # Without certificates nothing does.
        patch.setattr(contact, "certify", trusting)
        assert worst() > 1e-9
    with monkeypatch.context() as patch:
        # A bracket a thousand times wider certifies answers that are off by as much.
        honest = contact.refine

        def displaced(m: Meeting, jobs: Jobs) -> None:
            honest(m, jobs)
            jobs.rotation = jobs.rotation + 1e-10

        patch.setattr(contact, "refine", displaced)
        assert worst() <= PROMISED
        patch.setattr(certificate, "HALF_BRACKET", 2.5e-10)
        assert worst() > 10.0 * PROMISED


def compare_loosely(pair: GearPair, theta_2: FloatArray) -> FloatArray:
    """As ``compare``, also where the wrong teeth touch."""
    found = contacts(pair, theta_2)
    exact = closing_rotations(
        placed(pair.driving.flanks, 0, "drive"),
        placed(pair.driven.flanks, 1, "drive"),
        axis_distance=pair.a,
        poses=-theta_2,
        guesses=theta_2 / pair.ratio,
    )
    error: FloatArray = np.abs(-found.te / pair.ratio - exact.offset)
    return error


def test_a_tooth_out_of_place_turns_the_oracle_red(tmp_path: Path) -> None:
    """The oracle's placing is its own: teeth numbered the wrong way round, or a centre on the wrong side, show."""
    pair = grade_8(tmp_path, points=300)
    theta_2 = positions(pair, 200, 7)
    flanks = pair.driving.flanks, pair.driven.flanks
    mate = placed(flanks[1], 1, "drive")
    found = contacts(pair, theta_2).te
    backwards = replace(flanks[0], psi_drive=flanks[0].psi_drive[::-1])
    faults = (
        placed(backwards, 0, "drive"),
        placed(flanks[0], 0, "drive") * np.array([1.0, 1.0 + 1e-9]),
        placed(flanks[0], 0, "drive") + np.array([2e-9, 0.0]),
    )
    for fault in faults:
        exact = closing_rotations(fault, mate, axis_distance=pair.a, poses=-theta_2, guesses=theta_2 / pair.ratio)
        assert np.nanmax(np.abs(-found / pair.ratio - exact.offset)) > 10.0 * PROMISED
