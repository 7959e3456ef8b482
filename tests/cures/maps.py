"""Refusals of maps: what a map says wrong is told with the key, and the second map is taken."""

from __future__ import annotations

from gearpoly.recording.read import read_set
from tests.cures.cure import BASE, Cure, command, foreign, put, text
from tests.cures.texts import LOGGED

WHO = ("t", "Winkel 1", "Winkel 2", "M")
LOG = foreign(WHO)
GOOD = (
    'columns.time_s = { from = "t", unit = "s" }\n'
    'columns.driving_angle_deg = { from = "Winkel 1", unit = "deg" }\n'
    'columns.driven_angle_deg = { from = "Winkel 2", unit = "deg" }\n'
)


def line(name: str, says: str, bad: str, good: str = "") -> Cure:
    """A line of a map that is refused, and the one in its place."""
    return text(name, says, LOG, file="log.txt", chart=bad + GOOD, cured=good + GOOD)


def torque(name: str, says: str, bad: str, good: str) -> Cure:
    """The table of a column's source that is refused, and the one in its place."""
    at = "columns.torque_nm = {{ {} }}\n".format
    return text(name, says, LOG, file="log.txt", chart=GOOD + at(bad), cured=GOOD + at(good))


CURES = [
    torque(
        "ratio of teeth",
        "the driven teeth by the driving ones",
        'from = "M", unit = "N.m", scale = "z_2/z_1"',
        'from = "M", unit = "N.m", scale = 1.3889',
    ),
    line("unknown key", 'the nearest known key here is "section"', "sektion = 1\n", "section = 1\n"),
    line(
        "unknown column",
        'the nearest known column is "torque_nm"',
        'columns.torqe_nm = { from = "M" }\n',
        'columns.torque_nm = { from = "M", unit = "N.m" }\n',
    ),
    line("unknown record key", 'the nearest known key is "flank"', 'keys.flang = "coast"\n', 'keys.flank = "coast"\n'),
    line("key's value", 'want "drive" or "coast"', 'keys.flank = "left"\n', 'keys.flank = "coast"\n'),
    line("leave out", "a list of names, such as", 'leave_out = "M"\n', 'leave_out = ["M"]\n'),
    line("no table", "a table: [text] on a line of its own", "text = 1\n"),
    line("whole", "a whole number, counted from 1", "section = 0\n", "section = 1\n"),
    text(
        "jumps",
        '"taken out" or "kept"',
        LOG,
        file="log.txt",
        chart=GOOD.replace('unit = "s"', 'unit = "s", jumps = "out"'),
        cured=GOOD.replace('unit = "s"', 'unit = "s", jumps = "taken out"'),
    ),
    line("toml", "want", "section = \n", "section = 1\n"),
    line("mark", 'want ";"', 'text.separator = "x"\n', 'text.separator = ";"\n'),
    line(
        "same marks",
        "another mark than the decimal one",
        'text.decimal = ","\ntext.thousands = ","\n',
        'text.decimal = ","\ntext.thousands = "."\n',
    ),
    line(
        "thousands alone",
        'want decimal = "," or "."',
        'text.thousands = "."\n',
        'text.decimal = ","\ntext.thousands = "."\n',
    ),
    line("dates", '"day first"', 'text.dates = "days"\n', 'text.dates = "day first"\n'),
    line("missing", 'as text: ["OVERLOAD", "-9999"]', "text.missing = [-9999]\n", 'text.missing = ["-9999"]\n'),
    line("torn lines", '"left out", or no such line', "text.torn_lines = true\n", 'text.torn_lines = "left out"\n'),
    line("encoding", '"utf-8", "utf-16", "cp1252"', 'text.encoding = "utf-99"\n', 'text.encoding = "utf-8"\n'),
    line("units alone", "want header_line, the line of the names", "text.units_line = 1\n", "text.header_line = 1\n"),
    line("section", "or no section where there is one recording", "section = 3\n"),
    torque(
        "no source",
        'want from = "the name or path of the column in the file"',
        'unit = "N.m"',
        'from = "M", unit = "N.m"',
    ),
    torque("source", "in quotes: from =", "from = 3", 'from = "M", unit = "N.m"'),
    torque(
        "column that is not there",
        "want one of: t, Winkel 1, Winkel 2, M",
        'from = "N", unit = "N.m"',
        'from = "M", unit = "N.m"',
    ),
    torque(
        "unknown in a source",
        'the nearest known key here is "unit"',
        'from = "M", units = "N.m"',
        'from = "M", unit = "N.m"',
    ),
    torque(
        "scale",
        "a number above 0 (sign = -1 turns it round)",
        'from = "M", unit = "N.m", scale = -2.0',
        'from = "M", unit = "N.m", scale = 2.0',
    ),
    torque(
        "wraps",
        "at which the readings begin again, above 0",
        'from = "M", unit = "N.m", wraps = 0.0',
        'from = "M", unit = "N.m", wraps = 99.0',
    ),
    torque(
        "sign",
        "1, or -1 where the numbers count the other way",
        'from = "M", unit = "N.m", sign = 2',
        'from = "M", unit = "N.m", sign = 1',
    ),
    torque(
        "number",
        "a finite number with a decimal point",
        'from = "M", unit = "N.m", scale = "2"',
        'from = "M", unit = "N.m", scale = 2.0',
    ),
    torque("no unit", 'unit = "N.m"', 'from = "M"', 'from = "M", unit = "N.m"'),
    torque("no unit of any kind", "want a unit of torque", 'from = "M", unit = "bananas"', 'from = "M", unit = "N.m"'),
    torque(
        "unit of another kind", "want a unit of torque: N.m", 'from = "M", unit = "deg"', 'from = "M", unit = "N.m"'
    ),
    text(
        "a doubtful unit",
        "since it may mean both",
        LOG,
        file="log.txt",
        chart=GOOD.replace('"Winkel 1", unit = "deg"', '"Winkel 1", unit = "grad"'),
        cured=GOOD,
    ),
    text(
        "another unit by its wraps",
        'want unit = "deg"',
        LOG,
        file="log.txt",
        chart=GOOD.replace('"Winkel 1", unit = "deg"', '"Winkel 1", unit = "gon"'),
        cured=GOOD,
    ),
    text(
        "a channel twice",
        "or name another one here",
        LOG,
        file="log.txt",
        chart=GOOD.replace('"Winkel 2"', '"column 2"'),
        cured=GOOD,
    ),
    text(
        "a channel left out and taken",
        "take it out of leave_out",
        LOG,
        file="log.txt",
        chart='leave_out = ["Winkel 2"]\n' + GOOD,
        cured=GOOD,
    ),
    text(
        "a name of two",
        'want one of them: "Winkel (column 2)", "Winkel (column 3)"',
        LOG.replace("Winkel 1", "Winkel").replace("Winkel 2", "Winkel"),
        file="log.txt",
        chart=GOOD.replace("Winkel 1", "Winkel").replace("Winkel 2", "Winkel (column 3)"),
        cured=GOOD.replace("Winkel 1", "Winkel (column 2)").replace("Winkel 2", "Winkel (column 3)"),
    ),
    text(
        "stated twice",
        "or driving_zero_deg in [keys]",
        LOG,
        file="log.txt",
        chart="keys.driving_zero_deg = 1.0\n" + GOOD.replace('"Winkel 1",', '"Winkel 1", zero = 1.0,'),
        cured=GOOD.replace('"Winkel 1",', '"Winkel 1", zero = 1.0,'),
    ),
    Cure(
        name="as many maps",
        says="want one for all of them, or one for each in order",
        bad=lambda folder: (
            put(folder, "rec.csv", BASE),
            put(folder, "a.toml", ""),
            read_set([folder / "rec.csv"], [folder / "a.toml"] * 2),
        ),
        good=lambda folder, message: read_set([folder / "rec.csv"], [folder / "a.toml"]),
    ),
    Cure(
        name="write of several",
        says="want one of them",
        bad=lambda folder: (
            put(folder, "a.csv", BASE),
            put(folder, "b.txt", LOGGED),
            command("read", folder / "a.csv", folder / "b.txt", "--write", folder / "m.toml"),
        ),
        good=lambda folder, message: command("read", folder / "a.csv", "--write", folder / "m.toml"),
    ),
    Cure(
        name="write beside a map",
        says="leave out --write",
        bad=lambda folder: (
            put(folder, "a.csv", BASE),
            put(folder, "m.toml", ""),
            command("read", folder / "a.csv", "--map", folder / "m.toml", "--write", folder / "n.toml"),
        ),
        good=lambda folder, message: command("read", folder / "a.csv", "--map", folder / "m.toml"),
    ),
]
