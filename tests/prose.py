"""The prose of a Markdown page: its sentences and its terms. ``python -m tests.prose`` lists what is wrong.

Sentences are counted as a reader meets them: code is one word, and a colon that a capital follows ends a sentence.
A table's cell is a text of its own, in which semicolons divide; a cell that lists short names is no sentence at all.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).resolve().parents[1]
GLOSSARY = ROOT / "docs" / "reference" / "glossary.md"
TERMS = Path(__file__).with_name("terms.txt")
WRITTEN_ELSEWHERE = ("docs/proof.md",)
"""Pages that a program writes from its runs."""

LONGEST = 35
"""Words in a sentence."""
MEAN = 25
"""Words in a page's sentences, on average."""

WORTH = 7
"""Words of a sentence from which it is not said in two places by chance."""

# A full stop ends a sentence where a capital, a digit, code or a bracket goes on; after these it does not.
SHORT = re.compile(r"\b(e\.g|i\.e|cf|vs|No|Eqs?|Fig|Figs|Dr|St|et al|J|Cent|Univ|approx|incl)\.$")
END = re.compile(r"(?<=[.!?:])[\"')\]]*\s+(?=[\"'(\[]?[A-Z0-9`])")
CELL_END = re.compile(END.pattern + r"|;\s")
WORD = re.compile(r"[^\W_]+(?:[-'./^_·][^\W_]+)*")
PLACES = {"PAIR", "DIR", "FILE", "NAME", "FOLDER"}
"""Words in capitals that stand for what a user gives."""

ABBREVIATION = re.compile(r"\b[A-Z][A-Z0-9]+\b")


@dataclass(frozen=True)
class Sentence:
    """``text`` with its number of ``words`` on a ``page`` (a path in the repository), in the block at ``line``.
    A ``cell`` is of a table."""

    page: str
    line: int
    text: str
    words: int
    cell: bool = False


def pages() -> list[Path]:
    """The pages that people read: README, docs, what stands beside data and examples."""
    found = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "data").rglob("*.md")]
    found += [ROOT / name for name in ("CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md") if (ROOT / name).is_file()]
    return sorted(path for path in found if str(path.relative_to(ROOT)) not in WRITTEN_ELSEWHERE)


def blocks(path: Path) -> list[tuple[int, bool, list[Token]]]:
    """Line, whether it is a table's cell, and inline parts of every paragraph, heading, list item and cell; no code."""
    return _blocks(path.read_text(encoding="utf-8"))


@cache
def _blocks(text: str) -> list[tuple[int, bool, list[Token]]]:
    out = []
    line = 1
    cell = False
    # What stands before a notebook's text is for programs; its lines still count.
    text = re.sub(r"\A---\n(.*\n)*?---\n", lambda head: "\n" * head[0].count("\n"), text)
    for token in MarkdownIt("commonmark").enable("table").parse(text):
        line = token.map[0] + 1 if token.map else line
        if token.type in ("td_open", "th_open", "td_close", "th_close"):
            cell = token.type.endswith("open")
        if token.type == "inline":
            out.append((line, cell, token.children or []))
    return out


def spoken(parts: list[Token]) -> str:
    """What a reader reads, each piece of code as one word."""
    said = []
    for part in parts:
        if part.type == "code_inline":
            said.append("Code" if not said or said[-1].rstrip().endswith((".", ":")) else "code")
        elif part.type in ("softbreak", "hardbreak"):
            said.append(" ")
        elif part.type == "text":
            said.append(re.sub(r"\$[^$]+\$", "formula", part.content))
    return "".join(said)


def sentences(path: Path) -> list[Sentence]:
    """All sentences of a page."""
    out = []
    for line, cell, parts in blocks(path):
        pieces: list[str] = []
        text = spoken(parts)
        if cell and max(len(WORD.findall(one)) for one in text.split(", ")) <= 5:
            continue
        for piece in (CELL_END if cell else END).split(text):
            if pieces and SHORT.search(pieces[-1]):
                pieces[-1] += " " + piece
            else:
                pieces.append(piece)
        for piece in pieces:
            words = len(WORD.findall(piece))
            if words:
                out.append(
                    Sentence(
                        path.name if ROOT not in path.parents else str(path.relative_to(ROOT)),
                        line,
                        piece.strip(),
                        words,
                        cell,
                    )
                )
    return out


def too_long(path: Path) -> list[Sentence]:
    """Sentences beyond ``LONGEST`` words."""
    return [one for one in sentences(path) if one.words > LONGEST]


def said_twice() -> dict[str, list[str]]:
    """Sentences of ``WORTH`` words or more that stand in the text of two places, and where; code counts as one word.

    Cells of tables may agree, since rows are read alone, so may a page that a program writes from the commands, and the
    changelog says once more what came.
    """
    places: dict[str, list[str]] = {}
    for page in pages():
        if page.name in ("CHANGELOG.md", "commands.md"):
            continue
        for one in sentences(page):
            words = [word.lower() for word in WORD.findall(one.text)]
            if not one.cell and len(words) >= WORTH and words.count("code") < len(words) / 2:
                places.setdefault(" ".join(words), []).append(f"{one.page}:{one.line}")
    return {text: where for text, where in places.items() if len(where) > 1}


def mean_words(path: Path) -> float:
    """Words per sentence of four words or more: cells with a number or a name are no sentences."""
    counted = [one.words for one in sentences(path) if one.words > 3]
    return sum(counted) / max(1, len(counted))


def explained() -> set[str]:
    """Terms of the glossary, in lower case: the first cells of its tables, divided at commas."""
    found = re.findall(r"^\| ([^|]+) \|", GLOSSARY.read_text(encoding="utf-8"), re.MULTILINE)
    return {term.strip().strip("`").lower() for cell in found for term in cell.split(",")}


@cache
def terms() -> dict[str, re.Pattern[str]]:
    """Terms of the field and of statistics whose use asks for an entry in the glossary, and what finds each."""
    lines = TERMS.read_text(encoding="utf-8").splitlines()
    told = [line for line in lines if line and not line.startswith("#")]
    return {term: re.compile(rf"\b{re.escape(term.lower())}(?:s|es)?\b") for term in told}


def used(path: Path) -> set[str]:
    """Terms that a page uses: those of the list, and abbreviations in capitals."""
    text = " ".join(spoken(parts) for _, _, parts in blocks(path))
    low = text.lower()
    found = {term for term, pattern in terms().items() if term.lower() in low and pattern.search(low)}
    return found | {one.lower() for one in ABBREVIATION.findall(text) if one not in PLACES}


def main() -> None:
    """Print every sentence that is too long or stands twice, and every term that the glossary lacks."""
    known = explained() if GLOSSARY.is_file() else set()
    for path in pages():
        for one in too_long(path):
            print(f"{one.page}:{one.line}: {one.words} words: {one.text}")
        if mean_words(path) > MEAN:
            print(f"{path.relative_to(ROOT)}: {mean_words(path):.1f} words per sentence")
        for term in sorted(used(path) - known):
            print(f"{path.relative_to(ROOT)}: the glossary lacks {term!r}")
    for text, where in said_twice().items():
        print(f"{' and '.join(where)}: {text}")


if __name__ == "__main__":
    main()
