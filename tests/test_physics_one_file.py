"""A physics is one file: its keys, its equation, its case and what it does are read there by all others."""

from __future__ import annotations

import importlib
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import gearpoly.physics as package
from gearpoly.assemble import brought_parts, brought_shapes
from gearpoly.files.models import GearSection, PairFile, completed
from gearpoly.files.reference import pair_file_reference
from gearpoly.gear.deviations import Span, total
from gearpoly.gear.gear import Gear
from gearpoly.physics import catalogue
from gearpoly.physics.base import MADE, READ, Physics
from gearpoly.physics.page import table, unsearched, written
from gearpoly.physics.place import Place
from gearpoly.prove.truth import SIZE_PARAMETERS
from gearpoly.proving.physics import PHYSICS_BY_NAME as BENCH
from gearpoly.study.keys import known_keys
from gearpoly.units import UM
from tests.pair_files import pair_file

ROOT = Path(__file__).parents[1]

NEW = '''
"""A flank that stands back everywhere, a physics that nobody registered."""

from dataclasses import replace

import numpy as np

from gearpoly.gear.deviations import Deviations, Index
from gearpoly.keys.kinds import Section, UmSize, field
from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.physics.base import Physics, Quantity
from gearpoly.physics.place import Place
from gearpoly.physics.words import plain
from gearpoly.units import UM


class GearKeys(Section):
    """What a gear says of it."""

    newcomer_um: UmSize = field("by how much all flanks stand back in um", 0.0)


class PairKeys(Section):
    """What a pair says of it."""

    newcomer_friction: float = field("how much more teeth rub", 0.0, ge=0.0, le=1.0)


def shapes(section, gear, which):
    back = (Index(np.full(gear.z, -section.newcomer_um * UM)),)
    return Deviations(drive=back, coast=back)


def build(file, parts):
    more = parts.elasticity.friction + file.pair.newcomer_friction
    return replace(parts, elasticity=replace(parts.elasticity, friction=more))


PHYSICS = Physics(
    name="newcomer",
    rank=39,
    source="nobody",
    stands="driving.newcomer_um",
    parameters=("size_um",),
    case=(Place(gear=0), (1.0,)),
    keys={"gear": GearKeys, "pair": PairKeys},
    shapes=shapes,
    build=build,
    coordinates=(Quantity(name="size_um", unit="um", most=lambda scope, place: 1.0, why="so it is said"),),
    amplitudes=1,
    ordinary=(1.0,),
    places=lambda scope: [Place(gear=0)],
    write=lambda file, place, v: on_gear(
        file, place.gear, newcomer_um=gear_section(file, place.gear).newcomer_um + v[0]
    ),
    report=plain("size_um"),
    says=lambda place, values: "New.",
    equation="x = -size",
)
'''


@pytest.fixture
def newcomer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Physics]:
    """A file laid into the package, and what is found then."""
    (tmp_path / "newcomer.py").write_text(NEW, encoding="utf-8")
    (tmp_path / "helper.py").write_text('"""No physics here."""\nPHYSICS = "nothing"\n', encoding="utf-8")
    before = dict(catalogue())
    monkeypatch.setattr(package, "__path__", [*package.__path__, str(tmp_path)])
    catalogue.cache_clear()
    importlib.invalidate_caches()
    try:
        found = catalogue()
        assert set(found) == {*before, "newcomer"}
        yield found["newcomer"]
    finally:
        catalogue.cache_clear()
        for name in ("newcomer", "helper"):
            sys.modules.pop(f"gearpoly.physics.{name}", None)
            if hasattr(package, name):
                delattr(package, name)


def test_a_new_file_is_all_it_takes(newcomer: Physics) -> None:
    """Its keys are in the pair file and on its page, it is written, built, simulated and shown to the reader."""
    models = completed(catalogue().values())
    assert [*models["GearSection"].model_fields][-5:] == ["spall", "crack", "chip", "newcomer_um", "encoder"]
    page = pair_file_reference(models["PairFile"])
    assert "| `newcomer_um` | by how much all flanks stand back in um | `0.0` |" in page
    assert "| `newcomer_friction` |" in page
    assert "| `newcomer` | `driving.newcomer_um` | `size_um` | x = -size | nobody |" in table(catalogue().values())

    raw = {"driving": {"teeth": 18, "module_mm": 2.0}, "driven": {"teeth": 25, "module_mm": 2.0}}
    plain = models["PairFile"].model_validate(raw | {"pair": {"newcomer_friction": 0.25}})
    assert isinstance(plain, PairFile.__mro__[1])
    assert brought_parts(plain).elasticity.friction == 0.25
    written = newcomer.write(plain, Place(gear=0), (3.0,))
    gear = Gear(z=18, m=2.0)
    made = brought_shapes(written.driving, gear, 0)
    span = Span(l_start=1.0, l_a=gear.l_a)
    back = total(made.drive, np.array([[3.0, 5.0]]), z=18, span=span)
    np.testing.assert_array_equal(back, np.full((18, 2), -3.0 * UM))
    assert newcomer.twin == "newcomer"
    assert not newcomer.measures and not newcomer.fixed_amplitudes


def test_the_pages_say_what_the_files_of_the_catalogue_do() -> None:
    path = "docs/reference/catalogue.md"
    page = (ROOT / path).read_text(encoding="utf-8")
    assert table(catalogue().values()) in page, f"write it anew: python -m gearpoly.physics.page {path}"
    assert written(page, catalogue().values()) == page
    fewer = written(page, [catalogue()["wear"]])
    assert "| `friction` |" in page and "| `friction` |" not in fewer
    assert written(fewer, catalogue().values()) == page
    assert unsearched(catalogue().values()) in page
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    looked_for = [one for one in catalogue().values() if not one.unsearched]
    assert f"a catalogue of {len(looked_for)}," in readme, "write the number in the README anew"


@pytest.mark.parametrize("name", sorted(catalogue()))
def test_what_says_that_it_is_there_are_keys_of_the_pair_file(name: str) -> None:
    """With all that the physics adds to it."""
    where, _, keys = catalogue()[name].stands.partition(": ")
    path = where.strip("[]")
    stated = [f"{path}.{key}" for key in keys.split(", ")] if keys else path.split(", ")
    for key in stated:
        assert any(known == key or known.startswith(f"{key}.") for known in known_keys()), key


def test_ranks_are_all_different_and_in_the_order_of_a_life() -> None:
    ranks = [one.rank for one in catalogue().values()]
    assert len(set(ranks)) == len(ranks)
    assert all(MADE <= rank < READ + 10 for rank in ranks)
    measuring = {one.name for one in catalogue().values() if {"encoder", "measurement"} & set(one.keys)}
    assert measuring == {one.name for one in catalogue().values() if one.measures}


def test_every_physics_has_its_twin_in_the_bench_and_the_scorer_its_size() -> None:
    for one in catalogue().values():
        assert one.twin in BENCH, f"write gearpoly/proving/physics/{one.twin}.py too (docs/howto/add_physics.md)"
        assert not BENCH[one.twin].outside
        assert SIZE_PARAMETERS[one.twin] == one.parameters[0] == BENCH[one.twin].size


def test_no_key_of_a_physics_is_a_key_of_another_or_of_any_pair() -> None:
    """Two files that add the same key would hide one another."""
    tables = [item for one in catalogue().values() for item in one.keys.items()]
    brought = [(where, key) for where, keys in tables for key in keys.model_fields]
    assert len(set(brought)) == len(brought)
    assert {key for where, key in brought if where == "gear"} < set(GearSection.model_fields)


def test_what_a_physics_writes_is_read_back(tmp_path: Path) -> None:
    """Its keys are keys of the file like all others: written as TOML and read, they are the same."""
    from gearpoly.files.pairfile import dump_pair

    for one in catalogue().values():
        place, values = one.case
        file = one.write(pair_file(points=100), place, values)
        again = PairFile.model_validate(tomllib.loads(dump_pair(file)))
        assert dump_pair(again) == dump_pair(file), one.name
