"""A comparison in words and as JSON: how the recordings lie on the teeth, their noise, and where they differ."""

from __future__ import annotations

import json
import math
from collections import Counter
from typing import Any

from rich.console import Console
from rich.table import Table

from gearpoly import __version__
from gearpoly.compare.beside import Aligned, Comparison
from gearpoly.compare.division import Division
from gearpoly.compare.entries import Entry, named, says
from gearpoly.compare.lost_motion import lost_motions
from gearpoly.compare.on_sky import Sky, arcsec_words, sky_of
from gearpoly.compare.scale import Scale
from gearpoly.compare.zeros import Alignment, Zeros
from gearpoly.report.alike import together
from gearpoly.report.lost_motion_report import lost_json, lost_rows
from gearpoly.units import DEG, NM, RPM, UM

LINE_EACH = 3
"""Entries that come along with another one and still get a line each; more are summed up."""

FIRST_NAMED = 8
"""Of these so many are named, those that were told first; --json lists all."""


def _deg(angle: float | None, digits: int = 4) -> float | None:
    return None if angle is None else round(angle / DEG, digits) % 360.0


def _zeros_json(zeros: Zeros) -> dict[str, float | None]:
    return {
        "driving_zero_deg": _deg(zeros.driving),
        "driven_zero_deg": _deg(zeros.driven),
        "rms_um": zeros.rms / UM,
    }


def alignment_json(comparison: Comparison) -> dict[str, Any]:
    """The contract's ``alignment``, with what it rests on and its rivals."""
    found = comparison.alignment
    return {
        "driving_zero_deg": _deg(found.zeros.driving),
        "driven_zero_deg": _deg(found.zeros.driven),
        "std_deg": found.std / DEG,
        "driving_std_deg": None if found.zeros.driving is None else found.std_driving / DEG,
        "driven_std_deg": None if found.zeros.driven is None else found.std_driven / DEG,
        "numbered": all(found.numbered),
        "numbered_gears": [name for name, told in zip(("driving", "driven"), found.numbered, strict=True) if told],
        "numbering": found.numbering,
        "phased": found.phased,
        "rivals": [_zeros_json(one) for one in found.rivals],
        "contradicted_by": None if found.contradicted is None else _zeros_json(found.contradicted),
    }


def comparison_json(comparison: Comparison) -> dict[str, Any]:
    """Everything as plain values, sizes in um and angles in deg."""
    located = comparison.located
    repeatable = located.repeatable_rms
    sky, lost = sky_of(comparison), lost_motions(comparison)
    return {
        "gearpoly": __version__,
        "pair": comparison.name,
        "noise_um": located.noise_level / UM,
        "noise_um_by_recording": [noise.level / UM for noise in located.noises],
        "alignment": alignment_json(comparison),
        "where": entries_json(located.where, sky),
        "residual_rms_um": located.residual_rms / UM,
        "divides_um": division_json(located.division),
        **({} if repeatable is None else {"repeatable_rms_um": repeatable / UM}),
        **({} if sky is None else {"residual_rms_arcsec": sky.arcsec(located.residual_rms / UM)}),
        **({} if comparison.scale is None else {"reading_scale": _scale_json(comparison.scale)}),
        **({"lost_motion": [lost_json(one) for one in lost]} if lost else {}),
        "recordings": [
            {
                "file": str(one.cleaned.recording.source),
                "flank": one.flank,
                **({"reversed": True} if one.cleaned.backward else {}),
                "torque_nm": one.torque / NM,
                "speed_rpm": None if one.speed is None else one.speed / RPM,
                "samples": one.cleaned.size,
                "hunting_cycles": one.cycles,
                "mean_um": one.mean / UM,
                "residual_rms_um": one.rms / UM,
                "noise_um": noise.level / UM,
                "noise_std_um": noise.level_std / UM,
                "noise_from": noise.basis,
                "reading_step_deg": dict(zip(("driving", "driven"), map(_deg_step, one.steps), strict=True)),
                "rounding_um": one.rounding / UM,
                "divides_um": division_json(located.divisions[k]),
                "repeatable_rms_um": None if noise.repeatable is None else noise.repeatable / UM,
                "ratio_off": one.cleaned.ratio_offset / one.cleaned.ratio if one.cleaned.ratio_is_off else None,
                "done": [deed.says for deed in one.cleaned.done],
            }
            for k, (one, noise) in enumerate(zip(comparison.aligned, located.noises, strict=True))
        ],
        "remarks": list(comparison.remarks),
    }


def _scale_json(scale: Scale) -> dict[str, Any]:
    """What one reading was times the truth, before it was taken out."""
    out: dict[str, Any] = {"gear": scale.shaft, "ratio": scale.value, "std": scale.std}
    if scale.by_recording:
        out["ratio_by_recording"] = dict(zip(map(str, scale.of), scale.by_recording, strict=True))
    return out


def entries_json(entries: tuple[Entry, ...], sky: Sky | None) -> list[dict[str, object]]:
    """Places where recordings and simulation differ; behind a telescope's worm with sizes in arcsec, periods in s."""
    return [entry.to_json() | ({} if sky is None else sky.to_json(entry)) for entry in entries]


def entry_words(entry: Entry, sky: Sky | None) -> str:
    """A place in words, behind a telescope's worm as the sky shows it too."""
    return says(entry) if sky is None else f"{says(entry)}: {sky.says(entry)}"


def _deg_step(step: float | None) -> float | None:
    return None if step is None else step / DEG


def division_json(division: Division) -> dict[str, float]:
    """Rms in um of what is listed, of what teeth may hold, and of the rest."""
    return {
        "physics": division.physics / UM,
        "as_built": division.as_built / UM,
        "noise": division.noise / UM,
    }


def division_words(division: Division) -> str:
    """How the mismatch divides, in words."""
    return (
        f"{division.physics / UM:.3f} um rms in what is listed below, {division.as_built / UM:.3f} um in what "
        f"inspection or grade leave open of each tooth, {division.noise / UM:.3f} um in neither"
    )


def json_text(comparison: Comparison) -> str:
    """``comparison_json`` as text; nothing in it is infinite or no number."""
    return json.dumps(comparison_json(comparison), allow_nan=False, indent=1)


def print_comparison(console: Console, comparison: Comparison) -> None:
    """Print what an engineer asks first: do they lie on each other, how much is left, how loud is the noise, where."""
    located = comparison.located
    table = Table(title=comparison.name, title_justify="left", show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    gears = " on ".join(f"{gear.z} teeth ({gear.known_by})" for gear in comparison.gears)
    table.add_row("gears", gears)
    for k, one in enumerate(comparison.aligned):
        table.add_row(f"recording {k}", _recording_words(comparison, k, one))
    table.add_row("zeros", _zero_words(comparison))
    others = zeros_apart(comparison.alignment)
    for k, rival in enumerate(others[:3]):
        table.add_row("or perhaps" if k == 0 else "", f"{_readings(rival)}: {rival.rms / UM:.3f} um rms left")
    more = len(others) - 3
    if more > 0:
        table.add_row("", f"and {more} more that fit nearly as well")
    repeats = located.repeatable_rms
    sky = sky_of(comparison)
    table.add_row(
        "left over",
        f"{located.residual_rms / UM:.3f} um rms about each mean, noise {located.noise_level / UM:.3f} um"
        + ("" if repeats is None else f", of which {repeats / UM:.3f} um repeats every hunting cycle")
        + ("" if sky is None else f"; {arcsec_words(sky.arcsec(located.residual_rms / UM))} rms on the sky"),
    )
    table.add_row("made up of", division_words(located.division))
    for one_lost in lost_motions(comparison):
        for name, words in lost_rows(one_lost):
            table.add_row(name, words)
    console.print(table)
    if located.where:
        console.print("where they differ, most of the mismatch first:", style="bold", highlight=False)
        for line in _entry_lines(located.where, sky):
            console.print(f"  {line}", highlight=False, soft_wrap=True)
    else:
        console.print(
            "nothing beyond noise, and beyond what inspection or grade leave open of each tooth",
            style="bold",
            highlight=False,
        )
    for one_noise in dict.fromkeys(noise.basis for noise in located.noises):
        console.print(f"noise from {one_noise}", style="dim", highlight=False, soft_wrap=True)
    done = (f"recording {k}: {deed.says}" for k, one in enumerate(comparison.aligned) for deed in one.cleaned.done)
    for line in together(done):
        console.print(line, style="dim", highlight=False, soft_wrap=True)
    for remark in together(comparison.remarks):
        console.print(f"note: {remark}", style="yellow", highlight=False, soft_wrap=True)


def _entry_lines(entries: tuple[Entry, ...], sky: Sky | None) -> list[str]:
    """One line per entry; of many that come along with another one, only what they are, on one line."""
    along: dict[str, list[Entry]] = {}
    for entry in entries:
        if entry.companion_of is not None:
            along.setdefault(entry.companion_of, []).append(entry)
    alone = [e for e in entries if e.companion_of is None or len(along[e.companion_of]) <= LINE_EACH]
    twice = {name for name, count in Counter((e.kind, named(e)) for e in alone).items() if count > 1}
    out = []
    for e in alone:
        # What two recordings show alike is told of each.
        where = f" (recording {e.recordings[0]})" if (e.kind, named(e)) in twice and _of_one(e) else ""
        out.append(_capital(entry_words(e, sky)) + where)
    for parent, several in along.items():
        if len(several) > LINE_EACH:
            names = ", ".join(named(e) for e in several[:FIRST_NAMED])
            more = f" and {len(several) - FIRST_NAMED} more" if len(several) > FIRST_NAMED else ""
            out.append(f"With {parent} come {len(several)} weaker ones: {names}{more}")
    return out


def _of_one(entry: Entry) -> bool:
    """Whether it is a wave of one recording, whose words do not say of which."""
    return len(entry.recordings) == 1 and not (entry.drift or entry.moment or entry.burst) and entry.kind != "condition"


def _recording_words(comparison: Comparison, k: int, one: Aligned) -> str:
    speed = "" if one.speed is None else f", {one.speed / RPM:.4g} rpm"
    load = f"{one.torque / NM:g} N.m"
    noise = comparison.located.noises[k].level / UM
    return (
        f"{one.cleaned.recording.source.name}: {one.ran}, {load}{speed}, {one.cleaned.size} samples, "
        f"{one.cycles:.3g} hunting cycles; left {one.rms / UM:.3f} um rms about {one.mean / UM:+.3f} um, "
        f"noise {noise:.3f} um"
    )


def zeros_apart(found: Alignment) -> list[Zeros]:
    """The other zeros that fit nearly as well, best first: those that read otherwise. Where one shaft alone was read,
    places that differ in the other's turns do not."""
    read = {_readings(found.zeros)}
    out = []
    for one in found.rivals:
        if _readings(one) not in read:
            read.add(_readings(one))
            out.append(one)
    return out


def _readings(zeros: Zeros) -> str:
    parts = [
        f"{name} {round(angle / DEG, 3) % 360.0:.3f} deg"
        for name, angle in (("driving", zeros.driving), ("driven", zeros.driven))
        if angle is not None
    ]
    return ", ".join(parts)


def _zero_words(comparison: Comparison) -> str:
    found = comparison.alignment
    if not found.phased and not found.rough:
        return f"{_readings(found.zeros)}, not told by the curves, which are too flat to place the teeth"
    digits = max(1, min(4, 2 - math.floor(math.log10(max(found.std / DEG, 1e-6)))))
    how = {
        "curves": "tooth numbers found from the curves themselves",
        "stated": "tooth numbers from the stated zeros",
        "open": "tooth numbers stay open: other places fit as well",
    }[found.numbering]
    return f"{_readings(found.zeros)}, +- {found.std / DEG:.{digits}f} deg; {how}"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
