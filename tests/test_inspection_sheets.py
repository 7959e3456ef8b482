"""Pair files to begin with, inspection sheets, and what sheets state in their own terms."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
import shapely

import gearpoly
from gearpoly.assemble import assemble, with_sheets_stated
from gearpoly.errors import InputFileError, JammedError
from gearpoly.files.models import GearSection, Inspection, PairFile, PairSection
from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.files.sheet_csv import SHEET_KEYS, sheet_text
from gearpoly.files.template import TEMPLATE_TEETH
from gearpoly.inspected import thickness_remarks
from gearpoly.study.keys import known_keys
from gearpoly.units import UM, FloatArray
from tests.made_command import Command

COS = math.cos(math.radians(20.0))


def written(gearpoly_command: Command, folder: Path) -> tuple[Path, Path]:
    ran = gearpoly_command("pair", "--new", folder / "pair.toml", "--sheet", folder / "sheet.csv")
    assert ran.code == 0, ran.err
    return folder / "pair.toml", folder / "sheet.csv"


def fill(sheet: Path, values: dict[tuple[str, str], FloatArray]) -> None:
    """Fill columns of a sheet, by gear and key."""
    lines = sheet.read_text(encoding="utf-8").splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith("gear,"))
    names = lines[head].split(",")
    for k in range(head + 1, len(lines)):
        cells = lines[k].split(",")
        for (gear, key), column in values.items():
            if cells[0] == gear:
                cells[names.index(key)] = repr(float(column[int(cells[1])]))
        lines[k] = ",".join(cells)
    sheet.write_text("\n".join(lines) + "\n", encoding="utf-8")


def test_the_template_runs_as_it_stands_and_nobody_inspected_its_gears(
    gearpoly_command: Command, tmp_path: Path
) -> None:
    pair, _ = written(gearpoly_command, tmp_path)
    ran = gearpoly_command("simulate", pair, "--turns", "0.04", "--fast")
    assert ran.code == 0, ran.err
    assert "inspected" not in ran.out
    alone = gearpoly_command("pair", "--new", tmp_path / "alone.toml")
    assert alone.code == 0
    assert read_pair(tmp_path / "alone.toml") == read_pair(pair)


def test_every_key_behind_a_hash_is_a_key(gearpoly_command: Command, tmp_path: Path) -> None:
    """Uncommented all at once, but for those that state one thing again, they are read."""
    file = tmp_path / "alone.toml"
    assert gearpoly_command("pair", "--new", file).code == 0
    text = file.read_text(encoding="utf-8")
    keys = set(re.findall(r"^# (\w+) = ", text, flags=re.MULTILINE))
    assert len(keys) > 12
    assert keys <= {*PairSection.model_fields, *GearSection.model_fields, *Inspection.model_fields}
    again = keys & {"torque_driving_nm", "over_pins_mm", "pin_diameter_mm", "single_pitch_um"}
    for key in sorted(keys - again):
        text = text.replace(f"# {key} = ", f"{key} = ")
    for gear in TEMPLATE_TEETH:
        text = text.replace(f"# [{gear}.inspection]", f"[{gear}.inspection]")
    file.write_text(text, encoding="utf-8")
    assert read_pair(file).driven.inspection is not None


def test_nothing_that_was_filled_in_is_written_over(gearpoly_command: Command, tmp_path: Path) -> None:
    pair, sheet = written(gearpoly_command, tmp_path)
    before = pair.read_bytes(), sheet.read_bytes()
    for arguments in (("--new", pair), ("--new", tmp_path / "other.toml", "--sheet", sheet)):
        ran = gearpoly_command("pair", *arguments)
        assert ran.code == 2
        assert "this file exists" in ran.err
    assert (pair.read_bytes(), sheet.read_bytes()) == before
    assert not (tmp_path / "other.toml").exists()


def test_a_filled_sheet_is_read_as_its_keys_would_be(gearpoly_command: Command, tmp_path: Path) -> None:
    pair, sheet = written(gearpoly_command, tmp_path)
    rng = np.random.default_rng(3)
    values = {
        ("driving", "pitch_um"): rng.normal(size=18),
        ("driven", "tooth_thickness_um"): rng.normal(-50.0, 2.0, 25),
    }
    fill(sheet, values)
    read = read_pair(pair)
    assert read.driving.inspection is not None
    assert read.driven.inspection is not None
    assert read.driving.inspection.pitch_um == tuple(values["driving", "pitch_um"].tolist())
    assert read.driven.inspection.tooth_thickness_um == tuple(values["driven", "tooth_thickness_um"].tolist())
    assert read.driven.inspection.pitch_um is None
    # What is written back holds the values themselves, wherever the file goes.
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "again.toml").write_text(dump_pair(read), encoding="utf-8")
    assert read_pair(elsewhere / "again.toml") == read


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("driving,3,,", "driving,3,1.5,", ("column pitch_um", "no value for tooth 0", "all 18 teeth")),
        ("driving,3,,", "driving,2,,", ("tooth 2 of the driving gear again", "each tooth once")),
        ("driving,3,,", "driving,18,,", ('"18"', "0 to 17")),
        ("driving,3,,", "driving,3,x,", ("column pitch_um", '"x"', "number in um")),
        ("driving,3,,", "left,3,,", ('"left"', "driving or driven")),
        ("driving,3,,", "driving,3,,,,,,", ("cells", "as in the header")),
        ("gear,tooth,pitch_um", "gear,tooth,pich_um", ("pich_um", "pitch_um")),
    ],
)
def test_faults_of_a_sheet_name_line_or_column(
    gearpoly_command: Command, tmp_path: Path, old: str, new: str, words: tuple[str, ...]
) -> None:
    pair, sheet = written(gearpoly_command, tmp_path)
    text = sheet.read_text(encoding="utf-8")
    assert old in text
    sheet.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputFileError) as refusal:
        read_pair(pair)
    for word in ("sheet.csv", *words):
        assert word in str(refusal.value)


def test_sheet_missing_or_stating_what_the_pair_file_states(gearpoly_command: Command, tmp_path: Path) -> None:
    pair, sheet = written(gearpoly_command, tmp_path)
    fill(sheet, {("driving", "pitch_um"): np.zeros(18)})
    text = pair.read_text(encoding="utf-8")
    pair.write_text(
        text.replace('sheet_csv = "sheet.csv"', 'sheet_csv = "sheet.csv"\npitch_um = 1.0', 1), encoding="utf-8"
    )
    with pytest.raises(InputFileError, match="pitch_um in the sheet, and in the pair file too"):
        read_pair(pair)
    sheet.unlink()
    with pytest.raises(InputFileError, match=r"driving\.inspection\.sheet_csv: no such file"):
        read_pair(pair)


def test_the_sheet_has_every_key_with_one_value_per_tooth() -> None:
    text = sheet_text(TEMPLATE_TEETH)
    assert set(SHEET_KEYS) >= {"pitch_um", "single_pitch_um", "single_pitch_coast_um", "tooth_thickness_um"}
    assert sum(line.startswith("driv") for line in text.splitlines()) == 18 + 25
    for word in ("datum face", "counter-clockwise", "left flank is the drive flank"):
        assert word in text


def sides(which: str, **inspection: Any) -> dict[str, Any]:
    """Two gears of module 2, one of them inspected."""
    known: dict[str, Any] = {
        name: {"teeth": z, "module_mm": 2.0, "points_per_flank": 60} for name, z in (("driving", 18), ("driven", 25))
    }
    known[which]["inspection"] = inspection
    return known


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize(("which", "z"), [("driving", 18), ("driven", 25)])
def test_a_pitch_too_large_sets_the_later_teeth_back(
    which: Literal["driving", "driven"], z: int, flank: Literal["drive", "coast"]
) -> None:
    """Where the drawn flanks really stand: single pitches as angles between neighbours, in the order of meshing."""
    index = np.random.default_rng(z).normal(0.0, 3.0, z)
    f_p = index - np.roll(index, 1)
    key = "single_pitch_um" if flank == "drive" else "single_pitch_coast_um"
    pair = gearpoly.Pair.of(sides(which, **{key: f_p.tolist()}))
    gear = pair.driving if which == "driving" else pair.driven
    flanks, centres = gear.mounted.flanks, gear.mounted.centre_lines
    psi = flanks.psi_drive if flank == "drive" else -flanks.psi_coast
    middle = psi.shape[1] - 30
    # The driving gear turns counter-clockwise and its later teeth follow clockwise; the driven one is the mirror image.
    sense = -1.0 if which == "driving" else 1.0
    behind = sense * (centres + psi[:, middle])
    r_y = float(flanks.r[middle])
    pitch = np.angle(np.exp(1j * (behind - np.roll(behind, 1))))
    # An arc on the reference circle is the angle times its radius; 1e-6 um is rounding of angles of 1 rad.
    assert (pitch - gear.nominal.tau) * gear.nominal.r / UM == pytest.approx(f_p, abs=1e-6)
    assert r_y > gear.nominal.r_b


def test_single_pitches_are_the_running_sum_with_the_contracts_signs(tmp_path: Path) -> None:
    f_p = np.array([1.0, -2.0, 4.0, -3.0] + [0.0] * 14)
    for which, sense in (("driving", -1.0), ("driven", 1.0)):
        rest = [0.0] * (0 if which == "driving" else 7)
        pair = gearpoly.Pair.of(sides(which, single_pitch_um=[*f_p.tolist(), *rest]))
        stated = with_sheets_stated(pair.file, path=tmp_path / "pair.toml")
        sheet = getattr(stated, which).inspection
        z = getattr(stated, which).teeth
        sums = np.cumsum(np.pad(f_p, (0, z - 18)))
        assert sheet.pitch_um == pytest.approx(sense * COS * (sums - sums.mean()), abs=1e-12)
        assert sheet.single_pitch_um is None
        # A fitted file is written from this, and is read again.
        (tmp_path / "again.toml").write_text(dump_pair(stated), encoding="utf-8")
        assert getattr(read_pair(tmp_path / "again.toml"), which).inspection.pitch_um == sheet.pitch_um


def test_index_deviations_are_not_taken_for_single_pitches() -> None:
    index = [float(k) for k in range(18)]
    with pytest.raises(InputFileError, match=r"add up to 153 um.*index deviations \(F_p's\) belong in pitch_um"):
        gearpoly.Pair.of(sides("driving", single_pitch_um=index))
    # Rounded to whole um, a sheet of 18 teeth may be 9 um off.
    gearpoly.Pair.of(sides("driving", single_pitch_um=[3.0, 2.0, *[0.0] * 16]))
    gearpoly.Pair.of(sides("driving", single_pitch_um=[0.1, 0.2, -0.1, *[0.0] * 15]))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"pitch_um": 0.0, "single_pitch_um": 0.0}, "single_pitch_um: stated, and pitch_um too"),
        ({"pitch_coast_um": 0.0, "single_pitch_coast_um": 0.0}, "pitch_coast_um too"),
        ({"span_mm": 15.0, "span_teeth": 3, "tooth_thickness_um": 0.0}, "span_mm: stated, and tooth_thickness_um too"),
        ({"span_mm": 15.0, "span_teeth": 3, "over_pins_mm": 40.0, "pin_diameter_mm": 3.5}, "and span_mm too"),
        ({"span_mm": 15.0}, "want span_teeth beside it"),
        ({"pin_diameter_mm": 3.5}, "want over_pins_mm beside it"),
        ({"span_mm": 25.0, "span_teeth": 3}, "does not touch the involutes"),
        ({"over_pins_mm": 40.0, "pin_diameter_mm": 1.0}, "do not touch the involutes"),
        ({"gde": "a.gde", "span_mm": 15.0, "span_teeth": 3}, "and span_mm too"),
    ],
)
def test_what_states_one_thing_twice_or_nothing_is_refused(keys: dict[str, Any], words: str) -> None:
    with pytest.raises(InputFileError, match=words):
        gearpoly.Pair.of(sides("driving", **keys))


def outline(z: int, x: float) -> tuple[gearpoly.PairGear, shapely.Polygon]:
    """A drawn gear 73 um thin, tooth 0 about the +x axis, chords off by 1e-6 um at most."""
    sheet = {"tooth_thickness_um": -73.0}
    known = {
        "driving": {"teeth": z, "module_mm": 2.0, "profile_shift": x, "points_per_flank": 3000, "inspection": sheet},
        "driven": {"teeth": 40, "module_mm": 2.0, "points_per_flank": 20},
    }
    gear = gearpoly.Pair.of(known).driving
    # The coast flank alone was moved: half of it turns the tooth's middle.
    middle = gear.mounted.centre_lines[0] + 0.5 * 0.073 / gear.nominal.r
    return gear, shapely.affinity.rotate(gear.polygon, -middle, origin=(0.0, 0.0), use_radians=True)


def thickness(z: int, x: float, **keys: float) -> float:
    sheet = {"driving": {"teeth": z, "module_mm": 2.0, "profile_shift": x, "points_per_flank": 20, "inspection": keys}}
    known = sheet | {"driven": {"teeth": 40, "module_mm": 2.0, "points_per_flank": 20}}
    stated = with_sheets_stated(gearpoly.Pair.of(known).file, path="pair.toml")
    assert stated.driving.inspection is not None
    E_s = stated.driving.inspection.tooth_thickness_um
    assert isinstance(E_s, float)
    return E_s


CHORDS = 2e-3
"""um. What chords of 3000 points take off an outline, and fillets' nothing: span and pins touch involutes."""


@pytest.mark.parametrize(("z", "x", "k"), [(18, 0.0, 3), (25, 0.3, 4), (41, -0.2, 5)])
def test_a_span_over_the_drawn_gear_gives_its_thickness(z: int, x: float, k: int) -> None:
    """Callipers on the polygon: the width of k teeth across their middle."""
    gear, polygon = outline(z, x)
    ring = shapely.get_coordinates(polygon.exterior)
    angle = np.arctan2(ring[:, 1], ring[:, 0]) - math.pi * (k - 1) / z
    r = np.hypot(ring[:, 0], ring[:, 1])
    # Callipers are set above the fillets, which flare out.
    flanks = gear.mounted.flanks
    teeth = (np.abs(angle) < math.pi * k / z) & (r > flanks.r[flanks.root.n])
    across = (r * np.sin(angle))[teeth]
    assert thickness(z, x, span_mm=float(np.ptp(across)), span_teeth=k) == pytest.approx(-73.0, abs=CHORDS)


@pytest.mark.long
@pytest.mark.parametrize(
    ("z", "x"), [(18, 0.0), (25, 0.3), *(pytest.param(*one, marks=pytest.mark.slow) for one in ((40, -0.2), (41, 0.0)))]
)
def test_pins_in_the_drawn_gear_give_its_thickness(z: int, x: float) -> None:
    """A pin sinks into a space of the polygon until it touches both sides, and so does one opposite."""
    D = 3.5
    _, polygon = outline(z, x)

    def sunk(space: int) -> complex:
        direction = np.exp(1j * math.pi * (2 * space + 1) / z)
        low, high = 0.8 * z, 1.4 * z  # mm; radii that lie inside the body and outside everything
        for _ in range(60):
            middle = 0.5 * (low + high)
            point = middle * direction
            away = shapely.distance(polygon, shapely.Point(point.real, point.imag)) > 0.5 * D
            low, high = (low, middle) if away else (middle, high)
        return complex(high * direction)

    M = abs(sunk(0) - sunk(z // 2)) + D
    assert thickness(z, x, over_pins_mm=M, pin_diameter_mm=D) == pytest.approx(-73.0, abs=CHORDS)


@pytest.mark.parametrize(
    ("z", "k", "factor"),
    [(17, 2, 4.6663), (20, 3, 7.6604), (25, 3, 7.7305), (30, 4, 10.7526), (50, 6, 16.9370)],
)
def test_spans_of_the_handbooks_tables_are_of_nominal_teeth(z: int, k: int, factor: float) -> None:
    """W_k / m at 20 deg without profile shift, to four digits, of which half the last is 0.1 um at m = 2."""
    assert thickness(z, 0.0, span_mm=2.0 * factor, span_teeth=k) == pytest.approx(0.0, abs=0.1 / COS + 1e-6)


@pytest.mark.parametrize(("z", "x"), [(18, 0.0), (24, 0.4), (40, -0.2), (19, 0.0), (41, 0.3)])
def test_pins_by_the_closed_form_are_of_nominal_teeth(z: int, x: float) -> None:
    """M = m z cos(alpha) / cos(phi) + D, times cos(pi / 2 z) before D where z is odd, inv phi = D / d_b + inv alpha
    + 2 x tan(alpha) / z - pi / 2 z (ISO 21771:2007, 5.5), phi found by bisection."""
    m, D, alpha = 2.0, 1.728 * 2.0, math.radians(20.0)
    inv = math.tan(alpha) - alpha + D / (m * z * math.cos(alpha)) + 2.0 * x * math.tan(alpha) / z - math.pi / (2 * z)
    low, high = 0.0, 1.4
    for _ in range(80):
        phi = 0.5 * (low + high)
        low, high = (phi, high) if math.tan(phi) - phi < inv else (low, phi)
    M = m * z * math.cos(alpha) / math.cos(phi) * (math.cos(math.pi / (2 * z)) if z % 2 else 1.0) + D
    assert thickness(z, x, over_pins_mm=M, pin_diameter_mm=D) == pytest.approx(0.0, abs=1e-6)  # um: bisection to 1e-16


def test_the_mean_of_several_sizes_counts() -> None:
    nominal = 15.2648  # W_3 of 18 teeth, module 2, from the handbooks' tables (7.6324 m, four digits)
    each = [nominal - 0.02, nominal - 0.03, nominal - 0.04]
    E_s = thickness(18, 0.0, span_mm=each, span_teeth=3)  # type: ignore[arg-type]
    assert E_s == pytest.approx(-30.0 / COS, abs=0.2)  # the tables' last digit is 0.1 um of m


def test_torque_on_the_input_shaft(tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    text = "[pair]\n{torque}\n[driving]\nteeth = 18\nmodule_mm = 2\n{width}\n"
    text += "[driven]\nteeth = 25\nmodule_mm = 2\n{width}\n"
    width = "face_width_mm = 20\npoints_per_flank = 60"
    file.write_text(text.format(torque="torque_driving_nm = 18.0", width=width))
    pair = read_pair(file)
    assert pair.torque_nm == pytest.approx(25.0, rel=1e-15)  # times z_2/z_1
    assert "torque_driving_nm = 18.0" in dump_pair(pair)
    here = gearpoly.Pair.read(file).simulate(turns=0.04, points_per_mesh=4, fast=True)
    file.write_text(text.format(torque="torque_nm = 25.0", width=width))
    there = gearpoly.Pair.read(file).simulate(turns=0.04, points_per_mesh=4, fast=True)
    assert here.summary == there.summary
    file.write_text(text.format(torque="torque_nm = 25.0\ntorque_driving_nm = 18.0", width=width))
    with pytest.raises(InputFileError, match=r"pair\.torque_driving_nm: 18\.0, and torque_nm = 25\.0 too"):
        read_pair(file)
    file.write_text(text.format(torque="torque_driving_nm = 18.0", width=""))
    with pytest.raises(InputFileError, match=r"pair\.torque_driving_nm = 18\.0 bends the teeth"):
        read_pair(file)
    assert "pair.torque_driving_nm" in known_keys()


def test_no_value_is_rounded_and_no_zero_is_negative(gearpoly_command: Command, tmp_path: Path) -> None:
    pair, sheet = written(gearpoly_command, tmp_path)
    fill(sheet, {("driving", "pitch_um"): np.full(18, -0.0), ("driven", "single_pitch_um"): np.full(25, -0.0)})
    text = dump_pair(with_sheets_stated(read_pair(pair), path=pair))
    assert "-0.0" not in text
    drawn = assemble(read_pair(pair), path=pair, seed=0)
    assert drawn.origin == ("inspected", "inspected")


def test_a_thickness_beside_outright_coast_flanks_is_told_to_count_for_nothing(tmp_path: Path) -> None:
    """A sheet has both flanks about their own means, and -45 um of thickness: by pitch_coast_um the teeth are of
    nominal thickness, and recordings of both flanks had 99 um of play that nobody could explain. The cure makes the
    flanks stand where the thickness has them, which without a list they do by themselves."""

    def pair(**sheet: Any) -> PairFile:
        gear = {"teeth": 24, "module_mm": 2.0, "face_width_mm": 10.0}
        return PairFile.model_validate({"driving": {**gear, "inspection": sheet}, "driven": gear})

    index = np.round(3.0 * np.cos(2.0 * np.pi * np.arange(24) / 24), 2)
    both = {"pitch_um": index.tolist(), "pitch_coast_um": (-index).tolist()}
    wrong = pair(**both, tooth_thickness_um=-45.0)
    (told,) = thickness_remarks(wrong)
    assert "+42.3 um from where tooth_thickness_um" in told and "add -42.3 um to each" in told
    # Of lists that begin at 0 what is to be added is another.
    from_0 = {"pitch_um": (index - 3.0).tolist(), "pitch_coast_um": (3.0 - index).tolist()}
    (told,) = thickness_remarks(pair(**from_0, tooth_thickness_um=-45.0))
    assert "+42.3 um from where" in told and "add -42.3 um to each" in told
    (told,) = thickness_remarks(pair(**{**from_0, "pitch_coast_um": (-index).tolist()}, tooth_thickness_um=-45.0))
    assert "add -39.3 um to each" in told
    (tmp_path / "pair.toml").write_text(dump_pair(wrong), encoding="utf-8")
    with pytest.raises(JammedError, match="leave tooth_thickness_um out"):
        gearpoly.load(tmp_path / "pair.toml").simulate()
    right = pair(**{**both, "pitch_coast_um": np.round(-index - 45.0 * COS, 2).tolist()}, tooth_thickness_um=-45.0)
    plain = pair(pitch_um=index.tolist(), tooth_thickness_um=-45.0)
    single = pair(**{**both, "pitch_coast_um": None}, single_pitch_coast_um=[0.0] * 24, tooth_thickness_um=-45.0)
    for one in (right, plain, single):
        assert not [*thickness_remarks(with_sheets_stated(one, path=tmp_path / "pair.toml"))]
