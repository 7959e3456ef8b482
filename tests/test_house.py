"""The house itself: imports run one way, modules are small and say what they are, --help is quick."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "gearpoly"

# Each line imports only from lines above it. What a gear is, what two gears do, what a simulation may leave out, what
# is known of a pair, what was measured, how both compare, why they differ, how that is shown, what Python calls, what
# conceals effects and scores their finding, and what a user types.
ORDER = (
    "errors threads units",
    "arguments",
    "page plugins",
    "keys",
    "gear",
    "mesh",
    "physics",
    "files",
    "recording inspected",
    "assemble positions",
    "simulate touching",
    "scene course",
    "infer",
    "export compare",
    "diagnose view",
    "studies",
    "report",
    "study",
    "api",
    "proving",
    "prove",
    "options",
    "commands",
    "cli",
)
LEVEL = {name: k for k, line in enumerate(ORDER) for name in line.split()}

# Lines. A reader can hold so much; what is longer has to say why it stays whole.
LONGEST = 360
WHOLE = {
    "gearpoly.mesh.radial_search": "one compiled search, which the compiler has to see whole",
}


@cache
def modules() -> dict[str, ast.Module]:
    """All modules of the package by name."""
    out = {}
    for file in sorted(PACKAGE.rglob("*.py")):
        parts = file.relative_to(ROOT).with_suffix("").parts
        out[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = ast.parse(file.read_text(encoding="utf-8"))
    return out


@cache
def nodes(name: str) -> tuple[ast.AST, ...]:
    """All nodes of a module, walked once."""
    return tuple(ast.walk(modules()[name]))


@cache
def imports(name: str, *, inside_functions: bool = True) -> frozenset[str]:
    """Modules of the package that a module imports; what only type checkers see counts too."""
    out = set()
    tree = modules()[name]
    for node in nodes(name) if inside_functions else tree.body:
        if isinstance(node, ast.Import):
            out |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            assert node.level == 0, f"{name}: relative import"
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                out.add(whole if whole in modules() else node.module)
    return frozenset(one for one in out if one.split(".")[0] == "gearpoly" and one != name)


def part(name: str) -> str:
    """The package or module below gearpoly that a module belongs to."""
    return name.split(".")[1] if "." in name else ""


def test_every_part_has_its_place() -> None:
    assert {part(name) for name in modules()} - {"", "__main__"} == set(LEVEL), "say in ORDER where a new part belongs"


@pytest.mark.parametrize("upper", sorted(LEVEL))
def test_imports_run_one_way(upper: str) -> None:
    """The root is imported for its version alone; ``__main__`` modules are doors, and doors open into everything."""
    for name in modules():
        if part(name) != upper or name.endswith("__main__"):
            continue
        for other in imports(name):
            if other == "gearpoly":
                continue
            assert part(other) == upper or LEVEL[part(other)] < LEVEL[upper], f"{name} imports {other}"


def test_no_two_modules_import_each_other() -> None:
    """Nor any longer ring, inside a package either; not even with an import put off into a function."""
    graph = {name: imports(name) - {"gearpoly"} for name in modules() if name != "gearpoly"}
    list(TopologicalSorter(graph).static_order())  # raises CycleError with the ring


@pytest.mark.parametrize("name", ["bodies", "impact", "certificate", "contact"])
def test_the_contact_kernel_knows_no_gears(name: str) -> None:
    seen: set[str] = set()
    todo = {f"gearpoly.mesh.{name}"}
    while todo:
        module = todo.pop()
        seen.add(module)
        todo |= imports(module) - seen
    kernel = {"bodies", "impact", "certificate", "contact", "features"}
    assert seen <= {"gearpoly.units", "gearpoly.errors"} | {f"gearpoly.mesh.{part}" for part in kernel}


def test_the_root_is_imported_for_its_version_alone() -> None:
    for name in modules():
        for node in nodes(name):
            if isinstance(node, ast.ImportFrom) and node.module == "gearpoly":
                names = {alias.name for alias in node.names}
                of_package = {one for one in names if f"gearpoly.{one}" in modules()}
                assert names - of_package <= {"__version__"}, name


@pytest.mark.long
def test_matplotlib_is_imported_by_pictures_only() -> None:
    """No other part draws, and no picture is made unless asked for; what only type checkers see draws nothing."""
    for name in modules():
        if part(name) in ("report", "study", "prove") or name == "gearpoly.proving.life.pictures":
            continue
        drawing = [node for node in nodes(name) if _loads(node, "matplotlib")]
        typed = {
            id(inner)
            for node in (nodes(name) if drawing else ())
            if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
            for inner in ast.walk(node)
        }
        assert all(id(node) in typed for node in drawing), name


def _loads(node: ast.AST, package: str) -> bool:
    names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
    names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
    return any(one.split(".")[0] == package for one in names)


def test_the_proof_shares_no_code_with_what_it_proves() -> None:
    """The generator of concealed effects knows nothing of the simulator that explains them, and of gearpoly only the
    scorer and its command know the generator."""
    bench = {name for name in modules() if part(name) == "proving"}
    assert bench
    for name in modules():
        others = {"proving" if other in bench else part(other) or "root" for other in imports(name)}
        if name in bench:
            assert others <= {"proving"}, name
        elif part(name) != "prove" and name != "gearpoly.commands.prove":
            assert "proving" not in others, name


# Each folder of the repository imports only from those before it; examples show the package, and nothing else.
FOLDERS = ("gearpoly", "tests", "benchmarks")


@pytest.mark.parametrize("folder", [*FOLDERS, "examples"])
def test_folders_import_one_way(folder: str) -> None:
    allowed = {"gearpoly"} if folder == "examples" else set(FOLDERS[: FOLDERS.index(folder) + 1])
    files = sorted((ROOT / folder).rglob("*.py"))
    assert files
    barred = {*FOLDERS, "examples"} - allowed
    # Most files do not so much as hold the words; to read all of them as Python takes long.
    words = re.compile(rf"^[ \t]*(?:from|import)\b.*\b(?:{'|'.join(sorted(barred))})\b", re.MULTILINE)
    for file in files:
        text = file.read_text("utf-8")
        if barred and words.search(text):
            own = barred & {name.split(".")[0] for name in named(ast.parse(text))}
            assert not own, f"{file.relative_to(ROOT)} imports {sorted(own)}"


def test_no_two_benchmarks_import_each_other() -> None:
    files = {f"benchmarks.{file.stem}": file for file in (ROOT / "benchmarks").glob("*.py")}
    trees = {name: ast.parse(file.read_text("utf-8")) for name, file in files.items()}
    list(TopologicalSorter({name: named(tree) & files.keys() for name, tree in trees.items()}).static_order())


def named(tree: ast.Module) -> set[str]:
    """Modules that a file names in its imports."""
    out = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            out |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            out.add(node.module)
            out |= {f"{node.module}.{alias.name}" for alias in node.names}
    return out


def test_modules_are_small_and_say_what_they_are() -> None:
    wrong = []
    for name, tree in modules().items():
        path = PACKAGE.parent.joinpath(*name.split("."))
        file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        text = file.read_text(encoding="utf-8")
        if not text.strip():
            if file.name != "__init__.py":
                wrong.append(f"{name}: an empty module")
            continue
        if len(ast.get_docstring(tree) or "") <= 15:
            wrong.append(f"{name}: no docstring")
        if len(text.splitlines()) > LONGEST and name not in WHOLE:
            wrong.append(f"{name}: {len(text.splitlines())} lines")
    assert not wrong, "\n".join(wrong)


# Names that several modules of a package hold, since each is one of a kind: its loader asks for them.
ASKED_FOR = {
    ("gearpoly.commands", "ORDER"): "the place of a command in --help, read by gearpoly.cli",
    ("gearpoly.export.formats", "CURVES"): "how a format writes curves, read by gearpoly.export.formats",
    ("gearpoly.export.formats", "ENDINGS"): "the endings of a format, read by gearpoly.export.formats",
    ("gearpoly.mesh.compliance", "LAW"): "a law of compliance, found by gearpoly.mesh.compliance",
    ("gearpoly.physics", "EncoderKeys"): "keys of an encoder that a physics brings, joined by gearpoly.files.models",
    ("gearpoly.physics", "GearKeys"): "keys of a gear that a physics brings, joined by gearpoly.files.models",
    ("gearpoly.physics", "PHYSICS"): "a physics, found by gearpoly.physics",
    ("gearpoly.physics", "PairKeys"): "keys of a pair that a physics brings, joined by gearpoly.files.models",
    ("gearpoly.proving.physics", "PHYSICS"): "a physics that is concealed, found by gearpoly.proving.physics",
    ("gearpoly.recording", "READER"): "a format of recordings, found by gearpoly.recording.read",
    ("gearpoly.studies.paper", "QUESTION"): "a question of the paper, found by gearpoly.studies.paper",
}


def defined(tree: ast.Module) -> set[str]:
    """Public constants and classes that a module defines."""
    out = {node.name for node in tree.body if isinstance(node, ast.ClassDef)}
    for node in tree.body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        names = {one.id for target in targets for one in ast.walk(target) if isinstance(one, ast.Name)}
        out |= {name for name in names if name.isupper()}
    return {name for name in out if not name.startswith("_")}


def test_a_name_has_one_meaning() -> None:
    """What two modules share is defined in one of them; what differs has two names."""
    where: dict[str, list[str]] = {}
    for module, tree in modules().items():
        for name in defined(tree):
            if (module.rpartition(".")[0], name) not in ASKED_FOR:
                where.setdefault(name, []).append(module)
    assert not {name: held for name, held in where.items() if len(held) > 1}


@pytest.mark.parametrize(("package", "name"), sorted(ASKED_FOR))
def test_no_name_is_excepted_that_no_loader_asks_for(package: str, name: str) -> None:
    held = [
        module for module, tree in modules().items() if module.rpartition(".")[0] == package and name in defined(tree)
    ]
    assert len(held) > 1, held


@pytest.mark.parametrize("name", sorted(WHOLE))
def test_no_exception_outlives_its_reason(name: str) -> None:
    file = PACKAGE.parent.joinpath(*name.split(".")).with_suffix(".py")
    assert len(file.read_text(encoding="utf-8").splitlines()) > LONGEST


@pytest.mark.long
@pytest.mark.parametrize("arguments", [["--help"], ["diagnose", "--help"], ["simulate", "--help"], ["--version"]])
def test_help_loads_nothing_heavy(arguments: list[str]) -> None:
    code = (
        "import sys\n"
        "from gearpoly.__main__ import main\n"
        f"sys.argv = ['gearpoly', *{arguments!r}]\n"
        "try:\n"
        "    main()\n"
        "except SystemExit as stop:\n"
        "    assert not stop.code, stop.code\n"
        "heavy = {'numpy', 'scipy', 'shapely', 'matplotlib', 'numba'} & set(sys.modules)\n"
        "print('heavy:', sorted(heavy))\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT)
    assert run.returncode == 0, run.stderr
    assert "heavy: []" in run.stdout


@pytest.mark.long
def test_what_few_need_is_imported_where_it_is_needed() -> None:
    """These take longer to import than a small simulation to run, and every command and every worker would pay; those
    that compare would pay for the first two, of which scipy.special and scipy.ndimage have what they need."""
    code = (
        "import sys, gearpoly.simulate, gearpoly.study.local; "
        "print(sorted({'scipy.signal', 'scipy.stats', 'scipy.optimize', 'matplotlib', 'numba'} & set(sys.modules)));"
        "import gearpoly.compare.beside, gearpoly.diagnose.diagnose; "
        "print(sorted({'scipy.signal', 'scipy.stats', 'matplotlib'} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert run.stdout.split("\n") == ["[]", "[]", ""]
