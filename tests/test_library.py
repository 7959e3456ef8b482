"""gearpoly from Python: light to import, the same answers as underneath, pictures for notebooks, the example runs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from lxml import etree

import gearpoly
from gearpoly.errors import InputFileError, OutOfRangeError
from gearpoly.mesh.transmission import contacts
from gearpoly.units import UM

ROOT = Path(__file__).parents[1]
GRADED = ROOT / "data" / "pairs" / "graded_18_25.toml"


@pytest.fixture(scope="module")
def pair() -> gearpoly.Pair:
    return gearpoly.load(GRADED, seed=2)


def test_import_stays_light() -> None:
    code = "import sys, gearpoly; print(sorted({'numpy', 'shapely', 'pydantic'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"
    with pytest.raises(AttributeError, match="no attribute 'Bear'"):
        _ = gearpoly.Bear


def test_contacts_are_the_kernels(pair: gearpoly.Pair) -> None:
    at = np.array([0.1, 0.2])
    mine, kernel = pair.contacts(at), contacts(pair.mesh, at)
    np.testing.assert_array_equal(mine.te, kernel.te)
    assert pair.contacts(0.1).te[0] == mine.te[0]
    np.testing.assert_array_equal(pair.transmission_error(at), kernel.te)
    for bad in (np.nan, np.zeros((2, 2))):
        with pytest.raises(OutOfRangeError, match="theta_2"):
            pair.contacts(bad)


def test_polygon_is_valid_and_has_a_bore(pair: gearpoly.Pair) -> None:
    polygon = pair.driving.polygon
    assert polygon.is_valid and len(polygon.interiors) == 1
    # Between root and tip circle, less the bore of 20 mm.
    assert np.pi * (15.5**2 - 100.0) < polygon.area < np.pi * (20.0**2 - 100.0)


def test_deviation_includes_pitch_and_relief() -> None:
    relief = {"amount_um": 8.0, "length_mm": 0.7}
    gear = {"teeth": 20, "module_mm": 2.0, "inspection": {"pitch_um": 3.0}, "tip_relief": relief}
    made = gearpoly.Pair.of({"driving": gear, "driven": {"teeth": 30, "module_mm": 2.0}}).driving
    found = made.deviation(np.array([made.nominal.l_pitch, made.nominal.l_a]))
    np.testing.assert_allclose(found, np.tile([3.0 * UM, -5.0 * UM], (20, 1)), atol=1e-15)  # rounding of um
    assert made.deviation(np.array([made.nominal.l_pitch]), flank="coast")[0, 0] == pytest.approx(-3.0 * UM)


@pytest.mark.long
def test_simulation_and_seed(pair: gearpoly.Pair) -> None:
    run = pair.simulate(turns=0.1, torque_nm=0.0, fast=True)
    assert run.te_um.size == 120 and run.simulation.load is None
    assert gearpoly.load(GRADED, seed=2).transmission_error(0.1)[0] == pair.transmission_error(0.1)[0]
    assert gearpoly.load(GRADED, seed=3).transmission_error(0.1)[0] != pair.transmission_error(0.1)[0]


def test_notebooks_show_svg(pair: gearpoly.Pair) -> None:
    for shown, gears in ((pair, 2), (pair.driven, 1)):
        text = shown._repr_svg_()
        assert text.startswith("<svg") and len(text) < 150_000
        outlines = etree.fromstring(text).xpath("//*[contains(@id, 'tooth-outline')]")
        assert len(outlines) == gears


def test_a_pair_from_a_dictionary_is_checked_as_a_file_is() -> None:
    with pytest.raises(InputFileError, match=r'nearest known key in \[driven\] is "teeth"'):
        gearpoly.Pair.of({"driving": {"teeth": 18, "module_mm": 2.0}, "driven": {"teth": 25, "module_mm": 2.0}})


def test_gear_exports_alone(pair: gearpoly.Pair, tmp_path: Path) -> None:
    written = pair.driven.export(tmp_path / "gear.svg", points=20)
    assert [gear.name for gear in written.drawing.gears] == ["driven"] and "driven gear" in written.says
