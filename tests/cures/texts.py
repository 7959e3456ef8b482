"""Refusals of recordings as text, in the contract's own form and as loggers write them."""

from __future__ import annotations

import numpy as np

from gearpoly.recording.csv_reader import read_csv
from gearpoly.recording.elsewhere import BEGINNINGS, ZIPPED
from tests.cures.cure import (
    BASE,
    HEAD,
    RATIO,
    ROWS,
    RUN,
    Cure,
    by_its_lines,
    foreign,
    one_of_two,
    put,
    read,
    rows,
    text,
    with_columns,
)
from tests.made_texts import own

T, DRIVING, DRIVEN = (RUN[name] for name in ("time_s", "driving_angle_deg", "driven_angle_deg"))
N = T.size
WHOLE = 6.0 * 30.0 * T
GERMAN = ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Drehmoment Abtrieb [Nm]")
LOGGED = foreign(GERMAN)
KEY = "# torque_nm = 25.0\n"


def keyed(key: str, value: str, good: str, says: str) -> Cure:
    """A key of a comment line with a value that it may not have."""
    return text(f"key {key}", says, f"# {key} = {value}\n{BASE}", f"# {key} = {good}\n{BASE}")


def raw(**changes: object) -> str:
    """A counter on the driving shaft in the place of its angle."""
    count = np.floor(WHOLE / 360.0 * 4000.0)
    held: dict[str, object] = {"driving_angle_deg": None, "driving_count": count, **changes}
    return with_columns(**held)


def cells(k: int, time: str, driving: str, driven: str, torque: str) -> tuple[str, ...]:
    """A row of which one of two devices read its shaft."""
    return (time, driving if k % 2 else "", "" if k % 2 else driven, torque)


LINES = "# driving_lines = 1000\n"
PER = "# driving_counts_per_line = 4\n"
SWITCHING = (np.mod(np.floor(WHOLE / 20.0), 2) > 0).astype(float)
BACK = np.where(np.arange(N) < N // 2, WHOLE, 2.0 * WHOLE[N // 2] - WHOLE)
BY_TURNS = "\n".join([HEAD, *(",".join(cells(k, *row.split(","))) for k, row in enumerate(ROWS))]) + "\n"
SPOILT = BASE.replace(ROWS[300], ROWS[300].rpartition(",")[0] + ",Not A Read")
TWICE = own({**RUN, "time": T + 1.0}).replace(",time\n", ",time_s\n")
SLOW = np.linspace(0.0, 90.0, N)
SETBACK = np.floor(WHOLE / 360.0 * 4000.0)
SETBACK[350:] += 9777.0

OWN = [
    text("no header", "want a header row with driving_angle_deg", KEY, KEY + BASE),
    text("no rows", "want rows of numbers", HEAD + "\n", BASE),
    text(
        "comment below",
        "want comment lines before the header row",
        rows(*ROWS[:9], "# flank = 'drive'", *ROWS[9:]),
        "# flank = 'drive'\n" + BASE,
    ),
    text("cells", "want 4, as in the header", rows(*ROWS[:9], "1.0,2.0", *ROWS[9:]), BASE),
    text("cut off", "the last line looks cut off, delete it", rows(*ROWS[:5]) + "7.0,2.0", rows(*ROWS)),
    text(
        "cell",
        "want a finite number (an empty cell or nan for a drop-out)",
        rows(*ROWS[:9], "0.0,x,1.0,2.0", *ROWS[9:]),
        rows(*ROWS[:9], "0.09,,1.0,2.0", *ROWS[10:]),
    ),
    text(
        "no name", "want a name for every column", rows(*ROWS, head="time_s,driving_angle_deg,driven_angle_deg,"), BASE
    ),
    text(
        "misspelt",
        'the nearest known column is "driven_angle_deg"',
        BASE.replace("driven_angle_deg", "driven_angel_deg"),
        BASE,
    ),
    Cure(
        name="zero bytes",
        says="other formats need their own file name ending",
        bad=lambda folder: (put(folder, "a.csv", b"time_s\n1,\0\n"), read_csv(folder / "a.csv")),
        good=lambda folder, message: (put(folder, "a.csv", BASE), read_csv(folder / "a.csv")),
    ),
    text("long line", "want lines of at most 1048576 bytes, one for each row", HEAD + "\n" + "1," * 2**20, BASE),
    text("long header", "want a CSV file with lines", "#" * 2**19 + "\n" + HEAD + "," * (2**20 + 2**17) + "\n", BASE),
    text(
        "encoding",
        "save it again with that encoding",
        f"# torque_nm = 25.0 \u00b0\n{BASE}".encode("cp1252"),
        f"# torque_nm = 25.0 # \u00b0\n{BASE}",
    ),
    one_of_two("text", "time_s", (1, 5), lambda file: file.write_text(TWICE), "rec.csv"),
    text(
        "column twice, one without numbers",
        "want each name once",
        TWICE.replace("\n0.01000,", "\nx,", 1),
        BASE,
    ),
    Cure(
        name="a word that is no number",
        says='in a map, if it holds no reading: text.missing = ["Not A Read"]',
        bad=lambda folder: (put(folder, "rec.csv", SPOILT), read(folder)),
        good=lambda folder, message: (
            put(folder, "map.toml", message.partition("no reading: ")[2].partition("]")[0] + "]"),
            read(folder, maps=True),
        ),
    ),
    text("no row", "delete the line if it is no row", BASE + "END\n", BASE),
    *(
        text(what, cure, begin + b"\0" * 200, BASE, file="rec.dat")
        for begin, what, cure in (*BEGINNINGS, *((b"PK\x03\x04" + mark, *more) for mark, *more in ZIPPED))
    ),
    text(
        "read by turns",
        "or a column time_s, by which they are brought together",
        BY_TURNS.replace("time_s", "row_no", 1),
        BY_TURNS,
        ratio=RATIO,
    ),
    text("key twice", "want each key once", KEY + KEY + BASE, KEY + BASE),
    text("value", "text in quotes", f"# flank = drive\n{BASE}", f'# flank = "drive"\n{BASE}'),
    text(
        "long value",
        "want a value of at most 1000 characters",
        f'# flank = "{"d" * 2000}"\n{BASE}',
        f'# flank = "drive"\n{BASE}',
    ),
    text("near key", 'the nearest known key is "torque_nm"', f"# torqe_nm = 1.0\n{BASE}", KEY + BASE),
    text("many keys", "at most 2000 comment lines with =", "# a = 1\n" * 2001 + BASE, BASE),
    text("infinite", "want a finite number", BASE.replace(ROWS[3], "0.03,inf,1.0,2.0"), BASE),
    text(
        "nothing in it",
        "want numbers in it, or no such column",
        with_columns(torque_nm=np.full(N, np.nan)),
        with_columns(torque_nm=None),
    ),
    text(
        "huge angle",
        "leave that reading out (an empty cell or nan)",
        BASE.replace(ROWS[3], "0.03,1e300,1.0,2.0"),
        BASE.replace(ROWS[3], "0.03,,1.0,2.0"),
    ),
    text("incomplete", "want both driving_angle_deg and driven_angle_deg", with_columns(driven_angle_deg=None), BASE),
    text(
        "index alone",
        "want the pulses in driving_a, or the counts in driving_count",
        with_columns(driving_angle_deg=None, driving_index=SWITCHING),
        LINES + PER + raw(driving_index=None),
    ),
    text(
        "b alone",
        "or the only channel as driving_a",
        with_columns(driving_b=SWITCHING),
        "# driving_lines = 9\n" + with_columns(driving_angle_deg=None, driving_a=SWITCHING),
    ),
    text("radians", "want degrees", with_columns(driven_angle_deg=np.radians(DRIVEN)), BASE),
    by_its_lines(
        "radians in a map", "or a map with", with_columns(driven_angle_deg=np.radians(DRIVEN)), file="rec.csv"
    ),
    text("backward torque", "want a torque of 0 or more", with_columns(torque_nm=-RUN["torque_nm"]), BASE),
    text(
        "two errors",
        "leave one of them out",
        with_columns(te_urad=np.sin(T), te_arcsec=np.cos(T)),
        with_columns(te_urad=np.sin(T)),
    ),
    keyed("torque_nm", "-1.0", "1.0", "a torque in N.m, 0 or more"),
    keyed("flank", '"left"', '"coast"', '"drive" or "coast"'),
    keyed("reversed", "2", "true", "true where the pair ran backwards"),
    keyed("driving_direction", "0", "1", "1, or -1 where the encoder counts down"),
    keyed("driving_zero_deg", "nan", "1.0", "a finite number"),
    keyed("speed_rpm", "0.0", "30.0", "a speed in rpm, above 0"),
    keyed("sample_rate_hz", "0.0", "100.0", "samples per second, above 0"),
    keyed("driving_lines", "1.5", "1000", "as on its label or data sheet"),
    keyed("driving_counts_per_line", "3", "4", "1, 2 or 4 counts per line"),
    keyed("driving_count_bits", "99", "16", "a whole number from 2"),
    keyed("driving_count_modulus", "1", "4000", "a whole number from 2"),
    text("empty", "want a recording (", "", BASE),
    text("unknown format", "want a recording (", bytes(range(256)) * 9, BASE, file="rec.xyz"),
    text(
        "ending of another",
        "want a Parquet file, or the ending .csv if it is CSV",
        BASE,
        file="rec.parquet",
        to="rec.csv",
    ),
    text("no such file", "check the name, or export it again", b"\0\1\2" * 99, BASE, file="rec.txt"),
    text("part of one", "without #2", BASE, file="rec.csv#2", to="rec.csv"),
]

RAW = [
    text("lines missing", "want driving_lines = 1024", raw(), LINES + PER + raw()),
    text("counts per line missing", "want driving_counts_per_line = 4", LINES + raw(), LINES + PER + raw()),
    text(
        "times of pulses",
        "want a time that rises from sample to sample",
        LINES + PER + raw(time_s=np.zeros(N)),
        LINES + PER + raw(),
    ),
    text(
        "drop-outs of pulses",
        "want pulses without gaps",
        LINES + with_columns(driving_angle_deg=None, driving_a=np.where(np.arange(N) == 99, np.nan, SWITCHING)),
        "# driving_lines = 9\n" + with_columns(driving_angle_deg=None, driving_a=SWITCHING),
    ),
    text(
        "a channel that stands",
        "want a channel that switches as it turns",
        LINES + with_columns(driving_angle_deg=None, driving_a=np.zeros(N)),
        "# driving_lines = 9\n" + with_columns(driving_angle_deg=None, driving_a=SWITCHING),
    ),
    text(
        "modulus twice",
        "want one of the two",
        f"{LINES}{PER}# driving_count_bits = 16\n# driving_count_modulus = 4000\n{raw()}",
        f"{LINES}{PER}# driving_count_bits = 16\n{raw()}",
    ),
    text(
        "line count",
        "perhaps 9",
        "# driving_lines = 8\n"
        + with_columns(
            driving_angle_deg=None, driving_a=SWITCHING, driving_index=(np.mod(WHOLE, 360.0) < 20.0).astype(float)
        ),
        "# driving_lines = 9\n"
        + with_columns(
            driving_angle_deg=None, driving_a=SWITCHING, driving_index=(np.mod(WHOLE, 360.0) < 20.0).astype(float)
        ),
    ),
    text(
        "small modulus",
        "check where it wraps",
        f"{LINES}{PER}# driving_count_modulus = 40\n{raw()}",
        f"{LINES}{PER}# driving_count_modulus = 4000\n{raw()}",
    ),
    text("a reset", "or a recording without a reset", LINES + PER + raw(driving_count=SETBACK), LINES + PER + raw()),
    text(
        "two ways apart",
        "leave one of them out",
        "# driving_lines = 9\n" + with_columns(driving_a=SWITCHING, driving_angle_deg=np.mod(1.3 * WHOLE, 360.0)),
        "# driving_lines = 9\n" + with_columns(driving_a=SWITCHING),
    ),
]

LABELLED = [f"{t:.2f} s,{a:.5f} deg,{b:.5f} deg" for t, a, b in zip(*list(RUN.values())[:3], strict=True)]

UNEVEN = [",".join(f"{v:.6g}".replace(".", ",") for v in row) for row in zip(*RUN.values(), strict=True)]

COMMAS = [
    text(
        "commas of decimals among commas",
        "want semicolons between the cells, or decimal points",
        "\n".join([",".join(GERMAN), *UNEVEN]) + "\n",
        foreign(GERMAN, separator=";"),
    ),
    text(
        "commas of decimals among commas, in a map",
        "want semicolons between the cells, or decimal points",
        "\n".join([",".join(GERMAN), *(row.replace(",", ",0") for row in UNEVEN)]) + "\n",
        foreign(GERMAN, separator=",", decimal="."),
        chart='text.decimal = ","\n',
        cured="",
    ),
    text(
        "commas of decimals or not",
        'text.decimal = ","',
        foreign(GERMAN, separator=",").partition("\n")[2],
        chart="",
        cured='text.decimal = ","\n'
        + "".join(
            f'columns.{name} = {{ from = "column {k}", unit = "{unit}" }}\n'
            for k, (name, unit) in enumerate(zip(RUN, ("s", "deg", "deg", "N.m"), strict=True), start=1)
        ),
    ),
]

CLEAN = [
    text(
        "one shaft alone",
        "want the readings of both shafts",
        "\n".join(["Time,Input angle", *(one.rpartition(",")[0] for one in LABELLED)]) + "\n",
        "\n".join(["Time,Input angle,Output angle", *LABELLED]) + "\n",
    ),
    text(
        "a unit in one row",
        "delete the line if it is no row",
        "\n".join(["Time,Input angle,Output angle", *LABELLED[:-1], LABELLED[-1].replace("deg", "rad")]) + "\n",
        "\n".join(["Time,Input angle,Output angle", *LABELLED[:-1]]) + "\n",
    ),
    text(
        "time runs back",
        "want one recording in the order of time; cut it there",
        rows(*ROWS[:550], *ROWS[:150]),
        rows(*ROWS[:550]),
        ratio=RATIO,
    ),
    text(
        "speed off by a unit",
        'columns.time_s = { from = "time_s", unit = "ms" }',
        "# speed_rpm = 30.0\n" + own({**RUN, "time_s": 1e3 * T}),
        chart="",
        cured='columns.time_s = { from = "time_s", unit = "ms" }\n',
    ),
    text(
        "one shaft in rad",
        'columns.driven_angle_deg = { from = "driven_angle_deg", unit = "rad" }',
        own({**RUN, "driving_angle_deg": WHOLE, "driven_angle_deg": np.radians(RATIO * WHOLE)}, digits=9),
        chart="",
        cured='columns.driven_angle_deg = { from = "driven_angle_deg", unit = "rad" }\n',
        ratio=RATIO,
    ),
    text("newest first", "sort the rows by their times", rows(*ROWS[::-1]), BASE, ratio=RATIO),
    text("too short", "want at least 1 driving turn", rows(*ROWS[:200]), BASE, ratio=RATIO),
    text("few samples", "record longer", rows(*ROWS[:6]), BASE, ratio=RATIO),
    text(
        "counts down",
        "driving_direction = -1",
        with_columns(driving_angle_deg=np.mod(-WHOLE, 360.0)),
        "# driving_direction = -1\n" + with_columns(driving_angle_deg=np.mod(-WHOLE, 360.0)),
        ratio=RATIO,
    ),
    text(
        "ran backwards",
        "or reversed = true if the pair ran backwards",
        rows(*(",".join((a.split(",")[0], *b.split(",")[1:])) for a, b in zip(ROWS, ROWS[::-1], strict=True))),
        "# reversed = true\n"
        + rows(*(",".join((a.split(",")[0], *b.split(",")[1:])) for a, b in zip(ROWS, ROWS[::-1], strict=True))),
        ratio=RATIO,
    ),
    text(
        "another pair",
        "want a recording of this pair, with the right counts per turn",
        with_columns(driven_angle_deg=np.mod(0.5 * WHOLE, 360.0)),
        BASE,
        ratio=RATIO,
    ),
    text(
        "forth and back",
        "driving turn one way; gearpoly read tells the lost motion",
        with_columns(driving_angle_deg=BACK / 20.0, driven_angle_deg=RATIO * BACK / 20.0),
        BASE,
    ),
    text(
        "run of a part",
        "#1 to #",
        with_columns(driving_angle_deg=BACK, driven_angle_deg=RATIO * BACK),
        file="rec.csv#9",
        to="rec.csv#1",
    ),
]

FOREIGN = [
    text("no table", "want rows of at least two numbers parted by", "a remark\nand another\n", LOGGED, file="log.txt"),
    text(
        "bad row",
        "or a line of names where another recording begins",
        LOGGED[: LOGGED.index("\n", len(LOGGED) // 2)] + "\nx;1,0" + LOGGED[LOGGED.index("\n", len(LOGGED) // 2) :],
        LOGGED,
        file="log.txt",
    ),
    text("cells of a row", "as above", LOGGED + "8,0;1,0;2,0\n" * 20, LOGGED, file="log.txt"),
    text(
        "bad cell",
        "want a finite number (an empty cell or nan for a drop-out)",
        LOGGED + "x;1,0;2,0;3,0\n",
        LOGGED,
        file="log.txt",
    ),
    text(
        "mark within",
        "want a finite number with the decimal mark",
        LOGGED + "8.0.1;1,0;2,0;3,0\n",
        LOGGED + "8,01;1,0;2,0;3,0\n",
        file="log.txt",
    ),
    text(
        "many tables",
        "split the file",
        "\n".join(f"a;b\n{k},5;1,5\n{k},6;1,5" for k in range(102)),
        LOGGED,
        file="log.txt",
    ),
    text("empty lines", "take empty lines out", LOGGED + "\n" * 7_000_000, LOGGED, file="log.txt"),
    text(
        "stated encoding",
        "leave encoding out of [text]",
        LOGGED.encode("cp1252"),
        file="log.txt",
        chart='text.encoding = "utf-8"\n',
        cured="",
    ),
    text("no text", "other formats need their own file name ending", b"\xff\xfea\0b\0\0\0" * 9, LOGGED, file="log.txt"),
    text(
        "separator",
        "or none in [text] to have it found",
        LOGGED,
        file="log.txt",
        chart='text.separator = "|"\n',
        cured="",
    ),
    text(
        "header line",
        "want header_line in [text] of the map to be another line, or none",
        "by;me\n" + LOGGED,
        file="log.txt",
        chart="text.header_line = 1\n",
        cured="text.header_line = 2\n",
    ),
    text(
        "stamps",
        "want a time stamp like those above, or an empty cell",
        "Zeit;Winkel Antrieb [°];Winkel Abtrieb [°]\n"
        + "".join(
            f"2026-03-0{1 + k // 400} 10:{k // 60 % 60:02d}:{k % 60:02d};{a:.3f};{b:.3f}\n".replace(".", ",")
            for k, (a, b) in enumerate(zip(DRIVING, DRIVEN, strict=True))
        )
        + "2026-03-01 99:00:00;1,0;1,0\n",
        "Zeit;Winkel Antrieb [°];Winkel Abtrieb [°]\n"
        + "".join(
            f"2026-03-0{1 + k // 400} 10:{k // 60 % 60:02d}:{k % 60:02d};{a:.3f};{b:.3f}\n".replace(".", ",")
            for k, (a, b) in enumerate(zip(DRIVING, DRIVEN, strict=True))
        ),
        file="log.txt",
    ),
    by_its_lines(
        "decimal doubt",
        'text.decimal = ","',
        ";".join(GERMAN[:3])
        + "\n"
        + "".join(f"{1 + k / 1000:.3f};{2 + k / 1000:.3f};{3 + k / 1000:.3f}\n".replace(".", ",") for k in range(99)),
    ),
    text("no names", "want a line of names above them", LOGGED.split("\n", 1)[1], LOGGED, file="log.txt"),
    by_its_lines(
        "no angle",
        'columns.driven_angle_deg = { from = "Wert"',
        foreign(("Zeit [s]", "Winkel Antrieb [°]", "Wert")),
    ),
    by_its_lines(
        "doubtful",
        "columns.driving_angle_deg = { from =",
        foreign(("Zeit [s]", "Winkel 1 [°]", "Winkel 2 [°]")),
    ),
    text(
        "near the contract",
        "or give or leave it out in a map",
        foreign(("time_s", "driving_angle_deg", "driven_angle_deg", "torqe_nm")),
        file="log.txt",
        cured='leave_out = ["torqe_nm"]\n',
    ),
    text("part of several", "#1 to #2", LOGGED + "\n" + LOGGED, file="log.txt#3", to="log.txt#2"),
]

CURES = [*OWN, *RAW, *COMMAS, *CLEAN, *FOREIGN]
