"""The findings of a diagnosis as HTML: what, where, how sure, what else, before and after, and what to record next."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape

from gearpoly.compare.entries import chance_words
from gearpoly.compare.on_sky import sky_of
from gearpoly.diagnose.heldout import Rms, repeatable
from gearpoly.diagnose.verdict import Diagnosis, Finding, Rival
from gearpoly.physics.words import Reported
from gearpoly.report.diagnosis_report import STATUS, how_sure
from gearpoly.report.diagnosis_sky import finding_words
from gearpoly.report.diagnosis_words import MINUS, capital, number, parameter, physics_words, typeset
from gearpoly.units import UM

CHIP = {
    "nothing_missing": ("✓", "nothing missing"),
    "explained": ("✓", "explained"),
    "partly_explained": ("◐", "partly explained"),
    "unexplained": ("?", "unexplained"),
}
"""A status as a sign and a word, so that colour is never alone."""

LEAST = 1e-12
"""mm. Stands for no noise at all, as a made recording may have it."""

ROLES = {
    "without": "before",
    "with": "after",
    "declared simulation": "before",
    "with as-built teeth": "between",
    "with what was missing": "after",
}
"""Colour of a bar by what it stands for."""


def verdict(diagnosis: Diagnosis) -> str:
    """Status, verdict and one line per finding."""
    sign, word = CHIP[diagnosis.status]
    parts = [
        f'<p class="chip {diagnosis.status}"><span aria-hidden="true">{sign}</span> {word}</p>',
        f'<p class="sentence">{escape(STATUS[diagnosis.status])}</p>',
    ]
    if diagnosis.findings:
        lines = "".join(
            f'<li><a href="#finding-{n}">{escape(typeset(one.says))}</a> {_open(one)}'
            f"<small>{_short(one, diagnosis)}</small></li>"
            for n, one in enumerate(diagnosis.findings, 1)
        )
        parts.append(f'<ol class="found">{lines}</ol>')
    if diagnosis.unexplained:
        count = len(diagnosis.unexplained)
        plural = "places are" if count > 1 else "place is"
        parts.append(f'<p><a href="#unexplained">{count} {plural} located and not explained.</a></p>')
    before, after = (repeatable(rms.unseen, diagnosis.noise) / UM for rms in (diagnosis.before, diagnosis.after))
    parts.append(
        f'<dl class="figures"><div><dt>repeatable mismatch before</dt><dd>{number(before, 3)} µm</dd></div>'
        f"<div><dt>after, on data the fit never saw</dt><dd>{number(after, 3)} µm</dd></div>"
        f"<div><dt>noise floor</dt><dd>{number(diagnosis.noise / UM, 3)} µm rms</dd></div>"
        f"<div><dt>rms after over noise</dt><dd>{_over_noise(diagnosis.after, diagnosis.noise)}</dd></div></dl>"
    )
    return "\n".join(parts)


def _open(one: Finding) -> str:
    """A word of warning where the tooth that a sentence names has no certain number."""
    return (
        ' <span class="open">tooth number open</span> '
        if one.claim.place.tooth is not None and one.tooth is None
        else ""
    )


def _short(one: Finding, diagnosis: Diagnosis) -> str:
    a, b = (repeatable(rms.unseen, diagnosis.noise) / UM for rms in (one.without, one.with_))
    rivals = f"; {len(one.rivals)} other reading{'s' if len(one.rivals) > 1 else ''}" if one.rivals else ""
    words = "repeatable mismatch beside teeth fitted again"
    return f"{words}: {number(a, 3)} µm without it, {number(b, 3)} µm with it{rivals}"


def findings(diagnosis: Diagnosis) -> str:
    """One article per finding, most important first."""
    if not diagnosis.findings:
        return "<p>The evidence makes no missing physics necessary.</p>"
    return "\n".join(_article(n, one, diagnosis) for n, one in enumerate(diagnosis.findings, 1))


def _article(n: int, one: Finding, diagnosis: Diagnosis) -> str:
    claim = one.claim
    freedoms = sum(len(each.values) for each in one.claims)
    sure = (
        f"<b>{how_sure(one)}</b>. "
        f"Left out, the misfit (sum of squares over the noise) rises by <b>{number(one.gain, 1)}</b> for {freedoms} "
        f"free value{'s' if freedoms > 1 else ''}, everything else fitted again. Errors are one standard error."
    )
    if one.foretold is not None:
        sure += f" Foretold by all others, each torque and flank has <b>{number(one.foretold, 1)}</b> less of it."
    rows = [
        ("Where", escape(where(one)) + _show(one)),
        ("Model", f'<span class="equation">{escape(claim.physics.equation)}</span>'),
        ("Values", values_table(one.parameters)),
        *_on_the_sky(one, diagnosis),
        ("How sure", sure),
        ("What else it could be", rivals(one.rivals)),
        (
            "Before and after",
            rms_table([("without", one.without), ("with", one.with_)], diagnosis)
            + f"<p><small>{_unseen(diagnosis)}</small></p>",
        ),
        ("What would decide", decide(one)),
    ]
    body = "".join(f"<div><dt>{name}</dt><dd>{text}</dd></div>" for name, text in rows)
    name = physics_words(claim.physics.name)
    return (
        f'<article class="finding" id="finding-{n}" aria-labelledby="finding-{n}-head">'
        f'<h3 id="finding-{n}-head"><span class="n">{n}</span> {escape(typeset(one.says))} '
        f"<code>{escape(name)}</code>{_open(one)}</h3>"
        f"<dl>{body}</dl></article>"
    )


def _on_the_sky(one: Finding, diagnosis: Diagnosis) -> list[tuple[str, str]]:
    words = finding_words(one, diagnosis.comparison.located, sky_of(diagnosis.comparison))
    return [("On the sky", escape(capital(words)))] if words else []


def where(one: Finding) -> str:
    """A finding's place in words."""
    place = one.claim.place
    if one.recordings:
        several = "s" if one.recordings[1:] else ""
        return f"Measuring chain, recording{several} {', '.join(map(str, one.recordings))}"
    if place.gear_name is None:
        return "The pair as a whole" + ("" if place.flank is None else f", {place.flank} flank")
    out = f"{place.gear_name} gear" if not one.claim.physics.measures else f"measuring chain, {place.gear_name} shaft"
    if place.order is not None:
        out += f", order {place.order} per turn"
    if place.tooth is not None:
        out += f", tooth {one.tooth}" if one.tooth is not None else ", one tooth whose number is open"
    if place.flank is not None:
        out += f", {place.flank} flank"
    if one.encoder_deg is not None:
        out += (
            f"; its pitch point passes the line of centres at {one.encoder_deg:.1f}° of the {place.gear_name} encoder"
        )
        if one.tooth is None:
            out += f" (tooth {place.tooth} of the pictures below)"
    return capital(out)


def _show(one: Finding) -> str:
    """A button that leads to where the plots show it: the tooth's mesh, or the order."""
    place = one.claim.place
    if place.tooth is not None:
        at = f'data-tooth="{place.tooth}"'
    elif place.order is not None or one.claim.physics.once_per_turn:
        at = f'data-order="{place.order or 1}"'
    else:
        return ""
    return f' <button type="button" class="show" data-gear="{place.gear or 0}" {at} hidden>Show in the plots</button>'


def values_table(found: Reported) -> str:
    """Parameters with their standard errors and the keys that the JSON has them under."""
    rows = []
    for name, (value, std) in found.items():
        label, text = parameter(name, value, std)
        rows.append([escape(label), escape(text), f"<code>{escape(name)}</code>"])
    return table(("", "value ± standard error", "key"), rows, name="values")


def rivals(found: Sequence[Rival]) -> str:
    """What the recordings cannot tell a finding from."""
    if not found:
        return "Nothing else in the catalogue does the same in these recordings."
    items = []
    for one in found:
        values = ", ".join(" ".join(parameter(name, value, 0.0)) for name, (value, _) in one.parameters.items())
        items.append(
            f"<li>{escape(typeset(one.says))} <code>{escape(physics_words(one.claim.physics.name))}</code>"
            f"{_rival_place(one)}, {chance_words(one.probability)}<br><small>{escape(values)}</small></li>"
        )
    return f"<p>These recordings cannot tell it from:</p><ul>{''.join(items)}</ul>"


def _rival_place(one: Rival) -> str:
    place = one.claim.place
    words = [] if place.gear_name is None else [place.gear_name]
    if one.tooth is not None:
        words.append(f"tooth {one.tooth}")
    if place.flank is not None and place.flank != "drive":
        words.append(f"{place.flank} flank")
    return f" <small>({escape(', '.join(words))})</small>" if words else ""


def decide(one: Finding) -> str:
    """The recording that would tell a finding from its rivals."""
    if not one.rivals:
        return "No further recording is needed to name it."
    if one.separation is None:
        return "No recording that was thought of (another torque, flank, speed, encoder fit or sense) would."
    gap = one.separation
    return (
        f"<b>{escape(typeset(gap.recording.says))}</b> Separability would be {number(gap.separability, 2)}, and is "
        f"{number(gap.now, 2)} now (0: the same signal, 1: nothing in common)."
    )


def fit(diagnosis: Diagnosis) -> str:
    """Before and after for the whole model, on data that the fit never saw."""
    rows = [
        ("declared simulation", diagnosis.before),
        ("with as-built teeth", diagnosis.as_built_only),
        ("with what was missing", diagnosis.after),
    ]
    return (
        rms_table(rows, diagnosis, seen=True)
        + f"<p>{_unseen(diagnosis)} The repeatable part is √(rms² {MINUS} noise²): what of the rms no noise makes; "
        f"below {number(told_from(diagnosis) / UM, 3)} µm it cannot be told from none: the noise is known no better. "
        "The declared simulation has nothing fitted to it but the place of the zeros.</p>"
    )


def told_from(diagnosis: Diagnosis) -> float:
    """Repeatable part in mm that the noise level's own standard error alone would make: sqrt(2 noise std)."""
    noises = diagnosis.comparison.located.noises
    std = math.sqrt(sum(noise.level_std**2 for noise in noises)) / len(noises)
    return math.sqrt(2.0 * diagnosis.noise * std)


def _over_noise(rms: Rms, noise: float) -> str:
    return number(rms.unseen / max(noise, LEAST), 3)


def _unseen(diagnosis: Diagnosis) -> str:
    return f"Unseen by the fit: {escape(diagnosis.held_out_by)}. Noise floor {number(diagnosis.noise / UM, 3)} µm rms."


def rms_table(rows: Sequence[tuple[str, Rms]], diagnosis: Diagnosis, *, seen: bool = False) -> str:
    """Repeatable mismatch as bars against the noise floor, with the raw figures beside them."""
    noise = diagnosis.noise
    parts = [repeatable(rms.unseen, noise) for _, rms in rows]
    longest = max(*parts, noise, LEAST)
    floor = 100.0 * noise / longest
    out = []
    for (name, rms), part in zip(rows, parts, strict=True):
        bar = (
            f'<span class="bar" aria-hidden="true"><span class="{ROLES[name]}" '
            f'style="width:{100.0 * part / longest:.2f}%"></span><i style="left:{floor:.2f}%"></i></span>'
        )
        out.append(
            [
                escape(name),
                bar,
                number(part / UM, 3),
                number(rms.unseen / UM, 4),
                _over_noise(rms, noise),
                *([number(rms.seen / UM, 4)] if seen else []),
            ]
        )
    head = ["", '<span class="floor">┊ noise floor</span>', "repeatable µm", "rms µm", "rms / noise"]
    return table((*head, *(["rms on fitted data µm"] if seen else [])), out, name="rms")


def table(head: Iterable[str], rows: Iterable[Sequence[str]], *, name: str = "") -> str:
    """A table of ready-made cells; the first of each row is its heading."""
    top = "".join(f'<th scope="col">{cell}</th>' for cell in head)
    body = "".join(
        f'<tr><th scope="row">{row[0]}</th>' + "".join(f"<td>{cell}</td>" for cell in row[1:]) + "</tr>" for row in rows
    )
    return f'<div class="wide"><table class="{name}"><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'
