"""The keys that a fitted pair file needs beyond the contract's: read, refused with one message, and written back."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from gearpoly.errors import InputFileError
from gearpoly.files.pairfile import dump_pair, effective_defaults, read_pair

WHOLE = """\
name = "all of it"

[pair]
torque_nm = 25.0
speed_rpm = 30.0
friction_coefficient = 0.06
misalignment_um = 9.5
windup_urad_per_nm = 1.25

[pair.resonance]
frequency_hz = 740.0
damping_ratio = 0.07

[model]
compliance_scale = 1.08

[measurement]
thermal_drift_um = [[1.5, -0.25], [], [0.5]]

[driving]
teeth = 18
module_mm = 2.0
face_width_mm = 20.0
wear_um = 4.0

[[driving.undulation]]
order = 47
amplitude_um = 0.8
angle_deg = 30.0
flank = "both"

[[driving.undulation]]
order = 61
amplitude_um = 0.3

[[driving.spall]]
tooth = 17
depth_um = 12.0
from_mm = 17.8
to_mm = 18.6
wall_mm = 0.1

[[driving.crack]]
tooth = 0
compliance_factor = 1.4

[driving.encoder]
eccentricity_urad = 120.0
eccentricity_deg = 200.0
scale = 1.00001

[[driving.encoder.interpolation]]
order = 1024
amplitude_urad = 2.0
angle_deg = -40.0

[driven]
teeth = 25
module_mm = 2.0
face_width_mm = 20.0

[driven.encoder]
scale = 0.9999
"""


def written(folder: Path, text: str) -> Path:
    file = folder / "pair.toml"
    file.write_text(text, encoding="utf-8")
    return file


def refusal(folder: Path, old: str, new: str) -> str:
    """The one message for the whole file with one thing in it changed."""
    assert WHOLE.count(old) == 1, old
    file = written(folder, WHOLE.replace(old, new))
    with pytest.raises(InputFileError) as caught:
        read_pair(file)
    message = str(caught.value)
    assert message.startswith(str(file)) and "\n" not in message
    return message.removeprefix(str(file))


def test_everything_is_read_and_written_back(tmp_path: Path) -> None:
    pair = read_pair(written(tmp_path, WHOLE))
    assert pair.pair.resonance is not None and pair.pair.resonance.damping_ratio == 0.07
    assert (pair.pair.friction_coefficient, pair.pair.misalignment_um, pair.pair.windup_urad_per_nm) == (
        0.06,
        9.5,
        1.25,
    )
    assert pair.model.compliance_scale == 1.08
    assert pair.measurement is not None and pair.measurement.thermal_drift_um == ((1.5, -0.25), (), (0.5,))
    driving = pair.driving
    assert driving.wear_um == 4.0
    assert [(w.order, w.amplitude_um, w.angle_deg, w.flank) for w in driving.undulation] == [
        (47, 0.8, 30.0, "both"),
        (61, 0.3, 0.0, "drive"),
    ]
    assert [(s.tooth, s.depth_um, s.from_mm, s.to_mm, s.wall_mm) for s in driving.spall] == [
        (17, 12.0, 17.8, 18.6, 0.1)
    ]
    assert [(c.tooth, c.compliance_factor) for c in driving.crack] == [(0, 1.4)]
    assert driving.encoder is not None and pair.driven.encoder is not None
    assert (driving.encoder.eccentricity_urad, driving.encoder.scale, pair.driven.encoder.scale) == (
        120.0,
        1.00001,
        0.9999,
    )
    assert [one.order for one in driving.encoder.interpolation] == [1024]
    text = dump_pair(pair)
    again = read_pair(written(tmp_path, text))
    assert again == pair
    assert dump_pair(again) == text


def test_what_is_left_out_changes_nothing_and_is_not_written(tmp_path: Path) -> None:
    plain = "[driving]\nteeth = 18\nmodule_mm = 2.0\n[driven]\nteeth = 25\nmodule_mm = 2.0\n"
    pair = read_pair(written(tmp_path, plain))
    assert (pair.pair.friction_coefficient, pair.pair.misalignment_um, pair.pair.windup_urad_per_nm) == (0.0, 0.0, 0.0)
    assert pair.pair.resonance is None and pair.measurement is None and pair.driving.encoder is None
    assert (pair.driving.wear_um, pair.driving.undulation, pair.driving.spall, pair.driving.crack) == (0.0, (), (), ())
    assert pair.model.compliance_scale == 1.0
    text = dump_pair(pair)
    for key in ("friction", "misalignment", "windup", "wear", "undulation", "spall", "crack", "encoder", "measurement"):
        assert key not in text
    shown = dict(effective_defaults(pair))
    assert shown["pair.friction_coefficient"] == 0.0
    assert "driving.encoder" not in shown and "pair.resonance" not in shown


# Section, a right key of it, a misspelt one.
MISSPELT = [
    ("depth_um = 12.0", "depth_mu = 12.0", "depth_um"),
    ("compliance_factor = 1.4", "compliance_facter = 1.4", "compliance_factor"),
    ("angle_deg = 30.0", "angel_deg = 30.0", "angle_deg"),
    ("eccentricity_urad = 120.0", "excentricity_urad = 120.0", "eccentricity_urad"),
    ("amplitude_urad = 2.0", "amplitude_rad = 2.0", "amplitude_urad"),
    ("damping_ratio = 0.07", "damping = 0.07", "damping_ratio"),
    ("friction_coefficient = 0.06", "friction_coeficient = 0.06", "friction_coefficient"),
    ("wear_um = 4.0", "ware_um = 4.0", "wear_um"),
    ("thermal_drift_um =", "thermal_drift =", "thermal_drift_um"),
    ("[measurement]", "[measurements]", "measurement"),
    ("[[driving.spall]]", "[[driving.spal]]", "spall"),
    ("[driving.encoder]\n", "[driving.encodr]\n", "encoder"),
]


@pytest.mark.parametrize(
    ("old", "new", "nearest"), MISSPELT, ids=[new.split(" ")[0].strip("[]\n") for _, new, _ in MISSPELT]
)
def test_an_unknown_key_names_the_nearest(tmp_path: Path, old: str, new: str, nearest: str) -> None:
    message = refusal(tmp_path, old, new)
    wrong = new.split(" = ")[0].split(" =")[0].strip("[]\n").split(".")[-1]
    assert wrong in message
    assert nearest in message.split(wrong, 1)[1]


@pytest.mark.parametrize(
    ("old", "new", "where", "says"),
    [
        ("tooth = 17", "tooth = 18", "driving.spall", "0 to 17"),
        ("tooth = 17", "tooth = -1", "driving.spall", "-1"),
        ("tooth = 0", "tooth = 99", "driving.crack", "0 to 17"),
        ("tooth = 0", "tooth = 0.5", "driving.crack", "0.5"),
        ("tooth = 0", 'tooth = "first"', "driving.crack", "first"),
        ("to_mm = 18.6", "to_mm = 17.0", "driving.spall", "from_mm = 17.8"),
        ("to_mm = 18.6", "to_mm = 17.8", "driving.spall", "from_mm = 17.8"),
        ("depth_um = 12.0", "depth_um = -12.0", "driving.spall", "-12"),
        ("depth_um = 12.0", "depth_um = [12.0]", "driving.spall", "depth_um"),
        ("depth_um = 12.0\n", "", "driving.spall", "depth_um"),
        ("wall_mm = 0.1", "wall_mm = 0.0", "driving.spall", "wall_mm"),
        ("compliance_factor = 1.4", "compliance_factor = 0.0", "driving.crack", "compliance_factor"),
        ("order = 47", "order = 0", "driving.undulation", "order"),
        ("order = 47", "order = 47.5", "driving.undulation", "order"),
        ('flank = "both"', 'flank = "left"', "driving.undulation", "coast"),
        ("amplitude_um = 0.8", 'amplitude_um = "0.8"', "driving.undulation", "amplitude_um"),
        ("scale = 0.9999", "scale = 0.0", "driven.encoder.scale", "0.0"),
        ("order = 1024", "order = true", "driving.encoder.interpolation", "order"),
        ("friction_coefficient = 0.06", "friction_coefficient = 1.5", "pair.friction_coefficient", "1.5"),
        ("friction_coefficient = 0.06", "friction_coefficient = nan", "pair.friction_coefficient", "nan"),
        ("misalignment_um = 9.5", "misalignment_um = -9.5", "pair.misalignment_um", "-9.5"),
        ("windup_urad_per_nm = 1.25", "windup_urad_per_nm = inf", "pair.windup_urad_per_nm", "inf"),
        ("frequency_hz = 740.0", "frequency_hz = 0.0", "pair.resonance.frequency_hz", "0.0"),
        ("frequency_hz = 740.0\n", "", "pair.resonance.frequency_hz", "missing"),
        ("damping_ratio = 0.07", "damping_ratio = 1.2", "pair.resonance.damping_ratio", "1.2"),
        ("compliance_scale = 1.08", "compliance_scale = 0.0", "model.compliance_scale", "0.0"),
        ("wear_um = 4.0", "wear_um = -4.0", "driving.wear_um", "-4.0"),
        ("[[1.5, -0.25], [], [0.5]]", "[1.5, -0.25]", "measurement.thermal_drift_um", "1.5"),
        ("[[1.5, -0.25], [], [0.5]]", '[[1.5, "x"]]', "measurement.thermal_drift_um", "x"),
        ("[[1.5, -0.25], [], [0.5]]", "2.0", "measurement.thermal_drift_um", "2.0"),
    ],
)  # fmt: skip
def test_a_wrong_value_is_refused_in_one_message(tmp_path: Path, old: str, new: str, where: str, says: str) -> None:
    message = refusal(tmp_path, old, new)
    assert where in message and says in message and "want" in message


def test_a_spall_written_as_a_single_table_is_refused(tmp_path: Path) -> None:
    message = refusal(tmp_path, "[[driving.spall]]", "[driving.spall]")
    assert "driving.spall" in message and "want" in message


@pytest.mark.long
def test_the_command_says_it_once_and_exits_2(tmp_path: Path) -> None:
    file = written(tmp_path, WHOLE.replace("tooth = 17", "tooth = 18"))
    run = subprocess.run(
        [sys.executable, "-m", "gearpoly", "simulate", str(file), "--csv", str(tmp_path / "te.csv")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 2
    assert "Traceback" not in run.stderr and run.stdout == ""
    flat = " ".join(run.stderr.split())
    assert flat.count("driving.spall") == 1 and "0 to 17" in flat
    assert not (tmp_path / "te.csv").exists()
