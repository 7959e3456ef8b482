"""A diagnosis as a page: it says what was diagnosed, whatever files are called, and loads nothing from outside."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import lxml.html
import numpy as np
import pytest

from gearpoly.compare.entries import chance_words
from gearpoly.diagnose.heldout import repeatable
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.page.pack import unpacked
from gearpoly.page.typeset import typeset
from gearpoly.report.diagnosis_data import CURVE_VALUES, curves, places, shares, spectrum
from gearpoly.report.diagnosis_page import page
from gearpoly.report.diagnosis_report import how_sure, verdict_json
from gearpoly.report.diagnosis_words import MINUS, capital, chance, large, measured, number, parameter
from gearpoly.units import DEG, UM, FloatArray
from tests.made_diagnosis import E_UM, FILE, NAME, REMARK, made_comparison, made_diagnosis

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def diagnosis() -> Diagnosis:
    return made_diagnosis(*made_comparison())


@pytest.fixture(scope="module")
def text(diagnosis: Diagnosis) -> str:
    return page(diagnosis)


@pytest.fixture(scope="module")
def tree(text: str) -> Any:
    return lxml.html.document_fromstring(text)


def data_of(text: str) -> dict[str, Any]:
    """The data of a page, as a browser finds it."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    data: dict[str, Any] = json.loads(found[1])
    return data


def words(element: Any) -> str:
    return " ".join(element.text_content().split())


def whole(pack: dict[str, Any]) -> FloatArray:
    """A curve that the page holds sample by sample."""
    assert pack["high"] is None
    return unpacked(pack["low"]).astype(np.float64)


def placed(pack: dict[str, Any]) -> FloatArray:
    """Places as the page's scripts rebuild them."""
    line = np.linspace(pack["first"], pack["last"], pack["size"])
    return np.asarray(line if pack["rest"] is None else line + unpacked(pack["rest"]).astype(np.float64))


@pytest.mark.long
def test_every_element_that_opens_closes_and_no_id_stands_twice(text: str, tree: Any) -> None:
    markup = re.sub(r"<(script|style)\b[^>]*>.*?</\1>", "", text, flags=re.DOTALL)
    void = {"meta", "link", "br", "img", "input"}
    opened: list[str] = []
    for closing, name in re.findall(r"<(/?)([a-z][a-z0-9]*)\b[^>]*>", markup):
        if name in void:
            continue
        if closing:
            assert opened.pop() == name
        else:
            opened.append(name)
    assert opened == []
    ids = tree.xpath("//@id")
    assert len(ids) == len(set(ids))
    for target in [*tree.xpath("//a/@href"), *(f"#{name}" for name in tree.xpath("//@aria-labelledby | //label/@for"))]:
        assert target[1:] in ids


def test_nothing_comes_from_outside(text: str, tree: Any) -> None:
    assert re.findall(r"\b(?:https?|ftp|wss?)://", text) == []
    assert "@import" not in text
    assert re.findall(r"url\((?!data:)", text) == []
    for link in tree.xpath("//@src | //link/@href | //a/@href | //form/@action"):
        assert link.startswith(("#", "data:"))
    assert "default-src 'none'" in tree.xpath("//meta[@http-equiv]/@content")[0]


def test_names_from_files_stay_text(text: str, tree: Any) -> None:
    """A pair, a file, a remark and an entry that hold HTML and even a placeholder."""
    assert words(tree.xpath("//h1")[0]) == NAME
    assert tree.xpath("//title")[0].text.startswith(NAME)
    assert text.count("</script>") == text.count("<script") == 2
    assert tree.xpath("//img") == tree.xpath("//ghost") == tree.xpath("//i[text()='marks']") == []
    assert f"0: 0_{FILE}" in words(tree.xpath("//table[@class='recordings']")[0])
    assert REMARK[1:] in words(tree.get_element_by_id("limits"))
    assert "or a <ghost> order" in words(tree.get_element_by_id("unexplained"))
    assert [one["label"].startswith(f"{k}: {k}_{FILE} (") for k, one in enumerate(data_of(text)["recordings"])] == [
        True,
        True,
    ]


def test_the_verdict_and_its_figures_are_the_diagnosis(diagnosis: Diagnosis, tree: Any) -> None:
    top = tree.get_element_by_id("verdict")
    assert words(top.find_class("chip")[0]).endswith("partly explained")
    assert [words(a) for a in top.xpath(".//ol/li/a")] == [typeset(one.says) for one in diagnosis.findings]
    shown = {words(div.find("dt")): words(div.find("dd")) for div in top.xpath(".//dl/div")}
    before = math.sqrt(diagnosis.before.unseen**2 - diagnosis.noise**2) / UM
    after = math.sqrt(diagnosis.after.unseen**2 - diagnosis.noise**2) / UM
    assert shown["repeatable mismatch before"] == f"{before:.3f} µm"
    assert shown["after, on data the fit never saw"] == f"{after:.3f} µm"
    assert shown["noise floor"] == f"{diagnosis.noise / UM:.3f} µm rms"


def test_every_finding_says_where_what_how_sure_what_else_and_what_next(diagnosis: Diagnosis, tree: Any) -> None:
    for n, one in enumerate(diagnosis.findings, 1):
        article = tree.get_element_by_id(f"finding-{n}")
        parts = {words(div.find("dt")): div.find("dd") for div in article.xpath("./dl/div")}
        assert words(parts["Model"]) == " ".join(one.claim.physics.equation.split())
        keys = [words(cell) for cell in parts["Values"].xpath(".//tbody/tr/td[last()]")]
        assert keys == list(one.parameters)
        for cell, (value, std) in zip(parts["Values"].xpath(".//tbody/tr/td[1]"), one.parameters.values(), strict=True):
            figures = [float(x) for x in re.findall(r"[\d.]+", words(cell))]
            # Two figures of the error are shown: half of the last one may be lost.
            assert figures == pytest.approx([value, std], abs=0.05 * std)
        assert capital(how_sure(one)) in words(parts["How sure"])
        for rival in one.rivals:
            assert chance_words(rival.probability) in words(parts["What else it could be"])
        assert " ".join(large(one.gain).split()) in words(parts["How sure"])
        rows = [[words(cell) for cell in row] for row in parts["Before and after"].xpath(".//tbody/tr")]
        for row, rms in zip(rows, (one.without, one.with_), strict=True):
            assert float(row[2]) == pytest.approx(repeatable(rms.unseen, diagnosis.noise) / UM, abs=5.1e-4)
            assert float(row[3]) == pytest.approx(rms.unseen / UM, abs=5.1e-5)
            assert float(row[4]) == pytest.approx(rms.unseen / diagnosis.noise, abs=5.1e-4)
    first, tooth, chain = (tree.get_element_by_id(f"finding-{n}") for n in (1, 2, 3))
    assert "128.1 µrad" in words(first)
    assert "Record the coast flank at 1 N·m. Separability would be 0.68, and is 0.03 now" in words(first)
    assert "one tooth whose number is open" in words(tooth) and "203.1°" in words(tooth)
    assert "Nothing else in the catalogue does the same" in words(chain)
    assert "Measuring chain, driven shaft" in words(chain)


def test_bars_stand_for_the_repeatable_part_against_the_noise(diagnosis: Diagnosis, tree: Any) -> None:
    """Both on one scale: their widths are as the figures beside them."""
    for block in (tree.get_element_by_id("fit"), tree.get_element_by_id("finding-2")):
        for row in block.xpath(".//table[@class='rms']/tbody/tr"):
            bar = row.xpath(".//span[@class='bar']")[0]
            width, floor = (float(re.findall(r"[\d.]+%", e.get("style"))[0][:-1]) for e in bar)
            part = float(words(row[2]))
            # Widths have two decimals, figures three: 0.0005 um of a bar 0.3 um long at least.
            assert width / floor == pytest.approx(part / (diagnosis.noise / UM), abs=3e-3)


def test_the_page_says_below_what_a_repeatable_part_is_none(diagnosis: Diagnosis, tree: Any) -> None:
    """A noise level too low by its standard error makes an rms of pure noise look repeatable by as much."""
    levels = [noise.level_std for noise in diagnosis.comparison.located.noises]
    std = math.hypot(*levels) / len(levels)
    made = repeatable(diagnosis.noise, diagnosis.noise - std)
    shown = re.search(r"below ([\d.]+) µm it cannot be told", words(tree.get_element_by_id("fit")))
    assert shown is not None
    # The root of 2 noise std leaves std / 4 noise of it: below 1 %.
    assert float(shown[1]) == pytest.approx(made / UM, rel=0.01, abs=5e-4)


def test_curves_in_the_page_are_the_recordings_sample_by_sample(diagnosis: Diagnosis, text: str) -> None:
    recordings = data_of(text)["recordings"]
    given = zip(diagnosis.comparison.aligned, diagnosis.left, diagnosis.noise_by_recording, recordings, strict=True)
    for one, left, noise, raw in given:
        shown = raw["curves"]
        order = np.argsort(one.theta_2, kind="stable")
        x = one.theta_2[order] / DEG
        # Half a thousandth of a sample's spacing.
        assert np.allclose(placed(shown["x"]), x, rtol=0.0, atol=0.51e-3 * np.ptp(x) / x.size)
        for name, values in (
            ("recorded", one.recorded),
            ("simulated_before", one.simulated),
            ("simulated_after", one.recorded - left),
            ("residual_before", one.residual - np.mean(one.residual)),
            ("residual_after", left),
        ):
            # Half of a thirtieth of the noise floor, which is what rounding may take.
            assert np.allclose(whole(shown[name]), values[order] / UM, rtol=0.0, atol=noise / UM / 60.0)


def test_a_long_recording_is_thinned_without_losing_a_peak(diagnosis: Diagnosis) -> None:
    one = diagnosis.comparison.aligned[0]
    size = one.residual.size
    left = np.zeros(size)
    left[1234], left[2001] = 1.0, -2.0
    raw = curves(one, left, points=400, noise=0.0)
    low, high = (unpacked(raw["residual_after"][side]) for side in ("low", "high"))
    assert low.size == high.size == placed(raw["x"]).size == 200
    mean = float(np.mean(left)) / UM
    assert np.max(high) == pytest.approx(1000.0 - mean, rel=1e-6)
    assert np.min(low) == pytest.approx(-2000.0 - mean, rel=1e-6)
    at = placed(raw["x"])[int(np.argmax(high))]
    # Within its stretch.
    assert abs(at - one.theta_2[1234] / DEG) <= np.ptp(one.theta_2) / DEG / 200


def test_long_recordings_share_what_short_ones_leave() -> None:
    assert shares([18_000] * 3, CURVE_VALUES) == [18_000] * 3
    assert shares([1000, 10**6, 10**7], 61_000) == [1000, 30_000, 30_000]
    assert sum(shares([10**5] * 50, CURVE_VALUES)) <= CURVE_VALUES


def test_places_survive_rounding_however_far_they_go() -> None:
    """A million degrees, unevenly sampled by 1 deg."""
    x = 1e6 + np.cumsum(np.random.default_rng(1).uniform(0.5, 1.5, 5000))
    assert np.allclose(placed(places(x, 5000)), x, rtol=0.0, atol=0.51e-3)


@pytest.mark.long
def test_three_recordings_of_18_000_samples_stay_below_900_kb(diagnosis: Diagnosis) -> None:
    """And so does any longer set."""
    one = diagnosis.comparison.aligned[0]
    for size, count in ((18_000, 3), (100_000, 4)):
        more = np.arange(size)
        theta_2 = np.linspace(one.theta_2[0], one.theta_2[-1] * 9.0, size)
        rng = np.random.default_rng(2)
        residual = rng.normal(0.0, 1e-3, size)
        long = replace(one, theta_2=theta_2, recorded=residual + 1e-3 * np.sin(theta_2), residual=residual)
        comparison = replace(
            diagnosis.comparison,
            aligned=(long,) * count,
            located=replace(diagnosis.comparison.located, noises=(diagnosis.comparison.located.noises[0],) * count),
        )
        large = replace(
            diagnosis, comparison=comparison, left=(residual[more],) * count, noise_by_recording=(3e-4,) * count
        )
        text = page(large)
        assert len(text.encode()) < 0.9e6
        if size == 18_000:
            assert all(raw["curves"]["per_stretch"] == 1 for raw in data_of(text)["recordings"])


def test_a_wave_has_its_amplitude_in_the_spectrum() -> None:
    """Between two places of the grid, unevenly sampled as encoders are, beside a slow wave ten times as strong."""
    rng = np.random.default_rng(3)
    u = (np.arange(9000) + rng.uniform(-0.3, 0.3, 9000)) / 30.0
    values = 2.0 * np.cos(2.0 * np.pi * 1.2345 * u + 0.3) + 20.0 * np.cos(2.0 * np.pi * 0.05 * u)
    frequency, amplitude = spectrum(u, values, top=4.0)
    near = np.abs(frequency - 1.2345) < 0.05
    peak = int(np.argmax(np.where(near, amplitude, 0.0)))
    # Half a place of the grid, 1/600 of a cycle per mesh; it costs a Hann window's peak 4 %.
    assert frequency[peak] == pytest.approx(1.2345, abs=1.0 / 1200.0)
    assert amplitude[peak] == pytest.approx(2.0, rel=0.05)
    # Ten places away the window leaves 0.1 % of a line; uneven steps scatter some more of the strong one.
    assert np.max(amplitude[(frequency > 0.1) & (np.abs(frequency - 1.2345) > 0.02)]) < 0.1


def test_the_map_of_the_missing_gear_shows_its_wave_and_after_it_nothing(diagnosis: Diagnosis, text: str) -> None:
    """The driving gear's eccentricity, on both flanks, in its own rows; noise only once it is taken off."""
    for raw in data_of(text)["recordings"]:
        before, after = (unpacked(raw["maps"][when]["driving"]) for when in ("before", "after"))
        z = before.shape[0]
        assert z == 11
        mean = np.mean(before, axis=1)
        line = np.abs(np.fft.rfft(mean))[1] * 2.0 / z
        # The mean over one pitch blunts a wave of one turn by sinc(1/11): 1.4 %; noise adds 0.02 um.
        assert line == pytest.approx(E_UM, rel=0.03)
        std = raw["maps"]["after"]["std"][0]
        # 11 x 16 cells: the largest of them exceeds 4.5 errors once in 800 pages.
        assert np.max(np.abs(after)) < 4.5 * std
        assert np.max(np.abs(unpacked(raw["maps"]["before"]["driven"]))) < 0.2 * E_UM


def test_rows_of_the_maps_are_teeth_of_the_recorded_flank(diagnosis: Diagnosis) -> None:
    """Planted: whatever driven tooth 5 touches within half a pitch of its pitch point is 3 um high. The coast flank's
    turn comes half a pitch later, on driving tooth 4."""
    from gearpoly.report.diagnosis_data import maps

    located = diagnosis.comparison.located
    for one, noise in zip(diagnosis.comparison.aligned, located.noises, strict=True):
        late = 0.5 if one.flank == "coast" else 0.0
        mesh = np.round(one.theta_2 * (13 / (2.0 * np.pi)) - late).astype(int)
        driven = (mesh + (1 if one.flank == "coast" else 0)) % 13
        made = maps(replace(one, residual=np.where(driven == 5, 3.0 * UM, 0.0)), one.residual, noise, z=(11, 13))
        rows = np.mean(unpacked(made["before"]["driven"]), axis=1)
        # The mean tooth has a thirteenth of it.
        assert rows[5] - np.mean(np.delete(rows, 5)) == pytest.approx(3.0, abs=0.05)


def test_teeth_in_the_page_are_the_built_ones(diagnosis: Diagnosis, text: str, tree: Any) -> None:
    for gear, raw, name in zip(diagnosis.built, data_of(text)["built"], ("driving", "driven"), strict=True):
        for key, values in (
            ("pitch", gear.first.pitch), ("pitch_std", gear.first.pitch_std),
            ("slope", gear.first.slope), ("slope_std", gear.first.slope_std),
        ):  # fmt: skip
            assert np.array_equal(unpacked(raw[key]), values)
        details = tree.xpath(f"//details[contains(summary, 'Teeth of the {name} gear')]")[0]
        rows = details.xpath(".//tbody/tr")
        assert len(rows) == gear.first.pitch.size
        for at, one in ((1, gear.first), (3, gear.coast)):
            assert words(rows[3][at]) == measured(float(one.pitch[3]), float(one.pitch_std[3]))
            assert words(rows[3][at + 1]) == measured(float(one.slope[3]), float(one.slope_std[3]))
    assert [raw["marked"] for raw in data_of(text)["built"]] == [[], [7]]
    as_built = words(tree.get_element_by_id("as-built"))
    assert "driving gear as it runs fits ISO 1328-1 grade 6 (2013)" in as_built
    assert "driven gear as it runs fits no ISO 1328-1 grade" in as_built
    assert "1.080 ± 0.021" in as_built


def test_recordings_zeros_limits_and_times_are_told(diagnosis: Diagnosis, tree: Any) -> None:
    rows = tree.xpath("//table[@class='recordings']/tbody/tr")
    for k, (one, row) in enumerate(zip(diagnosis.comparison.aligned, rows, strict=True)):
        cells = [words(cell) for cell in row]
        assert cells[1] == one.flank
        assert int(cells[4]) == one.theta_2.size
        assert float(cells[7]) == pytest.approx(one.rms / UM, abs=5.1e-4)
        assert float(cells[8]) == pytest.approx(float(np.std(diagnosis.left[k])) / UM, abs=5.1e-5)
    zeros = [words(cell) for cell in tree.xpath("//table[@class='zeros']/tbody/tr")[0]]
    alignment = diagnosis.comparison.alignment
    assert alignment.zeros.driving is not None
    assert float(zeros[1].split()[0]) == pytest.approx(
        alignment.zeros.driving / DEG % 360.0, abs=alignment.std_driving / DEG
    )
    assert "made at <one> speed" in words(tree.get_element_by_id("limits"))
    assert "31.4" in words(tree.xpath("//table[@class='times']")[0])


def test_a_pair_that_lacks_nothing_says_so(diagnosis: Diagnosis) -> None:
    tree = lxml.html.document_fromstring(
        page(replace(diagnosis, status="nothing_missing", findings=(), unexplained=(), not_excluded=(), remarks=(),
                     seconds=(), compliance_scale=None))
    )  # fmt: skip
    assert "No physics of the catalogue is missing" in words(tree.get_element_by_id("verdict"))
    assert "makes no missing physics necessary" in words(tree.get_element_by_id("findings"))
    assert "Nothing is left" in words(tree.get_element_by_id("unexplained"))


@pytest.mark.parametrize(("value", "std", "wish"), [
    (6.0048, 0.0312, "6.005 ± 0.031"), (-0.00123, 0.00045, f"{MINUS}0.00123 ± 0.00045"), (1234.5, 120.0, "1234 ± 120"),
    (2.0, 0.0, "2.000"), (1.0, 7.6e-133, "1.000"), (0.0, 0.0, "0.000"), (-0.0001, 0.02, "0.000 ± 0.020"),
    (5.0, math.nan, "5.000"),
])  # fmt: skip
def test_figures_have_the_digits_of_their_error(value: float, std: float, wish: str) -> None:
    assert measured(value, std) == wish


@pytest.mark.parametrize(("p", "wish"), [
    (0.0, "below 10⁻³⁰⁰"), (1e-305, "below 10⁻³⁰⁰"), (3.2e-9, "3·10⁻⁹"), (9.7e-5, "1·10⁻⁴"), (0.0123, "0.012"),
    (1.0, "1"),
])  # fmt: skip
def test_chances_are_powers_of_ten_where_nobody_can_picture_them(p: float, wish: str) -> None:
    assert chance(p) == wish


def test_parameters_have_names_and_units() -> None:
    assert parameter("compliance_um_per_n", 0.0123, 0.0004) == ("compliance", "(0.01230 ± 0.00040) µm/N")
    assert parameter("compliance_urad_per_nm", 2.0, 0.1) == ("compliance", "(2.00 ± 0.10) µrad/(N·m)")
    assert parameter("order", 61.0000001, 0.0) == ("order", "61")
    assert parameter("damping_ratio", 0.05, 0.01) == ("damping ratio", "0.050 ± 0.010")
    assert parameter("angle_deg", 40.0, 0.31) == ("angle", "(40.00 ± 0.31)°")
    assert number(None, 2) == "\u2013"
    assert [large(x) for x in (12.34, 944.5, -1234567.8)] == ["12.3", "944", f"{MINUS}1\u202f234\u202f568"]


def test_sentences_are_set_with_the_units_of_print() -> None:
    assert typeset("It runs 6.0 um off, 3 urad, at 2 N.m, 1 +- 2") == "It runs 6.0 µm off, 3 µrad, at 2 N·m, 1 ± 2"
    assert typeset("um.csv holds gums") == "um.csv holds gums"


def themes(part: str) -> list[dict[str, str]]:
    """The colours of a style sheet: by day, by night as the system says, by night as the user says."""
    sheet = (ROOT / "gearpoly" / part / "page" / "style.css").read_text(encoding="utf-8")
    return [
        dict(re.findall(r"(--[a-z-]+):\s*([^;]+);", block)) for block in re.findall(r"\{([^{}]*--bg:[^{}]*)\}", sheet)
    ]


def test_the_page_has_the_colours_of_the_contact_debugger() -> None:
    """One look: names that both style sheets have stand for the same colours, by day and by night. A recorded curve
    is grey here, since it stands beside two others."""
    for view, report in zip(themes("view"), themes("report"), strict=True):
        shared = (view.keys() & report.keys()) - {"--recorded"}
        assert {"--bg", "--ink", "--driving", "--driven", "--accent"} <= shared
        assert {name: view[name] for name in shared} == {name: report[name] for name in shared}


def linear(colour: str) -> FloatArray:
    """Linear RGB (3,) of #rrggbb (IEC 61966-2-1)."""
    srgb = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def contrast(a: str, b: str) -> float:
    """Contrast ratio of two colours (WCAG 2.1, relative luminance)."""
    high, low = sorted((float(linear(c) @ [0.2126, 0.7152, 0.0722]) for c in (a, b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


SIGHT = {
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    "full": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
}
"""How others see linear RGB (Machado, Oliveira and Fernandes 2009, severity 1)."""


def lab(rgb: FloatArray) -> FloatArray:
    """CIE 1976 L*a*b* (3,) of linear sRGB, white D65."""
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    t = to_xyz @ np.clip(rgb, 0.0, 1.0) / [0.9505, 1.0, 1.089]
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


def test_words_and_curves_stand_out_by_day_and_by_night() -> None:
    """WCAG 2.1: 4.5 for words, 3 for graphics."""
    for colours in themes("report"):
        for name in ("--ink", "--muted", "--accent", "--good", "--warn"):
            assert contrast(colours[name], colours["--panel"]) >= 4.5, name
        for name in ("--recorded", "--before", "--after", "--noise", "--driving", "--driven", "--cursor"):
            assert contrast(colours[name], colours["--stage"]) >= 3.0, name


@pytest.mark.parametrize("sight", SIGHT)
def test_what_must_be_told_apart_is_whatever_the_eye(sight: str) -> None:
    """Curves of one plot, and both ends and the middle of a map: 20 in L*a*b*, where 2.3 can just be told."""
    for colours in themes("report"):
        for group in (
            ("--before", "--after"), ("--recorded", "--after"), ("--recorded", "--before"),
            ("--map-low", "--map-high"), ("--map-low", "--map-mid"), ("--map-mid", "--map-high"),
        ):  # fmt: skip
            a, b = (lab(np.array(SIGHT[sight]) @ linear(colours[name])) for name in group)
            assert np.linalg.norm(a - b) > 20.0, group


def test_where_the_numbering_is_open_no_rival_has_a_number(diagnosis: Diagnosis, text: str) -> None:
    """A rival on the coast flank says so, with the angle at which its tooth passes and without a number."""
    (rival,) = verdict_json(diagnosis)["missing"][1]["indistinguishable_from"]
    assert rival == {
        "physics": "tooth_pitch", "gear": "driving", "tooth": None, "encoder_deg": 17.2, "flank": "coast",
        "parameters": {"deviation_um": {"value": -3.4}}, "probability": 0.26,
    }  # fmt: skip
    assert "(driving, coast flank)" in text
    assert not re.search(r"[Tt]ooth 4\b", text)
