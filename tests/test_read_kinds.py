"""Exports of oscilloscopes, displays, controllers, robots and spreadsheets: right values, or a cure that works.

Every text is of the same run. Where a name does not say what a column is, the refusal's own lines are taken as the map,
with the scale that only the owner knows (10 V a turn).
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording, read_recordings
from gearpoly.recording.recording import Recording
from tests.made_texts import DEGREE, FloatArray, chart, run, written

TIME_S, DRIVING, DRIVEN, TORQUE = run(1200).values()
ROWS = range(1200)
VOLTS = DRIVING / 36.0, DRIVEN / 36.0
MAP_LINE = re.compile(r'(?:columns|keys|text)\.\w+ = (?:\{[^}]*\}|\[[^\]]*\]|"[^"]*"|\S+)')


def rows(form: str, *columns: FloatArray, decimal: str = ".") -> str:
    return "".join(form.format(*row).replace(".", decimal) + "\n" for row in zip(*columns, strict=True))


def counts(column: FloatArray, per: int) -> FloatArray:
    return np.floor(column / 360.0 * per)


def holds(read: Recording, *, time: float | None = 0.0, half: float = 1e-4, torque: bool = False) -> None:
    """Both angles to ``half`` a last place in deg, wrapped; the times from ``time`` on, if they are known."""
    assert read.driving_angle_rad is not None and read.driven_angle_rad is not None
    for angle, wanted in ((read.driving_angle_rad, DRIVING), (read.driven_angle_rad, DRIVEN)):
        apart = np.angle(np.exp(1j * (angle - wanted * DEGREE))) / DEGREE
        np.testing.assert_allclose(apart, 0.0, atol=half)
    if time is None:
        assert read.time_s is None
    else:
        assert read.time_s is not None
        np.testing.assert_allclose(read.time_s, TIME_S + time, atol=1e-6)
    assert (read.torque_samples_nm is not None) == torque
    if torque:
        np.testing.assert_allclose(read.torque_samples_nm, TORQUE, atol=1e-4)


def cured(file: Path, folder: Path, *changes: tuple[str, str]) -> Recording:
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    lines = "\n".join({one.partition(" = ")[0]: one for one in MAP_LINE.findall(caught.value.wish)}.values())
    for change in changes:
        assert change[0] in lines, caught.value.wish
        lines = lines.replace(*change)
    return read_recording(file, chart=chart(folder, lines))


ANGLES = "Time [s],Input angle [deg],Output angle [deg]\n"
PLAIN = {
    "amplifiers below the units": (
        "catman\r\nTime  1 - default rate\tWinkel Antrieb\tWinkel Abtrieb\tMoment Abtrieb\r\ns\t°\t°\tNm\r\n"
        "MX840B CH 1\tMX460B CH1\tMX460B CH2\tMX840B CH 2\r\n"
        + rows("{:.5f}\t{:.5f}\t{:.5f}\t{:.5f}", TIME_S, DRIVING, DRIVEN, TORQUE, decimal=",")
    ),
    "a remark below the units": (
        "Time\tInput angle\tOutput angle\tOutput torque\ns\tdeg\tdeg\tN.m\nComments\t\t\t\n"
        + rows("{:.4f}\t{:.5f}\t{:.5f}\t{:.5f}", TIME_S, DRIVING, DRIVEN, TORQUE)
    ),
    "names over merged cells": (
        "Zeit;Antrieb;;Abtrieb;\n;Winkel;Drehzahl;Winkel;Moment\ns;°;1/min;°;Nm\n"
        + rows("{:.4f};{:.5f};{:.1f};{:.5f};{:.5f}", TIME_S, DRIVING, 0.0 * TIME_S + 30.0, DRIVEN, TORQUE, decimal=",")
    ),
    "names over columns, repeated": (
        ",Input,Input,Output,Output\nTime (s),Angle (deg),Speed (rpm),Angle (deg),Torque (Nm)\n"
        + rows("{:.4f},{:.5f},{:.1f},{:.5f},{:.5f}", TIME_S, DRIVING, 0.0 * TIME_S + 30.0, DRIVEN, TORQUE)
    ),
}


@pytest.mark.parametrize("kind", PLAIN)
def test_names_in_several_lines(tmp_path: Path, kind: str) -> None:
    holds(read_recording(written(tmp_path, PLAIN[kind])), torque=True)


WRAPPED = {
    "formulas": (
        '="Time [s]",="Input angle [deg]",="Output angle [deg]"\n'
        + rows('="{:.4f}",="{:.5f}",="{:.5f}"', TIME_S, DRIVING, DRIVEN)
    ),
    "arrows": "".join(
        f"2026-02-03 10:15:{t:09.6f} -> angle_in deg:{a:.5f},angle_out deg:{b:.5f}\n"
        for t, a, b in zip(TIME_S, DRIVING, DRIVEN, strict=True)
    ),
    "lists": ANGLES + rows("[{:.4f}, {:.5f}, {:.5f}],", TIME_S, DRIVING, DRIVEN),
    "tuples": ANGLES + rows("({:.4f}, {:.5f}, {:.5f})", TIME_S, DRIVING, DRIVEN),
    "channels in rows": (
        "".join(
            f"{name};{';'.join(f'{one:.5f}' for one in column)}\n"
            for name, column in zip(ANGLES.strip().split(","), (TIME_S, DRIVING, DRIVEN), strict=True)
        )
    ),
    "per cent": (
        "Zeit [s];Winkel Antrieb [°];Winkel Abtrieb [°];Last\n"
        + rows("{:.4f};{:.5f};{:.5f};{:.1f}%", TIME_S, DRIVING, DRIVEN, TORQUE, decimal=",")
    ),
}


@pytest.mark.parametrize("kind", WRAPPED)
def test_what_programs_put_about_cells(tmp_path: Path, kind: str) -> None:
    read = read_recording(written(tmp_path, WRAPPED[kind]))
    holds(read, time=0.0)


@pytest.mark.long
def test_objects_of_json_and_stamps_in_brackets(tmp_path: Path) -> None:
    """Names are there, but no unit of the time."""
    objects = "".join(
        f'{{"t": {t:.3f}, "angle_in_deg": {a:.5f}, "angle_out_deg": {b:.5f}}}\n'
        for t, a, b in zip(TIME_S, DRIVING, DRIVEN, strict=True)
    )
    holds(cured(written(tmp_path, objects, name="log.json"), tmp_path))
    stamps = rows("[{:.3f}] in={:.5f} out={:.5f}", TIME_S, DRIVING, DRIVEN)
    holds(cured(written(tmp_path, stamps, name="log.txt"), tmp_path))


SCOPES = {
    "tektronix": (
        "Model,MSO44\n\nHorizontal Units,s\nSample Interval,0.01\nProbe Attenuation,1,1\nLabel,,\nTIME,CH1,CH2\n"
        + rows("{:.6e},{:.7f},{:.7f}", TIME_S, *VOLTS)
    ),
    "keysight": "x-axis,1,2\nsecond,Volt,Volt\n" + rows("{:+.6E},{:+.9E},{:+.9E}", TIME_S, *VOLTS),
    "rigol": (
        "X,CH1,CH2,Start,Increment\nSequence,Volt,Volt,-5.0e-01,1.0e-02\n"
        + "".join(f"{k},{a:.9e},{b:.9e},\n" for k, a, b in zip(ROWS, *VOLTS, strict=True))
    ),
    "siglent": (
        "Record Length,Analog:1200\nSample Interval,1.0e-02\nVertical Units,CH1:V CH2:V\nSource,CH1,CH2\n"
        "Second,Volt,Volt\n" + rows("{:.7f},{:.7f},{:.7f}", TIME_S, *VOLTS)
    ),
    "picoscope": "Time,Channel A,Channel B\n(ms),(V),(V)\n\n" + rows("{:.8f},{:.8f},{:.8f}", TIME_S * 1e3, *VOLTS),
}


@pytest.mark.parametrize("kind", SCOPES)
def test_traces_of_oscilloscopes(tmp_path: Path, kind: str) -> None:
    """Angles as voltages that begin again at 10 V: the refusal offers both channels as turns of 10 V, to be taken as
    they stand, and its times are seconds, not numbers of samples."""
    holds(cured(written(tmp_path, SCOPES[kind]), tmp_path), time=-0.5 if kind == "rigol" else 0.0)


def test_numbers_of_samples_are_offered_as_no_time(tmp_path: Path) -> None:
    text = "".join(f"{k} {a:.5f} {b:.5f}\n" for k, a, b in zip(ROWS, DRIVING, DRIVEN, strict=True))
    holds(cured(written(tmp_path, text, name="a.txt"), tmp_path), time=None)


def test_times_are_offered_as_no_angle(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="want the readings of both shafts"):
        read_recording(written(tmp_path, "Time,Ampl\n" + rows("{:.4f},{:.6f}", TIME_S, DRIVING)))


@pytest.mark.parametrize("form", ["{:d}", "0x{:04X}"])
def test_counts_that_go_round_at_a_width_are_asked_for_their_lines(tmp_path: Path, form: str) -> None:
    """65536 may be a turn, or the width of the counter. An angle in deg that begins again there would be one that
    trembles by 16 deg."""
    held = [counts(one, 2**16) for one in (DRIVING, DRIVEN)]
    text = "time_ms,in,out\n" + "".join(
        f"{10 * k},{form.format(int(a))},{form.format(int(b))}\n" for k, a, b in zip(ROWS, *held, strict=True)
    )
    file = written(tmp_path, text)
    holds(cured(file, tmp_path, ('"those on its label"', "16384")), half=360.0 / 2**16 * 1.01)
    lines = "\n".join(f'columns.{c} = {{ from = "{n}", unit = "deg" }}' for c, n in
                      (("driving_angle_deg", "in"), ("driven_angle_deg", "out")))  # fmt: skip
    with pytest.raises(InputFileError, match="counts that begin again after 65536") as caught:
        read_recording(file, chart=chart(tmp_path, lines))
    assert "wraps = 65536" in caught.value.wish


def test_a_trace_of_a_controller_with_pairs_of_keys_and_values(tmp_path: Path) -> None:
    """Each channel has a time of its own, in a column without a name; its unit is asked for."""
    head = (
        "Name\tFilter\nFile\tC:\\scope\n\n\t\t\t\nName\tAxis1.ActPos\tName\tAxis2.ActPos\nData-Type\tREAL64\tData-Type"
        "\tREAL64\nSampleTime[ms]\t10\tSampleTime[ms]\t10\nUnit\t°\tUnit\t°\n\n"
    )
    text = head + "".join(
        f"{10 * k}\t{a:.5f}\t{10 * k}\t{b:.5f}\n" for k, a, b in zip(ROWS, DRIVING, DRIVEN, strict=True)
    )
    holds(cured(written(tmp_path, text), tmp_path))


def test_joints_of_a_robot_between_words(tmp_path: Path) -> None:
    """Names of joints are words, and speeds are beside positions: the positions are offered."""
    turned = [np.unwrap(one * DEGREE) for one in (DRIVING, DRIVEN)]
    head = "%time,field.header.seq,field.header.frame_id,field.name0,field.position0,field.position1,field.velocity0\n"
    text = head + "".join(
        f"{1770000000000000000 + 10_000_000 * k},{k},base,motor,{a:.8f},{b:.8f},3.14\n"
        for k, a, b in zip(ROWS, *turned, strict=True)
    )
    file = written(tmp_path, text)
    read = cured(file, tmp_path, ('"field.position0", unit = "deg"', '"field.position0", unit = "rad"'),
                 ('"field.position1", unit = "deg"', '"field.position1", unit = "rad"'))  # fmt: skip
    assert read.time_s is not None
    np.testing.assert_allclose(read.time_s - read.time_s[0], TIME_S, atol=1e-6)
    assert read.driving_angle_rad is not None
    np.testing.assert_allclose(read.driving_angle_rad, turned[0], atol=1e-7)


@pytest.mark.parametrize(
    ("names", "encoding"),
    [
        (("Czas [s]", "Kąt wejściowy [°]", "Kąt wyjściowy [°]"), "cp1250"),
        (("Čas [s]", "Vstupní úhel [°]", "Výstupní úhel [°]"), "utf-8"),
        (("Idő [s]", "Bemenő szög [°]", "Kimenő szög [°]"), "cp1250"),
        (("時間(s)", "入力軸角度(deg)", "出力軸角度(deg)"), "utf-8-sig"),
        (("时间[s]", "输入角度[°]", "输出角度[°]"), "gb18030"),
    ],
)
def test_the_time_is_told_by_its_unit_in_any_language(tmp_path: Path, names: tuple[str, ...], encoding: str) -> None:
    """It was left out with a remark where its name was no word that is known."""
    text = ";".join(names) + "\n" + rows("{:.4f};{:.5f};{:.5f}", TIME_S, DRIVING, DRIVEN, decimal=",")
    holds(cured(written(tmp_path, text, encoding=encoding), tmp_path))


def test_a_star_s_places_are_no_angles_of_shafts(tmp_path: Path) -> None:
    text = "date,time,ra_arcsec,dec_arcsec\n" + "".join(
        f"2026-03-10,20:{k // 60:02d}:{k % 60:02d}.5,{a:.4f},0.1\n"
        for k, a in zip(range(600), DRIVING[:600], strict=True)
    )
    with pytest.raises(InputFileError, match="error of a telescope's axis") as caught:
        read_recording(written(tmp_path, text))
    assert 'columns.axis_error_arcsec = { from = "ra_arcsec", unit = "arcsec", sign = 1 }' in caught.value.wish
    assert "dec_arcsec" not in caught.value.wish


@pytest.mark.parametrize(
    ("head", "what", "cure"),
    [
        (b"|CF,2,1,1;|CK,1,3,1,1;\r\n", "imc FAMOS", "exported from FAMOS as ASCII"),
        (b"#BEGINCHANNELHEADER\n200,Zeit\n", "DIAdem", "saved from DIAdem as TDMS"),
        (b"TDSh\x0e\0\0\0", "index beside a TDMS file", "the .tdms file"),
        (b"HEADER KS.MK.FILE\r\n", "Klingelnberg", "gearpoly pair --from"),
    ],
)
def test_files_of_other_programs_are_called_by_their_names(tmp_path: Path, head: bytes, what: str, cure: str) -> None:
    file = tmp_path / "data.dat"
    file.write_bytes(head + bytes(range(256)) * 4)
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    assert what in caught.value.found and cure in caught.value.wish


def with_colons(angle: float) -> str:
    """Degrees, minutes and seconds of arc, rounded to a thousandth of these."""
    whole = round(angle * 3_600_000.0)
    return f"{whole // 3_600_000}:{whole // 60_000 % 60:02d}:{whole % 60_000 / 1000.0:06.3f}"


def test_angles_in_minutes_and_seconds_with_colons_are_degrees(tmp_path: Path) -> None:
    """More than a day has hours, so no times of day."""
    columns = zip(TIME_S, DRIVING, DRIVEN, strict=True)
    text = "".join(f"{t:.3f},{with_colons(a)},{with_colons(b)}\n" for t, a, b in columns)
    found = read_recording(written(tmp_path, ANGLES + text))
    assert sum("degrees with minutes, taken as decimal degrees" in one for one in found.remarks) == 2
    holds(found, half=0.5e-3 / 3600.0 * 1.01)


def test_degrees_with_colons_below_a_day_s_hours_are_those_of_columns_that_name_an_angle(tmp_path: Path) -> None:
    """They were taken for seconds, and the map that was offered made 72 000 degrees of 20."""
    slow = np.linspace(0.0, 20.0, TIME_S.size)
    rows = [f"{t:.3f},{with_colons(a)},{with_colons(0.72 * a)}" for t, a in zip(TIME_S, slow, strict=True)]
    read = read_recording(written(tmp_path, "\n".join(("t [s],Input angle,Output angle", *rows)) + "\n"))
    assert read.driving_angle_rad is not None
    assert read.driven_angle_rad is not None
    assert np.ptp(read.driving_angle_rad) == pytest.approx(20.0 * DEGREE, abs=1e-8)
    assert np.ptp(read.driven_angle_rad) == pytest.approx(14.4 * DEGREE, abs=1e-8)


def test_a_torn_angle_among_degrees_with_colons_is_told_where_it_stands(tmp_path: Path) -> None:
    columns = zip(TIME_S, DRIVING, DRIVEN, strict=True)
    rows = [f"{t:.3f},{with_colons(a)},{with_colons(b)}" for t, a, b in columns]
    rows[700] = f"{TIME_S[700]:.3f},12?34:56.000,{with_colons(DRIVEN[700])}"
    with pytest.raises(InputFileError, match=r'line 702, column Input angle: "12\?34:56.000"; want a finite number'):
        read_recording(written(tmp_path, "\n".join(("t [s],Input angle,Output angle", *rows)) + "\n"))


def test_two_tables_of_labview_are_two_recordings(tmp_path: Path) -> None:
    head = (
        "Channels\t2\nSamples\t1200\t1200\nY_Unit_Label\tdeg\tdeg\nX_Dimension\tTime\tTime\nX0\t0,0\t0,0\n"
        "Delta_X\t0,01\t0,01\n***End_of_Header***\nX_Value\tAngle in\tAngle out\tComment\n"
    )
    table = head + rows("{:.6f}\t{:.6f}\t{:.6f}\t", TIME_S, DRIVING, DRIVEN, decimal=",")
    text = "LabVIEW Measurement\nDecimal_Separator\t,\n***End_of_Header***\n\n" + table + "\n" + table
    both = read_recordings(written(tmp_path, text, name="run.lvm"))
    assert len(both) == 2
    for one in both:
        holds(one)
