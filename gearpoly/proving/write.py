"""Cases of a ground written with their truths apart, and sealed."""

from __future__ import annotations

import hashlib
from pathlib import Path

from gearpoly.proving.grounds import BENCH, GROUNDS
from gearpoly.proving.rig import BenchError


def write_case(
    seed: int, index: int, folder: Path, *, truths: Path | None = None, quick: bool = False, ground: str = BENCH
) -> str:
    """Write NAME/pair.toml and NAME/rec_K.csv under folder, NAME.truth.json under truths (default: folder).

    Returns the sha256 of the truth file's bytes. The truth comes last, and whole: where it is, the case is. Raises
    ``BenchError`` with the names of case and seed where the bench fails."""
    entry = GROUNDS[ground].plan(seed, quick=quick)[index]
    try:
        case = GROUNDS[ground].make(seed, entry)
        sealed = case.truth_text().encode()
        files = [(path, text.encode()) for path, text in case.files()]
    except BenchError as error:
        which = f"{entry.name} of the {ground} ground of seed {seed}{', quick' if quick else ''}"
        raise BenchError(f"{which}: {error}") from error
    apart = folder if truths is None else truths
    apart.mkdir(parents=True, exist_ok=True)
    place = folder / entry.name
    place.mkdir(parents=True, exist_ok=True)
    for path, data in files:
        (place / path).write_bytes(data)
    aside = apart / f"{entry.name}.truth.json.part"
    aside.write_bytes(sealed)
    aside.replace(apart / f"{entry.name}.truth.json")
    return hashlib.sha256(sealed).hexdigest()


def seal(hashes: dict[str, str]) -> str:
    """One hash over all truths of a ground: sha256 of the lines "name hash", sorted by name."""
    lines = "".join(f"{name} {hashes[name]}\n" for name in sorted(hashes))
    return hashlib.sha256(lines.encode()).hexdigest()
