"""A diagnosis in words and as the contract's JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

from rich.console import Console
from rich.table import Table

from gearpoly import __version__
from gearpoly.compare.entries import chance_words
from gearpoly.compare.on_sky import sky_of
from gearpoly.diagnose.heldout import Checked, Rms, repeatable
from gearpoly.diagnose.limits import Exceeded
from gearpoly.diagnose.verdict import BuiltFlank, BuiltGear, Diagnosis, Finding, Rival
from gearpoly.physics.words import Reported
from gearpoly.report.alike import together
from gearpoly.report.compare_report import alignment_json, entries_json, entry_words
from gearpoly.report.diagnosis_sky import finding_json, finding_words
from gearpoly.units import UM

STATUS = {
    "nothing_missing": "Nothing is missing: recordings and simulation agree to the noise.",
    "explained": "The mismatch is explained.",
    "partly_explained": "The mismatch is explained in part; what is left has no sure cause. It is located below.",
    "unexplained": "There is a mismatch that has no sure cause. It is located below, and not named.",
}

STOPPED = {
    "nothing_missing": "Nothing was found in the time given, and more may be missing.",
    "explained": "The mismatch is explained as far as the time given went.",
    "partly_explained": "The mismatch is explained in part; of the rest no cause was found in the time given.",
    "unexplained": "There is a mismatch of which no cause was found in the time given. It is located below.",
}
"""The same of a search that time has stopped: it says nothing of what it did not ask."""

SAYS_BEYOND_LIMITS = (
    "No physics of the catalogue is missing: teeth that deviate make the mismatch, and by more than their limits allow."
)
"""The same where nothing is missing and a gear breaks its limits: then they do not agree."""

SAYS_TEETH_DIFFER = (
    "No physics of the catalogue is missing: teeth as they were built make the mismatch, and the rest is noise."
)
"""The same where the declared simulation itself does not agree: what nobody measured of the teeth makes up for it."""

SAYS_NOTHING_STANDS_OUT = (
    "Nothing stands out of the noise; yet recordings and simulation do not agree to it, and no teeth make up for that."
)
"""The same where teeth were not estimated, or foretell no more of unseen data than the declared simulation does."""

AGREES_WITHIN = 1.1
"""Times the noise that unseen samples of the declared simulation may be left at for both to agree: what repeats is then
less than half of the noise. A judgement."""

PLACES_TOLD = 4
"""Places that the terminal tells of the whole mismatch; page and JSON have all."""

LISTED = 12
"""Places without an explanation that terminal and page list at once, the surest first."""

WHOLE_NUMBERS = ("order", "recording")
"""Parameters that are whole numbers."""

LEAST_STD_SHARE = 1e-6
"""Standard error over its value below which none is told: nothing is measured so well, but a relief that is surely a
line has an exponent of 1."""


def verdict_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """The contract's verdict, sizes in um and angles in deg."""
    located = diagnosis.comparison.located
    sky = sky_of(diagnosis.comparison)
    built = {name: _built_json(gear) for name, gear in zip(("driving", "driven"), diagnosis.built, strict=True)} | (
        {}
        if diagnosis.compliance_scale is None
        else {"compliance_scale": {"value": diagnosis.compliance_scale[0], "std": diagnosis.compliance_scale[1]}}
    )
    return {
        "gearpoly": __version__,
        "pair": diagnosis.comparison.name,
        "status": diagnosis.status,
        "noise_um": diagnosis.noise / UM,
        "noise_um_by_recording": [level / UM for level in diagnosis.noise_by_recording],
        "alignment": alignment_json(diagnosis.comparison),
        "where": entries_json(located.where, sky),
        "missing": [_finding_json(one) | finding_json(one, located, sky) for one in diagnosis.findings],
        "as_built": built,
        "unexplained": entries_json(diagnosis.unexplained, sky),
        "fit": {
            "heldout_rms_um": {"before": diagnosis.before.unseen / UM, "after": diagnosis.after.unseen / UM},
            "train_rms_um": {"before": diagnosis.before.seen / UM, "after": diagnosis.after.seen / UM},
            "as_built_only_heldout_rms_um": diagnosis.as_built_only.unseen / UM,
            "repeatable_mismatch_um": {
                "before": repeatable(diagnosis.before.unseen, diagnosis.noise) / UM,
                "after": repeatable(diagnosis.after.unseen, diagnosis.noise) / UM,
            },
            "held_out": diagnosis.held_out_by,
        }
        | _unseen_json(diagnosis.unseen),
        "not_excluded": list(diagnosis.not_excluded),
        "remarks": list(diagnosis.remarks),
    }


def _unseen_json(found: Checked | None) -> dict[str, Any]:
    """Mean squares of what unseen blocks leave, over that of noise; nothing where nothing was to be named."""
    if found is None:
        return {}
    names = {"declared": found.declared, "as_built": found.as_built, "with_names": found.named, "std": found.std}
    return {"unseen_mean_square": names}


def json_text(diagnosis: Diagnosis) -> str:
    """``verdict_json`` as text; nothing in it is infinite or no number."""
    return json.dumps(verdict_json(diagnosis), allow_nan=False, indent=1)


def _finding_json(one: Finding) -> dict[str, Any]:
    out: dict[str, Any] = {"physics": one.claim.physics.name}
    out |= _place_json(one)
    out["parameters"] = _parameters_json(one.parameters)
    out["says"] = one.says
    out["heldout_rms_um"] = {"without": one.without.unseen / UM, "with": one.with_.unseen / UM}
    out["probability"] = one.probability
    out["unknown_probability"] = one.unknown_probability
    out["gain"] = one.gain
    if one.foretold is not None:
        out["heldout_condition_gain"] = one.foretold
    out["model"] = one.claim.physics.equation
    out["indistinguishable_from"] = [_rival_json(rival) for rival in one.rivals]
    if one.separation is not None:
        out["would_separate"] = {
            "recording": one.separation.recording.to_json(),
            "separability": one.separation.separability,
            "separability_now": one.separation.now,
            "says": one.separation.recording.says,
        }
    return out


def _place_json(one: Finding | Rival) -> dict[str, Any]:
    place = one.claim.place
    out: dict[str, Any] = {}
    if place.gear_name is not None:
        out["gear"] = place.gear_name
    if place.tooth is not None:
        out |= {"tooth": one.tooth, "encoder_deg": one.encoder_deg}
    if place.flank is not None and place.flank != "drive":
        out["flank"] = place.flank
    recordings = one.recordings if isinstance(one, Finding) else place.recordings
    if recordings:
        out["recordings"] = list(recordings)
    return out


def _rival_json(rival: Rival) -> dict[str, Any]:
    out: dict[str, Any] = {"physics": rival.claim.physics.name} | _place_json(rival)
    out["probability"] = rival.probability
    out["parameters"] = {name: {"value": value} for name, (value, _) in rival.parameters.items()}
    return out


def _parameters_json(found: Reported) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for name, (value, std) in found.items():
        out[name] = {"value": round(value) if name in WHOLE_NUMBERS else value, "std": std}
    return out


def _built_json(gear: BuiltGear) -> dict[str, Any]:
    def listed(values: Any) -> list[float]:
        return [round(float(v), 4) for v in values]

    out: dict[str, Any] = {
        "flanks": [one.flank for one in gear.flanks],
        "pitch_um": listed(gear.first.pitch),
        "pitch_std_um": listed(gear.first.pitch_std),
        "profile_slope_um": listed(gear.first.slope),
        "profile_slope_std_um": listed(gear.first.slope_std),
    }
    if gear.coast is not None:
        out |= {
            "pitch_coast_um": listed(gear.coast.pitch),
            "pitch_coast_std_um": listed(gear.coast.pitch_std),
            "profile_slope_coast_um": listed(gear.coast.slope),
            "profile_slope_coast_std_um": listed(gear.coast.slope_std),
        }
    if gear.thickness is not None:
        out |= {"tooth_thickness_um": gear.thickness[0], "tooth_thickness_std_um": gear.thickness[1]}
    told = gear.estimated and not gear.ungraded
    needed, kept = (gear.grade_needed, gear.grade_kept) if told else (None, None)
    out |= {"grade_needed": needed, "grade_kept": kept, "grade_edition": gear.grade_edition}
    out |= {} if told else {"ungraded": grade_words(gear)}
    out["exceeds"] = [_exceeded_json(one) for one in gear.exceeded]
    return out


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict in one sentence."""
    if diagnosis.stopped:
        return STOPPED[diagnosis.status]
    if diagnosis.status == "nothing_missing":
        if any(gear.exceeded for gear in diagnosis.built):
            return SAYS_BEYOND_LIMITS
        if diagnosis.before.unseen > AGREES_WITHIN * diagnosis.noise:
            teeth_tell = (
                any(gear.estimated for gear in diagnosis.built) and diagnosis.after.unseen < diagnosis.before.unseen
            )
            return SAYS_TEETH_DIFFER if teeth_tell else SAYS_NOTHING_STANDS_OUT
    return STATUS[diagnosis.status]


def grade_words(gear: BuiltGear) -> str:
    """What the recordings say of a gear's grade, as what follows "the driving gear"; nothing of one whose teeth were
    not estimated."""
    if not gear.estimated:
        return "is declared without deviations: its teeth were not estimated one by one, and no grade is told"
    if gear.ungraded:
        return gear.ungraded
    by, edition = "by single pitch, cumulative pitch and profile slope", gear.grade_edition
    unjudged = "profile form is not judged"
    if gear.grade_needed is None:
        return f"as it runs fits no ISO 1328-1 grade ({edition}) {by}; {unjudged}"
    if gear.grade_needed == gear.grade_kept:
        return f"as it runs fits ISO 1328-1 grade {gear.grade_kept} ({edition}) {by}; {unjudged}"
    kept = "" if gear.grade_kept is None else f", and surely keeps grade {gear.grade_kept}"
    return f"as it runs needs ISO 1328-1 grade {gear.grade_needed} ({edition}) or a coarser one{kept}, {by}; {unjudged}"


def _exceeded_json(one: Exceeded) -> dict[str, Any]:
    out: dict[str, Any] = {"limit": one.limit.kind.replace(" ", "_")}
    out |= {"grade": one.limit.grade} if one.limit.grade is not None else {"key": one.limit.key}
    out |= {"value_um": one.value, "std_um": one.std, "by_um": one.by, "teeth": list(one.teeth)}
    return out if one.flank is None else out | {"flank": one.flank}


def _print_where(console: Console, diagnosis: Diagnosis) -> None:
    """Print where most of the whole mismatch lies, unless it is explained: teeth as built may make it, which no list of
    what is left tells."""
    where = [one for one in diagnosis.comparison.located.where if one.companion_of is None]
    if diagnosis.status == "explained" or not where:
        return
    console.print("\nwhere recordings and declared simulation differ, most of it first:", style="bold", highlight=False)
    for entry in where[:PLACES_TOLD]:
        words = entry_words(entry, sky_of(diagnosis.comparison))
        console.print(f"  {words}", highlight=False, soft_wrap=True)


def print_diagnosis(console: Console, diagnosis: Diagnosis) -> None:
    """Print where, what, how sure, what else, before and after, what next, and what could not be excluded."""
    comparison = diagnosis.comparison
    console.print(comparison.name, style="bold", highlight=False)
    console.print(sentence(diagnosis), style="bold", highlight=False, soft_wrap=True)
    for number, one in enumerate(diagnosis.findings, 1):
        _print_finding(console, number, one, diagnosis)
    _print_where(console, diagnosis)
    if diagnosis.unexplained:
        console.print("\nlocated, and not explained:", style="bold", highlight=False)
        for entry in diagnosis.unexplained[:LISTED]:
            console.print(f"  {entry_words(entry, sky_of(comparison))}", highlight=False, soft_wrap=True)
        if (more := len(diagnosis.unexplained) - LISTED) > 0:
            console.print(f"  and {more} more, which --json and --html list", highlight=False, soft_wrap=True)
    table = Table(title="\nfit", title_justify="left", box=None, pad_edge=False, title_style="bold")
    table.add_column("")
    for name in ("unseen, um rms", "repeatable, um", "rms / noise"):
        table.add_column(name, justify="right")
    for name, rms in (
        ("declared simulation", diagnosis.before),
        ("with as-built teeth", diagnosis.as_built_only),
        ("with what was missing", diagnosis.after),
    ):
        table.add_row(name, *_rms_words(rms, diagnosis.noise))
    console.print(table)
    console.print(
        f"noise {diagnosis.noise / UM:.3f} um; unseen by the fit: {diagnosis.held_out_by}", style="dim", highlight=False
    )
    for name, gear in zip(("driving", "driven"), diagnosis.built, strict=True):
        console.print(f"the {name} gear {grade_words(gear)}", highlight=False, soft_wrap=True)
        for side in gear.flanks if gear.estimated else ():
            pitch, slope = (f"{low:.1f} to {high:.1f} um" for low, high in _ranges(side))
            words = f"   as built, {side.flank} flanks: pitch (index deviation) {pitch}, profile slope {slope}"
            console.print(words, style="dim", highlight=False, soft_wrap=True)
    if diagnosis.compliance_scale is not None:
        value, std = diagnosis.compliance_scale
        console.print(f"compliance over the declared: {value:.3f} +- {std:.3f}", highlight=False)
    for words in diagnosis.not_excluded:
        console.print(f"not excluded: {words}", style="dim", highlight=False, soft_wrap=True)
    for remark in together(diagnosis.remarks):
        console.print(f"note: {remark}", style="yellow", highlight=False, soft_wrap=True)


def _ranges(side: BuiltFlank) -> Iterator[tuple[float, float]]:
    """Least and largest pitch, and slope, in um."""
    for values in (side.pitch, side.slope):
        yield float(values.min()), float(values.max())


def _rms_words(rms: Rms, noise: float) -> tuple[str, str, str]:
    return f"{rms.unseen / UM:.4f}", f"{repeatable(rms.unseen, noise) / UM:.4f}", f"{rms.unseen / noise:.3f}"


def _print_finding(console: Console, number: int, one: Finding, diagnosis: Diagnosis) -> None:
    console.print(f"\n{number}. {one.says}", style="bold", highlight=False, soft_wrap=True)
    if one.claim.place.tooth is not None:
        tooth = "its number is open" if one.tooth is None else f"tooth {one.tooth}"
        reading = "" if one.encoder_deg is None else f", at {one.encoder_deg:.1f} deg of its encoder"
        console.print(f"   where: {one.claim.place.gear_name} gear, {tooth}{reading}", highlight=False, soft_wrap=True)
    values = ", ".join(_value_words(name, *pair) for name, pair in one.parameters.items())
    console.print(f"   model: {one.claim.physics.equation}", highlight=False, soft_wrap=True)
    console.print(f"   values: {values}", highlight=False, soft_wrap=True)
    on_sky = finding_words(one, diagnosis.comparison.located, sky_of(diagnosis.comparison))
    if on_sky:
        console.print(f"   on the sky: {on_sky}", highlight=False, soft_wrap=True)
    console.print(f"   how sure: {how_sure(one)}", highlight=False, soft_wrap=True)
    before, after = repeatable(one.without.unseen, diagnosis.noise), repeatable(one.with_.unseen, diagnosis.noise)
    console.print(
        f"   unseen data: {one.without.unseen / UM:.4f} um rms without, {one.with_.unseen / UM:.4f} with (repeatable "
        f"mismatch {before / UM:.4f} to {after / UM:.4f})",
        highlight=False,
        soft_wrap=True,
    )
    if one.foretold is not None:
        console.print(
            f"   other torques and flanks: each foretold from all others, their misfit falls by {one.foretold:,.0f}",
            highlight=False,
            soft_wrap=True,
        )
    for rival in one.rivals:
        in_100 = chance_words(rival.probability)
        console.print(f"   or else, {in_100}: {rival.says}", highlight=False, soft_wrap=True)
    if one.separation is not None:
        console.print(
            f"   to decide: {one.separation.recording.says} (separability {one.separation.separability:.2f}, now "
            f"{one.separation.now:.2f})",
            highlight=False,
            soft_wrap=True,
        )


def how_sure(one: Finding) -> str:
    """The probability of a finding, and of a cause that is not in the catalogue, in words."""
    unknown = chance_words(one.unknown_probability)
    return (
        f"{chance_words(one.probability)} that it is this; {unknown} that a cause outside the catalogue does the same"
    )


def _value_words(name: str, value: float, std: float) -> str:
    if name in WHOLE_NUMBERS:
        return f"{name} {value:.0f}"
    if std <= LEAST_STD_SHARE * abs(value):
        return f"{name} {value:.4g}"
    digits = max(0, min(9, 1 - math.floor(math.log10(std))))
    return f"{name} {value:.{digits}f} +- {std:.{digits}f}"
