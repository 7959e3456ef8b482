"""Commas that part cells and mark decimals too: read where one way is left, asked for where two are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from tests.made_command import Command
from tests.made_texts import DEGREE, GERMAN, OWN, chart, run, table, written
from tests.test_read_locales import check

RUN = run()
COLUMNS = list(RUN.values())


@pytest.mark.parametrize("names", [GERMAN, OWN])
@pytest.mark.parametrize("separator", [",", ", "])
@pytest.mark.parametrize("digits", [3, 5, 9])
def test_the_names_above_say_how_many_numbers_there_are(
    tmp_path: Path, names: tuple[str, ...], separator: str, digits: int
) -> None:
    """Eight columns without names were told; with three digits a comma could part thousands too."""
    file = written(tmp_path, table(COLUMNS, names, separator=separator, digits=digits, head="# torque_nm = 25.0\n"))
    recording = read_recording(file)
    check(recording, half=0.5 * 10.0**-digits)
    assert recording.torque_nm == 25.0
    assert any("commas part the cells and mark the decimals too" in one for one in recording.remarks)


def test_whole_numbers_and_stamps_among_them(tmp_path: Path) -> None:
    """Fractions show themselves by zeros in front, so that a count of cycles and a time of day stay what they are."""
    stamps = [f"04.03.2026 10:15:{7 + t:06.3f}".replace(".", ",").replace(",", ".", 2) for t in RUN["time_s"]]
    assert stamps[1] == "04.03.2026 10:15:07,010"
    rows = [
        f"{stamp},{k},{driving:.5f},{k % 7},{driven:.5f}".replace(".", ",").replace(",", ".", 2)
        for k, (stamp, driving, driven) in enumerate(zip(stamps, COLUMNS[1], COLUMNS[2], strict=True))
    ]
    assert rows[1].startswith("04.03.2026 10:15:07,010,1,1,80000,1,1,29")
    names = f"Stempel,Zyklus,{GERMAN[1]},Stufe,{GERMAN[2]}"
    recording = read_recording(written(tmp_path, "\n".join([names, *rows, ""])))
    check(recording, torque=False)


@pytest.mark.parametrize("sign", ["-", "\u2212"])
def test_negative_numbers_and_powers(tmp_path: Path, sign: str) -> None:
    te = 40.0 * np.sin(np.radians(COLUMNS[1])) - 0.5
    rows = [f"{t:.3f},{a:.4f},{x:.6E}".replace(".", ",") for t, a, x in zip(*COLUMNS[:2], te, strict=True)]
    text = "\n".join([f"{GERMAN[0]},{GERMAN[1]},te_um", *(row.replace("E-", "E~").replace("-", sign) for row in rows)])
    recording = read_recording(written(tmp_path, text.replace("E~", "E-") + "\n"))
    assert recording.te_mm is not None
    np.testing.assert_allclose(1e3 * recording.te_mm, te, rtol=0.0, atol=1e-5)


def test_what_is_found_is_written_into_the_map_and_read_by_it(tmp_path: Path, gearpoly_command: Command) -> None:
    file = written(tmp_path, table(COLUMNS, GERMAN, separator=","))
    assert gearpoly_command("read", file, "--write", tmp_path / "found.toml").code == 0
    text = (tmp_path / "found.toml").read_text(encoding="utf-8")
    assert 'decimal = ","' in text and 'separator = ","' in text
    check(read_recording(file, chart=chart(tmp_path, text)))


def test_without_names_it_is_asked(tmp_path: Path) -> None:
    """Eight whole numbers are as many as four with decimals: the columns were offered as whole ones."""
    file = written(tmp_path, table(COLUMNS, GERMAN, separator=",").partition("\n")[2])
    asked = r'may be 4 numbers with decimal commas or 8 whole ones; want .*: text.decimal = "," or text.decimal = "."'
    with pytest.raises(InputFileError, match=asked):
        read_recording(file)
    lines = "".join(
        f'columns.{column} = {{ from = "column {k}", unit = "{unit}" }}\n'
        for k, (column, unit) in enumerate(zip(OWN, ("s", "deg", "deg", "N.m"), strict=True), start=1)
    )
    check(read_recording(file, chart=chart(tmp_path, 'text.decimal = ","\n' + lines)))
    with pytest.raises(InputFileError, match="8 columns of numbers without names"):
        read_recording(file, chart=chart(tmp_path, 'text.decimal = "."\n'))


def test_fractions_without_a_zero_in_front_may_be_whole_numbers(tmp_path: Path) -> None:
    """Two channels may have been put beside the two that have names."""
    turned = np.round(np.linspace(0.0, 2999.0, 1500) + 0.2, 1)
    rows = [f"{k},{a:.1f}".replace(".0", ".3").replace(".", ",") for k, a in enumerate(turned)]
    text = "\n".join(["driving_count,k", *(f"{row.partition(',')[0]},5,{row.partition(',')[2]}" for row in rows), ""])
    with pytest.raises(InputFileError, match="want"):
        read_recording(written(tmp_path, text))
    text = "\n".join(["Zaehler Antrieb,Zaehler Abtrieb", *(f"{k},5,{k // 2},5" for k in range(1500)), ""])
    with pytest.raises(InputFileError, match=r"may be 2 numbers with decimal commas or 4 whole ones"):
        read_recording(written(tmp_path, text))


def test_rows_of_uneven_numbers_of_cells_have_no_one_way(tmp_path: Path) -> None:
    """As %g writes numbers: whole ones have no comma, and 1,2,3 is 1,2 and 3 or 1 and 2,3."""
    rows = [",".join(f"{v:.6g}".replace(".", ",") for v in row) for row in zip(*COLUMNS, strict=True)]
    assert len({row.count(",") for row in rows}) > 1
    text = "\n".join([",".join(GERMAN), *rows, ""])
    with pytest.raises(InputFileError, match=r"line \d+: `.*`, \d cells.*; want semicolons between the cells, or dec"):
        read_recording(written(tmp_path, text))
    lines = 'text.torn_lines = "left out"\n'
    recording = read_recording(written(tmp_path, text), chart=chart(tmp_path, lines))
    kept = np.array([row.count(",") == 7 for row in rows])
    assert recording.driven_angle_rad is not None and 0 < kept.sum() < 1500
    np.testing.assert_allclose(recording.driven_angle_rad, COLUMNS[2][kept] * DEGREE, rtol=1e-5)


@pytest.mark.parametrize("names", [GERMAN, ("a", "b", "c", "d")])
def test_whole_numbers_with_zeros_in_front_stay_whole(tmp_path: Path, names: tuple[str, ...]) -> None:
    """A name for each column: counters that fill up with zeros, as 0012,0345."""
    rows = [",".join(f"{int(v):05d}" for v in row) for row in zip(*COLUMNS, strict=True)]
    file = written(tmp_path, "\n".join([",".join(names), *rows, ""]))
    if names is GERMAN:
        np.testing.assert_array_equal(read_recording(file).driving_angle_rad, np.floor(COLUMNS[1]) * DEGREE)
    else:
        with pytest.raises(InputFileError, match="only a, b, c, d"):
            read_recording(file)
