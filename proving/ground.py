"""The proving ground: from a seed alone, the list of concealed cases, and each case written with its truth apart.

A case depends on (seed, index) only, so any number of workers in any order writes the same bytes."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from proving.effects import CATALOGUE

SIZES_OVER_LIMIT = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 8.5, 10.0, 14.0, 20.0, 30.0)
"""From half to thirty times the theoretical limit; each case moves its own by up to 12 %."""

COUNTS = {
    "healthy": 80, "single": 110, "two": 24, "masked": 30, "one_flank": 12, "look_alike": 24, "stranger": 24, "short":
    16,
    "false_alarm": 120,
}  # fmt: skip
"""Cases of the full ground by class. The first eight are the mix (a quarter healthy); the last brings the healthy
ones to 200."""

QUICK = {
    "healthy": 6, "single": 8, "two": 2, "masked": 3, "one_flank": 1, "look_alike": 2, "stranger": 1, "short": 1,
}  # fmt: skip
"""The same classes for everyday use: 24 cases."""

MASKED = ("relief_under_eccentricity", "relief_cancels_deflection", "crack_under_pitch", "spall_under_pitch")
ONE_FLANK = (
    "tooth_thickness",
    "tooth_spall",
    "eccentricity",
    "encoder_eccentricity",
    "centre_distance",
    "cumulative_pitch",
)
LOOK_ALIKES = (
    "eccentricity", "encoder_eccentricity", "profile_slope", "wear", "undulation", "centre_distance",
    "cumulative_pitch",
    "encoder_interpolation", "encoder_scale", "profile_crowning", "thermal_drift", "tooth_thickness",
)  # fmt: skip
TWO = (
    ("eccentricity", "tooth_spall"), ("tip_relief", "tooth_pitch"), ("undulation", "eccentricity"),
    ("encoder_interpolation", "tooth_pitch"), ("tooth_crack", "shaft_windup"), ("thermal_drift", "cumulative_pitch"),
    ("friction", "tooth_crack"), ("profile_crowning", "undulation"), ("wear", "encoder_interpolation"),
    ("profile_slope", "eccentricity"), ("misalignment", "tooth_pitch"), ("tooth_spall", "undulation"),
)  # fmt: skip
SHORT = (
    "healthy", "eccentricity", "tooth_pitch", "undulation", "healthy", "tooth_spall", "profile_slope",
    "cumulative_pitch",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One line of the plan: index, class, what is concealed (none for a healthy case), and its size over the limit
    (0: fixed)."""

    index: int
    klass: str
    physics: tuple[str, ...]
    over: float
    variant: int
    quick: bool = False

    @property
    def name(self) -> str:
        """Folder of the case; says nothing of what is in it."""
        return f"case_{self.index:03d}"


def plan(seed: int, *, quick: bool = False) -> list[Entry]:
    """All cases of a ground, in an order that tells nothing (the block of further healthy cases comes last)."""
    rng = np.random.default_rng([seed, 0x9A0])
    counts = QUICK if quick else COUNTS
    rows: list[tuple[str, tuple[str, ...], float, int]] = []
    tail: list[tuple[str, tuple[str, ...], float, int]] = []
    turn = int(rng.integers(1000)) if quick else 0  # so that quick grounds of other seeds show other physics
    for klass, count in counts.items():
        for k in range(count):
            v = k + turn
            over = SIZES_OVER_LIMIT[(5 * v + v // len(SIZES_OVER_LIMIT)) % len(SIZES_OVER_LIMIT)]
            row: tuple[str, tuple[str, ...], float, int]
            if klass in ("healthy", "false_alarm"):
                row = (klass, (), 0.0, v)
            elif klass == "single":
                lap = v // len(CATALOGUE)
                n = SIZES_OVER_LIMIT[(5 * v + 4 * lap) % len(SIZES_OVER_LIMIT)]
                row = (klass, (CATALOGUE[v % len(CATALOGUE)],), n, v)
            elif klass == "two":
                row = (klass, TWO[v % len(TWO)], (7.0, 10.0, 14.0, 20.0, 30.0)[v % 5], v)
            elif klass == "masked":
                row = (klass, (MASKED[v % len(MASKED)],), 0.0, v)
            elif klass == "one_flank":
                row = (klass, (ONE_FLANK[v % len(ONE_FLANK)],), (3.0, 5.0, 10.0, 20.0)[v % 4], v)
            elif klass == "look_alike":
                row = (klass, (LOOK_ALIKES[v % len(LOOK_ALIKES)],), (5.0, 8.0, 14.0, 25.0)[v % 4], v)
            elif klass == "stranger":
                row = (klass, ("disturbance",), (5.0, 8.0, 14.0, 25.0, 30.0)[(v + v // 5) % 5], v)
            else:
                what = SHORT[v % len(SHORT)]
                row = (klass, () if what == "healthy" else (what,), 0.0 if what == "healthy" else max(over, 3.0), v)
            (tail if klass == "false_alarm" else rows).append(row)
    order = rng.permutation(len(rows))
    mixed = [rows[k] for k in order] + tail
    return [
        Entry(index=i, klass=klass, physics=physics, over=over, variant=variant, quick=quick)
        for i, (klass, physics, over, variant) in enumerate(mixed)
    ]


def write_case(seed: int, index: int, folder: Path, *, truths: Path | None = None, quick: bool = False) -> str:
    """Write NAME/pair.toml and NAME/rec_K.csv under folder, NAME.truth.json under truths (default: folder).

    Returns the sha256 of the truth file's bytes. The truth is written first, and everything under its final name only
    when whole."""
    from proving.case import make

    entry = plan(seed, quick=quick)[index]
    case = make(seed, entry)
    apart = folder if truths is None else truths
    apart.mkdir(parents=True, exist_ok=True)
    place = folder / entry.name
    place.mkdir(parents=True, exist_ok=True)
    sealed = case.truth_text().encode()
    for path, text in case.files():
        (place / path).write_bytes(text.encode())
    aside = apart / f"{entry.name}.truth.json.part"
    aside.write_bytes(sealed)
    aside.replace(apart / f"{entry.name}.truth.json")
    return hashlib.sha256(sealed).hexdigest()


def _work(job: tuple[int, int, str, str | None, bool]) -> tuple[int, str]:
    seed, index, folder, truths, quick = job
    return index, write_case(seed, index, Path(folder), truths=None if truths is None else Path(truths), quick=quick)


def write_ground(
    seed: int, folder: Path, *, truths: Path | None = None, quick: bool = False, workers: int = 1,
    indices: list[int] | None = None, done: Callable[[str, str], None] | None = None,
) -> dict[str, str]:  # fmt: skip
    """Write every case of a ground (or those of indices); returns name to sha256 of its truth, in the order of the
    plan."""
    entries = plan(seed, quick=quick)
    chosen = range(len(entries)) if indices is None else indices
    jobs = [(seed, i, str(folder), None if truths is None else str(truths), quick) for i in chosen]
    hashes: dict[str, str] = {}

    def collect(results: Iterator[tuple[int, str]]) -> None:
        for index, digest in results:
            hashes[entries[index].name] = digest
            if done is not None:
                done(entries[index].name, digest)

    if workers <= 1:
        collect(map(_work, jobs))
    else:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            collect(iter(pool.map(_work, jobs)))
    return hashes


def seal(hashes: dict[str, str]) -> str:
    """One hash over all truths of a ground: sha256 of the lines "name hash", sorted by name."""
    lines = "".join(f"{name} {hashes[name]}\n" for name in sorted(hashes))
    return hashlib.sha256(lines.encode()).hexdigest()
