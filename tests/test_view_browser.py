"""The contact debugger in a real Chromium: what the page shows is what ``simulate`` says, and hands and keys work.

Screenshots stay in out/view to be looked at.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.assemble import assemble
from gearpoly.files.pairfile import read_pair
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.page.pack import packed, unpacked
from gearpoly.simulate import Simulation, simulate
from gearpoly.units import DEG, NM, UM, FloatArray
from gearpoly.view.document import document
from gearpoly.view.html import page_text
from gearpoly.view.scene import ViewScene, scene_of
from tests.chromium import Chromium

pytestmark = pytest.mark.long


ROOT = Path(__file__).parents[1]
OUT = ROOT / "out" / "view"

CLOSE = 1e-4
"""um. Two implementations of the same polygons differ by rounding: 1e-12 rad on a radius of 50 mm. Promised is 1 um."""


def quiet(done: int) -> None:
    """Nobody watches."""


@dataclass(frozen=True, kw_only=True)
class Shown:
    """A page, and the scene that it was made from."""

    page: Path
    scene: ViewScene

    @property
    def pair(self) -> GearPair:
        return self.scene.simulation.pair


PAIRS: dict[str, tuple[str, Flank]] = {
    "loaded": ((ROOT / "data" / "pairs" / "graded_18_25.toml").read_text(encoding="utf-8"), "drive"),
    "rough": (
        """
name = "rough flanks, as the paper scatters them"
[driving]
teeth = 11
module_mm = 2.0
grade = 6
points_per_flank = 900
profile_errors = "scatter"
[driven]
teeth = 13
module_mm = 2.0
grade = 6
points_per_flank = 900
profile_errors = "scatter"
""",
        "drive",
    ),
    "off_axis": (
        """
name = "coast flank, off axis, shifted, wide"
[pair]
centre_distance_mm = 24.5
torque_nm = 4.0
[driving]
teeth = 11
module_mm = 2.0
profile_shift = 0.2
face_width_mm = 20.0
grade = 7
points_per_flank = 300
[driving.eccentricity]
amplitude_um = 12.0
angle_deg = 40.0
[driven]
teeth = 13
module_mm = 2.0
face_width_mm = 20.0
grade = 7
points_per_flank = 300
[driven.eccentricity]
amplitude_um = 25.0
angle_deg = 200.0
""",
        "coast",
    ),
    "chipped": (
        """
name = "tips broken off on both gears"
[pair]
torque_nm = 6.0
[driving]
teeth = 11
module_mm = 2.0
face_width_mm = 20.0
grade = 7
points_per_flank = 300
[[driving.chip]]
tooth = 4
height_mm = 1.1
[[driving.chip]]
tooth = 8
height_mm = 0.4
[driven]
teeth = 13
module_mm = 2.0
face_width_mm = 20.0
grade = 7
points_per_flank = 300
[[driven.chip]]
tooth = 2
height_mm = 1.9
""",
        "drive",
    ),
}


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Shown]:
    """All pages, made once."""
    folder = tmp_path_factory.mktemp("pages")
    out = {}
    for name, (text, flank) in PAIRS.items():
        path = folder / f"{name}.toml"
        path.write_text(text, encoding="utf-8")
        file = read_pair(path)
        scene = scene_of(
            assemble(file, path=path, seed=1),
            name=file.name,
            path=path,
            condition=Condition(flank=flank, torque=file.torque_nm * NM),
            seed=1,
            progress=quiet,
        )
        page = folder / f"{name}.html"
        page.write_text(page_text(document(scene)), encoding="utf-8")
        out[name] = Shown(page=page, scene=scene)
    return out


def at_angles(scene: ViewScene, theta_2: FloatArray) -> Simulation:
    """``simulate`` at angles of its own, certified by the polygon kernel, not those that the page was given."""
    one = scene.simulation
    return simulate(
        one.assembled, theta_2, one.mesh.condition, seed=one.seed, evenly=False, fast=False,
        progress=quiet,
    )  # fmt: skip


def first_rows(simulation: Simulation) -> list[int]:
    return np.searchsorted(simulation.contacts.position, np.arange(simulation.te.size)).tolist()


def degrees(theta_2: FloatArray) -> str:
    return json.dumps((theta_2 / DEG).tolist())


@pytest.mark.parametrize("name", PAIRS)
def test_contacts_stand_where_simulate_says(fresh: Chromium, shown: dict[str, Shown], name: str) -> None:
    """Anywhere in the cycle, between the samples too: all near pairs, their places, normals, gaps and features."""
    one = shown[name]
    theta_2 = np.random.default_rng(7).uniform(0.0, one.pair.cycle, 24)
    wish = at_angles(one.scene, theta_2).contacts
    fresh.open(one.page)
    assert fresh.run("document.getElementById('warning').hidden")
    found = fresh.run(f"{degrees(theta_2)}.map(deg => gearpoly.at(deg))")
    for k, state in enumerate(found):
        assert state["unloaded_te_um"] == pytest.approx(wish.te[k] * one.pair.r_b2 / UM, abs=CLOSE)
        rows = {(c["driving"], c["driven"]): c for c in state["contacts"]}
        for row in np.flatnonzero(wish.position == k):
            mine = rows[int(wish.driving[row]), int(wish.driven[row])]
            assert mine["gap_um"] == pytest.approx(wish.gap[row] / UM, abs=CLOSE)
            assert np.hypot(*(np.array(mine["point"]) - wish.point[row])) / UM < CLOSE
            # Normals of rough flanks turn by whole degrees from edge to edge; the place decides them.
            assert np.dot(mine["normal"], wish.normal[row]) == pytest.approx(1.0, abs=1e-6)
            corner = ("flank", "driving tip corner", "driven tip corner")[int(wish.feature[row])]
            assert mine["feature"] == corner


def test_a_browser_that_cannot_inflate_says_so(browser: Chromium, shown: dict[str, Shown]) -> None:
    script = browser.send("Page.addScriptToEvaluateOnNewDocument", source="delete window.DecompressionStream")
    try:
        with pytest.raises(RuntimeError, match="newer browser"):
            browser.open(shown["rough"].page)
    finally:
        browser.send("Page.removeScriptToEvaluateOnNewDocument", **script)
    assert "needs a newer browser" in browser.run("document.querySelector('[role=alert]').innerText")


@pytest.mark.parametrize("name", PAIRS)
def test_at_its_samples_the_page_repeats_simulate(fresh: Chromium, shown: dict[str, Shown], name: str) -> None:
    """TE, driving angle, backlash, who touches and, under load, who carries how much."""
    one = shown[name]
    simulation = one.scene.simulation
    chosen = np.random.default_rng(8).choice(simulation.te.size, 60, replace=False)
    fresh.open(one.page)
    found = fresh.run(f"{degrees(simulation.contacts.theta_2[chosen])}.map(deg => gearpoly.at(deg))")
    for k, state in zip(chosen.tolist(), found, strict=True):
        # 1e-4: TE and approach travel in steps of 1e-5 um.
        assert state["te_um"] == pytest.approx(simulation.te_um[k], abs=CLOSE)
        assert state["theta_1"] == pytest.approx(simulation.theta_1[k], abs=1e-8)
        assert state["backlash_um"] == pytest.approx(simulation.backlash.j_bn[k] / UM, abs=CLOSE)
        assert state["pairs"] == simulation.pairs[k]
        if simulation.load is not None:
            rows = np.flatnonzero((simulation.contacts.position == k) & simulation.touches)
            wish = {
                (int(simulation.contacts.driving[r]), int(simulation.contacts.driven[r])): simulation.load.force[r]
                for r in rows
            }
            force = {(c["driving"], c["driven"]): c["force"] for c in state["contacts"] if c["touching"]}
            # Half a step, of which there are 50 000 up to the greatest force of the cycle.
            assert force == pytest.approx(wish, abs=1.001e-5 * float(np.max(simulation.load.force)))


def test_a_page_whose_flanks_are_not_the_simulated_ones_says_so(
    fresh: Chromium, shown: dict[str, Shown], tmp_path: Path
) -> None:
    """Planted: one tooth stands 0.5 um off in the page only. Its own comparison with the simulation finds it."""
    data = document(shown["rough"].scene)
    level = unpacked(data["gears"][0]["drive"]["level"]).copy()
    level[3] += 0.5
    data["gears"][0]["drive"]["level"] = packed(level, "f8")
    page = tmp_path / "wrong.html"
    page.write_text(page_text(data), encoding="utf-8")
    fresh.open(page)
    assert not fresh.run("document.getElementById('warning').hidden")
    assert fresh.run("gearpoly.checked.te_um") == pytest.approx(0.5, abs=0.05)  # or less where another pair leads


@pytest.mark.parametrize("width", [1100, 1200, 1280, 1440])
def test_controls_stay_in_their_panel(fresh: Chromium, shown: dict[str, Shown], width: int) -> None:
    """Once the angle's unit stood beyond the edge of narrow screens."""
    fresh.size(width, 900)
    fresh.open(shown["loaded"].page)
    left, _, room, _ = fresh.box(".sliders")
    for name in ("#play", "#speed", "#cycle", "#fine", "#goto", "#angle", ".entry"):
        x, _, wide, _ = fresh.box(name)
        assert left - 1.0 <= x and x + wide <= left + room + 1.0, name
    fresh.size(1440, 900)


def test_sliders_move_the_contact_to_where_simulate_says(fresh: Chromium, shown: dict[str, Shown]) -> None:
    """A hand on each slider, then keys; each time the disc on the screen covers the point that simulate gives."""
    one = shown["loaded"]
    fresh.open(one.page)
    fresh.key("3", text="3")

    def check() -> float:
        state = fresh.run("({theta_2: gearpoly.state.theta_2, contacts: gearpoly.state.contacts.slice(0, 1)})")
        simulation = at_angles(one.scene, np.array([state["theta_2"]]))
        row = first_rows(simulation)[0]
        point = simulation.contacts.point[row]
        assert np.hypot(*(np.array(state["contacts"][0]["point"]) - point)) / UM < CLOSE
        x, y = fresh.run(f"gearpoly.screen({float(point[0])!r}, {float(point[1])!r})")
        left, top, _, _ = fresh.box("#stage")
        pixel = fresh.pixels(round(left + x), round(top + y), 1, 1)[0, 0]
        assert pixel.tolist() == [0x16, 0x19, 0x1D]  # the disc's own colour
        return float(state["theta_2"])

    left, top, width, height = fresh.box("#cycle")
    fresh.drag((left + 8, top + 0.5 * height), (left + 0.37 * width, top + 0.5 * height))
    there = check()
    assert there == pytest.approx(0.37 * one.pair.cycle, rel=0.05)  # a thumb is 16 px wide
    for _ in range(3):
        fresh.key("ArrowRight", code=39)
    assert check() == pytest.approx(there + 3 * one.pair.driven.gear.tau / one.scene.per_mesh, abs=1e-9)
    fresh.key("PageUp", code=33)
    share, mesh = math.modf(check() / one.pair.driven.gear.tau)
    wish = 0.3 if share > 0.5 else 0.7  # a click on the thumb moves nothing
    left, top, width, height = fresh.box("#fine")
    fresh.click(left + wish * width, top + 0.5 * height)
    assert check() / one.pair.driven.gear.tau == pytest.approx(mesh + wish, abs=0.06)
    left, top, width, height = fresh.box("#whole")
    fresh.click(left + 0.5 * width, top + 0.5 * height)
    check()


def test_the_curves_cursor_moves_with_the_gears(fresh: Chromium, shown: dict[str, Shown]) -> None:
    one = shown["rough"]
    fresh.open(one.page)
    middle = (
        "(() => { const b = document.getElementById('mark').getBoundingClientRect(); return b.left + b.width / 2; })()"
    )
    left, _, width, _ = fresh.box("#whole")
    seen = []
    for share in (0.2, 0.6):
        fresh.run(f"gearpoly.turn({share * one.pair.cycle / DEG!r}); 0")
        seen.append((fresh.run(middle) - left) / width)
    # The strip's axis takes 56 px of its width.
    assert seen[1] - seen[0] == pytest.approx(0.4 * (1.0 - 56.0 / width), abs=2.0 / width)


def test_a_view_of_10_nm_holds_still(fresh: Chromium, shown: dict[str, Shown]) -> None:
    """While the gears turn in steps of a millionth of a sample, the flanks' border beside the followed contact keeps
    its place to a pixel, 0.02 nm, and lies along the contact's tangent."""
    one = shown["loaded"]
    fresh.open(one.page)
    fresh.press(".layers summary")
    fresh.press("#show-load")  # unloaded flanks touch, they do not overlap
    fresh.press(".layers summary")
    start = fresh.run("gearpoly.turn(1234.56789).theta_2") / DEG
    fresh.run("gearpoly.follow('first'); gearpoly.zoomTo(10e-6); 0")
    assert fresh.run("gearpoly.camera.across") == pytest.approx(10e-6, rel=1e-9)
    OUT.mkdir(parents=True, exist_ok=True)
    fresh.screenshot(OUT / "zoom_10_nm.png")
    left, top, _, _ = fresh.box("#stage")
    seen = []
    for k in range(20):
        x, y, nx, ny = fresh.run(
            f"(() => {{ const c = gearpoly.turn({start + k * 3.6e-7!r}).contacts[0];"
            " return [...gearpoly.screen(...c.point), c.normal[0], -c.normal[1]]; })()"
        )
        image = fresh.pixels(left + round(x) - 200, top + round(y) - 200, 401, 401).astype(int)
        row = [x, y]
        for along in (-150, 150):
            # Across the border, clear of the marks on the contact: where blue ends and orange begins.
            places = [(200 - ny * along + nx * d, 200 + nx * along + ny * d) for d in np.arange(-30.0, 30.5, 0.5)]
            orange = [image[round(v), round(u), 0] > image[round(v), round(u), 2] for u, v in places]
            assert any(orange) and not orange[0]
            row.append(0.5 * orange.index(True) - 30.0)
        seen.append(row)
    borders = np.array(seen)
    # The contact stays in the middle to the rounding of float64 coordinates, 1e-14 mm of 1e-8 mm a pixel.
    assert np.max(np.ptp(borders[:, :2], axis=0)) < 1e-3
    assert np.max(np.abs(borders[:, 2:])) <= 2.5  # outlines of 1.4 px on whole pixels
    assert np.max(np.ptp(borders[:, 2:], axis=0)) <= 1.5


def test_zoom_by_wheel_keeps_the_place_under_the_hand(fresh: Chromium, shown: dict[str, Shown]) -> None:
    fresh.open(shown["rough"].page)
    left, top, width, height = fresh.box("#stage")
    x, y = left + 0.3 * width, top + 0.4 * height
    world = f"gearpoly.camera.world({0.3 * width!r}, {0.4 * height!r})"
    before = fresh.run(f"[gearpoly.camera.scale, ...{world}]")
    for _ in range(12):
        fresh.mouse("mouseWheel", x, y, deltaX=0, deltaY=-240)
    fresh.settle()
    after = fresh.run(f"[gearpoly.camera.scale, ...{world}]")
    assert after[0] > 100.0 * before[0]
    # The browser gives whole pixels; a fraction of one of the first view is what can be lost.
    assert np.hypot(after[1] - before[1], after[2] - before[2]) < 1.0 / before[0]


def test_a_click_shows_the_right_tooth(fresh: Chromium, shown: dict[str, Shown]) -> None:
    """Teeth of both gears, found by where simulate and the contract's numbering put them, magnified or not."""
    one = shown["loaded"]
    pair = one.pair
    fresh.open(one.page)
    theta_2 = fresh.run("gearpoly.turn(77.7).theta_2")
    theta_1 = fresh.run("gearpoly.state.theta_1")
    for which, mounted, axis, turn in ((0, pair.driving, 0.0, theta_1), (1, pair.driven, pair.a, -theta_2)):
        gear = mounted.gear
        for tooth in (0, 5, gear.z - 1):
            angle = mounted.centre_lines[tooth] + turn
            # The order of meshing is the contract's: driving tooth n at -n tau, driven tooth n at pi + n tau.
            x, y = axis + 0.95 * gear.r * math.cos(angle), 0.95 * gear.r * math.sin(angle)
            left, top, _, _ = fresh.box("#stage")
            px, py = fresh.run(f"gearpoly.screen({x!r}, {y!r})")
            fresh.click(left + px, top + py)
            if fresh.run("gearpoly.view.selected.gear") != which:
                continue  # where both gears are in mesh a mate's tooth may lie over it
            assert fresh.run("gearpoly.view.selected.tooth") == tooth
            name = "Driving" if which == 0 else "Driven"
            assert fresh.run("document.getElementById('tooth-name').textContent") == f"{name} tooth {tooth}"
            pitch = int(np.argmax(mounted.flanks.r >= gear.r))
            nominal = gear.psi(float(mounted.flanks.r[pitch]))
            d = (mounted.flanks.psi_drive[tooth, pitch] - nominal) * gear.r_b / UM
            words = fresh.run("document.getElementById('tooth-words').textContent")
            assert f"drive flank {d:.2f}".replace("-", "\u2212") in words
    meshes = fresh.run("document.querySelectorAll('#tooth-meshes button').length")
    assert meshes == pair.driving.gear.z  # the last was a driven tooth: it meets every driving tooth once
    fresh.press("#tooth-meshes li:nth-child(3) button")
    tooth = fresh.run("gearpoly.view.selected.tooth")
    assert tooth in fresh.run("gearpoly.state.contacts.map(one => one.driven)")
    fresh.screenshot(OUT / "tooth.png")


def test_magnified_teeth_still_touch_and_numbers_stay_true(fresh: Chromium, shown: dict[str, Shown]) -> None:
    """The exaggerated pair is turned until it touches; an ideal pair's picture does not change."""
    fresh.open(shown["loaded"].page)
    true = fresh.run("gearpoly.turn(200).te_um")
    fresh.press(".layers summary")
    left, top, width, height = fresh.box("#magnify")
    fresh.click(left + 0.7 * width, top + 0.5 * height)
    K = fresh.run("gearpoly.view.magnify")
    assert K > 5.0
    assert fresh.run("gearpoly.state.te_um") == true
    assert fresh.run("gearpoly.drawn.contacts[0].gap_um") == 0.0
    assert not fresh.run("document.getElementById('banner').hidden")
    # What varies from tooth to tooth grows K-fold: pitch steps dominate the unloaded TE, so its range does too.
    ranges = fresh.run(
        f"[1, {K!r}].map(K => {{ const te = Array.from({{length: 90}},"
        " (_, k) => gearpoly.at(14.4 * k + 1, K).unloaded_te_um); return Math.max(...te) - Math.min(...te); })"
    )
    assert ranges[1] / ranges[0] == pytest.approx(K, rel=0.25)  # other pairs lead where profiles are K times as bent
    fresh.key("2", text="2")
    fresh.screenshot(OUT / "magnified.png")


def test_fingers_pinch_and_pan(fresh: Chromium, shown: dict[str, Shown]) -> None:
    fresh.size(420, 900, touch=True)
    fresh.open(shown["rough"].page)
    left, top, width, height = fresh.box("#stage")
    x, y = left + 0.5 * width, top + 0.5 * height

    def touch(kind: str, *points: tuple[float, float]) -> None:
        fresh.send(
            "Input.dispatchTouchEvent",
            type=kind,
            touchPoints=[{"x": px, "y": py, "id": k} for k, (px, py) in enumerate(points)],
        )

    before = fresh.run("gearpoly.camera.scale")
    touch("touchStart", (x - 30, y), (x + 30, y))
    for reach in (45, 60, 90):
        touch("touchMove", (x - reach, y), (x + reach, y))
    touch("touchEnd")
    fresh.settle()
    after = fresh.run("gearpoly.camera.scale")
    assert after / before == pytest.approx(3.0, rel=0.02)  # 180 px for 60
    centre = fresh.run("gearpoly.camera.x")
    touch("touchStart", (x, y))
    for shift in (10, 25, 40):
        touch("touchMove", (x - shift, y))
    touch("touchEnd")
    fresh.settle()
    # 3 px are taken for a shaky finger before the view moves.
    assert (fresh.run("gearpoly.camera.x") - centre) * after == pytest.approx(40.0, abs=11.0)
    fresh.screenshot(OUT / "phone.png")


def test_every_control_has_a_name_and_the_keyboard_reaches_it(fresh: Chromium, shown: dict[str, Shown]) -> None:
    fresh.open(shown["loaded"].page)
    fresh.run("document.querySelector('details').open = true; gearpoly.select(0, 3); 0")
    nodes: list[dict[str, Any]] = fresh.send("Accessibility.getFullAXTree")["nodes"]
    roles = {"button", "slider", "checkbox", "combobox", "spinbutton", "img", "dialog"}
    controls = [node for node in nodes if node.get("role", {}).get("value") in roles and not node.get("ignored")]
    assert len(controls) > 25
    nameless = [node["role"]["value"] for node in controls if not node.get("name", {}).get("value")]
    assert nameless == []
    reached = set()
    fresh.run("document.body.focus(); 0")
    for _ in range(60):
        fresh.key("Tab", code=9)
        reached.add(fresh.run("document.activeElement.id"))
    assert {
        "stage",
        "zoom-nano",
        "follow",
        "play",
        "cycle",
        "fine",
        "angle",
        "magnify",
        "theme",
        "gap-range",
    } <= reached
    before = fresh.run("gearpoly.state.theta_2")
    fresh.run("document.getElementById('stage').focus(); 0")
    fresh.key("]", text="]")
    one = shown["loaded"]
    step = one.pair.driven.gear.tau / one.scene.per_mesh
    assert fresh.run("gearpoly.state.theta_2") == pytest.approx(before + step, abs=1e-12)
    fresh.key("5", text="5")
    assert fresh.run("gearpoly.camera.across") == pytest.approx(1e-5, rel=1e-9)
    followed = "(() => gearpoly.view.follow.driving)()"
    fresh.key("n", text="n")
    assert fresh.run(followed) == fresh.run("gearpoly.state.contacts[1].driving")


def _luminance(colour: str) -> float:
    """Relative luminance of a colour #rrggbb (WCAG 2.2)."""
    parts = [int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("dark", [False, True])
def test_both_themes_are_legible(fresh: Chromium, shown: dict[str, Shown], dark: bool) -> None:
    """WCAG 2.2: words 4.5 to 1 on their ground (1.4.3), lines and marks 3 to 1 (1.4.11); also without colour vision,
    since luminance alone is what counts."""
    fresh.dark(dark)
    fresh.open(shown["loaded"].page)
    names = [
        "ink",
        "muted",
        "panel",
        "stage",
        "bg",
        "driving",
        "driven",
        "touch",
        "normal",
        "force",
        "curve",
        "miss",
        "cursor",
    ]
    found = fresh.run(
        f"{json.dumps(names)}.map(n => getComputedStyle(document.documentElement).getPropertyValue('--' + n).trim())"
    )
    light = dict(zip(names, map(_luminance, found), strict=True))

    def contrast(one: str, other: str) -> float:
        high, low = sorted((light[one], light[other]), reverse=True)
        return (high + 0.05) / (low + 0.05)

    assert (light["bg"] < 0.1) == dark
    for words in ("ink", "muted"):
        assert min(contrast(words, ground) for ground in ("panel", "stage", "bg")) >= 4.5
    for mark in ("driving", "driven", "touch", "normal", "force", "curve", "miss", "cursor"):
        assert min(contrast(mark, ground) for ground in ("panel", "stage")) >= 3.0
    fresh.key("2", text="2")
    fresh.screenshot(OUT / f"mesh_{'dark' if dark else 'light'}.png")
    fresh.send("Emulation.setEmulatedVisionDeficiency", type="deuteranopia")
    fresh.screenshot(OUT / f"mesh_{'dark' if dark else 'light'}_deuteranopia.png")
    fresh.send("Emulation.setEmulatedVisionDeficiency", type="none")
