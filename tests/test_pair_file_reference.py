"""The page about the pair file says what the models read."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from gearpoly.files.models import GearSection, PairFile
from gearpoly.files.reference import pair_file_reference

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "pair_file.md"


def test_the_page_is_what_the_models_say() -> None:
    assert PAGE.read_text(encoding="utf-8") == pair_file_reference(), (
        "write it anew: python -m gearpoly.files.reference docs/reference/pair_file.md"
    )


def test_every_key_of_a_gear_stands_on_the_page_with_its_meaning() -> None:
    """Also the tables below it; no row without a meaning, no table twice."""
    page = pair_file_reference()
    keys = re.findall(r"^\| `(\w+)` \| (.+) \| (.+) \|$", page, flags=re.MULTILINE)
    known = {name for name, _, _ in keys}
    assert known >= {"pressure_angle_deg", "profile_shift", "bore_mm", "depth_um", "windup_urad_per_nm"}
    assert all(meaning not in ("", "None") for _, meaning, _ in keys)
    titles = re.findall(r"^## (.+)$", page, flags=re.MULTILINE)
    assert len(titles) == len(set(titles))
    assert "`[[driving.spall]]`, any number of them" in titles
    assert "`[driving.encoder]`" in titles


def test_the_example_on_the_page_is_a_pair_file() -> None:
    (example,) = re.findall(r"```toml\n(.+?)```", pair_file_reference(), flags=re.DOTALL)
    pair = PairFile.model_validate(tomllib.loads(example))
    assert isinstance(pair.driven, GearSection)
    assert pair.driven.teeth == 25
