"""As much of long recordings as a fit of everything can hold: means over neighbours, of whole hunting cycles.

Every column of the fit is as long as its recording, and there are hundreds. Of a million samples of 21 and 55 teeth
they took more than 22 GB. `compare` has looked at every sample by then; what of its finds means do not show is told as
it stands there.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.beside import Aligned, Comparison
from gearpoly.compare.entries import Entry
from gearpoly.compare.fast import BELOW
from gearpoly.compare.noise import spacing_of
from gearpoly.compare.reduce import SAMPLES_SEARCHED, Shortening, shortening
from gearpoly.compare.slow import slow_curves
from gearpoly.diagnose.foreign import columns_of, is_foreign
from gearpoly.mesh.shafts import runs_up
from gearpoly.recording.deeds import Deed
from gearpoly.units import FloatArray

LONG_RECORDING_SAMPLES = 2 * SAMPLES_SEARCHED
"""Samples of a recording beyond which it is shortened: of 80 000 samples of 60 teeth the columns of a fit take 0.4 GB,
and means are less exact where pairs take over."""


@dataclass(frozen=True, kw_only=True)
class FittedPart:
    """A ``comparison`` whose recordings are short enough to fit, and what it located ``beyond`` them: waves too fast
    for means, and what lies after their end."""

    comparison: Comparison
    beyond: tuple[Entry, ...] = ()


def fitted_part(comparison: Comparison) -> FittedPart:
    """The ``comparison`` with its long recordings shortened; as it is where none is long."""
    aligned: list[Aligned] = []
    beyond: list[Entry] = []
    for k, one in enumerate(comparison.aligned):
        if one.theta_2.size <= LONG_RECORDING_SAMPLES:
            aligned.append(one)
            continue
        z_1, z_2 = (gear.z for gear in comparison.gears)
        cut = _cut(one, z_1=z_1, z_2=z_2)
        fast = [e for e in comparison.located.entries if k in e.recordings and _is_fast(e, one, cut, z=(z_1, z_2))]
        aligned.append(_means(_without(one, fast), cut))
        late = [e for e in comparison.located.entries if e.recordings == (k,) and _is_late(e, one, aligned[-1])]
        beyond += [e for e in (*fast, *late) if e not in beyond]
    if all(mine is its for mine, its in zip(aligned, comparison.aligned, strict=True)):
        return FittedPart(comparison=comparison)
    entries = tuple(e for e in comparison.located.entries if e not in beyond)
    located = replace(comparison.located, entries=entries)
    return FittedPart(comparison=replace(comparison, aligned=tuple(aligned), located=located), beyond=tuple(beyond))


def _cut(one: Aligned, *, z_1: int, z_2: int) -> Shortening:
    """How a long recording is shortened. Of a run-up all is kept, since it meets every speed once."""
    u = one.theta_2 * (z_2 / (2.0 * np.pi))
    if runs_up(one.theta_1, one.time_s) is None:
        return shortening(u, z_1=z_1, z_2=z_2)
    group = -(-u.size // LONG_RECORDING_SAMPLES)
    return Shortening(group=group, size=u.size // group, spacing=spacing_of(u))


def _is_fast(entry: Entry, one: Aligned, cut: Shortening, *, z: tuple[int, int]) -> bool:
    """Whether a wave of no pair is too fast for means of ``cut``."""
    if entry.moment is not None or entry.burst is not None or not is_foreign(entry):
        return False
    if entry.kind == "time":
        meshes = float(np.ptp(one.theta_2)) * z[1] / (2.0 * np.pi)
        seconds = 0.0 if one.time_s is None else float(np.ptp(one.time_s))
        per_mesh = (entry.hz or 0.0) * seconds / meshes
    else:
        per_mesh = (entry.order or 0.0) / z[1 if entry.gear == "driven" else 0]
    return per_mesh >= BELOW * 0.5 / (cut.group * cut.spacing)


def _is_late(entry: Entry, whole: Aligned, part: Aligned) -> bool:
    """Whether a jump or a burst comes after the part that is fitted."""
    entry = whole.turned_round(entry)
    if entry.time_s is not None or entry.during_s is not None:
        end = np.inf if part.time_s is None else float(part.time_s[-1])
        at = entry.time_s if entry.time_s is not None else (entry.during_s or (0.0,))[0]
        return at > end
    turn = entry.driving_turn if entry.driving_turn is not None else (entry.during_turns or (-1.0,))[0]
    return turn > float(np.ptp(part.theta_1)) / (2.0 * np.pi)


def _without(one: Aligned, waves: Sequence[Entry]) -> Aligned:
    """The recording less these waves, as they fit what it differs by from its simulation."""
    if not waves:
        return one
    u = one.theta_2
    columns = np.concatenate([*(columns_of(e, one) for e in waves), slow_curves(u)], axis=1)
    heights = np.linalg.lstsq(columns, one.residual, rcond=None)[0]
    count = 2 * len(waves)
    made = columns[:, :count] @ heights[:count]
    return replace(one, recorded=one.recorded - made, residual=one.residual - made)


def _means(one: Aligned, cut: Shortening) -> Aligned:
    """The recording as means of ``cut``."""

    def means(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else cut.means(values)

    def known(values: FloatArray | None) -> FloatArray | None:
        """Means of what was read at all."""
        if values is None:
            return None
        rows = values[: cut.size * cut.group].reshape(cut.size, cut.group)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # of no reading there is no mean
            return np.asarray(np.nanmean(rows, axis=1))

    was = one.cleaned
    of = f"{cut.size * cut.group} of {was.size}" if cut.size * cut.group < was.size - cut.group else f"{was.size}"
    says = f"{of} samples are fitted, as means over {cut.group} neighbours each: {cut.size} in all"
    cleaned = replace(
        was,
        theta_1=cut.means(was.theta_1),
        theta_2=cut.means(was.theta_2),
        te=cut.means(was.te),
        time_s=means(was.time_s),
        torque_nm=known(was.torque_nm),
        speed_rpm=known(was.speed_rpm),
        keep=was.keep[cut.group // 2 : cut.size * cut.group : cut.group],
        done=(*was.done, Deed("fitted", was.size - cut.size, says)),
    )
    return replace(
        one,
        cleaned=cleaned,
        theta_2=cut.means(one.theta_2),
        recorded=cut.means(one.recorded),
        residual=cut.means(one.residual),
        swings=means(one.swings),
        load=means(one.load),
        averaged=0.0 if cut.group == 1 else cut.group * cut.spacing,
    )
