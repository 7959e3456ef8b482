"""Other parts of a drive: their lines, what is told of them, and what is not named for their sake."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.also_turns import with_parts
from gearpoly.compare.entries import Entry, says
from gearpoly.diagnose.foreign import is_foreign
from gearpoly.errors import InputFileError
from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.keys.also_turns import Part, lines_at, parts_of
from gearpoly.keys.sections import AlsoTurns
from gearpoly.physics.base import Place
from tests.made_command import Command
from tests.physics_cases import Condition, rough, scope_of

MOTOR = Part(name="motor", turns=3.9, teeth=10)
PAIR = "[driving]\nteeth = 18\nmodule_mm = 2\n[driven]\nteeth = 25\nmodule_mm = 2\n"


@pytest.mark.parametrize(
    ("order", "words"),
    [
        (3.9, "the motor's turn"),
        (7.8, "order 2 of the motor"),
        (39.0, "the motor's mesh"),
        (42.9, "side band +1 of the motor's mesh"),
        (31.2, "side band -2 of the motor's mesh"),
        (78.0, "mesh order 2 of the motor"),
        (4.1, None),
        (0.01, None),
        (3.9 * 16, None),  # neither low nor beside its mesh
    ],
)
def test_the_lines_of_a_part(order: float, words: str | None) -> None:
    """Whole multiples of its turn: low ones, its mesh of ten teeth, and side bands of that."""
    assert MOTOR.line(order, 0.05) == words


def test_turns_are_counted_per_turn_of_the_driven_gear() -> None:
    """12 on 47 teeth: the driving gear turns 47/12 times as often."""
    stated = (AlsoTurns(name="the motor", turns_per_driving=2.0), AlsoTurns(name="belt", turns_per_driven=0.5))
    motor, belt = parts_of(stated, z_1=12, z_2=47)
    assert motor.name == "motor"
    assert motor.turns == pytest.approx(2.0 * 47 / 12, rel=1e-12)
    assert belt.turns == 0.5


def test_what_a_recording_does_not_resolve_falls_together() -> None:
    """Half a line is half a wave over the whole recording."""
    assert lines_at((MOTOR,), 4.0, turns=4.0) == ("the motor's turn",)
    assert lines_at((MOTOR,), 4.0, turns=6.0) == ()


def wave(**more: object) -> Entry:
    plain = {"kind": "shaft_order", "p_value": 1e-9, "recordings": (0,), "amplitude_um": 1.0, "std_um": 0.1}
    return Entry(**{**plain, **more})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("entry", "parts", "ends"),
    [
        # Of no whole order: the part alone.
        (wave(gear="driven", order=3.9, order_std=0.01), ("the motor's turn",), ": the motor's turn"),
        (wave(gear="driving", order=3.9 / 2.0, order_std=0.01), ("the motor's turn",), ": the motor's turn"),
        # A whole order of the pair: both.
        (wave(kind="mesh_order", order=1.0), ("the wheel's turn",), ", where the wheel's turn falls too"),
        (wave(gear="driven", order=5.0), (), "1.00 +- 0.10 um"),
        # 1 Hz at 60 rpm of the driving shaft is twice per turn of the driven one.
        (wave(kind="time", hz=1.95, hz_std=0.001), ("the motor's turn",), ": the motor's turn"),
    ],
)
def test_entries_are_told_with_the_part(entry: Entry, parts: tuple[str, ...], ends: str) -> None:
    stated = (MOTOR, Part(name="wheel", turns=20.0))
    (found,) = with_parts([entry], stated, z=(10, 20), turns=[30.0], speeds=[2.0 * np.pi])
    assert found.parts == parts
    assert says(found).endswith(ends)
    assert found.to_json().get("also_turns", []) == list(parts)


def declared(folder: Path, tables: str) -> Path:
    pair = folder / "pair.toml"
    pair.write_text(PAIR + tables, encoding="utf-8")
    return pair


def test_a_pair_file_holds_any_number_of_parts(tmp_path: Path) -> None:
    tables = '[[also_turns]]\nname = "motor"\nturns_per_driving = 5.5\n'
    tables += '[[also_turns]]\nname = "belt"\nturns_per_driven = 1\nteeth = 60\n'
    read = read_pair(declared(tmp_path, tables))
    assert [(one.name, one.teeth) for one in read.also_turns] == [("motor", None), ("belt", 60)]
    again = tmp_path / "again.toml"
    again.write_text(dump_pair(read), encoding="utf-8")
    assert read_pair(again) == read


@pytest.mark.parametrize(
    ("table", "says"),
    [
        ('name = "motor"', 'turns_per_driven: missing, and turns_per_driving too; want one of the two for "motor"'),
        ('name = "motor"\nturns_per_driven = 1\nturns_per_driving = 2', "turns_per_driving = 2.0 too"),
        ('name = "motor"\nturns_per_driven = 0', "turns_per_driven"),
        ('name = "motor"\nturns_per_driven = 1\nteeth = 0', "teeth"),
        ("turns_per_driven = 1", "name"),
        ('name = ""\nturns_per_driven = 1', "name"),
        ('name = "motor"\nturns_per_drivin = 1', "turns_per_driving"),
    ],
)
def test_a_part_that_cannot_be_is_one_message(tmp_path: Path, table: str, says: str) -> None:
    with pytest.raises(InputFileError) as raised:
        read_pair(declared(tmp_path, f"[[also_turns]]\n{table}\n"))
    assert says in str(raised.value)
    assert "also_turns" in str(raised.value)


def test_no_wave_at_a_part_s_order_is_named_of_this_pair_alone() -> None:
    """A wheel of 20 teeth on the driven shaft waves as this gear does; beyond half its teeth, and beside the other
    shaft's orders, places stay open."""
    alone = scope_of(rough(), (Condition(),))
    wheel = AlsoTurns(name="wheel", turns_per_driven=1.0, teeth=20)
    beside = replace(alone, file=alone.file.model_copy(update={"also_turns": (wheel,)}))
    for order in (1, 2, 7, 19, 20, 22):
        assert alone.shows(Place(gear=1, order=order))
        assert not beside.shows(Place(gear=1, order=order))
    for order in (12, 15, 26):
        assert beside.shows(Place(gear=1, order=order))
    # The gears are of 12 and 16 teeth: three driving orders are four driven ones.
    assert not beside.shows(Place(gear=0, order=3))
    assert beside.shows(Place(gear=0, order=1))
    assert not beside.shows(Place(gear=1), once=True)
    assert beside.shows(Place(gear=0), once=True)
    assert beside.shows(Place(gear=1, tooth=3))
    # What teeth make is told from a smooth wave by its side bands, where one is fitted at that order.
    fitted = replace(beside, smooth=frozenset({(1, 2)}))
    assert fitted.shows(Place(gear=1, order=2), by_teeth=True)
    assert not fitted.shows(Place(gear=1, order=2))
    assert not fitted.shows(Place(gear=1, order=7), by_teeth=True)


def test_a_whole_order_of_a_part_is_fitted_beside_everything() -> None:
    """Barred from names alone it would be made up of spalls and reliefs, as it was for a wheel of 13 teeth."""
    plain = wave(gear="driving", order=13.0)
    assert not is_foreign(plain)
    assert is_foreign(replace(plain, parts=("the wheel's mesh",)))
    # Nor is it taken for what a proud tooth brings along, or the teeth would take a part of it and leave its images.
    assert is_foreign(replace(plain, parts=("the wheel's mesh",), companion_of="a tooth of the driven gear"))
    assert not is_foreign(replace(plain, companion_of="a tooth of the driven gear"))
    assert not is_foreign(wave(kind="mesh_order", order=1.0, parts=("the wheel's mesh",)))


@pytest.mark.long
def test_compare_tells_a_line_with_its_part(tmp_path: Path, gearpoly_command: Command) -> None:
    """An ideal 18/25 pair with a wave of 2 um at 3.3 per driven turn, which the pair file states as the motor's."""
    rng = np.random.default_rng(2)
    turns = np.linspace(0.0, 30.0, 9000) + rng.uniform(0.0, 1e-3, 9000)
    te = 2.0 * np.cos(2.0 * np.pi * 3.3 * turns) + 0.3 * rng.standard_normal(turns.size)
    recording, out = tmp_path / "made.csv", tmp_path / "out.json"
    table = np.column_stack((360.0 * turns, te))
    np.savetxt(recording, table, delimiter=",", header="driven_angle_deg,te_um", comments="", fmt="%.6f")
    tables = '[[also_turns]]\nname = "motor"\nturns_per_driven = 3.3\n'
    ran = gearpoly_command("compare", declared(tmp_path, tables), recording, "--json", out)
    assert ran.code == 0, ran.err
    (told,) = [one for one in json.loads(out.read_text(encoding="utf-8"))["where"] if one.get("also_turns")]
    assert told["also_turns"] == ["the motor's turn"]
    assert told["amplitude_um"] == pytest.approx(2.0, abs=0.05)  # 0.3 um in 9000 samples: 0.0045 um
    assert "the motor's turn" in ran.out
