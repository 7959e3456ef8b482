"""What stands beside the findings of a diagnosis on its page: places, teeth, zeros, recordings, limits and times."""

from __future__ import annotations

from collections.abc import Sequence

from gearpoly.compare.entries import Entry, causes, named
from gearpoly.compare.on_sky import Sky
from gearpoly.compare.zeros import Zeros
from gearpoly.diagnose.verdict import BuiltGear, Diagnosis
from gearpoly.page.typeset import typeset
from gearpoly.report.alike import together
from gearpoly.report.compare_report import zeros_apart
from gearpoly.report.diagnosis_findings import Shown
from gearpoly.report.diagnosis_report import LISTED, grade_words
from gearpoly.report.diagnosis_words import NONE, capital, chance, measured, number
from gearpoly.units import DEG, NM, RPM, UM

ALONG_SHOWN = 6
"""Places that come along with another one and are shown at once; more are folded away."""

NUMBERED = {
    "curves": "Tooth numbers were found from the curves themselves.",
    "stated": "Tooth numbers come from the stated zeros.",
    "open": "Tooth numbers stay open: other places fit as well. Encoder readings decide.",
}


def entries(found: Sequence[Entry], *, sky: Sky | None = None) -> Shown:
    """Places where recordings and simulation differ; behind a telescope's worm as the sky shows them. Columns that say
    nothing of any are left out."""
    shown, folded = parted(found)
    head = ["where", "size µm", "encoder", "mesh phase", "chance from noise", "recordings", ""]
    if sky is not None:
        head.insert(2, "on the sky")
    rows = [_entry_row(one, sky) for one in (*shown, *folded)]
    kept = [k for k in range(len(head)) if any(row[k] for row in rows)]
    rows = [[row[k] for k in kept] for row in rows]
    return {"head": [head[k] for k in kept], "rows": rows[: len(shown)], "folded": rows[len(shown) :]}


def parted(found: Sequence[Entry]) -> tuple[list[Entry], list[Entry]]:
    """Places that a report shows at once, the strongest first, and those that it folds away: many that come along with
    others, and what is left beyond the first ones."""
    along = [one for one in found if one.companion_of is not None]
    plain = [one for one in found if len(along) <= ALONG_SHOWN or one.companion_of is None]
    shown = plain[:LISTED]
    return shown, [one for one in found if not any(one is other for other in shown)]


def _entry_row(one: Entry, sky: Sky | None) -> list[str]:
    if one.amplitude_um is not None:
        size = measured(one.amplitude_um, one.std_um or 0.0)
    else:
        size = NONE if one.rms_um is None else f"{number(one.rms_um, 3)} rms"
    notes = [one.label] if one.label else []
    notes += [f"{part} falls there too" if one.of_the_pair else part for part in one.parts]
    if one.companion_of:
        notes.append(f"comes with {one.companion_of}")
    notes += [f"or {rival}" for rival in one.rivals]
    notes += [causes(one)] if one.could_be else []
    return [
        capital(named(one)),
        size,
        *([] if sky is None else [sky.says(one).removesuffix(" on the sky")]),
        "" if one.encoder_deg is None else f"{number(one.encoder_deg, 1)}°",
        "" if one.phase is None else f"{number(one.phase[0], 2)} to {number(one.phase[1], 2)}",
        chance(one.p_value),
        ", ".join(str(k) for k in one.recordings),
        typeset("; ".join(notes)),
    ]


def as_built(diagnosis: Diagnosis) -> Shown:
    """Which grades the gears fit as they run, and their teeth in numbers."""
    gears = []
    for name, gear in zip(("driving", "driven"), diagnosis.built, strict=True):
        thick = "" if gear.thickness is None else f"; mean tooth thickness deviation ({measured(*gear.thickness)}) µm"
        words = grade_words(gear) + thick
        gears.append({"name": name, "words": words, **_teeth(gear)})
    scale = diagnosis.compliance_scale
    return {"gears": gears, "compliance": None if scale is None else measured(*scale)}


def _teeth(gear: BuiltGear) -> Shown:
    rows = [[str(tooth)] for tooth in range(gear.first.pitch.size)]
    head = ["tooth"]
    for one in gear.flanks:
        head += [f"pitch (index deviation) µm, {one.flank} flank", f"profile slope µm, {one.flank} flank"]
        columns = zip(rows, one.pitch, one.pitch_std, one.slope, one.slope_std, strict=True)
        for row, p, p_std, s, s_std in columns:
            row += [measured(float(p), float(p_std)), measured(float(s), float(s_std))]
    return {"head": head, "rows": rows}


def alignment(diagnosis: Diagnosis) -> Shown:
    """How the recordings lie on the teeth, and the other ways in which they might."""
    found = diagnosis.comparison.alignment
    rows = [_zeros_row("chosen", found.zeros, found.std_driving, found.std_driven)]
    rows += [_zeros_row("or perhaps", one) for one in zeros_apart(found)[:3]]
    if found.contradicted is not None:
        rows.append(_zeros_row("fits much better, against the stated zeros", found.contradicted))
    return {
        "flat": not found.phased and not found.rough,
        "stated": found.numbering == "stated",
        "numbered": NUMBERED[found.numbering],
        "rows": rows,
        "more": max(0, len(zeros_apart(found)) - 3),
    }


def _zeros_row(name: str, zeros: Zeros, std_driving: float = 0.0, std_driven: float = 0.0) -> list[str]:
    def reading(angle: float | None, std: float) -> str:
        if angle is None:
            return "no encoder"
        # Rounded first, so that 359.9999 reads 0.
        return (
            f"{number(round(angle / DEG, 3) % 360.0, 3)}°"
            if std <= 0.0
            else f"{measured(angle / DEG % 360.0, std / DEG)}°"
        )

    return [name, reading(zeros.driving, std_driving), reading(zeros.driven, std_driven), number(zeros.rms / UM, 3)]


def recordings(diagnosis: Diagnosis) -> Shown:
    """The recordings with their conditions, their noise and what is left of each."""
    comparison, rows, done = diagnosis.comparison, [], []
    for k, (one, noise, left) in enumerate(
        zip(comparison.aligned, comparison.located.noises, diagnosis.left, strict=True)
    ):
        rows.append(
            [
                f"{k}: {one.cleaned.recording.source.name}",
                one.ran.replace(" flank", ""),
                number(one.torque / NM, 2),
                NONE if one.speed is None else number(one.speed / RPM, 1),
                str(one.theta_2.size),
                number(one.cycles, 2),
                number(one.mean / UM, 3),
                number(one.rms / UM, 3),
                number(float(left.std()) / UM, 4),
                number(diagnosis.noise_by_recording[k] / UM, 4),
                noise.basis,
            ]
        )
        done += [f"Recording {k}: {deed.says}" for deed in one.cleaned.done]
    head = (
        "recording", "flank", "N·m", "rpm", "samples", "hunting cycles", "mean before µm", "rms before µm",
        "rms after µm", "noise µm", "noise from",
    )  # fmt: skip
    return {"head": head, "rows": rows, "noise": number(diagnosis.noise / UM, 4), "done": sentences(together(done))}


def sentences(lines: Sequence[str]) -> list[str]:
    """Lines as the page prints them."""
    return [typeset(capital(line)) for line in lines]


def timings(diagnosis: Diagnosis) -> list[tuple[str, str, str]]:
    """How long each stage of the diagnosis took, in s and as a share."""
    total = sum(seconds for _, seconds in diagnosis.seconds)
    rows = [
        (name, number(seconds, 1), f"{number(100.0 * seconds / max(total, 1e-9), 0)} %")
        for name, seconds in diagnosis.seconds
    ]
    return [*rows, ("together", number(total, 1), "")] if rows else []
