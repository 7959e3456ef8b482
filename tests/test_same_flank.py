"""Forth and back on one flank where an encoder reads another angle coming back: no change of flank, and no physics."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.assemble import Assembled
from gearpoly.compare.compare import compare
from gearpoly.compare.same_flank import with_flanks
from gearpoly.compare.turns import backlash
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.files.models import PairFile
from gearpoly.recording.recording import Recording
from gearpoly.recording.runs import runs_of
from gearpoly.units import ARCMIN, UM
from tests.made_recordings import inspected
from tests.made_runs import motion, recorded


def pair(folder: Path) -> tuple[PairFile, Path, Assembled]:
    return inspected(folder, np.random.default_rng(1), z_1=12, z_2=16)


def forth_and_back(made: Assembled, hysteresis: float, *, hangs: bool = True, eccentric: float = 0.0) -> Recording:
    """Four driven turns either way, more than a hunting cycle; the driving encoder reads ``hysteresis`` (rad) more
    going forth than back, and the driven gear is off its axis by so many mm."""
    turned = motion((4.0, -4.0))
    one = recorded(made, turned, np.random.default_rng(7), hangs=hangs)
    assert one.driving_angle_rad is not None and one.driven_angle_rad is not None
    once = eccentric / made.pair.r_b2 * np.cos(turned.driven)
    return replace(
        one,
        driving_angle_rad=np.mod(one.driving_angle_rad + 0.5 * hysteresis * turned.way, 2.0 * math.pi),
        driven_angle_rad=np.mod(one.driven_angle_rad + once, 2.0 * math.pi),
    )


def flanks(runs: list[Recording]) -> list[str]:
    return [one.flank for one in runs]


@pytest.mark.long
def test_far_less_than_the_backlash_is_no_change_of_flank(tmp_path: Path) -> None:
    """1 arcmin of 20 and more: a reader that does not know the pair takes it for lost motion."""
    file, path, made = pair(tmp_path)
    read = list(runs_of(forth_and_back(made, 1.0 * ARCMIN)))
    assert flanks(read) == ["drive", "coast"]
    runs = with_flanks(read, file, made.pair)
    assert flanks(runs) == ["drive", "drive"]
    said = " ".join(" ".join(one.remarks) for one in runs)
    assert "one flank carries both ways, as the file states: 1 arcmin" in said
    assert "coast" not in said
    beside = compare(file, read, path=path)
    apart = [entry for entry in beside.located.entries if entry.kind == "condition"]
    assert len(apart) == 1
    # What the driving encoder reads too little coming back, along the line of action.
    assert apart[0].rms_um == pytest.approx(ARCMIN * made.pair.r_b1 / UM, abs=0.05)


@pytest.mark.long
def test_the_backlash_itself_is_a_change_of_flank(tmp_path: Path) -> None:
    """Beside it an encoder's hysteresis of the same size changes nothing; nor does a computed error's unit."""
    file, _, made = pair(tmp_path)
    for hysteresis in (0.0, 1.0 * ARCMIN, -1.0 * ARCMIN):
        read = list(runs_of(forth_and_back(made, hysteresis, hangs=False)))
        assert flanks(with_flanks(read, file, made.pair)) == ["drive", "coast"]


def test_a_quarter_of_the_backlash_decides(tmp_path: Path) -> None:
    """Of 0.2 and 0.3 of the least backlash only the first is none."""
    file, _, made = pair(tmp_path)
    least = float(np.min(backlash(made.pair).j_bn)) / made.pair.r_b1
    for part, expected in ((0.2, ["drive", "drive"]), (0.3, ["drive", "coast"])):
        read = list(runs_of(forth_and_back(made, part * least)))
        assert flanks(with_flanks(read, file, made.pair)) == expected


def test_teeth_of_a_thickness_that_nobody_stated_say_nothing(tmp_path: Path) -> None:
    """What a grade leaves open says little of the backlash: gears may be set as close as they run."""
    file, _, made = pair(tmp_path)
    sheet = file.driving.inspection
    assert sheet is not None
    bare = sheet.model_copy(update={"tooth_thickness_um": None})
    unstated = file.model_copy(update={"driving": file.driving.model_copy(update={"inspection": bare})})
    read = list(runs_of(forth_and_back(made, 1.0 * ARCMIN)))
    assert flanks(with_flanks(read, unstated, made.pair)) == ["drive", "coast"]


@pytest.mark.slow
def test_an_eccentric_gear_is_told_beside_a_step_between_both_ways(tmp_path: Path) -> None:
    """The step is located and has no name, and hides nothing: 4 um of the driven gear, or of its encoder."""
    file, path, made = pair(tmp_path)
    read = list(runs_of(forth_and_back(made, 1.0 * ARCMIN, eccentric=4.0 * UM)))
    diagnosis = diagnose(file, read, path=path)
    (finding,) = diagnosis.findings
    assert finding.claim.place.gear == 1
    assert finding.claim.physics.name in ("eccentricity", "encoder_eccentricity")
    if finding.claim.physics.name == "eccentricity":
        assert math.hypot(*finding.claim.values) == pytest.approx(4.0, abs=0.1)
    assert [entry.kind for entry in diagnosis.unexplained] == ["condition"]
    size = ARCMIN * made.pair.r_b1 / UM
    assert diagnosis.unexplained[0].rms_um == pytest.approx(size, abs=0.1)
