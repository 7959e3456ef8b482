"""Names and units of columns: a shaft that is named, a unit that is shown, and everything else in doubt."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.by_readings import contradicting, wrapped_unit
from gearpoly.recording.meaning import meanings
from gearpoly.recording.quantities import UNITS
from gearpoly.recording.read import read_recording
from gearpoly.recording.table import Channel
from tests.made_texts import DEGREE, OWN, chart, own, run, same, table, written


@pytest.mark.parametrize(
    ("header", "shaft"),
    [
        ("Winkel Antrieb [°]", "driving"), ("Abtriebswinkel [°]", "driven"), ("input angle [deg]", "driving"),
        ("Ausgangswelle Winkel [°]", "driven"), ("Angle entrée [°]", "driving"), ("ángulo salida [°]", "driven"),
        ("Kanal 1 Drehwinkel Antrieb [°]", "driving"), ("channel 2 driven angle [deg]", "driven"),
        # Names that are no shaft, or of both.
        ("Kanal 1 Eingang Winkel [°]", ""), ("channel 1 output angle [deg]", ""),
        ("Analog input 1 angle [deg]", ""), ("Eingang 3 Winkel [°]", ""), ("Winkel Ritzel [°]", ""),
        ("angle 1 [deg]", ""),
        ("Winkel Antrieb/Abtrieb [°]", ""), ("Non-drive side angle [deg]", ""), ("angle_in [deg]", ""),
    ],
)  # fmt: skip
def test_a_shaft_is_named_or_it_is_not(header: str, shaft: str) -> None:
    (found,) = meanings({header: Channel(values=np.arange(20.0))})
    if shaft:
        assert (found.column, found.doubt) == (f"{shaft}_angle_deg", "")
    else:
        assert found.doubt


@pytest.mark.parametrize(
    "header",
    ["Sollwinkel Antrieb [°]", "Winkelfehler Antrieb [°]", "Differenzwinkel Antrieb [°]", "Verdrehwinkel Antrieb [°]",
     "Temperatur Antrieb [°C]", "T [°C]", "Kraft Antrieb [N]", "M [kg]", "input angle setpoint [deg]"],
)  # fmt: skip
def test_what_is_no_reading_of_a_shaft_is_never_taken(header: str) -> None:
    (found,) = meanings({header: Channel(values=np.arange(20.0))})
    assert not found.column or found.doubt


@pytest.mark.parametrize(
    "header",
    [
        "Relative Zeit [ms]",
        "Relative time [ms]",
        "Zeit relativ [ms]",
        "temps relatif [ms]",
        "Relativzeit [ms]",
        "RelativeTime [ms]",
        "tiempo relativo [ms]",
    ],
)
def test_a_relative_time_is_the_time(header: str) -> None:
    """It counts from the beginning of the trace; what else is relative is of neither shaft."""
    (found,) = meanings({header: Channel(values=2.0 * np.arange(20.0))})
    assert (found.column, found.unit, found.doubt) == ("time_s", UNITS["time"]["ms"], "")
    (angle,) = meanings({header.replace("ms", "deg"): Channel(values=np.arange(20.0))})
    assert not angle.column or angle.doubt


@pytest.mark.parametrize(
    ("header", "unit"),
    [("Winkelgeschwindigkeit Antrieb [1/s]", "rad/s"), ("omega driving [s-1]", "rad/s"),
     ("input angular velocity [s^-1]", "rad/s"), ("Drehzahl Antrieb [1/s]", "rev/s"), ("input speed [1/s]", "rev/s"),
     ("omega driving [rev/s]", "rev/s"), ("omega driving [Hz]", "rev/s"), ("omega driving [rad/s]", "rad/s")],
)  # fmt: skip
def test_an_angular_velocity_in_1_s_is_in_radians(header: str, unit: str) -> None:
    """ISO 80000-3: an angular velocity has the unit rad/s or s^-1, a rotational frequency s^-1 too."""
    (found,) = meanings({header: Channel(values=np.full(20, 6.28))})
    assert (found.column, found.unit) == ("speed_rpm", UNITS["speed"][unit])


def test_microseconds_that_begin_again_are_offered_with_their_wrap() -> None:
    """The counter of a small computer has 32 bits: of 500 samples per second it begins again within 72 minutes."""
    ticks = np.mod(4286967296.0 + 2000.0 * np.arange(6000), 2.0**32)
    (found,) = meanings({"micros": Channel(values=ticks)})
    assert found.unit == UNITS["time"]["us"] and found.doubt
    assert found.ask == ('columns.time_s = { from = "micros", unit = "us", wraps = 4294967296 }',)
    (rising,) = meanings({"micros": Channel(values=np.sort(ticks))})
    assert not rising.doubt


def test_a_column_without_a_number_is_offered_for_nothing() -> None:
    (found,) = meanings({"result": Channel(values=np.full(300, np.nan))})
    assert found.dimension == "something else" and not found.ask


def test_an_error_in_arcsec_beside_one_shaft_is_offered_as_transmission_error() -> None:
    (found,) = meanings({"Error [arcsec]": Channel(values=np.sin(np.arange(300.0)))})
    assert found.column == "te_arcsec" and found.doubt
    assert found.ask == ('columns.te_arcsec = { from = "Error [arcsec]", unit = "arcsec", sign = 1 }',)
    (other,) = meanings({"Position error [deg]": Channel(values=np.sin(np.arange(300.0)))})
    assert not other.column


def test_two_that_may_be_one_column_are_in_doubt() -> None:
    names = ("Winkel Antrieb [°]", "Winkel Antrieb gefiltert [°]")
    found = meanings({name: Channel(values=np.arange(20.0) + k) for k, name in enumerate(names)})
    assert all("may each be driving_angle_deg" in one.doubt for one in found)
    first, second = meanings({name: Channel(values=np.arange(20.0)) for name in names})
    assert first.column == "driving_angle_deg" and not first.doubt
    assert not second.column and second.why == 'the same readings as "Winkel Antrieb [°]"'


def test_the_unit_of_an_angle_is_told_by_where_it_begins_again() -> None:
    """deg, rad and gon have moduli a tenth and more apart; what does not wrap tells nothing."""
    turned = 0.031 * np.arange(800)  # turns
    for name, turn in (("deg", 360.0), ("rad", 2.0 * math.pi), ("gon", 400.0), ("mrad", 2000.0 * math.pi)):
        for direction in (1.0, -1.0):
            unit = wrapped_unit(np.mod(direction * turned, 1.0) * turn)
            assert unit is not None and unit.name == name
    assert wrapped_unit(360.0 * turned) is None
    assert wrapped_unit(np.mod(turned, 1.0) * 380.0) is None


@pytest.mark.parametrize(("stated", "true"), [("rad", "deg"), ("deg", "rad"), ("deg", "gon"), ("gon", "deg")])
def test_units_that_the_numbers_contradict_are_asked_about(tmp_path: Path, stated: str, true: str) -> None:
    """An angle that begins again at 360 is in degrees whatever its header says; the line of the message cures it."""
    held = run(1200)
    per = UNITS["angle"][true].size
    angles = [held[name] / per for name in OWN[1:3]]
    names = ("Zeit [s]", f"Winkel Antrieb [{stated}]", f"Winkel Abtrieb [{stated}]")
    file = written(tmp_path, table([held["time_s"], *angles], names, digits=7))
    with pytest.raises(InputFileError, match=f"the unit {stated}, and its readings begin again .* as in {true}"):
        read_recording(file)
    lines = "".join(
        f'columns.{column} = {{ from = "{name}", unit = "?" }}\n'
        for column, name in zip(OWN[1:3], names[1:], strict=True)
    )
    cured = read_recording(file, chart=chart(tmp_path, lines.replace("?", true)))
    same(cured.driving_angle_rad, held["driving_angle_deg"] * DEGREE, half=0.5e-7 * per * DEGREE)
    with pytest.raises(InputFileError, match=f'unit: {stated}, and the readings .* want unit = "{true}"'):
        read_recording(file, chart=chart(tmp_path, lines.replace("?", stated)))


def test_radians_under_a_name_of_degrees_are_refused_with_a_map_that_cures_it(tmp_path: Path) -> None:
    held = run(1200)
    for name in OWN[1:3]:
        held[name] = np.radians(held[name])
    file = written(tmp_path, own(held, digits=9))
    with pytest.raises(InputFileError, match="readings that begin again after one turn as in rad"):
        read_recording(file)
    lines = "".join(f'columns.{name} = {{ from = "{name}", unit = "rad" }}\n' for name in OWN[1:3])
    cured = read_recording(file, chart=chart(tmp_path, lines))
    same(cured.driven_angle_rad, run(1200)["driven_angle_deg"] * DEGREE, half=0.5e-9)


def test_a_spike_of_400_is_no_turn_of_gons() -> None:
    angle = np.linspace(0.0, 700.0, 2000)
    angle[900] += 400.0
    assert contradicting(angle, UNITS["angle"]["deg"]) is None
