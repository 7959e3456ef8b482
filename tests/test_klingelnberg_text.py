"""The lines of Klingelnberg's exports in the forms that public readers know of."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from gearpoly.errors import InputFileError
from gearpoly.files.inspection.klingelnberg import read_klingelnberg
from gearpoly.files.inspection.klingelnberg_text import Probe, SheetCurve, read_export
from gearpoly.files.inspection.probes import counting

HEAD = """\
HEADER KS.MK.FILE
VERSION 5.0.0 ! version
UNDEFINED -2147483.648 ! undefined
   7 :ME/Seite/KS/LZ....: 97340-neu
  22 :Zähnezahl z.......:  6
  21 :Normalmodul mn....:  4.0
  23 :Eingriffswinkel...: 20.0
  26 :Zahnbreite [mm]...: 30.0
  41 :Start Messbereich.....da  [mm]..:  23.2      23.2
  42 :Ende der Messstrecke..de  [mm]..:  30.0      30.0
"""
KNOWN = {"profile_shift": 0.5}


def file(folder: Path, text: str) -> Path:
    path = folder / "a.mka"
    path.write_text(text, encoding="utf-8")
    return path


def curve(folder: Path, line: str, *, title: str = "") -> SheetCurve:
    (found,) = read_export(file(folder, f"{HEAD}{title}{line}\n 1.0 2.0\n -2147483.648 .5\n")).curves
    return found


@pytest.mark.parametrize(
    ("line", "title", "letter", "kind", "place"),
    [
        ("Zahn-Nr.: 4 links / 4  Werte  z= 7.500", "Profil:\n", "", "profile", 7.5),
        ("Profil:  Zahn-Nr.: 4a links / 4 Werte  / z= 17.5", "", "a", "profile", 17.5),
        ("Profile: Tooth No.: 4 left / 4 values z= -1,5", "", "", "profile", -1.5),
        ("Zahn-Nr.: 4 links / 4  Werte  x= 8.742", "Flankenlinie:\n", "", "other", 8.742),
        ("Flankenlinie:  Zahn-Nr.: 4 links / 4 Werte  d= 174.822", "", "", "other", 174.822),
        ("Verschränkung: Zahn-Nr.: 4k /Profil:3 links / 4  Werte  z= 10.263", "", "k", "other", 10.263),
    ],
)
def test_heads_of_curves(tmp_path: Path, line: str, title: str, letter: str, kind: str, place: float) -> None:
    found = curve(tmp_path, line, title=title)
    assert (found.tooth, found.side, found.letter, found.kind, found.place) == (4, "left", letter, kind, place)
    assert found.values[:2] == (1.0, 2.0) and math.isnan(found.values[2]) and found.values[3] == 0.5


def test_rows_below_the_curves(tmp_path: Path) -> None:
    """Diameters at a height, pitch tables, probed points; a line of no known form is told, not passed over."""
    text = HEAD + (
        "Fußkreisdurchmesser / Höhe :     7.500\n   49.5 49.6\nKopfkreisdurchmesser / Höhe : 7.5\n 54.0 54.1\n"
        "        linke Zahnflanke\n        Zahn-Nr.  fp  Fp  Fr\n\n  1  0.1 0.1 0.3\n  2  -0.1 0.0 -0.3\n\n"
        "Teilung:\nZ-Nr. Seite PHI X Y Z\n  1   R  0.0000  .1198  25.5249  87.2302\n\nunexpected\n"
    )
    found = read_export(file(tmp_path, text))
    (table,) = found.tables
    assert (table.side, table.names) == ("left", ("fp", "Fp", "Fr"))
    assert table.rows == {1: (0.1, 0.1, 0.3), 2: (-0.1, 0.0, -0.3)}
    assert found.probes == [Probe(tooth=1, side="right", phi=0.0, x=0.1198, y=25.5249)]
    assert len(found.unread) == 1
    assert next(one for one in found.fields if one.label.startswith("Start")).numbers() == (23.2, 23.2)


def test_of_several_profiles_the_middle_one_counts_and_leads_do_not(tmp_path: Path) -> None:
    text = HEAD
    for letter, place, values in (("a", 5.0, "9 9 9 9"), ("b", 14.0, "-1 0 1 2"), ("c", 25.0, "7 7 7 7")):
        text += f"Profil:  Zahn-Nr.: 2{letter} rechts / 4 Werte  / z= {place}\n {values}\n"
    text += "Flankenlinie:  Zahn-Nr.: 2 rechts / 2 Werte  d= 24.0\n 5 5\n"
    found = read_klingelnberg(file(tmp_path, text), known=KNOWN, count="clockwise")
    (profile,) = found.profiles
    assert (profile.tooth, profile.flank) == (2, "right")
    # From the first diameter to the last in even steps of roll length, rising to the tip; 0 at the reference circle.
    r_b = 12.0 * math.cos(math.radians(20.0))
    low, high = (math.sqrt(0.25 * d * d - r_b * r_b) for d in (23.2, 30.0))
    assert profile.roll_length == pytest.approx([low + (high - low) * k / 3 for k in range(4)], abs=1e-6)
    l_r = 12.0 * math.sin(math.radians(20.0))
    assert profile.deviation[0] == pytest.approx(-3.0 * (l_r - low) / (high - low), abs=1e-4)
    assert profile.deviation[3] - profile.deviation[0] == pytest.approx(3.0)
    said = " ".join(found.says)
    assert "lead and twist curves are not taken" in said and "nearest z = 15 mm" in said
    assert found.name == "97340-neu"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Profil: Zahn-Nr.: 1 links / 4 Werte z= 1.0\n 1 2 3\n", "a curve of 3 values, and its head says 4"),
        ("Profil: Zahn-Nr.: 1 links / 2 Werte z= 1.0\n 1 2 3\n", "a curve of 3 values, and its head says 2"),
        ("Profil: Zahn-Nr.: 1 links / 999999 Werte z= 1.0\n", "want 1 to 100000"),
        ("linke Zahnflanke\n Zahn-Nr. fa Fb\n 1 2 3\n", "want Zahn-Nr. fp Fp Fr"),
        ("linke Zahnflanke\n Zahn-Nr. fp Fp\n", "without rows"),
        ("linke Zahnflanke\n Zahn-Nr. fp Fp\n 1 0 0\n 1 0 0\n", "tooth 1 twice"),
        ("linke Zahnflanke\n Zahn-Nr. fp Fp\n 1 0 x\n", "want numbers"),
    ],
)
def test_what_is_cut_off_is_refused_with_its_line(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(InputFileError, match=r"line 1[1-4]: ") as refusal:
        read_export(file(tmp_path, HEAD + text))
    assert words in str(refusal.value)


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("width", [0.45, -0.45])
def test_probed_points_show_the_direction_of_counting(sense: float, width: float) -> None:
    """Whatever way the machine's angle runs: from left to right flank as from tooth to tooth is clockwise."""

    def points(*, off: float = 0.0) -> list[Probe]:
        tau = 360.0 / 7
        out = []
        for n in range(7):
            for side, shift in (("left", 0.0), ("right", width * sense * tau)):
                angle = sense * n * tau + shift + (off if n == 3 else 0.0)
                out.append(Probe(tooth=n + 1, side=side, phi=angle % 360.0, x=0.1, y=20.0))  # type: ignore[arg-type]
        return out

    assert counting(points(), 7)[0] == ("clockwise" if width > 0 else "counterclockwise")
    # Nothing is told by points of some teeth, or by one that belongs to another tooth.
    assert counting(points()[2:], 7)[0] is None
    assert counting(points(off=20.0), 7)[0] is None
    assert counting([], 7)[0] is None
