"""What other installed packages bring: a physics, a reader and an exporter at work, and packages that are broken."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from gearpoly import api, plugins
from gearpoly.errors import GearpolyError, InputFileError, PluginError
from gearpoly.export.formats import formats
from gearpoly.files.pairfile import read_pair
from gearpoly.gear.gear import Gear
from gearpoly.physics import catalogue
from gearpoly.physics.brought import brought
from gearpoly.recording import apart as apart_module
from gearpoly.recording.read import read_recording, readers
from tests.plugin_package import files_of_the_page, install, install_page

ROOT = Path(__file__).parents[1]

PAIR = """
[model]
tooth_deflection = false
[driving]
teeth = 10
module_mm = 2.0
profile_shift = 0.3
addendum = 0.9
points_per_flank = 120
HOB
[driving.inspection]
uncertainty_um = 0.1
tooth_thickness_um = -60.0
[driven]
teeth = 11
module_mm = 2.0
profile_shift = 0.3
addendum = 0.9
points_per_flank = 120
[driven.inspection]
uncertainty_um = 0.1
tooth_thickness_um = -60.0
"""
OFFSET = 6.0
NOISE_DEG = 1e-3
"""deg on the driven angle: 0.18 um along the line of action of the driven base radius, 10.3 mm."""


def run(site: Path, *words: object) -> subprocess.CompletedProcess[str]:
    """gearpoly with the packages in ``site``, in a process of its own."""
    paths = os.pathsep.join(map(str, (site, ROOT, *sys.path)))
    return subprocess.run(
        [sys.executable, "-m", "gearpoly", *map(str, words)], capture_output=True, text=True, check=False,
        env=os.environ | {"PYTHONPATH": paths, "COLUMNS": "200"},
    )  # fmt: skip


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_page(tmp_path_factory.mktemp("site"))


@pytest.fixture(scope="module")
def bench(site: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """pair.toml, truth.toml with the physics of the package, and what ``simulate`` makes of it."""
    folder = tmp_path_factory.mktemp("bench")
    (folder / "pair.toml").write_text(PAIR.replace("HOB", ""), encoding="utf-8")
    (folder / "truth.toml").write_text(PAIR.replace("HOB", f"hob_threads_um = {OFFSET}"), encoding="utf-8")
    made = "--csv", folder / "sim.csv", "--json", folder / "sim.json"
    ran = run(site, "simulate", folder / "truth.toml", *made, "--turns", 20, "--points-per-mesh", 8)
    assert ran.returncode == 0, ran.stderr
    return folder


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of packages that this process finds; what it knows of packages is forgotten before and after."""
    monkeypatch.syspath_prepend(str(tmp_path))
    before = set(sys.modules)
    for known in (plugins.installed, readers, formats):
        known.cache_clear()
    yield tmp_path
    for known in (plugins.installed, readers, formats):
        known.cache_clear()
    for name in set(sys.modules) - before:
        if (getattr(sys.modules[name], "__file__", None) or "").startswith(str(tmp_path)):
            del sys.modules[name]


@pytest.mark.long
def test_nothing_is_loaded_before_it_is_needed(site: Path) -> None:
    code = (
        "import sys, gearpoly\n"
        "from gearpoly.__main__ import main\n"
        "sys.argv = ['gearpoly', '--version']\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print([name for name in sys.modules if name.startswith('gearpoly_rig')])\n"
    )
    paths = os.pathsep.join(map(str, (site, ROOT)))
    told = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ | {"PYTHONPATH": paths}
    ).stdout.splitlines()
    assert told[1:4] == [
        "with gearpoly-rig 1.0: hob_threads of gearpoly.physics",
        "with gearpoly-rig 1.0: obj of gearpoly.exporters",
        "with gearpoly-rig 1.0: rig of gearpoly.readers",
    ]
    assert told[-1] == "[]"


@pytest.mark.long
def test_a_brought_physics_is_simulated(bench: Path) -> None:
    """On ideal flanks each tooth carries by itself at some time, so the transmission error ranges by the whole offset.
    Chords of 120 points and the corner of a tooth that leads add to it, 0.1 um at most."""
    te = np.genfromtxt(bench / "sim.csv", delimiter=",", names=True, comments="#")["te_um"]
    assert np.ptp(te) == pytest.approx(OFFSET, abs=0.1)


@pytest.fixture(scope="module")
def recorded(bench: Path) -> Path:
    """The simulated run as the rig of the page records it."""
    table = np.genfromtxt(bench / "sim.csv", delimiter=",", names=True, comments="#")
    noise = np.random.default_rng(4).normal(0.0, NOISE_DEG, table.size)
    rows = np.column_stack(
        [np.arange(table.size) * 1e-3, table["driving_angle_deg"] + 40.0, table["driven_angle_deg"] + 25.0 + noise]
    )
    file = bench / "rec.rig"
    file.write_bytes(b"RIG1" + np.array([40.0, 25.0]).tobytes() + rows.tobytes())
    return file


@pytest.mark.slow
def test_a_brought_physics_is_diagnosed_from_a_file_that_a_brought_reader_reads(
    site: Path, bench: Path, recorded: Path
) -> None:
    ran = run(site, "diagnose", bench / "pair.toml", recorded, "--json", bench / "v.json", "--fitted", bench / "f.toml")
    assert ran.returncode == 0, ran.stderr
    (named,) = json.loads((bench / "v.json").read_text("utf-8"))["missing"]
    assert (named["physics"], named["gear"]) == ("hob_threads", "driving")
    size = named["parameters"]["offset_um"]
    assert abs(size["value"] - OFFSET) < 4.0 * size["std"] < 0.5  # 4 sigma: once in 16 000; half a micrometre is told
    fitted = tomllib.loads((bench / "f.toml").read_text("utf-8"))["driving"]["hob_threads_um"]
    assert fitted == pytest.approx(size["value"], abs=1e-3)  # as the verdict's digits have it


@pytest.mark.long
def test_a_pair_file_with_keys_of_a_package_that_is_not_there_is_refused(bench: Path) -> None:
    with pytest.raises(InputFileError, match="hob_threads_um"):
        read_pair(bench / "truth.toml")


@pytest.mark.long
def test_a_brought_exporter_writes_what_the_drawing_holds(site: Path, bench: Path) -> None:
    """Its lines are the closed outlines of both gears."""
    ran = run(site, "export", bench / "pair.toml", "--to", bench / "pair.obj")
    assert ran.returncode == 0, ran.stderr
    assert "pair.obj: driving and driven gear" in ran.stderr
    words = [line.split() for line in (bench / "pair.obj").read_text("ascii").splitlines()]
    points = np.array([[float(x) for x in one[1:3]] for one in words if one[0] == "v"])
    lines = [points[np.array(one[1:], dtype=int) - 1] for one in words if one[0] == "l"]
    wanted = api.load(bench / "pair.toml").drawing().gears
    assert [one[1] for one in words if one[0] == "o"] == [one.name for one in wanted]
    for line, gear in zip(lines, wanted, strict=True):
        np.testing.assert_allclose(line, [*gear.ring, gear.ring[0]], atol=1e-8)  # mm, the last digit that is written


def test_a_brought_reader_refuses_a_damaged_file_as_all_do(here: Path) -> None:
    install_page(here)
    file = here / "cut.rig"
    file.write_bytes(b"RIG1" + bytes(50))
    with pytest.raises(InputFileError, match="50 bytes; want two numbers, then rows of three"):
        read_recording(file)


# Broken packages.

PHYSICS = files_of_the_page()["gearpoly_rig/hob_threads.py"]


def broken_physics(change: str, by: str) -> str:
    assert change in PHYSICS
    return PHYSICS.replace(change, by)


@pytest.mark.parametrize(
    ("module", "told"),
    [
        ("import no_such_library", "it cannot be loaded: ModuleNotFoundError: No module named 'no_such_library'"),
        ("raise SystemExit('bye')", "it cannot be loaded: SystemExit: bye"),
        ("x = 1", "it cannot be loaded: there is no PHYSICS in bad"),
        ("PHYSICS = 'wear'", "str, not a gearpoly.physics.base.Physics"),
        (broken_physics('name="hob_threads"', 'name="wear"'), "there is a physics named wear already"),
        (broken_physics('name="hob_threads"', 'name="Hob threads"'), 'its name is "Hob threads"; want small letters'),
        (broken_physics("hob_threads_um: Um", "wear_um: Um"), "the table of a gear has a key wear_um already"),
        (broken_physics("hob_threads_um: Um", "teeth: Um"), "the table of a gear has a key teeth already"),
        (broken_physics('along the normal", 0.0)', 'along the normal", ...)'), "key hob_threads_um has no default"),
        (broken_physics('keys={"gear"', 'keys={"gears"'), 'it adds keys to "gears"; want one of pair, gear, encoder'),
        (broken_physics("effect=effect,", ""), "it has no effect"),
        (broken_physics("ordinary=(5.0,)", "ordinary=()"), "of 1 coordinates 1 are amplitudes, and its ordinary fault"),
        (broken_physics("(6.0,))", "())"), "its case is no Place with 1 values"),
        (
            broken_physics("ordinary=(5.0,)", "ordinary=5.0"),
            "it is not whole: TypeError: object of type 'float' has no",
        ),
        (broken_physics("rank=MADE + 9", "rank=None"), "its rank is no whole number"),
    ],
)
def test_a_broken_physics_is_told_by_its_package_and_entry_point(here: Path, module: str, told: str) -> None:
    install(here, "bad-one", {"bad.py": module}, "[gearpoly.physics]\nworse = bad:PHYSICS\n", version="0.3")
    with pytest.raises(PluginError) as caught:
        brought(catalogue())
    message = str(caught.value)
    assert message.startswith("package bad-one 0.3, entry point worse = bad:PHYSICS of gearpoly.physics: ")
    assert told in message and message.endswith("pip uninstall bad-one")


def test_two_packages_with_one_name_are_refused(here: Path) -> None:
    for name in ("one", "two"):
        install(here, name, {f"mod_{name}.py": PHYSICS}, f"[gearpoly.physics]\nx = mod_{name}:PHYSICS\n")
    with pytest.raises(PluginError, match=r"package two 1\.0, .*: there is a physics named hob_threads already"):
        brought(catalogue())


@pytest.mark.parametrize(
    ("change", "by", "call", "told"),
    [
        ("return [Place", "1 / 0\n    return [Place", "places", "its places failed: ZeroDivisionError"),
        ("return Deviations(drive", "return dict(drive", "shapes", "its shapes gave dict, not Deviations"),
        (
            "return scene.deviated(",
            "return scene.deviated(0, 0)[:3], (",
            "effect",
            "its effect is no numbers: ValueError",
        ),
        ("return scene.deviated(", "return np.inf + scene.deviated(", "effect", "its effect gave numbers that are not"),
        ("values[0], tooth))", "values[0], tooth))[:3]", "effect", "its effect gave shape (3,); want 7 finite numbers"),
    ],
)
def test_a_physics_that_fails_at_work_is_told(here: Path, change: str, by: str, call: str, told: str) -> None:
    gears = Gear(z=10, m=2.0), Gear(z=11, m=2.0)
    scene = SimpleNamespace(samples=SimpleNamespace(size=7, flank="drive"), deviated=lambda gear, by: np.zeros(7))
    install(here, "bad", {"bad.py": broken_physics(change, by)}, "[gearpoly.physics]\nx = bad:PHYSICS\n")
    physics = brought(catalogue())["hob_threads"]
    given = {
        "places": (SimpleNamespace(gears=gears),),
        "shapes": (SimpleNamespace(hob_threads_um=3.0), gears[0], 0),
        "effect": (scene, *physics.case),
    }
    with pytest.raises(PluginError) as caught:
        getattr(physics, call)(*given[call])
    assert told in str(caught.value)


READER = files_of_the_page()["gearpoly_rig/rig_reader.py"]
ROWS = b"RIG1" + np.zeros(2 + 3 * 40).tobytes()


@pytest.mark.parametrize(
    ("change", "by", "told"),
    [
        ('name="rig"', 'name="CSV"', "there is a reader named CSV already"),
        ("head.startswith(MAGIC)", "True", "it takes any text for its format"),
        ('(".rig",)', '("RIG",)', "its endings are ('RIG',); want small letters behind a dot"),
        ("data = file", "data = [] + file", "rec.rig: its reading failed: TypeError"),
        ("return Table(", "return dict(", "rec.rig: its read gave dict, not Table"),
        ("rows.T, strict", "rows[None, :, :].T, strict", "rec.rig: its column time_s has 2 dimensions; want one"),
        ("lambda head: head", "lambda head: 'x' + head", "it is not whole: TypeError"),
        ("read=read_table)", "read=read_table, apart=True)", "for a library that it does not name as module"),
    ],
)
def test_a_broken_reader_is_told_by_its_package_and_entry_point(here: Path, change: str, by: str, told: str) -> None:
    assert change in READER
    install(here, "bad", {"bad.py": READER.replace(change, by)}, "[gearpoly.readers]\nx = bad:READER\n")
    file = here / "rec.rig"
    file.write_bytes(ROWS)
    with pytest.raises(PluginError) as caught:
        read_recording(file)
    message = str(caught.value)
    assert message.startswith("package bad 1.0, entry point x = bad:READER of gearpoly.readers: ") and told in message


@pytest.mark.long
def test_a_reader_may_read_in_a_process_of_its_own_and_fail_there(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    apart = READER.replace("read=read_table)", 'read=read_table, apart=True, module="json")')
    failing = apart.replace("    zeros, rows", '    if data[:8] == b"\\xff" * 8:\n        1 / 0\n    zeros, rows')
    with monkeypatch.context() as before:  # a process that reads is kept by then, and knows nothing of the new package
        before.setattr(sys, "path", [path for path in sys.path if path != str(here)])
        apart_module._process()
    install(here, "far", {"far.py": failing}, "[gearpoly.readers]\nx = far:READER\n")
    file = here / "rec.rig"
    angles = np.column_stack([np.arange(40) * 1e-3, np.arange(40.0), np.arange(40.0)])
    file.write_bytes(b"RIG1" + np.zeros(2).tobytes() + angles.tobytes())
    np.testing.assert_allclose(read_recording(file).driven_angle_rad, np.radians(np.arange(40.0)))
    file.write_bytes(b"RIG1" + b"\xff" * 16 + angles.tobytes())
    with pytest.raises(PluginError, match="its reading failed: RuntimeError: ZeroDivisionError: division by zero"):
        read_recording(file)


EXPORTER = files_of_the_page()["gearpoly_rig/obj.py"]


@pytest.mark.parametrize(
    ("change", "by", "told"),
    [
        ('".obj"', '".svg"', "there is a format with the ending .svg already"),
        ('".obj"', '".rexs"', "there is a format with the ending .rexs already"),
        ('".obj"', '"obj"', "its ENDINGS are ('obj',); want small letters behind a dot"),
        ('"lines"', '"circles"', "its CURVES are ('circles',); want some of lines, arcs, splines"),
        ("CURVES = ", "CURVE = ", "it is not whole: AttributeError"),
        ("first = 1\n", "first = 1 / 0\n", "its write failed: ZeroDivisionError"),
        ("return drawing.chord_error", "return None", "its write gave NoneType, not float"),
        ("return drawing.chord_error", "return -1.0", "its write states a chord error of -1.0 mm"),
        ("    target.write_text", "    str", "its write wrote nothing"),
    ],
)
def test_a_broken_exporter_is_told_and_leaves_no_file(
    here: Path, pair_file: Path, change: str, by: str, told: str
) -> None:
    text = EXPORTER.replace(change, by).replace(', encoding="ascii"', "" if by == "    str" else ', encoding="ascii"')
    install(here, "bad", {"bad.py": text}, "[gearpoly.exporters]\nx = bad\n")
    target = here / "pair.obj"
    with pytest.raises(GearpolyError) as caught:
        api.load(pair_file).export(target)
    message = str(caught.value)
    assert message.startswith("package bad 1.0, entry point x = bad of gearpoly.exporters: ") and told in message
    assert not list(here.glob("*.obj*"))


def test_damaged_metadata_are_told_if_they_name_a_group_of_gearpoly(here: Path) -> None:
    install(here, "other", {}, "[console_scripts]\nno equals sign\n")
    assert not any(one.package == "other" for one in plugins.installed())
    plugins.installed.cache_clear()
    install(here, "torn", {}, "[gearpoly.readers]\nno equals sign\n")
    with pytest.raises(PluginError, match=r"package torn 1.0: its entry_points.txt is damaged; .*pip uninstall torn"):
        plugins.installed()


@pytest.mark.long
@pytest.mark.parametrize(
    "words",
    [
        ("simulate", "pair.toml"),
        *(
            pytest.param(one, marks=pytest.mark.slow)
            for one in (("read", "rec.csv"), ("export", "pair.toml", "--to", "p.svg"))
        ),
    ],
)
def test_a_broken_package_ends_a_command_with_one_message(
    words: tuple[str, ...], tmp_path: Path, pair_file: Path
) -> None:
    group = {"simulate": "physics", "read": "readers", "export": "exporters"}[words[0]]
    (tmp_path / "rec.csv").write_text("driving_angle_deg,driven_angle_deg\n0,0\n1,1\n", encoding="utf-8")
    # A physics that imports what is made from the finished catalogue goes round in a circle.
    module = "from gearpoly.api import load" if group == "physics" else "1 / 0"
    install(tmp_path, "bad", {"bad.py": module}, f"[gearpoly.{group}]\nx = bad:X\n")
    given = [tmp_path / one if "." in one else one for one in words]
    ran = run(tmp_path, *given)
    assert ran.returncode == 2 and ran.stdout == ""
    (line,) = ran.stderr.splitlines()
    assert line.startswith(f"gearpoly: package bad 1.0, entry point x = bad:X of gearpoly.{group}: it cannot be loaded")
    assert not (tmp_path / "p.svg").exists()
