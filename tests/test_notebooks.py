"""The notebooks of the docs run from top to bottom, and what they say of their numbers holds."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "docs" / "tutorial").glob("python_*.md"))
SLOW = {"python_diagnose", "python_plan"}
"""Half a minute, and ten seconds."""

CELL = re.compile(r"^```\{code-cell\}\n((?::[^\n]*\n)*)(.*?)^```$", re.MULTILINE | re.DOTALL)
HIDDEN = ":tags: [remove-cell]\n"


def cells(path: Path) -> list[tuple[str, str]]:
    """Options and code of every cell."""
    return [(options, code) for options, code in CELL.findall(path.read_text(encoding="utf-8"))]


@pytest.mark.long
@pytest.mark.parametrize(
    "path", [pytest.param(one, marks=pytest.mark.slow if one.stem in SLOW else (), id=one.stem) for one in NOTEBOOKS]
)
def test_a_notebook_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its last cell is hidden, and asserts what the text says."""
    monkeypatch.chdir(tmp_path)
    pyplot = pytest.importorskip("matplotlib.pyplot")
    names: dict[str, object] = {}
    for number, (_, code) in enumerate(cells(path), start=1):
        exec(compile(code, f"{path.name}, cell {number}", "exec"), names)
    pyplot.close("all")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[one.stem for one in NOTEBOOKS])
def test_a_notebook_shows_the_api_and_hides_its_assertions(path: Path) -> None:
    *shown, (options, last) = cells(path)
    text = path.read_text(encoding="utf-8")
    assert text.count("```{code-cell}") == len(shown) + 1
    assert options == HIDDEN and "assert " in last
    for options, code in shown:
        assert not options and "assert " not in code
        assert not re.search(r"(from|import) gearpoly\.", code)


def test_the_site_is_made_of_what_its_extra_brings() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extra = {re.split(r"[>=\[]", one)[0] for one in project["optional-dependencies"]["docs"]}
    site = (ROOT / "docs" / "conf.py").read_text(encoding="utf-8")
    loaded = set(re.findall(r"[\w.]+", re.search(r"^extensions = \[(.*)\]", site, re.MULTILINE)[1]))  # type: ignore[index]
    wanted = {one.partition(".")[0].replace("_", "-") for one in loaded}
    wanted |= set(re.findall(r'^html_theme = "(\w+)"', site, re.MULTILINE))
    assert "myst-nb" in wanted and wanted <= extra
    assert '--editable ".[docs]"' in (ROOT / "Makefile").read_text(encoding="utf-8")
