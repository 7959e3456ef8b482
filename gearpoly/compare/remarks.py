"""What had to be assumed of a set of recordings, and what of them does not fit the pair file, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from gearpoly.compare.among import means_compare
from gearpoly.compare.beside import ROUNDING_TOLD, Aligned
from gearpoly.compare.other_pair import OtherPair, other_pair
from gearpoly.compare.ratio import OrderPower
from gearpoly.compare.same_ratio import SameRatio, other_teeth_of_ratio, same_ratio
from gearpoly.compare.scale import Scale
from gearpoly.compare.stated import speed_remarks
from gearpoly.compare.zeros import Alignment, Base
from gearpoly.files.models import PairFile
from gearpoly.keys.also_turns import Part
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, NM, UM

Other = OtherPair | SameRatio
"""Another pair than the declared one."""

VARIES = 0.02
"""Relative spread of a recorded torque from which its mean no longer stands for it without a word."""


ZEROS_APART_PITCHES = 0.1
"""Pitches by which the means of two recordings of one flank differ from which on that is told. Teeth and bearings give
a hundredth of a pitch, and where shafts twist by more, that is worth a word as well. A judgement."""


def remarks(file: PairFile, aligned: tuple[Aligned, ...], alignment: Alignment, base: Base) -> list[str]:
    """Remarks on ``aligned`` recordings of the pair of ``file``."""
    out = list(_rounding_remarks(aligned))
    for name, section in (("driving", file.driving), ("driven", file.driven)):
        if section.inspection is None and (section.grade is not None or section.limits is not None):
            out.append(f"nobody inspected the {name} gear: it is simulated free of deviations, its limits are a prior")
    for k, one in enumerate(aligned):
        out += [f"recording {k}: {remark}" for remark in one.cleaned.recording.remarks]
        samples = one.cleaned.torque_nm
        if samples is None and one.cleaned.recording.torque_nm is None and one.torque > 0.0:
            out.append(f"recording {k}: no torque is stated, the {one.torque / NM:g} N.m of the pair file are taken")
        if samples is None or not np.isfinite(samples).any():
            continue
        spread = float(np.nanstd(samples))
        if spread * NM > VARIES * max(one.torque, NM):
            out.append(
                f"recording {k}: the torque varies by {spread:.3g} N.m rms about {one.torque / NM:g}, and is followed"
            )
    silent = [one.cleaned.torque_nm is None and one.cleaned.recording.torque_nm is None for one in aligned]
    if len(aligned) > 1 and all(silent) and all(one.torque == 0.0 for one in aligned):
        out.append(
            "neither recordings nor pair file state a torque: all are taken for unloaded; where it differs, state "
            "torque_nm in each recording"
        )
    out += speed_remarks(aligned, of_pair=file.pair.speed_rpm)
    wrong = alignment.contradicted
    if wrong is not None:
        places = [
            f"{name}_zero_deg = {zero / DEG:.2f}"
            for name, zero in (("driving", wrong.driving), ("driven", wrong.driven))
            if zero is not None
        ]
        out.append(
            f"the curves fit much better ({wrong.rms / UM:.2f} um rms instead of {alignment.zeros.rms / UM:.2f}) with "
            f"{' and '.join(places)}, more than half a tooth from what is stated; check the stated zeros"
        )
    if not alignment.phased and alignment.rough:
        to = [
            f"the {name} shaft to {std / DEG:.{1 if std < 10.0 * DEG else 0}f} deg"
            for name, std in (("driving", alignment.std_driving), ("driven", alignment.std_driven))
        ]
        out.append(
            f"the curves place {' and '.join(to)} only, since a coupling or encoder off its axis would look alike"
        )
    elif not alignment.phased:
        kept = base.driving is not None or base.driven is not None
        out.append(
            "the simulated curve is too flat to place the teeth: "
            + ("the stated zeros are kept" if kept else "no zero is stated either, so tooth numbers mean nothing")
        )
    return out


def apart_remarks(aligned: Sequence[Aligned], *, z_2: int) -> Iterator[str]:
    """Which recordings of one flank stand so far from the first that their encoders hardly have one zero."""
    compared = means_compare([one.cleaned.recording for one in aligned])
    for flank in ("drive", "coast"):
        mine = [k for k, one in enumerate(aligned) if one.flank == flank and compared[k]]
        for k in mine[1:]:
            one, first = aligned[k], aligned[mine[0]]
            apart, pitch = one.mean - first.mean, 2.0 * math.pi * one.r_b2 / z_2
            if abs(apart) > ZEROS_APART_PITCHES * pitch:
                yield (
                    f"recording {k} stands {apart / UM:+.4g} um from recording {mine[0]} on the same flank "
                    f"({apart / pitch:+.2g} of a pitch), beyond what is simulated: either its encoders have other "
                    "zeros, and it is to be compared by itself, or shafts between encoders and gears twist by so much; "
                    "only recordings whose encoders kept their zeros are of one set"
                )


def scale_remarks(scale: Scale | None, another: Other | None) -> Iterator[str]:
    """Which reading was wrong, where one was, and how its size is known; or which pair shows in the stead of this."""
    if another is not None:
        yield another.says
    if scale is not None:
        yield scale.says
        if scale.by_recording:
            each = ", ".join(
                f"{value:.6g} in recording {k}" for k, value in zip(scale.of, scale.by_recording, strict=True)
            )
            yield f"the {scale.shaft} shaft reads its turns times {each}"


def _rounding_remarks(aligned: tuple[Aligned, ...]) -> Iterator[str]:
    """Where readings are so coarse that their rounding shows."""
    for k, one in enumerate(aligned):
        if one.rounding < ROUNDING_TOLD * one.rms:
            continue
        parts = [
            f"the {name} angle in steps of {step / DEG:.4g} deg ({2.0 * np.pi / step:.0f} a turn)"
            for name, step in zip(("driving", "driven"), one.steps, strict=True)
            if step is not None
        ]
        yield (
            f"recording {k} reads {' and '.join(parts)}: rounding alone makes {one.rounding / UM:.3g} um rms along the "
            "line of action, "
            + (
                "and in samples so even it makes waves of any order of either shaft"
                if one.stepped
                else "as waves of no shaft while the speed stays the same, else as noise"
                if one.coarse_for_a_while
                else "as noise"
            )
        )


def of_other_teeth(aligned: Sequence[Aligned], parts: Sequence[Part], *, z: tuple[int, int]) -> Other | None:
    """Whether recordings of ``z`` declared teeth are of other ones: of another ratio, where one shaft was read and the
    rig computed the transmission error, since travels tell where both were read; or of the same ratio."""
    read = {_read(one.cleaned.recording) for one in aligned}
    shaft = read.pop() if len(read) == 1 else None
    found: Other | None = None
    if shaft is not None:
        found = other_pair([_lines(one, shaft) for one in aligned], read=shaft, z=z, parts=parts)
    if found is None and other_teeth_of_ratio(z):
        found = same_ratio([_lines(one, 0) for one in aligned], z=z, parts=parts)
    return found


def _lines(one: Aligned, shaft: int) -> OrderPower:
    """The lines of a recorded transmission error, at orders of the driving (0) or the driven shaft (1)."""
    return OrderPower((one.theta_2 if shaft else one.estimated[0]) / (2.0 * math.pi), one.recorded)


def _read(recording: Recording) -> int | None:
    """The only shaft that was read where the rig computed the transmission error; None of any other recording."""
    there = recording.driving_angle_rad is not None, recording.driven_angle_rad is not None
    return int(there[1]) if recording.computed and sum(there) == 1 else None
