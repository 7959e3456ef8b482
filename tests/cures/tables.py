"""Refusals of inspection sheets as tables of any layout, of their maps, and of GDE files."""

from __future__ import annotations

from tests.cures.cure import Cure
from tests.cures.sheets import ASKED, COUNT, GEAR, seen, sheet
from tests.made_sheets import table as spreadsheet
from tests.test_gde import BOMB, HAND

TABLE = spreadsheet(seen())
TABLE_HEAD, *TABLE_ROWS = TABLE.splitlines()
FREE = COUNT + GEAR


def rows(head: str = TABLE_HEAD, lines: list[str] | None = None) -> str:
    return "\n".join([head, *(TABLE_ROWS if lines is None else lines)]) + "\n"


def tabled(
    name: str, says: str, bad: str | bytes, good: str | None = "", *, layout: str = FREE, cured: str | None = None
) -> Cure:
    """A table that is refused, and one in its place, or the map that says what it leaves open."""
    return sheet(
        name, says, bad, (good or (TABLE if cured is None else None)), file="a.csv", layout=layout, cured=cured
    )


FLAT = "tooth,fp left,fp right,E_sn\n"
EVEN = "".join(f"{n},0.0,0.0,-40.0\n" for n in range(1, 18))

TABLES = [
    tabled("no head", '[columns] "NAME" = "tooth"', "1;2\n3;4\n"),
    tabled(
        "a row missing",
        "want a row for each of the 17 teeth",
        rows(lines=TABLE_ROWS[1:]),
        layout=FREE + "teeth = 17\n",
    ),
    tabled("long line", "want lines of at most", TABLE + "x" * 20_000),
    tabled("cells", "a map may state separator and decimal", TABLE + "18;1\n"),
    tabled(
        "unknown head",
        '= "ignored", or tooth, flank, single_pitch',
        rows(TABLE_HEAD.replace("fp links [µm]", "Wert")),
        cured=FREE.replace(
            "[gear]",
            '[columns]\n"Zahn-Nr." = "tooth"\n"Wert" = "single_pitch_left"\n'
            '"Fp links [µm]" = "cumulative_pitch_left"\n"fp rechts [µm]" = "single_pitch_right"\n'
            '"Fp rechts [µm]" = "cumulative_pitch_right"\n[gear]',
        ),
    ),
    tabled("head twice", 'and "ignored" for the others', rows(TABLE_HEAD.replace("Fp links", "fp links"))),
    tabled("unit", "want a length: um, mm", rows(TABLE_HEAD.replace("[µm]", "[arcsec]"))),
    tabled(
        "no unit, too small",
        'want unit = "mm"',
        FLAT + EVEN.replace("5,0.0,0.0,-40.0", "5,0.004,0.0,-0.04").replace(",-40.0", ",-0.04"),
        None,
        cured='unit = "mm"\n' + FREE,
    ),
    tabled(
        "another unit",
        "want the unit that the numbers have",
        "tooth,fp left [mm]\n1,3.0\n2,-3.0\n" + "".join(f"{n},0.0\n" for n in range(3, 18)),
    ),
    tabled(
        "no teeth",
        '[columns] in the map wants "NAME" = "tooth"',
        TABLE,
        layout=FREE.replace("[gear]", '[columns]\n"Zahn-Nr." = "ignored"\n[gear]'),
        cured=FREE,
    ),
    tabled("which flank", "want left or right in its name", rows(TABLE_HEAD.replace("fp links", "fp"))),
    tabled(
        "tooth's number",
        "want the number of a tooth",
        rows(lines=[TABLE_ROWS[0].replace("1;", "eins;", 1), *TABLE_ROWS[1:]]),
    ),
    tabled(
        "flank's name",
        "want links or rechts, left or right",
        "tooth,flank,fp\n1,up,0.0\n",
        "tooth,flank,fp\n" + "".join(f"{n},left,0.0\n" for n in range(1, 18)),
    ),
    tabled("cell", "a map may state decimal", rows(lines=[TABLE_ROWS[0] + "x", *TABLE_ROWS[1:]])),
    tabled(
        "tooth again",
        "want each flank once",
        rows(lines=[";".join(["1", "99,0", *TABLE_ROWS[0].split(";")[2:]]), *TABLE_ROWS]),
    ),
    tabled(
        "a tooth missing",
        "want all 17 teeth, or an empty column",
        FLAT + EVEN.replace("5,0.0,0.0,-40.0", "5,,0.0,-40.0"),
        FLAT + EVEN,
    ),
    tabled(
        "fp against Fp",
        "call it ignored in a map",
        rows(lines=[";".join(["1", "99,0", *TABLE_ROWS[0].split(";")[2:]]), *TABLE_ROWS[1:]]),
    ),
    tabled(
        "nothing measured",
        "want a row for each tooth that was measured, with its numbers",
        "tooth,fp left\n" + "".join(f"{n},\n" for n in range(1, 18)),
        FLAT + EVEN,
    ),
    tabled("no text", "export the sheet as text or CSV", b"a\0b" * 99),
    tabled(
        "map: unknown key", 'the nearest known key is "count"', TABLE, layout='kount = "clockwise"\n' + GEAR, cured=FREE
    ),
    tabled("map: value", "want", TABLE, layout='count = "left"\n' + GEAR, cured=FREE),
    tabled("map: size twice", "want one of the two", TABLE, layout=FREE + "diametral_pitch = 12.7\n", cured=FREE),
]


def gde(name: str, says: str, old: str, new: str, *, good: str = HAND) -> Cure:
    """A GDE file with one piece changed."""
    assert old in HAND, old
    return sheet(name, says, HAND.replace(old, new), good, file="a.gde")


def block(tag: str) -> str:
    start, stop = HAND.index(f"<{tag}"), HAND.index(f"</{tag}>") + len(f"</{tag}>")
    return HAND[start:stop]


PROFILE = HAND[HAND.index("<profile tooth") : HAND.index("</profile>") + len("</profile>")]
PITCH = HAND[HAND.index("<pitch") : HAND.index("</profile>") + len("</profile>")]

GDE = [
    gde(
        "entities",
        "take <!DOCTYPE ...> out",
        '<?xml version="1.0" encoding="UTF-8"?>',
        BOMB,
    ),
    gde("cut off", "want the whole file in XML: export it again", "</inspection>", ""),
    gde("another root", "want <gear_data_exchange>", "gear_data_exchange", "gear_data"),
    gde("unit", "want mm", '<normal_module unit="mm">', '<normal_module unit="inch">'),
    gde("unit too much", "want a plain number without unit", "<number_of_teeth>6", '<number_of_teeth unit="mm">6'),
    gde("no teeth", "want <number_of_teeth>, of", "<number_of_teeth>6</number_of_teeth>", ""),
    gde("part of a tooth", "want a whole number from 5 to 10000", "<number_of_teeth>6", "<number_of_teeth>6.5"),
    gde("unknown block", "the nearest known block is <geometry>", "geometry>", "geometrie>"),
    gde(
        "no direction",
        "want tooth_count = clockwise or counterclockwise",
        '<inspection tooth_count="clockwise">',
        "<inspection>",
    ),
    sheet(
        "no direction, stated in a map",
        "want tooth_count = clockwise or counterclockwise",
        HAND.replace(' tooth_count="clockwise"', ""),
        file="a.gde",
        cured='count = "clockwise"\n',
    ),
    gde("values", "want 6", "0 1 2 3 4 5", "0 1 2 3 4"),
    gde("word", "want finite numbers with decimal points", "0 1 2 3 4 5", "0 1 2 3 4 x"),
    gde("huge", "want -10000 to 10000 um", "0 1 2 3 4 5", "0 1 2 3 4 5e5"),
    gde("flank twice", "want each flank once", 'flank="right"', 'flank="left"'),
    gde("tooth", "want a tooth number from 1 to 6", 'tooth="2"', 'tooth="7"'),
    gde("roll", "want them in mm, each larger than the last", "1.0 2.0 4.0", "1.0 4.0 2.0"),
    gde(
        "a point",
        "want at least 2",
        '<roll_length unit="mm">1.0 2.0 4.0</roll_length>\n      <deviation unit="µm">0.5 -1 2.25',
        '<roll_length unit="mm">1.0</roll_length>\n      <deviation unit="µm">0.5',
    ),
    gde("no roll", "want a block <roll_length>", '<roll_length unit="mm">1.0 2.0 4.0</roll_length>', ""),
    gde(
        "helix",
        "want 0: only spur gears are read",
        "<profile_shift_coefficient>",
        '<helix_angle unit="deg">15</helix_angle><profile_shift_coefficient>',
    ),
    gde("second block", "want one <geometry>", block("geometry"), block("geometry") * 2),
    gde("profile twice", "want each flank's profile once", PROFILE, PROFILE * 2),
    gde("nothing measured", "want <pitch>, <tooth_thickness> or <profile>", PITCH, ""),
    sheet(
        "count stated",
        "leave --count, or count in the map, out: the file states it",
        HAND,
        file="a.gde",
        asked=(*ASKED, "--count", "counterclockwise"),
        good_asked=ASKED,
    ),
    sheet(
        "count stated in the map",
        "leave --count, or count in the map, out: the file states it",
        HAND,
        file="a.gde",
        layout='count = "counterclockwise"\n',
        cured="",
    ),
    sheet(
        "another module in the map",
        "correct module_mm in the pair file or the map",
        HAND,
        file="a.gde",
        layout="[gear]\nmodule_mm = 3.0\n",
        cured="[gear]\nmodule_mm = 2.5\n",
    ),
    sheet(
        "columns of no table",
        "leave columns out of the map",
        HAND,
        file="a.gde",
        layout='[columns]\n"Nr" = "tooth"\n',
        cured="",
    ),
]

CURES = [*TABLES, *GDE]
