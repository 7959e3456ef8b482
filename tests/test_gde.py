"""Inspection files: read, written and read back equal, mapped to the right flank and tooth, and refused when wrong."""

from __future__ import annotations

import math
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly import api
from gearpoly.assemble import assemble, with_sheets_stated
from gearpoly.errors import InputFileError
from gearpoly.files.gde import GearInspection, Profile, Turn, gde_text
from gearpoly.files.gde_read import read_gde
from gearpoly.files.pairfile import dump_pair, moved, read_pair
from gearpoly.files.traces import read_traces
from gearpoly.units import DEG, UM

GRADED = Path(__file__).parents[1] / "data" / "pairs" / "graded_18_25.toml"

HAND = """\
<?xml version="1.0" encoding="UTF-8"?>
<!-- one gear of six teeth, as a person would write it -->
<gear_data_exchange>
  <identification><name>six &amp; teeth</name></identification>
  <geometry>
    <number_of_teeth>6</number_of_teeth>
    <normal_module unit="mm">2.5</normal_module>
    <normal_pressure_angle unit="deg">20</normal_pressure_angle>
    <profile_shift_coefficient>0.6</profile_shift_coefficient>
  </geometry>
  <tolerances><quality_grade>7</quality_grade><single_pitch unit="um">8</single_pitch></tolerances>
  <inspection tooth_count="clockwise">
    <pitch flank="left" direction="normal" unit="um">0 1 2 3 4 5</pitch>
    <pitch flank="right" direction="arc" unit="mm">0 0.001 0.002 0 0 0</pitch>
    <profile tooth="2" flank="left">
      <roll_length unit="mm">1.0 2.0 4.0</roll_length>
      <deviation unit="µm">0.5 -1 2.25</deviation>
    </profile>
  </inspection>
</gear_data_exchange>
"""


def written(folder: Path, text: str = HAND) -> Path:
    path = folder / "gear.gde"
    path.write_text(text, encoding="utf-8")
    return path


def pair_text(which: str, *, extra: str = "") -> str:
    mate = {"driving": "driven", "driven": "driving"}[which]
    return f"""\
[{which}]
teeth = 6
module_mm = 2.5
profile_shift = 0.45
addendum = 0.8
[{which}.inspection]
gde = "gear.gde"
{extra}
[{mate}]
teeth = 20
module_mm = 2.5
"""


def test_a_hand_made_file_reads_as_it_says(tmp_path: Path) -> None:
    gear = read_gde(written(tmp_path))
    arc = math.cos(20.0 * DEG)
    assert gear == GearInspection(
        name="six & teeth",
        geometry={
            "number_of_teeth": 6.0,
            "normal_module": 2.5,
            "normal_pressure_angle": 20.0,
            "profile_shift_coefficient": 0.6,
        },
        tolerances={"quality_grade": 7.0, "single_pitch": 8.0},
        count="clockwise",
        pitch={"left": (0.0, 1.0, 2.0, 3.0, 4.0, 5.0), "right": (0.0, arc * 1.0, arc * 2.0, 0.0, 0.0, 0.0)},
        profiles=(Profile(tooth=2, flank="left", roll_length=(1.0, 2.0, 4.0), deviation=(0.5, -1.0, 2.25)),),
    )


def test_a_hand_made_file_written_and_read_again_is_equal(tmp_path: Path) -> None:
    gear = read_gde(written(tmp_path))
    assert read_gde(written(tmp_path, gde_text(gear))) == gear


number = st.floats(-9e3, 9e3)


@pytest.mark.long
@settings(max_examples=30, deadline=None)
@given(data=st.data(), z=st.integers(5, 9), count=st.sampled_from(get_args(Turn)))
def test_any_inspection_reads_back_equal(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject, z: int, count: Turn
) -> None:
    row = st.tuples(*[number] * z)
    roll = st.lists(st.floats(0.0, 50.0), min_size=2, max_size=4, unique=True).map(lambda l: tuple(sorted(l)))
    rolls = data.draw(st.lists(roll, max_size=3))
    gear = GearInspection(
        name=data.draw(st.text("abc <>&\"'µ", min_size=1).map(lambda s: s.strip() or "x")),
        geometry={"number_of_teeth": float(z), "normal_module": 2.0, "normal_pressure_angle": 20.0},
        count=count,
        pitch={"left": data.draw(row), "right": data.draw(row)},
        thickness=data.draw(st.none() | row),
        profiles=tuple(
            Profile(tooth=k + 1, flank="right", roll_length=r, deviation=data.draw(st.tuples(*[number] * len(r))))
            for k, r in enumerate(rolls)
        ),
    )
    assert read_gde(written(tmp_path_factory.mktemp("gde"), gde_text(gear))) == gear


@pytest.mark.parametrize(("which", "order"), [("driving", [0, 1, 2, 3, 4, 5]), ("driven", [0, 5, 4, 3, 2, 1])])
def test_left_flanks_drive_and_teeth_follow_in_meshing_order(tmp_path: Path, which: str, order: list[int]) -> None:
    written(tmp_path)
    (tmp_path / "pair.toml").write_text(pair_text(which))
    pair = api.load(tmp_path / "pair.toml")
    gear = pair.driving if which == "driving" else pair.driven
    # The file counts clockwise, the driven gear's teeth mesh counter-clockwise.
    at = np.array([7.0])
    tooth = order.index(1)
    drive = gear.deviation(at)[:, 0]
    wanted = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0])[order] * UM
    wanted[tooth] += 2.25 * UM  # the trace stays level beyond its end
    np.testing.assert_allclose(drive, wanted, atol=1e-15)  # rounding of um
    coast = gear.deviation(at, flank="coast")[:, 0]
    np.testing.assert_allclose(
        coast, np.array([0.0, 1.0, 2.0, 0.0, 0.0, 0.0])[order] * UM * math.cos(20.0 * DEG), atol=1e-15
    )
    # Seen on the datum face the left side of a tooth that points up is its counter-clockwise side.
    middle = gear.mounted.flanks.drive[0, -1]
    assert middle[1] > 0.0


@pytest.mark.long
def test_a_drawn_pair_written_and_named_in_a_pair_file_is_the_same_pair(tmp_path: Path) -> None:
    drawn = api.load(GRADED, seed=5)
    text = GRADED.read_text()
    for name in ("driving", "driven"):
        drawn.export(tmp_path / f"{name}.gde", which=name)
    relief = '[{0}.tip_relief]\namount_um = 5.0\nlength_mm = 0.7\nshape = "parabolic"\n'
    gears = [
        f"[{name}]\nteeth = {z}\nmodule_mm = 2.0\nface_width_mm = 20.0\nbore_mm = {bore}\npoints_per_flank = 2000\n"
        f'[{name}.inspection]\ngde = "{name}.gde"\n' + relief.format(name)
        for name, z, bore in (("driving", 18, 20.0), ("driven", 25, 28.0))
    ]
    assert 'shape = "parabolic"' in text  # the reliefs above are the drawn pair's own
    (tmp_path / "pair.toml").write_text("\n".join(gears))
    read = api.load(tmp_path / "pair.toml")
    for mine, theirs in zip((read.driving, read.driven), (drawn.driving, drawn.driven), strict=True):
        for side in ("psi_drive", "psi_coast"):
            apart = getattr(mine.mounted.flanks, side) - getattr(theirs.mounted.flanks, side)
            # 481 points per trace: straight between them, waves of 2 um and five half waves err by 0.6 nm.
            assert np.max(np.abs(apart)) * mine.nominal.r_b < 1e-6
    at = np.linspace(0.0, 0.5, 7)
    np.testing.assert_allclose(
        read.transmission_error(at) * read.mesh.r_b2, drawn.transmission_error(at) * drawn.mesh.r_b2, atol=2e-6
    )


@pytest.mark.long
def test_written_traces_are_what_pair_files_read(tmp_path: Path) -> None:
    drawn = api.load(GRADED, seed=5)
    drawn.export(tmp_path / "driven.traces.csv", which="driven")
    traces = read_traces(tmp_path / "driven.traces.csv", 25)
    assert len(traces) == 50
    trace = next(one for one in traces if one.tooth == 7 and one.flank == "coast")
    whole = drawn.driven.deviation(trace.roll_length, flank="coast")[7]
    place = whole - trace.deviation  # pitch, thickness and the design's relief are not in a trace
    below = trace.roll_length < drawn.driven.nominal.roll_length(drawn.driven.nominal.r_a - 0.7)
    np.testing.assert_allclose(place[below], place[0], atol=1e-15)
    assert place[-1] - place[0] == pytest.approx(-5.0 * UM, rel=0.2)  # a thinned flank goes on past the tip


BOMB = '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]>'
OUTSIDE = '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/hostname">]>'


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('<?xml version="1.0" encoding="UTF-8"?>', BOMB, "entities"),
        ('<?xml version="1.0" encoding="UTF-8"?>', OUTSIDE, "entities"),
        ("</inspection>", "", "line"),
        ("gear_data_exchange", "gear_data", "want <gear_data_exchange>"),
        ('<normal_module unit="mm">', '<normal_module unit="inch">', 'unit "inch"; want mm'),
        ('<normal_module unit="mm">', "<normal_module>", "no unit; want mm"),
        ('direction="normal" unit="um"', 'direction="normal" unit="mil"', 'unit "mil"; want um or'),
        ('<deviation unit="µm">', '<deviation unit="deg">', 'unit "deg"'),
        ("<number_of_teeth>6", '<number_of_teeth unit="mm">6', "without unit"),
        ("<number_of_teeth>6</number_of_teeth>", "", "no <number_of_teeth>"),
        ("<number_of_teeth>6", "<number_of_teeth>6.5", "whole number"),
        ("geometry>", "geometrie>", "the nearest known block is <geometry>"),
        ('<inspection tooth_count="clockwise">', "<inspection>", "no tooth_count"),
        ('tooth_count="clockwise"', 'tooth_count="left"', "clockwise or counterclockwise"),
        ("0 1 2 3 4 5", "0 1 2 3 4", "5 values; want 6"),
        ("0 1 2 3 4 5", "0 1 2 3 4 nan", '"nan"'),
        ("0 1 2 3 4 5", "0 1 2 3 4 5,5", '"5,5"'),
        ("0 1 2 3 4 5", "0 1 2 3 4 5e5", "-10000 to 10000 um"),
        ('flank="right"', 'flank="left"', "twice"),
        ('tooth="2"', 'tooth="7"', "1 to 6"),
        ("1.0 2.0 4.0", "1.0 4.0 2.0", "do not rise"),
        ("0.5 -1 2.25", "0.5 -1", "2 values; want 3"),
        ('<roll_length unit="mm">1.0 2.0 4.0</roll_length>', "", "no <roll_length>"),
        ("<profile_shift_coefficient>", '<helix_angle unit="deg">15</helix_angle><profile_shift_coefficient>', "spur"),
    ],
)
def test_faults_are_named(tmp_path: Path, old: str, new: str, says: str) -> None:
    assert old in HAND
    with pytest.raises(InputFileError) as refused:
        read_gde(written(tmp_path, HAND.replace(old, new)))
    assert says in str(refused.value) and "gear.gde" in str(refused.value)


@pytest.mark.parametrize("block", ["geometry", "inspection"])
def test_missing_blocks_are_named(tmp_path: Path, block: str) -> None:
    start, stop = HAND.index(f"<{block}"), HAND.index(f"</{block}>") + len(f"</{block}>")
    with pytest.raises(InputFileError, match=f"no <{block}>"):
        read_gde(written(tmp_path, HAND[:start] + HAND[stop:]))


def test_an_inspection_without_measurements_is_refused(tmp_path: Path) -> None:
    start, stop = HAND.index("<pitch"), HAND.index("</profile>") + len("</profile>")
    with pytest.raises(InputFileError, match="nothing measured"):
        read_gde(written(tmp_path, HAND[:start] + HAND[stop:]))


@pytest.mark.parametrize(
    "data", [b"", b"\x00\x01", b"\xff\xfe<", b"<a>" * 5000, b"<?xml version='1.0' encoding='no-such'?><a/>"]
)
def test_no_xml_is_refused(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "gear.gde").write_bytes(data)
    with pytest.raises(InputFileError):
        read_gde(tmp_path / "gear.gde")
    with pytest.raises(InputFileError, match="no such file"):
        read_gde(tmp_path / "none.gde")
    with pytest.raises(InputFileError, match="a folder"):
        read_gde(tmp_path)


def test_a_file_of_another_gear_is_refused(tmp_path: Path) -> None:
    written(tmp_path)
    text = pair_text("driving").replace("teeth = 6", "teeth = 7")
    (tmp_path / "pair.toml").write_text(text)
    with pytest.raises(InputFileError, match=r"geometry\.number_of_teeth: 6; want 7"):
        api.load(tmp_path / "pair.toml")


def test_the_pair_file_names_one_source(tmp_path: Path) -> None:
    written(tmp_path)
    path = tmp_path / "pair.toml"
    path.write_text(pair_text("driving", extra="profile_slope_um = 1.0"))
    with pytest.raises(InputFileError, match="profile_slope_um too"):
        read_pair(path)
    path.write_text(pair_text("driving", extra="uncertainty_um = 0.8"))
    file = read_pair(path)
    assert file.driving.inspection is not None and file.driving.inspection.uncertainty_um == 0.8
    path.write_text(pair_text("driving").replace("gear.gde", "none.gde"))
    with pytest.raises(InputFileError, match=r"driving\.inspection\.gde: no such file"):
        read_pair(path)


def test_a_pair_file_that_moves_still_finds_its_inspection(tmp_path: Path) -> None:
    written(tmp_path)
    path, target = tmp_path / "pair.toml", tmp_path / "below" / "pair.toml"
    path.write_text(pair_text("driving"))
    target.parent.mkdir()
    target.write_text(dump_pair(moved(read_pair(path), source=path, target=target)))
    assert api.load(target).driving.deviation(np.array([7.0]))[4, 0] == pytest.approx(4.0 * UM)


def test_what_is_found_of_a_measured_gear_is_added_to_its_file(tmp_path: Path) -> None:
    """A diagnosis adds 5 um to one pitch: the drawn gear has it, and the pair file written out is read back."""
    written(tmp_path)
    path = tmp_path / "pair.toml"
    path.write_text(pair_text("driving"))
    file = with_sheets_stated(read_pair(path), path=path)
    sheet = file.driving.inspection
    assert sheet is not None
    assert sheet.gde == "gear.gde"
    assert isinstance(sheet.pitch_um, tuple)
    before = assemble(file, path=path, seed=0).pair.driving
    plain = assemble(read_pair(path), path=path, seed=0).pair.driving
    np.testing.assert_array_equal(before.flanks.psi_drive, plain.flanks.psi_drive)
    pitch = (*sheet.pitch_um[:3], sheet.pitch_um[3] + 5.0, *sheet.pitch_um[4:])
    more = sheet.model_copy(update={"pitch_um": pitch})
    path.write_text(
        dump_pair(file.model_copy(update={"driving": file.driving.model_copy(update={"inspection": more})}))
    )
    after = assemble(read_pair(path), path=path, seed=0).pair.driving
    moved_by = (after.flanks.psi_drive - before.flanks.psi_drive) * before.gear.r_b
    # Along the line of action, all but the first point, which is the middle of the tooth space.
    np.testing.assert_allclose(np.abs(moved_by[3, 1:]), 5.0 * UM, rtol=1e-6)
    np.testing.assert_allclose(np.delete(moved_by, 3, axis=0), 0.0, atol=1e-12)
