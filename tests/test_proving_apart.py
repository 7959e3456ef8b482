"""The proof is honest only while the bench that makes recordings and the tool that explains them share no code."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def imported(path: Path) -> set[str]:
    """Top-level names of every package that a module imports, wherever in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add("." if node.level else (node.module or "").split(".")[0])
    return names


@pytest.mark.parametrize("path", sorted((ROOT / "proving").rglob("*.py")), ids=lambda p: p.name)
def test_the_bench_knows_nothing_of_the_simulator(path: Path) -> None:
    foreign = imported(path) & {"gearpoly", "tests"}
    assert not foreign
    assert "import_module" not in path.read_text()
    assert "subprocess" not in imported(path)


def test_the_simulator_knows_nothing_of_the_bench() -> None:
    allowed = {"prove"}
    for path in sorted((ROOT / "gearpoly").rglob("*.py")):
        parts = path.relative_to(ROOT / "gearpoly").with_suffix("").parts
        if parts[0] in allowed or parts == ("commands", "prove"):
            continue
        assert "proving" not in imported(path), f"{path} imports the proving ground"
