"""The page of a diagnosis in a real Chromium: plots draw what the diagnosis holds, and hands and keys work.

Screenshots stay in out/diagnosis to be looked at.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.report.diagnosis_page import page
from gearpoly.units import DEG, UM
from tests.chromium import Chromium
from tests.made_diagnosis import left_of, made_comparison, made_diagnosis

OUT = Path(__file__).parents[1] / "out" / "diagnosis"

SPIKE = 700
"""Sample of recording 0, in the order of its angles, that stands ``SPIKE_UM`` out of what is left."""
SPIKE_UM = 25.0

ROUNDED = 1.5e-3
"""um. Three decimals err by 0.5 nm, and the steps in which curves travel by as much."""

BEFORE, AFTER = (0x9A, 0x6A, 0x00), (0x3F, 0x33, 0xB5)
"""Colours of curves by day."""


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Diagnosis]:
    folder = tmp_path_factory.mktemp("diagnosis")
    file, comparison = made_comparison()
    left = [values.copy() for values in left_of(comparison)]
    left[0][np.argsort(comparison.aligned[0].theta_2)[SPIKE]] = SPIKE_UM * UM
    diagnosis = made_diagnosis(file, comparison, left=tuple(left))
    target = folder / "page.html"
    target.write_text(page(diagnosis), encoding="utf-8")
    return target, diagnosis


@pytest.fixture
def fresh(browser: Chromium, shown: tuple[Path, Diagnosis]) -> Iterator[Chromium]:
    """The page as a user finds it; whatever it writes to the console is an error, and it asks for nothing."""
    browser.size(1280, 900)
    browser.dark(False)
    browser.console.clear()
    browser.requests.clear()
    browser.open(shown[0])
    browser.settle()
    yield browser
    assert browser.console == []
    assert all(url.startswith(("file:", "data:")) for url in browser.requests)


def canvas(browser: Chromium, name: str) -> tuple[float, float, float, float]:
    """Left, top, width and height of a plot's canvas, scrolled into the middle of the screen, clear of the menu."""
    browser.run(f"document.querySelector('#{name} canvas').scrollIntoView({{block: 'center'}}); 0")
    return browser.box(f"#{name} canvas")


def picture(browser: Chromium, name: str) -> npt.NDArray[np.int64]:
    """What a plot shows, as colours (height, width, 3)."""
    left, top, width, height = canvas(browser, name)
    # A clip is taken from the page's own top, not from the screen's.
    scrolled = browser.run("scrollY")
    return browser.pixels(round(left), round(top + scrolled), round(width), round(height)).astype(np.int64)


def told(text: str, names: tuple[str, ...]) -> list[float]:
    """What a read-out says of each curve, in um."""
    found = [re.search(rf"{name} (\u2212?[\d.]+) µm", text) for name in names]
    return [float(one[1].replace("\u2212", "-")) for one in found if one is not None]


def painted(image: npt.NDArray[np.int64], colour: tuple[int, int, int]) -> npt.NDArray[np.bool_]:
    """Where an image has a colour, but for the edges of lines."""
    return np.asarray(np.max(np.abs(image - np.array(colour)), axis=2) <= 2)


def view(browser: Chromium, plot: str) -> dict[str, float]:
    found: dict[str, float] = browser.run(f"gearpoly.plots.{plot}.view")
    return found


def read_out(browser: Chromium, name: str) -> str:
    text: str = browser.run(f"document.querySelector('#{name} output').textContent")
    return text


def near(diagnosis: Diagnosis, deg: float) -> int:
    """The sample of recording 0 next to a driven angle."""
    return int(np.argmin(np.abs(diagnosis.comparison.aligned[0].theta_2 / DEG - deg)))


def test_every_plot_draws(fresh: Chromium) -> None:
    """All canvases show more than a handful of colours; both residuals are there by day."""
    for name in fresh.run("[...document.querySelectorAll('.plot')].map(e => e.id)"):
        image = picture(fresh, name)
        assert np.unique(image @ (1 << 16, 1 << 8, 1)).size > 8, name
    image = picture(fresh, "plot-residual")
    assert np.sum(painted(image, BEFORE)) > 1000
    assert np.sum(painted(image, AFTER)) > 1000
    fresh.run("scrollTo(0, 0)")
    fresh.screenshot(OUT / "verdict.png")
    fresh.dark(True)
    for name in ("plot-te", "map-driving-before", "pitch-driving"):
        fresh.run(f"document.getElementById('{name}').scrollIntoView(); 0")
        fresh.screenshot(OUT / f"{name}_dark.png")


@pytest.mark.long
def test_a_single_sample_shows_with_everything_in_view(fresh: Chromium, shown: tuple[Path, Diagnosis]) -> None:
    """The spike of one sample among thousands reaches its height on the screen: no level of detail loses it."""
    image = picture(fresh, "plot-residual")
    theta_2 = float(np.sort(shown[1].comparison.aligned[0].theta_2)[SPIKE]) / DEG
    x, y = fresh.run(f"[gearpoly.plots.residual.px({theta_2!r}), gearpoly.plots.residual.py({SPIKE_UM!r})]")
    # A line between two pixels is pale in both; the other curve is redder than blue, and axes are grey.
    around = (image[..., 2] - image[..., 0] > 30)[:, round(x) - 2 : round(x) + 4]
    # Its mean is taken off: below 0.1 um, a pixel.
    assert np.flatnonzero(np.any(around, axis=1))[0] == pytest.approx(y, abs=3.0)


@pytest.mark.long
def test_the_wheel_zooms_about_the_hand_and_both_curves_follow(fresh: Chromium) -> None:
    left, top, width, height = canvas(fresh, "plot-te")
    # The browser takes whole pixels.
    x, y = round(left + 0.4 * width), round(top + 0.5 * height)
    place = f"gearpoly.plots.te.x({x - left!r})"
    before, deg = view(fresh, "te"), fresh.run(place)
    for _ in range(6):
        fresh.mouse("mouseWheel", x, y, deltaX=0, deltaY=-240)
    fresh.settle()
    after = view(fresh, "te")
    assert (after["x1"] - after["x0"]) < 0.1 * (before["x1"] - before["x0"])
    assert [after["y0"], after["y1"]] == [before["y0"], before["y1"]]
    assert fresh.run(place) == pytest.approx(deg, abs=1e-6 * abs(deg))
    friend = view(fresh, "residual")
    assert [friend["x0"], friend["x1"]] == [after["x0"], after["x1"]]
    fresh.screenshot(OUT / "zoomed.png")
    fresh.mouse("mouseWheel", x, y, deltaX=0, deltaY=-240, modifiers=8)  # Shift
    fresh.settle()
    tall = view(fresh, "te")
    assert tall["y1"] - tall["y0"] < 0.8 * (after["y1"] - after["y0"])
    assert tall["x1"] - tall["x0"] == pytest.approx(after["x1"] - after["x0"])


@pytest.mark.long
def test_a_page_that_shows_everything_scrolls_on(fresh: Chromium) -> None:
    left, top, width, height = canvas(fresh, "plot-te")
    before = fresh.run("scrollY")
    fresh.mouse("mouseWheel", left + 0.5 * width, top + 0.5 * height, deltaX=0, deltaY=200)
    fresh.run("new Promise(done => setTimeout(() => done(0), 300))")
    assert fresh.run("scrollY") > before + 50


@pytest.mark.long
def test_a_drag_moves_and_a_double_click_shows_everything(fresh: Chromium) -> None:
    left, top, _, _ = canvas(fresh, "plot-residual")
    whole = view(fresh, "residual")
    fresh.run("gearpoly.plots.residual.zoom(0.1, 0.5); 0")
    before = view(fresh, "residual")
    fresh.drag((left + 500, top + 150), (left + 380, top + 120))
    after = view(fresh, "residual")
    inner = fresh.run("[gearpoly.plots.residual.inner.width, gearpoly.plots.residual.inner.height]")
    assert after["x0"] - before["x0"] == pytest.approx(120 / inner[0] * (before["x1"] - before["x0"]), rel=1e-6)
    assert after["y0"] - before["y0"] == pytest.approx(-30 / inner[1] * (before["y1"] - before["y0"]), rel=1e-6)
    for count in (1, 2):
        for kind in ("mousePressed", "mouseReleased"):
            fresh.mouse(kind, left + 300, top + 100, button="left", clickCount=count)
    fresh.settle()
    assert view(fresh, "residual") == whole


@pytest.mark.long
def test_the_read_out_is_the_sample_under_the_hand(fresh: Chromium, shown: tuple[Path, Diagnosis]) -> None:
    one = shown[1].comparison.aligned[0]
    left, top, width, height = canvas(fresh, "plot-te")
    fresh.mouse("mouseMoved", left + 0.31 * width, top + 0.5 * height)
    fresh.settle()
    deg = fresh.run(f"gearpoly.plots.te.x({0.31 * width!r})")
    k = near(shown[1], deg)
    values = (one.recorded[k], one.simulated[k], one.recorded[k] - shown[1].left[0][k])
    names = ("recorded", "simulated before", "simulated after")
    assert told(read_out(fresh, "plot-te").partition(": ")[2], names) == pytest.approx(
        np.array(values) / UM, abs=ROUNDED
    )
    mesh = round(one.theta_2[k] * 13 / (2.0 * np.pi))
    assert f"driving tooth {mesh % 11} on driven {mesh % 13}" in read_out(fresh, "plot-te")
    # The residual beside it reads at the same sample.
    residual = (one.residual[k] - np.mean(one.residual)) / UM
    assert told(read_out(fresh, "plot-residual"), ("before",)) == pytest.approx([residual], abs=ROUNDED)


@pytest.mark.long
def test_the_keyboard_zooms_moves_reads_and_resets(fresh: Chromium, shown: tuple[Path, Diagnosis]) -> None:
    canvas(fresh, "plot-residual")
    fresh.run("document.querySelector('#plot-residual canvas').focus(); 0")
    whole = view(fresh, "residual")
    for _ in range(12):
        fresh.key("+", text="+")
    near_ = view(fresh, "residual")
    assert near_["x1"] - near_["x0"] == pytest.approx(0.8**12 * (whole["x1"] - whole["x0"]))
    fresh.key("ArrowRight", code=39)
    assert view(fresh, "residual")["x0"] - near_["x0"] == pytest.approx(0.1 * (near_["x1"] - near_["x0"]))
    seen = []
    for _ in range(3):
        fresh.key(".", text=".")
        seen.append(fresh.run("gearpoly.plots.residual.cross.x"))
    samples = [near(shown[1], deg) for deg in seen]
    assert seen == sorted(seen) and len(set(samples)) == 3
    k = samples[-1]
    assert f"after {shown[1].left[0][k] / UM - np.mean(shown[1].left[0]) / UM:.3f} µm".replace(
        "-", "\u2212"
    ) in read_out(fresh, "plot-residual")
    before = view(fresh, "residual")
    fresh.key("f", text="f")
    fitted = view(fresh, "residual")
    assert fitted["y1"] - fitted["y0"] < before["y1"] - before["y0"]
    fresh.key("0", text="0")
    assert view(fresh, "residual") == whole


@pytest.mark.long
def test_a_curve_can_be_put_away(fresh: Chromium) -> None:
    fresh.press("#plot-residual button[data-curve=residual_before]")
    image = picture(fresh, "plot-residual")
    assert np.sum(painted(image, BEFORE)) == 0
    assert np.sum(painted(image, AFTER)) > 1000
    assert fresh.run("document.querySelector('[data-curve=residual_before]').getAttribute('aria-pressed')") == "false"
    fresh.press("#plot-residual button[data-curve=residual_before]")
    assert np.sum(painted(picture(fresh, "plot-residual"), BEFORE)) > 1000


@pytest.mark.long
def test_the_spectrum_names_the_missing_order(fresh: Chromium) -> None:
    """The largest line before is the driving shaft's first order; the read-out says so."""
    canvas(fresh, "plot-spectrum")
    fresh.run(
        "(() => { const { orders, spectrum } = gearpoly.recording(); const low = spectrum.before.levels[0].low;"
        " let best = 0; low.forEach((v, k) => { if (v > low[best]) best = k; });"
        " gearpoly.plots.spectrum.point(orders[best], 1); })()"
    )
    assert "(driving shaft order 1)" in read_out(fresh, "plot-spectrum")


@pytest.mark.long
def test_a_finding_is_one_click_away_from_its_place(fresh: Chromium) -> None:
    """The tooth's mesh in the middle of the curves, on each flank; the order in the spectrum."""
    for k, late in ((0, 0.0), (1, 0.5)):
        fresh.run(f"gearpoly.choose({k}); 0")
        fresh.press("#finding-2 button.show")
        shown_ = view(fresh, "te")
        pitch = 360.0 / 13.0
        middle = 0.5 * (shown_["x0"] + shown_["x1"]) / pitch - late
        assert round(middle + (1 if late else 0)) % 13 == 7
        assert middle == pytest.approx(round(middle), abs=1e-6)
        assert shown_["x1"] - shown_["x0"] == pytest.approx(4.0 * pitch)
        assert "on driven 7, phase" in read_out(fresh, "plot-te")
    fresh.press("#finding-1 button.show")
    assert "(driving shaft order 1)" in read_out(fresh, "plot-spectrum")
    fresh.press("#finding-3 button.show")
    assert "(driven shaft order 1)" in read_out(fresh, "plot-spectrum")


@pytest.mark.long
def test_maps_read_their_cells_and_change_their_scale(fresh: Chromium) -> None:
    left, top, _, _ = canvas(fresh, "map-driving-before")
    x, y = fresh.run("[gearpoly.plots.maps[0].px(0.28), gearpoly.plots.maps[0].py(4)]")
    fresh.mouse("mouseMoved", left + x, top + y)
    fresh.settle()
    # Cell 12 of 16 runs from 0.25 to 0.3125.
    value = fresh.run("gearpoly.recording().maps['driving-before'][4 * 16 + 12]")
    assert read_out(fresh, "map-driving-before").startswith(
        f"tooth 4, phase 0.25 to 0.31: {value:.3f} ± ".replace("-", "\u2212")
    )
    # The map of what is left reads at the same cell.
    assert read_out(fresh, "map-driving-after").startswith("tooth 4, phase 0.25 to 0.31: ")
    pale = picture(fresh, "map-driving-after")
    fresh.run("const s = document.getElementById('scale'); s.value = 'own'; s.dispatchEvent(new Event('change')); 0")
    strong = picture(fresh, "map-driving-after")
    # Inside the axes.
    inside = (slice(20, 270), slice(70, 540))
    assert np.mean(255 - strong[inside]) > 3.0 * np.mean(255 - pale[inside])
    fresh.mouse("mouseMoved", 2, 2)
    fresh.run("gearpoly.plots.maps[0].zoom(0.5, 0.5); 0")
    assert view(fresh, "maps[0]") == view(fresh, "maps[1]")


@pytest.mark.long
def test_another_recording_is_shown_on_request(fresh: Chromium, shown: tuple[Path, Diagnosis]) -> None:
    """The coast flank: its own curves, and driving tooth n on driven n + 1."""
    one = shown[1].comparison.aligned[1]
    fresh.run("const r = document.getElementById('recording'); r.value = '1'; r.dispatchEvent(new Event('change')); 0")
    home = view(fresh, "te")
    # Half a thousandth of a sample's spacing.
    spacing = float(np.ptp(one.theta_2)) / DEG / one.theta_2.size
    assert home["x0"] == pytest.approx(float(np.min(one.theta_2)) / DEG, abs=0.51e-3 * spacing)
    k = 400
    fresh.run(f"gearpoly.plots.te.point({float(one.theta_2[k]) / DEG!r}, 0); 0")
    mesh = round(one.theta_2[k] * 13 / (2.0 * np.pi) - 0.5)
    text = read_out(fresh, "plot-te")
    assert f"driving tooth {mesh % 11} on driven {(mesh + 1) % 13}" in text
    assert told(text, ("recorded",)) == pytest.approx([one.recorded[k] / UM], abs=ROUNDED)


@pytest.mark.long
def test_teeth_read_their_values(fresh: Chromium, shown: tuple[Path, Diagnosis]) -> None:
    built = shown[1].built[1].first
    canvas(fresh, "pitch-driven")
    fresh.run("gearpoly.plots.teeth[1].point(6.8, 0); 0")
    wish = f"tooth 7: {built.pitch[7]:.2f} ± {built.pitch_std[7]:.2f} µm".replace("-", "\u2212")
    assert read_out(fresh, "pitch-driven") == wish


@pytest.mark.long
def test_fingers_pinch_pan_and_tap_twice(fresh: Chromium) -> None:
    fresh.size(420, 900, touch=True)
    fresh.settle()
    left, top, width, height = canvas(fresh, "plot-te")
    x, y = left + 0.5 * width, top + 0.5 * height

    def touch(kind: str, *points: tuple[float, float]) -> None:
        fresh.send(
            "Input.dispatchTouchEvent",
            type=kind,
            touchPoints=[{"x": px, "y": py, "id": k} for k, (px, py) in enumerate(points)],
        )

    whole = view(fresh, "te")
    touch("touchStart", (x - 30, y), (x + 30, y))
    for reach in (45, 60, 90):
        touch("touchMove", (x - reach, y), (x + reach, y))
    touch("touchEnd")
    fresh.settle()
    pinched = view(fresh, "te")
    # 180 px for 60; fingers are taken one after the other.
    assert (whole["x1"] - whole["x0"]) / (pinched["x1"] - pinched["x0"]) == pytest.approx(3.0, rel=0.1)
    touch("touchStart", (x, y))
    for shift in (10, 25, 40):
        touch("touchMove", (x - shift, y))
    touch("touchEnd")
    fresh.settle()
    moved = view(fresh, "te")
    inner = fresh.run("gearpoly.plots.te.inner.width")
    # The browser keeps the first 15 px to see which way a finger goes.
    assert (moved["x0"] - pinched["x0"]) / (pinched["x1"] - pinched["x0"]) * inner == pytest.approx(40.0, abs=16.0)
    fresh.run("new Promise(done => setTimeout(() => done(0), 400))")
    for _ in range(2):
        touch("touchStart", (x, y))
        touch("touchEnd")
    fresh.settle()
    assert view(fresh, "te") == whole
    # Nothing stands out of a small screen but what scrolls by itself.
    assert fresh.run("document.documentElement.scrollWidth") <= 420
    fresh.screenshot(OUT / "phone.png")


@pytest.mark.long
def test_themes_repaint_the_plots(fresh: Chromium) -> None:
    day = picture(fresh, "plot-residual")
    fresh.run("const t = document.getElementById('theme'); t.value = 'dark'; t.dispatchEvent(new Event('change')); 0")
    night = picture(fresh, "plot-residual")
    assert np.mean(day) > 200.0 and np.mean(night) < 80.0


@pytest.mark.long
def test_every_control_has_a_name_and_the_keyboard_reaches_it(fresh: Chromium) -> None:
    nodes = fresh.send("Accessibility.getFullAXTree")["nodes"]
    roles = {"button", "combobox", "image", "img", "link", "DisclosureTriangle"}
    controls = [node for node in nodes if node.get("role", {}).get("value") in roles]
    assert len(controls) > 40
    assert [node for node in controls if not node.get("name", {}).get("value")] == []
    assert fresh.run("[...document.querySelectorAll('canvas, button, select, summary')].every(e => e.tabIndex >= 0)")


@pytest.mark.long
def test_on_a_phone_tables_fit_the_screen_and_say_what_each_number_is(fresh: Chromium) -> None:
    """Once their columns lay beyond the edge, where nobody looks."""
    fresh.size(390, 844, touch=True)
    fresh.settle()
    assert fresh.run("document.documentElement.scrollWidth") == 390
    script = (
        "[...document.querySelectorAll('.places td, .recordings td, .rms td, .values td')]"
        ".filter(one => one.offsetParent && one.getBoundingClientRect().right > innerWidth + 1)"
        ".map(one => one.closest('table').className + ': ' + one.textContent)"
    )
    assert fresh.run(script) == []
    # A cell's heading stands before it, as the table's own head does on a desk.
    script = "getComputedStyle(document.querySelector('.recordings td:nth-child(5)'), '::before').content"
    assert fresh.run(script) == '"samples"'
    fresh.screenshot(OUT / "phone.png")


@pytest.mark.long
def test_a_recording_of_a_million_samples_zooms_at_once(
    fresh: Chromium, shown: tuple[Path, Diagnosis], tmp_path: Path
) -> None:
    """Its curves come as least and greatest of stretches, which the page says and the read-out gives."""
    diagnosis = shown[1]
    one = diagnosis.comparison.aligned[0]
    size = 1_000_000
    theta_2 = np.linspace(0.0, 300.0, size)
    residual = np.random.default_rng(4).normal(0.0, 3e-4, size)
    residual[654_321] = 0.02
    long = replace(one, theta_2=theta_2, recorded=residual, residual=residual)
    target = tmp_path / "long.html"
    located = replace(diagnosis.comparison.located, noises=diagnosis.comparison.located.noises[:1])
    comparison = replace(diagnosis.comparison, aligned=(long,), located=located)
    target.write_text(page(replace(diagnosis, comparison=comparison, left=(residual,))), encoding="utf-8")
    fresh.open(target)
    fresh.settle()
    assert "from least to greatest of every" in fresh.run("document.getElementById('means').textContent")
    fresh.run(f"gearpoly.plots.residual.point({float(theta_2[654_321]) / DEG!r}, 0); 0")
    assert "to 20.000 µm" in read_out(fresh, "plot-residual") or "to 19.999 µm" in read_out(fresh, "plot-residual")
    image = picture(fresh, "plot-residual")
    assert np.sum(painted(image, AFTER)) > 1000
