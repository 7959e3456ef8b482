"""What is put to the proof: the diagnosis, as a whole or with a part of it missing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gearpoly.files.models import PairFile
from gearpoly.keys.edit import changed, on_gear

SOONER = 40.0
"""Processor seconds after which no more is looked for on a quick ground and without a part of the method, where claim
after claim of coloured noise takes long, and the first say enough; else the time that the command takes by itself."""

WRONG = 1.05
"""Factor by which known parameters are wrong in the control that asks what then happens."""


@dataclass(frozen=True, kw_only=True)
class How:
    """How a case is diagnosed: physics struck from the catalogue (``without``), with or without whitening, with
    eccentricity exact or to first order, from the recordings of the highest torque only (``one_torque``), with
    Young's modulus, declared eccentricities and reliefs wrong by 5 % (``wrong``); ``hurried``: in less time."""

    without: tuple[str, ...] = ()
    whiten: bool = True
    exact: bool = True
    one_torque: bool = False
    wrong: bool = False
    hurried: bool = False


Diagnoser = Callable[[Path, Sequence[Path], How], dict[str, Any]]
"""From a pair file and recordings to the contract's verdict; a function of a module, so that workers find it."""


def gearpoly(pair: Path, recordings: Sequence[Path], how: How) -> dict[str, Any]:
    """The verdict of ``gearpoly diagnose``."""
    from gearpoly.diagnose.budget import USUAL_WORK_S
    from gearpoly.diagnose.diagnose import diagnose
    from gearpoly.diagnose.method import Method
    from gearpoly.files.pairfile import read_pair
    from gearpoly.positions import recorded_torque
    from gearpoly.recording.read import read_recording
    from gearpoly.report.diagnosis_report import verdict_json

    file = read_pair(pair)
    read = [read_recording(path, worm=file.worm) for path in recordings]
    if how.one_torque:
        torques = [recorded_torque(one, default=file.torque_nm) for one in read]
        read = [one for one, torque in zip(read, torques, strict=True) if torque >= 0.999 * max(torques)]
    if how.wrong:
        file = wrong(file)
    method = Method(without=frozenset(how.without), whiten=how.whiten, exact=how.exact)
    return verdict_json(diagnose(file, read, path=pair, method=method, within=SOONER if how.hurried else USUAL_WORK_S))


def wrong(file: PairFile) -> PairFile:
    """The pair file with what it declares of load and shape wrong by 5 %."""
    out: PairFile = changed(
        file, material=changed(file.material, youngs_modulus_gpa=WRONG * file.material.youngs_modulus_gpa)
    )
    for gear, section in enumerate((file.driving, file.driven)):
        if section.eccentricity is not None:
            off = changed(section.eccentricity, amplitude_um=WRONG * section.eccentricity.amplitude_um)
            out = on_gear(out, gear, eccentricity=off)
        if section.tip_relief is not None:
            relief = changed(section.tip_relief, amount_um=WRONG * section.tip_relief.amount_um)
            out = on_gear(out, gear, tip_relief=relief)
    return out
