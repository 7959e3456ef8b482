"""The docs are read once and understood: short sentences, and every term in the glossary."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from gearpoly.physics import catalogue
from gearpoly.report.simulation_files import CSV_HEADER
from tests import made_commands_page, prose

PAGES = prose.pages()


@pytest.mark.parametrize("page", PAGES, ids=[str(page.relative_to(prose.ROOT)) for page in PAGES])
def test_sentences_are_short(page: Path) -> None:
    long = [f"{one.page}:{one.line}: {one.words} words: {one.text}" for one in prose.too_long(page)]
    assert not long, "\n".join(long)
    assert prose.mean_words(page) <= prose.MEAN


@pytest.mark.parametrize("page", PAGES, ids=[str(page.relative_to(prose.ROOT)) for page in PAGES])
def test_every_term_is_in_the_glossary(page: Path) -> None:
    lacking = sorted(prose.used(page) - prose.explained())
    assert not lacking, f"{prose.GLOSSARY.relative_to(prose.ROOT)} lacks {lacking}"


def test_every_physics_of_the_catalogue_is_in_the_glossary() -> None:
    """By its own words, or by each of them where it is named after a part: an encoder's eccentricity."""
    known = prose.explained()
    loose = {"windup": "wind-up", "thermal": "drift", "tooth": "tooth thickness", "shaft": "wind-up"}
    for name in catalogue():
        words = name.replace("_", " ")
        parts = {loose.get(part, part) for part in words.split()}
        assert words in known or parts <= known | {"profile", "tip", "mesh", "centre"}, f"the glossary lacks {words}"


@pytest.mark.long
def test_nothing_is_said_twice() -> None:
    assert not prose.said_twice()


def test_what_is_said_twice_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, text in (
        ("a.md", "The pair runs in the morning sun. Short."),
        ("b.md", "So: the pair runs in the\nmorning sun."),
    ):
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.setattr(prose, "pages", lambda: sorted(tmp_path.glob("*.md")))
    assert not prose.said_twice()  # "So:" goes on
    (tmp_path / "b.md").write_text("So it is. The pair runs in the\nmorning sun.", encoding="utf-8")
    assert prose.said_twice() == {"the pair runs in the morning sun": ["a.md:1", "b.md:1"]}


def test_a_long_sentence_and_a_foreign_term_are_seen(tmp_path: Path) -> None:
    words = " ".join(["word"] * 36)
    text = f"# Head\n\nShort one. {words.capitalize()}.\n\n| a | b |\n| --- | --- |\n| {words}; {words} | a QZX |\n"
    page = tmp_path / "made.md"
    page.write_text(text, encoding="utf-8")
    assert [one.words for one in prose.too_long(page)] == [36, 36, 36]
    assert prose.used(page) == {"qzx"}
    code = "`--flag value`, e.g. `x`, makes 3.5 um (see Eq. 16). A second sentence.\n"
    page.write_text(code, encoding="utf-8")
    assert [one.words for one in prose.sentences(page)] == [9, 3]


def test_links_lead_somewhere() -> None:
    """Files that are there, and headings as GitHub and the site name them."""
    for page in (*PAGES, *(prose.ROOT / name for name in prose.WRITTEN_ELSEWHERE)):
        text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        for target in re.findall(r"\]\(([^)\s]+)\)", text):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, heading = target.partition("#")
            file = (page.parent / path).resolve() if path else page
            assert file.exists(), f"{page.name}: {target}"
            if heading:
                heads = re.findall(r"^#+ (.+)$", file.read_text(encoding="utf-8"), re.MULTILINE)
                assert heading in {slug(head) for head in heads}, f"{page.name}: {target}"


def slug(head: str) -> str:
    return re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-")


def test_the_page_of_commands_is_what_the_commands_say() -> None:
    page = prose.ROOT / "docs" / "reference" / "commands.md"
    assert page.read_text(encoding="utf-8") == made_commands_page.page(), f"write {page.name} anew"


def test_the_page_of_a_simulation_has_the_columns_of_its_table() -> None:
    page = (prose.ROOT / "docs" / "reference" / "simulated.md").read_text(encoding="utf-8")
    listed = re.findall(r"`(\w+)`", page.partition("| column | is |")[2].partition("## The JSON")[0])
    assert listed == [*CSV_HEADER.split(","), "mesh_stiffness_n_per_um"]


@pytest.mark.parametrize("page", PAGES, ids=[str(page.relative_to(prose.ROOT)) for page in PAGES])
def test_a_page_with_its_pictures_loads_soon(page: Path) -> None:
    """Below 1.5 MB, of which text, styles and scripts of the site take up to 0.5."""
    pictures = set(re.findall(r"!\[[^\]]*\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")))
    assert sum((page.parent / one).stat().st_size for one in pictures) < 1_000_000


def test_every_page_is_on_the_site() -> None:
    """One table of contents, and each page once in it."""
    listed = re.findall(r"^([a-z_]+(?:/[a-z_]+)?)$", (prose.ROOT / "docs" / "index.md").read_text(), re.MULTILINE)
    there = {str(page.relative_to(prose.ROOT / "docs").with_suffix("")) for page in (prose.ROOT / "docs").rglob("*.md")}
    assert sorted(listed) == sorted(there - {"index"})
