"""One version, said in one place, and what a release holds."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import gearpoly

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def test_citation_and_changelog_are_of_this_version() -> None:
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    dated = re.search(r"^## \[(\d+\.\d+\.\d+)\] - (\d{4}-\d{2}-\d{2})$", changes, re.MULTILINE)
    assert dated is not None
    assert dated[1] == gearpoly.__version__
    assert f"version: {dated[1]}\n" in citation and f'date-released: "{dated[2]}"' in citation
    assert PROJECT["project"]["dynamic"] == ["version"]


def test_all_extras_are_in_all_but_the_heavy_and_the_makers() -> None:
    extras = PROJECT["project"]["optional-dependencies"]
    (everything,) = extras["all"]
    held = set(re.fullmatch(r"gearpoly\[(.*)\]", everything)[1].split(","))  # type: ignore[index]
    assert held == set(extras) - {"all", "step", "test", "docs"}


def test_the_source_package_lists_what_is_there() -> None:
    for name in PROJECT["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]:
        assert (ROOT / name).exists(), name
    for source in PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]:
        assert (ROOT / source).is_dir()
