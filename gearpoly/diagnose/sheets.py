"""Inspections that are not of the teeth as they come into mesh: counted from another tooth or the other way round, of
the other sign, or of another gear. No physics is missing then, and yet every tooth is wrong, each by a step of its own.

The teeth are fitted as though nothing were known of them, and held against the sheet in every order.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.arguments import GEARS
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.shortened import PLACING_SAMPLES, shortened
from gearpoly.diagnose.teeth_off_sheet import ReadAs, TeethOffSheet, order_of
from gearpoly.diagnose.teeth_scale import COARSEST, USUAL
from gearpoly.diagnose.unstated import between, limited
from gearpoly.errors import GearpolyError
from gearpoly.files.models import GearSection, Inspection, PairFile
from gearpoly.gear.metrology import index_deviations
from gearpoly.keys.edit import changed, gear_section, on_gear
from gearpoly.physics.sheet import column
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray

SHEET_FIT_ROUNDS = 8
"""Most rounds of simulating and fitting: without load other teeth touch by a wrong sheet than on the gear. Of eight
gears of 12 to 31 teeth of 1.5 to 10 um that were counted otherwise the right order left 0.19 to 0.83 of the steps after
one round, 0.40 at most after two, 0.02 after four and eight; sheets of seven other gears left 0.56 and more."""

OPPOSITE = (
    "the transmission error of the recordings fits the inspection only with the opposite sign, and was taken so; check "
    "the sign of te_um (positive where the driven gear is ahead), or of pitch_um"
)
"""What to tell of recordings whose transmission error has the other sign."""


@dataclass(frozen=True, kw_only=True)
class Reread:
    """The ``inspection`` of a ``gear`` (0, 1) as the recordings bear it out, None where they do not in any order;
    ``opposite``: its deviations have the other sign; ``says`` what to tell of that."""

    gear: int
    inspection: Inspection | None
    opposite: bool
    says: str


def reread(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> list[Reread] | None:
    """What is wrong with the sheets of inspected gears: in ``model`` nothing is claimed yet. None where nobody can
    tell: no sheet lists teeth, time is over, or gears with other teeth cannot run."""
    listed = _listed_gears(model.declared)
    if not listed or model.budget.over:
        return None
    step("holding the inspection against the teeth")
    try:
        fit = _wide_fit(model, foreign, step, listed)
    except GearpolyError:
        return None  # so rough are no gears that run: the sheets are not that far off
    teeth = [_teeth(fit, model, gear) for gear in listed]
    z_1, z_2 = (gear.z for gear in fit.model.as_built.gears)
    if z_1 == z_2:
        # Every tooth meets one other for ever, so only what both deviate together is told.
        both = len(listed) == 2 and _together(fit, *teeth).contradicted
        return [_left_out(one, "what both gears deviate together is") for one in teeth] if both else []
    return [_reread(one, model.declared) for one in teeth if one.contradicted]


def placed_by_sheets(model: Model, foreign: list[FloatArray], step: Callable[[str], None]) -> Model | None:
    """The ``model`` moved to that of the places left open by the curves where every sheet is recognised by its teeth;
    None where none is. A few wrong teeth may say more of the place than all others together, and of a wrong place every
    sheet seems to be another gear's. Raises what ``Fit.begun`` does."""
    listed = _listed_gears(model.declared)
    if not model.elsewhere or not listed or model.budget.over:
        return None
    fit = _wide_fit(model, foreign, step, listed)
    teeth = [_teeth(fit, model, gear) for gear in listed]
    tau = model.scope.gears[1].tau
    alike = {by: min(one.recognised_after(round(by / tau)) for one in teeth) for by in model.elsewhere}
    best = max(alike, key=lambda by: alike[by])
    return replace(model.moved(-best), elsewhere=()) if alike[best] > 0.0 else None


def as_read(file: PairFile, wrong: Sequence[Reread]) -> tuple[PairFile, tuple[str, ...]]:
    """The pair file with its sheets as the recordings bear them out, and what to tell of that."""
    for one in wrong:
        file = on_gear(file, one.gear, inspection=one.inspection)
    return file, tuple(one.says for one in wrong)


def sign_may_be_wrong(file: PairFile, recordings: Sequence[Recording], wrong: Sequence[Reread]) -> bool:
    """Whether there are sheets, all of them wrong, and rigs that computed the transmission error: its sign is likelier
    to be wrong than every sheet."""
    every = bool(wrong) and {one.gear for one in wrong} == set(_listed_gears(file))
    return every and all(one.computed for one in recordings)


def opposite(recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings with the other sign of their transmission error."""
    return [
        replace(
            one,
            te_rad=None if one.te_rad is None else -one.te_rad,
            te_mm=None if one.te_mm is None else -one.te_mm,
        )
        for one in recordings
    ]


def _wide_fit(model: Model, foreign: list[FloatArray], step: Callable[[str], None], listed: Sequence[int]) -> Fit:
    """The teeth fitted as though nothing were known of those that are ``listed``. Raises what ``Fit.begun`` does."""
    wide = limited(model, dict.fromkeys(listed, COARSEST))
    return Fit.begun(
        *shortened(wide, foreign, few=PLACING_SAMPLES[-1]), step, trial=SHEET_FIT_ROUNDS,
        limits_over_usual=COARSEST / USUAL,
    )  # fmt: skip


def _teeth(fit: Fit, model: Model, gear: int) -> TeethOffSheet:
    """The teeth of a gear as the fit has them."""
    section, built, flank = gear_section(model.declared, gear), fit.model.as_built, fit.model.as_built.flanks[0]
    at = fit.linear.layout.built
    start, z = built.start(flank, gear), built.gears[gear].z
    sheet = column(section, "pitch_coast_um" if flank == "coast" else "pitch_um")
    return TeethOffSheet(
        gear=gear,
        off=built.pitch(fit.linear.system.solution[at], flank, gear),
        covariance=fit.linear.system.covariance[at, at][start : start + z, start : start + z],
        sheet=sheet,
        # What stands in files of traces has a name there that says what it is.
        summed=None if _traces_of(section) else _summed(sheet, section, gear, coast=flank == "coast"),
        uncertainty=section.inspection.uncertainty_um if section.inspection is not None else 0.0,
        steps=between(z, common=math.gcd(*(one.z for one in built.gears))),
    )


def _together(fit: Fit, one: TeethOffSheet, mate: TeethOffSheet) -> TeethOffSheet:
    """What every tooth and the one of the mate that it always meets deviate together."""
    built = fit.model.as_built
    z, covariance = one.off.size, fit.linear.system.covariance[fit.linear.layout.built, fit.linear.layout.built]
    starts = [built.start(built.flanks[0], gear) for gear in (0, 1)]
    each = [covariance[a : a + z, b : b + z] for a in starts for b in starts]
    return TeethOffSheet(
        gear=one.gear,
        off=one.off + mate.off,
        covariance=np.sum(each, axis=0),
        sheet=one.sheet + mate.sheet,
        uncertainty=math.hypot(one.uncertainty, mate.uncertainty),
        steps=between(z),
    )


def _reread(teeth: TeethOffSheet, file: PairFile) -> Reread:
    """What is wrong with the sheet of a gear whose teeth contradict it."""
    if teeth.elsewhere is None:
        return _left_out(teeth, "counted from no other tooth it fits better; its pitch_um is")
    way = teeth.elsewhere
    return Reread(
        gear=teeth.gear,
        inspection=_read(file, teeth, way),
        opposite=way.sign < 0.0 and not way.single,
        says=_says(GEARS[teeth.gear], way) + _of_traces(file, teeth.gear),
    )


def _left_out(teeth: TeethOffSheet, what: str) -> Reread:
    """The sheet of a gear that is another's."""
    return Reread(
        gear=teeth.gear,
        inspection=None,
        opposite=False,
        says=f"the inspection of the {GEARS[teeth.gear]} gear does not fit the gear that was recorded: {what} off by "
        f"{teeth.within(teeth.off, 0.5):.1f} um or more in half of the steps from tooth to tooth; it was left out, and "
        "no physics is claimed for the difference; check whose sheet it is, and whether what recurs every turn was "
        "taken off the recording",
    )


def _says(name: str, way: ReadAs) -> str:
    """What the engineer should check."""
    if way.single:
        return (
            f"pitch_um of the {name} gear fits only as single pitches f_p, whose running sum the index deviations are: "
            "it was taken so, and no physics is claimed for the difference; state single_pitch_um in its place"
        )
    from_0 = "" if way.first else ", from tooth 0 of the pair on"
    ways = [
        *([f"counts its teeth the other way round{from_0}"] if way.back else []),
        *([f"calls tooth {way.first} what is tooth 0 of the pair"] if way.first else []),
        *(["has the opposite sign"] if way.sign < 0.0 else []),
    ]
    return (
        f"the inspection of the {name} gear fits only where it {', and '.join(ways)}: it was taken so, and no physics "
        "is claimed for the difference; check how the sheet is numbered"
        + (", and the sign of pitch_um" if way.sign < 0.0 else "")
        + (" (single pitches counted the other way round have it)" if way.sign < 0.0 and way.back else "")
    )


def _of_traces(file: PairFile, gear: int) -> str:
    """What to tell of whole traces, which stay with the teeth that their own file gives them."""
    names = _traces_of(gear_section(file, gear))
    return f"; traces of {names[0]} were left with the teeth that they have there" if names else ""


def _traces_of(section: GearSection) -> list[str]:
    """The keys that name files of traces."""
    return [name for name in ("profile_csv", "gde") if getattr(section.inspection, name, None) is not None]


def _read(file: PairFile, teeth: TeethOffSheet, way: ReadAs) -> Inspection:
    """The inspection of a gear with its values per tooth read in another ``way``."""
    section = gear_section(file, teeth.gear)
    order = order_of(section.teeth, way.first, back=way.back)
    keys = {}
    for name, value in _listed(file, teeth.gear).items():
        values = np.asarray(value)[order]
        if name.startswith("pitch"):
            coast = name == "pitch_coast_um"
            values = way.sign * (_summed(values, section, teeth.gear, coast=coast) if way.single else values)
            if way.single and coast:
                # Single pitches have no level: their flanks stand where the mean thickness has them.
                alpha = math.radians(section.pressure_angle_deg)
                values = values + float(np.mean(column(section, "tooth_thickness_um"))) * math.cos(alpha)
        keys[name] = tuple(values.tolist())
    read: Inspection = changed(section.inspection, **keys)
    return read


def _listed_gears(file: PairFile) -> list[int]:
    """Gears (0, 1) whose inspection lists the pitch of every tooth."""
    return [gear for gear in (0, 1) if len(_listed(file, gear).get("pitch_um", ())) > 1]


def _listed(file: PairFile, gear: int) -> dict[str, Sequence[float]]:
    """What the inspection of a gear lists tooth by tooth, by its keys: nothing where nobody inspected it, or where all
    teeth have one value, and no count of them matters."""
    sheet = gear_section(file, gear).inspection
    held = {} if sheet is None else sheet.model_dump()
    return {name: value for name, value in held.items() if isinstance(value, (list, tuple))}


def _summed(single: FloatArray, section: GearSection, gear: int, *, coast: bool) -> FloatArray:
    """Index deviations (z,) in um that values (z,) of a sheet would mean as ``single`` pitches of a gear's drive or
    ``coast`` flanks; those of a gear may have been counted with the other sign."""
    which, alpha = GEARS[gear], math.radians(section.pressure_angle_deg)
    return index_deviations(single - np.mean(single), alpha=alpha, which=which, coast=coast)
