"""The contact debugger's data and command: what the page is given, and what is refused before anything is written."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from gearpoly.assemble import Assembled, assemble
from gearpoly.cli import app
from gearpoly.errors import GearpolyError, OutOfRangeError
from gearpoly.files.pairfile import read_pair
from gearpoly.mesh.condition import Condition
from gearpoly.page.pack import Kind, nearly_even, packed, rounded, rounded_log, under_noise, unpacked
from gearpoly.units import DEG, NM, UM
from gearpoly.view.document import document
from gearpoly.view.html import page_text
from gearpoly.view.scene import LEAST_VIEWED_PER_MESH, opening_angle, points_per_mesh, scene_of

ROOT = Path(__file__).parents[1]
PAPER = ROOT / "data" / "pairs" / "paper_18_25.toml"
GRADED = ROOT / "data" / "pairs" / "graded_18_25.toml"

UNLOADED, LOADED = (Condition(flank="drive", torque=torque * NM) for torque in (0.0, 8.0))


def quiet(done: int) -> None:
    """Nobody watches."""


def small(folder: Path, *, name: str = "small pair", torque_nm: float = 0.0) -> Path:
    """A pair of few teeth and points, drawn in a moment."""
    path = folder / "small.toml"
    gears = "\n".join(
        f"[{gear}]\nteeth = {z}\nmodule_mm = 2.0\nface_width_mm = 20.0\ngrade = 6\npoints_per_flank = 120\n"
        for gear, z in (("driving", 11), ("driven", 13))
    )
    path.write_text(f"name = {json.dumps(name)}\n[pair]\ntorque_nm = {torque_nm}\n{gears}", encoding="utf-8")
    return path


def made(path: Path) -> Assembled:
    return assemble(read_pair(path), path=path, seed=0)


def page_data(html: str) -> dict[str, Any]:
    """The data of a page, as a browser finds it."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', html, re.DOTALL)
    assert found is not None
    data: dict[str, Any] = json.loads(found[1])
    return data


@pytest.mark.parametrize(("kind", "values"), [
    ("f8", [1.0 / 3.0, -1e-300]), ("f4", [0.5, -3.25]), ("u4", [0, 2**32 - 1]), ("u2", [0, 65535]),
    ("i4", [-(2**31), 2**31 - 1]), ("i2", [-(2**15), 2**15 - 1]), ("u1", [0, 255]), ("i1", [-128, 127]),
])  # fmt: skip
def test_arrays_come_back_as_they_went(kind: Kind, values: list[float]) -> None:
    assert unpacked(packed([values, values], kind)).tolist() == [values, values]
    assert unpacked(packed([], kind)).size == 0


def test_smooth_numbers_travel_as_differences_and_noise_as_it_is() -> None:
    """A parabola has second differences that are all 2 (two ends apart), so its text does not grow with its length."""
    n = np.arange(20_000)
    smooth, noise = packed(n**2, "i4"), packed(np.random.default_rng(8).integers(-99, 99, n.size), "i2")
    assert smooth["differences"] >= 2 and len(smooth["deflated"]) < 1000
    assert noise["differences"] == 0


def test_differences_may_pass_what_their_kind_holds() -> None:
    """A sawtooth falls from end to end of the range: modulo 2^16 all of its differences are 1000."""
    teeth = (1000 * np.arange(60_000)) % 2**16 - 2**15
    pack = packed(teeth, "i2")
    assert pack["differences"] > 0 and len(pack["deflated"]) < 1000
    assert np.array_equal(unpacked(pack), teeth)


def test_rounding_errs_by_half_a_step_in_as_few_bytes_as_hold_it() -> None:
    values = np.random.default_rng(5).uniform(-40.0, 90.0, (3, 500))
    for step, kind in ((0.6, "i1"), (0.01, "i2"), (1e-6, "i4")):
        made = rounded(values, to=step)
        assert made["kind"] == kind
        assert np.max(np.abs(unpacked(made) - values)) <= 0.5 * step * (1.0 + 1e-9)  # sums round
    for step in (1e-12, 0.0):  # more steps than 32 bits count
        assert np.array_equal(unpacked(rounded(values, to=step)), values.astype(np.float32))
    assert unpacked(rounded([2.5, 2.5], to=0.0)).tolist() == [2.5, 2.5]
    assert np.isnan(unpacked(rounded([1.0, np.nan], to=0.1))[1])


@pytest.mark.long
def test_rounding_adds_nothing_to_noise_that_it_is_held_against() -> None:
    """Uniform rounding errors of 1/30 of the noise make it greater by 1/21 600; a tenth more for the sample."""
    noise = np.random.default_rng(6).normal(0.0, 0.02, 200_000)
    back = unpacked(under_noise(noise, noise=0.02))
    assert np.std(back - noise) < 0.02 / 30.0 / np.sqrt(12.0) * 1.1
    assert np.std(back) / np.std(noise) - 1.0 < 1.5 / 21_600.0
    # Much noise hides more, but 0.001 um is printed.
    assert np.max(np.abs(unpacked(under_noise(noise, noise=20.0)) - noise)) <= 0.5001e-3


def test_amplitudes_keep_their_place_on_a_logarithmic_axis() -> None:
    values = np.array([0.0, 1e-9, 3e-4, 0.02, 7.0, 1e3])
    back = unpacked(rounded_log(values))
    assert back[1:] == pytest.approx(values[1:], rel=5e-4) and back[0] == pytest.approx(0.0, abs=1.1e-12)


def test_even_places_are_two_numbers() -> None:
    assert nearly_even(np.arange(1000) * 0.3)["rest"] is None
    assert nearly_even(np.arange(1000) ** 1.001)["rest"] is not None


def test_a_number_that_does_not_fit_is_refused_rather_than_wrapped() -> None:
    with pytest.raises(OverflowError, match="256"):
        packed([0, 256], "u1")


@pytest.mark.long
def test_the_page_holds_the_very_polygons_that_were_simulated() -> None:
    """Of the roughest flanks, rebuilt vertices lie within 0.0001 nm, a hundredth of a pixel of a 10 nm view."""
    assembled = made(PAPER)
    scene = scene_of(assembled, name="paper", path=PAPER, condition=UNLOADED, progress=quiet)
    for raw, mounted in zip(document(scene)["gears"], (assembled.pair.driving, assembled.pair.driven), strict=True):
        flanks = mounted.flanks
        for side, psi in (("drive", flanks.psi_drive), ("coast", flanks.psi_coast)):
            d = unpacked(raw[side]["level"])[:, None] + unpacked(raw[side]["rest"]).astype(np.float64)
            rebuilt = unpacked(raw["psi"]) + d * UM / raw["r_b"]
            rebuilt[:, 0] = unpacked(raw["psi"])[0]  # mid space, which all teeth share
            assert np.max(np.abs(rebuilt - psi) * flanks.r) < 1e-10
        assert np.array_equal(unpacked(raw["radius"]), flanks.r)


@pytest.mark.long
def test_a_tooth_without_its_tip_stands_in_the_page_as_it_was_simulated(tmp_path: Path) -> None:
    path = small(tmp_path)
    text = path.read_text(encoding="utf-8") + "[[driving.chip]]\ntooth = 3\nheight_mm = 0.9\n"
    path.write_text(text, encoding="utf-8")
    assembled = made(path)
    scene = scene_of(assembled, name="pair", path=path, condition=UNLOADED, progress=quiet)
    driving, driven = document(scene)["gears"]
    assert driven["chipped"] == []
    (raw,) = driving["chipped"]
    own = assembled.pair.driving.flanks.chipped[3]
    assert raw["tooth"] == 3
    assert np.array_equal(unpacked(raw["radius"]), own.r)
    assert own.r[-1] == pytest.approx(driving["r_a"] - 0.9, abs=1e-14)
    for side, psi in (("drive", own.drive), ("coast", own.coast)):
        d = unpacked(raw[side]["level"])[:, None] + unpacked(raw[side]["rest"]).astype(np.float64)
        rebuilt = (unpacked(raw["psi"]) + d[0] * UM / driving["r_b"])[1:]  # the first is mid space
        assert np.max(np.abs(rebuilt - psi[1:]) * own.r[1:]) < 1e-9


def test_deviations_in_the_page_are_normal_and_in_um(tmp_path: Path) -> None:
    """An inspected index deviation stands in the page as the file states it, on the whole involute."""
    path = tmp_path / "pair.toml"
    path.write_text(
        "[driving]\nteeth = 11\nmodule_mm = 2.0\npoints_per_flank = 50\n[driving.inspection]\n"
        f"pitch_um = {[1.5 * k for k in range(11)]}\ntooth_thickness_um = -40.0\n"
        "[driven]\nteeth = 13\nmodule_mm = 2.0\npoints_per_flank = 50\n",
        encoding="utf-8",
    )
    assembled = made(path)
    scene = scene_of(assembled, name="pair", path=path, condition=UNLOADED, progress=quiet)
    raw = document(scene)["gears"][0]
    d = {s: unpacked(raw[s]["level"])[:, None] + unpacked(raw[s]["rest"])[:, raw["root"] :] for s in ("drive", "coast")}
    index = 1.5 * np.arange(11)[:, None]
    # 1e-6 um: both sides come from angles in float64, of which 1e-16 rad are 2e-12 um; float32 adds 1e-6.
    assert np.allclose(d["drive"], index, rtol=0.0, atol=1e-6)
    assert np.allclose(d["coast"], -index - 40.0 * math.cos(20.0 * DEG), rtol=0.0, atol=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(("path", "condition", "most"), [(PAPER, UNLOADED, 1.1e6), (GRADED, LOADED, 0.6e6)])
def test_a_page_of_18_25_teeth_at_2000_points_stays_small(path: Path, condition: Condition, most: float) -> None:
    """Below 1.5 MB with a long recording beside it, which weighs 0.4 MB. Flanks with random errors from point to point
    are 0.7 MB; drawn as machines leave them, 0.1 MB."""
    assembled = made(path)
    scene = scene_of(assembled, name=path.stem, path=path, condition=condition, progress=quiet)
    assert assembled.pair.driving.flanks.r.size > 2000
    assert len(page_text(document(scene)).encode()) < most


@pytest.mark.long
def test_forces_in_the_page_balance_the_torque(tmp_path: Path) -> None:
    """At every sample the carried forces times their levers about the driven axis make the torque."""
    path = small(tmp_path, torque_nm=8.0)
    scene = scene_of(made(path), name="pair", path=path, condition=LOADED, progress=quiet)
    samples = document(scene)["samples"]
    force, carrying = unpacked(samples["force_n"]).astype(float), unpacked(samples["carrying"]).astype(np.int64)
    assert int(np.sum(carrying)) == force.size
    found = scene.simulation.contacts
    rows = np.flatnonzero(scene.simulation.touches)
    assert np.array_equal(found.driven[rows], unpacked(samples["driven"]))
    assert np.array_equal(found.driving[rows], unpacked(samples["driving"]))
    arm = found.point[rows] - [scene.simulation.pair.a, 0.0]
    moments = force * np.abs(arm[:, 0] * found.normal[rows, 1] - arm[:, 1] * found.normal[rows, 0])
    sums = np.add.reduceat(moments, np.concatenate(([0], np.cumsum(carrying)[:-1])))
    # Two forces, each within 1 part in 131 000 of the greatest.
    assert np.allclose(sums, 8.0 * NM, rtol=2e-5)


def test_an_opening_angle_is_taken_within_the_cycle_and_must_be_a_number(tmp_path: Path) -> None:
    pair = made(small(tmp_path)).pair
    assert opening_angle(pair, 12.5 * DEG) == pytest.approx(12.5 * DEG, abs=1e-15)
    # 1e-12: rounding of a cycle of 11 turns in rad.
    assert opening_angle(pair, 12.5 * DEG - pair.cycle) == pytest.approx(12.5 * DEG, abs=1e-12)
    for bad in (math.nan, math.inf):
        with pytest.raises(OutOfRangeError, match="--at"):
            opening_angle(pair, bad)


def test_the_longest_cycles_are_sampled_less_densely_but_never_past_a_hand_over() -> None:
    class Many:
        meshes_per_cycle = 199 * 200

    assert points_per_mesh(Many()) == LEAST_VIEWED_PER_MESH  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["</script><script>boom()</script>", "{{DATA}} & {{STYLE}}", "<!--<script>"])
def test_a_pair_may_have_any_name(tmp_path: Path, name: str) -> None:
    path = small(tmp_path, name=name)
    scene = scene_of(made(path), name=name, path=path, condition=UNLOADED, progress=quiet)
    html = page_text(document(scene))
    assert page_data(html)["name"] == name
    assert html.count("</script>") == 2
    assert html.count("<script") == 2


def run(*arguments: str | Path) -> tuple[int, str]:
    """Exit code and message of ``gearpoly view`` as ``main`` would give them."""
    result = CliRunner().invoke(app, ["view", *map(str, arguments)])
    if isinstance(result.exception, GearpolyError):
        return 2, str(result.exception)
    return result.exit_code, result.output


def test_the_command_writes_a_page_that_opens_at_the_angle(tmp_path: Path) -> None:
    path = small(tmp_path)
    code, said = run(path, "--at", "33.5", "--html", tmp_path / "page.html", "--flank", "coast")
    assert code == 0
    assert "page.html" in said
    data = page_data((tmp_path / "page.html").read_text(encoding="utf-8"))
    assert data["at"] == pytest.approx(33.5 * DEG, abs=1e-15)
    assert data["flank"] == "coast"


def test_without_a_target_the_page_is_named_after_the_pair(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = small(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert run(path)[0] == 0
    assert (tmp_path / "small.html").is_file()


def test_standard_output_gets_the_page_and_nothing_else(tmp_path: Path) -> None:
    code, said = run(small(tmp_path), "--html", "-")
    assert code == 0
    assert said.startswith("<!doctype html>")
    assert said.rstrip().endswith("</html>")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--html", "{folder}/none/page.html"], "there is no folder"),
        (["--html", "{folder}/folder.html"], "this is a folder"),
        (["--html", "{folder}/page.svg"], r"want a name ending in \.html"),
        (["--html", "{folder}/page.html", "--at", "nan"], "want a driven angle in deg"),
        (["--html", "{folder}/page.html", "--recording", "{folder}/none.csv"], r"none\.csv"),
        (["--html", "{folder}/page.html", "--recording", "{folder}/none.csv", "--seed", "3"], "leave out --flank"),
        (["--html", "{folder}/page.html", "--recording", "{folder}/none.csv", "--flank", "drive"], "leave out --flank"),
    ],
)
def test_bad_input_is_refused_with_its_cure_and_leaves_nothing(tmp_path: Path, arguments: list[str], says: str) -> None:
    path = small(tmp_path)
    (tmp_path / "folder.html").mkdir()
    before = sorted(tmp_path.rglob("*"))
    code, said = run(path, *(part.format(folder=tmp_path) for part in arguments))
    assert code == 2
    assert re.search(says, said)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.long
def test_an_old_page_survives_a_run_that_fails(tmp_path: Path) -> None:
    """Gears that jam are found only after everything else: the page of yesterday is still whole."""
    target = tmp_path / "page.html"
    target.write_text("yesterday", encoding="utf-8")
    path = small(tmp_path)
    path.write_text(
        path.read_text(encoding="utf-8").replace("grade = 6", "inspection = {tooth_thickness_um = 30.0}"),
        encoding="utf-8",
    )
    code, said = run(path, "--html", target)
    assert code == 2
    assert "jam" in said
    assert target.read_text(encoding="utf-8") == "yesterday"
    assert [p.name for p in tmp_path.glob(".gearpoly-*")] == []
