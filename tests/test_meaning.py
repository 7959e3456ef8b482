"""Names and units of columns: a shaft that is named, a unit that is shown, and everything else in doubt."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearpoly.recording.meaning import meanings, wrapped_unit
from gearpoly.recording.table import Channel


@pytest.mark.parametrize(
    ("header", "shaft"),
    [
        ("Winkel Antrieb [°]", "driving"), ("Abtriebswinkel [°]", "driven"), ("input angle [deg]", "driving"),
        ("Ausgangswelle Winkel [°]", "driven"), ("Angle entrée [°]", "driving"), ("ángulo salida [°]", "driven"),
        # Names that are no shaft, or of both.
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


def test_two_that_may_be_one_column_are_in_doubt() -> None:
    names = ("Winkel Antrieb [°]", "Winkel Antrieb gefiltert [°]")
    found = meanings({name: Channel(values=np.arange(20.0)) for name in names})
    assert all("may each be driving_angle_deg" in one.doubt for one in found)


def test_the_unit_of_an_angle_is_told_by_where_it_begins_again() -> None:
    """deg, rad and gon have moduli a tenth and more apart; what does not wrap tells nothing."""
    turned = 0.031 * np.arange(800)  # turns
    for name, turn in (("deg", 360.0), ("rad", 2.0 * math.pi), ("gon", 400.0), ("mrad", 2000.0 * math.pi)):
        for direction in (1.0, -1.0):
            unit = wrapped_unit(np.mod(direction * turned, 1.0) * turn)
            assert unit is not None and unit.name == name
    assert wrapped_unit(360.0 * turned) is None
    assert wrapped_unit(np.mod(turned, 1.0) * 380.0) is None
