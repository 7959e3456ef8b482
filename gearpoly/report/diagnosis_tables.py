"""What stands beside the findings of a diagnosis, as HTML: places, teeth, zeros, recordings, limits and times."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from gearpoly.compare.entries import Entry, causes, named
from gearpoly.compare.on_sky import Sky
from gearpoly.compare.zeros import Zeros
from gearpoly.diagnose.verdict import BuiltGear, Diagnosis
from gearpoly.report.diagnosis_findings import table
from gearpoly.report.diagnosis_report import grade_words
from gearpoly.report.diagnosis_words import NONE, capital, chance, measured, number, typeset
from gearpoly.units import DEG, NM, RPM, UM

ALONG = 6
"""Places that come along with another one and are shown at once; more are folded away."""

NUMBERED = {
    "curves": "Tooth numbers were found from the curves themselves.",
    "stated": "Tooth numbers come from the stated zeros.",
    "open": "Tooth numbers stay open: other places fit as well. Encoder readings decide.",
}


def entries(found: Sequence[Entry], *, none: str, sky: Sky | None = None) -> str:
    """A table of places where recordings and simulation differ; behind a telescope's worm as the sky shows them."""
    if not found:
        return f"<p>{none}</p>"
    first = [one for one in found if one.companion_of is None]
    along = [one for one in found if one.companion_of is not None]
    if len(along) <= ALONG:
        return _entry_table(found, sky)
    return (
        _entry_table(first, sky)
        + f"<details><summary>{len(along)} weaker ones that come along with these</summary>"
        + f"{_entry_table(along, sky)}</details>"
    )


def _entry_table(found: Sequence[Entry], sky: Sky | None) -> str:
    head = ["where", "size µm", "encoder", "mesh phase", "chance from noise", "recordings", ""]
    rows = [_entry_row(one) for one in found]
    if sky is not None:
        head.insert(2, "on the sky")
        for row, one in zip(rows, found, strict=True):
            row.insert(2, escape(sky.says(one).removesuffix(" on the sky")))
    return table(head, rows, name="places")


def _entry_row(one: Entry) -> list[str]:
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
        escape(capital(named(one))),
        size,
        "" if one.encoder_deg is None else f"{number(one.encoder_deg, 1)}°",
        "" if one.phase is None else f"{number(one.phase[0], 2)} to {number(one.phase[1], 2)}",
        chance(one.p_value),
        ", ".join(str(k) for k in one.recordings),
        escape(typeset("; ".join(notes))),
    ]


def as_built(diagnosis: Diagnosis) -> str:
    """Which grades the gears fit as they run, and their teeth in numbers."""
    parts = []
    for name, gear in zip(("driving", "driven"), diagnosis.built, strict=True):
        ideal = diagnosis.comparison.gears[("driving", "driven").index(name)].ideal
        thick = "" if gear.thickness is None else f"; mean tooth thickness deviation ({measured(*gear.thickness)}) µm"
        parts.append(f"<p>The {name} gear {grade_words(gear, ideal=ideal)}{thick}.</p>")
    if diagnosis.compliance_scale is not None:
        parts.append(f"<p>Compliance over the declared one: <b>{measured(*diagnosis.compliance_scale)}</b>.</p>")
    for name, gear in zip(("driving", "driven"), diagnosis.built, strict=True):
        parts.append(f"<details><summary>Teeth of the {name} gear in numbers</summary>{_teeth(gear)}</details>")
    return "\n".join(parts)


def _teeth(gear: BuiltGear) -> str:
    rows = [[str(tooth)] for tooth in range(gear.first.pitch.size)]
    head = ["tooth"]
    for one in gear.flanks:
        head += [f"pitch (index deviation) µm, {one.flank} flank", f"profile slope µm, {one.flank} flank"]
        columns = zip(rows, one.pitch, one.pitch_std, one.slope, one.slope_std, strict=True)
        for row, p, p_std, s, s_std in columns:
            row += [measured(float(p), float(p_std)), measured(float(s), float(s_std))]
    return table(tuple(head), rows, name="teeth")


def alignment(diagnosis: Diagnosis) -> str:
    """How the recordings lie on the teeth, and the other ways in which they might."""
    found = diagnosis.comparison.alignment
    parts = []
    if not found.phased and not found.rough:
        parts.append("<p>The curves are too flat to place the teeth; the stated zeros stand.</p>")
    parts.append(f"<p>{NUMBERED[found.numbering]}</p>")
    rows = [_zeros_row("chosen", found.zeros, found.std_driving, found.std_driven)]
    rows += [_zeros_row("or perhaps", one) for one in found.rivals[:3]]
    if found.contradicted is not None:
        rows.append(_zeros_row("fits much better, against the stated zeros", found.contradicted))
    parts.append(table(("", "driving zero", "driven zero", "left over, rms µm"), rows, name="zeros"))
    if len(found.rivals) > 3:
        parts.append(f"<p>And {len(found.rivals) - 3} more that fit nearly as well.</p>")
    return "\n".join(parts)


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


def recordings(diagnosis: Diagnosis) -> str:
    """The recordings with their conditions, their noise and what is left of each."""
    comparison, rows, done = diagnosis.comparison, [], []
    for k, (one, noise, left) in enumerate(
        zip(comparison.aligned, comparison.located.noises, diagnosis.left, strict=True)
    ):
        rows.append(
            [
                f"{k}: {escape(one.cleaned.recording.source.name)}",
                one.ran.replace(" flank", ""),
                number(one.torque / NM, 2),
                NONE if one.speed is None else number(one.speed / RPM, 1),
                str(one.theta_2.size),
                number(one.cycles, 2),
                number(one.mean / UM, 3),
                number(one.rms / UM, 3),
                number(float(left.std()) / UM, 4),
                number(diagnosis.noise_by_recording[k] / UM, 4),
                escape(noise.basis),
            ]
        )
        done += [f"Recording {k}: {deed.says}" for deed in one.cleaned.done]
    head = (
        "recording", "flank", "N·m", "rpm", "samples", "hunting cycles", "mean before µm", "rms before µm",
        "rms after µm", "noise µm", "noise from",
    )  # fmt: skip
    out = table(head, rows, name="recordings")
    return out + (
        f"<p>Noise pooled: <b>{number(diagnosis.noise / UM, 4)} µm</b> rms. Before: recorded minus declared "
        "simulation, about its mean. After: what nothing explains, on all samples.</p>"
    ) + bullets(done, none="")  # fmt: skip


def bullets(lines: Sequence[str], *, none: str) -> str:
    """A list of sentences, or what to say when there is none."""
    if not lines:
        return f"<p>{none}</p>" if none else ""
    return "<ul>" + "".join(f"<li>{escape(typeset(capital(line)))}</li>" for line in lines) + "</ul>"


def timings(diagnosis: Diagnosis) -> str:
    """How long each stage of the diagnosis took."""
    if not diagnosis.seconds:
        return "<p>No times were taken.</p>"
    total = sum(seconds for _, seconds in diagnosis.seconds)
    rows = [
        [escape(name), number(seconds, 1), f"{number(100.0 * seconds / max(total, 1e-9), 0)} %"]
        for name, seconds in diagnosis.seconds
    ]
    return table(("stage", "s", "share"), [*rows, ["together", number(total, 1), ""]], name="times")
