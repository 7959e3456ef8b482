"""REXS designs: read in every file and version, written and read back equal, valid by the schema, refused safely."""

from __future__ import annotations

import json
import math
import zipfile
from pathlib import Path

import pytest
from lxml import etree

from gearpoly.assemble import assemble
from gearpoly.errors import InputFileError
from gearpoly.export.design import design_model
from gearpoly.files.pairfile import read_pair
from gearpoly.files.rexs.source import REXS_SIZE_LIMIT_BYTES, read_model
from gearpoly.files.rexs.write import json_text, xml_text
from tests.made_command import Command

ROOT = Path(__file__).parents[1]
PLACES = [folder / "shared" / "formats" / "rexs" for folder in ROOT.parents]
SHARED = next((place for place in PLACES if place.is_dir()), PLACES[0])
GRADED = ROOT / "data" / "pairs" / "graded_18_25.toml"

OLD = """\
<?xml version="1.0" encoding="UTF-8"?>
<model version="1.2" applicationId="hand" applicationVersion="1" date="2020-01-01T00:00:00+01:00">
 <relations>
  <relation id="1" type="stage">
   <ref id="10" role="stage"/><ref id="1" role="gear_1"/><ref id="2" role="gear_2"/></relation>
  <relation id="2" type="stage_gear_data">
   <ref id="10" role="stage"/><ref id="1" role="gear"/><ref id="11" role="stage_gear_data"/></relation>
  <relation id="3" type="stage_gear_data">
   <ref id="10" role="stage"/><ref id="2" role="gear"/><ref id="12" role="stage_gear_data"/></relation>
  <relation id="4" type="flank"><ref id="1" role="gear"/><ref id="3" role="left"/><ref id="4" role="right"/></relation>
  <relation id="5" type="flank"><ref id="2" role="gear"/><ref id="5" role="left"/><ref id="6" role="right"/></relation>
  <relation id="6" type="ordered_reference" order="1">
   <ref id="1" role="origin"/><ref id="7" role="referenced"/></relation>
  <relation id="7" type="reference"><ref id="3" role="origin"/><ref id="8" role="referenced"/></relation>
 </relations>
 <components>
  <component id="1" type="cylindrical_gear" name="pinion">
   <attribute id="number_of_teeth" unit="none">17</attribute>
   <attribute id="normal_module" unit="mm">2.5</attribute>
   <attribute id="helix_angle_reference_diameter" unit="°">0.0</attribute>
   <attribute id="face_width" unit="mm">20</attribute><attribute id="tip_diameter" unit="mm">48.0</attribute>
   <attribute id="single_pitch_deviation_iso_1328_2013" unit="mum">7.5</attribute></component>
  <component id="2" type="cylindrical_gear" name="wheel">
   <attribute id="number_of_teeth" unit="none">30</attribute>
   <attribute id="normal_module" unit="mm">2.5</attribute>
   <attribute id="face_width" unit="mm">18</attribute><attribute id="root_diameter" unit="mm">68.75</attribute>
   <attribute id="inner_diameter" unit="mm">25</attribute>
   <attribute id="rotational_speed" unit="1 / min">-120</attribute>
  </component>
  <component id="3" type="flank_geometry"><attribute id="normal_pressure_angle" unit="°">20</attribute>
   <attribute id="addendum_modification_coefficient" unit="none">0.1</attribute></component>
  <component id="4" type="flank_geometry">
   <attribute id="normal_pressure_angle" unit="rad">0.3490658503988659</attribute>
   <attribute id="addendum_modification_coefficient" unit="none">0.1</attribute></component>
  <component id="5" type="flank_geometry"><attribute id="normal_pressure_angle" unit="°">20</attribute></component>
  <component id="6" type="flank_geometry"><attribute id="normal_pressure_angle" unit="°">20</attribute></component>
  <component id="7" type="rack_shaped_tool">
   <attribute id="addendum_coefficient_reference_profile" unit="none">1.3</attribute>
   <attribute id="dedendum_coefficient_reference_profile" unit="none">1.4</attribute>
   <attribute id="tip_corner_radius_reference_profile" unit="mm">0.75</attribute></component>
  <component id="8" type="tip_relief"><attribute id="tip_relief_depth" unit="mm">0.010</attribute>
   <attribute id="tip_relief_datum_diameter" unit="mm">46.0</attribute>
   <attribute id="tip_relief_evaluation_reference" unit="mm">47.0</attribute>
   <attribute id="shape_of_relief" unit="none">linear</attribute></component>
  <component id="10" type="cylindrical_stage" name="stage"><attribute id="center_distance" unit="mm">59.0</attribute>
   <attribute id="upper_center_distance_allowance" unit="mum">20</attribute></component>
  <component id="11" type="stage_gear_data"><attribute id="is_driving_gear" unit="none">false</attribute>
   <attribute id="loaded_tooth_flank" unit="none">left</attribute></component>
  <component id="12" type="stage_gear_data"><attribute id="is_driving_gear" unit="none">true</attribute>
   <attribute id="torque" unit="N mm">-30000</attribute></component>
 </components>
</model>
"""


def write(folder: Path, text: str | bytes, name: str = "design.rexs") -> Path:
    file = folder / name
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    return file


def test_an_old_design_is_read_as_it_says(gearpoly_command: Command, tmp_path: Path) -> None:
    """Version 1.2: degrees as a sign, the old names of flanks and stage data, the tool that cuts from its reference."""
    file = tmp_path / "pair.toml"
    ran = gearpoly_command("pair", "--from", write(tmp_path, OLD), file)
    assert ran.code == 0, ran.err
    pair = read_pair(file)
    # The second gear drives. 30 N.m on it, 120 rpm; senses are not part of a pair file.
    assert (pair.driving.teeth, pair.driven.teeth) == (30, 17)
    assert (pair.pair.torque_driving_nm, pair.pair.speed_rpm, pair.pair.centre_distance_mm) == (30.0, 120.0, 59.0)
    pinion, wheel = pair.driven, pair.driving
    # d_a = m (z + 2 x + 2 h_a), d_f = m (z + 2 x - 2 h_f); the tool's addendum is the pinion's dedendum.
    assert pinion.profile_shift == 0.1
    assert pinion.addendum == pytest.approx((48.0 / 2.5 - 17) / 2 - 0.1, abs=1e-12)
    assert (pinion.dedendum, pinion.root_radius) == (1.3, 0.3)
    assert wheel.dedendum == pytest.approx((30 - 68.75 / 2.5) / 2, abs=1e-12)
    assert (wheel.face_width_mm, wheel.bore_mm) == (18.0, 25.0)
    assert pinion.limits is not None
    assert pinion.limits.f_pt_um == 7.5
    # The relief is stated at 47 mm; along the roll length, in which it grows, the tip has more of it.
    r_b = 0.5 * 2.5 * 17 * math.cos(math.radians(20.0))
    start, at, tip = (math.sqrt(0.25 * d * d - r_b * r_b) for d in (46.0, 47.0, 48.0))
    assert pinion.tip_relief is not None
    assert pinion.tip_relief.amount_um == pytest.approx(10.0 * (tip - start) / (at - start), abs=1e-5)
    assert (pinion.tip_relief.length_mm, pinion.tip_relief.shape, pinion.tip_relief.flank) == (1.0, "linear", "drive")
    for said in ("allowances of the centre distance are not taken", "states no tip_diameter", "0 is taken"):
        assert said in ran.err


@pytest.mark.parametrize("version", ["1.0", "1.1", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0", "2.0.0"])
def test_every_version_is_read(tmp_path: Path, version: str) -> None:
    text = OLD.replace('version="1.2"', f'version="{version}"')
    assert len(read_model(write(tmp_path, text)).components) == 11


@pytest.mark.parametrize("ending", ["rexs", "rexsj", "rexsz"])
def test_a_pair_goes_out_and_comes_back(gearpoly_command: Command, tmp_path: Path, ending: str) -> None:
    """All that a design holds: gears, tool, relief, grade, torque, speed, centre distance."""
    design, file = tmp_path / f"d.{ending}", tmp_path / "pair.toml"
    assert gearpoly_command("export", GRADED, "--to", design).code == 0
    assert gearpoly_command("pair", "--from", design, file).code == 0
    first, again = read_pair(GRADED), read_pair(file)
    one, two = (assemble(pair, path=path, seed=3) for pair, path in ((first, GRADED), (again, file)))
    assert two.pair.driving.gear == one.pair.driving.gear
    assert two.pair.driven.gear == one.pair.driven.gear
    assert two.pair.a == one.pair.a
    for gear in ("driving", "driven"):
        mine, its = getattr(first, gear), getattr(again, gear)
        assert (its.grade, its.tip_relief.amount_um) == (mine.grade, mine.tip_relief.amount_um)
        assert its.tip_relief.length_mm == pytest.approx(mine.tip_relief.length_mm, abs=1e-9)  # by way of a diameter
    assert (again.torque_nm, again.pair.speed_rpm) == (first.torque_nm, first.pair.speed_rpm)


@pytest.mark.parametrize("flank", ["drive", "coast", "both"])
def test_a_relief_on_one_flank_stays_there(gearpoly_command: Command, tmp_path: Path, flank: str) -> None:
    text = GRADED.read_text(encoding="utf-8").replace('"parabolic"', f'"linear"\nflank = "{flank}"')
    source, design, file = tmp_path / "a.toml", tmp_path / "d.rexs", tmp_path / "b.toml"
    source.write_text(text, encoding="utf-8")
    assert gearpoly_command("export", source, "--to", design).code == 0
    assert gearpoly_command("pair", "--from", design, file).code == 0
    for gear in ("driving", "driven"):
        assert getattr(read_pair(file), gear).tip_relief.flank == flank


def test_what_is_no_design_is_said(gearpoly_command: Command, tmp_path: Path) -> None:
    source = tmp_path / "a.toml"
    text = "[driving]\nteeth = 18\nmodule_mm = 2\nwear_um = 3.0\n[driving.inspection]\npitch_um = 1.0\n"
    source.write_text(text + "[driven]\nteeth = 25\nmodule_mm = 2\n", encoding="utf-8")
    ran = gearpoly_command("export", source, "--to", tmp_path / "d.rexs")
    assert ran.code == 0
    assert "left out: driving.inspection, driving.wear_um" in ran.err
    for option in (("--gear", "driving"), ("--magnify", "10"), ("--curves", "lines")):
        ran = gearpoly_command("export", source, "--to", tmp_path / "e.rexs", *option)
        assert ran.code == 2 and "leave" in ran.err and not (tmp_path / "e.rexs").exists()


@pytest.mark.skipif(not SHARED.is_dir(), reason="the schema of REXS is not beside this folder")
def test_what_is_written_is_valid(tmp_path: Path) -> None:
    """By FVA's XML schema, and every attribute is one of its component, in its unit, by FVA's database of 2.0."""
    pair = read_pair(GRADED)
    model = design_model(pair, assemble(pair, path=GRADED, seed=0))
    document = etree.fromstring(xml_text(model).encode())
    etree.XMLSchema(etree.parse(str(SHARED / "rexs-file.xsd"))).assertValid(document)
    base = etree.parse(str(SHARED / "rexs_schema_2.0.0.xml")).getroot()
    units = {one.get("id"): one.get("name") for one in base.find("units")}
    attributes = {one.get("numericId"): one for one in base.find("attributes")}
    known = {
        (one.get("componentId"), one.get("attributeId")): units[attributes[one.get("attributeNumericId")].get("unit")]
        for one in base.find("componentAttributeMappings")
    }
    for component in model.components.values():
        for key, attribute in component.attributes.items():
            assert known[component.type, key] == attribute.unit, key
    roles = {one.get("relationId"): one for one in base.find("relations")}
    for relation in model.relations:
        allowed = [
            {(part.get("roleId"), part.get("componentId")) for part in combination}
            for combination in roles[relation.type].find("allowedCombinations")
        ]
        assert {(role, model.components[ref].type) for role, ref in relation.refs} in allowed, relation.type


@pytest.mark.skipif(not SHARED.is_dir(), reason="FVA's own models are not beside this folder")
def test_fvas_own_models(gearpoly_command: Command, tmp_path: Path) -> None:
    planetary = SHARED / "FVA_Planetary_stage_-_Minus_gearing_1.1.rexs"
    file = tmp_path / "pair.toml"
    ran = gearpoly_command("pair", "--from", planetary, file)
    assert ran.code == 2 and "6 stages; say which with --stage: 211 (17 / 22 teeth)" in ran.err
    ran = gearpoly_command("pair", "--from", planetary, file, "--stage", "220")
    assert ran.code == 2 and "a ring gear" in ran.err and "--stage may name 211" in ran.err
    ran = gearpoly_command("pair", "--from", planetary, file, "--stage", "211")
    assert ran.code == 2 and "--as driving or --as driven" in ran.err
    ran = gearpoly_command("pair", "--from", planetary, file, "--stage", "211", "--as", "driving")
    assert ran.code == 0, ran.err
    pair = read_pair(file)
    assert (pair.driving.teeth, pair.driven.teeth, pair.driving.module_mm) == (17, 22, 4.0)
    for ending in ("rexs", "rexsj", "rexsz"):
        design, again = tmp_path / f"design.{ending}", tmp_path / f"{ending}.toml"
        assert gearpoly_command("export", file, "--to", design).code == 0
        assert gearpoly_command("pair", "--from", design, again).code == 0
        assert read_pair(again) == pair
    helical = SHARED / "FVA-Industriegetriebe_2stufig_1-4.rexs"
    ran = gearpoly_command("pair", "--from", helical, tmp_path / "h.toml", "--stage", "19")
    assert ran.code == 2 and "helical, 21 deg; want external spur gears" in ran.err


def test_a_file_that_exists_is_not_written_over(gearpoly_command: Command, tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    file.write_text("mine", encoding="utf-8")
    ran = gearpoly_command("pair", "--from", write(tmp_path, OLD), file)
    assert ran.code == 2 and "this file exists" in ran.err
    assert file.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('version="1.2"', 'version="3.0"', ('"3.0"', "1.0 to 1.7 or 2.0")),
        ('version="1.2" ', "", ("no version",)),
        ('unit="mm">2.5', 'unit="inch">2.5', ("normal_module", 'unit "inch"', "mm")),
        ('unit="mm">2.5', 'unit="mm">two', ('"two"', "want a number")),
        ('unit="none">17', 'unit="none">17.5', ("number_of_teeth", "whole number")),
        ('unit="none">17', 'unit="none">3', ("teeth", "5 or more")),
        ('unit="none">0.1', 'unit="none">0.2', ("left 0.2 and right 0.1", "same on both flanks")),
        ('"none">false', '"none">true', ("does not say which gear drives", "--as driving or --as driven")),
        ('"none">false', '"none">perhaps', ("true or false",)),
        ('id="2" role="gear_2"', 'id="99" role="gear_2"', ("component 99, which is not there",)),
        ('component id="8"', 'component id="7"', ("component 7 twice",)),
        ('component id="8"', 'component id="x"', ('"x"', "whole number")),
        ('unit="°">0.0', 'unit="°">12.5', ("helical, 12.5 deg",)),
        ('unit="mm">48.0', 'unit="mm">1', ("tip_diameter_mm", "want a diameter in mm from")),
        ("</model>", "", ("no XML",)),
        (
            '<?xml version="1.0" encoding="UTF-8"?>',
            '<!DOCTYPE model [<!ENTITY a "a"><!ENTITY b "&a;&a;&a;&a;">]>',
            ("declares entities", "nothing of the kind is expanded"),
        ),
        (
            '<?xml version="1.0" encoding="UTF-8"?>',
            '<!DOCTYPE model SYSTEM "file:///etc/passwd">',
            ("declares entities or fetches others",),
        ),
    ],
)
def test_faults_of_a_design(
    gearpoly_command: Command, tmp_path: Path, old: str, new: str, words: tuple[str, ...]
) -> None:
    assert old in OLD
    ran = gearpoly_command("pair", "--from", write(tmp_path, OLD.replace(old, new, 1)), tmp_path / "pair.toml")
    assert ran.code == 2, ran.err
    for word in ("design.rexs", *words):
        assert word in ran.err
    assert not (tmp_path / "pair.toml").exists()


def test_which_gear_drives_can_be_said_and_not_contradicted(gearpoly_command: Command, tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    silent = write(tmp_path, OLD.replace('"none">false', '"none">true', 1))
    assert gearpoly_command("pair", "--from", silent, file, "--as", "driving").code == 0
    assert read_pair(file).driving.teeth == 17
    ran = gearpoly_command("pair", "--from", write(tmp_path, OLD), tmp_path / "b.toml", "--as", "driving")
    assert ran.code == 2 and "leave --as out" in ran.err
    for option in (("--flank", "left"), ("--count", "clockwise"), ("--map", "map.toml")):
        ran = gearpoly_command("pair", "--from", write(tmp_path, OLD), tmp_path / "b.toml", *option)
        assert ran.code == 2 and f"leave {option[0]} out" in ran.err


def zipped(folder: Path, parts: dict[str, bytes]) -> Path:
    file = folder / "design.rexsz"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    return file


def refused(file: Path) -> str:
    with pytest.raises(InputFileError) as refusal:
        read_model(file)
    return str(refusal.value)


@pytest.mark.long
def test_zips_that_are_no_model(tmp_path: Path) -> None:
    """A bomb is unpacked to the limit and no further; attached files are never opened."""
    assert "unpacks to more" in refused(zipped(tmp_path, {"a.rexs": b" " * (REXS_SIZE_LIMIT_BYTES + 1)}))
    assert "0 models" in refused(zipped(tmp_path, {"a.txt": b"x"}))
    assert "2 models" in refused(zipped(tmp_path, {"a.rexs": b"x", "b.rexsj": b"x"}))
    assert "1001 files" in refused(zipped(tmp_path, {f"{n}.txt": b"" for n in range(1001)}))
    assert "no XML" in refused(zipped(tmp_path, {"a.rexs": b"PK\3\4"}))
    whole = zipped(tmp_path, {"a.rexs": OLD.encode(), "../evil.bin": b"x"})
    assert len(read_model(whole).components) == 11
    assert not (tmp_path.parent / "evil.bin").exists()
    data = bytearray(whole.read_bytes())
    data[60:90] = bytes(30)
    assert "zip" in refused(write(tmp_path, bytes(data), "broken.rexsz"))
    assert "zip" in refused(write(tmp_path, data[:200], "cut.rexsz"))


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("<other/>", "<other>"),
        ('{"model": ', "no JSON"),
        ("{}", 'no "model"'),
        ('{"model": {"version": "2.0", "components": [{"id": NaN}]}}', "no number of JSON"),
        ('{"model": {"version": "2.0", "components": [{"id": 1.5, "type": "a"}]}}', '"1.5"'),
        ('{"model": {"version": 2.0, "components": []}}', "no cylindrical stage"),
        ('{"a":' * 100_000, "nested too deep"),
        ('{"model": {"version": "2.0", "x": ' + "9" * 5000 + "}}", "no JSON"),
    ],
)
def test_json_that_is_no_model(gearpoly_command: Command, tmp_path: Path, text: str, word: str) -> None:
    ran = gearpoly_command("pair", "--from", write(tmp_path, text, "d.rexsj"), tmp_path / "p.toml")
    assert ran.code == 2 and word in ran.err and not (tmp_path / "p.toml").exists()


def test_json_with_a_mark_says_what_xml_says(tmp_path: Path) -> None:
    pair = read_pair(GRADED)
    model = design_model(pair, assemble(pair, path=GRADED, seed=0))
    plain = read_model(write(tmp_path, xml_text(model)))
    marked = read_model(write(tmp_path, "\ufeff" + json_text(model), "d.rexsj"))
    assert marked.relations == plain.relations == model.relations
    for number, component in model.components.items():
        assert set(marked.components[number].attributes) == set(plain.components[number].attributes)
        assert marked.components[number].attributes == dict(component.attributes)
    assert json.loads(json_text(model))["model"]["version"] == "2.0"
