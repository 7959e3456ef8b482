"""Inspection sheets of machines and tables: signs, flanks and numbering against a polygon that was measured."""

from __future__ import annotations

import itertools
import math
import re
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

import gearpoly
from gearpoly.files.pairfile import read_pair
from gearpoly.gear.gear import Gear
from gearpoly.gear.metrology import thickness_from_span
from gearpoly.units import UM
from tests.made_command import Command
from tests.made_sheets import Seen, inspect, known, mka, table

RAW = known(z=(17, 20))


POINTS = 60
"""Of a profile: machines write 480, each of which costs the inspector 10 ms here."""


@pytest.fixture(scope="module")
def pair() -> gearpoly.Pair:
    return gearpoly.Pair.of(RAW)


@cache
def plain() -> Seen:
    """The driving gear with one tooth traced."""
    return inspect(gearpoly.Pair.of(RAW).driving, teeth=(1,), points=POINTS)


def beside(folder: Path) -> Path:
    """A pair file that has both gears, none of them inspected, at the centre distance of the one that was measured."""
    tables = "".join(
        f"[{name}]\nteeth = {RAW[name]['teeth']}\nmodule_mm = 2.0\nprofile_shift = {RAW[name]['profile_shift']}\n"
        f"face_width_mm = 20.0  # mm\n"
        for name in ("driving", "driven")
    )
    file = folder / "pair.toml"
    file.write_text(f"# mine\n[pair]\ncentre_distance_mm = 37.3\n{tables}", encoding="utf-8")
    return file


def written(folder: Path, text: str, name: str = "sheet.mka", encoding: str = "utf-8-sig") -> Path:
    file = folder / name
    file.write_text(text, encoding=encoding)
    return file


def deviations(gear: Any, flank: Literal["drive", "coast"], l: np.ndarray) -> np.ndarray:
    """Deviations (z, n) in um, the mean of all teeth at the reference circle taken off: a sheet of pitch and profiles
    does not say where all flanks stand together."""
    out = gear.deviation(l, flank=flank) / UM
    return out - np.mean(gear.deviation(np.array([gear.nominal.l_pitch]), flank=flank) / UM)


@pytest.mark.long
@pytest.mark.parametrize("which", ["driving", "driven"])
@pytest.mark.parametrize("face", ["datum", "other"])
@pytest.mark.parametrize("count", ["clockwise", "counterclockwise"])
def test_a_gear_measured_on_its_polygon_comes_back(
    pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path, which: str, face: Any, count: str
) -> None:
    """Each flank of each tooth, whichever gear it is, from whichever face it was seen and however teeth were counted.
    Seen on the datum face the left flank drives; turned over, what was left is right."""
    gear = getattr(pair, which)
    seen = inspect(gear, face=face, count=count, teeth=(1, 2, 5), points=POINTS)
    sheet = written(tmp_path, mka(seen, turned=face == "datum"))
    file = beside(tmp_path)
    ran = gearpoly_command(
        "pair", "--from", sheet, file, "--as", which, "--flank", "left" if face == "datum" else "right"
    )
    assert ran.code == 0, ran.err
    assert f"teeth are counted {count}" in ran.err
    again = getattr(gearpoly.Pair.read(file), which)
    at = np.array([gear.nominal.l_pitch])
    for flank in ("drive", "coast"):
        # Sheets print 0.001 um, chords lie 0.001 um under the flank, and the level of the teeth without a profile is
        # that of their mean slope: it moves all of them alike, by less than half a um.
        mine, its = deviations(gear, flank, at)[:, 0], deviations(again, flank, at)[:, 0]  # type: ignore[arg-type]
        traced = [tooth for tooth in range(gear.nominal.z) if _was_traced(file, which, tooth, flank)]
        rest = [tooth for tooth in range(gear.nominal.z) if tooth not in traced]
        for group in (traced, rest):
            assert np.ptp((mine - its)[group]) < 0.01
        assert np.ptp(mine) > 5.0  # so that a wrong sign or order shows
    # Whole profiles of the teeth that were traced, and on which tooth they stand.
    l = np.linspace(0.5 * gear.nominal.l_pitch, 0.98 * gear.nominal.l_a, 40)
    l = l[l > np.sqrt(0.25 * seen.start**2 - gear.nominal.r_b**2) + 0.05]
    sense = 1 if (count == "clockwise") == ((which == "driving") == (face == "datum")) else -1
    for tooth, flank in itertools.product((1, 2, 5), ("drive", "coast")):
        k = (sense * (tooth - 1)) % gear.nominal.z
        mine, its = gear.deviation(l, flank=flank)[k], again.deviation(l, flank=flank)[k]
        assert np.ptp(mine - its) / UM < 0.05  # linear between 60 points, printed to 0.001, chords of 0.001 um


def _was_traced(file: Path, which: str, tooth: int, flank: str) -> bool:
    text = (file.parent / f"pair_{which}_profiles.csv").read_text(encoding="utf-8")
    return f"\n{tooth},{flank}," in text


@pytest.mark.long
def test_the_transmission_error_comes_back(pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path) -> None:
    """Both gears from their sheets, all teeth traced, mesh as the pair that was measured."""
    file = beside(tmp_path)
    for which in ("driving", "driven"):
        gear = getattr(pair, which)
        sheet = written(
            tmp_path, mka(inspect(gear, teeth=tuple(range(1, gear.nominal.z + 1)), points=POINTS)), f"{which}.mka"
        )
        ran = gearpoly_command("pair", "--from", sheet, file, "--as", which, "--flank", "left")
        assert ran.code == 0, ran.err
    text = file.read_text(encoding="utf-8")
    assert text.startswith("# mine\n") and "# mm" in text  # what stood there stays
    again = gearpoly.Pair.read(file)
    theta = np.linspace(0.0, 2.0 * np.pi, 300, endpoint=False) + 0.001
    for flank in ("drive", "coast"):
        mine = pair.transmission_error(theta, flank=flank) * pair.mesh.r_b2 / UM
        its = again.transmission_error(theta, flank=flank) * pair.mesh.r_b2 / UM
        assert np.ptp(mine) > 5.0
        assert np.ptp(mine - its) < 0.3  # below da, where the mate's tip reaches, no profile was measured


@pytest.mark.parametrize("drawn", [{"english": True}, {"coded": False}, {"english": True, "coded": False}])
def test_words_in_english_and_headers_without_numbers(
    pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path, drawn: dict[str, bool]
) -> None:
    seen = plain()
    texts = []
    for name, text in (("a", mka(seen)), ("b", mka(seen, **drawn))):
        (tmp_path / name).mkdir()
        file = beside(tmp_path / name)
        ran = gearpoly_command(
            "pair", "--from", written(tmp_path / name, text), file, "--as", "driving", "--flank", "left"
        )
        assert ran.code == 0, ran.err
        texts.append(file.read_text(encoding="utf-8"))
    assert texts[0] == texts[1]


def test_old_files_are_in_latin_1(pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path) -> None:
    sheet = written(tmp_path, mka(plain()), encoding="latin-1")
    ran = gearpoly_command("pair", "--from", sheet, tmp_path / "p.toml", "--as", "driving", "--flank", "left")
    assert ran.code == 0, ran.err


def test_the_direction_of_counting_is_asked_for(pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path) -> None:
    """Without probed points the file does not show it. Each cure works, and a wrong statement is refused."""
    seen = plain()
    sheet, file = written(tmp_path, mka(seen, probes=False)), tmp_path / "p.toml"
    base = ("pair", "--from", sheet, file)
    for more, word in (
        ((), "--as driving or --as driven"),
        (("--as", "driving"), "--flank left or --flank right"),
        (("--as", "driving", "--flank", "left"), "--count clockwise or counterclockwise"),
    ):
        ran = gearpoly_command(*base, *more)
        assert ran.code == 2 and word in ran.err
        assert not file.exists()
    assert gearpoly_command(*base, "--as", "driving", "--flank", "left", "--count", "clockwise").code == 0
    shown = written(tmp_path, mka(seen), "shown.mka")
    other = tmp_path / "q.toml"
    ran = gearpoly_command(
        "pair", "--from", shown, other, "--as", "driving", "--flank", "left", "--count", "counterclockwise"
    )
    assert ran.code == 2 and "leave --count, or count in the map, out" in ran.err and not other.exists()


def refusal(command: Command, folder: Path, text: str, *more: str) -> str:
    """What is said of a sheet that is refused; nothing is left behind."""
    sheet, file = written(folder, text), folder / "p.toml"
    ran = command("pair", "--from", sheet, file, "--as", "driving", "--flank", "left", *more)
    assert ran.code == 2, ran.err
    assert not file.exists() and not list(folder.glob("*profiles.csv"))
    return ran.err


def test_faults_of_a_curve_file(pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path) -> None:
    seen = plain()
    good = mka(seen)

    def said(old: str, new: str) -> str:
        assert old in good
        return refusal(gearpoly_command, tmp_path, good.replace(old, new, 1))

    assert "a helix angle of 12 deg; want a spur gear" in said(
        "[Grad]............:  0.0000", "[Grad]............:  12.0000"
    )
    assert "no number of teeth" in said("Zähnezahl", "Zahl")
    assert "in the header, or [gear] end_mm in a file that --map names" in said("Ende der Messstrecke de", "Ende")
    assert "and its head says 61" in said("/ 60  Werte", "/ 61  Werte")
    assert "want teeth 1 to 17" in said("Zahn-Nr.: 1 links", "Zahn-Nr.: 18 links")
    cut = good[: good.index("rechte Zahnflanke") + 200]
    assert "a pitch table of" in refusal(gearpoly_command, tmp_path, cut)
    wrong = re.sub(r"(linke Zahnflanke.*?\n +2 +)[-.\d]+", r"\g<1>99.000", good, count=1, flags=re.DOTALL)
    assert "Fp(n) - Fp(n-1) = fp(n)" in refusal(gearpoly_command, tmp_path, wrong)
    assert "want HEADER" not in refusal(gearpoly_command, tmp_path, "tooth;fp left\n1;0\n")


def test_a_missing_range_may_stand_in_a_map(pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path) -> None:
    seen = plain()
    sheet = written(tmp_path, mka(seen).replace("Ende der Messstrecke de", "Ende"))
    layout = tmp_path / "map.toml"
    layout.write_text(f"[gear]\nend_mm = {seen.end}\n", encoding="utf-8")
    file = tmp_path / "p.toml"
    ran = gearpoly_command("pair", "--from", sheet, file, "--as", "driving", "--flank", "left", "--map", layout)
    assert ran.code == 0, ran.err


def test_profiles_over_roll_and_inches_are_refused_with_a_cure_that_works(
    pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path
) -> None:
    seen = plain()
    rolled = mka(seen).replace("PROFILE diameter", "PROFILE roll")
    said = refusal(gearpoly_command, tmp_path, rolled)
    assert 'profiles over "roll"' in said and "[gear] start_mm and end_mm" in said
    layout = tmp_path / "map.toml"
    layout.write_text(f"[gear]\nstart_mm = {seen.start}\nend_mm = {seen.end}\n", encoding="utf-8")
    file, sheet = tmp_path / "p.toml", written(tmp_path, rolled)
    ran = gearpoly_command("pair", "--from", sheet, file, "--as", "driving", "--flank", "left", "--map", layout)
    assert ran.code == 0, ran.err
    (tmp_path / "inch").mkdir()
    inches = mka(seen).replace("TYPE STI", "UNITS inch\r\nTYPE STI")
    assert "export it again in mm" in refusal(gearpoly_command, tmp_path / "inch", inches)


def test_another_gear_and_a_second_inspection_are_refused(
    pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path
) -> None:
    sheet, file = written(tmp_path, mka(plain())), beside(tmp_path)
    before = file.read_text(encoding="utf-8")
    ran = gearpoly_command("pair", "--from", sheet, file, "--as", "driven", "--flank", "left")
    assert ran.code == 2 and "teeth: 17" in ran.err and "20" in ran.err
    assert file.read_text(encoding="utf-8") == before
    assert gearpoly_command("pair", "--from", sheet, file, "--as", "driving", "--flank", "left").code == 0
    ran = gearpoly_command("pair", "--from", sheet, file, "--as", "driving", "--flank", "left")
    assert ran.code == 2 and "take [driving.inspection] out of the file" in ran.err


MEW = """\
HEADER KS.MW.FILE
TYPE STI ! type
  22 :Zähnezahl z.....: 18
  21 :Normalmodul mn..: 2.0000
  23 :Eingriffswinkel.: 20.0
  24 :Profilverschiebung x: 0.1
  51 :Kugeldurchmesser DM [mm]: 3.5
10111 : fHa links 1 : 2.0
10112 : fHa links 2 : 4.0
10130 : fHam links : 3.1
10211 : fHa rechts 1 : -9999.0
10212 : fHa rechts 2 : -1.5
20130 : Cam links : 1.25
34610 : Wk : 15.3500
"""


def test_a_file_of_values(gearpoly_command: Command, tmp_path: Path) -> None:
    """Means as printed, or of what was measured; the span over the only number of teeth that comes near; balls."""
    file = tmp_path / "p.toml"
    sheet = written(tmp_path, MEW, "sheet.mew")
    ran = gearpoly_command("pair", "--from", sheet, file, "--as", "driven", "--flank", "left")
    assert ran.code == 0, ran.err
    file.write_text(file.read_text(encoding="utf-8") + "[driving]\nteeth = 20\nmodule_mm = 2\n", encoding="utf-8")
    found = read_pair(file).driven.inspection
    assert found is not None
    assert (found.profile_slope_um, found.profile_slope_coast_um, found.profile_crowning_um) == (3.1, -1.5, 1.25)
    assert (found.span_mm, found.span_teeth) == (15.35, 3)
    gear = Gear(z=18, m=2.0, x=0.1)
    # W_k = m cos(alpha) ((k - 1/2) pi + z inv alpha) + 2 x m sin(alpha), written out; E_s = dW / cos(alpha).
    alpha = math.radians(20.0)
    W = 2.0 * math.cos(alpha) * (2.5 * math.pi + 18 * (math.tan(alpha) - alpha)) + 0.4 * math.sin(alpha)
    assert thickness_from_span(gear, 15.35, k=3) == pytest.approx((15.35 - W) / math.cos(alpha), abs=1e-12)
    balls = written(tmp_path, MEW.replace("34610 : Wk : 15.3500", "32810 : MdK : 41.2"), "balls.mew")
    other = tmp_path / "q.toml"
    assert gearpoly_command("pair", "--from", balls, other, "--as", "driven", "--flank", "left").code == 0
    assert "over_pins_mm = 41.2" in other.read_text(encoding="utf-8")
    assert "pin_diameter_mm = 3.5" in other.read_text(encoding="utf-8")


def test_slopes_whose_sign_the_machine_turns_are_not_taken(gearpoly_command: Command, tmp_path: Path) -> None:
    text = MEW.replace("10111", " 165 :Vorzeichen..: R_FHA: 1 : L: + : R: -\n10111", 1)
    file = tmp_path / "p.toml"
    ran = gearpoly_command("pair", "--from", written(tmp_path, text), file, "--as", "driven", "--flank", "left")
    assert ran.code == 0 and "profile slopes are not taken" in ran.err
    assert "slope" not in file.read_text(encoding="utf-8")


@pytest.mark.long
@pytest.mark.parametrize("which", ["driving", "driven"])
def test_a_table_says_what_curves_say(
    pair: gearpoly.Pair, gearpoly_command: Command, tmp_path: Path, which: str
) -> None:
    """Semicolons, decimal commas, German heads; in English with points; a row per flank: one gear."""
    seen = inspect(getattr(pair, which), points=POINTS)
    german = table(seen)
    left, right = (np.round(seen.single(side), 2) for side in ("left", "right"))  # type: ignore[arg-type]
    english = "# a sheet\ntooth,fp left (um),fp right (um)\n" + "".join(
        f"{n + 1},{left[n]},{right[n]}\n" for n in range(seen.z)
    )
    rows = "Tooth\tSide\tf_p [mm]\n" + "".join(
        f"{n}\t{side}\t{value / 1000:.5f}\n"
        for side, values in (("L", left), ("R", right))
        for n, value in enumerate(values)
    )
    found = []
    for name, text, encoding in (("g", german, "cp1252"), ("e", english, "utf-8"), ("r", rows, "utf-16")):
        folder = tmp_path / name
        folder.mkdir()
        file = beside(folder)
        sheet = written(folder, text, "sheet.csv", encoding)
        ran = gearpoly_command("pair", "--from", sheet, file, "--as", which, "--flank", "left", "--count", "clockwise")
        assert ran.code == 0, ran.err
        inspection = getattr(read_pair(file), which).inspection
        found.append((inspection.single_pitch_um, inspection.single_pitch_coast_um))
    for one in found[1:]:
        # f_p printed to 0.01 um beside differences of F_p printed so.
        np.testing.assert_allclose(one, found[0], atol=0.0151)
    again = getattr(gearpoly.Pair.read(file), which)
    gear = getattr(pair, which)
    at = np.array([gear.nominal.l_pitch])
    for flank in ("drive", "coast"):
        off = deviations(gear, flank, at) - deviations(again, flank, at)  # type: ignore[arg-type]
        assert np.max(np.abs(off)) < 0.01 * seen.z  # rounded single pitches add up


def test_a_map_reads_any_layout(gearpoly_command: Command, tmp_path: Path) -> None:
    sheet = written(tmp_path, "made by hand\nNr|a|note\n1|0,5|x\n2|-1,0|\n3|0,5|\n4|0,2|\n5|-0,2|\n", "sheet.txt")
    file, layout = tmp_path / "p.toml", tmp_path / "map.toml"
    base = ("pair", "--from", sheet, file, "--as", "driving", "--flank", "right")
    ran = gearpoly_command(*base)
    assert ran.code == 2 and '[columns] "NAME" = "tooth"' in ran.err
    layout.write_text(
        'count = "clockwise"\n[gear]\ndiametral_pitch = 10\n[columns]\nNr = "tooth"\na = "single_pitch_right"\n',
        encoding="utf-8",
    )
    ran = gearpoly_command(*base, "--map", layout)
    assert ran.code == 0, ran.err
    text = file.read_text(encoding="utf-8")
    assert "module_mm = 2.54" in text
    # Seen on the datum face a driving gear whose right flank drives turns clockwise; its teeth come the other way
    # round, so the pitch from the sheet's tooth 2 on to its tooth 1 is the first.
    assert "single_pitch_um = [-1.0, 0.5, -0.2, 0.2, 0.5]" in text


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("tooth,fp left,colour\n1,0,red\n", '"colour" = "ignored"'),
        ("tooth,fp\n1,0\n", "of which flank"),
        ("tooth,fp left [arcsec]\n1,0\n", "want a length: um, mm"),
        ("tooth,fp left\n1,0\n2,zero\n", '"zero"'),
        ("tooth,fp left\n1,0\n1,1\n", "tooth 1 again"),
        ("tooth,fp left\n1,0\n2,1\n4,-1\n5,0\n6,0\n7,0\n", "want a row for each"),
        ("tooth,fp left\n1,5\n2,5\n3,5\n4,5\n5,5\n", "add up to 25"),
        ("tooth,fp left,Fp left\n1,4,4\n2,4,8\n3,-4,4\n4,-4,-4\n5,0,0\n", "F_p(n) - F_p(n-1) = f_p(n)"),
        ("tooth,fp left\n1,0,7\n", "3 cells"),
        ("tooth,fp left,fp links\n1,0,7\n", "again"),
        ("tooth,fp left\n", "no rows"),
    ],
)
def test_faults_of_a_table(gearpoly_command: Command, tmp_path: Path, text: str, word: str) -> None:
    assert word in refusal(gearpoly_command, tmp_path, text, "--count", "clockwise")


@pytest.mark.parametrize(
    ("text", "layout"),
    [
        ("tooth,fp left,colour\n", '[columns]\n"colour" = "ignored"\n'),
        ("tooth,fp,_\n", '[columns]\nfp = "single_pitch_left"\n'),
        ("tooth,fp left,fp links\n", '[columns]\n"fp links" = "ignored"\n'),
        ("tooth,fp left,Fp left\n", '[columns]\n"Fp left" = "ignored"\n'),
    ],
)
def test_a_map_cures_what_a_head_leaves_open(gearpoly_command: Command, tmp_path: Path, text: str, layout: str) -> None:
    """As the refusal says, and no more than that."""
    rows = "".join(f"{n},{value},{7 * n}\n" for n, value in enumerate((1.0, -1.0, 2.0, -2.0, 0.0), start=1))
    gear = "[gear]\nmodule_mm = 2\n"
    file, sheet, chart = tmp_path / "p.toml", written(tmp_path, text + rows), tmp_path / "map.toml"
    base = ("pair", "--from", sheet, file, "--as", "driving", "--flank", "left", "--count", "clockwise", "--map", chart)
    chart.write_text(gear, encoding="utf-8")
    assert gearpoly_command(*base).code == 2
    chart.write_text(gear + layout, encoding="utf-8")
    ran = gearpoly_command(*base)
    assert ran.code == 0, ran.err
    assert "single_pitch_um = [1.0, -1.0, 2.0, -2.0, 0.0]" in file.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("label", "key"),
    [("Zähnezahl", "teeth = 17"), ("Normalmodul", "module_mm = 2.0"), ("Eingriffswinkel", "pressure_angle_deg = 20.0")],
)
def test_a_map_cures_what_a_header_lacks(gearpoly_command: Command, tmp_path: Path, label: str, key: str) -> None:
    text = mka(plain()).replace(label, "Sonst")
    said = refusal(gearpoly_command, tmp_path, text)
    assert key.partition(" ")[0] in said and "--map" in said
    chart, file = tmp_path / "map.toml", tmp_path / "p.toml"
    chart.write_text(f"[gear]\n{key}\n", encoding="utf-8")
    ran = gearpoly_command(
        "pair", "--from", tmp_path / "sheet.mka", file, "--as", "driving", "--flank", "left", "--map", chart
    )
    assert ran.code == 0, ran.err


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("count = 'up'\n", "'clockwise' or 'counterclockwise'"),
        ("counts = 'clockwise'\n", 'the nearest known key is "count"'),
        ("[gear]\nmodule_mm = -1\n", "module in mm"),
        ("[gear]\nmodule_mm = 2\ndiametral_pitch = 12.7\n", "one of the two"),
        ("[columns]\nNr = 'teeth'\n", "'tooth'"),
        ("count = \n", "want TOML"),
    ],
)
def test_faults_of_a_map(gearpoly_command: Command, tmp_path: Path, text: str, word: str) -> None:
    layout = tmp_path / "map.toml"
    layout.write_text(text, encoding="utf-8")
    said = refusal(gearpoly_command, tmp_path, "tooth,fp left\n1,0\n", "--map", str(layout))
    assert "map.toml" in said and word in said


def test_an_inspection_written_by_gearpoly_is_read_too(gearpoly_command: Command, tmp_path: Path) -> None:
    graded = Path(__file__).parents[1] / "data" / "pairs" / "graded_18_25.toml"
    assert (
        gearpoly_command("export", graded, "--to", tmp_path / "d.gde", "--gear", "driving", "--points", "8").code == 0
    )
    file = tmp_path / "p.toml"
    ran = gearpoly_command("pair", "--from", tmp_path / "d.gde", file, "--as", "driving", "--flank", "left")
    assert ran.code == 0 and "gearpoly's own subset" in ran.err
    file.write_text(file.read_text(encoding="utf-8") + "[driven]\nteeth = 25\nmodule_mm = 2\n", encoding="utf-8")
    mine, its = gearpoly.Pair.read(graded), gearpoly.Pair.read(file)
    at = np.array([mine.driving.nominal.l_pitch])
    for flank in ("drive", "coast"):
        # The traces hold the profile at 8 points; pitch and thickness are whole.
        off = (mine.driving.deviation(at, flank=flank) - its.driving.deviation(at, flank=flank)) / UM  # type: ignore[arg-type]
        assert np.max(np.abs(off)) < 1.0
        assert np.ptp(off) < 2.0 < np.ptp(mine.driving.deviation(at, flank=flank) / UM)  # type: ignore[arg-type]


def test_single_pitches_of_both_flanks_keep_the_thickness(tmp_path: Path) -> None:
    """Single pitches have no level: the coast flanks stand where the thickness has them."""
    zeros = [0.0] * 18
    raw = {
        "driving": {"teeth": 18, "module_mm": 2.0, "inspection": {
            "single_pitch_um": zeros, "single_pitch_coast_um": zeros, "tooth_thickness_um": -50.0}},
        "driven": {"teeth": 25, "module_mm": 2.0},
    }  # fmt: skip
    coast = gearpoly.Pair.of(raw).driving.deviation(np.array([7.0]), flank="coast") / UM
    np.testing.assert_allclose(coast, -50.0 * math.cos(math.radians(20.0)), rtol=1e-12)
