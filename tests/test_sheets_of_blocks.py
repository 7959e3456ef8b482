"""Inspection tables of several blocks, and with teeth in columns: each gives the gear that was written down."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from tests.made_command import Command
from tests.test_sheets_of_owners import SINGLE, SUMS, Z, right, run

MAP = "[gear]\nmodule_mm = 2.0\nteeth = 11\n"


def rows(side: str, sep: str = ",", *, teeth: range = range(Z)) -> list[str]:
    return [sep.join((str(n + 1), f"{SINGLE[side][n]:.1f}", f"{SUMS[side][n]:.1f}")) for n in teeth]


def row(head: str, side: str, sep: str = ",", *, form: str = ".1f", per_um: float = 1.0, sums: bool = False) -> str:
    return sep.join((head, *(f"{value * per_um:{form}}" for value in (SUMS if sums else SINGLE)[side])))


def teeth(head: str, sep: str = ",", numbers: range = range(1, Z + 1)) -> str:
    return sep.join((head, *map(str, numbers)))


def text(*lines: str) -> str:
    return "\n".join(lines) + "\n"


def german(lines: str) -> str:
    """Decimal commas."""
    return re.sub(r"(\d)\.(\d)", r"\1,\2", lines)


HEAD = "Tooth,fp (um),Fp (um)"
KOPF = "Zahn-Nr.;fp [µm];Fp [µm]"
LEFT, RIGHT = rows("left"), rows("right")
BESIDE = [f"{one},,{other}" for one, other in zip(LEFT, RIGHT, strict=True)]
FIRST, SECOND = range(6), range(6, Z)


def by_flank(sums: bool) -> list[str]:
    held = SUMS if sums else SINGLE
    return [f"{n + 1},{held['left'][n]},{held['right'][n]}" for n in range(Z)]


BLANKS = text(
    "   linke Zahnflanke", "  Zahn-Nr.   fp    Fp", *rows("left", "    "),
    "   rechte Zahnflanke", "  Zahn-Nr.   fp    Fp", *rows("right", "    "),
)  # fmt: skip

BLOCKS = {
    "german": german(
        text(
            "Messprotokoll;;", "Drehrichtung: rechts;;", "linke Zahnflanke;;", KOPF, *rows("left", ";"), "max;6.0;7.0",
            "rechte Zahnflanke;;", KOPF, *rows("right", ";"), "max;4.5;3.0",
        )
    ),
    "english": text("Left flank", HEAD, *LEFT, "Right flank", HEAD, *RIGHT),
    "right first": text("Right flank", HEAD, *RIGHT, "Left flank", HEAD, *LEFT),
    "heads once": text(HEAD, "Left flank", *LEFT, "Right flank", *RIGHT),
    "pages": text(
        "Left flank", HEAD, *rows("left", teeth=FIRST), HEAD, *rows("left", teeth=SECOND),
        "Right flank", HEAD, *rows("right", teeth=FIRST), HEAD, *rows("right", teeth=SECOND),
    ),
    "side by side": text("Left flank,,,,Right flank,,", f"{HEAD},,{HEAD}", *BESIDE),
    "by quantity": text(
        "Single pitch deviation fp [um]", "Tooth,left,right", *by_flank(False),
        "Cumulative pitch deviation Fp [um]", "Tooth,left,right", *by_flank(True),
    ),
    "blanks": BLANKS,
    "blanks and commas": german(BLANKS),
}  # fmt: skip

COLUMNS = {
    "german": german(
        text(
            teeth("Zahn", ";"), row("fp links [µm]", "left", ";"), row("Fp links [µm]", "left", ";", sums=True),
            row("fp rechts [µm]", "right", ";"), row("Fr [µm]", "left", ";"),
        )
    ),
    "english below a page": text(
        "Inspection report", "Operator: R. Meier", "Date: today", "Machine: new", "Material: steel", teeth("Tooth"),
        row("fp left [um]", "left"), row("fp right [um]", "right"),
    ),
    "heads in columns": german(
        text(
            teeth("Flanke;Größe;Einheit", ";") + ";max", row("links;fp;µm", "left", ";") + ";9.9",
            row(";Fp;µm", "left", ";", sums=True) + ";9.9", row("rechts;fp;µm", "right", ";") + ";9.9",
        )
    ),
    "titles": text("Left flank", teeth("Tooth"), row("fp", "left"), "Right flank", teeth("Tooth"), row("fp", "right")),
    "titles among": text(teeth("Tooth"), "Left flank", row("fp", "left"), "Right flank", row("fp", "right")),
    "millimetres": text(
        teeth("Tooth"), row("fp left [mm]", "left", form=".4f", per_um=1e-3),
        row("fp right [mm]", "right", form=".4f", per_um=1e-3),
    ),
    "from 0, closed": text(
        teeth("Tooth", numbers=range(Z)) + ",0", row("fp left", "left") + ",6.0", row("fp right", "right") + ",-1.0"
    ),
    "blanks": german(text(teeth("Zahn", " "), row("fp links", "left", " "), row("fp rechts", "right", " "))),
}  # fmt: skip


@pytest.mark.parametrize("name", BLOCKS)
def test_blocks_of_both_flanks(gearpoly_command: Command, tmp_path: Path, name: str) -> None:
    code, said = run(gearpoly_command, tmp_path, BLOCKS[name], MAP)
    assert code == 0, said
    right(tmp_path)


@pytest.mark.parametrize("name", COLUMNS)
def test_teeth_in_columns(gearpoly_command: Command, tmp_path: Path, name: str) -> None:
    code, said = run(gearpoly_command, tmp_path, COLUMNS[name], MAP)
    assert code == 0, said
    right(tmp_path)


def test_teeth_in_columns_over_two_blocks(gearpoly_command: Command, tmp_path: Path) -> None:
    """A page is as wide as it is: teeth 9 to 11 stand below the others."""

    def part(first: int, end: int) -> list[str]:
        return [
            teeth("Tooth", numbers=range(first + 1, end + 1)),
            *(",".join((f"fp {s} [um]", *map(str, SINGLE[s][first:end]))) for s in ("left", "right")),
        ]

    code, said = run(gearpoly_command, tmp_path, text(*part(0, 8), *part(8, Z)), MAP)
    assert code == 0, said
    right(tmp_path)


@pytest.mark.parametrize(
    ("lines", "words", "layout"),
    [
        (text("Flanke A", HEAD, *LEFT, "Flanke B", HEAD, *RIGHT), '[blocks] "line 2" = "left"',
         '[blocks]\n"Flanke A" = "left"\n"line 14" = "right"\n'),
        (text(HEAD, *LEFT, HEAD, *RIGHT), '[blocks] "line 1" = "left"',
         '[blocks]\n"line 1" = "left"\n"line 13" = "right"\n'),
        (text(HEAD, "Side A", *LEFT, "Side B", *RIGHT), '[blocks] "line 2" = "left"',
         '[blocks]\n"line 2" = "left"\n"Side B" = "right"\n'),
        (text("A,,,,B,,", f"{HEAD},,{HEAD}", *BESIDE), '[columns] "column 2" = "single_pitch_left"',
         '[columns]\n"column 2" = "single_pitch_left"\n"column 6" = "single_pitch_right"\n'),
        (text(teeth("Nr"), row("dT li", "left"), row("dT re", "right")), '[columns] "dT li" = "ignored", or tooth',
         '[columns]\n"dT li" = "single_pitch_left"\n"line 3" = "single_pitch_right"\n'),
        (text(teeth("Nr"), row("fp", "left"), row("fp", "right")), '"line 3" = "single_pitch_right"',
         '[columns]\n"line 2" = "single_pitch_left"\n"line 3" = "single_pitch_right"\n'),
    ],
    ids=["titles", "no titles", "titles among", "side by side", "unknown heads", "one head twice"],
)  # fmt: skip
def test_a_map_says_what_the_sheet_does_not(
    gearpoly_command: Command, tmp_path: Path, lines: str, words: str, layout: str
) -> None:
    """What is not sure is asked for, and the lines that the refusal names are the cure."""
    code, said = run(gearpoly_command, tmp_path, lines, MAP)
    assert code == 2 and words in said, said
    assert not (tmp_path / "p.toml").exists()
    code, said = run(gearpoly_command, tmp_path, lines, MAP + layout)
    assert code == 0, said
    right(tmp_path)


@pytest.mark.parametrize(
    ("lines", "layout", "words"),
    [
        (text("Left flank", HEAD, *LEFT, "Left flank", HEAD, *RIGHT), "", "tooth 1 again, after line 3"),
        (text("Left flank", HEAD, *LEFT, "Left flank", HEAD, *RIGHT), "", '[blocks] "line 15" = "right"'),
        (text("Left flank", HEAD, *LEFT[:-1], "Right flank", HEAD, *RIGHT), "", "no single pitch of tooth 11"),
        (BLOCKS["english"], '[blocks]\n"line 99" = "left"\n', "want the title of a block"),
        (BLOCKS["english"], '[blocks]\n"line 2" = "top"\n', "blocks.line 2"),
        (text(teeth("Tooth"), row("fp left", "left").rsplit(",", 1)[0]), "", "11 cells; want 12, as in line 1"),
        (text(teeth("Tooth"), row("fp left", "left").replace("3.0", "x")), "", 'line 2, column 7: "x"'),
        (text(teeth("Tooth", numbers=range(1, Z)), row("fp left", "left")), "", "columns of 10 teeth"),
    ],
)  # fmt: skip
def test_faults_of_blocks_and_columns(
    gearpoly_command: Command, tmp_path: Path, lines: str, layout: str, words: str
) -> None:
    code, said = run(gearpoly_command, tmp_path, lines, MAP + layout)
    assert code == 2 and words in said, said
    assert not (tmp_path / "p.toml").exists()


def test_the_sense_of_rotation_is_no_flank(gearpoly_command: Command, tmp_path: Path) -> None:
    """Lines that have left or right in another sense, or of a name, say nothing of flanks."""
    for line in (
        "Drehrichtung: rechts",
        "Flankenrichtung: links",
        "Prüfer: R. Meier",
        "links und rechts",
        "right hand",
    ):
        code, said = run(gearpoly_command, tmp_path, text(line, HEAD, *LEFT), MAP)
        assert code == 2 and "of which flank" in said, said


def test_what_no_block_is_of_stays_out(gearpoly_command: Command, tmp_path: Path) -> None:
    """A title holds for the block below it, not for the next one of another quantity."""
    shape = [f"{n + 1},{0.1 * n:.1f}" for n in range(Z)]
    code, said = run(gearpoly_command, tmp_path, text("Right flank", HEAD, *RIGHT, "", "Tooth,fHa (um)", *shape), MAP)
    assert code == 2 and '"fHa (um)" of which flank' in said
    lines = text("Right flank", HEAD, *RIGHT, "Left flank", "Tooth,fHa (um)", *shape)
    code, said = run(gearpoly_command, tmp_path, lines, MAP)
    assert code == 0, said
    held = tomllib.loads((tmp_path / "p.toml").read_text(encoding="utf-8"))["driving"]["inspection"]
    np.testing.assert_allclose(held["profile_slope_um"], 0.1 * np.arange(Z), atol=1e-9)
    np.testing.assert_allclose(held["single_pitch_coast_um"], SINGLE["right"], atol=0.051)
    assert "single_pitch_um" not in held
