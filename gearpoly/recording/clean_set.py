"""All recordings of a set made ready for comparison; runs that are too short at speed are left out, with a word."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from gearpoly.recording.clean import Cleaned, TooShortError, clean
from gearpoly.recording.recording import Recording


def clean_set(recordings: Sequence[Recording], *, ratio: float, r_b2: float) -> list[Cleaned]:
    """Every recording as :func:`clean` has it. Of a file that turned forth and back some runs may be too short once
    their ramps are cut: they are left out while one stays.

    Raises what ``clean`` does.
    """
    out: list[Cleaned] = []
    short: list[tuple[Recording, TooShortError]] = []
    for recording in recordings:
        try:
            out.append(clean(recording, ratio=ratio, r_b2=r_b2))
        except TooShortError as error:
            if recording.run is None:
                raise
            short.append((recording, error))
    for recording, refused in short:
        kept = next((k for k, one in enumerate(out) if _one_file(one.recording, recording)), None)
        if kept is None:
            raise refused
        held = out[kept].recording
        said = f"{recording.source.name} left out, with {refused.found}"
        out[kept] = replace(out[kept], recording=replace(held, remarks=(*held.remarks, said)))
    return out


def _one_file(one: Recording, other: Recording) -> bool:
    return one.run is not None and other.run is not None and one.run.file == other.run.file
