"""Sheets of machines, tables, maps and designs made wrong, in their lines and in their bytes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearpoly.files.inspection.measured import translated
from gearpoly.files.inspection.read import read_sheet
from gearpoly.files.inspection.sheet_map import SheetMap, read_map
from gearpoly.files.pair_from import DESIGN_START_BYTES, Choices, pair_from
from gearpoly.files.rexs.source import read_model
from gearpoly.files.rexs.write import json_text
from tests.fuzz.judge import FUZZ, judged
from tests.fuzz.mutate import damaged, texts, toml, trees

SHEETS = Path(__file__).parents[2] / "data" / "sheets"
MAP: dict[str, Any] = {
    "separator": ";", "decimal": ",", "count": "clockwise", "first_tooth": 1,
    "gear": {"teeth": 25, "module_mm": 2.0, "pressure_angle_deg": 20.0, "start_mm": 40.0},
    "columns": {"Zahn-Nr.": "tooth", "fp links [µm]": "single_pitch_left"},
}  # fmt: skip
WORDS = ("links", "Zahn-Nr.:", "480", "Werte", "fp", "Fp", "-9999.0", "8999.0", "1e308", "0", "-1", "da", ":", "2,5")


@st.composite
def sheets(draw: Any, name: str) -> bytes:
    """A sheet with up to four changes to its lines: dropped, doubled, moved, cut, a word replaced."""
    lines = (SHEETS / name).read_text(encoding="cp1252" if name.endswith("csv") else "utf-8").splitlines()
    for _ in range(draw(st.sampled_from((0, 1, 1, 2, 4)))):
        at, to = draw(st.integers(0, len(lines) - 1)), draw(st.integers(0, len(lines) - 1))
        change = draw(st.sampled_from(("drop", "double", "move", "cut", "word", "word", "text")))
        if change == "drop" and len(lines) > 1:
            del lines[at]
        elif change == "double":
            lines.insert(to, lines[at])
        elif change == "move":
            lines[at], lines[to] = lines[to], lines[at]
        elif change == "cut":
            lines[at] = lines[at][: draw(st.integers(0, 40))]
        elif change == "word":
            words = lines[at].replace(";", " ; ").split(" ")
            words[draw(st.integers(0, len(words) - 1))] = draw(st.sampled_from(WORDS) | texts)
            lines[at] = " ".join(words)
        elif change == "text":
            lines[at] = draw(texts)
    return draw(damaged("\n".join(lines).encode("utf-8", "surrogatepass")))


@pytest.mark.long
@FUZZ
@pytest.mark.parametrize("name", ["driving.mka", "driven.csv"])
@given(data=st.data())
def test_a_sheet_gives_an_inspection_or_one_line(folder: Path, name: str, data: st.DataObject) -> None:
    file = folder / name
    whole = data.draw(sheets(name))
    file.write_bytes(whole)
    layout = data.draw(st.sampled_from((SheetMap(), SheetMap.model_validate(MAP))))

    def read() -> object:
        sheet = read_sheet(
            file, whole[:DESIGN_START_BYTES], layout=layout, known={}, count=None if "mka" in name else "clockwise"
        )
        return translated(sheet, which="driven", drive="right")

    judged("sheets of machines and tables", read)


@pytest.mark.long
@FUZZ
@given(data=st.data())
def test_a_map_gives_a_map_or_one_line(folder: Path, data: st.DataObject) -> None:
    file = folder / "map.toml"
    file.write_bytes(data.draw(damaged(toml(data.draw(trees([MAP]))).encode("utf-8", "surrogatepass"))))
    judged("maps of sheets", lambda: read_map(file).known)


DESIGN = json.loads(json_text(read_model(SHEETS / "design.rexs")))


@pytest.mark.long
@FUZZ
@given(data=st.data())
def test_a_design_gives_a_pair_file_or_one_line(folder: Path, data: st.DataObject) -> None:
    """As JSON, whose values and tables change their kind, or as the bytes of XML."""
    target = folder / "pair.toml"
    target.unlink(missing_ok=True)
    if data.draw(st.booleans()):
        file = folder / "design.rexsj"
        text = json.dumps(data.draw(trees([DESIGN])), allow_nan=True)
        file.write_bytes(data.draw(damaged(text.encode())))
    else:
        file = folder / "design.rexs"
        file.write_bytes(data.draw(damaged((SHEETS / "design.rexs").read_bytes())))
    if judged("designs", lambda: pair_from(file, target, Choices(which=None, stage=None))) is None:
        assert not target.exists()
