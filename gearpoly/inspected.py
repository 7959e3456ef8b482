"""What an inspection states as a sheet has it (single pitches, spans, pins, a whole file) as deviations per tooth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError, OutOfRangeError
from gearpoly.files.gde_inspection import Which, inspection
from gearpoly.files.models import GearSection, Inspection, PairFile
from gearpoly.files.traces import Trace
from gearpoly.gear.gear import Gear
from gearpoly.gear.metrology import index_deviations, thickness_from_pins, thickness_from_span
from gearpoly.units import UM

CLOSING_UM = 0.05
"""um. What each single pitch may add to the sum that closes the circle, where the sheet prints more digits: sheets
print 0.1 um, and machines resolve no less than half of it."""


OUTRIGHT_UM, OUTRIGHT_SIGMAS = 1.0, 3.0
"""um, and standard uncertainties of the sheet, by which two statements of where the coast flanks stand differ from
which on that is told. A sheet prints 0.1 um, and a thickness is 20 to 200 um off its nominal size."""


def thickness_remarks(file: PairFile) -> Iterator[str]:
    """Which inspection states a thickness that counts for nothing, since its ``pitch_coast_um`` says outright where the
    coast flanks stand, and somewhere else."""
    for name, section in (("driving", file.driving), ("driven", file.driven)):
        sheet = section.inspection
        if sheet is None or sheet.pitch_coast_um is None or sheet.tooth_thickness_um is None:
            continue
        alpha = math.radians(section.pressure_angle_deg)
        apart = float(np.mean(sheet.pitch_coast_um)) - _coast_level(sheet.tooth_thickness_um, sheet.pitch_um, alpha)
        if abs(apart) > max(OUTRIGHT_UM, OUTRIGHT_SIGMAS * sheet.uncertainty_um):
            yield (
                f"{name}.inspection: pitch_coast_um says outright where the coast flanks stand, {apart:+.1f} um from "
                "where tooth_thickness_um has them, so that thickness counts for nothing: if the list is about its own "
                f"mean, add {-apart:+.1f} um to each of it, or state single_pitch_coast_um; else leave "
                "tooth_thickness_um out"
            )


def _coast_level(thickness: object, drive: object, alpha: float) -> float:
    """Mean index deviation in um of coast flanks by ``thickness`` in um and that of the ``drive`` flanks, each for all
    teeth, one per tooth, or None; ``alpha`` in rad."""
    E_s, index = (
        float(np.mean(np.asarray(0.0 if one is None else one, dtype=np.float64))) for one in (thickness, drive)
    )
    return E_s * math.cos(alpha) - index


def measured(
    path: Path | str, section: GearSection, sheet: Inspection, gear: Gear, which: Which
) -> tuple[Inspection, tuple[Trace, ...]]:
    """The inspection ``sheet`` of a ``gear`` of the pair file ``path`` with pitch and thickness as deviations per
    tooth, and the traces of its inspection file.

    Raises ``InputFileError`` for single pitches that do not close the circle, and for sizes that no such gear has.
    """
    traces: tuple[Trace, ...] = ()
    if sheet.gde is not None:
        sheet, traces = inspection(path, section, sheet, which)
    changes: dict[str, object] = {}
    for flank in ("", "_coast"):
        key = f"single_pitch{flank}_um"
        single = getattr(sheet, key)
        if single is None:
            continue
        values = np.broadcast_to(np.asarray(single, dtype=np.float64), (section.teeth,))
        _refuse_open(path, f"{which}.inspection.{key}", values)
        index = index_deviations(values, alpha=gear.alpha, which=which, coast=bool(flank))
        changes |= {f"pitch{flank}_um": tuple(index.tolist()), key: None}
    for key, beside in (("span_mm", "span_teeth"), ("over_pins_mm", "pin_diameter_mm")):
        size = getattr(sheet, key)
        if size is None:
            continue
        mean, by = float(np.mean(size)), getattr(sheet, beside)
        try:
            E_s = thickness_from_span(gear, mean, k=by) if key == "span_mm" else thickness_from_pins(gear, mean, D=by)
        except OutOfRangeError as error:
            wish = f"want {key} and {beside} as measured on this gear"
            raise InputFileError(path, where=f"{which}.inspection.{key}", found=str(error), wish=wish) from None
        changes |= {"tooth_thickness_um": E_s / UM, key: None, beside: None}
    thickness = changes.get("tooth_thickness_um", sheet.tooth_thickness_um)
    if sheet.single_pitch_coast_um is not None and thickness is not None:
        # Single pitches say how the coast flanks stand to each other, the thickness where they stand.
        level = _coast_level(thickness, changes.get("pitch_um", sheet.pitch_um), gear.alpha)
        changes["pitch_coast_um"] = tuple((np.asarray(changes["pitch_coast_um"]) + level).tolist())
    return sheet.model_copy(update=changes), traces


def _refuse_open(path: Path | str, where: str, values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> None:
    """Single pitches go once round, so they add up to 0 but for their rounding; index deviations do not."""
    digits = min(int(Decimal(repr(float(value))).normalize().as_tuple().exponent) for value in values)
    sum_ = float(np.sum(values))
    if abs(sum_) > values.size * max(CLOSING_UM, 0.5 * 10.0 ** min(digits, 0)):
        raise InputFileError(
            path,
            where=where,
            found=f"values that add up to {sum_:.3g} um",
            wish="want single pitch deviations f_p, which add up to 0 round the gear but for rounding; index "
            "deviations (F_p's) belong in pitch_um",
        )
