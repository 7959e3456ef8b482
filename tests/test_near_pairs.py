"""No near pair is missing: certified polygons, compiled search and exhaustion agree on pairs that touch where they do
not usually, and a check of gearpoly itself that fails is no fault of the user's."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from gearpoly import __main__ as entry
from gearpoly.errors import GeometryError, SelfCheckError
from gearpoly.gear.deviations import pitch_and_thickness
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.gear.root import form_point
from gearpoly.mesh import contact, transmission
from gearpoly.mesh.contact import Closings, closing_rotations
from gearpoly.mesh.pair import Flank, GearPair, active_start, mount, tight_centre_distance
from gearpoly.mesh.radial import closing_rotations_fast
from gearpoly.mesh.transmission import contacts, expected_closing
from tests.oracles.radial_gap import closing_rotations_of_pairs

PROMISED = 1e-12
"""rad. What both kernels promise."""


def pair_of(
    z: tuple[int, int], x: tuple[float, float], eccentric: tuple[float, float] = (0.0, 0.0), wider: float = 0.0
) -> GearPair:
    """Ideal gears of module 2, shifted, eccentric and apart; mm."""
    gears = [Gear(z=z[k], m=2.0, x=x[k]) for k in (0, 1)]
    flanks = [
        draw_flanks(gears[k], l_start=active_start(gears[k], gears[1 - k], l_form=form_point(gears[k])[1]), points=200)
        for k in (0, 1)
    ]
    a = tight_centre_distance(*gears) + wider
    return mount(*flanks, a=a, eccentricity_1=(eccentric[0], 0.7), eccentricity_2=(eccentric[1], 2.1))


def rows_of(found: Closings) -> dict[tuple[int, int, int], float]:
    rows = zip(found.pose, found.turning, found.fixed, found.rotation, strict=True)
    return {(int(p), int(i), int(j)): float(rotation) for p, i, j, rotation in rows}


def largest_difference(pair: GearPair, flank: Flank, *, near: float, positions: int = 60) -> tuple[float, float]:
    """How far (rad) the compiled search and the certified polygons are off exhaustion, a missing pair as infinity."""
    sense = 1.0 if flank == "drive" else -1.0
    theta_2 = np.linspace(0.0123, 6.2, positions)
    bodies = pair.driving.body(flank), pair.driven.body(flank)
    guesses = sense * theta_2 / pair.ratio + expected_closing(pair, flank)
    how = {"axis_distance": pair.a, "poses": -sense * theta_2, "guesses": guesses}
    exact = closing_rotations_of_pairs(bodies[0].faces, bodies[1].faces, count=5, **how)
    reach = near / pair.r_b1
    true = {
        (p, int(exact.pair[p, k, 0]), int(exact.pair[p, k, 1])): float(exact.offset[p, k])
        for p in range(positions)
        for k in range(5)
        if exact.offset[p, k] <= exact.offset[p, 0] + reach
    }
    fast = rows_of(closing_rotations_fast(*bodies, near=reach, **how))
    (part,) = closing_rotations(*bodies, near=reach, **how)
    found = rows_of(part)
    fast_off, certified_off = (
        max(abs(one.get(key, np.inf) - true.get(key, np.inf)) for key in one.keys() | true.keys())
        for one in (fast, found)
    )
    return fast_off, certified_off


TOUCH_ELSEWHERE = [
    ((9, 300), (-0.3, 0.0), (0.0, 0.0), 0.0),  # the mate's tip meets the fillet of an undercut pinion
    ((9, 49), (-0.47, -0.01), (0.0, 0.0), 0.005),
    ((8, 14), (-0.11, -0.12), (0.059, 0.086), 0.145),
    ((7, 59), (-0.43, 0.62), (0.15, 0.133), 0.29),
    ((46, 140), (0.0, 0.0), (0.2, 0.19), 0.3),  # sound teeth that run 0.2 mm off their axes, far from every guess
    ((59, 147), (-0.38, -0.36), (0.174, 0.163), 0.337),
]


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize(("z", "x", "eccentric", "wider"), TOUCH_ELSEWHERE)
def test_pairs_that_touch_on_a_fillet_or_far_from_their_guess_are_found(
    z: tuple[int, int], x: tuple[float, float], eccentric: tuple[float, float], wider: float, flank: Flank
) -> None:
    assert max(largest_difference(pair_of(z, x, eccentric, wider), flank, near=0.01)) <= PROMISED


def test_without_the_last_look_on_whole_faces_pairs_are_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted fault."""
    monkeypatch.setattr(contact, "_missed", lambda m, tree, jobs, *_, **__: jobs.take(np.zeros(0, dtype=np.int64)))
    assert largest_difference(pair_of((9, 300), (-0.3, 0.0)), "drive", near=0.01)[1] > PROMISED


PLAIN = """
[pair]
torque_nm = {torque}
[driving]
teeth = {z}
module_mm = 2
profile_shift = {x}
face_width_mm = 20
[driven]
teeth = {mate}
module_mm = 2
face_width_mm = 20
"""


def run(*arguments: str, monkeypatch: pytest.MonkeyPatch) -> int:
    """The command line as a process runs it: its exit code."""
    monkeypatch.setattr(sys, "argv", ["gearpoly", *arguments])
    with pytest.raises(SystemExit) as end:
        entry.main()
    return int(end.value.code or 0)


@pytest.mark.parametrize("fast", [[], ["--fast"]])
@pytest.mark.parametrize("torque", ["3e4", "1e6", "1e9"])
def test_a_torque_beyond_all_teeth_says_to_lower_it_on_both_paths(
    torque: str, fast: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "pair.toml"
    file.write_text(PLAIN.format(torque=torque, z=18, x=0, mate=25))
    assert run("simulate", str(file), "--turns", "0.04", *fast, monkeypatch=monkeypatch) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "more than 100 um, 5% of the module" in said
    assert "lower the torque" in said


def test_an_undercut_pinion_runs_on_the_fast_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "pair.toml"
    file.write_text(PLAIN.format(torque=0, z=9, x=-0.3, mate=300))
    assert run("simulate", str(file), "--turns", "0.02", "--fast", monkeypatch=monkeypatch) == 0
    assert "TEpp" in capsys.readouterr().out


def test_a_recording_of_eccentric_shafts_on_14_bits_runs_on_the_fast_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A magnet 0.5 deg off is taken for 0.2 mm of eccentricity of either gear, with which polygons missed pairs."""
    text = PLAIN.format(torque=0, z=46, x=0, mate=140).replace("torque_nm", "centre_distance_mm = 186.5\ntorque_nm")
    text = text.replace("[driven]", "[driving.eccentricity]\namplitude_um = 200\n[driven]")
    (tmp_path / "pair.toml").write_text(text + "[driven.eccentricity]\namplitude_um = 190\n")
    steps = np.linspace(0.0, 2.0 * np.pi, 300)
    read = [a + np.radians(0.5) * np.sin(a + 0.3) if k else a for k, a in enumerate((steps * 140 / 46, steps))]
    grid = 2.0 * np.pi / 2**14
    read = [np.degrees(np.round(a / grid) * grid) for a in read]
    lines = [f"{a:.6f},{b:.6f}" for a, b in zip(*read, strict=True)]
    head = "# driving_zero_deg = 0.0\n# driven_zero_deg = 0.0\ndriving_angle_deg,driven_angle_deg\n"
    (tmp_path / "run.csv").write_text(head + "\n".join(lines) + "\n")
    arguments = ["simulate", str(tmp_path / "pair.toml"), "--at", str(tmp_path / "run.csv"), "--fast"]
    assert run(*arguments, monkeypatch=monkeypatch) == 0
    assert "TEpp" in capsys.readouterr().out


def test_a_failed_self_check_is_a_bug_and_says_what_to_send(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def differs(*_: object, **__: object) -> float:
        raise SelfCheckError("the fast path and the certified polygons differ by 0.1 rad")

    monkeypatch.setattr(transmission, "spot_check", differs)
    file = tmp_path / "pair.toml"
    file.write_text(PLAIN.format(torque=0, z=18, x=0, mate=25))
    assert run("simulate", str(file), "--turns", "0.02", "--fast", monkeypatch=monkeypatch) == 1
    said = capsys.readouterr().err
    assert "fault in gearpoly, not in your files" in said
    assert "send this message, the command line, the pair file" in said
    assert "Traceback" not in said


def test_deviations_that_leave_open_which_teeth_face_each_other_are_the_users_to_cure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """0.95 mm of index deviation at module 2 is a wrong unit; both kernels then may well differ."""

    def differs(*_: object, **__: object) -> float:
        raise SelfCheckError("they differ")

    monkeypatch.setattr(transmission, "spot_check", differs)
    gears = [Gear(z=18, m=2.0), Gear(z=25, m=2.0)]
    index = np.zeros(18)
    index[3] = -0.95
    wild = draw_flanks(gears[0], pitch_and_thickness(gears[0], index=index, E_s=index), points=60)
    pair = mount(wild, draw_flanks(gears[1], points=60))
    with pytest.raises(GeometryError, match=r"stand up to 8\d\d um off their places.*unit \(um\)"):
        contacts(pair, np.zeros(1), fast=True)
