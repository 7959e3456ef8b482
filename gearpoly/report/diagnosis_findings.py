"""The findings of a diagnosis in words, for its page: what, where, how sure, what else, and what to record next."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from gearpoly.compare.entries import chance_words
from gearpoly.compare.on_sky import sky_of
from gearpoly.diagnose.heldout import Rms, repeatable
from gearpoly.diagnose.verdict import Diagnosis, Finding, Rival
from gearpoly.page.typeset import typeset
from gearpoly.physics.words import Reported
from gearpoly.report.diagnosis_report import how_sure, sentence
from gearpoly.report.diagnosis_sky import finding_words
from gearpoly.report.diagnosis_words import capital, large, number, parameter, physics_words
from gearpoly.units import UM

CHIP = {
    "nothing_missing": ("✓", "nothing missing"),
    "explained": ("✓", "explained"),
    "partly_explained": ("◐", "partly explained"),
    "unexplained": ("?", "unexplained"),
}
"""A status as a sign and a word, so that colour is never alone."""

NO_NOISE = 1e-12
"""mm. Stands for no noise at all, as a made recording may have it."""

ROLES = {
    "without": "before",
    "with": "after",
    "declared simulation": "before",
    "with as-built teeth": "between",
    "with what was missing": "after",
}
"""Colour of a bar by what it stands for."""


Shown = dict[str, Any]
"""What a template shows: words, numbers as text, and whether there is anything at all."""


def verdict(diagnosis: Diagnosis) -> Shown:
    """Status, verdict and its figures."""
    sign, word = CHIP[diagnosis.status]
    before, after = (repeatable(rms.unseen, diagnosis.noise) / UM for rms in (diagnosis.before, diagnosis.after))
    return {
        "status": diagnosis.status,
        "sign": sign,
        "word": word,
        "sentence": sentence(diagnosis),
        "unexplained": len(diagnosis.unexplained),
        "figures": [
            ("repeatable mismatch before", f"{number(before, 3)} µm"),
            ("after, on data the fit never saw", f"{number(after, 3)} µm"),
            ("noise floor", f"{number(diagnosis.noise / UM, 3)} µm rms"),
            ("rms after over noise", _over_noise(diagnosis.after, diagnosis.noise)),
        ],
    }


def findings(diagnosis: Diagnosis) -> list[Shown]:
    """What there is to say of each finding, most important first."""
    return [_finding(n, one, diagnosis) for n, one in enumerate(diagnosis.findings, 1)]


def _finding(n: int, one: Finding, diagnosis: Diagnosis) -> Shown:
    a, b = (repeatable(rms.unseen, diagnosis.noise) / UM for rms in (one.without, one.with_))
    located = diagnosis.comparison.located
    return {
        "n": n,
        "says": typeset(one.says),
        "name": physics_words(one.claim.physics.name),
        # The tooth that the sentence names may have no certain number.
        "open": one.claim.place.tooth is not None and one.tooth is None,
        "without": number(a, 3),
        "with": number(b, 3),
        "where": where(one),
        "place": _place(one),
        "equation": one.claim.physics.equation,
        "parameters": values(one.parameters),
        "sky": capital(finding_words(one, located, sky_of(diagnosis.comparison)) or ""),
        "sure": capital(how_sure(one)),
        "gain": large(one.gain),
        "freedoms": sum(len(each.values) for each in one.claims),
        "foretold": None if one.foretold is None else large(one.foretold),
        "rivals": [_rival(each) for each in one.rivals],
        "rms": rms_rows([("without", one.without), ("with", one.with_)], diagnosis),
        "decide": _decide(one),
    }


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


def _place(one: Finding) -> Shown | None:
    """Where the plots show it: the tooth's mesh, or the order."""
    place = one.claim.place
    if place.tooth is not None:
        return {"gear": place.gear or 0, "kind": "tooth", "number": place.tooth}
    if place.order is not None or one.claim.physics.once_per_turn:
        return {"gear": place.gear or 0, "kind": "order", "number": place.order or 1}
    return None


def values(found: Reported) -> list[tuple[str, str, str]]:
    """Parameters with their standard errors and the keys that the JSON has them under."""
    return [(*parameter(name, value, std), name) for name, (value, std) in found.items()]


def _rival(one: Rival) -> Shown:
    """What the recordings cannot tell a finding from."""
    place = one.claim.place
    words = [] if place.gear_name is None else [place.gear_name]
    if one.tooth is not None:
        words.append(f"tooth {one.tooth}")
    if place.flank is not None and place.flank != "drive":
        words.append(f"{place.flank} flank")
    return {
        "says": typeset(one.says),
        "name": physics_words(one.claim.physics.name),
        "place": ", ".join(words),
        "chance": chance_words(one.probability),
        "parameters": ", ".join(" ".join(parameter(name, value, 0.0)) for name, (value, _) in one.parameters.items()),
    }


def _decide(one: Finding) -> Shown | None:
    """The recording that would tell a finding from its rivals."""
    gap = one.separation if one.rivals else None
    if gap is None:
        return None
    return {
        "says": typeset(gap.recording.says), "then": number(gap.separability, 2), "now": number(gap.now, 2),
    }  # fmt: skip


def fit(diagnosis: Diagnosis) -> Shown:
    """Before and after for the whole model, on data that the fit never saw."""
    rows = [
        ("declared simulation", diagnosis.before),
        ("with as-built teeth", diagnosis.as_built_only),
        ("with what was missing", diagnosis.after),
    ]
    return rms_rows(rows, diagnosis, seen=True)


def told_from(diagnosis: Diagnosis) -> float:
    """Repeatable part in mm that the noise level's own standard error alone would make: sqrt(2 noise std)."""
    noises = diagnosis.comparison.located.noises
    std = math.sqrt(sum(noise.level_std**2 for noise in noises)) / len(noises)
    return math.sqrt(2.0 * diagnosis.noise * std)


def _over_noise(rms: Rms, noise: float) -> str:
    return number(rms.unseen / max(noise, NO_NOISE), 3)


def unseen(diagnosis: Diagnosis) -> str:
    """What the fit never saw, and the noise in it."""
    return f"Unseen by the fit: {diagnosis.held_out_by}. Noise floor {number(diagnosis.noise / UM, 3)} µm rms."


def rms_rows(rows: Sequence[tuple[str, Rms]], diagnosis: Diagnosis, *, seen: bool = False) -> Shown:
    """Repeatable mismatch as lengths of bars (%) beside the noise floor's, with the raw figures."""
    noise = diagnosis.noise
    parts = [repeatable(rms.unseen, noise) for _, rms in rows]
    longest = max(*parts, noise, NO_NOISE)
    return {
        "head": ["repeatable µm", "rms µm", "rms / noise", *(["rms on fitted data µm"] if seen else [])],
        "floor": f"{100.0 * noise / longest:.2f}",
        "rows": [
            {
                "name": name,
                "role": ROLES[name],
                "width": f"{100.0 * part / longest:.2f}",
                "cells": [
                    number(part / UM, 3),
                    number(rms.unseen / UM, 4),
                    _over_noise(rms, noise),
                    *([number(rms.seen / UM, 4)] if seen else []),
                ],
            }
            for (name, rms), part in zip(rows, parts, strict=True)
        ],
    }
