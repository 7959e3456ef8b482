"""Files that owners have and no reader takes: what they are by their first bytes, and what makes recordings of them."""

from __future__ import annotations

import struct

EXPORT = "want it exported as CSV, MAT, HDF5, Parquet or TDMS by a program that reads it"
SPREADSHEET_CURE = "want the sheet saved as CSV in the spreadsheet program"
UNPACK = "want it unpacked first, with the program that packed it"

BEGINNINGS: tuple[tuple[bytes, str, str], ...] = (
    (b"\x1f\x8b", "packed by gzip", UNPACK),
    (b"BZh", "packed by bzip2", UNPACK),
    (b"\xfd7zXZ\0", "packed by xz", UNPACK),
    (b"\x28\xb5\x2f\xfd", "packed by Zstandard", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "packed by 7-Zip", UNPACK),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an Excel workbook (or another document of Office)", SPREADSHEET_CURE),
    (b"\x93NUMPY", "an array of NumPy", EXPORT),
    (b"MDF     ", "an MDF file", EXPORT),
    (b"RIFF", "a sound file", EXPORT),
    (b"SQLite format 3\0", "an SQLite database", EXPORT),
    (b"#ROSBAG", "a ROS bag", EXPORT),
    (b"ARROW1", "an Arrow (Feather) file", EXPORT),
    (b"CDF\x01", "a netCDF 3 file", EXPORT),
    (b"CDF\x02", "a netCDF 3 file", EXPORT),
    (b"%PDF", "a PDF document", EXPORT),
    (b"|CF,", "an imc FAMOS file", "want it exported from FAMOS as ASCII, MATLAB or TDMS"),
    (b"|CK,", "an imc FAMOS file", "want it exported from FAMOS as ASCII, MATLAB or TDMS"),
    (b"#BEGINCHANNELHEADER", "the header of a DIAdem file", "want it saved from DIAdem as TDMS"),
    (b"DIADEM DATA FILE", "the header of a DIAdem file", "want it saved from DIAdem as TDMS"),
    (b"TDSh", "the index beside a TDMS file", "want the .tdms file of the same name, not its .tdms_index"),
    (b"WAVEDESC", "a trace of a LeCroy oscilloscope", EXPORT),
    (b":CURV", "a trace of a Tektronix oscilloscope", EXPORT),
    (b":WFM", "a trace of a Tektronix oscilloscope", EXPORT),
    (b"\x89MCAP", "a log of a robot (MCAP)", EXPORT),
    (b"\xd4\xc3\xb2\xa1", "a capture of a network", EXPORT),
    (b"\x0a\x0d\x0d\x0a", "a capture of a network", EXPORT),
    (b"HEADER KS.M", "an inspection by Klingelnberg, no recording", "want it given to gearpoly pair --from"),
    (b"<?xml", "an XML document", EXPORT),
)
"""How files begin, what they are, and the cure."""

ZIPPED: tuple[tuple[bytes, str, str], ...] = (
    (b"opendocument.spreadsheet", "a spreadsheet (ods)", SPREADSHEET_CURE),
    (b"[Content_Types].xml", "an Excel workbook", SPREADSHEET_CURE),
    (b".npy", "arrays of NumPy (npz)", EXPORT),
    (b"", "a zip archive", UNPACK),
)
"""The same of what lies in a zip archive, by a name near its beginning."""

MAT_4_TYPES = {0, 10, 20, 30, 40, 50, 1, 2, 51, 52, 1000, 1010, 1020, 1030, 1040, 1050}
"""First numbers of MAT 4 files: byte order, precision and kind of the first variable."""


BLANK = b"\xef\xbb\xbf \t\r\n"
"""What may stand before the first sign of XML."""

LONGEST_NAME = 64
"""Characters of a variable's name in MATLAB, and its end."""


def known_elsewhere(head: bytes) -> tuple[str, str] | None:
    """What a file with these first bytes is and what would do in its place; ``None`` where nobody knows."""
    if head.lstrip(BLANK).startswith(b"<") and (b"<gear_data_exchange" in head or b"<model" in head):
        what = "an inspection as XML" if b"<gear_data_exchange" in head else "a design (REXS)"
        return f"{what}, no recording", "want it given to gearpoly pair --from"
    if head.startswith(b"PK\x03\x04"):
        return next((what, cure) for mark, what, cure in ZIPPED if mark in head)
    if _is_mat_4(head):
        return "a MAT 4 file", "want it saved again in MATLAB: load it, then save with -v7"
    return next(((what, cure) for begin, what, cure in BEGINNINGS if head.startswith(begin)), None)


def _is_mat_4(head: bytes) -> bool:
    """Whether a file begins with the header of a variable in MAT 4: kind, rows, columns, complex or not, and the length
    of its name, which ends in a zero byte."""
    if len(head) < 24:
        return False
    for order in "<>":
        kind, rows, columns, imaginary, length = struct.unpack(order + "5i", head[:20])
        name = head[20 : 19 + length].replace(b"_", b"")
        ends = 2 <= length <= LONGEST_NAME and head[19 + length : 20 + length] == b"\0" and name.isalnum()
        if kind in MAT_4_TYPES and min(rows, columns) > 0 and imaginary in (0, 1) and ends:
            return True
    return False
