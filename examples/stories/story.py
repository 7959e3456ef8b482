"""What the stories share: a concealed case from the bench, its diagnosis, and means over what repeats."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.files.pairfile import read_pair
from gearpoly.proving.case import make
from gearpoly.proving.entry import CaseEntry
from gearpoly.recording.read import read_recording
from gearpoly.units import UM

FloatArray = npt.NDArray[np.float64]

BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#777777"


@dataclass(frozen=True, kw_only=True)
class Concealed:
    """The files of a case, and its truth, which the diagnosis never sees."""

    pair: Path
    recordings: list[Path]
    truth: dict[str, Any]

    def diagnosed(self, which: Sequence[int] | None = None) -> Diagnosis:
        """The diagnosis from some of the recordings, or all."""
        chosen = self.recordings if which is None else [self.recordings[k] for k in which]
        return diagnose(read_pair(self.pair), [read_recording(path) for path in chosen], path=self.pair)


def conceal(folder: Path, *, klass: str, physics: str, seed: int, over: float = 0.0) -> Concealed:
    """Make one case of the proving ground in ``folder``."""
    case = make(seed, CaseEntry(index=0, klass=klass, physics=(physics,), over=over, variant=0))
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in case.files():
        (folder / name).write_text(text)
    return Concealed(
        pair=folder / "pair.toml",
        recordings=[folder / f"rec_{k}.csv" for k in range(len(case.conditions))],
        truth=case.truth,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Seen:
    """One recording (n,): driven rotation in rad, and in um the recorded, declared and fitted transmission error."""

    theta_2: FloatArray
    recorded: FloatArray
    declared: FloatArray
    fitted: FloatArray
    torque_nm: float
    flank: str


def seen(diagnosis: Diagnosis) -> list[Seen]:
    """All recordings of a diagnosis, each about its own mean."""
    out = []
    for one, left in zip(diagnosis.comparison.aligned, diagnosis.left, strict=True):

        def level(values: FloatArray) -> FloatArray:
            return np.asarray((values - np.mean(values)) / UM)

        out.append(
            Seen(
                theta_2=one.theta_2,
                recorded=level(one.recorded),
                declared=level(one.simulated),
                fitted=level(one.recorded - left),
                torque_nm=one.torque / 1e3,
                flank=one.flank,
            )
        )
    return out


def mean_over(angle: FloatArray, values: FloatArray, *, period: float, bins: int) -> tuple[FloatArray, FloatArray]:
    """Mean of ``values`` in equal bins of ``angle`` modulo ``period``: middles of the bins, means."""
    place = np.floor(np.mod(angle, period) / period * bins).astype(int) % bins
    count = np.maximum(np.bincount(place, minlength=bins), 1)
    return (np.arange(bins) + 0.5) * period / bins, np.bincount(place, weights=values, minlength=bins) / count


def told(diagnosis: Diagnosis) -> list[str]:
    """What the diagnosis says, one line per finding, with what it may be instead."""
    out = []
    for one in diagnosis.findings:
        rivals = ", ".join(rival.claim.physics.name.replace("_", " ") for rival in one.rivals)
        out.append(one.claim.says + (f" Or else: {rivals}." if rivals else ""))
    return out or ["Nothing is missing." if not diagnosis.unexplained else "Something is left that has no name."]


def truths(concealed: Concealed) -> list[str]:
    """The truth in words, for the end of a story."""
    out = []
    for one in concealed.truth["truth"]:
        size = ", ".join(
            f"{name} {value:.4g}" for name, value in one.items()
            if isinstance(value, float) and name not in ("over_limit", "rms_um", "encoder_deg")
        )  # fmt: skip
        gear = {1: "driving ", 2: "driven "}.get(one.get("gear"), "")
        tooth = f" tooth {one['tooth']}" if "tooth" in one else ""
        out.append(f"{gear}{one['physics'].replace('_', ' ')}{tooth}: {size}")
    return out
