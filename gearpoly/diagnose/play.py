"""Lost motion between the flanks that neither the simulation nor any name explains, where the pair file says how thick
the teeth are.

Teeth as built take it up: to the fit, both gears are thinner than an inspection found them, and nothing of it is left.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry
from gearpoly.compare.lost_motion import Lost, lost_motions
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.nuisance import DISCREPANCY
from gearpoly.diagnose.prepare import LIMITS_APART_SIGMAS
from gearpoly.keys.edit import gear_section
from gearpoly.keys.sections import GearSection, PairFile
from gearpoly.physics.base import Claim
from gearpoly.units import UM

PLAY_SIGMAS = 5.0
"""Standard errors of the mean lost motion, and of what the pair file leaves open of the thickness of both gears, from
which on it is told. Parts of a turn are not independent, and a limit is no bound on a gear that nobody measured. A
judgement: an inspected pair with 55 um of play shows 180 of them, without play none."""


def play(
    search: Fit, comparison: Comparison, claims: Sequence[Claim], *, file: PairFile
) -> tuple[tuple[Entry, ...], tuple[str, ...]]:
    """Where recordings of the coast flank stand farther from those of the drive flank than the simulation and the named
    ``claims`` put them, and a word about each; nothing where ``file``, the pair's own, does not state the thickness of
    either gear. The declared file says of every gear how thick it was taken: of a sound pair within its limits 11 um
    were told."""
    gears = search.model.scope.gears
    stated = [std for gear in (0, 1) if (std := _open_um(gear_section(file, gear))) is not None]
    if len(stated) < len(gears):
        return (), ()
    left_open = UM * math.hypot(*(std * math.cos(gear.alpha) for std, gear in zip(stated, gears, strict=True)))
    found = list(_beyond(search, comparison, claims, left_open))
    return tuple(_entry(*one) for one in found), tuple(_says(*one) for one in found)


def with_play(entries: Sequence[Entry], played: Sequence[Entry]) -> tuple[Entry, ...]:
    """The ``entries`` with what ``play`` found before all others; where one is about the means of the same recordings
    already, it has the words and the size, and keeps its causes."""
    out = list(entries)
    more = []
    for one in played:
        at = next((k for k, other in enumerate(out) if _of_means(other) and other.recordings == one.recordings), None)
        if at is None:
            more.append(one)
        else:
            out[at] = replace(out[at], rms_um=one.rms_um, label=one.label)
    return (*more, *out)


def _of_means(entry: Entry) -> bool:
    """Whether an entry is about how far recordings stand apart, which nobody located as anything else."""
    return entry.kind == "condition" and not entry.label


def _open_um(section: GearSection) -> float | None:
    """Standard deviation in um of the thickness of a gear as its ``section`` has it; None where that says nothing."""
    sheet, limits = section.inspection, section.limits
    if sheet is not None and sheet.tooth_thickness_um is not None:
        return sheet.uncertainty_um
    if limits is None or limits.E_sns_um is None or limits.E_sni_um is None:
        return None
    return (limits.E_sns_um - limits.E_sni_um) / LIMITS_APART_SIGMAS


def _beyond(
    search: Fit, comparison: Comparison, claims: Sequence[Claim], left_open: float
) -> Iterator[tuple[Lost, float]]:
    """Lost motions and what of them in mm nothing explains; ``left_open`` in mm is not known beforehand, nor the part
    of what teeth bend by which compliance laws differ."""
    changes = [search.model.change(search.scenes, one, one.values, but=one) for one in claims]
    for lost in lost_motions(comparison):
        drive, coast = (
            sum(float(np.mean(np.concatenate([change[k] for k in flank]))) for change in changes)
            for flank in lost.recordings
        )
        left = lost.beyond - (coast - drive)
        bent = DISCREPANCY * abs(float(np.mean(lost.simulated - lost.backlash)))
        if abs(left) > PLAY_SIGMAS * math.hypot(lost.std, left_open, bent):
            yield lost, left


def _entry(lost: Lost, left: float) -> Entry:
    return Entry(
        kind="condition",
        rms_um=abs(left) / UM,
        recordings=lost.recordings[1],
        p_value=0.0,
        gain=(left / max(lost.std, 1e-12)) ** 2,
        probability=1.0,
        label=f"coast against drive flank: lost motion {left / UM:+.3g} um along the line of action, "
        f"{lost.arcmin(left):+.3g} arcmin of the driving shaft, beyond the simulated",
    )


def _says(lost: Lost, left: float) -> str:
    more = "more" if left > 0.0 else "less"
    teeth, apart = ("thinner", "larger") if left > 0.0 else ("thicker", "smaller")
    return (
        f"both flanks show {abs(left) / UM:.3g} um {more} lost motion than the pair file has, "
        f"{abs(lost.arcmin(left)):.3g} arcmin of the driving shaft: {teeth} teeth, a {apart} centre distance"
        + (" or play in a coupling, key or bearing may make it" if left > 0.0 else " or a preloaded train may make it")
    )
