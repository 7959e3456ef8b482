"""Refusals of inspection sheets: exports of measuring machines, tables of any layout, GDE files, and their maps."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import gearpoly
from tests.cures.cure import Cure, command, put, read
from tests.made_sheets import Seen, inspect, known, mka

RAW = known(z=(17, 20))
ROOT = Path(__file__).parents[2]
MODULED = (ROOT / "data" / "sheets" / "driven.csv").read_bytes()
"""A table of a gear, of which the map beside it knows the module."""


@cache
def seen() -> Seen:
    """The driving gear of 17 teeth with one tooth traced."""
    return inspect(gearpoly.Pair.of(RAW).driving, teeth=(1,), points=24)


@cache
def curves() -> str:
    """Its export of curves."""
    return mka(seen()).replace("\r\n", "\n")


GEAR = "[gear]\nmodule_mm = 2.0\npressure_angle_deg = 20.0\nprofile_shift = 0.1\n"
COUNT = 'count = "clockwise"\n'
ASKED = ("--as", "driving", "--flank", "left")


def sheet(
    name: str,
    says: str,
    bad: str | bytes,
    good: str | bytes | None = None,
    *,
    file: str = "a.mka",
    layout: str | None = None,
    cured: str | None = None,
    asked: tuple[str, ...] = ASKED,
    good_asked: tuple[str, ...] | None = None,
    pair: str | None = None,
    good_pair: str | None = None,
) -> Cure:
    """A sheet, its map (``layout``), what is asked for and a pair file that is there: refused, and put right."""

    def attempt(
        folder: Path, content: str | bytes, lines: str | None, words: tuple[str, ...], there: str | None
    ) -> None:
        target = folder / "pair.toml"
        target.unlink(missing_ok=True)
        if there is not None:
            put(folder, "pair.toml", there)
        put(folder, file, content)
        if lines is not None:
            put(folder, "map.toml", lines)
        more = () if lines is None else ("--map", folder / "map.toml")
        command("pair", "--from", folder / file, target, *words, *more)

    return Cure(
        name=name,
        says=says,
        bad=lambda folder: attempt(folder, bad, layout, asked, pair),
        good=lambda folder, message: attempt(
            folder,
            bad if good is None else good,
            layout if cured is None else cured or None,
            asked if good_asked is None else good_asked,
            pair if good_pair is None else good_pair or None,
        ),
    )


ELEVEN = "[gear]\nmodule_mm = 2.0\nteeth = 11\n"
PITCHES = [1.0, -2.0, 3.0, -1.0, 0.0, 2.0, -3.0, 1.0, -1.0, 2.0, -2.0]


def blocks() -> str:
    """Eleven teeth of either flank, one block after the other."""
    sums = [sum(PITCHES[: n + 1]) for n in range(11)]
    rows = "".join(f"{n + 1},{PITCHES[n]:.1f},{sums[n]:.1f}\n" for n in range(11))
    return "".join(f"{side} flank\nTooth,fp (um),Fp (um)\n{rows}" for side in ("Left", "Right"))


def across() -> str:
    """The same with a column per tooth, of the left flank."""
    numbers = ",".join(str(n + 1) for n in range(11))
    return f"Tooth,{numbers}\nfp left [um]," + ",".join(f"{one:.1f}" for one in PITCHES) + "\n"


def edited(*changes: tuple[str, str], text: str = "") -> str:
    """The export of curves with pieces changed once."""
    text = text or curves()
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def line_of(word: str, text: str = "") -> str:
    """The first line of the export with a word."""
    return next(line for line in (text or curves()).split("\n") if word in line)


TITLE = "linke Zahnflanke"
START = line_of("Start Messbereich")
CURVE = line_of("Zahn-Nr.: 1 links")
ROW = line_of("    1  ", curves()[curves().index(TITLE) :])
PROBED = next(line for line in curves().split("\n")[::-1] if line.strip())
MINE = "[driving]\nteeth = 17\nmodule_mm = 2.0\nprofile_shift = 0.1\nface_width_mm = 20.0\n"

CURES = [
    sheet("no flank", "say --flank left or --flank right", curves(), asked=("--as", "driving"), good_asked=ASKED),
    sheet("no gear", "say which: --as driving or --as driven", curves(), asked=("--flank", "left"), good_asked=ASKED),
    sheet("stage", "leave --stage out", curves(), asked=(*ASKED, "--stage", "1"), good_asked=ASKED),
    sheet(
        "count against the probes",
        "leave --count, or count in the map, out; the probed points",
        curves(),
        asked=(*ASKED, "--count", "counterclockwise"),
        good_asked=ASKED,
    ),
    sheet(
        "no direction",
        "say --count clockwise or counterclockwise",
        mka(seen(), probes=False),
        asked=ASKED,
        good_asked=(*ASKED, "--count", "clockwise"),
    ),
    sheet(
        "helix",
        "spur",
        curves().replace(line_of("Schrägungswinkel"), line_of("Schrägungswinkel").replace("0.0000", "12.0")),
        curves(),
    ),
    sheet(
        "no teeth",
        "or [gear] teeth in a file that --map names",
        curves().replace(line_of("Zähnezahl"), ""),
        cured="[gear]\nteeth = 17\n",
    ),
    sheet(
        "few teeth",
        "want a whole number from 5 to 10000",
        curves().replace(line_of("Zähnezahl"), line_of("Zähnezahl").replace("17", "3")),
        curves(),
    ),
    sheet(
        "a module out of bounds",
        "is the line of the header another quantity?",
        curves().replace(line_of("Normalmodul"), line_of("Normalmodul").replace("2.0000", "500.0")),
        curves(),
    ),
    sheet(
        "another gear",
        "correct module_mm in the pair file or the map",
        curves(),
        pair=MINE.replace("2.0\n", "3.0\n", 1),
        good_pair=MINE,
    ),
    sheet("inches", "want mm: export it again in mm", edited(("PROFILE diam", "UNITS inch\nPROFILE diam")), curves()),
    sheet(
        "roll",
        "[gear] start_mm and end_mm in a file that --map names",
        edited(("PROFILE diameter", "PROFILE roll")),
        cured=f"[gear]\nstart_mm = {seen().start}\nend_mm = {seen().end}\n",
    ),
    sheet(
        "no range",
        "or [gear] start_mm in a file that --map names",
        edited((START, "")),
        cured=f"[gear]\nstart_mm = {seen().start}\n",
    ),
    sheet(
        "range turned round",
        "state [gear] start_mm and end_mm in a map",
        edited((START, START.replace(f"{seen().start:.4f}", "99.0"))),
        cured=f"[gear]\nstart_mm = {seen().start}\nend_mm = {seen().end}\n",
    ),
    sheet(
        "nothing in it",
        "want pitch tables or profile curves (.mka)",
        "HEADER KS.MK.FILE\n" + line_of("Zähnezahl") + "\n",
        curves(),
    ),
    sheet("second table", "want one of each", edited(("rechte Zahnflanke", "linke Zahnflanke")), curves()),
    sheet("table of fewer", "each once; measure all teeth", edited((ROW + "\n", "")), curves()),
    sheet(
        "table of more",
        "put its number of teeth right where it is stated",
        edited((line_of("Zähnezahl"), line_of("Zähnezahl").replace("17", "16"))),
        curves(),
    ),
    sheet("not measured", "want every tooth measured, in um", edited((ROW, "    1   -9999.0 -9999.0 0.0")), curves()),
    sheet("fp against Fp", "want Fp(n) - Fp(n-1) = fp(n)", edited((ROW, "    1   99.0 0.0 0.0")), curves()),
    sheet(
        "open circle",
        "was every tooth measured?",
        "HEADER KS.MK.FILE\n"
        + "\n".join(map(line_of, ("Zähnezahl", "Normalmodul", "Eingriffswinkel")))
        + f"\n{TITLE}\nZahn-Nr. fp\n"
        + "".join(f"{n} 5.0\n" for n in range(1, 18)),
        "HEADER KS.MK.FILE\n"
        + "\n".join(map(line_of, ("Zähnezahl", "Normalmodul", "Eingriffswinkel")))
        + f"\n{TITLE}\nZahn-Nr. fp\n"
        + "".join(f"{n} 0.0\n" for n in range(1, 18)),
        asked=(*ASKED, "--count", "clockwise"),
    ),
    sheet(
        "no points",
        "want at least 2; measure it",
        edited(
            (CURVE, "Zahn-Nr.: 1 links / 2  Werte  z= 10.000\n1.0 -2147483.648\n\n" + CURVE.replace("10.000", "1.000"))
        ),
        curves(),
    ),
    sheet("tooth beyond", "want teeth 1 to 17", edited((CURVE, CURVE.replace(" 1 links", " 99 links"))), curves()),
    sheet("no export", "want HEADER KS.MK.FILE", "\n HEADER KS.MK.FILE\n", curves()),
    sheet("long line", "want lines of at most 10000", curves() + "x" * 20_000, curves()),
    sheet("header without end", "export it again", "HEADER KS.MK.FILE\n" + "a: 1\n" * 200_000, curves()),
    sheet("curve of none", "want 1 to", edited((CURVE, CURVE.replace("/ 24", "/ 0"))), curves()),
    sheet(
        "curve of fewer",
        "the file may be cut off: export it again",
        edited((CURVE, CURVE.replace("/ 24", "/ 240"))),
        curves(),
    ),
    sheet("curve of more", "export the file again", edited((CURVE, CURVE.replace("/ 24", "/ 20"))), curves()),
    sheet(
        "title alone", "want Zahn-Nr. fp Fp Fr", edited(("    Zahn-Nr.   fp   Fp   Fr", "    Zahn-Nr. a b c")), curves()
    ),
    sheet("tooth twice", "want each tooth once", edited((ROW, ROW + "\n" + ROW)), curves()),
    sheet(
        "profile twice",
        "want one profile at each place of a flank",
        edited((CURVE, CURVE.replace("/ 24", "/ 2") + "\n1.0 2.0\n\n" + CURVE)),
        curves(),
    ),
    sheet("no rows", "want a row per tooth; export the file again", curves()[: curves().index(ROW)], curves()),
    sheet("words in a table", "want numbers", edited((ROW, "    1   x 0.0 0.0")), curves()),
    sheet("words among probes", "want numbers", edited((PROBED, "17 L x 1.0 1.0 1.0")), curves()),
    sheet(
        "another's sizes",
        "want one gear: correct one of the two",
        curves(),
        pair=MINE,
        layout="[gear]\nmodule_mm = 3.0\n",
        cured="[gear]\nmodule_mm = 2.0\n",
    ),
    sheet(
        "inspected already",
        "take [driving.inspection] out of the file",
        curves(),
        pair=MINE + "[driving.inspection]\npitch_um = 1.0\n",
        good_pair=MINE,
    ),
    sheet(
        "no table of the gear",
        "want [driving] with the keys of the gear",
        curves(),
        pair="driving = 1\n",
        good_pair=MINE,
    ),
    Cure(
        name="standard output",
        says="want the name of a pair file",
        bad=lambda folder: (put(folder, "a.mka", curves()), command("pair", "--from", folder / "a.mka", "-", *ASKED)),
        good=lambda folder, message: command("pair", "--from", folder / "a.mka", folder / "p.toml", *ASKED),
    ),
    sheet(
        "inches per tooth",
        "want",
        curves(),
        pair=MINE.replace("module_mm = 2.0", "module_mm = 2.0\ndiametral_pitch = 12.7"),
        good_pair=MINE,
    ),
    sheet(
        "no module",
        "want [gear] module_mm in a file that --map names",
        curves().replace(line_of("Normalmodul"), "")[: curves().replace(line_of("Normalmodul"), "").index("Profil:")]
        + curves()[curves().index("        " + TITLE) :],
        cured="[gear]\nmodule_mm = 2.0\n",
    ),
    sheet(
        "not as the file has it",
        "or correct driving.profile_shift there",
        curves(),
        pair=MINE.replace("profile_shift = 0.1\n", ""),
        good_pair=MINE,
    ),
    sheet(
        "no such block",
        "want the title of a block, or its line of heads: line 2, line 15",
        blocks(),
        file="a.csv",
        layout=f'{ELEVEN}[blocks]\n"line 99" = "left"\n',
        cured=f'{ELEVEN}[blocks]\n"line 2" = "left"\n"line 15" = "right"\n',
        asked=(*ASKED, "--count", "clockwise"),
    ),
    sheet(
        "no such head of several blocks",
        "want one of Fp (um), Tooth, fp (um)",
        blocks(),
        file="a.csv",
        layout=f'{ELEVEN}[columns]\n"fp [um]" = "single_pitch"\n',
        cured=f'{ELEVEN}[columns]\n"fp (um)" = "single_pitch"\n',
        asked=(*ASKED, "--count", "clockwise"),
    ),
    sheet(
        "row of teeth in columns cut off",
        "want 12, as in line 1",
        across().rstrip().rpartition(",")[0] + "\n",
        across(),
        file="a.csv",
        layout=ELEVEN,
        asked=(*ASKED, "--count", "clockwise"),
    ),
    *(
        Cure(
            name=f"{file} as a recording",
            says="want it given to gearpoly pair --from",
            bad=lambda folder, file=file, content=content: (put(folder, file, content()), read(folder, file)),
            good=lambda folder, message, file=file, words=words: command(
                "pair", "--from", folder / file, folder / "new.toml", *ASKED, *words
            ),
        )
        for file, content, words in (
            ("a.csv", lambda: MODULED, ("--count", "clockwise", "--map", ROOT / "data" / "sheets" / "driven_map.toml")),
            ("a.mka", curves, ()),
        )
    ),
]
