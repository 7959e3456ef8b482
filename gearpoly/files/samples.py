"""The sample data that come with gearpoly: pair files, recordings with their truths, sheets, studies."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

from gearpoly.arguments import check_file
from gearpoly.errors import InputFileError
from gearpoly.files.paths import is_folder, look

PACKAGE = Path(__file__).resolve().parents[1]

SAMPLE_FOLDERS = (PACKAGE / "samples", PACKAGE.parent / "data")
"""Where the data stand: within an installed package, or beside it in a clone."""


def samples() -> Path:
    """The folder of the sample data, to read from.

    Raises ``InputFileError`` where this installation has none.
    """
    for place in SAMPLE_FOLDERS:
        if is_folder(place / "recordings"):
            return place
    raise InputFileError(PACKAGE, found="no sample data here", wish="install a wheel of gearpoly, or work in a clone")


def copy_samples(target: Path | str) -> Path:
    """Copy the sample data to the folder ``target``, which must not be there yet: whole, or not at all.

    Raises ``InputFileError`` where ``target`` is there or cannot be written.
    """
    check_file("target", target)
    target = Path(target)
    source = samples()
    if look(target) is not None:
        raise InputFileError(target, found="it is there already", wish="want the name of a new folder")
    if not is_folder(target.parent):
        wish = "make it, or write somewhere else"
        raise InputFileError(target, found=f"there is no folder {target.parent}", wish=wish)
    try:
        aside = Path(tempfile.mkdtemp(dir=target.parent, prefix=".gearpoly-"))
        try:
            shutil.copytree(source, aside / "data")
            os.rename(aside / "data", target)
        finally:
            shutil.rmtree(aside, ignore_errors=True)
    except OSError as error:
        wish = "could not be written; check space and rights"
        raise InputFileError(target, found=error.strerror or str(error), wish=wish) from None
    return target
