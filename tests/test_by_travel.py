"""One shaft in another unit than it is read in: told by how far both travelled, with the line that cures it."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.physics.parts import EncoderErrors
from gearpoly.recording.chain import corrected
from gearpoly.recording.clean import clean
from gearpoly.recording.read import read_recording
from tests.made_texts import DEGREE, RATIO, chart, table, written

TIME = np.arange(6000) / 200.0
DRIVING = 180.0 * TIME + 2.0 * np.sin(2.0 * TIME)
DRIVEN = RATIO * DRIVING + np.degrees(2e-5 * np.sin(DRIVING * DEGREE))
SIZES = {"deg": 1.0, "rad": 1.0 / DEGREE, "rev": 360.0, "arcmin": 1.0 / 60.0, "arcsec": 1.0 / 3600.0}
OWN = ("time_s", "driving_angle_deg", "driven_angle_deg")
FOREIGN = ("t [s]", "Winkel Antrieb [{}]", "Winkel Abtrieb [{}]")
TRUE = EncoderErrors()


@pytest.mark.parametrize("shaft", ["driving", "driven"])
@pytest.mark.parametrize(
    ("names", "stated", "true"),
    [
        (OWN, "deg", "rad"),
        (OWN, "deg", "rev"),
        (FOREIGN, "deg", "rad"),
        (FOREIGN, "deg", "rev"),
        (FOREIGN, "rad", "deg"),
        (FOREIGN, "rev", "rad"),
        (FOREIGN, "deg", "arcmin"),
        (FOREIGN, "deg", "arcsec"),
    ],
)
def test_a_shaft_in_another_unit_is_named(
    tmp_path: Path, names: tuple[str, ...], stated: str, true: str, shaft: str
) -> None:
    """It was called a recording of half a turn. The line that is named gives the angles that both shafts had."""
    units = {"driving": stated, "driven": stated, shaft: true}
    columns = [TIME, DRIVING / SIZES[units["driving"]], DRIVEN / SIZES[units["driven"]]]
    file = written(tmp_path, table(columns, [one.format(stated) for one in names], digits=9, decimal=".",
                                   separator="," if names == OWN else ";"))  # fmt: skip
    read = read_recording(file)
    with pytest.raises(InputFileError, match=f"column {shaft}_angle_deg: read in {stated}.* with {true} in it") as told:
        corrected(read, TRUE, TRUE, ratio=RATIO, r_b2=23.5)
    with pytest.raises(InputFileError, match=f"column {shaft}_angle_deg"):
        clean(read, ratio=RATIO)
    line = re.search(r"columns\.\S+ = \{[^}]*\}", told.value.wish)
    assert line is not None
    if true.startswith("arc"):  # a gear of 60 between shaft and encoder reads so too, and its scale is taken
        assert f"[{shaft}.encoder] scale" in told.value.wish
        scaled = {"driving": TRUE, "driven": TRUE, shaft: EncoderErrors(scale=SIZES[stated] / SIZES[true])}
        corrected(read, scaled["driving"], scaled["driven"], ratio=RATIO, r_b2=23.5)
    cured = read_recording(file, chart=chart(tmp_path, line[0]))
    assert corrected(cured, TRUE, TRUE, ratio=RATIO, r_b2=23.5) is cured
    for angle, turned in ((cured.driving_angle_rad, DRIVING), (cured.driven_angle_rad, DRIVEN)):
        assert angle is not None
        np.testing.assert_allclose(angle, turned * DEGREE, atol=1e-6)


@pytest.mark.parametrize("factor", [1.0, 0.9, 10.0 / 9.0, 2.0, 0.25, 10.0, 1000.0 / 1024.0])
def test_counts_that_are_set_wrong_are_no_unit(tmp_path: Path, factor: float) -> None:
    file = written(tmp_path, table([TIME, DRIVING, factor * DRIVEN], OWN, digits=9, decimal=".", separator=","))
    read = read_recording(file)
    assert corrected(read, TRUE, TRUE, ratio=RATIO, r_b2=23.5) is read


@pytest.mark.parametrize("wrapped", [(True, True), (True, False), (False, True)])
def test_wrapped_readings_are_of_the_turns_that_they_made(tmp_path: Path, wrapped: tuple[bool, bool]) -> None:
    angles = [np.mod(one, 360.0) if wraps else one for one, wraps in zip((DRIVING, DRIVEN), wrapped, strict=True)]
    read = read_recording(written(tmp_path, table([TIME, *angles], OWN, digits=9, decimal=".", separator=",")))
    assert corrected(read, TRUE, TRUE, ratio=RATIO, r_b2=23.5) is read
