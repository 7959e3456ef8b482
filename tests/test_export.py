"""Drawings: what other libraries read back is the gear, magnification is exact, and bad wishes leave no file."""

from __future__ import annotations

import csv
import json
import math
from functools import cache
from pathlib import Path

import ezdxf
import ezdxf.path
import numpy as np
import numpy.typing as npt
import pytest
import shapely
import svgpathtools
from lxml import etree
from typer.testing import CliRunner

from gearpoly import api
from gearpoly.cli import app
from gearpoly.errors import GearpolyError, InputFileError, OutOfRangeError
from gearpoly.export.curves import bulges, spline
from gearpoly.export.drawing import Drawing, Request
from gearpoly.export.formats import formats
from gearpoly.export.outline import Detail
from gearpoly.export.reference import line_of_action
from gearpoly.gear.gear import Gear
from gearpoly.units import DEG, UM

ROOT = Path(__file__).parents[1]
GRADED = ROOT / "data" / "pairs" / "graded_18_25.toml"

AREA = 1e-6
"""Relative: what is promised of outlines read back; text holds coordinates to 1e-8 mm, far finer."""


FINE = 4e-6
"""mm. Chord error of the drawings that others are held against."""


@pytest.fixture(scope="module")
def pair() -> api.Pair:
    return api.load(GRADED, seed=3)


@pytest.fixture(scope="module")
def ideal() -> api.Pair:
    return api.load(ROOT / "data" / "pairs" / "ideal_18_25.toml")


def area(points: npt.ArrayLike) -> float:
    x, y = np.asarray(points, dtype=float).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


@cache
def fine(pair: api.Pair) -> Drawing:
    """The same gears with chords of 4 nm: what the drawn outlines have to stay near to."""
    return pair.drawing(Request(detail=Detail(chord=FINE)))


# The outline itself.


@pytest.mark.long
def test_outline_is_the_polygon_that_the_kernel_draws(pair: api.Pair) -> None:
    # Two constructions of root and lands. The kernel draws root, tip and bore to 0.05 um: over a perimeter of 180 mm,
    # 1e-5 of the area.
    for gear, drawn in zip((pair.driving, pair.driven), fine(pair).gears, strict=True):
        assert drawn.polygon.area == pytest.approx(gear.polygon.area, rel=1e-5)
        assert drawn.polygon.is_valid and drawn.outline.ring.shape[0] > 2000


def test_measured_chord_error_is_that_of_the_closed_form_on_ideal_involutes(ideal: api.Pair) -> None:
    for points in (20, 40, 80):
        for gear in ideal.drawing(Request(detail=Detail(points=points))).gears:
            # h^2/(8 rho) is the first term in h; near the base circle rho changes along a chord, at 20 points by 5 %.
            closed = gear.outline.flanks.chord_error
            assert gear.outline.flank_error == pytest.approx(closed, rel=0.3 if points == 20 else 0.15)


@pytest.mark.long
@pytest.mark.parametrize("chord_um", [2.0, 0.2, 0.02])
def test_no_point_of_the_true_outline_is_farther_than_the_stated_error(pair: api.Pair, chord_um: float) -> None:
    drawing = pair.drawing(Request(detail=Detail(chord=chord_um * UM)))
    assert drawing.chord_error <= chord_um * UM
    for drawn, true in zip(drawing.gears, fine(pair).gears, strict=True):
        # The detail changes by nanometres where the gears touch, so both are seen in their own frame.
        ring = shapely.LinearRing(drawn.outline.ring)
        off = shapely.distance(shapely.points(true.outline.ring[::23]), ring)
        # 1 nm is the fine drawing's own chord error.
        assert float(np.max(off)) <= drawing.chord_error + FINE


def test_default_detail_is_five_hundred_thousandths_of_the_module(pair: api.Pair) -> None:
    assert pair.drawing().chord_error <= 5e-5 * 2.0


def test_scattered_profiles_get_a_bounded_number_of_points_and_the_honest_error() -> None:
    scattered = api.load(ROOT / "data" / "pairs" / "paper_18_25.toml")
    drawing = scattered.drawing()
    assert drawing.statement()["points_per_flank"] == 500
    # Each point is 3 um away from its neighbours: chords cannot do better than that scatter.
    assert 0.5 * UM < drawing.chord_error < 10.0 * UM


def test_detail_that_corners_do_not_allow_is_refused(pair: api.Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearpoly.export.outline.MOST_POINTS_PER_FLANK", 200)
    with pytest.raises(OutOfRangeError, match="cannot be reached: with 200 points"):
        pair.drawing(Request(detail=Detail(chord=1e-6)))


@pytest.mark.parametrize("z", [8, 13, 60, 200])
@pytest.mark.parametrize("x", [0.0, 0.4])
def test_all_sizes_have_a_valid_outline_and_the_tips_on_the_tip_circle(z: int, x: float) -> None:
    gear = {"teeth": z, "module_mm": 1.5, "profile_shift": x}
    drawing = api.Pair.of({"driving": gear, "driven": gear}).drawing(Request(apart=True, detail=Detail(points=12)))
    for drawn in drawing.gears:
        nominal: Gear = drawn.mounted.gear
        radius = np.hypot(*drawn.outline.ring.T)
        # 1e-12 of a radius is a thousand roundings.
        assert np.max(radius) == pytest.approx(nominal.r_a, rel=1e-12)
        assert np.min(radius) >= nominal.r_f * (1.0 - 1e-12)
        assert drawn.polygon.is_valid
        assert sum(part.kind == "tip" for part in drawn.outline.parts) == z
    low, high = (gear.polygon for gear in drawing.gears)
    # Two modules between the tip circles; a tooth that faces a space adds part of the tooth height.
    assert 2.0 * 1.5 - 1e-9 <= low.distance(high) < 3.5 * 1.5


# In mesh.


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("detail", [Detail(), Detail(points=8), Detail(chord=5.0 * UM)])
def test_gears_in_mesh_touch_and_do_not_overlap(pair: api.Pair, flank: api.Flank, detail: Detail) -> None:
    drawing = pair.drawing(Request(at=0.3, flank=flank, detail=detail))
    low, high = (gear.polygon for gear in drawing.gears)
    # The kernel certifies to 2.5e-13 rad, 1e-11 mm; rotating coordinates of 40 mm rounds to 1e-14.
    assert low.distance(high) < 1e-9
    assert low.intersection(high).area < 1e-9


@pytest.mark.long
def test_drawn_angles_are_those_of_the_simulation(pair: api.Pair) -> None:
    drawing = pair.drawing(Request(at=0.3, detail=Detail(chord=1e-6)))
    te = pair.transmission_error(0.3)[0]
    # Both chord errors together, 2 nm, as an angle.
    assert drawing.theta_1 == pytest.approx((0.3 - te) / pair.mesh.ratio, abs=2e-6 / pair.mesh.r_b1)


@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_line_of_action_runs_through_the_contact_along_its_normal(ideal: api.Pair, flank: api.Flank) -> None:
    drawing = ideal.drawing(Request(at=0.05, flank=flank, detail=Detail(chord=1e-6)))
    ends, found = line_of_action(drawing), drawing.contacts
    assert ends is not None and found is not None
    along = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
    for point, normal in zip(found.point, found.normal, strict=True):
        # Ideal gears at their tight distance: chords of 1 nm move a contact by the width of one chord, 4 um across.
        offset = point - ends[0]
        assert abs(offset[0] * along[1] - offset[1] * along[0]) < 0.01
        assert float(normal @ along) == pytest.approx(1.0, abs=1e-3)
    for end, centre, radius in ((ends[0], 0.0, ideal.mesh.r_b1), (ends[1], ideal.mesh.a, ideal.mesh.r_b2)):
        assert math.hypot(end[0] - centre, end[1]) == pytest.approx(radius, rel=1e-12)


# Magnified.


def known_pair() -> api.Pair:
    gear = {"teeth": 20, "module_mm": 2.0, "inspection": {"pitch_um": 1.5, "profile_slope_um": 2.0}}
    return api.Pair.of({"driving": gear, "driven": {"teeth": 30, "module_mm": 2.0}})


@pytest.mark.parametrize("K", [0.0, 1.0, 20.0, 100.0])
def test_magnified_flanks_stand_off_k_times_along_the_normal(K: float) -> None:
    drawing = known_pair().drawing(Request(which="driving", magnify=K, detail=Detail(points=30)))
    flanks = drawing.gears[0].outline.flanks
    gear, first = flanks.gear, flanks.root.n - 1
    L = np.sqrt(flanks.r[first:] ** 2 - gear.r_b**2)
    # The point on the base tangent of roll length l, l + d off its foot: its polar angle gives l back.
    l = gear.r_b * (gear.psi_b + np.arctan(L / gear.r_b) - flanks.psi_drive[3, first:])
    wanted = K * (1.5 + 2.0 * (flanks.span.u(l) - 0.5)) * UM
    inside = l <= gear.l_a  # beyond the tip a magnified flank goes straight on
    # The points are found to 1e-15 of 10 mm, times a lever of 10.
    np.testing.assert_allclose((L - l)[inside], wanted[inside], atol=1e-12)


def test_magnified_zero_times_is_the_ideal_gear(pair: api.Pair, ideal: api.Pair) -> None:
    flat = pair.drawing(Request(which="driving", magnify=0.0, detail=Detail(points=40))).gears[0].outline.flanks
    same = ideal.drawing(Request(which="driving", detail=Detail(points=40))).gears[0].outline.flanks
    np.testing.assert_allclose(flat.psi_drive, same.psi_drive, atol=1e-14)  # rounding of angles below 1


@pytest.mark.long
def test_crossing_teeth_are_refused_with_the_magnification_from_which_they_cross(pair: api.Pair) -> None:
    detail = Detail(points=200)  # the search draws the gears a dozen times
    with pytest.raises(InputFileError, match=r"teeth cross.*from (\d+\.?\d*) on") as refused:
        pair.drawing(Request(apart=True, magnify=5000.0, detail=detail))
    most = float(str(refused.value).rpartition("from ")[2].split()[0])
    assert 5.0 < most < 100.0
    pair.drawing(Request(apart=True, magnify=most, detail=detail))
    with pytest.raises(InputFileError):
        # The onset is searched to 1e-3 and stated rounded down to three digits.
        pair.drawing(Request(apart=True, magnify=1.02 * most, detail=detail))


@pytest.mark.long
def test_magnified_gears_that_jam_are_refused_unless_apart() -> None:
    # 2 um more material on both flanks of one gear, thinned by 1 um on the other's coast flanks: no room at K = 50.
    gear = {"teeth": 20, "module_mm": 2.0, "inspection": {"tooth_thickness_um": 3.0}}
    thin = {"teeth": 30, "module_mm": 2.0}
    pair = api.Pair.of({"pair": {"centre_distance_mm": 50.05}, "driving": gear, "driven": thin})
    pair.drawing(Request())
    with pytest.raises(InputFileError, match=r"jam.*from (\d+\.?\d*) on") as refused:
        pair.drawing(Request(magnify=50.0))
    most = float(str(refused.value).rpartition("from ")[2].split()[0])
    # Parting by 0.05 mm leaves j = 2 * 0.05 sin(20 deg) = 34 um along the normals; 3 um of arc eat 2.82 um of it each.
    assert most == pytest.approx(2.0 * 50.0 * math.sin(20.0 * DEG) / (3.0 * math.cos(20.0 * DEG)), rel=0.02)
    pair.drawing(Request(magnify=50.0, apart=True))


def test_fillets_that_grow_into_each_other_still_make_a_gear() -> None:
    pitch = [0.0] * 20
    pitch[4], pitch[5] = 4.0, -4.0
    gear = {"teeth": 20, "module_mm": 2.0, "inspection": {"pitch_um": pitch}}
    pair = api.Pair.of({"driving": gear, "driven": gear})
    areas = []
    for K in (80.0, 100.0, 120.0):
        drawn = pair.drawing(Request(apart=True, magnify=K)).gears[0]
        assert drawn.polygon.is_valid
        assert len([part for part in drawn.outline.parts if part.kind == "land"]) < 20
        areas.append(drawn.polygon.area)
    # Shifted whole teeth keep the area but for the fillets that overlap, a few hundredths of a square mm.
    assert np.ptp(areas) < 2e-4 * areas[0]


# Formats, read back by other libraries.


def test_svg_has_true_size_layers_and_the_exact_outline(pair: api.Pair, tmp_path: Path) -> None:
    target = tmp_path / "pair.svg"
    written = pair.export(target, theta_2=0.3)
    root = etree.parse(str(target)).getroot()
    ns = {"s": "http://www.w3.org/2000/svg", "i": "http://www.inkscape.org/namespaces/inkscape"}
    size = [float(value) for value in root.get("viewBox").split()]
    assert [float(root.get(key).removesuffix("mm")) for key in ("width", "height")] == size[2:]
    layers = root.xpath("//s:g[@i:groupmode='layer']/@i:label", namespaces=ns)
    assert {"driving gear", "driven gear", "driven tooth numbers", "driving circles", "mesh"} <= set(layers)
    for gear in written.drawing.gears:
        path = root.xpath(f"//s:path[@id='{gear.name}-tooth-outline']", namespaces=ns)[0]
        points = np.array([edge.start for edge in svgpathtools.parse_path(path.get("d"))])
        assert points.size == gear.ring.shape[0]
        # The page's y axis points down, which turns the sense of the outline.
        assert -area(np.column_stack((points.real, points.imag))) == pytest.approx(area(gear.ring), rel=AREA)
        nominal = gear.mounted.gear
        for kind, radius in (
            ("base", nominal.r_b),
            ("reference", nominal.r),
            ("pitch", nominal.r_b / math.cos(pair.mesh.alpha_w)),
        ):
            circle = root.xpath(f"//s:circle[@id='{gear.name}-{kind}']", namespaces=ns)[0]
            assert float(circle.get("r")) == pytest.approx(radius, abs=1e-8)
        numbers = root.xpath(f"//s:g[@id='{gear.name}-numbers']/s:text/text()", namespaces=ns)
        assert numbers == [str(k) for k in range(nominal.z)]
    assert len(root.xpath("//s:line[@id='line-of-action']", namespaces=ns)) == 1
    statement = json.loads(root.xpath("//s:metadata/text()", namespaces=ns)[0])
    assert statement["magnify"] == 1.0 and statement["chord_error_um"] == pytest.approx(
        written.chord_error / UM, rel=0.01
    )


def test_tooth_numbers_stand_on_their_teeth(pair: api.Pair, tmp_path: Path) -> None:
    pair.export(tmp_path / "pair.svg", theta_2=0.3)
    root = etree.parse(str(tmp_path / "pair.svg")).getroot()
    found = pair.contacts(0.3)
    for name, tooth in (("driving", found.driving[0]), ("driven", found.driven[0])):
        texts = root.xpath(f"//*[@id='{name}-numbers']/*")
        places = np.array([[float(text.get("x")), -float(text.get("y"))] for text in texts])
        # Of all teeth, the touching one's number is nearest to the contact point.
        assert int(np.argmin(np.hypot(*(places - found.point[0]).T))) == tooth


@pytest.mark.long
@pytest.mark.parametrize("curves", ["lines", "arcs"])
def test_dxf_is_clean_and_holds_one_closed_polyline_per_gear(pair: api.Pair, tmp_path: Path, curves: str) -> None:
    target = tmp_path / "pair.dxf"
    written = pair.export(target, curves=curves, points=40)
    document = ezdxf.readfile(target)
    audit = document.audit()
    assert not audit.errors and not audit.fixes
    assert document.units == ezdxf.units.MM
    assert document.header.custom_vars.get("GEARPOLY_MAGNIFY") == "1.0"
    truth = fine(pair)
    for gear, true in zip(written.drawing.gears, truth.gears, strict=True):
        (outline,) = document.modelspace().query(f'LWPOLYLINE[layer=="{gear.name.upper()}_OUTLINE"]')
        assert outline.closed
        if curves == "lines":
            assert area([(x, y) for x, y, *_ in outline.get_points()]) == pytest.approx(area(gear.ring), rel=AREA)
        else:
            points = [(v.x, v.y) for v in ezdxf.path.make_path(outline).flattening(1e-5)]
            # Arcs of 40 points a flank err by the third derivative alone: far below chords, which lose 1e-5 here.
            assert area(points) == pytest.approx(area(true.ring), rel=AREA)
        assert len(document.modelspace().query(f'TEXT[layer=="{gear.name.upper()}_NUMBERS"]')) == gear.mounted.gear.z


@pytest.mark.long
def test_dxf_splines_keep_the_stated_error(pair: api.Pair, tmp_path: Path) -> None:
    target = tmp_path / "pair.dxf"
    written = pair.export(target, curves="splines", points=40)
    document = ezdxf.readfile(target)
    assert not document.audit().errors
    assert written.chord_error < written.drawing.chord_error * 1.0001
    gear = written.drawing.gears[0]
    pieces = [
        np.array([(v.x, v.y) for v in (entity.flattening(1e-6))])
        for entity in document.modelspace().query('SPLINE ARC[layer=="DRIVING_OUTLINE"]')
    ]
    lines = shapely.MultiLineString([piece[:, :2] for piece in pieces])
    true = gear.at(fine(pair).gears[0].outline.ring[::40])
    # The detail moves the contact by its chord error, and so the whole gear; both are drawn at the same angle here.
    assert float(np.max(shapely.distance(shapely.points(true), lines))) <= written.chord_error + 1e-6 + FINE


def test_geojson_and_wkb_hold_the_same_polygons(pair: api.Pair, tmp_path: Path) -> None:
    drawing = pair.export(tmp_path / "pair.geojson").drawing
    pair.export(tmp_path / "pair.wkb")
    document = json.loads((tmp_path / "pair.geojson").read_text())
    assert document["gearpoly"]["unit"] == "mm"
    collection = shapely.from_wkb((tmp_path / "pair.wkb").read_bytes())
    for gear, feature, polygon in zip(drawing.gears, document["features"], collection.geoms, strict=True):
        shape = shapely.geometry.shape(feature["geometry"])
        assert shape.exterior.is_ccw and not shape.interiors[0].is_ccw
        assert shape.area == pytest.approx(gear.polygon.area, rel=AREA)
        assert polygon.equals_exact(gear.polygon, 0.0)


@pytest.mark.long
def test_csv_of_points_is_the_outline_in_order(pair: api.Pair, tmp_path: Path) -> None:
    drawing = pair.export(tmp_path / "points.csv", magnify=3.0).drawing
    lines = (tmp_path / "points.csv").read_text().splitlines()
    assert "# magnify = 3.0" in lines
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    for gear in drawing.gears:
        mine = [row for row in rows if row["gear"] == gear.name and row["ring"] == "outline"]
        points = np.array([(float(row["x_mm"]), float(row["y_mm"])) for row in mine])
        np.testing.assert_allclose(points, gear.ring, atol=1e-8)  # written to 1e-8 mm
        assert {int(row["tooth"]) for row in mine} == set(range(gear.mounted.gear.z))


def test_step_reads_back_with_the_volume_of_the_polygon(pair: api.Pair, tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d")
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    written = pair.export(tmp_path / "gear.step", which="driving", points=30)
    (solid,) = build123d.import_step(tmp_path / "gear.step").solids()
    assert solid.is_valid
    properties = GProp_GProps()
    BRepGProp.VolumePropertiesGK_s(solid.wrapped, properties, 1e-8)
    gear = written.drawing.gears[0]
    exact = area(fine(pair).gears[0].ring) - math.pi * gear.outline.r_bore**2
    # Splines of 30 points per flank are good to 5 nm over a perimeter of 180 mm; area 681 mm^2.
    assert properties.Mass() == pytest.approx(20.0 * exact, rel=3e-6)


@pytest.mark.long
def test_same_wish_same_bytes(pair: api.Pair, tmp_path: Path) -> None:
    for ending in (".svg", ".csv", ".geojson", ".wkb"):
        contents = []
        for name in ("a", "b"):
            pair.export(tmp_path / f"{name}{ending}")
            contents.append((tmp_path / f"{name}{ending}").read_bytes())
        assert contents[0] == contents[1]


# Curves in closed form.


def test_bulges_of_a_circle_are_exact() -> None:
    angle = np.linspace(0.3, 1.9, 9) ** 1.2
    points = 7.0 * np.column_stack((np.cos(angle), np.sin(angle)))
    vertices, bulge = bulges(points)
    np.testing.assert_allclose(vertices, points[:-1:2])
    # tan of a quarter of each arc's angle; rounding through a sagitta of 0.1 mm costs four digits.
    np.testing.assert_allclose(bulge, np.tan(0.25 * (angle[2::2] - angle[:-1:2])), rtol=1e-11)
    _, back = bulges(points[::-1])
    np.testing.assert_allclose(back, -bulge[::-1], rtol=1e-11)
    _, odd = bulges(points[:-1])
    assert odd[-1] == 0.0 and odd.size == 4
    assert not np.any(bulges(np.column_stack((np.arange(5.0), np.arange(5.0))))[1])


def test_spline_reproduces_a_cubic() -> None:
    t = np.arange(7.0)
    points = np.column_stack((t, 0.1 * t**3 - t))
    curve = spline(points)
    np.testing.assert_allclose(curve.end_slopes, [[1.0, -1.0], [1.0, 0.3 * 36.0 - 1.0]], atol=1e-12)  # rounding


# Bad wishes.


def test_unknown_ending_names_the_known_ones(pair: api.Pair, tmp_path: Path) -> None:
    for name in ("gear.foo", "gear", ".svg"):
        with pytest.raises(InputFileError) as refused:
            pair.export(tmp_path / name)
        for ending in formats():
            assert ending in str(refused.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--to", "{}/gear.foo"], ".3mf, .csv, .dxf"),
        (["--to", "{}/nowhere/gear.svg"], "there is no folder"),
        (["--to", "{}"], "want one of"),
        (["--to", "{}/gear.svg", "--points", "5"], "too few"),
        (["--to", "{}/gear.stl", "--points", "3"], "watertight"),
        (["--to", "{}/gear.svg", "--points", "50", "--chord-um", "1"], "want one of the two"),
        (["--to", "{}/gear.svg", "--chord-um", "0"], "want 0.0001 to 100 um"),
        (["--to", "{}/gear.svg", "--chord-um", "nan"], "want 0.0001 to 100 um"),
        (["--to", "{}/gear.svg", "--magnify", "-1"], "want 0 (the ideal gear)"),
        (["--to", "{}/gear.svg", "--magnify", "nan"], "want 0 (the ideal gear)"),
        (["--to", "{}/gear.svg", "--magnify", "900"], "teeth cross"),
        (["--to", "{}/gear.svg", "--at", "inf"], "want an angle"),
        (["--to", "{}/gear.svg", "--at", "5", "--apart"], "leave it out"),
        (["--to", "{}/gear.svg", "--curves", "arcs"], "hold lines"),
        (["--to", "{}/gear.wkb", "--magnify", "2"], "cannot state it"),
        (["--to", "{}/gear.gde"], "one gear"),
        (["--to", "{}/gear.gde", "--gear", "driven", "--magnify", "2"], "real one"),
    ],
)
def test_bad_wishes_are_refused_and_leave_no_file(tmp_path: Path, options: list[str], says: str) -> None:
    command = ["export", str(GRADED), *(option.format(tmp_path) for option in options)]
    result = CliRunner().invoke(app, command)
    assert isinstance(result.exception, GearpolyError) and says in str(result.exception)
    assert not list(tmp_path.iterdir())


@pytest.mark.long
def test_command_writes_and_says_what(tmp_path: Path) -> None:
    target = tmp_path / "gear.svg"
    result = CliRunner().invoke(
        app, ["export", str(GRADED), "--to", str(target), "--at", "12.5", "--magnify", "4", "--chord-um", "0.5"]
    )
    assert result.exit_code == 0, result.output
    said = " ".join(result.output.split())
    assert "magnified 4 times" in said and "12.5 deg" in said and target.is_file()


def test_failing_writer_leaves_nothing(pair: api.Pair, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from gearpoly.export.formats import geojson

    def half(*_: object, **__: object) -> str:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(geojson.json, "dumps", half)
    with pytest.raises(InputFileError, match="No space left"):
        pair.export(tmp_path / "gear.geojson")
    assert not list(tmp_path.iterdir())
