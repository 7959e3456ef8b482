"""The proof is honest only while the bench that makes recordings and the tool that explains them share no code."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
BENCH = ROOT / "gearpoly" / "proving"
FINDS_ITS_FILES = 'import_module(f"gearpoly.proving.physics.{info.name}")'
"""The one call by which the bench imports what its text does not name: the files of one folder."""


def imported(text: str) -> set[str]:
    """Full names of all that a module imports, wherever in it: modules, and what is taken from them."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names |= {f"{'.' * node.level}{node.module or ''}.{alias.name}" for alias in node.names}
    return names


def of_bench(name: str) -> bool:
    """Whether a name is the bench or lies in it."""
    return name == "gearpoly.proving" or name.startswith("gearpoly.proving.")


def foreign(text: str) -> set[str]:
    """What a module of the bench may not import: tests, other parts of gearpoly, its root, or what no reader sees."""
    hidden = {"import_module", "__import__"} & {
        node.func.id for node in ast.walk(ast.parse(text.replace(FINDS_ITS_FILES, "None")))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }  # fmt: skip
    return hidden | {
        name for name in imported(text)
        if name.split(".")[0] in ("gearpoly", "tests", "", "subprocess", "runpy") and not of_bench(name)
    }  # fmt: skip


def knows_the_bench(text: str) -> bool:
    """Whether a module imports the bench, or holds its name as a string that could be imported."""
    if "proving" not in text:
        return False
    strings = {
        node.value for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }  # fmt: skip
    return any(map(of_bench, imported(text) | strings))


@pytest.mark.parametrize("path", sorted(BENCH.rglob("*.py")), ids=lambda p: p.relative_to(BENCH).as_posix())
def test_the_bench_knows_nothing_of_the_simulator(path: Path) -> None:
    assert not foreign(path.read_text())


def test_the_simulator_knows_nothing_of_the_bench() -> None:
    """Of gearpoly only the scorer and its command do."""
    looked = 0
    for path in sorted((ROOT / "gearpoly").rglob("*.py")):
        parts = path.relative_to(ROOT / "gearpoly").with_suffix("").parts
        if parts[0] in ("prove", "proving") or parts == ("commands", "prove"):
            continue
        looked += 1
        assert not knows_the_bench(path.read_text()), f"{path} imports the proving ground"
    assert looked > 200


@pytest.mark.parametrize(
    "text",
    [
        "import gearpoly", "from gearpoly import __version__", "from gearpoly import mesh",
        "import gearpoly.mesh.contact", "from gearpoly.mesh.contact import touch", "from ..mesh import contact",
        "def f():\n    from gearpoly.physics import FRICTION", "from gearpoly.prove.score import score",
        "from gearpoly.provings import x", "import_module('gearpoly.mesh')", "import tests.made_pair",
        "import subprocess",
    ],
)  # fmt: skip
def test_what_the_bench_may_not_import_is_seen(text: str) -> None:
    assert foreign(text)


@pytest.mark.parametrize(
    "text",
    [
        "import gearpoly.proving", "from gearpoly import proving", "from gearpoly.proving import rig",
        "from gearpoly.proving.rig import Rig", "def f():\n    import gearpoly.proving.rig",
        "import_module('gearpoly.proving.rig')",
    ],
)  # fmt: skip
def test_whoever_knows_the_bench_is_seen(text: str) -> None:
    assert knows_the_bench(text)
    assert not foreign(text.replace("import_module", "found"))


@pytest.mark.long
def test_the_bench_runs_without_the_simulator() -> None:
    """Whatever the texts say: with all grounds and samples imported, nothing else of gearpoly is there."""
    code = (
        "import sys, gearpoly; before = set(sys.modules)\n"
        "import gearpoly.proving.grounds, gearpoly.proving.samples, gearpoly.proving.write\n"
        "print(any(name.startswith('gearpoly.proving') for name in before))\n"
        "print(sorted(n for n in sys.modules if n.startswith('gearpoly.') and not n.startswith('gearpoly.proving')))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert ran.stdout == "False\n[]\n"


def test_no_two_modules_of_the_bench_import_each_other() -> None:
    """Nor any longer ring, not even with an import put off into a function."""
    files = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in sorted(BENCH.rglob("*.py"))
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
        graph[name] = (seen & set(files)) - {"gearpoly.proving", name}
    # The folder of physics imports every file in it, by their names.
    graph["gearpoly.proving.physics"] |= {name for name in files if name.startswith("gearpoly.proving.physics.")}
    assert list(TopologicalSorter(graph).static_order())  # raises CycleError with the ring


def test_a_physics_of_the_bench_is_one_file() -> None:
    """Its name stands in no other module of the bench but in plans, which say which cases there are, and in what names
    it as a rival."""
    from gearpoly.proving.physics import PHYSICS_BY_NAME

    for path in sorted((BENCH / "physics").glob("*.py")):
        if path.stem in ("__init__", "base"):
            continue
        assert PHYSICS_BY_NAME[path.stem].name == path.stem
    machinery = (
        "effects", "rivals", "sizes", "limit", "chain", "rig", "contact", "contacts", "equilibrium", "scenes",
        "physics/base",
    )  # fmt: skip
    for name in machinery:
        strings = {
            node.value for node in ast.walk(ast.parse((BENCH / f"{name}.py").read_text()))
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
        }  # fmt: skip
        assert not strings & (set(PHYSICS_BY_NAME) - {"disturbance"}), name
