"""Inspection files made wrong, as XML and as bytes: a gear's inspection that the pair takes, or one line."""

from __future__ import annotations

import copy
import xml.etree.ElementTree as Xml
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearpoly.files.gde_inspection import inspection
from gearpoly.files.gde_read import read_gde
from gearpoly.files.models import PairFile
from tests.fuzz.judge import FUZZ, judged
from tests.fuzz.mutate import damaged, texts
from tests.test_gde import HAND

WHOLE = Xml.fromstring(HAND)
PAIR = PairFile.model_validate(
    {
        "driving": {"teeth": 6, "module_mm": 2.5, "profile_shift": 0.6, "inspection": {"gde": "gear.gde"}},
        "driven": {"teeth": 25, "module_mm": 2.5},
    }
)
# XML 1.0 has no way to hold them, so that no writer makes them; damaged bytes may.
printable = texts.filter(lambda text: all(c >= " " for c in text) and "\ufffe" not in text and "\uffff" not in text)


@st.composite
def documents(draw: Any) -> bytes:
    """The inspection file with up to four changes: a block dropped, doubled, renamed or moved, a unit or number
    replaced."""
    root = copy.deepcopy(WHOLE)
    for _ in range(draw(st.sampled_from((0, 1, 1, 1, 2, 4)))):
        parents = [one for one in root.iter() if len(one)]
        if not parents:
            break
        parent = draw(st.sampled_from(parents))
        child = draw(st.sampled_from(list(parent)))
        change = draw(st.sampled_from(("drop", "double", "rename", "move", "text", "attribute", "nest")))
        if change == "drop":
            parent.remove(child)
        elif change == "double":
            parent.append(copy.deepcopy(child))
        elif change == "rename":
            child.tag = draw(st.sampled_from(("pitch", "profile", "normal_module", "a", "{urn:x}pitch", "geometry")))
        elif change == "move":
            draw(st.sampled_from(parents)).append(copy.deepcopy(child))
        elif change == "text":
            child.text = draw(printable | st.lists(st.floats().map(str) | printable, max_size=8).map(" ".join))
        elif change == "attribute":
            child.set(draw(st.sampled_from(("unit", "flank", "tooth", "direction", "tooth_count"))), draw(printable))
        elif change == "nest":
            for _ in range(draw(st.sampled_from((1, 300)))):
                around = Xml.Element(child.tag)
                parent.remove(child)
                around.append(child)
                parent.append(around)
                child = around
    return Xml.tostring(root, encoding="utf-8", xml_declaration=True)


@pytest.mark.long
@FUZZ
@given(data=st.data())
def test_an_inspection_file_gives_an_inspection_or_one_line(folder: Path, data: st.DataObject) -> None:
    file = folder / "gear.gde"
    file.write_bytes(data.draw(damaged(data.draw(documents()))))
    if judged("inspection files", lambda: read_gde(file)) is not None:
        section = PAIR.driving
        assert section.inspection is not None
        sheet = section.inspection
        judged("inspections taken", lambda: inspection(folder / "pair.toml", section, sheet, "driving"))
