"""Solids: watertight, of the polygon's volume, within the stated chord error, read back by a mesh library."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh
from lxml import etree

from gearpoly import api
from gearpoly.errors import GeometryError, InputFileError, OutOfRangeError
from gearpoly.export.drawing import Drawing, Request
from gearpoly.export.outline import Detail
from gearpoly.export.solid import solids
from gearpoly.units import UM

VOLUME = 1e-4
"""Relative: what is promised of a solid's volume over its polygon's area times the face width."""

GRADED = Path(__file__).parents[1] / "data" / "pairs" / "graded_18_25.toml"


def made(z_1: int, z_2: int, *, x: float = 0.0) -> api.Pair:
    def gear(z: int, b: float) -> dict[str, object]:
        return {"teeth": z, "module_mm": 2.0, "profile_shift": x, "face_width_mm": b, "grade": 6}

    return api.Pair.of({"driving": gear(z_1, 20.0), "driven": gear(z_2, 14.0)})


def bodies(target: Path) -> dict[str, trimesh.Trimesh]:
    """The gears in the file; driving and driven differ in face width."""
    loaded = trimesh.load_scene(target)
    parts = [part for mesh in loaded.geometry.values() for part in mesh.split(only_watertight=False)]
    assert len(parts) == 2
    parts.sort(key=lambda part: -part.extents[2])
    return dict(zip(("driving", "driven"), parts, strict=True))


@pytest.mark.parametrize(
    ("z_1", "z_2", "x", "ending"),
    [
        (8, 13, 0.5, ".stl"),
        (18, 25, 0.0, ".3mf"),
        *(pytest.param(*one, marks=pytest.mark.slow) for one in ((8, 13, 0.5, ".3mf"), (17, 80, 0.0, ".stl"))),
    ],
)
def test_solids_are_watertight_and_have_the_polygons_volume(
    tmp_path: Path, z_1: int, z_2: int, x: float, ending: str
) -> None:
    pair = made(z_1, z_2, x=x)
    pair.export(tmp_path / f"pair{ending}")
    # The true gear's area, chords of 10 nm: the default detail has to keep the volume, not only the mesh its polygon.
    true = {gear.name: gear.polygon.area for gear in pair.drawing(Request(detail=Detail(chord=1e-5))).gears}
    for (name, body), b in zip(bodies(tmp_path / f"pair{ending}").items(), (20.0, 14.0), strict=True):
        assert body.is_watertight and body.is_winding_consistent and body.is_volume
        assert body.euler_number == 0  # one bore makes a ring
        assert body.volume == pytest.approx(true[name] * b, rel=VOLUME)
        low, high = body.bounds[:, 2]
        # Middle planes level; single precision resolves 20 mm to 2e-6.
        assert (low + high) / 2.0 == pytest.approx(10.0, abs=4e-6) and high - low == pytest.approx(b, abs=4e-6)


@pytest.mark.long
@pytest.mark.parametrize(("ending", "K"), [pytest.param(".stl", 1.0, marks=pytest.mark.slow), (".3mf", 5.0)])
def test_a_slice_lies_within_the_stated_chord_error(tmp_path: Path, ending: str, K: float) -> None:
    pair = made(18, 25)
    target = tmp_path / f"pair{ending}"
    written = pair.export(target, magnify=K, chord=1.0 * UM)
    # One gear's flanks far finer, turned to where the file has it.
    for name, body in bodies(target).items():
        lines = trimesh.intersections.mesh_plane(body, (0.0, 0.0, 1.0), (0.0, 0.0, 9.0))[:, :, :2]
        section = shapely.MultiLineString(list(lines))
        drawn = next(gear for gear in written.drawing.gears if gear.name == name)
        true = pair.drawing(Request(apart=True, magnify=K, detail=Detail(chord=1e-5))).gears
        ring = drawn.at(next(gear for gear in true if gear.name == name).outline.ring[::40])
        off = float(np.max(shapely.distance(shapely.points(ring), section)))
        # The finer drawing stands off by its own 10 nm.
        assert off <= written.chord_error + 1e-5
        assert off > 0.3 * UM  # and the file is as coarse as it says, so the test can see


@pytest.mark.long
def test_stl_states_k_and_an_error_that_includes_its_rounding(tmp_path: Path) -> None:
    written = made(18, 25).export(tmp_path / "pair.stl", magnify=4.0)
    head = (tmp_path / "pair.stl").read_bytes()[:80].decode("ascii")
    assert "magnify=4 " in head and "unit=mm" in head and not head.startswith("solid")
    stated = float(head.rpartition("chord_error_um=")[2])
    assert stated == pytest.approx(written.chord_error / UM, rel=0.01)  # three digits
    assert written.chord_error > written.drawing.chord_error


@pytest.mark.long
def test_3mf_is_in_millimetres_and_names_gears_and_k(tmp_path: Path) -> None:
    made(18, 25).export(tmp_path / "pair.3mf", magnify=4.0)
    with zipfile.ZipFile(tmp_path / "pair.3mf") as archive:
        assert archive.testzip() is None
        root = etree.fromstring(archive.read("3D/3dmodel.model"))
    ns = {"m": "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"}
    assert root.get("unit") == "millimeter"
    names = root.xpath("//m:object/@name", namespaces=ns)
    assert names == ["driving gear, deviations 4 times", "driven gear, deviations 4 times"]
    assert "magnify = 4.0" in root.xpath("//m:metadata[@name='Description']/text()", namespaces=ns)[0]


@pytest.mark.long
@pytest.mark.parametrize("points", [8, 9, 400])
def test_coarsest_and_fine_detail_stay_watertight(tmp_path: Path, points: int) -> None:
    made(18, 25).export(tmp_path / "gear.stl", which="driving", points=points)
    mesh = trimesh.load_mesh(tmp_path / "gear.stl")
    assert mesh.is_watertight and mesh.is_volume


@pytest.mark.long
def test_apart_gears_stand_on_the_bed_clear_of_each_other(tmp_path: Path) -> None:
    made(18, 25).export(tmp_path / "pair.3mf", apart=True)
    driving, driven = bodies(tmp_path / "pair.3mf").values()
    assert driving.bounds[0, 2] == 0.0 and driven.bounds[0, 2] == 0.0
    assert driven.bounds[0, 0] - driving.bounds[1, 0] > 2.0 * 2.0 - 1e-6


def test_solids_need_a_face_width(tmp_path: Path) -> None:
    gear = {"teeth": 20, "module_mm": 2.0}
    pair = api.Pair.of({"driving": gear, "driven": gear})
    for ending in (".stl", ".3mf", ".step"):
        with pytest.raises(OutOfRangeError, match=r"driving\.face_width_mm"):
            pair.export(tmp_path / f"gear{ending}")
    assert not list(tmp_path.iterdir())


@pytest.mark.long
def test_points_that_fall_together_in_single_precision_are_refused() -> None:
    # 20 000 points on the flanks of a tiny tooth far from the axis: 1e-5 mm apart, where floats step by 3e-5.
    gear = {"teeth": 2000, "module_mm": 0.2, "face_width_mm": 5.0}
    small = api.Pair.of({"driving": {"teeth": 12, "module_mm": 0.2, "face_width_mm": 5.0}, "driven": gear})
    drawing: Drawing = small.drawing(Request(which="driving", detail=Detail(points=16)))
    shifted = drawing.gears[0]
    object.__setattr__(shifted, "axis", shifted.axis + 3.0e5)  # floats step by 0.03 mm there
    with pytest.raises(GeometryError, match="watertight"):
        solids(drawing, single=True)


def test_bore_larger_than_the_root_is_refused() -> None:
    gear = {"teeth": 20, "module_mm": 2.0, "face_width_mm": 5.0, "bore_mm": 36.0}
    with pytest.raises(InputFileError, match="bore"):
        api.Pair.of({"driving": gear, "driven": gear})


def test_a_bore_too_large_for_chords_between_the_spaces_still_makes_a_solid(tmp_path: Path) -> None:
    # Root circle 11 mm, chords between the 8 spaces at 11 cos(22.5 deg) = 10.2 mm from the axis, bore 10.6 mm.
    gear = {"teeth": 8, "module_mm": 3.0, "profile_shift": 0.9, "addendum": 0.6, "face_width_mm": 5.0, "bore_mm": 21.2}
    api.Pair.of({"driving": gear, "driven": gear}).export(tmp_path / "gear.stl", which="driving")
    mesh = trimesh.load_mesh(tmp_path / "gear.stl")
    assert mesh.is_watertight and mesh.is_volume and mesh.euler_number == 0
