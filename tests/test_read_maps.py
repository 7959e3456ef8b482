"""Maps: units, scales, signs, zeros and paths do what they say, and a wrong line is named with a cure that works."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.clean import clean
from gearpoly.recording.map_file import COLUMN, TEXT, TOP, read_map
from gearpoly.recording.map_text import map_text
from gearpoly.recording.quantities import COUNT, UNITS, unit_written, units_written
from gearpoly.recording.read import read_recording
from gearpoly.recording.reader import recording_from_table
from gearpoly.recording.survey import survey
from gearpoly.recording.table import Channel, Table
from gearpoly.recording.taken import taken
from tests import recording_files
from tests.at_hand import ROOT
from tests.made_texts import DEGREE, RATIO, chart, own, run, same, table, written

RUN = run(1200)
NAMES = ("A", "B", "C", "D")

BOTH = """
columns.driving_angle_deg = { from = "B", unit = "deg" }
columns.driven_angle_deg = { from = "C", unit = "deg" }
"""


def of_units(folder: Path, unit: str, column: str, per: float) -> tuple[object, float]:
    """A recording whose ``column`` was written in ``unit`` (``per`` of the contract's unit in one), and half of the
    last place written, in the contract's unit."""
    held = {**RUN, column: RUN[column] / per}
    text = table(list(held.values()), NAMES, digits=9)
    place = {"time_s": "A", "driving_angle_deg": "B", "driven_angle_deg": "C", "torque_nm": "D"}
    lines = [
        f'columns.{name} = {{ from = "{place[name]}", unit = "{unit if name == column else default}" }}'
        for name, default in zip(place, ("s", "deg", "deg", "N.m"), strict=True)
    ]
    recording = read_recording(written(folder, text), chart=chart(folder, "\n".join(lines)))
    return recording, 0.5e-9 * per


@pytest.mark.parametrize(
    ("unit", "per"),
    [
        ("deg", 1.0), ("°", 1.0), ("arcmin", 1 / 60), ("arcsec", 1 / 3600), ("rad", 180 / math.pi), ("rev", 360.0),
        ("gon", 0.9), ("mrad", 0.18 / math.pi), ("µrad", 0.18e-3 / math.pi),
    ],
)  # fmt: skip
def test_units_of_an_angle(tmp_path: Path, unit: str, per: float) -> None:
    recording, half = of_units(tmp_path, unit, "driving_angle_deg", per)
    same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=half * DEGREE)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("unit", "per"), [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("µs", 1e-6), ("min", 60.0), ("h", 3600.0)]
)
def test_units_of_time(tmp_path: Path, unit: str, per: float) -> None:
    recording, half = of_units(tmp_path, unit, "time_s", per)
    same(recording.time_s, RUN["time_s"], half=half)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("unit", "per"),
    [
        ("N.m", 1.0), ("Nm", 1.0), ("N·mm", 1e-3), ("Ncm", 1e-2), ("kNm", 1e3), ("kgf.m", 9.80665),
        ("kgf.cm", 0.0980665),
        # Foot-pound and inch-pound of force as NIST SP 811 has them, to the digits printed there.
        ("lbf.ft", 1.355818), ("ft-lb", 1.355818), ("in.lbf", 0.1129848), ("in-lb", 0.1129848), ("ozf.in", 0.007061552),
    ],
)  # fmt: skip
def test_units_of_torque(tmp_path: Path, unit: str, per: float) -> None:
    recording, half = of_units(tmp_path, unit, "torque_nm", per)
    # The printed factors have seven digits, so half of the seventh of 25 N.m is allowed.
    same(recording.torque_samples_nm, RUN["torque_nm"], half=half + 25.0 * 5e-7)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("unit", "rpm"),
    [("1/min", 1.0), ("U/min", 1.0), ("rad/s", 30 / math.pi), ("deg/s", 1 / 6), ("Hz", 60.0), ("tr/min", 1.0)],
)
def test_units_of_speed(unit: str, rpm: float) -> None:
    found = unit_written(unit, "speed")
    assert found is not None and found.size == pytest.approx(rpm, rel=1e-15)


def test_spellings_do_not_contradict_one_another() -> None:
    for dimension, units in UNITS.items():
        for name, unit in units.items():
            assert unit_written(name, dimension) == unit
    assert {one.dimension for one in units_written("nm")} == {"torque", "length"}
    assert units_written("MNm") == units_written("Mrad") == ()  # no milli
    assert units_written("furlong") == units_written("") == units_written("x" * 1000) == ()


def test_a_unit_that_means_two_things_is_asked_for(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="want deg or gon, since it may mean both"):
        chart(tmp_path, 'columns.driving_angle_deg = { from = "B", unit = "grad" }')
    for unit, per in (("deg", 1.0), ("gon", 0.9)):
        assert (
            chart(tmp_path, f'columns.driving_angle_deg = {{ from = "B", unit = "{unit}" }}')
            .columns["driving_angle_deg"]
            .unit
            == UNITS["angle"][unit]
        )
        assert UNITS["angle"][unit].size == per


def test_counts_that_the_index_sets_to_zero_for_the_first_time(tmp_path: Path) -> None:
    """Either counter begins anywhere; what it read before the index came is left out."""
    turned_deg = {name: np.unwrap(RUN[f"{name}_angle_deg"], period=360.0) for name in ("driving", "driven")}
    whole = {name: np.floor(one / 360.0 * 4096.0) for name, one in turned_deg.items()}
    set_ = {name: one >= one[0] + 500.0 + 9.0 * k for k, (name, one) in enumerate(whole.items())}
    held = [
        np.where(after, np.mod(one - one[after][0], 4096.0), one - one[0] + 2345.0)
        for one, after in zip(whole.values(), set_.values(), strict=True)
    ]
    lines = "".join(
        f'columns.{name}_angle_deg = {{ from = "{column}", unit = "rev", scale = {1.0 / 4096.0!r}, wraps = 4096 }}\n'
        for name, column in zip(whole, ("B", "C"), strict=True)
    )
    file = written(tmp_path, table([RUN["time_s"], *held], ("Zeit [s]", "B", "C"), digits=6))
    recording = read_recording(file, chart=chart(tmp_path, lines))
    good = set_["driving"] & set_["driven"]
    assert 0 < int(np.sum(~good)) < len(good) // 2
    for name, angle in (("driving", recording.driving_angle_rad), ("driven", recording.driven_angle_rad)):
        assert angle is not None
        one = whole[name]
        turned = (one - one[good][0])[good] * (360.0 * DEGREE / 4096.0)
        np.testing.assert_array_equal(np.isfinite(angle), set_[name])
        np.testing.assert_allclose(angle[good] - angle[good][0], turned, rtol=0.0, atol=1e-9)
    told = [one for one in recording.remarks if "set to 0 by the index" in one]
    assert [int(np.argmax(one)) + 1 for one in set_.values()] == [int(re.findall(r"row (\d+)", one)[0]) for one in told]


def test_scale_sign_zero_and_wraps(tmp_path: Path) -> None:
    """4096 counts a turn that begin again at 65536 and fall as the shaft turns; torque in volts, with a tare."""
    turned = np.degrees(np.unwrap(np.radians(RUN["driving_angle_deg"])))
    counts = np.mod(-np.rint(turned / 360.0 * 4096) + 40000, 65536)
    volts = 1.25 - RUN["torque_nm"] / 10.0
    text = table([RUN["time_s"], counts, RUN["driven_angle_deg"], volts], NAMES, digits=[5, 0, 5, 9])
    recording = read_recording(
        written(tmp_path, text),
        chart=chart(
            tmp_path,
            f"""
            [columns]
            time_s = {{ from = "A", unit = "s" }}
            driven_angle_deg = {{ from = "C", unit = "deg", zero = 0 }}
            torque_nm = {{ from = "D", unit = "N.m", scale = 10, sign = -1, zero = 1.25 }}
            [columns.driving_angle_deg]
            from = "B"
            unit = "rev"
            scale = {1 / 4096}
            sign = -1
            zero = 40000
            wraps = 65536
            """,
        ),
    )
    assert recording.driving_direction == -1
    assert recording.driving_zero_rad == pytest.approx(40000 / 4096 * 2 * math.pi, rel=1e-15)
    cleaned = clean(recording, ratio=RATIO)
    half = 0.5 * 2 * math.pi / 4096  # of a count
    np.testing.assert_allclose(cleaned.theta_1, turned[cleaned.keep] * DEGREE, atol=1.01 * half)
    same(recording.torque_samples_nm, RUN["torque_nm"], half=0.5e-8)


def test_a_sign_is_the_direction_of_the_contract(tmp_path: Path) -> None:
    """Readings stay those of the encoder; the key that states its direction and its zero is what is set."""
    held = {**RUN, "driving_angle_deg": np.mod(200.0 - RUN["driving_angle_deg"], 360.0)}
    mapped = read_recording(
        written(tmp_path, table(list(held.values()), NAMES)),
        chart=chart(tmp_path, BOTH.replace('"B", unit = "deg"', '"B", unit = "deg", sign = -1, zero = 200.0')),
    )
    head = "# driving_direction = -1\n# driving_zero_deg = 200.0\n"
    plain = read_recording(written(tmp_path, head + own(held), name="own.csv"))
    assert (mapped.driving_direction, mapped.driving_zero_rad) == (plain.driving_direction, plain.driving_zero_rad)
    np.testing.assert_array_equal(mapped.driving_angle_rad, plain.driving_angle_rad)


def test_keys_and_sections_of_a_map(tmp_path: Path) -> None:
    text = table(list(RUN.values()), NAMES)
    recording = read_recording(
        written(tmp_path, text),
        chart=chart(tmp_path, BOTH + 'keys.flank = "coast"\nkeys.torque_nm = 12.5\nkeys.driven_zero_deg = 3.0\n'),
    )
    assert (recording.flank, recording.torque_nm) == ("coast", 12.5)
    assert recording.driven_zero_rad == pytest.approx(3.0 * DEGREE, rel=1e-15)


def test_what_is_left_out_is_not_taken(tmp_path: Path) -> None:
    text = table(list(RUN.values()), ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Drehmoment [Nm]"))
    file = written(tmp_path, text)
    with pytest.raises(InputFileError, match="no word says of which shaft the torque is"):
        read_recording(file)
    recording = read_recording(file, chart=chart(tmp_path, 'leave_out = ["Drehmoment"]'))
    assert recording.torque_samples_nm is None and recording.time_s is not None


@pytest.mark.parametrize("name", ["Drehmoment [Nm]", "Drehmoment", "column 4"])
def test_a_column_is_called_by_its_header_its_name_or_its_number(tmp_path: Path, name: str) -> None:
    text = table(list(RUN.values()), ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Drehmoment [Nm]"))
    one = read_recording(written(tmp_path, text), chart=chart(tmp_path, f'columns.torque_nm = {{ from = "{name}" }}'))
    same(one.torque_samples_nm, RUN["torque_nm"], half=0.5e-5)


def test_layout_of_a_map_settles_the_text(tmp_path: Path) -> None:
    text = "1;2;3;4\n" * 12 + table(list(RUN.values()), NAMES, units=("s", "°", "°", "Nm"))
    recording = read_recording(
        written(tmp_path, text, encoding="utf-16"),
        chart=chart(
            tmp_path,
            BOTH + 'text = { encoding = "utf-16", separator = ";", decimal = ",", header_line = 13, units_line = 14 }',
        ),
    )
    same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.5e-5 * DEGREE)


FAULTS: list[tuple[str, str, str, str]] = [
    # The map, the key that is named, and a part of the message that is taken as the cure in place of the key's line.
    ('colums.driving_angle_deg = { from = "B" }', "colums", "unknown key", 'nearest known key here is "columns"'),
    ('columns.driving_angle = { from = "B" }', "columns.driving_angle", "unknown column", '"driving_angle_deg"'),
    ('columns.driving_angle_deg = { form = "B" }', "columns.driving_angle_deg.form", "unknown key", '"from"'),
    ("columns.driving_angle_deg = { unit = 3 }", "columns.driving_angle_deg.from", "missing", "gearpoly read lists"),
    ("columns.driving_angle_deg = { from = 2 }", "columns.driving_angle_deg.from", "2", "in quotes"),
    ('columns.driving_angle_deg = "B"', "columns.driving_angle_deg", '"B"', "a table"),
    ('columns.torque_nm = { from = "D", unit = "deg" }', "columns.torque_nm.unit", "a unit of angle", "N.m, N.mm"),
    ('columns.torque_nm = { from = "D", unit = "xyz" }', "columns.torque_nm.unit", '"xyz"', "N.m, N.mm"),
    ('columns.torque_nm = { from = "D", scale = 0 }', "columns.torque_nm.scale", "0", "above 0"),
    ('columns.torque_nm = { from = "D", scale = "1" }', "columns.torque_nm.scale", '"1"', "a finite number"),
    ('columns.torque_nm = { from = "D", sign = 2 }', "columns.torque_nm.sign", "2", "1, or -1"),
    ('columns.torque_nm = { from = "D", wraps = -1 }', "columns.torque_nm.wraps", "-1", "above 0"),
    ('columns.torque_nm = { from = "D", zero = inf }', "columns.torque_nm.zero", "inf", "finite"),
    ('keys.flank = "left"', "keys.flank", '"left"', '"drive" or "coast"'),
    ("keys.torque = 3.0", "keys.torque", "unknown key", '"torque_nm"'),
    ('text.decimal = "x"', "text.decimal", '"x"', '"," or "."'),
    ('text = { decimal = ",", thousands = "," }', "text.thousands", '","', "another mark"),
    ('text.thousands = "."', "text.decimal", "missing beside", 'want decimal = ","'),
    ('text.separator = "and"', "text.separator", '"and"', '";"'),
    ('text.encoding = "klingon"', "text.encoding", '"klingon"', '"utf-8"'),
    ('text.dates = "dmy"', "text.dates", '"dmy"', '"day first"'),
    ("text.header_line = 0", "text.header_line", "0", "counted from 1"),
    ("text.units_line = 3", "text.header_line", "missing beside", "header_line"),
    ("section = 1.5", "section", "1.5", "a whole number"),
    ("leave_out = \"D\"", "leave_out", '"D"', "a list of names"),
    ("text = 3", "text", "3", "a table"),
    ('columns.driven_angle_deg = { from = "C", sign = -1 }\nkeys.driven_direction = 1',
     "columns.driven_angle_deg.sign", "driven_direction too", "one of the two"),
    # Those that only the recording tells.
    ('columns.driving_angle_deg = { from = "E" }', "columns.driving_angle_deg.from", '"E" is no column', "want one of"),
    ('columns.driving_angle_deg = { from = "B" }', "columns.driving_angle_deg.unit", "states no unit", 'unit = "deg"'),
    ('leave_out = ["E"]', "leave_out", '"E" is no column', "want one of: A, B, C, D"),
    ("section = 2", "section", "2, and the file holds 1", "from 1 to 1"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "where", "found", "wish"), FAULTS, ids=[one[0][:50] for one in FAULTS])
def test_a_wrong_line_of_a_map_is_named(tmp_path: Path, text: str, where: str, found: str, wish: str) -> None:
    file = written(tmp_path, table(list(RUN.values()), NAMES))
    with pytest.raises(InputFileError) as caught:
        read_recording(file, chart=chart(tmp_path, text))
    error = caught.value
    assert error.file == str(tmp_path / "map.toml")
    assert error.where == where
    assert found in error.found
    assert wish in error.wish
    assert "\n" not in str(error)


def test_text_of_a_map_is_for_text(tmp_path: Path) -> None:
    file = tmp_path / "a.uff"
    recording_files.write_uff(file, RUN, {})
    with pytest.raises(InputFileError, match=r"a.uff is UFF58, no text; want no \[text\]"):
        read_recording(file, chart=chart(tmp_path, 'text.decimal = ","'))


LINE = re.compile(r"(?:columns|keys|text)\.\w+ = (?:\{[^}]*\}|\"[^\"]*\"|[\d.]+)")


@pytest.mark.parametrize(
    "names",
    [
        ("Zeit [s]", "Winkel 1 [°]", "Winkel 2 [°]", "Drehmoment Abtrieb [Nm]"),
        ("Zeit", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Drehmoment Abtrieb [Nm]"),
        ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Drehmoment [Nm]"),
        ("Zeit [s]", "Winkel Ritzel [°]", "Winkel Rad [°]", "Drehmoment [Nm]"),
        ("Zeit [s]", "Winkel Antrieb [V]", "Winkel Abtrieb [°]", "Drehmoment Abtrieb"),
        ("Zeit [s]", "Kanal 1 [°]", "Kanal 2 [°]", "Drehmoment Abtrieb [Nm]"),
        ("t", "p", "q", "r"),
        ("", "", "", ""),
    ],
)
def test_every_refusal_names_a_cure_that_works(tmp_path: Path, names: tuple[str, ...]) -> None:
    """The lines of each message are put into the map until the recording is read."""
    file = written(tmp_path, table(list(RUN.values()), names if any(names) else ["", "", "", ""]))
    lines: list[str] = []
    for _ in range(6):
        try:
            recording = read_recording(file, chart=chart(tmp_path, "\n".join(lines)))
            break
        except InputFileError as error:
            found = LINE.findall(error.wish)
            assert found, str(error)
            assert found[0] not in lines, "a cure that does not work"
            lines.append(found[0])
    else:
        pytest.fail(f"no end of questions: {lines}")
    # The first doubtful angle is offered as the driving one.
    if all(names):
        assert recording.size == 1200


@pytest.mark.parametrize(
    "names",
    [
        ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Drehmoment Abtrieb [Nm]"),
        ("time (s)", "Input angle (deg)", "Output angle (deg)", "Output torque (lbf.ft)"),
        ("time_s", "driving_angle_deg", "driven_angle_deg", "torque_nm"),
    ],
)
def test_a_written_map_gives_the_same_numbers(tmp_path: Path, names: tuple[str, ...]) -> None:
    file = written(tmp_path, table(list(RUN.values()), names), encoding="cp1252")
    plain = read_recording(file)
    text = map_text(survey(file)[0])
    mapped = read_recording(file, chart=chart(tmp_path, text))
    assert "columns.driven_angle_deg" in text
    for name in ("time_s", "driving_angle_rad", "driven_angle_rad", "torque_samples_nm"):
        np.testing.assert_array_equal(getattr(mapped, name), getattr(plain, name))


def test_what_is_in_doubt_is_written_behind_a_mark_and_settles_it(tmp_path: Path) -> None:
    file = written(tmp_path, table(list(RUN.values()), ("Zeit", "Winkel 1 [°]", 'Winkel "2" [°]', "Drehmoment [Nm]")))
    text = map_text(survey(file)[0])
    with pytest.raises(InputFileError):
        read_recording(file, chart=chart(tmp_path, text))
    settled = re.sub(r"^# (columns\.)", r"\1", text, flags=re.MULTILINE)
    recording = read_recording(file, chart=chart(tmp_path, settled))
    same(recording.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=0.5e-5 * DEGREE)
    same(recording.time_s, RUN["time_s"], half=0.5e-5)


def test_angles_that_no_name_tells_are_offered_in_the_map(tmp_path: Path) -> None:
    """The refusal says that the map has the line: it has one for each column that may be the angle, of either shaft."""
    file = written(tmp_path, table(list(RUN.values())[:3], ("time_s", "enc1", "enc2")))
    with pytest.raises(InputFileError, match=r"--write map\.toml writes them") as caught:
        read_recording(file)
    text = map_text(survey(file)[0])
    asked = re.search(r"columns\.driving_angle_deg = \{[^}]*\}", str(caught.value))
    assert asked is not None and f"# {asked[0]}\n" in text
    for driving, driven in (("enc1", "enc2"), ("enc2", "enc1")):
        settled = text
        for column, name in (("driving", driving), ("driven", driven)):
            line = f'columns.{column}_angle_deg = {{ from = "{name}", unit = "deg" }}'
            assert f"# {line}\n" in settled
            settled = settled.replace(f"# {line}", line)
        recording = read_recording(file, chart=chart(tmp_path, settled))
        first, second = (RUN["driving_angle_deg"], RUN["driven_angle_deg"])[:: 1 if driving == "enc1" else -1]
        same(recording.driving_angle_rad, first * DEGREE, half=0.5e-5 * DEGREE)
        same(recording.driven_angle_rad, second * DEGREE, half=0.5e-5 * DEGREE)
    text = map_text(survey(written(tmp_path, own(RUN)))[0])
    assert "no column is" not in text


def test_counts_that_begin_again_are_offered_as_turns(tmp_path: Path) -> None:
    """A 12-bit encoder's counts from 0 to 4095: the map has the line that the refusal names, and with it the angles
    are what was counted, to half a count."""
    counts = [np.mod(np.rint(RUN[f"{one}_angle_deg"] / 360.0 * 4096.0), 4096.0) for one in ("driving", "driven")]
    file = written(tmp_path, table([RUN["time_s"], *counts], ("time_s", "raw_motor", "raw_out")))
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    settled = map_text(survey(file)[0])
    for column, name in (("driving", "raw_motor"), ("driven", "raw_out")):
        line = (
            f'columns.{column}_angle_deg = {{ from = "{name}", unit = "rev", scale = {1.0 / 4096.0!r}, wraps = 4096 }}'
        )
        assert line in str(caught.value) and f"# {line}\n" in settled
        settled = settled.replace(f"# {line}", line)
    recording = read_recording(file, chart=chart(tmp_path, settled))
    for angle, column in ((recording.driving_angle_rad, "driving"), (recording.driven_angle_rad, "driven")):
        assert angle is not None
        off = np.exp(1j * (angle - RUN[f"{column}_angle_deg"] * DEGREE)) - 1.0
        assert np.max(np.abs(off)) <= 1.01 * math.pi / 4096.0


@pytest.mark.parametrize("per_turn", [16_384, 14_400, 30_000, 2**22])
@pytest.mark.parametrize("name", ["Encoder {}", "Winkel {}", "Winkel {} [counts]"])
def test_the_number_at_which_counts_begin_again_is_told_in_full(tmp_path: Path, name: str, per_turn: int) -> None:
    """Of 16 384 counts a turn 16 400 were told under the name of an angle, and of 30 000 the power of two above. The
    lines as they stand give the turns that were counted, to half a count."""
    turns = [RUN["time_s"] * 0.5 + 2e-3 * np.sin(3.0 * RUN["time_s"])]
    turns.append(0.72 * turns[0])
    counts = [np.mod(np.rint(one * per_turn), per_turn) for one in turns]
    names = ("time_s", name.format("Antrieb"), name.format("Abtrieb"))
    file = written(tmp_path, table([RUN["time_s"], *counts], names, digits=(5, 0, 0)))
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    lines = re.findall(r"columns\.\S+ = \{[^}]*\}", str(caught.value))
    assert all(f"wraps = {per_turn} }}" in line for line in lines) and len(lines) == 2
    read = read_recording(file, chart=chart(tmp_path, "\n".join(lines)))
    for angle, turn in ((read.driving_angle_rad, turns[0]), (read.driven_angle_rad, turns[1])):
        assert angle is not None
        assert np.max(np.abs(angle / (2.0 * math.pi) - turn)) <= 0.51 / per_turn


def in_groups(*, apart: float = 0.0) -> Table:
    """What a reader of a format with groups hands over: channels by path, each with its unit and its own times."""
    late = RUN["time_s"][RUN["time_s"] >= apart]
    return Table(
        columns={},
        keys={},
        others={
            "rig/encoder 1": Channel(values=np.radians(RUN["driving_angle_deg"]), unit="rad", time=RUN["time_s"]),
            "rig/encoder 2": Channel(values=RUN["driven_angle_deg"][RUN["time_s"] >= apart], unit="deg", time=late),
        },
    )


def test_a_map_names_a_channel_by_its_path(tmp_path: Path) -> None:
    lines = (
        'columns.driving_angle_deg = { from = "rig/encoder 1" }\ncolumns.driven_angle_deg = { from = "encoder 2" }\n'
    )
    file = tmp_path / "a.tdms"
    together = recording_from_table(file, taken(file, in_groups(), chart(tmp_path, lines)))
    # From deg to rad, back and to rad again: four roundings.
    same(together.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.0)
    same(together.time_s, RUN["time_s"], half=0.0)
    apart = recording_from_table(file, taken(file, in_groups(apart=2.0), chart(tmp_path, lines)))
    assert apart.time_s is not None and apart.time_s[0] == 2.0
    assert apart.size == np.count_nonzero(RUN["time_s"] >= 2.0)


def test_a_parquet_table_under_names_of_its_own(tmp_path: Path) -> None:
    """Units stand in the metadata of its fields; what is sure is taken, what is not is asked for, a map settles it."""
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")

    def file(driven: str) -> Path:
        columns = (("Zeit", "s"), ("Winkel Antrieb", "deg"), (driven, "deg"), ("Drehmoment Abtrieb", "Nm"))
        schema = pa.schema([pa.field(name, pa.float64(), metadata={"unit": unit}) for name, unit in columns])
        schema = schema.append(pa.field("Bemerkung", pa.string()))
        target = tmp_path / "a.parquet"
        parquet.write_table(pa.table([*(pa.array(v) for v in RUN.values()), pa.array(["x"] * 1200)], schema), target)
        return target

    sure = read_recording(file("Winkel Abtrieb"))
    same(sure.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=0.0)
    same(sure.torque_samples_nm, RUN["torque_nm"], half=0.0)
    with pytest.raises(InputFileError, match="of which shaft"):
        read_recording(file("Winkel 2"))
    mapped = read_recording(
        file("Winkel 2"), chart=chart(tmp_path, 'columns.driven_angle_deg = { from = "Winkel 2", sign = -1 }')
    )
    same(mapped.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=0.0)
    assert mapped.driven_direction == -1


def test_one_channel_is_no_two_columns(tmp_path: Path) -> None:
    """No reading is that of both shafts, whichever of its names a map calls it by."""
    file = written(tmp_path, table(list(RUN.values()), NAMES))
    for again in ("B", "column 2"):
        with pytest.raises(
            InputFileError, match=r'driven_angle_deg\.from: "B", which columns\.driving_angle_deg has too'
        ):
            read_recording(file, chart=chart(tmp_path, BOTH.replace('"C"', f'"{again}"')))


@pytest.mark.long
@pytest.mark.parametrize("name", ["time_s", "te_um", "torque_nm", "Zeit [s]", "Drehzahl Antrieb [1/min]"])
def test_a_name_twice_is_asked_for_and_the_map_decides(tmp_path: Path, name: str) -> None:
    """Neither wins without a word; each is taken by its number, and named alike ones that mean nothing are no fault."""
    column = {"Zeit [s]": "time_s", "Drehzahl Antrieb [1/min]": "speed_rpm"}.get(name, name)
    first = RUN["torque_nm"]
    held = {**{one: RUN[one] for one in ("driving_angle_deg", "driven_angle_deg") if column != "te_um"}}
    if column == "te_um":
        held = {"driving_angle_deg": RUN["driving_angle_deg"]}
    columns, names = [first, *held.values(), first + 1.0, first, first], [name, *held, name, "Reserve", "Reserve"]
    file = written(tmp_path, table(columns, names, separator=",", decimal="."))
    last = len(held) + 2
    with pytest.raises(InputFileError, match=rf"is the name of columns 1 and {last}\b"):
        read_recording(file)
    for number, wanted in ((1, first), (last, first + 1.0)):
        recording = read_recording(file, chart=chart(tmp_path, f'columns.{column} = {{ from = "column {number}" }}'))
        read = {
            "time_s": recording.time_s,
            "te_um": None if recording.te_mm is None else 1e3 * recording.te_mm,
            "torque_nm": recording.torque_samples_nm,
            "speed_rpm": recording.speed_samples_rpm,
        }[column]
        same(read, wanted, half=0.5e-5)


def test_columns_are_numbered_as_in_the_file(tmp_path: Path) -> None:
    """A date that is one with the time of day beside it is a column too."""
    days = ["26.11.2026"] * 1200
    clock = [f"10:00:{t:06.3f}" for t in RUN["time_s"]]
    rows = [";".join(one) for one in zip(days, clock, *(map(str, RUN[k]) for k in list(RUN)[1:3]), strict=True)]
    file = written(tmp_path, "\n".join(["Datum;Uhrzeit;A;B", *rows]) + "\n")
    lines = BOTH.replace('"B"', '"column 3"').replace('"C"', '"column 4"')
    recording = read_recording(file, chart=chart(tmp_path, lines))
    same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=1e-12)
    same(recording.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=1e-12)


def test_the_speed_of_a_shaft_is_told_by_the_angles(tmp_path: Path) -> None:
    for rpm, taken_for in ((30.0, True), (30.0 * RATIO, False)):
        held = [RUN["time_s"], RUN["driving_angle_deg"], RUN["driven_angle_deg"], np.full(1200, rpm)]
        names = ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Drehzahl [1/min]")
        recording = read_recording(written(tmp_path, table(held, names)))
        assert (recording.speed_samples_rpm is not None) == taken_for


def test_columns_that_state_one_thing_twice_are_checked_in_any_unit(tmp_path: Path) -> None:
    """The transmission error in arcsec, to two places, beside both angles: taken where it is theirs, refused by row."""
    odd = run(1200, rpm=29.71234)  # at 30 rpm the angles are whole tenths, and count as rounded to them
    te = 3600.0 * np.degrees(40e-6 * np.sin(np.radians(odd["driving_angle_deg"])))
    for shift, good in ((0.0, True), (0.5, False)):
        held = [odd["driving_angle_deg"], odd["driven_angle_deg"], te + shift * (np.arange(1200) == 700)]
        text = table(held, ("A", "B", "E"), digits=[7, 7, 2])
        lines = """
        columns.driving_angle_deg = { from = "A", unit = "deg" }
        columns.driven_angle_deg = { from = "B", unit = "deg" }
        columns.te_urad = { from = "E", unit = "arcsec" }
        """
        recording = read_recording(written(tmp_path, text), chart=chart(tmp_path, lines))
        if good:
            clean(recording, ratio=RATIO)
        else:
            with pytest.raises(InputFileError, match="row 701"):
                clean(recording, ratio=RATIO)


def test_a_map_that_is_no_map(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="no such file"):
        read_map(tmp_path / "absent.toml")
    with pytest.raises(InputFileError, match="line 1"):
        chart(tmp_path, "columns = {")


PAGE = (ROOT / "docs" / "reference" / "recordings.md").read_text(encoding="utf-8")


def test_the_documented_map_is_one(tmp_path: Path) -> None:
    (example,) = re.findall(r"```toml\n(columns\..*?)```", PAGE, flags=re.DOTALL)
    held = chart(tmp_path, example)
    assert len(held.columns) == 4 and held.section == 2
    for key in (*TOP, *TEXT, *COLUMN):
        assert re.search(rf"\b{key}\b", PAGE[PAGE.index("### Maps") :]), key


def test_the_documented_units_are_those_that_are_known() -> None:
    for dimension, units in UNITS.items():
        if dimension != COUNT:
            assert f"| {dimension} | {', '.join(units)} |" in PAGE
