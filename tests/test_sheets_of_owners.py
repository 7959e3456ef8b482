"""Inspection tables as people keep them: other units, other counts, rows beside the teeth. Each gives one gear."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

from tests.made_command import Command

Z = 11
SINGLE = {
    "left": (6.0, -2.5, 1.0, -4.0, 0.5, 3.0, -1.5, 2.0, -3.5, 1.5, -2.5),
    "right": (-1.0, 2.0, -3.0, 4.5, -0.5, 0.0, 1.0, -2.0, 3.0, -5.0, 1.0),
}
"""um, adding up to 0, the pitch from tooth n - 1 to n."""

SUMS = {side: tuple(np.round(np.cumsum(values), 1).tolist()) for side, values in SINGLE.items()}
MAP = "[gear]\nmodule_mm = 2.0\nteeth = 11\n"


def rows(form: str = "{:.1f}", *, per_um: float = 1.0, first: int = 1, sep: str = ",", sums: bool = False) -> list[str]:
    held = SUMS if sums else SINGLE
    return [
        sep.join([str(first + n), *(form.format(per_um * held[side][n]) for side in ("left", "right"))])
        for n in range(Z)
    ]


def sheet(head: str, lines: list[str]) -> str:
    return "\n".join([head, *lines]) + "\n"


HEAD = "tooth,fp left [um],fp right [um]"
PLAIN = rows()
SUMMED = rows(sums=True)
COMMAS = [line.replace(",", ";").replace(".", ",") for line in rows("{:.4f}", per_um=1e-3)]
BLANKS = [
    f"{n + 1:4d} " + " ".join(f"{held[side][n]:8.1f}" for side in ("left", "right") for held in (SINGLE, SUMS))
    for n in range(Z)
]
BETWEEN = [f"{(k - 1) % Z or Z}-{line}" for k, line in enumerate(PLAIN, 1)]
LONG = [f"{n + 1},{word},{SINGLE[side][n]}" for side, word in (("left", "LH"), ("right", "RF")) for n in range(Z)]
BESIDE = [f"{one},9.9,2.1,8.8" for one in PLAIN]
BARS = [f"| {line.replace(',', ' | ')} |" for line in PLAIN]
MERGED = [
    ",".join([str(n + 1), *(str(held[side][n]) for side in ("left", "right") for held in (SINGLE, SUMS))])
    for n in range(Z)
]
BY_NUMBER = "\n".join(
    f'"column {k}" = "{held}"'
    for k, held in enumerate(("tooth", "single_pitch_left", "ignored", "single_pitch_right"), start=1)
)


def run(gearpoly_command: Command, folder: Path, text: str, layout: str = MAP) -> tuple[int, str]:
    """The exit code and what was said; the pair file is ``p.toml``."""
    file, chart = folder / "sheet.csv", folder / "map.toml"
    file.write_bytes(text.encode("utf-8"))
    chart.write_text(layout, encoding="utf-8")
    ran = gearpoly_command(
        "pair", "--from", file, folder / "p.toml", "--as", "driving", "--flank", "left", "--count", "clockwise",
        "--map", chart,
    )  # fmt: skip
    return ran.code, ran.err


def taken(folder: Path) -> dict[str, list[float]]:
    """The deviations by the sheet's side. A driving gear whose left flank drives turns counter-clockwise, so that teeth
    mesh in the order in which they are counted clockwise."""
    held = tomllib.loads((folder / "p.toml").read_text(encoding="utf-8"))["driving"]["inspection"]
    return {"left": held["single_pitch_um"], "right": held["single_pitch_coast_um"]}


def right(folder: Path, *, shift: int = 0, atol: float = 0.051) -> None:
    """The same gear, and not one that is turned by a tooth."""
    for side, values in taken(folder).items():
        np.testing.assert_allclose(values, np.roll(SINGLE[side], shift), rtol=0.0, atol=atol)


@pytest.mark.parametrize(
    "text",
    [
        sheet(HEAD, PLAIN),
        sheet("tooth,Fp left [um],Fp right [um]", SUMMED),
        sheet(HEAD, rows(first=0)),
        sheet(HEAD, PLAIN[::-1]),
        sheet("Zahn;fp links [mm];fp rechts [mm]", COMMAS),
        sheet("Tooth,fp left (in),fp right (in)", rows("{:.7f}", per_um=1 / 25_400)),
        sheet("Tooth No.,fp Left (mils),fp Right (mils)", rows("{:.4f}", per_um=1 / 25.4)),
        sheet('Tooth #,Pitch Var LF (0.0001"),Pitch Var RF (0.0001")', rows("{:.3f}", per_um=1 / 2.54)),
        sheet("tooth,fp left [m],fp right [m]", rows("{:.3e}", per_um=1e-6)),
        sheet("tooth,fp left,fp right\n,mm,mm", rows("{:.4f}", per_um=1e-3)),
        sheet(HEAD, [*PLAIN, "max,6.0,4.5", "mean,0.0,0.0", ",,"]),
        sheet(HEAD, [*PLAIN, PLAIN[0]]),
        sheet("tooth,Fp left [um],Fp right [um]", ["0,0.0,0.0", *SUMMED]),
        sheet(HEAD, [line.replace(",", ".0,", 1) for line in PLAIN]),
        sheet(HEAD, [f"T{line}" for line in PLAIN]),
        sheet("Tooth pair,fp left [um],fp right [um]", BETWEEN),
        sheet(HEAD, [line.replace("-", "\u2212") for line in PLAIN]),
        sheet("Dent,fp gauche [um],fp droite [um]", PLAIN),
        sheet("Zahn,Linke Flanke fp,Rechte Flanke fp\n,µm,µm", PLAIN),
        sheet("Tooth,Left Spacing [um],Right Spacing [um]", PLAIN),
        sheet("tooth,fp left [um],fp right [um],Fr [um],ffa left [um],Fb right [um]", BESIDE),
        sheet("tooth,side,fp [um]", LONG),
        sheet("Zahn;Linke Flanke;Rechte Flanke;\n;fp [µm];fp [µm];", [f"{line.replace(',', ';')};" for line in PLAIN]),
        sheet("Tooth,Left,,Right,\n,fp [um],Fp [um],fp [um],Fp [um]", MERGED),
        sheet("| Tooth | fp left [um] | fp right [um] |\n|---|---|---|", BARS),
        sheet("Zahn Nr.   fp links   Fp links   fp rechts   Fp rechts\n    [µm]    [µm]    [µm]    [µm]", BLANKS),
    ],
    ids=range(26),
)  # fmt: skip
def test_every_way_of_writing_gives_the_same_gear(gearpoly_command: Command, tmp_path: Path, text: str) -> None:
    code, said = run(gearpoly_command, tmp_path, text)
    assert code == 0, said
    right(tmp_path)


def test_columns_of_one_head_are_named_by_their_numbers(gearpoly_command: Command, tmp_path: Path) -> None:
    """Machines print both flanks side by side, with their names in a line above, parted by blanks."""
    top = "PITCH      left flank         right flank\nTooth   fp   Fp   fp   Fp"
    text = sheet(top, [*BLANKS, "", "fp max  6.0  4.5", "Fr 12.0"])
    code, said = run(gearpoly_command, tmp_path, text)
    assert code == 2 and '"fp" again' in said and '"column 4" = "single_pitch_right"' in said
    code, said = run(gearpoly_command, tmp_path, text, MAP + "[columns]\n" + BY_NUMBER)
    assert code == 0, said
    right(tmp_path)


def test_a_table_without_heads_is_read_by_numbers(gearpoly_command: Command, tmp_path: Path) -> None:
    text = sheet("made by hand", BLANKS)
    code, said = run(gearpoly_command, tmp_path, text)
    assert code == 2 and '"column 1" = "tooth"' in said
    code, said = run(gearpoly_command, tmp_path, text, MAP + "[columns]\n" + BY_NUMBER)
    assert code == 0, said
    right(tmp_path)


def test_millimetres_without_a_unit_are_asked_about(gearpoly_command: Command, tmp_path: Path) -> None:
    """No machine prints deviations of a hundredth of a micrometre: a thousandth of each would have been taken."""
    text = sheet("tooth,fp left,fp right", rows("{:.4f}", per_um=1e-3))
    code, said = run(gearpoly_command, tmp_path, text)
    assert code == 2 and "states no unit" in said and 'unit = "mm"' in said
    assert not (tmp_path / "p.toml").exists()
    code, said = run(gearpoly_command, tmp_path, text, 'unit = "mm"\n' + MAP)
    assert code == 0, said
    right(tmp_path)
    (tmp_path / "p.toml").unlink()
    code, said = run(gearpoly_command, tmp_path, sheet("tooth,fp left,fp right", PLAIN))
    assert code == 0 and "is taken in um" in said
    right(tmp_path)


def test_micrometres_under_a_head_of_millimetres_are_refused(gearpoly_command: Command, tmp_path: Path) -> None:
    """6 mm of pitch deviation at module 2 are a whole tooth."""
    code, said = run(gearpoly_command, tmp_path, sheet("tooth,fp left [mm],fp right [mm]", PLAIN))
    assert code == 2 and "6000 um at module 2 mm" in said and "want the unit that the numbers have" in said
    code, said = run(gearpoly_command, tmp_path, sheet("tooth,Fp left [mm],Fp right [mm]", SUMMED))
    assert (
        code == 2 and "5000 um at module 2 mm" in said
    )  # the largest step of the sums, of which one is not among them


def test_printed_steps_of_a_micrometre_add_up_as_such(gearpoly_command: Command, tmp_path: Path) -> None:
    """mm with three decimals: F_p steps by f_p but for three roundings of 0.5 um."""
    lines = [f"{n + 1},{SINGLE['left'][n] / 1e3:.3f},{SUMS['left'][n] / 1e3:.3f}" for n in range(Z)]
    code, said = run(gearpoly_command, tmp_path, sheet("tooth,fp left [mm],Fp left [mm]", lines))
    assert code == 0, said
    held = tomllib.loads((tmp_path / "p.toml").read_text(encoding="utf-8"))["driving"]["inspection"]
    np.testing.assert_allclose(held["single_pitch_um"], SINGLE["left"], rtol=0.0, atol=1.01)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (sheet(HEAD, [*PLAIN, "12,0.0,0.0"]), "rows of 12 teeth"),
        (sheet(HEAD, PLAIN[:9]), "rows of 9 teeth"),
        (sheet(HEAD, [*PLAIN[:5], "max,1,1", *PLAIN[5:]]), 'tooth "max"'),
        (sheet(HEAD, [*PLAIN, "x12,1,1"]), "rows of 12 teeth"),
        (sheet(HEAD, [*PLAIN[:-1], "9-7,1.0,1.0"]), "or 6-7 for the pitch"),
        (sheet(HEAD, [*PLAIN, "1,2.0,2.0"]), "tooth 1 again"),
        (sheet("tooth,fp left [arcsec],fp right [um]", PLAIN), "an angle in rad times the radius"),
        (sheet("tooth,FP left [um],fp right [um]", PLAIN), '"FP left [um]" = "ignored", or tooth, flank, single_pitch'),
    ],
)
def test_what_is_no_gear_is_refused(gearpoly_command: Command, tmp_path: Path, text: str, words: str) -> None:
    code, said = run(gearpoly_command, tmp_path, text)
    assert code == 2
    assert words in said
    assert not (tmp_path / "p.toml").exists()
