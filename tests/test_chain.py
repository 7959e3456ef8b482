"""What encoders read wrong: a true rotation encoded with every error, and read back; drift that a pair file states."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from gearpoly.assemble import brought_parts
from gearpoly.compare.compare import lay_beside
from gearpoly.files.models import Encoder, Measurement, PairFile
from gearpoly.keys.edit import on_gear
from gearpoly.physics.encoder_interpolation import Interpolation
from gearpoly.physics.parts import EncoderErrors
from gearpoly.recording.chain import corrected
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, UM, URAD, FloatArray
from tests.made_recordings import Rig, inspected, record
from tests.pair_files import pair_file

TURN = 2.0 * math.pi
RATIO, R_B2 = 18 / 25, 23.5

# Errors of up to 300 urad, with 1800 waves of 2 urad among them: slopes of 0.004, so that a reading has one truth.
WRONG = Encoder(
    eccentricity_urad=300.0,
    eccentricity_deg=77.0,
    interpolation=(
        Interpolation(order=900, amplitude_urad=3.0, angle_deg=20.0),
        Interpolation(order=1800, amplitude_urad=2.0, angle_deg=-130.0),
    ),
)


def encoder_errors(section: Encoder | None) -> EncoderErrors:
    """The errors that a pair file with this section states."""
    return brought_parts(on_gear(pair_file(), 0, encoder=section)).encoders[0]


def error_of(section: Encoder, reading: FloatArray) -> FloatArray:
    """The documented error in rad at a reading in rad: largest once per turn at ``eccentricity_deg``."""
    out = section.eccentricity_urad * URAD * np.cos(reading - section.eccentricity_deg * DEG)
    for one in section.interpolation:
        out = out + one.amplitude_urad * URAD * np.cos(one.order * reading + one.angle_deg * DEG)
    return np.asarray(out)


def read_wrongly(section: Encoder, truth: FloatArray) -> FloatArray:
    """What the encoder shows for a true angle (n,) in rad: scale times truth, plus the error at what it shows."""
    reading = section.scale * truth
    for _ in range(60):
        reading = section.scale * truth + error_of(section, reading)
    return reading


def turning(n: int = 4000, turns: float = 12.0) -> tuple[FloatArray, FloatArray]:
    """Driving and driven angle (n,) in rad of a pair with some transmission error."""
    theta_2 = 0.4 + np.linspace(0.0, turns * TURN, n)
    return (theta_2 - 5e-5 * np.sin(3.0 * theta_2)) / RATIO, theta_2


@pytest.mark.parametrize("wrapped", [False, True])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("scale", [1.0, 1.0 + 3e-5, 0.9])
def test_both_encoders_are_put_right_exactly(wrapped: bool, direction: Literal[1, -1], scale: float) -> None:
    """Drop-outs stay drop-outs; wrapped readings come back up to whole turns of the reading."""
    theta_1, theta_2 = turning()
    sections = WRONG.model_copy(update={"scale": scale}), WRONG.model_copy(update={"eccentricity_urad": 50.0})
    zeros = 1.1, 2.2
    truths = [zero + direction * theta for zero, theta in zip(zeros, (theta_1, theta_2), strict=True)]
    readings = [read_wrongly(section, truth) for section, truth in zip(sections, truths, strict=True)]
    if wrapped:
        readings = [np.mod(reading, TURN) for reading in readings]
    readings[0][17] = np.nan
    recording = Recording(
        source=Path("r.csv"),
        driving_angle_rad=readings[0],
        driven_angle_rad=readings[1],
        driving_direction=direction,
        driven_direction=direction,
    )
    back = corrected(recording, *(encoder_errors(s) for s in sections), ratio=RATIO, r_b2=R_B2)
    for k, found in enumerate((back.driving_angle_rad, back.driven_angle_rad)):
        assert found is not None
        off = found - truths[k]
        assert np.isnan(off[17]) == (k == 0)
        off = np.delete(off, 17)
        # A whole turn of the reading is 1/scale turns of the truth.
        whole = TURN / sections[k].scale
        jumps = np.round((off - off[0]) / whole) if sections[k].scale == 1.0 else np.zeros(off.size)
        # Angles of 100 rad in double precision; 60 rounds leave 0.004^60.
        np.testing.assert_allclose(off - jumps * whole, off[0], atol=1e-12)
        assert abs(math.remainder(off[0], whole)) < 1e-12


def test_scale_goes_on_over_many_turns() -> None:
    """A millionth is 6.3 urad a turn: after 1000 turns 6 mrad, all of it taken back."""
    truth = np.linspace(0.0, 1000.0 * TURN, 20_001)
    section = Encoder(scale=1.0 + 1e-6)
    reading = np.mod(read_wrongly(section, truth), TURN)
    other = np.mod(truth * RATIO, TURN)
    recording = Recording(source=Path("r.csv"), driving_angle_rad=reading, driven_angle_rad=other)
    back = corrected(recording, encoder_errors(section), EncoderErrors(), ratio=RATIO, r_b2=R_B2)
    assert back.driving_angle_rad is not None
    assert np.ptp(np.unwrap(reading) - truth) == pytest.approx(1e-6 * 1000.0 * TURN, rel=1e-6)
    # Rounding of 6000 rad, summed by the unwrapping of 20 000 samples.
    np.testing.assert_allclose(back.driving_angle_rad - back.driving_angle_rad[0], truth, atol=1e-9)


@pytest.mark.parametrize("shaft", ["driving", "driven"])
@pytest.mark.parametrize("column", ["te_rad", "te_mm"])
def test_a_rig_that_computed_te_gets_the_recorded_shaft_put_right(shaft: str, column: str) -> None:
    """Its TE = theta_2 - ratio theta_1 took the wrong reading in; with counting down, too."""
    theta_1, theta_2 = turning()
    section, direction = WRONG.model_copy(update={"scale": 1.0 + 2e-5}), -1
    truth = {"driving": theta_1, "driven": theta_2}
    reading = read_wrongly(section, direction * truth[shaft])
    wrong = {**truth, shaft: direction * reading}
    unit = 1.0 if column == "te_rad" else R_B2
    te = wrong["driven"] - RATIO * wrong["driving"]
    keys: dict[str, Any] = {
        column: te * unit,
        f"{shaft}_angle_rad": np.mod(reading, TURN),
        f"{shaft}_direction": direction,
    }
    recording = Recording(source=Path("r.csv"), **keys)
    errors = {shaft: encoder_errors(section)}
    none = EncoderErrors()
    back = corrected(recording, errors.get("driving", none), errors.get("driven", none), ratio=RATIO, r_b2=R_B2)
    found = getattr(back, column)
    assert found is not None
    shown = found / unit - (theta_2 - RATIO * theta_1)
    # The first turn of a wrapped reading is unknown: a constant. Angles of 100 rad in double precision.
    np.testing.assert_allclose(shown - shown[0], 0.0, atol=1e-12)


def test_a_true_encoder_leaves_the_recording_as_it_is() -> None:
    theta_1, theta_2 = turning(100, 1.0)
    recording = Recording(source=Path("r.csv"), driving_angle_rad=theta_1, driven_angle_rad=theta_2)
    assert corrected(recording, encoder_errors(None), encoder_errors(Encoder()), ratio=RATIO, r_b2=R_B2) is recording


def with_errors(file: PairFile, **keys: Encoder) -> PairFile:
    return file.model_copy(
        update={name: getattr(file, name).model_copy(update={"encoder": e}) for name, e in keys.items()}
    )


@pytest.mark.long
def test_compare_takes_stated_errors_and_drift_off(tmp_path: Path) -> None:
    """The same recording, once as true encoders on a cool rig would have made it, once with all of it wrong: the same
    residual."""
    rng = np.random.default_rng(3)
    file, path, truth = inspected(tmp_path, rng, z_1=12, z_2=16)
    zeros = 1.234, 4.321
    plain = record(truth, Rig(zero_1=zeros[0], zero_2=zeros[1], noise=0.1), rng, cycles=1.5, per_mesh=12, stated=zeros)
    assert plain.driving_angle_rad is not None and plain.driven_angle_rad is not None and plain.time_s is not None
    sections = WRONG.model_copy(update={"scale": 1.0 + 1e-5}), WRONG
    drift = (2.0, -1.5, 0.7)
    along = 2.0 * (plain.time_s - plain.time_s[0]) / np.ptp(plain.time_s) - 1.0
    slow = np.polynomial.legendre.legval(along, (0.0, *drift)) * UM
    # TE = theta_2 - ratio theta_1: what drifts is put on the driving reading.
    drifting = plain.driving_angle_rad - slow / truth.pair.r_b2 / truth.pair.ratio
    wrong = replace(
        plain,
        driving_angle_rad=read_wrongly(sections[0], drifting),
        driven_angle_rad=read_wrongly(sections[1], plain.driven_angle_rad),
    )
    knows = with_errors(file, driving=sections[0], driven=sections[1]).model_copy(
        update={"measurement": Measurement(thermal_drift_um=(drift,))}
    )
    a, b = lay_beside(file, [plain], path=path), lay_beside(knows, [wrong], path=path)
    # Both are aligned by themselves; the drift's samples differ from the true ones by what the readings do.
    np.testing.assert_allclose(b.aligned[0].residual, a.aligned[0].residual, atol=1e-6)
    blind = lay_beside(file, [wrong], path=path)
    assert blind.aligned[0].rms > 3.0 * a.aligned[0].rms
