"""Guide logs with several sections, other stars, pauses and other spellings; and what cannot be used, with its cure."""

from __future__ import annotations

import codecs
import math
import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.units import ARCSEC, FloatArray
from tests.made_command import Command
from tests.made_guide_log import ANGLE, EQ6, SCALE, made_log

CALIBRATION = "Calibration Begins at 2026-03-10 20:00:00\nDirection,Step,dx,dy,x,y,Dist\nWest,0,0,0,1,2,0\n"


def read(folder: Path, text: str, *, part: str = "") -> Recording:
    log = folder / "log.txt"
    log.write_text(text, encoding="utf-8")
    return read_recording(f"{log}{part}", worm=EQ6)


def axis_arcsec(recording: Recording) -> FloatArray:
    assert recording.te_rad is not None
    return recording.te_rad / ARCSEC / 180


def check_error(recording: Recording, error: FloatArray, *, within: float = 0.01) -> None:
    """The error of the axis in arcsec, but for a constant: lock positions and offsets are written to 0.001 px."""
    found = axis_arcsec(recording)
    held = np.isfinite(found)
    difference = (found - error)[held]
    assert np.ptp(difference) < 2.0 * within


def test_every_section_is_a_recording_of_its_own(tmp_path: Path) -> None:
    """By its number, the longest otherwise; a section with a fault is told and does not keep the others from use."""
    parts = [made_log(frames=n)[0] for n in (120, 300, 200)]
    bad = made_log(frames=400)[0].replace('"Mount"', '"AO"')
    tiny = made_log(frames=20)[0]
    text = "PHD2 version 2.6.8, Log version 2.5\n" + CALIBRATION + "".join([*parts, bad, tiny])
    longest = read(tmp_path, text)
    assert longest.size == 300
    said = "\n".join(longest.remarks)
    assert "5 guiding sections and 1 calibration; section 2 was read" in said
    assert "log.txt#1 (4 min), log.txt#3 (7 min)" in said
    assert "section 4 cannot be used" in said and "AO" in said
    assert "section 5 cannot be used" in said and "20 frames" in said
    for number, frames in ((1, 120), (2, 300), (3, 200)):
        assert read(tmp_path, text, part=f"#{number}").size == frames
    for number, says in ((4, "adaptive optics"), (5, "20 frames"), (6, "from 1 to 5")):
        with pytest.raises(InputFileError, match=says):
            read(tmp_path, text, part=f"#{number}")


@pytest.mark.parametrize(
    ("encoding", "mark"),
    [
        ("utf-8", codecs.BOM_UTF8),
        ("utf-16-le", codecs.BOM_UTF16_LE),
        ("utf-16-be", codecs.BOM_UTF16_BE),
        ("utf-16-le", b""),
        ("utf-16-be", b""),
        ("utf-32-le", codecs.BOM_UTF32_LE),
        ("cp1252", b""),
    ],
)
def test_a_log_is_read_in_every_encoding(tmp_path: Path, encoding: str, mark: bytes) -> None:
    """With a byte order mark, and without one where the zero bytes are certain: the same numbers, bit by bit."""
    text = "PHD2 version 2.6.8, Log version 2.5\nEquipment Profile = K\u00f6ln\n" + made_log()[0]
    plain = read(tmp_path, text)
    log = tmp_path / "wide.txt"
    log.write_bytes(mark + text.replace("\n", "\r\n").encode(encoding))
    found = read_recording(log, worm=EQ6)
    assert found.time_s is not None and plain.time_s is not None
    assert np.array_equal(found.time_s, plain.time_s)
    assert np.array_equal(axis_arcsec(found), axis_arcsec(plain), equal_nan=True)
    assert found.remarks == plain.remarks


def test_sections_do_not_stand_beside_one_another(tmp_path: Path, gearpoly_command: Command, pair_file: Path) -> None:
    """Each begins at an angle of its own, so that teeth and means of both compare with nothing."""
    log = tmp_path / "log.txt"
    log.write_text(made_log(frames=200)[0] + made_log(frames=300)[0], encoding="utf-8")
    with pair_file.open("a", encoding="utf-8") as stream:
        stream.write("\n[worm]\nwheel_teeth = 180\n")
    ran = gearpoly_command("compare", pair_file, f"{log}#1", f"{log}#2")
    assert ran.code == 2
    assert "want it alone" in ran.err and "log.txt#1" in ran.err


def test_a_file_of_one_recording_has_no_parts(tmp_path: Path, gearpoly_command: Command, pair_file: Path) -> None:
    plain = tmp_path / "made.csv"
    plain.write_text("driving_angle_deg,driven_angle_deg\n0,0\n1,1\n", encoding="utf-8")
    with pytest.raises(InputFileError, match=r"want made\.csv without #2"):
        read_recording(f"{plain}#2")
    # A file of that very name is read as it is.
    plain.rename(tmp_path / "made.csv#2")
    assert read_recording(tmp_path / "made.csv#2").size == 2
    log = tmp_path / "log.txt"
    log.write_text(made_log()[0], encoding="utf-8")
    ran = gearpoly_command("compare", pair_file, f"{log}#1", "--json", log)
    assert ran.code == 2
    assert log.read_text(encoding="utf-8") == made_log()[0]


def test_another_star_moves_the_lock_position_and_not_the_error(tmp_path: Path) -> None:
    """A star 200 px away is taken in the middle: lock position and star go there together."""
    text, _, error = made_log(dithered=(-1, 0.0))
    rows = text.splitlines(keepends=True)
    middle = next(k for k, row in enumerate(rows) if row.startswith("200,"))
    rows.insert(middle, "INFO: SET LOCK POSITION, new lock pos = 450.000, 360.000\n")
    found = read(tmp_path, "".join(rows))
    check_error(found, error)
    assert "1 time another star was taken, which stands where the first would" in found.remarks


def test_a_re_aiming_of_unknown_size_leaves_no_step(tmp_path: Path) -> None:
    """The lock position is said to move by 4 px and the star moves by 40, as after a recentring that no log tells."""
    text, _, error = made_log(dithered=(150, 4.0), lost=-1)

    def moved(row: re.Match[str]) -> str:
        if int(row[1]) <= 150:
            return row[0]
        x, y, offset = (float(one) for one in row[3].split(","))
        along = 40.0 * math.cos(math.radians(ANGLE)), 40.0 * math.sin(math.radians(ANGLE))
        return f'{row[1]},{row[2]},"Mount",{x + along[0]:.4f},{y + along[1]:.4f},{offset + 40.0:.4f},'

    text = re.sub(r'^(\d+),([\d.]+),"Mount",([-\d.]+,[-\d.]+,[-\d.]+),', moved, text, flags=re.MULTILINE)
    found = read(tmp_path, text)
    # The middle of three frames on either side stands for the place of the step: 0.4 arcsec of mesh goes through.
    check_error(found, error, within=2.0)
    assert any("of another size than the log says" in one for one in found.remarks)


def test_frames_tell_the_camera_s_angle_where_the_header_errs(tmp_path: Path) -> None:
    """Old logs have it in rad, some have none: the offsets along both camera axes give it."""
    text, _, error = made_log()
    for angle in (f"xAngle = {math.radians(ANGLE):.3f}", "xAngle = Unknown"):
        check_error(read(tmp_path, text.replace(f"xAngle = {ANGLE}", angle)), error)


def test_decimal_commas_are_read_as_points(tmp_path: Path) -> None:
    """A computer set to decimal commas writes 2,100 for 2.100 into cells that commas part."""
    text, _, _ = made_log()
    plain = read(tmp_path, text)
    found = read(tmp_path, re.sub(r"(?<=\d)\.(?=\d)", ",", text))
    np.testing.assert_array_equal(axis_arcsec(found), axis_arcsec(plain))
    assert any("decimal commas" in one for one in found.remarks)


def test_offsets_in_arcsec_are_told_by_those_in_pixels(tmp_path: Path) -> None:
    """KStars writes PHD2's log with distances along the right ascension in arcsec."""
    text, _, error = made_log()

    def scaled(row: re.Match[str]) -> str:
        return f"{row[1]}{float(row[2]) * SCALE:.4f},"

    text = re.sub(r'^(\d+,[\d.]+,"Mount",[-\d.]+,[-\d.]+,)([-\d.]+),', scaled, text, flags=re.MULTILINE)
    found = read(tmp_path, "KStars version 3.4.3. PHD2 log version 2.5.\n" + text)
    check_error(found, error)
    assert any("in arcsec in this log" in one for one in found.remarks)


def test_frames_with_an_error_show_no_star(tmp_path: Path) -> None:
    """Old logs write a lost star as a frame of zeros with its error; a saturated star (error 1) is one."""
    text, _, _ = made_log(lost=-1)
    text = (
        text.replace("DECDuration\n", "DECDuration,ErrorCode\n")
        .replace(",W,0\n", ",W,0,0\n")
        .replace(",E,0\n", ",E,0,1\n")
    )
    row = next(one for one in text.splitlines() if one.startswith("77,"))
    time = row.split(",")[1]
    text = text.replace(row, f'77,{time},"Mount",0,0,0,0,0,0,0,,0,2')
    found = axis_arcsec(read(tmp_path, text))
    assert np.flatnonzero(np.isnan(found)).tolist() == [76]


def test_pauses_and_shifts_are_told(tmp_path: Path) -> None:
    text, _, error = made_log()
    at = text.index("\n200,") + 1
    words = (
        "INFO: Server received PAUSE\nINFO: Server received RESUME\nINFO: LOCK SHIFT, enabled = 1 RA,Dec rate (1,2)\n"
    )
    found = read(tmp_path, text[:at] + words + text[at:])
    check_error(found, error)
    said = "\n".join(found.remarks)
    assert "guiding was paused 1 time;" in said
    assert "LOCK SHIFT" in said


def test_a_log_without_pulses_needs_no_guide_rate(tmp_path: Path) -> None:
    """Unguided, as the guiding assistant has it: the star alone shows the error."""
    text, _, _ = made_log(frames=100, dithered=(-1, 0.0), lost=-1)
    unguided = re.sub(r",\d+,[WE],0$", ",0,,0", text, flags=re.MULTILINE).replace("xRate = 2.4", "xRate = ?")
    assert any("no pulses were sent" in one for one in read(tmp_path, unguided).remarks)


@pytest.mark.parametrize(
    ("change", "says", "cure"),
    [
        (
            ("Pixel scale = 3.2 arc-sec/px", "Pixel scale = unspecified"),
            "no Pixel scale",
            "Pixel scale = 3.2 arc-sec/px",
        ),
        ((", Dec = 12.0 deg", ", Dec = Unknown"), "does not state the declination", "Dec = 12.0 deg"),
    ],
)
def test_the_cure_of_a_header_works(tmp_path: Path, change: tuple[str, str], says: str, cure: str) -> None:
    """The line that a message asks for, written below the section's first, makes the log as good as the whole one."""
    whole = axis_arcsec(read(tmp_path, made_log()[0]))
    text = made_log()[0].replace(*change)
    try:
        said = "\n".join(read(tmp_path, text).remarks)
    except InputFileError as error:
        said = str(error)
    assert says in said
    first, rest = text.split("\n", 1)
    np.testing.assert_array_equal(axis_arcsec(read(tmp_path, f"{first}\n{cure}\n{rest}")), whole)


def test_a_clock_set_back_spoils_its_section_alone(tmp_path: Path) -> None:
    good, _, _ = made_log(frames=100)
    bad, _, _ = made_log(frames=300)
    row = next(one for one in bad.splitlines() if one.startswith("200,"))
    bad = bad.replace(row, row.replace(row.split(",")[1], "5.000", 1))
    found = read(tmp_path, good + bad)
    assert found.size == 100
    assert any("section 2 cannot be used" in one and "Time = 5 after" in one for one in found.remarks)


@pytest.mark.parametrize(("mark", "told"), [(";", "semicolons"), ("\t", "tabs")])
def test_a_log_that_a_spreadsheet_saved_again_is_told_so(tmp_path: Path, mark: str, told: str) -> None:
    """It was said to hold no frames."""
    text, _, _ = made_log()
    lines = [
        line.replace(",", mark) if line[:5] == "Frame" or line[:1].isdigit() else line for line in text.split("\n")
    ]
    log = tmp_path / "log.txt"
    log.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(InputFileError, match=f"columns parted by {told}.*a spreadsheet saved this one again"):
        read_recording(log, worm=EQ6)
