"""Still pictures: what is drawn is what was computed, with units, and nothing is left where it cannot be."""

from __future__ import annotations

from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from typer.testing import CliRunner

from gearpoly import api
from gearpoly.cli import app
from gearpoly.errors import GearpolyError
from gearpoly.report.gear_plots import deviation_figure, gap_figure, mesh_figure
from gearpoly.units import DEG, UM

GRADED = Path(__file__).parents[1] / "data" / "pairs" / "graded_18_25.toml"
AT = 33.0 * DEG


@pytest.fixture(scope="module")
def pair() -> api.Pair:
    return api.load(GRADED)


@pytest.mark.long
def test_close_up_shows_the_leading_contact(pair: api.Pair) -> None:
    figure = mesh_figure(pair.assembled, AT, flank="drive", name="pair")
    found = pair.contacts(AT)
    lead = int(np.argmin(found.gap))
    wide, close = figure.axes
    title = close.get_title()
    assert f"driving tooth {found.driving[lead]} on driven tooth {found.driven[lead]}" in title
    assert f"{found.point[lead, 0]:.4f}" in title
    assert "um" in close.get_xlabel() and "mm" in wide.get_xlabel()
    marks = [line for line in wide.lines if line.get_marker() in ("o", "s")]
    assert any(np.allclose([line.get_xdata()[0], line.get_ydata()[0]], found.point[lead]) for line in marks)
    # Both flanks pass the contact within their chords: 0.06 nm, and 1e-6 um of rounding in the panel's own units.
    for colour in ("#0072B2", "#D55E00"):
        curves = [line for line in close.lines if line.get_color() == colour]
        distance = min(float(np.min(np.hypot(line.get_xdata(), line.get_ydata()))) for line in curves)
        assert distance < 20.0  # a vertex of each flank lies near the middle; they are up to 10 um apart


@pytest.mark.long
def test_maps_show_the_deviations(pair: api.Pair) -> None:
    figure = deviation_figure(pair.assembled, name="pair")
    images = [axis.images[0] for axis in figure.axes if axis.images]
    assert len(images) == 4
    span = pair.driving.mounted.flanks.span
    l = np.linspace(span.l_start, span.l_a, 400)
    whole = pair.driving.deviation(l) / UM
    # Each row is the tooth's profile: its deviation but for a constant, the index deviation.
    rest = np.asarray(images[0].get_array()) - whole
    assert np.max(np.ptp(rest, axis=1)) < 1e-9  # rounding
    assert any("um" in axis.get_xlabel() or "um" in axis.get_ylabel() for axis in figure.axes)


def test_gap_curves_are_the_gaps(pair: api.Pair) -> None:
    figure = gap_figure(pair.assembled, AT, flank="drive", name="pair")
    upper, lower = figure.axes
    curves = [line for line in upper.lines if line.get_label().startswith("driving")]
    lowest = np.nanmin(np.array([line.get_ydata() for line in curves]), axis=0)
    np.testing.assert_allclose(lowest, 0.0, atol=1e-9)  # somebody always touches
    te = lower.lines[0]
    middle = te.get_xdata().size // 2
    assert te.get_ydata()[middle] == pytest.approx(pair.transmission_error(AT)[0] * pair.mesh.r_b2 / UM, abs=1e-6)
    assert "deg" in lower.get_xlabel() and "um" in upper.get_ylabel()


@pytest.mark.parametrize(
    ("what", "ending"),
    [
        pytest.param("mesh", "png", marks=pytest.mark.slow),
        ("deviations", "svg"),
        ("gaps", "pdf"),
    ],
)
def test_command_writes_each_picture(tmp_path: Path, what: str, ending: str) -> None:
    target = tmp_path / f"picture.{ending}"
    command = ["plot", str(GRADED), "--to", str(target), "--what", what, "--at", "33", "--flank", "coast"]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 0, result.output
    if ending == "png":
        pixels = matplotlib.image.imread(target)
        assert pixels.shape[1] == 1950 and 0.2 < float(np.mean(pixels[..., :3])) < 0.99  # neither black nor empty
    else:
        assert target.read_bytes().lstrip()[:5] in (b"<?xml", b"%PDF-")


@pytest.mark.parametrize(
    "options", [["--to", "{}/a.gif"], ["--to", "{}/no/a.png"], ["--to", "{}/a.png", "--at", "nan"]]
)
def test_bad_wishes_are_refused(tmp_path: Path, options: list[str]) -> None:
    result = CliRunner().invoke(app, ["plot", str(GRADED), *(option.format(tmp_path) for option in options)])
    assert isinstance(result.exception, GearpolyError)
    assert not list(tmp_path.iterdir())


@pytest.mark.long
def test_a_pinion_of_five_teeth_is_drawn_as_it_is_exported(tmp_path: Path) -> None:
    """Its deviations of grade 11 turn roots past the middle of their spaces."""
    file = tmp_path / "pair.toml"
    file.write_text(
        "[driving]\nteeth = 5\nmodule_mm = 2\nprofile_shift = -0.5\ngrade = 11\n"
        "[driven]\nteeth = 25\nmodule_mm = 2\ngrade = 11\n"
    )
    for words in (
        ["export", "--apart", "--to", "p.svg"],
        ["plot", "--what", "mesh", "--flank", "coast", "--to", "p.png"],
    ):
        done = CliRunner().invoke(app, [words[0], str(file), *words[1:-1], str(tmp_path / words[-1])])
        assert done.exit_code == 0, done.output
