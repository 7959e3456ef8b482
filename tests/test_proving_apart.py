"""The proof is honest only while the bench that makes recordings and the tool that explains them share no code."""

from __future__ import annotations

import ast
from graphlib import TopologicalSorter
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
    # The one folder that finds its files by itself looks nowhere else.
    calls = (
        path.read_text()
        .replace('import_module(f"proving.physics.{info.name}")', "")
        .replace("import import_module", "")
    )
    assert "import_module" not in calls
    assert "subprocess" not in imported(path)


def test_the_simulator_knows_nothing_of_the_bench() -> None:
    allowed = {"prove"}
    for path in sorted((ROOT / "gearpoly").rglob("*.py")):
        parts = path.relative_to(ROOT / "gearpoly").with_suffix("").parts
        if parts[0] in allowed or parts == ("commands", "prove"):
            continue
        assert "proving" not in imported(path), f"{path} imports the proving ground"


def test_no_two_modules_of_the_bench_import_each_other() -> None:
    """Nor any longer ring, not even with an import put off into a function."""
    files = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in sorted((ROOT / "proving").rglob("*.py"))
    }
    graph: dict[str, set[str]] = {}
    for name, path in files.items():
        seen = set()
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                seen |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                inner = {f"{node.module}.{alias.name}" for alias in node.names}
                seen |= inner & set(files) or {node.module}
        graph[name] = (seen & set(files)) - {"proving", name}
    # The folder of physics imports every file in it, by their names.
    graph["proving.physics"] |= {name for name in files if name.startswith("proving.physics.")}
    assert list(TopologicalSorter(graph).static_order())  # raises CycleError with the ring


def test_a_physics_of_the_bench_is_one_file() -> None:
    """Its name stands in no other module of the bench but in plans, which say which cases there are, and in what names
    it as a rival."""
    from proving.physics import PHYSICS

    for path in sorted((ROOT / "proving" / "physics").glob("*.py")):
        if path.stem in ("__init__", "base"):
            continue
        assert PHYSICS[path.stem].name == path.stem
    machinery = ("effects", "rivals", "sizes", "limit", "chain", "rig", "contact", "scenes", "physics/base")
    for name in machinery:
        strings = {
            node.value for node in ast.walk(ast.parse((ROOT / "proving" / f"{name}.py").read_text()))
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
        }  # fmt: skip
        assert not strings & (set(PHYSICS) - {"disturbance"}), name
