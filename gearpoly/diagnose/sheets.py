"""Inspections that are not of the teeth as they come into mesh: counted from another tooth or the other way round, of
the other sign, or of another gear. No physics is missing then, and yet every tooth is wrong, each by a step of its own.

The teeth are fitted as though nothing were known of them, and held against the sheet in every order. Half of the steps
from tooth to tooth decide, so that few wrong teeth, or an eccentricity, say nothing against a sheet.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from gearpoly.arguments import GEARS
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.shortened import PLACING_SAMPLES, shortened
from gearpoly.diagnose.teeth_scale import COARSEST
from gearpoly.diagnose.unstated import between, limited
from gearpoly.errors import GearpolyError
from gearpoly.files.models import Inspection, PairFile
from gearpoly.keys.edit import changed, gear_section, on_gear
from gearpoly.physics.sheet import column
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray, IntArray

DOUBTED_SHEET_SCATTER = 2.0
"""Scatter of the steps from tooth to tooth about the sheet, over what its uncertainty and the fit leave open, from
which on the sheet is doubted: by chance half of the steps are so far off in 1 of 40 gears of 8 teeth and 1 of 360 of
18, and these keep their sheet where it tells anything of their teeth."""

WRONG_TEETH = 4
"""Steps that may be wrong of however few teeth: those of two teeth out of their place."""

OWN = 0.5
"""The same scatter over that of the teeth without any sheet, below which the sheet tells of them: of sheets of other
gears 6 in 100 of 8 teeth, 3 of 12 and none of 18 or more come so near; beside two wild teeth 94 of 100 right ones of 12
teeth do, and all of 18."""

WILD = 2.5
"""Times their median from which on steps are cut where orders of a sheet are compared, so that a few wrong teeth do not
decide: of gears with two teeth out of place by five times the others 50 in 100 (25 teeth) then know their sheet, 11 in
100 without; of none is the chance."""

STEPS_NEAR_OTHER_ORDER_PART, OTHER_ORDER_DISTANCE_RATIO = 0.75, 0.35
"""Part of the steps that must lie as near the sheet in another order, over how near they lie to it as it is, or to
none, below which that is the right order: of 400 sheets of other gears, each in every order and of either sign, the
nearest came to 0.38 with 18 teeth, 0.49 with 25, and below 0.35 in 1 of 150 with 12."""

STEPS_SHOWN_PART = 0.5
"""Part of its steps that those of the teeth must hold for a sheet to be recognised: halfway between none and all. Two
sheets of other gears fitted best as they were by chance, with 0.43 and 0.48, and 15 wrong names were made of them."""

SHEET_FIT_ROUNDS = 8
"""Most rounds of simulating and fitting: without load other teeth touch by a wrong sheet than on the gear. Of eight
gears of 12 to 31 teeth of 1.5 to 10 um that were counted otherwise the right order left 0.19 to 0.83 of the steps after
one round, 0.40 at most after two, 0.02 after four and eight; sheets of seven other gears left 0.56 and more."""

OPPOSITE = (
    "the transmission error of the recordings fits the inspection only with the opposite sign, and was taken so; check "
    "the sign of te_um (positive where the driven gear is ahead), or of pitch_um"
)
"""What to tell of recordings whose transmission error has the other sign."""

Ordered = tuple[float, int, bool, float]
"""How near in um the steps lie, and the order in which they do: the number on the sheet of tooth 0, whether it counts
back, and its sign."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TeethOffSheet:
    """Index deviations of a gear in um: ``off`` (z,) about its ``sheet`` (z,), with their ``covariance`` (z, z), the
    sheet's ``uncertainty``; ``steps`` (z, z) makes steps from tooth to tooth of them."""

    gear: int
    off: FloatArray
    covariance: FloatArray
    sheet: FloatArray
    uncertainty: float
    steps: FloatArray

    @property
    def whole(self) -> FloatArray:
        """The same (z,) without any sheet."""
        return np.asarray(self.sheet + self.off)

    def within(self, values: FloatArray, part: float) -> float:
        """What a part of the steps of some deviations (z,) keep within, um."""
        return float(np.quantile(np.abs(self.steps @ values), part))

    @property
    def contradicted(self) -> bool:
        """Whether half of the steps, or all but four, are off by more than the sheet's uncertainty and the fit leave
        open, and are not recognised; and by a good part of what they are without any sheet, or another order fits.
        A gear may have one wave over its teeth that the sheet lacks, and all its steps are then off: where nothing else
        is, the sheet is right.
        """
        doubt = float(np.median(np.diag(self.steps @ self.covariance @ self.steps.T)))
        z = self.off.size
        half = min(0.5, (z - WRONG_TEETH - 1.0) / (z - 1.0))
        off = self.within(self.off, half)
        least = DOUBTED_SHEET_SCATTER * float(ndtri(0.5 * (1.0 + half))) * math.sqrt(2.0 * self.uncertainty**2 + doubt)
        if off < least or self.recognised:
            return False
        if off < OWN * self.within(self.whole, half):
            return self.elsewhere is not None
        return self.within(_without_wave(self.off), half) > least

    @property
    def elsewhere(self) -> Ordered | None:
        """The order in which the sheet fits clearly better than as it is, and than none; None where there is none."""
        z = self.off.size
        near: list[Ordered] = []
        for first, back, sign in other_orders(z):
            sheet = sign * self.sheet[order_of(z, first, back=back)]
            near.append((self.within(self.whole - sheet, STEPS_NEAR_OTHER_ORDER_PART), first, back, sign))
        best = min(near)
        return (
            best
            if best[0]
            < OTHER_ORDER_DISTANCE_RATIO
            * min(
                self.within(self.off, STEPS_NEAR_OTHER_ORDER_PART), self.within(self.whole, STEPS_NEAR_OTHER_ORDER_PART)
            )
            else None
        )

    @property
    def recognised(self) -> bool:
        """Whether the steps are more like those of the sheet as it is than in any other order, of either sign: of
        sheets of other gears 1 of 4 z is by chance. Shafts may have waves of their own beside it, however large: beside
        orders 2, 3, 4 and 6 with a fifth more than the teeth's own steps 57, 75 and 96 of 100 gears of 18, 25 and 40
        teeth know their sheet; beside an uncertainty of 2 um, with steps of 4 um, 80, 94 and 100. Of what is on it they
        also have to show half: a right sheet shows whole, another's not at all, each give or take 1 / sqrt(z)."""
        z, steps = self.off.size, _cut(self.steps @ self.whole)
        orders = (sign * self.sheet[order_of(z, first, back=back)] for first, back, sign in other_orders(z))
        as_it_is, *others = (_cut(self.steps @ sheet) for sheet in (self.sheet, *orders))
        alike = _alike(steps, as_it_is)
        return alike > max(STEPS_SHOWN_PART * float(np.linalg.norm(as_it_is)), *(_alike(steps, one) for one in others))


def _cut(steps: FloatArray) -> FloatArray:
    """Steps (z,), the wild ones cut."""
    most = WILD * float(np.median(np.abs(steps)))
    return np.asarray(np.clip(steps, -most, most))


def _alike(steps: FloatArray, others: FloatArray) -> float:
    """How alike steps (z,) are to others, as a part of their own size; 0 where those are none."""
    size = float(np.linalg.norm(others))
    return float(steps @ others) / size if size > 0.0 else 0.0


def _without_wave(values: FloatArray) -> FloatArray:
    """Deviations (z,) without the wave over the teeth that makes the largest steps."""
    waves = np.fft.rfft(values)
    steps = np.abs(waves) * np.sin(np.pi * np.arange(waves.size) / values.size)
    steps[:2] = 0.0
    waves[int(np.argmax(steps))] = 0.0
    return np.asarray(np.fft.irfft(waves, values.size))


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
        wide = limited(model, dict.fromkeys(listed, COARSEST))
        fit = Fit.begun(*shortened(wide, foreign, few=PLACING_SAMPLES[-1]), step, trial=SHEET_FIT_ROUNDS)
    except GearpolyError:
        return None  # so rough are no gears that run: the sheets are not that far off
    teeth = [_teeth(fit, model, gear) for gear in listed]
    z_1, z_2 = (gear.z for gear in fit.model.as_built.gears)
    if z_1 == z_2:
        # Every tooth meets one other for ever, so only what both deviate together is told.
        both = len(listed) == 2 and _together(fit, *teeth).contradicted
        return [_left_out(one, "what both gears deviate together is") for one in teeth] if both else []
    return [_reread(one, model.declared) for one in teeth if one.contradicted]


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


def _teeth(fit: Fit, model: Model, gear: int) -> TeethOffSheet:
    """The teeth of a gear as the fit has them."""
    section, built, flank = gear_section(model.declared, gear), fit.model.as_built, fit.model.as_built.flanks[0]
    at = fit.linear.layout.built
    start, z = built.start(flank, gear), built.gears[gear].z
    return TeethOffSheet(
        gear=gear,
        off=built.pitch(fit.linear.system.solution[at], flank, gear),
        covariance=fit.linear.system.covariance[at, at][start : start + z, start : start + z],
        sheet=column(section, "pitch_coast_um" if flank == "coast" else "pitch_um"),
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
    _, first, back, sign = teeth.elsewhere
    return Reread(
        gear=teeth.gear,
        inspection=_counted(file, teeth.gear, order_of(teeth.off.size, first, back=back), sign=sign),
        opposite=sign < 0.0,
        says=_says(GEARS[teeth.gear], first, back=back, sign=sign) + _of_traces(file, teeth.gear),
    )


def _left_out(teeth: TeethOffSheet, what: str) -> Reread:
    """The sheet of a gear that is another's."""
    return Reread(
        gear=teeth.gear,
        inspection=None,
        opposite=False,
        says=f"the inspection of the {GEARS[teeth.gear]} gear does not fit the gear that was recorded: {what} off by "
        f"{teeth.within(teeth.off, 0.5):.1f} um or more in half of the steps from tooth to tooth; it was left out, and "
        "no physics is claimed for the difference; check whose sheet it is",
    )


def other_orders(z: int) -> Iterator[tuple[int, bool, float]]:
    """Every order of ``z`` teeth but their own: the number of tooth 0, whether they count back, and the sign."""
    for sign in (1.0, -1.0):
        for back in (False, True):
            for first in range(z):
                if first or back or sign < 0.0:
                    yield first, back, sign


def order_of(z: int, first: int, *, back: bool) -> IntArray:
    """Numbers (z,) on the sheet of the teeth 0, 1, ... of the pair."""
    return np.asarray((first + (-1 if back else 1) * np.arange(z)) % z)


def _says(name: str, first: int, *, back: bool, sign: float) -> str:
    """What the engineer should check."""
    from_0 = "" if first else ", from tooth 0 of the pair on"
    ways = [
        *([f"counts its teeth the other way round{from_0}"] if back else []),
        *([f"calls tooth {first} what is tooth 0 of the pair"] if first else []),
        *(["has the opposite sign"] if sign < 0.0 else []),
    ]
    return (
        f"the inspection of the {name} gear fits only where it {', and '.join(ways)}: it was taken so, and no physics "
        "is claimed for the difference; check how the sheet is numbered"
        + (", and the sign of pitch_um" if sign < 0.0 else "")
        + (" (single pitches counted the other way round have it)" if sign < 0.0 and back else "")
    )


def _of_traces(file: PairFile, gear: int) -> str:
    """What to tell of whole traces, which stay with the teeth that their own file gives them."""
    sheet = gear_section(file, gear).inspection
    names = [name for name in ("profile_csv", "gde") if getattr(sheet, name, None) is not None]
    return f"; traces of {names[0]} were left with the teeth that they have there" if names else ""


def _counted(file: PairFile, gear: int, order: IntArray, *, sign: float) -> Inspection:
    """The inspection of a gear with its values per tooth in another ``order`` (z,), pitch by a ``sign``."""
    sheet = gear_section(file, gear).inspection
    keys = {
        name: tuple(((sign if name.startswith("pitch") else 1.0) * np.asarray(value)[order]).tolist())
        for name, value in _listed(file, gear).items()
    }
    counted: Inspection = changed(sheet, **keys)
    return counted


def _listed_gears(file: PairFile) -> list[int]:
    """Gears (0, 1) whose inspection lists the pitch of every tooth."""
    return [gear for gear in (0, 1) if len(_listed(file, gear).get("pitch_um", ())) > 1]


def _listed(file: PairFile, gear: int) -> dict[str, Sequence[float]]:
    """What the inspection of a gear lists tooth by tooth, by its keys: nothing where nobody inspected it, or where all
    teeth have one value, and no count of them matters."""
    sheet = gear_section(file, gear).inspection
    held = {} if sheet is None else sheet.model_dump()
    return {name: value for name, value in held.items() if isinstance(value, (list, tuple))}
