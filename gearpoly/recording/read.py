"""The way in for every recording: the format is found from the file's ending and its first bytes."""

from __future__ import annotations

import functools
import importlib
import pkgutil
from pathlib import Path

from gearpoly import recording as package
from gearpoly.errors import InputFileError
from gearpoly.files.paths import parted
from gearpoly.files.traces import check_file, unreadable
from gearpoly.keys.sections import WormSection
from gearpoly.recording.apart import read_apart
from gearpoly.recording.reader import RECORDING_LIMIT_BYTES, Reader, recording_from_table
from gearpoly.recording.recording import Recording

HEAD_BYTES = 4096
"""How much of a file is looked at to tell its format; HDF5 may begin as far in as 2048."""


@functools.cache
def readers() -> tuple[Reader, ...]:
    """Every reader of this package, found by its module's name; the fallback stands last."""
    names = [info.name for info in pkgutil.iter_modules(package.__path__) if info.name.endswith("_reader")]
    found = [importlib.import_module(f"{package.__name__}.{name}").READER for name in sorted(names)]
    return tuple(sorted(found, key=lambda reader: reader.fallback))


def read_recording(path: Path | str, *, worm: WormSection | None = None) -> Recording:
    """Read one recording of any format; a guide log through the ``worm`` of the pair file. ``FILE#2`` is the second
    recording of a file that holds several.

    Units and signs are those of :class:`Recording`. Raises ``InputFileError`` (file, place, cure) where the file is no
    recording, and ``MissingExtraError`` where its format needs a package that is not installed.
    """
    file, part = parted(Path(path))
    reader = find_reader(file)
    if part is not None:
        if not reader.parts:
            wish = f"want {file.name} without #{part}: a {reader.name} file holds one recording"
            raise InputFileError(path, found=f"part {part} asked for", wish=wish)
        table = reader.read(file, part)
    else:
        table = read_apart(reader, file) if reader.apart else reader.read(file)
    return recording_from_table(Path(path), table, worm=worm)


def find_reader(file: Path) -> Reader:
    """The reader whose ending and first bytes both fit; an ending that nobody claims leaves it to the bytes."""
    check_file(file, limit_bytes=RECORDING_LIMIT_BYTES)
    if not file.is_file():
        raise InputFileError(file, found="no ordinary file", wish="want a file on a disk")
    try:
        with file.open("rb") as stream:
            head = stream.read(HEAD_BYTES)
    except OSError as error:
        raise unreadable(file, error) from None
    known = ", ".join(reader.name for reader in readers())
    if not head:
        raise InputFileError(file, found="an empty file", wish=f"want a recording ({known})")
    ending = file.suffix.lower()
    by_ending = [reader for reader in readers() if ending in reader.endings]
    by_content = [reader for reader in readers() if reader.recognises(head)]
    for reader in by_ending:
        if reader in by_content and (not reader.fallback or by_content[0] is reader):
            return reader
    if by_ending:
        wanted = " or ".join(reader.name for reader in by_ending)
        if not by_content:
            wish = f"want a {wanted} file; check the name, or export it again"
            raise InputFileError(file, found=f"no {wanted} file, for all its ending {ending}", wish=wish)
        inside = by_content[0]
        kind = "text" if inside.fallback else f"a {inside.name} file"
        wish = f"want a {wanted} file, or the ending {inside.endings[0]} if it is {inside.name}"
        raise InputFileError(file, found=f"{kind}, for all its ending {ending}", wish=wish)
    if by_content:
        return by_content[0]
    raise InputFileError(file, found="a format that is not known", wish=f"want a recording ({known})")
